// VRML 2.0: positions under Transform nodes, faces, and every kind of damaged file.
#include "datasets/load.h"
#include "tests/support/reading.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace hausbench {
namespace {

const std::string head = "#VRML V2.0 utf8\n";
const std::string points = "coord Coordinate { point [ 0 0 0, 1 0 0, 0 2 0, 0 0 3 ] }";

std::string shape(const std::string& fields) { return "Shape { geometry IndexedFaceSet { " + fields + " } }\n"; }
const std::string triangle = shape(points + " coordIndex [ 0 1 2 -1 ]");

std::string transform(const std::string& fields, const std::string& children) {
    return "Transform { " + fields + " children [ " + children + " ] }\n";
}

std::string repeated(const std::string& text, int times) {
    std::string all;
    for (int i = 0; i < times; ++i) all += text;
    return all;
}

class Vrml : public Reading {
protected:
    Vrml() : Reading("a.wrl") {}

    std::vector<Vec3> corners(const std::string& scene) const { return Reading::corners(head + scene); }
    // Expects that a Transform with these fields moves (0, 0, 0), (1, 0, 0) and (0, 2, 0) to `where`.
    void expect_at(const std::string& fields, const std::vector<Vec3>& where, double off = 0) const {
        expect_near(corners(transform(fields, triangle)), where, off, fields);
    }
};

TEST_F(Vrml, VerticesAreReadToTheLastBit) {
    const auto points = corners(
        "# a comment { [ \"\nShape{appearance Appearance{material DEF M-1 Material{diffuseColor .1 .2 .3}}\rgeometry "
        "IndexedFaceSet{"
        "solid FALSE,coord Coordinate{point[0.1,1e-17,+.5 # x\n0.30000000000000004 -2.7182818284590451 "
        "1.7976931348623157e300,3 4 5.]}"
        "coordIndex[0,1 2]creaseAngle .5}}");
    ASSERT_EQ(points.size(), 3u);
    EXPECT_EQ(points[0], Vec3(0.1, 1e-17, 0.5));
    EXPECT_EQ(points[1], Vec3(0.1 + 0.2, -2.718281828459045, 1.7976931348623157e300));
    EXPECT_EQ(points[2], Vec3(3, 4, 5));
}

TEST_F(Vrml, TheReportSaysWhatWasThere) {
    const LoadedShape loaded =
        load("a.vrml", head + triangle + shape(points + " coordIndex [ 0 1 2 3 -1 0 1 -1 1 2 3 -1 ]"));
    EXPECT_EQ(loaded.report.format, "vrml");
    EXPECT_EQ(loaded.report.precision, "float64");
    EXPECT_FALSE(loaded.report.float32);
    EXPECT_EQ(loaded.report.objects, 2);
    EXPECT_EQ(loaded.report.polygons, 1);
    EXPECT_FALSE(loaded.report.unreferenced);
    const auto& mesh = std::get<TriangleMesh>(loaded.shape);
    EXPECT_EQ(mesh.triangles.rows(), 5);
    EXPECT_EQ(loaded.report.segments, 1);  // the face with two corners
    EXPECT_EQ(mesh.vertices.rows(), 4);    // both shapes have the same vertices
    EXPECT_EQ(loaded.report.stated.unit, "m");
    EXPECT_EQ(loaded.report.stated.micrometres, 1e6);
    EXPECT_EQ(loaded.report.stated.up, 'Y');
    EXPECT_EQ(loaded.report.notes.size(), 1u);
    EXPECT_TRUE(has_note(loaded, "not flat"));
}

TEST_F(Vrml, LinesAndPointsAreRead) {
    const std::string line = "Shape { geometry IndexedLineSet { " + points + " coordIndex [ 0 1 2 -1 3 0 -1 2 ] } }";
    EXPECT_EQ(corners(transform("translation 0 0 1", line)), (std::vector<Vec3>{{0, 0, 1},
                                                                                {1, 0, 1},
                                                                                {1, 0, 1},
                                                                                {1, 0, 1},
                                                                                {0, 2, 1},
                                                                                {0, 2, 1},
                                                                                {0, 0, 4},
                                                                                {0, 0, 1},
                                                                                {0, 0, 1},
                                                                                {0, 2, 1},
                                                                                {0, 2, 1},
                                                                                {0, 2, 1}}));
    EXPECT_EQ(load(head + line).report.segments, 3);
    EXPECT_EQ(load(head + line).report.single_points, 1);
    const std::string cloud = "Shape { geometry PointSet { coord Coordinate { point [ 1 2 3, 1 2 3, 4 5 6 ] } } }";
    const LoadedShape alone = load(head + transform("scale 2 2 2", cloud));
    ASSERT_EQ(kind_of(alone.shape), ShapeKind::points);
    EXPECT_EQ(points_of(alone.shape), (Points(3, 3) << 2, 4, 6, 2, 4, 6, 8, 10, 12).finished());
    EXPECT_EQ(load(head + triangle + cloud).report.single_points, 3);
    EXPECT_EQ(corners(triangle + cloud).size(), 12u);
    refused(head + "Shape { geometry IndexedLineSet { " + points + "\ncoordIndex [ 0 4 ] } }", {"line 3", "'4'"});
    refused(head + "Shape { geometry PointSet { coord Coordinate { point [ 1 2 ] } } }", {"'point' has 2 numbers"});
    refused(head + "Shape { geometry PointSet { } }", {"holds no IndexedFaceSet"});
    const std::string many =
        "Shape { geometry PointSet { coord Coordinate { point [ " + repeated("0 0 0,", 3000) + "] } } }";
    refused(head + "DEF T " + many + repeated("USE T ", 3000), {"USE repeats"});
}

TEST_F(Vrml, PolygonsAreCutByTheirShape) {
    // A concave face: a fan of triangles from its first corner would cover the notch at the second.
    const auto notched =
        corners(shape("coord Coordinate { point [ 0 3 0, 0.5 0 0, 0 -3 0, 4 0 0 ] } coordIndex [ 0 1 2 3 -1 ]"));
    ASSERT_EQ(notched.size(), 6u);
    double area = 0;
    for (std::size_t i = 0; i < 6; i += 3)
        area += (notched[i + 1] - notched[i]).cross(notched[i + 2] - notched[i]).norm() / 2;
    EXPECT_DOUBLE_EQ(area, 12 - 1.5);
}

TEST_F(Vrml, TransformsPutVerticesInTheOrderOfTheStandard) {
    expect_at("", {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});
    expect_at("translation 0.1 -2 3", {{0.1, -2, 3}, {1.1, -2, 3}, {0.1, 0, 3}});
    expect_at("scale 2 3 4", {{0, 0, 0}, {2, 0, 0}, {0, 6, 0}});
    expect_at("rotation 0 0 1 1.5707963267948966", {{0, 0, 0}, {0, 1, 0}, {-2, 0, 0}}, 2e-16);
    expect_at("rotation 0 0 5 1.5707963267948966", {{0, 0, 0}, {0, 1, 0}, {-2, 0, 0}}, 2e-16);  // any axis length
    expect_at("rotation 0 0 2e-162 1.5707963267948966", {{0, 0, 0}, {0, 1, 0}, {-2, 0, 0}}, 2e-16);
    expect_at("rotation 0 0 1e-300 1.5707963267948966", {{0, 0, 0}, {0, 1, 0}, {-2, 0, 0}}, 2e-16);
    expect_at("rotation 1 0 0 1.5707963267948966", {{0, 0, 0}, {1, 0, 0}, {0, 0, 2}}, 2e-16);
    expect_at("rotation 0 1 0 1.5707963267948966", {{0, 0, 0}, {0, 0, -1}, {0, 2, 0}}, 2e-16);
    expect_at("rotation 1 1 1 2.0943951023931953", {{0, 0, 0}, {0, 1, 0}, {0, 0, 2}}, 1e-15);  // turns x to y, y to z
    expect_at("rotation 0 0 0 0", {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});
    expect_at("scale 2 1 1 rotation 0 0 1 1.5707963267948966", {{0, 0, 0}, {0, 2, 0}, {-2, 0, 0}},
              4e-16);  // the scale comes first
    expect_at("rotation 0 0 1 1.5707963267948966 translation 1 0 0", {{1, 0, 0}, {1, 1, 0}, {-1, 0, 0}}, 2e-16);
    expect_at("center 1 0 0 rotation 0 0 1 1.5707963267948966", {{1, -1, 0}, {1, 0, 0}, {-1, -1, 0}}, 4e-16);
    expect_at("center 1 0 0 scale 3 1 1 translation 0 0 7", {{-2, 0, 7}, {1, 0, 7}, {-2, 2, 7}});
    // Scaled by 3 along the diagonal of x and y: (1, 0) is half along it and half across.
    expect_at("scale 3 1 1 scaleOrientation 0 0 1 0.78539816339744831", {{0, 0, 0}, {2, 1, 0}, {2, 4, 0}}, 2e-15);
    // scaleOrientation is undone after the scale, so it does not affect the rotation.
    expect_at("scale 3 1 1 scaleOrientation 0 0 1 0.78539816339744831 rotation 0 0 1 1.5707963267948966",
              {{0, 0, 0}, {-1, 2, 0}, {-4, 2, 0}}, 2e-15);
}

TEST_F(Vrml, AnglesOfAnySizeTurnAsTheCosineSays) {
    for (const double angle :
         {1e-9, 0.3, 0.785, 0.786, 1.0, 2.0, 2.4, 3.0, 3.2, 4.712389, 5.0, 6.2, 7.0, 100.0, -0.3, -2.0, -4.0, -6.2})
        expect_at(fmt::format("rotation 0 0 1 {}", angle),
                  {{0, 0, 0}, {std::cos(angle), std::sin(angle), 0}, {-2 * std::sin(angle), 2 * std::cos(angle), 0}},
                  angle == 100 ? 1e-14 : 2e-15);
}

TEST_F(Vrml, TransformsActFromTheInnerToTheOuter) {
    const auto points = corners(
        transform("translation 10 0 0",
                  transform("scale 2 2 2", "Group { children " + transform("translation 0 0 1", triangle) + "}")));
    EXPECT_EQ(points, (std::vector<Vec3>{{10, 0, 2}, {12, 0, 2}, {10, 4, 2}}));
}

TEST_F(Vrml, UseRepeatsWhatDefNamed) {
    const auto points = corners("DEF T " + triangle + transform("translation 5 0 0", "USE T") +
                                transform("translation 0 0 7", "USE T USE T"));
    ASSERT_EQ(points.size(), 12u);
    EXPECT_EQ(points[4], Vec3(6, 0, 0));
    EXPECT_EQ(points[6], Vec3(0, 0, 7));
    // Vertices may come from a node that is not read itself. If nodes share a name, the last one counts.
    const auto shared = corners(
        "Shape { geometry IndexedLineSet { coord DEF C Coordinate { point [ 9 9 9 ] } } }"
        "Switch { choice Shape { geometry PointSet { coord DEF C Coordinate { point [ 1 2 3 4 5 6 7 8 10 ] } } } }" +
        shape("coord USE C coordIndex [ 2 1 0 ]"));
    EXPECT_EQ(shared, (std::vector<Vec3>{{7, 8, 10}, {4, 5, 6}, {1, 2, 3}}));
}

TEST_F(Vrml, WhatIsSeenOfASwitchAndALodIsRead) {
    const auto chosen = [&](const std::string& which) {
        return corners(triangle + "Switch { " + which + " choice [ Group {} " +
                       transform("translation 1 1 1", triangle) + " ] }")
                   .size() /
               3;
    };
    EXPECT_EQ(chosen("whichChoice 0"), 1u);
    EXPECT_EQ(chosen("whichChoice 1"), 2u);
    EXPECT_EQ(chosen("whichChoice 2"), 1u);
    EXPECT_EQ(chosen("whichChoice -1"), 1u);
    EXPECT_EQ(chosen(""), 1u);
    const std::string lod = "LOD { level [ " + triangle + triangle + " ] range [ 7 ] }";
    EXPECT_EQ(corners(lod).size(), 3u);
    EXPECT_EQ(load(head + lod + lod).report.notes,
              (std::vector<std::string>{"only the first level of each LOD is read, which is seen from near"}));
    EXPECT_TRUE(load(head + "LOD { level " + triangle + " }").report.notes.empty());
    for (const char* group : {"Anchor", "Billboard", "Collision"})
        EXPECT_EQ(corners(fmt::format("{} {{ children [ {} ] }}", group, triangle)).size(), 3u) << group;
}

TEST_F(Vrml, WhatIsNotShownOrMovesIsTold) {
    using Notes = std::vector<std::string>;
    const auto notes = [&](const std::string& scene) { return load(head + triangle + scene).report.notes; };
    const std::string both = "choice [ " + triangle + triangle + " ] }";
    EXPECT_EQ(notes("Switch { whichChoice 1 " + both),
              Notes{"1 node is left out, because no whichChoice of a Switch shows it"});
    for (const char* none : {"", "whichChoice -1 ", "whichChoice 2 "})
        EXPECT_EQ(notes("Switch { " + std::string(none) + both + "Switch { choice [] }"),
                  Notes{"2 nodes are left out, because no whichChoice of a Switch shows them"});
    EXPECT_TRUE(notes("Switch { whichChoice 0 choice " + triangle + " }").empty());
    refused(head + "Switch { whichChoice 0x1 " + both, {"line 2", "'0x1' is not an integer"});
    EXPECT_EQ(notes("Billboard { children " + triangle + " }"),
              Notes{"a Billboard turns to the viewer: its shapes are read as they are stored"});
    EXPECT_EQ(
        notes("DEF S TimeSensor {} DEF P PositionInterpolator {} ROUTE S.a TO P.b"),
        Notes{"left out: PositionInterpolator, ROUTE, TimeSensor, so nothing moves from where the file places it"});
    EXPECT_EQ(notes("Group { children Script { url \"a\" } }"),
              Notes{"left out: Script, so nothing moves from where the file places it"});
}

TEST_F(Vrml, AFieldThatANodeHasTwiceIsRefused) {
    refused(head + transform("translation 1 0 0 translation 0 0 0", triangle), {"line 2", "a second 'translation'"});
    refused(head + "Group { children [] children " + triangle + " }", {"a second 'children' of one Group"});
    refused(head + shape(points + " coordIndex [ 0 1 2 ] coordIndex [ 0 1 3 ]"), {"a second 'coordIndex'"});
    refused(head + shape("coord Coordinate { point [] point [ 0 0 0 ] } coordIndex [ 0 1 2 ]"), {"a second 'point'"});
}

TEST_F(Vrml, FacesThatAreSeenFromBehindAreTurned) {
    const std::vector<Vec3> front = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}}, back = {{0, 2, 0}, {1, 0, 0}, {0, 0, 0}};
    EXPECT_EQ(corners(shape(points + " ccw TRUE coordIndex [ 0 1 2 ]")), front);
    EXPECT_EQ(corners(shape(points + " ccw FALSE coordIndex [ 0 1 2 ]")), back);
    EXPECT_EQ(corners(transform("scale 1 1 -1", triangle)), back);
    EXPECT_EQ(corners(transform("scale 1 1 -1", shape(points + " ccw FALSE coordIndex [ 0 1 2 ]"))), front);
}

