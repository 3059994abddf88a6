// Collada: positions under every kind of transform, every kind of primitive, units and axes, and what is refused.
#include "datasets/load.h"
#include "tests/support/reading.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <variant>
#include <vector>

namespace hausbench {
namespace {

constexpr double u = std::numeric_limits<double>::epsilon() / 2;

const std::string params =
    R"(<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>)";
const std::string triangles =
    R"(<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>)";

std::string source(const std::string& numbers, const std::string& array, const std::string& accessor,
                   const std::string& named = params) {
    return fmt::format(R"(<source id="p"><float_array id="pa" {}>{}</float_array><technique_common>)"
                       R"(<accessor source="#pa" {}>{}</accessor></technique_common></source>)",
                       array, numbers, accessor, named);
}
const std::string vertices = R"(<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>)";
const std::string positions = source("0 0 0 1 0 0 0 2 0 0 0 3", R"(count="12")", R"(count="4" stride="3")");

std::string geometry(const std::string& mesh, const std::string& id = "g") {
    return fmt::format(R"(<geometry id="{}">{}</geometry>)", id, mesh);
}
std::string mesh(const std::string& primitives) { return "<mesh>" + positions + vertices + primitives + "</mesh>"; }
std::string node(const std::string& inside) { return "<node>" + inside + "</node>"; }
const std::string instance = R"(<instance_geometry url="#g"/>)";
const std::string scene = R"(<scene><instance_visual_scene url="#s"/></scene>)";

// A document with these geometries, and the scene 's' with these nodes.
std::string document(const std::string& geometries, const std::string& nodes, const std::string& more = scene,
                     const std::string& asset = "") {
    return fmt::format(R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" )"
                       R"(version="1.4.1">{}<library_geometries>{}</library_geometries><library_visual_scenes>)"
                       R"(<visual_scene id="s">{}</visual_scene></library_visual_scenes>{}</COLLADA>)",
                       asset.empty() ? "" : "<asset>" + asset + "</asset>", geometries, nodes, more);
}
std::string with_primitives(const std::string& primitives) {
    return document(geometry(mesh(primitives)), node(instance));
}

class Collada : public Reading {
protected:
    Collada() : Reading("a.dae") {}

