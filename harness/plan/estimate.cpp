#include "harness/plan/estimate.h"

#include "algorithms/error.h"
#include "algorithms/registry.h"
#include "harness/plan/lookup.h"
#include "harness/result/provenance.h"
#include "harness/result/result_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

constexpr double start_seconds = 0.022;        // to start a worker and to check its answers
constexpr double load_seconds = 1e-7;          // per element of either shape
constexpr double seconds_per_distance = 3e-9;  // point to point, without cache misses
constexpr double distances_per_point = 300, distances_per_triangle = 3000;  // the factor k of estimate.h, roughly

// Resident bytes of a worker process without shapes, of a point or vertex, and of the three corner indices of a
// triangle.
constexpr std::int64_t worker_bytes = 60 << 20, bytes_per_point = 24, bytes_per_triangle = 12;

// Assumed bytes per element that a solver uses besides the shapes, if no earlier run has measured them. Only the
// bounding boxes of a few solvers take more.
constexpr double solver_bytes_per_point = 200, solver_bytes_per_triangle = 600;

// Rows with fewer elements are ignored when bytes per element are learnt: on small shapes, the memory of a solver is
// not proportional to the number of elements.
constexpr double least_elements_to_learn_from = 10000;

bool takes_meshes(const std::string& solver) {
    return std::any_of(solvers().begin(), solvers().end(),
                       [&](const SolverEntry& entry) { return entry.info.name == solver && entry.info.target.mesh; });
}

double expected_work(const Case& c) {
    const double a = double(c.source_elements), b = double(c.target_elements);
    if (c.solver == "naive") return a * b;
    return (takes_meshes(c.solver) ? distances_per_triangle : distances_per_point) * (a + b);
}

double guessed_bytes(const Case& c) {
    return (takes_meshes(c.solver) ? solver_bytes_per_triangle : solver_bytes_per_point) *
           (double(c.source_elements) + double(c.target_elements));
}

double elements(const Case& c) { return double(c.source_elements) + double(c.target_elements); }

// The columns of results that Memory::learn() looks at.
const ResultPart learnt_from = {{"identity", "solver", "status", "machine", "source_elements", "target_elements",
                                 "from_trace", "peak_bytes", "prepare_seconds", "solve_seconds", "case_seconds_limit"}};

struct Known {
    double prepare = 0, solve = 0;  // seconds
    double work = 0;                // see expected_work()
    bool answered = false;          // the times of the case itself, not of a similar case
};

}  // namespace

// The times and memory of earlier runs.
struct Estimates::Memory {
    explicit Memory(const fs::path& results) {
        std::error_code none;
        for (fs::directory_iterator entry(results, none), end; !none && entry != end; entry.increment(none)) {
            if (entry->path().extension() != ".h5") continue;
            try {
                for (const Row& row : read_part(entry->path(), learnt_from).rows) learn(row);
            } catch (const InputError&) {  // a damaged file only makes the estimates less accurate
            }
        }
    }

    void learn(const Row& row) {
        const Outcome& o = row.outcome;
        if (o.from_trace) return;
        if (o.peak_bytes > 0 && elements(row.spec) >= least_elements_to_learn_from)
            bytes[row.spec.solver].add(elements(row.spec), double(o.peak_bytes) / elements(row.spec));
        if (o.machine != this_machine().id) return;
        const bool killed = o.status == RowStatus::timeout && !std::isfinite(o.solve_seconds);
        if (!killed && !std::isfinite(o.solve_seconds)) return;
        Known timing{killed ? 0 : o.prepare_seconds, killed ? row.spec.limits.case_seconds : o.solve_seconds,
                     expected_work(row.spec), true};
        cases[row.spec.identity] = timing;
        if (timing.work > 0) times[row.spec.solver].add(timing.work, timing);
    }

    Known of(const Case& spec) const {
        if (const auto at = cases.find(spec.identity); at != cases.end()) return at->second;
        const auto others = times.find(spec.solver);
        const double work = expected_work(spec);
        if (others == times.end()) return {0, work * seconds_per_distance, work, false};
        const Known& near = others->second.nearest(work);
        return {near.prepare * work / near.work, near.solve * work / near.work, work, false};
    }

