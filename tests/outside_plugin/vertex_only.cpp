// A complete solver in one file, small and slow: every vertex of A against every triangle (or point) of B.
//
// Lower bound: the largest distance of a vertex of A. Upper bound: the distance to a single triangle S of B is
// convex, so over a triangle T of A it is largest at a corner of T; the best S is the one whose distance to its
// farthest corner of T is least. O(|A| |B|) time, O(|B|) memory for each corner of T. Certified: vertices are
// exact, and the distances are bounded by the proofs of the kernels (kernel/point_triangle.h, kernel/rounding.h).
#include <hausbench/certificate/cover_certificate.h>
#include <hausbench/kernel/deadline.h>
#include <hausbench/kernel/point_triangle.h>
#include <hausbench/kernel/rounding.h>
#include <hausbench/plugin.h>

#include <algorithm>

using namespace hausbench;

namespace {

// Returns the elements of a shape; a point becomes a triangle whose corners coincide.
std::vector<Triangle> elements_of(const Shape& shape, const Points& points) {
    std::vector<Triangle> elements;
    for (Index i = 0; i < element_count(shape); ++i) {
        const auto* mesh = std::get_if<TriangleMesh>(&shape);
        const auto corner = [&](int k) -> Vec3 { return points.row(mesh ? mesh->triangles(i, k) : i); };
        elements.push_back({corner(0), corner(1), corner(2)});
    }
    return elements;
}

class VertexOnly final : public Solver {
public:
    explicit VertexOnly(const Options&) {}

    void prepare(const Scene& scene, const Prepared&) override {
        scene_ = &scene;
        target_ = elements_of(scene.target, points_of(scene.target));
        target_magnitude_ = magnitude(points_of(scene.target));
    }

    Result solve(const Query& query, State*, Trace&) const override {
        const Points a = posed(points_of(scene_->source), query.source_pose);
        const double size = std::max(magnitude(a), target_magnitude_);
        if (size != 0 && !(size >= smallest_safe_magnitude && size <= largest_safe_magnitude)) return {};

        const Deadline deadline = query.deadline();
        Result result;
        double upper = 0;
        Field lowers{"lower", Field::Of::elements, Field::Meaning::lower, {}}, uppers = lowers;
        uppers.name = "upper", uppers.meaning = Field::Meaning::upper;
        const std::vector<Triangle> elements = elements_of(scene_->source, a);
        CertificateBuilder proof{Index(elements.size())};
        for (std::size_t i = 0; i < elements.size(); ++i) {
            if (deadline.passed()) {
                result.status = Status::time_limit;
                result.why_no_certificate = "time was out before each triangle of A had a bound; allow it more time";
                return result;  // without the other triangles there is no upper bound
            }
            lowers.values.push_back(0);
            std::vector<double> farthest(target_.size(), 0);  // squared distance of the farthest corner, from each S
            for (const Vec3& corner : {elements[i].a, elements[i].b, elements[i].c}) {
                double lower = std::numeric_limits<double>::infinity(), nearest = lower;
                Witness witness{corner, corner, Index(i), -1};
                for (std::size_t j = 0; j < target_.size(); ++j) {
                    const TrianglePoint q = closest_point(corner, target_[j]);
                    lower = std::min(lower, distance_certainly_at_least(corner, target_[j], q.point));
                    farthest[j] = std::max(farthest[j], q.squared_distance);
                    if (q.squared_distance < nearest)
                        nearest = q.squared_distance, witness.target_point = q.point, witness.target_element = Index(j);
                }
                result.counters.point_triangle_distances += target_.size();
                lowers.values.back() = std::max(lowers.values.back(), lower);
                if (lower > result.bounds.lower || i == 0) result.bounds.lower = lower, result.witness = witness;
            }
            const auto least = std::min_element(farthest.begin(), farthest.end());
            CertificateTree tree;
            tree.one(Index(least - farthest.begin()));
            proof.set(Index(i), tree);
            uppers.values.push_back(surface_distance_at_most(*least, size, 0));
            upper = std::max(upper, uppers.values.back());
        }
        result.bounds.upper = upper;
        if (query.wanted.fields) result.fields = {lowers, uppers};
        // Adds room for the checker's rounding errors (cover_certificate.h). Diagonals are at most 2 sqrt(3) `size`.
        if (query.wanted.certificate) result.certificates = {*proof.finish(upper + 100 * unit_roundoff * 4 * size)};
        const bool close = result.bounds.gap() <= query.tolerance.gap(result.bounds.lower);
        result.status = close ? Status::converged : Status::budget;  // it cannot refine further
        if (!close) result.note = "a solver that looks at vertices only comes no closer than this";
        return result;
    }

private:
    const Scene* scene_ = nullptr;
    std::vector<Triangle> target_;
    double target_magnitude_ = 0;
};

}  // namespace

SolverEntry vertex_only_solver() {
    SolverInfo info;
    info.name = "vertex_only";
    info.title = "Vertices only";
    info.source = info.target = {.points = true, .mesh = true};
    info.certified = true;
    info.abilities = {Ability::fields, Ability::certificates};
    return {info,
            [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<VertexOnly>(options); }};
}
