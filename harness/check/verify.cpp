#include "harness/check/verify.h"

#include "algorithms/kernel/watched.h"
#include "harness/check/verify_fields.h"
#include "harness/check/verify_penetration.h"
#include "harness/check/verify_statistics.h"
#include "harness/check/verify_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <tuple>
#include <utility>

namespace hausbench {
namespace {

// Returns an upper bound on the |coordinates| of the shape after its pose v -> R * v + t, and on every product and
// partial sum in this computation.
double largest_within(const Shape& shape, const Pose& pose) {
    const Vec3 largest = points_of(shape).cwiseAbs().colwise().maxCoeff().transpose();
    return (WATCHED_ELSE("verify: slack for the products of a pose", pose, Pose{}).rotation.cwiseAbs() * largest +
            WATCHED_ELSE("verify: slack for the translation of a pose", pose, Pose{}).translation.cwiseAbs())
        .maxCoeff();
}

// Returns the slack of bounds that are not certified: the most that rounding can make them wrong if a solver is right
// in exact arithmetic and computes in doubles. Let u = 2^-53, the unit roundoff, and M the larger largest_within() of
// the two shapes. To first order in u, each coordinate of a point is off by at most the sum of
// - 8uM if the solver poses vertices by other operations than the definition. Each of the two ways loses at most 4uM:
//   uM in its three products together, and uM in each of three sums;
// - 12uM for the point a + s * (b - a) + t * (c - a) of a triangle: 2uM for each of two differences and two products,
//   uM for each of two sums, and 2uM because s + t may be rounded to above 1. (Other errors of s and t only choose
//   another point of the triangle.)
// So the point is off by at most sqrt(3) * 20uM < 35uM. A lower bound loses this twice: for the witness on A, which the
// check compares with A, and for the nearest point on B. A distance d is at most 2 * sqrt(3) * M, and its computation
// (differences, squares, sum and root) loses less than 4ud < 14uM. The sum is 35uM + 35uM + 14uM = 84uM. An upper bound
// loses no more.
double slack_for_rounding(const Shape& first, const Pose& first_pose, const Shape& second, const Pose& second_pose) {
    const double slack =
        WATCHED_ELSE("verify: the slack is no larger than it has to be",
                     WATCHED("verify: the slack of bounds that are not certified", 84), 16800) *
        0x1p-53 *
        std::max(WATCHED("verify: slack for what the first shape rounds", largest_within(first, first_pose)),
                 WATCHED("verify: slack for what the second shape rounds", largest_within(second, second_pose)));
    return std::isfinite(slack) ? slack : 0;
}

// Says by how much `high` exceeds `low`, such as "by 1.1e-16 (1 ulp)". One ulp is the step to the next double.
std::string excess(double high, double low) {
    const auto ulps = std::bit_cast<std::int64_t>(high) - std::bit_cast<std::int64_t>(low + 0.0);  // -0 + 0.0 is 0
    return ulps < 1'000'000 ? fmt::format("by {:.3g} ({} ulp{})", high - low, ulps, ulps == 1 ? "" : "s")
                            : fmt::format("by {:.3g} ({:.2g} ulps)", high - low, double(ulps));
}

// Returns the distance that a case asks for. The largest distance among statistics by area is one, too.
Quantity distance_of(const Case& c) {
    const bool largest = c.quantity == Quantity::distribution && c.weigh == WeighBy::area;
    if (WATCHED("verify rows: the largest distance among statistics is not compared with its witness",
                largest && c.statistic == "maximum"))
        return Quantity::directed;
    return largest && c.statistic == "maximum larger" ? Quantity::symmetric : c.quantity;
}

// The index of a row on a pair of shapes. `turned` is true if the row's source is the second shape of the pair.
struct Member {
    std::size_t row;
    bool turned;
};

// Checks all rows on two shapes in fixed poses against each other: rows of h(first, second), h(second, first) and H.
class PairCheck {
public:
    PairCheck(std::vector<Row>& rows, std::vector<Member> members, const Shape& first, const Shape& second,
              const Stop& stop)
        : rows_(rows),
          members_(std::move(members)),
          shapes_{&first, &second},
          checkers_{Checker(first, second, stop), Checker(second, first, stop)},
          stop_(stop),
          slack_(slack_for_rounding(first, poses().first, second, poses().second)),
          surfaces_(kind_of(first) == ShapeKind::surface && kind_of(second) == ShapeKind::surface) {}

