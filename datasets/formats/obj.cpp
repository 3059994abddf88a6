// Reads Wavefront OBJ: x, y and z of `v` lines, and the vertex numbers of faces (`f`, `fo`), lines (`l`, whose parts
// are segments) and points (`p`). A face of two corners is a segment.
//
// Ignores texture coordinates, normals, `vp`, groups, materials and display attributes, and a colour or the weight 1
// after z in a `v` line. Another weight is left out with a note: by the format's specification it counts only in
// rational curves and surfaces, which are refused, but some programs divide x, y and z of every vertex by it. Refuses
// free-form curves and surfaces (cstype, curv, surf, ...), superseded ones (bzp, bsp, cdc, cdp, res), and `call` and
// `csh`, which insert what another file or program says. A note names the first of other lines, which are left out.
//
// OBJ states no unit and no axes. A coordinate is the double nearest to the decimal number.
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>

namespace hausbench::readers {
namespace {

// Returns the text without a byte order mark. Converts UTF-16 to ASCII, with '?' for other characters, which occur only
// in names and comments.
std::string as_ascii(std::string_view bytes) {
    if (bytes.starts_with("\xef\xbb\xbf")) return std::string(bytes.substr(3));
    const bool little = bytes.starts_with("\xff\xfe"), big = bytes.starts_with("\xfe\xff");
    if (!little && !big) return std::string(bytes);
    std::string narrow;
    for (std::size_t i = 2; i + 1 < bytes.size(); i += 2) {
        const char low = bytes[little ? i : i + 1], high = bytes[little ? i + 1 : i];
        narrow.push_back(high == 0 ? low : '?');
    }
    return narrow;
}

// Removes the first line from `bytes` and returns it. While it ends with a backslash, also removes the next line and
// appends it. Adds the number of removed lines to `number`. Refuses a comment that would swallow a statement in this
// way, as in "# from C:\models\": programs differ on what it means.
std::string next_statement(const std::string& name, std::string_view& bytes, std::uint32_t& number) {
    std::string statement;
    for (bool goes_on = true; goes_on && !bytes.empty(); ++number) {
        statement += next_line(bytes);
        goes_on = statement.ends_with('\\');
        if (!goes_on) continue;
        std::string_view words = statement, next = bytes;
        const std::string_view keyword = next_word(words);
        const bool names = keyword == "g" || keyword == "o" || keyword == "usemtl" || keyword == "mtllib";
        std::string_view following = next_line(next);
        const std::string_view first = next_word(following);
        const bool swallows = first == "v" || first == "f" || first == "fo" || first == "l" || first == "p";
        if (swallows && (names || statement.find('#') != std::string::npos))
            refuse(name, number + 1,
                   "ends with a backslash, which would join the next line to a comment or a name: remove the "
                   "backslash");
        statement.back() = ' ';
    }
    return statement;
}

// Returns the vertices of a face, numbered from 0; finish() checks that they exist. Ignores the texture and the normal
// of a corner, which follow slashes. `points` is the number of vertices read so far.
std::vector<std::size_t> face_of(const std::string& name, std::string_view line, std::uint32_t number,
                                 std::size_t points) {
    std::vector<std::size_t> face;
    for (auto word = next_word(line); !word.empty() && word[0] != '#'; word = next_word(line)) {
        const auto index = whole<int>(word.substr(0, word.find('/')));
        if (!index || *index == 0)
            refuse(name, number,
                   fmt::format("'{}' is not a vertex number (they count from 1, or from -1 backwards)", shown(word)));
        face.push_back(static_cast<std::size_t>(*index > 0 ? *index - 1 : static_cast<std::int64_t>(points) + *index));
    }
    return face;
}

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

// Returns whether numbers follow x, y and z in a `v` line that are neither the weight 1 nor a colour. Refuses other
// words.
bool has_more_numbers(const std::string& name, std::string_view line, std::uint32_t number) {
    for (int i = 0; i < 3; ++i) next_word(line);
    std::vector<double> rest;
    for (auto word = next_word(line); !word.empty(); word = next_word(line)) {
        const auto value = decimal(word);
        if (!value) refuse(name, number, fmt::format("'{}' after z is not a number: remove it", shown(word)));
        rest.push_back(*value);
    }
    return rest.size() == 1 ? rest[0] != 1 : !rest.empty() && rest.size() != 3;
}

// Refuses a statement that makes geometry which is not read. Returns whether the statement is known, and makes none.
bool may_be_ignored(const std::string& name, std::string_view keyword, std::uint32_t number) {
    if (is_one_of(keyword, {"cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm", "trim", "hole", "scrv",
                            "sp", "con", "bzp", "bsp", "cdc", "cdp", "res"}))
        refuse(name, number,
               fmt::format("'{}' belongs to a free-form curve or surface, which is not read: convert it to polygons in "
                           "the program that wrote it, or in Blender",
                           keyword));
    if (is_one_of(keyword, {"call", "csh"}))
        refuse(
            name, number,
            fmt::format("'{}' inserts what another file or program says, which is not read: write its lines into the "
                        "file",
                        keyword));
    if (is_one_of(keyword, {"V", "F", "L", "P"}))
        refuse(name, number, fmt::format("'{}' is not a keyword: write it in lower case", keyword));
    return keyword.empty() || keyword.front() == '#' ||
           is_one_of(keyword, {"v",        "vt",       "vn",         "vp",        "o",      "g",     "s",
                               "mg",       "usemtl",   "mtllib",     "usemap",    "maplib", "bevel", "lod",
                               "c_interp", "d_interp", "shadow_obj", "trace_obj", "ctech",  "stech", "end"});
}

// Adds the faces of an f, l or p statement.
void add_faces(const std::string& name, std::string_view keyword, std::string_view line, std::uint32_t number,
               Soup& soup) {
    const std::vector<std::size_t> corners = face_of(name, line, number, soup.points.size());
    if (keyword == "l" && corners.size() < 2) refuse(name, number, "a line needs two vertices or more");
    if (keyword == "p" && corners.empty()) refuse(name, number, "names no point");
    const bool whole_face = keyword != "p" && keyword != "l";
    const std::size_t size = keyword == "p" ? 1 : 2;  // corners of each part
    for (std::size_t i = 0; !whole_face && i + size <= corners.size(); ++i) {
        const auto first = corners.begin() + static_cast<std::ptrdiff_t>(i);
        soup.faces.emplace_back(first, first + static_cast<std::ptrdiff_t>(size));
        soup.face_lines.push_back(number);
    }
    if (!whole_face) return;
    soup.faces.push_back(corners);
    soup.face_lines.push_back(number);
}

}  // namespace

Soup read_obj(const Input& input) {
    const std::string& name = input.name;
    const std::string_view bytes = input.bytes;
    Soup soup;
    soup.objects = 0;
    bool new_object = true;
    std::size_t unknown = 0;
    std::string first_unknown;
    std::size_t weights = 0, first_weight = 0;
    const std::string text = as_ascii(bytes);
    std::string_view rest = text;
    for (std::uint32_t last = 0; !rest.empty();) {
        const std::uint32_t number = last + 1;
        const std::string statement = next_statement(name, rest, last);
        std::string_view line = statement;
        const std::string_view keyword = next_word(line);
        if (keyword == "v") {
            line = line.substr(0, line.find('#'));
            add_point(name, line, number, soup);
            if (has_more_numbers(name, line, number) && weights++ == 0) first_weight = number;
        }
        if (keyword == "o" || keyword == "g") new_object = true;
        if (!is_one_of(keyword, {"f", "fo", "l", "p"})) {
            if (!may_be_ignored(name, keyword, number) && unknown++ == 0)
                first_unknown = fmt::format("'{}' in line {}", shown(keyword), number);
            continue;
        }
        soup.objects += new_object ? 1 : 0;
        new_object = false;
        add_faces(name, keyword, line, number, soup);
    }
    if (weights > 0)
        soup.notes.push_back(
            fmt::format("numbers after z are left out in {} `v` line{}, the first {}: they are not a colour, and a "
                        "weight counts only "
                        "in rational curves and surfaces",
                        weights, weights == 1 ? "" : "s", first_weight));
    if (unknown > 0)
        soup.notes.push_back(
            unknown == 1
                ? fmt::format("a line with an unknown keyword, {}, was left out", first_unknown)
                : fmt::format("{} lines with unknown keywords, the first {}, were left out", unknown, first_unknown));
    soup.objects = std::max<std::int64_t>(soup.objects, 1);
    return soup;
}

}  // namespace hausbench::readers
