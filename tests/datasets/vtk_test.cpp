// VTK's files, legacy and XML: cells of every kind, every encoding of arrays, and every kind of damaged file.
#include "datasets/load.h"
#include "tests/support/reading.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hausbench {
namespace {

using Corners = std::vector<Vec3>;

const std::string head = "# vtk DataFile Version 3.0\na title\nASCII\n";
const std::string square = "POINTS 4 double\n0 0 0 1 0 0 1 1 0 0 1 0\n";
const Vec3 a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0);

template <class T> std::string stored(T value, bool big_endian) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    return bytes;
}
template <class T> std::string big(std::initializer_list<T> values) {
    std::string bytes;
    for (const T value : values) bytes += stored(value, true);
    return bytes;
}
template <class T> std::string little(std::initializer_list<T> values) {
    std::string bytes;
    for (const T value : values) bytes += stored(value, false);
    return bytes;
}

std::string base64(const std::string& bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::string deflated(const std::string& bytes) {
    uLongf size = compressBound(bytes.size());
    std::string packed(size, '\0');
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
             bytes.size());
    packed.resize(size);
    return packed;
}

class Vtk : public Reading {
protected:
    Vtk() : Reading("a.vtk") {}

    Corners points(const std::string& text) const { return rows(load(text)); }
    Corners points(const std::string& name, const std::string& text) const { return rows(load(name, text)); }
    void expect_one_note(const LoadedShape& loaded, const std::vector<std::string>& parts) const {
        ASSERT_EQ(loaded.report.notes.size(), 1u);
        for (const std::string& part : parts)
            EXPECT_NE(loaded.report.notes[0].find(part), std::string::npos) << loaded.report.notes[0];
    }
};

std::string poly(const std::string& sections) { return head + "DATASET POLYDATA\n" + square + sections; }

// A grid over the square with one cell of this type.
std::string grid(int type, const std::vector<int>& cell, const std::string& rest = "") {
    std::string list = fmt::format("CELLS 1 {}\n{}", cell.size() + 1, cell.size());
    for (const int v : cell) list += fmt::format(" {}", v);
    return head + "DATASET UNSTRUCTURED_GRID\n" + square + list + fmt::format("\nCELL_TYPES 1\n{}\n", type) + rest;
}

TEST_F(Vtk, CellsOfEveryFlatKindAreRead) {
    EXPECT_EQ(corners(grid(5, {0, 1, 2})), (Corners{a, b, c}));
    EXPECT_EQ(corners(grid(7, {0, 1, 2, 3})), (Corners{a, b, c, a, c, d}));
    EXPECT_EQ(corners(grid(9, {0, 1, 2, 3})), (Corners{a, b, c, a, c, d}));
    EXPECT_EQ(corners(grid(8, {0, 1, 3, 2})), (Corners{a, b, c, a, c, d}));  // VTK_PIXEL counts x before y
    EXPECT_EQ(corners(grid(6, {0, 1, 3, 2})), (Corners{a, b, d, b, c, d}));  // VTK_TRIANGLE_STRIP
    EXPECT_EQ(corners(grid(3, {0, 2})), (Corners{a, c, c}));
    EXPECT_EQ(corners(grid(4, {0, 1, 2})), (Corners{a, b, b, b, c, c}));
    EXPECT_EQ(points(grid(1, {2})), Corners{c});
    EXPECT_EQ(points(grid(2, {2, 0})), (Corners{c, a}));
}

TEST_F(Vtk, PolyDataHasFourLists) {
    const std::string text = poly(
        "VERTICES 1 3\n2 0 1\nLINES 1 3\n2 2 3\nPOLYGONS 1 5\n4 0 1 2 3\n"
        "TRIANGLE_STRIPS 1 5\n4 0 1 3 2\n");
    EXPECT_EQ(corners(text), (Corners{a, a, a, b, b, b, c, d, d, a, b, c, a, c, d, a, b, d, b, c, d}));
    const LoadReport report = load(text).report;
    EXPECT_EQ(report.segments, 1);
    EXPECT_EQ(report.single_points, 2);
    EXPECT_EQ(report.polygons, 1);
    EXPECT_FALSE(report.float32);
    EXPECT_TRUE(report.notes.empty());
    EXPECT_TRUE(report.stated.unit.empty());
}

TEST_F(Vtk, KeywordsAreReadInAnyCaseAndLineEndsOfEveryKind) {
    std::string text =
        "# VTK datafile version 1.0\n\nascii\ndataset polydata\npoints 4 Double\n0 0 0 1 0 0 1 1\n0 0 1 0 "
        "polygons 1 4 3 0\n1 2 cell_data 1 rubbish";
    EXPECT_EQ(corners(text), (Corners{a, b, c}));
    for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 2)) text.insert(at, "\r");
    EXPECT_EQ(corners(text), (Corners{a, b, c}));
}

