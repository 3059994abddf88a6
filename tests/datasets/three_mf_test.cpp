// 3MF: positions under transforms, parts in other files, what is left out or refused, and damaged archives.
#include "algorithms/error.h"
#include "datasets/load.h"
#include "tests/support/reading.h"
#include "tests/support/zip_archive.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace hausbench {
namespace {

const std::string core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
const std::string microsoft = "http://schemas.microsoft.com/3dmanufacturing/";
const std::string mesh =
    "<mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='1' y='0' z='0'/><vertex x='0' y='2' z='0'/></vertices>"
    "<triangles><triangle v1='0' v2='1' v3='2'/></triangles></mesh>";

std::string object(int id, const std::string& inside = mesh, const std::string& attributes = "") {
    return fmt::format("<object id='{}' {}>{}</object>\n", id, attributes, inside);
}

std::string components(const std::string& inside) { return "<components>" + inside + "</components>"; }

std::string component(int id, const std::string& attributes = "") {
    return fmt::format("<component objectid='{}' {}/>", id, attributes);
}

std::string model(const std::string& resources, const std::string& items, const std::string& attributes = "") {
    return fmt::format(
        "<?xml version='1.0' encoding='UTF-8'?>\n<model xmlns='{}' {}>\n<resources>\n{}</resources>\n"
        "<build>{}</build></model>",
        core, attributes, resources, items);
}

const std::string item = "<item objectid='1'/>";
const std::string with_p = "xmlns:p='" + microsoft + "production/2015/06' requiredextensions='p'";

std::string relations(const std::string& target = "/3D/a.model", const std::string& attributes = "") {
    return fmt::format(
        "<Relationships xmlns='http://schemas.openxmlformats.org/package/2006/relationships'>"
        "<Relationship Id='r' Type='{}2013/01/3dmodel' Target='{}' {}/></Relationships>",
        microsoft, target, attributes);
}

class ThreeMf : public Reading {
protected:
    ThreeMf() : Reading("a.3mf") {}