TEST_F(Vrml, AllElseIsSkipped) {
    const std::string script =
        "DEF S Script { url \"javascript: function f() { } \\\" [\" field SFNode n USE nobody field MFString s [ \"}\" "
        "] eventIn SFTime t }\n";
    EXPECT_EQ(
        corners("WorldInfo { title \"a } # b\" info [ \"[\", \"{\" ] }\nNavigationInfo { type [ \"EXAMINE\", \"ANY\" ] "
                "headlight FALSE }\n" +
                script +
                "ROUTE S.a TO T.b\nDEF P PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0 1 1 1 ] } Shape { "
                "geometry NULL }\n" +
                "Group { children [ PointLight { color 1 1 1 } " + triangle + " ROUTE S.a TO T.b ] ROUTE S.a TO T.b }")
            .size(),
        3u);
}

TEST_F(Vrml, GzippedFilesAreRead) {
    for (const char* name : {"a.wrl.gz", "a.wrz"}) {
        const std::filesystem::path file = folder_.path() / name;
        const gzFile out = gzopen(file.c_str(), "wb");
        const std::string text = "\xef\xbb\xbf" + head + triangle;
        gzwrite(out, text.data(), static_cast<unsigned>(text.size()));
        gzclose(out);
        EXPECT_EQ(std::get<TriangleMesh>(load_file(file).shape).triangles.rows(), 1) << name;
        EXPECT_TRUE(names_a_file(name));
    }
}

