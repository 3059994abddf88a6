// Distances from points of A to the triangles of B near them, and which of these are within the threshold
// (offset_cover.h). Compiled once for each instruction set, so include it after hwy/foreach_target.h.
#include "algorithms/kernel/triangle_frames-inl.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/cover/offset_cover.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#if defined(HAUSBENCH_OFFSET_COVER_MEASURE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HAUSBENCH_OFFSET_COVER_MEASURE_INL
#undef HAUSBENCH_OFFSET_COVER_MEASURE_INL
#else
#define HAUSBENCH_OFFSET_COVER_MEASURE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace hausbench::cover::HWY_NAMESPACE {

using namespace hausbench::HWY_NAMESPACE;
namespace {

// Number of sample points whose distances to one triangle of B are computed at once: half of them on one edge of a
// polygon, half on another.
template <class T> inline constexpr std::size_t samples = sizeof(T) == 4 ? 16 : 8;

// The triangles of B that are tried for a polygon, and their limits: all of OffsetCover::near, or the few kept by
// keep_few().
template <class T> struct Candidates {
    const NearTriangles<T>* frames;
    const T* limit;

    std::size_t count() const { return frames->count(); }
    const T* row(std::size_t i) const { return frames->row(i); }
};

// Sets `within` to the triangles certainly within the threshold of a point: their squared distance, squares(k) for those
// from k on, is at most their limit. Collects the bits of each word in a register: a word that was stored in pieces
// would have to reach memory before it can be read.
template <class T, class Squares>
HWY_INLINE void compare(const Candidates<T>& candidates, const Squares& squares, NearSet& within) {
    const FrameLanes<T> d;
    const std::size_t count = candidates.count();
    std::size_t k = 0;
    for (std::uint64_t& word : within.word) {
        std::uint64_t bits = 0;
        for (const std::size_t end = std::min(k + 64, count); k < end; k += hn::Lanes(d)) {
            const auto near = hn::Le(squares(k), hn::LoadU(d, candidates.limit + k));
            bits |= std::uint64_t{mask_bits<T>(near)} << (k % 64);
        }
        word = bits;  // without unused lanes, because their limits are -1
    }
}

template <class T> HWY_INLINE void compare_row(OffsetCover<T>& c, const Candidates<T>& candidates, std::size_t point) {
    const auto squares = [from = c.squares(point)](std::size_t k)
                             HWY_ATTR { return hn::LoadU(FrameLanes<T>(), from + k); };
    compare<T>(candidates, squares, c.within[point]);
}

template <class T>
void measure_row(OffsetCover<T>& c, const Candidates<T>& candidates, std::size_t point, T x, T y, T z) {
    const FrameLanes<T> d;
    const auto px = hn::Set(d, x), py = hn::Set(d, y), pz = hn::Set(d, z);
    T* const to = c.squares(point);
    const auto squares = [&](std::size_t k) HWY_ATTR {
        const auto load = [&](std::size_t i) HWY_ATTR { return hn::LoadU(d, candidates.row(i) + k); };
        const auto squared = squared_in_frames<T>(load, px, py, pz);
        hn::StoreU(squared, d, to + k);
        return squared;
    };
    compare<T>(candidates, squares, c.within[point]);
    c.distances += candidates.count();
}

template <class T> struct SamplePoints { T x[samples<T>], y[samples<T>], z[samples<T>]; };

// The distances from the sample points to one triangle of B.
template <class T> struct Sampled {
    T square[samples<T>];
    unsigned within;  // bit i: point i is certainly within the threshold of the triangle
};
template <class T>
void measure_samples(OffsetCover<T>& c, const Candidates<T>& candidates, std::size_t k, const SamplePoints<T>& points,
                     Sampled<T>& sampled) {
    const FrameLanes<T> d;
    const auto set = [&](std::size_t i) HWY_ATTR { return hn::Set(d, candidates.row(i)[k]); };
    const auto limit = hn::Set(d, candidates.limit[k]);
    unsigned within = 0;
    for (std::size_t i = 0; i < samples<T>; i += hn::Lanes(d)) {
        const auto squared = squared_in_frames<T>(set, hn::LoadU(d, points.x + i), hn::LoadU(d, points.y + i),
                                                  hn::LoadU(d, points.z + i));
        hn::StoreU(squared, d, sampled.square + i);
        within |= mask_bits<T>(hn::Le(squared, limit)) << i;
    }
    sampled.within = within;
    c.distances += samples<T>;
}

template <class T> void roots(const T (&squares)[samples<T>], T (&distances)[samples<T>]) {
    const FrameLanes<T> d;
    for (std::size_t i = 0; i < samples<T>; i += hn::Lanes(d))
        hn::StoreU(hn::Sqrt(hn::LoadU(d, squares + i)), d, distances + i);
}

// Returns an upper bound on the exact distance to triangle k, given the computed squared distance.
template <class T> double at_most(const OffsetCover<T>& c, const NearTriangles<T>& frames, T square, std::size_t k) {
    return std::sqrt(static_cast<double>(square)) * (1 + 0x1p-50) + c.error(frames, k);
}

struct Covering {
    std::size_t triangle = no_triangle;
    double upper = std::numeric_limits<double>::infinity();
};

// Finds a triangle of B that is within the threshold of all measured points, given by their rows, and an upper bound on
// its distance to any of them. If there are several, takes the one with the least bound, or the first with a bound of at
// most early_out or `enough`.
template <class T>
Covering covering_triangle(OffsetCover<T>& c, const NearTriangles<T>& frames, std::span<const std::size_t> rows,
                           double enough) {
    NearSet common = c.within[rows[0]];
    for (const std::size_t row :
         rows.subspan(WATCHED_ELSE("offset cover: all corners are near the triangle that settles", 1, 2)))
        common = common & c.within[row];
    Covering best;
    enough = std::max(enough, c.early_out);
    for (std::size_t w = 0; w < NearSet::words; ++w) {
        for (std::uint64_t rest = common.word[w]; rest != 0; rest &= rest - 1) {
            const std::size_t k = 64 * w + static_cast<std::size_t>(std::countr_zero(rest));
            T most = 0;
            for (const std::size_t row : WATCHED_ELSE(
                     "offset cover: the bound of a triangle that settles holds for all corners", rows, rows.first(1)))
                most = std::max(most, c.squares(row)[k]);
            const double bound = at_most(c, frames, most, k);
            if (bound < best.upper) best = {k, bound};
            if (best.upper <= enough) return best;
        }
    }
    return best;
}

}  // namespace
}  // namespace hausbench::cover::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