    static std::string archive(const std::string& xml, std::vector<ZipEntry> more = {}) {
        more.push_back({"3D/a.model", xml});
        more.push_back({"_rels/.rels", relations()});
        return zip_archive(more);
    }
    LoadedShape load_model(const std::string& xml, std::vector<ZipEntry> more = {}) const {
        return load(archive(xml, std::move(more)));
    }
    void refused_archive(const std::string& bytes, const std::vector<std::string>& parts) const {
        Reading::refused(bytes, parts);
    }
    void refused(const std::string& xml, const std::vector<std::string>& parts) const {
        refused_archive(archive(xml), parts);
    }
};

TEST_F(ThreeMf, CoordinatesAreReadToTheLastBit) {
    const LoadedShape loaded = load_model(
        model(object(1,
                     "<mesh><vertices><vertex x='0.1' y='1e-17' z='+.5'/><vertex x=' 0.30000000000000004 ' "
                     "y='-2.7182818284590451' z='1.7976931348623157e300'/><vertex x='3' y='4' z='5'/>"
                     "<vertex x='1e999' y='0' z='0'/></vertices><triangles><triangle v1='0' v2='1' v3='2' p1='7'/>"
                     "</triangles></mesh>"),
              "<item objectid='1' transform='1 0 0 0 1 0 0 0 1 0 0 0'/>"));
    EXPECT_EQ(
        corners(loaded),
        (std::vector<Vec3>{{0.1, 1e-17, 0.5}, {0.1 + 0.2, -2.718281828459045, 1.7976931348623157e300}, {3, 4, 5}}));
    EXPECT_EQ(loaded.report.format, "3mf");
    EXPECT_FALSE(loaded.report.float32);
    EXPECT_EQ(loaded.report.unreferenced, 1);
    EXPECT_EQ(loaded.report.objects, 1);
    EXPECT_EQ(loaded.report.stated.unit, "mm");
    EXPECT_EQ(loaded.report.stated.micrometres, 1000);
    EXPECT_EQ(loaded.report.stated.up, 'Z');
    EXPECT_TRUE(loaded.report.notes.empty());
}

TEST_F(ThreeMf, UnitsOfTheSpecification) {
    const std::vector<std::pair<std::string, double>> units = {
        {"micron", 1}, {"millimeter", 1e3}, {"centimeter", 1e4}, {"inch", 25400}, {"foot", 304800}, {"meter", 1e6}};
    for (const auto& [name, micrometres] : units)
        EXPECT_EQ(load_model(model(object(1), item, "unit='" + name + "'")).report.stated.micrometres, micrometres);
    refused(model(object(1), item, "unit='yard'"), {"3D/a.model: line 2: ", "unit=\"yard\"", "write micron"});
}

TEST_F(ThreeMf, TransformsMultiplyRowVectors) {
    // x' = 2 + 4 y, y' = 3 + 5 x, z' = 7 + z; the determinant is negative, so that the corners change their order.
    const auto points =
        corners(load_model(model(object(1), "<item objectid='1' transform='0 5 0 4 0 0 0 0 1 2 3 7'/>")));
    EXPECT_EQ(points, (std::vector<Vec3>{{2, 3, 7}, {10, 3, 7}, {2, 8, 7}}));
}

TEST_F(ThreeMf, ComponentsAreMovedFromTheInnermostToTheOutermost) {
    const std::string resources = object(1) +
                                  object(2, components(component(1, "transform='2 0 0 0 2 0 0 0 2 0 0 0'") +
                                                       component(1, "transform='1 0 0 0 1 0 0 0 1 0 0 1'"))) +
                                  object(3, components(component(2, "transform='1 0 0 0 1 0 0 0 1 10 0 0'")));
    const LoadedShape loaded =
        load_model(model(resources, "<item objectid='3' transform='0 1 0 -1 0 0 0 0 1 0 0 0'/><item objectid='1'/>"));
    EXPECT_EQ(corners(loaded), (std::vector<Vec3>{{0, 10, 0},
                                                  {0, 12, 0},
                                                  {-4, 10, 0},
                                                  {0, 10, 1},
                                                  {0, 11, 1},
                                                  {-2, 10, 1},
                                                  {0, 0, 0},
                                                  {1, 0, 0},
                                                  {0, 2, 0}}));
    EXPECT_EQ(loaded.report.objects, 3);
}

TEST_F(ThreeMf, PartsInOtherFilesHaveTheirOwnIds) {
    const std::string other = model(object(1, mesh) + object(2, components(component(1))), item);
    const std::string moved =
        "<mesh><vertices><vertex x='5' y='0' z='0'/><vertex x='6' y='0' z='0'/><vertex x='5' "
        "y='1' z='0'/></vertices><triangles><triangle v1='0' v2='1' v3='2'/></triangles></mesh>";
    const std::string root = model(
        object(1, moved) +
            object(7, components(component(2, "p:path='/3D/Objects/b.model' transform='1 0 0 0 1 0 0 0 1 0 0 3'") +
                                 component(1))),
        "<item objectid='7'/><item objectid='1' p:path='3d/objects/%62.model'/>", with_p);
    const LoadedShape loaded = load_model(root, {{"3D/Objects/b.model", other}});
    EXPECT_EQ(corners(loaded),
              (std::vector<Vec3>{
                  {0, 0, 3}, {1, 0, 3}, {0, 2, 3}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 2, 0}}));
    EXPECT_TRUE(loaded.report.notes.empty());  // the build section of the other part does not count
}