TEST_F(Vrml, WhatIsNotReadIsToldWithItsLine) {
    refused("#VRML V1.0 ascii\nSeparator { }\n", {"line 1", "VRML 1.0", "convert"});
    refused("#X3D V3.0 utf8\n", {"line 1", "not a VRML file"});
    refused("Shape {}", {"line 1", "#VRML V2.0"});
    for (const char* kind : {"Box", "Sphere", "Cylinder", "Cone", "Extrusion", "ElevationGrid", "Text"})
        refused(head + triangle + fmt::format("\nShape {{ geometry\n {} {{ size 1 1 1 }} }}", kind),
                {"line 5", kind, "convert"});
    refused(head + "PROTO Bolt [ field SFInt32 n 0 ] { Group {} }\n", {"line 2", "PROTO", "convert"});
    refused(head + "Group { EXTERNPROTO Bolt [ ] \"a.wrl\" }\n", {"line 2", "EXTERNPROTO"});
    refused(head + triangle + "Group {\n children Inline { url \"b.wrl\" } }", {"line 4", "Inline"});
    EXPECT_EQ(corners(triangle + "Switch { choice Shape { geometry Sphere {} } }").size(), 3u);  // an unselected choice
    refused(head, {"holds no IndexedFaceSet"});
    refused(head + shape(points), {"holds no IndexedFaceSet with a face"});
    refused(head + shape("coordIndex [ 0 1 2 ]"), {"holds no IndexedFaceSet with a face"});
    refused(head + triangle + "GeoLocation { children " + triangle + " }", {"line 3", "GeoLocation is not a node"});
    EXPECT_EQ(load(head + shape(points + " coordIndex [ 0 1 -1 2 3 -1 ]")).report.segments, 2);
}

