// DXF: the corners of every kind of entity, blocks and object coordinates, units, and what is refused or left out.
#include "algorithms/error.h"
#include "datasets/load.h"
#include "tests/support/reading.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace hausbench {
namespace {

constexpr double u = std::numeric_limits<double>::epsilon() / 2;

// Puts each of the words of a text on a line of its own.
std::string lines(const std::string& words) {
    std::string text;
    for (const char c : words) text += c == ' ' ? '\n' : c;
    return text + "\n";
}
// An entity with points in the groups 10, 11, ..., and the same z, 0.
std::string entity(const std::string& type, const std::vector<std::pair<int, int>>& points,
                   const std::string& more = "") {
    std::string text = lines("0 " + type) + (more.empty() ? "" : lines(more));
    for (std::size_t i = 0; i < points.size(); ++i)
        text += lines(fmt::format("{} {} {} {} {} 0", 10 + i, points[i].first, 20 + i, points[i].second, 30 + i));
    return text;
}
std::string vertex(int x, int y, int z, const std::string& more = "") {
    return lines(fmt::format("0 VERTEX 10 {} 20 {} 30 {}", x, y, z)) + (more.empty() ? "" : lines(more));
}
const std::string seqend = lines("0 SEQEND");
std::string section(const std::string& name, const std::string& text) {
    return lines("0 SECTION 2 " + name) + text + lines("0 ENDSEC");
}
std::string block(const std::string& name, const std::string& text, const std::string& base = "10 0 20 0 30 0") {
    return lines("0 BLOCK 2 " + name + " " + base) + text + lines("0 ENDBLK");
}
std::string drawing(const std::string& entities, const std::string& blocks = "", const std::string& header = "") {
    return section("HEADER", header) + section("BLOCKS", blocks) + section("ENTITIES", entities) + lines("0 EOF");
}
const std::string triangle = entity("3DFACE", {{0, 0}, {1, 0}, {0, 2}, {0, 2}});

class Dxf : public Reading {
protected:
    Dxf() : Reading("a.dxf") {}

    void expect_at(const std::string& text, const std::vector<Vec3>& where, double off = 0) const {
        expect_near(corners(text), where, off, text);
    }
};

TEST_F(Dxf, FacesAreReadToTheLastBit) {
    const std::string face = lines(
        "0 3DFACE 8 0 10 0.1 20 1e-17 30 .5 11 0.30000000000000004 21 -2.7182818284590451 31 1e300 12 3 22 4 32 5. "
        "13 3 23 4 33 5");
    expect_at(drawing(face), {{0.1, 1e-17, 0.5}, {0.1 + 0.2, -2.718281828459045, 1e300}, {3, 4, 5}});
    std::string windows;
    for (const char c : "999\n a comment\n" + drawing(face)) windows += c == '\n' ? "\r\n" : std::string(1, c);
    EXPECT_EQ(corners(windows), corners(drawing(face)));
}

TEST_F(Dxf, OldElevationsAreRefused) {
    for (const char* entity : {"0 LINE 38 5 10 0 20 0 30 0 11 1 21 0 31 0", "0 POINT 38 5 10 0 20 0 30 0"})
        refused(drawing(lines(entity)), {"elevation", "release 12"});
    EXPECT_EQ(load(drawing(lines("0 POINT 38 0 10 0 20 0 30 0"))).report.notes.size(), 0u);
}

TEST_F(Dxf, QuadrilateralsAndSolids) {
    EXPECT_EQ(load(drawing(entity("3DFACE", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}))).report.polygons, 1);
    expect_at(drawing(entity("3DFACE", {{0, 0}, {1, 0}, {0, 2}})), {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});
    // The corners of a SOLID are crossed: this is the square from (0, 0) to (1, 1).
    for (const std::string type : {"SOLID", "TRACE"}) {
        expect_at(drawing(entity(type, {{0, 0}, {1, 0}, {0, 1}, {1, 1}})),
                  {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}});
        expect_at(drawing(entity(type, {{0, 0}, {1, 0}, {0, 2}, {0, 2}}, "210 0 220 0 230 -1")),
                  {{0, 0, 0}, {-1, 0, 0}, {0, 2, 0}});
        refused(drawing(entity(type, {{0, 0}, {1, 0}, {0, 1}}, "39 2")),
                {"a.dxf: line 20: " + type + " with a thickness is not supported"});
    }
    refused(drawing(entity("3DFACE", {{0, 0}, {1, 0}})), {"a.dxf: line 18: 3DFACE has no groups 12 and 22"});
    refused(drawing(entity("3DFACE", {{0, 0}, {1, 0}, {0, 2}}, "10 5")), {"3DFACE has two groups 10"});
    refused(drawing(lines("0 3DFACE 10 0 20 x")), {"line 22: 'x' is not a number"});
}