    // Returns false if the check was stopped.
    bool run() {
        for (const Member& m : members_) {
            if (stop_ && stop_()) return false;
            check_lower(m);
            if (WATCHED("verify: an upper bound is held against the row's own witness", true)) look_beyond_upper(m);
        }
        if (stop_ && stop_()) return false;
        if (WATCHED("verify: each h refutes H", true))
            best_[of_both] = std::max({best_[of_first], best_[of_second], best_[of_both]});
        refute_without_witness();
        for (const Member& m : members_) check_upper(m);
        return true;
    }

private:
    struct Found {
        Verdict verdict;
        double shown;
    };
    // h(first, second), h(second, first), H.
    enum Distance { of_first, of_second, of_both };

    Distance distance(const Member& m) const {
        return WATCHED("verify: H refutes no h", distance_of(rows_[m.row].spec) == Quantity::symmetric) ? of_both
               : m.turned                                                                               ? of_second
                                                                                                        : of_first;
    }

    // Returns the poses of the first and second shape, which all rows share.
    std::pair<Pose, Pose> poses() const {
        const Case& spec = rows_[members_.front().row].spec;
        return members_.front().turned ? std::pair(spec.target_pose, spec.pose)
                                       : std::pair(spec.pose, spec.target_pose);
    }

    double slack(const Row& row) const {
        return WATCHED_ELSE("verify: no slack for certified bounds", row.spec.certified == 0, true) ? slack_ : 0;
    }

    void check_lower(const Member& m) {
        Row& row = rows_[m.row];
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
        const bool forward = witness.direction == Witness::Direction::source_to_target;
        if (WATCHED("verify: the witness of a directed row is far away on A",
                    distance_of(row.spec) == Quantity::directed && !forward)) {
            row.check.lower = Verdict::unsound;
            row.check.reason = "the witness is one of h(B,A), and the row one of h(A,B)";
            return;
        }
        const Vec3& p = forward ? witness.source_point : witness.target_point;
        if (!p.allFinite()) {
            row.check.lower = Verdict::no_witness;
            return;
        }
        double shown = 0, proven = lower;
        Verdict verdict = by_witness(m, lower, shown);
        if (verdict == Verdict::unsound && slack(row) > 0 && lower - slack(row) <= shown) {
            double less = 0;
            proven = std::max(0.0, lower - WATCHED("verify: the slack of a lower bound", slack(row)));
            verdict = WATCHED_ELSE("verify: a lower bound that its slack takes to 0 needs no witness", proven > 0, true)
                          ? by_witness(m, proven, less)
                          : Verdict::holds;
        }
        row.check.lower = verdict;
        if (verdict == Verdict::holds)
            best_[distance(m)] = std::max(best_[distance(m)],
                                          WATCHED_ELSE("verify: what refutes others is what is shown", proven, lower));
        if (verdict != Verdict::unsound) return;
        row.check.reason = fmt::format("lower {:.17g}", lower) + what_is_shown(shown, forward);
        row.check.reason += ", " + excess(lower, shown) + beyond_slack(row);
    }

    // Returns the end of a message on a refuted lower bound: the value that its witness shows instead. The witness is
    // on the source if `forward`. For surfaces, `shown` is 0 if no point of the surface was found near the witness.
    std::string what_is_shown(double shown, bool forward) const {
        const char *side = forward ? "source" : "target", *other = forward ? "target" : "source";
        if (!surfaces_) return fmt::format(" is above the distance of its witness ({:.17g})", shown);
        if (shown == 0) return fmt::format(": nothing shows that the witness is near the {}", side);
        return fmt::format(": the {} has a point {:.17g} from the witness", other, shown);
    }

    // Checks whether the row's witness is farther from the other shape than the row's upper bound allows. If so, the
    // witness refutes this bound, whatever lower bound the row claims. For surfaces this takes a long search, so it is
    // done only for rows without a lower bound.
    void look_beyond_upper(const Member& m) {
        const Row& row = rows_[m.row];
        const Witness& witness = row.outcome.witness;
        const double most = row.outcome.bounds.upper + slack(row);
        const double beyond = std::max(std::nextafter(most, infinity), std::numeric_limits<double>::denorm_min());
        const bool forward = witness.direction == Witness::Direction::source_to_target;
        const Vec3& p = forward ? witness.source_point : witness.target_point;
        if (!std::isfinite(beyond) || !p.allFinite() || (surfaces_ && row.outcome.bounds.lower > 0) ||
            (distance_of(row.spec) == Quantity::directed && !forward))
            return;
        double shown = 0;
        if (by_witness(m, beyond, shown) == Verdict::holds) best_[distance(m)] = std::max(best_[distance(m)], beyond);
    }