TEST_F(ThreeMf, PartsThatDoNotCombineAreRefused) {
    const std::string root = model("", "<item objectid='1' p:path='/b.model'/>", with_p);
    const auto with = [&](const std::string& other) { return archive(root, {{"b.model", other}}); };
    refused_archive(archive(root), {"'/b.model', which is not in its archive"});
    refused_archive(with(model(object(1), "", "unit='inch'")), {"3D/a.model: line ", "in inch, from a part in mm"});
    refused_archive(with(model(object(2), "")), {"objectid=1 names no object of its model part"});
    refused_archive(with(model(object(1, components(component(1, "p:path='/3D/a.model'"))), "", with_p)),
                    {"b.model: line ", "outside of the root model part"});
    refused_archive(with(model(object(1), "", "xmlns:b='" + microsoft + "beamlattice/2017/02' requiredextensions='b'")),
                    {"/b.model: line 2: ", "beam lattices"});
    refused(model(object(1), "<item objectid='1' path='/b.model'/>", with_p), {"without the prefix"});
}

TEST_F(ThreeMf, OnlyTheBuildCounts) {
    const LoadedShape loaded = load_model(model(
        object(1) + object(2) + object(3, mesh, "type='support'") + object(4, components(component(1) + component(3))),
        "<item objectid='4'/>"));
    EXPECT_EQ(corners(loaded).size(), 3u);
    EXPECT_EQ(loaded.report.notes,
              (std::vector<std::string>{
                  "1 object that its build does not use is left out",
                  "1 object of type support is left out: supports only hold the model while it is printed"}));
    refused(model(object(1), ""), {"its build section is empty", "add the objects"});
    refused("<model xmlns='" + core + "'><resources>" + object(1) + "</resources></model>", {"build section is empty"});
    refused(model(object(1, mesh, "type='solidsupport'"), item), {"have no triangle, except supports"});
    refused(model(object(1, "<mesh><vertices><vertex x='0' y='0' z='0'/></vertices></mesh>"), item), {"no triangle"});
}

TEST_F(ThreeMf, TypesOfObjects) {
    EXPECT_EQ(corners(load_model(model(object(1, mesh, "type='surface'"), item))).size(), 3u);
    refused(model(object(1, mesh, "type='other'"), item), {"line 4: ", "type 'other'", "remove it from the build"});
    refused(model(object(1, mesh, "type='x'"), item), {"type=\"x\" is not a type"});
}

TEST_F(ThreeMf, RequiredExtensionsAreRefusedByName) {
    for (const auto& [uri, name] : std::vector<std::pair<std::string, std::string>>{
             {microsoft + "beamlattice/2017/02", "beam lattices (" + microsoft + "beamlattice/2017/02)"},
             {"http://schemas.3mf.io/3dmanufacturing/booleanoperations/2023/07", "boolean operations"},
             {"http://schemas.3mf.io/3dmanufacturing/volumetric/2022/01", "volumetric data"},
             {"http://schemas.3mf.io/3dmanufacturing/displacement/2023/10", "displacement"},
             {microsoft + "securecontent/2019/04", "encrypted parts"},
             {"http://example.com/own", "'http://example.com/own'"}})
        refused(model(object(1), item, "xmlns:b='" + uri + "' requiredextensions=' b '"),
                {"3D/a.model: line 2: ", "not supported, " + name, "export it as a plain mesh"});
    refused(model(object(1), item, "requiredextensions='q'"), {"'q', which no xmlns declares"});
    const LoadedShape loaded = load_model(
        model(object(1), item,
              "xmlns:m='" + microsoft + "material/2015/02' xmlns:t='" + microsoft + "trianglesets/2021/07' xmlns:b='" +
                  microsoft + "beamlattice/2017/02' requiredextensions='m t' recommendedextensions='b'"));
    ASSERT_EQ(loaded.report.notes.size(), 1u);
    EXPECT_EQ(loaded.report.notes[0].find("recommends an extension that is not supported"), 0u);
}