TEST_F(Vtk, NumbersAreRoundedOnceToTheirType) {
    const auto first = [&](const char* type, const char* word) {
        return points(head + fmt::format("DATASET POLYDATA\nPOINTS 1 {}\n{} 0 0\n", type, word))[0].x();
    };
    EXPECT_EQ(first("double", "0.1"), 0.1);
    EXPECT_EQ(first("float", "0.1"), static_cast<double>(0.1f));
    // Above the middle of two floats by less than half a step of double: rounding twice gives 1.
    EXPECT_EQ(first("float", "1.00000005960464477539062500001"), 1.00000011920928955078125);
    EXPECT_EQ(first("short", "-32768"), -32768);
    EXPECT_EQ(first("unsigned_long", "18446744073709551615"), 0x1p64);
    EXPECT_TRUE(load(head + "DATASET POLYDATA\nPOINTS 1 float\n0 0 0\n").report.float32);
    for (const auto& [type, word] : {std::pair("short", "32768"),
                                     {"unsigned_char", "-1"},
                                     {"int", "1.5"},
                                     {"double", "1,5"},
                                     {"double", "1D0"},
                                     {"float", "0x1"}})
        refused(head + fmt::format("DATASET POLYDATA\nPOINTS 1 {}\n0\n{} 0\n", type, word),
                {"line 7", word, "is not a number of the type of its array"});
}

TEST_F(Vtk, BinaryIsBigEndianAndHasAnyType) {
    const std::string begin = "# vtk DataFile Version 4.2\nt\nBINARY\nDATASET POLYDATA\n";
    const std::string cells = "\nPOLYGONS 1 4\n" + big<std::int32_t>({3, 0, 1, 2}) + "\n";
    const Corners right = {{1, 2, 3}, {10, 2, 3}, {1, 13, 3}};
    const auto check = [&](const char* type, const std::string& bytes) {
        EXPECT_EQ(corners(begin + "POINTS 3 " + type + "\n" + bytes + cells), right) << type;
    };
    check("double", big<double>({1, 2, 3, 10, 2, 3, 1, 13, 3}));
    check("float", big<float>({1, 2, 3, 10, 2, 3, 1, 13, 3}));
    check("int", big<std::int32_t>({1, 2, 3, 10, 2, 3, 1, 13, 3}));  // 10 and 13 are line ends as bytes
    check("long", big<std::int64_t>({1, 2, 3, 10, 2, 3, 1, 13, 3}));
    check("vtktypeint64", big<std::int64_t>({1, 2, 3, 10, 2, 3, 1, 13, 3}));
    check("unsigned_short", big<std::uint16_t>({1, 2, 3, 10, 2, 3, 1, 13, 3}));
    check("char", big<std::int8_t>({1, 2, 3, 10, 2, 3, 1, 13, 3}));
    refused(begin + "POINTS 3 double\n" + big<double>({1, 2, 3, 4}), {"byte", "announces 3 x 3 numbers", "truncated"});
    refused(begin + "POINTS 3 half\n", {"byte", "'half'", "save the file with double"});
    refused(begin + "POINTS 1 float\n" + big<float>({1, 2, 3}) + "POLYGONS 1 4\n" + little<std::int32_t>({3, 0, 0, 0}),
            {"byte", "the lists of corners are damaged: cell 0"});
}

// As of version 5.0: offsets and corners in two arrays, and text blocks METADATA after arrays.
TEST_F(Vtk, Version5HasOffsets) {
    const std::string metadata =
        "METADATA\nCOMPONENT_NAMES\nX\n\nZ\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION "
        "vtkDataArray\nDATA 2 0 1.7 \n\n";
    std::string begin = "# vtk DataFile Version 5.1\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n" + square + metadata;
    EXPECT_EQ(corners(begin + "CELLS 3 7\nOFFSETS vtktypeint64\n0 4 7\nMETADATA\nINFORMATION 0\n\nCONNECTIVITY "
                              "vtktypeint64\n0 1 2 3 0 1 3\nCELL_TYPES 2\n9 5\nMETADATA\n\nPOINT_DATA 4\n"),
              (Corners{a, b, c, a, c, d, a, b, d}));
    refused(begin + "CELLS 3 7\nOFFSETS int\n0 8 7\nCONNECTIVITY int\n0 1 2 3 0 1 3\nCELL_TYPES 2\n9 5\n",
            {"the offsets of its cells are damaged: cell 0", "ends at 8 of 7"});
    refused(begin + "CELLS 3 7\nOFFSETS int\n0 4 6\nCONNECTIVITY int\n0 1 2 3 0 1 3\nCELL_TYPES 2\n9 5\n",
            {"have 6 corners, but 7 are listed"});
    refused(begin + "CELLS 3 7\nOFFSETS int\n1 4 7\nCONNECTIVITY int\n0 1 2 3 0 1 3\nCELL_TYPES 2\n9 5\n",
            {"the first offset is 1"});
    refused(begin + "METADATA\nINFORMATION 0\nCELLS 3 7\nOFFSETS int\n", {"empty line must end METADATA", "CELLS 3 7"});
    refused(begin + "CELLS 3 7\nOFFSETS double\n0 4 7\n", {"must be integers"});
    refused(begin + "CELLS 3 7\nOFFSETS int\n0 4 7\nCELL_TYPES 2\n", {"CONNECTIVITY must follow OFFSETS"});
    begin = "# vtk DataFile Version 5.1\nt\nBINARY\nDATASET POLYDATA\nPOINTS 3 float\n" +
            big<float>({0, 0, 0, 1, 0, 0, 1, 1, 0}) + "\n" + metadata;
    EXPECT_EQ(corners(begin + "POLYGONS 2 3\nOFFSETS vtktypeint64\n" + big<std::int64_t>({0, 3}) +
                      "\nCONNECTIVITY vtktypeint64\n" + big<std::int64_t>({0, 1, 2}) + "\n"),
              (Corners{a, b, c}));
}

