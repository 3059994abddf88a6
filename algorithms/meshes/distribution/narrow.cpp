// The limits for a piece are lowered in rounds until the sums of all gaps are small enough. The sum of the gaps turns out
// to be about proportional to the limit, so the next limit is the last one times (allowed gap) / (gap).
#include "algorithms/meshes/distribution/narrow.h"

#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <optional>

namespace hausbench::distribution {
namespace {

using Kind = Statistic::Kind;
using Over = Statistic::Over;

// More if the shapes have more triangles. One round may exceed it, see Dissection::refine().
constexpr std::size_t most_pieces = 5'000'000;

// A round counts as progress if it narrows a quantile by a tenth. If this many rounds in a row do not, and F is known and
// constant in the middle of the interval, no number of pieces will narrow it.
constexpr int rounds_without_progress = 4;

// If a round finds nothing to cut, the limits were too large, and shrink by this factor; after so many such rounds in a
// row, all gaps are rounding.
constexpr double shrink = 0x1p-10;
constexpr int rounds_without_cuts = 6;

// Returns whether a value is combined from the values over A and over B.
bool combines(Over over) { return over != Over::source && over != Over::target && over != Over::pooled; }

// A statistic over A, over B or over both pooled, and the limit for its pieces. The other statistics are combined from
// the values over A and over B.
struct Goal {
    Statistic statistic;
    Bounds bounds = {};
    double allowed = infinity;  // the largest gap that the query allows; infinity: it is not needed any more
    double limit = CutWhere::never;
    double last_gap = infinity;
    int idle = 0;           // rounds without progress
    bool constant = false;  // F is known in the middle between the bounds of a quantile

    bool flat() const { return constant && idle >= rounds_without_progress; }
};

class Narrowing {
public:
    Narrowing(const OneWay* source, const OneWay* target, double magnitude, const Query& query, Trace& trace)
        : query_(query), trace_(trace), most_(most_pieces) {
        const double far = farthest_apart(source ? *source : *target);
        for (const Statistic& statistic : query.statistics) answers_.push_back({0, is_share(statistic) ? 1 : far});
        trace_.show(answers_);
        for (const OneWay* way : {source, target}) {
            if (way) most_ = std::max(most_, 8 * static_cast<std::size_t>(way->triangles.rows()));
            pieces_.push_back(!way ? std::nullopt
                                   : std::optional<Dissection>(std::in_place, way->triangles, way->points, way->other,
                                                               magnitude, way->weigh, query.threads));
        }
        most_ = static_cast<std::size_t>(std::min<std::uint64_t>(query.budget, most_));
        for (const Statistic& statistic : query.statistics) {
            if (!combines(statistic.over)) {
                goal(statistic, statistic.over);
            } else {
                goal(statistic, Over::source);
                goal(statistic, Over::target);
            }
        }
    }

    Narrowed run() try {
        while (true) {
            bool more = false;
            for (std::size_t way = 0; way < 2; ++way)
                if (pieces_[way]) more |= pieces_[way]->refine(where_[way], stop_of(way), most_);
            expect_no_interrupt();
            if (const auto status = narrower(more)) return result(*status);
        }
    } catch (const Interrupted&) {
        return interrupted();
    }

private:
    // The place in `goals_` of a statistic over these points; adds it if it is new.
    std::size_t goal(Statistic statistic, Over over) {
        statistic.over = over;
        for (std::size_t i = 0; i < goals_.size(); ++i)
            if (goals_[i].statistic == statistic) return i;
        goals_.push_back({statistic});
        return goals_.size() - 1;
    }

    std::size_t pieces() const {
        std::size_t sum = 0;
        for (const std::optional<Dissection>& dissection : pieces_)
            if (dissection) sum += dissection->leaves().size();
        return sum;
    }

    struct Interrupted {};  // leaves a round at once, because interrupted() does not need its pieces
    void expect_no_interrupt() const {
        if (WATCHED("distribution: an interrupt", query_.interrupt && query_.interrupt->stop_requested()))
            throw Interrupted();
    }

