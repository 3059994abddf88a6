// glTF 2.0: containers, accessors, primitives, nodes and extensions, and every kind of file that is refused.
#include "datasets/load.h"
#include "tests/support/reading.h"
#include "tests/support/temporary_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace hausbench {
namespace {

using Json = nlohmann::json;

template <class Number> std::string bytes_of(const std::vector<Number>& numbers) {
    std::string bytes(numbers.size() * sizeof(Number), '\0');
    std::copy_n(static_cast<const char*>(static_cast<const void*>(numbers.data())), bytes.size(), bytes.begin());
    return bytes;
}

std::string base64(const std::string& bytes) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
    }
    return text;
}

// Returns a file of one triangle in floats, with the corners (0, 0, 0), (1, 0, 0) and (0, 2, 0), of which the fourth
// point (0, 0, 4) is not one. The bytes follow in `binary()`.
Json triangle() {
    return Json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 6}],
        "buffers": [{"byteLength": 54}]})");
}

std::string binary() {
    return bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 4}) + bytes_of<std::uint16_t>({0, 1, 2});
}

std::string number(std::size_t value) { return bytes_of<std::uint32_t>({static_cast<std::uint32_t>(value)}); }

std::string glb(std::string json, std::string bin) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    bin.resize((bin.size() + 3) / 4 * 4, '\0');
    return "glTF" + number(2) + number(28 + json.size() + bin.size()) + number(json.size()) + "JSON" + json +
           number(bin.size()) + std::string("BIN\0", 4) + bin;
}

