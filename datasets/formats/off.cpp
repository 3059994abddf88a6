// Reads OFF as text: a header of any number of lines, whose keyword may be missing, then one line for each vertex and
// for each face. Refuses files whose lines are divided in another way. A face of two corners is a segment, and one of
// one corner a point. Ignores the colours, normals and texture coordinates that may follow in a line. The counts may
// follow the keyword without a blank, as in the "OFF8 6 0" of ModelNet40. Refuses nOFF, 4nOFF and binary files.
//
// OFF states no unit and no axes. A coordinate is the double nearest to the decimal number; in 4OFF, the quotient of
// two such doubles, rounded once.
#include "algorithms/error.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <limits>

namespace hausbench::readers {
namespace {

constexpr const char* each_alone =
    ": fetch it again if it is truncated, or write each vertex and each face on a line of its own";

struct Line {
    std::string_view text;
    std::uint32_t number;  // in the file, from 1
};

struct OffHeader {
    bool four = false;  // 4OFF: a vertex has a fourth number, by which x, y and z are divided
    std::size_t points = 0, faces = 0, lines = 0;  // `lines`: of the header itself
};

// Returns an integer from 0 to end - 1, or nothing if the word is not one. Some files write integers with a decimal
// point.
std::optional<std::size_t> number_below(std::size_t end, std::string_view word) {
    const auto value = decimal(word);
    if (!value || !(*value >= 0 && *value < static_cast<double>(end)) || std::floor(*value) != *value)
        return std::nullopt;
    return static_cast<std::size_t>(*value);
}

// Returns whether a word is a header that is read: OFF, with ST, C, N and 4 before it, in this order.
bool is_keyword(std::string_view word) {
    for (const std::string_view part : {"ST", "C", "N", "4"})
        if (word.starts_with(part)) word.remove_prefix(part.size());
    return word == "OFF";
}

// Returns the number of vertices or faces that the header of a file of `size` bytes announces.
std::size_t count_of(const std::string& name, std::string_view word, const char* what, std::size_t size) {
    const std::string_view number = word.substr(0, word.find(','));
    // The line of a vertex or face takes at least two bytes, so a count above size / 2 is wrong. Refusing it here saves
    // the memory for that many elements.
    if (const auto value = number_below(size / 2 + 1, number)) return *value;
    const bool whole = bool(number_below(std::numeric_limits<std::size_t>::max(), number));
    throw InputError(
        fmt::format("{}: the header announces {} {}, {}", name, shown(word), what,
                    whole ? fmt::format("which a file of {} bytes cannot hold", size) : "which is not a count"));
}

[[noreturn]] void refuse_binary(const std::string& name) {
    throw InputError(name + ": binary OFF is not supported: convert it to text");
}

OffHeader header_of(const std::string& name, const std::vector<Line>& lines, std::size_t size) {
    OffHeader header;
    std::string_view keyword;
    std::vector<std::string_view> counts;
    for (; header.lines < lines.size() && counts.size() < 2; ++header.lines) {
        auto [line, number] = lines[header.lines];
        for (auto word = next_word(line); !word.empty(); word = next_word(line)) {
            const std::size_t end = word.find("OFF") + 3;  // of the keyword, if the number of vertices follows it
            if (keyword.empty() && counts.empty() && end >= 3 && end < word.size() &&
                word.find_first_not_of("0123456789", end) == std::string_view::npos) {
                line = {word.begin() + static_cast<std::ptrdiff_t>(end), line.end()};
                word = word.substr(0, end);
            }
            if (word == "BINARY" && counts.empty()) refuse_binary(name);
            if (!keyword.empty() || !counts.empty() || !std::isalpha(static_cast<unsigned char>(word.back()))) {
                counts.push_back(word);
                continue;
            }
            keyword = word;
            if (!is_keyword(word))
                refuse(name, number,
                       fmt::format(
                           "'{}' is not a supported OFF header (OFF, with ST, C, N or 4 before it, in this order): "
                           "save the file as OFF with three coordinates",
                           shown(word)));
        }
    }
    if (counts.size() < 2) throw InputError(name + ": has no OFF header with the number of vertices and faces");
    if (header.lines < lines.size()) {  // the number of edges may stand alone in the next line
        std::string_view line = lines[header.lines].text;
        const std::string_view word = next_word(line);
        if (next_word(line).empty() && whole<std::int64_t>(word)) ++header.lines;
    }
    header.four = keyword.find('4') != std::string_view::npos;
    header.points = count_of(name, counts[0], "vertices", size);
    header.faces = count_of(name, counts[1], "faces", size);
    return header;
}

void add_vertex(const std::string& name, Line line, bool four, Soup& soup) {
    add_point(name, line.text, line.number, soup);
    if (!four) return;
    for (int k = 0; k < 3; ++k) next_word(line.text);
    const auto weight = decimal(next_word(line.text));
    if (!weight) refuse(name, line.number, "a vertex of 4OFF needs four numbers");
    soup.points.back() /= *weight;
}

void add_face(const std::string& name, Line line, Soup& soup) {
    const std::size_t most = line.text.size();
    const auto corners = number_below(most, next_word(line.text));
    if (!corners)
        refuse(
            name, line.number,
            fmt::format("face {} (from 0) does not begin with its number of corners{}", soup.faces.size(), each_alone));
    std::vector<std::size_t> face;
    while (face.size() < *corners) {
        const auto index = number_below(soup.points.size(), next_word(line.text));
        if (!index)
            refuse(name, line.number,
                   fmt::format("face {} (from 0) does not name {} of the {} vertices", soup.faces.size(), *corners,
                               soup.points.size()));
        face.push_back(*index);
    }
    soup.faces.push_back(std::move(face));
    soup.face_lines.push_back(line.number);
}

}  // namespace

Soup read_off(const Input& input) {
    const std::string& name = input.name;
    const std::string_view bytes = input.bytes;
    if (bytes.find('\0') != std::string_view::npos) refuse_binary(name);
    std::vector<Line> lines;  // without empty lines and comments
    std::string_view rest = bytes;
    for (std::uint32_t number = 1; !rest.empty(); ++number) {
        const std::string_view line = next_line(rest);
        const std::string_view text = trimmed(line.substr(0, line.find('#')));
        if (!text.empty()) lines.push_back({text, number});
    }
    const OffHeader header = header_of(name, lines, bytes.size());
    const std::size_t there = lines.size() - header.lines;
    if (there < header.points)
        throw InputError(fmt::format("{}: ends after {} of {} vertices{}", name, there, header.points, each_alone));
    if (there - header.points < header.faces)
        throw InputError(
            fmt::format("{}: ends after {} of {} faces{}", name, there - header.points, header.faces, each_alone));
    Soup soup;
    for (std::size_t i = 0; i < header.points; ++i) add_vertex(name, lines[header.lines + i], header.four, soup);
    for (std::size_t i = 0; i < header.faces; ++i) add_face(name, lines[header.lines + header.points + i], soup);
    if (const std::size_t more = there - header.points - header.faces; more > 0)
        soup.notes.push_back(fmt::format("{} line{} after its last face {} left out", more, more == 1 ? "" : "s",
                                         more == 1 ? "was" : "were"));
    return soup;
}

}  // namespace hausbench::readers
