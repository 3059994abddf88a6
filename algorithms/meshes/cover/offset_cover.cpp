#include "algorithms/meshes/cover/offset_cover.h"

#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/meshes/cover/offset_cover.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include "algorithms/meshes/cover/offset_cover_cut-inl.h"
#include "algorithms/meshes/cover/offset_cover_engine-inl.h"
#include "algorithms/meshes/cover/offset_cover_peel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hausbench::cover::HWY_NAMESPACE {

using namespace hausbench::HWY_NAMESPACE;
namespace {

void shared_rows(OffsetCover<float>& cover, const LocalPoints<float>& points) {
    const Candidates<float> all{&cover.near, cover.limit.data()};
    for (std::size_t i = 0; i < points.count; ++i) measure_row(cover, all, i, points.x[i], points.y[i], points.z[i]);
}

CoverResult shared_piece(OffsetCover<float>& cover, const Polygon<float>& piece,
                         const std::array<std::size_t, 3>& points, std::size_t most_work) {
    // Most pieces are covered by a single triangle of B, which is found in less time than it takes to set up an engine.
    if (const Covering covering = covering_triangle<float>(cover, cover.near, points, 0);
        covering.triangle != no_triangle) {
        ++cover.tests;
        if (cover.proof) cover.proof->one(cover.near.triangle[covering.triangle]);
        return {true, covering.upper};
    }
    return Engine<float>(cover, nullptr, nullptr, most_work).run(piece, points.data());
}

CoverResult sure_piece(OffsetCover<double>& cover, const Polygon<double>& piece, Host& host,
                       const TriangleMesh& target) {
    return Engine<double>(cover, &host, &target, std::numeric_limits<std::size_t>::max()).run(piece, nullptr);
}

}  // namespace
}  // namespace hausbench::cover::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hausbench::cover {

HWY_EXPORT(shared_rows);
HWY_EXPORT(shared_piece);
HWY_EXPORT(sure_piece);

template <class T> void OffsetCover<T>::set_threshold(double tau) {
    threshold = tau;
    const std::size_t count = near.count(), padded = (count + frames_width - 1) / frames_width * frames_width;
    limit.resize(NearTriangles<T>::stride);
    // The root of a limit plus error(k) must be at most tau. Let u = 2^-53 and v be the unit roundoff of T. The difference
    // and its square may be too large by a factor of (1 + u)^3; the factor 1 - 4v, its product and the conversion to T
    // make this (1 + u)^4 (1 + v) (1 - 4v) < 1 for float and (1 + u)^4 (1 - 4u) < 1 for double. If a square underflows,
    // frame_underflow covers what it loses. So no double needs the factor 1 - 2^-50; it stays because without it the last
    // bits of answers would change. No bound on a distance depends on limits: they only tell which triangles cover a
    // polygon, whose bound is then at_most().
    for (std::size_t k = 0; k < padded; ++k) {
        const double allowed = std::max(tau * (1 - 0x1p-50) - error(near, k), 0.0);
        limit[k] = allowed > 0
                       ? static_cast<T>(allowed * allowed *
                                        (1 - WATCHED("offset cover: rounding of a limit", 4 * frame_roundoff<T>)))
                       : T(-1);
    }
    std::fill(limit.begin() + static_cast<std::ptrdiff_t>(count), limit.begin() + static_cast<std::ptrdiff_t>(padded),
              T(-1));
}
template <class T> void OffsetCover<T>::make_rows(std::size_t points) {
    if (squared.size() < points * NearTriangles<T>::stride) squared.resize(points * NearTriangles<T>::stride);
    if (within.size() < points) within.resize(points);
}
template struct OffsetCover<float>;
template struct OffsetCover<double>;

void measure_shared(OffsetCover<float>& cover, const LocalPoints<float>& points) {
    HWY_DYNAMIC_DISPATCH(shared_rows)(cover, points);
}
CoverResult cover_shared(OffsetCover<float>& cover, const Polygon<float>& piece,
                         const std::array<std::size_t, 3>& points, std::size_t most_work) {
    return HWY_DYNAMIC_DISPATCH(shared_piece)(cover, piece, points, most_work);
}
std::size_t may_cover(const OffsetCover<float>& cover, const std::array<std::size_t, 3>& points) {
    const float* const corners[3] = {cover.squares(points[0]), cover.squares(points[1]), cover.squares(points[2])};
    std::size_t best = no_triangle;
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < cover.near.count(); ++k) {
        const float most = std::max({corners[0][k], corners[1][k], corners[2][k]});
        if (most >= least) continue;
        least = most;
        best = k;
    }
    if (best == no_triangle || std::sqrt(static_cast<double>(least)) > cover.threshold + cover.error(cover.near, best))
        return no_triangle;
    return best;
}
CoverResult cover_surely(OffsetCover<double>& cover, const Polygon<double>& piece, Host& host,
                         const TriangleMesh& target) {
    cover.make_rows(most_shared_points + most_polygon_corners + 4);
    return HWY_DYNAMIC_DISPATCH(sure_piece)(cover, piece, host, target);
}

}  // namespace hausbench::cover
#endif