// Appends an accessor over data of its own, and returns its index.
template <class Number>
std::size_t append(Json& json, std::string& bin, const std::vector<Number>& numbers, int component, const char* type,
                   std::size_t components, std::size_t stride = 0) {
    std::string data = bytes_of(numbers);
    const std::size_t size = components * sizeof(Number), count = numbers.size() / components;
    if (stride) {
        std::string spread;
        for (std::size_t i = 0; i < count; ++i)
            spread += data.substr(i * size, size) + std::string(stride - size, '\x7f');
        data = spread;
    }
    bin.resize((bin.size() + 3) / 4 * 4, '\0');
    Json view = {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", data.size()}};
    if (stride) view["byteStride"] = stride;
    json["accessors"].push_back(
        {{"bufferView", json["bufferViews"].size()}, {"componentType", component}, {"count", count}, {"type", type}});
    json["bufferViews"].push_back(view);
    bin += data;
    json["buffers"][0]["byteLength"] = bin.size();
    return json["accessors"].size() - 1;
}

class Gltf : public Reading {
protected:
    Gltf() : Reading("a.glb") {}

    using Reading::load;
    using Reading::refused;
    LoadedShape load(const Json& json, const std::string& bin = binary()) const { return load(glb(json.dump(), bin)); }
    std::vector<Vec3> corners(const Json& json, const std::string& bin = binary()) const {
        const LoadedShape loaded = load(json, bin);
        return kind_of(loaded.shape) == ShapeKind::points ? rows(loaded) : Reading::corners(loaded);
    }
    void refused(const Json& json, const std::vector<std::string>& parts, const std::string& bin = binary()) const {
        refused(glb(json.dump(), bin), parts);
    }
    void noted(const Json& json, const std::string& note, const std::string& bin = binary()) const {
        expect_note(load(json, bin), note);
    }

    const std::vector<Vec3> at_rest_ = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
};

TEST_F(Gltf, ATriangleIsReadToTheLastBit) {
    std::string bin = binary();
    const float odd = 0.1f;
    bin.replace(12, 4, bytes_of<float>({odd}));
    const auto points = corners(triangle(), bin);
    EXPECT_EQ(points, (std::vector<Vec3>{{0, 0, 0}, {double(odd), 0, 0}, {0, 2, 0}}));
    const LoadedShape loaded = load(triangle());
    EXPECT_EQ(loaded.report.format, "glb");
    EXPECT_TRUE(loaded.report.float32);
    EXPECT_EQ(loaded.report.objects, 1);
    EXPECT_EQ(loaded.report.stated.unit, "m");
    EXPECT_EQ(loaded.report.stated.micrometres, 1e6);
    EXPECT_EQ(loaded.report.stated.up, 'Y');
    EXPECT_TRUE(loaded.report.notes.empty());
    EXPECT_EQ(points_of(loaded.shape).rows(), 3);  // no face uses the fourth point
}

TEST_F(Gltf, AnUnusedPointMayBeNaN) {
    std::string bin = binary();
    bin.replace(36, 4, bytes_of<float>({NAN}));
    EXPECT_EQ(corners(triangle(), bin), at_rest_);
    bin.replace(12, 4, bytes_of<float>({NAN}));
    refused(triangle(), {"not finite"}, bin);
}

TEST_F(Gltf, BuffersAreInsideOrBesideTheFile) {
    Json json = triangle();
    json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(binary());
    const auto read = [&](const std::string& name) { return points_of(load(name, json.dump()).shape).rows(); };
    EXPECT_EQ(read("a.gltf"), 3);
    json["buffers"][0]["uri"] = "data:application/gltf-buffer;base64," + base64(binary() + "x");  // padding
    EXPECT_EQ(read("a.gltf"), 3);
    std::filesystem::create_directory(folder_.path() / "sub");
    std::ofstream(folder_.path() / "sub" / "two words%.bin", std::ios::binary) << binary();
    json["buffers"][0]["uri"] = "sub/two%20words%25.bin";
    EXPECT_EQ(read("a.gltf"), 3);
    EXPECT_EQ(read("a.glb"), 3);  // the contents count, not the ending
    const auto bad = [&](const std::string& uri, const std::vector<std::string>& parts) {
        json["buffers"][0]["uri"] = uri;
        refused("a.gltf", json.dump(), parts);
    };
    const TemporaryFolder elsewhere;
    std::ofstream(elsewhere.path() / "a.bin", std::ios::binary) << binary();
    std::filesystem::create_symlink(elsewhere.path() / "a.bin", folder_.path() / "out.bin");
    std::filesystem::create_directory_symlink(elsewhere.path(), folder_.path() / "out");
    std::filesystem::create_symlink(folder_.path() / "sub" / "two words%.bin", folder_.path() / "in.bin");
    json["buffers"][0]["uri"] = "in.bin";
    EXPECT_EQ(read("a.gltf"), 3);
    bad("out.bin", {"a link out of its folder"});
    bad("out/a.bin", {"a link out of its folder"});
    bad("missing.bin", {"'missing.bin'", "which is not there"});
    bad("../a.bin", {"not below its own folder"});
    bad("%2e%2e/a.bin", {"not below its own folder"});
    bad("/etc/passwd", {"not below its own folder"});
    bad("http://x/a.bin", {"buffer 0 (from 0)", "is not a file beside this one", ".glb"});
    bad("file:///etc/passwd", {"is not a file beside this one"});
    bad("a%2.bin", {"two digits", "%25"});
    bad("data:text/plain,abc", {"not base64"});
    bad("data:;base64,AB*D", {"not base64"});
    bad("data:;base64,AAAA", {"has 3 bytes, not the 54"});
    bad("", {"refers to the file ''"});
}

TEST_F(Gltf, OtherFilesAreNeverOpened) {
    Json json = triangle();
    json["images"] = {{{"uri", "missing.png"}}};
    json["buffers"].push_back({{"byteLength", 10}, {"uri", "missing.bin"}});
    json["bufferViews"].push_back({{"buffer", 1}, {"byteLength", 10}});
    json["accessors"].push_back({{"bufferView", 2}, {"componentType", 5126}, {"count", 9}, {"type", "VEC3"}});
    json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 2;
    EXPECT_EQ(corners(json), at_rest_);
}

TEST_F(Gltf, DamagedContainersAreRefused) {
    const std::string whole = glb(triangle().dump(), binary());
    refused(whole.substr(0, whole.size() - 4), {"truncated", "header announces"});
    refused(whole.substr(0, 10), {"ends inside of its header"});
    std::string damaged = whole;
    damaged[4] = 1;
    refused(damaged, {"GLB of version 1", "gltf-pipeline"});
    damaged = whole;
    damaged[14] = '\x7f';
    refused(damaged, {"chunk 0 (from 0) ends after the end"});
    damaged = whole;
    damaged[16] = 'X';
    refused(damaged, {"does not begin with a JSON chunk"});
    damaged = glb(triangle().dump(), "");
    refused(damaged, {"buffer 0 (from 0): has 0 bytes, not the 54"});
    refused("glTF" + number(2) + number(12), {"does not begin with a JSON chunk"});
    const LoadedShape loaded = load(whole + "abc");
    ASSERT_EQ(loaded.report.notes.size(), 1u);
    EXPECT_EQ(loaded.report.notes[0], "has 3 bytes after the end that its header states, which are ignored");
}

TEST_F(Gltf, DamagedJsonIsRefused) {
    refused("a.gltf", "{\"asset\": ", {"JSON cannot be parsed"});
    refused("a.gltf", "[]", {"not an object"});
    refused("a.gltf", "{}", {"has no 'asset'"});
    refused("a.gltf", R"({"asset": {"version": "1.0"}})", {"version '1.0'", "gltf-pipeline"});
    refused("a.gltf", R"({"asset": {"version": "2.1", "minVersion": "2.1"}})", {"version '2.1'"});
    for (const char* version : {"3.0", "2.x", "2", "2.", "20", "", "2.0.1"})
        refused("a.gltf", fmt::format(R"({{"asset": {{"version": "{}"}}}})", version),
                {fmt::format("version '{}'", version)});
    refused("a.gltf", R"({"asset": {"version": 2.0}})", {"'version' is not a string"});
    const std::string empty = R"({"asset": {"version": "2.0"}} )";
    for (const char* more : {"// made by hand", "}", " <!-- a } -->", "{}"})
        refused("a.gltf", empty + more,
                {fmt::format("{} bytes follow the end of its JSON, at byte 29", std::string(more).size() + 1),
                 "remove them"});
    refused("a.gltf", empty + std::string("\0x", 2), {"its JSON has a zero byte at byte 30"});
    refused("a.gltf", empty + std::string("\0\0", 2), {"has no scene"});  // padding
    refused("a.gltf", std::string(100000, '['), {"nested deeper than 128"});
    refused("a.gltf", R"({"asset": {"version": "2.0"}, "nodes": [], "nodes": []})", {"key 'nodes' twice"});
    refused("a.gltf", "{\"a\": \"\xff\"}", {"JSON cannot be parsed"});
    refused("a.gltf", R"({"a": 1e999})", {"JSON cannot be parsed"});
    for (const Json& wrong : {Json(-1), Json(0.5), Json("0"), Json(nullptr), Json(1e300), Json::array()}) {
        Json json = triangle();
        json["accessors"][0]["count"] = wrong;
        refused(json, {"accessor 0 (from 0)", "'count' is not a count"});
    }
}

TEST_F(Gltf, ReferencesAreChecked) {
    const auto bad = [&](const char* pointer, const Json& value, const std::vector<std::string>& parts) {
        Json json = triangle();
        json[Json::json_pointer(pointer)] = value;
        refused(json, parts);
    };
    bad("/scenes/0/nodes/0", 7, {"node 7 (from 0), but there are 1"});
    bad("/nodes/0/mesh", 1, {"mesh 1 (from 0), but there are 1"});
    bad("/meshes/0/primitives/0/attributes/POSITION", 9, {"accessor 9"});
    bad("/accessors/0/bufferView", 2, {"bufferView 2"});
    bad("/bufferViews/0/buffer", 1, {"buffer 1"});
    bad("/bufferViews/0/byteLength", 55, {"bufferView 0 (from 0)", "buffer 0 (from 0) has 54 bytes"});
    bad("/bufferViews/0/byteOffset", 9007199254740991, {"bufferView 0 (from 0)"});
    bad("/accessors/0/count", 5, {"accessor 0 (from 0)", "5 elements do not fit"});
    bad("/accessors/0/count", 9007199254740991, {"do not fit"});
    bad("/accessors/0/byteOffset", 1, {"do not fit"});
    bad("/accessors/0/byteOffset", 49, {"do not fit"});
    bad("/accessors/0/count", 0, {"has no elements"});
    bad("/accessors/0/type", "MAT4", {"'MAT4'"});
    bad("/accessors/0/type", "VEC2", {"accessor 0", "not a VEC3 of FLOAT"});
    bad("/accessors/0/componentType", 5130, {"5130 is not known"});
    bad("/accessors/0/componentType", 5125, {"not a VEC3 of FLOAT"});
    bad("/accessors/1/componentType", 5122, {"accessor 1", "unsigned integers"});
    bad("/accessors/1/normalized", true, {"accessor 1", "unsigned integers"});
    bad("/bufferViews/0/byteStride", 8, {"its elements have 12 bytes, but the byteStride is 8"});
    bad("/nodes/0", 3, {"node 0 (from 0): is not an object"});
    bad("/meshes/0/primitives/0/mode", 7, {"mode 7"});
    bad("/nodes/0/translation", {1, 2}, {"'translation' has 2 numbers, not 3"});
    bad("/nodes/0/translation", {1, 2, "x"}, {"not a number"});
    bad("/scene", 1, {"scene 1 (from 0), but there are 1"});
    std::string bin = binary();
    bin.replace(48, 2, bytes_of<std::uint16_t>({4}));
    refused(triangle(), {"accessor 1 (from 0)", "index 0 (from 0) is 4, but the primitive has 4 points"}, bin);
    bin.replace(48, 2, bytes_of<std::uint16_t>({65535}));
    refused(triangle(), {"is 65535", "restarts"}, bin);
}

TEST_F(Gltf, ComponentTypesHaveTheValuesOfTheSpecification) {
    const auto check = [&](auto numbers, int component, bool normalized, std::vector<Vec3> where, std::size_t stride) {
        Json json = triangle();
        std::string bin = binary();
        const std::size_t index = append(json, bin, numbers, component, "VEC3", 3, stride);
        json["accessors"][index]["normalized"] = normalized;
        json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = index;
        refused(json, {"integers", "KHR_mesh_quantization", "extensionsRequired"}, bin);
        json["extensionsUsed"] = json["extensionsRequired"] = {"KHR_mesh_quantization"};
        EXPECT_EQ(corners(json, bin), where) << component;
        EXPECT_FALSE(load(json, bin).report.float32);
    };
    check(std::vector<std::int8_t>{-128, -127, 3, 127, 0, 1, 0, 64, 0}, 5120, false,
          {{-128, -127, 3}, {127, 0, 1}, {0, 64, 0}}, 4);
    check(std::vector<std::int8_t>{-128, -127, 3, 127, 0, 1, 0, 64, 0}, 5120, true,
          {{-1, -1, 3 / 127.}, {1, 0, 1 / 127.}, {0, 64 / 127., 0}}, 4);
    check(std::vector<std::uint8_t>{255, 128, 3, 0, 0, 1, 0, 64, 0}, 5121, false,
          {{255, 128, 3}, {0, 0, 1}, {0, 64, 0}}, 4);
    check(std::vector<std::uint8_t>{255, 128, 3, 0, 0, 1, 0, 64, 0}, 5121, true,
          {{1, 128 / 255., 3 / 255.}, {0, 0, 1 / 255.}, {0, 64 / 255., 0}}, 4);
    check(std::vector<std::int16_t>{-32768, -32767, 3, 32767, 0, 1, 0, 64, 0}, 5122, true,
          {{-1, -1, 3 / 32767.}, {1, 0, 1 / 32767.}, {0, 64 / 32767., 0}}, 8);
    check(std::vector<std::uint16_t>{65535, 1, 3, 0, 0, 1, 0, 64, 0}, 5123, true,
          {{1, 1 / 65535., 3 / 65535.}, {0, 0, 1 / 65535.}, {0, 64 / 65535., 0}}, 8);
    check(std::vector<std::uint16_t>{65535, 1, 3, 0, 0, 1, 0, 64, 0}, 5123, false,
          {{65535, 1, 3}, {0, 0, 1}, {0, 64, 0}}, 0);
}

TEST_F(Gltf, IndicesHaveAnyUnsignedType) {
    const auto check = [&](auto numbers, int component) {
        Json json = triangle();
        std::string bin = binary();
        json["meshes"][0]["primitives"][0]["indices"] = append(json, bin, numbers, component, "SCALAR", 1);
        EXPECT_EQ(corners(json, bin), (std::vector<Vec3>{{0, 0, 4}, {0, 2, 0}, {1, 0, 0}})) << component;
    };
    check(std::vector<std::uint8_t>{3, 2, 1}, 5121);
    check(std::vector<std::uint16_t>{3, 2, 1}, 5123);
    check(std::vector<std::uint32_t>{3, 2, 1}, 5125);
}

TEST_F(Gltf, SparseAccessorsReplaceElements) {
    Json json = triangle();
    std::string bin = binary();
    const std::size_t indices = append<std::uint8_t>(json, bin, {1, 2}, 5121, "SCALAR", 1);
    const std::size_t values = append<float>(json, bin, {7, 8, 9, 5, 5, 5}, 5126, "VEC3", 3);
    json["accessors"][0]["sparse"] = {{"count", 2},
                                      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", values}}}};
    EXPECT_EQ(corners(json, bin), (std::vector<Vec3>{{0, 0, 0}, {7, 8, 9}, {5, 5, 5}}));
    Json zeros = json;
    zeros["accessors"][0].erase("bufferView");
    zeros["accessors"][0]["sparse"]["count"] = 1;
    EXPECT_EQ(corners(zeros, bin), (std::vector<Vec3>{{0, 0, 0}, {7, 8, 9}, {0, 0, 0}}));
    const auto bad = [&](const char* pointer, const Json& value, const std::vector<std::string>& parts) {
        Json wrong = json;
        wrong["accessors"][0]["sparse"][Json::json_pointer(pointer)] = value;
        refused(wrong, parts, bin);
    };
    bad("/count", 0, {"'sparse' is not complete"});
    bad("/count", 5, {"'sparse' is not complete, or has more elements"});
    bad("/count", 3, {"do not fit"});
    bad("/indices/componentType", 5126, {"not unsigned integers"});
    bad("/indices/byteOffset", 1, {"do not fit"});
    std::string unordered = bin;
    unordered[56] = 2;
    refused(json, {"index 1 (from 0) of its 'sparse'"}, unordered);
    unordered[57] = 4;
    refused(json, {"index 1 (from 0) of its 'sparse' is out of range"}, unordered);
    json["accessors"][0].erase("sparse");
    json["accessors"][0].erase("bufferView");
    refused(json, {"primitive 0", "POSITION has no data", "gltf-transform copy"}, bin);
}

TEST_F(Gltf, EveryTopologyBecomesFaces) {
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 2, 0), d(0, 0, 4);
    const auto check = [&](int mode, const std::vector<std::uint16_t>& indices, const std::vector<Vec3>& where) {
        Json json = triangle();
        std::string bin = binary();
        json["meshes"][0]["primitives"][0]["mode"] = mode;
        json["meshes"][0]["primitives"][0]["indices"] = append(json, bin, indices, 5123, "SCALAR", 1);
        EXPECT_EQ(corners(json, bin), where) << mode;
    };
    check(0, {3, 1}, {d, b});
    check(1, {0, 1, 2, 3}, {a, b, b, c, d, d});
    check(2, {0, 1, 2}, {a, b, b, b, c, c, c, a, a});
    check(3, {0, 1, 2}, {a, b, b, b, c, c});
    check(4, {0, 1, 2, 1, 2, 3}, {a, b, c, b, c, d});
    check(5, {0, 1, 2, 3}, {a, b, c, b, d, c});
    check(6, {0, 1, 2, 3}, {b, c, a, c, d, a});
    const auto bad = [&](int mode, std::size_t count) {
        Json json = triangle();
        json["meshes"][0]["primitives"][0]["mode"] = mode;
        json["meshes"][0]["primitives"][0].erase("indices");
        json["accessors"][0]["count"] = count;
        refused(json, {"primitive 0 (from 0)", fmt::format("has {} corners", count)});
    };
    bad(1, 3);
    bad(2, 1);
    bad(3, 1);
    bad(4, 4);
    bad(5, 2);
    bad(6, 2);
}

TEST_F(Gltf, PrimitivesMayHaveNoIndices) {
    Json json = triangle();
    json["meshes"][0]["primitives"][0].erase("indices");
    json["accessors"][0]["count"] = 3;
    EXPECT_EQ(corners(json), at_rest_);
    json["meshes"][0]["primitives"][0]["mode"] = 0;
    EXPECT_EQ(kind_of(load(json).shape), ShapeKind::points);
    EXPECT_EQ(corners(json), at_rest_);
    json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}});
    const LoadReport report = load(json).report;
    EXPECT_EQ(report.single_points, 3);
    EXPECT_EQ(report.objects, 1);
}