    std::string beyond_slack(const Row& row) const {
        return slack(row) > 0 ? fmt::format("; rounding explains {:.3g}", slack(row)) : "";
    }

    // Checks a lower bound by the witness of a row. Caches the results, because many rows share a witness and a bound.
    Verdict by_witness(const Member& m, double lower, double& shown) {
        const Row& row = rows_[m.row];
        const Witness& witness = row.outcome.witness;
        const bool forward = witness.direction == Witness::Direction::source_to_target;
        const Vec3& p = forward ? witness.source_point : witness.target_point;
        const bool from_second = forward == m.turned;
        const Index element = forward ? witness.source_element : witness.target_element;
        const std::vector<double> same{double(from_second), p[0], p[1], p[2], double(element), lower};
        auto at = known_.find(same);
        if (at == known_.end()) {
            Found entry{};
            if (surfaces_)
                entry.verdict = check_surface_lower(
                    std::get<AlgebraicSurface>(
                        *shapes_[WATCHED("verify: the surface that the witness lies on", from_second)]),
                    std::get<AlgebraicSurface>(*shapes_[!from_second]), lower, p, entry.shown);
            else
                entry.verdict =
                    checkers_[m.turned].lower(lower, witness, row.spec.pose, row.spec.target_pose, entry.shown);
            at = known_.emplace(same, entry).first;
        }
        shown = at->second.shown;
        return at->second.verdict;
    }

    // Refutes lower bounds without a witness that are above a certified upper bound on the same distance. An upper
    // bound on H is also one on h(A,B) and h(B,A).
    void refute_without_witness() {
        std::array<double, 3> least;
        least.fill(std::numeric_limits<double>::infinity());
        for (const Member& m : members_) {
            const Row& row = rows_[m.row];
            const double upper =
                WATCHED("verify: an upper bound of a reference counts only if it is proven", row.is_reference)
                    ? row.outcome.proven_upper
                    : row.outcome.bounds.upper;
            if (row.spec.certified == 1 && row.check.lower == Verdict::holds &&
                WATCHED_ELSE("verify: an upper bound that is refuted refutes nothing", upper >= best_[distance(m)],
                             true))
                least[distance(m)] = std::min(least[distance(m)], upper);
        }
        for (Distance h : {of_first, of_second}) {
            if (WATCHED("verify: a certified upper bound of H is one of each h", true))
                least[h] = std::min(least[h], least[of_both]);
        }
        for (const Member& m : members_) {
            Row& row = rows_[m.row];
            const double lower = row.outcome.bounds.lower;
            if (row.check.lower != Verdict::no_witness ||
                !(lower > least[distance(m)] + WATCHED("verify: the slack of a bound without a witness", slack(row))))
                continue;
            row.check.lower = Verdict::unsound;
            row.check.reason =
                fmt::format("lower {:.17g} is above the certified upper bound {:.17g} of another row, {}{}", lower,
                            least[distance(m)], excess(lower, least[distance(m)]), beyond_slack(row));
        }
    }

    // Refutes the row's upper bound if it is below a verified lower bound or below the row's own lower bound.
    void check_upper(const Member& m) {
        Row& row = rows_[m.row];
        const Bounds& b = row.outcome.bounds;
        const double best = best_[distance(m)];
        const double upper = b.upper + WATCHED("verify: the slack of an upper bound", slack(row));
        row.check.upper = upper >= best && upper >= b.lower ? Verdict::holds : Verdict::unsound;
        if (row.check.upper == Verdict::holds) return;
        if (!row.check.reason.empty()) row.check.reason += "; ";
        const bool crossed = upper < b.lower;
        row.check.reason += crossed
                                ? fmt::format("upper {:.17g} is below lower {:.17g}", b.upper, b.lower)
                                : fmt::format("upper {:.17g} is below the verified lower bound {:.17g}", b.upper, best);
        if (b.upper >= 0) row.check.reason += ", " + excess(crossed ? b.lower : best, b.upper) + beyond_slack(row);
    }

