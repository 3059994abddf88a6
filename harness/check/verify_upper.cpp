#include "harness/check/verify_upper.h"

#include "algorithms/kernel/watched.h"

#include <CGAL/Interval_nt.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <vector>

namespace hausbench {
namespace {

using Enclosure = CGAL::Interval_nt<false>;

// A hash table of points by the grid cell that contains them.
class Grid {
public:
    // `origin` should be near most of the points, so that their cell indices are small and exact.
    Grid(const Points& points, double side, const Vec3& origin) : side_(side), origin_(origin) {
        for (Index i = 0; i < points.rows(); ++i) cells_[cell_of(points.row(i))].push_back(i);
    }

    // Calls visit(i) for the points in the cell of p, then in the 26 cells around it, and stops when visit(i) returns
    // true.
    template <class Visit> void near(const Vec3& p, Visit visit) const {
        const Cell centre = cell_of(p);
        if (any_in(centre, visit)) return;
        for (int k = 0; k < 27; ++k) {
            const Cell other = {centre[0] + k % 3 - 1, centre[1] + k / 3 % 3 - 1, centre[2] + k / 9 - 1};
            if (k != 13 && any_in(other, visit)) return;
        }
    }

private:
    using Cell = std::array<std::int64_t, 3>;
    struct Hash {
        std::size_t operator()(const Cell& cell) const {
            std::uint64_t sum = 0;
            for (const std::int64_t x : cell) {
                sum = (sum ^ std::uint64_t(x)) * 0x9E3779B97F4A7C15u;
                sum ^= sum >> 29;
            }
            return std::size_t(sum);
        }
    };

    Cell cell_of(const Vec3& p) const {
        Cell cell;
        for (int k = 0; k < 3; ++k)
            cell[std::size_t(k)] = std::int64_t(std::clamp(std::floor((p[k] - origin_[k]) / side_), -0x1p60, 0x1p60));
        return cell;
    }

    template <class Visit> bool any_in(const Cell& cell, Visit visit) const {
        const auto entry = cells_.find(cell);
        return entry != cells_.end() && std::any_of(entry->second.begin(), entry->second.end(), visit);
    }

    double side_;
    Vec3 origin_;
    std::unordered_map<Cell, std::vector<Index>, Hash> cells_;
};

bool is_within(const Vec3& p, const Vec3& q, double upper) {
    return squared_distance(p, {q}) <= Rational(upper) * Rational(upper);
}

// The result of comparing the distance of two points with `upper` in interval arithmetic. `certain`: it is at most
// `upper`. `doubtful`: exact rationals must decide. If both are false, it is larger.
struct Judged {
    bool certain, doubtful;
};

// Requires upward rounding.
Judged judge(const Vec3& p, const Vec3& q, double upper) {
    Enclosure sum(0);
    for (int k = 0; k < 3; ++k) sum += CGAL::square(Enclosure(p[k]) - Enclosure(q[k]));
    const Enclosure most = CGAL::square(Enclosure(upper));
    const bool certain =
        WATCHED_ELSE("verify: a point is near if intervals prove it", sum.sup() <= most.inf(), sum.inf() <= most.sup());
    return {certain, !certain && !(sum.inf() > most.sup())};
}

// A time limit. To be fast, passed() reads the clock only at every 4096th call.
class Limit {
public:
    explicit Limit(double seconds) : seconds_(seconds) {}
    bool passed() {
        if (!passed_ && ++asked_ % 4096 == 0) passed_ = elapsed() > seconds_;
        return passed_;
    }
    double elapsed() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }

private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    double seconds_;
    std::uint64_t asked_ = 0;
    bool passed_ = false;
};

// Returns whether a point of `to` is at most `upper` away from p. The result is meaningless once the limit has passed.
bool has_near(const Grid& grid, const Points& to, const Vec3& p, double upper, Limit& limit) {
    std::vector<Index> doubtful;
    bool certain = false;
    const auto visit = [&](Index i) {
        const Judged judged = judge(p, to.row(i), upper);
        if (judged.doubtful) doubtful.push_back(i);
        return (certain = judged.certain) || limit.passed();
    };
    const auto within = [&](Index i) { return limit.passed() || is_within(p, to.row(i), upper); };
    const auto settled = [&] { return certain || std::any_of(doubtful.begin(), doubtful.end(), within); };
    {
        CGAL::Protect_FPU_rounding<true> upward;
        grid.near(p, visit);
    }
    if (settled()) return true;
    // Rounding may have put a point into a wrong cell, so all points are tried before giving up.
    doubtful.clear();
    {
        CGAL::Protect_FPU_rounding<true> upward;
        for (Index i = 0; i < to.rows() && !visit(i);) ++i;
    }
    return settled();
}

// Returns the median of the points along each axis, and their longest extent along an axis. The extent ignores 5 % of
// the points at either end as outliers, unless this makes it 0.
std::pair<Vec3, double> bulk_of(const Points& points) {
    Vec3 middle;
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
        std::vector<double> along(points.col(k).begin(), points.col(k).end());
        const auto at = [&](std::size_t i) {
            std::nth_element(along.begin(), along.begin() + std::ptrdiff_t(i), along.end());
            return along[i];
        };
        const std::size_t last = along.size() - 1;
        middle[k] = at(last / 2);
        longest = std::max(longest, at(last - last / 20) - at(last / 20));
    }
    return {middle, longest > 0 ? longest : (points.colwise().maxCoeff() - points.colwise().minCoeff()).maxCoeff()};
}