TEST_F(ThreeMf, SurfacesOfExtensionsAreRefusedWhereTheyAreUsed) {
    const std::string beams = "<mesh><vertices/><triangles/><b:beamlattice/></mesh>";
    const std::string with_b = "xmlns:b='" + microsoft + "beamlattice/2017/02'";
    refused(model(object(1, beams), item, with_b), {"line 4: ", "<b:beamlattice>", "beam lattices"});
    EXPECT_EQ(load_model(model(object(1) + object(2, beams), item, with_b)).report.notes.size(), 1u);
    const std::string boolean = "<o:booleanshape objectid='2'/>";
    refused(
        model(object(1, boolean), item, "xmlns:o='http://schemas.3mf.io/3dmanufacturing/booleanoperations/2023/07'"),
        {"<o:booleanshape>", "boolean operations"});
    refused(model(object(1, mesh + "<a:alternatives/>"), item,
                  "xmlns:a='" + microsoft + "production/alternatives/2021/04'"),
            {"alternatives of objects"});
    refused(model(object(1, mesh, "a:modelresolution='lowres'"), item,
                  "xmlns:a='" + microsoft + "production/alternatives/2021/04'"),
            {"modelresolution=\"lowres\""});
    const std::string with_s = "xmlns:s='" + microsoft + "slice/2015/07' requiredextensions='s'";
    refused(model(object(1, mesh, "s:slicestackid='5' s:meshresolution='lowres'"), item, with_s),
            {"low resolution", "full resolution"});
    EXPECT_EQ(load_model(model(object(1, mesh, "s:slicestackid='5'"), item, with_s)).report.notes,
              std::vector<std::string>{"slices of objects are left out: their meshes have full resolution"});
}

TEST_F(ThreeMf, NamespacesDecideWhatAnElementIs) {
    // The same file with a prefix for the core, which an object declares anew; a vertex of another namespace is ignored.
    const std::string xml =
        "<c:model xmlns:c='" + core + "' xmlns:v='http://example.com/v'><c:resources><c:object id='1'><mesh xmlns='" +
        core +
        "'><vertices><vertex x='0' y='0' z='0'/><v:vertex x='9' y='9' z='9'/><vertex x='1' y='0' z='0'/><vertex x='0' "
        "y='2' z='0'/></vertices><triangles><triangle v1='0' v2='1' v3='2'/></triangles></mesh></c:object>"
        "<v:object id='1'/></c:resources><c:build><c:item objectid='1'/><v:item objectid='5'/></c:build></c:model>";
    const LoadedShape loaded = load_model(xml);
    EXPECT_EQ(corners(loaded), (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}}));
    EXPECT_EQ(loaded.report.notes,
              std::vector<std::string>{"<v:vertex> of the private namespace 'http://example.com/v' is left out"});
    refused("<model xmlns='http://example.com/v'/>", {"line 1: ", "'http://example.com/v', which is not the core"});
    refused("<x:model/>", {"is not the core"});
    const LoadedShape bare =
        load_model("<model><resources>" + object(1) + "</resources><build>" + item + "</build></model>");
    ASSERT_EQ(bare.report.notes.size(), 1u);
    EXPECT_NE(bare.report.notes[0].find("no XML namespace"), std::string::npos);
    refused(model(object(1, mesh + "<polygon/>"), item), {"<polygon> is not an element that 3MF has here"});
}

