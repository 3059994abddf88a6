// Reads FBX (7.0 and later) with assimp, which is loaded when it is first needed: polygons and lines of all meshes, moved
// by the transforms of the nodes. Animations, cameras and lights are left out.
//
// Refuses meshes that a skeleton or blend shapes deform, NURBS and patches, everything that assimp leaves out by its own
// log, transforms so small that assimp ignores them, and nodes that are turned below a scale that differs between the
// axes (see Collector::within).
//
// Unit: UnitScaleFactor of GlobalSettings, in centimetres; 1 cm if it is missing. Axes: UpAxis; Y if it is missing. Both
// are only stated: assimp 5.2.5 neither turns nor scales FBX, unless asked to.
//
// Error of a coordinate: assimp rounds vertices, and the matrix of each node, to float32; the products are computed in
// double. Without transforms a coordinate is the float32 nearest to the number of the file.
//
// Other formats of assimp are not read. With 5.2.5, ASE, IQM and MD2 are turned by 90 degrees; X and LWO are mirrored;
// ASE, X, IQM and MS3D are not deformed by their skeletons; AC and X lose faces whose material does not exist; AC replaces
// vertices that do not exist by the first, and does not move lines by `loc`; X3D loses everything in LOD; NFF and X3D
// approximate spheres and other curved shapes; LWO gives the control polygons of patches; MD2 gives the first frame.
#include "algorithms/error.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"
#include "datasets/units.h"

