#include "harness/result/field_file.h"

#include "algorithms/error.h"
#include "datasets/hash.h"
#include "process/whole_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

namespace hausbench {

using nlohmann::json;
namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little);

namespace {

constexpr int format_version = 1;

template <class T> void append(std::string& bytes, T value) {
    const std::size_t at = bytes.size();
    bytes.resize(at + sizeof value);
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

template <class E> E named(const json& name, std::initializer_list<E> all) {
    for (E value : all) {
        if (name == to_string(value)) return value;
    }
    throw std::runtime_error("a field of no known kind");
}

Fields parse(const std::string& bytes) {
    const std::size_t end = bytes.find('\n');
    const json head = json::parse(bytes.substr(0, end));
    if (head.at("hausbench_fields") != format_version) throw std::runtime_error("fields of another version");
    Fields fields;
    std::size_t at = end + 1;
    for (const json& entry : head.at("fields")) {
        Field field;
        field.name = entry.at("name");
        field.of = named(entry.at("of"), {Field::Of::vertices, Field::Of::elements, Field::Of::pieces});
        field.meaning =
            named(entry.at("meaning"), {Field::Meaning::lower, Field::Meaning::upper, Field::Meaning::number});
        const std::size_t count = entry.at("count");
        if (count > (bytes.size() - at) / sizeof(double)) throw std::runtime_error("fewer values than it says");
        field.values.resize(count);
        std::memcpy(field.values.data(), bytes.data() + at, count * sizeof(double));
        at += count * sizeof(double);
        fields.push_back(std::move(field));
    }
    return fields;
}

struct Property {
    std::string name, type;
    std::vector<double> values;
};

using Properties = std::vector<Property>;

// Replaces the characters that PLY or VTK does not allow in a name. VTK reads %41 as A, so % is one of them.
std::string word(std::string name) {
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return c <= ' ' || c >= 0x7f || c == '%'; }, '_');
    return name.empty() ? "_" : name;
}

struct Drawn {
    const Points& vertices;
    const Triangles& pieces;
    Properties of_vertices, of_cells;  // a cell is a piece, or a point
};

Drawn with_properties(const DrawnField& drawn, const Fields& given) {
    Fields solver_fields;
    add_own(solver_fields, given);
    const bool points = drawn.pieces.rows() == 0;
    Drawn all{drawn.vertices, drawn.pieces, {}, {}};
    all.of_vertices.push_back({"distance", "double", drawn.distances});
    all.of_vertices.push_back({"nearest", "int", {drawn.nearest.begin(), drawn.nearest.end()}});
    if (!points) all.of_cells.push_back({"element", "int", {drawn.elements.begin(), drawn.elements.end()}});
    for (const Field& field : solver_fields) {
        if (field.of == Field::Of::pieces) continue;  // solvers do not know the pieces
        Property property{word(field.name), "double", field.values};
        if (field.of == Field::Of::vertices) {
            property.values.resize(drawn.distances.size(), std::numeric_limits<double>::quiet_NaN());
            all.of_vertices.push_back(std::move(property));
            continue;
        }
        property.values.clear();
        for (Index element : drawn.elements) property.values.push_back(field.values.at(std::size_t(element)));
        all.of_cells.push_back(points ? Property{property.name, property.type, field.values} : std::move(property));
    }
    return all;
}

void append(std::string& bytes, const Properties& properties, std::size_t i) {
    for (const Property& p : properties) {
        const double value = p.values.at(i);
        if (p.type == "int")
            append(bytes, std::int32_t(value));
        else if (p.type == "float")
            append(bytes, float(value));
        else if (p.type == "uchar")
            append(bytes, std::uint8_t(value));
        else
            append(bytes, value);
    }
}

// Returns the red, green and blue, 0 to 255, of each value between 0 and the largest: dark violet, blue, green, yellow,
// like the colour map viridis at these five values.
Properties colours_of(const std::vector<double>& values) {
    constexpr double stops[5][3] = {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}};
    Properties colours = {{"red", "uchar", {}}, {"green", "uchar", {}}, {"blue", "uchar", {}}};
    const double largest = values.empty() ? 0 : *std::max_element(values.begin(), values.end());
    for (const double value : values) {
        const double along = largest > 0 && std::isfinite(largest) ? 4 * (value / largest) : 0;
        const auto below = std::min<std::size_t>(std::size_t(along), 3);
        for (std::size_t k = 0; k < 3; ++k)
            colours[k].values.push_back(
                std::round(std::lerp(stops[below][k], stops[below + 1][k], along - double(below))));
    }
    return colours;
}