    // Returns the bytes per element of the solver's known case with the nearest number of elements. Returns 0 if there
    // is none.
    double bytes_of(const Case& spec) const {
        const auto others = bytes.find(spec.solver);
        return others != bytes.end() && elements(spec) > 0 ? others->second.nearest(elements(spec)) : 0;
    }

    std::map<std::string, Known> cases;
    std::map<std::string, NearestByWork<Known>> times;
    std::map<std::string, NearestByWork<double>> bytes;
};

Estimates::Estimates(const fs::path& results) : results_(results) {}
Estimates::~Estimates() = default;

namespace {

// Returns the memory, in bytes, of the coordinates and triangles of the shape in `file`. Returns 0 if no model of the
// plan has this file.
std::int64_t shape_bytes(const Plan& plan, const fs::path& file) {
    for (const ModelRow& model : plan.models) {
        if (model.resolved.shape_file.native() != file.native()) continue;  // comparing paths is slow
        const bool mesh = model.resolved.kind == ShapeKind::mesh;
        return model.resolved.vertices * bytes_per_point + (mesh ? model.resolved.elements * bytes_per_triangle : 0);
    }
    return 0;
}

// Returns the memory, in bytes, of a job's worker process and its shapes, without the solver's own memory. Each shape
// counts twice: as read from its file and as kept by the worker.
std::int64_t loaded_bytes(const Plan& plan, const Job& job) {
    std::set<fs::path> files;
    for (const Job::Pair& pair : job.pairs) files.insert({pair.source_file, pair.target_file});
    std::int64_t bytes = worker_bytes;
    for (const fs::path& file : files) bytes += 2 * shape_bytes(plan, file);
    return bytes;
}

}  // namespace

std::int64_t least_bytes(const Plan& plan, const Job& job) {
    std::int64_t most = 0;
    for (const Job::Pair& pair : job.pairs) {
        const bool same = pair.source_file == pair.target_file;
        most = std::max(most, shape_bytes(plan, pair.source_file) + (same ? 0 : shape_bytes(plan, pair.target_file)));
    }
    return most;
}

std::string does_not_fit(const Plan& plan, const Job& job, std::int64_t memory) {
    const std::int64_t limit = plan.cases[job.cases.front()].limits.memory_bytes, least = least_bytes(plan, job);
    if (least <= std::min(limit, memory)) return "";
    return fmt::format("{}its shapes alone take {} MB, and {}", not_started, least >> 20,
                       limit <= memory ? fmt::format("{} MB are allowed: raise memory_mb in [limits]", limit >> 20)
                                       : fmt::format("this machine has {} MB: take a larger one", memory >> 20));
}

JobEstimate Estimates::of(const Plan& plan, const Job& job) const {
    const Experiment& e = plan.experiment;
    if (!memory_) memory_ = std::make_unique<Memory>(results_);
    JobEstimate out;
    double prepare = 0, besides = 0, load = 0;
    for (std::size_t row : job.cases) {
        const Case& spec = plan.cases[row];
        const Known timing = memory_->of(spec);
        prepare = std::max(prepare, timing.prepare);
        load = std::max(load, elements(spec));
        const double bytes = memory_->bytes_of(spec) * elements(spec);
        besides = std::max(besides, bytes > 0 ? bytes : guessed_bytes(spec));
        out.timed_cases += timing.answered;
        const double once = std::min(timing.solve, spec.limits.case_seconds);
        const bool in_time = timing.solve < spec.limits.case_seconds;
        const double repeats =
            in_time ? std::min(e.repeats * std::max(once, 5e-4), 2 * spec.limits.case_seconds + once) : 0;
        out.seconds += e.rounds * (once + repeats) + (e.trace && !plan.marks(row).empty() ? once : 0);
    }
    out.seconds += e.rounds * (start_seconds + load_seconds * load + prepare);
    out.bytes = loaded_bytes(plan, job) + std::int64_t(besides);
    return out;
}

}  // namespace hausbench