#include <assimp/cimport.h>
#include <assimp/metadata.h>
#include <assimp/scene.h>
#include <assimp/version.h>
#include <fmt/format.h>

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hausbench::readers {
namespace {

// The functions of assimp. The library is loaded when they are first needed: few files need it, and loading it takes
// longer than everything else that the program does before its first line.
class Library {
public:
    static const Library& get() {
        static const Library loaded;
        return loaded;
    }

    void* const library = ::dlopen(HAUSBENCH_ASSIMP, RTLD_NOW | RTLD_LOCAL);  // never closed
    decltype(&aiImportFileFromMemory) import_memory = find<decltype(&aiImportFileFromMemory)>("aiImportFileFromMemory");
    decltype(&aiAttachLogStream) attach_log = find<decltype(&aiAttachLogStream)>("aiAttachLogStream");
    decltype(&aiDetachLogStream) detach_log = find<decltype(&aiDetachLogStream)>("aiDetachLogStream");
    decltype(&aiReleaseImport) release = find<decltype(&aiReleaseImport)>("aiReleaseImport");
    decltype(&aiGetErrorString) error = find<decltype(&aiGetErrorString)>("aiGetErrorString");
    decltype(&aiGetVersionMajor) major = find<decltype(&aiGetVersionMajor)>("aiGetVersionMajor");
    decltype(&aiGetVersionMinor) minor = find<decltype(&aiGetVersionMinor)>("aiGetVersionMinor");
    decltype(&aiGetVersionPatch) patch = find<decltype(&aiGetVersionPatch)>("aiGetVersionPatch");

private:
    Library() = default;

    template <class Function> Function find(const char* name) const {
        void* const found = library ? ::dlsym(library, name) : nullptr;
        if (!found) throw std::runtime_error(fmt::format("assimp cannot be loaded: {}: install it again", ::dlerror()));
        return reinterpret_cast<Function>(found);
    }
};

using Scene = std::unique_ptr<const aiScene, decltype(&aiReleaseImport)>;

// The messages of assimp while it reads a file. assimp drops objects that it cannot read, and says so only here.
class Log {
public:
    explicit Log(const Library& assimp) : assimp_(assimp) { assimp_.attach_log(&stream_); }
    ~Log() { assimp_.detach_log(&stream_); }
    Log(const Log&) = delete;
    Log& operator=(const Log&) = delete;

    // Returns the first message about something that was left out and may have a shape, or an empty text.
    std::string lost() const {
        static const std::vector<std::string_view> harmless_errors = {"layer", "material", "length of input data",
                                                                      "vertex data channel"};
        static const std::vector<std::string_view> grave_warnings = {
            "unrecognized geometry", "null geometry", "geometry link", "incoming model link", "duplicate object id"};
        for (const std::string& line : lines_) {
            const std::string lower = lower_case(line);
            const auto has = [&](std::string_view words) { return lower.find(words) != std::string::npos; };
            const bool error =
                lower.starts_with("error") && std::none_of(harmless_errors.begin(), harmless_errors.end(), has);
            const bool warning =
                lower.starts_with("warn") && std::any_of(grave_warnings.begin(), grave_warnings.end(), has);
            if (error || warning) return one_line(line);
        }
        return "";
    }

private:
    static void add(const char* message, char* user) {
        auto& lines = *reinterpret_cast<std::vector<std::string>*>(user);
        if (lines.size() < 10000) lines.emplace_back(trimmed(std::string_view(message).substr(0, 400)));
    }

    const Library& assimp_;
    std::vector<std::string> lines_;
    const aiLogStream stream_{add, reinterpret_cast<char*>(&lines_)};
};

// Refuses geometries that assimp leaves out, by the name of their class: a text in quotes, or in a binary file a text
// with its length before it.
void refuse_curved(const Input& input) {
    for (const std::string_view kind :
         {"NurbsCurve", "NurbsSurface", "NurbsPatch", "TrimNurbsSurface", "Nurbs", "Patch"}) {
        std::string binary = "S";
        binary += static_cast<char>(kind.size());
        binary.append(3, '\0');
        binary += kind;
        if (input.bytes.find(binary) != std::string_view::npos ||
            input.bytes.find(fmt::format("\"{}\"", kind)) != std::string_view::npos)
            throw InputError(
                fmt::format("{}: holds a {}, which is not supported: convert it to polygons in the program "
                            "that wrote the file, or export OBJ",
                            input.name, kind));
    }
}

// Removes the next three numbers from `rest`, the text of an FBX file after the name of a property, and returns them. In
// a text file they follow three words in quotes; in a binary file three texts with their lengths before them, and are
// doubles. Returns nothing if there is something else.
std::optional<Vec3> three_numbers(std::string_view rest, bool binary) {
    Vec3 numbers;
    for (int i = 0; i < 3; ++i) {
        std::uint32_t size = 0;
        if (!binary) {
            const std::size_t open = rest.find('"'), close = open == rest.npos ? open : rest.find('"', open + 1);
            if (close == rest.npos) return std::nullopt;
            rest.remove_prefix(close + 1);
            continue;
        }
        if (rest.size() < 5 || rest[0] != 'S') return std::nullopt;
        std::memcpy(&size, rest.data() + 1, 4);
        if (rest.size() - 5 < size) return std::nullopt;
        rest.remove_prefix(5 + std::size_t{size});
    }
    for (double& number : numbers) {
        if (binary) {
            if (rest.size() < 9 || rest[0] != 'D') return std::nullopt;
            std::memcpy(&number, rest.data() + 1, 8);
            rest.remove_prefix(9);
            continue;
        }
        rest.remove_prefix(std::min(rest.find_first_not_of(" \t,\r\n"), rest.size()));
        const std::string_view word = rest.substr(0, rest.find_first_of(" \t,\r\n"));
        const auto value = decimal(word);
        if (!value) return std::nullopt;
        number = *value;
        rest.remove_prefix(word.size());
    }
    return numbers;
}

// Refuses transforms so close to the identity that assimp leaves them out: translations and angles in degrees, or scales
// minus 1, whose squared length is at most the epsilon of float32. Returns a note if one is left out that makes no larger
// difference than rounding to float32: 1e-5 degrees, 1.2e-7 of the size, or 1e-6 units.
std::string check_tiny_transforms(const Input& input) {
    const bool binary = input.bytes.starts_with("Kaydara FBX Binary");
    std::string note;
    for (const std::string_view property :
         {"Lcl Translation", "Lcl Rotation", "Lcl Scaling", "PreRotation", "PostRotation", "RotationPivot",
          "RotationOffset", "ScalingOffset", "ScalingPivot", "GeometricTranslation", "GeometricRotation",
          "GeometricScaling"}) {
        const std::string quoted = fmt::format("\"{}\"", property);
        const std::string_view wanted = binary ? property : std::string_view(quoted);
        const bool scale = property.ends_with("Scaling"), angles = property.ends_with("Rotation");
        std::string_view rest = input.bytes;
        for (std::size_t at = rest.find(wanted); at != rest.npos; at = rest.find(wanted)) {
            rest.remove_prefix(at + wanted.size());
            const auto found = three_numbers(rest, binary);
            if (!found) continue;
            const Vec3 off = scale ? Vec3(*found - Vec3::Ones()) : *found;
            if (!(off.squaredNorm() > 0 && off.squaredNorm() < 1.2e-7)) continue;
            note = fmt::format("a {} of {}, {}, {}", property, found->x(), found->y(), found->z());
            if (off.cwiseAbs().maxCoeff() > (scale ? 1.2e-7 : angles ? 1e-5 : 1e-6))
                throw InputError(
                    fmt::format("{}: has {}, which assimp leaves out because it is so small: apply the "
                                "transforms in the program that wrote the file, or export OBJ",
                                input.name, note));
            note += " is left out, because assimp ignores what is so small";
        }
    }
    return note;
}

// Turns the meshes of a scene into faces.
class Collector {
public:
    Collector(const std::string& name, const aiScene& scene) : name_(name), scene_(scene) {
        soup_.objects = 0;
        soup_.float32 = soup_.unreferenced_unknown = soup_.merge = true;
        soup_.precision = "float32";
    }

    Soup collect() {
        collect(*scene_.mRootNode, {}, 0);
        if (soup_.objects == 0)
            throw InputError(name_ +
                             ": assimp finds no mesh in it; if there is one, convert it to OBJ, PLY, STL or OFF");
        state();
        if (scene_.mNumAnimations > 0)
            soup_.notes.emplace_back("its animations are left out: the transforms of the nodes count");
        return std::move(soup_);
    }

private:
    // Where a node is: a point p moves to matrix * p + shift.
    struct Placement {
        Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
        Vec3 shift = Vec3::Zero();
        bool identity = true;
        bool stretched = false;  // a node above scales its axes differently
    };

    // Returns the place of a node within `outer`. FBX has three rules of how a child inherits a scale. assimp always
    // multiplies the matrices. The rules agree unless a node with a rotation is below a scale that is not uniform.
    Placement within(const Placement& outer, const aiNode& node) const {
        const aiMatrix4x4& m = node.mTransformation;
        if (m == aiMatrix4x4()) return outer;  // its IsIdentity() tolerates 0.01
        Eigen::Matrix3d matrix;
        matrix << m.a1, m.a2, m.a3, m.b1, m.b2, m.b3, m.c1, m.c2, m.c3;
        const Vec3 shift(m.a4, m.b4, m.c4);
        const bool diagonal = matrix == Eigen::Matrix3d(matrix.diagonal().asDiagonal());
        if (outer.stretched && !diagonal)
            throw InputError(
                fmt::format("{}: node '{}' is turned below a scale that differs between the axes, and "
                            "programs differ on the result: apply the transforms in the program that wrote "
                            "the file, or export OBJ",
                            name_, shown(node.mName.C_Str())));
        Placement inner;
        for (int i = 0; i < 3; ++i) {
            for (int k = 0; k < 3; ++k)
                inner.matrix(i, k) = outer.matrix(i, 0) * matrix(0, k) + outer.matrix(i, 1) * matrix(1, k) +
                                     outer.matrix(i, 2) * matrix(2, k);
            inner.shift[i] = outer.matrix(i, 0) * shift[0] + outer.matrix(i, 1) * shift[1] +
                             outer.matrix(i, 2) * shift[2] + outer.shift[i];
        }
        const Vec3 lengths = matrix.colwise().norm();
        inner.stretched = outer.stretched || lengths.maxCoeff() > lengths.minCoeff() * (1 + 1e-5);
        inner.identity = false;
        return inner;
    }

    void collect(const aiNode& node, const Placement& outer, int depth) {
        if (depth > 1000) throw InputError(name_ + ": nodes are nested deeper than 1000: take some of them apart");
        const Placement at = within(outer, node);
        for (unsigned i = 0; i < node.mNumMeshes; ++i) add(*scene_.mMeshes[node.mMeshes[i]], at);
        for (unsigned i = 0; i < node.mNumChildren; ++i) collect(*node.mChildren[i], at, depth + 1);
    }

    void add(const aiMesh& mesh, const Placement& at) {
        const char* const deformer = mesh.mNumBones > 0        ? "a skeleton"
                                     : mesh.mNumAnimMeshes > 0 ? "blend shapes"
                                                               : nullptr;
        if (deformer)
            throw InputError(
                fmt::format("{}: mesh '{}' is deformed by {}, which is not supported: apply it in the "
                            "program that wrote the file, and export the mesh alone",
                            name_, shown(mesh.mName.C_Str()), deformer));
        ++soup_.objects;
        const std::size_t first = soup_.points.size();
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            const Vec3 p(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z);
            Vec3 moved = p;
            for (int i = 0; i < 3 && !at.identity; ++i)
                moved[i] = at.matrix(i, 0) * p[0] + at.matrix(i, 1) * p[1] + at.matrix(i, 2) * p[2] + at.shift[i];
            soup_.points.push_back(moved);
        }
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            auto& face = soup_.faces.emplace_back();
            for (unsigned k = 0; k < mesh.mFaces[f].mNumIndices; ++k)
                face.push_back(first + mesh.mFaces[f].mIndices[k]);
        }
    }

    // Returns a number of the file's GlobalSettings.
    template <class Number> std::optional<Number> setting(const char* key) const {
        Number value{};
        if (!scene_.mMetaData || !scene_.mMetaData->Get(key, value)) return std::nullopt;
        return value;
    }

    // States the unit, which FBX gives in centimetres, and the axis that points up.
    void state() {
        const float centimetres = setting<float>("UnitScaleFactor").value_or(1);
        // Through decimals, so that the float32 nearest to 2.54 gives an inch.
        const auto metres = decimal(fmt::format("{}e-2", centimetres));
        if (centimetres > 0 && metres && std::isfinite(*metres)) soup_.stated = stated_unit(*metres);
        const auto up = setting<std::int32_t>("UpAxis").value_or(1);
        const auto sign = setting<std::int32_t>("UpAxisSign").value_or(1);
        if (up >= 0 && up < 3 && sign == 1)
            soup_.stated.up = "XYZ"[up];
        else
            soup_.notes.emplace_back("the axis that points up is negative or unknown, and counts as not stated");
    }

    const std::string& name_;
    const aiScene& scene_;
    Soup soup_;
};

}  // namespace

