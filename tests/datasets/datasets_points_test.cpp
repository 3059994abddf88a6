// Point clouds, as lines of decimal numbers (.xyz, .pts, .csv) and PCD: valid files and every kind of damage.
#include "datasets/load.h"
#include "tests/support/reading.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#ifdef HAUSBENCH_HAS_LZF
#include <liblzf/lzf.h>
#endif

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace hausbench {
namespace {

using Rows = std::vector<std::array<double, 3>>;

class PointFiles : public Reading {
protected:
    PointFiles() : Reading("a.xyz") {}

    void reads(const std::string& name, const std::string& bytes, const Rows& expected,
               const LoadOptions& options = {}) const {
        const LoadedShape loaded = load(name, bytes, options);
        ASSERT_EQ(kind_of(loaded.shape), ShapeKind::points) << bytes;
        const Points& points = points_of(loaded.shape);
        ASSERT_EQ(points.rows(), Eigen::Index(expected.size())) << bytes;
        for (std::size_t i = 0; i < expected.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_EQ(points(Eigen::Index(i), Eigen::Index(k)), expected[i][k]) << bytes << ": " << i << ", " << k;
        EXPECT_EQ(loaded.report.precision, "float64");
    }
};

template <class T> void put(std::string& bytes, T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

TEST_F(PointFiles, LinesOfNumbers) {
    const Rows two = {{1, -2.5, 3e-3}, {4, 5, 6}};
    for (const std::string name : {"a.xyz", "a.pts", "a.csv", "A.XYZ"}) {
        reads(name, "1 -2.5 3e-3\n4 5 6\n", two);
        reads(name, "1\t-2.5\t3e-3\r\n4\t5\t6", two);
        reads(name, "\xef\xbb\xbf# x y z\n\n  +1, -2.5 ,3e-3 # here\n// no more\n4,5,6\n", two);
        reads(name, "x;y;z;i;r\r1;-2.5;3e-3;0.5;255\r4;5;6;0.5;255\r", two);  // old line ends
        reads(name, "1 -2.5 3e-3\r4 5 6\r\n", two);                           // the same file, saved again
        reads(name, "\"1\";\"-2.5\";3e-3;\n4;5;6;;\n", two);                  // quotes, and separators at the end
    }
    for (const std::string name : {"a.xyzn", "a.xyzrgb"}) {
        reads(name, "1 -2.5 3e-3 nan nan nan\n4 5 6 nan nan nan\n", two);  // unknown normals
        reads(name, "1 -2.5 3e-3\n4 5 6\n", two);
        refused(name, "1 2 3 4\n", {"line 1: 4 columns, and nothing names them"});
        refused(name, "1 2 3 4 5 6\n1 2 3 4 5\n", {"line 2: 5 columns, and the first point has 6"});
        refused(name, "1 2 3\n1 2 3 4 5 6\n", {"line 2: 6 columns"});
    }
}

TEST_F(PointFiles, EveryDigitCounts) {
    // Halfway cases, a subnormal and the largest double must be rounded as strtod rounds them.
    const std::vector<std::string> hard = {
        "9007199254740993",       "0.1", "2.2250738585072011e-308", "4.9e-324", "1e-400",
        "1.7976931348623157e308", "-0",  "0.30000000000000004441",  "8.41e21"};
    for (const std::string& text : hard) {
        const double value = std::strtod(text.c_str(), nullptr);
        reads("a.xyz", fmt::format("{} {} 1\n", text, text), {{value, value, 1}});
    }
}

TEST_F(PointFiles, CountLines) {
    reads("a.pts", "2\n1 2 3 -5 10 20 30\n4 5 6 -5 10 20 30\n", {{1, 2, 3}, {4, 5, 6}});
    reads("a.pts", "1\n1 2 3\n2\n4 5 6\n7 8 9\n", {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}});  // two scans in one file
    reads("a.xyz", "1\n1 2 3\n", {{1, 2, 3}});
    refused("a.pts", "3\n1 2 3\n4 5 6\n", {"is truncated", "line 1 announces 3 points, and 2 are there"});
    refused("a.pts", "1\n1 2 3\n4 5 6\n", {"line 3", "another point, though line 1 announces 1"});
    refused("a.pts", "2\n1 2 3\n2\n4 5 6\n", {"line 3", "1 column, and a point"});
    refused("a.pts", "1 2 3 -5 10 20 30\n", {"line 1: 7 columns", "--columns 1,2,3"});  // no count line
    refused("a.csv", "2\n1,2,3\n", {"line 1", "1 column"});
}

TEST_F(PointFiles, HeadersOfColumns) {
    const Rows point = {{1, 2, 3}};
    reads("a.csv", "x,y,z\n1,2,3\n", point);
    reads("a.csv", "id;\"Z\";\"Y\";\"X\"\n7;3;2;1\n", point);
    reads("a.csv", "//X,Y,Z,Intensity\n1,2,3,9\n", point);  // as CloudCompare writes it
    reads("a.csv", "//Intensity,X,Y,Z\n9,1,2,3\n", point);
    reads("a.csv", "//X,Y,Z,R\n1\n1,2,3,9\n", point);
    reads("a.asc", "//X Y Z R G B\n1\n1 2 3 4 5 6\n", point);
    reads("a.csv", "easting,northing,height\n1,2,3\n", point);
    reads("a.xyz", "X Y Z R G B\n1 2 3 4 5 6\n", point);
    reads("a.csv", "x,y,z\n1,2,3,\n", point);
    reads("a.csv", ",x,y,z\n0,1,2,3\n", point);                      // pandas, with its index
    reads("a.csv", "\"\",\"x\",\"y\",\"z\"\n\"1\",1,2,3\n", point);  // R, with the names of rows
    reads("a.txt", "\tx\ty\tz\n0\t1\t2\t3\n", point);
    reads("a.csv", "sep=;\nx;y;z\n1;2;3\n", point);
    reads("a.csv", "name,x,y,z\n\"a,7,8,9,b\",1,2,3\n", point);
    reads("a.csv", "name,x,y,z\n\"a \"\"b\"\", # c\",1,2,3\n", point);
    refused("a.csv", "x,y,height\n1,2,3\n", {"line 1", "names only some of x, y and z", "--columns"});
    refused("a.csv", "1.0.0,2,3\n4,5,6\n", {"line 1", "'1.0.0'"});  // a bad number, not a header
    refused("a.csv", "id,z,y,x\n7,3,2\n", {"line 2", "column 4 (x) is missing"});
    refused("a.csv", "x,y,z\nx,y,z\n", {"line 2", "column 1 (x) is 'x', which is not a number"});
    refused("a.csv", "x,y,z\n", {"holds no vertices"});
    refused("a.csv", "x,y,z\n1,2,3\n1,5,2,0,3,0\n",
            {"line 3: 6 columns, and the header names 3", "decimals with a point"});
    refused("a.csv", "name,x,y,z\na,7,8,9,b,1,2,3\n", {"line 2: 8 columns, and the header names 4"});
    refused("a.csv", "x,y,z\n\"1,2,3\n", {"line 2", "quoted field", "does not end"});
    refused("a.txt", "x y z\n1 7 8 9\n", {"line 2: 4 columns, and the header names 3"});  // write.table of R
    refused("a.txt", "x y z w\n1 2 3\n", {"line 2: 3 columns, and the header names 4"});  // which value is missing?
    refused("a.csv", "a,b,c\n1,2,3\n", {"line 1", "names none of x, y and z ('a', 'b', 'c')", "--columns"});
    refused("a.csv", ",0,1,2\n0,1,2,3\n", {"names none of x, y and z"});  // pandas, without names
}

TEST_F(PointFiles, NamesOfCoordinates) {
    for (const std::string names :
         {"x,y,z", "X,Y,Z", "px,py,pz", "pos_x,pos_y,pos_z", "position.x,position.y,position.z",
          "coord x,coord y,coord z", "X coordinate,Y coordinate,Z coordinate", "Points:0,Points:1,Points:2",
          "Points_0,Points_1,Points_2", "point_x,point_y,point_z", "East,North,Up", "Easting,Northing,Elevation",
          "easting,northing,altitude", "easting,northing,z", "X/East,Y/North,Z/Altitude",
          "\"x [mm]\",\"y [mm]\",\"z [mm]\"", "x(m),y(m),z(m)", "x_mm,y_mm,z_mm"}) {
        const auto reversed = [&] {
            const std::size_t first = names.find(','), second = names.rfind(',');
            return names.substr(second + 1) + ",id," + names.substr(first + 1, second - first - 1) + "," +
                   names.substr(0, first);
        };
        reads("a.csv", "id," + names + "\n9,1,2,3\n", {{1, 2, 3}});
        reads("a.csv", reversed() + "\n3,9,2,1\n", {{1, 2, 3}});
        reads("a.csv", "# " + reversed() + "\n3,9,2,1\n", {{1, 2, 3}});
    }
    reads("a.txt", "id x [mm] y [mm] z [mm]\n9 1 2 3\n", {{1, 2, 3}});
    reads("a.txt", "X coordinate\tY coordinate\tZ coordinate\n1\t2\t3\n", {{1, 2, 3}});
    reads("a.csv", "nx,ny,nz,x,y,z\n9,9,9,1,2,3\n", {{1, 2, 3}});  // normals
    reads("a.csv", "lat,lon,x,y,z\n9,9,1,2,3\n", {{1, 2, 3}});
    for (const std::string names :
         {"x,y,z,px,py,pz", "x,y,z,X,Y,Z", "x,y,z,x,q,q", "x,y,z,easting,northing,up", "east,north,up,height,q,q"})
        refused("a.csv", names + "\n1,2,3,4,5,6\n", {"line 1", "more than once", "--columns"});
    for (const std::string names : {"x,py,z", "east,y,z", "x,y,elevation", "height,width,depth"})
        refused("a.csv", names + "\n1,2,3\n", {"line 1", "names only some of x, y and z"});
    for (const std::string names : {"lat,lon,height", "Longitude,Latitude,Altitude", "# lat lon h"})
        refused("a.txt", names + "\n1 2 3\n", {"line 1", "angles"});
    const auto notes = load("a.csv", "ID,Easting,Northing,Height\n9,1,2,3\n").report.notes;
    EXPECT_EQ(
        notes,
        (std::vector<std::string>{"x is column 2 ('Easting'), y column 3 ('Northing') and z column 4 ('Height')"}));
    EXPECT_TRUE(load("a.csv", "id,z,y,x\n9,1,2,3\n").report.notes.empty());
}

TEST_F(PointFiles, UnitsOfColumns) {
    const auto stated = [&](const std::string& names) { return load("a.csv", names + "\n1,2,3\n").report.stated; };
    EXPECT_EQ(stated("x [mm],y [mm],z [mm]").micrometres, 1000);
    EXPECT_EQ(stated("X(m),Y(metre),Z(M)").unit, "m");
    EXPECT_EQ(stated("x_inch,y_inch,z_inch").micrometres, 25400);
    EXPECT_EQ(stated("x,y,z").micrometres, 0);
    refused("a.csv", "x [m],y [m],z [ft]\n1,2,3\n", {"line 1", "'m', 'm' and 'ft'", "--columns"});
    refused("a.csv", "x [m],y [m],z\n1,2,3\n", {"line 1", "differ: 'm', 'm' and ''"});
    const LoadedShape chosen = load("a.csv", "x [m],y [m],z [ft]\n1,2,3\n", {.columns = "1,2,3"});
    EXPECT_EQ(chosen.report.stated.micrometres, 0);
    EXPECT_EQ(chosen.report.notes,
              (std::vector<std::string>{"the units of x, y and z differ: 'm', 'm' and 'ft'; the numbers count"}));
    EXPECT_EQ(load("a.csv", "a [m],b [m],c [m]\n1,2,3\n", {.columns = "a,b,c"}).report.stated.unit, "m");
}

TEST_F(PointFiles, ColumnsThatTheUserChose) {
    const Rows point = {{1, 2, 3}};
    reads("a.csv", "7,1,2,3,IP\n", point, {.columns = "2,3,4"});
    reads("a.csv", "7,1,2,3,\"a;b, c\"\n", point, {.columns = "2,3,4"});
    reads("a.txt", "3 2 1\n", point, {.columns = "3, 2, 1"});
    reads("a.csv", "E,N,H,x,y,z\n1,2,3,4,5,6\n", point, {.columns = "E,N,H"});
    reads("a.csv", "E,N,H,x,y,z\n1,2,3,4,5,6\n", point, {.columns = "1,2,3"});
    reads("a.csv", "e [m],n [m],h [m]\n1,2,3\n", point, {.columns = "E,N,H"});
    reads("a.csv", "x,y,z,X,Y,Z\n9,9,9,1,2,3\n", point, {.columns = "X,Y,Z"});
    reads("a.txt", "# q E N H\n9 1 2 3\n", point, {.columns = "E,N,H"});
    reads("a.txt", "x y z\n9 1 2 3\n", point, {.columns = "2,3,4"});  // write.table of R
    reads("a.csv", ",0,1,2\n0,1,2,3\n", point, {.columns = "2,3,4"});
    const std::string names = "id,E,N,H\n9,1,2,3\n";
    refused("a.csv", names, {"line 1", "no column is named 'Q', only 'id', 'E', 'N', 'H'"}, {.columns = "E,N,Q"});
    refused("a.csv", names, {"column 5", "there are 4", "'id', 'E'"}, {.columns = "3,4,5"});
    refused("a.csv", names, {"column 0", "count from 1"}, {.columns = "0,1,2"});
    refused("a.csv", names, {"'2,3' does not name three columns"}, {.columns = "2,3"});
    refused("a.csv", names, {"names a column twice"}, {.columns = "2,3,3"});
    refused("a.csv", names, {"names a column twice"}, {.columns = "E,N,e"});
    refused("a.csv", "Ee,EE,n,h\n1,2,3,4\n", {"line 1: 2 columns are named 'ee'"}, {.columns = "ee,n,h"});
    refused("a.csv", "9,1,2,3\n", {"no header", "2,3,4"}, {.columns = "E,N,H"});
    refused("a.csv", "9,1,2,3\n9,1\n", {"line 2", "2 columns, and a point needs"}, {.columns = "2,3,4"});
    refused("a.csv", "9,1,2,3\n9,1,x,3\n", {"line 2", "column 3 (y) is 'x'"}, {.columns = "2,3,4"});
}

TEST_F(PointFiles, ColumnsWithoutNamesAreNotGuessed) {
    for (const std::string name : {"a.xyz", "a.txt", "a.asc", "a.csv", "a.pts"}) {
        refused(name, "1 2 3 4 5 6\n", {"line 1: 6 columns, and nothing names them ('1 2 3 4 5 6')", "--columns"});
        refused(name, "1 2 3\n1 2 3 4\n", {"line 2: 4 columns"});
    }
    refused("a.csv", "1,5000.25,2000.5,101.125,IP\n", {"'1,5000.25,2000.5,101.125,IP'", "columns=\"2,3,4\""});
    reads("a.txt", "# made by a program on some day\n1 2 3\n", {{1, 2, 3}});
    reads("a.txt", "# the x y z of it\n1 2 3\n", {{1, 2, 3}});
    reads("a.txt", "# columns: z y x\n1 2 3\n", {{3, 2, 1}});
    refused("a.txt", "# y x height\n1 2 3\n", {"line 1", "names only some"});
    EXPECT_EQ(load("a.csv", "0,1,2\n5,6,7\n").report.notes,
              (std::vector<std::string>{"line 1 ('0,1,2') counts as a point: delete it if it numbers the columns"}));
    const std::string water = "2\nwater 1 2\nO 0 0 0\nH 0 0 1\n";
    refused("a.xyz", water, {"molecule", "--columns 2,3,4"});
    reads("a.xyz", water, {{0, 0, 0}, {0, 0, 1}}, {.columns = "2,3,4"});
    reads("a.xyz", "1\n\nO 0 0 0\n", {{0, 0, 0}}, {.columns = "2,3,4"});
    refused("a.xyz", water + water, {"line 5", "second frame"}, {.columns = "2,3,4"});
}

TEST_F(PointFiles, MissingMeasurements) {
    for (const std::string none :
         {"", "NA", "nan", "NaN", "N/A", "#N/A", "null", "-1.#IND", "1.#QNAN", "inf", "-inf"}) {
        const std::string text = "x,y,z\n1,2,3\n4," + none + ",6\n7,8,9\n";
        refused("a.csv", text, {"line 3", "not finite", "--drop-invalid"});
        reads("a.csv", text, {{1, 2, 3}, {7, 8, 9}}, {.drop_invalid = true});
        EXPECT_EQ(load("a.csv", text, {.drop_invalid = true}).report.dropped_points, 1) << none;
    }
    reads("a.xyz", "1 2 3\n1 2 -1.#IND\n1 2 nan # none\n", {{1, 2, 3}}, {.drop_invalid = true});
    refused("a.csv", "x,y,z\n1,abc,3\n", {"line 2", "'abc', which is not a number"}, {.drop_invalid = true});
    refused("a.txt", "1\t\t3\n", {"line 1", "not finite"});  // an empty field between tabs
    refused("a.txt", "1\t\t2\t3\n", {"line 1: 4 columns"});
}

TEST_F(PointFiles, BadLines) {
    refused("a.xyz", "1 2 3\n4 5\n", {"line 2", "2 columns, and a point needs x, y and z"});
    refused("a.csv", "1,2,3\n4,,6\n", {"line 2", "4 nan 6", "--drop-invalid"});
    refused("a.csv", "1,5;2,5;3,5\n4,5;5;6\n", {"line 1: column 1 (x) is '1,5'", "with a point, not a comma"});
    refused("a.csv", "x;y;z\n1,5;2,5;3,5\n", {"line 2: column 1 (x) is '1,5'", "with a point, not a comma"});
    refused("a.xyz", "1,5 2,5 3,5\n", {"line 1: '1,5 2,5 3,5'", "with a point, not a comma"});
    refused("a.xyz", "1,5 2,5\n", {"line 1: column 2 (y) is '5 2'", "with a point, not a comma"});
    refused("a.xyz", "1 2 3\n1 nan 3\n", {"line 2", "not finite"});
    refused("a.xyz", "1 2 -inf\n", {"line 1", "not finite"});
    refused("a.xyz", "1 2 1e400\n", {"line 1", "not finite"});
    refused("a.xyz", "1 2 0x3\n", {"line 1", "column 3 (z) is '0x3'"});
    refused("a.xyz", "1 2 +-3\n", {"line 1", "'+-3'"});
    refused("a.xyz", "1 2 3#4\n", {"line 1", "'3#4'"});
    refused("a.xyz", std::string("\xff\xfe\x31\x00\x20\x00", 6), {"UTF-16", "UTF-8"});
    refused("a.xyz", "# nothing\n", {"holds no vertices"});
    refused("a.laz", "LASF", {"LAZ", "convert it to .xyz", "las2txt"});
}

std::string pcd(const std::string& types, const std::string& sizes, int points, const std::string& data,
                const std::string& fields = "x y z") {
    const std::string ones = "1 1 1 1 1 1";
    const auto count = std::size_t(std::count(fields.begin(), fields.end(), ' ') + 1);
    return fmt::format(
        "# .PCD v0.7\nVERSION 0.7\nFIELDS {}\nSIZE {}\nTYPE {}\nCOUNT {}\nWIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 "
        "0 1 0 0 0\nPOINTS {}\nDATA {}\n",
        fields, sizes, types, ones.substr(0, 2 * count - 1), points, points, data);
}

TEST_F(PointFiles, PcdAsText) {
    const Rows two = {{0.1, 2, 3}, {4, 5, 6}};
    reads("a.pcd", pcd("F F F", "8 8 8", 2, "ascii") + "0.1 2 3\n4 5 6\n", two);
    reads("a.pcd", pcd("U F F F", "4 8 8 8", 2, "ascii", "rgb z y x") + "7 3 2 0.1\r\n7 6 5 4\r\n", two);
    EXPECT_TRUE(load("a.pcd", pcd("F F F", "4 4 4", 1, "ascii") + "1 2 3\n").report.float32);
    EXPECT_FALSE(load("a.pcd", pcd("F F F", "8 8 8", 1, "ascii") + "1 2 3\n").report.float32);
    refused("a.pcd", pcd("F F F", "8 8 8", 3, "ascii") + "1 2 3\n4 5 6\n", {"the header announces 3 points, and 2"});
    refused("a.pcd", pcd("F F F", "8 8 8", 1, "ascii") + "1 2 3\n4 5 6\n", {"line 13", "announces 1"});
    refused("a.pcd", pcd("F F F", "8 8 8", 1, "ascii") + "1 x 3\n", {"line 12", "column 2 (y) is 'x'"});
    refused("a.pcd", pcd("F F F", "8 8 8", 2, "ascii") + "1 2 3\nnan nan nan\n",
            {"line 13", "vertex 1 (from 0)", "not finite", "--drop-invalid"});
    reads("a.pcd", pcd("F F F", "8 8 8", 2, "ascii") + "1 2 3\nnan nan nan\n", {{1, 2, 3}}, {.drop_invalid = true});
    // Text of a float32 field is rounded to float32, as binary data would be.
    reads("a.pcd", pcd("F F F", "4 8 4", 1, "ascii") + "0.1 0.1 0.3\n", {{0.1f, 0.1, 0.3f}});
}

// Returns two points as floats, each with one unused byte before it and two after it.
std::string binary_records() {
    std::string body;
    for (const float first : {0.5f, 4.f}) {
        put(body, std::uint8_t{9});
        for (const float value : {first, first + 1, first + 2}) put(body, value);
        put(body, std::uint16_t{7});
    }
    return body;
}

TEST_F(PointFiles, PcdAsBytes) {
    const Rows two = {{0.5, 1.5, 2.5}, {4, 5, 6}};
    const std::string head = pcd("U F F F U", "1 4 4 4 2", 2, "binary", "a x y z b");
    reads("a.pcd", head + binary_records(), two);
    EXPECT_TRUE(load("a.pcd", head + binary_records()).report.float32);
    refused("a.pcd", (head + binary_records()).substr(0, head.size() + 20), {"is truncated", "2 points of 15 bytes"});
    std::string wide, small;
    for (const double value : {1.0 / 3, 2.0, -5.0}) put(wide, value);
    for (const int value : {-1, 2, 3}) put(small, static_cast<std::int16_t>(value));
    reads("a.pcd", pcd("F F F", "8 8 8", 1, "binary") + wide, {{1.0 / 3, 2, -5}});
    reads("a.pcd", pcd("I I I", "2 2 2", 1, "binary") + small, {{-1, 2, 3}});
    EXPECT_FALSE(load("a.pcd", pcd("F F F", "8 8 8", 1, "binary") + wide).report.float32);
    std::string hole = binary_records();
    const float none = std::numeric_limits<float>::quiet_NaN();
    std::memcpy(hole.data() + 5, &none, 4);
    refused("a.pcd", head + hole, {"vertex 0 (from 0)", "0.5 nan 2.5", "--drop-invalid"});
    reads("a.pcd", head + hole, {{4, 5, 6}}, {.drop_invalid = true});
}

TEST_F(PointFiles, PcdCompressed) {
    std::string by_field(2, '\x9');
    for (const float value : {0.5f, 4.f, 1.5f, 5.f, 2.5f, 6.f}) put(by_field, value);
    by_field += std::string("\7\0\7\0", 4);
    const std::string head = pcd("U F F F U", "1 4 4 4 2", 2, "binary_compressed", "a x y z b");
#ifdef HAUSBENCH_HAS_LZF
    std::string packed(100, '\0');
    packed.resize(lzf_compress(by_field.data(), unsigned(by_field.size()), packed.data(), unsigned(packed.size())));
    ASSERT_GT(packed.size(), 0u);
    const auto file = [&](std::uint32_t announced, const std::string& body) {
        std::string all = head;
        put(all, announced);
        put(all, static_cast<std::uint32_t>(by_field.size()));
        return all + body;
    };
    const auto size = static_cast<std::uint32_t>(packed.size());
    reads("a.pcd", file(size, packed), {{0.5, 1.5, 2.5}, {4, 5, 6}});
    refused("a.pcd", file(size, packed.substr(0, 9)), {"is truncated"});
    refused("a.pcd", file(size, std::string(size, '\xff')), {"is damaged"});
    refused("a.pcd", head + "abc", {"is truncated"});
    std::string fewer = file(size, packed);
    fewer.replace(fewer.find("WIDTH 2"), 7, "WIDTH 1").replace(fewer.find("POINTS 2"), 8, "POINTS 1");
    refused("a.pcd", fewer, {"is damaged", "1 points of 15 bytes are announced, and 30 bytes are there"});
    refused("a.pcd", head + std::string("\1\0\0\0\xff\xff\xff\x7f\0", 9), {"is damaged"});
#else
    refused("a.pcd", head + by_field, {"binary_compressed", "liblzf-dev"});
#endif
}

TEST_F(PointFiles, BadPcdHeaders) {
    const std::string good = pcd("F F F", "4 4 4", 1, "ascii") + "1 2 3\n";
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return text.replace(text.find(from), from.size(), to);
    };
    reads("a.pcd", good, {{1, 2, 3}});
    reads("a.pcd", with("VIEWPOINT 0 0 0 1 0 0 0", "VIEWPOINT 9 9 9 0 1 0 0"), {{1, 2, 3}});  // the sensor's pose
    EXPECT_TRUE(has_note(load("a.pcd", with("VIEWPOINT 0 0 0 1 0 0 0", "VIEWPOINT 0 0 9 1 0 0 0")),
                         "its VIEWPOINT 0 0 9 1 0 0 0, the pose of the sensor, does not move the points"));
    EXPECT_TRUE(load("a.pcd", good).report.notes.empty());
    EXPECT_TRUE(load("a.pcd", with("VIEWPOINT 0 0 0 1 0 0 0", "VIEWPOINT 0 0 0 -1 0.0 -0 0")).report.notes.empty());
    reads("a.pcd", with("FIELDS x y z", "FIELDS Z Y X"), {{3, 2, 1}});
    reads("a.pcd", "\xef\xbb\xbf" + good, {{1, 2, 3}});
    refused("a.pcd", "hello\n1 2 3\n", {"line 1", "'hello' is not a word of a PCD header"});
    refused("a.pcd", good.substr(0, good.find("DATA")), {"no DATA line"});
    refused("a.pcd", with("FIELDS x y z", "FIELDS x y w"), {"FIELDS has no 'z'"});
    refused("a.pcd", with("SIZE 4 4 4", "SIZE 4 4"), {"line 4", "SIZE has 2 values for 3 FIELDS"});
    refused("a.pcd", with("SIZE 4 4 4", "SIZE 4 4 3"), {"'z' is of type F3"});
    refused("a.pcd", with("COUNT 1 1 1", "COUNT 1 1 2"), {"'z'", "count 2"});
    refused("a.pcd", with("POINTS 1", "POINTS 2"), {"POINTS is 2, and WIDTH times HEIGHT 1"});
    refused("a.pcd", with("POINTS 1", "POINTS -1"), {"line 10", "'-1' is not an integer"});
    refused("a.pcd", with("WIDTH 1", "WIDTH 1099511627776"), {"WIDTH times HEIGHT"});
    refused("a.pcd", with("DATA ascii", "DATA asci"), {"unknown DATA 'asci'", "did you mean 'ascii'"});
}

TEST_F(PointFiles, CommentsThatContradictOrNameAngles) {
    refused("a.xyz", "# x y z\n# z y x\n1 2 3\n", {"line 2", "different columns", "--columns"});
    refused("a.xyz", "# format: lat lon alt\n1 2 3\n", {"line 1", "angles"});
    EXPECT_TRUE(has_note(load("a.csv", "x,y,z,i\n1,2,3,4\n", {.columns = "2,3,4"}), "other columns x, y and z"));
    EXPECT_TRUE(load("a.csv", "x,y,z,i\n1,2,3,4\n", {.columns = "1,2,3"}).report.notes.empty());
    EXPECT_EQ(load("a.csv", "x [NM],y [NM],z [NM]\n1,2,3\n").report.stated.micrometres, 0);
    EXPECT_EQ(load("a.csv", "x [nm],y [nm],z [nm]\n1,2,3\n").report.stated.unit, "nm");
}

TEST_F(PointFiles, PcdThatDisagreesWithItsHeader) {
    const std::string head = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nPOINTS 1\n";
    refused("a.pcd", head + "DATA ascii\n1 2 3 4\n", {"line 7", "4 columns", "name 3"});
    refused("a.pcd", "FIELDS x y z x\nSIZE 4 4 4 4\nTYPE F F F F\nPOINTS 1\nDATA ascii\n1 2 3 4\n", {"'x' twice"});
    refused("a.pcd", head + "DATA binary\n" + std::string(24, '\1'), {"1 points of 12 bytes", "24 bytes"});
    EXPECT_TRUE(
        has_note(load("a.pcd", head + "DATA binary\n" + std::string(14, '\0')), "2 bytes after its last point"));
    // pcl_converter fills its files with a page of zeros.
    EXPECT_TRUE(has_note(load("a.pcd", head + "DATA binary\n" + std::string(12 + 4000, '\0')),
                         "4000 bytes after its last point"));
}

}  // namespace
}  // namespace hausbench
