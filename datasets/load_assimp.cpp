#include "algorithms/error.h"
#include "datasets/parse.h"
#include "datasets/readers.h"

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <fstream>
#include <iterator>

namespace hausbench::readers {
namespace {

// assimp 5.2.5 either rejects UTF-16 text (AC, Collada, Irrlicht), or reads every number in it as 0 (ASE).
void refuse_utf16(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string mark(2, ' ');
    if (in.read(mark.data(), 2) && (mark == "\xff\xfe" || mark == "\xfe\xff"))
        throw InputError(file.string() + ": is UTF-16 text, which its reader does not support: convert it to UTF-8");
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

// Returns null if assimp cannot read the file; the importer then has the reason. `extension` is the extension of the
// file, and `format` the extension that assimp should assume instead, if it is not empty.
const aiScene* read_scene(Assimp::Importer& importer, const std::filesystem::path& file, const std::string& extension,
                          const std::string& format) {
    if (format.empty() || format == extension)
        return importer.ReadFile(file.string(), 0);  // by its path, because the file may refer to others beside it
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    return importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, format.c_str());
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

LoadedShape load_with_assimp(const std::filesystem::path& file, const std::string& format) {
    const std::string name = file.string();
    refuse_utf16(file);
    std::string extension = file.extension().string();
    if (!extension.empty()) extension.erase(0, 1);
    Assimp::Importer importer;
    const aiScene* scene = read_scene(importer, file, extension, format);
    Tally tally;
    if (scene && scene->mRootNode) {
        count(*scene, *scene->mRootNode, tally);
        // Gives each node its own copies of its meshes, and applies the node's transformation to their vertices.
        if (tally.meshes > 0)
            scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_PreTransformVertices);
    }
    if (!scene) {
        std::string why = importer.GetErrorString();
        std::replace(why.begin(), why.end(), '\n', ' ');
        throw InputError(name + ": cannot be read: " + (why.empty() ? "assimp gives no reason" : why) +
                         "; if it is sound, convert it to OBJ, PLY, STL or OFF");
    }
    if (tally.meshes == 0)
        throw InputError(name + ": assimp finds no mesh in it; if there is one, convert it to OBJ, PLY, STL or OFF");
    Soup soup = soup_of(*scene);
    soup.objects = tally.meshes;
    LoadReport report;
    report.format = lower_case(format.empty() ? extension : format);
    report.precision = "float32";
    report.unreferenced = std::nullopt;
    report.polygons = tally.polygons;
    return finish(name, std::move(soup), report, true);
}

}  // namespace hausbench::readers