    // Returns the bounds of the last round, and does not look at the pieces made since, so that it takes no time.
    Narrowed interrupted() { return result(Status::time_limit); }

    // Returns whether the time limit would pass while the statistics of this number of pieces are computed. Throws
    // Interrupted.
    bool is_over(std::size_t pieces) {
        expect_no_interrupt();
        if (std::isinf(query_.time_limit)) return false;
        if (seconds() >= query_.time_limit) return true;
        if (rounds_ == 0 && !estimated_.exchange(true)) estimate_seconds_per_piece();
        return seconds() + seconds_per_piece_ * static_cast<double>(pieces) >= query_.time_limit;
    }

    // Estimates, in the first round, how long the statistics of a piece will take: computes them for the first pieces.
    void estimate_seconds_per_piece() {
        for (const std::optional<Dissection>& dissection : pieces_) {
            if (!dissection || dissection->leaves().empty()) continue;
            const double begin = seconds();
            const Statistics some({dissection->leaves()}, dissection->extra_weight(), dissection->counted());
            for (const Goal& goal : goals_) some.of(goal.statistic);
            // Twice, because many pieces are not in the cache.
            seconds_per_piece_ = 2 * (seconds() - begin) / static_cast<double>(dissection->leaves().size());
            return;
        }
        estimated_ = false;  // try again once the first pieces are made
    }

    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }

    Dissection::Stop stop_of(std::size_t way) {
        const std::size_t others = pieces_[1 - way] ? pieces_[1 - way]->count() : 0;
        return [this, others](std::size_t pieces) { return is_over(pieces + others); };
    }

    // Computes all bounds from the pieces, and the next places to cut. Returns why to stop, if there is a reason;
    // `more` tells whether the last round cut anything.
    std::optional<Status> narrower(bool more) {
        std::array<std::optional<Statistics>, 3> all;  // by Over: source, target; the last is pooled
        const auto now = [&](Over over) -> const Statistics& {
            std::optional<Statistics>& statistics = all[over == Over::pooled ? 2 : static_cast<std::size_t>(over)];
            if (!statistics) {
                std::vector<std::span<const Leaf>> leaves;
                double extra = 0;
                bool counted = true;
                for (std::size_t way = 0; way < 2; ++way) {
                    if (over != Over::pooled && way != static_cast<std::size_t>(over)) continue;
                    leaves.emplace_back(pieces_[way]->leaves());
                    extra += pieces_[way]->extra_weight();
                    counted &= pieces_[way]->counted();
                }
                statistics.emplace(std::move(leaves), extra, counted);
            }
            return *statistics;
        };
        const double begin = seconds();
        for (Goal& goal : goals_) {
            // A machine may be slower now than in the last round, whose bounds hold, too.
            if (rounds_ > 0 && seconds() >= query_.time_limit) throw Interrupted();
            goal.bounds = now(goal.statistic.over).of(goal.statistic);
            goal.allowed = infinity;
        }
        ++rounds_;
        seconds_per_piece_ = (seconds() - begin) / static_cast<double>(pieces() + 1);
        const bool done = answer();
        trace_.show(answers_);
        if (done) return Status::converged;
        if (is_over(pieces())) return Status::time_limit;
        if (pieces() > most_) return Status::budget;
        without_cuts_ = more ? 0 : without_cuts_ + 1;
        for (Goal& goal : goals_) look_for_plateau(goal, now(goal.statistic.over));
        if (without_cuts_ > rounds_without_cuts) return unfinished();
        where_ = {};
        bool cut = false;
        for (Goal& goal : goals_) {
            if (goal.bounds.gap() <= goal.allowed || goal.flat()) continue;
            cut = true;
            lower_limit(goal, now(goal.statistic.over));
            for (std::size_t way = 0; way < 2; ++way) {
                if (goal.statistic.over == Over::pooled || way == static_cast<std::size_t>(goal.statistic.over))
                    now(goal.statistic.over).cut(goal.statistic, goal.bounds, goal.allowed, goal.limit, where_[way]);
            }
        }
        return cut ? std::nullopt : std::optional(Status::stalled);
    }

