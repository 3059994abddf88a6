// Gmsh: text and binary files of all versions, elements of lower dimension, and every refusal.
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

std::string format_of(const std::string& version) { return "$MeshFormat\n" + version + " 0 8\n$EndMeshFormat\n"; }

// Four nodes with tags that have gaps and no order.
const std::string nodes = "$Nodes\n4\n7 0 0 0\n1 1 0 0\n90 0 1 0\n4 0 0 1\n$EndNodes\n";
std::string elements(int count, const std::string& lines) {
    return fmt::format("$Elements\n{}\n{}$EndElements\n", count, lines);
}
const std::string head = format_of("2.2") + nodes;
const std::string triangle = "3 2 2 0 1 7 1 90\n";

// Appends numbers to a binary file.
class Binary {
public:
    Binary(const std::string& version, bool big) : big_(big) {
        text("$MeshFormat\n" + version + " 1 8\n").integers<std::int32_t>({1}).text("\n$EndMeshFormat\n");
    }
    Binary& text(const std::string& text) {
        bytes_ += text;
        return *this;
    }
    template <class T> Binary& integers(const std::vector<T>& values) {
        for (const T value : values) {
            char chars[sizeof value];
            std::memcpy(chars, &value, sizeof value);
            if (big_) std::reverse(chars, chars + sizeof value);
            bytes_.append(chars, sizeof value);
        }
        return *this;
    }
    Binary& ints(const std::vector<std::int32_t>& values) { return integers(values); }
    Binary& longs(const std::vector<std::int64_t>& values) { return integers(values); }
    Binary& reals(const std::vector<double>& values) { return integers(values); }
    const std::string& bytes() const { return bytes_; }

private:
    bool big_;
    std::string bytes_;
};

class Gmsh : public Reading {
protected:
    Gmsh() : Reading("a.msh") {}

    void expect_triangle(const std::string& text) const {
        const LoadedShape loaded = load(text);
        EXPECT_EQ(corners(loaded), (std::vector<Vec3>{{0.1, 0, 0}, {1, 0, -2}, {0, 3, 0}})) << text;
        EXPECT_TRUE(loaded.report.notes.empty());
        EXPECT_FALSE(loaded.report.float32);
        EXPECT_EQ(loaded.report.format, "msh");
    }
};

TEST_F(Gmsh, VersionOneIsRead) {
    expect_triangle(
        "$NOD\n3\n5 0.1 0 0\n6 1 0 -2\n8 0 3 0\n$ENDNOD\n$ELM\n2\n1 15 0 1 1 5\n2 2 9 1 3 5 6 8\n$ENDELM\n");
    refused("$NOD\n1\n5 0 0 0\n$ENDNOD\n$ELM\n1\n1 2 9 1 4 5 5 5 5\n$ENDELM\n",
            {"line 7", "has 4 nodes, but its type has 3"});
}

TEST_F(Gmsh, VersionTwoIsRead) {
    for (const char* version : {"2", "2.0", "2.000000", "2.1", "2.2", "2.20"})
        expect_triangle(format_of(version) +
                        "$Nodes\n3\n5 0.1 0 0\n6 1 0 -2\n8 0 3 0\n$EndNodes\n$Elements\r\n1\r\n"
                        "2 2 4 9 1 2 -3 5 6 8\r\n$EndElements\r\n");
    expect_triangle(
        format_of("2.2") +
        "$ParametricNodes\n3\n5 0.1 0 0 0 1\n6 1 0 -2 1 4 0.5\n8 0 3 0 2 1 0.25 0.75\n$EndParametricNodes\n" +
        elements(1, "1 2 0 5 6 8\n"));
}

TEST_F(Gmsh, VersionFourIsRead) {
    // 4.0: the tag of the entity stands before its dimension, and each tag before its coordinates.
    expect_triangle(format_of("4") +
                    "$Nodes\n2 3\n1 0 0 1\n5 0.1 0 0\n1 2 1 2\n6 1 0 -2 .5 .5\n8 0 3 0 0 1\n$EndNodes\n"
                    "$Elements\n1 1\n1 2 2 1\n1 5 6 8\n$EndElements\n");
    expect_triangle(format_of("4.1") +
                    "$Nodes\n2 3 5 8\n0 1 1 1\n5\n0.1 0 0\n2 1 1 2\n8\n6\n0 3 0 .5 .5\n1 0 -2 0 1\n$EndNodes\n"
                    "$Elements\n2 2 1 2\n0 1 15 1\n1 5\n2 1 2 1\n2 5 6 8\n$EndElements\n");
}

