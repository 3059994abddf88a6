#include "harness/run/ledger.h"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <set>

namespace hausbench {

namespace {

// Records the time saved by reading rows off the runs of other rows. Run by itself, each of these rows would have cost
// a first answer and the timed repeats in every round.
void note_time_saved(const Experiment& e, const std::vector<Row>& rows, std::vector<LedgerEntry>& ledger) {
    std::map<std::string, double> saved;
    for (const Row& row : rows) {
        if (!row.outcome.from_trace || !std::isfinite(row.outcome.solve_seconds)) continue;
        saved[fmt::format("{} on {}{}", shown(row.spec), row.spec.scene, suffix_of_statistic(row.spec))] +=
            row.outcome.solve_seconds * e.rounds * (1 + e.repeats);
    }
    for (LedgerEntry& entry : ledger) {
        const auto at = saved.find(entry.subject);
        if (entry.what != coarser_tolerances || at == saved.end()) continue;
        entry.seconds_saved = at->second;
        at->second = 0;  // several entries may have this subject: the first gets the sum
    }
}

// Records the time saved because a worker builds its structures once, not once for each pose.
void note_structures_reused(const Plan& plan, const Finished& finished, const Job& job,
                            std::vector<LedgerEntry>& ledger) {
    std::set<double> builds;  // preparation seconds of each worker process; several after a crash or interruption
    std::set<int> poses;
    for (std::size_t row : job.cases) {
        const Outcome* outcome = finished.kept(row, 0);
        if (!outcome || outcome->preparation.empty() || !std::isfinite(outcome->prepare_seconds)) continue;
        builds.insert(outcome->prepare_seconds);
        poses.insert(plan.cases[row].pose_index);
    }
    if (poses.size() <= builds.size()) return;
    const auto left_out = poses.size() - builds.size();
    const double mean = std::accumulate(builds.begin(), builds.end(), 0.0) / double(builds.size());
    ledger.push_back({"not_prepared", job.label, structures_for_each_pose,
                      fmt::format("built {} and used for all {} poses",
                                  builds.size() == 1 ? "once" : fmt::format("{} times", builds.size()), poses.size()),
                      std::int64_t(left_out), mean * double(left_out)});
}

// Records the time saved because a worker of a matrix prepares each shape once, not once for each pair.
void note_shapes_shared(const Job& job, const Finished& finished, std::vector<LedgerEntry>& ledger) {
    struct Use {
        int built = 0, shared = 0;
        double saved = 0;
        std::set<std::filesystem::path> shapes;
    };
    std::map<std::string, Use> uses;
    std::size_t place = 0;
    for (const Job::Pair& pair : job.pairs) {
        const Outcome* outcome = finished.kept(job.cases[place], 0);  // all cases of a pair share its preparation
        place += pair.cases;
        if (!outcome) continue;
        for (const Preparation& part : outcome->preparation) {
            if (part.round != 0 || part.name.starts_with("solver")) continue;
            const std::size_t side =
                part.name.find(' ') + 1;  // names: "target BVH" or, for a structure over A, "target BVH (B to A)"
            const std::size_t back = part.name.find(" (B to A)");
            const bool over_target = part.name.starts_with("target") == (back == std::string::npos);
            Use& use = uses[part.name.substr(side, back - side)];
            ++(part.shared ? use.shared : use.built);
            if (part.shared) use.saved += part.seconds;
            use.shapes.insert(over_target ? pair.target_file : pair.source_file);
        }
    }
    for (const auto& [name, use] : uses) {
        if (use.shared == 0) continue;
        const std::string again = std::size_t(use.built) == use.shapes.size()
                                      ? ""
                                      : fmt::format(", built {} times, by several workers or runs", use.built);
        ledger.push_back({"not_prepared", job.label, structures_for_each_pair,
                          fmt::format("{}: built over {} shapes and used {} times by {} pairs{}", name,
                                      use.shapes.size(), use.built + use.shared, job.pairs.size(), again),
                          use.shared, use.saved});
    }
}

}  // namespace

void note_savings(const Plan& plan, const Finished& finished, const std::vector<Row>& rows,
                  std::vector<LedgerEntry>& ledger) {
    note_time_saved(plan.experiment, rows, ledger);
    for (const Job& job : plan.jobs) {
        if (job.exponent)
            note_shapes_shared(job, finished, ledger);
        else if (!job.pairs.front().queries.target_copied)  // see note_copies() in plan.cpp
            note_structures_reused(plan, finished, job, ledger);
    }
}

}  // namespace hausbench