TEST_F(Gltf, TrianglesThatJoinStripsAreNoPartOfTheSurface) {
    Json json = triangle();
    std::string bin = binary();
    json["meshes"][0]["primitives"][0]["mode"] = 5;
    json["meshes"][0]["primitives"][0]["indices"] =
        append<std::uint16_t>(json, bin, {0, 1, 2, 2, 3, 3, 1, 0}, 5123, "SCALAR", 1);
    EXPECT_EQ(corners(json, bin).size(), 6u);
    noted(json, "4 triangles that only join parts of a strip, with a repeated vertex: left out", bin);
}

TEST_F(Gltf, NodesMoveTheirMeshes) {
    const auto check = [&](const Json& node, const std::vector<Vec3>& where, double off) {
        Json json = triangle();
        json["nodes"][0].update(node);
        expect_near(corners(json), where, off);
    };
    check({{"translation", {0.1, -2, 3}}}, {{0.1, -2, 3}, {1.1, -2, 3}, {0.1, 0, 3}}, 0);
    check({{"scale", {2, -3, 4}}}, {{0, 0, 0}, {2, 0, 0}, {0, -6, 0}}, 0);
    const double half = std::sqrt(0.5);
    check({{"rotation", {0, 0, half, half}}}, {{0, 0, 0}, {0, 1, 0}, {-2, 0, 0}}, 0);
    check({{"rotation", {0.70710678f, 0, 0, 0.70710678f}}}, {{0, 0, 0}, {1, 0, 0}, {0, 0, 2}}, 0);
    check({{"rotation", {0.5, 0.5, 0.5, 0.5}}}, {{0, 0, 0}, {0, 1, 0}, {0, 0, 2}}, 0);  // x to y, y to z
    check({{"rotation", {0, std::sin(0.15), 0, std::cos(0.15)}}},
          {{0, 0, 0}, {std::cos(0.3), 0, -std::sin(0.3)}, {0, 2, 0}}, 4e-16);
    check({{"rotation", {0, 0, half, half}}, {"scale", {2, 1, 1}}, {"translation", {10, 0, 0}}},
          {{10, 0, 0}, {10, 2, 0}, {8, 0, 0}}, 0);  // the scale first, the translation last
    check({{"matrix", {2, 0, 0, 0, 0, 3, 0, 0, 0.5, 0, 1, 0, 10, 20, 30, 1}}},
          {{10, 20, 30}, {12, 20, 30}, {10, 26, 30}}, 0);
    check({{"matrix", {0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1}}}, {{0, 0, 0}, {0, 1, 0}, {0, 0, 2}}, 0);
}

