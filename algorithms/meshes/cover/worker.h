// Covers parts of A for threshold cover (meshes/cover/cover.cpp): clusters of triangles in single precision, then the
// undecided pieces in double precision.
//
// A worker starts from a given lower bound and collects its results in a CoverOutcome. They depend only on the part
// and that bound, so several workers may run at once, and merging outcomes in the order of the parts gives the same
// result for any number of threads.
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

namespace hausbench {

// Scratch buffers for covering, a few hundred kB. Each thread keeps returned ones, because allocating them anew would
// take longer than a search among small shapes.
class CoverRoom {
public:
    struct Covers {
        OffsetCover<float> rough;
        OffsetCover<double> exact;
    };

    CoverRoom();
    ~CoverRoom();
    CoverRoom(CoverRoom&&) = default;

    Covers& operator*() const { return *covers_; }

private:
    std::unique_ptr<Covers> covers_;
};

class CoverWorker final : CoverHost {
public:
    explicit CoverWorker(const CoverScene& scene) : scene_(scene) {}
    CoverWorker(CoverWorker&&) = default;

    // Starts a new part. `settled` is the largest upper bound so far, `budget` the number of cuts left. If `stopped`,
    // time is already out, and everything is settled by the bounds it has.
    void begin(const Farthest& farthest, double settled, std::uint64_t budget, bool stopped, const Deadline& deadline);

    // Bounds a group that knows at most a landmark, which may be its parent's. Settles it, or adds it to the
    // outcome's groups with a better bound.
    void narrow(const Cluster& group, const Box& box);

    // Settles the triangles of a cluster, or leaves some undecided.
    void cover(const Cluster& cluster);

    // Does the same for up to CoverBatch::most_pieces pieces near a landmark; if there are several, they must be
    // whole triangles. Public for tests.
    void cover(std::span<const CoverPiece> pieces, const Landmark& landmark);

    // Settles a piece in double precision. Always ends.
    void decide(const CoverPiece& piece);

    CoverOutcome finish();

    // Returns the reason if time or budget ran out.
    std::optional<Status> stopped() const { return stop_; }

private:
    // CoverHost, for the piece being decided.
    Index measure(const double (&point)[3], double slack, Index near) override;
    double threshold() const override;
    bool promising(double distance) const override;
    bool go_on() override;

    MeasuredPoint measure(const Vec3& point, Index near, Index source, int level);
    void set_tau();
    double covered_within(int level) const;
    void look_at_clock();
    double around(const Vec3& at, double distance, const Box& box) const;
    bool from_partner(const Cluster& group, const Box& box, Landmark& landmark);
    Index middle_of(const Cluster& group) const { return scene_.order[group.begin + group.count / 2]; }
    Landmark central_corner(Index source, const Box& box) const;
    struct CornerBound {
        KnownUpper upper;
        double squared = 0;        // the largest distance of a corner to the triangle, as computed
        std::size_t farthest = 0;  // that corner
    };
    CornerBound by_corners(const CoverPiece& piece, Index near);
    void settle(double upper, Index source);
    void settle(const CoverPiece& piece);
    void settle(const Cluster& cluster);
    std::array<CoverPiece, 2> halve(const CoverPiece& piece);
    bool is_open(CoverPiece& half);

    bool cover_together(std::span<const CoverPiece> pieces, const Landmark& landmark, bool all_near);
    void cover_from_own(std::span<const CoverPiece> pieces, const Landmark& landmark);
    bool decide_whole(const CoverPiece& piece);
    void count();

    CoverScene scene_;
    const Deadline* deadline_ = nullptr;
    CoverOutcome outcome_;
    double tau_ = 0, settled_before_ = 0;
    std::uint64_t budget_ = 0;
    std::optional<Status> stop_;
    CoverRoom room_;
    OffsetCover<float>& cover_ = (*room_).rough;
    OffsetCover<double>& exact_ = (*room_).exact;
    std::vector<CoverPiece> pieces_, again_;
    std::size_t batch_ = 0;     // number of pieces covered together
    std::size_t gathered_ = 0;  // largest number of triangles of B near the last pieces
    bool crowded_ = false;      // and they were too many
    Index source_ = -1;         // of the piece being decided
    int level_ = 0;
};

}  // namespace hausbench
