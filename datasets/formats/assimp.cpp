#include "algorithms/error.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"

#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/version.h>
#include <fmt/format.h>

#include <dlfcn.h>

#include <algorithm>
#include <memory>
#include <stdexcept>

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
    decltype(&aiApplyPostProcessing) process = find<decltype(&aiApplyPostProcessing)>("aiApplyPostProcessing");
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

// assimp 5.2.5 either rejects UTF-16 text (AC, Irrlicht), or reads every number in it as 0 (ASE).
void refuse_utf16(const Input& input) {
    if (input.bytes.starts_with("\xff\xfe") || input.bytes.starts_with("\xfe\xff"))
        throw InputError(input.name + ": is UTF-16 text, which its reader does not support: convert it to UTF-8");
}

struct Tally {
    std::int64_t meshes = 0, polygons = 0;  // polygons: faces of more than three corners
};

// Counts the meshes of a node and of all nodes below it. A mesh that several nodes use counts once for each, because
// the soup contains a copy for each.
void count(const aiScene& scene, const aiNode& node, Tally& tally) {
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
        const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
        ++tally.meshes;
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) tally.polygons += mesh.mFaces[f].mNumIndices > 3 ? 1 : 0;
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) count(scene, *node.mChildren[i], tally);
}

Soup soup_of(const aiScene& scene) {
    Soup soup;
    soup.float32 = true;
    for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
        const aiMesh& mesh = *scene.mMeshes[m];
        const std::size_t base = soup.points.size();
        for (unsigned v = 0; v < mesh.mNumVertices; ++v)
            soup.points.emplace_back(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z);
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            auto& face = soup.faces.emplace_back();
            for (unsigned k = 0; k < mesh.mFaces[f].mNumIndices; ++k) face.push_back(base + mesh.mFaces[f].mIndices[k]);
        }
    }
    return soup;
}

}  // namespace

// Reads from memory, so that assimp opens no other file.
Soup read_with_assimp(const Input& input) {
    refuse_utf16(input);
    const Library& assimp = Library::get();
    Scene scene(assimp.import_memory(input.bytes.data(), unsigned(input.bytes.size()), 0, input.format.c_str()),
                assimp.release);
    Tally tally;
    if (scene && scene->mRootNode) {
        count(*scene, *scene->mRootNode, tally);
        // Gives each node its own copies of its meshes, and applies the node's transformation to their vertices.
        if (tally.meshes > 0)
            scene.reset(assimp.process(scene.release(), aiProcess_Triangulate | aiProcess_PreTransformVertices));
    }
    if (!scene) {
        std::string why = assimp.error();
        std::replace(why.begin(), why.end(), '\n', ' ');
        throw InputError(input.name + ": cannot be read: " + (why.empty() ? "assimp gives no reason" : why) +
                         "; if it is sound, convert it to OBJ, PLY, STL or OFF");
    }
    if (tally.meshes == 0)
        throw InputError(input.name +
                         ": assimp finds no mesh in it; if there is one, convert it to OBJ, PLY, STL or OFF");
    Soup soup = soup_of(*scene);
    soup.objects = tally.meshes;
    soup.precision = "float32";
    soup.unreferenced_unknown = true;
    soup.merge = true;
    return soup;
}

std::string assimp_version() {
    const Library& assimp = Library::get();
    return fmt::format("{}.{}.{}", assimp.major(), assimp.minor(), assimp.patch());
}

}  // namespace hausbench::readers
