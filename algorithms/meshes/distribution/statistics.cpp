// Every statistic is a quotient of sums over leaves, sum(w v) / sum(w), with bounds on v.
//
// Rounding. A computed weight w' stands for a weight w = w' (1 + e) with |e| <= weight_error = 2^-42, and the sum of all
// weights may be larger by `extra`. So with v >= 0, a lower bound of the quotient is sum(w' v) / (sum(w') + extra) times
// (1 - 2^-42) / (1 + 2^-42). An upper bound is the same with extra * (the largest v) added to the numerator, times the
// inverse factor: the quotient grows with the weight that has the largest v. The factor 1 - 2^-40 (or 1 + 2^-40)
// also covers the rounding errors of values, products and sums, which are below 2^-46, and of the next operation.
//
// Counted leaves have the exact weight 1, so a share of them is a quotient of integers that rounds once. A quantile
// compares this double with its level. Then 18 of 20 points reach the level 0.9, although the double 0.9 is greater
// than 9/10: both numbers are the double nearest to 9/10.
#include "algorithms/meshes/distribution/statistics.h"

#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/distribution/weights.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace hausbench::distribution {
namespace {

constexpr double down = 1 - 0x1p-40, up = 1 + 0x1p-40;

}  // namespace

template <class Of> double Statistics::sum(const Of& of) const {
    Sum sum;
    for (const std::span<const Leaf> some : leaves_)
        for (const Leaf& leaf : some) sum.add(of(leaf));
    return sum.value();
}

// Returns the bounds of a mean from the sums of weight times lower and upper bound; `most` is the largest value.
Bounds Statistics::mean_of(double lower, double upper, double most) const {
    const double all = weight_ + extra_;
    return {
        lower / all * down,
        std::min((upper + WATCHED("distribution: the weight of triangles that are nearly segments", extra_ * most)) /
                     all * up,
                 most)};
}

// Returns a lower bound on F from the weight of leaves that are surely within.
double Statistics::share_at_least(double within) const {
    return counted_
               ? WATCHED_ELSE("distribution: shares of points are exact", within / weight_, within / weight_ * down)
               : within / (weight_ + extra_) * down;
}

// Returns an upper bound on F from the weight of leaves that are surely beyond.
double Statistics::share_at_most_beside(double beyond) const {
    return counted_
               ? (weight_ - beyond) / weight_
               : WATCHED_ELSE("distribution: the rounding of a share", next_up(1 - beyond / (weight_ + extra_) * down),
                              1 - beyond / (weight_ + extra_) * down);
}

Statistics::Statistics(std::vector<std::span<const Leaf>> leaves, double extra_weight, bool counted)
    : leaves_(std::move(leaves)), extra_(extra_weight), counted_(counted) {
    least_ = std::numeric_limits<double>::infinity();
    std::size_t count = 0;
    for (const std::span<const Leaf> some : leaves_) count += some.size();
    extents_.reserve(count);
    for (const std::span<const Leaf> some : leaves_) {
        for (const Leaf& leaf : some) {
            const Extent& extent =
                extents_.emplace_back(Extent{leaf.bounds.least(), leaf.bounds.most(), leaf.weight, &leaf});
            least_ = std::min(least_, extent.least);
            most_ = std::max(most_, extent.most);
            for (const double x : leaf.bounds.lower) most_at_least_ = std::max(most_at_least_, x);
        }
    }
    weight_ = sum([](const Leaf& leaf) { return leaf.weight; });
    mean_ = mean_of(sum([](const Leaf& leaf) { return leaf.weight * std::max(leaf.bounds.mean_lower, 0.0); }),
                    sum([](const Leaf& leaf) { return leaf.weight * leaf.bounds.mean_upper; }), most_);
    square_ = mean_of(sum([](const Leaf& leaf) { return leaf.weight * std::max(leaf.bounds.square_lower, 0.0); }),
                      sum([](const Leaf& leaf) { return leaf.weight * leaf.bounds.square_upper; }), most_ * most_ * up);
    mean_.lower = std::max(mean_.lower, least_);
    about_ = 0.5 * (mean_.lower + mean_.upper);
}

Bounds Statistics::of(const Statistic& statistic) const {
    switch (statistic.kind) {
        case Statistic::Kind::mean:
            return mean_;
        case Statistic::Kind::rms:
            return {std::sqrt(square_.lower) * down, std::min(std::sqrt(square_.upper) * up, most_)};
        case Statistic::Kind::deviation: {
            const double far = std::max(most_ - about_, about_) * up;
            const Bounds spread =
                mean_of(sum([&](const Leaf& leaf) { return leaf.weight * spread_about(leaf.bounds, about_).lower; }),
                        sum([&](const Leaf& leaf) { return leaf.weight * spread_about(leaf.bounds, about_).upper; }),
                        far * far * up);
            // The mean of (d - about)^2 is the squared deviation plus (mean - about)^2.
            const double off = WATCHED("distribution: a deviation about a length beside the mean",
                                       (0.5 * mean_.gap() + 4 * unit_roundoff * about_) * up);
            return {std::sqrt(std::max(0.0, spread.lower - off * off * up)) * down, std::sqrt(spread.upper) * up};
        }
        case Statistic::Kind::maximum:
            return {std::min(most_at_least_, most_), most_};
        case Statistic::Kind::quantile:
            return quantile(statistic.argument);
        case Statistic::Kind::share_within:
            return share_within(statistic.argument);
    }
    return {};
}

