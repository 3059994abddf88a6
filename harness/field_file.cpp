#include "field_file.h"

#include "error.h"
#include "hash.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

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

void write_file(const fs::path& file, const std::string& bytes) {
    const fs::path unfinished = file.string() + ".unfinished";
    std::error_code failed;
    errno = 0;
    {
        std::ofstream out(unfinished, std::ios::binary);
        out.write(bytes.data(), std::streamsize(bytes.size()));
        out.close();
        if (!out) failed = std::error_code(errno ? errno : EIO, std::generic_category());
    }
    if (!failed) fs::rename(unfinished, file, failed);
    if (!failed) return;
    std::error_code ignored;
    fs::remove(unfinished, ignored);
    throw InputError(
        fmt::format("{}: cannot be written ({}): choose another place, or make room", file.string(), failed.message()));
}

template <class E> E named(const json& name, std::initializer_list<E> all) {
    for (E one : all) {
        if (name == to_string(one)) return one;
    }
    throw std::runtime_error("a field of no known kind");
}

Fields parse(const std::string& bytes) {
    const std::size_t end = bytes.find('\n');
    const json head = json::parse(bytes.substr(0, end));
    if (head.at("hausbench_fields") != format_version) throw std::runtime_error("fields of another version");
    Fields fields;
    std::size_t at = end + 1;
    for (const json& one : head.at("fields")) {
        Field field;
        field.name = one.at("name");
        field.of = named(one.at("of"), {Field::Of::vertices, Field::Of::elements});
        field.meaning =
            named(one.at("meaning"), {Field::Meaning::lower, Field::Meaning::upper, Field::Meaning::number});
        const std::size_t count = one.at("count");
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
    const std::vector<double>* values;
};

// Names become words, as PLY has no others.
std::string word(std::string name) {
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return c <= ' ' || c >= 0x7f; }, '_');
    return name.empty() ? "_" : name;
}

std::vector<Property> properties(const Fields& fields, bool of_vertices, bool points) {
    std::vector<Property> out;
    for (const Field& field : fields) {
        if ((field.of == Field::Of::vertices || points) != of_vertices) continue;
        const bool first_distance = field.name == "distance" && field.of == Field::Of::vertices;
        if (first_distance) out.push_back({"quality", "float", &field.values});
        out.push_back({word(field.name), field.name == "nearest" && of_vertices ? "int" : "double", &field.values});
    }
    return out;
}

void append(std::string& bytes, const std::vector<Property>& properties, std::size_t i) {
    for (const Property& p : properties) {
        const double value = p.values->at(i);
        if (p.type == "int")
            append(bytes, std::int32_t(value));
        else if (p.type == "float")
            append(bytes, float(value));
        else
            append(bytes, value);
    }
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
    write_file(file, bytes);
    return sha256_of_file(file);
}

std::optional<Fields> read_fields(const fs::path& file, const std::string& sha256) {
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    if (!in || Sha256().add(bytes.data(), bytes.size()).hex() != sha256) return std::nullopt;
    return parse(bytes);
}

void check_ply_place(const fs::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    if (extension != ".ply")
        throw InputError(fmt::format("{}: fields are written as .ply: end the name with it", file.string()));
    const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
    if (!fs::is_directory(folder))
        throw InputError(fmt::format("{}: its folder does not exist: make it, or choose another place", file.string()));
    if (::access(folder.c_str(), W_OK) != 0 || fs::is_directory(file))
        throw InputError(fmt::format("{}: cannot be written: choose another place", file.string()));
}

void write_fields_ply(const fs::path& file, const Shape& shape, const Points& posed, const Fields& fields) {
    const auto* mesh = std::get_if<TriangleMesh>(&shape);
    const auto of_vertices = properties(fields, true, !mesh), of_faces = properties(fields, false, !mesh);
    std::string bytes = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment distances of A to B, by hausbench\nelement vertex {}\n"
        "property double x\nproperty double y\nproperty double z\n",
        posed.rows());
    for (const Property& p : of_vertices) bytes += fmt::format("property {} {}\n", p.type, p.name);
    if (mesh) {
        bytes += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", mesh->triangles.rows());
        for (const Property& p : of_faces) bytes += fmt::format("property {} {}\n", p.type, p.name);
    }
    bytes += "end_header\n";
    for (Index i = 0; i < posed.rows(); ++i) {
        for (int k = 0; k < 3; ++k) append(bytes, posed(i, k));
        append(bytes, of_vertices, std::size_t(i));
    }
    for (Index i = 0; mesh && i < mesh->triangles.rows(); ++i) {
        append(bytes, std::uint8_t(3));
        for (int k = 0; k < 3; ++k) append(bytes, std::int32_t(mesh->triangles(i, k)));
        append(bytes, of_faces, std::size_t(i));
    }
    write_file(file, bytes);
}

}  // namespace hausbench
