#include "algorithms/surfaces/surface_mesh.h"

#include "algorithms/error.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/surfaces/surface_tree.h"

#include <algorithm>
#include <map>

namespace hausbench {
namespace {

// Triangulates one surface by marching tetrahedra.
class Marching {
public:
    Marching(const AlgebraicSurface& surface, int cells) : f_(Polynomial::of(surface)), cells_(cells) {
        for (int k = 0; k < 3; ++k) {
            for (int i = 0; i <= cells; ++i) {
                const double low = surface.box(0, k), high = surface.box(1, k);
                lines_[std::size_t(k)].push_back(i == cells ? high : low + (high - low) * i / cells);
            }
        }
        const std::size_t n = std::size_t(cells) + 1;
        positive_.resize(n * n * n);
        for (std::size_t v = 0; v < positive_.size(); ++v) positive_[v] = f_.value(corner(v)) >= 0;
    }

    TriangleMesh run() {
        // The six tetrahedra of a cell share its diagonal, from corner 0 to corner 7. Each has one of these pairs as
        // its other two corners: one pair for each order in which to walk from corner 0 to corner 7 along the three
        // axes.
        constexpr int orders[6][2] = {{1, 3}, {1, 5}, {2, 3}, {2, 6}, {4, 5}, {4, 6}};
        const std::size_t n = std::size_t(cells_) + 1;
        for (int z = 0; z < cells_; ++z) {
            for (int y = 0; y < cells_; ++y) {
                for (int x = 0; x < cells_; ++x) {
                    std::size_t corners[8];
                    bool some = false, all = true;
                    for (int c = 0; c < 8; ++c) {
                        corners[c] = (std::size_t(z + (c >> 2)) * n + std::size_t(y + (c >> 1 & 1))) * n +
                                     std::size_t(x + (c & 1));
                        some = some || positive_[corners[c]];
                        all = all && positive_[corners[c]];
                    }
                    if (!some || all) continue;
                    for (const auto& corner_order : orders)
                        tetrahedron({corners[0], corners[corner_order[0]], corners[corner_order[1]], corners[7]});
                }
            }
        }
        TriangleMesh mesh;
        std::vector<Index> renumbered(vertices_.size(), -1);
        std::vector<Vec3> used;
        mesh.triangles.resize(Index(triangles_.size()), 3);
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) {
                Index& at = renumbered[std::size_t(triangles_[t][k])];
                if (at < 0) {
                    at = Index(used.size());
                    used.push_back(vertices_[std::size_t(triangles_[t][k])]);
                }
                mesh.triangles(Index(t), Index(k)) = at;
            }
        }
        mesh.vertices.resize(Index(used.size()), 3);
        for (std::size_t v = 0; v < used.size(); ++v) mesh.vertices.row(Index(v)) = used[v];
        return mesh;
    }

private:
    Vec3 corner(std::size_t v) const {
        const std::size_t n = std::size_t(cells_) + 1;
        return {lines_[0][v % n], lines_[1][v / n % n], lines_[2][v / n / n]};
    }

    // Returns the vertex of the mesh on the edge from grid point a to grid point b: the point where the polynomial
    // changes sign.
    Index between(std::size_t a, std::size_t b) {
        const auto key = std::minmax(a, b);
        const auto [at, fresh] = edges_.emplace(key, Index(vertices_.size()));
        if (fresh) {
            Vec3 p = corner(key.first), q = corner(key.second);
            const bool sign = positive_[key.first];
            for (int step = 0; step < 50; ++step) {
                const Vec3 middle = 0.5 * (p + q);
                if (middle == p || middle == q) break;
                ((f_.value(middle) >= 0) == sign ? p : q) = middle;
            }
            vertices_.push_back(positive_[key.first] ? p : q);
        }
        return at->second;
    }

    void triangle(Index a, Index b, Index c) {
        const Vec3 &p = vertices_[std::size_t(a)], &q = vertices_[std::size_t(b)], &r = vertices_[std::size_t(c)];
        if (p != q && q != r && r != p) triangles_.push_back({a, b, c});
    }

    void tetrahedron(std::array<std::size_t, 4> v) {
        std::stable_partition(v.begin(), v.end(), [&](std::size_t i) { return positive_[i]; });
        const auto count = std::count_if(v.begin(), v.end(), [&](std::size_t i) { return bool(positive_[i]); });
        if (count == 1) triangle(between(v[0], v[1]), between(v[0], v[2]), between(v[0], v[3]));
        if (count == 3) triangle(between(v[3], v[0]), between(v[3], v[1]), between(v[3], v[2]));
        if (count != 2) return;
        const Index a = between(v[0], v[2]), b = between(v[0], v[3]), c = between(v[1], v[3]), d = between(v[1], v[2]);
        triangle(a, b, c);
        triangle(a, c, d);
    }