    std::vector<Row>& rows_;
    std::vector<Member> members_;
    std::array<const Shape*, 2> shapes_;
    std::array<Checker, 2> checkers_;  // for (first, second) and for (second, first)
    const Stop& stop_;
    double slack_;  // for rows that are not certified
    bool surfaces_;
    std::array<double, 3> best_{};                // the largest verified lower bound on each Distance; 0 always holds
    std::map<std::vector<double>, Found> known_;  // results of by_witness()
};

using Placed = std::pair<std::string, std::vector<double>>;  // a model and its pose

Placed placed(const std::string& model, const Pose& pose) {
    std::vector<double> values(pose.rotation.data(), pose.rotation.data() + 9);
    values.insert(values.end(), pose.translation.data(), pose.translation.data() + 3);
    return {model, values};
}

void check_fields_of(Row& row, const std::function<const Shape*(const std::string&)>& load, const Stop& stop) {
    const Shape *source = load(row.spec.source), *target = load(row.spec.target);
    if (!source || !target) return;
    std::string reason;
    const Case& spec = row.spec;
    const double slack =
        WATCHED_ELSE("fields: slack for bounds that are not certified alone", spec.certified == 0, true)
            ? slack_for_rounding(*source, spec.pose, *target, spec.target_pose)
            : 0;
    row.check.fields = check_fields(row.fields, *source, spec.pose, *target, spec.target_pose, slack, stop, reason);
    if (row.check.fields == Verdict::unsound) row.check.reason += (row.check.reason.empty() ? "" : "; ") + reason;
}

void check_depths(std::vector<Row>& rows, const std::vector<std::size_t>& members, std::size_t checked,
                  const std::function<const Shape*(const std::string&)>& load, const Stop& stop) {
    const auto is_checked = [&](std::size_t i) { return i >= checked && rows[i].check.lower != Verdict::not_checked; };
    if (std::all_of(members.begin(), members.end(), is_checked)) return;
    const Case& first = rows[members.front()].spec;
    const Shape *source = load(first.source), *target = load(first.target);
    if (!source || !target || kind_of(*source) != ShapeKind::mesh || kind_of(*target) != ShapeKind::mesh) return;
    PenetrationChecker checker(*source, first.pose, *target, first.target_pose, stop);
    for (const std::size_t i : members) rows[i].check = checker.check(rows[i].outcome.bounds, rows[i].outcome.witness);
    for (const std::size_t i : members) {
        Check& check = rows[i].check;
        std::string reason;
        if (check.upper != Verdict::holds ||
            !WATCHED("verify: upper bounds of other rows of the pair", checker.refutes(rows[i].outcome.bounds, reason)))
            continue;
        check.upper = Verdict::unsound;
        check.reason += (check.reason.empty() ? "" : "; ") + reason;
    }
}

bool finite(const Pose& pose) { return pose.rotation.allFinite() && pose.translation.allFinite(); }

// The problem of a row: two shapes in their poses, and a quantity. Rows with the same problem have the same exact
// answer.
using Problem = std::tuple<Placed, Placed, Quantity, std::string>;

Problem problem_in(const Case& c) {
    return {placed(c.source_hash, c.pose), placed(c.target_hash, c.target_pose), c.quantity,
            c.statistic + std::string(to_string(c.weigh))};
}

// Sets `reference` of each row to the narrowest reference interval for the same shapes, poses and quantity. Ignores
// references that are unsound or refused.
void take_references(std::vector<Row>& rows, const std::vector<Row>& references) {
    std::map<Problem, Bounds> narrowest;
    for (const Row& reference : references) {
        const Bounds& bounds = reference.outcome.bounds;
        const auto proof = reference.outcome.facts.find("certificate");
        const bool refused = proof != reference.outcome.facts.end() && proof->second.starts_with("refused");
        const bool usable = reference.outcome.status != RowStatus::unsound && !refused && bounds.lower <= bounds.upper;
        if (!usable || reference.spec.source_hash.empty() || reference.spec.target_hash.empty() ||
            !finite(reference.spec.pose) || !finite(reference.spec.target_pose))
            continue;
        const auto [at, fresh] = narrowest.emplace(problem_in(reference.spec), bounds);
        if (bounds.gap() < at->second.gap()) at->second = bounds;
    }
    for (Row& row : rows) {
        if (!finite(row.spec.pose) || !finite(row.spec.target_pose)) continue;
        const auto at = narrowest.find(problem_in(row.spec));
        row.reference = at == narrowest.end() ? Bounds{unknown, unknown} : at->second;
    }
}

}  // namespace

void verify_rows(std::vector<Row>& rows, std::vector<Row>& references,
                 const std::function<const Shape*(const std::string&)>& load, const Stop& stop, std::size_t checked) {
    const auto mine = static_cast<std::ptrdiff_t>(rows.size());
    std::move(references.begin(), references.end(), std::back_inserter(rows));
    verify_rows(rows, load, stop, checked);
    references.assign(std::make_move_iterator(rows.begin() + mine), std::make_move_iterator(rows.end()));
    rows.resize(static_cast<std::size_t>(mine));
    if (WATCHED("verify: rows are given the bounds of their reference", true)) take_references(rows, references);
}

void verify_rows(std::vector<Row>& rows, const std::function<const Shape*(const std::string&)>& load, const Stop& stop,
                 std::size_t checked) {
    std::map<std::pair<Placed, Placed>, std::vector<Member>> pairs;
    std::map<std::pair<Placed, Placed>, std::vector<std::size_t>> solids, statistics;  // rows of these quantities
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Case& c = rows[i].spec;
        const Bounds& b = rows[i].outcome.bounds;
        if (i < checked) rows[i].check = {};
        if (std::isnan(b.lower) || std::isnan(b.upper)) {
            if (i < checked && !rows[i].outcome.solver_status.empty()) {  // the solver did answer
                rows[i].check = {Verdict::unsound, Verdict::unsound, "a bound is not a number"};
            }
            continue;
        }
        if (!finite(c.pose) || !finite(c.target_pose)) continue;  // only a damaged file holds such a pose
        const Placed source = placed(c.source, c.pose);
        const Placed target =
            placed(c.target,
                   WATCHED_ELSE("verify: rows of other poses of the target are other scenes", c.target_pose, Pose{}));
        if (distance_of(c) == Quantity::distribution) {
            statistics[{source, target}].push_back(i);
            continue;
        }
        if (WATCHED("verify: a penetration depth is no distance of the two shapes",
                    c.quantity == Quantity::penetration)) {
            solids[{source, target}].push_back(i);
            continue;
        }
        const bool turned = target < source;
        pairs[turned ? std::pair(target, source) : std::pair(source, target)].push_back({i, turned});
    }
    const auto is_checked = [&](const Member& m) {
        return m.row >= checked && rows[m.row].check.lower != Verdict::not_checked;
    };
    for (const auto& [key, members] : pairs) {
        const bool all = WATCHED_ELSE("verify: rows of an earlier run are held against new ones",
                                      std::all_of(members.begin(), members.end(), is_checked),
                                      std::any_of(members.begin(), members.end(), is_checked));
        if (all) continue;
        const Shape *first = load(key.first.first), *second = load(key.second.first);
        if (!first || !second) continue;
        for (const Member& m : members)
            rows[m.row].check = {Verdict::not_checked, Verdict::not_checked, "", rows[m.row].check.fields};
        if (!PairCheck(rows, members, *first, *second, stop).run()) break;
    }
    for (const auto& [key, members] : solids) {
        if (stop && stop()) break;
        check_depths(rows, members, checked, load, stop);
    }
    for (const auto& [key, members] : statistics) {
        if (stop && stop()) break;
        check_statistics(rows, members, checked, load, stop);
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
        Row& row = rows[i];
        if (!row.fields.empty() && (i < checked || row.check.fields == Verdict::not_checked))
            check_fields_of(row, load, stop);
        const Check& check = row.check;
        if (check.lower != Verdict::unsound && check.upper != Verdict::unsound &&
            WATCHED_ELSE("verify: a field that is unsound makes its row unsound", check.fields != Verdict::unsound,
                         true))
            continue;
        row.outcome.status = RowStatus::unsound;
        if (!check.reason.empty()) row.outcome.reason = check.reason;  // empty if the row was checked before
    }
}

}  // namespace hausbench