TEST_F(Vrml, MistakesAreToldWithTheirLine) {
    refused(head +
                "\nShape { geometry IndexedFaceSet { coord Coordinate {\npoint [ 0 0 0,\n1 x 0, 0 1 0 ] } coordIndex [ "
                "0 1 2 ] } }",
            {"line 5", "'x' is not a number"});
    for (const char* bad : {"nan", "inf", "-inf", "1e999"})
        refused(
            head + shape(fmt::format("coord Coordinate {{ point [ 0 0 0 1 0 {} 0 1 0 ] }} coordIndex [ 0 1 2 ]", bad)),
            {"line 2", "not finite", "--drop-invalid"});
    refused(head + transform("scale 1e300 1 1", transform("scale 1e300 1 1", triangle)), {"not finite"});
    refused(head + transform("scale 1 nan 1", triangle), {"line 2", "'scale'"});
    refused(head + transform("rotation 0 0 1 1e999", triangle), {"line 2", "1e999"});
    refused(head + transform("rotation 0 0 0 1", triangle), {"line 2", "'rotation' has no axis"});
    refused(head + transform("translation 1 2", triangle), {"line 2", "'translation' has 2 numbers, not 3"});
    refused(head + shape("coord Coordinate { point [ 0 0 0 1 ] } coordIndex [ 0 0 0 ]"),
            {"line 2", "'point' has 4 numbers"});
    // Index 4 is out of range, although the whole file has enough vertices.
    refused(head + shape(points + " coordIndex [ 0 1\n4 -1 ]") + triangle,
            {"line 3", "'4' names none of the 4 vertices"});
    for (const char* bad : {"-2", "1.5", "x", "99999999999999999999"})
        refused(head + shape(points + fmt::format(" coordIndex [ 0 1 {} -1 ]", bad)),
                {"line 2", bad, "counted from 0"});
    refused(head + shape("coord Color { } coordIndex [ 0 1 2 ]"), {"line 2", "not a Color"});
    refused(head + "Group { children [ USE T ] }\nDEF T " + triangle, {"line 2", "'T'", "no DEF"});
    refused(head + "DEF T Group { children [ USE T ] }\n", {"line 2", "'T'"});
    refused(head + "Group { children [ Group { } }\n", {"line 2", "'}'"});
    refused(head + "Group { children [ [ ] ] }\n", {"line 2", "'['"});
    refused(head + "Group { 7 }\n", {"line 2", "'7'", "name of a field"});
    refused(head + "DEF T 7 }\n", {"line 2", "'}'", "'{'"});
    refused(head + "Shape\n", {"line 2", "'Shape' is not a node"});
    refused(head + triangle + "}\n", {"line 3", "'}'"});
    refused(head + triangle + std::string(1, '\0') + "garbage", {"zero byte"});
    refused(head + "WorldInfo {\n title \"never ends\\\" }\n", {"line 3", "does not end"});
}