    Polynomial f_;
    int cells_;
    std::array<std::vector<double>, 3> lines_;  // grid lines, for each axis
    std::vector<char> positive_;                // for each corner of the grid: whether the polynomial is >= 0
    std::map<std::pair<std::size_t, std::size_t>, Index> edges_;
    std::vector<Vec3> vertices_;
    std::vector<std::array<Index, 3>> triangles_;
};

double apart(const Vec3& p, const Vec3& q) {  // an upper bound, because the mode rounds up
    return std::sqrt((q - p).cwiseAbs().cwiseMax((p - q).cwiseAbs()).squaredNorm());
}

// Computes the bounds of deviation().
class Deviation {
public:
    Deviation(const AlgebraicSurface& surface, const TriangleMesh& mesh, int cells)
        : mesh_(mesh), cells_(cells), tree_(surface), magnitude_(magnitude(mesh.vertices)) {
        for (Index t = 0; t < mesh.triangles.rows(); ++t) {
            Box box = box_of(t);
            std::array<int, 3> low = cell_of(box.low), high = cell_of(box.high);
            for (int z = low[2]; z <= high[2]; ++z) {
                for (int y = low[1]; y <= high[1]; ++y) {
                    for (int x = low[0]; x <= high[0]; ++x) by_cell_[{x, y, z}].push_back(t);
                }
            }
        }
    }

    double of_mesh() {
        double most = 0;
        for (Index t = 0; t < mesh_.triangles.rows(); ++t) {
            double within = graph(t);
            if (!(within < infinity)) within = by_vertex(t);
            most = std::max(most, within);
        }
        return most;
    }

    double of_surface(int levels) {
        if (tree_.size() == 0) return 0;
        const double size = (tree_.box().high - tree_.box().low).maxCoeff() / cells_ / (1 << levels);
        double most = 0;
        std::vector<std::int32_t> open{0};
        while (!open.empty() && most < infinity) {
            const std::int32_t i = open.back();
            open.pop_back();
            const Vec3 width = tree_[i].box.high - tree_[i].box.low;
            if (width.maxCoeff() <= size * 1.01 || !tree_.may_split(i)) {
                most = std::max(most, middle_to_mesh(tree_[i]));
                continue;
            }
            tree_.split(i, counters_);
            for (std::int32_t c = tree_[i].first; c < tree_[i].first + tree_[i].count; ++c) open.push_back(c);
        }
        return most;
    }

private:
    Vec3 vertex(Index t, int k) const { return mesh_.vertices.row(mesh_.triangles(t, k)); }

    Box box_of(Index t) const {
        Box box;
        for (int k = 0; k < 3; ++k) box.add(vertex(t, k));
        return box;
    }

    // Returns the grid cell that contains p, up to rounding: it is only used to find triangles near p.
    std::array<int, 3> cell_of(const Vec3& p) const {
        std::array<int, 3> cell;
        for (int k = 0; k < 3; ++k) {
            const double at = (p[k] - tree_.box().low[k]) / (tree_.box().high[k] - tree_.box().low[k]) * cells_;
            cell[std::size_t(k)] = std::clamp(static_cast<int>(at), 0, cells_ - 1);
        }
        return cell;
    }

    // Returns an upper bound on the distance from any point of triangle t to the surface f = 0: M / m, where |f| <= M
    // on the triangle and |df/dx| >= m along one axis near it (see deviation() in surface_mesh.h). Returns infinity if
    // the proof fails.
    double graph(Index t) {
        Box box = box_of(t);
        // A flat box has no linear form, so it is widened a little, but not beyond the box of the surface.
        const double least_width = 1e-6 * (tree_.box().high - tree_.box().low).maxCoeff() / cells_;
        for (int k = 0; k < 3; ++k) {
            if (box.high[k] - box.low[k] >= least_width) continue;
            box.low[k] = std::max(tree_.box().low[k], -(least_width - box.low[k]));  // rounded down
            box.high[k] = std::min(tree_.box().high[k], box.high[k] + least_width);
        }
        const LinearForm f = tree_.form(box, counters_);
        double most = 0;  // M: up to `rest`, f is linear, so |f| is largest at a vertex
        for (int i = 0; i < 3; ++i) {
            Interval value = f.rest;
            for (int k = 0; k < 3; ++k)
                value +=
                    Interval(f.slope[k]) * ((Interval(vertex(t, i)[k]) - Interval(f.middle[k])) / Interval(f.half[k]));
            most = std::max(most, hausbench::magnitude(value));
        }
        const Vec3 gradient = f.slope.cwiseQuotient(f.half);
        int axis = 0;
        gradient.cwiseAbs().maxCoeff(&axis);
        if (!(std::abs(gradient[axis]) > 0)) return infinity;
        // Guesses how far to widen the box from the slope in the middle, then checks the guess with the smallest slope
        // in the widened box.
        for (const double room : {1.25, 4.0}) {
            const double move = room * most / std::abs(gradient[axis]);
            Box wide = box;
            wide.low[axis] = -(move - wide.low[axis]);
            wide.high[axis] += move;
            if (!(wide.low[axis] >= tree_.box().low[axis] && wide.high[axis] <= tree_.box().high[axis]))
                return infinity;
            const Interval slope = tree_.derivative(axis, wide, counters_);
            const double least = std::max(slope.inf(), -slope.sup());
            if (least > 0 && most / least <= move) return most / least;
        }
        return infinity;
    }

