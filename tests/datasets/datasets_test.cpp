// Reading files: every format, every kind of damage, our own shape files, and readers that crash.
#include "algorithms/error.h"
#include "datasets/hash.h"
#include "datasets/hdf5.h"
#include "datasets/load.h"
#include "datasets/separate_process.h"
#include "datasets/shape_file.h"
#include "tests/support/temporary_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>

namespace hausbench {
namespace {

class Files : public ::testing::Test {
protected:
    std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_.path() / name, std::ios::binary) << bytes;
        return folder_.path() / name;
    }
    LoadedShape load(const std::string& name, const std::string& bytes, const std::string& format = "") const {
        return load_file(write(name, bytes), {.format = format});
    }
    // Expects an error of one line that names the file and contains all `parts`.
    void refused(const std::string& name, const std::string& bytes, const std::vector<std::string>& parts) const {
        const std::filesystem::path file = write(name, bytes);
        try {
            load_file(file);
            FAIL() << name << " was read";
        } catch (const InputError& error) {
            const std::string message = error.what();
            EXPECT_TRUE(message.starts_with(file.string())) << message;
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
            for (const std::string& part : parts)
                EXPECT_NE(message.find(part), std::string::npos) << message << " lacks " << part;
        }
    }

    TemporaryFolder folder_;
};

const TriangleMesh& mesh_of(const LoadedShape& loaded) { return std::get<TriangleMesh>(loaded.shape); }

bool same_bits(const Points& a, const Points& b) {
    return a.rows() == b.rows() &&
           std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

// A tetrahedron whose coordinates need the full precision of a double.
TriangleMesh awkward() {
    TriangleMesh mesh;
    mesh.vertices.resize(4, 3);
    mesh.vertices << 0.1234567890123, 1.0 / 3, -2.0 / 7, 1e-17, 1.7976931348623157e300, 0.1 + 0.2,  //
        -1e-300, 4503599627370497.5, 5e-10, 3.141592653589793, 2.718281828459045, 1.4142135623730951;
    mesh.triangles.resize(4, 3);
    mesh.triangles << 0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0;
    return mesh;
}

std::string as_text(const TriangleMesh& mesh, const std::string& head, const std::string& before_vertex,
                    const std::string& before_face, int base) {
    std::string text = head;
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v)
        text += fmt::format("{}{:.17g} {:.17g} {:.17g}\n", before_vertex, mesh.vertices(v, 0), mesh.vertices(v, 1),
                            mesh.vertices(v, 2));
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
        text += fmt::format("{}{} {} {}\n", before_face, mesh.triangles(t, 0) + base, mesh.triangles(t, 1) + base,
                            mesh.triangles(t, 2) + base);
    return text;
}

const std::string ply_head =
    "ply\nformat ascii 1.0\ncomment made for a test\nelement vertex 4\nproperty double x\nproperty double y\nproperty "
    "double z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n";

std::string ply_text() { return as_text(awkward(), ply_head, "", "3 ", 0); }

