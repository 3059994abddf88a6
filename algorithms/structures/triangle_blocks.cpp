#include "algorithms/structures/triangle_blocks.h"

#include "algorithms/kernel/morton.h"
#include "algorithms/kernel/pages.h"
#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hausbench {

namespace {

// The least unit of local coordinates (LocalUnits), as a fraction of the largest |coordinate| of the mesh.
constexpr double least_unit_of_magnitude = 0x1p-100;

constexpr std::size_t least_of_block = 4096;  // a thread processes at least so many triangles at a time

}  // namespace

void LocalUnits::set(const Box& box, double least) {
    double half = least;
    for (int k = 0; k < 3; ++k) {
        origin[k] = 0.5 * (box.low[k] + box.high[k]);
        half = std::max({half, box.high[k] - origin[k], origin[k] - box.low[k]});
    }
    // The next larger power of two has the exponent of `half` plus one.
    const std::uint64_t exponent = (std::bit_cast<std::uint64_t>(half) >> 52) + 1;
    unit = std::bit_cast<double>(exponent << 52);
    inverse = std::bit_cast<double>((2046 - exponent) << 52);
    magnitude = 0;
    for (const double x : origin) magnitude = std::max(magnitude, std::abs(x));
    magnitude += unit;
}

TriangleOrder::TriangleOrder(const TriangleMesh& mesh, const Threads& threads) {
    const auto count = static_cast<std::size_t>(mesh.triangles.rows());
    Points centres(mesh.triangles.rows(), 3);
    touch_pages(centres.data(), static_cast<std::size_t>(centres.size()) * sizeof(double));
    std::vector<Box> boxes(blocks_of(count, least_of_block));
    threads.for_each(boxes.size(), [&](std::size_t block) {
        const Part mine = part(count, block, boxes.size());
        for (std::size_t i = mine.begin; i < mine.end; ++i) {
            const Triangle t = triangle_of(mesh, static_cast<Index>(i));
            const Vec3 centre = (t.a + t.b + t.c) / 3;
            centres.row(static_cast<Eigen::Index>(i)) = centre;
            boxes[block].add(centre);
        }
    });
    Box box;
    for (const Box& block_box : boxes) box.add(block_box);
    order = hilbert_order(centres, MortonFrame(box), threads);
}

namespace {

// Removes each triangle that has the same corners as its predecessor, in the same order. This changes no answer,
// because ties go to the lowest index, which comes first among copies. A large stack of copies would put more triangles
// near a point than NearTriangles can hold.
std::vector<Index> without_copies(const TriangleMesh& mesh, std::vector<Index> order) {
    const auto is_copy = [&](Index i, Index j) {
        for (Index k = 0; k < WATCHED_ELSE("triangle blocks: a copy has all three corners", 3, 1); ++k)
            if (mesh.vertices.row(mesh.triangles(i, k)) != mesh.vertices.row(mesh.triangles(j, k))) return false;
        return true;
    };
    order.erase(std::unique(order.begin(), order.end(), is_copy), order.end());
    return order;
}

// Consecutive triangles along the Hilbert curve that become one leaf, and the box around them.
struct Run {
    std::size_t begin, end;
    Box box;
};

double longest_side(const Box& box) { return (box.high - box.low).maxCoeff(); }

// A run is cut in two only if one part is at most this fraction of the whole in size. The size of several triangles is
// the longest side of the box around them.
constexpr double small_part = 0x1p-6;

Box box_of(const TriangleMesh& mesh, const std::vector<Index>& order, std::size_t begin, std::size_t end) {
    Box box;
    for (std::size_t i = begin; i < end; ++i) box.add(box_of(triangle_of(mesh, order[i])));
    return box;
}

// Returns the index at which to cut a run that mixes a dense cluster with distant triangles, so that each part gets
// local coordinates of its own. The cluster, whose size is at most small_part of the run, is at the beginning or else
// at the end. Returns `end` without a cluster.
std::size_t cut_of(const TriangleMesh& mesh, const std::vector<Index>& order, std::size_t begin, std::size_t end) {
    const double small = small_part * longest_side(box_of(mesh, order, begin, end));
    if (!(small > 0)) return end;
    Box box;
    for (std::size_t i = begin; i < end; ++i) {
        box.add(box_of(triangle_of(mesh, order[i])));
        if (longest_side(box) <= small) continue;
        if (i > begin) return i;
        break;
    }
    box = {};
    for (std::size_t i = end; i-- > begin;) {
        box.add(box_of(triangle_of(mesh, order[i])));
        if (longest_side(box) > small) return i + 1;
    }
    return end;
}

// Sixteen consecutive triangles along the Hilbert curve, fewer at its end. They become one leaf, or several if `mixed`
// is set.
struct Sixteen {
    Box box;
    bool mixed;  // the size of one quarter of them is at most small_part of the size of all
};

Sixteen sixteen(const TriangleMesh& mesh, const std::vector<Index>& order, std::size_t begin, std::size_t end) {
    Sixteen all;
    const std::size_t quarter = (end - begin + 3) / 4;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = begin; i < end; i += quarter) {
        const Box some = box_of(mesh, order, i, std::min(i + quarter, end));
        least = std::min(least, longest_side(some));
        all.box.add(some);
    }
    all.mixed = least <= small_part * longest_side(all.box);
    return all;
}