TEST_F(Gmsh, BinaryFilesAreReadInBothByteOrders) {
    for (const bool big : {false, true}) {
        Binary version_22("2.2", big);
        version_22.text("$Nodes\n3\n")
            .ints({5})
            .reals({0.1, 0, 0})
            .ints({6})
            .reals({1, 0, -2})
            .ints({8})
            .reals({0, 3, 0});
        version_22.text("\n$EndNodes\n$Elements\n3\n").ints({15, 2, 2, 1, 0, 1, 5, 2, 0, 1, 6});
        expect_triangle(version_22.ints({2, 1, 2, 3, 0, 1, 5, 6, 8}).text("\n$EndElements\n").bytes());
        Binary version_40("4.0", big);
        version_40.text("$Nodes\n").longs({1, 3}).ints({1, 2, 1}).longs({3});
        version_40.ints({5})
            .reals({0.1, 0, 0, 7, 7})
            .ints({6})
            .reals({1, 0, -2, 7, 7})
            .ints({8})
            .reals({0, 3, 0, 7, 7});
        version_40.text("\n$EndNodes\n$Elements\n").longs({1, 1}).ints({1, 2, 2}).longs({1}).ints({1, 5, 6, 8});
        expect_triangle(version_40.text("\n$EndElements\n").bytes());
        Binary version_41("4.1", big);
        version_41.text("$Entities\n").longs({0, 0, 0, 0}).text("\n$EndEntities\n");
        version_41.text("$Nodes\n").longs({1, 3, 5, 8}).ints({3, 1, 1}).longs({3, 5, 6, 8});
        version_41.reals({0.1, 0, 0, 7, 7, 7, 1, 0, -2, 7, 7, 7, 0, 3, 0, 7, 7, 7}).text("\n$EndNodes\n$Elements\n");
        version_41.longs({1, 1, 1, 1}).ints({2, 1, 2}).longs({1, 1, 5, 6, 8}).text("\n$EndElements\n");
        expect_triangle(version_41.bytes());
        for (std::size_t size = 1; size < version_41.bytes().size() - 1; ++size) {
            // A file that ends before the elements is a valid point set.
            const std::string part = version_41.bytes().substr(0, size);
            if (part.ends_with("$EndNodes") || part.ends_with("$EndNodes\n")) continue;
            EXPECT_THROW(load(part), InputError) << size;
        }
    }
}

TEST_F(Gmsh, DamagedBinaryFilesAreRefused) {
    const auto start = [] { return Binary("4.1", false); };
    refused(start().text("$Nodes\n").longs({1, INT64_MAX, 1, 1}).bytes(), {"announces 9223372036854775807 nodes"});
    refused(start().text("$Nodes\n").longs({1, -1, 1, 1}).bytes(), {"announces -1 nodes"});
    refused(start().text("$Nodes\n").longs({1, 0, 1, 1}).ints({9, 1, 0}).longs({0}).bytes(), {"dimension 9"});
    refused(start().text("$Nodes\n").longs({1, 0, 1, 1}).ints({2, 1, 5}).longs({0}).bytes(), {"expected 0 or 1"});
    const auto two = [] {
        return Binary("2.2", false).text("$Nodes\n1\n").ints({5}).reals({0.1, 0, 0}).text("$EndNodes\n");
    };
    refused(two().text("$Elements\n2\n").ints({15, 3, 0, 1, 5, 2, 5, 3, 5}).bytes(), {"a block has 3 elements, but 2"});
    refused(two().text("$Elements\n2\n").ints({15, 0, 0, 0}).bytes(), {"a block has 0 elements"});
    refused(two().text("$Elements\n1\n").ints({15, 1, 1 << 30, 0, 0}).bytes(), {"announces 1073741824 tags"});
    refused("$MeshFormat\n2.2 1 8\nabcd\n$EndMeshFormat\n", {"tells the byte order"});
    refused("$MeshFormat\n4.1 1 4\n", {"numbers of 4 bytes", "gmsh"});
}