TEST_F(ThreeMf, BrokenModelsAreRefusedWithTheirLine) {
    refused(model(object(1) + object(1), item), {"a.model: line 5: ", "second object with id 1"});
    refused(model(object(1, mesh + mesh), item), {"a second <mesh>"});
    refused(model(object(1, mesh + components("")), item), {"line 4: ", "either a <mesh> or <components>"});
    refused(model(object(1, ""), item), {"either a <mesh> or <components>"});
    refused(model(object(1), "<item objectid='2'/>"), {"line 6: ", "objectid=2 names no object"});
    refused(model(object(1), "<item/>"), {"has no attribute 'objectid'"});
    refused(model(object(1), "<item objectid='1' transform='1 0 0 0 1 0 0 0 1 0 0'/>"), {"is not 12 finite numbers"});
    refused(model(object(1), "<item objectid='1' transform='1 0 0 0 1 0 0 0 inf 0 0 0'/>"), {"12 finite numbers"});
    refused(model(object(1), "<item objectid='1' transform='1 0 0 0 1 0 0 0 x 0 0 0'/>"), {"'x' is not a number"});
    const auto with = [](const std::string& vertex, const std::string& triangle) {
        return model(object(1, "<mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='1' y='0' z='0'/>\n" + vertex +
                                   "</vertices><triangles>" + triangle + "</triangles></mesh>"),
                     item);
    };
    const std::string good = "<triangle v1='0' v2='1' v3='1'/>";
    refused(with("<vertex x='1' y='2'/>", good), {"line 5: ", "<vertex> has no attribute 'z'"});
    refused(with("<vertex x='1' x='1' y='2' z='3'/>", good), {"<vertex> has the attribute 'x' twice"});
    refused(with("<vertex x='1' y='2' z='1,5'/>", good), {"'1,5' is not a number"});
    refused(with("", "<triangle v1='0' v2='1' v3='2'/>"), {"v3=\"2\" names none of the 2 vertices"});
    refused(with("", "<triangle v1='0' v2='1' v3='-1'/>"), {"v3=\"-1\" names none"});
    refused(with("<vertex x='1e999' y='2' z='1'/>", "<triangle v1='0' v2='1' v3='2'/>"), {"not finite"});
    refused("<!DOCTYPE x [<!ENTITY a 'b'>]>" + model(object(1), item), {"document type definition"});
    refused(model(object(1), item) + "<model/>", {"a second root element"});
    refused("nothing", {"3D/a.model: ", "is not XML"});
}

TEST_F(ThreeMf, CyclesAndExplosionsAreRefused) {
    refused(model(object(1, components(component(2))) + object(2, components(component(1))), item),
            {"object 1 contains itself"});
    std::string resources = object(100);
    for (int i = 99; i > 0; --i)
        resources += object(i, components(component(i + 1) + component(i + 1) + component(i + 1)));
    refused(model(resources, item), {"more than 64 objects, points and corners for each byte"});
    std::string deep = object(400);
    for (int i = 399; i > 0; --i) deep += object(i, components(component(i + 1)));
    refused(model(deep, item), {"nested deeper than 256"});
    EXPECT_EQ(corners(load_model(model(deep, "<item objectid='300'/>"))).size(), 3u);
}

TEST_F(ThreeMf, SlicersMarkTrianglesThatAreNotSurface) {
    const LoadedShape loaded =
        load_model(model(object(1), "<item objectid='1' printable='0'/>"),
                   {{"Metadata/Slic3r_PE_model.config",
                     "<metadata type=\"volume\" key=\"volume_type\" value=\"NegativeVolume\"/>"}});
    ASSERT_EQ(loaded.report.notes.size(), 2u);
    EXPECT_NE(loaded.report.notes[0].find("not printable"), std::string::npos);
    EXPECT_NE(loaded.report.notes[1].find("Metadata/Slic3r_PE_model.config some triangles are a NegativeVolume"),
              std::string::npos);
}

TEST_F(ThreeMf, RelationsNameTheRoot) {
    const std::string xml = model(object(1), item);
    const auto with = [&](const std::string& rels, const std::string& path = "x/y.model") {
        return zip_archive({{path, xml}, {"_rels/.rels", rels}});
    };
    EXPECT_EQ(corners(load(with(relations("/x/y.model")))).size(), 3u);
    EXPECT_EQ(corners(load(with(relations("./X//y.MODEL")))).size(), 3u);
    refused_archive(with(relations("/3D/a.model")), {"refers to '/3D/a.model', which is not in its archive"});
    refused_archive(with(relations("../x/y.model")), {"_rels/.rels: line 1: ", "is not a path in the archive"});
    refused_archive(with(relations("/x/y.model", "TargetMode='External'")), {"outside of the archive"});
    refused_archive(with("<Relationships/>"), {"names no 3D model"});
    std::string two = relations("/x/y.model");
    two.insert(two.find("<Relationship "),
               two.substr(two.find("<Relationship "), two.find("</") - two.find("<Relationship ")));
    refused_archive(with(two), {"a second root model part"});
    std::string secure = relations("/x/y.model");
    secure.insert(secure.find("<Relationship "),
                  "<Relationship Id='k' Type='http://schemas.microsoft.com/3dmanufacturing/2019/04/keystore' "
                  "Target='/Secure/keystore.xml'/>");
    refused_archive(with(secure), {"encrypted parts"});
    refused_archive(zip_archive({{"x/y.model", xml}}), {"has no _rels/.rels"});
}

