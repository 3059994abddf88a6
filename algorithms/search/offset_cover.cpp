#include "offset_cover.h"

#include <cmath>
#include <limits>
#include <span>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "search/offset_cover.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include "kernel/triangle_frames-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hausbench::HWY_NAMESPACE {
namespace {

// Points that are measured at once against one triangle: half of them on either edge of a peel.
template <class T> inline constexpr std::size_t samples = sizeof(T) == 4 ? 16 : 8;

constexpr std::size_t tried_triangles = 3;  // for a peel, by their true exits
constexpr std::size_t most_seconds = 4;     // that may cover the rest
constexpr std::size_t crowded = 12;         // corners: with so many, a polygon is cut in two
// The mean of up to 16 corners: partial sums are at most 16, so each of 15 sums errs by 16u, a sixteenth of that in the mean, and
// the quotient by u: sqrt(3) 16 < 28.
constexpr double slack_of_mean = 28;
// Who checks a certificate takes the mean of the exact corners: that is so far from ours, and as far as the corners are off. Its distances to B
// and to the corners are off by as much each.
constexpr double difference_of_means = 2 * slack_of_mean;
constexpr int most_peels = 8;  // one after another: along a short edge, many may remove next to nothing

// The triangles that are looked at now: all that are near, or few of them.
template <class T> struct Candidates {
    const NearTriangles<T>* frames;
    const T* limit;

    std::size_t count() const { return frames->count(); }
    const T* row(std::size_t i) const { return frames->row(i); }
};

template <class T> NearSet compare(const Candidates<T>& candidates, const T* squares) {
    using D = FrameLanes<T>;
    const D d;
    NearSet within;
    for (std::size_t k = 0; k < candidates.count(); k += hn::Lanes(d)) {
        const auto near = hn::Le(hn::LoadU(d, squares + k), hn::LoadU(d, candidates.limit + k));
        within.word[k / 64] |= std::uint64_t{mask_bits<T>(near)} << (k % 64);
    }
    return within;  // the limit of what is not in use is -1
}

template <class T> HWY_INLINE void measure_all(const Candidates<T>& candidates, T x, T y, T z, T* squares) {
    using D = FrameLanes<T>;
    const D d;
    const auto px = hn::Set(d, x), py = hn::Set(d, y), pz = hn::Set(d, z);
    for (std::size_t k = 0; k < candidates.count(); k += hn::Lanes(d)) {
        const auto load = [&](std::size_t i) HWY_ATTR { return hn::LoadU(d, candidates.row(i) + k); };
        hn::StoreU(squared_in_frames<T>(load, px, py, pz), d, squares + k);
    }
}

template <class T>
void measure_row(OffsetCover<T>& c, const Candidates<T>& candidates, std::size_t point, T x, T y, T z) {
    measure_all(candidates, x, y, z, c.squares(point));
    c.distances += candidates.count();
    c.within[point] = compare(candidates, c.squares(point));
}

// Squared distances of some points to one triangle, and which of them are within its limit, as bits.
template <class T> struct SamplePoints { T x[samples<T>], y[samples<T>], z[samples<T>]; };
template <class T> struct Sampled {
    T square[samples<T>];
    unsigned within;
};
template <class T>
Sampled<T> measure_samples(OffsetCover<T>& c, const Candidates<T>& candidates, std::size_t k,
                           const SamplePoints<T>& points) {
    using D = FrameLanes<T>;
    const D d;
    const auto set = [&](std::size_t i) HWY_ATTR { return hn::Set(d, candidates.row(i)[k]); };
    const auto limit = hn::Set(d, candidates.limit[k]);
    Sampled<T> found;
    found.within = 0;
    for (std::size_t i = 0; i < samples<T>; i += hn::Lanes(d)) {
        const auto squared = squared_in_frames<T>(set, hn::LoadU(d, points.x + i), hn::LoadU(d, points.y + i),
                                                  hn::LoadU(d, points.z + i));
        hn::StoreU(squared, d, found.square + i);
        found.within |= mask_bits<T>(hn::Le(squared, limit)) << i;
    }
    c.distances += samples<T>;
    return found;
}

template <class T> void roots(const T (&squares)[samples<T>], T (&distances)[samples<T>]) {
    const FrameLanes<T> d;
    for (std::size_t i = 0; i < samples<T>; i += hn::Lanes(d))
        hn::StoreU(hn::Sqrt(hn::LoadU(d, squares + i)), d, distances + i);
}

// One piece of A.
template <class T> class Engine {
public:
    Engine(OffsetCover<T>& cover, CoverHost* host, const TriangleMesh* target, std::size_t most_work)
        : c_(cover), all_{&cover.near, cover.limit.data()}, host_(host), target_(target), most_work_(most_work) {}

    CoverResult run(const CoverPolygon<T>& piece, const std::size_t* shared);

private:
    static constexpr bool exact = sizeof(T) == 8;
    static constexpr std::size_t centre_row = most_shared_points + most_polygon_corners + 2;

    struct Run {
        std::size_t begin = 0, length = 0;  // corners
        NearSet common;                     // the triangles that are near all of them
    };
    static constexpr std::size_t half = samples<T> / 2, none = static_cast<std::size_t>(-1);
    struct Exits {
        std::size_t triangle = 0;
        T before = 0,
          after = 0;  // where the edges before and after the run leave its offset: 0 at the run, 1 at the other end
        std::size_t second = none;  // a triangle that covers the rest, if they are left there
        double upper = 0;           // by both
    };
    struct Tried {
        std::size_t k;
        T estimate;
        Sampled<T> sampled;
    };
    enum class Peel { stuck, peeled, covered };

    CoverResult cover(const CoverPolygon<T>& piece, const std::size_t* shared);
    void begin(const CoverPolygon<T>& polygon, const std::size_t* shared);
    bool pop();
    bool one_for_all();
    bool every_corner_near();
    void ask(T x, T y, T z, double slack, std::size_t near);
    Run longest_run() const;
    std::size_t choose(const Run& run, std::array<Tried, tried_triangles>& tried);
    Exits exits(const Run& run);
    void sample_edges(const Run& run, SamplePoints<T>& points) const;
    void sample_edge(std::size_t side, std::size_t from, std::size_t to, T low, T high, SamplePoints<T>& points) const;
    bool by_two(const Run& run, std::span<const Tried> tried, const SamplePoints<T>& points, Exits& out);
    T exit_of(const Run& run, const Tried& tried, std::size_t side, const SamplePoints<T>& points);
    void estimate_exits(const Run& run, const std::size_t (&corners)[4],
                        T (&estimate)[NearTriangles<T>::most_triangles]);
    Peel peel();
    void keep_few();
    void find_centre();
    bool add_exit(CoverPolygon<T>& rest, std::size_t* rows, std::size_t inside, std::size_t outside, T& t,
                  std::size_t k);
    enum class Centre { covered, lost, cut };
    Centre look_at_centre();
    void cut();
    bool along_prism(std::size_t k, T (&side)[most_polygon_corners]) const;
    void across_longest_edge(T (&side)[most_polygon_corners]);
    void settle();

    std::size_t next(std::size_t i) const { return i + 1 == piece_.count ? 0 : i + 1; }
    std::size_t last(std::size_t i) const { return i == 0 ? piece_.count - 1 : i - 1; }
    T square(std::size_t corner, std::size_t k) const { return c_.squares(row_[corner])[k]; }
    // Of a corner at t of the way from one to the other (offset_cover.h); the factors make up for rounding here.
    float slack_of_cut(std::size_t from, std::size_t to, T t) const {
        const T length = std::abs(piece_.x[to] - piece_.x[from]) + std::abs(piece_.y[to] - piece_.y[from]) +
                         std::abs(piece_.z[to] - piece_.z[from]);
        return std::max(piece_.slack[from], piece_.slack[to]) + 1.75F + 2.01F * static_cast<float>(t * length);
    }
    const NearSet& within(std::size_t corner) const { return c_.within[row_[corner]]; }
    // Triangle k is near all corners.
    void covered_by(std::size_t k, double bound) {
        upper_ = std::max(upper_, bound);
        if (c_.proof) c_.proof->one(all_.frames->triangle[k]);
    }
    void cut_proof(const Run& run, const Exits& out) {
        c_.proof->cut(CutPoint::back(last(run.begin), static_cast<double>(out.before)),
                      CutPoint::along((run.begin + run.length - 1) % piece_.count, static_cast<double>(out.after)));
    }
    double at_most(T square, std::size_t k) const {
        return std::sqrt(static_cast<double>(square)) * (1 + 0x1p-50) + c_.error(*all_.frames, k);
    }
    T largest_square(std::size_t k) const {
        T most = 0;
        for (std::size_t i = 0; i < piece_.count; ++i) most = std::max(most, square(i, k));
        return most;
    }
    std::size_t nearest(std::size_t point) const {
        const T* const squares = c_.squares(point);
        return static_cast<std::size_t>(std::min_element(squares, squares + all_.count()) - squares);
    }
    std::size_t take_row() {
        const auto free = static_cast<std::size_t>(std::countr_one(used_));
        used_ |= 1U << free;
        return most_shared_points + free;
    }

    OffsetCover<T>& c_;
    Candidates<T> all_;
    CoverHost* host_;             // null in single precision
    const TriangleMesh* target_;  // likewise
    std::size_t most_work_, work_ = 0;
    double upper_ = 0;  // of what is covered so far
    CoverPolygon<T> piece_;
    std::size_t row_[most_polygon_corners]{};  // of its corners
    std::uint32_t used_ = 0;                   // rows
    int slow_ = 0;                             // peels in a row that removed little
    int peels_ = 0;                            // since the last cut
    bool spent_ = false;                       // what is left gets the bound that it has
    bool full_ = false;                        // there is no room for a triangle that is nearest to a point
    std::array<T, 3> centre_{};
    double radius_ = 0;  // of the piece, around it
    float slack_ = 0;    // the largest of its corners
};

template <class T> void Engine<T>::begin(const CoverPolygon<T>& polygon, const std::size_t* shared) {
    piece_ = polygon;
    used_ = 0;
    slow_ = 0;
    peels_ = 0;
    for (std::size_t i = 0; i < piece_.count; ++i) {
        row_[i] = shared ? shared[i] : take_row();
        if (!shared) measure_row(c_, all_, row_[i], piece_.x[i], piece_.y[i], piece_.z[i]);
    }
}

template <class T> CoverResult Engine<T>::run(const CoverPolygon<T>& piece, const std::size_t* shared) {
    const std::size_t mark = c_.proof ? c_.proof->mark() : 0;
    const CoverResult result = cover(piece, shared);
    if (c_.proof && !result.covered) c_.proof->back_to(mark);
    return result;
}

template <class T> CoverResult Engine<T>::cover(const CoverPolygon<T>& piece, const std::size_t* shared) {
    c_.stack.clear();
    begin(piece, shared);
    while (true) {
        if (++work_ > most_work_) return {};
        if (exact && !spent_ && !host_->go_on()) spent_ = true;
        if (spent_) {
            settle();
            if (!pop()) return {true, upper_};
            continue;
        }
        if (!every_corner_near()) {
            if (!exact) return {};
            if (full_) return {};
            settle();  // rounding is more than what is left
            if (!pop()) return {true, upper_};
            continue;
        }
        if (one_for_all()) {
            if (!pop()) return {true, upper_};
            continue;
        }
        const Peel peeled = peel();
        if (peeled == Peel::peeled) {
            if (peels_ == 2 || (peels_ == 1 && all_.count() > 4 * frames_width)) keep_few();
            continue;
        }
        if (peeled == Peel::covered) {
            if (!pop()) return {true, upper_};
            continue;
        }
        const Centre centre = look_at_centre();
        if (full_) return {};
        if (centre == Centre::lost) return {};
        if (centre == Centre::cut)
            cut();
        else if (!pop())
            return {true, upper_};
    }
}

template <class T> bool Engine<T>::pop() {
    if (c_.stack.empty()) return false;
    const CoverPolygon<T> polygon = c_.stack.back();
    c_.stack.pop_back();
    begin(polygon, nullptr);
    return true;
}

// The distance to a triangle is convex, so the largest of the corners bounds that of the polygon; for the triangle for which it is least.
template <class T> void Engine<T>::settle() {
    double least = std::numeric_limits<double>::infinity();
    std::size_t best = 0;
    for (std::size_t k = 0; k < all_.count(); ++k) {
        const double bound = at_most(largest_square(k), k);
        if (bound < least) least = bound, best = k;
    }
    covered_by(best, least);
}

// Whether one triangle is within the threshold of all corners. The one that bounds the polygon best settles it.
template <class T> bool Engine<T>::one_for_all() {
    ++c_.tests;
    NearSet common = within(0);
    for (std::size_t i = 1; i < piece_.count; ++i) common = common & within(i);
    if (common.empty()) return false;
    double least = std::numeric_limits<double>::infinity();
    const double enough = std::max(upper_, c_.enough);
    std::size_t best = 0;
    common.for_each([&](std::size_t k) {
        if (least <= enough) return;
        const double bound = at_most(largest_square(k), k);
        if (bound < least) least = bound, best = k;
    });
    covered_by(best, least);
    return true;
}

// Measures a point of the piece exactly. The host's threshold may rise, and the triangle that is nearest is among those near, from
// then on. Squares of all corners and limits are as they should be afterwards.
template <class T> void Engine<T>::ask(T x, T y, T z, double slack, std::size_t near) {
    const double point[3] = {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
    const Index found = host_->measure(point, slack, c_.near.triangle[near]);
    if (std::find(c_.near.triangle.begin(), c_.near.triangle.end(), found) == c_.near.triangle.end()) {
        if (c_.near.count() == NearTriangles<T>::most_triangles) {
            full_ = true;
            return;
        }
        std::vector<Index> triangles = c_.near.triangle;
        triangles.push_back(found);
        if constexpr (exact) set_frames(*target_, triangles, c_.near);
        c_.make_rows(most_shared_points + most_polygon_corners + 4);
        c_.set_threshold(host_->threshold());
        all_ = {&c_.near, c_.limit.data()};
        for (std::size_t i = 0; i < piece_.count; ++i)
            measure_row(c_, all_, row_[i], piece_.x[i], piece_.y[i], piece_.z[i]);
    } else {
        c_.set_threshold(host_->threshold());
        all_ = {&c_.near, c_.limit.data()};
        for (std::size_t i = 0; i < piece_.count; ++i) c_.within[row_[i]] = compare(all_, c_.squares(row_[i]));
    }
}

template <class T> bool Engine<T>::every_corner_near() {
    std::size_t asked = 0;
    for (std::size_t i = 0; i < piece_.count; ++i) {
        if (!within(i).empty()) continue;
        if (!exact || full_ || ++asked > 2 * most_polygon_corners) return false;
        ask(piece_.x[i], piece_.y[i], piece_.z[i], piece_.slack[i], nearest(row_[i]));
        if (within(i).empty()) return false;
        i = static_cast<std::size_t>(-1);  // sets of the others are new too
    }
    return true;
}

// --- peel -------------------------------------------------------------------------------------------------------------

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

// How far along both edges each triangle seems to reach, from 0 to 2: the distance is convex along an edge, so the exit is no farther than
// where the chord between the distances of its ends meets the threshold.
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

// A few triangles near the run that seem to reach farthest.
template <class T> std::size_t Engine<T>::choose(const Run& run, std::array<Tried, tried_triangles>& tried) {
    std::size_t count = 0;
    T estimate[NearTriangles<T>::most_triangles];
    const bool more = run.common.size() > tried.size();
    const std::size_t end = (run.begin + run.length - 1) % piece_.count;
    if (more) estimate_exits(run, {run.begin, last(run.begin), end, next(end)}, estimate);
    run.common.for_each([&](std::size_t k) {
        if (count < tried.size()) {
            tried[count].k = k;
            tried[count++].estimate = more ? estimate[k] : T(0);
            return;
        }
        auto worst = std::min_element(tried.begin(), tried.end(),
                                      [](const Tried& x, const Tried& y) { return x.estimate < y.estimate; });
        if (estimate[k] > worst->estimate) worst->k = k, worst->estimate = estimate[k];
    });
    return count;
}

// Points of one of the two edges, the last one at `high`.
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
    const std::size_t end = (run.begin + run.length - 1) % piece_.count;
    sample_edge(0, run.begin, last(run.begin), T(0), T(1), points);
    sample_edge(1, end, next(end), T(0), T(1), points);
}

// Whether a triangle that is near the run and one that is near all other corners both reach a sample on either edge: then the two cover
// the polygon, cut there.
template <class T>
bool Engine<T>::by_two(const Run& run, std::span<const Tried> tried, const SamplePoints<T>& points, Exits& out) {
    const std::size_t end = (run.begin + run.length - 1) % piece_.count;
    NearSet others = within(next(end));
    for (std::size_t i = next(end); i != run.begin; i = next(i)) others = others & within(i);
    std::size_t looked = 0;
    others.for_each([&](std::size_t k) {
        if (out.second != none || ++looked > most_seconds) return;
        const Sampled<T> second = measure_samples(c_, all_, k, points);
        for (const Tried& first : tried) {
            const unsigned both = first.sampled.within & second.within,
                           sides[2] = {both & ((1U << half) - 1), both >> half};
            if (sides[0] == 0 || sides[1] == 0) continue;
            const auto before = static_cast<std::size_t>(std::countr_zero(sides[0]));
            const auto after = static_cast<std::size_t>(std::countr_zero(sides[1]));
            T near_first = std::max(first.sampled.square[before], first.sampled.square[half + after]);
            T near_second = std::max(second.square[before], second.square[half + after]);
            std::size_t i = run.begin;
            for (std::size_t left = run.length; left > 0; i = next(i), --left)
                near_first = std::max(near_first, square(i, first.k));
            for (; i != run.begin; i = next(i)) near_second = std::max(near_second, square(i, k));
            out = {first.k, static_cast<T>(before + 1) / static_cast<T>(half),
                   static_cast<T>(after + 1) / static_cast<T>(half), k,
                   std::max(at_most(near_first, first.k), at_most(near_second, k))};
            return;
        }
    });
    return out.second != none;
}

// Where one of the two edges leaves the offset of a triangle.
template <class T>
T Engine<T>::exit_of(const Run& run, const Tried& tried, std::size_t side, const SamplePoints<T>& points) {
    const std::size_t end = (run.begin + run.length - 1) % piece_.count;
    const std::size_t inside = side == 0 ? run.begin : end, outside = side == 0 ? last(run.begin) : next(end);
    const T threshold = std::sqrt(all_.limit[tried.k]);
    T from = 0, to = 1, near = std::sqrt(square(inside, tried.k)), out = 0;
    Sampled<T> sampled = tried.sampled;
    for (int round = 0; round < (exact ? 3 : 1); ++round) {
        if (round > 0) {
            SamplePoints<T> finer = points;
            sample_edge(side, inside, outside, from, to, finer);
            sampled = measure_samples(c_, all_, tried.k, finer);
        }
        T distances[samples<T>];
        roots(sampled.square, distances);
        // The first sample that is outside, and the last one before it; the chord between their distances is left no later.
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

// Two triangles that cover all, or the one that removes most, of a few that seem to, and where its offset is left.
template <class T> typename Engine<T>::Exits Engine<T>::exits(const Run& run) {
    std::array<Tried, tried_triangles> tried;
    const std::size_t count = choose(run, tried);
    SamplePoints<T> points;
    sample_edges(run, points);
    for (std::size_t i = 0; i < count; ++i) tried[i].sampled = measure_samples(c_, all_, tried[i].k, points);
    Exits best;
    if (by_two(run, std::span(tried).first(count), points, best)) return best;
    T best_score = -1;
    for (std::size_t i = 0; i < count; ++i) {
        const T before = exit_of(run, tried[i], 0, points), after = exit_of(run, tried[i], 1, points);
        const T score = run.length == 1 ? before * after + T(0.01) * (before + after) : before + after;
        if (score <= best_score) continue;
        best_score = score;
        best.triangle = tried[i].k;
        best.before = before;
        best.after = after;
    }
    return best;
}

// A corner at t on the edge from `inside` to `outside` that is within the limit of triangle k, as computed; t shrinks until it is.
template <class T>
bool Engine<T>::add_exit(CoverPolygon<T>& rest, std::size_t* rows, std::size_t inside, std::size_t outside, T& t,
                         std::size_t k) {
    const float slack = slack_of_cut(inside, outside, t);
    if (slack > OffsetCover<T>::most_slack) return false;
    const std::size_t row = take_row();
    // In double precision far less would do, but along an edge so short that rounding is a part of it.
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

// Leaves out triangles that are farther from the centre than any part of the polygon may be from what covers it. It does not matter for a
// proof which are left. In double precision the host may ask for any of them.
template <class T> void Engine<T>::keep_few() {
    using D = FrameLanes<T>;
    const D d;
    const std::size_t lanes = hn::Lanes(d), count = all_.count();
    if (exact || all_.frames != &c_.near || count <= 2 * frames_width) return;
    find_centre();
    measure_all(all_, centre_[0], centre_[1], centre_[2], c_.squares(centre_row));
    c_.distances += count;
    const auto far = static_cast<T>((radius_ + c_.threshold) * (1 + 0x1p-20));
    std::array<std::uint8_t, 8 * NearTriangles<T>::most_triangles / frames_width>
        bits{};  // of each vector, 8 bytes apart
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
        c_.within[row_[i]] = compare(all_, c_.squares(row_[i]));
    }
}

// Cuts off what one triangle covers: the run's corners and both exits are within its offset, so all between them is.
template <class T> typename Engine<T>::Peel Engine<T>::peel() {
    if (piece_.count >= crowded || slow_ >= 2 || peels_ >= most_peels) return Peel::stuck;
    const Run run = longest_run();
    Exits out = exits(run);
    const std::size_t first = run.begin, end = (run.begin + run.length - 1) % piece_.count;
    if (out.second != none) {
        if (std::max(slack_of_cut(first, last(first), out.before), slack_of_cut(end, next(end), out.after)) >
            OffsetCover<T>::most_slack)
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

    CoverPolygon<T> rest;
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

// --- cut in two ---------------------------------------------------------------------------------------------------------

// No point of the polygon is farther from a triangle than its centre is, plus its radius.
template <class T> void Engine<T>::find_centre() {
    std::array<T, 3> sum{};
    for (std::size_t i = 0; i < piece_.count; ++i) sum[0] += piece_.x[i], sum[1] += piece_.y[i], sum[2] += piece_.z[i];
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

template <class T> typename Engine<T>::Centre Engine<T>::look_at_centre() {
    find_centre();
    measure_row(c_, all_, centre_row, centre_[0], centre_[1], centre_[2]);
    std::size_t k = nearest(centre_row);
    const auto distance = [&] { return at_most(c_.squares(centre_row)[k], k); };
    if (exact && host_->promising(distance())) {
        ask(centre_[0], centre_[1], centre_[2], slack_ + slack_of_mean, k);
        measure_row(c_, all_, centre_row, centre_[0], centre_[1], centre_[2]);
        k = nearest(centre_row);
    }
    const double bound =
        distance() + radius_ + (difference_of_means + 2 * static_cast<double>(slack_)) * frame_roundoff<T>;
    // Too small to be cut: rounding is as large.
    const bool tiny = radius_ < 4 * c_.error(*all_.frames, k) || c_.stack.size() > 200 ||
                      slack_ + 14 > OffsetCover<T>::most_slack || piece_.count + 2 > most_polygon_corners;
    if (bound <= c_.threshold || (exact && tiny)) {
        const double by_corners = at_most(largest_square(k), k);
        if (by_corners <= bound) {
            covered_by(k, by_corners);
        } else {
            upper_ = std::max(upper_, bound);
            if (c_.proof) c_.proof->centre(all_.frames->triangle[k]);
        }
        return Centre::covered;
    }
    if (!exact && (tiny || distance() > c_.threshold)) return Centre::lost;
    return Centre::cut;
}

// Across an edge of triangle k, by the plane through it that is normal to the triangle, if that is not near the rim of the polygon.
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
        if (depth > best) best = depth, chosen = s;
    }
    if (chosen == 3 || !(static_cast<double>(best) > 0.05 * radius_)) return false;
    std::copy_n(sides[chosen], piece_.count, side);
    return true;
}

// By the plane across the longest edge, where it is as far from the triangles that are nearest to its ends, or at its midpoint.
template <class T> void Engine<T>::across_longest_edge(T (&side)[most_polygon_corners]) {
    std::size_t a = 0;
    T longest = -1;
    for (std::size_t i = 0; i < piece_.count; ++i) {
        const std::size_t j = next(i);
        const T x = piece_.x[j] - piece_.x[i], y = piece_.y[j] - piece_.y[i], z = piece_.z[j] - piece_.z[i];
        const T squared = (x * x + y * y) + z * z;
        if (squared > longest) longest = squared, a = i;
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
    side[a] = -t * longest;  // whatever rounding says
    side[b] = (1 - t) * longest;
}

// Cuts where the sides change, twice: a run of corners on the positive side, and the rest. That a side may be wrong by rounding, or that
// there are more changes, does no harm: what is cut off is what lies beyond the chord between two points of the rim.
template <class T> void Engine<T>::cut() {
    ++c_.cuts;
    T side[most_polygon_corners];
    if (!along_prism(nearest(centre_row), side)) across_longest_edge(side);
    std::size_t first = 0;  // of a run of corners on the positive side
    while (!(side[first] > 0 && side[last(first)] <= 0)) ++first;
    std::size_t end = first;
    while (side[next(end)] > 0) end = next(end);
    const std::size_t before = last(first), after = next(end);
    struct Crossing {
        T x, y, z;
        float slack;
        CutPoint place;
    };
    // The rim crosses between two corners, or in one of them where the side is 0.
    const auto crossing = [&](std::size_t from, std::size_t to, std::size_t zero) -> Crossing {
        if (side[zero] == 0)
            return {piece_.x[zero], piece_.y[zero], piece_.z[zero], piece_.slack[zero], CutPoint::corner(zero)};
        const T t = side[from] / (side[from] - side[to]);
        return {piece_.x[from] + t * (piece_.x[to] - piece_.x[from]),
                piece_.y[from] + t * (piece_.y[to] - piece_.y[from]),
                piece_.z[from] + t * (piece_.z[to] - piece_.z[from]), slack_of_cut(from, to, t),
                CutPoint::along(from, static_cast<double>(t))};
    };
    const Crossing p = crossing(before, first, before), q = crossing(end, after, after);
    CoverPolygon<T> high, low;
    const auto add = [](CoverPolygon<T>& part, const Crossing& at) { part.add(at.x, at.y, at.z, at.slack); };
    const auto copy = [&](CoverPolygon<T>& part, std::size_t i) {
        part.add(piece_.x[i], piece_.y[i], piece_.z[i], piece_.slack[i]);
    };
    add(high, p);
    for (std::size_t i = first; i != after; i = next(i)) copy(high, i);
    add(high, q);
    add(low, q);
    for (std::size_t i = side[after] == 0 ? next(after) : after; i != first && (i != before || side[before] != 0);
         i = next(i))
        copy(low, i);
    add(low, p);
    if (c_.proof) c_.proof->cut(p.place, q.place);
    c_.stack.push_back(low);
    begin(high, nullptr);
}

void shared_rows(OffsetCover<float>& cover, const CoverPoints<float>& points) {
    const Candidates<float> all{&cover.near, cover.limit.data()};
    for (std::size_t i = 0; i < points.count; ++i) measure_row(cover, all, i, points.x[i], points.y[i], points.z[i]);
}

CoverResult shared_piece(OffsetCover<float>& cover, const CoverPolygon<float>& piece,
                         const std::array<std::size_t, 3>& points, std::size_t most_work) {
    return Engine<float>(cover, nullptr, nullptr, most_work).run(piece, points.data());
}

CoverResult sure_piece(OffsetCover<double>& cover, const CoverPolygon<double>& piece, CoverHost& host,
                       const TriangleMesh& target) {
    return Engine<double>(cover, &host, &target, std::numeric_limits<std::size_t>::max()).run(piece, nullptr);
}

}  // namespace
}  // namespace hausbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hausbench {

HWY_EXPORT(shared_rows);
HWY_EXPORT(shared_piece);
HWY_EXPORT(sure_piece);

template <class T> void OffsetCover<T>::set_threshold(double tau) {
    threshold = tau;
    const std::size_t count = near.count(), padded = (count + frames_width - 1) / frames_width * frames_width;
    limit.resize(NearTriangles<T>::stride);
    for (std::size_t k = 0; k < padded; ++k) {
        const double allowed = std::max(tau * (1 - 0x1p-50) - error(near, k), 0.0);
        // Rounded down: the factor is more than rounding to T takes.
        limit[k] = allowed > 0 ? static_cast<T>(allowed * allowed * (1 - 4 * frame_roundoff<T>)) : T(-1);
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

void measure_shared(OffsetCover<float>& cover, const CoverPoints<float>& points) {
    HWY_DYNAMIC_DISPATCH(shared_rows)(cover, points);
}
CoverResult cover_shared(OffsetCover<float>& cover, const CoverPolygon<float>& piece,
                         const std::array<std::size_t, 3>& points, std::size_t most_work) {
    return HWY_DYNAMIC_DISPATCH(shared_piece)(cover, piece, points, most_work);
}
CoverResult cover_surely(OffsetCover<double>& cover, const CoverPolygon<double>& piece, CoverHost& host,
                         const TriangleMesh& target) {
    cover.make_rows(most_shared_points + most_polygon_corners + 4);
    return HWY_DYNAMIC_DISPATCH(sure_piece)(cover, piece, host, target);
}

}  // namespace hausbench
#endif
