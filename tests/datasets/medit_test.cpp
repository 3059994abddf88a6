// Medit: text and binary files of all versions, the cells that are the surface, and every refusal.
#include "algorithms/error.h"
#include "datasets/load.h"
#include "tests/support/reading.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <variant>
#include <vector>

namespace hausbench {
namespace {

const std::string head = "MeshVersionFormatted 2\nDimension 3\n";
const std::string vertices = "Vertices\n4\n0 0 0 7\n1 0 0 7\n0 1 0 7\n0 0 1 7\n";
const std::string triangle = "Triangles\n1\n1 2 3 0\n";

// Writes the numbers of a binary file.
class Binary {
public:
    Binary(int version, bool big) : version_(version), big_(big) {
        number<std::int32_t>(1);
        number<std::int32_t>(version);
    }
    template <class T> Binary& number(T value) {
        char text[sizeof value];
        std::memcpy(text, &value, sizeof value);
        if (big_) std::reverse(text, text + sizeof value);
        bytes_.append(text, sizeof value);
        return *this;
    }
    Binary& integer(std::int64_t value) {
        return version_ == 4 ? number(value) : number(static_cast<std::int32_t>(value));
    }
    Binary& real(double value) { return version_ == 1 ? number(static_cast<float>(value)) : number(value); }
    Binary& link(std::int64_t at) { return version_ > 2 ? number(at) : number(static_cast<std::int32_t>(at)); }
    // Adds a keyword whose data takes `size` bytes.
    Binary& keyword(int code, std::int64_t size) {
        number<std::int32_t>(code);
        const auto here = static_cast<std::int64_t>(bytes_.size());
        return link(here + (version_ > 2 ? 8 : 4) + size);
    }
    Binary& dimension() { return keyword(3, 4).number<std::int32_t>(3); }
    Binary& three_vertices() {
        const std::int64_t whole = version_ == 4 ? 8 : 4, real_size = version_ == 1 ? 4 : 8;
        keyword(4, whole + 3 * (3 * real_size + whole)).integer(3);
        for (const auto& p : std::vector<std::vector<double>>{{0.1, 0, 0}, {1, 0, -2}, {0, 3, 0}}) {
            for (const double x : p) real(x);
            integer(0);
        }
        return *this;
    }
    Binary& triangle(std::int64_t last = 3) {
        keyword(6, (version_ == 4 ? 8 : 4) * 5).integer(1);
        return integer(1).integer(2).integer(last).integer(0);
    }
    Binary& end() { return number<std::int32_t>(54).link(0); }
    const std::string& bytes() const { return bytes_; }

private:
    int version_;
    bool big_;
    std::string bytes_;
};

class Medit : public Reading {
protected:
    Medit() : Reading("a.mesh") {}
};

TEST_F(Medit, TextIsReadToTheLastBit) {
    const auto loaded = load(
        "# made by hand\nMeshVersionFormatted\n3 Dimension\n3\n# vertices\n\nVertices 3 # three\n0.1 1e-17 +.5 0\n"
        "0.30000000000000004 -2.718281828459045 1.7976931348623157e300 -1\r\n3 4 5. 2.0\nTriangles 1 3 1 2 9 End\n");
    EXPECT_EQ(
        corners(loaded),
        (std::vector<Vec3>{{3, 4, 5}, {0.1, 1e-17, 0.5}, {0.1 + 0.2, -2.718281828459045, 1.7976931348623157e300}}));
    EXPECT_EQ(loaded.report.format, "mesh");
    EXPECT_EQ(loaded.report.precision, "float64");
    EXPECT_FALSE(loaded.report.float32);
    EXPECT_EQ(loaded.report.stated.unit, "");
    EXPECT_EQ(loaded.report.stated.up, 0);
    EXPECT_TRUE(loaded.report.notes.empty());
}

TEST_F(Medit, VersionOneIsSinglePrecision) {
    const std::string file =
        "MeshVersionFormatted 1\nDimension 3\nVertices\n3\n0.1 0 0 0\n{} 0 0 0\n0 1 0 0\n" + triangle + "End\n";
    const auto loaded = load(fmt::format(fmt::runtime(file), "0.123456789012345"));
    EXPECT_EQ(corners(loaded)[0].x(), static_cast<double>(0.1f));
    EXPECT_EQ(corners(loaded)[1].x(), static_cast<double>(0.123456789012345f));
    EXPECT_TRUE(loaded.report.float32);
    EXPECT_TRUE(has_note(loaded, "as MeshVersionFormatted 1 defines (1)"));
    EXPECT_TRUE(has_note(loaded, "write 'MeshVersionFormatted 2'"));
    // A float32 that was printed with all digits loses nothing.
    EXPECT_TRUE(load(fmt::format(fmt::runtime(file), "0.12345679104328156")).report.notes.empty());
    EXPECT_TRUE(load(fmt::format(fmt::runtime(file), "0.5")).report.notes.empty());
}

TEST_F(Medit, FloatingPointPrecisionOverridesTheVersion) {
    const std::string rest =
        "Dimension 3\nFloatingPointPrecision {}\nVertices 3 0.1 0 0 0 1 0 0 0 0 1 0 0\n" + triangle + "End\n";
    EXPECT_EQ(corners(load("MeshVersionFormatted 2\n" + fmt::format(fmt::runtime(rest), 32)))[0].x(),
              static_cast<double>(0.1f));
    EXPECT_EQ(corners(load("MeshVersionFormatted 1\n" + fmt::format(fmt::runtime(rest), 64)))[0].x(), 0.1);
    refused("MeshVersionFormatted 1\n" + fmt::format(fmt::runtime(rest), 16), {"line 3", "only 32 and 64"});
    refused(head + vertices + "FloatingPointPrecision 32\nEnd\n", {"after Vertices", "move it"});
}

TEST_F(Medit, BinaryIsReadInAllVersionsAndByteOrders) {
    for (int version = 1; version <= 4; ++version)
        for (const bool big : {false, true}) {
            Binary file(version, big);
            file.dimension().three_vertices().keyword(60, 3).number('a').number('b').number('c');  // normals
            const auto loaded = load(big ? "a.meshb" : "a.mesh", file.triangle().end().bytes());
            const double tenth = version == 1 ? static_cast<double>(0.1f) : 0.1;
            EXPECT_EQ(corners(loaded), (std::vector<Vec3>{{tenth, 0, 0}, {1, 0, -2}, {0, 3, 0}})) << version << big;
            EXPECT_EQ(loaded.report.float32, version == 1);
            EXPECT_TRUE(loaded.report.notes.empty());
        }
}

TEST_F(Medit, DamagedBinaryFilesAreRefused) {
    const auto start = [](int version = 2) { return Binary(version, false); };
    const std::string good = start().dimension().three_vertices().triangle().end().bytes();
    for (std::size_t size = 4; size < good.size(); ++size) EXPECT_THROW(load(good.substr(0, size)), InputError) << size;
    refused(start().dimension().three_vertices().triangle(9).end().bytes(), {"names vertex 9", "1 to 3"});
    refused(start().dimension().three_vertices().triangle(0).end().bytes(), {"names vertex 0"});
    refused(start().dimension().three_vertices().number<std::int32_t>(60).link(8).bytes(),
            {"said to be at byte 8", "damaged"});
    refused(start().dimension().number<std::int32_t>(60).link(1 << 30).bytes(), {"is truncated or damaged"});
    refused(start(3).dimension().number<std::int32_t>(60).link(-5).bytes(), {"damaged"});
    refused(start().dimension().keyword(4, 4).integer(2000000000).bytes(), {"announces 2000000000 Vertices"});
    refused(start(4).dimension().keyword(4, 8).number<std::int64_t>(INT64_MAX).bytes(), {"announces", "Vertices"});
    refused(start().dimension().keyword(4, 4).integer(-1).bytes(), {"announces -1 Vertices"});
    refused(start().dimension().keyword(4, 8).integer(0).integer(0).end().bytes(), {"Vertices ends at byte"});
    refused(start().dimension().keyword(24, 4).integer(1).end().bytes(), {"TrianglesP2", "curved"});
    refused(start().dimension().keyword(999, 0).end().bytes(), {"unknown keyword of code 999"});
    refused(Binary(5, false).dimension().end().bytes(), {"MeshVersionFormatted 5", "1 to 4"});
}

TEST_F(Medit, TwoDimensionsLieInThePlane) {
    const auto loaded = load("MeshVersionFormatted 2 Dimension 2 Vertices 3 0 0 1 1 0 1 0 2 1 " + triangle + "End");
    EXPECT_EQ(corners(loaded), (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}}));
    EXPECT_TRUE(has_note(loaded, "dimension 2: z is 0"));
}

