// 3D Studio: vertices as they are in the file, what the keyframer may do, and every kind of damaged file.
#include "datasets/load.h"
#include "tests/support/reading.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <variant>
#include <vector>

namespace hausbench {
namespace {

template <class Number> std::string raw(Number value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return bytes;
}
std::string u16(int value) { return raw(static_cast<std::uint16_t>(value)); }

std::string chunk(int id, const std::string& body) {
    return u16(id) + raw(static_cast<std::uint32_t>(body.size() + 6)) + body;
}
std::string text(const std::string& word) { return word + '\0'; }

std::string vertices(const std::vector<float>& numbers) {
    std::string body = u16(static_cast<int>(numbers.size() / 3));
    for (const float number : numbers) body += raw(number);
    return chunk(0x4110, body);
}
std::string faces(const std::vector<std::array<int, 3>>& all) {
    std::string body = u16(static_cast<int>(all.size()));
    for (const auto& [a, b, c] : all) body += u16(a) + u16(b) + u16(c) + u16(7);
    return chunk(0x4120, body + chunk(0x4150, std::string(4 * all.size(), '\0')));
}
std::string axes(const std::array<float, 12>& numbers) {
    std::string body;
    for (const float number : numbers) body += raw(number);
    return chunk(0x4160, body);
}
std::string mesh(const std::string& name, const std::string& chunks) {
    return chunk(0x4000, text(name) + chunk(0x4012, "") + chunk(0x4100, chunks));
}
const std::vector<float> numbers = {0.1F, 1e-20F, -3, 1, 0, 0, 0, 2, 0, 0, 0, 3};
const std::string triangle = vertices(numbers) + faces({{0, 1, 2}});

std::string node(const std::string& name) {
    return chunk(0xb002, chunk(0xb030, u16(0)) + chunk(0xb010, text(name) + std::string(6, '\0')));
}
std::string file(const std::string& in_editor, const std::string& in_keyframer = "") {
    return chunk(0x4d4d, chunk(2, raw(std::uint32_t{3})) + chunk(0x3d3d, in_editor) +
                             (in_keyframer.empty() ? "" : chunk(0xb000, in_keyframer)));
}

class ThreeDs : public Reading {
protected:
    ThreeDs() : Reading("a.3ds") {}
};

TEST_F(ThreeDs, VerticesAreTheFloatsOfTheFile) {
    const LoadedShape loaded = load(file(mesh("a", triangle)));
    const auto& shape = std::get<TriangleMesh>(loaded.shape);
    ASSERT_EQ(shape.triangles.rows(), 1);
    const double x = 0.1F, y = 1e-20F;
    EXPECT_EQ(shape.vertices.row(0), Eigen::RowVector3d(x, y, -3)) << "not turned, as assimp does";
    EXPECT_EQ(shape.vertices.row(2), Eigen::RowVector3d(0, 2, 0));
    EXPECT_TRUE(loaded.report.float32);
    EXPECT_EQ(loaded.report.unreferenced, 1);
    EXPECT_EQ(loaded.report.stated.up, 0);
    EXPECT_EQ(loaded.report.stated.micrometres, 0);
    EXPECT_TRUE(loaded.report.notes.empty());
}

TEST_F(ThreeDs, AxesAndScaleMoveNothing) {
    const std::string turned = axes({0, 1, 0, -1, 0, 0, 0, 0, 1, 5, 6, 7});
    const LoadedShape loaded =
        load(file(chunk(0x0100, raw(25.4F)) + mesh("a", turned + triangle) + mesh("b", triangle)));
    const auto& shape = std::get<TriangleMesh>(loaded.shape);
    ASSERT_EQ(shape.vertices.rows(), 6);
    EXPECT_EQ(shape.vertices.row(1), Eigen::RowVector3d(1, 0, 0));
    EXPECT_EQ(shape.triangles.row(1), (Eigen::Matrix<Index, 1, 3>(3, 4, 5)));
    EXPECT_EQ(loaded.report.objects, 2);
    EXPECT_EQ(loaded.report.notes, std::vector<std::string>{"has the master scale 25.4, which changes no coordinate"});
    refused(file(mesh("a", axes({-1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}) + triangle)),
            {"a.3ds: byte ", "the local axes of mesh 'a' are left-handed", "or export OBJ"});
}

TEST_F(ThreeDs, FacesMayStandBeforeVertices) {
    const LoadedShape loaded = load(file(mesh("a", faces({{1, 2, 3}}) + vertices(numbers))));
    EXPECT_EQ(std::get<TriangleMesh>(loaded.shape).vertices.row(2), Eigen::RowVector3d(0, 0, 3));
}

TEST_F(ThreeDs, MeshesWithoutFacesArePoints) {
    const LoadedShape loaded = load(file(mesh("a", vertices(numbers))));
    EXPECT_EQ(std::get<PointSet>(loaded.shape).points.rows(), 4);
    EXPECT_EQ(loaded.report.notes, std::vector<std::string>{"mesh 'a' has no faces: its vertices count as points"});
}

TEST_F(ThreeDs, HiddenMeshesAreRead) {
    const auto hidden = [](const std::string& name) {
        return chunk(0x4000, text(name) + chunk(0x4010, "") + chunk(0x4100, triangle));
    };
    EXPECT_EQ(load(file(hidden("a") + mesh("b", triangle))).report.notes,
              std::vector<std::string>{"the hidden mesh 'a' is read"});
    const LoadedShape both = load(file(hidden("a") + hidden("b") + chunk(0x4000, text("light") + chunk(0x4010, ""))));
    EXPECT_EQ(both.report.notes, std::vector<std::string>{"the hidden mesh 'a' and 1 more are read"});
    EXPECT_EQ(both.report.objects, 2);
}

TEST_F(ThreeDs, TheKeyframerIsLeftOutAndInstancesAreRefused) {
    const LoadedShape loaded = load(file(mesh("a", triangle), node("a") + node("$$$DUMMY") + node("$$$DUMMY")));
    EXPECT_EQ(
        loaded.report.notes,
        std::vector<std::string>{"its keyframer section (animation) is left out: the vertices of the meshes count"});
    EXPECT_EQ(load(file(mesh("a", triangle) + mesh("a", triangle), node("a") + node("a"))).report.objects, 2);
    refused(file(mesh("a", triangle), node("a") + node("a")),
            {"2 nodes of the keyframer repeat mesh 'a'", "make the instances unique"});
}

TEST_F(ThreeDs, DamagedFilesAreRefused) {
    const std::string good = file(mesh("a", triangle));
    refused("solid a", {"does not begin with the chunk 4D4D"});
    refused("MM", {"does not begin with the chunk 4D4D"});
    for (std::size_t size = 6; size < good.size(); ++size)
        refused(good.substr(0, size), {"a.3ds: byte 0: chunk 4D4D announces", "truncated"});
    EXPECT_NO_THROW(load(good + "more"));
    refused(file(""), {"holds no mesh"});
    refused(file(mesh("a", vertices({}) + faces({}))), {"holds no vertices"});
    refused(file(mesh("a", vertices(numbers) + faces({{0, 1, 4}}))),
            {"face 0 (from 0) of mesh 'a' names vertex 4 (from 0), but there are 4"});
    refused(file(mesh("a", triangle + vertices(numbers))), {"two chunks 4110"});
    refused(file(mesh("a", triangle + faces({}))), {"two chunks 4120"});
    refused(file(mesh("a", chunk(0x4110, u16(4) + std::string(47, '\0')))), {"announces 4 elements of 12 bytes"});
    refused(file(mesh("a", chunk(0x4110, ""))), {"announces 0 elements"});
    refused(file(mesh("a", vertices(numbers) + chunk(0x4120, u16(2) + std::string(15, '\0')))),
            {"announces 2 elements of 8 bytes"});
    refused(file(mesh("a", chunk(0x4160, "short"))), {"fewer than 48 bytes"});
    refused(file(chunk(0x4000, "abc")), {"a name does not end"});
    refused(file(u16(0x4000) + raw(std::uint32_t{3})), {"chunk 4000 announces 3 bytes"});
    refused(file(u16(0x4000) + raw(std::uint32_t{0xffffffff})), {"chunk 4000 announces 4294967295 bytes"});
    refused(file("abc"), {"a chunk ends too early"});
}

}  // namespace
}  // namespace hausbench