// Cuts the triangles along the Hilbert curve into runs of sixteen. A run of triangles with very different scales is cut
// further by cut_of(). This adds at most 4 + n / 256 runs, so the number of leaves stays near n / 16.
std::vector<Run> runs_of(const TriangleMesh& mesh, const std::vector<Index>& order, const Threads& threads) {
    auto all = filled<Sixteen>((order.size() + frames_width - 1) / frames_width);
    const std::size_t blocks = blocks_of(all.size(), least_of_block / frames_width);
    threads.for_each(blocks, [&](std::size_t block) {
        const Part mine = part(all.size(), block, blocks);
        for (std::size_t n = mine.begin; n < mine.end; ++n)
            all[n] = sixteen(mesh, order, n * frames_width, std::min((n + 1) * frames_width, order.size()));
    });
    std::vector<Run> runs;
    std::size_t spare = 4 + order.size() / (frames_width * frames_width);
    reserve_touched(runs, all.size() + spare);
    for (std::size_t n = 0; n < all.size(); ++n) {
        const std::size_t begin = n * frames_width, end = std::min(begin + frames_width, order.size());
        std::size_t at = begin;
        for (; all[n].mixed && at < end && spare > 0; --spare) {
            const std::size_t cut = cut_of(mesh, order, at, end);
            if (cut == end) break;
            runs.push_back({at, cut, box_of(mesh, order, at, cut)});
            at = cut;
        }
        runs.push_back({at, end, at == begin ? all[n].box : box_of(mesh, order, at, end)});
    }
    return runs;
}

void set_leaf(const TriangleMesh& mesh, const std::vector<Index>& order, const Run& run, double least_unit,
              TriangleFramesLeaf& leaf) {
    leaf.count = static_cast<std::int32_t>(run.end - run.begin);
    leaf.units.set(run.box, least_unit);
    CornerRows corners;
    for (std::size_t i = 0; i < frames_width; ++i) {
        leaf.triangle[i] = order[std::min(run.begin + i, run.end - 1)];
        const Triangle t = triangle_of(mesh, leaf.triangle[i]);
        const Vec3* const of[3] = {&t.a, &t.b, &t.c};
        for (std::size_t v = 0; v < 3; ++v)
            for (std::size_t k = 0; k < 3; ++k)
                corners.row[3 * v + k][i] =
                    ((*of[v])[static_cast<Index>(k)] - leaf.units.origin[k]) * leaf.units.inverse;
    }
    make_frames(corners, leaf.frames);
}

}  // namespace

