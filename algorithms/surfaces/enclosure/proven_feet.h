// Proven points of B, and a search for the one nearest to a point that also proves that no point of B is much nearer.
//
// All functions require UpwardRounding (kernel/interval.h).
#pragma once

#include "algorithms/kernel/deadline.h"
#include "algorithms/surfaces/surface_tree.h"

#include <span>
#include <vector>

namespace hausbench {

// The accuracy of a search for the nearest point of B.
struct FootSearch {
    double precision;  // the result may be below the distance by this much
    // The search ends once the distance is known to be at most `lower - cell_size`: then no point of a cell of this
    // size is farther than `lower`.
    double lower, cell_size;
};

struct NearestFoot {
    std::int32_t foot = -1;  // the nearest proven point found; -1: none
    double at_least = 0;     // lower bound of the distance to B
};

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

    // Returns an upper bound of the distance from the piece to B.
    double at_most(const SurfaceTree::Node& piece, std::int32_t foot);

    // Finds the proven point nearest to p. `known` are feet of points near p, used as a start.
    NearestFoot nearest(const Vec3& p, std::span<const std::int32_t> known, const FootSearch& search);

private:
    struct Best {
        double at_most = std::numeric_limits<double>::infinity();  // upper bound of the distance to the foot
        std::int32_t foot = -1;
    };
    void descend_from(const Vec3& seed, const Vec3& p, Best& best);
    double at_least(const Vec3& p, const FootSearch& search, Best& best);

    SurfaceTree tree_;
    const Deadline& deadline_;
    Counters& counters_;
    std::vector<SurfacePoint> feet_;
};

}  // namespace hausbench
