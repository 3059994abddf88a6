// FBX through assimp: positions under transforms, stated units and axes, and everything that is refused.
#include "datasets/load.h"
#include "tests/support/reading.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

namespace hausbench {
namespace {

std::string property(const std::string& name, const std::string& type, const std::string& values) {
    return fmt::format("P: \"{}\", \"{}\", \"\", \"A\",{}\n", name, type, values);
}
std::string properties(const std::string& text) { return "Properties70: {\n" + text + "}\n"; }

// A mesh with the vertices (0.1, 0, 0), (1, 0, 0), (0, 2, 0) and (0, 0, 3).
std::string geometry(const std::string& corners, int id = 10) {
    return fmt::format(
        "Geometry: {}, \"Geometry::\", \"Mesh\" {{\nVertices: *12 {{\na: 0.1,0,0,1,0,0,0,2,0,0,0,3\n}}\n"
        "PolygonVertexIndex: *{} {{\na: {}\n}}\nGeometryVersion: 124\n}}\n",
        id, 1 + std::count(corners.begin(), corners.end(), ','), corners);
}
std::string model(const std::string& props, int id = 20) {
    return fmt::format("Model: {}, \"Model::n{}\", \"Mesh\" {{\nVersion: 232\n{}}}\n", id, id, properties(props));
}
std::string connect(int from, int to) { return fmt::format("C: \"OO\",{},{}\n", from, to); }

std::string fbx(const std::string& objects, const std::string& connections, const std::string& settings = "") {
    return "; FBX 7.4.0 project file\nFBXHeaderExtension: {\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}\n"
           "GlobalSettings: {\nVersion: 1000\n" +
           properties(settings) + "}\nDefinitions: {\nVersion: 100\n}\nObjects: {\n" + objects + "}\nConnections: {\n" +
           connections + "}\n";
}
const std::string triangle = geometry("0,1,-3");
const std::string connected = connect(20, 0) + connect(10, 20);

class Fbx : public Reading {
protected:
    Fbx() : Reading("a.fbx") {}

