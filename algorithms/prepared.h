// Structures that are built before any query: exactly those that a solver declares in needs(), each timed.
//
// A structure is a type with
//
//     static constexpr std::string_view structure_name = "BVH";
//     static constexpr int structure_layout = 1;   // increases when its members change: plug-ins that were built before are refused
//     explicit Type(const TriangleMesh&);          // or (const Points&), which fits meshes too; or (const Shape&), which fits all
//     std::size_t bytes() const;
//
// and may live in a solver's own file. With `struct Parameters`, which has `std::string text() const`, the constructor takes one too,
// and structures with other values are others. A structure belongs to a shape, not to a pair: who shares a PreparedShape
// shares what was built over it.
#pragma once

#include "scene.h"

#include <concepts>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

enum class Side { source, target };

struct BuiltStructure {
    std::shared_ptr<const void> object;
    std::size_t bytes = 0;
    double seconds = 0;
};

struct StructureKind {
    std::string name;    // with the values of its parameters, where it has any
    std::string layout;  // its number and its size: what a plug-in and the program must agree on to share one
    std::function<bool(ShapeKind)> fits;
    std::function<BuiltStructure(const Shape&)> build;  // does not time itself
};

template <class Type> struct WithoutParameters {
    std::string text() const { return {}; }
};

template <class Type> struct ParametersOf { using type = WithoutParameters<Type>; };
template <class Type>
requires requires { typename Type::Parameters; }
struct ParametersOf<Type> {
    using type = typename Type::Parameters;
};
template <class Type> using StructureParameters = typename ParametersOf<Type>::type;

template <class Type> StructureKind structure_kind(const StructureParameters<Type>& parameters = {}) {
    constexpr bool parametric = requires { typename Type::Parameters; };
    const auto construct = [parameters](const auto& from) {
        if constexpr (parametric)
            return std::shared_ptr<const Type>(new Type(from, parameters));
        else
            return std::shared_ptr<const Type>(new Type(from));
    };
    constexpr bool of_mesh = parametric ? std::constructible_from<Type, const TriangleMesh&, StructureParameters<Type>>
                                        : std::constructible_from<Type, const TriangleMesh&>;
    constexpr bool of_points = parametric ? std::constructible_from<Type, const Points&, StructureParameters<Type>>
                                          : std::constructible_from<Type, const Points&>;
    StructureKind kind;
    kind.name = std::string(Type::structure_name);
    if (const std::string text = parameters.text(); !text.empty()) kind.name += " (" + text + ")";
    kind.layout = std::to_string(Type::structure_layout) + ", " + std::to_string(sizeof(Type)) + " bytes";
    kind.fits = [](ShapeKind shape) {
        return shape == ShapeKind::mesh || (shape == ShapeKind::points && !of_mesh) || (!of_mesh && !of_points);
    };
    kind.build = [construct](const Shape& shape) {
        std::shared_ptr<const Type> object;
        if constexpr (of_mesh)
            object = construct(std::get<TriangleMesh>(shape));
        else if constexpr (of_points)
            object = construct(points_of(shape));
        else
            object = construct(shape);
        const std::size_t bytes = object->bytes();
        return BuiltStructure{std::move(object), bytes, 0};
    };
    return kind;
}

// A structure over one side of the scene.
struct Need {
    StructureKind structure;
    Side side;

    bool operator==(const Need& other) const { return side == other.side && structure.name == other.structure.name; }
};
using Needs = std::vector<Need>;

// In needs() and may_need: need<TriangleBvh>(Side::target).
template <class Type> Need need(Side side, const StructureParameters<Type>& parameters = {}) {
    return {structure_kind<Type>(parameters), side};
}

std::string to_string(const Need& need);  // "target BVH"

struct PreparationTime {
    std::string name;  // as to_string(Need), or "solver" for what the solver built itself
    double seconds;
    std::size_t bytes;
};

// A shape, and what was built over it so far. Not for several threads at once.
class PreparedShape {
public:
    explicit PreparedShape(const Shape& shape) : shape_(shape) {}  // which must outlive it

    const Shape& shape() const { return shape_; }

    // Built and timed when it is asked for first. Throws std::logic_error where it does not fit the shape.
    const BuiltStructure& structure(const StructureKind& kind);

private:
    const Shape& shape_;
    std::map<std::string, BuiltStructure> built_;
};

// What one solver declared, of the two shapes of a scene.
class Prepared {
public:
    // Builds what is not there yet. `scene` must outlive this. O(n log n) for each structure.
    Prepared(const Scene& scene, const Needs& needs);
    Prepared(std::shared_ptr<PreparedShape> source, std::shared_ptr<PreparedShape> target, const Needs& needs);

    template <class Type> bool has(Side side, const StructureParameters<Type>& parameters = {}) const {
        return declared_.contains(to_string(need<Type>(side, parameters)));
    }

    // Over the elements or the points of that side, unposed. Throws std::logic_error if it was not declared.
    template <class Type> const Type& get(Side side, const StructureParameters<Type>& parameters = {}) const {
        return *static_cast<const Type*>(use(to_string(need<Type>(side, parameters))));
    }

    // What its structures cost when they were built, for this pair or an earlier one.
    const std::vector<PreparationTime>& times() const { return times_; }

    // How often get() has returned each, by name; the contract test fails for a declared one that is never used.
    const std::map<std::string, int>& uses() const { return uses_; }

private:
    const void* use(const std::string& name) const;

    std::shared_ptr<PreparedShape> shapes_[2];
    std::map<std::string, const void*> declared_;
    std::vector<PreparationTime> times_;
    mutable std::map<std::string, int> uses_;
};

}  // namespace hausbench
