#include "algorithms/meshes/distribution/dissection.h"

#include "algorithms/kernel/point_triangle.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/distribution/cuts.h"
#include "algorithms/meshes/distribution/weights.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace hausbench::distribution {
namespace {

constexpr std::size_t most_near = 224;  // triangles of B near a piece; with more, the piece is halved
constexpr std::size_t pieces_of_part = 32,
                      pieces_of_round = 64 * pieces_of_part;  // of a thread at a time; between two looks at the clock
constexpr std::size_t work_between_looks = 8192;              // triangles that a thread gathers or compares
constexpr int most_cuts = 200;
// After so many cuts a piece is only halved, because cuts where the nearest triangle changes can make ever thinner
// slivers that stay as long.
constexpr int most_cuts_at_change = 60;

}  // namespace

SpreadBounds spread_about(const AffineBounds& b, double about) {
    const auto mean_of_square = [](const CornerValues& x) {
        return (x[0] * x[0] + x[1] * x[1] + x[2] * x[2] + x[0] * x[1] + x[1] * x[2] + x[2] * x[0]) / 6;
    };
    // |d - about - middle| <= radius, and both `middle` and `radius` are affine. So (d - about)^2 and middle^2 differ by
    // at most 2 |middle| radius + radius^2.
    //
    // `radius` includes all rounding errors. Let u be the unit roundoff, e = upper + about at a corner, r = half of the gap
    // there, and m = |middle| <= e. `middle` errs by u * upper + u * m <= 2u e, and computing `radius` costs u e. So of
    // the 16u e that it has on top of r, 12u e are left. Half of them, as r <= e / 2, are 12u of r: more than the errors
    // of `first` (4u), of the mean of the square of `radius` (7u) and of the sums (2u). The other half adds 12u * (the
    // largest m) * (the mean of e) to `first`, which is at least 12u * (the mean of middle^2 with the absolute terms),
    // because that mean is at most (the largest m) * (the mean of m). The computed mean errs by 7u of it and the sums by
    // 2u. So no factor for rounding is needed there.
    //
    // `rounding` times the sum of the absolute terms bounds the rounding errors of the other sums below: 16u.
    constexpr double rounding = 16 * unit_roundoff;
    CornerValues middle, radius;
    double most = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double low = std::max(b.lower[k], 0.0);
        middle[k] = 0.5 * (low + b.upper[k]) - about;
        radius[k] = 0.5 * (b.upper[k] - b.lower[k]) + WATCHED("distribution: rounding of the middle of a spread",
                                                              16 * unit_roundoff * (b.upper[k] + about));
        most = std::max(most, std::abs(middle[k]));
    }
    const bool crosses = std::min({b.lower[0], b.lower[1], b.lower[2]}) < 0;
    SpreadBounds spread{};
    if (!crosses) {
        const double square = mean_of_square(middle), wide = (radius[0] + radius[1] + radius[2]) / 3;
        const double first = 2 * most * wide;
        spread = {square - first, square + first + mean_of_square(radius)};
    } else {
        CornerValues far;
        for (std::size_t k = 0; k < 3; ++k) far[k] = std::max(std::abs(b.upper[k] - about), std::abs(about));
        spread = {0, mean_of_square(far) * (1 + WATCHED("distribution: rounding of a spread near contact", rounding))};
    }
    const auto by = [&](double square, double mean, double outward) {
        const double twice = 2 * about * mean, last = about * about;
        return square - twice + last +
               WATCHED("distribution: rounding of a spread from means",
                       outward * rounding * (std::abs(square) + std::abs(twice) + last));
    };
    spread.lower = std::max({0.0, spread.lower, by(b.square_lower, b.mean_upper, -1)});
    spread.upper = std::max(0.0, std::min(spread.upper, by(b.square_upper, b.mean_lower, 1)));
    return spread;
}

double open_in(const AffineBounds& b, double low, double high) {
    if (b.least() > high || b.most() <= low) return 0;
    const auto open_at = [&](double t) {
        return std::max(0.0, 1 - share_at_most(b.upper, t) - share_above(b.lower, t));
    };
    if (low == high) return open_at(low);
    return (open_at(low) + open_at(low + 0.5 * (high - low)) + open_at(high)) / 3;
}