TEST_F(Gltf, TransformsActFromTheInnerToTheOuter) {
    Json json = triangle();
    json["nodes"] = {{{"translation", {10, 0, 0}}, {"children", {1}}},
                     {{"scale", {2, 2, 2}}, {"children", {2}}},
                     {{"translation", {0, 0, 1}}, {"mesh", 0}}};
    EXPECT_EQ(corners(json), (std::vector<Vec3>{{10, 0, 2}, {12, 0, 2}, {10, 4, 2}}));
    json["nodes"][1]["mesh"] = 0;
    EXPECT_EQ(load(json).report.objects, 2);
    EXPECT_EQ(corners(json).size(), 6u);
}

TEST_F(Gltf, ANodeWithoutATransformKeepsEveryBit) {
    std::string bin = binary();
    bin.replace(12, 4, bytes_of<float>({1e-45f}));
    Json json = triangle();
    json["nodes"] = {{{"children", {1}}, {"scale", {1, 1, 1}}},
                     {{"mesh", 0}, {"rotation", {0, 0, 0, 1}}, {"translation", {0, -0.0, 0}}}};
    EXPECT_EQ(corners(json, bin)[1].x(), double(1e-45f));
}

TEST_F(Gltf, ImpossibleTransformsAreRefused) {
    const auto bad = [&](const Json& node, const std::vector<std::string>& parts) {
        Json json = triangle();
        json["nodes"][0].update(node);
        refused(json, parts);
    };
    bad({{"rotation", {0, 0, 0, 0}}}, {"node 0 (from 0)", "not a unit quaternion"});
    bad({{"rotation", {0, 0, 1, 1}}}, {"[0, 0, 1, 1] is not a unit quaternion", "length"});
    bad({{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2}}}, {"last row", "projection"});
    bad({{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}, {"scale", {1, 1, 1}}}, {"remove one of them"});
    bad({{"matrix", {1, 0, 0}}}, {"'matrix' has 3 numbers, not 16"});
    bad({{"skin", 0}}, {"node 0 (from 0)", "skin", "apply the armature"});
    bad({{"scale", {1e300, 1, 1}}, {"translation", {1e308, 0, 0}}, {"children", Json::array({0})}}, {"lists node 0"});
}

