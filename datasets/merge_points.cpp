#include "datasets/merge_points.h"

#include "algorithms/kernel/splitmix.h"

#include <array>
#include <bit>
#include <cstdint>
#include <unordered_map>

namespace hausbench {

Points rows_of(const Points& points, const std::vector<Index>& rows) {
    Points chosen(static_cast<Eigen::Index>(rows.size()), 3);
    for (std::size_t i = 0; i < rows.size(); ++i) chosen.row(static_cast<Eigen::Index>(i)) = points.row(rows[i]);
    return chosen;
}

std::vector<Index> first_equal(const Points& points) {
    using Coordinates = std::array<double, 3>;
    const auto hash = [](const Coordinates& p) {
        std::uint64_t mixed = 0;
        for (const double value : p) {
            mixed = (mixed ^ std::bit_cast<std::uint64_t>(value)) * golden_step;
            mixed ^= mixed >> 32;
        }
        return static_cast<std::size_t>(mixed);
    };
    const auto count = static_cast<std::size_t>(points.rows());
    std::unordered_map<Coordinates, Index, decltype(hash)> first(count, hash);
    std::vector<Index> firsts(count);
    for (Index v = 0; v < points.rows(); ++v) {  // + 0.0 turns -0 into +0
        const Coordinates p{points(v, 0) + 0.0, points(v, 1) + 0.0, points(v, 2) + 0.0};
        if (!points.row(v).allFinite()) {  // NaN equals nothing, so that many of them would fill one bucket
            firsts[static_cast<std::size_t>(v)] = v;
            continue;
        }
        firsts[static_cast<std::size_t>(v)] = first.try_emplace(p, v).first->second;
    }
    return firsts;
}

TriangleMesh without_unused(const Points& vertices, const Triangles& triangles) {
    std::vector<Index> becomes(static_cast<std::size_t>(vertices.rows()), -1), kept;
    for (const Index v : triangles.reshaped()) becomes[static_cast<std::size_t>(v)] = 0;
    for (std::size_t v = 0; v < becomes.size(); ++v) {
        if (becomes[v] < 0) continue;
        becomes[v] = static_cast<Index>(kept.size());
        kept.push_back(static_cast<Index>(v));
    }
    const auto renumbered = [&](Index v) { return becomes[static_cast<std::size_t>(v)]; };
    return {rows_of(vertices, kept), triangles.unaryExpr(renumbered)};
}

}  // namespace hausbench
