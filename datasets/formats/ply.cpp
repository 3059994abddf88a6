// Reads PLY as text or binary, in either byte order, with numbers and lists of any type. Ignores everything except x, y
// and z of the vertices and the vertex numbers of the faces.
#include "algorithms/error.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace hausbench::readers {
namespace {

const std::map<std::string, Stored, std::less<>> types = {
    {"char", {'I', 1}},  {"int8", {'I', 1}},    {"uchar", {'U', 1}},  {"uint8", {'U', 1}},
    {"short", {'I', 2}}, {"int16", {'I', 2}},   {"ushort", {'U', 2}}, {"uint16", {'U', 2}},
    {"int", {'I', 4}},   {"int32", {'I', 4}},   {"uint", {'U', 4}},   {"uint32", {'U', 4}},
    {"float", {'F', 4}}, {"float32", {'F', 4}}, {"double", {'F', 8}}, {"float64", {'F', 8}}};

struct Property {
    std::string_view name;
    Stored type;
    std::optional<Stored> count = std::nullopt;  // type of the length of a list; empty if it is not a list

    bool is_corners() const { return count && (name == "vertex_index" || name == "vertex_indices"); }
    // Returns 0, 1 or 2 for x, y or z; otherwise -1.
    int axis() const { return !count && name.size() == 1 && name >= "x" && name <= "z" ? name[0] - 'x' : -1; }
};

struct Element {
    std::string_view name;
    std::uint64_t count = 0;
    std::vector<Property> properties;

    bool is_vertices() const { return name == "vertex" || name == "vertices"; }
    bool is_faces() const { return name == "face" || name == "faces"; }
};

class PlyReader {
public:
    PlyReader(const std::string& name, std::string_view bytes) : name_(name), body_(bytes) {}

    Soup read() {
        read_header();
        if (format_ != "ascii" && format_ != "binary_little_endian" && format_ != "binary_big_endian")
            refuse_file(fmt::format("unknown PLY format '{}'", shown(format_)));
        std::uint64_t least = 0;  // least number of bytes that the announced elements can take
        for (const Element& element : elements_) least += checked(element);
        if (points_ == 0) refuse_file("holds no vertices");
        if (body_.size() + (text() ? 1 : 0) < least)
            refuse_file(
                fmt::format("is truncated: the header announces {} vertices and {} faces, at least {} bytes; "
                            "{} bytes found after it",
                            points_, faces_, least, body_.size()));
        for (const Element& element : elements_) {
            if (element.properties.empty()) continue;  // takes no bytes, so there is nothing to read
            for (std::uint64_t i = 0; i < element.count; ++i) read_one(element);
        }
        return std::move(soup_);
    }

private:
    bool text() const { return format_ == "ascii"; }

    [[noreturn]] void refuse_file(const std::string& why) const { throw InputError(name_ + ": " + why); }
    [[noreturn]] void refuse_line(const std::string& why) const { refuse(name_, line_, why); }

    void read_header() {
        for (line_ = 1; !body_.empty(); ++line_) {
            std::string_view line = next_line(body_);
            const std::string_view keyword = next_word(line);
            if (line_ == 1 && keyword != "ply") refuse_line("is not a PLY file: it does not begin with 'ply'");
            if (keyword == "format") format_ = next_word(line);
            if (keyword == "element") add_element(line);
            if (keyword == "property") add_property(line);
            if (keyword == "end_header") return;  // ignores other lines: comments, which some writers do not mark
        }
        refuse_file("has no end_header line: truncated, or not a PLY file");
    }

    void add_element(std::string_view line) {
        Element& element = elements_.emplace_back();
        element.name = next_word(line);
        const auto count = whole<std::uint64_t>(next_word(line));
        if (!count) refuse_line("an element needs a name and a count");
        element.count = *count;
    }

    void add_property(std::string_view line) {
        Property property;
        std::string_view word = next_word(line);
        if (word == "list") {
            property.count = type_named(next_word(line));
            word = next_word(line);
        }
        property.type = type_named(word);
        property.name = next_word(line);
        if (property.name.empty() || elements_.empty()) refuse_line("a property needs a type, a name and an element");
        elements_.back().properties.push_back(property);
    }

    Stored type_named(std::string_view word) const {
        const auto type = types.find(word);
        if (type == types.end()) refuse_line(fmt::format("unknown type '{}'", shown(word)));
        return type->second;
    }