TEST_F(Dxf, LinesAndPoints) {
    expect_at(drawing(entity("LINE", {{1, 2}, {3, 4}})), {{1, 2, 0}, {3, 4, 0}, {3, 4, 0}});
    const LoadedShape points = load(drawing(entity("POINT", {{1, 2}}) + entity("POINT", {{3, 4}})));
    EXPECT_EQ(std::get<PointSet>(points.shape).points.row(1), Eigen::RowVector3d(3, 4, 0));
    refused(drawing(entity("LINE", {{1, 2}, {3, 4}}, "39 1")), {"LINE with a thickness"});
}

TEST_F(Dxf, Polylines) {
    const std::string three = vertex(0, 0, 0) + vertex(1, 0, 5) + vertex(0, 2, 0) + seqend;
    expect_at(drawing(lines("0 POLYLINE 70 8") + three),
              {{0, 0, 0}, {1, 0, 5}, {1, 0, 5}, {1, 0, 5}, {0, 2, 0}, {0, 2, 0}});
    EXPECT_EQ(load(drawing(lines("0 POLYLINE 70 9") + three)).report.segments, 3);
    refused(drawing(lines("0 POLYLINE") + three), {"line 28: VERTEX of a 2D polyline of elevation 0 has z = 5"});
    const std::string flat = vertex(0, 0, 0) + vertex(1, 0, 0) + seqend;
    expect_at(drawing(lines("0 POLYLINE 30 7 210 0 220 0 230 -1") + flat), {{0, 0, -7}, {-1, 0, -7}, {-1, 0, -7}});
    refused(drawing(lines("0 POLYLINE 70 4") + flat), {"POLYLINE that is fitted to a curve"});
    refused(drawing(lines("0 POLYLINE 40 0.5") + flat), {"POLYLINE with a width is not supported: set the width to 0"});
    refused(drawing(lines("0 POLYLINE") + vertex(0, 0, 0, "42 1") + flat), {"VERTEX with a bulge is not supported"});
    refused(drawing(lines("0 POLYLINE") + vertex(0, 0, 0)), {"POLYLINE does not end with SEQEND"});
}

TEST_F(Dxf, LightPolylines) {
    expect_at(drawing(lines("0 LWPOLYLINE 90 2 70 0 38 3 10 0 20 0 10 1 20 2")), {{0, 0, 3}, {1, 2, 3}, {1, 2, 3}});
    EXPECT_EQ(load(drawing(lines("0 LWPOLYLINE 90 3 70 1 10 0 20 0 10 1 20 2 10 5 20 5"))).report.segments, 3);
    refused(drawing(lines("0 LWPOLYLINE 90 2 10 0 20 0 42 1 10 1 20 2")), {"line 26: LWPOLYLINE with a bulge"});
    refused(drawing(lines("0 LWPOLYLINE 90 2 43 1 10 0 20 0 10 1 20 2")), {"LWPOLYLINE with a width"});
    refused(drawing(lines("0 LWPOLYLINE 90 2 39 1 10 0 20 0 10 1 20 2")), {"LWPOLYLINE with a thickness"});
    refused(drawing(lines("0 LWPOLYLINE 90 3 10 0 20 0 10 1 20 2")), {"announces 3 vertices and has 2"});
    refused(drawing(lines("0 LWPOLYLINE 90 2 10 0 10 1 20 2")), {"x and y do not alternate"});
    refused(drawing(lines("0 LWPOLYLINE 90 1 10 0")), {"announces 1 vertices"});
}

TEST_F(Dxf, PolyfaceMeshes) {
    const std::string corners4 =
        vertex(0, 0, 0, "70 192") + vertex(1, 0, 0, "70 192") + vertex(0, 2, 0, "70 192") + vertex(0, 0, 3, "70 192");
    const auto face = [](const std::string& more) { return vertex(0, 0, 0, "70 128 " + more); };
    expect_at(drawing(lines("0 POLYLINE 70 64") + corners4 + face("71 1 72 -2 73 3") + face("71 2 72 4") + seqend),
              {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {1, 0, 0}, {0, 0, 3}, {0, 0, 3}});
    expect_at(drawing(lines("0 POLYLINE 70 64") + face("71 1 72 2 73 3 74 0") + corners4 + seqend),
              {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});
    refused(drawing(lines("0 POLYLINE 70 64") + corners4 + face("71 1 72 2 73 5") + seqend),
            {"VERTEX of a polyface mesh names vertex 5, but there are 4"});
    refused(drawing(lines("0 POLYLINE 70 64") + corners4 + face("71 -9223372036854775808") + seqend),
            {"names vertex -9223372036854775808"});
    refused(drawing(lines("0 POLYLINE 70 64") + corners4 + face("71 0") + seqend), {"without corners"});
}

