// AMF: coordinates, units, constellations, what is left out or refused, and damaged files.
#include "datasets/load.h"
#include "tests/support/reading.h"
#include "tests/support/zip_archive.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace hausbench {
namespace {

std::string vertex(const std::string& x, const std::string& y, const std::string& z, const std::string& more = "") {
    return fmt::format("<vertex><coordinates><x>{}</x><y>{}</y><z>{}</z></coordinates>{}</vertex>\n", x, y, z, more);
}

std::string triangle(const std::string& a, const std::string& b, const std::string& c) {
    return fmt::format("<triangle><v1>{}</v1><v2>{}</v2><v3>{}</v3></triangle>", a, b, c);
}

const std::string three = vertex("0", "0", "0") + vertex("1", "0", "0") + vertex("0", "2", "0");

std::string mesh(const std::string& vertices = three, const std::string& triangles = triangle("0", "1", "2"),
                 const std::string& volume = "") {
    return "<mesh><vertices>\n" + vertices + "</vertices><volume " + volume + ">" + triangles + "</volume></mesh>";
}

std::string object(const std::string& id, const std::string& inside = mesh()) {
    return fmt::format("<object id='{}'>{}</object>\n", id, inside);
}

std::string constellation(const std::string& id, const std::string& inside) {
    return fmt::format("<constellation id='{}'>{}</constellation>\n", id, inside);
}

std::string instance(const std::string& id, const std::string& inside = "") {
    return fmt::format("<instance objectid='{}'>{}</instance>", id, inside);
}

std::string amf(const std::string& inside, const std::string& attributes = "") {
    return "<?xml version='1.0' encoding='utf-8'?>\n<amf " + attributes + ">\n" + inside + "</amf>\n";
}

class Amf : public Reading {
protected:
    Amf() : Reading("a.amf") {}