    // Checks an element of the header and counts its vertices or faces. Refuses triangle strips, vertices without x, y
    // and z, and faces without a list of vertices. Returns the least number of bytes that all elements of this kind can
    // take.
    std::uint64_t checked(const Element& element) {
        if (element.name == "tristrips" && element.count > 0)
            refuse_file("triangle strips are not supported: convert the file to faces");
        std::uint64_t least = 0;
        int axes = 0, named = 0, lists = 0;
        for (const Property& property : element.properties) {
            if (element.is_vertices() && property.count && property.name.starts_with("vertex_ind"))
                refuse_file(
                    fmt::format("its vertices have the list '{}': a line 'element face ...' before it is missing",
                                shown(property.name)));
            least += text() ? 2 : property.count.value_or(property.type).size;
            if (property.axis() >= 0) {
                axes |= 1 << property.axis();
                ++named;
            }
            lists += property.is_corners() ? 1 : 0;
        }
        if (element.is_vertices()) {
            if (axes != 7 || named != 3) refuse_file("its vertices do not have x, y and z");
            points_ += element.count;
        }
        if (element.is_faces() && element.count > 0) {
            if (lists != 1) refuse_file("its faces have no list vertex_indices");
            faces_ += element.count;
        }
        if (element.count > body_.size()) least = std::max<std::uint64_t>(least, 1);
        return std::min<std::uint64_t>(element.count, std::uint64_t{1} << 40) * least;
    }

    void read_one(const Element& element) {
        Vec3 point = Vec3::Zero();
        std::vector<std::size_t> face;
        for (const Property& property : element.properties) {
            const int axis = element.is_vertices() ? property.axis() : -1;
            const std::uint64_t count = property.count ? whole_number(*property.count) : 1;
            for (std::uint64_t i = 0; i < count; ++i) {
                if (element.is_faces() && property.is_corners())
                    face.push_back(whole_number(property.type));
                else if (const double value = number(property.type); axis >= 0)
                    point[axis] = value;
            }
            if (axis >= 0) soup_.float32 = soup_.float32 || property.type.is_float32();
        }
        if (element.is_vertices()) soup_.points.push_back(point);
        if (element.is_faces()) soup_.faces.push_back(std::move(face));
    }

    [[noreturn]] void end_early() const {
        refuse_file(
            fmt::format("is truncated or damaged after {} of {} vertices and {} of {} faces (a coordinate that "
                        "is no finite number ends the reading too)",
                        soup_.points.size(), points_, soup_.faces.size(), faces_));
    }

    double number(Stored type) {
        if (text()) {
            const std::string_view word = next_word_of_body();
            // Reads a float32 as such, so that it is rounded once. Rounding to double first could give another float.
            const auto value = type.is_float32() ? std::optional<double>(decimal<float>(word)) : decimal(word);
            if (!value || !std::isfinite(*value)) end_early();
            return *value;
        }
        if (body_.size() < type.size) end_early();
        std::array<char, 8> bytes{};
        std::copy_n(body_.data(), type.size, bytes.data());
        if (format_ == "binary_big_endian") std::reverse(bytes.data(), bytes.data() + type.size);
        body_.remove_prefix(type.size);
        return type.value(bytes.data());
    }

    // Reads an integer. A negative vertex number becomes a very large one, which finish() refuses.
    std::size_t whole_number(Stored type) {
        const double value = number(type);
        if (std::floor(value) != value || std::abs(value) > 0x1p53) end_early();
        return static_cast<std::size_t>(static_cast<std::int64_t>(value));
    }

    std::string_view next_word_of_body() {
        constexpr std::string_view spaces = " \t\r\v\f\n";
        body_.remove_prefix(std::min(body_.find_first_not_of(spaces), body_.size()));
        const std::string_view word = body_.substr(0, body_.find_first_of(spaces));
        body_.remove_prefix(word.size());
        return word;
    }

    const std::string& name_;
    std::string_view body_, format_;
    std::uint32_t line_ = 0;  // current line of the header
    std::vector<Element> elements_;
    std::uint64_t points_ = 0, faces_ = 0;  // numbers that the header announces
    Soup soup_;
};

}  // namespace

Soup read_ply(const Input& input) {
    const std::string& name = input.name;
    const std::string_view bytes = input.bytes;
    return PlyReader(name, bytes).read();
}

}  // namespace hausbench::readers