TEST_F(Vtk, FieldsBeforeThePointsAreSkipped) {
    const std::string text = "FIELD FieldData 3\nTIME 1 1 double\n0.5\nname 1 2 string\nPOINTS 4 float\n\nNULL_ARRAY\n";
    EXPECT_EQ(corners(head + "DATASET POLYDATA\n" + text + square + "POLYGONS 1 4\n3 0 1 2\n"), (Corners{a, b, c}));
    const std::string binary = "FIELD FieldData 4\nTIME 1 1 double\n" + big<double>({0.5}) +
                               "\nname 1 2 string\n\xc6POINTS" + big<std::uint16_t>({0x8000 + 70}) +
                               std::string(70, '\n') + "\nbits 1 9 bit\nab\nempty 1 0 int\n\n";
    EXPECT_EQ(points("# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\n" + binary + "POINTS 1 double\n" +
                     big<double>({1, 2, 3})),
              (Corners{{1, 2, 3}}));
    refused("# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\nFIELD F 1\nn 1 1 string\n\x3fxxxxxxx",
            {"byte", "truncated"});
    refused(head + "DATASET POLYDATA\nFIELD F 1\nn 4611686018427387904 4 string\nx\n", {"line 6", "truncated"});
    refused(head + "DATASET POLYDATA\nFIELD F 99999999\n", {"truncated"});
}

// The bytes that `measure --fields out.vtk` writes.
TEST_F(Vtk, FilesOfThisProjectAreRead) {
    const auto file = [](int cells, const std::string& list, std::int32_t type) {
        std::string bytes =
            "# vtk DataFile Version 3.0\ndistances of A to B, by hausbench\nBINARY\nDATASET "
            "UNSTRUCTURED_GRID\nPOINTS 3 double\n" +
            big<double>({0, 0, 0, 1, 0, 0, 1, 1, 0}) + fmt::format("\nCELLS {} {}\n", cells, list.size() / 4) + list +
            fmt::format("\nCELL_TYPES {}\n", cells);
        for (int i = 0; i < cells; ++i) bytes += big<std::int32_t>({type});
        return bytes + "\nPOINT_DATA 3\nSCALARS distance double 1\nLOOKUP_TABLE default\n" + big<double>({1, 2, 3}) +
               "\n";
    };
    EXPECT_EQ(corners(file(1, big<std::int32_t>({3, 0, 1, 2}), 5)), (Corners{a, b, c}));
    EXPECT_EQ(points(file(3, big<std::int32_t>({1, 0, 1, 1, 1, 2}), 1)), (Corners{a, b, c}));
}

TEST_F(Vtk, PointsWithoutCellsAreAPointSet) {
    EXPECT_EQ(points(poly("")), (Corners{a, b, c, d}));
    expect_one_note(load(poly("")), {"points and no cells"});
    // An unused point may be NaN, and is reported.
    const LoadedShape loaded =
        load(head + "DATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 1 1 0 nan 0 0\nPOLYGONS 1 4\n3 0 1 2\n");
    EXPECT_EQ(loaded.report.unreferenced, 1);
    refused(head + "DATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 1 1 0 nan 0 0\nPOLYGONS 1 4\n3 0 1 3\n",
            {"vertex 3", "not finite"});
    refused(grid(0, {}), {"none of its cells is a point, a line or a surface"});
    refused(head + "DATASET POLYDATA\n", {"holds no vertices"});
}

TEST_F(Vtk, VolumeCellsAreLeftOutWithANoteOrRefused) {
    const std::string text = head + "DATASET UNSTRUCTURED_GRID\n" + square +
                             "CELLS 3 14\n4 0 1 2 3\n3 0 1 2\n4 0 1 2 99\nCELL_TYPES 3\n10 5 10\n";
    EXPECT_EQ(corners(text), (Corners{a, b, c}));
    expect_one_note(load(text), {"2 volume cells were left out (2 VTK_TETRA)"});
    refused(grid(10, {0, 1, 2, 3}), {"1 VTK_TETRA", "no surface", "Extract Surface"});
    // Lines and points beside volume cells are not their surface.
    refused(head + "DATASET UNSTRUCTURED_GRID\n" + square + "CELLS 2 8\n4 0 1 2 3\n2 0 1\nCELL_TYPES 2\n12 3\n",
            {"1 VTK_HEXAHEDRON", "no surface"});
}

