// Octree subdivision and interval distances, as published.
//
// Source: Shou, Huang, Gu, Miao, Wang: Computing the Hausdorff distance between two algebraic surfaces, Computer Science and
// Application 3, 2013 (in Chinese; read from badly recognised text: the denominators of its surfaces are inferred from the
// interval it prints).
// The box is divided into 2^depth voxels an axis by an octree that keeps a cell where 0 lies in the interval of the
// polynomial over it. The distance of two kept voxels is an interval [g, G], the least and the largest distance of their
// points, and the answer is [max over A of min over B of g, max over A of min over B of G]. The paper's H is the larger of
// both directions, end by end: ask for both.
//
// Not certified: a kept voxel need not hold a point of the surface, so either end may be wrong. Reported as the method
// gives it, so that this can be seen; surface_enclosure.cpp is the one to trust. No witness, for the same reason.
//
// `pairs = all` computes every pair of voxels, as the paper does. `pruned` gives the same bits: min over B of g is at most
// the distance between voxels farther for another voxel of A (both are translates), so an octree over A is searched by
// the value at one voxel of each cell, and each value by an octree over B. Budget: voxels of A (all) or searches (pruned).
//
// Grid lines are rounded numbers lo + (hi - lo) i / n, and voxels are the boxes between them: they cover the box without
// gaps. Polynomials are bounded with directed rounding; squared distances are rounded to nearest and widened at the end
// as kernel/rounding.h says. Time O(8^depth) at worst, O(4^depth) for the octree of a tame surface, O(16^depth) for all
// pairs; memory O(4^depth).
#include "error.h"
#include "kernel/deadline.h"
#include "kernel/interval_form.h"
#include "kernel/rounding.h"
#include "solver.h"

#include <algorithm>
#include <optional>
#include <queue>

namespace hausbench {
namespace {

using Grid = std::array<std::vector<double>, 3>;  // 2^depth + 1 lines an axis

struct Node {
    std::array<int, 3> at;  // in voxels
    int size;
    std::uint32_t first = 0, count = 0;  // children; none: a voxel
};

// The kept voxels of one surface and the octree that led to them.
struct Voxels {
    Grid grid;
    std::vector<Node> nodes;
    std::vector<std::uint32_t> leaves;
    std::array<std::vector<double>, 3> low, high;  // by leaf
    std::uint64_t evaluations = 0;

    std::size_t bytes() const {
        return nodes.size() * sizeof(Node) + leaves.size() * (sizeof(std::uint32_t) + 6 * sizeof(double));
    }
};

Box box_of(const Grid& grid, const std::array<int, 3>& at, int size) {
    Box box;
    for (std::size_t k = 0; k < 3; ++k) {
        box.low[Eigen::Index(k)] = grid[k][std::size_t(at[k])];
        box.high[Eigen::Index(k)] = grid[k][std::size_t(at[k] + size)];
    }
    return box;
}

class Subdivision {
public:
    Subdivision(const AlgebraicSurface& surface, int depth, Form form)
        : form_(form), evaluator_(Polynomial(surface.polynomial)) {
        const int n = 1 << depth;
        for (int k = 0; k < 3; ++k) {
            auto& lines = voxels_.grid[std::size_t(k)];
            const double low = surface.box(0, k), high = surface.box(1, k);
            for (int i = 0; i <= n; ++i) lines.push_back(i == n ? high : low + (high - low) * i / n);
            for (int i = 0; i < n; ++i) {
                if (!(lines[std::size_t(i)] < lines[std::size_t(i) + 1])) {
                    throw InputError(fmt_problem(surface));
                }
            }
        }
        const UpwardRounding upward;
        if (!keep({0, 0, 0}, n)) throw InputError(empty_problem(surface));
        voxels_.nodes.push_back({{0, 0, 0}, n});
        split(0);
        if (voxels_.leaves.empty()) throw InputError(empty_problem(surface));
        for (const std::uint32_t leaf : voxels_.leaves) {
            const Box box = box_of(voxels_.grid, voxels_.nodes[leaf].at, 1);
            for (std::size_t k = 0; k < 3; ++k) {
                voxels_.low[k].push_back(box.low[Eigen::Index(k)]);
                voxels_.high[k].push_back(box.high[Eigen::Index(k)]);
            }
        }
    }

