// Cuts one or two shapes into pieces until the statistics of a query are within its tolerance.
#pragma once

#include "algorithms/meshes/distribution/statistics.h"

#include <string>
#include <vector>

namespace hausbench::distribution {

// The elements of one shape, and the other shape. Keeps references.
struct OneWay {
    const Triangles& triangles;
    const Points& points;  // the vertices, moved by the pose
    const TriangleBlocks& other;
    CountedBy weigh;
};

struct Narrowed {
    Status status = Status::stalled;
    std::string note = {};
    std::vector<Bounds> bounds;  // of each statistic
    std::size_t pieces = 0;
    Counters counters;
    Witness witness;  // of the largest distance, if that is the first statistic, over A, over B, larger or pooled
};

// Bounds the statistics of `query`. `source` has the distances from A to B, `target` those from B to A; either may be
// null if no statistic needs it. `magnitude` is M of kernel/rounding.h, for both shapes. Cuts the pieces with the
// largest gaps first. The unit of Query::budget is one piece; a piece takes about 200 bytes. Shows the bounds after each
// round to the watcher of the trace, and before the first round those that follow from the boxes.
Narrowed narrow(const OneWay* source, const OneWay* target, double magnitude, const Query& query, Trace& trace);

// Combines the bounds of a statistic over A and over B. Every result holds under rounding.
Bounds combined(Statistic::Over over, const Bounds& source, const Bounds& target);

}  // namespace hausbench::distribution