template <class T> void put(std::string& bytes, T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string binary_ply() {
    std::string bytes = ply_head;
    bytes.replace(bytes.find("ascii"), 5, "binary_little_endian");
    const TriangleMesh mesh = awkward();
    for (const double x : mesh.vertices.reshaped<Eigen::RowMajor>()) put(bytes, x);
    for (Eigen::Index t = 0; t < 4; ++t) {
        put(bytes, std::uint8_t{3});
        for (int k = 0; k < 3; ++k) put(bytes, mesh.triangles(t, k));
    }
    return bytes;
}

std::string binary_stl(const std::string& header, std::uint32_t announced, std::uint32_t written, float x = 0) {
    std::string bytes = header;
    bytes.resize(80, ' ');
    put(bytes, announced);
    for (std::uint32_t f = 0; f < written; ++f) {
        for (const float value : {0.f, 0.f, 1.f, x, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, static_cast<float>(f + 1), 0.f})
            put(bytes, value);
        put(bytes, std::uint16_t{0});
    }
    return bytes;
}

const std::string ascii_facet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0.1\n endloop\nendfacet\n";

TEST_F(Files, SeventeenDigitsComeBackBitEqual) {
    const TriangleMesh mesh = awkward();
    const std::map<std::string, std::string> files = {{"a.ply", ply_text()},
                                                      {"b.ply", binary_ply()},
                                                      {"a.off", as_text(mesh, "OFF\n4 4 0\n", "", "3 ", 0)},
                                                      {"a.obj", as_text(mesh, "# a comment\n", "v ", "f ", 1)}};
    for (const auto& [name, bytes] : files) {
        const LoadedShape loaded = load(name, bytes);
        EXPECT_TRUE(same_bits(mesh_of(loaded).vertices, mesh.vertices)) << name;
        EXPECT_EQ(mesh_of(loaded).triangles, mesh.triangles) << name;
        EXPECT_EQ(loaded.report.precision, "float64");
        EXPECT_EQ(loaded.report.unreferenced, 0);
        EXPECT_EQ(loaded.report.format, name.substr(2));
    }
}

TEST_F(Files, AsciiStlKeepsDoublesAndSharesVertices) {
    const LoadedShape loaded = load(
        "a.stl", "solid solid facet\r\n" + ascii_facet +
                     "endsolid x\nSOLID b\n"
                     "FACET NORMAL 0 0 0\nOUTER LOOP\nVERTEX -0.0 0 0\nVERTEX 1 0 0\nVERTEX 0 0.12345678901234567 1\n"
                     "ENDLOOP\nENDFACET\nENDSOLID\n");
    ASSERT_EQ(mesh_of(loaded).triangles.rows(), 2);
    EXPECT_EQ(mesh_of(loaded).vertices.rows(), 4);  // -0 equals +0
    EXPECT_EQ(mesh_of(loaded).vertices(3, 1), 0.12345678901234567);
    EXPECT_EQ(loaded.report.objects, 2);
}

TEST_F(Files, BinaryStlIsKnownByItsSize) {
    for (const std::string header : {"solid of a misleading name\nfacet", "anything"}) {
        const LoadedShape loaded = load("a.stl", binary_stl(header, 3, 3));
        EXPECT_EQ(mesh_of(loaded).triangles.rows(), 3);
        EXPECT_EQ(mesh_of(loaded).vertices.rows(), 5);
    }
}

TEST_F(Files, ObjTraps) {
    const LoadedShape loaded =
        load("a.obj",
             "mtllib x.mtl\r\nv 0 0 0 1 0 0\r\nv\t1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nvt 0 0\r\nvn 0 0 1\r\nv 9 9 9\r\n"
             "g one\r\nf 1/1/1\t2//1 \\\r\n3/1 4\r\ng two\r\nf -5 -4 -3 # tail\r\nf 1 2\r\n");
    EXPECT_EQ(mesh_of(loaded).triangles.rows(), 4);
    EXPECT_EQ(mesh_of(loaded).vertices.rows(), 4);
    EXPECT_EQ(loaded.report.polygons, 1);
    EXPECT_EQ(loaded.report.segments, 1);
    EXPECT_EQ(loaded.report.unreferenced, 1);
    EXPECT_EQ(loaded.report.objects, 2);
    EXPECT_TRUE(loaded.report.notes.empty());
    std::string wide = "\xff\xfe";
    for (const char c : std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")) wide.append({c, '\0'});
    EXPECT_EQ(mesh_of(load("wide.obj", wide)).triangles.rows(), 1);
}

// Old Macs end lines with \r. Such an OBJ file was once read as a single line with one point.
TEST_F(Files, LinesMayEndWithACarriageReturnAlone) {
    const std::vector<std::pair<std::string, std::string>> files = {
        {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0 # corner\nv 0 0 1\nf 1 2 3\nf 1 \\\n2 4\n"},
        {"a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0 # corner\n0 0 1\n3 0 1 2\n3 0 1 3\n"},
        {"a.ply",
         "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
         "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n"}};
    for (const auto& [name, text] : files) {
        std::string old = text;
        std::replace(old.begin(), old.end(), '\n', '\r');
        const LoadedShape loaded = load_file(write(name, old)), same = load_file(write(name, text));
        EXPECT_EQ(points_of(loaded.shape).rows(), 4) << name;
        EXPECT_EQ(element_count(loaded.shape), 2) << name;
        EXPECT_EQ(content_hash(loaded.shape), content_hash(same.shape)) << name;
    }
    refused("b.obj", "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 x\r", {"line 4", "'x'"});
}

TEST_F(Files, OffTraps) {
    const std::string body = "0 0 0\n\n1 0 0 # why\n1 1 0\n# between\n0 1 0\n5 5 5\n4 0 1 2 3\n\n3 0 1 2 255 0 0\n";
    for (const std::string head :
         {"OFF\n5 2 0\n", "# first\nOFF 5 2 0\n", "5 2 0\n", "OFF\n5 2\n", "COFF\n5 2 0\n", "STOFF\r\n5 2 0\r\n"}) {
        const LoadedShape loaded = load("a.off", head + body);
        EXPECT_EQ(mesh_of(loaded).triangles.rows(), 3) << head;
        EXPECT_EQ(mesh_of(loaded).vertices.rows(), 4) << head;
        EXPECT_EQ(loaded.report.polygons, 1) << head;
        EXPECT_EQ(loaded.report.unreferenced, 1) << head;
    }
    const LoadedShape four = load("four.off", "4OFF\n3 1 0\n2 0 0 2\n0 2 0 2\n0 0 1 0.5\n3 0 1 2\n");
    EXPECT_EQ(mesh_of(four).vertices, (Points(3, 3) << 1, 0, 0, 0, 1, 0, 0, 0, 2).finished());
}

TEST_F(Files, PlyTraps) {
    const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    const LoadedShape whole =
        load("a.ply",
             "ply\r\ncomment first\nformat ascii 1.0\nCreated by nobody\n\nelement vertex 3\nproperty int x\n"
             "property int y\nproperty int z\nelement face 1\nproperty list uchar ushort vertex_index\nend_header\n" +
                 body);
    EXPECT_EQ(mesh_of(whole).triangles.rows(), 1);
    refused("z.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n",
            {"x, y and z"});
}

TEST_F(Files, VerticesWithoutFacesAreAPointSet) {
    const std::map<std::string, std::string> files = {
        {"a.obj", "v 0 0 0\nv 1 2 3\np 1 2\n"},
        {"a.off", "OFF\n2 0 0\n0 0 0\n1 2 3\n"},
        {"a.ply",
         "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 "
         "0 0\n1 2 3\n"}};
    for (const auto& [name, bytes] : files) {
        const LoadedShape loaded = load(name, bytes);
        ASSERT_EQ(kind_of(loaded.shape), ShapeKind::points) << name;
        EXPECT_EQ(points_of(loaded.shape), (Points(2, 3) << 0, 0, 0, 1, 2, 3).finished()) << name;
    }
}

TEST_F(Files, ConcavePolygonsKeepTheirOutline) {
    // A concave face of area 1; a fan of triangles from its first corner would cover more.
    const LoadedShape loaded = load("a.obj", "v 0 2 0\nv -1 0 0\nv 0 1 0\nv 1 0 0\nf 2 3 4 1\n");
    const TriangleMesh& mesh = mesh_of(loaded);
    double area = 0;
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        const auto corner = [&](int k) -> Vec3 { return mesh.vertices.row(mesh.triangles(t, k)).transpose(); };
        area += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 2;
    }
    EXPECT_EQ(mesh.triangles.rows(), 2);
    EXPECT_DOUBLE_EQ(area, 1);
}

TEST_F(Files, DegenerateTrianglesAndShortFacesStay) {
    const LoadedShape loaded = load("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 1 2\nf 1 2 3\nf 3\nf 1 1 2 2\n");
    EXPECT_EQ(mesh_of(loaded).triangles.rows(), 4);
    EXPECT_EQ(loaded.report.single_points, 1);
}

TEST_F(Files, GzippedAndMisnamedFiles) {
    const std::string text = ply_text();
    const std::filesystem::path file = folder_.path() / "a.ply.gz";
    gzFile out = gzopen(file.c_str(), "wb");
    gzwrite(out, text.data(), static_cast<unsigned>(text.size()));
    gzclose(out);
    EXPECT_TRUE(same_bits(mesh_of(load_file(file)).vertices, awkward().vertices));
    std::ifstream in(file, std::ios::binary);
    const std::string packed{std::istreambuf_iterator<char>(in), {}};
    refused("cut.ply.gz", packed.substr(0, packed.size() - 20), {"inflated"});

    out = gzopen((folder_.path() / "bomb.obj.gz").c_str(), "wb");
    const std::string blank(1 << 20, ' ');
    for (int megabyte = 0; megabyte < 80; ++megabyte) gzwrite(out, blank.data(), static_cast<unsigned>(blank.size()));
    gzclose(out);
    try {
        load_file(folder_.path() / "bomb.obj.gz");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("times its size"), std::string::npos) << error.what();
    }
    EXPECT_TRUE(same_bits(mesh_of(load("a.js", text, "ply")).vertices, awkward().vertices));
}

TEST_F(Files, ElementsOfPlyWithoutPropertiesCostNothing) {
    std::string head =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
        "property double z\nelement face 1\nproperty list uchar int vertex_indices\n";
    for (int i = 0; i < 20; ++i) head += "element nothing 80\n";
    std::string body(72, '\0');
    const double one = 1;
    std::memcpy(body.data() + 24, &one, sizeof one);
    std::memcpy(body.data() + 56, &one, sizeof one);
    const std::int32_t corners[] = {0, 1, 2};
    body += '\3' + std::string(reinterpret_cast<const char*>(corners), sizeof corners);
    EXPECT_EQ(mesh_of(load("a.ply", head + "end_header\n" + body)).triangles.rows(), 1);
    refused("b.ply",
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float x\nproperty float "
            "y\nend_header\n0 0 0\n",
            {"x, y and z"});
}

TEST_F(Files, CountsOfOffMayHaveADecimalPoint) {
    EXPECT_EQ(mesh_of(load("a.off", "OFF\n3.0, 1.0 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")).triangles.rows(), 1);
    refused("b.off", "OFF\n3.5 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", {"3.5", "not a count"});
}

TEST_F(Files, BadFilesAreRefusedWithTheirPlace) {
    const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    refused("empty.obj", "", {"empty"});
    refused("none", "v 0 0 0\n", {"format"});
    refused("words.obj", "this is no mesh\n", {"no vertices"});
    refused("nan.obj", "v 0 0 0\n# x\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", {"line 3", "vertex 1 (from 0)"});
    refused("inf.obj", "v 0 0 0\nv 1 0 0\nv 0 inf 0\nf 1 2 3\n", {"line 3", "vertex 2 (from 0)"});
    refused("huge.obj", "v 0 0 1e999\n" + three + "f 1 2 3\n", {"line 1", "vertex 0 (from 0)"});
    refused("short.obj", "v 0 0\n" + three + "f 1 2 3\n", {"line 1"});
    refused("range.obj", three + "f 1 2 4\n", {"line 4", "vertex 3 (from 0), but there are 3"});
    refused("minus.obj", three + "f 1 2 -9\n", {"line 4", "but there are 3"});
    refused("zero.obj", three + "f 0 1 2\n", {"line 4", "'0'"});
    refused("word.obj", three + "f 1 two 3\n", {"line 4", "'two'"});
    refused("fortran.obj", "v 0 0 0\nv 1.5D3 0 0\nv 0 1 0\nf 1 2 3\n", {"line 2", "'1.5D3'"});
    refused("empty.obj", three + "f\n", {"none of its faces has a corner"});

    refused("nan.off", "OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", {"line 4", "vertex 1 (from 0)"});
    refused("range.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", {"line 6", "face 0"});
    refused("minus.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", {"line 6", "face 0"});
    refused("cut.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", {"1 of 2 faces"});
    refused("memory.off", "OFF\n3000000000 1 0\n0 0 0\n", {"announces 3000000000"});
    refused("fortran.off", "OFF\n3 1 0\n0 0 0\n1 0 3.1+e2\n0 1 0\n3 0 1 2\n", {"line 4", "'3.1+e2'"});
    refused("no.off", "hello\n", {"OFF"});

    refused("nan.ply", ply_head + "0 0 0\n0 nan 0\n0 0 1\n0 1 0\n3 0 1 2\n3 0 1 3\n3 0 1 2\n3 0 1 2\n",
            {"vertex 1 (from 0)", "0 nan 0", "--drop-invalid"});
    refused("word.ply", ply_head + "0 0 0\n0 x 0\n0 0 1\n0 1 0\n3 0 1 2\n3 0 1 3\n", {"1 of 4 vertices"});
    std::string nan = binary_ply();
    const double quiet = std::numeric_limits<double>::quiet_NaN();
    std::memcpy(nan.data() + nan.find("end_header\n") + 11 + 5 * 8, &quiet, 8);
    refused("nan2.ply", nan, {"vertex 1 (from 0)", "nan"});
    std::string range = binary_ply();
    const int nine = 9;
    std::memcpy(range.data() + range.size() - 4, &nine, 4);
    refused("range.ply", range, {"face 3 (from 0) names vertex 9"});
    refused("cut.ply", binary_ply().substr(0, binary_ply().size() - 5), {"truncated", "3 of 4 faces"});
    refused("cut2.ply", binary_ply().substr(0, binary_ply().size() - 80), {"truncated", "bytes found"});
    refused("cut3.ply", ply_text().substr(0, ply_text().size() - 3), {"truncated", "3 of 4 faces"});
    refused("head.ply", ply_head.substr(0, ply_head.find("property")), {"end_header"});
    refused("memory.ply",
            "ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nproperty float y\nproperty float "
            "z\nend_header\n0 0 0\n",
            {"announces 99999999999"});

    refused("cut.stl", binary_stl("x", 3, 2), {"3 facets take 234 bytes, 184 bytes found"});
    refused("long.stl", binary_stl("x", 1, 2), {"1 facets take 134 bytes, 184 bytes found"});
    refused("nan.stl", binary_stl("x", 2, 2, std::numeric_limits<float>::infinity()), {"vertex 0 of facet 0"});
    refused("cut2.stl", "solid x\n" + ascii_facet, {"truncated"});
    refused("nan2.stl",
            "solid x\n" + ascii_facet +
                "facet\nouter loop\nvertex 0 0 0\nvertex 0 NaN 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\n",
            {"line 12", "vertex 4 (from 0)"});
    refused("fortran.stl",
            "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 0 1d3 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\n",
            {"line 5", "'1d3'"});
    refused("four.stl",
            "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 "
            "0\nendloop\nendfacet\nendsolid\n",
            {"line 9", "4 vertices"});
    refused("nothing.stl", "solid\nendsolid\n", {"no vertices"});
    refused("model.ase", "*MESH", {"3ds Max", "export OBJ"});
    refused("faceless.ply",
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
            "property list uchar int vertex_indices\nend_header\n0 0 0\n",
            {"element face"});

    refused("junk.gltf", "{ this is not JSON", {"JSON", "fetch or save"});
    EXPECT_THROW(load_file(folder_.path() / "absent.obj"), InputError);
    std::filesystem::create_directory(folder_.path() / "folder.obj");
    EXPECT_THROW(load_file(folder_.path() / "folder.obj"), InputError);
}

TEST_F(Files, ShapeFilesComeBackBitEqual) {
    LoadedShape mesh{awkward(), {"ply", "float32", true, std::nullopt, 3, 2}};
    mesh.report.unreferenced = std::nullopt;
    mesh.report.segments = 4;
    mesh.report.single_points = 5;
    mesh.report.dropped_points = 6;
    mesh.report.dropped_faces = 7;
    mesh.report.stated = {"inch", 25400, 'Y'};
    mesh.report.notes = {"one", "two, with a comma"};
    const std::filesystem::path file = folder_.path() / "shape.h5";
    write_shape(file, mesh);
    const LoadedShape back = read_shape(file);
    EXPECT_TRUE(same_bits(points_of(back.shape), points_of(mesh.shape)));
    EXPECT_EQ(mesh_of(back).triangles, mesh_of(mesh).triangles);
    EXPECT_EQ(content_hash(back.shape), content_hash(mesh.shape));
    EXPECT_EQ(back.report.precision, "float32");
    EXPECT_FALSE(back.report.unreferenced.has_value());
    EXPECT_EQ(back.report.polygons, 3);
    EXPECT_EQ(back.report.objects, 2);
    EXPECT_EQ(back.report.segments, 4);
    EXPECT_EQ(back.report.single_points, 5);
    EXPECT_EQ(back.report.dropped_points, 6);
    EXPECT_EQ(back.report.dropped_faces, 7);
    EXPECT_EQ(back.report.stated.unit, "inch");
    EXPECT_EQ(back.report.stated.micrometres, 25400);
    EXPECT_EQ(back.report.stated.up, 'Y');
    EXPECT_EQ(back.report.notes, mesh.report.notes);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1);  // no temporary file is left

    write_shape(file, {PointSet{awkward().vertices}, {}});
    EXPECT_EQ(kind_of(read_shape(file).shape), ShapeKind::points);
    EXPECT_NE(content_hash(PointSet{awkward().vertices}), content_hash(awkward()));
    EXPECT_THROW(write_shape(folder_.path() / "absent" / "x.h5", mesh), std::runtime_error);

    EXPECT_THROW(read_shape(write("text.h5", "no HDF5")), InputError);
}

