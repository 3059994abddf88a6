#include "datasets/formats/readers.h"

#include <numeric>

namespace hausbench::readers {
namespace {

// Returns a positive number if the path from a over b to c turns left, as seen from the side to which the normal
// points; a negative number if it turns right.
double turn(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) {
    return (b - a).cross(c - a).dot(normal);
}

}  // namespace

// Ear clipping (Meisters, "Polygons have ears", 1975): cuts off one ear after the other, a corner where the polygon
// turns left and whose triangle contains no other corner. A polygon that crosses itself may have no ear; then the
// second of the remaining corners is cut off. O(n^3) at worst.
std::vector<std::array<std::size_t, 3>> triangulate(const std::vector<Vec3>& corners) {
    const std::size_t n = corners.size();
    std::vector<std::array<std::size_t, 3>> triangles;
    Vec3 normal = Vec3::Zero();
    for (std::size_t i = 1; i + 1 < n; ++i) normal += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);

    std::vector<std::size_t> left(n);
    std::iota(left.begin(), left.end(), std::size_t{0});
    const auto is_ear = [&](std::size_t at) {
        const Vec3& a = corners[left[at]];
        const Vec3& b = corners[left[(at + 1) % left.size()]];
        const Vec3& c = corners[left[(at + 2) % left.size()]];
        if (!(turn(a, b, c, normal) > 0)) return false;
        for (const std::size_t other : left) {
            const Vec3& p = corners[other];
            if (p == a || p == b || p == c) continue;
            if (turn(a, b, p, normal) >= 0 && turn(b, c, p, normal) >= 0 && turn(c, a, p, normal) >= 0) return false;
        }
        return true;
    };
    // Tries the second corner first, so that a convex polygon becomes a fan around its first corner.
    while (left.size() > 3) {
        std::size_t at = 0;
        while (at < left.size() && !is_ear(at)) ++at;
        if (at == left.size()) at = 0;
        const std::size_t tip = (at + 1) % left.size();
        triangles.push_back({left[at], left[tip], left[(at + 2) % left.size()]});
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(tip));
    }
    triangles.push_back({left[0], left[1], left[2]});
    return triangles;
}

}  // namespace hausbench::readers