    // Returns an upper bound on the distance from any point of triangle t to the surface: the distance from a vertex to
    // a proven point of the surface, plus the longest edge from this vertex. Returns infinity if no point is proven.
    double by_vertex(Index t) {
        double best = infinity;
        for (int i = 0; i < 3; ++i) {
            const Vec3 v = vertex(t, i);
            const auto point = tree_.nearby(v, v, counters_);
            if (!point) continue;
            const double edge = std::max(apart(v, vertex(t, (i + 1) % 3)), apart(v, vertex(t, (i + 2) % 3)));
            best = std::min(best, apart(v, point->at) + point->error + edge);
        }
        return best;
    }

    // Returns an upper bound on the distance from any point of the piece to the mesh: the distance from the middle of
    // its box to a triangle, plus half the diagonal. Looks for triangles in the grid cell of the middle, then in the
    // cells around it. Returns infinity if there are none near.
    double middle_to_mesh(const SurfaceTree::Node& piece) {
        const Vec3& p = piece.form.middle;
        const double half = std::sqrt(piece.form.half.squaredNorm());
        const std::array<int, 3> cell = cell_of(p);
        double best = infinity;
        for (int ring = 0; ring < 3 && best == infinity; ++ring) {
            for (int z = cell[2] - ring; z <= cell[2] + ring; ++z) {
                for (int y = cell[1] - ring; y <= cell[1] + ring; ++y) {
                    for (int x = cell[0] - ring; x <= cell[0] + ring; ++x) {
                        const auto entry = by_cell_.find({x, y, z});
                        if (entry == by_cell_.end()) continue;
                        for (const Index t : entry->second) best = std::min(best, to_triangle(p, t));
                    }
                }
            }
        }
        return best + half;
    }

    double to_triangle(const Vec3& p, Index t) const {
        return triangle_distance_at_most(p, vertex(t, 0), vertex(t, 1), vertex(t, 2), magnitude_);
    }

    const TriangleMesh& mesh_;
    int cells_;
    SurfaceTree tree_;
    double magnitude_;
    Counters counters_;
    std::map<std::array<int, 3>, std::vector<Index>> by_cell_;
};

}  // namespace

// Returns the distance to q = a + v (b - a) + w (c - a). For any v, w >= 0 with v + w <= 1, q lies in the triangle, so
// the distance to it is an upper bound. Rounding may move q off the triangle. With u = 2^-53, M = `magnitude` and a
// relative error of 2u for each operation, because the mode rounds upward, each coordinate of q errs by
//     8uM   from the products of a weight and an edge. A coordinate of an edge is below 2M and errs by 4uM; its product
//           with the weight errs by 4uM more. v + w <= 1, so two edges err no more than one.
//     4uM   from the two sums, each of about M at most
//     4uM   from v + w, which may exceed 1 by 2u, times edges of 2M
// In total 16uM, so q errs by sqrt(3) * 16uM < 28uM. The code adds 32uM, which leaves room for terms of order u^2.
double triangle_distance_at_most(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, double magnitude) {
    const Vec3 ab = b - a, ac = c - a, ap = p - a;
    const double d00 = ab.dot(ab), d01 = ab.dot(ac), d11 = ac.dot(ac), e0 = ap.dot(ab), e1 = ap.dot(ac);
    const double area = d00 * d11 - d01 * d01;
    double v = area > 0 ? std::clamp((d11 * e0 - d01 * e1) / area, 0.0, 1.0) : 0;
    double w = area > 0 ? std::clamp((d00 * e1 - d01 * e0) / area, 0.0, 1.0) : 0;
    if (v + w > 1) {
        const double sum = v + w;
        v /= sum;
        w /= sum;
    }
    const Vec3 q = a + v * ab + w * ac;
    return apart(p, q) +
           WATCHED("mesh of a surface: rounding of the point of a triangle", 32 * unit_roundoff * magnitude);
}

TriangleMesh triangulate(const AlgebraicSurface& surface, int cells) {
    TriangleMesh mesh = Marching(surface, cells).run();
    if (mesh.triangles.rows() == 0) {
        throw InputError("surface '" + surface.polynomial +
                         "': the polynomial has one sign at all corners of the grid: give more cells, or a polynomial "
                         "that changes sign");
    }
    return mesh;
}

MeshDeviation deviation(const AlgebraicSurface& surface, const TriangleMesh& mesh, int cells, int levels) {
    const UpwardRounding upward;
    Deviation measured(surface, mesh, cells);
    const double out = measured.of_mesh();
    return {out, measured.of_surface(levels)};
}

}  // namespace hausbench