bool CutWhere::operator()(const AffineBounds& b, double weight) const {
    if (weight * (b.mean_upper - b.mean_lower) > mean) return true;
    if (weight * (b.square_upper - b.square_lower) > square) return true;
    if (b.most() > maximum && b.most() - std::max({b.lower[0], b.lower[1], b.lower[2]}) > maximum_gap) return true;
    for (const Spread& spread : spreads) {
        const SpreadBounds here = spread_about(b, spread.about);
        if (weight * (here.upper - here.lower) > spread.limit) return true;
    }
    for (const Band& band : bands)
        if (weight * open_in(b, band.low, band.high) > band.limit) return true;
    return false;
}

// Cuts pieces, each down to pieces within the limits.
class Dissection::Worker {
public:
    Worker(const Dissection& all, const CutWhere& where, const Stop& stop, std::size_t most)
        : all_(all), where_(where), stop_(stop), most_(most), bounder_(all.magnitude_) {}

    // Cuts a piece into at most about `most` parts. Once it was told to stop, keeps the bounds that a piece has, or gives
    // it rough ones if it has none (`first`).
    void open(const Leaf& leaf, bool first) {
        if (stopped_) {
            leaves_.push_back(
                WATCHED_ELSE("distribution: the next piece forgets its bounds when it is told to stop", first, true)
                    ? all_.unknown(leaf.piece)
                    : leaf);
            return;
        }
        enough_ = leaves_.size() + most_;
        gather_and_cut(leaf.piece);
    }

    std::vector<Leaf> take_leaves() { return std::exchange(leaves_, {}); }

    Counters take_counters() {
        counters_.point_triangle_distances += std::exchange(bounder_.distances, 0);
        return std::exchange(counters_, {});
    }

private:
    // Returns whether this piece is cut. `near` triangles were compared for its bounds. Asks now and then whether to stop.
    bool is_cut(const Piece& piece, const AffineBounds& bounds, std::size_t near) {
        ++counters_.bound_tests;
        work_ += 16 + near + WATCHED("distribution: searches do not count as work", std::exchange(searched_, 0));
        if (work_ >= work_between_looks) {
            work_ = 0;
            stopped_ = stopped_ || stop_(all_.count() + leaves_.size());
            if (stopped_) enough_ = 0;
        }
        return leaves_.size() < enough_ && where_(bounds, all_.weight_of(piece));
    }

    void emit(const Piece& piece, const AffineBounds& bounds, bool final) {
        leaves_.push_back({piece, bounds, all_.weight_of(piece), final});
    }

    bool too_small(const Piece& piece) const {
        double edge = 0;
        for (std::size_t k = 0; k < 3; ++k)
            edge = std::max(edge, squared_length(piece.corners[(k + 1) % 3] - piece.corners[k]));
        return piece.cuts >= most_cuts || !(edge > std::pow(1024 * unit_roundoff * all_.magnitude_, 2));
    }

    // Returns whether the bounds of a piece are as close as rounding allows. Then cutting it would make them worse. A lower
    // value below 0 counts as it is unless all upper values are nearly 0, because inside the piece the distance may be far
    // above the affine function with that value.
    bool only_rounding(const Piece& piece, const AffineBounds& bounds) const {
        const double gap = (64 + 8 * piece.level) * unit_roundoff * all_.magnitude_;
        bool close = true, zero = true;
        for (std::size_t k = 0; k < 3; ++k) {
            close =
                close && bounds.upper[k] - WATCHED_ELSE("distribution: lower bounds below 0 always count as rounding",
                                                        bounds.lower[k], std::max(bounds.lower[k], 0.0)) <=
                             gap;
            zero = zero && bounds.upper[k] <= gap;
        }
        return close || WATCHED("distribution: lower bounds below 0 never count as rounding", zero);
    }

    // The work of all searches so far.
    std::size_t searches() const { return counters_.node_visits + counters_.point_triangle_distances; }