TEST_F(Dxf, PolygonMeshes) {
    std::string grid;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 2; ++k) grid += vertex(i, k, 0, "70 64");
    const auto quads = [&](int flags) {
        return load(drawing(lines(fmt::format("0 POLYLINE 70 {} 71 3 72 2", flags)) + grid + seqend)).report.polygons;
    };
    EXPECT_EQ(quads(16), 2);
    EXPECT_EQ(quads(16 + 1), 3);
    EXPECT_EQ(quads(16 + 32), 4);
    EXPECT_EQ(quads(16 + 1 + 32), 6);
    expect_at(drawing(lines("0 POLYLINE 70 16 71 2 72 2") + vertex(0, 0, 0) + vertex(0, 1, 0) + vertex(1, 0, 0) +
                      vertex(1, 1, 0) + seqend),
              {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {1, 0, 0}});
    refused(drawing(lines("0 POLYLINE 70 16 71 2 72 2") + grid + seqend),
            {"a polygon mesh of 2 x 2 vertices, and has 6"});
    refused(drawing(lines("0 POLYLINE 70 20 71 3 72 2 75 6") + grid + seqend), {"smooth surface"});
}

TEST_F(Dxf, Meshes) {
    const auto mesh = [](const std::string& level, const std::string& vertices, const std::string& faces) {
        return drawing(lines("0 MESH 92 1 310 00 100 AcDbSubDMesh 71 2 72 0 91 " + level + " " + vertices + " " +
                             faces + " 94 1 90 0 90 1 95 0 90 0"));
    };
    const std::string four = "92 4 10 0 20 0 30 0 10 1 20 0 30 0 10 0 20 2 30 0 10 0 20 0 30 3";
    expect_at(mesh("0", four, "93 8 90 3 90 0 90 1 90 2 90 3 90 1 90 2 90 3"),
              {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}});
    refused(mesh("1", four, "93 0"), {"MESH of subdivision level 1 is not supported"});
    refused(mesh("0", four, "93 4 90 3 90 0 90 1 90 4"), {"names vertex 4 (from 0), but there are 4"});
    refused(mesh("0", four, "93 4 90 4 90 0 90 1 90 2"), {"a face of 4 corners, and 3 numbers are left"});
    refused(mesh("0", "92 9000000000", "93 0"), {"announces 9000000000 elements in group 92"});
    refused(mesh("0", "92 2 10 0 20 0 30 0", "93 0"), {"has no group 10 where one is expected"});
}

TEST_F(Dxf, BlocksAreRepeated) {
    const auto insert = [&](const std::string& more, const std::string& base = "10 0 20 0 30 0") {
        return drawing(lines("0 INSERT 2 b " + more), block("B", triangle, base));
    };
    expect_at(insert("10 0 20 0 30 0"), {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});
    expect_at(insert("10 5 20 6 30 7"), {{5, 6, 7}, {6, 6, 7}, {5, 8, 7}});
    expect_at(insert("10 5 20 0 30 0", "10 1 20 2 30 3"), {{4, -2, -3}, {5, -2, -3}, {4, 0, -3}});
    expect_at(insert("10 0 20 0 41 2 42 3 43 4 30 0"), {{0, 0, 0}, {2, 0, 0}, {0, 6, 0}});
    expect_at(insert("10 1 20 0 30 0 41 2 50 90", "10 1 20 0 30 0"), {{1, -2, 0}, {1, 0, 0}, {-1, -2, 0}});
    const double half = std::sqrt(0.5);
    expect_at(insert("10 0 20 0 50 45"), {{0, 0, 0}, {half, half, 0}, {-2 * half, 2 * half, 0}}, 32 * u);
    expect_at(insert("10 5 20 6 30 7 210 0 220 0 230 -1"), {{-5, 6, -7}, {-6, 6, -7}, {-5, 8, -7}});
    // The object axes of the direction x: x is y of the world, and y is z.
    expect_at(insert("10 0 20 0 30 9 210 2 220 0 230 0"), {{9, 0, 0}, {9, 1, 0}, {9, 0, 2}});
    // Two columns and rows, turned by 90 degrees; the distances are not scaled.
    const auto array = corners(insert("10 0 20 0 41 2 50 90 70 2 71 2 44 10 45 100"));
    ASSERT_EQ(array.size(), 12u);
    EXPECT_EQ(array[0], Vec3(0, 0, 0));
    EXPECT_EQ(array[3], Vec3(0, 10, 0));
    EXPECT_EQ(array[4], Vec3(0, 12, 0));
    EXPECT_EQ(array[6], Vec3(-100, 0, 0));
    EXPECT_EQ(array[9], Vec3(-100, 10, 0));
}

