#include "error.h"
#include "readers.h"

#include <fmt/format.h>

#include <map>
#include <sstream>

namespace hausbench::readers {
namespace {

struct Property {
    std::string type, name;
    std::string count_type;  // for a list, else empty
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;

    bool is_vertices() const { return name == "vertex" || name == "vertices"; }
    bool is_faces() const { return name == "face" || name == "faces"; }
};

const std::map<std::string, std::uint64_t> sizes = {{"char", 1},  {"int8", 1},    {"uchar", 1},  {"uint8", 1},
                                                    {"short", 2}, {"int16", 2},   {"ushort", 2}, {"uint16", 2},
                                                    {"int", 4},   {"int32", 4},   {"uint", 4},   {"uint32", 4},
                                                    {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};

bool is_real(const std::string& type) { return type.starts_with("float") || type.starts_with("double"); }
bool is_index(const std::string& type) {
    return type == "int" || type == "int32" || type == "uint" || type == "uint32";
}

struct Header {
    std::string format;
    std::vector<Element> elements;
    std::size_t end = 0;  // where the body begins
};

Header parse(const std::string& name, const std::string& bytes) {
    const auto refuse = [&](std::size_t line, const std::string& why) {
        throw InputError(fmt::format("{}: line {}: {}", name, line, why));
    };
    Header header;
    std::size_t number = 0;
    while (header.end < bytes.size()) {
        const std::size_t end = std::min(bytes.find('\n', header.end), bytes.size());
        std::istringstream line(bytes.substr(header.end, std::min<std::size_t>(end - header.end, 4096)));
        header.end = std::min(end + 1, bytes.size());
        ++number;
        std::string keyword;
        line >> keyword;
        if (number == 1) {
            if (keyword != "ply") refuse(number, "is no PLY file: it does not begin with 'ply'");
        } else if (keyword == "format") {
            line >> header.format;
        } else if (keyword == "element") {
            Element element;
            if (!(line >> element.name >> element.count)) refuse(number, "an element needs a name and a count");
            header.elements.push_back(element);
        } else if (keyword == "property") {
            Property property;
            line >> property.type;
            if (property.type == "list") line >> property.count_type >> property.type;
            line >> property.name;
            if (!line || header.elements.empty()) refuse(number, "a property needs a type, a name and an element");
            for (const std::string& type : {property.type, property.count_type})
                if (!type.empty() && !sizes.contains(type)) refuse(number, "unknown type '" + type + "'");
            header.elements.back().properties.push_back(property);
        } else if (keyword == "end_header") {
            return header;  // other words are comments that some writers do not mark
        }
    }
    throw InputError(name + ": has no end_header line: truncated, or no PLY file");
}

}  // namespace

Mended mend_ply(const std::string& name, const std::string& bytes) {
    Header header = parse(name, bytes);
    const bool text = header.format == "ascii";
    if (!text && header.format != "binary_little_endian" && header.format != "binary_big_endian")
        throw InputError(fmt::format("{}: unknown PLY format '{}'", name, header.format));

    Mended mended;
    std::uint64_t least_bytes = 0;  // at least these bytes for the counts in the header
    bool vertices = false;
    for (Element& element : header.elements) {
        if (element.name == "tristrips" && element.count > 0)
            throw InputError(name + ": triangle strips are not read: convert the file to faces");
        std::uint64_t least = 0;
        int coordinates = 0, corners = 0;
        for (Property& property : element.properties) {
            const bool list = !property.count_type.empty();
            if (element.is_vertices() && list && property.name.starts_with("vertex_ind"))
                throw InputError(
                    fmt::format("{}: its vertices have the list '{}': a line 'element face ...' before it "
                                "is missing",
                                name, property.name));
            least += text ? 2 : sizes.at(list ? property.count_type : property.type);
            if (element.is_vertices() && !list &&
                (property.name == "x" || property.name == "y" || property.name == "z")) {
                ++coordinates;
                if (text && !is_real(property.type)) property.type = "double";
                mended.float32 = mended.float32 || property.type == "float" || property.type == "float32";
                if (!is_real(property.type))
                    throw InputError(fmt::format(
                        "{}: coordinates of type {} in a binary PLY are not read: write double", name, property.type));
            }
            if (element.is_faces() && list && (property.name == "vertex_index" || property.name == "vertex_indices")) {
                ++corners;
                if (text && !is_index(property.type)) property.type = "int";
                if (!is_index(property.type))
                    throw InputError(fmt::format(
                        "{}: vertex numbers of type {} in a binary PLY are not read: write int", name, property.type));
            }
        }
        if (element.count > bytes.size()) least = std::max<std::uint64_t>(least, 1);
        least_bytes += std::min<std::uint64_t>(element.count, std::uint64_t{1} << 40) * least;
        if (element.is_vertices()) {
            if (coordinates != 3) throw InputError(name + ": its vertices do not have x, y and z");
            mended.points += element.count;
            vertices = true;
        }
        if (element.is_faces() && element.count > 0) {
            if (corners != 1) throw InputError(name + ": its faces have no list vertex_indices");
            mended.faces += element.count;
        }
    }
    if (!vertices || mended.points == 0) throw InputError(name + ": holds no vertices");
    const std::size_t found = bytes.size() - header.end;
    if (found + (text ? 1 : 0) < least_bytes)
        throw InputError(
            fmt::format("{}: is truncated: the header announces {} vertices and {} faces, at least {} bytes; {} bytes "
                        "found after it",
                        name, mended.points, mended.faces, least_bytes, found));

    mended.bytes = "ply\nformat " + header.format + " 1.0\n";
    for (const Element& element : header.elements) {
        if (element.count == 0) continue;
        mended.bytes += fmt::format("element {} {}\n", element.name, element.count);
        for (const Property& p : element.properties)
            mended.bytes += p.count_type.empty()
                                ? fmt::format("property {} {}\n", p.type, p.name)
                                : fmt::format("property list {} {} {}\n", p.count_type, p.type, p.name);
    }
    mended.bytes += "end_header\n";
    mended.bytes.append(bytes, header.end, std::string::npos);
    return mended;
}

}  // namespace hausbench::readers
