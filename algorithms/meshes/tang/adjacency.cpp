#include "algorithms/meshes/tang/adjacency.h"

#include <algorithm>

namespace hausbench::tang {

Adjacency::Adjacency(const TriangleMesh& mesh) {
    // A side of a triangle, from corner k to corner k + 1 (mod 3).
    struct Half {
        Index high;          // the larger one of the two vertex numbers
        std::int32_t place;  // 3 * triangle + k
    };
    const auto halves_count = static_cast<std::size_t>(mesh.triangles.size());
    const auto vertices = static_cast<std::size_t>(mesh.vertices.rows());
    const auto ends = [&](std::size_t place) {
        const auto triangle = static_cast<Index>(place / 3);
        const int k = static_cast<int>(place % 3);
        const Index from = mesh.triangles(triangle, k), to = mesh.triangles(triangle, (k + 1) % 3);
        return std::pair(std::min(from, to), std::max(from, to));
    };

    // Sort the sides so that sides with the same edge are adjacent: a counting sort by the lower vertex index, then
    // std::sort by the higher index within each group.
    std::vector<std::int32_t> first(vertices + 1, 0);
    for (std::size_t place = 0; place < halves_count; ++place) ++first[static_cast<std::size_t>(ends(place).first) + 1];
    for (std::size_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
    std::vector<Half> halves(halves_count);
    std::vector<std::int32_t> next(first.begin(), first.end() - 1);
    for (std::size_t place = 0; place < halves_count; ++place) {
        const auto [low, high] = ends(place);
        halves[static_cast<std::size_t>(next[static_cast<std::size_t>(low)]++)] = {high,
                                                                                   static_cast<std::int32_t>(place)};
    }
    const auto before = [](const Half& a, const Half& b) {
        return a.high != b.high ? a.high < b.high : a.place < b.place;
    };

    edge_of_.resize(halves_count);
    triangles_.resize(halves_count);
    begin_.reserve(halves_count / 2 + 1);
    for (std::size_t v = 0; v < vertices; ++v) {
        std::sort(halves.begin() + first[v], halves.begin() + first[v + 1], before);
        for (auto i = static_cast<std::size_t>(first[v]); i < static_cast<std::size_t>(first[v + 1]); ++i) {
            const bool is_new = i == static_cast<std::size_t>(first[v]) || halves[i].high != halves[i - 1].high;
            if (is_new) begin_.push_back(static_cast<std::int32_t>(i));
            edge_of_[static_cast<std::size_t>(halves[i].place)] = static_cast<Index>(begin_.size()) - 1;
            triangles_[i] = halves[i].place / 3;
        }
    }
    begin_.push_back(static_cast<std::int32_t>(halves_count));
    begin_.shrink_to_fit();
}

std::size_t Adjacency::bytes() const {
    return edge_of_.capacity() * sizeof(Index) + begin_.capacity() * sizeof(std::int32_t) +
           triangles_.capacity() * sizeof(Index);
}

}  // namespace hausbench::tang