    Voxels take() { return std::move(voxels_); }

private:
    static std::string fmt_problem(const AlgebraicSurface& surface) {
        return "surface '" + surface.polynomial + "': its box is too small for so many voxels: give a smaller depth";
    }
    static std::string empty_problem(const AlgebraicSurface& surface) {
        return "surface '" + surface.polynomial + "': has no point in its box: give another box or polynomial";
    }

    bool keep(const std::array<int, 3>& at, int size) {
        ++voxels_.evaluations;
        const Interval value = evaluator_.range(form_, box_of(voxels_.grid, at, size));
        return value.inf() <= 0 && value.sup() >= 0;
    }

    // Children stand together. A cell without kept children stays as one without count: it has no voxels.
    void split(std::uint32_t of) {
        const Node node = voxels_.nodes[of];
        if (node.size == 1) {
            voxels_.leaves.push_back(of);
            return;
        }
        const int half = node.size / 2;
        const auto first = static_cast<std::uint32_t>(voxels_.nodes.size());
        for (int c = 0; c < 8; ++c) {
            const std::array<int, 3> at{node.at[0] + (c & 1) * half, node.at[1] + (c >> 1 & 1) * half,
                                        node.at[2] + (c >> 2) * half};
            if (keep(at, half)) voxels_.nodes.push_back({at, half});
        }
        const auto count = static_cast<std::uint32_t>(voxels_.nodes.size()) - first;
        voxels_.nodes[of].first = first;
        voxels_.nodes[of].count = count;
        for (std::uint32_t i = 0; i < count; ++i) split(first + i);
    }

