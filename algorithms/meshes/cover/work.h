// Does one part of the work of threshold cover (meshes/cover/cover.cpp): shows that triangles of A are within a
// threshold of B, in single precision, or in double precision if that is not enough.
//
// The results depend only on the part and on the lower bound at its start. So several may run at once, and
// their results, merged in order, are the same for any number of threads.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/deadline.h"
#include "algorithms/meshes/cover/offset_cover.h"
#include "algorithms/meshes/cover/scene.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace hausbench::cover {

// Scratch buffers of a Work, a few hundred kB. They come from a pool of this thread and return to it, because
// allocating them would take longer than a search in small meshes.
class Buffers {
public:
    struct Covers {
        OffsetCover<float> rough;
        OffsetCover<double> exact;
    };

    Buffers();
    ~Buffers();
    Buffers(Buffers&&) = default;

    Covers& operator*() const { return *covers_; }

private:
    std::unique_ptr<Covers> covers_;
};

class Work final : Host {
public:
    explicit Work(const Input& scene) : scene_(scene) {}
    Work(Work&&) = default;

    // Starts a new part. `farthest` gives the lower bound, `settled` is the largest upper bound accepted so far, and
    // `budget` is the number of cuts left. If `stopped`, the search has already ended, and everything in the part is
    // finished with the upper bound that it has.
    void begin(const Farthest& farthest, double settled, std::uint64_t budget, bool stopped, const Deadline& deadline);

    // Computes an upper bound on the distance of a group of triangles to B: the distance of its landmark (a point) plus
    // the distance from there to the farthest point of `box`. Measures a new landmark if that may help. Finishes the
    // group if the bound is at most tau. Otherwise adds it to Outcome::groups.
    void narrow(const Cluster& group, const Box& box);

    // Tries to show in single precision that the triangles of a cluster are within tau of B. Adds those for which this
    // fails, or parts of them, to Outcome::undecided.
    void cover(const Cluster& cluster);

    // Like cover() above, but for up to Batch::most_pieces pieces around a landmark. Several pieces must be whole
    // triangles of A, and some of them may go to `again_`, for cover(cluster) to try again. Public for tests.
    void cover(std::span<const Piece> pieces, const Landmark& landmark);

    // Computes an upper bound on the distance of a piece to B in double precision, and finishes the piece even if the
    // bound is larger than tau.
    void decide(const Piece& piece);

    Outcome finish();

    // If the search should stop, returns why: out of time, over budget, or distance above the cutoff.
    std::optional<Status> stopped() const { return stop_; }

private:
    // Implements Host for the piece that decide() is working on.
    Index measure(const double (&point)[3], double slack, Index near) override;
    double threshold() const override;
    bool promising(double distance) const override;
    bool go_on() override;

    MeasuredPoint measure(const Vec3& point, Index near, Index source, int level);
    void set_tau();
    double covered_within(double tau, int level) const;
    void look_at_clock();
    double around(const Vec3& at, double distance, const Box& box) const;
    bool from_partner(const Cluster& group, const Box& box, Landmark& landmark);
    Index middle_of(const Cluster& group) const { return scene_.order[group.begin + group.count / 2]; }
    Landmark central_corner(Index source, const Box& box) const;
    struct CornerBound {
        KnownUpper upper;
        double squared = 0;        // largest squared distance of a corner to the triangle, as computed
        std::size_t farthest = 0;  // the corner with this distance
    };
    CornerBound by_corners(const Piece& piece, Index near);
    void settle(double upper, Index source);
    void settle(const Piece& piece);
    void settle(const Cluster& cluster);
    std::array<Piece, 2> halve(const Piece& piece);
    bool is_open(Piece& half);

    void fetch_after(std::size_t begin);
    bool cover_together(std::span<const Piece> pieces, const Landmark& landmark, bool all_near);
    bool is_of_b(const Piece& piece, const std::array<std::size_t, 3>& points);
    bool is_one_of(const Piece& piece, const NearSet& triangles);
    bool covered_in_double(const Piece& piece, const std::array<std::size_t, 3>& points);
    void cover_from_own(std::span<const Piece> pieces, const Landmark& landmark);
    bool decide_whole(const Piece& piece);
    void count();

    Input scene_;
    const Deadline* deadline_ = nullptr;
    Outcome outcome_;
    double tau_ = 0, settled_before_ = 0;
    bool within_floor_ = false;  // whether h(A,B) may still be proven to be at most the floor, which is the cutoff
    std::uint64_t budget_ = 0;
    std::optional<Status> stop_;
    Buffers buffers_;
    OffsetCover<float>& cover_ = (*buffers_).rough;
    OffsetCover<double>& exact_ = (*buffers_).exact;
    std::vector<Piece> pieces_, again_;
    std::size_t batch_ = 0;     // number of pieces to cover together next
    std::size_t gathered_ = 0;  // largest number of triangles of B gathered for a part of the last batch
    bool crowded_ = false;      // whether the last gathering found more triangles of B than can be used
    Index source_ = -1;         // the triangle of A with the piece that decide() is working on
    int level_ = 0;             // the level of this piece
};

}  // namespace hausbench::cover
