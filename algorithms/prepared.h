// Structures: data, such as a BVH, that is built over one shape before any query, and timed separately. Only the
// structures that a solver returns from needs() are built.
//
// A structure is a type with
//
//     static constexpr std::string_view structure_name = "BVH";
//     static constexpr int structure_layout = 1;   // increase it when members change: older plug-ins are then refused
//     explicit Type(const TriangleMesh&);          // for a point set: a mesh with one triangle (i, i, i) per point
//     std::size_t bytes() const;                   // memory that it uses
//
// and may be defined in a solver's own file. Instead of the mesh, the constructor may take `const Points&` (it then
// receives the vertices of a mesh) or `const Shape&`. Optional members:
// - `struct Parameters` with `std::string text() const`: the constructor then has a second argument of this type.
//   Structures whose parameters have different texts are kept apart.
// - `static constexpr bool structure_of_meshes_only = true`: the structure cannot be built over a point set.
// - a last constructor argument `const Threads&`: several threads may build the structure (kernel/parallel.h). It must
//   have the same bits for any number of threads.
//
// A structure belongs to one shape, not to a pair of shapes. Scenes that share a PreparedShape share its structures.
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

// A structure after it was built, stored without its type, and the cost of building it.
struct BuiltStructure {
    std::shared_ptr<const void> object;  // Prepared::get() casts it back to its type
    std::size_t bytes = 0;
    double seconds = 0;  // wall time
};

// Describes a kind of structure, with its parameters, and how to build it. Made by structure_kind().
struct StructureKind {
    std::string name;  // structure_name, and the text of the parameters if there are any: "BVH", "samples (n = 3)"
    // structure_layout and sizeof(Type). A plug-in may share a structure with the program only if both are the same.
    std::string layout;
    std::function<bool(ShapeKind)> fits;  // whether it can be built over such a shape
    std::function<BuiltStructure(const PreparedShape&, const Threads&)> build;  // does not set `seconds`
};

// StructureParameters<Type> is Type::Parameters if Type has parameters, and WithoutParameters<Type> otherwise.
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

// True if Type can be constructed from a `const From&`, followed by its parameters (if it has any) and, optionally, a
// `const Threads&`.
template <class Type, class From> inline constexpr bool structure_from = requires { typename Type::Parameters; }
? std::constructible_from<Type, const From&, StructureParameters<Type>> ||
        std::constructible_from<Type, const From&, StructureParameters<Type>, const Threads&>
    : std::constructible_from<Type, const From&> || std::constructible_from<Type, const From&, const Threads&>;

// Describes how to build a Type with these parameters. If the constructor accepts several kinds of input, a mesh is
// preferred to points, and points to a Shape.
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

// A structure that a solver needs over the source or over the target.
struct Need {
    StructureKind structure;
    Side side;

    bool operator==(const Need& other) const { return side == other.side && structure.name == other.structure.name; }
};
using Needs = std::vector<Need>;

// Makes a Need, to be returned from Solver::needs() or listed in SolverInfo::may_need. Example:
// need<TriangleBvh>(Side::target).
template <class Type> Need need(Side side, const StructureParameters<Type>& parameters = {}) {
    return {structure_kind<Type>(parameters), side};
}

std::string to_string(const Need& need);  // "target BVH"

// The cost of building one structure, or of Solver::prepare().
struct PreparationTime {
    std::string name;     // as to_string(Need), or "solver" for Solver::prepare()
    double seconds;       // wall time
    std::size_t bytes;    // memory that stays in use
    bool shared = false;  // the structure existed already, built for another scene with this shape
};

// A shape, scaled by a power of two, and the structures built over it so far. Several scenes may share it.
class PreparedShape {
public:
    // Uses the shape without scaling (exponent 0) and without copying it.
    explicit PreparedShape(SharedShape shape);

    // Multiplies every coordinate by 2^exponent. Keeps a copy of the original coordinates only if this rounds one of
    // them.
    PreparedShape(Shape shape, int exponent);

    const SharedShape& shape() const { return shape_; }
    int exponent() const { return exponent_; }

    // Returns an upper bound on how far the scaling moved any point by rounding, as a scaled length: 0 if it was exact,
    // else 2^-1074. Only a coordinate that underflows is rounded, by at most 2^-1075.
    double lost() const { return lost_; }

    // Return the largest |coordinate| and the smallest nonzero |coordinate|, after scaling. If all coordinates are 0,
    // largest() is 0 and smallest() is infinity.
    double largest() const { return largest_; }
    double smallest() const { return smallest_; }

    // Returns the coordinates before scaling, bit for bit.
    Points original() const;

    // Returns the shape as a mesh. A point set becomes a mesh with one triangle (i, i, i) per point, which the first
    // call makes. Throws std::logic_error for a surface.
    const TriangleMesh& triangles() const;

    // Returns the structure over this shape. The first call builds and times it, with at most `threads`; later calls
    // return the same object. Sets `*before`, if not null, to whether the structure existed before this call. Throws
    // std::logic_error if the structure cannot be built over such a shape.
    const BuiltStructure& structure(const StructureKind& kind, const Threads& threads = Threads(),
                                    bool* before = nullptr);

private:
    struct Scaled {
        SharedShape shape;
        int exponent;
        double lost;
        std::optional<Points> original;  // only if the scaling was not exact
    };
    static Scaled scaled(Shape shape, int exponent);
    explicit PreparedShape(Scaled scaled);

    SharedShape shape_;
    int exponent_;
    double lost_, largest_, smallest_;
    std::optional<Points> original_;
    mutable std::once_flag flag_;
    mutable std::unique_ptr<const TriangleMesh> flat_;
    std::recursive_mutex building_;  // an interrupt may ask for a structure while one is built
    std::map<std::string, BuiltStructure> built_;
};

// Returns the exponent e for which `largest` * 2^e is in [0.5, 1); 0 if `largest` is 0.
int scale_exponent(double largest);

// The structures that one solver declared for the two shapes of a scene.
class Prepared {
public:
    // Builds the needed structures that do not exist yet, one after the other.
    Prepared(const Scene& scene, const Needs& needs, const Threads& threads = Threads());
    Prepared(std::shared_ptr<PreparedShape> source, std::shared_ptr<PreparedShape> target, const Needs& needs,
             const Threads& threads = Threads());

    // Returns whether the solver declared the structure in needs(), so that get() may be called.
    template <class Type> bool has(Side side, const StructureParameters<Type>& parameters = {}) const {
        return declared_.contains(to_string(need<Type>(side, parameters)));
    }

    // Returns the structure over the source or the target, which no pose has moved. Throws std::logic_error if the
    // solver did not declare it in needs().
    template <class Type> const Type& get(Side side, const StructureParameters<Type>& parameters = {}) const {
        return *static_cast<const Type*>(use(to_string(need<Type>(side, parameters))));
    }

    // Returns the source or the target as a mesh; see PreparedShape::triangles().
    const TriangleMesh& triangles(Side side) const { return shapes_[static_cast<std::size_t>(side)]->triangles(); }

    // Returns the threads that Solver::prepare() may use to build its private data.
    const Threads& threads() const { return threads_; }

    // Returns the cost of building each structure, even if it was built earlier, for another scene.
    const std::vector<PreparationTime>& times() const { return times_; }

    // Returns how often get() has returned each structure, by the structure's name, as to_string(Need) gives it. Unused
    // structures are absent, so that a test can find needless declarations.
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