    Form form_;
    FormEvaluator evaluator_;
    Voxels voxels_;
};

// Squared least (g) or largest (G) distance of two boxes. Rounded to nearest; every operation is monotone.
template <bool largest> double squared_distance(const Box& a, const Box& b) {
    double d[3];
    for (int k = 0; k < 3; ++k) {
        d[k] = largest ? std::max(b.high[k] - a.low[k], a.high[k] - b.low[k])
                       : std::max(std::max(b.low[k] - a.high[k], a.low[k] - b.high[k]), 0.0);
    }
    return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

// No more than squared_distance() of a and any voxel in the cell.
template <bool largest> double at_least(const Box& a, const Voxels& b, const Node& cell) {
    const Box whole = box_of(b.grid, cell.at, cell.size);
    if (!largest) return squared_distance<false>(a, whole);
    double d[3];
    for (std::size_t k = 0; k < 3; ++k) {  // a voxel's upper end is no lower than the lowest voxel's, and so on
        const auto i = Eigen::Index(k);
        const double high = b.grid[k][std::size_t(cell.at[k]) + 1],
                     low = b.grid[k][std::size_t(cell.at[k] + cell.size) - 1];
        d[k] = std::max(high - a.low[i], a.high[i] - low);
    }
    return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

class IntervalSubdivision final : public Solver {
public:
    explicit IntervalSubdivision(const Options& options)
        : depth_(static_cast<int>(options.integer("depth"))), all_(options.text("pairs") == "all") {
        const std::string form = options.text("form");
        form_ =
            static_cast<Form>(std::find(std::begin(form_names), std::end(form_names), form) - std::begin(form_names));
    }

    void prepare(const Scene& scene, const Prepared&) override {
        source_ = Subdivision(surface_of(scene.source), depth_, form_).take();
        target_ = Subdivision(surface_of(scene.target), depth_, form_).take();
    }

    std::size_t prepared_bytes() const override { return source_.bytes() + target_.bytes(); }

    Result solve(const Query& query, State*, Trace& trace) const override {
        const Deadline deadline(query.time_limit);
        Result result;
        result.counters.polynomial_evaluations = source_.evaluations + target_.evaluations;
        std::optional<Status> stopped;
        double g = 0, large = 0;  // squared
        if (all_) {
            all_pairs(query, deadline, result.counters, stopped, g, large);
        } else {
            g = pruned<false>(query, deadline, result.counters, stopped);
            large = pruned<true>(query, deadline, result.counters, stopped);
        }
        if (stopped)
            large = squared_distance<true>(box_of(source_.grid, {0, 0, 0}, 1 << depth_),
                                           box_of(target_.grid, {0, 0, 0}, 1 << depth_));
        result.bounds = {distance_at_least(g, true), distance_at_most(large, true)};
        trace.record(result.bounds.lower, result.bounds.upper);
        if (const auto answer = query.answer(result.bounds.lower, result.bounds.upper)) {
            result.status = *answer;
        } else if (stopped) {
            result.status = *stopped;
        } else {
            result.status = Status::stalled;
            result.note = "the width of the interval depends on the voxels alone: give a larger depth";
        }
        return result;
    }

private:
    void all_pairs(const Query& query, const Deadline& deadline, Counters& counters, std::optional<Status>& stopped,
                   double& g, double& large) const {
        constexpr std::size_t lanes = 4;  // minima kept apart, so that the compiler may compute them side by side
        const std::size_t m = target_.leaves.size();
        const double *bl[3], *bh[3];
        for (std::size_t k = 0; k < 3; ++k) bl[k] = target_.low[k].data(), bh[k] = target_.high[k].data();
        for (std::size_t i = 0; i < source_.leaves.size(); ++i) {
            if (i >= query.budget) stopped = Status::budget;
            if (deadline.passed()) stopped = Status::time_limit;
            if (stopped) return;
            double al[3], ah[3];
            for (std::size_t k = 0; k < 3; ++k) al[k] = source_.low[k][i], ah[k] = source_.high[k][i];
            double least[lanes], least_large[lanes];
            std::fill_n(least, lanes, std::numeric_limits<double>::infinity());
            std::fill_n(least_large, lanes, std::numeric_limits<double>::infinity());
            const auto look = [&](std::size_t j, std::size_t lane) {
                double s[3], t[3];
                for (std::size_t k = 0; k < 3; ++k) {
                    const double before = al[k] - bh[k][j], after = bl[k][j] - ah[k];
                    const double apart = before > after ? before : after;
                    s[k] = apart > 0 ? apart : 0;
                    const double first = bh[k][j] - al[k], second = ah[k] - bl[k][j];
                    t[k] = first > second ? first : second;
                }
                const double one = (s[0] * s[0] + s[1] * s[1]) + s[2] * s[2],
                             other = (t[0] * t[0] + t[1] * t[1]) + t[2] * t[2];
                least[lane] = one < least[lane] ? one : least[lane];
                least_large[lane] = other < least_large[lane] ? other : least_large[lane];
            };
            std::size_t j = 0;
            for (; j + lanes <= m; j += lanes) {
                for (std::size_t lane = 0; lane < lanes; ++lane) look(j + lane, lane);
            }
            for (; j < m; ++j) look(j, 0);
            counters.box_distances += m;
            g = std::max(g, *std::min_element(least, least + lanes));
            large = std::max(large, *std::min_element(least_large, least_large + lanes));
        }
    }

    // The least squared distance from a voxel to those of B; any value at most `enough` once it is known to be at most that.
    template <bool largest> double nearest(const Box& a, double enough, Counters& counters) const {
        struct Entry {
            double least;
            std::uint32_t node;
        };
        Entry stack[8 * 16];
        std::size_t size = 0;
        stack[size++] = {0, 0};
        double best = std::numeric_limits<double>::infinity();
        while (size > 0 && best > enough) {
            const Entry entry = stack[--size];
            if (entry.least >= best) continue;
            const Node& node = target_.nodes[entry.node];
            const std::size_t begin = size;
            for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
                const Node& child = target_.nodes[i];
                if (child.size > 1 && child.count == 0) continue;
                ++counters.box_distances;
                if (child.size == 1) {
                    best = std::min(best, squared_distance<largest>(a, box_of(target_.grid, child.at, 1)));
                } else if (const double least = at_least<largest>(a, target_, child); least < best) {
                    stack[size++] = {least, i};
                }
            }
            std::sort(stack + begin, stack + size, [](const Entry& x, const Entry& y) { return x.least > y.least; });
        }
        return best;
    }

    // The largest, over voxels of A, of their least squared distance to those of B.
    template <bool largest>
    double pruned(const Query& query, const Deadline& deadline, Counters& counters,
                  std::optional<Status>& stopped) const {
        struct Entry {
            double bound;  // of the distances of all its voxels
            std::uint32_t node, leaf;
            double squared;  // of that voxel
            bool operator<(const Entry& other) const { return bound < other.bound; }
        };
        double most = 0, magnitude = 0;
        for (const Grid* grid : {&source_.grid, &target_.grid}) {
            for (const auto& lines : *grid)
                magnitude = std::max({magnitude, std::abs(lines.front()), std::abs(lines.back())});
        }
        // Translates are so but for the rounding of grid lines, a few ulps of the largest coordinate.
        const double slack = 64 * unit_roundoff * magnitude;
        const auto shift = [&](std::uint32_t node, std::uint32_t leaf) {
            const Node &cell = source_.nodes[node], &voxel = source_.nodes[leaf];
            double sum = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto& lines = source_.grid[k];
                const double step = (lines.back() - lines.front()) / double(lines.size() - 1);
                const double d = step * std::max(voxel.at[k] - cell.at[k], cell.at[k] + cell.size - 1 - voxel.at[k]);
                sum += d * d;
            }
            return std::sqrt(sum) * (1 + 1e-12) + slack;
        };
        std::priority_queue<Entry> queue;
        std::uint64_t searches = 0;
        const auto add = [&](std::uint32_t node, std::uint32_t leaf, double squared) {
            const bool voxel = source_.nodes[node].size == 1;
            const double further = voxel ? 0 : shift(node, leaf);
            if (squared < 0) {
                ++searches;
                const double room = std::sqrt(most) - further;
                squared = nearest<largest>(box_of(source_.grid, source_.nodes[leaf].at, 1),
                                           room > 0 ? room * room * (1 - 1e-12) : -1, counters);
            }
            if (squared > most) most = squared;
            const double bound = std::sqrt(squared) * (1 + 1e-12) + further;
            if (!voxel && bound >= std::sqrt(most)) queue.push({bound, node, leaf, squared}), ++counters.queue_pushes;
        };
        const auto some_leaf = [&](std::uint32_t node) {
            // The kept voxel next to the middle of the cell, as the octree's order has it; cells without voxels have none.
            std::optional<std::uint32_t> found;
            const auto find = [&](auto&& self, std::uint32_t at) -> void {
                const Node& cell = source_.nodes[at];
                if (cell.size == 1) found = at;
                for (std::uint32_t i = 0; i < cell.count && !found; ++i)
                    self(self, cell.first + (i + cell.count / 2) % cell.count);
            };
            find(find, node);
            return found;
        };
        if (const auto leaf = some_leaf(0)) add(0, *leaf, -1);
        while (!queue.empty()) {
            const Entry entry = queue.top();
            queue.pop();
            if (entry.bound < std::sqrt(most)) break;
            if (searches >= query.budget) stopped = Status::budget;
            if (deadline.passed()) stopped = Status::time_limit;
            if (stopped) break;
            const Node& node = source_.nodes[entry.node];
            for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
                const Node &child = source_.nodes[i], &voxel = source_.nodes[entry.leaf];
                bool inside = true;
                for (std::size_t k = 0; k < 3; ++k)
                    inside = inside && voxel.at[k] >= child.at[k] && voxel.at[k] < child.at[k] + child.size;
                if (std::sqrt(entry.squared) * (1 + 1e-12) + shift(i, entry.leaf) < std::sqrt(most)) continue;
                if (inside)
                    add(i, entry.leaf, entry.squared);
                else if (const auto leaf = some_leaf(i))
                    add(i, *leaf, -1);
            }
        }
        return most;
    }

