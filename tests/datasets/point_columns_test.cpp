// Which columns of a table of points are x, y and z, and in which unit: headers, comments, rows of units, numbers.
#include "datasets/load.h"
#include "datasets/units.h"
#include "tests/support/reading.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace hausbench {
namespace {

class Columns : public Reading {
protected:
    Columns() : Reading("a.xyz") {}

    void reads(const std::string& name, const std::string& bytes, const Vec3& first,
               const LoadOptions& options = {}) const {
        try {
            const LoadedShape loaded = load(name, bytes, options);
            EXPECT_EQ(rows(loaded).front(), first) << bytes << ": " << rows(loaded).front().transpose();
        } catch (const InputError& error) {
            ADD_FAILURE() << bytes << ": " << error.what();
        }
    }
};

const Vec3 point = {1, 2, 3}, turned = {2, 1, 3};  // columns 1, 2, 3; and x in column 2, y in column 1

TEST_F(Columns, HeaderOfNumbersIsNoPoint) {
    for (const std::string header : {"id,2019,2020,2021", "id,0,1,2", "pt,1.5,2.5,3.5", ",2019,2020,2021"})
        refused("a.csv", header + "\n7,1,2,3\n8,4,5,6\n", {"line 1", "header of numbers", "move it down"},
                {.columns = "2,3,4"});
    refused("a.csv", "name,2019,2020,2021\nA,1,2,3\n", {"line 1", "'name'"}, {.columns = "2,3,4"});
    reads("a.csv", "BM1,1,2,3\nBM2,4,5,6\n7,7,8,9\n", point, {.columns = "2,3,4"});
    reads("a.csv", "A,1,2,3\n", point, {.columns = "2,3,4"});
    reads("a.csv", "7,1,2,3\nBM2,4,5,6\n", point, {.columns = "2,3,4"});
    reads("a.csv", "N/A,1,2,3\n5,4,5,6\n", point, {.columns = "2,3,4"});
    EXPECT_TRUE(has_note(load("a.csv", "0,1,2,3\n9,1,2,3\n", {.columns = "2,3,4"}), "if it numbers the columns"));
    reads("a.csv", "x,y,z,2019\n1,2,3,4\n", point);  // one of the names is a number
    reads("a.csv", "x,y,z,2nd return\n1,2,3,4\n", point);
}

TEST_F(Columns, CommentsThatListOtherNamesAreRefused) {
    for (const std::string names : {"r theta phi",
                                    "ra dec z",
                                    "N E D",
                                    "vx vy vz",
                                    "R G B",
                                    "nx ny nz",
                                    "u v w",
                                    "a b c",
                                    "t x y",
                                    "range azimuth elevation",
                                    "time, depth, value",
                                    "foo,bar,baz",
                                    "col1 col2 col3",
                                    "vel_x vel_y vel_z",
                                    "1:r 2:theta 3:phi",
                                    "columns: foo bar baz",
                                    "Columns: 1=u 2=v 3=w",
                                    "r | theta | phi",
                                    "r/theta/phi",
                                    "radius [m], angle [deg], height [m]",
                                    "radius in m, angle in deg, height in m",
                                    "r \xce\xb8 \xcf\x86",
                                    "2:y 3:x 4:z",
                                    "1:x 1:y 2:z",
                                    "row col value",
                                    "-x y z",
                                    "x -y z",
                                    "-x, -y, z",
                                    "x^2 y^2 z^2",
                                    "log10(x) log10(y) log10(z)",
                                    "px_y px_x depth",
                                    "Velocity.X Velocity.Y Velocity.Z"})
        for (const std::string mark : {"# ", "//", "% ", "#"})
            refused("a.txt", "# made by a program\n" + mark + names + "\n1 2 3\n", {"line 2", "--columns"});
    for (const std::string names : {"lat lon alt", "WGS84 lat lon h", "longitude, latitude, height", "lat lon"})
        refused("a.txt", "# " + names + "\n1 2 3\n", {"line 1", "angles"});
    refused("a.txt", "# 1: r  the radius\n# 2: theta  an angle\n# 3: phi  another\n1 2 3\n", {"--columns"});
    refused("a.txt", "# x y z\n# r theta phi\n1 2 3\n", {"line 2", "--columns"});
    reads("a.txt", "# r theta phi\n1 2 3\n", point, {.columns = "1,2,3"});
    reads("a.txt", "# r theta phi\n1 2 3\n", turned, {.columns = "theta,r,phi"});
}

TEST_F(Columns, CommentsThatListXyzAreHonoured) {
    for (const std::string names : {"y x z",
                                    "1:y 2:x 3:z",
                                    "Columns: 1=y 2=x 3=z",
                                    "columns: y x z",
                                    "y, x, z",
                                    "Format: Y X Z",
                                    "y/x/z",
                                    "[y, x, z]",
                                    "y | x | z",
                                    "y\tx\tz",
                                    "1 y 2 x 3 z",
                                    "0:y 1:x 2:z",
                                    "2=x 1=y 3=z",
                                    "x=2 y=1 z=3",
                                    "y (m) x (m) z (m)",
                                    "Northing Easting Height",
                                    "Y X Z [mm]",
                                    "y x z mm",
                                    "y x z in mm",
                                    "\"Y\" \"X\" \"Z\"",
                                    "#y #x #z",
                                    "--- y x z ---",
                                    "Spalten: y x z",
                                    "order y x z",
                                    "$1=y $2=x $3=z",
                                    "<y> <x> <z>",
                                    "{y} {x} {z}",
                                    "'y' 'x' 'z'",
                                    "- y x z",
                                    "columns=y,x,z"})
        reads("a.txt", "# " + names + "\n1 2 3\n", turned);
    reads("a.txt", "# Column 1: y\n# Column 2: x\n# Column 3: z\n1 2 3\n", turned);
    reads("a.txt", "#   1 Y   north\n#   2 X   east\n#   3 Z   up\n1 2 3\n", turned);
    reads("a.txt", "% Model: a.mph\n% Date: Nov 29 2026\n% Length unit: m\n% Y X Z\n1 2 3\n", turned);
    reads("a.csv", "% Y,X,Z,T (K) @ t=0\n1,2,3,4\n", turned);
    reads("a.csv", "# Y in mm, X in mm, Z in mm\n1,2,3\n", turned);
    refused("a.txt", "# x y z\n# y x z\n1 2 3\n", {"line 2", "different columns"});
}

TEST_F(Columns, ProseIsIgnored) {
    for (const std::string text :
         {"sorted by z, y, x", "Point cloud data", "made by me, on Monday, for testing", "Created by Foo",
          "the x y z of it", "x y z of the points", "sphere with noise", "Author: Joe Q Roe", "1 2 3", "3 scans here",
          "Date: Nov 29 2026", "---", "2026-11-29", "units are mm", "Date\t29", "in the box",
          "coordinates of the points", "moved along y, x and z", "x y z"})
        reads("a.txt", "# " + text + "\n1 2 3\n", point);
    reads("a.txt", "# 1. first step\n# 2. second step\n# 3. third step\n1 2 3\n", point);
    reads("a.txt", "# x y z\n# mm mm mm\n1 2 3\n", point);
    reads("a.txt", "# x/y/z\n1 2 3\n", point);
    for (const std::string text : {"y x z coordinates", "zyx", "NED", "order: zyx", "Y X Z, in metres", "z/y/x of it"})
        refused("a.txt", "# " + text + "\n1 2 3\n", {"line 1", "another order", "--columns"});
}

TEST_F(Columns, Units) {
    const auto stated = [&](const std::string& text) {
        try {
            return load("a.txt", text).report.stated.unit;
        } catch (const InputError& error) {
            return std::string(error.what());
        }
    };
    for (const std::string text :
         {"# x y z (mm)\n1 2 3\n", "# x, y, z [mm]\n1 2 3\n", "x y z [mm]\n1 2 3\n", "x/mm y/mm z/mm\n1 2 3\n",
          "x,y,z\nmm,mm,mm\n1,2,3\n", "id,x,y,z,T\n,mm,mm,mm,K\n7,1,2,3,4\n", "x y z\n[mm] [mm] [mm]\n1 2 3\n",
          "# x y z\n# mm mm mm\n1 2 3\n", "# x y z in mm\n1 2 3\n", "# x y z mm\n1 2 3\n", "% Length unit: mm\n1 2 3\n",
          "# Units: mm\n# x y z\n1 2 3\n", "# unit = [mm]\n1 2 3\n", "\"x, mm\";\"y, mm\";\"z, mm\"\n1;2;3\n",
          "x in mm,y in mm,z in mm\n1,2,3\n", "x y z [mm] i\n1 2 3 4\n",
          "Easting (X) [mm],Northing (Y) [mm],Height (Z) [mm]\n1,2,3\n"})
        EXPECT_EQ(stated(text), "mm") << text;
    EXPECT_EQ(stated("x [\xce\xbcm],y [\xc2\xb5m],z [um]\n1,2,3\n"), "um");
    EXPECT_EQ(stated("x [US ft] y [US ft] z [US ft]\n1 2 3\n"), "us-ft");
    EXPECT_EQ(stated("x (us survey feet),y (us survey feet),z (us survey feet)\n1,2,3\n"), "us-ft");
    EXPECT_EQ(stated("x [A],y [A],z [A]\n1,2,3\n"), "A");
    EXPECT_EQ(stated("x/furlong,y/furlong,z/furlong\n1,2,3\n"), "furlong");
    EXPECT_EQ(stated("x [Mm],y [Mm],z [Mm]\n1,2,3\n"), "Mm");
    EXPECT_EQ(stated("X/East,Y/North,Z/Altitude\n1,2,3\n"), "");
    EXPECT_EQ(stated("Easting (X),Northing (Y),Height (Z)\n1,2,3\n"), "");
    EXPECT_EQ(stated("# Unit: K\n1 2 3\n"), "");
    EXPECT_EQ(stated("% Length unit: furlong\n1 2 3\n"), "furlong");
    EXPECT_EQ(stated("x [-],y [-],z [-]\n1,2,3\n"), "");
    refused("a.csv", "x,y,z [mm]\n1,2,3\n", {"units", "differ"});
    refused("a.csv", "x,y,z\nmm,mm,m\n1,2,3\n", {"units", "differ"});
    refused("a.csv", "Northing (X),Easting (Y),Height (Z)\n1,2,3\n", {"more than once"});
    EXPECT_EQ(stated_unit(1200.0 / 3937).unit, "us-ft");
}

TEST_F(Columns, UnitsThatAreNotKnown) {
    LoadedShape loaded = load("a.csv", "x [A],y [A],z [A]\n1,2,3\n");
    EXPECT_EQ(loaded.report.stated.micrometres, 0);
    EXPECT_TRUE(has_note(loaded, "states the unit 'A', which is not known"));
    EXPECT_THROW(convert_to_unit(loaded, *unit_named("mm"), "a.csv"), InputError);
    const Stated angstrom = unit_stated_as("A"), px = unit_stated_as("px"), mm = unit_stated_as("mm");
    EXPECT_TRUE(units_differ(angstrom, px));
    EXPECT_TRUE(units_differ(angstrom, mm));
    EXPECT_FALSE(units_differ(angstrom, angstrom));
    EXPECT_FALSE(units_differ(angstrom, {}));
    EXPECT_FALSE(units_differ(unit_stated_as("millimetre"), mm));
    LoadedShape feet = load("a.csv", "x [US ft],y [US ft],z [US ft]\n3937,0,0\n");
    convert_to_unit(feet, *unit_named("m"), "a.csv");
    EXPECT_NEAR(rows(feet).front()[0], 1200, 1e-12);
}

TEST_F(Columns, NumbersAsOthersWriteThem) {
    reads("a.txt", "1 2 3;\n4 5 6;\n", point);
    reads("a.txt", "0.1D+01 2d0 +.3D1\n", point);
    refused("a.txt", "1.5D+0D 2 3\n", {"line 1", "column 1 (x) is '1.5D+0D'"});
    refused("a.txt", "1 2 3D\n", {"column 3 (z) is '3D'"});
    for (const std::string text : {"1,234.5", "1.234,5", "1,234,567", "1'234.5"})
        for (const std::string& line : {"x;y;z\n1;2;" + text + "\n", "x,y,z\n1,2,\"" + text + "\"\n"})
            refused("a.csv", line, {"line 2", "column 3 (z)", "thousands without a separator"});
    refused("a.csv", "1;2;1,234\n", {"with a point, not a comma"});
    refused("a.csv", "1.0.0,2,3\n", {"'1.0.0', which is not a number"});
}

TEST_F(Columns, TextWithoutPoints) {
    refused("count.csv", "2\n1,2,3\n4,5,6\n",
            {"line 1: 1 column, and a point needs x, y and z; if '2' is the number of points", "delete the line"});
    refused("eq.txt", "x^2 + y^2 + z^2 = 1\n", {"line 1", "expected lines of three numbers", "'x^2 + y^2"});
    refused("eq.txt", "Dear reader,\nthis is a letter.\n", {"line 1", "expected", "'Dear reader,'"});
    refused("a.csv", "name,city\nAnn,Rome\n", {"line 1", "expected", "'name,city'"});
}

}  // namespace
}  // namespace hausbench
