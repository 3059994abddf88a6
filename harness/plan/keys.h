// The keys of experiment files. The reader allows these and no others; `hausbench list keys` prints them, and docs/experiments.md is
// written from them (`python3 -m analysis.schema`). A new key is a line in keys.cpp, and code that reads it.
#pragma once

#include <string>
#include <vector>

namespace hausbench {

struct Key {
    std::string name;
    std::string fallback;  // value if the key is missing, as it would be written; empty: there is none
    std::string meaning;   // Markdown, one line
};

struct KeyTable {
    std::string title;  // as messages name the table, such as "[[scene]]"; empty: the top level
    std::vector<Key> keys;

    std::vector<std::string> names() const;
};

const KeyTable& top_keys();
const KeyTable& limit_keys();
const KeyTable& scene_keys();
const KeyTable& motion_keys(const std::string& kind);  // of one of motion_kinds()
const KeyTable& solver_keys();
const KeyTable& claim_keys();

const std::vector<std::string>& motion_kinds();

// All of the above, in the order in which documents list them.
std::vector<KeyTable> key_tables();

}  // namespace hausbench
