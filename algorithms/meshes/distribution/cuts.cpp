#include "algorithms/meshes/distribution/cuts.h"

#include "algorithms/kernel/point_triangle.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hausbench::distribution {
namespace {

// A change by less than this part of an edge is not worth a cut.
constexpr double least_change = 1e-5;

// A cut closer to the end of an edge than this part of it is moved, so that no part is much thinner than the piece.
constexpr double near_end = 0.02;

// Two triangles count as parallel if the cosine of the angle between the directions to them is above this.
constexpr double nearly_parallel = 0.9;

// Cuts a piece where an affine function, given at the corners, is 0.
Parts cut_at_zero(const Piece& piece, const CornerValues& f, double magnitude) {
    // The corner whose sign is alone.
    std::size_t alone = 3;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
        if ((f[k] > 0 && f[l] <= 0 && f[m] <= 0) || (f[k] <= 0 && f[l] > 0 && f[m] > 0)) alone = k;
    }
    if (alone == 3) return {};
    const std::size_t b = (alone + 1) % 3, c = (alone + 2) % 3;
    double tb = f[alone] / (f[alone] - f[b]), tc = f[alone] / (f[alone] - f[c]);
    if (tb < near_end && tc < near_end) return {};
    const bool whole_b = tb > 1 - near_end, whole_c = tc > 1 - near_end;
    if (whole_b && whole_c) return {};
    tb = whole_b ? 1 : std::max(tb, near_end);
    tc = whole_c ? 1 : std::max(tc, near_end);
    const Vec3 at = piece.corners[alone], pb = piece.corners[b], pc = piece.corners[c];
    const double longest = std::max((pb - at).cwiseAbs().maxCoeff(), (pc - at).cwiseAbs().maxCoeff());
    const Vec3 q = whole_b ? pb : point_of_edge(at, pb, tb), r = whole_c ? pc : point_of_edge(at, pc, tc);
    Piece part = piece;
    part.level = piece.level +
                 WATCHED("distribution: the level of the parts of a cut", level_of_point_of_edge(longest, magnitude));
    part.cuts = piece.cuts + 2;
    Parts parts;
    const auto add = [&](const Vec3& one, const Vec3& two, const Vec3& three, double share) {
        part.corners = {one, two, three};
        part.share = piece.share * share;
        parts.pieces[parts.count++] = part;
    };
    add(at, q, r, tb * tc);
    if (whole_b) {
        add(r, pb, pc, 1 - tc);
    } else {
        add(q, pb, pc, 1 - tb);
        if (!whole_c) add(q, pc, r, tb * (1 - tc));
    }
    return parts;
}

// Cuts where the distances to S and T, whose squares are given at the corners, seem to be equal.
Parts cut_between(const Piece& piece, const Triangle& s, const Triangle& t, const CornerValues& to_s,
                  const CornerValues& to_t, double magnitude) {
    CornerValues f;
    if (const std::optional<Bisector> bisector = bisector_of(s, t)) {
        for (std::size_t k = 0; k < 3; ++k) f[k] = bisector->side(piece.corners[k]);
        if (const Parts parts = cut_at_zero(piece, f, magnitude); parts.count > 0) return parts;
    }
    // For triangles in one plane, the signed roots of the differences of squares are affine; for bisectors of planes,
    // the differences of distances are.
    for (std::size_t k = 0; k < 3; ++k) f[k] = to_s[k] - to_t[k];
    const auto low = static_cast<std::size_t>(std::min_element(f.begin(), f.end()) - f.begin()),
               high = static_cast<std::size_t>(std::max_element(f.begin(), f.end()) - f.begin());
    const Vec3 x = closest_point(piece.corners[low], s).point - piece.corners[low],
               y = closest_point(piece.corners[high], t).point - piece.corners[high];
    const double lengths = std::sqrt(squared_length(x) * squared_length(y));
    const bool flat = lengths == 0 || dot(x, y) > nearly_parallel * lengths;
    for (std::size_t k = 0; k < 3; ++k) {
        f[k] = flat ? std::copysign(std::sqrt(std::abs(f[k])), f[k]) : std::sqrt(to_s[k]) - std::sqrt(to_t[k]);
    }
    return cut_at_zero(piece, f, magnitude);
}

}  // namespace

std::array<Piece, 2> halves(const Piece& piece) {
    std::size_t a = 0;
    double longest = -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const double length = squared_length(piece.corners[(k + 1) % 3] - piece.corners[k]);
        if (length > longest) {
            longest = length;
            a = k;
        }
    }
    const std::size_t b = (a + 1) % 3;
    Piece first = piece, second = piece;
    const Vec3 middle = 0.5 * (piece.corners[a] + piece.corners[b]);
    first.corners[a] = second.corners[b] = middle;
    first.share = second.share = 0.5 * piece.share;
    first.level = second.level = piece.level + WATCHED("distribution: the level of halves", 1);
    first.cuts = second.cuts = piece.cuts + 1;
    return {first, second};
}

Parts cut_at_change(const Piece& piece, std::span<const NearbyTriangle> near, std::span<const std::uint16_t> kept,
                    std::span<const CornerValues> squares, double magnitude) {
    const double size = std::sqrt(squared_length(piece.corners[0] - piece.corners[1]));
    const Triangle& s = near[kept[0]].corners;
    double best = 0;
    std::size_t other = 0;
    for (std::size_t i = 1; i < kept.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            const double gain = std::sqrt(squares[0][k]) - std::sqrt(squares[i][k]);
            if (gain > best) {
                best = gain;
                other = i;
            }
        }
    }
    if (best > least_change * size)
        return cut_between(piece, s, near[kept[other]].corners, squares[0], squares[other], magnitude);
    const Vec3 n = (s.b - s.a).cross(s.c - s.a).normalized();
    CornerValues f;
    for (std::size_t k = 0; k < 3; ++k) f[k] = dot(n, piece.corners[k] - s.a);
    const auto [least, most] = std::minmax({f[0], f[1], f[2]});
    if (least < -least_change * size && most > least_change * size) return cut_at_zero(piece, f, magnitude);
    return {};
}

}  // namespace hausbench::distribution