TEST_F(Vtk, CurvedAndUnknownCellsAreRefusedByName) {
    refused(grid(22, {0, 1, 2, 0, 1, 2}), {"cell 0 (from 0)", "VTK_QUADRATIC_TRIANGLE", "curved", "Nonlinear"});
    refused(grid(21, {0, 1, 2}), {"VTK_QUADRATIC_EDGE"});
    refused(grid(69, {0, 1, 2}), {"VTK_LAGRANGE_TRIANGLE"});
    refused(grid(77, {0, 1, 2, 3}), {"VTK_BEZIER_QUADRILATERAL"});
    refused(grid(17, {0, 1, 2}), {"cell 0 (from 0)", "unknown type 17"});
    refused(grid(-5, {0, 1, 2}), {"unknown type -5"});
}

TEST_F(Vtk, DegenerateCellsAreKeptWithANote) {
    const std::string text = poly("LINES 1 2\n1 2\nPOLYGONS 3 6\n2 0 1\n1 3\n0\nTRIANGLE_STRIPS 1 4\n3 0 1 2\n");
    EXPECT_EQ(corners(text), (Corners{c, c, c, a, b, b, d, d, d, a, b, c}));
    expect_one_note(load(text), {"4 cells have fewer corners"});
    refused(grid(5, {0, 1}), {"cell 0", "VTK_TRIANGLE with 2 corners instead of 3"});
    refused(grid(9, {0, 1, 2, 3, 0}), {"VTK_QUAD with 5 corners instead of 4"});
}

TEST_F(Vtk, CellsThatVtkDoesNotShowAreLeftOutWithANote) {
    const std::string begin = head + "DATASET UNSTRUCTURED_GRID\n" + square +
                              "CELLS 3 12\n3 0 1 2\n3 0 1 3\n3 1 2 3\nCELL_TYPES 3\n5 5 5\nCELL_DATA 3\nSCALARS s int\n"
                              "LOOKUP_TABLE default\n1 2 3\n";
    const std::string field = "FIELD FieldData 1\nvtkGhostType 1 3 unsigned_char\n0 32 1\n";
    for (const std::string& ghosts :
         {field, std::string("SCALARS vtkGhostType unsigned_char\nLOOKUP_TABLE default\n0 32 1\n"),
          std::string("COLOR_SCALARS vtkGhostType 1\n0 0.12549 0.00392157\n")}) {
        EXPECT_EQ(corners(begin + ghosts), (Corners{a, b, c})) << ghosts;
        expect_one_note(load(begin + ghosts), {"2 cells were left out", "vtkGhostType"});
    }
    EXPECT_EQ(corners(begin + "FIELD F 1\nvtkGhostType 1 3 unsigned_char\n0 2 16\n").size(), 9u);
    EXPECT_EQ(corners(begin + "POINT_DATA 4\nFIELD F 1\nvtkGhostType 1 4 unsigned_char\n1 1 1 1\n").size(), 9u);
    refused(begin + "POINT_DATA 4\nFIELD F 1\nvtkGhostType 1 4 unsigned_char\n0 0 0 2\n",
            {"cell 1 (from 0) uses point 3", "hides", "Extract Surface"});
    refused(begin + "FIELD F 1\nvtkGhostType 1 4 unsigned_char\n0 0 0 2\n", {"vtkGhostType", "one number for each"});
    refused(begin + field + field, {"second section"});
    refused(begin + "FIELD F 1\nvtkGhostType 1 3 unsigned_char\n32 32 32\n", {"none of its cells"});
}

TEST_F(Vtk, MistakesAreToldWithTheirPlace) {
    refused("solid\n", {"line 1", "not a VTK file"});
    refused("# vtk DataFile Version 6.0\nt\nASCII\n", {"line 1", "'6.0'"});
    refused("# vtk DataFile Version 3.0\nt\nUTF8\n", {"line 3", "ASCII or BINARY"});
    refused(head + "POINTS 3 float\n", {"line 4", "DATASET"});
    for (const char* kind : {"STRUCTURED_GRID", "RECTILINEAR_GRID", "STRUCTURED_POINTS", "FIELD", "TABLE"})
        refused(head + fmt::format("DATASET {}\nDIMENSIONS 2 2 1\n", kind), {"line 4", kind, "ParaView"});
    refused(poly("POLYGONS 1 4\n3 0 1 4\n"), {"cell 0 (from 0) names point 4 (from 0), but there are 4"});
    refused(poly("POLYGONS 1 4\n3 0 1 -1\n"), {"names point -1"});
    refused(poly("POLYGONS 1 4\n3 0\n1 x\n"), {"line 9", "'x'"});
    refused(poly("POLYGONS 1 4\n3 0 1"), {"truncated"});
    refused(poly("POLYGONS x 4\n3 0 1 2"), {"line 7", "'x' is not the number of cells"});
    refused(poly("POLYGONS 1 5\n3 0 1 2 0\n"), {"1 cells take 4 of 5 numbers"});
    refused(poly("POLYGONS 1 4\n-1 0 1 2\n"), {"cell 0 (from 0) of 1 does not fit"});
    refused(poly("POLYGONS 1 4\n3 0 1 2\nPOLYGONS 1 4\n3 0 1 2\n"), {"line 9", "second section"});
    refused(poly("CELLS 1 4\n3 0 1 2\n"), {"line 7", "'CELLS' is not the name of a section"});
    refused(poly("POLYGONS 1 4\n3 0 1 2 3\n"), {"line 8", "'3' is not the name of a section"});
    const std::string cells = head + "DATASET UNSTRUCTURED_GRID\n" + square + "CELLS 1 4\n3 0 1 2\n";
    refused(cells, {"1 cells", "the types of 0"});
    refused(cells + "CELL_TYPES 2\n5 5\n", {"1 cells", "the types of 2"});
    for (const char* counts : {"POINTS 99999999999999 float\n", "POINTS 18446744073709551615 double\n"})
        refused(head + "DATASET POLYDATA\n" + counts, {"line 5", "announces"});
    refused(poly("POLYGONS 9999999999 9999999999\n3 0 1 2\n"), {"line 7", "announces"});
    refused(poly("POLYGONS 9999999999 4\n3 0 1 2\n"), {"cell 1 (from 0) of 9999999999"});
}