    // Expects that a node with these transforms moves (0, 0, 0), (1, 0, 0) and (0, 2, 0) to `where`.
    void expect_at(const std::string& transforms, const std::vector<Vec3>& where, double off = 0) const {
        expect_near(corners(document(geometry(mesh(triangles)), node(transforms + instance))), where, off, transforms);
    }
    void expect_faces(const std::string& primitives, const std::vector<std::vector<int>>& faces) const {
        const std::vector<Vec3> all = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
        std::vector<Vec3> expected;
        for (const auto& face : faces)
            for (const int v : face) expected.push_back(all[static_cast<std::size_t>(v)]);
        EXPECT_EQ(corners(with_primitives(primitives)), expected) << primitives;
    }
};

TEST_F(Collada, VerticesAreReadToTheLastBit) {
    const std::string text = source("0.1 1e-17 +.5\n0.30000000000000004 -2.7182818284590451<!-- 7 --> 1e300 3 4 5.",
                                    R"(count="9")", R"(count="3" stride="3")");
    const auto points = corners(document(geometry("<mesh>" + text + vertices + triangles + "</mesh>"), node(instance)));
    ASSERT_EQ(points.size(), 3u);
    EXPECT_EQ(points[0], Vec3(0.1, 1e-17, 0.5));
    EXPECT_EQ(points[1], Vec3(0.1 + 0.2, -2.718281828459045, 1e300));
    EXPECT_EQ(points[2], Vec3(3, 4, 5));
}

TEST_F(Collada, AccessorsHaveOffsetsStridesAndUnnamedParams) {
    const auto read = [&](const std::string& text) {
        return corners(document(geometry("<mesh>" + text + vertices + triangles + "</mesh>"), node(instance)));
    };
    const std::vector<Vec3> expected = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
    EXPECT_EQ(read(source("-1 -1 0 1 2 3 0 4 5 6 0 7 8 9", R"(count="14")", R"(count="3" offset="2" stride="4")",
                          R"(<param type="float"/>)" + params)),
              expected);
    EXPECT_EQ(read(source("2 1 3 9 5 4 6 9 8 7 9", R"(count="11")", R"(count="3" stride="4")",
                          R"(<param name="Y" type="float"/><param name="X" type="float"/>)"
                          R"(<param name="Z" type="float"/>)")),
              expected)
        << "by the names of the params; the last element may end before its stride does";
    const auto wrong = [&](const std::string& accessor, const std::string& named, const std::string& why) {
        refused(document(geometry("<mesh>" + source("1 2 3 4 5 6 7 8 9", R"(count="9")", accessor, named) + vertices +
                                  triangles + "</mesh>"),
                         node(instance)),
                {"a.dae: line 1: ", why});
    };
    wrong(R"(count="4" stride="3")", params, "reaches beyond the 9 numbers");
    wrong(R"(count="3" stride="3" offset="1")", params, "reaches beyond the 9 numbers");
    wrong(R"(count="18446744073709551615" stride="3")", params, "reaches beyond");
    wrong(R"(count="2" stride="18446744073709551615")", params, "reaches beyond");
    wrong(R"(count="3" stride="2")", params, "3 params and the stride 2");
    wrong(R"(count="3" stride="3")", R"(<param name="X" type="float"/><param name="Y" type="float"/>)",
          "2 named params");
    wrong(R"(count="3" stride="3")",
          R"(<param name="X" type="float"/><param name="Y" type="float"/><param name="X" type="float"/>)",
          "a param 'X' where X, Y and Z are expected");
    refused(document(geometry("<mesh>" + source("1 2 3", R"(count="4")", R"(count="1" stride="3")") + vertices +
                              triangles + "</mesh>"),
                     node(instance)),
            {"announces 4 numbers and has 3"});
}

TEST_F(Collada, PrimitivesOfEveryKind) {
    const std::string input = R"(<input semantic="VERTEX" source="#v" offset="0"/>)";
    expect_faces(triangles, {{0, 1, 2}});
    expect_faces(R"(<triangles count="2"><input semantic="NORMAL" source="#n" offset="2"/>)"
                 R"(<input semantic="VERTEX" source="#v" offset="1"/><p>9 0 9 9 1 9 9 2 9 9 1 9 9 2 9 9 3 9</p>)"
                 "</triangles>",
                 {{0, 1, 2}, {1, 2, 3}});
    expect_faces("<trifans count=\"1\">" + input + "<p>0 1 2 3</p></trifans>", {{0, 1, 2}, {0, 2, 3}});
    expect_faces("<tristrips count=\"2\">" + input + "<p>0 1 2 3</p><p>3 1 0</p></tristrips>",
                 {{0, 1, 2}, {2, 1, 3}, {3, 1, 0}});
    expect_faces("<polylist count=\"2\">" + input + "<vcount>3 3</vcount><p>0 1 2 1 2 3</p></polylist>",
                 {{0, 1, 2}, {1, 2, 3}});
    expect_faces("<polygons count=\"2\">" + input + "<p>0 1 2</p><p>2 1 3</p></polygons>", {{0, 1, 2}, {2, 1, 3}});
    expect_faces("<lines count=\"2\">" + input + "<p>0 1 2 3</p></lines>", {{0, 1, 1}, {2, 3, 3}});
    expect_faces("<linestrips count=\"1\">" + input + "<p>0 1 2</p></linestrips>", {{0, 1, 1}, {1, 2, 2}});
    expect_faces(triangles + "<lines count=\"1\">" + input + "<p>1 3</p></lines>", {{0, 1, 2}, {1, 3, 3}});
    const LoadedShape square = load(with_primitives("<polygons>" + input + "<p>0 1 2 3</p></polygons>"));
    EXPECT_EQ(square.report.polygons, 1);
    EXPECT_EQ(std::get<TriangleMesh>(square.shape).triangles.rows(), 2);
}

TEST_F(Collada, AllTrianglesOfAStripHaveOneOrientation) {
    const std::string strip = R"(<tristrips count="1"><input semantic="VERTEX" source="#v" offset="0"/>)";
    expect_faces(strip + "<p>0 1 2 3 0 1</p></tristrips>", {{0, 1, 2}, {2, 1, 3}, {2, 3, 0}, {0, 3, 1}});
}

TEST_F(Collada, ParamsNameTheAxesInAnyOrder) {
    const auto first = [&](const std::string& named) {
        const std::string text = source("1 2 3 4 5 6 7 8 9", R"(count="9")", R"(count="3" stride="3")", named);
        return corners(document(geometry("<mesh>" + text + vertices + triangles + "</mesh>"), node(instance)))[0];
    };
    const auto param = [](const std::string& name) { return R"(<param type="float" name=")" + name + "\"/>"; };
    EXPECT_EQ(first(param("Z") + param("Y") + param("X")), Vec3(3, 2, 1));
    EXPECT_EQ(first(param("Y") + param("Z") + param("X")), Vec3(3, 1, 2));
}

TEST_F(Collada, WhatStandsTwiceIsRefused) {
    refused(document(geometry("<mesh>" + positions + vertices + vertices + triangles + "</mesh>"), node(instance)),
            {"a second <vertices> in one <mesh>", "remove one of them"});
    refused(document(geometry(mesh(triangles)), node(instance), scene + scene), {"a second <scene>"});
    refused(document(geometry(mesh(triangles)), node(instance), scene, R"(<unit meter="1"/><unit meter="0.01"/>)"),
            {"a second <unit> in one <asset>"});
    refused(document(geometry("<mesh>" + source("0 0 0", R"(count="3")", R"(count="1" stride="3" count="2")") +
                              vertices + triangles + "</mesh>"),
                     node(instance)),
            {"line 1", "<accessor> has the attribute 'count' twice"});
}

TEST_F(Collada, ACommentInsideOfANumberIsRefused) {
    expect_faces(R"(<triangles><input semantic="VERTEX" source="#v" offset="0"/><p>0 1<!-- --> 2</p></triangles>)",
                 {{0, 1, 2}});
    for (const char* p : {"0 1<!-- -->2", "0 1 <!-- -->1<![CDATA[ 2]]><!-- -->3", "0<!-- -->0 1 2"})
        refused(with_primitives(R"(<triangles><input semantic="VERTEX" source="#v" offset="0"/><p>)" + std::string(p) +
                                "</p></triangles>"),
                {"a comment or CDATA section in <p>", "remove it"});
    const std::string text = source("0 0 0 1<!-- -->0 0 0 2 0", R"(count="9")", R"(count="3" stride="3")");
    refused(document(geometry("<mesh>" + text + vertices + triangles + "</mesh>"), node(instance)), {"<float_array>"});
}

TEST_F(Collada, NodesThatAProgramHidesAreRead) {
    const auto hidden = [&](const std::string& visibility) {
        return load(document(geometry(mesh(triangles)), node(instance + "<extra><technique profile=\"MAYA\">" +
                                                             visibility + "</technique></extra>")));
    };
    for (const char* value : {"0", " false ", "0.0", "FALSE"})
        EXPECT_EQ(hidden(fmt::format("<visibility>{}</visibility>", value)).report.notes,
                  std::vector<std::string>{"<node> is read, although <visibility> in an <extra> hides it"});
    EXPECT_TRUE(hidden("<visibility>1</visibility>").report.notes.empty());
    EXPECT_TRUE(hidden("<dynamic>0</dynamic>").report.notes.empty());
    const std::string nothing = "<node><extra><technique><visibility>0</visibility></technique></extra></node>";
    EXPECT_TRUE(load(document(geometry(mesh(triangles)), node(instance) + nothing)).report.notes.empty());
}

TEST_F(Collada, DamagedPrimitivesAreRefused) {
    const std::string input = R"(<input semantic="VERTEX" source="#v" offset="0"/>)";
    const auto wrong = [&](const std::string& primitives, const std::string& why) {
        refused(with_primitives(primitives), {"a.dae: line 1: ", why});
    };
    wrong("<triangles>" + input + "<p>0 1 4</p></triangles>", "'4' names none of the 4 vertices");
    wrong("<triangles>" + input + "<p>0 1 -1</p></triangles>", "'-1' is not an integer of at least 0");
    wrong("<triangles>" + input + "<p>0 1</p></triangles>", "has 2 corners, not a multiple of 3");
    wrong("<triangles count=\"2\">" + input + "<p>0 1 2</p></triangles>", "announces count=\"2\" and has 1");
    wrong("<tristrips>" + input + "<p>0 1</p></tristrips>", "fewer than 3");
    wrong("<linestrips>" + input + "<p>0</p></linestrips>", "fewer than 2");
    wrong("<polylist>" + input + "<vcount>3 3</vcount><p>0 1 2 3</p></polylist>", "<vcount> of <polylist>");
    wrong("<polylist>" + input + "<vcount>3</vcount><p>0 1 2 3</p></polylist>", "<vcount> of <polylist>");
    wrong("<polylist>" + input + "<vcount>18446744073709551615 4</vcount><p>0 1 2</p></polylist>", "<vcount>");
    wrong("<polygons>" + input + "<ph><p>0 1 2</p><h>0 1 3</h></ph></polygons>", "a polygon with holes");
    wrong("<triangles><p>0 1 2</p></triangles>", "has no input VERTEX");
    wrong(R"(<triangles><input semantic="VERTEX" source="#w" offset="0"/><p>0 1 2</p></triangles>)",
          "does not name the <vertices>");
    wrong(R"(<triangles><input semantic="VERTEX" source="#v" offset="18446744073709551615"/><p>0 1 2</p></triangles>)",
          "is too large");
    wrong("<triangles>" + input + R"(<input semantic="NORMAL" source="#n" offset="1"/><p>0 1 2</p></triangles>)",
          "has 3 indices, not 2 for each corner");
}

TEST_F(Collada, TransformsOfEveryKind) {
    expect_at("", {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});
    expect_at("<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>", {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});
    expect_at("<translate>1 2 3</translate>", {{1, 2, 3}, {2, 2, 3}, {1, 4, 3}});
    expect_at("<scale>2 3 4</scale>", {{0, 0, 0}, {2, 0, 0}, {0, 6, 0}});
    expect_at("<matrix>1 2 3 4 5 6 7 8 9 10 11 12 0 0 0 1</matrix>", {{4, 8, 12}, {5, 13, 21}, {8, 20, 32}});
    expect_at("<rotate>0 0 1 90</rotate>", {{0, 0, 0}, {0, 1, 0}, {-2, 0, 0}});
    expect_at("<rotate>0 0 5 -90</rotate>", {{0, 0, 0}, {0, -1, 0}, {2, 0, 0}});
    expect_at("<rotate>0 1 0 450</rotate>", {{0, 0, 0}, {0, 0, -1}, {0, 2, 0}});
    expect_at("<rotate>1 0 0 180</rotate>", {{0, 0, 0}, {1, 0, 0}, {0, -2, 0}});
    const double half = std::sqrt(0.5);
    expect_at("<rotate>0 0 1 45</rotate>", {{0, 0, 0}, {half, half, 0}, {-2 * half, 2 * half, 0}}, 32 * u);
    expect_at("<rotate>1 1 1 120</rotate>", {{0, 0, 0}, {0, 1, 0}, {0, 0, 2}}, 32 * u);
    // At (5, 0, 0), -z towards (0, 0, 0), y up: x points to -z of the world.
    expect_at("<lookat>5 0 0 0 0 0 0 1 0</lookat>", {{5, 0, 0}, {5, 0, -1}, {5, 2, 0}}, 32 * u);
}

TEST_F(Collada, TransformsApplyInTheOrderOfTheDocument) {
    expect_at("<translate>1 0 0</translate><scale>2 2 2</scale>", {{1, 0, 0}, {3, 0, 0}, {1, 4, 0}});
    expect_at("<scale>2 2 2</scale><translate>1 0 0</translate>", {{2, 0, 0}, {4, 0, 0}, {2, 4, 0}});
    const auto nested =
        corners(document(geometry(mesh(triangles)),
                         node("<rotate>0 0 1 90</rotate>" + node("<translate>1 0 0</translate>" + instance))));
    EXPECT_EQ(nested, (std::vector<Vec3>{{0, 1, 0}, {0, 2, 0}, {-2, 1, 0}}));
}

TEST_F(Collada, TransformsThatAreNotSupportedMatterOnlyAboveAMesh) {
    const auto wrong = [&](const std::string& transform, const std::string& why) {
        refused(document(geometry(mesh(triangles)), node(transform + node(instance))), {"a.dae: line 1: ", why});
        EXPECT_EQ(corners(document(geometry(mesh(triangles)), node(transform) + node(instance))).size(), 3u);
    };
    wrong("<skew>45 0 1 0 1 0 0</skew>", "<skew> is not supported: write it as <matrix>");
    wrong("<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1</matrix>", "row 0 0 0 1");
    wrong("<rotate>0 0 0 90</rotate>", "axis 0 0 0");
    wrong("<lookat>0 0 0 0 1 0 0 1 0</lookat>", "<lookat> has no direction");
    refused(document(geometry(mesh(triangles)), node("<scale>1 2</scale>" + instance)),
            {"<scale> has 2 numbers, not 3"});
    refused(document(geometry(mesh(triangles)), node("<scale>1 2 inf</scale>" + instance)), {"not finite"});
}

TEST_F(Collada, NodesAreInstantiated) {
    const std::string library =
        R"(<library_nodes><node id="n"><translate>0 0 1</translate>)" + instance + "</node></library_nodes>" + scene;
    const std::string twice =
        node(R"(<instance_node url="#n"/>)") + node(R"(<translate>1 0 0</translate><instance_node url="#n"/>)");
    const std::string text = document(geometry(mesh(triangles)), twice, library);
    EXPECT_EQ(corners(text), (std::vector<Vec3>{{0, 0, 1}, {1, 0, 1}, {0, 2, 1}, {1, 0, 1}, {2, 0, 1}, {1, 2, 1}}));
    EXPECT_EQ(load(text).report.objects, 2);
    EXPECT_EQ(load(text).report.unreferenced, 2) << "the fourth vertex, twice";
}

TEST_F(Collada, InstancesCannotFillTheMemory) {
    const auto with_nodes = [&](const std::string& nodes) {
        return document(geometry(mesh(triangles)), node(R"(<instance_node url="#n0"/>)"),
                        "<library_nodes>" + nodes + "</library_nodes>" + scene);
    };
    refused(with_nodes(R"(<node id="n0"><node><instance_node url="#n0"/></node></node>)"),
            {"<node> 'n0' contains an instance of itself"});
    std::string doubled, deep, deep_end;
    for (int i = 0; i < 40; ++i)
        doubled += fmt::format(R"(<node id="n{}"><instance_node url="#n{}"/><instance_node url="#n{}"/></node>)", i,
                               i + 1, i + 1);
    refused(with_nodes(doubled + R"(<node id="n40">)" + instance + "</node>"), {"instances repeat nodes so often"});
    for (int i = 0; i < 300; ++i) {
        deep += "<node>";
        deep_end += "</node>";
    }
    refused(document(geometry(mesh(triangles)), deep + instance + deep_end), {"nested deeper than 256"});
}

TEST_F(Collada, UnitAndAxesAreStatedAndChangeNoNumber) {
    const auto stated = [&](const std::string& asset) {
        const LoadedShape loaded = load(document(geometry(mesh(triangles)), node(instance), scene, asset));
        EXPECT_EQ(std::get<TriangleMesh>(loaded.shape).vertices.row(2), Eigen::RowVector3d(0, 2, 0));
        return loaded.report.stated;
    };
    EXPECT_EQ(stated("").unit, "m");
    EXPECT_EQ(stated("").micrometres, 1e6);
    EXPECT_EQ(stated("").up, 'Y');
    EXPECT_EQ(stated(R"(<unit name="inch" meter="0.0254"/><up_axis>Z_UP</up_axis>)").unit, "inch");
    EXPECT_EQ(stated(R"(<unit name="inch" meter="0.0254"/><up_axis> Z_UP </up_axis>)").up, 'Z');
    EXPECT_EQ(stated(R"(<unit meter="0.001"/><up_axis>X_UP</up_axis>)").up, 'X');
    EXPECT_EQ(stated(R"(<unit meter="0.001"/>)").micrometres, 1e3);
    EXPECT_EQ(stated(R"(<unit meter="0,01"/>)").micrometres, 0);
    EXPECT_EQ(stated("<up_axis>UP</up_axis>").up, 0);
}

TEST_F(Collada, NotesSayWhatIsLeftOut) {
    const std::string good = geometry(mesh(triangles));
    expect_note(load(document(good, node(instance), scene, R"(<unit meter="0,01"/>)")),
                "its unit, meter=\"0,01\", is not a positive number, and counts as not stated");
    expect_note(load(document(good, node(instance), scene, R"(<unit name="centimeter" meter="1"/>)")),
                "its unit has the name 'centimeter' and meter=\"1\": the latter counts");
    expect_note(load(document(good + geometry(mesh(triangles), "h"), node(instance))),
                "<geometry> 'h' is left out: no node of the scene instantiates it");
    expect_note(load(document(good + geometry(mesh(triangles), "h") + geometry("", "i"), node(instance))),
                "<geometry> 'h' and 1 more are left out: no node of the scene instantiates them");
    expect_note(load(document(good, node(instance), "<library_animations><animation/></library_animations>" + scene)),
                "its animations are left out: the transforms in the nodes count");
    expect_note(load(document(good, node(instance), "<scene/>")), "has no <scene>: its only visual scene is read");
    expect_note(load(document(geometry(R"(<asset><unit meter="0.01"/></asset>)" + mesh(triangles)), node(instance))),
                "an <asset> in <geometry> 'g' states another unit than the file; it is not applied");
    EXPECT_EQ(load(document(good, node(instance))).report.notes, std::vector<std::string>());
}

TEST_F(Collada, AMeshWithoutPrimitivesIsPoints) {
    const LoadedShape loaded = load(document(geometry(mesh("")), node("<translate>1 0 0</translate>" + instance)));
    const auto& points = std::get<PointSet>(loaded.shape).points;
    ASSERT_EQ(points.rows(), 4);
    EXPECT_EQ(points.row(2), Eigen::RowVector3d(1, 2, 0));
    EXPECT_EQ(loaded.report.notes[0], "<geometry> 'g' has no primitives: its vertices count as points");
    expect_note(load(document(geometry(mesh("<triangles count=\"0\"/>"), "h") + geometry(mesh(triangles)),
                              node(R"(<instance_geometry url="#h"/>)" + instance))),
                "<geometry> 'h' has no corners, and adds nothing");
}

TEST_F(Collada, OtherGeometriesAreRefusedByName) {
    for (const std::string kind : {"convex_mesh", "spline", "brep"})
        refused(document(geometry("<" + kind + "/>"), node(instance)),
                {"<" + kind + "> is not supported, only <mesh>: convert"});
    const auto controller = [&](const std::string& kind) {
        return document(geometry(mesh(triangles)), node(R"(<instance_controller url="#c"/>)"),
                        R"(<library_controllers><controller id="c"><)" + kind + R"( source="#g"/></controller>)" +
                            "</library_controllers>" + scene);
    };
    refused(controller("skin"), {"<controller> 'c' is a skin, which deforms a mesh", "export the mesh alone"});
    refused(controller("morph"), {"<controller> 'c' is a morph, which deforms a mesh"});
}

TEST_F(Collada, NamesThatLeadNowhereAreRefused) {
    const std::string good = geometry(mesh(triangles));
    refused(document(good, node(R"(<instance_geometry url="b.dae#g"/>)")), {"leads out of the file"});
    refused(document(good, node(R"(<instance_node url="http://b/#g"/>)")), {"leads out of the file"});
    refused(document(good, node(R"(<instance_geometry url="#h"/>)")), {"url=\"#h\" names no <geometry>"});
    refused(document(good + good, node(instance)), {"two <geometry> elements have the id 'g'"});
    refused(document(good, node(instance), R"(<scene><instance_visual_scene url="#t"/></scene>)"),
            {"names no <visual_scene>"});
    refused(document(good, node(instance), R"(<library_visual_scenes><visual_scene id="t"/></library_visual_scenes>)"),
            {"which of the 2 visual scenes counts"});
    refused(document(good, ""), {"the scene instantiates no mesh"});
    refused(R"(<COLLADA version="1.3.1"/>)", {"is Collada 1.3.1, and only 1.4 and 1.5"});
    refused("<x3d/>", {"its root element is <x3d>, not <COLLADA>"});
    refused("<COLLADA", {"is not XML, as a Collada file is"});
}

}  // namespace
}  // namespace hausbench