    int depth_;
    Form form_ = Form::modified_affine;
    bool all_;
    Voxels source_, target_;
};

}  // namespace

SolverEntry interval_subdivision_solver() {
    SolverInfo info;
    info.name = "interval_subdivision";
    info.title = "interval subdivision";
    info.paper = "shou2014";
    info.source.surface = info.target.surface = true;
    info.traces = true;
    info.parameters = {
        {.name = "depth",
         .default_value = std::int64_t{6},
         .unit = "",
         .paper_value = "6",
         .description = "of the octree: 2^depth voxels an axis",
         .choices = {},
         .least = 1,
         .most = 10},
        {.name = "form",
         .default_value = std::string("modified_affine"),
         .unit = "",
         .paper_value = "modified affine arithmetic",
         .description = "how the polynomial is bounded over a cell",
         .choices = {std::begin(form_names), std::end(form_names)}},
        {.name = "pairs",
         .default_value = std::string("all"),
         .unit = "",
         .paper_value = "all",
         .description = "pairs of voxels whose distance is computed; 'pruned' leaves out those that cannot matter",
         .choices = {"all", "pruned"}},
    };
    return {info, [](const Options& options) -> std::unique_ptr<Solver> {
                return std::make_unique<IntervalSubdivision>(options);
            }};
}

}  // namespace hausbench
