// `hausbench measure A B`: the distance between any two files.
#pragma once

#include "load.h"
#include "record.h"

#include <filesystem>
#include <optional>
#include <string>

namespace hausbench {

inline constexpr double question_seconds = 10;  // the time limit where a cutoff is asked about and no other is given

struct MeasureRequest {
    std::filesystem::path source, target;
    std::string solver;  // empty: guthe for meshes, earlybreak for point sets
    ParameterMap options;
    double tolerance = 1e-6;
    std::string of = "diagonal";   // one of tolerance_units
    bool symmetric = false;        // H = max of both directions
    std::optional<double> cutoff;  // asks "is the distance above this length?"; the tolerance then ends nothing
    int threads = 1;
    double time_limit = std::numeric_limits<double>::infinity();
    std::filesystem::path fields = {};  // a file to write them into; empty: none are wanted
};

struct Measured {
    std::string solver;
    Result result;
    double unit = 1;  // see unit_of
    double tolerance_absolute = 0;
    double prepare_seconds = 0, solve_seconds = 0;
    std::int64_t peak_bytes = -1;
    LoadReport source_report, target_report;
    ShapeKind source_kind{}, target_kind{};
    Index source_elements = 0, target_elements = 0;
};

// Throws InputError for anything wrong with the files, the solver, its parameters or the tolerance.
Measured measure(const MeasureRequest& request);

// Whether the solver said anything at all: not where it stalled at [0, infinity].
bool answered(const Measured& measured);

// 0, or 1 without an answer. Of a question with a cutoff: 0 if the distance is at most that, 1 if it is above, 3 if that is open.
int exit_code(const Measured& measured, const MeasureRequest& request);

nlohmann::json to_json(const Measured& measured, const MeasureRequest& request);
std::string describe(const Measured& measured, const MeasureRequest& request);  // for a person; ends in a newline

}  // namespace hausbench
