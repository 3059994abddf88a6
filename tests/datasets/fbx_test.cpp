// FBX, binary and text: positions under transforms to the double, stated units and axes, notes, and everything that is
// refused.
#include "datasets/circle.h"
#include "datasets/load.h"
#include "datasets/units.h"
#include "tests/support/fbx_files.h"
#include "tests/support/reading.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <variant>
#include <vector>

namespace hausbench {
namespace {

using namespace fbx;

const std::vector<double> vertices = {0.1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3};
const Node triangle = geometry(10, vertices, {0, 1, -3});
const Nodes connected = {connect(20, 0), connect(10, 20)};
const std::vector<Vec3> unmoved = {{0.1, 0, 0}, {1, 0, 0}, {0, 2, 0}};

// A scene of the triangle below one model.
Nodes one_model(const Nodes& props, const Nodes& settings = {}) {
    return document({triangle, model(20, props)}, connected, settings);
}
// A scene of the triangle below a model below another.
Nodes two_models(const Nodes& outer, const Nodes& inner) {
    return document({triangle, model(20, inner), model(21, outer)}, {connect(21, 0), connect(20, 21), connect(10, 20)});
}

class Fbx : public Reading {
protected:
    Fbx() : Reading("a.fbx") {}

    // Expects that these properties of the model move the corners of the triangle to `where`, in text and in binary.
    void expect_at(const Nodes& props, const std::vector<Vec3>& where, double off = 0) const {
        expect_near(corners(text(one_model(props))), where, off, text_of(props));
        expect_near(corners(binary(one_model(props))), where, off, text_of(props));
    }
    void refused_scene(const Nodes& nodes, const std::vector<std::string>& parts) const {
        refused(text(nodes), parts);
        refused(binary(nodes), parts);
    }
};

TEST_F(Fbx, EveryFormGivesTheDoublesOfTheFile) {
    const double odd = std::nextafter(1.0 / 3, 1);
    const Nodes nodes = document(
        {geometry(10, {0.1, odd, 5e-324, -1e300, 2, 0, 3, 123456789.123456789, 0}, {2, 1, -1}), model(20)}, connected);
    const std::vector<Vec3> right = {{3, 123456789.123456789, 0}, {-1e300, 2, 0}, {0.1, odd, 5e-324}};
    const std::vector<std::string> forms = {text(nodes), binary(nodes, 7100, false), binary(nodes, 7400, true),
                                            binary(nodes, 7500, false), binary(nodes, 7700, true)};
    for (std::size_t i = 0; i < forms.size(); ++i) {
        const LoadedShape loaded = load(forms[i]);
        EXPECT_EQ(corners(loaded), right) << i;
        EXPECT_EQ(loaded.report.precision, "float64");
        EXPECT_FALSE(loaded.report.float32);
        EXPECT_TRUE(loaded.report.notes.empty()) << ::testing::PrintToString(loaded.report.notes);
    }
    Nodes narrow = one_model({});
    narrow[3].children[0].children[0].values = {std::vector<float>(vertices.begin(), vertices.end())};
    const LoadedShape loaded = load(binary(narrow));
    EXPECT_EQ(corners(loaded)[0].x(), double{0.1F});
    EXPECT_TRUE(loaded.report.float32);
}

TEST_F(Fbx, NumbersOfAnyLengthInText) {
    std::string bytes = text(one_model({}));
    bytes.replace(bytes.find("0.1,"), 4, "0.1000000000000000055511151231257827021181583404541015625,");
    EXPECT_EQ(corners(bytes), unmoved);
    bytes.replace(bytes.find("Vertices"), 0, "; a comment with { and \"\r\n\t ");
    bytes.replace(bytes.find(",0,0,1,"), 7, ",\r\n0,  0\n,1,");
    EXPECT_EQ(corners(bytes), unmoved);
}

TEST_F(Fbx, PolygonsSegmentsAndPoints) {
    const LoadedShape loaded =
        load(binary(document({geometry(10, vertices, {0, 1, 2, -4, 0, -2, -4}), model(20)}, connected)));
    EXPECT_EQ(loaded.report.polygons, 1);
    EXPECT_EQ(loaded.report.segments, 1);
    EXPECT_EQ(loaded.report.single_points, 1);
    const Node line = {"Geometry",
                       {std::int64_t{10}, std::string("Geometry::"), std::string("Line")},
                       {{"Points", {vertices}}, {"PointsIndex", {std::vector<std::int32_t>{0, 1, -3, 2, -4}}}}};
    const LoadedShape lines = load(text(document({line, model(20)}, connected)));
    EXPECT_EQ(lines.report.segments, 3);
    EXPECT_EQ(std::get<TriangleMesh>(lines.shape).triangles.row(1), Eigen::RowVector3i(1, 2, 2));
}

TEST_F(Fbx, ModelsMoveTheirGeometries) {
    expect_at({property("Lcl Translation", 1.0, 2.0, 3.0)}, {{1.1, 2, 3}, {2, 2, 3}, {1, 4, 3}});
    expect_at({property("Lcl Translation", 1e-9, 0.0, 0.0)}, {{0.1 + 1e-9, 0, 0}, {1 + 1e-9, 0, 0}, {1e-9, 2, 0}});
    expect_at({property("Lcl Rotation", 0.0, 0.0, 90.0)}, {{0, 0.1, 0}, {0, 1, 0}, {-2, 0, 0}});
    expect_at({property("Lcl Scaling", 2.0, 3.0, 4.0)}, {{0.2, 0, 0}, {2, 0, 0}, {0, 6, 0}});
    expect_at({property("GeometricTranslation", 0.0, 0.0, 5.0), property("Lcl Scaling", 1.0, 1.0, 2.0)},
              {{0.1, 0, 10}, {1, 0, 10}, {0, 2, 10}});
    // The rotation is about the pivot (1, 0, 0), and the scale from (0, 1, 0).
    expect_at({property("RotationPivot", 1.0, 0.0, 0.0), property("Lcl Rotation", 0.0, 0.0, 90.0)},
              {{1, -0.9, 0}, {1, 0, 0}, {-1, -1, 0}});
    expect_at({property("ScalingPivot", 0.0, 1.0, 0.0), property("Lcl Scaling", 1.0, 3.0, 1.0)},
              {{0.1, -2, 0}, {1, -2, 0}, {0, 4, 0}});
    expect_at({property("RotationPivot", 0.3, 0.7, 0.9), property("ScalingPivot", 0.3, 0.7, 0.9)}, unmoved);
    expect_at({property("RotationOffset", 1.0, 0.0, 0.0), property("ScalingOffset", 0.0, 1.0, 0.0),
               property("Lcl Rotation", 0.0, 0.0, 90.0)},
              {{0, 0.1, 0}, {0, 1, 0}, {-2, 0, 0}});
    const double third = std::numeric_limits<double>::epsilon() * 16;
    const auto [c, s] = circle_at_degrees(30);
    expect_at({property("Lcl Rotation", 30.0, 0.0, 0.0)}, {{0.1, 0, 0}, {1, 0, 0}, {0, 2 * c, 2 * s}}, third);
}

TEST_F(Fbx, RotationsInTheirOrder) {
    const Node turn = property("Lcl Rotation", 90.0, 90.0, 0.0), active = property("RotationActive", std::int32_t{1});
    // By default about x first, then about y: (0, 2, 0) moves to (0, 0, 2) and (2, 0, 0).
    expect_at({turn}, {{0, 0, -0.1}, {0, 0, -1}, {2, 0, 0}});
    // Order 3 is YXZ: about y first: (1, 0, 0) moves to (0, 0, -1) and (0, 1, 0).
    expect_at({turn, active, property("RotationOrder", std::int32_t{3})}, {{0, 0.1, 0}, {0, 1, 0}, {0, 0, 2}});
    // Rpre R Rpost^-1.
    expect_at({property("PreRotation", 0.0, 0.0, 90.0), property("Lcl Rotation", 90.0, 0.0, 0.0), active},
              {{0, 0.1, 0}, {0, 1, 0}, {0, 0, 2}});
    expect_at({property("PostRotation", 0.0, 0.0, 90.0), property("Lcl Rotation", 90.0, 0.0, 0.0), active},
              {{0, 0, -0.1}, {0, 0, -1}, {2, 0, 0}});
    // The inverse of a rotation about two axes.
    const Nodes undone = {property("PreRotation", 90.0, 90.0, 180.0), property("PostRotation", 90.0, 90.0, 180.0),
                          active};
    expect_at(undone, unmoved);
    for (const char* const name : {"PreRotation", "PostRotation"})
        refused_scene(one_model({property(name, 0.0, 1e-9, 0.0)}), {"while RotationActive is 0, and programs differ"});
    refused_scene(one_model({turn, property("RotationOrder", std::int32_t{1})}), {"while RotationActive is 0"});
    expect_at({property("Lcl Rotation", 0.0, 0.0, 90.0), property("RotationOrder", std::int32_t{1})},
              {{0, 0.1, 0}, {0, 1, 0}, {-2, 0, 0}});
    refused_scene(one_model({turn, active, property("RotationOrder", std::int32_t{6})}), {"has the RotationOrder 6"});
}

TEST_F(Fbx, ModelsBelowModels) {
    const Node stretched = property("Lcl Scaling", 2.0, 1.0, 1.0), even = property("Lcl Scaling", 2.0, 2.0, 2.0),
               turned = property("Lcl Rotation", 0.0, 0.0, 90.0);
    const auto inherits = [](std::int32_t rule) { return property("InheritType", rule); };
    EXPECT_EQ(corners(text(two_models({even}, {property("Lcl Translation", 1.0, 0.0, 0.0)})))[1], Vec3(4, 0, 0));
    // The geometric transform of the outer model does not move the inner one.
    EXPECT_EQ(corners(binary(two_models({property("GeometricTranslation", 5.0, 0.0, 0.0)}, {}))), unmoved);
    const std::vector<Vec3> sheared = {{0, 0.1, 0}, {0, 1, 0}, {-4, 0, 0}};
    EXPECT_EQ(corners(text(two_models({stretched}, {turned, inherits(1)}))), sheared);
    refused_scene(two_models({stretched}, {turned, inherits(0)}),
                  {"'n20' is turned, with InheritType 0, below a scale"});
    refused_scene(two_models({stretched}, {turned}), {"'n20' is turned, with InheritType 0, below a scale"});
    refused_scene(two_models({even}, {inherits(2)}), {"'n20' has InheritType 2 below a scale"});
    refused_scene(two_models({even}, {inherits(7)}), {"has the unknown InheritType 7"});
    EXPECT_EQ(corners(text(two_models({even}, {turned})))[1], Vec3(0, 2, 0));
    EXPECT_EQ(corners(text(two_models({turned}, {inherits(2), stretched})))[1], Vec3(0, 2, 0));
    // What shows no geometry may be turned as it likes.
    EXPECT_EQ(
        corners(text(document({triangle, model(20), model(21, {property("PreRotation", 1.0, 0.0, 0.0)}, "Camera")},
                              {connect(20, 0), connect(10, 20), connect(21, 0)}))),
        unmoved);
}

TEST_F(Fbx, TemplatesGiveDefaults) {
    const auto with = [](const Nodes& defaults, const Nodes& props) {
        return document(
            {triangle, model(20, props)}, connected, {},
            {{"ObjectType",
              {std::string("Model")},
              {{"Count", {std::int32_t{1}}}, {"PropertyTemplate", {std::string("FbxNode")}, {properties(defaults)}}}}});
    };
    const Node shift = property("Lcl Translation", 5.0, 0.0, 0.0), active = property("RotationActive", std::int32_t{1});
    EXPECT_EQ(corners(text(with({shift}, {})))[1], Vec3(6, 0, 0));
    EXPECT_EQ(corners(binary(with({shift}, {property("Lcl Translation", 0.0, 0.0, 1.0)})))[1], Vec3(1, 0, 1));
    EXPECT_EQ(corners(binary(with({active}, {property("PreRotation", 0.0, 0.0, 90.0)})))[1], Vec3(0, 1, 0));
    EXPECT_TRUE(has_note(load(text(with({property("Show", std::int32_t{0})}, {}))), "1 of its models are hidden"));
}

TEST_F(Fbx, UnitIsStatedAndChangesNoNumber) {
    const auto unit = [&](const Nodes& settings) {
        const LoadedShape loaded = load(binary(one_model({}, settings)));
        EXPECT_EQ(corners(loaded), unmoved);
        return loaded.report.stated.unit;
    };
    EXPECT_EQ(unit({}), "cm");
    EXPECT_EQ(unit({property("UnitScaleFactor", 100.0)}), "m");
    EXPECT_EQ(unit({property("UnitScaleFactor", 2.54)}), "inch");
    EXPECT_EQ(unit({property("UnitScaleFactor", double{2.54F})}), "inch");
    EXPECT_EQ(unit({property("UnitScaleFactor", 0.1)}), "mm");
    EXPECT_EQ(unit({property("UnitScaleFactor", -1.0)}), "");
    expect_note(load(text(one_model({}, {property("UnitScaleFactor", 0.0)}))),
                "its UnitScaleFactor is not a positive number, and counts as not stated");
}

Nodes axes(int up, int up_sign, int front, int front_sign, int right, int right_sign) {
    return {property("UpAxis", std::int32_t{up}),       property("UpAxisSign", std::int32_t{up_sign}),
            property("FrontAxis", std::int32_t{front}), property("FrontAxisSign", std::int32_t{front_sign}),
            property("CoordAxis", std::int32_t{right}), property("CoordAxisSign", std::int32_t{right_sign})};
}

// Writes the same shape in each of the 48 systems of axes, also the 24 that Blender offers. Each is stated so that --up
// gives the shape back, or not at all.
TEST_F(Fbx, AxesAreStatedOnlyIfTheyAreThoseOfUp) {
    const std::vector<Vec3> shape = {{1, 2, 3}, {4, 0, 0}, {0, 5, 0}};  // to the right, up, towards the viewer
    int stated = 0;
    for (int code = 0; code < 3 * 3 * 3 * 8; ++code) {
        const int up = code % 3, front = code / 3 % 3, right = code / 9 % 3, signs = code / 27;
        const int us = signs & 1 ? -1 : 1, fs = signs & 2 ? -1 : 1, rs = signs & 4 ? -1 : 1;
        if (up == front || up == right || front == right) continue;
        std::vector<double> written;
        for (const Vec3& p : shape) {
            Vec3 moved;
            moved[right] = rs * p[0], moved[up] = us * p[1], moved[front] = fs * p[2];
            written.insert(written.end(), moved.begin(), moved.end());
        }
        LoadedShape loaded = load(text(
            document({geometry(10, written, {0, 1, -3}), model(20)}, connected, axes(up, us, front, fs, right, rs))));
        const bool told = has_note(loaded, "to the right: --up knows no such axes, so it counts as stating none");
        EXPECT_EQ(loaded.report.stated.up == 0, told) << code;
        if (told) continue;
        ++stated;
        convert_to_up(loaded, 'Y');
        EXPECT_EQ(corners(loaded), shape) << code;
    }
    EXPECT_EQ(stated, 3) << "X, Y and Z up";
    EXPECT_EQ(load(text(one_model({}))).report.stated.up, 'Y');
    EXPECT_EQ(load(text(one_model({}, axes(2, 1, 1, -1, 0, 1)))).report.stated.up, 'Z') << "3ds Max";
    expect_note(
        load(text(one_model({}, axes(2, 1, 1, 1, 0, -1)))),
        "in its axes +Z points up, +Y to the viewer and -X to the right: --up knows no such axes, so it counts as "
        "stating none");
    expect_note(
        load(text(one_model({}, {property("UpAxis", std::int32_t{5})}))),
        "in its axes ? points up, +Z to the viewer and +X to the right: --up knows no such axes, so it counts as "
        "stating none");
}

TEST_F(Fbx, InstancesAndObjectsOutsideOfTheScene) {
    const LoadedShape loaded =
        load(text(document({triangle, geometry(11, vertices, {0, 1, -3}), geometry(12, {}, {}), model(20),
                            model(21, {property("Lcl Translation", 0.0, 0.0, 7.0)}), model(22), model(23), model(24)},
                           {connect(20, 0), connect(21, 0), connect(10, 20), connect(10, 21), connect(12, 20),
                            connect(11, 22), connect(23, 24), connect(24, 23)})));
    EXPECT_EQ(loaded.report.objects, 2);
    EXPECT_EQ(corners(loaded)[3], Vec3(0.1, 0, 7));
    expect_note(loaded, "3 of its models are left out: the scene does not hold them");
    expect_note(loaded, "1 of its geometries are left out: no model of the scene shows them");
    expect_note(loaded, "1 of its geometries have no polygons and no lines, and add nothing");
    refused_scene(document({triangle, model(20)}, {connect(10, 20)}), {"no model of its scene shows a polygon"});
    refused_scene(
        document({triangle, model(20), model(21)}, {connect(20, 0), connect(10, 20), connect(21, 0), connect(20, 21)}),
        {"model 'n20' is below two others"});
    refused_scene(document({triangle, model(20)}, {connect(20, 0), connect(10, 20), connect(11, 20)}),
                  {"object 11, a part of model 'n20', is not in the file"});
    refused_scene(document({triangle, triangle, model(20)}, connected), {"two objects have the id 10"});
}

TEST_F(Fbx, ScenesAreBounded) {
    Nodes objects = {triangle}, connections = {connect(10, 1300), connect(1001, 0)};
    for (int id = 1001; id <= 1300; ++id) {
        objects.push_back(model(id));
        if (id > 1001) connections.push_back(connect(id, id - 1));
    }
    refused_scene(document(objects, connections), {"models are nested deeper than 256"});
    std::vector<std::int32_t> face(30000, 0);
    face.back() = -1;
    objects = {geometry(1, std::vector<double>(3 * face.size(), 1.0), face)}, connections.clear();
    for (int id = 2; id < 22; ++id) {
        objects.push_back(model(id));
        connections.push_back(connect(id, 0));
        connections.push_back(connect(1, id));
    }
    refused(binary(document(objects, connections)), {"models repeat geometries so often"});
    std::string deep;
    for (int i = 0; i < 100000; ++i) deep += "a: {\n";
    refused("; FBX 7.4.0\n" + deep, {"nodes are nested deeper than"});
}

TEST_F(Fbx, NotesTellWhatIsNotShownAsItIs) {
    const auto note_of = [&](Node extra, const char* note) {
        expect_note(load(binary(document({triangle, model(20), std::move(extra)}, connected))), note);
    };
    note_of({"AnimationCurve", {std::int64_t{30}, std::string(), std::string()}},
            "its animations are left out: the transforms of the models count");
    note_of({"Constraint", {std::int64_t{30}, std::string(), std::string()}},
            "1 constraints are left out: the transforms of the models count");
    EXPECT_TRUE(has_note(load(text(one_model({property("Visibility", 0.0)}))), "1 of its models are hidden, and read"));
    EXPECT_TRUE(
        has_note(load(text(two_models({property("Visibility", 0.0)}, {}))), "1 of its models are hidden, and read"));
    Nodes smooth = one_model({});
    smooth[3].children[0].children.push_back({"Smoothness", {std::int32_t{2}}});
    expect_note(load(text(smooth)), "1 of its meshes are shown smoothed: their control meshes are read");
    using Ints = std::vector<std::int32_t>;
    for (const auto& [edges, odd] :
         {std::pair{Ints{0, 1, 2}, false}, {Ints{0, 2}, true}, {Ints{}, false}, {Ints{7, -1}, false}}) {
        Nodes listed = one_model({});
        listed[3].children[0].children.push_back({"Edges", {edges}});
        EXPECT_EQ(
            has_note(load(binary(listed)), "1 of its meshes have polygons with sides that are not among their Edges"),
            odd);
        EXPECT_EQ(
            has_note(load(text(listed)), "1 of its meshes have polygons with sides that are not among their Edges"),
            odd);
    }
}

TEST_F(Fbx, DeformedAndOtherGeometriesAreRefused) {
    for (const char* const kind : {"Skin", "BlendShape"}) {
        Nodes deformed = one_model({});
        deformed[3].children.push_back({"Deformer", {std::int64_t{30}, std::string("Deformer::"), std::string(kind)}});
        deformed[4].children.push_back(connect(30, 10));
        refused_scene(deformed, {fmt::format("is deformed by Deformer '{}', which is not supported: apply it", kind)});
    }
    for (const char* const kind : {"Shape", "NurbsCurve", "NurbsSurface", "TrimNurbsSurface", "Boundary", "Patch"}) {
        Nodes curved = one_model({});
        curved[3].children[0].values[2] = std::string(kind);
        refused_scene(curved, {fmt::format("is a {}, which is not supported: convert it to polygons", kind)});
    }
    Nodes changed = one_model({});
    changed[3].children[0].children.push_back({"Shape", {std::string("smile")}});
    refused_scene(changed, {"has blend shapes, which are not supported"});
    changed = one_model({});
    changed[3].children[0].children.push_back(
        {"LayerElementHole", {std::int32_t{0}}, {{"Hole", {std::vector<std::int32_t>{1}}}}});
    refused_scene(changed, {"marks polygons as holes, which is not supported: delete them"});
    changed = one_model({});
    changed[3].children.push_back({"NodeAttribute", {std::int64_t{30}, std::string(), std::string("LodGroup")}});
    changed[4].children.push_back(connect(30, 20));
    refused_scene(changed, {"model 'n20' is a LodGroup, which holds several versions"});
    changed = one_model({});
    changed[3].children.push_back({"SceneReference", {std::int64_t{30}}});
    refused_scene(changed, {"refers to another file, which is not supported"});
    changed = one_model({});
    changed[3].children.push_back(model(21));
    changed[4].children.push_back(
        {"C", {std::string("OP"), std::int64_t{21}, std::int64_t{20}, std::string("LookAtProperty")}});
    refused_scene(changed, {"model 'n20' has a LookAtProperty"});
    refused_scene(one_model({property("Lcl Translation", 5.0, 0.0, 0.0), property("TranslationActive", std::int32_t{1}),
                             property("TranslationMaxX", std::int32_t{1}), property("TranslationMax", 2.0, 0.0, 0.0)}),
                  {"has a Lcl Translation beyond its limits"});
    refused_scene(one_model({property("Lcl Translation", 5.0, 0.0, 0.0), property("Lcl Translation", 2.0, 0.0, 0.0)}),
                  {"Lcl Translation stands twice: remove one"});
}

TEST_F(Fbx, DamagedListsAreRefused) {
    const auto with = [](std::vector<double> points, std::vector<std::int32_t> list) {
        return document({geometry(10, std::move(points), std::move(list)), model(20)}, connected);
    };
    refused_scene(with(vertices, {0, 1, -8}), {"-8 in PolygonVertexIndex names none of the 4 vertices"});
    refused_scene(with(vertices, {0, 4, -3}), {"4 in PolygonVertexIndex names none of the 4 vertices"});
    refused_scene(with(vertices, {0, 1, 2}), {"the last number of PolygonVertexIndex is not negative"});
    refused_scene(with({1, 2, 3, 4}, {0, -1}), {"Vertices has 4 numbers, not a multiple of 3"});
    refused(text(with({1, 2, std::nan("")}, {0, -1})), {"has a coordinate that is not finite"});
    refused_scene(one_model({property("Lcl Scaling", 1.0, std::numeric_limits<double>::infinity(), 1.0)}),
                  {"Lcl Scaling is not finite"});
    refused_scene(one_model({property("Lcl Scaling", 1.0, 1.0)}), {"value 7 of P is not a number"});
    for (const char* const name : {"Objects", "Connections"}) {
        Nodes twice = one_model({});
        twice.push_back({name, {}, {triangle}});
        refused_scene(twice, {fmt::format("{} stands twice", name)});
    }
    std::string bytes = text(one_model({}));
    bytes.replace(bytes.find("0.1,"), 4, "0.1x,");
    refused(bytes, {"line ", "'0.1x' in Vertices is not a number"});
    bytes = text(one_model({}));
    bytes.replace(bytes.find("*12"), 3, "*13");
    refused(bytes, {"Vertices does not have the 13 elements that it says"});
    Nodes wrong = one_model({});
    wrong[3].children[0].children[0].values = {std::vector<std::int32_t>{1, 2, 3}};
    refused(binary(wrong), {"Vertices is not an array of float32 or float64 numbers"});
}

TEST_F(Fbx, OtherVersionsAndOtherFilesAreRefused) {
    refused(binary(one_model({}), 6100), {"is version 6100 of FBX, and only 7000 to 7700 are supported: export it as"});
    refused(binary(one_model({}), 8000), {"is version 8000 of FBX"});
    std::string old = text(one_model({}));
    old.replace(old.find("7400"), 4, "6100");
    refused(old, {"is version 6100 of FBX"});
    refused("; FBX 7.4.0\n", {"has no FBXVersion"});
    refused("nothing", {"does not begin like a binary or a text FBX file"});
    refused("Kaydara FBX Binary  ", {"does not begin like a binary or a text FBX file"});
}

// No part of a sound file is sound.
TEST_F(Fbx, TruncatedFilesAreRefused) {
    for (const std::uint32_t version : {7400u, 7500u}) {
        std::string whole = binary(one_model({}), version);
        whole.resize(whole.size() - 160);
        for (std::size_t size = 1; size < whole.size(); ++size) refused(whole.substr(0, size), {"a.fbx: "});
    }
    std::string whole = text(one_model({}));
    whole.resize(whole.size() - 2);  // without the last '}'
    for (std::size_t size = 1; size <= whole.size(); ++size) refused(whole.substr(0, size), {"a.fbx: "});
}

// Sizes are checked before memory is allocated.
TEST_F(Fbx, ArraysThatClaimTooMuchAreRefused) {
    const std::string sound = binary(one_model({}), 7400, false), packed = binary(one_model({}), 7400, true);
    const auto claim = [&](std::string bytes, std::size_t after, std::uint32_t value) {
        const std::size_t at = bytes.find("Vertices") + 9 + after;
        std::memcpy(bytes.data() + at, &value, 4);
        refused(bytes, {"at byte "});
    };
    claim(sound, 0, 0xffffffff), claim(sound, 0, 13), claim(sound, 4, 2), claim(sound, 8, 0xffffffff);
    claim(packed, 0, 0xffffffff), claim(packed, 0, 13), claim(packed, 0, 11), claim(packed, 4, 0);
    Nodes zeros = document({geometry(10, std::vector<double>(9000000, 0.0), {0, 0, -1}), model(20)}, connected);
    refused(binary(zeros), {"its arrays inflate to more than 200 times its size"});
}

}  // namespace
}  // namespace hausbench