TEST_F(Vtk, TruncatedBinaryFilesAreRefused) {
    const std::string whole = "# vtk DataFile Version 5.1\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 double\n" +
                              big<double>({0, 0, 0, 1, 0, 0, 1, 1, 0}) + "\nCELLS 2 3\nOFFSETS vtktypeint64\n" +
                              big<std::int64_t>({0, 3}) + "\nCONNECTIVITY vtktypeint64\n" +
                              big<std::int64_t>({0, 1, 2}) + "\nCELL_TYPES 1\n" + big<std::int32_t>({5});
    EXPECT_EQ(corners(whole), (Corners{a, b, c}));
    const std::size_t cells = whole.find("\nCELLS") + 2;  // before, the points may be all that the file has
    for (std::size_t size = cells; size < whole.size(); ++size) refused(whole.substr(0, size), {});
}

// How an XML file stores its arrays.
struct Storage {
    std::string format = "ascii";
    bool zlib = false, base64 = true, big_endian = false, header64 = false;
};

// Writes XML files as VTK does.
class XmlFile {
public:
    explicit XmlFile(Storage storage) : storage_(std::move(storage)) {}

    template <class T>
    std::string array(const std::string& attributes, const std::string& type, const std::vector<T>& values) {
        const std::string begin =
            fmt::format("<DataArray {} type=\"{}\" format=\"{}\"", attributes, type, storage_.format);
        if (storage_.format == "ascii") {
            std::string text;
            for (const T value : values) text += fmt::format(" {}\n", value);
            return begin + ">" + text + "<InformationKey><Value>5</Value></InformationKey></DataArray>\n";
        }
        std::string bytes;
        for (const T value : values) bytes += stored(value, storage_.big_endian);
        const std::string encoded = storage_.zlib ? packed(bytes) : code(number(bytes.size()) + bytes);
        if (storage_.format == "binary") return begin + ">\n  " + encoded + "\n</DataArray>\n";
        const std::size_t offset = appended_.size();
        appended_ += encoded;
        return fmt::format("{} offset=\"{}\"/>\n", begin, offset);
    }

    std::string file(const std::string& type, const std::string& pieces) const {
        return fmt::format(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{0}\" version=\"1.0\" byte_order=\"{1}Endian\" "
            "header_type=\"UInt{2}\"{3}>\n<{0}>\n{4}</{0}>\n{5}</VTKFile>\n",
            type, storage_.big_endian ? "Big" : "Little", storage_.header64 ? 64 : 32,
            storage_.zlib ? " compressor=\"vtkZLibDataCompressor\"" : "", pieces,
            storage_.format == "appended" ? fmt::format("<AppendedData encoding=\"{}\">\n  _{}\n</AppendedData>\n",
                                                        storage_.base64 ? "base64" : "raw", appended_)
                                          : "");
    }

private:
    std::string number(std::size_t value) const {
        return storage_.header64 ? stored(static_cast<std::uint64_t>(value), storage_.big_endian)
                                 : stored(static_cast<std::uint32_t>(value), storage_.big_endian);
    }
    std::string code(const std::string& bytes) const {
        return storage_.base64 || storage_.format == "binary" ? base64(bytes) : bytes;
    }
    // Blocks of 16 bytes; the last may be smaller.
    std::string packed(const std::string& bytes) const {
        constexpr std::size_t block = 16;
        std::string sizes, blocks;
        for (std::size_t i = 0; i < bytes.size(); i += block) {
            const std::string compressed = deflated(bytes.substr(i, block));
            sizes += number(compressed.size());
            blocks += compressed;
        }
        return code(number((bytes.size() + block - 1) / block) + number(block) + number(bytes.size() % block) + sizes) +
               code(blocks);
    }

    Storage storage_;
    std::string appended_;
};

