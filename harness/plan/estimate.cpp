#include "plan/estimate.h"

#include "error.h"
#include "plan/lookup.h"
#include "registry.h"
#include "result/provenance.h"
#include "result/result_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

constexpr double start_seconds = 0.02;         // of a worker, loading a middling shape included
constexpr double seconds_per_distance = 3e-9;  // point to point, cache misses not counted
constexpr double distances_per_point = 300, distances_per_triangle = 3000;  // of solvers that use trees, roughly

// Resident bytes of a worker: by itself; a point or vertex; a triangle, which has half a vertex. A shape is read from its file and
// copied once, so it is there twice for a moment.
constexpr std::int64_t worker_bytes = 60 << 20;
constexpr std::int64_t bytes_per_point = 2 * 24, bytes_per_triangle = 2 * (12 + 12);

// What solvers take besides, an element, where no earlier run tells: more than all but the boxes of a few need.
constexpr double solver_bytes_per_point = 200, solver_bytes_per_triangle = 600;

// Of smaller shapes, what a solver takes is not in proportion to them.
constexpr double least_elements_to_learn_from = 10000;

bool takes_meshes(const std::string& solver) {
    return std::any_of(solvers().begin(), solvers().end(), [&](const SolverEntry& entry) {
        return entry.info.name == solver && entry.info.target.mesh;
    });
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

struct Known {
    double prepare = 0, solve = 0;
    double work = 0;
    bool answered = false;
};

}  // namespace

// What earlier runs took.
struct Estimates::Memory {
    explicit Memory(const fs::path& results) {
        std::error_code none;
        for (fs::directory_iterator entry(results, none), end; !none && entry != end; entry.increment(none)) {
            if (entry->path().extension() != ".h5") continue;
            try {
                for (const Row& row : read_result(entry->path()).rows) learn(row);
            } catch (const InputError&) {  // a damaged file only costs us its times
            }
        }
    }

    void learn(const Row& row) {
        const Outcome& o = row.outcome;
        if (o.from_trace) return;
        if (o.peak_bytes > 0 && elements(row.asked) >= least_elements_to_learn_from)
            bytes[row.asked.solver].add(elements(row.asked), double(o.peak_bytes) / elements(row.asked));
        if (o.machine != this_machine().id) return;
        const bool killed = o.status == RowStatus::timeout && !std::isfinite(o.solve_seconds);
        if (!killed && !std::isfinite(o.solve_seconds)) return;
        Known known{killed ? 0 : o.prepare_seconds, killed ? row.asked.limits.case_seconds : o.solve_seconds,
                    expected_work(row.asked), true};
        cases[row.asked.identity] = known;
        if (known.work > 0) times[row.asked.solver].add(known.work, known);
    }

    Known of(const Case& asked) const {
        if (const auto at = cases.find(asked.identity); at != cases.end()) return at->second;
        const auto others = times.find(asked.solver);
        const double work = expected_work(asked);
        if (others == times.end()) return {0, work * seconds_per_distance, work, false};
        const Known& near = others->second.nearest(work);  // scaled to this case
        return {near.prepare * work / near.work, near.solve * work / near.work, work, false};
    }

    // An element, of a case of about as many; 0 where there is none.
    double bytes_of(const Case& asked) const {
        const auto others = bytes.find(asked.solver);
        return others != bytes.end() && elements(asked) > 0 ? others->second.nearest(elements(asked)) : 0;
    }

    std::map<std::string, Known> cases;
    std::map<std::string, NearestByWork<Known>> times;
    std::map<std::string, NearestByWork<double>> bytes;
};

Estimates::Estimates(const fs::path& results) : results_(results) {}
Estimates::~Estimates() = default;

std::int64_t loaded_bytes(const Plan& plan, const Job& job) {
    std::set<fs::path> files;
    for (const Job::Pair& pair : job.pairs) files.insert({pair.source_file, pair.target_file});
    std::int64_t bytes = worker_bytes;
    for (const ModelRow& model : plan.models) {
        if (!files.contains(model.resolved.shape_file)) continue;
        bytes += model.resolved.vertices * bytes_per_point;
        if (model.resolved.kind == ShapeKind::mesh) bytes += model.resolved.elements * bytes_per_triangle;
    }
    return bytes;
}

JobEstimate Estimates::of(const Plan& plan, const Job& job) const {
    const Experiment& e = plan.experiment;
    if (!memory_) memory_ = std::make_unique<Memory>(results_);
    JobEstimate out;
    double prepare = 0, besides = 0, known_besides = 0;
    for (std::size_t row : job.cases) {
        const Case& asked = plan.cases[row];
        const Known known = memory_->of(asked);
        prepare = std::max(prepare, known.prepare);
        const double bytes = memory_->bytes_of(asked) * elements(asked);
        known_besides = std::max(known_besides, bytes);
        besides = std::max(besides, bytes > 0 ? bytes : guessed_bytes(asked));
        out.known += known.answered;
        const double once = std::min(known.solve, asked.limits.case_seconds);
        const bool in_time = known.solve < asked.limits.case_seconds;
        const double repeats =
            in_time ? std::min(e.repeats * std::max(once, 5e-4), 2 * asked.limits.case_seconds + once) : 0;
        out.seconds += e.rounds * (once + repeats) + (e.trace && !plan.marks(row).empty() ? once : 0);
    }
    out.seconds += e.rounds * (start_seconds + prepare);
    out.bytes = loaded_bytes(plan, job) + std::int64_t(besides);
    out.known_bytes = loaded_bytes(plan, job) + std::int64_t(known_besides);
    return out;
}

void refuse_what_does_not_fit(Plan& plan, const Estimates& estimates, std::int64_t most) {
    std::vector<Job> jobs;
    for (Job& job : plan.jobs) {
        const std::int64_t limit = std::min(most, plan.cases[job.cases.front()].limits.memory_bytes);
        const Case& first = plan.cases[job.cases.front()];
        // Far below the limit nothing needs to be known, so no result is read.
        const bool small = loaded_bytes(plan, job) + std::int64_t(8 * guessed_bytes(first)) <= limit;
        const std::int64_t bytes = small ? 0 : estimates.of(plan, job).known_bytes;
        if (bytes <= limit) {
            jobs.push_back(std::move(job));
            continue;
        }
        Outcome refused;
        refused.status = RowStatus::out_of_memory;
        refused.reason = fmt::format(
            "not started: about {} MB would be needed ({} MB for the shapes), and {} MB are allowed: raise memory_mb in "
            "[limits], or take a machine with more",
            bytes >> 20, loaded_bytes(plan, job) >> 20, limit >> 20);
        for (std::size_t row : job.cases) plan.decided[row] = refused;
        plan.ledger.push_back({"not_run", job.label, "all cases", refused.reason, std::int64_t(job.cases.size())});
    }
    plan.jobs = std::move(jobs);
}

}  // namespace hausbench
