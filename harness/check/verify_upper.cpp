#include "check/verify_upper.h"

#include <CGAL/Interval_nt.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace hausbench {
namespace {

using Interval = CGAL::Interval_nt<false>;

// Points by the cell of a grid that they are in.
class Grid {
public:
    Grid(const Points& points, double side) : side_(side), origin_(points.colwise().minCoeff()) {
        for (Index i = 0; i < points.rows(); ++i) cells_[cell_of(points.row(i))].push_back(i);
    }

    // Calls visit(i) for the points in the cell of p, then for those in the 26 around it, until it returns true.
    template <class Visit> void near(const Vec3& p, Visit visit) const {
        const Cell own = cell_of(p);
        if (any_in(own, visit)) return;
        for (int k = 0; k < 27; ++k) {
            const Cell other = {own[0] + k % 3 - 1, own[1] + k / 3 % 3 - 1, own[2] + k / 9 - 1};
            if (k != 13 && any_in(other, visit)) return;
        }
    }

private:
    using Cell = std::array<std::int64_t, 3>;
    struct Hash {
        std::size_t operator()(const Cell& cell) const {
            std::uint64_t sum = 0;
            for (const std::int64_t x : cell) sum = (sum ^ std::uint64_t(x)) * 0x9E3779B97F4A7C15u, sum ^= sum >> 29;
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
        const auto found = cells_.find(cell);
        return found != cells_.end() && std::any_of(found->second.begin(), found->second.end(), visit);
    }

    double side_;
    Vec3 origin_;
    std::unordered_map<Cell, std::vector<Index>, Hash> cells_;
};

bool is_within(const Vec3& p, const Vec3& q, double upper) {
    return squared_distance(p, {q}) <= Rational(upper) * Rational(upper);
}

// Whether intervals prove that q is at most `upper` from p (certain), or leave it open (doubtful). Upward rounding must be on.
struct Judged {
    bool certain, doubtful;
};

Judged judge(const Vec3& p, const Vec3& q, double upper) {
    Interval sum(0);
    for (int k = 0; k < 3; ++k) sum += CGAL::square(Interval(p[k]) - Interval(q[k]));
    const Interval most = CGAL::square(Interval(upper));
    const bool certain = sum.sup() <= most.inf();
    return {certain, !certain && !(sum.inf() > most.sup())};
}

bool has_near(const Grid& grid, const Points& to, const Vec3& p, double upper) {
    std::vector<Index> doubtful;
    bool found = false;
    const auto visit = [&](Index i) {
        const Judged judged = judge(p, to.row(i), upper);
        if (judged.doubtful) doubtful.push_back(i);
        return found = judged.certain;
    };
    const auto within = [&](Index i) { return is_within(p, to.row(i), upper); };
    const auto settled = [&] { return found || std::any_of(doubtful.begin(), doubtful.end(), within); };
    {
        CGAL::Protect_FPU_rounding<true> upward;
        grid.near(p, visit);
    }
    if (settled()) return true;
    // A cell may be missed by rounding: nothing is refuted without a look at every point.
    doubtful.clear();
    {
        CGAL::Protect_FPU_rounding<true> upward;
        for (Index i = 0; i < to.rows() && !visit(i);) ++i;
    }
    return settled();
}

Verdict one_way(const Standing& from, const Standing& to, double upper, double seconds) {
    const auto begin = std::chrono::steady_clock::now();
    const Points &a = from.points(), &b = to.points();
    const double extent = (b.colwise().maxCoeff() - b.colwise().minCoeff()).maxCoeff();
    // A little wider than `upper`, for the rounding of cells, and not so narrow that their numbers would be rounded.
    const double side = std::max({1.001 * upper, 0x1p-40 * extent, std::numeric_limits<double>::min()});
    if (!from.finite() || !to.finite() || !std::isfinite(side)) return Verdict::not_checked;
    const Grid grid(b, side);
    for (Index i = 0; i < a.rows(); ++i) {
        if (i % 16 == 0 && std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() > seconds)
            return Verdict::not_checked;
        if (!has_near(grid, b, a.row(i), upper)) return Verdict::unsound;
    }
    return Verdict::holds;
}

}  // namespace

Verdict UpperCheck::of_points(const Shape& source, const Pose& source_pose, const Shape& target,
                              const Pose& target_pose) const {
    const Standing a(source, source_pose), b(target, target_pose);
    const Verdict there = one_way(a, b, upper, seconds);
    return there == Verdict::holds && quantity == Quantity::symmetric ? one_way(b, a, upper, seconds) : there;
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
