// Shows that a piece of A is within a threshold of B, polygon by polygon, as explained in offset_cover.h. Peeling is in
// offset_cover_peel-inl.h, cutting in two in offset_cover_cut-inl.h. Compiled once for each instruction set, so include
// it after hwy/foreach_target.h.
#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/cover/offset_cover_measure-inl.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#if defined(HAUSBENCH_OFFSET_COVER_ENGINE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HAUSBENCH_OFFSET_COVER_ENGINE_INL
#undef HAUSBENCH_OFFSET_COVER_ENGINE_INL
#else
#define HAUSBENCH_OFFSET_COVER_ENGINE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace hausbench::cover::HWY_NAMESPACE {

using namespace hausbench::HWY_NAMESPACE;
namespace {

// Number of triangles of B that are compared before a part of a polygon is cut off.
constexpr std::size_t tried_triangles = 3;

// Shows that one piece of A is within the threshold of B (offset_cover.h).
template <class T> class Engine {
public:
    Engine(OffsetCover<T>& cover, Host* host, const TriangleMesh* target, std::size_t most_work)
        : c_(cover), all_{&cover.near, cover.limit.data()}, host_(host), target_(target), most_work_(most_work) {}

    CoverResult run(const Polygon<T>& piece, const std::size_t* shared);

private:
    static constexpr bool exact = sizeof(T) == 8;
    static constexpr std::size_t centre_row = most_shared_points + most_polygon_corners + 2;

    // Consecutive corners of the polygon that are all within the threshold of the same triangle of B.
    struct Run {
        std::size_t begin = 0, length = 0;  // first corner, number of corners
        NearSet common;                     // all triangles for which this holds
    };
    static constexpr std::size_t half = samples<T> / 2;
    struct Exits {
        std::size_t triangle = 0;  // a triangle of B that covers the part of the polygon with the run
        // How much of the edges before and after the run of corners is within the threshold of `triangle`, as fractions
        // of the edges, counted from the run.
        T before = 0, after = 0;
        std::size_t second = no_triangle;  // covers the other part
        double upper = 0;  // only if `second` is set: upper bound for the whole polygon, from both triangles
    };
    struct Tried {
        std::size_t k;
        T estimate;
        Sampled<T> sampled;
    };
    enum class Peel { stuck, peeled, covered };

    CoverResult cover(const Polygon<T>& piece, const std::size_t* shared);
    void begin(const Polygon<T>& polygon, const std::size_t* rows);
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
    bool add_exit(Polygon<T>& rest, std::size_t* rows, std::size_t inside, std::size_t outside, T& t, std::size_t k);
    enum class Centre { covered, lost, cut };
    Centre look_at_centre();
    void cut();
    bool along_prism(std::size_t k, T (&side)[most_polygon_corners]) const;
    void across_longest_edge(T (&side)[most_polygon_corners]);
    void settle();

    std::size_t next(std::size_t i) const { return i + 1 == piece_.count ? 0 : i + 1; }
    std::size_t end_of(const Run& run) const {
        const std::size_t i = run.begin + run.length - 1;
        return i < piece_.count ? i : i - piece_.count;
    }
    std::size_t last(std::size_t i) const { return i == 0 ? piece_.count - 1 : i - 1; }
    T square(std::size_t corner, std::size_t k) const { return c_.squares(row_[corner])[k]; }
    // Returns an upper bound on the rounding error of a new corner at fraction t of the way between two corners, as a
    // multiple of the unit roundoff (derived in offset_cover.h). `length` is at least the distance of the two corners;
    // 1.75 and 2.01 instead of 1.74 and 2 absorb the rounding in this expression.
    float slack_of_cut(std::size_t from, std::size_t to, T t) const {
        const T length = std::abs(piece_.x[to] - piece_.x[from]) + std::abs(piece_.y[to] - piece_.y[from]) +
                         std::abs(piece_.z[to] - piece_.z[from]);
        return WATCHED_ELSE("offset cover: all slack of cut corners",
                            WATCHED("offset cover: slack of the ends of an edge that is cut",
                                    std::max(piece_.slack[from], piece_.slack[to])) +
                                WATCHED("offset cover: slack of cut corners, their own rounding", 1.75F) +
                                WATCHED("offset cover: slack of cut corners, the way along the edge",
                                        2.01F * static_cast<float>(t * length)),
                            0.0F);
    }
    const NearSet& within(std::size_t corner) const { return c_.within[row_[corner]]; }
    // Records an upper bound on the distance from any point of a polygon to triangle k of B.
    void covered_by(std::size_t k, double bound) {
        upper_ = std::max(upper_, bound);
        if (c_.proof) c_.proof->one(all_.frames->triangle[k]);
    }
    void cut_proof(const Run& run, const Exits& out) {
        c_.proof->cut(CutPoint::back(last(run.begin), static_cast<double>(out.before)),
                      CutPoint::along(end_of(run), static_cast<double>(out.after)));
    }
    double at_most(T square, std::size_t k) const { return HWY_NAMESPACE::at_most(c_, *all_.frames, square, k); }
    T largest_square(std::size_t k) const {
        T most = 0;
        for (std::size_t i = 0; i < piece_.count; ++i) most = std::max(most, square(i, k));
        return most;
    }
    std::size_t nearest(std::size_t point) const;
    std::size_t take_row() {
        const auto free = static_cast<std::size_t>(std::countr_one(used_));
        used_ |= 1U << free;
        return most_shared_points + free;
    }

    OffsetCover<T>& c_;
    Candidates<T> all_;
    Host* host_;                  // null in single precision
    const TriangleMesh* target_;  // null in single precision
    std::size_t most_work_, work_ = 0;
    double upper_ = 0;                         // largest upper bound of the polygons covered so far
    Polygon<T> piece_;                         // the current polygon
    std::size_t row_[most_polygon_corners]{};  // for each corner, its row in c_.squared and its index in c_.within
    std::uint32_t used_ = 0;                   // bit i: row most_shared_points + i is in use
    int slow_ = 0;                             // number of consecutive peels that removed little
    int peels_ = 0;                            // number of peels since the last cut in two
    bool spent_ = false;  // time or budget is spent; the other polygons get the bounds that they have
    bool full_ = false;   // a triangle must be added to `near`, which has no room left
    std::array<T, 3> centre_{};
    double radius_ = 0;  // largest distance of a corner of the polygon from centre_
    float slack_ = 0;    // largest slack of a corner of the polygon
};

// Returns the triangle of B nearest to a measured point, or the first one of several.
template <class T> std::size_t Engine<T>::nearest(std::size_t point) const {
    const FrameLanes<T> d;
    const T* const squares = c_.squares(point);
    const std::size_t count = all_.count(), whole = count - count % hn::Lanes(d);
    auto all = hn::Set(d, std::numeric_limits<T>::infinity());
    for (std::size_t k = 0; k < whole; k += hn::Lanes(d)) all = hn::Min(all, hn::LoadU(d, squares + k));
    T least = hn::GetLane(hn::MinOfLanes(d, all));
    for (std::size_t k = whole; k < count; ++k) least = std::min(least, squares[k]);
    for (std::size_t k = 0; k < whole; k += hn::Lanes(d)) {
        const unsigned here = mask_bits<T>(hn::Eq(hn::LoadU(d, squares + k), hn::Set(d, least)));
        if (here != 0) return k + static_cast<std::size_t>(std::countr_zero(here));
    }
    return static_cast<std::size_t>(std::find(squares + whole, squares + count, least) - squares);
}

// Makes a polygon the current one. `rows`: the rows of its corners; null if they are not measured yet.
template <class T> void Engine<T>::begin(const Polygon<T>& polygon, const std::size_t* rows) {
    piece_ = polygon;
    used_ = 0;
    slow_ = 0;
    peels_ = 0;
    for (std::size_t i = 0; i < piece_.count; ++i) {
        if (rows) {
            row_[i] = rows[i];
            if (WATCHED("offset cover: rows that a part of a cut polygon keeps are not used again",
                        rows[i] >= most_shared_points))
                used_ |= 1U << (rows[i] - most_shared_points);
        } else {
            row_[i] = take_row();
            measure_row(c_, all_, row_[i], piece_.x[i], piece_.y[i], piece_.z[i]);
        }
    }
}

template <class T> CoverResult Engine<T>::run(const Polygon<T>& piece, const std::size_t* shared) {
    const std::size_t mark = c_.proof ? c_.proof->mark() : 0;
    const CoverResult result = cover(piece, shared);
    if (c_.proof && !result.covered) c_.proof->back_to(mark);
    return result;
}

template <class T> CoverResult Engine<T>::cover(const Polygon<T>& piece, const std::size_t* shared) {
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
            settle();  // a corner is not provably within the threshold, not even after it was measured
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
    const Polygon<T> polygon = c_.stack.back();
    c_.stack.pop_back();
    begin(polygon, nullptr);
    return true;
}

// Finishes the polygon with the least upper bound that a single triangle of B gives, even if it is above the threshold.
// The distance to a triangle is convex, so its largest value over the polygon is at a corner.
template <class T> void Engine<T>::settle() {
    double least = std::numeric_limits<double>::infinity();
    std::size_t best = 0;
    for (std::size_t k = 0; k < all_.count(); ++k) {
        const double bound = at_most(largest_square(k), k);
        if (bound < least) {
            least = bound;
            best = k;
        }
    }
    covered_by(best, least);
}

// Returns whether all corners, and so the whole polygon, are within the threshold of one triangle of B.
template <class T> bool Engine<T>::one_for_all() {
    ++c_.tests;
    const Covering covering = covering_triangle(c_, *all_.frames, std::span(row_, piece_.count), upper_);
    if (covering.triangle == no_triangle) return false;
    covered_by(covering.triangle, covering.upper);
    return true;
}

// Calls Host::measure() to find the triangle of B nearest to a point of the piece, which may raise the threshold.
// Adds the triangle to `near`, or sets full_ if `near` is full. Updates distances and limits.
template <class T> void Engine<T>::ask(T x, T y, T z, double slack, std::size_t near) {
    const double point[3] = {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
    const Index triangle = host_->measure(point, slack, c_.near.triangle[near]);
    if (std::find(c_.near.triangle.begin(), c_.near.triangle.end(), triangle) == c_.near.triangle.end()) {
        if (c_.near.count() == NearTriangles<T>::most_triangles) {
            full_ = true;
            return;
        }
        std::vector<Index> triangles = c_.near.triangle;
        triangles.push_back(triangle);
        if constexpr (exact) set_frames(*target_, triangles, c_.near);
        c_.make_rows(most_shared_points + most_polygon_corners + 4);
        c_.set_threshold(host_->threshold());
        all_ = {&c_.near, c_.limit.data()};
        for (std::size_t i = 0; i < piece_.count; ++i)
            measure_row(c_, all_, row_[i], piece_.x[i], piece_.y[i], piece_.z[i]);
    } else {
        c_.set_threshold(host_->threshold());
        all_ = {&c_.near, c_.limit.data()};
        for (std::size_t i = 0; i < piece_.count; ++i) compare_row(c_, all_, row_[i]);
    }
}

// Returns whether every corner is within the threshold of some triangle of B that is tried. In double precision, calls
// ask() for a corner that is not, which may add a triangle or raise the threshold. If that does not help one corner, the
// others are asked about all the same: one of them may be farther than the cutoff.
template <class T> bool Engine<T>::every_corner_near() {
    std::size_t calls = 0;
    bool near = true;
    for (std::size_t i = 0;
         i < piece_.count &&
         WATCHED_ELSE("cover: one corner at the length ends the questions about the others", true, near);
         ++i) {
        if (!within(i).empty()) continue;
        if (!exact || full_ || ++calls > 2 * most_polygon_corners) return false;
        ask(piece_.x[i], piece_.y[i], piece_.z[i], piece_.slack[i], nearest(row_[i]));
        if (within(i).empty())
            near = false;
        else if (near)
            i = static_cast<std::size_t>(-1);  // start again: the near triangles of the other corners have changed, too
    }
    return near;
}

}  // namespace
}  // namespace hausbench::cover::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