// Returns the indices of the points in lexicographic order, so that equal points are neighbours.
std::vector<Index> sorted(const Points& points) {
    std::vector<Index> order(std::size_t(points.rows()));
    std::iota(order.begin(), order.end(), 0);
    const auto key = [&](Index i) { return std::array{points(i, 0), points(i, 1), points(i, 2)}; };
    std::sort(order.begin(), order.end(), [&](Index i, Index j) { return key(i) < key(j); });
    return order;
}

// Returns whether each point of `from` has a point of `to` at most `upper` away.
Verdict one_way(const Standing& from, const Standing& to, double upper, double seconds) {
    Limit limit(seconds);
    const Points &a = from.points(), &b = to.points();
    if (!from.finite() || !to.finite() || !std::isfinite(upper)) return Verdict::not_checked;
    if (upper < 0) return Verdict::unsound;
    const auto [middle, extent] = bulk_of(b);
    // A cell is slightly wider than `upper`, to absorb rounding errors, and wide enough that most cell indices are
    // exact.
    const double side = std::max({1.001 * upper, 0x1p-40 * extent, std::numeric_limits<double>::min()});
    if (!std::isfinite(side)) return Verdict::not_checked;
    const Grid grid(b, side, middle);
    if (limit.elapsed() > seconds) return Verdict::not_checked;
    Index before = -1;
    for (const Index i : sorted(a)) {
        const bool same = before >= 0 && a.row(i) == a.row(before);
        if (!same && !has_near(grid, b, a.row(i), upper, limit) && !limit.passed()) return Verdict::unsound;
        if (limit.passed()) return Verdict::not_checked;
        before = i;
    }
    return Verdict::holds;
}

}  // namespace

Verdict UpperCheck::of_points(const Shape& source, const Pose& source_pose, const Shape& target,
                              const Pose& target_pose) const {
    const Standing a(source, source_pose), b(target, target_pose);
    const Verdict there = one_way(a, b, upper, seconds);
    return there == Verdict::holds && WATCHED("verify: H takes both directions", quantity == Quantity::symmetric)
               ? one_way(b, a, upper, seconds)
               : there;
}

const char* UpperCheck::words(Verdict verdict) {
    switch (verdict) {
        case Verdict::holds:
            return "accepted: each point has one within the upper bound";
        case Verdict::unsound:
            return "refused: a point has none within the upper bound";
        default:
            return "not checked: it takes too long, or leaves the range of doubles";
    }
}

}  // namespace hausbench