    void gather_and_cut(Piece piece) {
        if (stopped_) {
            const Index near = std::max<Index>(piece.near, 0);
            return emit(piece, bounder_.rough(piece, triangle_of(all_.target_.mesh(), near), 0), false);
        }
        const std::size_t before = searches();
        const Vec3 c = piece.centre();
        double squared;
        bool exact = false;
        const auto nearest = [&] {
            const ClosestPoint at = all_.target_.closest(c, {.warm_triangle = piece.near}, counters_);
            piece.near = at.triangle;
            squared = at.squared_distance;
            exact = true;
        };
        if (piece.near < 0)
            nearest();
        else
            squared = closest_point(c, triangle_of(all_.target_.mesh(), piece.near)).squared_distance;
        Box box;
        for (const Vec3& corner : piece.corners) box.add(corner);
        LocalUnits place;
        place.set(box, all_.magnitude_ * 0x1p-40);
        near_.clear(place);
        near_.most = most_near;
        all_.target_.gather(c, reach_of(piece, squared, all_.magnitude_), near_, counters_);
        if (near_.count() > most_near) {
            if (!exact) nearest();
            const double least = all_.target_.certified_distance(c, counters_);
            searched_ += searches() - before;
            const AffineBounds bounds = bounder_.rough(piece, triangle_of(all_.target_.mesh(), piece.near), least);
            const bool small = too_small(piece);
            if (!is_cut(piece, bounds, near_.count()) || small) return emit(piece, bounds, small);
            for (const Piece& half : halves(piece)) gather_and_cut(half);
            return;
        }
        searched_ += searches() - before;
        triangles_.clear();
        std::vector<std::uint16_t>& among = lists_at(0);
        among.clear();
        for (std::size_t i = 0; i < near_.count(); ++i) {
            triangles_.push_back({triangle_of(all_.target_.mesh(), near_.triangle[i]), near_.triangle[i]});
            among.push_back(static_cast<std::uint16_t>(i));
            if (near_.triangle[i] == piece.near) std::swap(among[0], among.back());
        }
        cut(piece, 0);
    }

    void cut(Piece piece, std::size_t depth) {
        const AffineBounds bounds = bounder_.bounds(piece, triangles_, lists_at(depth));
        piece.near = triangles_[bounder_.kept()[0]].index;
        if (!is_cut(piece, bounds, lists_at(depth).size())) return emit(piece, bounds, false);
        if (too_small(piece) || only_rounding(piece, bounds)) return emit(piece, bounds, true);
        lists_at(depth + 1) = bounder_.kept();
        ++counters_.subdivisions;
        Parts parts;
        if (WATCHED_ELSE("distribution: slivers are halved", piece.cuts < most_cuts_at_change, true))
            parts = cut_at_change(piece, triangles_, lists_at(depth + 1), bounder_.kept_squares(), all_.magnitude_);
        if (parts.count > 0) {
            for (const Piece& part : parts) cut(part, depth + 1);
        } else {
            for (const Piece& half : halves(piece)) cut(half, depth + 1);
        }
    }

    std::vector<std::uint16_t>& lists_at(std::size_t depth) {
        while (lists_.size() <= depth) lists_.emplace_back(new std::vector<std::uint16_t>);
        return *lists_[depth];
    }

    const Dissection& all_;
    const CutWhere& where_;
    const Stop& stop_;
    std::size_t most_, enough_ = 0;
    std::size_t work_ = 0, searched_ = 0;  // since the last look at the clock, and in searches of the current piece
    bool stopped_ = false;
    MeanBounder bounder_;
    std::vector<Leaf> leaves_;
    Counters counters_;
    NearTriangles<float> near_;
    std::vector<NearbyTriangle> triangles_;
    std::vector<std::unique_ptr<std::vector<std::uint16_t>>> lists_;
};

Triangles both_orders(const Triangles& triangles, const Points& points) {
    const Eigen::Index n = triangles.rows();
    Triangles both(2 * n, 3);
    for (Eigen::Index i = 0; i < n; ++i) {
        const Index a = triangles(i, 0);
        const bool first = points.row(a) != points.row(triangles(i, 1));
        const Index b = triangles(i, first ? 1 : 2);
        both.row(i) << a, b, b;
        both.row(n + i) << WATCHED_ELSE(
            "distribution: a segment counts in both orders, so that all its parts count alike", b, a),
            a, a;
    }
    return both;
}