TEST_F(Gltf, AMeshScaledToAPointIsHidden) {
    Json json = triangle();
    json["nodes"].push_back({{"mesh", 0}, {"scale", {0, 0, 0}}, {"translation", {9, 9, 9}}});
    json["scenes"][0]["nodes"] = {0, 1};
    EXPECT_EQ(corners(json), at_rest_);
    noted(json, "1 mesh scaled to a single point, by which the format hides a mesh: left out");
    json["nodes"][1]["scale"] = {0, 1, 1};  // flat, but visible
    EXPECT_EQ(corners(json).size(), 6u);
}

TEST_F(Gltf, TheDefaultSceneCounts) {
    Json json = triangle();
    json["nodes"].push_back({{"mesh", 0}, {"translation", {0, 0, 9}}});
    noted(json, "1 node with a mesh that the default scene does not show: left out");
    EXPECT_EQ(corners(json), at_rest_);
    json["scenes"].push_back({{"nodes", {1}}});
    json["scene"] = 1;
    EXPECT_EQ(corners(json)[0], Vec3(0, 0, 9));
    json.erase("scene");
    refused(json, {"has 2 scenes", "add \"scene\": 0"});
    json["scenes"].erase(1);
    EXPECT_EQ(corners(json), at_rest_);  // the only one
    json["scenes"] = Json::array();
    refused(json, {"has no scene", "add a scene"});
    json["scenes"] = {{{"nodes", Json::array()}}};
    refused(json, {"shows no mesh"});
}

TEST_F(Gltf, NodesFormATree) {
    Json json = triangle();
    json["nodes"] = {{{"children", {1}}}, {{"children", {0}}, {"mesh", 0}}};
    refused(json, {"scene 0 (from 0): lists node 0 (from 0), which is a child of node 1"});
    json["nodes"] = {{{"children", {1, 2}}}, {{"children", {2}}}, {{"mesh", 0}}};
    refused(json, {"node 2 (from 0) is a child of node 0 and of node 1"});
    json["nodes"] = {{{"children", {1, 1}}}, {{"mesh", 0}}};
    refused(json, {"node 1 (from 0) is a child of node 0 and of node 0"});
    json = triangle();
    json["scenes"][0]["nodes"] = {0, 0};
    refused(json, {"lists node 0 (from 0) twice"});
    json["scenes"][0]["nodes"] = {0};
    Json chain = json;
    for (std::size_t i = 0; i < 20000; ++i) chain["nodes"][i] = {{"children", {i + 1}}};
    chain["nodes"].push_back({{"mesh", 0}});
    EXPECT_EQ(corners(chain), at_rest_);  // deep, without recursion
}

TEST_F(Gltf, MorphTargetsApplyTheirDefaultWeights) {
    Json json = triangle();
    std::string bin = binary();
    const std::size_t one = append<float>(json, bin, {1, 0, 0, 0, 1, 0, 0, 0, 1, 9, 9, 9}, 5126, "VEC3", 3);
    const std::size_t two = append<float>(json, bin, {0, 0, 8, 0, 0, 8, 0, 0, 8, 0, 0, 8}, 5126, "VEC3", 3);
    Json& primitive = json["meshes"][0]["primitives"][0];
    primitive["targets"] = {{{"POSITION", one}}, {{"POSITION", two}}};
    EXPECT_EQ(corners(json, bin), at_rest_);
    json["meshes"][0]["weights"] = {0.5, 0};
    EXPECT_EQ(corners(json, bin), (std::vector<Vec3>{{0.5, 0, 0}, {1, 0.5, 0}, {0, 2, 0.5}}));
    noted(json, "1 morph target applied, by the default weights of the file", bin);
    json["nodes"][0]["weights"] = {2, -1};  // instead of the weights of the mesh
    EXPECT_EQ(corners(json, bin), (std::vector<Vec3>{{2, 0, -8}, {1, 2, -8}, {0, 2, -6}}));
    json["nodes"][0]["weights"] = {1};
    refused(json, {"primitive 0 (from 0)", "2 morph targets, but there are 1 weights"}, bin);
    json["nodes"][0]["weights"] = {1, 1};
    json["accessors"][two]["count"] = 3;
    refused(json, {"morph target 1 (from 0)", "moves 3 points, but the primitive has 4"}, bin);
}