std::string grid_piece(XmlFile& file, double shift = 0) {
    std::string text = "<Piece NumberOfPoints=\"4\" NumberOfCells=\"2\">\n<Points>" +
                       file.array<double>("Name=\"Points\" NumberOfComponents=\"3\"", "Float64",
                                          {shift, 0, 0, 1 + shift, 0, 0, 1 + shift, 1, 0, shift, 1, 0}) +
                       "</Points>\n<Cells>";
    text += file.array<std::int64_t>("Name=\"connectivity\"", "Int64", {0, 1, 3, 2, 0, 1, 2});
    text += file.array<std::int32_t>("Name=\"offsets\"", "Int32", {4, 7});
    return text + file.array<std::uint16_t>("Name=\"types\"", "UInt16", {8, 5}) + "</Cells>\n</Piece>\n";
}

std::vector<Storage> all_storages() {
    std::vector<Storage> all = {{}};
    for (const bool zlib : {false, true})
        for (const bool big_endian : {false, true})
            for (const bool header64 : {false, true}) {
                all.push_back({"binary", zlib, true, big_endian, header64});
                all.push_back({"appended", zlib, true, big_endian, header64});
                all.push_back({"appended", zlib, false, big_endian, header64});
            }
    return all;
}

TEST_F(Vtk, XmlIsReadInEveryEncoding) {
    for (const Storage& storage : all_storages()) {
        XmlFile file(storage);
        const std::string piece = grid_piece(file);
        EXPECT_EQ(corners("a.vtu", file.file("UnstructuredGrid", piece)), (Corners{a, b, c, a, c, d, a, b, c}))
            << storage.format << storage.zlib << storage.base64 << storage.big_endian << storage.header64;
    }
}

TEST_F(Vtk, AllPiecesAreRead) {
    const Vec3 right(2, 0, 0);
    for (const Storage& storage : all_storages()) {
        XmlFile file(storage);
        std::string pieces = grid_piece(file);
        pieces += grid_piece(file, 2);
        const LoadedShape loaded = load("a.vtu", file.file("UnstructuredGrid", pieces));
        EXPECT_EQ(loaded.report.objects, 2);
        EXPECT_EQ(corners("a.vtu", file.file("UnstructuredGrid", pieces)),
                  (Corners{a, b, c, a, c, d, a, b, c, a + right, b + right, c + right, a + right, c + right, d + right,
                           a + right, b + right, c + right}));
    }
}

// A PolyData file as text, with the elements of its piece.
std::string vtp(const std::string& counts, const std::string& elements) {
    return fmt::format(
        "<VTKFile type=\"PolyData\" version=\"0.1\">\n<PolyData>\n<Piece NumberOfPoints=\"4\" {}>\n"
        "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">0 0 0 1 0 0 1 1 0 0 1 "
        "0</DataArray></Points>\n{}</Piece>\n</PolyData>\n</VTKFile>\n",
        counts, elements);
}
std::string list(const char* element, const char* offsets, const char* connectivity) {
    return fmt::format(
        "<{0}><DataArray type=\"Int32\" Name=\"connectivity\">{2}</DataArray>\n<DataArray "
        "type=\"Int32\" Name=\"offsets\">{1}</DataArray></{0}>\n",
        element, offsets, connectivity);
}

TEST_F(Vtk, XmlPolyDataHasFourLists) {
    const std::string text = vtp("NumberOfVerts=\"1\" NumberOfLines=\"1\" NumberOfStrips=\"1\" NumberOfPolys=\"2\"",
                                 list("Strips", "4", "0 1 3 2") + list("Verts", "2", "0 1") +
                                     list("Lines", "2", "2 3") + list("Polys", "4 7", "0 1 2 3 0 1 2"));
    EXPECT_EQ(corners("a.vtp", text),
              (Corners{a, a, a, b, b, b, c, d, d, a, b, c, a, c, d, a, b, c, a, b, d, b, c, d}));
    EXPECT_TRUE(load("a.vtp", text).report.float32);
    EXPECT_EQ(points("a.vtp", vtp("", "")), (Corners{a, b, c, d}));
    expect_one_note(load("a.vtp", vtp("", "")), {"points and no cells"});
}

TEST_F(Vtk, XmlCellsThatVtkDoesNotShowAreLeftOut) {
    const auto with = [](const std::string& data) {
        return vtp("NumberOfPolys=\"2\"", list("Polys", "3 6", "0 1 2 0 1 3") + data);
    };
    const auto cell_data = [](const char* name, const char* values) {
        return fmt::format("<CellData><DataArray type=\"UInt8\" Name=\"{}\">{}</DataArray></CellData>\n", name, values);
    };
    EXPECT_EQ(corners("a.vtp", with(cell_data("vtkGhostType", "0 32"))), (Corners{a, b, c}));
    EXPECT_EQ(corners("a.vtp", with(cell_data("vtkGhostLevels", "0 2"))), (Corners{a, b, c}));
    expect_one_note(load("a.vtp", with(cell_data("vtkGhostType", "8 0"))), {"1 cell was left out"});
    EXPECT_EQ(corners("a.vtp", with(cell_data("other", "32 32"))).size(), 6u);
    refused("a.vtp", with("<PointData><DataArray type=\"UInt8\" Name=\"vtkGhostType\">0 0 0 2</DataArray></PointData>"),
            {"cell 1 (from 0) uses point 3", "hides"});
    refused("a.vtp", with(cell_data("vtkGhostType", "0")), {"line 7", "'vtkGhostType' has 1 numbers instead of 2"});
}

