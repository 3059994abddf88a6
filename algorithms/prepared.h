// Structures that are built and timed before any query: exactly those that a solver declares in needs().
//
// A structure is a type with
//
//     static constexpr std::string_view structure_name = "BVH";
//     static constexpr int structure_layout = 1;   // increase it when members change: older plug-ins are then refused
//     explicit Type(const TriangleMesh&);          // a point set comes as triangles (i, i, i)
//     std::size_t bytes() const;
//
// and may live in a solver's own file. The constructor may take `const Points&` instead (the vertices of a mesh), or
// `const Shape&`. Optional members:
// - `struct Parameters` with `std::string text() const`: the constructor takes one too, and structures with different
//   parameters are kept apart;
// - `static constexpr bool structure_of_meshes_only = true`: point sets are refused;
// - a last constructor argument `const Threads&`: several threads may build it (kernel/parallel.h), always to the same bits.
//
// A structure belongs to one shape, not to a pair; scenes that share a PreparedShape share its structures.
#pragma once

#include "algorithms/kernel/parallel.h"
#include "algorithms/scene.h"

#include <atomic>
#include <concepts>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

enum class Side { source, target };

class PreparedShape;

struct BuiltStructure {
    std::shared_ptr<const void> object;
    std::size_t bytes = 0;
    double seconds = 0;
};