    // The status if there is nothing left to cut: `stalled` if only quantiles are open, because F is flat there.
    Status unfinished() {
        bool other = false;
        for (Goal& goal : goals_) {
            if (goal.bounds.gap() <= goal.allowed) continue;
            if (goal.constant)
                goal.idle = rounds_without_progress;
            else
                other = true;
        }
        return other ? Status::precision_floor : Status::stalled;
    }

    // Combines the bounds of the goals into `answers_`, and sets what the goals must still reach. Returns whether all
    // answers are within the tolerance.
    bool answer() {
        answers_.clear();
        bool done = true;
        for (const Statistic& statistic : query_.statistics) {
            if (!combines(statistic.over)) {
                Goal& single = goals_[goal(statistic, statistic.over)];
                answers_.push_back(single.bounds);
                single.allowed = std::min(single.allowed, query_.allowed_gap(statistic, single.bounds.lower));
                done &= single.bounds.gap() <= single.allowed;
                continue;
            }
            Goal& source = goals_[goal(statistic, Over::source)];
            Goal& target = goals_[goal(statistic, Over::target)];
            Bounds bounds = combined(statistic.over, source.bounds, target.bounds);
            if (is_share(statistic)) bounds.upper = std::min(bounds.upper, 1.0);
            answers_.push_back(bounds);
            const double allowed = query_.allowed_gap(statistic, bounds.lower);
            if (bounds.gap() <= allowed) continue;
            done = false;
            for (Goal* side : {&source, &target}) {
                // A value that cannot be the larger one need not be known better. A harmonic mean changes by at most
                // twice the change of one value.
                if (statistic.over == Over::larger && side->bounds.upper <= bounds.lower + allowed) continue;
                // Combining them rounds, so a mean of both gets a little less.
                const double part = statistic.over == Over::harmonic_mean  ? 0.25
                                    : statistic.over == Over::mean_of_both ? 0.99
                                                                           : 1;
                side->allowed = std::min(side->allowed, part * allowed);
            }
        }
        return done;
    }

    // Notes whether a quantile has come closer, and whether F is already known in the middle between its bounds.
    static void look_for_plateau(Goal& goal, const Statistics& now) {
        if (goal.statistic.kind != Kind::quantile) return;
        const double middle = goal.bounds.lower + 0.5 * goal.bounds.gap();
        goal.constant = now.open(goal.statistic, {middle, middle}) <= 0x1p-30 * now.weight();
        goal.idle = goal.bounds.gap() > 0.9 * goal.last_gap ? goal.idle + 1 : 0;
        goal.last_gap = goal.bounds.gap();
    }

    void lower_limit(Goal& goal, const Statistics& now) const {
        const bool quantile = goal.statistic.kind == Kind::quantile;
        const double open = now.open(goal.statistic, goal.bounds),
                     most = now.allowed(goal.statistic, goal.bounds, goal.allowed);
        if (open == 0) return;  // the gap does not come from the pieces
        if (goal.limit == CutWhere::never)
            goal.limit = std::min(4 * std::max(most, open / 256), 0.5 * open) / static_cast<double>(pieces());
        else if (without_cuts_ > 0)
            goal.limit *= WATCHED_ELSE("distribution: limits shrink where nothing was cut", shrink, 1);
        else
            goal.limit *= std::clamp(0.7 * most / open, quantile ? 0x1p-4 : 0x1p-10, 0.5);
    }

    Narrowed result(Status status) const {
        Narrowed narrowed{status, {}, answers_, pieces(), {}, witness()};
        for (const Goal& goal : goals_) {
            if (goal.bounds.gap() <= goal.allowed || !goal.flat()) continue;
            narrowed.note = to_string(goal.statistic) +
                            ": no distance lies between the bounds, and rounding leaves open which end is right; a "
                            "slightly different level is certain";
        }
        for (const std::optional<Dissection>& dissection : pieces_)
            if (dissection) narrowed.counters += dissection->counters();
        return narrowed;
    }