std::string as_ply(const Drawn& drawn) {
    const std::vector<double>& distances = drawn.of_vertices.front().values;
    Properties columns = {{"quality", "float", distances}, {"scalar_distance", "float", distances}};
    for (const Properties& more : {colours_of(distances), drawn.of_vertices})
        columns.insert(columns.end(), more.begin(), more.end());
    const bool mesh = drawn.pieces.rows() > 0;
    if (!mesh) columns.insert(columns.end(), drawn.of_cells.begin(), drawn.of_cells.end());
    std::string bytes = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment distances of A to B, by hausbench\nelement vertex {}\nproperty "
        "double x\nproperty double y\nproperty double z\n",
        drawn.vertices.rows());
    for (const Property& p : columns) bytes += fmt::format("property {} {}\n", p.type, p.name);
    if (mesh) bytes += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", drawn.pieces.rows());
    bytes += "end_header\n";
    for (Index i = 0; i < drawn.vertices.rows(); ++i) {
        for (int k = 0; k < 3; ++k) append(bytes, drawn.vertices(i, k));
        append(bytes, columns, std::size_t(i));
    }
    for (Index i = 0; i < drawn.pieces.rows(); ++i) {
        append(bytes, std::uint8_t(3));
        for (int k = 0; k < 3; ++k) append(bytes, std::int32_t(drawn.pieces(i, k)));
    }
    return bytes;
}

template <class T> void append_big_endian(std::string& bytes, T value) {
    append(bytes, value);
    std::reverse(bytes.end() - std::ptrdiff_t(sizeof value), bytes.end());
}

void append_vtk_scalars(std::string& bytes, const char* section, Index count, const Properties& properties) {
    if (properties.empty()) return;
    bytes += fmt::format("{} {}\n", section, count);
    for (const Property& p : properties) {
        bytes += fmt::format("SCALARS {} {} 1\nLOOKUP_TABLE default\n", p.name, p.type);
        for (Index i = 0; i < count; ++i) {
            const double value = p.values.at(std::size_t(i));
            if (p.type == "int")
                append_big_endian(bytes, std::int32_t(value));
            else
                append_big_endian(bytes, value);
        }
        bytes += '\n';
    }
}

std::string as_vtk(const Drawn& drawn) {
    const bool mesh = drawn.pieces.rows() > 0;
    const Index points = static_cast<Index>(drawn.vertices.rows());
    const Index cells = mesh ? static_cast<Index>(drawn.pieces.rows()) : points;
    const int corners = mesh ? 3 : 1, type = mesh ? 5 : 1;  // VTK_TRIANGLE, VTK_VERTEX
    std::string bytes = fmt::format(
        "# vtk DataFile Version 3.0\ndistances of A to B, by hausbench\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS {} "
        "double\n",
        points);
    for (Index i = 0; i < points; ++i) {
        for (int k = 0; k < 3; ++k) append_big_endian(bytes, drawn.vertices(i, k));
    }
    bytes += fmt::format("\nCELLS {} {}\n", cells, cells * (corners + 1));
    for (Index i = 0; i < cells; ++i) {
        append_big_endian(bytes, std::int32_t(corners));
        for (int k = 0; k < corners; ++k) append_big_endian(bytes, std::int32_t(mesh ? drawn.pieces(i, k) : i));
    }
    bytes += fmt::format("\nCELL_TYPES {}\n", cells);
    for (Index i = 0; i < cells; ++i) append_big_endian(bytes, std::int32_t(type));
    bytes += '\n';
    append_vtk_scalars(bytes, "POINT_DATA", points, drawn.of_vertices);
    append_vtk_scalars(bytes, "CELL_DATA", cells, drawn.of_cells);
    return bytes;
}

std::string extension_of(const fs::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    return extension;
}

}  // namespace

std::string write_fields(const fs::path& file, const Fields& fields) {
    json head{{"hausbench_fields", format_version}, {"fields", json::array()}};
    for (const Field& field : fields) {
        head["fields"].push_back({{"name", one_line(field.name)},
                                  {"of", to_string(field.of)},
                                  {"meaning", to_string(field.meaning)},
                                  {"count", field.values.size()}});
    }
    std::string bytes = head.dump(-1, ' ', false, json::error_handler_t::replace) + '\n';
    for (const Field& field : fields) {
        const std::size_t at = bytes.size(), size = field.values.size() * sizeof(double);
        bytes.resize(at + size);
        std::memcpy(bytes.data() + at, field.values.data(), size);
    }
    write_whole_file(file, bytes);
    return sha256_of_file(file);
}

std::optional<Fields> read_fields(const fs::path& file, const std::string& sha256) {
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    if (!in || Sha256().add(bytes.data(), bytes.size()).hex() != sha256) return std::nullopt;
    return parse(bytes);
}

void check_export_place(const fs::path& file) {
    if (const std::string extension = extension_of(file); extension != ".ply" && extension != ".vtk")
        throw InputError(
            fmt::format("{}: fields are written as PLY or VTK: end the name with .ply or .vtk", file.string()));
    check_place_to_write(file);
}

fs::path file_of_way_back(const fs::path& file) {
    return fs::path(file).replace_extension(".back" + file.extension().string());
}

void export_fields(const fs::path& file, const DrawnField& drawn, const Fields& solver_fields) {
    const auto write = extension_of(file) == ".vtk" ? as_vtk : as_ply;
    write_whole_file(file, write(with_properties(drawn, solver_fields)));
}

}  // namespace hausbench
