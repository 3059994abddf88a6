// Bounds on statistics (statistic.h), from the pieces of one or both shapes.
#pragma once

#include "algorithms/meshes/distribution/dissection.h"
#include "algorithms/solver.h"

#include <span>
#include <vector>

namespace hausbench::distribution {

// The statistics of the leaves of one dissection, or of several together: each leaf counts with its weight. Every
// result holds under rounding.
class Statistics {
public:
    // Keeps the spans. `extra_weight` is the sum of Dissection::extra_weight(); `counted` tells that every weight is
    // exactly 1. O(n).
    Statistics(std::vector<std::span<const Leaf>> leaves, double extra_weight, bool counted);

    // O(n) each; a quantile takes several times as long as the others.
    Bounds of(const Statistic& statistic) const;

    // The sum of all weights, as computed.
    double weight() const { return weight_; }

    // For a mean, rms or deviation: the sum over all leaves of weight times gap, of the quantity that CutWhere limits.
    // For a quantile between `band.lower` and `band.upper`: the same for this band.
    double open(const Statistic& statistic, const Bounds& band) const;

    // The value around which deviation is computed, near the mean.
    double about() const { return about_; }

    // Returns the largest sum open() with which the gap of a statistic is at most `gap`, if its bounds are in proportion
    // to that sum.
    double allowed(const Statistic& statistic, const Bounds& bounds, double gap) const;

    // Adds to `where` that pieces must be cut until their gaps are at most `limit`, for a statistic with these bounds
    // whose gap may be `gap`.
    void cut(const Statistic& statistic, const Bounds& bounds, double gap, double limit, CutWhere& where) const;

private:
    // A leaf in the little memory that is needed where its distances are all on one side of a length.
    struct Extent {
        double least, most, weight;
        const Leaf* leaf;
    };

    template <class Of> double sum(const Of& of) const;
    double open_between(double low, double high) const;
    Bounds share_within(double length) const;
    Bounds quantile(double level) const;
    Bounds mean_of(double lower, double upper, double most) const;
    double share_at_least(double within) const;
    double share_at_most_beside(double beyond) const;

    std::vector<std::span<const Leaf>> leaves_;
    std::vector<Extent> extents_;  // of all leaves
    double extra_;
    bool counted_;
    double weight_, about_ = 0;
    double least_ = 0, most_ = 0, most_at_least_ = 0;
    Bounds mean_, square_;
};

}  // namespace hausbench::distribution