TEST_F(Gltf, RequiredExtensionsAreKnownOrRefused) {
    Json json = triangle();
    json["extensionsUsed"] = {"KHR_materials_unlit", "KHR_texture_basisu", "ACME_other"};
    json["extensionsRequired"] = {"KHR_materials_unlit", "KHR_texture_basisu"};
    EXPECT_EQ(corners(json), at_rest_);
    noted(json, "uses the optional extension ACME_other, which is not supported: read without it");
    EXPECT_EQ(load(json).report.notes.size(), 1u);
    for (const char* const name : {"ACME_other", "KHR_gaussian_splatting", "CESIUM_RTC", "KHR_techniques_webgl"}) {
        json["extensionsRequired"] = {name};
        json["accessors"] = 3;  // refused before anything else is looked at
        refused(json, {fmt::format("requires the extension {}", name), "PLY or OBJ"});
    }
    json = triangle();
    json["extensions"]["CESIUM_RTC"]["center"] = {1, 2, 3};
    refused(json, {"CESIUM_RTC"});
}

TEST_F(Gltf, InstancesRepeatTheMesh) {
    Json json = triangle();
    std::string bin = binary();
    const std::size_t translation = append<float>(json, bin, {0, 0, 1, 0, 0, 2}, 5126, "VEC3", 3);
    const std::size_t rotation = append<std::int16_t>(json, bin, {0, 0, 0, 32767, 0, 0, 23170, 23170}, 5122, "VEC4", 4);
    const std::size_t scale = append<float>(json, bin, {1, 1, 1, 2, 2, 2}, 5126, "VEC3", 3);
    json["accessors"][rotation]["normalized"] = true;
    json["nodes"][0]["translation"] = {10, 0, 0};
    json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", translation}, {"ROTATION", rotation}, {"SCALE", scale}, {"_ID", 99}};
    json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    expect_near(corners(json, bin), {{10, 0, 1}, {11, 0, 1}, {10, 2, 1}, {10, 0, 2}, {10, 2, 2}, {6, 0, 2}}, 1e-15);
    EXPECT_EQ(load(json, bin).report.objects, 2);
    Json wrong = json;
    wrong["accessors"][scale]["count"] = 1;
    refused(wrong, {"SCALE of EXT_mesh_gpu_instancing has the wrong type or count"}, bin);
    wrong = json;
    wrong["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"_ID", 99}};
    refused(wrong, {"node 0 (from 0)", "no number of instances"}, bin);
    wrong = json;
    wrong["accessors"][rotation].erase("normalized");
    refused(wrong, {"instance 0 (from 0)", "unit quaternion"}, bin);
}

TEST_F(Gltf, HiddenNodesAndLevelsOfDetail) {
    Json json = triangle();
    json["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"mesh", 0}, {"translation", {0, 0, 5}}}};
    json["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = false;
    json["extensionsUsed"] = {"KHR_node_visibility"};
    json["scenes"][0]["nodes"] = {0, 1};
    EXPECT_EQ(corners(json), at_rest_);
    noted(json, "1 node hidden by KHR_node_visibility, with everything below: left out");
    json["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = true;
    EXPECT_EQ(corners(json).size(), 6u);
    json["nodes"][0]["extensions"]["MSFT_lod"]["ids"] = {1};
    refused(json, {"node 1 (from 0)", "level of detail of node 0", "MSFT_lod"});
    json["scenes"][0]["nodes"] = {0};
    EXPECT_EQ(corners(json), at_rest_);
}

TEST_F(Gltf, OtherNotes) {
    Json json = triangle();
    json["animations"] = {{{"channels", Json::array()}}};
    noted(json, "has animations, which are not applied: the nodes stay as the file places them");
    json["meshes"][0]["primitives"].push_back({{"attributes", {{"NORMAL", 0}}}});
    noted(json, "1 primitive without POSITION: left out");
}

TEST_F(Gltf, SmallFilesDoNotFillTheMemory) {
    Json json = triangle();
    json["accessors"][0].erase("bufferView");
    json["accessors"][0]["count"] = std::uint64_t{1} << 50;
    json["meshes"][0]["primitives"][0].erase("indices");
    json["meshes"][0]["primitives"][0]["mode"] = 0;
    refused(json, {"more than 200 points and corners for each byte"});
    json = triangle();
    json["accessors"].push_back({{"componentType", 5126}, {"count", std::uint64_t{1} << 50}, {"type", "VEC3"}});
    json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", 2}};
    refused(json, {"more than 200 points and corners for each byte"});
    // 3000 points in each of 2000 nodes.
    std::vector<float> many(9000, 1.f);
    std::string bin = binary();
    json = triangle();
    const std::size_t index = append(json, bin, many, 5126, "VEC3", 3);
    json["meshes"][0]["primitives"][0] = {{"attributes", {{"POSITION", index}}}};
    for (std::size_t i = 0; i < 2000; ++i) json["nodes"][i] = {{"mesh", 0}};
    json["scenes"][0]["nodes"].clear();
    for (std::size_t i = 0; i < 2000; ++i) json["scenes"][0]["nodes"].push_back(i);
    refused(json, {"more than 200 points and corners"}, bin);
}

// A tetrahedron with the corners (0, 0, 0), (1, 0, 0), (0, 2, 0) and (0, 0, 4), compressed by gltfpack 0.18.
const std::string meshopt_tetrahedron =
    "oAAAAQ8AAAD//wEPAAAAfn0AAAABPAAAAIB/"
    "AAABAwAAAP8BAwAAAIAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAOHwIBECAHaHVmd4"
    "qYZliWiYAWkAAAAAAA==";

Json compressed(const char* extension, const std::string& data, std::size_t bytes) {
    Json json = triangle();
    json["extensionsUsed"] = json["extensionsRequired"] = {extension};
    json["buffers"] = {{{"byteLength", bytes}, {"uri", "data:application/octet-stream;base64," + data}}};
    json["accessors"][1]["count"] = 12;
    return json;
}

Json meshopt(const std::string& data = meshopt_tetrahedron) {
    Json json = compressed("EXT_meshopt_compression", data, 100);
    json["buffers"].push_back({{"byteLength", 72}});  // without data
    json["bufferViews"] = Json::parse(
        R"([{"buffer": 1, "byteLength": 48, "byteStride": 12, "extensions": {"EXT_meshopt_compression":
              {"buffer": 0, "byteLength": 73, "byteStride": 12, "mode": "ATTRIBUTES", "count": 4}}},
            {"buffer": 1, "byteOffset": 48, "byteLength": 24, "extensions": {"EXT_meshopt_compression":
              {"buffer": 0, "byteOffset": 76, "byteLength": 21, "byteStride": 2, "mode": "TRIANGLES", "count": 12}}}])");
    return json;
}

TEST_F(Gltf, MeshoptIsDecoded) {
    const Vec3 a(0, 0, 0), b(0, 2, 0), c(1, 0, 0), d(0, 0, 4);
    EXPECT_EQ(corners(meshopt()), (std::vector<Vec3>{a, b, c, b, a, d, d, a, c, d, c, b}));
    Json optional = meshopt();
    optional.erase("extensionsRequired");
    EXPECT_EQ(corners(optional).size(), 12u);
    optional["buffers"][1]["uri"] =
        "data:;base64," + base64(bytes_of<float>({9, 9, 9, 1, 0, 0, 0, 2, 0, 0, 0, 4}) +
                                 bytes_of<std::uint16_t>({0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2}));
    EXPECT_EQ(corners(optional)[0], Vec3(9, 9, 9));  // the uncompressed data count
}

// Renames EXT_meshopt_compression to the name under which Khronos ratified it.
Json ratified(const Json& json) {
    std::string text = json.dump();
    for (std::size_t at = 0; (at = text.find("EXT_meshopt", at)) != std::string::npos;) text.replace(at, 3, "KHR");
    return Json::parse(text);
}

TEST_F(Gltf, RatifiedMeshoptIsDecodedToo) {
    EXPECT_EQ(corners(ratified(meshopt())), corners(meshopt()));
    Json optional = ratified(meshopt());
    optional.erase("extensionsRequired");
    EXPECT_EQ(corners(optional).size(), 12u);
    EXPECT_TRUE(load(optional).report.notes.empty());
    Json colour = ratified(meshopt());
    colour["bufferViews"][0]["extensions"]["KHR_meshopt_compression"]["filter"] = "COLOR";
    refused(colour, {"bufferView 0 (from 0)", "the filter 'COLOR'"});
    colour["bufferViews"][0]["extensions"]["KHR_meshopt_compression"]["mode"] = "OTHER";
    refused(colour, {"KHR_meshopt_compression has no mode 'OTHER'"});
    // "oQ" decodes to the byte 0xa1.
    ASSERT_TRUE(meshopt_tetrahedron.starts_with("oA"));
    refused(ratified(meshopt("oQ" + meshopt_tetrahedron.substr(2))),
            {"KHR_meshopt_compression with version 1 of its vertex codec", "gltf-transform copy"});
    refused(meshopt("oQ" + meshopt_tetrahedron.substr(2)), {"begin with the byte 0xa1, not 0xa0"});
}

TEST_F(Gltf, AFallbackBufferHasNoDataInAGlb) {
    // The uncompressed data of buffer 0 would be the BIN chunk.
    Json json = meshopt();
    std::swap(json["buffers"][0], json["buffers"][1]);
    json["buffers"][0]["extensions"]["EXT_meshopt_compression"]["fallback"] = true;
    for (Json& view : json["bufferViews"]) {
        view["buffer"] = 0;
        view["extensions"]["EXT_meshopt_compression"]["buffer"] = 1;
    }
    json.erase("extensionsRequired");
    EXPECT_EQ(Reading::corners("a.glb", glb(json.dump(), std::string(72, '\0'))), corners(meshopt()));
}

TEST_F(Gltf, TheExponentialFilterIsExact) {
    // Three points whose numbers are m 2^e, each stored as one element in a block of the codec.
    Json json = meshopt();
    json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["filter"] = "EXPONENTIAL";
    const auto points = corners(json);
    // The bits of 1.0f, 2.0f and 4.0f, read as a mantissa and an exponent.
    EXPECT_EQ(points[1].y(), 0);                            // 0x40000000: exponent 64, mantissa 0
    EXPECT_EQ(points[2].x(), std::ldexp(-0x800000, 0x3f));  // 0x3f800000
    EXPECT_EQ(points[5].z(), std::ldexp(-0x800000, 0x40));  // 0x40800000
}

TEST_F(Gltf, DamagedMeshoptIsRefused) {
    const auto bad = [&](std::size_t view, const char* key, const Json& value, const std::vector<std::string>& parts) {
        Json json = meshopt();
        json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"][key] = value;
        refused(json, parts);
    };
    bad(0, "count", 5, {"bufferView 0 (from 0)", "does not match the bufferView"});
    bad(0, "byteStride", 0, {"does not match"});
    bad(0, "mode", "OTHER", {"no mode 'OTHER'"});
    bad(0, "mode", "INDICES", {"a stride of 12", "not possible in mode INDICES"});
    bad(0, "filter", "QUATERNION", {"a stride of 12 with the filter 'QUATERNION'"});
    bad(1, "filter", "EXPONENTIAL", {"bufferView 1", "not possible in mode TRIANGLES"});
    bad(0, "byteLength", 101, {"buffer 0 (from 0) has 100 bytes"});
    bad(0, "byteLength", 50, {"bufferView 0 (from 0)", "damaged"});
    bad(0, "byteLength", 0, {"0 compressed bytes cannot hold"});
    bad(0, "byteOffset", 1, {"begin with the byte 0x00, not 0xa0"});
    bad(0, "buffer", 1, {"buffer 1 (from 0): has no data"});
    Json json = meshopt();
    json["bufferViews"][0]["byteLength"] = json["buffers"][1]["byteLength"] = 12 * (std::uint64_t{1} << 40);
    json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] = std::uint64_t{1} << 40;
    refused(json, {"more than 64 bytes for each byte of the file"});
    json = meshopt();
    json["bufferViews"][0]["extensions"].clear();
    refused(json, {"bufferView 0 (from 0)", "buffer 1 (from 0) has no data"});
}

