#include "algorithms/prepared.h"

#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>

namespace hausbench {

namespace {

// Multiplies the points by 2^exponent. Returns true if this was exact, false if a coordinate was rounded.
bool scale(Points& points, int exponent) {
    bool exact = true;
    const auto each = [&](const auto& times, const auto& divided) {
        for (double& value : std::span(points.data(), static_cast<std::size_t>(points.size()))) {
            const double scaled = times(value);
            exact = exact & (divided(scaled) == value);
            value = scaled;
        }
    };
    if (std::abs(exponent) <= 1022) {  // a product with a power of two rounds like ldexp but is faster
        const double factor = std::ldexp(1.0, exponent), inverse = std::ldexp(1.0, -exponent);
        each([&](double x) { return x * factor; }, [&](double x) { return x * inverse; });
    } else {
        each([&](double x) { return std::ldexp(x, exponent); }, [&](double x) { return std::ldexp(x, -exponent); });
    }
    return exact;
}

}  // namespace

std::string to_string(const Need& need) {
    return (need.side == Side::source ? "source " : "target ") + need.structure.name;
}

const Shape& shape_of(const PreparedShape& shape) { return shape.shape(); }
const TriangleMesh& triangles_of(const PreparedShape& shape) { return shape.triangles(); }

PreparedShape::PreparedShape(SharedShape shape) : PreparedShape(Scaled{std::move(shape), 0, 0, {}}) {}

PreparedShape::PreparedShape(Shape shape, int exponent) : PreparedShape(scaled(std::move(shape), exponent)) {}

PreparedShape::PreparedShape(Scaled scaled)
    : shape_(std::move(scaled.shape)),
      exponent_(scaled.exponent),
      lost_(scaled.lost),
      largest_(magnitude(points_of(shape_))),
      smallest_(smallest_nonzero(points_of(shape_))),
      original_(std::move(scaled.original)) {}

PreparedShape::Scaled PreparedShape::scaled(Shape shape, int exponent) {
    Points& points = points_of(shape);
    std::optional<Points> original;
    // Scaling rounds only coordinates that become subnormal. If there are none, no copy of the original is needed.
    if (std::ldexp(smallest_nonzero(points), exponent) < std::numeric_limits<double>::min()) original = points;
    const bool exact = scale(points, exponent);
    if (exact) original.reset();
    return {std::move(shape), exponent, exact ? 0 : 0x1p-1074, std::move(original)};
}

Points PreparedShape::original() const {
    if (WATCHED("session: the input's own coordinates are posed", original_.has_value())) return *original_;
    Points points = points_of(shape_);
    scale(points, -exponent_);
    return points;
}

const TriangleMesh& PreparedShape::triangles() const {
    if (kind_of(shape_) == ShapeKind::mesh) return mesh_of(shape_);
    if (kind_of(shape_) == ShapeKind::surface)
        throw std::logic_error("an algebraic surface has no triangles: triangulate it first");
    std::call_once(flag_, [this] {
        TriangleMesh flat{points_of(shape_), {}};
        flat.triangles.resize(flat.vertices.rows(), 3);
        for (Eigen::Index i = 0; i < flat.vertices.rows(); ++i)
            flat.triangles.row(i).setConstant(static_cast<Index>(i));
        flat_ = std::make_unique<const TriangleMesh>(std::move(flat));
    });
    return *flat_;
}

const BuiltStructure& PreparedShape::structure(const StructureKind& kind, const Threads& threads, bool* before) {
    const std::lock_guard lock(building_);
    const auto at = built_.find(kind.name);
    if (before) *before = at != built_.end();
    if (at != built_.end()) return at->second;
    if (!kind.fits(kind_of(shape_)))
        throw std::logic_error("a " + kind.name + " was declared, but the shape of that side is of another kind");
    const auto begin = std::chrono::steady_clock::now();
    BuiltStructure built = kind.build(*this, threads);
    built.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return built_.emplace(kind.name, std::move(built)).first->second;
}

int scale_exponent(double largest) {
    int exponent = 0;
    if (largest > 0) std::frexp(largest, &exponent);
    return -exponent;
}

Prepared::Prepared(const Scene& scene, const Needs& needs, const Threads& threads)
    : Prepared(std::make_shared<PreparedShape>(scene.source), std::make_shared<PreparedShape>(scene.target), needs,
               threads) {}

Prepared::Prepared(std::shared_ptr<PreparedShape> source, std::shared_ptr<PreparedShape> target, const Needs& needs,
                   const Threads& threads)
    : shapes_{std::move(source), std::move(target)}, threads_(threads) {
    for (const Need& need : needs) {
        const std::string name = to_string(need);
        if (declared_.contains(name)) continue;
        PreparedShape& shape = *shapes_[static_cast<std::size_t>(need.side)];
        bool shared = false;
        const BuiltStructure& built = shape.structure(need.structure, threads, &shared);
        declared_[name].object = built.object.get();
        times_.push_back({name, built.seconds, built.bytes, shared});
    }
}

const void* Prepared::use(const std::string& name) const {
    const auto at = declared_.find(name);
    if (at == declared_.end()) throw std::logic_error("the " + name + " is used but was not declared in needs()");
    at->second.uses.fetch_add(1, std::memory_order_relaxed);
    return at->second.object;
}

std::map<std::string, int> Prepared::uses() const {
    std::map<std::string, int> counts;
    for (const auto& [name, declared] : declared_) {
        if (const int count = declared.uses.load(); count > 0) counts[name] = count;
    }
    return counts;
}

}  // namespace hausbench
