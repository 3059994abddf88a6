// Reads one TOML table of an experiment, and refuses unknown keys.
#pragma once

#include "algorithms/scene.h"
#include "datasets/toml_reader.h"
#include "harness/plan/keys.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

class ExperimentTable : public TomlReader {
public:
    ExperimentTable(const std::filesystem::path& file, const toml::table& table, const KeyTable& keys)
        : TomlReader(file, table, keys.title, ":") {
        allow(keys.names());
        refuse_other_keys();
    }

    double limit(std::string_view key, double otherwise) const;  // above 0, in seconds or megabytes
    Vec3 vector(std::string_view key) const;
    std::vector<double> tolerances(std::string_view key) const;  // empty if the key is missing
};

inline int line_of(const toml::node& node) { return int(node.source().begin.line); }

}  // namespace hausbench
