// Compares our readers with assimp, an independent implementation: the triangles of both must be the same, up to the
// float32 numbers of assimp. assimp is a part of this test alone.
#include "algorithms/error.h"
#include "datasets/load.h"
#include "tests/support/fbx_files.h"
#include "tests/support/reading.h"

#include <assimp/cimport.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace hausbench {
namespace {

// A shape without any symmetry.
const std::vector<std::array<double, 3>> points = {{0.1, 0, 0},    {1.3, 0.2, -0.1}, {0, 2.7, 0.3},
                                                   {-0.2, 0.5, 3}, {0.9, 1.1, 1.7},  {-1.6, -0.4, 0.8}};
const std::vector<std::array<int, 3>> faces = {{0, 1, 2}, {0, 3, 1}, {1, 4, 2}, {2, 4, 3}, {0, 2, 5}, {3, 5, 0}};

using Triangle = std::array<Vec3, 3>;

// Adds the triangles of a node of assimp and the nodes below it.
void collect(const aiScene& scene, const aiNode& node, const aiMatrix4x4& outer, std::vector<Triangle>& all) {
    const aiMatrix4x4 at = outer * node.mTransformation;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
        const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            ASSERT_EQ(mesh.mFaces[f].mNumIndices, 3u);
            Triangle& triangle = all.emplace_back();
            for (unsigned k = 0; k < 3; ++k) {
                const aiVector3D p = at * mesh.mVertices[mesh.mFaces[f].mIndices[k]];
                triangle[k] = {p.x, p.y, p.z};
            }
        }
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) collect(scene, *node.mChildren[c], at, all);
}

// Returns the largest difference of two coordinates, if the triangles begin at the best corner.
double difference(const Triangle& a, const Triangle& b) {
    double least = 1e300;
    for (std::size_t turn = 0; turn < 3; ++turn) {
        double most = 0;
        for (std::size_t k = 0; k < 3; ++k) most = std::max(most, (a[k] - b[(k + turn) % 3]).cwiseAbs().maxCoeff());
        least = std::min(least, most);
    }
    return least;
}

template <class Number> std::string raw(const Number& value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return bytes;
}

// Returns the coordinates and indices, each as text with this format.
std::string lines(const char* point, const char* face, int first = 0) {
    std::string text;
    for (const auto& [x, y, z] : points) text += fmt::format(fmt::runtime(point), x, y, z);
    for (const auto& [a, b, c] : faces) text += fmt::format(fmt::runtime(face), a + first, b + first, c + first);
    return text;
}
std::string raw_points() {
    std::string bytes;
    for (const auto& point : points)
        for (const double coordinate : point) bytes += raw(static_cast<float>(coordinate));
    return bytes;
}

class Assimp : public Reading {
protected:
    Assimp() : Reading("a.obj") {}

    // Expects the same triangles from our reader and from assimp. `skip_root`: assimp turns the scene by its root.
    void expect_same(const std::string& name, const std::string& bytes, std::size_t count,
                     bool skip_root = false) const {
        SCOPED_TRACE(name);
        const std::vector<Vec3> corners = Reading::corners(name, bytes);
        const std::string ending = name.substr(name.find('.') + 1);
        const std::unique_ptr<const aiScene, decltype(&aiReleaseImport)> scene(
            aiImportFileFromMemory(bytes.data(), static_cast<unsigned>(bytes.size()), 0, ending.c_str()),
            aiReleaseImport);
        ASSERT_TRUE(scene && scene->mRootNode) << aiGetErrorString();
        aiMatrix4x4 outer;
        if (skip_root) outer = aiMatrix4x4(scene->mRootNode->mTransformation).Inverse();
        std::vector<Triangle> theirs, ours;
        collect(*scene, *scene->mRootNode, outer, theirs);
        for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
            ours.push_back({corners[i], corners[i + 1], corners[i + 2]});
        ASSERT_EQ(ours.size(), count);
        ASSERT_EQ(theirs.size(), count);
        const auto found_in = [](const Triangle& triangle, const std::vector<Triangle>& all) {
            return std::any_of(all.begin(), all.end(),
                               [&](const Triangle& other) { return difference(triangle, other) < 2e-5; });
        };
        for (std::size_t i = 0; i < count; ++i) {
            EXPECT_TRUE(found_in(ours[i], theirs)) << i << ": " << ours[i][0].transpose();
            EXPECT_TRUE(found_in(theirs[i], ours)) << i << ": " << theirs[i][0].transpose();
        }
    }
};

TEST_F(Assimp, Obj) { expect_same("a.obj", lines("v {} {} {}\n", "f {} {} {}\n", 1), faces.size()); }

TEST_F(Assimp, Ply) {
    expect_same(
        "a.ply",
        fmt::format("ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float "
                    "z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
                    points.size(), faces.size()) +
            lines("{} {} {}\n", "3 {} {} {}\n"),
        faces.size());
}

TEST_F(Assimp, Stl) {
    std::string bytes = std::string(80, ' ') + raw(static_cast<std::uint32_t>(faces.size()));
    for (const auto& face : faces) {
        bytes += std::string(12, '\0');
        for (const int v : face) bytes += raw_points().substr(12 * static_cast<std::size_t>(v), 12);
        bytes += std::string(2, '\0');
    }
    expect_same("a.stl", bytes, faces.size());
}

