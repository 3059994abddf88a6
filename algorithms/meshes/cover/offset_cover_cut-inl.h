// The part of Engine (offset_cover_engine-inl.h) that cuts a polygon in two when peeling makes no progress (step 4 in
// offset_cover.h). Compiled once for each instruction set, so include it after hwy/foreach_target.h.
#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/cover/offset_cover_engine-inl.h"

#if defined(HAUSBENCH_OFFSET_COVER_CUT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HAUSBENCH_OFFSET_COVER_CUT_INL
#undef HAUSBENCH_OFFSET_COVER_CUT_INL
#else
#define HAUSBENCH_OFFSET_COVER_CUT_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace hausbench::cover::HWY_NAMESPACE {

using namespace hausbench::HWY_NAMESPACE;
namespace {

// Upper bound on the rounding error of the mean of up to 16 corners, as a multiple of the unit roundoff u. As
// |coordinate| <= 1, every partial sum of one coordinate is at most 16, so each of the 15 sums errs by at most 16u. The
// division by 16 reduces this to u for each sum, 15u in total, and adds u for its own rounding. So each coordinate errs
// by at most 16u, and the point by sqrt(3) * 16u < 28u. The mean of fewer corners errs less.
constexpr double slack_of_mean = 28;

// Sets centre_ to the mean of the corners, radius_ to an upper bound on the distance from there to any point of the
// polygon, and slack_ to the largest slack (rounding error) of a corner.
template <class T> void Engine<T>::find_centre() {
    std::array<T, 3> sum{};
    for (std::size_t i = 0; i < piece_.count; ++i) {
        sum[0] += piece_.x[i];
        sum[1] += piece_.y[i];
        sum[2] += piece_.z[i];
    }
    for (std::size_t k = 0; k < 3; ++k) centre_[k] = sum[k] / static_cast<T>(piece_.count);
    double most = 0;
    slack_ = 0;
    for (std::size_t i = 0; i < piece_.count; ++i) {
        const double x = static_cast<double>(piece_.x[i]) - static_cast<double>(centre_[0]),
                     y = static_cast<double>(piece_.y[i]) - static_cast<double>(centre_[1]),
                     z = static_cast<double>(piece_.z[i]) - static_cast<double>(centre_[2]);
        most = std::max(most, (x * x + y * y) + z * z);
        slack_ = std::max(slack_, piece_.slack[i]);
    }
    radius_ = std::sqrt(most) * (1 + 0x1p-50);
}

// Decides what to do with a polygon when peeling makes no progress, using triangle k of B, the one nearest to the
// centre of the polygon. Returns
// - `covered` if the whole polygon is within the threshold of triangle k. In double precision, a polygon that must not
//   be cut also counts as covered, with the bound from triangle k.
// - `lost` in single precision, if the polygon must not be cut or its centre is beyond the threshold.
// - `cut` otherwise.
template <class T> typename Engine<T>::Centre Engine<T>::look_at_centre() {
    find_centre();
    measure_row(c_, all_, centre_row, centre_[0], centre_[1], centre_[2]);
    std::size_t k = nearest(centre_row);
    const auto distance = [&] { return at_most(c_.squares(centre_row)[k], k); };
    if (exact && host_->promising(distance())) {
        ask(centre_[0], centre_[1], centre_[2],
            WATCHED("offset cover: slack of the corners whose mean it is", slack_) +
                WATCHED("offset cover: slack of the mean of corners", slack_of_mean),
            k);
        measure_row(c_, all_, centre_row, centre_[0], centre_[1], centre_[2]);
        k = nearest(centre_row);
    }
    // Do not cut the polygon if it is hardly larger than the rounding error, if too many polygons are on the stack, if
    // it would get too many corners, or if its slack would become too large. By slack_of_cut(), a cut adds at most
    // 1.75 + 2.01 * (the sum of the coordinate differences along an edge, at most 3 * 2), which is less than 14.
    const bool tiny = radius_ < 4 * c_.error(*all_.frames, k) || c_.stack.size() > 200 ||
                      WATCHED("offset cover: most slack, a cut in two", slack_ + 14 > OffsetCover<T>::most_slack) ||
                      piece_.count + 2 > most_polygon_corners;
    // The polygon gets the bound from its corners. The bound from its centre (distance plus radius) only tells whether
    // triangle k is near the whole polygon. In exact arithmetic the bound from the corners is never the larger one, but
    // rounding may make it so. So both must be within the threshold.
    const double by_corners = at_most(largest_square(k), k);
    if ((distance() + radius_ <= c_.threshold && by_corners <= c_.threshold) || (exact && tiny)) {
        covered_by(k, by_corners);
        return Centre::covered;
    }
    if (!exact && (tiny || distance() > c_.threshold)) return Centre::lost;
    return Centre::cut;
}

// Chooses a plane through an edge of triangle k and perpendicular to the triangle, to cut the polygon with. Takes the
// one of the three planes that cuts deepest into the polygon, and sets `side` to the signed distances of the corners of
// the polygon from it. Returns false if even this plane only grazes the polygon: if the corners on one side are within
// twice the threshold and within a twentieth of the radius of the plane. Corners farther beyond it than the threshold
// are not near triangle k, so a cut along the plane is needed even if the part beyond is small.
template <class T> bool Engine<T>::along_prism(std::size_t k, T (&side)[most_polygon_corners]) const {
    const auto row = [&](std::size_t i) { return all_.row(i)[k]; };
    T sides[3][most_polygon_corners], best = 0;
    std::size_t chosen = 3;
    for (std::size_t i = 0; i < piece_.count; ++i) {
        const auto along = [&](std::size_t axis) {
            return ((row(3 * axis) * piece_.x[i] + row(3 * axis + 1) * piece_.y[i]) + row(3 * axis + 2) * piece_.z[i]) +
                   row(frame_row::shift + axis);
        };
        const T x = along(0), y = along(1), from_b = x - row(frame_row::length);
        sides[0][i] = y;
        sides[1][i] = x * row(frame_row::ac + 1) - y * row(frame_row::ac);
        sides[2][i] = y * row(frame_row::bc) - from_b * row(frame_row::bc + 1);
    }
    for (std::size_t s = 0; s < 3; ++s) {
        const auto [low, high] = std::minmax_element(sides[s], sides[s] + piece_.count);
        const T depth = std::min(-*low, *high);
        if (depth > best) {
            best = depth;
            chosen = s;
        }
    }
    if (chosen == 3) return false;
    if (!(static_cast<double>(best) >
          std::min(0.05 * radius_,
                   WATCHED_ELSE("cover: a plane that grazes a polygon by more than the threshold does not cut it",
                                2 * c_.threshold, 0.05 * radius_))))
        return false;
    std::copy_n(sides[chosen], piece_.count, side);
    return true;
}

// Chooses a plane perpendicular to the longest edge of the polygon, to cut the polygon with. Places it where the edge
// is estimated to be equally far from the two triangles nearest to its ends, or at the midpoint if both ends have the
// same nearest triangle. Sets `side` to numbers proportional to the signed distances of the corners from the plane.
template <class T> void Engine<T>::across_longest_edge(T (&side)[most_polygon_corners]) {
    std::size_t a = 0;
    T longest = -1;
    for (std::size_t i = 0; i < piece_.count; ++i) {
        const std::size_t j = next(i);
        const T x = piece_.x[j] - piece_.x[i], y = piece_.y[j] - piece_.y[i], z = piece_.z[j] - piece_.z[i];
        const T squared = (x * x + y * y) + z * z;
        if (squared > longest) {
            longest = squared;
            a = i;
        }
    }
    const std::size_t b = next(a), near_a = nearest(row_[a]), near_b = nearest(row_[b]);
    T t = T(0.5);
    if (near_a != near_b) {
        const T at_a = square(a, near_b) - square(a, near_a), at_b = square(b, near_a) - square(b, near_b);
        if (at_a + at_b > 0) t = std::clamp(at_a / (at_a + at_b), T(0.1), T(0.9));
    }
    const T ex = piece_.x[b] - piece_.x[a], ey = piece_.y[b] - piece_.y[a], ez = piece_.z[b] - piece_.z[a];
    const T mx = piece_.x[a] + t * ex, my = piece_.y[a] + t * ey, mz = piece_.z[a] + t * ez;
    for (std::size_t i = 0; i < piece_.count; ++i)
        side[i] = ((piece_.x[i] - mx) * ex + (piece_.y[i] - my) * ey) + (piece_.z[i] - mz) * ez;
    side[a] = -t * longest;  // so that a and b are on different sides, whatever rounding did
    side[b] = (1 - t) * longest;
}

// Cuts the polygon in two: one part has the corners where `side` is positive and is handled next; the other part goes
// to the stack. Any cut between two points of the boundary is valid, so it does no harm if rounding makes a sign wrong,
// or if the positive corners form several runs, of which only one is taken.
template <class T> void Engine<T>::cut() {
    ++c_.cuts;
    T side[most_polygon_corners];
    if (!along_prism(nearest(centre_row), side)) across_longest_edge(side);
    std::size_t first = 0;  // the first corner of a run on the positive side
    while (!(side[first] > 0 && side[last(first)] <= 0)) ++first;
    std::size_t end = first;
    while (side[next(end)] > 0) end = next(end);
    const std::size_t before = last(first), after = next(end);
    struct Corner {
        T x, y, z;
        float slack;
        std::size_t row;  // in c_.squared
    };
    const auto corner = [&](std::size_t i) -> Corner {
        return {piece_.x[i], piece_.y[i], piece_.z[i], piece_.slack[i], row_[i]};
    };
    // Returns the point between two corners at which `side` changes sign. If `side` is 0 at corner `zero`, which is one
    // of the two, returns this corner.
    const auto crossing = [&](std::size_t from, std::size_t to, std::size_t zero, CutPoint& place) -> Corner {
        place = CutPoint::corner(zero);
        if (side[zero] == 0) return corner(zero);
        const T t = side[from] / (side[from] - side[to]);
        place = CutPoint::along(from, static_cast<double>(t));
        const Corner at{piece_.x[from] + t * (piece_.x[to] - piece_.x[from]),
                        piece_.y[from] + t * (piece_.y[to] - piece_.y[from]),
                        piece_.z[from] + t * (piece_.z[to] - piece_.z[from]), slack_of_cut(from, to, t), take_row()};
        if (WATCHED("offset cover: new corners of a cut are measured", true))
            measure_row(c_, all_, at.row, at.x, at.y, at.z);
        return at;
    };
    CutPoint start = CutPoint::corner(0), stop = start;
    const Corner p = crossing(before, first, before, start), q = crossing(end, after, after, stop);
    Polygon<T> high, low;
    std::size_t rows[most_polygon_corners];
    const auto add = [&](Polygon<T>& part, const Corner& at) {
        rows[part.count] = at.row;
        part.add(at.x, at.y, at.z, at.slack);
    };
    add(low, q);
    for (std::size_t i = side[after] == 0 ? next(after) : after; i != first && (i != before || side[before] != 0);
         i = next(i))
        add(low, corner(i));
    add(low, p);
    add(high, p);
    for (std::size_t i = first; i != after; i = next(i)) add(high, corner(i));
    add(high, q);
    if (c_.proof) c_.proof->cut(start, stop);
    if (WATCHED("offset cover: the second part of a cut", true)) c_.stack.push_back(low);
    begin(high, rows);  // `rows` are now the rows of `high`
}

}  // namespace
}  // namespace hausbench::cover::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