TEST_F(Vrml, TruncatedFilesAreRefused) {
    const std::string whole =
        head + "Group { children [ DEF T " + triangle.substr(0, triangle.size() - 1) + " USE T ] }";
    EXPECT_EQ(std::get<TriangleMesh>(load(whole).shape).triangles.rows(), 2);
    for (std::size_t size = head.size() + 1; size < whole.size(); ++size) refused(whole.substr(0, size), {"line 2"});
}

TEST_F(Vrml, LinesAreCountedThroughTextsAndEveryKindOfEnd) {
    refused(head + "WorldInfo { title \"two\nlines\" }\r\n# comment\r# another\n\n\rGroup { 7 }", {"line 8"});
}

TEST_F(Vrml, DeepNestingIsRefusedAndNoCrash) {
    const auto nested = [](int depth) {
        return repeated("Group { children [ ", depth) + triangle + repeated("] } ", depth);
    };
    EXPECT_EQ(corners(nested(200)).size(), 3u);
    refused(head + nested(300), {"line 2", "nested deeper than 256"});
    refused(head + repeated("Group { children [ ", 1'000'000), {"nested deeper than 256"});
    std::string chain = "DEF T0 " + triangle;  // each USE nests one node deeper
    for (int i = 1; i < 100'000; ++i) chain += fmt::format("DEF T{} Group {{ children USE T{} }}\n", i, i - 1);
    refused(head + chain, {"nested deeper than 256", "USE"});
}

TEST_F(Vrml, RepetitionThatNoMemoryHoldsIsRefused) {
    std::string doubled = "DEF T0 " + triangle;
    for (int i = 1; i < 60; ++i)
        doubled += fmt::format("DEF T{0} Group {{ children [ USE T{1} USE T{1} ] }}\n", i, i - 1);
    refused(head + doubled, {"USE repeats"});
    std::string empty = "DEF T0 Group {}";  // without any vertex
    for (int i = 1; i < 60; ++i)
        empty += fmt::format("DEF T{0} Group {{ children [ USE T{1} USE T{1} ] }}\n", i, i - 1);
    refused(head + empty, {"USE repeats"});
    const std::string many =
        shape("coord Coordinate { point [ " + repeated("0 0 0,", 3000) + " ] } coordIndex [ 0 1 2 ]");
    refused(head + "DEF T " + many + repeated("USE T ", 3000), {"USE repeats"});
}

// Files of at most 2 KB, whose nested USE nodes repeat a triangle 2^12 and 2^17 times.
TEST_F(Vrml, ASmallFileMayRepeatSome) {
    const auto doubled = [](int times) {
        std::string text = "DEF T0 " + triangle;
        for (int i = 1; i <= times; ++i)
            text += fmt::format("DEF T{0} Group {{ children [ USE T{1} USE T{1} ] }}\n", i, i - 1);
        return text;
    };
    EXPECT_EQ(corners(doubled(12)).size(), 3 * 8191u);  // 2^13 - 1: each group also counts where it is defined
    refused(head + doubled(17), {"USE repeats", "200 nodes, points and corners for each byte"});
}

}  // namespace
}  // namespace hausbench