// A point counts as within `length` if an upper bound of d is, and as beyond it if a lower bound is.
Bounds Statistics::share_within(double length) const {
    Sum within_all, beyond_all;
    for (const Extent& extent : extents_) {
        if (extent.most <= length) {
            within_all.add(extent.weight);
        } else if (extent.least > length) {
            beyond_all.add(extent.weight);
        } else {
            within_all.add(extent.weight * share_at_most(extent.leaf->bounds.upper, length));
            beyond_all.add(extent.weight * share_above(extent.leaf->bounds.lower, length));
        }
    }
    const double within = within_all.value(), beyond = beyond_all.value();
    if (length >= most_) return {1, 1};
    const double lower = share_at_least(within), upper = share_at_most_beside(beyond);
    if (!counted_) return {lower, std::min(upper, 1.0)};
    return {lower > 0 ? WATCHED_ELSE("distribution: a share that rounds", next_down(lower), lower) : 0,
            upper > 0 ? std::min(next_up(upper), 1.0) : 0};
}

// Bisection: any t at which F is surely at least `level` is an upper bound, any t at which it is surely less a lower
// bound. For the first, leaves are judged by their upper bounds; for the second, by their lower bounds. Leaves that are
// the same for all t between `low` and `high` are added up once.
Bounds Statistics::quantile(double level) const {
    struct Open {
        CornerValues values;
        double least, most, weight;
    };
    const auto bisect = [&](bool surely) {
        const auto weighed = [&](const Open& entry, double t) {
            if (surely)
                return t >= entry.most   ? entry.weight
                       : t < entry.least ? 0
                                         : entry.weight * share_at_most(entry.values, t);
            return t >= entry.most ? 0 : t < entry.least ? entry.weight : entry.weight * share_above(entry.values, t);
        };
        double low = least_, high = most_;
        std::vector<Open> open;  // a copy, because the leaves themselves are too large for the cache
        for (const std::span<const Leaf> some : leaves_) {
            for (const Leaf& leaf : some) {
                const CornerValues& x = surely ? leaf.bounds.upper : leaf.bounds.lower;
                const auto [least, most] = std::minmax({x[0], x[1], x[2]});
                open.push_back({x, least, most, leaf.weight});
            }
        }
        Sum settled;
        for (int step = 0; step < 64; ++step) {
            const double middle = low + 0.5 * (high - low);
            if (!(low < middle && middle < high)) break;
            Sum all = settled;
            for (const Open& entry : open) all.add(weighed(entry, middle));
            const double share = surely ? share_at_least(all.value()) : share_at_most_beside(all.value());
            (share >= level ? high : low) = middle;
            std::erase_if(open, [&](const Open& entry) {
                if (entry.least <= high && entry.most > low) return false;
                settled.add(weighed(entry, high));
                return true;
            });
        }
        return surely ? high : low;
    };
    return {bisect(false), bisect(true)};
}

double Statistics::open_between(double low, double high) const {
    Sum all;
    for (const Extent& extent : extents_)
        if (extent.least <= high && extent.most > low) all.add(extent.weight * open_in(extent.leaf->bounds, low, high));
    return all.value();
}

double Statistics::open(const Statistic& statistic, const Bounds& band) const {
    switch (statistic.kind) {
        case Statistic::Kind::mean:
            return sum(
                [](const Leaf& leaf) { return leaf.weight * (leaf.bounds.mean_upper - leaf.bounds.mean_lower); });
        case Statistic::Kind::rms:
            return sum(
                [](const Leaf& leaf) { return leaf.weight * (leaf.bounds.square_upper - leaf.bounds.square_lower); });
        case Statistic::Kind::deviation:
            return sum([&](const Leaf& leaf) {
                const SpreadBounds spread = spread_about(leaf.bounds, about_);
                return leaf.weight * (spread.upper - spread.lower);
            });
        case Statistic::Kind::quantile:
            return open_between(band.lower, band.upper);
        case Statistic::Kind::share_within:
            return open_between(statistic.argument, statistic.argument);
        case Statistic::Kind::maximum:
            return 0;
    }
    return 0;
}

double Statistics::allowed(const Statistic& statistic, const Bounds& bounds, double gap) const {
    switch (statistic.kind) {
        case Statistic::Kind::mean:
        case Statistic::Kind::maximum:
        case Statistic::Kind::share_within:
            return weight_ * gap;
        case Statistic::Kind::rms:
        case Statistic::Kind::deviation:
            return weight_ * gap * (2 * bounds.lower + gap);  // of squares
        case Statistic::Kind::quantile:
            return open(statistic, bounds) * std::min(1.0, gap / bounds.gap());
    }
    return 0;
}

void Statistics::cut(const Statistic& statistic, const Bounds& bounds, double gap, double limit,
                     CutWhere& where) const {
    switch (statistic.kind) {
        case Statistic::Kind::mean:
            where.mean = std::min(where.mean, limit);
            break;
        case Statistic::Kind::rms:
            where.square = std::min(where.square, limit);
            break;
        case Statistic::Kind::deviation:
            where.spreads.push_back({about_, limit});
            break;
        case Statistic::Kind::maximum:
            where.maximum_gap =
                std::min(where.maximum == CutWhere::never ? infinity : where.maximum_gap, 0.125 * bounds.gap());
            where.maximum = std::min(where.maximum, bounds.lower + gap);
            break;
        case Statistic::Kind::quantile:
            where.bands.push_back({bounds.lower, bounds.upper, limit});
            break;
        case Statistic::Kind::share_within:
            where.bands.push_back({statistic.argument, statistic.argument, limit});
            break;
    }
}

}  // namespace hausbench::distribution
