// Peeling: cuts off a part of a polygon of A that is within the threshold of one triangle of B (step 2 in
// offset_cover.h). Compiled once for each instruction set, so include it after hwy/foreach_target.h.
#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/cover/offset_cover_engine-inl.h"

#if defined(HAUSBENCH_OFFSET_COVER_PEEL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HAUSBENCH_OFFSET_COVER_PEEL_INL
#undef HAUSBENCH_OFFSET_COVER_PEEL_INL
#else
#define HAUSBENCH_OFFSET_COVER_PEEL_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace hausbench::cover::HWY_NAMESPACE {

using namespace hausbench::HWY_NAMESPACE;
namespace {

constexpr std::size_t most_second_triangles = 4;  // number of triangles that by_two() tries as the second of two
constexpr std::size_t crowded = 12;               // a polygon with this many corners is cut in two instead
// After this many peels, a polygon is cut in two instead: along a short edge each peel may remove next to nothing.
constexpr int most_peels = 8;

template <class T> typename Engine<T>::Run Engine<T>::longest_run() const {
    Run best;
    for (std::size_t begin = 0; begin < piece_.count; ++begin) {
        NearSet common = within(begin);
        std::size_t length = 1;
        for (std::size_t i = next(begin); length < piece_.count; i = next(i), ++length) {
            const NearSet longer = common & within(i);
            if (longer.empty()) break;
            common = longer;
        }
        if (length > best.length) best = {begin, length, common};
    }
    return best;
}

// Estimates how much of two edges is within the threshold of each triangle of B: the sum of two fractions, from 0 to 2.
// `corners` are the ends of the first edge, then of the second; the first end of each is within the threshold. The
// distance to a triangle is convex along an edge, so it is at most the linear interpolation between the ends, and the
// estimate is never too large.
template <class T>
void Engine<T>::estimate_exits(const Run& run, const std::size_t (&corners)[4],
                               T (&estimate)[NearTriangles<T>::most_triangles]) {
    using D = FrameLanes<T>;
    const D d;
    const auto one = hn::Set(d, T(1)), zero = hn::Zero(d);
    for (std::size_t k = 0; k < all_.count(); k += hn::Lanes(d)) {
        if ((run.common.word[k / 64] >> (k % 64) & ((std::uint64_t{1} << hn::Lanes(d)) - 1)) == 0) continue;
        const auto limit = hn::Sqrt(hn::Max(hn::LoadU(d, all_.limit + k), zero));
        auto sum = zero;
        for (std::size_t side = 0; side < 2; ++side) {
            const auto near = hn::Sqrt(hn::LoadU(d, c_.squares(row_[corners[2 * side]]) + k));
            const auto far = hn::Sqrt(hn::LoadU(d, c_.squares(row_[corners[2 * side + 1]]) + k));
            const auto t = hn::Min(hn::Max(hn::Div(hn::Sub(limit, near), hn::Sub(far, near)), zero), one);
            sum = hn::Add(sum, hn::IfThenElse(hn::Gt(far, near), t, one));
        }
        hn::StoreU(sum, d, estimate + k);
    }
}

// Chooses up to tried_triangles of the triangles of B that are near all corners of the run: those with the best
// estimates for the two adjoining edges. Returns their number.
template <class T> std::size_t Engine<T>::choose(const Run& run, std::array<Tried, tried_triangles>& tried) {
    std::size_t count = 0;
    T estimate[NearTriangles<T>::most_triangles];
    const bool more = run.common.size() > tried.size();
    const std::size_t end = end_of(run);
    if (more) estimate_exits(run, {run.begin, last(run.begin), end, next(end)}, estimate);
    run.common.for_each([&](std::size_t k) {
        if (count < tried.size()) {
            tried[count].k = k;
            tried[count++].estimate = more ? estimate[k] : T(0);
            return;
        }
        auto worst = std::min_element(tried.begin(), tried.end(),
                                      [](const Tried& x, const Tried& y) { return x.estimate < y.estimate; });
        if (estimate[k] > worst->estimate) {
            worst->k = k;
            worst->estimate = estimate[k];
        }
    });
    return count;
}

// Sets the sample points of one edge (side 0: before the run of corners, 1: after it), evenly spaced from fraction
// `low` to `high` of the edge. The last sample is at `high`; none is at `low`.
template <class T>
void Engine<T>::sample_edge(std::size_t side, std::size_t from, std::size_t to, T low, T high,
                            SamplePoints<T>& points) const {
    for (std::size_t i = 0; i < half; ++i) {
        const T t = low + (high - low) * (static_cast<T>(i + 1) / static_cast<T>(half));
        points.x[side * half + i] = piece_.x[from] + t * (piece_.x[to] - piece_.x[from]);
        points.y[side * half + i] = piece_.y[from] + t * (piece_.y[to] - piece_.y[from]);
        points.z[side * half + i] = piece_.z[from] + t * (piece_.z[to] - piece_.z[from]);
    }
}

template <class T> void Engine<T>::sample_edges(const Run& run, SamplePoints<T>& points) const {
    const std::size_t end = end_of(run);
    sample_edge(0, run.begin, last(run.begin), T(0), T(1), points);
    sample_edge(1, end, next(end), T(0), T(1), points);
}

// Looks for two triangles of B that cover the polygon together. The first must be near (within the threshold of) all
// corners of the run, the second near all other corners, and both near a common sample point on each of the two edges
// between. A cut from one of these samples to the other leaves one part for each triangle. Returns whether it found
// such a pair.
template <class T>
bool Engine<T>::by_two(const Run& run, std::span<const Tried> tried, const SamplePoints<T>& points, Exits& out) {
    const std::size_t end = end_of(run);
    NearSet others = within(next(end));
    for (std::size_t i = next(end); i != run.begin; i = next(i)) others = others & within(i);
    std::size_t looked = 0;
    others.for_each([&](std::size_t k) {
        if (out.second != no_triangle || ++looked > most_second_triangles) return;
        Sampled<T> second;
        measure_samples(c_, all_, k, points, second);
        for (const Tried& first : tried) {
            const unsigned both =
                               WATCHED_ELSE("offset cover: two triangles meet at a sample of either edge",
                                            first.sampled.within & second.within, first.sampled.within | second.within),
                           sides[2] = {both & ((1U << half) - 1), both >> half};
            if (sides[0] == 0 || sides[1] == 0) continue;
            const auto before = static_cast<std::size_t>(std::countr_zero(sides[0]));
            const auto after = static_cast<std::size_t>(std::countr_zero(sides[1]));
            T near_first = std::max(first.sampled.square[before], first.sampled.square[half + after]);
            T near_second = std::max(second.square[before], second.square[half + after]);
            std::size_t i = run.begin;
            for (std::size_t left = run.length; left > 0; i = next(i), --left)
                near_first = std::max(near_first, square(i, first.k));
            for (; WATCHED("offset cover: corners that the second of two triangles covers", i != run.begin);
                 i = next(i))
                near_second = std::max(near_second, square(i, k));
            out = {first.k, static_cast<T>(before + 1) / static_cast<T>(half),
                   static_cast<T>(after + 1) / static_cast<T>(half), k,
                   std::max(at_most(near_first, first.k),
                            WATCHED("offset cover: the second of two triangles", at_most(near_second, k)))};
            return;
        }
    });
    return out.second != no_triangle;
}

// Returns how far one edge (side 0: before the run of corners, 1: after it) stays within the threshold of a triangle of
// B, as a fraction of the edge. In double precision, two more rounds of samples refine the result.
template <class T>
T Engine<T>::exit_of(const Run& run, const Tried& tried, std::size_t side, const SamplePoints<T>& points) {
    const std::size_t end = end_of(run);
    const std::size_t inside = side == 0 ? run.begin : end, outside = side == 0 ? last(run.begin) : next(end);
    const T threshold = std::sqrt(all_.limit[tried.k]);
    T from = 0, to = 1, near = std::sqrt(square(inside, tried.k)), out = 0;
    Sampled<T> sampled = tried.sampled;
    for (int round = 0; round < (exact ? 3 : 1); ++round) {
        if (round > 0) {
            SamplePoints<T> finer = points;
            sample_edge(side, inside, outside, from, to, finer);
            measure_samples(c_, all_, tried.k, finer, sampled);
        }
        T distances[samples<T>];
        roots(sampled.square, distances);
        // Finds the first sample beyond the threshold, and interpolates linearly between its distance and the distance
        // of the sample before. The distance is convex along the edge, so the result is never too large.
        const auto s = static_cast<std::size_t>(std::countr_one(sampled.within >> (side * half) & ((1U << half) - 1)));
        if (s == half) return to;
        if (s > 0) near = distances[side * half + s - 1];
        const T step = (to - from) / static_cast<T>(half);
        const T low = from + step * static_cast<T>(s), far = distances[side * half + s];
        out = low + (far > near ? step * std::clamp((threshold - near) / (far - near), T(0), T(1)) : T(0));
        from = low;
        to = low + step;
    }
    return out;
}

// Returns two triangles of B that cover the polygon together, if by_two() finds them. Otherwise returns the triangle
// that can cut off the largest part of the polygon, and how far it reaches along the two edges.
template <class T> typename Engine<T>::Exits Engine<T>::exits(const Run& run) {
    std::array<Tried, tried_triangles> tried;
    const std::size_t count = choose(run, tried);
    SamplePoints<T> points;
    sample_edges(run, points);
    for (std::size_t i = 0; i < count; ++i) measure_samples(c_, all_, tried[i].k, points, tried[i].sampled);
    Exits best;
    if (by_two(run, std::span(tried).first(count), points, best)) return best;
    T best_score = -1;
    for (std::size_t i = 0; i < count; ++i) {
        const T before = exit_of(run, tried[i], 0, points), after = exit_of(run, tried[i], 1, points);
        // Cutting off a single corner removes a triangle, whose area is proportional to before * after.
        const T score = run.length == 1 ? before * after + T(0.01) * (before + after) : before + after;
        if (score <= best_score) continue;
        best_score = score;
        best.triangle = tried[i].k;
        best.before = before;
        best.after = after;
    }
    return best;
}

// Adds to `rest` a corner at fraction t of the edge from corner `inside` to corner `outside`. Reduces t slightly, so
// that the rounded corner is certainly within the threshold of triangle k. Returns false if no reduction that it tries
// is enough, or if the rounding error of the corner would be too large.
template <class T>
bool Engine<T>::add_exit(Polygon<T>& rest, std::size_t* rows, std::size_t inside, std::size_t outside, T& t,
                         std::size_t k) {
    const float slack = slack_of_cut(inside, outside, t);
    if (WATCHED("offset cover: most slack, one exit", slack > OffsetCover<T>::most_slack)) return false;
    const std::size_t row = take_row();
    // t is reduced by each of these fractions in turn. In double precision the first one is enough, except on an edge
    // so short that rounding matters.
    constexpr std::array<T, 4> backs = exact ? std::array<T, 4>{T(0x1p-40), T(0x1p-28), T(0x1p-16), T(0x1p-4)}
                                             : std::array<T, 4>{T(0x1p-16), T(0x1p-12), T(0x1p-8), T(0x1p-4)};
    for (const T back : backs) {
        const T at = t * (1 - back);
        const T x = piece_.x[inside] + at * (piece_.x[outside] - piece_.x[inside]),
                y = piece_.y[inside] + at * (piece_.y[outside] - piece_.y[inside]),
                z = piece_.z[inside] + at * (piece_.z[outside] - piece_.z[inside]);
        measure_row(c_, all_, row, x, y, z);
        if (!c_.within[row].has(k)) continue;
        rows[rest.count] = row;
        rest.add(x, y, z, slack);
        t = at;
        return true;
    }
    return false;
}

// Drops the triangles of B that are too far away to matter for the polygon: farther from its centre than its radius
// plus the threshold. Bounds stay valid whatever is dropped. Does nothing if there are few triangles, or in double
// precision, where triangles may still be added.
template <class T> void Engine<T>::keep_few() {
    using D = FrameLanes<T>;
    const D d;
    const std::size_t lanes = hn::Lanes(d), count = all_.count();
    constexpr std::size_t least_lanes = HWY_HAVE_SCALABLE ? 1 : hn::MaxLanes(D());
    if (exact || all_.frames != &c_.near || count <= 2 * frames_width) return;
    find_centre();
    measure_row(c_, all_, centre_row, centre_[0], centre_[1], centre_[2]);
    const auto far = static_cast<T>((radius_ + c_.threshold) * (1 + 0x1p-20));
    // The bit masks of the vectors, two bytes each. LoadMaskBits() may read eight bytes, hence six more at the end.
    std::array<std::uint8_t, 2 * NearTriangles<T>::most_triangles / least_lanes + 6> bits{};
    c_.few.clear(c_.near.units);
    for (std::size_t k = 0; k < count; k += lanes) {
        unsigned near = mask_bits<T>(hn::Le(hn::LoadU(d, c_.squares(centre_row) + k), hn::Set(d, far * far)));
        if (count - k < lanes) near &= (1U << (count - k)) - 1;
        bits[k / lanes * 2] = static_cast<std::uint8_t>(near);
        bits[k / lanes * 2 + 1] = static_cast<std::uint8_t>(near >> 8);
        for (; near != 0; near &= near - 1)
            c_.few.triangle.push_back(c_.near.triangle[k + static_cast<std::size_t>(std::countr_zero(near))]);
    }
    c_.few_limit.resize(NearTriangles<T>::stride);
    const auto compress = [&](const T* from, T* to) HWY_ATTR {
        for (std::size_t k = 0; k < count; k += lanes) {
            const auto near = hn::LoadMaskBits(d, bits.data() + k / lanes * 2);
            hn::StoreU(hn::Compress(hn::LoadU(d, from + k), near), d, to);
            to += hn::CountTrue(d, near);
        }
    };
    for (std::size_t i = 0; i < near_rows; ++i) compress(all_.row(i), c_.few.row(i));
    compress(all_.limit, c_.few_limit.data());
    const std::size_t kept = c_.few.count();
    std::fill(c_.few_limit.begin() + static_cast<std::ptrdiff_t>(kept), c_.few_limit.end(), T(-1));
    all_ = {&c_.few, c_.few_limit.data()};
    for (std::size_t i = 0; i < piece_.count; ++i) {
        const std::size_t from = row_[i];
        if (from < most_shared_points) row_[i] = take_row();
        compress(c_.squares(from), c_.squares(row_[i]));
        compare_row(c_, all_, row_[i]);
    }
}

// Cuts off a part of the polygon that is within the threshold of one triangle of B. The part is the convex hull of some
// consecutive corners and of one point on each of the two edges next to them. Returns `covered` if the rest is within
// the threshold of a second triangle, `stuck` if too little can be cut off, and otherwise `peeled`.
template <class T> typename Engine<T>::Peel Engine<T>::peel() {
    if (piece_.count >= crowded || slow_ >= 2 || peels_ >= most_peels) return Peel::stuck;
    const Run run = longest_run();
    Exits out = exits(run);
    const std::size_t first = run.begin, end = end_of(run);
    if (out.second != no_triangle) {
        if (WATCHED("offset cover: most slack, two triangles",
                    std::max(slack_of_cut(first, last(first), out.before), slack_of_cut(end, next(end), out.after)) >
                        OffsetCover<T>::most_slack))
            return Peel::stuck;
        if (c_.proof) cut_proof(run, out);
        covered_by(out.triangle, out.upper);
        covered_by(out.second, out.upper);
        ++c_.cuts;
        return Peel::covered;
    }
    const T removed = out.before + out.after;
    if (removed < T(0.02)) return Peel::stuck;
    slow_ = removed < T(0.3) ? slow_ + 1 : 0;

    Polygon<T> rest;
    std::size_t rows[most_polygon_corners];
    const std::uint32_t used_before = used_;
    bool kept = add_exit(rest, rows, end, next(end), out.after, out.triangle);
    for (std::size_t i = next(end); kept; i = next(i)) {
        rows[rest.count] = row_[i];
        rest.add(piece_.x[i], piece_.y[i], piece_.z[i], piece_.slack[i]);
        if (i == last(first)) break;
    }
    kept = kept && add_exit(rest, rows, first, last(first), out.before, out.triangle);
    if (!kept) {
        used_ = used_before;
        return Peel::stuck;
    }
    T most = std::max(c_.squares(rows[0])[out.triangle], c_.squares(rows[rest.count - 1])[out.triangle]);
    for (std::size_t i = first, left = run.length; left > 0; i = next(i), --left) {
        most = std::max(most, square(i, out.triangle));
        if (row_[i] >= most_shared_points) used_ &= ~(1U << (row_[i] - most_shared_points));
    }
    if (c_.proof) cut_proof(run, out);
    covered_by(out.triangle, at_most(most, out.triangle));
    piece_ = rest;
    std::copy_n(rows, rest.count, row_);
    ++c_.cuts;
    ++peels_;
    return Peel::peeled;
}

}  // namespace
}  // namespace hausbench::cover::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