TEST_F(Vtk, XmlThatIsNotReadIsToldWithItsPlace) {
    const auto whole = [](const std::string& attributes, const std::string& inside = "<PolyData/>") {
        return "<VTKFile " + attributes + ">\n" + inside + "</VTKFile>";
    };
    const std::string poly_data = "type=\"PolyData\" version=\"1.0\" ";
    for (const char* compressor : {"vtkLZ4DataCompressor", "vtkLZMADataCompressor"})
        refused("a.vtp", whole(poly_data + fmt::format("compressor=\"{}\"", compressor)),
                {"line 1", compressor, "save it with zlib"});
    refused("a.vtp", whole("type=\"ImageData\" version=\"1.0\""), {"line 1", "ImageData", "Extract Surface"});
    refused("a.vtp", whole("type=\"PPolyData\" version=\"1.0\""), {"PPolyData", "files of its pieces"});
    refused("a.vtp", whole("type=\"PolyData\" version=\"3.0\""), {"'3.0'"});
    refused("a.vtp", whole(poly_data + "byte_order=\"Middle\""), {"'Middle'"});
    refused("a.vtp", whole(poly_data + "header_type=\"UInt16\""), {"'UInt16'"});
    refused("a.vtp", whole(poly_data, "<PolyData TimeValues=\"0 1\"/>"), {"line 2", "several time steps"});
    refused("a.vtp", whole(poly_data, "<PolyData/><PolyData/>"), {"2 elements <PolyData>"});
    refused("a.vtp", whole(poly_data), {"holds no vertices"});
    refused("a.vtp", "<svg/>", {"<svg>"});
    const std::string array = "<DataArray type=\"Float32\" TimeStep=\"0\">0 0 0</DataArray>";
    refused("a.vtp",
            whole(poly_data,
                  "<PolyData><Piece NumberOfPoints=\"1\"><Points>" + array + array + "</Points></Piece></PolyData>"),
            {"several time steps"});
    XmlFile file({});
    std::string curved = file.file("UnstructuredGrid", grid_piece(file));
    curved.replace(curved.find(" 5\n"), 2, " 22");
    refused("a.vtu", curved, {"cell 1 (from 0)", "VTK_QUADRATIC_TRIANGLE"});
    curved.replace(curved.find(" 22\n"), 3, " 10");
    expect_one_note(load("a.vtu", curved), {"1 volume cell was left out (1 VTK_TETRA)"});
}

TEST_F(Vtk, XmlMistakesAreToldWithTheirPlace) {
    const std::string one_polygon = "NumberOfPolys=\"1\"";
    refused("a.vtp", vtp(one_polygon, ""), {"line 3", "no <Polys>"});
    refused("a.vtp", vtp(one_polygon, "<Polys/>"), {"line 5", "Name=\"offsets\""});
    refused("a.vtp", vtp(one_polygon, list("Polys", "3", "0 1 4")),
            {"cell 0 (from 0) names point 4 (from 0), but there are 4"});
    refused("a.vtp", vtp(one_polygon, list("Polys", "3", "0 1 -1")), {"names point -1"});
    refused("a.vtp", vtp(one_polygon, list("Polys", "3", "0 0<!-- -->1 2")), {"line 5", "a comment or CDATA section"});
    EXPECT_EQ(corners("a.vtp", vtp(one_polygon, list("Polys", "3", "0 1<!-- --> 2"))).size(), 3u);
    refused("a.vtp", vtp(one_polygon, list("Polys", "3", "0 1 2") + list("Polys", "3", "0 1 3")),
            {"line 7", "a second <Polys> in one <Piece>"});
    refused("a.vtp", vtp(one_polygon + " NumberOfPolys=\"0\"", list("Polys", "3", "0 1 2")),
            {"line 3", "the attribute 'NumberOfPolys' twice"});
    refused("a.vtp", vtp(one_polygon, list("Polys", "3", "0 1")),
            {"line 5", "'connectivity' has 2 numbers instead of 3"});
    refused("a.vtp", vtp(one_polygon, list("Polys", "3 6", "0 1 2")),
            {"line 6", "'offsets' has 2 numbers instead of 1"});
    refused("a.vtp", vtp(one_polygon, list("Polys", "-3", "0 1 2")), {"last offset is -3"});
    refused("a.vtp", vtp(one_polygon, list("Polys", "999999999999", "0 1 2")),
            {"'999999999999' is not a number of the type Int32"});
    refused("a.vtp", vtp("NumberOfPolys=\"2\"", list("Polys", "4 3", "0 1 2")), {"offsets of its cells are damaged"});
    refused("a.vtp", vtp("", list("Polys", "3", "0 1 2")), {"line 3", "no attribute NumberOfPolys"});
    refused("a.vtp", vtp("NumberOfPolys=\"-1\"", ""), {"NumberOfPolys"});
    refused("a.vtp", vtp("NumberOfPolys=\"99999999999999999\"", list("Polys", "3", "0 1 2")), {"instead of"});
    std::string text = vtp(one_polygon, list("Polys", "3", "0 1 2"));
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string copy = text;
        return copy.replace(copy.find(from), from.size(), to);
    };
    EXPECT_EQ(corners("a.vtp", text), (Corners{a, b, c}));
    refused("a.vtp", changed("NumberOfPoints=\"4\"", "NumberOfPoints=\"5\""), {"has 12 numbers instead of 15"});
    refused("a.vtp", changed("NumberOfPoints=\"4\"", "NumberOfPoints=\"6148914691236517206\""), {"too large"});
    refused("a.vtp", changed("NumberOfPoints=\"4\"", ""), {"NumberOfPoints"});
    refused("a.vtp", changed("NumberOfComponents=\"3\"", "NumberOfComponents=\"2\""), {"line 4", "2 components"});
    refused("a.vtp", changed("Float32", "Float16"), {"line 4", "'Float16'"});
    refused("a.vtp", changed("Int32\" Name=\"conn", "Float32\" Name=\"conn"), {"must have integers"});
    refused("a.vtp", changed("0 0 0", "0 x 0"), {"line 4", "'x' is not a number of the type Float32"});
    refused("a.vtp", changed("type=\"Float32\"", "type=\"Float32\" format=\"hex\""), {"'hex'"});
    refused("a.vtp", changed("type=\"Float32\"", "type=\"Float32\" format=\"appended\" offset=\"0\""),
            {"no <AppendedData>"});
    refused("a.vtp", text.substr(0, text.size() - 12), {"is not XML"});
}