    std::vector<std::string> notes(const std::string& bytes) const { return load(bytes).report.notes; }
    void expect_at(const std::string& move, const std::vector<Vec3>& where, double off = 0) const {
        expect_near(corners(amf(object("1") + constellation("2", instance("1", move)))), where, off, move);
    }
};

TEST_F(Amf, CoordinatesAreReadToTheLastBit) {
    const std::string vertices = vertex("0.1", "1e-17", "<![CDATA[+.5]]>") +
                                 vertex("\n 0.30000000000000004 ", "-2.7182818284590451", "1.7976931348623157e300") +
                                 vertex("<!-- 3 -->34<!-- 5 -->", "4", "5.") + vertex("9", "9", "1e999");
    const LoadedShape loaded = load(amf(object("1", mesh(vertices))));
    EXPECT_EQ(
        corners(amf(object("1", mesh(vertices)))),
        (std::vector<Vec3>{{0.1, 1e-17, 0.5}, {0.1 + 0.2, -2.718281828459045, 1.7976931348623157e300}, {34, 4, 5}}));
    EXPECT_EQ(loaded.report.format, "amf");
    EXPECT_FALSE(loaded.report.float32);
    EXPECT_EQ(loaded.report.unreferenced, 1);
    EXPECT_EQ(loaded.report.stated.unit, "mm");
    EXPECT_EQ(loaded.report.stated.up, 0);
    EXPECT_TRUE(loaded.report.notes.empty());
}

TEST_F(Amf, UnitsOfTheStandard) {
    for (const auto& [name, micrometres] : std::vector<std::pair<std::string, double>>{
             {"millimeter", 1e3}, {"inch", 25400}, {"feet", 304800}, {"meter", 1e6}, {"micron", 1}})
        EXPECT_EQ(load(amf(object("1"), "unit='" + name + "'")).report.stated.micrometres, micrometres);
    refused(amf(object("1"), "unit='cubit'"), {"line 2: ", "unit=\"cubit\"", "write millimeter"});
}

TEST_F(Amf, MeshesAndVolumesHaveTheIndicesOfTheirMesh) {
    const std::string two = "<mesh><vertices>" + three + vertex("0", "0", "5") + "</vertices><volume materialid='2'>" +
                            "<metadata type='name'>a</metadata><color><r>1</r></color>" + triangle("0", "1", "2") +
                            "</volume><volume type='support'>" + triangle("0", "1", "3") + "</volume><volume>" +
                            triangle("0", "2", "3") + "</volume></mesh>";
    const std::string file = amf(object("1", two) + object("2"));
    EXPECT_EQ(corners(file),
              (std::vector<Vec3>{
                  {0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 0}, {0, 2, 0}, {0, 0, 5}, {0, 0, 0}, {1, 0, 0}, {0, 2, 0}}));
    EXPECT_EQ(load(file).report.objects, 2);
    EXPECT_EQ(notes(file),
              (std::vector<std::string>{
                  "2 objects stand at their own coordinates: no constellation places them",
                  "1 volume of type support is left out: supports only hold the model while it is printed"}));
    refused(amf(object("1", mesh(three, triangle("0", "1", "2"), "type='support'"))), {"no triangle, except supports"});
}

TEST_F(Amf, InstancesRotateAboutOneAxisAndThenMove) {
    expect_at("", {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});
    expect_at("<deltax>0.5</deltax><deltay>-3</deltay><deltaz>7</deltaz>", {{0.5, -3, 7}, {1.5, -3, 7}, {0.5, -1, 7}});
    expect_at("<rz>90</rz>", {{0, 0, 0}, {0, 1, 0}, {-2, 0, 0}});
    expect_at("<rx>90</rx><ry>0</ry>", {{0, 0, 0}, {1, 0, 0}, {0, 0, 2}});
    expect_at("<ry>90</ry>", {{0, 0, 0}, {0, 0, -1}, {0, 2, 0}});
    expect_at("<rz>-450</rz>", {{0, 0, 0}, {0, -1, 0}, {2, 0, 0}});
    expect_at("<rz>180</rz><deltax>1</deltax>", {{1, 0, 0}, {0, 0, 0}, {1, -2, 0}});
    expect_at("<rz>360</rz>", {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});
    const double root = std::sqrt(0.5), off = 8 * 0x1p-53 * 2;
    expect_at("<rz>45</rz>", {{0, 0, 0}, {root, root, 0}, {-2 * root, 2 * root, 0}}, off);
    expect_at("<rz>1110</rz>", {{0, 0, 0}, {std::sqrt(0.75), 0.5, 0}, {-1, 2 * std::sqrt(0.75), 0}}, off);
    for (const double degrees : {0.001, 1.0, 44.9, 45.1, 137.0, 200.0, 299.0, -77.0}) {
        const double angle = degrees * 0.017453292519943295, c = std::cos(angle), s = std::sin(angle);
        expect_at(fmt::format("<ry>{}</ry>", degrees), {{0, 0, 0}, {c, 0, -s}, {0, 2, 0}}, 1e-15);
    }
    EXPECT_EQ(notes(amf(object("1") + constellation("2", instance("1", "<rz>90</rz><deltax>1</deltax>")))),
              std::vector<std::string>{
                  "instances are rotated first and then moved: the standard does not state this order clearly"});
}

TEST_F(Amf, ConstellationsHoldConstellations) {
    const std::string file = amf(constellation("5", instance("4", "<rz>90</rz>") + instance("1")) + object("1") +
                                 constellation("4", instance("1", "<deltax>10</deltax>")));
    EXPECT_EQ(corners(file), (std::vector<Vec3>{{0, 10, 0}, {0, 11, 0}, {-2, 10, 0}, {0, 0, 0}, {1, 0, 0}, {0, 2, 0}}));
    EXPECT_TRUE(notes(file).empty());
    EXPECT_EQ(notes(amf(object("1") + constellation("4", instance("1")) + constellation("5", instance("1")))),
              std::vector<std::string>{"2 constellations stand at their own coordinates: none places the others"});
}

TEST_F(Amf, AnObjectAndAConstellationMayShareAnId) {
    const std::string moved = instance("0", "<deltax>10</deltax>");
    EXPECT_EQ(corners(amf(object("0") + constellation("0", moved)))[0], Vec3(10, 0, 0));  // as FreeCAD writes it
    EXPECT_EQ(corners(amf(object("0") + object("1") + constellation("0", moved + instance("1")))).size(), 6u);
    refused(amf(object("0") + constellation("0", moved) + constellation("1", instance("0"))),
            {"objectid=\"0\" names an object and a constellation", "another id"});
    refused(amf(object("1") + constellation("0", instance("1")) + constellation("0", instance("1"))),
            {"a second <constellation> with id '0'"});
}

TEST_F(Amf, ACommentInsideOfANumberIsRefused) {
    EXPECT_EQ(corners(amf(object("1", mesh(vertex("5 <!-- 2 -->", "0", "0") + three))))[0], Vec3(5, 0, 0));
    for (const char* x : {"1<!-- -->2", "1<![CDATA[2]]>", "<![CDATA[1]]>2"})
        refused(amf(object("1", mesh(vertex(x, "0", "0") + three))), {"line 4", "a comment or CDATA section in <x>"});
    refused(amf(object("1", mesh(three, triangle("0", "1", "<!-- -->0<!-- -->2")))), {"ends before '2'"});
}

TEST_F(Amf, WhatProgramsUnderstandDifferentlyIsRefused) {
    const auto with = [](const std::string& move) {
        return amf(object("1") + constellation("2", instance("1", move)));
    };
    refused(with("<rx>90</rx><rz>1</rz>"), {"more than one axis", "apply them to the object"});
    refused(with("<scalex>2</scalex>"), {"<scalex> of an instance is not part of AMF"});
    refused(with("<mirrory>-1</mirrory>"), {"<mirrory> of an instance"});
    refused(with("<rz>1.57</rz><scalex>1</scalex>"), {"radians", "degrees"});
    EXPECT_TRUE(notes(with("<rz>0</rz><scalex>1</scalex><printable>1</printable>")).empty());
    EXPECT_EQ(notes(with("<printable>0</printable>")).size(), 1u);
    EXPECT_EQ(notes(with("<skew>1</skew>")),
              std::vector<std::string>{"<skew> in <instance> is not an element of AMF, and is left out"});
    refused(amf(object("1") + object("2") + constellation("3", instance("1"))),
            {"line ", "object '2' is in no constellation"});
    EXPECT_EQ(notes(amf(object("1", mesh(three, "<metadata type='slic3r.volume_type'>ParameterModifier</metadata>" +
                                                    triangle("0", "1", "2"))))),
              std::vector<std::string>{
                  "a volume is a ParameterModifier of a slicer, which AMF does not define: it counts as surface"});
}

TEST_F(Amf, CurvesAndLatticesAreRefused) {
    refused(amf(object("1", mesh(vertex("0", "0", "0", "<normal><nx>0</nx><ny>0</ny><nz>1</nz></normal>") + three))),
            {"line 4: ", "<normal>", "curved triangles", "export flat triangles"});
    refused(amf(object("1", mesh(three + "<edge><v1>0</v1><v2>1</v2></edge>"))), {"<edge>", "curved triangles"});
    const auto with = [](const std::string& formula) {
        return amf("<material id='7'><composite materialid='1'>" + formula + "</composite></material>" +
                   object("1", mesh(three, triangle("0", "1", "2"), "materialid='7'")));
    };
    refused(with("sin(x)"), {"material '7' is a function of the place", "lattice"});
    EXPECT_EQ(corners(with("0.5")).size(), 3u);
}

TEST_F(Amf, BrokenFilesAreRefusedWithTheirLine) {
    refused(amf(object("1", mesh(three, triangle("0", "1", "3")))), {"line 7: ", "'3' names none of the 3 vertices"});
    refused(amf(object("1", mesh(three, triangle("0", "1", "1.0")))), {"'1.0' names none"});
    refused(amf(object("1", mesh(three, triangle("0", "1", "-1")))), {"'-1' names none"});
    refused(amf(object("1", mesh(three, "<triangle><v1>0</v1><v2>1</v2></triangle>"))), {"has 0 <v3>, not one"});
    refused(amf(object("1", mesh(vertex("1", "2", "</z><z>3")))), {"<coordinates> has 2 <z>, not one"});
    refused(amf(object("1", mesh(vertex("1", "2", "1,5")))), {"line 4: ", "'1,5' is not a number"});
    refused(amf(object("1", mesh(vertex("1", "2", "<b>5</b>")))), {"<b> inside of <z>"});
    refused(amf(object("1", mesh("<vertex/>"))), {"<vertex> has 0 <coordinates>"});
    refused(amf(object("1", "<mesh/>")), {"<mesh> has 0 <vertices>, not one"});
    refused(amf(object("1", mesh(vertex("1e999", "2", "3"), triangle("0", "0", "0")))), {"not finite"});
    refused(amf(object("1") + object("1")), {"id '1'", "give it another"});
    refused(amf(object("1") + constellation("2", instance("3"))), {"objectid=\"3\" names no object"});
    refused(amf(object("1") + constellation("2", instance("1", "<rx>1</rx><rx>1</rx>"))), {"a second <rx>"});
    refused(amf(object("1") + constellation("2", instance("1", "<rx>inf</rx>"))), {"<rx> is not finite"});
    refused(amf(object("", "")), {"no triangle"});
    refused(amf(""), {"no triangle"});
    refused("<object/>", {"its root element is <object>, not <amf>"});
    refused(amf(object("1")) + "<amf/>", {"a second root element"});
}

TEST_F(Amf, CyclesAndExplosionsAreRefused) {
    refused(amf(object("1") + constellation("2", instance("2"))), {"every constellation is an instance"});
    refused(amf(object("1") + constellation("a", instance("b")) + constellation("b", instance("c")) +
                constellation("c", instance("b"))),
            {"constellation 'b' contains itself"});
    std::string doubled = object("0");
    for (int i = 1; i < 60; ++i)
        doubled += constellation(fmt::format("{}", i),
                                 instance(fmt::format("{}", i - 1)) + instance(fmt::format("{}", i - 1)));
    refused(amf(doubled), {"more than 64 instances, points and corners for each byte"});
    std::string deep = object("0");
    for (int i = 1; i < 300; ++i) deep += constellation(fmt::format("{}", i), instance(fmt::format("{}", i - 1)));
    refused(amf(deep), {"nested deeper than 256"});
}

TEST_F(Amf, ArchivesHoldOneAmfFile) {
    const std::string file = amf(object("1"));
    EXPECT_EQ(corners(zip_archive({{"A.AMF", file}, {"notes.txt", "x"}})).size(), 3u);
    EXPECT_EQ(corners(zip_archive({{"a.amf", file, true, true}})).size(), 3u);
    refused(zip_archive({{"a.amf", file}, {"b.amf", file}}), {"several .amf files", "unpack it"});
    refused(zip_archive({{"a.xml", file}}), {"no .amf file", "unpack it"});
    refused(zip_archive({{"a.amf", file, true, false, 1}}), {"is encrypted"});
    refused(zip_archive({{"a.amf", amf(object("1", "<mesh/>"))}}), {"a.amf: a.amf: line 3: "});
}

}  // namespace
}  // namespace hausbench