TEST_F(Files, ADamagedShapeFileIsNoticed) {
    const std::filesystem::path file = folder_.path() / "shape.h5";
    write_shape(file, {awkward(), {}});
    std::ifstream in(file, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const double third = 1.0 / 3;
    const std::size_t at = bytes.find(std::string(reinterpret_cast<const char*>(&third), 8));
    ASSERT_NE(at, std::string::npos);
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
    EXPECT_THROW(read_shape(write("shape.h5", bytes)), InputError);
}

TEST_F(Files, ShapeProblemsAreNamed) {
    TriangleMesh mesh = awkward();
    EXPECT_EQ(shape_problem(mesh), "");
    mesh.vertices(2, 1) = std::numeric_limits<double>::infinity();
    EXPECT_NE(shape_problem(mesh).find("vertex 2 (from 0)"), std::string::npos);
    mesh = awkward();
    mesh.triangles(3, 0) = 4;
    EXPECT_NE(shape_problem(mesh).find("triangle 3 (from 0) names vertex 4 of 4"), std::string::npos);
    mesh = awkward();
    mesh.triangles.conservativeResize(1, 3);
    EXPECT_NE(shape_problem(mesh).find("vertex 3 (from 0) belongs to no triangle"), std::string::npos);
    EXPECT_NE(shape_problem(PointSet{}), "");
}

TEST_F(Files, Hdf5ColumnsComeBack) {
    const std::filesystem::path path = folder_.path() / "x.h5";
    const std::vector<std::string> texts = {"", "plain", "Größe\n2"};
    {
        h5::File file(path, h5::Open::create);
        file.write("a/b/doubles", std::vector<double>{1, 2, 3, 4, 5, 6}, 3);
        file.write("a/integers", std::vector<std::int64_t>{-1, 1});
        file.write("a/unsigned", std::vector<std::uint64_t>{~std::uint64_t{0}});
        file.write("a/texts", texts);
        file.write("a/none", std::vector<double>{});
        file.attribute("a", "number", std::int64_t{-7});
        file.attribute("", "text", std::string("wörter"));
        file.attribute("new/group", "text", std::string());
        file.attribute("new/group", "text", std::string("again"));
        EXPECT_THROW(file.write("a/odd", std::vector<double>{1, 2}, 3), std::logic_error);
        file.close();
    }
    const h5::File file(path, h5::Open::read);
    EXPECT_EQ(file.read_doubles("a/b/doubles"), (std::vector<double>{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(file.read_integers("a/integers"), (std::vector<std::int64_t>{-1, 1}));
    EXPECT_EQ(file.read_indices("a/integers"), (std::vector<std::int32_t>{-1, 1}));
    EXPECT_EQ(file.read_unsigned("a/unsigned"), (std::vector<std::uint64_t>{~std::uint64_t{0}}));
    EXPECT_EQ(file.read_texts("a/texts"), texts);
    EXPECT_TRUE(file.read_doubles("a/none").empty());
    EXPECT_EQ(file.integer_attribute("a", "number"), -7);
    EXPECT_EQ(file.text_attribute("/", "text"), "wörter");
    EXPECT_EQ(file.text_attribute("new/group", "text"), "again");
    EXPECT_TRUE(file.has("a/b/doubles"));
    EXPECT_FALSE(file.has("a/c/doubles"));
    EXPECT_FALSE(file.has_attribute("nowhere", "x"));
    EXPECT_EQ(file.children("a"), (std::vector<std::string>{"b", "integers", "none", "texts", "unsigned"}));
    EXPECT_THROW(file.read_integers("a/unsigned"), std::runtime_error);  // the value would be clamped silently
    EXPECT_THROW(file.read_unsigned("a/integers"), std::runtime_error);
    EXPECT_THROW(file.read_doubles("a/texts"), std::runtime_error);
    EXPECT_THROW(file.read_doubles("absent"), std::runtime_error);
    EXPECT_THROW(h5::File(folder_.path() / "absent.h5", h5::Open::read), std::runtime_error);
}

TEST_F(Files, Sha256IsTheStandardOne) {
    EXPECT_EQ(Sha256().add("abc", 3).hex(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256_of_file(write("abc", "abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_NE(Sha256().add("ab").add("c").hex(), Sha256().add("a").add("bc").hex());
    EXPECT_THROW(sha256_of_file(folder_.path() / "absent"), InputError);
    EXPECT_THROW(sha256_of_file(folder_.path()), InputError);
}

class Isolated : public Files {
protected:
    // Makes a shell script that is called in place of the program: load [--format F] -- FILE OUT.
    std::filesystem::path script(const std::string& body) const {
        const std::filesystem::path file = write("program", "#!/bin/sh\n" + body);
        std::filesystem::permissions(file, std::filesystem::perms::owner_all);
        return file;
    }
    std::string message(const std::string& body, double seconds = 60, std::int64_t bytes = 0) const {
        try {
            load_separately(script(body), "mesh.obj", {}, {}, seconds, bytes);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }
};

TEST_F(Isolated, TheChildsShapeComesBack) {
    write_shape(folder_.path() / "shape.h5", {awkward(), {}});
    const auto program = script(fmt::format(
        "[ \"$1 $2 $3 $4 $5\" = 'load --format obj -- mesh.obj' ] && cp {}/shape.h5 \"$6\"", folder_.path().string()));
    EXPECT_TRUE(
        same_bits(points_of(load_separately(program, "mesh.obj", {.format = "obj"}).shape), awkward().vertices));
}

TEST_F(Isolated, AProgressLineIsDrawnMeanwhile) {
    write_shape(folder_.path() / "shape.h5", {awkward(), {}});
    int calls = 0;
    load_separately(script(fmt::format("sleep 0.2; cp {}/shape.h5 \"$4\"", folder_.path().string())), "mesh.obj", {},
                    [&] { ++calls; });
    EXPECT_GT(calls, 5);
}

TEST_F(Isolated, TheChildsFailuresAreTold) {
    EXPECT_EQ(message("echo noise >&2; echo 'hausbench: mesh.obj: line 3: bad' >&2; exit 2"), "mesh.obj: line 3: bad");
    EXPECT_NE(message("kill -SEGV $$").find("killed by signal 11"), std::string::npos);
    EXPECT_NE(message("sleep 60", 0.2).find("did not finish within 0.2 s"), std::string::npos);
    EXPECT_NE(message("exec dd if=/dev/zero of=/dev/null bs=200M", 60, 50'000'000).find("more than 50 MB of memory"),
              std::string::npos);
    EXPECT_EQ(message("printf 'mesh.obj: \\033[2J\\r' >&2; exit 2"), "mesh.obj:  [2J");
    EXPECT_NE(message("exec 2>&-; sleep 60", 0.2).find("did not finish"), std::string::npos);
    EXPECT_NE(message("echo oh >&2; exit 3").find("exit code 3: oh"), std::string::npos);
    EXPECT_NE(message("echo 'hausbench: out of memory' >&2; exit 4").find("ran out of memory"), std::string::npos);
    EXPECT_NE(message("exit 0").find("shape.h5"), std::string::npos);
    EXPECT_THROW(load_separately(folder_.path() / "absent", "mesh.obj"), InputError);
}

TEST_F(Isolated, TheProgramItselfReads) {
    const char* program = std::getenv("HAUSBENCH_PROGRAM");
    if (!program || !std::filesystem::exists(program)) GTEST_SKIP() << "the program is not built";
    EXPECT_TRUE(same_bits(points_of(load_separately(program, write("a.ply", ply_text())).shape), awkward().vertices));
    try {
        load_separately(program, write("bad.obj", "v 0 0 0\nv 1 nan 0\n"));
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("line 2: vertex 1 (from 0)"), std::string::npos) << error.what();
    }
}

TEST(NearestHint, NamesTheSlipOrTheList) {
    EXPECT_EQ(nearest_hint("tolerence", {"motion", "tolerance"}), " (did you mean 'tolerance'?)");
    EXPECT_EQ(nearest_hint("zebra", {"motion", "tolerance"}), " (known: motion, tolerance)");
    EXPECT_EQ(nearest_hint("x", {}), "");
}

}  // namespace
}  // namespace hausbench