TriangleBlocks::TriangleBlocks(const TriangleMesh& mesh, const Threads& threads) : mesh_(&mesh) {
    const std::vector<Index> order = without_copies(mesh, TriangleOrder(mesh, threads).order);
    const double least_unit = std::max(mesh.vertices.cwiseAbs().maxCoeff() * least_unit_of_magnitude, 0x1p-900);
    const std::vector<Run> runs = runs_of(mesh, order, threads);
    leaves_ = filled<TriangleFramesLeaf>(runs.size());
    auto boxes = filled<Box>(runs.size());
    std::vector<Box> below;
    const std::size_t blocks = blocks_of(runs.size(), least_of_block / frames_width);
    threads.for_each(blocks, [&](std::size_t block) {
        const Part mine = part(runs.size(), block, blocks);
        for (std::size_t i = mine.begin; i < mine.end; ++i) {
            set_leaf(mesh, order, runs[i], least_unit, leaves_[i]);
            boxes[i] = runs[i].box;
        }
    });
    std::size_t nodes = 0, level = runs.size();
    do {
        level = (level + frames_width - 1) / frames_width;
        nodes += level;
    } while (level > 1);
    reserve_touched(nodes_, nodes);
    do {
        below.swap(boxes);
        add_level(below, boxes, least_unit);
    } while (boxes.size() > 1);
}

void TriangleBlocks::add_level(const std::vector<Box>& below, std::vector<Box>& boxes, double least_unit) {
    level_begin_.push_back(nodes_.size());
    const std::size_t count = (below.size() + frames_width - 1) / frames_width;
    boxes.assign(count, Box());
    for (std::size_t n = 0; n < count; ++n) {
        BoxNode& node = nodes_.emplace_back();
        const std::size_t begin = n * frames_width, end = std::min(begin + frames_width, below.size());
        node.count = static_cast<std::int32_t>(end - begin);
        for (std::size_t c = begin; c < end; ++c) boxes[n].add(below[c]);
        node.units.set(boxes[n], least_unit);
        for (std::size_t k = 0; k < 3; ++k) {
            const auto local = [&](double x) {
                return static_cast<float>((x - node.units.origin[k]) * node.units.inverse);
            };
            for (std::size_t c = 0; c < frames_width; ++c) {
                const bool used = begin + c < end;
                const auto axis = static_cast<Index>(k);
                node.low[k][c] = used ? local(below[begin + c].low[axis]) -
                                            WATCHED("triangle blocks: planes of boxes, rounded", plane_error)
                                      : std::numeric_limits<float>::infinity();
                node.high[k][c] = used ? local(below[begin + c].high[axis]) +
                                             WATCHED("triangle blocks: planes of boxes, rounded", plane_error)
                                       : -std::numeric_limits<float>::infinity();
            }
        }
    }
}

namespace {

// Makes the frames (kernel/triangle_frames.h) of triangles[begin] to triangles[end - 1], in the local coordinates
// near.units. Unused lanes repeat the last triangle.
void frames_of(const TriangleMesh& mesh, const std::vector<Index>& triangles, std::size_t begin, std::size_t end,
               NearTriangles<double>& near) {
    CornerRows corners;
    for (std::size_t i = 0; i < frames_width; ++i) {
        const Triangle t = triangle_of(mesh, triangles[std::min(begin + i, end - 1)]);
        const Vec3* const of[3] = {&t.a, &t.b, &t.c};
        double size = 0;
        for (std::size_t v = 0; v < 3; ++v) {
            Vec3 local;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto axis = static_cast<Index>(k);
                corners.row[3 * v + k][i] = local[axis] = ((*of[v])[axis] - near.units.origin[k]) * near.units.inverse;
            }
            size = std::max(size, local.norm());
        }
        near.row(frame_row::count)[begin + i] =
            WATCHED("triangle blocks: the size of a triangle in the error of its frame",
                    size * (1 + 0x1p-20));  // R of near_error, rounded up
    }
    TriangleFrames<double> frames;
    make_frames(corners, frames);
    for (std::size_t i = 0; i < frame_row::count; ++i) std::copy_n(frames.row[i], frames_width, near.row(i) + begin);
}

}  // namespace

void set_frames(const TriangleMesh& mesh, const std::vector<Index>& triangles, NearTriangles<double>& near) {
    near.triangle = triangles;
    for (std::size_t begin = 0; begin < triangles.size(); begin += frames_width)
        frames_of(mesh, triangles, begin, std::min(begin + frames_width, triangles.size()), near);
}

std::size_t TriangleBlocks::bytes() const {
    return leaves_.capacity() * sizeof(TriangleFramesLeaf) + nodes_.capacity() * sizeof(BoxNode) +
           level_begin_.capacity() * sizeof(std::size_t);
}

}  // namespace hausbench
