#include "verify.h"

#include "verify_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace hausbench {
namespace {

// One scene in one pose: its rows are held against each other.
class SceneCheck {
public:
    SceneCheck(std::vector<Row>& rows, std::vector<std::size_t> members, const Shape& source, const Shape& target,
               const Stop& stop)
        : rows_(rows),
          members_(std::move(members)),
          source_(source),
          target_(target),
          checker_(source, target, stop),
          stop_(stop),
          surfaces_(kind_of(source) == ShapeKind::surface && kind_of(target) == ShapeKind::surface) {}

    // False where it was stopped.
    bool run() {
        for (std::size_t i : members_) {
            if (stop_ && stop_()) return false;
            check_lower(rows_[i]);
        }
        if (stop_ && stop_()) return false;
        refute_without_witness();
        for (std::size_t i : members_) check_upper(rows_[i]);
        return true;
    }

private:
    struct Found {
        Verdict verdict;
        double shown;
    };

    void check_lower(Row& row) {
        const double lower = row.outcome.bounds.lower;
        const Witness& witness = row.outcome.witness;
        if (lower <= 0) {  // 0 needs no witness
            row.check.lower = Verdict::holds;
            return;
        }
        if (!std::isfinite(lower)) {
            row.check = {Verdict::unsound, row.check.upper, "lower is infinite, and no two points are that far apart"};
            return;
        }
        if (!witness.source_point.allFinite()) {
            row.check.lower = Verdict::no_witness;
            return;
        }
        const Vec3& p = witness.source_point;
        const std::vector<double> same{p[0], p[1], p[2], double(witness.source_element), lower};
        auto at = known_.find(same);
        if (at == known_.end()) {
            Found found{};
            found.verdict = surfaces_ ? check_surface_lower(std::get<AlgebraicSurface>(source_),
                                                            std::get<AlgebraicSurface>(target_), lower, p, found.shown)
                                      : checker_.lower(lower, witness, row.asked.pose, found.shown);
            at = known_.emplace(same, found).first;
        }
        const auto& [verdict, shown] = at->second;
        row.check.lower = verdict;
        if (verdict == Verdict::holds) best_ = std::max(best_, lower);
        if (verdict != Verdict::unsound) return;
        row.check.reason =
            surfaces_ ? fmt::format("lower {:.17g}: the target has a point {:.17g} from the witness", lower, shown)
                      : fmt::format("lower {:.17g} is above what its witness shows ({:.17g})", lower, shown);
    }

    // Without a witness a lower bound can still be refuted: it is above an upper bound that is certified.
    void refute_without_witness() {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i : members_) {
            if (rows_[i].asked.certified == 1 && rows_[i].check.lower == Verdict::holds)
                least = std::min(least, rows_[i].outcome.bounds.upper);
        }
        for (std::size_t i : members_) {
            Row& row = rows_[i];
            const double lower = row.outcome.bounds.lower;
            if (row.check.lower != Verdict::no_witness || !(lower > least) || least < best_) continue;
            row.check.lower = Verdict::unsound;
            row.check.reason =
                fmt::format("lower {:.17g} is above the certified upper bound {:.17g} of another row", lower, least);
        }
    }

    void check_upper(Row& row) const {
        const Bounds& b = row.outcome.bounds;
        row.check.upper = b.upper >= best_ && b.upper >= b.lower ? Verdict::holds : Verdict::unsound;
        if (row.check.upper == Verdict::holds) return;
        if (!row.check.reason.empty()) row.check.reason += "; ";
        row.check.reason +=
            b.upper < b.lower ? fmt::format("upper {:.17g} is below lower {:.17g}", b.upper, b.lower)
                              : fmt::format("upper {:.17g} is below the verified lower bound {:.17g}", b.upper, best_);
    }

    std::vector<Row>& rows_;
    std::vector<std::size_t> members_;
    const Shape &source_, &target_;
    Checker checker_;
    const Stop& stop_;
    bool surfaces_;
    double best_ = 0;                             // the largest verified lower bound; 0 always holds
    std::map<std::vector<double>, Found> known_;  // many rows share a witness and a bound
};

}  // namespace

void verify_rows(std::vector<Row>& rows, const std::function<const Shape*(const std::string&)>& load,
                 const Stop& stop) {
    using SceneKey = std::tuple<std::string, std::string, std::vector<double>>;
    std::map<SceneKey, std::vector<std::size_t>> scenes;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Case& c = rows[i].asked;
        const Bounds& b = rows[i].outcome.bounds;
        rows[i].check = {};
        if (std::isnan(b.lower) || std::isnan(b.upper)) {
            if (!rows[i].outcome.solver_status.empty()) {  // it did answer
                rows[i].check = {Verdict::unsound, Verdict::unsound, "a bound is not a number"};
            }
            continue;
        }
        if (!c.pose.rotation.allFinite() || !c.pose.translation.allFinite())
            continue;  // only a damaged file holds such a pose
        std::vector<double> pose(c.pose.rotation.data(), c.pose.rotation.data() + 9);
        pose.insert(pose.end(), c.pose.translation.data(), c.pose.translation.data() + 3);
        scenes[{c.source, c.target, pose}].push_back(i);
    }
    for (const auto& [key, members] : scenes) {
        const Shape *source = load(std::get<0>(key)), *target = load(std::get<1>(key));
        if (!source || !target) continue;
        if (!SceneCheck(rows, members, *source, *target, stop).run()) break;
    }
    for (Row& row : rows) {
        if (row.check.lower != Verdict::unsound && row.check.upper != Verdict::unsound) continue;
        row.outcome.status = RowStatus::unsound;
        row.outcome.reason = row.check.reason;
    }
}

}  // namespace hausbench