    // Expects that a node with these properties moves the corners of the triangle to `where`, up to float32 rounding.
    void expect_at(const std::string& props, const std::vector<Vec3>& where) const {
        expect_near(corners(fbx(triangle + model(props), connected)), where, 1e-6, props);
    }
};

TEST_F(Fbx, VerticesAreTheNearestFloats) {
    const auto found = corners(fbx(triangle + model(""), connected));
    ASSERT_EQ(found.size(), 3u);
    EXPECT_EQ(found[0], Vec3(0.1F, 0, 0));
    EXPECT_EQ(found[2], Vec3(0, 2, 0));
    const LoadedShape loaded = load(fbx(geometry("0,1,2,-4") + model(""), connected));
    EXPECT_EQ(loaded.report.polygons, 1);
    EXPECT_EQ(loaded.report.precision, "float32");
    EXPECT_TRUE(loaded.report.float32);
}

TEST_F(Fbx, NodesMoveTheirMeshes) {
    expect_at(property("Lcl Translation", "Lcl Translation", "1,2,3"), {{1.1, 2, 3}, {2, 2, 3}, {1, 4, 3}});
    expect_at(property("Lcl Rotation", "Lcl Rotation", "0,0,90"), {{0, 0.1, 0}, {0, 1, 0}, {-2, 0, 0}});
    expect_at(property("Lcl Scaling", "Lcl Scaling", "2,3,4"), {{0.2, 0, 0}, {2, 0, 0}, {0, 6, 0}});
    expect_at(property("GeometricTranslation", "Vector3D", "0,0,5") + property("Lcl Scaling", "Lcl Scaling", "1,1,2"),
              {{0.1, 0, 10}, {1, 0, 10}, {0, 2, 10}});
    // The rotation is about the pivot (1, 0, 0).
    expect_at(property("RotationPivot", "Vector3D", "1,0,0") + property("Lcl Rotation", "Lcl Rotation", "0,0,90"),
              {{1, -0.9, 0}, {1, 0, 0}, {-1, -1, 0}});
    const auto nested = corners(fbx(triangle + model(property("Lcl Translation", "Lcl Translation", "1,0,0")) +
                                        model(property("Lcl Scaling", "Lcl Scaling", "2,2,2"), 21),
                                    connect(21, 0) + connect(20, 21) + connect(10, 20)));
    EXPECT_EQ(nested[1], Vec3(4, 0, 0));
}

TEST_F(Fbx, UnitAndAxesAreStatedAndChangeNoNumber) {
    const auto stated = [&](const std::string& settings) {
        const LoadedShape loaded = load(fbx(triangle + model(""), connected, settings));
        EXPECT_EQ(std::get<TriangleMesh>(loaded.shape).vertices.row(2), Eigen::RowVector3d(0, 2, 0)) << settings;
        return loaded.report.stated;
    };
    EXPECT_EQ(stated("").unit, "cm");
    EXPECT_EQ(stated("").up, 'Y');
    EXPECT_EQ(stated(property("UnitScaleFactor", "double", "100")).unit, "m");
    EXPECT_EQ(stated(property("UnitScaleFactor", "double", "2.54")).unit, "inch");
    EXPECT_EQ(stated(property("UnitScaleFactor", "double", "0.1")).unit, "mm");
    EXPECT_EQ(stated(property("UpAxis", "int", "2")).up, 'Z');
    EXPECT_EQ(stated(property("UpAxis", "int", "2") + property("UpAxisSign", "int", "-1")).up, 0);
}

TEST_F(Fbx, DeformedAndCurvedShapesAreRefused) {
    const std::string skin =
        "Deformer: 30, \"Deformer::\", \"Skin\" {\n}\nDeformer: 31, \"SubDeformer::\", \"Cluster\" {\nIndexes: *1 "
        "{\na: "
        "0\n}\nWeights: *1 {\na: 1\n}\nTransform: *16 {\na: 1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1\n}\nTransformLink: *16 "
        "{\na: "
        "1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1\n}\n}\n" +
        model("", 21);
    refused(fbx(triangle + model("") + skin,
                connected + connect(21, 0) + connect(30, 10) + connect(31, 30) + connect(21, 31)),
            {"is deformed by a skeleton, which is not supported"});
    refused(fbx("Geometry: 11, \"Geometry::\", \"NurbsSurface\" {\n}\n" + triangle + model(""), connected),
            {"holds a NurbsSurface, which is not supported: convert it to polygons"});
}

TEST_F(Fbx, WhatAssimpLeavesOutIsRefused) {
    refused(fbx(geometry("0,1,-8") + model(""), connected), {"a.fbx: ", "convert it to OBJ"});
    refused(fbx(triangle + geometry("0,1,-8", 11) + model("") + model("", 21),
                connected + connect(21, 0) + connect(11, 21)),
            {"a.fbx: assimp cannot read a part of it", "polygon vertex index out of range"});
    refused(fbx(triangle + "Geometry: 11, \"Geometry::\", \"Unknown\" {\n}\n" + model("") + model("", 21),
                connected + connect(21, 0) + connect(11, 21)),
            {"a.fbx: assimp cannot read a part of it"});
    const std::string stretched = property("Lcl Scaling", "Lcl Scaling", "2,1,1");
    refused(fbx(triangle + model(property("Lcl Rotation", "Lcl Rotation", "0,0,30")) + model(stretched, 21),
                connect(21, 0) + connect(20, 21) + connect(10, 20)),
            {"is turned below a scale that differs between the axes"});
    refused(fbx(triangle + model(property("Lcl Translation", "Lcl Translation", "3e-4,0,0")), connected),
            {"has a Lcl Translation of 0.0003, 0, 0, which assimp leaves out"});
    refused(fbx(triangle + model(property("Lcl Scaling", "Lcl Scaling", "1,1.0003,1")), connected),
            {"has a Lcl Scaling of 1, 1.0003, 1, which assimp leaves out"});
    const LoadedShape turned =
        load(fbx(triangle + model(property("Lcl Rotation", "Lcl Rotation", "0,1e-6,0")), connected));
    expect_note(turned, "a Lcl Rotation of 0, 1e-06, 0 is left out, because assimp ignores what is so small");
    EXPECT_TRUE(has_note(turned, "RotationActive and InheritType"));
    const auto near =
        corners(fbx(triangle + model(property("Lcl Translation", "Lcl Translation", "4e-4,0,0")), connected));
    EXPECT_NEAR(near[2].x(), 4e-4, 1e-9) << "assimp applies it";
    refused("Kaydara FBX Binary  ", {"a.fbx: cannot be read"});
    refused("nothing", {"a.fbx: "});
}

}  // namespace
}  // namespace hausbench