TEST_F(Dxf, BlocksAreNested) {
    const std::string blocks = block("A", triangle) + block("B", lines("0 INSERT 2 A 10 1 20 0 30 0 66 1") +
                                                                     lines("0 ATTRIB 10 0 20 0") + seqend + triangle);
    expect_at(drawing(lines("0 INSERT 2 B 10 0 20 0 30 0 41 2 42 2 43 2"), blocks),
              {{0, 0, 0}, {2, 0, 0}, {0, 4, 0}, {2, 0, 0}, {4, 0, 0}, {2, 4, 0}});
    refused(drawing(lines("0 INSERT 2 A 10 0 20 0"), block("A", lines("0 INSERT 2 a 10 0 20 0"))),
            {"line 22: the block 'a' contains an INSERT of itself"});
    refused(drawing(lines("0 INSERT 2 C 10 0 20 0"), blocks), {"INSERT names the block 'c', which is not in the file"});
    refused(drawing(lines("0 INSERT 2 A 10 0 20 0"), blocks + blocks), {"a second block has the name 'a'"});
    refused(drawing(lines("0 INSERT 2 A 10 0 20 0"), block("A", "", "70 4 1 other.dwg")),
            {"the block 'a' is a reference to another file"});
    refused(drawing(lines("0 INSERT 2 A 10 0 20 0 210 0.015625 220 0 230 0.99987792223"), blocks),
            {"axes of its coordinates jump"});
}

TEST_F(Dxf, AGroupThatAnEntityHasTwiceIsRefused) {
    for (const char* twice : {"41 2 41 3", "50 0 50 90", "70 1 70 2", "2 b 2 c"})
        refused(drawing(lines("0 INSERT 10 0 20 0 " + std::string(twice) + (twice[0] == '2' ? "" : " 2 b")),
                        block("b", triangle)),
                {"INSERT has two groups " + std::string(twice).substr(0, std::string(twice).find(' '))});
    refused(drawing(lines("0 LWPOLYLINE 90 2 38 1 38 2 10 0 20 0 10 1 20 2")), {"LWPOLYLINE has two groups 38"});
    refused(drawing(entity("SOLID", {{0, 0}, {1, 0}, {0, 1}}, "230 1 230 -1")), {"SOLID has two groups 230"});
}

TEST_F(Dxf, InsertsCannotFillTheMemory) {
    std::string doubled = block("B40", triangle), deep = block("B100", triangle);
    for (int i = 0; i < 40; ++i)
        doubled += block(fmt::format("B{}", i), lines(fmt::format("0 INSERT 2 B{} 10 0 20 0 70 2 44 1", i + 1)));
    for (int i = 0; i < 100; ++i)
        deep += block(fmt::format("B{}", i), lines(fmt::format("0 INSERT 2 B{} 10 0 20 0", i + 1)));
    const std::string insert = lines("0 INSERT 2 B0 10 0 20 0");
    refused(drawing(insert, doubled), {"INSERT repeats blocks so often"});
    refused(drawing(insert, deep), {"blocks are nested deeper than 64"});
    refused(drawing(lines("0 INSERT 2 B 10 0 20 0 70 2000000000 71 2000000000"), block("B", "")), {"so often"});
}

TEST_F(Dxf, UnitsAreStated) {
    const auto stated = [&](int unit) {
        const LoadedShape loaded = load(drawing(triangle, "", lines(fmt::format("9 $INSUNITS 70 {}", unit))));
        EXPECT_EQ(std::get<TriangleMesh>(loaded.shape).vertices.row(2), Eigen::RowVector3d(0, 2, 0));
        EXPECT_EQ(loaded.report.stated.up, 0);
        return loaded.report;
    };
    EXPECT_EQ(stated(0).stated.micrometres, 0);
    EXPECT_EQ(stated(1).stated.unit, "inch");
    EXPECT_EQ(stated(2).stated.unit, "ft");
    EXPECT_EQ(stated(4).stated.unit, "mm");
    EXPECT_EQ(stated(5).stated.unit, "cm");
    EXPECT_EQ(stated(6).stated.unit, "m");
    EXPECT_EQ(stated(13).stated.unit, "um");
    EXPECT_EQ(stated(14).stated.unit, "dm");
    EXPECT_EQ(stated(16).stated.micrometres, 1e8);
    EXPECT_EQ(stated(99).notes[0], "its unit $INSUNITS = 99 is unknown, and counts as not stated");
    EXPECT_EQ(load(drawing(triangle)).report.stated.unit, "");
}

