// Reads Wavefront OBJ: `v` lines, and the vertex numbers of `f` lines. Ignores everything else.
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"

#include <fmt/format.h>

#include <algorithm>

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
// appends it. Adds the number of removed lines to `number`.
std::string next_statement(std::string_view& bytes, std::uint32_t& number) {
    std::string statement;
    for (bool goes_on = true; goes_on && !bytes.empty(); ++number) {
        statement += next_line(bytes);
        goes_on = statement.ends_with('\\');
        if (goes_on) statement.back() = ' ';
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

}  // namespace

Soup read_obj(const Input& input) {
    const std::string& name = input.name;
    const std::string_view bytes = input.bytes;
    Soup soup;
    soup.objects = 0;
    bool new_object = true;
    const std::string text = as_ascii(bytes);
    std::string_view rest = text;
    for (std::uint32_t last = 0; !rest.empty();) {
        const std::uint32_t number = last + 1;
        const std::string statement = next_statement(rest, last);
        std::string_view line = statement;
        const std::string_view keyword = next_word(line);
        if (keyword == "v") add_point(name, line.substr(0, line.find('#')), number, soup);
        if (keyword == "o" || keyword == "g") new_object = true;
        if (keyword != "f" && keyword != "fo") continue;
        soup.objects += new_object ? 1 : 0;
        new_object = false;
        soup.faces.push_back(face_of(name, line, number, soup.points.size()));
        soup.face_lines.push_back(number);
    }
    soup.objects = std::max<std::int64_t>(soup.objects, 1);
    return soup;
}

}  // namespace hausbench::readers