TEST_F(Medit, OnlyEdgesOffTheSurfaceAreAdded) {
    const auto loaded = load(head + vertices + "Edges 3 2 1 0 2 3 0 1 4 0\n" + triangle + "End");
    EXPECT_EQ(loaded.report.segments, 1);
    EXPECT_EQ(corners(loaded), (std::vector<Vec3>{{0, 0, 0}, {0, 0, 1}, {0, 0, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_TRUE(has_note(loaded, "a side of no surface cell are measured too (1)"));
    EXPECT_EQ(load(head + vertices + "Edges 1 1 4 0 End").report.segments, 1);
    // The diagonal of a quadrilateral is not a side of it.
    const auto quad = load(head + vertices + "Quadrilaterals 1 1 2 4 3 0 Edges 2 1 4 0 3 4 0 End");
    EXPECT_EQ(quad.report.polygons, 1);
    EXPECT_EQ(quad.report.segments, 1);
}

TEST_F(Medit, VerticesAloneAreAPointSet) {
    const auto loaded = load(head + vertices + "Corners 1 1 End");
    EXPECT_EQ(std::get<PointSet>(loaded.shape).points.rows(), 4);
}

TEST_F(Medit, VolumeCellsAreLeftOutWithANote) {
    const std::string surface = "Triangles 4 1 2 3 0 1 2 4 0 2 3 4 0 1 3 4 0\n";
    const auto whole = load(head + vertices + surface + "Tetrahedra 1 1 2 3 4 0 End");
    EXPECT_EQ(corners(whole).size(), 12u);
    ASSERT_EQ(whole.report.notes.size(), 1u);
    EXPECT_TRUE(has_note(whole, "the volume cells of the file (1 tetrahedra) are left out"));
    const auto part = load(head + vertices + triangle + "Tetrahedra 1 1 2 3 4 0 End");
    EXPECT_TRUE(has_note(part, "a part of the outside of the solid: they lack 3 outer faces"));
    const auto inside = load(head + "Vertices 5 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0 0 0 -1 0 " + triangle +
                             "Tetrahedra 2 1 2 3 4 0 1 2 3 5 0 End");
    EXPECT_TRUE(has_note(inside, "between two volume cells, are measured too (1)"));
    EXPECT_TRUE(has_note(inside, "they lack 6 outer faces"));
    refused(head + vertices + "Tetrahedra 1 1 2 3 4 0 End",
            {"volume cells (1 tetrahedra) and no surface cells", "Extract Surface"});
    refused(head + vertices + triangle + "Tetrahedra 1 1 2 3 5 0 End", {"names vertex 5"});
}

TEST_F(Medit, TheFacesOfEveryVolumeCellAreKnown) {
    const std::string eight = "Vertices 8 0 0 0 0 1 0 0 0 1 1 0 0 0 1 0 0 0 0 1 0 1 0 1 0 1 1 1 0 0 1 1 0\n";
    const auto hexahedron = load(head + eight +
                                 "Quadrilaterals 6 1 2 3 4 0 5 6 7 8 0 1 2 6 5 0 2 3 7 6 0 3 4 8 7 0 4 1 5 8 0 "
                                 "Hexahedra 1 1 2 3 4 5 6 7 8 0 End");
    EXPECT_EQ(hexahedron.report.notes.size(), 1u);
    const auto prism = load(head + eight +
                            "Triangles 2 1 2 3 0 5 6 7 0 Quadrilaterals 3 1 2 6 5 0 2 3 7 6 0 1 3 7 5 0 "
                            "Prisms 1 1 2 3 5 6 7 0 End");
    EXPECT_EQ(prism.report.notes.size(), 1u);
    const auto pyramid = load(head + eight +
                              "Triangles 4 1 2 5 0 2 3 5 0 3 4 5 0 4 1 5 0 Quadrilaterals 1 1 2 3 4 0 "
                              "Pyramids 1 1 2 3 4 5 0 End");
    EXPECT_EQ(pyramid.report.notes.size(), 1u);
}

TEST_F(Medit, AttributesAreIgnored) {
    const auto loaded = load(head + "Identifier\n\"x Triangles 1\"\nGeometry \"a\"\nRequiredVertices 1 1\n" + vertices +
                             "Normals 1 nan 0 1\nNormalAtVertices 1 1 1\nTangents 1 0 0 1\nRidges 0\n" + triangle +
                             "Comments 2\nTriangles 5\nand so on\nSolAtVertices 1 1 1\n0.5\nTrianglesP2 0\n"
                             "VerticesOnGeometricEdges 0\nTrianglesGID 0\nEnd\n# the end\n");
    EXPECT_EQ(corners(loaded).size(), 3u);
    EXPECT_EQ(loaded.report.unreferenced, 1);
    EXPECT_TRUE(loaded.report.notes.empty());
}

TEST_F(Medit, AMissingEndIsNoted) { EXPECT_TRUE(has_note(load(head + vertices + triangle), "End is missing")); }

TEST_F(Medit, UnsupportedCellsAreRefusedByName) {
    refused(head + vertices + "TrianglesP2\n1\n1 2 3 4 1 2 0\nEnd", {"line 10", "TrianglesP2", "curved", "degree 1"});
    refused(head + vertices + "EdgesP3 1 1 2 3 4 0 End", {"EdgesP3"});
    refused(head + vertices + "BoundaryPolygonHeaders\n1\n1 1\nEnd",
            {"BoundaryPolygonHeaders", "not supported", "Triangles"});
    refused(head + vertices + "Blobs\n1\n1\nEnd", {"line 9", "unknown keyword 'Blobs'"});
    refused(head + "vertices\n1\n", {"line 3", "unknown keyword 'vertices'", "write 'Vertices'"});
}

TEST_F(Medit, DamagedTextIsRefusedWithItsLine) {
    refused(head + vertices + "Triangles\n1\n1 2 5 0\nEnd", {"line 11", "names vertex 5", "1 to 4"});
    refused(head + vertices + "Triangles\n1\n0 1 2 0\nEnd", {"line 11", "names vertex 0"});
    refused(head + "Vertices\n2\n0 0 0\n1 0 0\n" + triangle, {"line 7", "a coordinate", "'Triangles'"});
    refused(head + "Vertices\n1\n0 0 0 1 5\n" + triangle, {"line 5", "found '5'", "3 coordinates and a reference"});
    refused(head + "Vertices\n9999999\n0 0 0 1\n", {"line 4", "announces 9999999 Vertices", "truncated"});
    refused(head + "Vertices\n-1\n", {"announces -1 Vertices"});
    refused(head + "Vertices\n1\n0 x 0 1\n", {"line 5", "found 'x'"});
    refused(head + "Vertices\n1\n0 inf 0 1\nEnd", {"not finite"});
    refused(head + vertices + "Triangles\n1\n1 2      ", {"the number of a vertex", "end of the file"});
    refused(head + vertices + vertices + "End", {"a second Vertices", "join"});
    refused("MeshVersionFormatted 2\nVertices\n1\n0 0 0 0\nEnd", {"Dimension 3"});
    refused("MeshVersionFormatted 2\nDimension 4\n", {"line 2", "Dimension 4"});
    refused("MeshVersionFormatted 0\nDimension 2\n", {"line 1", "MeshVersionFormatted 0", "1 to 4"});
    refused(head + "End", {"no keyword Vertices"});
    refused(head + vertices + "End\nTriangles", {"line 10", "after the keyword End"});
}

TEST_F(Medit, OtherFormatsAreNamed) {
    refused("MFEM mesh v1.0\n\ndimension\n3\n", {"is not a Medit mesh", "a mesh of MFEM", "convert"});
    refused("<?xml version='1.0'?>\n<!-- x --><mesh>\n</mesh>\n", {"XML file with the element <mesh>", "Ogre"});
    refused(std::string("\x00\x10[MeshSerializer_v1.100]\n", 25), {"a binary mesh of Ogre"});
    refused("version 1.00\n2\n", {"a mesh of Roblox"});
    refused("%YAML 1.1\n", {"YAML", "Unity"});
    refused("hello\n", {"does not begin with MeshVersionFormatted"});
}

}  // namespace
}  // namespace hausbench