TEST_F(Vtk, DamagedXmlDataAreRefused) {
    for (const Storage& storage : all_storages()) {
        if (storage.format != "appended") continue;
        XmlFile file(storage);
        const std::string piece = grid_piece(file);
        const std::string text = file.file("UnstructuredGrid", piece);
        const std::size_t begin = text.find('_', text.find("<AppendedData")) + 1, end = text.rfind("\n</AppendedData");
        // Without the last bytes, and without the first byte.
        refused("a.vtu", text.substr(0, end - 5) + text.substr(end), {"line 9", "'types'"});
        refused("a.vtu", text.substr(0, begin) + text.substr(begin + 1), {"line 5"});
        refused("a.vtu", text.substr(0, end), {"its appended data do not end"});
        refused("a.vtu", text.substr(0, begin - 1) + text.substr(begin), {"underscore"});
        std::string beyond = text;
        beyond.replace(beyond.find("offset=\"0\""), 10, "offset=\"99999\"");
        refused("a.vtu", beyond, {"line 5", "offset 99999 is beyond"});
        std::string encoding = text;
        encoding.replace(encoding.find("encoding=\""), 10, "encoding=\"x");
        refused("a.vtu", encoding, {"unknown encoding"});
    }
}

TEST_F(Vtk, SizesThatNoMemoryHoldsAreRefused) {
    // A header of compressed data that announces 2^40 bytes in one block.
    const std::string header = little<std::uint64_t>({1, 3 * 8ull << 37, 0, 11}) + deflated("abc");
    const std::string text =
        "<VTKFile type=\"PolyData\" version=\"1.0\" header_type=\"UInt64\" "
        "compressor=\"vtkZLibDataCompressor\"><PolyData><Piece NumberOfPoints=\"{}\"><Points>"
        "<DataArray type=\"Float64\" format=\"binary\">{}</DataArray></Points></Piece></PolyData>"
        "</VTKFile>";
    refused("a.vtp", fmt::format(fmt::runtime(text), 1ull << 37, base64(header)), {"too large"});
    // A block of more than 1032 times its compressed size.
    const std::string block = little<std::uint64_t>({1, 24 * 4000, 0, 11}) + deflated("abc");
    refused("a.vtp", fmt::format(fmt::runtime(text), 4000, base64(block)), {"truncated or damaged"});
    // Many pieces that share one array.
    XmlFile file({"appended", false, false, false, false});
    std::string piece = "<Piece NumberOfPoints=\"1000\"><Points>" +
                        file.array<double>("NumberOfComponents=\"3\"", "Float64", std::vector<double>(3000, 1.0)) +
                        "</Points></Piece>\n";
    std::string pieces;
    for (int i = 0; i < 8; ++i) pieces += piece;
    EXPECT_EQ(points("a.vtp", file.file("PolyData", pieces)).size(), 8000u);
    for (int i = 0; i < 92; ++i) pieces += piece;
    refused("a.vtp", file.file("PolyData", pieces), {"the arrays of the file overlap"});
}

}  // namespace
}  // namespace hausbench
