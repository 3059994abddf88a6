// Reads PLY as text or binary, in either byte order, with numbers and lists of any type: x, y and z of the vertices;
// the list vertex_indices (or vertex_index) of faces and of triangle strips, in which -1 begins another strip; and
// vertex1 and vertex2 of edges, which are segments. A triangle of a strip that repeats a vertex only joins two strips,
// and is left out. A vertex that nothing uses may have coordinates that are not finite.
//
// A note names other elements with lists of vertices, which are left out; without faces, strips and edges such a file
// is refused, except a range_grid of points. Words after the last element of a text file are refused, because its
// header then disagrees with its lines; so are bytes after the last element of a binary file, if they are as many as a
// vertex has and not all zero or blank. Fewer are told in a note.
//
// The names of properties are conventions: X, Y and Z are read if there is no x, y or z. A second element of vertices
// is refused, because the numbers in faces would be ambiguous.
//
// PLY states no unit and no axes. A coordinate is exactly the stored number; in a text file, the float32 or float64
// nearest to the decimal number, by the type of the property. A coordinate in a text file that its integer type cannot
// hold is refused.
#include "algorithms/error.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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
    // Returns 0, 1 or 2 for x, y or z, otherwise -1. `first` is 'x', or 'X' for X, Y and Z.
    int axis(char first) const {
        return !count && name.size() == 1 && name[0] >= first && name[0] <= first + 2 ? name[0] - first : -1;
    }
};

struct Element {
    std::string_view name;
    std::uint64_t count = 0;
    std::vector<Property> properties;

    bool is_vertices() const { return name == "vertex" || name == "vertices"; }
    bool is_faces() const { return name == "face" || name == "faces"; }
    bool is_strips() const { return name == "tristrips" || name == "tristrip"; }
    bool is_edges() const { return name == "edge" || name == "edges"; }
    // Whether a property may be the number of a vertex, by its name.
    bool may_index() const {
        return std::any_of(properties.begin(), properties.end(), [](const Property& property) {
            const bool numbered = property.name.size() == 2 && (property.name[0] == 'v' || property.name[0] == 'p') &&
                                  property.name[1] >= '0' && property.name[1] <= '9';
            return numbered || property.name.find("vertex") != std::string_view::npos;
        });
    }
    bool has(std::string_view property) const {
        return std::any_of(properties.begin(), properties.end(),
                           [&](const Property& candidate) { return candidate.name == property && !candidate.count; });
    }
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
        check_others();
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
        check_rest();
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

    // Checks an element of the header and counts its vertices or faces. Refuses vertices without x, y and z, and faces,
    // strips and edges without their vertices. Returns the least number of bytes that all elements of this kind can
    // take.
    std::uint64_t checked(const Element& element) {
        std::uint64_t least = 0;
        if (element.is_vertices()) {
            if (seen_) refuse_file("has two elements of vertices: write all vertices as one element");
            seen_ = true;
            const bool small = std::any_of(element.properties.begin(), element.properties.end(),
                                           [](const Property& property) { return property.axis('x') >= 0; });
            first_axis_ = small ? 'x' : 'X';
        }
        int axes = 0, named = 0, lists = 0;
        for (const Property& property : element.properties) {
            if (element.is_vertices() && property.count && property.name.starts_with("vertex_ind"))
                refuse_file(
                    fmt::format("its vertices have the list '{}': a line 'element face ...' before it is missing",
                                shown(property.name)));
            least += text() ? 2 : property.count.value_or(property.type).size;
            if (const int axis = property.axis(first_axis_); element.is_vertices() && axis >= 0) {
                axes |= 1 << axis;
                ++named;
            }
            lists += property.is_corners() ? 1 : 0;
        }
        if (element.is_vertices()) {
            if (axes != 7 || named != 3) refuse_file("its vertices do not have x, y and z: name these properties so");
            vertex_bytes_ = least;
            points_ += element.count;
        }
        if ((element.is_faces() || element.is_strips()) && element.count > 0) {
            if (lists != 1)
                refuse_file(fmt::format("its {} have no list vertex_indices: write it for each of them",
                                        element.is_faces() ? "faces" : "triangle strips"));
            faces_ += element.count;
        } else if (element.is_faces()) {
            no_faces_ = true;
        } else if (element.is_edges() && element.count > 0) {
            if (lists > 0 || !element.has("vertex1") || !element.has("vertex2"))
                refuse_file("its edges do not have vertex1 and vertex2: write them, or leave the edges out");
            faces_ += element.count;
        } else if (!element.is_vertices() && lists > 0 && element.count > 0) {
            others_.push_back(element);
        } else if (!element.is_vertices() && element.count > 0 && element.may_index()) {
            soup_.notes.push_back(
                fmt::format("its elements '{}' ({}) were left out", shown(element.name), element.count));
        }
        if (element.count > body_.size()) least = std::max<std::uint64_t>(least, 1);
        return std::min<std::uint64_t>(element.count, std::uint64_t{1} << 40) * least;
    }