struct StructureKind {
    std::string name;  // with the values of its parameters, if it has any
    // Layout number and size; a plug-in and the program must agree on them to share a structure.
    std::string layout;
    std::function<bool(ShapeKind)> fits;
    std::function<BuiltStructure(const PreparedShape&, const Threads&)> build;  // untimed
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

const Shape& shape_of(const PreparedShape& shape);
const TriangleMesh& triangles_of(const PreparedShape& shape);

// True if Type can be built from From, with its parameters if it has any, with threads or without.
template <class Type, class From> inline constexpr bool structure_from = requires { typename Type::Parameters; }
? std::constructible_from<Type, const From&, StructureParameters<Type>> ||
        std::constructible_from<Type, const From&, StructureParameters<Type>, const Threads&>
    : std::constructible_from<Type, const From&> || std::constructible_from<Type, const From&, const Threads&>;

template <class Type> StructureKind structure_kind(const StructureParameters<Type>& parameters = {}) {
    constexpr bool parametric = requires { typename Type::Parameters; };
    const auto construct = [parameters]<class From>(const From& from, const Threads& threads) {
        using Parameters = StructureParameters<Type>;
        if constexpr (parametric && std::constructible_from<Type, const From&, Parameters, const Threads&>)
            return std::shared_ptr<const Type>(new Type(from, parameters, threads));
        else if constexpr (parametric)
            return std::shared_ptr<const Type>(new Type(from, parameters));
        else if constexpr (std::constructible_from<Type, const From&, const Threads&>)
            return std::shared_ptr<const Type>(new Type(from, threads));
        else
            return std::shared_ptr<const Type>(new Type(from));
    };
    constexpr bool of_mesh = structure_from<Type, TriangleMesh>, of_points = structure_from<Type, Points>;
    StructureKind kind;
    kind.name = std::string(Type::structure_name);
    if (const std::string text = parameters.text(); !text.empty()) kind.name += " (" + text + ")";
    kind.layout = std::to_string(Type::structure_layout) + ", " + std::to_string(sizeof(Type)) + " bytes";
    constexpr bool meshes_only = requires { requires Type::structure_of_meshes_only; };
    kind.fits = [](ShapeKind shape) {
        if (shape == ShapeKind::surface) return !of_mesh && !of_points;
        return shape == ShapeKind::mesh || !meshes_only;
    };
    kind.build = [construct](const PreparedShape& shape, const Threads& threads) {
        std::shared_ptr<const Type> object;
        if constexpr (of_mesh)
            object = construct(triangles_of(shape), threads);
        else if constexpr (of_points)
            object = construct(points_of(shape_of(shape)), threads);
        else
            object = construct(shape_of(shape), threads);
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

// Makes a need, for needs() and may_need: need<TriangleBvh>(Side::target).
template <class Type> Need need(Side side, const StructureParameters<Type>& parameters = {}) {
    return {structure_kind<Type>(parameters), side};
}

std::string to_string(const Need& need);  // "target BVH"

struct PreparationTime {
    std::string name;  // as to_string(Need), or "solver" for the solver's private data
    double seconds;
    std::size_t bytes;
    bool shared = false;  // built before, for another scene with this shape
};

// A shape scaled by a power of two, with the structures built over it so far. Scenes may share it.
class PreparedShape {
public:
    // Shares the shape as it is.
    explicit PreparedShape(SharedShape shape);

    // Multiplies every coordinate by 2^exponent in place. Keeps a copy of the original only if that rounds a coordinate.
    PreparedShape(Shape shape, int exponent);

    const SharedShape& shape() const { return shape_; }
    int exponent() const { return exponent_; }

    // Returns 2^-1074 if scaling rounded a coordinate (which underflowed and is off by at most half of that), else
    // 0.
    double lost() const { return lost_; }

    // Return the largest and the smallest nonzero |coordinate|, scaled; 0 and infinity if there is none.
    double largest() const { return largest_; }
    double smallest() const { return smallest_; }

    // Returns the coordinates before scaling.
    Points original() const;

    // Returns the mesh itself, or for a point set one triangle (i, i, i) per point, made on first use. Not for surfaces.
    const TriangleMesh& triangles() const;

    // Returns the structure, built and timed on first use by at most so many threads. Its address does not change. Throws
    // std::logic_error if it does not fit the shape. Sets `*before`, if given, to whether it existed already.
    const BuiltStructure& structure(const StructureKind& kind, const Threads& threads = Threads(),
                                    bool* before = nullptr);

private:
    struct Scaled {
        SharedShape shape;
        int exponent;
        double lost;
        std::optional<Points> original;  // only if scaling was not exact
    };
    static Scaled scaled(Shape shape, int exponent);
    explicit PreparedShape(Scaled scaled);

    SharedShape shape_;
    int exponent_;
    double lost_, largest_, smallest_;
    std::optional<Points> original_;
    mutable std::once_flag flag_;
    mutable std::unique_ptr<const TriangleMesh> flat_;
    std::mutex building_;
    std::map<std::string, BuiltStructure> built_;
};

// Returns the exponent that brings the largest |coordinate| into [0.5, 1); 0 if all are zero.
int scale_exponent(double largest);

// The structures that one solver declared for the two shapes of a scene.
class Prepared {
public:
    // Builds the structures that do not exist yet, one after the other, each in O(n log n).
    Prepared(const Scene& scene, const Needs& needs, const Threads& threads = Threads());
    Prepared(std::shared_ptr<PreparedShape> source, std::shared_ptr<PreparedShape> target, const Needs& needs,
             const Threads& threads = Threads());

    template <class Type> bool has(Side side, const StructureParameters<Type>& parameters = {}) const {
        return declared_.contains(to_string(need<Type>(side, parameters)));
    }

    // Returns the structure over the elements or points of that side, unposed. Throws std::logic_error if it was not
    // declared.
    template <class Type> const Type& get(Side side, const StructureParameters<Type>& parameters = {}) const {
        return *static_cast<const Type*>(use(to_string(need<Type>(side, parameters))));
    }

    // Returns the triangles of a mesh, or one for each point of a point set; see PreparedShape.
    const TriangleMesh& triangles(Side side) const { return shapes_[static_cast<std::size_t>(side)]->triangles(); }

    // Returns the threads to use for private data that a solver builds in prepare().
    const Threads& threads() const { return threads_; }

    // Returns the cost of each structure when it was built, for this pair or an earlier one.
    const std::vector<PreparationTime>& times() const { return times_; }

    // Returns how often get() has returned each structure, by name. The contract test fails if one is never used.
    std::map<std::string, int> uses() const;

private:
    struct Declared {
        const void* object = nullptr;
        mutable std::atomic<int> uses{0};
    };
    const void* use(const std::string& name) const;

    std::shared_ptr<PreparedShape> shapes_[2];
    Threads threads_;
    std::map<std::string, Declared> declared_;
    std::vector<PreparationTime> times_;
};

}  // namespace hausbench
