// The points of B that a search has proven to exist so far (SurfacePoint in surface_tree.h). They are called *feet*,
// because each is about the closest point of B to some point of A. A foot is identified by its index. A search finds
// the foot nearest to a point, and proves that no point of B is much nearer.
//
// The caller of every function must hold an UpwardRounding (kernel/interval.h), which sets the rounding mode.
#pragma once

#include "algorithms/kernel/deadline.h"
#include "algorithms/surfaces/surface_tree.h"

#include <span>
#include <vector>

namespace hausbench::surface_enclosure {

// How accurate a search for the nearest point of B must be, and when it may stop early.
struct FootSearch {
    double precision;  // by how much the lower bound may be below the distance to the foot
    // A search may stop once the distance from p to B is proven to be at most `lower - cell_size`, where `lower` is the
    // solver's lower bound so far. No point in a cell of A of this size can then be farther from B than `lower`.
    double lower, cell_size;
};

struct NearestFoot {
    std::int32_t foot = -1;  // the nearest foot found; -1: none
    double at_least = 0;     // lower bound on the distance to B
};

// The proven points of B found so far (feet), and the octree of B that the searches refine.
class ProvenFeet {
public:
    ProvenFeet(const SurfaceTree& target, const Deadline& deadline, Counters& counters)
        : tree_(target), deadline_(deadline), counters_(counters) {}

    SurfaceTree& tree() { return tree_; }
    const SurfaceTree& tree() const { return tree_; }
    bool empty() const { return feet_.empty(); }
    const SurfacePoint& operator[](std::int32_t foot) const { return feet_[static_cast<std::size_t>(foot)]; }
    std::int32_t add(const SurfacePoint& foot) {
        feet_.push_back(foot);
        return static_cast<std::int32_t>(feet_.size()) - 1;
    }

    // Returns an upper bound on the distance from any point of the piece to B: the largest distance from the piece to
    // this point of B.
    double at_most(const SurfaceTree::Node& piece, std::int32_t foot);

    // Finds a proven point of B that is about nearest to p, and a lower bound on the distance from p to B. Starts from
    // `near_feet`, the feet of points near p. May add feet.
    NearestFoot nearest(const Vec3& p, std::span<const std::int32_t> near_feet, const FootSearch& search);

private:
    struct Best {
        double at_most = std::numeric_limits<double>::infinity();  // upper bound on the distance to the foot
        std::int32_t foot = -1;
    };
    void descend_from(const Vec3& seed, const Vec3& p, Best& best);
    double at_least(const Vec3& p, const FootSearch& search, Best& best);

    SurfaceTree tree_;
    const Deadline& deadline_;
    Counters& counters_;
    std::vector<SurfacePoint> feet_;
};

}  // namespace hausbench::surface_enclosure