    // Says which elements with lists of vertices are left out, and whether faces were expected. Refuses them if the file has no other faces.
    void check_others() {
        if (no_faces_ && faces_ == 0 && others_.empty())
            soup_.notes.emplace_back("its header announces 0 faces: its vertices count as points");
        for (const Element& other : others_) {
            const std::string text = fmt::format("'{}' ({})", shown(other.name), other.count);
            if (faces_ == 0 && other.name != "range_grid")
                refuse_file(
                    fmt::format("its elements {} have lists of vertices, but only faces, tristrips and edges "
                                "are read: name them 'face' if they are faces",
                                text));
            soup_.notes.push_back(fmt::format("its elements {}, which have lists of vertices, were left out", text));
        }
    }

    // Checks the bytes after the last element.
    void check_rest() {
        const std::string_view rest = body_;
        const std::size_t size = rest.size();
        const std::string_view word = next_word_of_body();
        if (word.empty()) return;
        if (text())
            refuse_file(
                fmt::format("has words after its last element, such as '{}': the header announces fewer "
                            "elements or properties than its lines have: correct it",
                            shown(word)));
        const std::string_view zeros("\0 \t\r\n", 5);
        const bool padding = rest.find_first_not_of(zeros) == std::string_view::npos;
        if (!padding && size >= vertex_bytes_)
            refuse_file(
                fmt::format("has {} bytes after its last element: the header announces fewer elements or smaller "
                            "properties than are there: correct it, or cut the bytes off",
                            size));
        soup_.notes.push_back(fmt::format("{} bytes after its last element were left out", size));
    }

    // Adds the triangles of a strip. Every second triangle has its corners in the reverse order.
    void add_strip(const std::vector<std::size_t>& strip) {
        std::size_t start = 0;
        for (std::size_t i = 0; i < strip.size(); ++i) {
            if (strip[i] == static_cast<std::size_t>(-1)) start = i + 1;
            if (i < start + 2) continue;
            const std::size_t a = strip[i - 2], b = strip[i - 1], c = strip[i];
            if (a == b || b == c || a == c) continue;
            soup_.faces.push_back((i - start) % 2 == 0 ? std::vector{a, b, c} : std::vector{b, a, c});
        }
    }

    void read_one(const Element& element) {
        Vec3 point = Vec3::Zero();
        std::vector<std::size_t> face;
        std::array<std::size_t, 2> edge{};
        const bool corners = element.is_faces() || element.is_strips();
        for (const Property& property : element.properties) {
            const int axis = element.is_vertices() ? property.axis(first_axis_) : -1;
            const std::uint64_t count = property.count ? whole_number(*property.count) : 1;
            for (std::uint64_t i = 0; i < count; ++i) {
                if (corners && property.is_corners())
                    face.push_back(whole_number(property.type));
                else if (element.is_edges() && (property.name == "vertex1" || property.name == "vertex2"))
                    edge[property.name == "vertex1" ? 0 : 1] = whole_number(property.type);
                else if (const double value = number(property.type); axis >= 0)
                    point[axis] = value;
            }
            if (axis >= 0) {
                soup_.float32 = soup_.float32 || property.type.is_float32();
                if (!property.type.holds(point[axis])) refuse_coordinate(property, point[axis]);
            }
        }
        if (element.is_vertices()) soup_.points.push_back(point);
        if (element.is_edges()) soup_.faces.push_back({edge[0], edge[1]});
        if (element.is_strips()) add_strip(face);
        if (element.is_faces()) soup_.faces.push_back(std::move(face));
    }

    [[noreturn]] void refuse_coordinate(const Property& property, double value) const {
        refuse_file(
            fmt::format("vertex {} (from 0): {} is {:.17g}, which its integer type cannot hold: write 'property "
                        "double {}' in the header",
                        soup_.points.size(), property.name, value, property.name));
    }

    [[noreturn]] void end_early() const {
        refuse_file(
            fmt::format("is truncated or damaged after {} of {} vertices and {} of {} faces (a word that is not a "
                        "number ends the reading too): save or fetch it again",
                        soup_.points.size(), points_, soup_.faces.size(), faces_));
    }

    double number(Stored type) {
        if (text()) {
            const std::string_view word = next_word_of_body();
            // Reads a float32 as such, so that it is rounded once. Rounding to double first could give another float.
            const auto value = type.is_float32() ? std::optional<double>(decimal<float>(word)) : decimal(word);
            if (!value) end_early();
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
        if (std::floor(value) != value || !(std::abs(value) <= 0x1p53)) end_early();
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
    bool seen_ = false;                     // an element of vertices
    char first_axis_ = 'x';                 // the name of the first coordinate, or 'X'
    std::uint64_t vertex_bytes_ = 0;        // least number of bytes of a vertex
    std::vector<Element> others_;           // with lists of vertices that are not read
    bool no_faces_ = false;                 // the header has an element for faces, and announces none
    std::uint64_t points_ = 0, faces_ = 0;  // numbers that the header announces; strips and edges count as faces
    Soup soup_;
};

}  // namespace

Soup read_ply(const Input& input) {
    const std::string& name = input.name;
    const std::string_view bytes = input.bytes;
    return PlyReader(name, bytes).read();
}

}  // namespace hausbench::readers