TEST_F(Assimp, Gltf) {
    std::string json = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 2]}],
        "nodes": [{"children": [1], "translation": [1, 2, 3], "rotation": [0.5, 0.5, -0.5, 0.5], "scale": [1, 2, 3]},
                  {"mesh": 0, "rotation": [0.6, 0, 0, 0.8]}, {"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5125, "count": 18, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 72}, {"buffer": 0, "byteOffset": 72, "byteLength": 72}],
        "buffers": [{"byteLength": 144}]})";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string bin = raw_points();
    for (const auto& face : faces)
        for (const int v : face) bin += raw(static_cast<std::uint32_t>(v));
    const auto size = [](std::size_t value) { return raw(static_cast<std::uint32_t>(value)); };
    expect_same("a.glb",
                "glTF" + size(2) + size(28 + json.size() + bin.size()) + size(json.size()) + "JSON" + json +
                    size(bin.size()) + std::string("BIN\0", 4) + bin,
                2 * faces.size());
}

TEST_F(Assimp, ThreeDs) {
    const auto short_of = [](std::size_t value) { return raw(static_cast<std::uint16_t>(value)); };
    const auto chunk = [&](std::size_t id, const std::string& body) {
        return short_of(id) + raw(static_cast<std::uint32_t>(body.size() + 6)) + body;
    };
    std::string list = short_of(faces.size());
    for (const auto& face : faces) {
        for (const int v : face) list += short_of(static_cast<std::size_t>(v));
        list += short_of(7);
    }
    const std::string mesh = chunk(0x4100, chunk(0x4110, short_of(points.size()) + raw_points()) + chunk(0x4120, list));
    expect_same(
        "a.3ds",
        chunk(0x4d4d, chunk(2, raw(std::uint32_t{3})) + chunk(0x3d3d, chunk(0x4000, std::string("a\0", 2) + mesh))),
        faces.size(), true);
}

// With Y up and metres, because assimp would turn and scale other files. It expects an axis of length 1 in <rotate>.
TEST_F(Assimp, Collada) {
    std::string numbers, indices;
    for (const auto& [x, y, z] : points) numbers += fmt::format("{} {} {} ", x, y, z);
    for (const auto& [a, b, c] : faces) indices += fmt::format("{} {} {} ", a, b, c);
    expect_same(
        "a.dae",
        fmt::format(
            R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="f" count="{}">{}</float_array><technique_common>
<accessor source="#f" count="{}" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v">
<input semantic="POSITION" source="#s"/></vertices><triangles count="{}">
<input semantic="VERTEX" source="#v" offset="0"/><p>{}</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="w"><node id="n"><translate>1 2 3</translate><rotate>0 0.6 0.8 40</rotate>
<scale>1 2 3</scale><node id="m"><matrix>1 2 0 4 0 1 0 5 0 0 1 6 0 0 0 1</matrix><instance_geometry url="#g"/></node>
</node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#w"/></scene></COLLADA>)",
            3 * points.size(), numbers, points.size(), faces.size(), indices),
        faces.size());
}

TEST_F(Assimp, Fbx) {
    using fbx::property;
    std::vector<double> vertices;
    std::vector<std::int32_t> corners;
    for (const auto& point : points) vertices.insert(vertices.end(), point.begin(), point.end());
    for (const auto& [a, b, c] : faces) corners.insert(corners.end(), {a, b, -1 - c});
    const fbx::Node active = property("RotationActive", std::int32_t{1}),
                    matrices = property("InheritType", std::int32_t{1});
    const fbx::Nodes outer = {
        property("Lcl Translation", 1.0, 2.0, 3.0),    property("Lcl Rotation", 20.0, -50.0, 110.0),
        property("Lcl Scaling", 1.0, 2.0, 0.5),        property("RotationPivot", 0.3, 0.1, -2.0),
        property("RotationOffset", 0.5, -0.25, 0.125), property("GeometricTranslation", 9.0, 9.0, 9.0)};
    const fbx::Nodes inner = {active,
                              matrices,
                              property("PreRotation", 15.0, 25.0, -35.0),
                              property("PostRotation", -5.0, 45.0, 75.0),
                              property("Lcl Rotation", 10.0, 20.0, 30.0),
                              property("Lcl Scaling", -1.0, 3.0, 2.0),
                              property("ScalingPivot", 1.0, 0.5, 0.25),
                              property("ScalingOffset", 0.1, 0.2, 0.3),
                              property("RotationPivot", 1.0, -1.0, 2.0),
                              property("GeometricTranslation", 0.5, 0.0, 1.0),
                              property("GeometricRotation", 90.0, 30.0, 0.0),
                              property("GeometricScaling", 1.0, 2.0, 3.0)};
    const fbx::Nodes scene = fbx::document(
        {fbx::geometry(10, vertices, corners), fbx::model(20, inner), fbx::model(21, outer, "Null"), fbx::model(22)},
        {fbx::connect(21, 0), fbx::connect(20, 21), fbx::connect(22, 0), fbx::connect(10, 20), fbx::connect(10, 22)});
    expect_same("a.fbx", fbx::text(scene), 2 * faces.size());
    expect_same("a.fbx", fbx::binary(scene, 7400), 2 * faces.size());
    expect_same("a.fbx", fbx::binary(scene, 7500), 2 * faces.size());
}

}  // namespace
}  // namespace hausbench