TEST_F(Gmsh, ElementsThatAddNothingAreLeftOut) {
    const auto loaded = load(head + elements(4, "1 15 2 0 1 7\n2 1 2 0 1 1 7\n8 15 2 0 1 90\n" + triangle));
    EXPECT_EQ(corners(loaded), (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(loaded.report.segments, 0);
    EXPECT_EQ(loaded.report.single_points, 0);
    EXPECT_EQ(loaded.report.unreferenced, 1);
    EXPECT_TRUE(loaded.report.notes.empty());
}

TEST_F(Gmsh, ElementsOffTheSurfaceAreAdded) {
    const auto line = load(head + elements(4, "1 15 2 0 1 4\n2 1 2 0 1 7 4\n8 15 2 0 1 90\n" + triangle));
    EXPECT_EQ(line.report.segments, 1);
    EXPECT_EQ(line.report.single_points, 0);
    EXPECT_TRUE(has_note(line, "a side of no surface cell are measured too (1)"));
    EXPECT_FALSE(has_note(line, "points"));
    // The centre of an arc.
    const auto point = load(head + elements(2, "1 15 2 0 1 4\n" + triangle));
    EXPECT_EQ(corners(point).size(), 3u);
    EXPECT_TRUE(has_note(point, "such as the centres of arcs, are left out (1)"));
    const auto quadrangle = load(head + elements(2, "1 3 2 0 1 7 1 90 4\n2 1 0 7 90\n"));
    EXPECT_EQ(quadrangle.report.polygons, 1);
    EXPECT_EQ(quadrangle.report.segments, 1);  // a diagonal
    EXPECT_EQ(std::get<PointSet>(load(head + elements(1, "1 15 0 90\n")).shape).points, Points({{0, 1, 0}}));
    EXPECT_EQ(std::get<PointSet>(load(head).shape).points.rows(), 4);
    EXPECT_TRUE(has_note(load(head), "no elements: its nodes are read as points"));
}

TEST_F(Gmsh, VolumeElementsAreLeftOutWithANote) {
    const auto loaded = load(head + elements(2, triangle + "9 4 0 7 1 90 4\n"));
    EXPECT_EQ(corners(loaded).size(), 3u);
    EXPECT_TRUE(has_note(loaded, "the volume cells of the file (1 tetrahedra) are left out"));
    EXPECT_TRUE(has_note(loaded, "they lack 3 outer faces"));
    refused(head + elements(2, "1 1 0 7 1\n9 4 0 7 1 90 4\n"),
            {"volume cells (1 tetrahedra) and no surface cells", "Mesh.SaveAll", "Extract Surface"});
    refused(head + elements(2, triangle + "9 4 0 7 1 90 5\n"), {"a volume element names node 5"});
    const std::string eight =
        format_of("2.2") +
        "$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n$EndNodes\n";
    const auto all =
        load(eight + elements(4, "1 2 0 1 2 3\n2 5 0 1 2 3 4 5 6 7 8\n3 6 0 1 2 3 5 6 7\n4 7 0 1 2 3 4 5\n"));
    EXPECT_TRUE(has_note(all, "1 pyramids, 1 prisms, 1 hexahedra"));
}

TEST_F(Gmsh, OtherSectionsAreIgnored) {
    const auto loaded = load("$Comments\nanything $Nodes\n$EndComments\n" + format_of("2.2") +
                             "$PhysicalNames\n1\n2 1 \"a b\"\n$EndPhysicalNames\n" + nodes + elements(1, triangle) +
                             "$Periodic\n0\n$EndPeriodic\n$NodeData\n1\n\"x\"\n$EndNodeData\n$Blobs\n1\n$EndBlobs\n");
    EXPECT_EQ(corners(loaded).size(), 3u);
    ASSERT_EQ(loaded.report.notes.size(), 1u);
    EXPECT_TRUE(has_note(loaded, "the section $Blobs is not known"));
}

TEST_F(Gmsh, CurvedElementsAreRefusedByName) {
    refused(head + elements(1, "1 9 0 7 1 90 4 4 4\n"), {"line 13", "type 9 (6-node triangle)", "curved", "order 1"});
    refused(head + elements(1, "1 8 0 7 1 90\n"), {"type 8 (3-node line)"});
    refused(head + elements(1, "1 16 0 7 1 90\n"), {"type 16 (8-node quadrangle)"});
    refused(head + elements(1, "1 31 0 7 1 90\n"), {"type 31 (56-node tetrahedron)"});
    refused(head + elements(1, "1 92 0 7 1 90\n"), {"type 92 are curved"});
    refused(head + elements(1, "1 34 0 7 1 90\n"), {"type 34 (polygon)", "triangles"});
    refused(head + elements(1, "1 0 0 7 1 90\n"), {"type 0 is not known"});
    refused(head + elements(1, "1 999 0 7 1 90\n"), {"type 999 is not known"});
}

TEST_F(Gmsh, DamagedTextIsRefusedWithItsPlace) {
    refused(head + elements(1, "3 2 2 0 1 7 1 8\n"), {"line 13", "element 3 names node 8", "$Nodes does not have"});
    refused(head + elements(2, triangle), {"line 14", "expected the number of an element", "'$EndElements'"});
    refused(head + elements(1, triangle + triangle), {"line 14", "expected $EndElements, found '3'", "more numbers"});
    refused(head + elements(99999, triangle), {"line 12", "announces 99999 elements"});
    refused(head + "$Elements\n1\n" + triangle, {"expected $EndElements", "the end of the file"});
    refused(format_of("2.2") + "$Nodes\n1\n1 0 x 0\n$EndNodes\n", {"line 6", "a coordinate of a node, found 'x'"});
    refused(format_of("2.2") + "$Nodes\n2\n1 0 0 0\n1 0 0 1\n$EndNodes\n", {"node 1 twice"});
    refused(format_of("2.2") + "$Nodes\n1\n1 0 nan 0\n$EndNodes\n", {"not finite"});
    refused(format_of("4.1") + "$Nodes\n1 2 1 2\n2 1 0 1\n1\n0 0 0\n$EndNodes\n",
            {"announces 2 nodes", "blocks have 1"});
    refused(format_of("2.2") + "text\n", {"line 4", "expected a section", "'text'"});
    refused(format_of("2.2") + "$Periodic\n1\n", {"has no $EndPeriodic", "truncated"});
    refused(format_of("2.2"), {"no section $Nodes"});
    refused("$Nodes\n0\n$EndNodes\n", {"before $MeshFormat"});
    refused(format_of("2.2") + format_of("2.2"), {"a second $MeshFormat"});
    EXPECT_EQ(corners(load(format_of("2.2") + nodes + nodes + elements(1, triangle))).size(), 3u);  // the same again
}

TEST_F(Gmsh, OtherVersionsAndFormatsAreNamed) {
    refused(format_of("3"), {"line 2", "version 3", "msh41"});
    refused(format_of("4.2"), {"version 4.2"});
    refused(format_of("nan"), {"version nan"});
    refused("$NOD\n1\n5 0 0 0\n$ENDNOD\n$ELM\n1\n1 15 0 1 1 5\n$ENDELM$\n",
            {"found '$ENDELM$': remove what follows $ENDELM"});
    refused("$MeshFormat\n2.2 7 8\n", {"file type 7"});
    refused("$PostFormat\n1.4 0 8\n$EndPostFormat\n", {"view of results"});
    refused("(0 \"Fluent\")\n(2 3)\n", {"is not a Gmsh mesh", "Fluent", "ParaView"});
    refused("4 2 4\n0 0 1\n1 0 1\n", {"FreeFem", "savemesh"});
    refused("MESH dimension 3 ElemType Triangle Nnode 3\n", {"GiD"});
    refused("MeshVersionFormatted 2\n", {"like a file of Medit", "rename it to end in .mesh"});
    refused("<mesh/>\n", {"XML"});
    refused("hello\n", {"does not begin with $MeshFormat"});
}

}  // namespace
}  // namespace hausbench