    // Returns the corner of a piece with the largest lower bound. A corner of level k is off its triangle by at most
    // 2k * uM, and its lower bound was lowered by more (mean_bounds.cpp), so the bound also holds for the corner as
    // computed, less its distance from the triangle.
    Witness witness() const {
        Witness farthest;
        const Statistic& first = query_.statistics.front();
        if (first.kind != Kind::maximum || first.over == Over::mean_of_both || first.over == Over::harmonic_mean)
            return farthest;
        double most = -infinity;
        for (std::size_t way = 0; way < 2; ++way) {
            if (!pieces_[way] || (first.over == Over::source && way == 1) || (first.over == Over::target && way == 0))
                continue;
            for (const Leaf& leaf : pieces_[way]->leaves()) {
                for (std::size_t k = 0; k < 3; ++k) {
                    if (!(leaf.bounds.lower[k] > most)) continue;
                    most = leaf.bounds.lower[k];
                    farthest = {};
                    (WATCHED_ELSE("distribution: the witness is on the other shape", way == 0, way == 1)
                         ? farthest.source_point
                         : farthest.target_point) = leaf.piece.corners[k];
                    (way == 0 ? farthest.source_element : farthest.target_element) = leaf.piece.source;
                    farthest.direction =
                        way == 0 ? Witness::Direction::source_to_target : Witness::Direction::target_to_source;
                }
            }
        }
        return farthest;
    }

    // Returns an upper bound on the distance between any two points of the shapes: the sum of the sides of their box,
    // whose squares could underflow.
    static double farthest_apart(const OneWay& way) {
        double sum = 0;
        for (int k = 0; k < 3; ++k) {
            const auto &a = way.points.col(k), &b = way.other.mesh().vertices.col(k);
            const double least = std::min(a.minCoeff(), b.minCoeff()), most = std::max(a.maxCoeff(), b.maxCoeff());
            sum = WATCHED("distribution: the first bounds allow for all sides of the boxes",
                          next_up(sum + next_up(most - least)));
        }
        return sum;
    }

    const Query& query_;
    Trace& trace_;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    std::atomic<double> seconds_per_piece_ = 0;  // to compute all statistics
    std::atomic<bool> estimated_ = false;
    int rounds_ = 0;
    std::size_t most_;
    int without_cuts_ = 0;
    std::vector<std::optional<Dissection>> pieces_;  // of A and of B
    std::vector<Goal> goals_;
    std::vector<Bounds> answers_;
    std::array<CutWhere, 2> where_;
};

}  // namespace

Bounds combined(Over over, const Bounds& source, const Bounds& target) {
    // Each operation errs by a factor of at most 1 + u, or by less than the least positive double.
    const double factor = 1 + WATCHED("distribution: the rounding of a harmonic mean", 8 * unit_roundoff);
    const auto outward = [factor](double lower, double upper) {
        return Bounds{
            std::max(0.0, next_down(lower / factor)),
            WATCHED_ELSE("distribution: underflow in the mean of both", next_up(upper * factor), upper * factor)};
    };
    const auto harmonic = [](double x, double y) {
        return x > 0 && y > 0 ? 2 * (std::min(x, y) * (std::max(x, y) / (x + y))) : 0;
    };
    switch (over) {
        case Over::larger:
            return {std::max(source.lower, target.lower), std::max(source.upper, target.upper)};
        case Over::mean_of_both:
            return outward(0.5 * source.lower + 0.5 * target.lower, 0.5 * source.upper + 0.5 * target.upper);
        case Over::harmonic_mean:
            return outward(harmonic(source.lower, target.lower), harmonic(source.upper, target.upper));
        default:
            return source;
    }
}

Narrowed narrow(const OneWay* source, const OneWay* target, double magnitude, const Query& query, Trace& trace) {
    return Narrowing(source, target, magnitude, query, trace).run();
}

}  // namespace hausbench::distribution