Dissection::Dissection(const Triangles& triangles, const Points& points, const TriangleBlocks& target, double magnitude,
                       CountedBy weigh, int threads)
    : triangles_(triangles),
      points_(points),
      target_(target),
      magnitude_(magnitude),
      threads_(threads),
      counted_(weigh == CountedBy::points) {
    weights_.assign(static_cast<std::size_t>(triangles.rows()), 1);
    if (counted_) return;
    const double inverse = magnitude > 0 ? std::ldexp(1.0, -std::ilogb(magnitude) - 1) : 1;
    for (Eigen::Index i = 0; i < triangles.rows(); ++i) {
        const auto v = triangles.row(i);
        const Triangle t{inverse * Vec3(points.row(v[0])), inverse * Vec3(points.row(v[1])),
                         inverse * Vec3(points.row(v[2]))};
        const Area area = weigh == CountedBy::length ? length_of(t) : area_of(t);
        weights_[static_cast<std::size_t>(i)] = area.value;
        extra_ += area.extra;
    }
    extra_ *= 1 + 0x1p-20;
}

// A leaf for a piece that there was no time to look at: the distance to some triangle of B is an upper bound.
Leaf Dissection::unknown(const Piece& piece) const {
    return {piece, MeanBounder(magnitude_).rough(piece, triangle_of(target_.mesh(), 0), 0), weight_of(piece), false};
}

Leaf Dissection::uncut(std::size_t triangle) const {
    const auto i = static_cast<Index>(triangle);
    const auto v = triangles_.row(i);
    return {{{points_.row(v[0]), points_.row(v[1]), points_.row(v[2])}, 1, i, -1, 0, 0}, {}, 0, false};
}

bool Dissection::refine(const CutWhere& where, const Stop& stop, std::size_t most_leaves) {
    std::vector<Leaf> open;
    const bool first = leaves_.empty();
    if (!first) {
        std::size_t left = 0;
        for (const Leaf& leaf : leaves_) {
            if (!leaf.final && where(leaf.bounds, leaf.weight))
                open.push_back(leaf);
            else
                leaves_[left++] = leaf;
        }
        leaves_.resize(left);
    }
    const std::size_t count = first ? static_cast<std::size_t>(triangles_.rows()) : open.size();
    if (count == 0) return false;
    const auto nth = [&](std::size_t i) { return first ? uncut(i) : open[i]; };
    const std::size_t room = most_leaves - std::min(most_leaves, leaves_.size());
    const std::size_t most = 16 + 4 * room / count;  // of one piece; few pieces are cut into so many
    std::vector<std::unique_ptr<Worker>> workers(static_cast<std::size_t>(threads_.most()));
    for (std::size_t begin = 0; begin < count; begin += pieces_of_round) {
        const std::size_t end = std::min(count, begin + pieces_of_round);
        open_ = count - begin;
        if (stop(this->count())) {
            leaves_.reserve(leaves_.size() + count - begin);
            for (std::size_t i = begin; i < count; ++i) leaves_.push_back(first ? unknown(nth(i).piece) : open[i]);
            break;
        }
        const std::size_t parts = (end - begin + pieces_of_part - 1) / pieces_of_part;
        std::vector<std::vector<Leaf>> made(parts);
        std::vector<Counters> counters(parts);
        threads_.for_each(parts, [&](std::size_t p, int number) {
            std::unique_ptr<Worker>& worker = workers[static_cast<std::size_t>(number)];
            if (!worker) worker = std::make_unique<Worker>(*this, where, stop, most);
            const std::size_t from = begin + p * pieces_of_part;
            for (std::size_t i = from; i < std::min(end, from + pieces_of_part); ++i) worker->open(nth(i), first);
            made[p] = worker->take_leaves();
            counters[p] = worker->take_counters();
        });
        for (std::size_t p = 0; p < parts; ++p) {
            leaves_.insert(leaves_.end(), made[p].begin(), made[p].end());
            counters_ += counters[p];
        }
    }
    open_ = 0;
    return true;
}

}  // namespace hausbench::distribution
