// Lines, points, strips and vertices that nothing uses in OBJ, OFF, PLY and STL, and geometry that is refused by name.
#include "datasets/load.h"
#include "tests/support/reading.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace hausbench {
namespace {

using Notes = std::vector<std::string>;

class MeshFiles : public Reading {
protected:
    MeshFiles() : Reading("a.obj") {}

    // Returns the corners of all triangles of a mesh, as "x y z, x y z, x y z; ...".
    std::string corners(const std::string& name, const std::string& bytes, const LoadOptions& options = {}) const {
        std::string text;
        std::size_t i = 0;
        for (const Vec3& p : Reading::corners(load(name, bytes, options))) {
            text += fmt::format("{}{} {} {}", i == 0 ? "" : i % 3 == 0 ? "; " : ", ", p[0], p[1], p[2]);
            ++i;
        }
        return text;
    }
};

const std::string four = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\n";

TEST_F(MeshFiles, LinesOfObjAreSegments) {
    EXPECT_EQ(corners("a.obj", four + "l 1 2/7 -1 # end\n"), "0 0 0, 1 0 0, 1 0 0; 1 0 0, 0 0 3, 0 0 3");
    const LoadedShape both = load("a.obj", four + "f 1 2 3\nl 3 4\nf 1 4\n");
    EXPECT_EQ(both.report.segments, 2);
    EXPECT_EQ(both.report.unreferenced, 0);
    EXPECT_EQ(element_count(both.shape), 3);
    EXPECT_EQ(load("a.obj", "o a\n" + four + "l 1 2\no b\nl 3 4\n").report.objects, 2);
    refused("a.obj", four + "l 1\n", {"line 5", "two vertices"});
    refused("a.obj", four + "l 1 5\n", {"line 5", "vertex 4 (from 0), but there are 4"});
    refused("a.obj", four + "l 1 x\n", {"line 5", "'x'"});
}

TEST_F(MeshFiles, PointsOfObjArePoints) {
    const LoadedShape alone = load("a.obj", four + "p 4 2\np 1\n");
    ASSERT_EQ(kind_of(alone.shape), ShapeKind::points);
    EXPECT_EQ(points_of(alone.shape), (Points(3, 3) << 0, 0, 3, 1, 0, 0, 0, 0, 0).finished());
    EXPECT_EQ(corners("a.obj", four + "f 1 2 3\np 4\n"), "0 0 0, 1 0 0, 0 2 0; 0 0 3, 0 0 3, 0 0 3");
    EXPECT_EQ(load("a.obj", four + "f 1 2 3\np 4\n").report.single_points, 1);
    refused("a.obj", four + "f 1 2 3\np\n", {"line 6", "no point"});
    refused("a.obj", four + "f\n", {"none of its faces has a corner"});
    EXPECT_EQ(element_count(load("a.obj", four + "f\nf 1 2 3\n").shape), 1);
}

TEST_F(MeshFiles, NumbersAfterZOfObjAreTold) {
    const auto notes = [&](const std::string& vertex) {
        return load("a.obj", vertex + "\nv 1 0 0\nv 0 2 0\nf 1 2 3\n").report.notes;
    };
    for (const char* vertex : {"v 4 0 0", "v 4 0 0 1", "v 4 0 0 1.0 # 2", "v 4 0 0 0.5 0.5 0.5"})
        EXPECT_EQ(notes(vertex), Notes()) << vertex;
    for (const char* vertex : {"v 4 0 0 2", "v 4 0 0 0", "v 4 0 0 1 1", "v 4 0 0 1 .5 .5 .5", "v 4 0 0 1 2 3 4 5"})
        EXPECT_EQ(notes(vertex),
                  Notes{"numbers after z are left out in 1 `v` line, the first 1: they are not a colour, "
                        "and a weight counts only in rational curves and surfaces"})
            << vertex;
    EXPECT_EQ(corners("a.obj", "v 4 0 0 2\nv 1 0 0\nv 0 2 0\nf 1 2 3\n"), "4 0 0, 1 0 0, 0 2 0");
    EXPECT_TRUE(has_note(load("a.obj", "v 4 0 0 2\nv 1 0 0 2\nv 0 2 0\nf 1 2 3\n"), "in 2 `v` lines, the first 1"));
    refused("a.obj", "v 1 2 3 x\n", {"line 1", "'x' after z is not a number"});
}

TEST_F(MeshFiles, ObjRefusesWhatItDoesNotRead) {
    for (const char* statement :
         {"cstype bezier", "curv 0 1 1 2", "curv2 1 2", "surf 0 1 0 1 1 2 3 4", "bmat u 1 1 1 1", "deg 1 1",
          "parm u 0 1", "bzp 1 2 3", "bsp 1 2 3", "cdc 1 2 3", "cdp 1 2 3", "res 1 1"})
        refused("a.obj", four + "f 1 2 3\n" + statement + "\n", {"line 6", "free-form", "polygons"});
    refused("a.obj", four + "call other.obj\nf 1 2 3\n", {"line 5", "'call'", "another file"});
    refused("a.obj", four + "csh make\nf 1 2 3\n", {"line 5", "'csh'"});
    refused("a.obj", four + "F 1 2 3\n", {"line 5", "'F'", "lower case"});
    const std::string faces = "mg 1 2\ns off\nusemtl a\nvp 1 2\nvt 0 0\nvn 0 0 1\n#comment\nf 1 2 3\n";
    EXPECT_TRUE(load("a.obj", four + faces).report.notes.empty());
    EXPECT_EQ(load("a.obj", four + "q 1\n" + faces).report.notes,
              (Notes{"a line with an unknown keyword, 'q' in line 5, was left out"}));
    EXPECT_EQ(load("a.obj", four + "q 1\nr 2\n" + faces).report.notes,
              (Notes{"2 lines with unknown keywords, the first 'q' in line 5, were left out"}));
    // A weight counts only in rational curves and surfaces.
    EXPECT_EQ(corners("a.obj", "v 2 0 0 2\nv 1 0 0 1 0 0\nv 0 1 0\nf 1 2 3\n"), "2 0 0, 1 0 0, 0 1 0");
}

TEST_F(MeshFiles, ACommentOfObjThatWouldJoinAStatementIsRefused) {
    const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    refused("a.obj", "# from C:\\models\\\n" + points + "f 1 2 3\n", {"line 1", "backslash"});
    refused("a.obj", points + "g part\\\nf 1 2 3\n", {"line 4", "backslash"});
    refused("a.obj", "v 0 0 0 # origin \\\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", {"line 1", "backslash"});
    EXPECT_EQ(element_count(load("a.obj", "# a\\\n# b\n" + points + "f 1 \\\n2 3\n").shape), 1);
}

TEST_F(MeshFiles, PolygonsWhoseSplitMattersAreTold) {
    const std::string bent = "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf 1 2 3 4\n";
    EXPECT_TRUE(has_note(load("a.obj", bent), "not flat (a corner is up to 0."));
    const std::string flat = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    EXPECT_TRUE(load("a.obj", flat).report.notes.empty());
    EXPECT_TRUE(has_note(load("a.obj", flat.substr(0, flat.find('f')) + "f 1 2 4 3\n"), "cross themselves (1)"));
    const std::string dart = "v 0 0 0\nv 2 -1 0\nv 0.5 0 0\nv 2 1 0\nf 1 2 3 4\n";  // concave
    EXPECT_TRUE(load("a.obj", dart).report.notes.empty());
}

TEST_F(MeshFiles, WordsThatShareALineOfStlAreRefused) {
    const auto facet = [](const std::string& begin, const std::string& end) {
        return begin + "outer loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n" + end;
    };
    const std::string good = facet("facet normal 0 0 1\n", "endfacet\n");
    EXPECT_EQ(element_count(load("a.stl", "\xef\xbb\xbfsolid a b\n" + good + "endsolid a b\n").shape), 1);
    refused("a.stl", "solid\n" + facet("facet normal 0 0 1\n", "endfacet facet normal 0 0 1\n") + "endsolid\n",
            {"line 8", "'facet' follows 'endfacet'"});
    refused("a.stl", "solid a facet normal 0 0 1\n" + good + "endsolid\n", {"line 1", "'facet' follows 'solid'"});
    refused("a.stl", "solid\n" + facet("facet normal 0 0 1 outer loop\n", "endfacet\n") + "endsolid\n",
            {"line 2", "'outer'"});
    refused("a.stl", "solid\n" + facet("", "") + "endsolid\n", {"line 3", "outside of a facet"});
    refused("a.stl", "solid\nendfacet\nendsolid\n", {"line 2", "did not begin"});
}

TEST_F(MeshFiles, KeywordsOfOffMayTouchTheirCounts) {
    const std::string body = "0 0 0\n1 0 0\n0 2 0\n3 0 1 2\n";
    for (const char* head : {"OFF3 1 0\n", "COFF3 1 0\n", "OFF3 1\n", "# a\n\nOFF3 1 0\n"})
        EXPECT_EQ(corners("a.off", head + body), "0 0 0, 1 0 0, 0 2 0") << head;
    EXPECT_EQ(corners("a.off", "4OFF3 1 0\n0 0 0 1\n2 0 0 2\n0 4 0 2\n3 0 1 2\n"), "0 0 0, 1 0 0, 0 2 0");
    for (const char* head : {"nOFF3 1 0\n", "4nOFF 3 1 0\n", "OFFX3 1 0\n", "OFF3x 1 0\n"})
        refused("a.off", head + body, {"OFF"});
    refused("a.off", "OFF9999 1 0\n" + body, {"announces 9999 vertices", "cannot hold"});
    EXPECT_EQ(load("a.off", "OFF 3 1 0\n" + body + "3 2 1 0\n").report.notes,
              (Notes{"1 line after its last face was left out"}));
}

TEST_F(MeshFiles, LinesOfOffMayBeDividedInTheHeaderAlone) {
    const std::string body = "0 0 0 # a\n1 0 0\n0 2 0\n3 0 1 2 # b\n";
    for (const char* head :
         {"OFF\n3\n1\n0\n", "OFF 3\n1 0\n", "OFF\n3 1\n0\n", "3 1\n0\n", "OFF\n# a\n3 # b\n1 # c\n# d\n0\n"})
        EXPECT_EQ(corners("a.off", head + body), "0 0 0, 1 0 0, 0 2 0") << head;
    EXPECT_EQ(corners("a.off", "STCNOFF\n3 1 0\n0 0 0 0 0 1 9 9 9 9 .5 .5\n1 0 0\n0 2 0\n3 0 1 2\n"),
              "0 0 0, 1 0 0, 0 2 0");
    for (const char* text : {"OFF\n3 2 0\n0 0 0\n1 0 0\n0 2 0\n3 0 1 2 3 2 1 0\n",
                             "OFF\n3 1 0\n0 0 0 1 0 0 0 2 0 3 0 1 2\n", "OFF\n3 1 0\n0 0 0 1 0 0\n0 2 0\n3 0 1 2\n"})
        refused("a.off", text, {"ends after", "on a line of its own"});
    refused("a.off", "OFF\n3 1 0\n0 0\n0\n1 0 0\n0 2 0\n3 0 1 2\n", {"line 3", "three coordinates"});
    for (const char* head : {"OFF BINARY\n", "COFF BINARY\n"}) refused("a.off", head + body, {"binary OFF", "text"});
    refused("a.off", "NCOFF\n3 1 0\n" + body, {"'NCOFF' is not a supported OFF header", "save the file as OFF"});
}

TEST_F(MeshFiles, UnusualStl) {
    const auto facet = [](float x, const std::string& attribute) {
        std::string bytes(12, '\0');
        for (const float v : {x, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 2.0F, 0.0F}) {
            bytes.append(sizeof v, '\0');
            std::copy_n(static_cast<const char*>(static_cast<const void*>(&v)), sizeof v, bytes.end() - sizeof v);
        }
        return bytes + attribute;
    };
    const auto binary = [](std::string header, char count, const std::string& facets) {
        header.resize(80, ' ');
        return header + count + std::string(3, '\0') + facets;
    };
    const std::string good = binary("solid a", 2, facet(0, "\x1f\x80") + facet(9, "\xff\xff"));
    EXPECT_EQ(corners("a.stl", good), "0 0 0, 1 0 0, 0 2 0; 9 0 0, 1 0 0, 0 2 0");
    EXPECT_EQ(corners("a.stl", binary("COLOR=abcd", 1, facet(0, "ab"))), "0 0 0, 1 0 0, 0 2 0");
    refused("a.stl", good + "more", {"damaged", "fetch or save it again"});
    refused("a.stl", binary("a", 0, facet(0, "ab")), {"0 facets take 84 bytes"});
    refused("a.stl", binary("solid a", 0, ""), {"no vertices"});
    const std::string text = "outer loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2 0\nendloop\nendfacet\n";
    const LoadedShape two =
        load("a.stl", "solid a\nfacet\n" + text + "endsolid a\nsolid\nfacet normal\n" + text + "facet normal 0 0\n" +
                          text + "facet normal nan nan nan\n" + text + "endsolid\n");
    EXPECT_EQ(two.report.objects, 2);
    EXPECT_EQ(element_count(two.shape), 4);
    refused("a.stl", "solid a\nendsolid a\n", {"no vertices"});
    refused("a.stl",
            "solid a\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2 0\nendloop\nouter loop\n"
            "vertex 0 0 0\nvertex 1 0 0\nvertex 0 2 0\nendloop\nendfacet\nendsolid\n",
            {"a facet of 6 vertices"});
}

TEST_F(MeshFiles, UnknownHeadersOfOffAreRefused) {
    for (const char* word : {"LOFF", "XOFF", "OFFF", "nOFF"})
        refused("a.off", std::string(word) + "\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", {"line 1", word});
}

TEST_F(MeshFiles, ShortFacesOfOffAreSegmentsAndPoints) {
    const LoadedShape loaded = load("a.off", "OFF\n3 3 0\n0 0 0\n1 0 0\n0 2 0\n2 0 1\n1 2\n0\n");
    EXPECT_EQ(loaded.report.segments, 1);
    EXPECT_EQ(loaded.report.single_points, 1);
    EXPECT_EQ(element_count(loaded.shape), 2);
    const LoadedShape points = load("a.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 2 0\n1 2\n1 0\n");
    ASSERT_EQ(kind_of(points.shape), ShapeKind::points);
    EXPECT_EQ(points_of(points.shape), (Points(2, 3) << 0, 2, 0, 0, 0, 0).finished());
}

// Returns a text file of PLY with four vertices and another element.
std::string ply(const std::string& element, const std::string& lines, const std::string& last = "0 0 3\n") {
    return "ply\nformat ascii 1.0\nobj_info x\nelement vertex 4\nproperty double x\nproperty double y\nproperty double "
           "z\n" +
           element + "end_header\n0 0 0\n1 0 0\n0 2 0\n" + last + lines;
}
const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
const std::string edges = "element edge 2\nproperty uchar q\nproperty int vertex2\nproperty int vertex1\n";

TEST_F(MeshFiles, EdgesOfPlyAreSegments) {
    const std::string text = ply(edges, "9 1 0\n9 3 2\n");
    EXPECT_EQ(corners("a.ply", text), "0 0 0, 1 0 0, 1 0 0; 0 2 0, 0 0 3, 0 0 3");
    EXPECT_EQ(load("a.ply", text).report.segments, 2);
    EXPECT_EQ(element_count(load("a.ply", ply(faces + edges, "3 0 1 2\n9 1 0\n9 3 2\n")).shape), 3);
    refused("a.ply", ply(edges, "9 1 0\n9 4 2\n"), {"face 1 (from 0) names vertex 4"});
    refused("a.ply", ply(edges, "9 1 0\n9 -1 2\n"), {"face 1 (from 0)"});
    refused("a.ply", ply(edges, "9 1 0\n9 0.5 2\n"), {"damaged"});
    refused("a.ply", ply("element edge 1\nproperty int vertex1\n", "0\n"), {"vertex1 and vertex2"});
    refused("a.ply", ply("element edge 1\nproperty list uchar int vertex_indices\n", "2 0 1\n"),
            {"vertex1 and vertex2"});
}

TEST_F(MeshFiles, StripsOfPlyAreTriangles) {
    const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\n";
    EXPECT_EQ(corners("a.ply", ply(strips, "4 0 1 2 3\n")), "0 0 0, 1 0 0, 0 2 0; 0 2 0, 1 0 0, 0 0 3");
    EXPECT_EQ(corners("a.ply", ply(strips, "8 0 1 2 -1 1 2 3 -1\n")), "0 0 0, 1 0 0, 0 2 0; 1 0 0, 0 2 0, 0 0 3");
    EXPECT_EQ(corners("a.ply", ply(strips, "6 0 1 2 2 2 3\n")), "0 0 0, 1 0 0, 0 2 0");  // joins without an area
    refused("a.ply", ply(strips, "4 0 1 2 4\n"), {"names vertex 4"});
    refused("a.ply", ply(strips, "4 0 1 2 -2\n"), {"face 1 (from 0)"});
    refused("a.ply", ply("element tristrips 1\nproperty int q\n", "4\n"), {"triangle strips have no list"});
}

TEST_F(MeshFiles, UnusedVerticesOfPlyNeedNotBeFinite) {
    for (const std::string none : {"nan nan nan\n", "inf 0 -inf\n"}) {
        const std::string text = ply(faces, "3 0 1 2\n", none), used = ply(faces, "3 0 1 3\n", none);
        EXPECT_EQ(corners("a.ply", text), "0 0 0, 1 0 0, 0 2 0");
        EXPECT_EQ(load("a.ply", text).report.unreferenced, 1);
        refused("a.ply", used, {"vertex 3 (from 0)", "not finite", "--drop-invalid"});
        refused("a.ply", ply("", "", none), {"vertex 3 (from 0)"});
        EXPECT_EQ(load("a.ply", ply("", "", none), {.drop_invalid = true}).report.dropped_points, 1);
    }
    refused("a.ply", ply(faces, "nan 0 1 2\n"), {"damaged"});
    refused("a.ply", ply(faces, "3 0 inf 2\n"), {"damaged"});
}

TEST_F(MeshFiles, OtherElementsOfPlyAreTold) {
    const std::string polygons = "element polygon 1\nproperty list uchar int vertex_indices\n";
    EXPECT_EQ(load("a.ply", ply(faces + polygons, "3 0 1 2\n3 1 2 3\n")).report.notes,
              (Notes{"its elements 'polygon' (1), which have lists of vertices, were left out"}));
    refused("a.ply", ply(polygons, "3 0 1 2\n"), {"'polygon' (1)", "'face'"});
    const std::string none =
        "element face 0\nproperty list uchar int vertex_indices\n";  // as VTK writes a mesh of strips
    EXPECT_EQ(load("a.ply", ply(none, "")).report.notes,
              (Notes{"its header announces 0 faces: its vertices count as points"}));
    const std::string grid = "element range_grid 2\nproperty list uchar int vertex_indices\n";
    const LoadedShape scan = load("a.ply", ply(grid, "1 0\n0\n"));
    EXPECT_EQ(kind_of(scan.shape), ShapeKind::points);
    EXPECT_EQ(scan.report.notes.size(), 1u);
    EXPECT_TRUE(has_note(
        load("a.ply", ply(faces + "element line 1\nproperty int vertex1\nproperty int vertex2\n", "3 0 1 2\n0 1\n")),
        "'line' (1) were left out"));
    EXPECT_TRUE(
        load("a.ply", ply(faces + "element camera 1\nproperty float f\n", "3 0 1 2\n1\n")).report.notes.empty());
}

TEST_F(MeshFiles, WordsAfterTheElementsOfPlyAreRefused) {
    refused("a.ply", ply(faces, "3 0 1 2\n3 0 1 3\n"), {"'3'", "fewer elements or properties"});
    EXPECT_EQ(corners("a.ply", ply(faces, "3 0 1 2\n \n\n")), "0 0 0, 1 0 0, 0 2 0");
}

TEST_F(MeshFiles, BytesAfterTheElementsOfBinaryPly) {
    const std::string head =
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar x\nproperty uchar y\nproperty uchar "
        "z\nend_header\n\1\2\3";
    EXPECT_TRUE(load("a.ply", head).report.notes.empty());
    EXPECT_TRUE(load("a.ply", head + "\r\n").report.notes.empty());
    EXPECT_TRUE(has_note(load("a.ply", head + std::string(9, '\0')), "9 bytes after its last element were left out"));
    EXPECT_TRUE(has_note(load("a.ply", head + "\7\7"), "2 bytes after its last element were left out"));
    refused("a.ply", head + "\4\5\6", {"3 bytes after its last element", "correct it"});
}

TEST_F(MeshFiles, IntegerTypesOfTextPly) {
    const auto with = [](const std::string& type, const std::string& x) {
        return "ply\nformat ascii 1.0\nelement vertex 1\nproperty " + type +
               " x\nproperty float y\nproperty float z\n" + "end_header\n" + x + " 2 3\n";
    };
    EXPECT_EQ(rows(load("a.ply", with("uchar", "255"))).front(), Vec3(255, 2, 3));
    EXPECT_EQ(rows(load("a.ply", with("short", "-32768.0"))).front(), Vec3(-32768, 2, 3));
    for (const auto& [type, x] :
         {std::pair("uchar", "256"), {"uchar", "-1"}, {"short", "-32769"}, {"int", "0.5"}, {"uint", "nan"}})
        refused("a.ply", with(type, x), {"vertex 0 (from 0): x is ", "'property double x' in the header"});
}

TEST_F(MeshFiles, NamesInPly) {
    const auto with = [](const std::string& names, const std::string& line) {
        return "ply\nformat ascii 1.0\nelement vertex 1\n" + names + "end_header\n" + line;
    };
    const std::string capitals = "property float X\nproperty float Y\nproperty float Z\n";
    const std::string small = "property float x\nproperty float y\nproperty float z\n";
    const auto first = [&](const std::string& bytes) { return rows(load("a.ply", bytes)).front(); };
    EXPECT_EQ(first(with(capitals, "1 2 3\n")), Vec3(1, 2, 3));
    EXPECT_EQ(first(with(capitals + small, "4 5 6 1 2 3\n")), Vec3(1, 2, 3));
    EXPECT_EQ(first("\xef\xbb\xbf" + with(small, "1 2 3\n")), Vec3(1, 2, 3));
    refused("a.ply", with("property float X\nproperty float y\nproperty float z\n", "1 2 3\n"), {"x, y and z"});
    refused("a.ply", with(small + "element vertex 1\n" + small, "1 2 3\n4 5 6\n"), {"two elements of vertices"});
}

TEST_F(MeshFiles, FormatsWithAnotherEnding) {
    const std::string solid =
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
        "0\nendloop\nendfacet\nendsolid a\n";
    const std::string off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    const std::string amf = "<?xml version=\"1.0\"?>\n<!-- a -->\n<amf unit=\"mm\"></amf>\n";
    const std::vector<std::array<std::string, 3>> all = {
        {"a.obj", off, ".off"},
        {"a.txt", off, ".off"},
        {"a.obj", solid, ".stl"},
        {"a.stl", ply(faces, "3 0 1 2\n"), ".ply"},
        {"a.3mf", amf, ".amf"},
        {"a.obj", "{\"asset\": {\"version\": \"2.0\"}}", ".glb"},
        {"a.xyz", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ".obj"},
        {"a.mesh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", ".msh"},
        {"a.xyz", "# .PCD v.7 - Point Cloud Data file format\nVERSION .7\nFIELDS x y z\n", ".pcd"},
        {"a", off, ".off"},
        {"a.dat", off, ".off"},
        {"a.stl", "0\nSECTION\n2\nENTITIES\n0\nENDSEC\n0\nEOF\n", ".dxf"},
    };
    for (const auto& [name, bytes, ending] : all)
        refused(name, bytes, {"begins like", "rename it to end in " + ending});
    for (const std::string name : {"a.xyz", "a.h5", "a.dat", "a.ply", "a"})
        refused(name, "\x89HDF\r\n\x1a\n....", {"HDF5", "h5py"});
    std::string utf16("\xff\xfes\0o\0l\0i\0d\0", 12);
    utf16.resize(212);
    refused("a.stl", utf16, {"UTF-16", "UTF-8"});
    refused("a.stl", "solid state physics\n", {"ends inside a solid"});
    refused("a.dat", "1 2 3\n", {"'dat' is not a format", ".xyz"});
}

TEST_F(MeshFiles, StlWithoutItsInvalidFacets) {
    std::string bytes(80, ' ');
    const std::uint32_t facets = 2;
    bytes.append(reinterpret_cast<const char*>(&facets), 4);
    for (const float x : {1.f, std::numeric_limits<float>::quiet_NaN()}) {
        for (const float value : {0.f, 0.f, 1.f, 0.f, 0.f, 0.f, x, 0.f, 0.f, 0.f, 2.f, 0.f})
            bytes.append(reinterpret_cast<const char*>(&value), 4);
        bytes.append(2, '\0');
    }
    refused("a.stl", bytes, {"vertex 1 of facet 1", "--drop-invalid"});
    EXPECT_EQ(corners("a.stl", bytes, {.drop_invalid = true}), "0 0 0, 1 0 0, 0 2 0");
    EXPECT_EQ(load("a.stl", bytes, {.drop_invalid = true}).report.dropped_faces, 1);
}

}  // namespace
}  // namespace hausbench