// The same tetrahedron, compressed by gltf-transform 4.5.1 with Draco's two methods and 14 bits for 4 units.
const std::string draco_edgebreaker =
    "RFJBQ08CAgEBAAAABAQAAwAAAS8BARAB/wAAAQAJAwAAAgEBAQAPAwEQLwEwAwBQggQA/n8BAAD4/wEAAPD/BwAAAAAAAP8/"
    "AAAAAAAAAAAAAAAAAAAAAIBADgA=";
const std::string draco_sequential =
    "RFJBQ08CAgEAAAAEBAEAAQIAAgMAAwECAQMBAQAJAwAAAgABAQAPAwEQKwEQASADADCQAAD+fwAAAPz/AYD/DwACAAAAAAD/"
    "PwAAAAAAAAAAAAAAAAAAAACAQA4=";

Json draco(const std::string& data, std::size_t bytes) {
    Json json = compressed("KHR_draco_mesh_compression", data, bytes);
    json["bufferViews"] = {{{"buffer", 0}, {"byteLength", bytes}}};
    json["accessors"][0].erase("bufferView");
    json["accessors"][1].erase("bufferView");
    json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
        {"bufferView", 0}, {"attributes", {{"POSITION", 0}}}};
    return json;
}

TEST_F(Gltf, DracoIsDecoded) {
    // Draco puts the points on a grid of 4 / 16383 units.
    const double x = 4096 * 4 / 16383., y = 8192 * 4 / 16383.;
    const Vec3 a(0, 0, 0), b(x, 0, 0), c(0, y, 0), d(0, 0, 4);
    expect_near(corners(draco(draco_edgebreaker, 91)), {a, d, c, c, d, b, d, a, b, c, b, a}, 1e-6);
    expect_near(corners(draco(draco_sequential, 92)), {a, c, b, a, b, d, a, d, c, b, c, d}, 1e-6);
}