TEST_F(Dxf, NotesSayWhatIsLeftOut) {
    const std::string text = lines("0 TEXT 1 word") + lines("0 DIMENSION") + lines("0 TEXT 1 word");
    EXPECT_EQ(load(drawing(triangle + text)).report.notes, std::vector<std::string>{"left out: 1 DIMENSION, 2 TEXT"});
    EXPECT_EQ(load(drawing(triangle + lines("0 CIRCLE 67 1 10 0 20 0 40 1"))).report.notes,
              std::vector<std::string>{"left out: 1 entity in the paper space"});
    EXPECT_EQ(load(drawing(triangle, block("A", triangle) + block("*D1", triangle))).report.notes,
              std::vector<std::string>{"blocks that no INSERT in the model space names are left out: 1"});
    EXPECT_TRUE(load(drawing(triangle)).report.notes.empty());
    EXPECT_EQ(load(drawing(triangle + triangle)).report.objects, 1);
}

TEST_F(Dxf, HiddenEntitiesAreReadAndCounted) {
    const std::string layers =
        section("TABLES", lines("0 TABLE 2 LAYER 0 LAYER 2 Off 70 0 62 -7 0 LAYER 2 FROZEN 70 1 62 7 "
                                "0 LAYER 2 shown 70 4 62 3 0 LAYER 2 later 70 2 62 3 0 ENDTAB"));
    const auto on = [](const std::string& layer, const std::string& more = "") {
        return entity("3DFACE", {{0, 0}, {1, 0}, {0, 2}}, "8 " + layer + more);
    };
    const auto notes = [&](const std::string& entities, const std::string& blocks = "") {
        return load(layers + drawing(entities, blocks)).report.notes;
    };
    using Notes = std::vector<std::string>;
    EXPECT_EQ(notes(on("shown") + on("later") + on("absent")), Notes());
    EXPECT_EQ(notes(on("shown") + on("off")), Notes{"1 entity on the hidden layer 'Off' is read"});
    EXPECT_EQ(notes(on("OFF") + on("Frozen") + on("off")),
              Notes{"3 entities on the hidden layers 'FROZEN', 'Off' are read"});
    EXPECT_EQ(notes(on("shown", " 60 1") + on("shown", " 60 0")), Notes{"1 invisible entity (group 60) is read"});
    EXPECT_EQ(notes(lines("0 INSERT 2 b 8 Off 10 0 20 0") + lines("0 POLYLINE 8 shown 70 8") + vertex(0, 0, 0) +
                        vertex(1, 0, 0) + seqend + lines("0 TEXT 8 Off 10 0 20 0"),
                    block("b", on("frozen", " 60 1") + on("shown"))),
              (Notes{"left out: 1 TEXT", "2 entities on the hidden layers 'FROZEN', 'Off' are read",
                     "1 invisible entity (group 60) is read"}));
    EXPECT_EQ(corners(layers + drawing(on("shown") + on("off", " 60 1"))).size(), 6u);
}

TEST_F(Dxf, OtherEntitiesAreRefusedByName) {
    for (const std::string type : {"CIRCLE", "ARC", "SPLINE", "3DSOLID", "BODY", "REGION", "SURFACE", "ELLIPSE",
                                   "HATCH", "MLINE", "HELIX", "ACAD_PROXY_ENTITY"})
        refused(drawing(triangle + lines("0 " + type + " 10 0 20 0 40 1")),
                {"a.dxf: line 44: " + type + " is not supported: convert it to 3DFACE"});
}

TEST_F(Dxf, DamagedFilesAreRefused) {
    const std::string good = drawing(triangle);
    for (std::size_t size = 1; size + 1 < good.size(); ++size)
        EXPECT_THROW(load(good.substr(0, size)), InputError) << good.substr(0, size);
    refused("AutoCAD Binary DXF\r\n\x1a", {"is binary DXF, which is not supported: save it as text"});
    refused("solid x\n", {"line 1: 'solid x' is not a group code of DXF"});
    refused("99999\nx\n", {"'99999' is not a group code"});
    refused(section("ENTITIES", triangle), {"does not end with the group EOF"});
    refused(lines("0 SECTION 2 ENTITIES") + triangle + lines("0 EOF"), {"section ENTITIES does not end with ENDSEC"});
    refused(drawing(""), {"has no face, line or point in the model space"});
}

}  // namespace
}  // namespace hausbench