TEST_F(ThreeMf, ArchivesOfAllKindsAreRead) {
    for (const bool deflated : {false, true})
        for (const bool zip64 : {false, true})
            EXPECT_EQ(corners(load(zip_archive({{"3D/", "", false},
                                                {"_rels/.rels", relations(), deflated, zip64},
                                                {"3D/a.model", model(object(1), item), deflated, zip64}},
                                               "a comment PK\x05\x06")))
                          .size(),
                      3u);
}

TEST_F(ThreeMf, DamagedArchivesAreRefused) {
    const std::string xml = model(object(1), item);
    const auto with = [&](ZipEntry entry) {
        if (entry.name.empty()) entry.name = "3D/a.model";
        if (entry.bytes.empty()) entry.bytes = xml;
        return zip_archive({{"_rels/.rels", relations()}, std::move(entry)});
    };
    refused_archive(with({"", "", true, false, 1}), {"'3D/a.model' is encrypted", "without a password"});
    refused_archive(with({"", "", true, false, 0, 12}), {"method 12", "'deflate'"});
    refused_archive(with({"", "", true, false, 0, -1, 100}), {"'/3D/a.model' is damaged"});
    refused_archive(with({"", "", true, false, 0, -1, 5000}), {"is damaged"});
    refused_archive(with({"", "", false, false, 0, -1, 5000}), {"is damaged"});
    refused_archive(with({"", "", true, false, 0, -1, std::int64_t{1} << 31}), {"more than 200 times"});
    refused_archive(with({"", "", true, true, 0, -1, std::int64_t{1} << 62}), {"more than 200 times"});
    refused_archive(with({"", "", true, false, 0, -1, -1, true}), {"its checksum is wrong"});
    refused_archive(with({"", "", true, false, 0, -1, -1, false, "3D/b.model"}), {"is damaged"});
    refused_archive(with({"3d/A.model/../a.model", ""}), {"does not lie in the archive"});
    refused_archive(with({"%2e%2E/a.model", ""}), {"does not lie in the archive"});
    for (const char* again : {"3D/a.model", "3d/A.MODEL", "3d/A%2emodel"})
        refused_archive(archive(xml, {{again, "x"}}), {"a.model' is there twice", "remove one"});
    const std::string sound = archive(xml);
    for (std::size_t size = 2; size < sound.size(); ++size) refused_archive(sound.substr(0, size), {"a.3mf: "});
    refused_archive(sound + " ", {"is not a sound ZIP archive"});
    refused_archive("x" + sound, {"is not a sound ZIP archive"});
    refused_archive("<model/>", {"is not a sound ZIP archive"});
}

TEST_F(ThreeMf, BombsAreRefusedBeforeTheyFillTheMemory) {
    const std::string blank(std::size_t{20} << 20, ' ');
    refused_archive(archive(model(object(1), item) + blank), {"inflates to more than 200 times the size"});
    EXPECT_EQ(corners(load(archive(model(object(1), item) + blank.substr(0, 1 << 20)))).size(), 3u);
}

TEST_F(ThreeMf, AChangedByteNeverCrashes) {
    const std::string sound =
        zip_archive({{"_rels/.rels", relations(), false}, {"3D/a.model", model(object(1), item)}});
    for (std::size_t at = 0; at < sound.size(); ++at) try {
            std::string bytes = sound;
            bytes[at] = static_cast<char>(bytes[at] ^ (at % 2 ? '\x81' : '\xff'));
            load(bytes);
        } catch (const InputError&) {  // a byte of a date may change
        }
}

}  // namespace
}  // namespace hausbench