TEST_F(Gltf, DracoMayHaveMetadata) {
    // Without a grid, and with names and values before the mesh.
    const std::string data =
        "RFJBQ08CAgEBAIABAAEEbmFtZQhwb3NpdGlvbgABBmF1dGhvcgdzb21lb25lAQNzdWIBAXgEAwAAAAAABAQAAwAAAS8BARAB/"
        "wAAAQAJAwAAAAAA"
        "AAAAAAAAAACAQAAAAAAAAABAAAAAAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAA==";
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 2, 0), d(0, 0, 4);
    EXPECT_EQ(corners(draco(data, 130)), (std::vector<Vec3>{a, d, c, c, d, b, d, a, b, c, b, a}));
    std::string deep = data;
    deep.replace(deep.find("AQNzdWIB"), 8, "/////w8B");  // very many tables
    refused(draco(deep, 130), {"bufferView 0 (from 0)", "damaged"});
}

TEST_F(Gltf, AnOptionalDracoCopyIsNotRead) {
    Json json = triangle();
    json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
    json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
        {"bufferView", 0}, {"attributes", {{"POSITION", 0}}}};
    EXPECT_EQ(corners(json), at_rest_);
    noted(json,
          "1 primitive with a compressed copy by the optional KHR_draco_mesh_compression: the uncompressed data count");
}

TEST_F(Gltf, DamagedDracoIsRefused) {
    const Json sound = draco(draco_sequential, 92);
    const auto bad = [&](const char* pointer, const Json& value, const std::vector<std::string>& parts) {
        Json json = sound;
        json[Json::json_pointer(pointer)] = value;
        refused(json, parts);
    };
    const std::string extension = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";
    bad("/accessors/0/count", 5, {"bufferView 0 (from 0)", "4 triangles and 4 points", "12 indices and 5 points"});
    bad("/accessors/1/count", 9, {"9 indices and 4 points"});
    bad("/accessors/1/count", std::uint64_t{1} << 50, {"more than 200 points"});
    bad("/accessors/0/componentType", 5121, {"KHR_mesh_quantization"});
    bad((extension + "/attributes/POSITION").c_str(), 1, {"have no attribute 1 for POSITION"});
    bad((extension + "/attributes").c_str(), Json::object(), {"only for triangles", "gltf-transform copy"});
    bad("/meshes/0/primitives/0/mode", 5, {"only for triangles", "gltf-transform copy"});
    bad("/bufferViews/0/byteOffset", 1, {"buffer 0 (from 0) has 92 bytes"});
    bad("/bufferViews/0/byteLength", 60, {"damaged"});
    bad("/bufferViews/0/byteLength", 4, {"does not hold Draco data"});
    Json shared = sound;
    shared["accessors"].push_back(shared["accessors"][0]);
    shared["accessors"][2]["count"] = 3;
    Json second = shared["meshes"][0]["primitives"][0];
    second["attributes"]["POSITION"] = 2;
    shared["meshes"][0]["primitives"].push_back(second);
    refused(shared, {"primitive 1 (from 0)", "shares its Draco data"});
}

}  // namespace
}  // namespace hausbench
