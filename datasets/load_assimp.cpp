#include "error.h"
#include "readers.h"

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
        throw InputError(file.string() + ": is UTF-16 text, which its reader does not understand: convert it to UTF-8");
}

struct Tally {
    std::int64_t meshes = 0, polygons = 0;
};

// Counts every instance of a mesh, since the soup contains each.
void count(const aiScene& scene, const aiNode& node, Tally& tally) {
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
        const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
        ++tally.meshes;
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) tally.polygons += mesh.mFaces[f].mNumIndices > 3 ? 1 : 0;
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) count(scene, *node.mChildren[i], tally);
}

}  // namespace

LoadedShape load_with_assimp(const std::filesystem::path& file, const std::string& format) {
    const std::string name = file.string();
    refuse_utf16(file);
    std::string extension = file.extension().string();
    if (!extension.empty()) extension.erase(0, 1);
    Assimp::Importer importer;
    const aiScene* scene = nullptr;
    if (format.empty() || format == extension) {
        scene = importer.ReadFile(name, 0);  // not from memory: the file may refer to other files in its folder
    } else {
        std::ifstream in(file, std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(in), {}};
        scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, format.c_str());
    }
    Tally tally;
    if (scene && scene->mRootNode) {
        count(*scene, *scene->mRootNode, tally);
        // Every node's transformation goes into the vertices of a mesh of its own.
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

    Soup soup;
    soup.objects = std::max<std::int64_t>(tally.meshes, 1);
    for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
        const aiMesh& mesh = *scene->mMeshes[m];
        const std::size_t base = soup.points.size();
        for (unsigned v = 0; v < mesh.mNumVertices; ++v)
            soup.points.emplace_back(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z);
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            auto& face = soup.faces.emplace_back();
            for (unsigned k = 0; k < mesh.mFaces[f].mNumIndices; ++k) face.push_back(base + mesh.mFaces[f].mIndices[k]);
        }
    }
    LoadReport report;
    report.format = format.empty() ? extension : format;
    std::transform(report.format.begin(), report.format.end(), report.format.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    report.precision = "float32";
    report.float32 = true;
    report.unreferenced = std::nullopt;
    report.polygons = tally.polygons;
    return finish(name, std::move(soup), report, true);
}

}  // namespace hausbench::readers