Soup read_with_assimp(const Input& input) {
    static std::mutex one_at_a_time;  // assimp has one log for all threads
    const std::lock_guard lock(one_at_a_time);
    refuse_curved(input);
    const std::string note = check_tiny_transforms(input);
    const Library& assimp = Library::get();
    const Log log(assimp);
    // From memory, so that assimp opens no other file.
    const Scene scene(assimp.import_memory(input.bytes.data(), unsigned(input.bytes.size()), 0, input.format.c_str()),
                      assimp.release);
    if (!scene || !scene->mRootNode) {
        std::string why = assimp.error();
        std::replace(why.begin(), why.end(), '\n', ' ');
        throw InputError(input.name + ": cannot be read: " + (why.empty() ? "assimp gives no reason" : why) +
                         "; if it is sound, convert it to OBJ, PLY, STL or OFF");
    }
    if (const std::string lost = log.lost(); !lost.empty())
        throw InputError(fmt::format("{}: assimp cannot read a part of it ({}): convert it to OBJ, PLY, STL or OFF",
                                     input.name, lost));
    Soup soup = Collector(input.name, *scene).collect();
    if (!note.empty()) soup.notes.push_back(note);
    // Found by reading files of known numbers; the tree of the file, which would tell, is not looked at here.
    soup.notes.emplace_back(
        "is read through assimp, which reads numbers of 32 characters and more in text as 0, and ignores "
        "RotationActive "
        "and InheritType: compare it with an export as glTF or OBJ");
    return soup;
}

std::string assimp_version() {
    const Library& assimp = Library::get();
    return fmt::format("{}.{}.{}", assimp.major(), assimp.minor(), assimp.patch());
}

}  // namespace hausbench::readers
