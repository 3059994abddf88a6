#include "error.h"
#include "readers.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

namespace hausbench::readers {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& why) { throw InputError(name + ": " + why); }

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

// Removes the next word from `line` and returns it; empty at the end.
std::string_view next_word(std::string_view& line) {
    std::size_t begin = 0;
    while (begin < line.size() && is_blank(line[begin])) ++begin;
    std::size_t end = begin;
    while (end < line.size() && !is_blank(line[end])) ++end;
    const std::string_view word = line.substr(begin, end - begin);
    line.remove_prefix(end);
    return word;
}

// Calls f(line, number from 1) for each line.
template <class F> void each_line(std::string_view bytes, F f) {
    std::uint32_t number = 1;
    for (std::size_t begin = 0; begin < bytes.size(); ++number) {
        const std::size_t end = std::min(bytes.find('\n', begin), bytes.size());
        f(bytes.substr(begin, end - begin), number);
        begin = end + 1;
    }
}

// Whether the whole word is a number; one out of range or a NaN counts too, since finish() checks the values.
bool is_number(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error != std::errc::invalid_argument && end == word.data() + word.size();
}

// A stream would read "1.5D3" and "3.1+e2" as 1.5 and 3.1, and ignore the rest.
void check_coordinates(const std::string& name, std::string_view line, std::uint32_t number) {
    for (int k = 0; k < 3; ++k) {
        const std::string_view word = next_word(line);
        if (!word.empty() && !is_number(word)) refuse(name, fmt::format("line {}: '{}' is no number", number, word));
    }
}

void put_line(Mended& mended, std::string_view text, std::uint32_t number) {
    mended.bytes.append(text).push_back('\n');
    mended.lines.push_back(number);
}

// Removes a UTF-8 byte order mark; converts UTF-16 to ASCII (other characters occur only in names and comments).
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

// A backslash at the end of a line joins it with the next, which becomes empty, so that line numbers stay the same.
void join_continued(std::string& bytes) {
    std::size_t owed = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        if (bytes[i] == '\\') {
            std::size_t end = i + 1;
            while (end < bytes.size() && bytes[end] == '\r') ++end;
            if (end < bytes.size() && bytes[end] == '\n') {
                std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                          bytes.begin() + static_cast<std::ptrdiff_t>(end) + 1, ' ');
                ++owed;
            }
        } else if (bytes[i] == '\n' && owed > 0) {
            bytes.insert(i, owed, '\n');
            i += owed;
            owed = 0;
        }
    }
}

}  // namespace

Mended mend_obj(const std::string& name, std::string bytes) {
    bytes = as_ascii(bytes);
    join_continued(bytes);
    Mended mended;
    mended.objects = 0;
    bool new_object = true;
    std::string face;
    each_line(bytes, [&](std::string_view line, std::uint32_t number) {
        const std::string_view keyword = next_word(line);
        if (keyword == "v") {
            check_coordinates(name, line.substr(0, line.find('#')), number);
            put_line(mended, fmt::format("v {}", line), number);
            mended.point_lines.push_back(number);
        } else if (keyword == "o" || keyword == "g") {
            new_object = true;
        } else if (keyword == "f" || keyword == "fo") {
            mended.objects += new_object ? 1 : 0;
            new_object = false;
            face = "f";
            for (std::string_view word = next_word(line); !word.empty() && word[0] != '#'; word = next_word(line)) {
                const std::string_view digits = word.substr(0, word.find('/'));
                int index = 0;
                const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
                if (error != std::errc() || end != digits.data() + digits.size() || index == 0)
                    refuse(name,
                           fmt::format("line {}: '{}' is no vertex number (they begin with 1, or -1 from the end)",
                                       number, word));
                face.append(" ").append(digits);
            }
            put_line(mended, face, number);
            mended.face_lines.push_back(number);
        }
    });
    mended.points = mended.point_lines.size();
    mended.faces = mended.face_lines.size();
    mended.objects = std::max<std::int64_t>(mended.objects, 1);
    return mended;
}

Mended mend_off(const std::string& name, const std::string& bytes) {
    if (bytes.find('\0') != std::string::npos) refuse(name, "a binary OFF file is not read: convert it to text");
    Mended mended;
    std::vector<std::string_view> words;  // of the header: keyword and three counts
    std::string keyword = "OFF";
    std::size_t left_points = 0, left_faces = 0;
    bool in_header = true;
    const auto count = [&](std::size_t which, const char* what) {
        long long value = -1;
        std::from_chars(words[which].data(), words[which].data() + words[which].size(), value);
        // The shortest line of either kind has two characters; a header with a larger count is wrong and would cost memory.
        if (value < 0 || static_cast<unsigned long long>(value) > bytes.size() / 2)
            refuse(name, fmt::format("the header announces {} {}, which a file of {} bytes cannot hold", words[which],
                                     what, bytes.size()));
        return static_cast<std::size_t>(value);
    };
    each_line(bytes, [&](std::string_view line, std::uint32_t number) {
        line = line.substr(0, line.find('#'));
        std::string_view rest = line;
        if (in_header) {
            for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
                if (words.empty() && keyword == "OFF" && std::isalpha(static_cast<unsigned char>(word.back()))) {
                    const bool four = word.find('4') != std::string_view::npos;
                    if (!word.ends_with("OFF") || word.find('n') != std::string_view::npos)
                        refuse(name,
                               fmt::format(
                                   "line {}: '{}' is no OFF header that is read (OFF, with ST, C, N or 4 before it)",
                                   number, word));
                    keyword = four ? "4OFF" : "OFF ";
                    continue;
                }
                words.push_back(word);
            }
            if (words.size() < 2) return;
            in_header = false;
            mended.points = left_points = count(0, "vertices");
            mended.faces = left_faces = count(1, "faces");
            put_line(mended, keyword, number);
            put_line(mended, fmt::format("{} {} 0", mended.points, mended.faces), number);
            return;
        }
        if (next_word(rest).empty() || (left_points == 0 && left_faces == 0)) return;
        const bool point = left_points > 0;
        if (point) check_coordinates(name, line, number);
        (point ? mended.point_lines : mended.face_lines).push_back(number);
        --(point ? left_points : left_faces);
        std::string text(line);
        std::replace(text.begin(), text.end(), '\r', ' ');
        put_line(mended, text, number);
    });
    if (in_header) refuse(name, "has no OFF header with the number of vertices and faces");
    if (left_points > 0)
        refuse(name, fmt::format("ends after {} of {} vertices", mended.points - left_points, mended.points));
    if (left_faces > 0) refuse(name, fmt::format("ends after {} of {} faces", mended.faces - left_faces, mended.faces));
    return mended;
}

namespace {

constexpr std::size_t stl_header = 84, stl_facet = 50;

Mended mend_binary_stl(const std::string& name, std::string bytes) {
    std::uint32_t facets = 0;
    std::memcpy(&facets, bytes.data() + 80, sizeof facets);
    const std::uint64_t expected = stl_header + std::uint64_t{stl_facet} * facets;
    if (bytes.size() < expected)
        refuse(name, fmt::format("is truncated, or no STL file: {} facets take {} bytes, {} bytes found", facets,
                                 expected, bytes.size()));
    if (bytes.size() > expected)  // usually a file that was transferred as text: its coordinates are wrong
        refuse(name, fmt::format("is damaged, or no STL file: {} facets take {} bytes, {} bytes found", facets,
                                 expected, bytes.size()));
    for (std::size_t f = 0; f < facets; ++f)
        for (std::size_t k = 0; k < 9; ++k) {  // before CGAL sorts them, which fails with a NaN
            float value = 0;
            std::memcpy(&value, bytes.data() + stl_header + f * stl_facet + 12 + 4 * k, sizeof value);
            if (!std::isfinite(value))
                refuse(name, fmt::format("vertex {} of facet {} (both from 0) has a coordinate that is not finite",
                                         k / 3, f));
        }
    std::fill_n(bytes.begin(), 80, 'x');
    Mended mended;
    mended.bytes = std::move(bytes);
    mended.faces = facets;
    mended.float32 = true;
    return mended;
}

}  // namespace

Mended mend_stl(const std::string& name, std::string bytes) {
    std::uint32_t facets = 0;
    if (bytes.size() >= stl_header) std::memcpy(&facets, bytes.data() + 80, sizeof facets);
    const bool exact = bytes.size() >= stl_header && bytes.size() == stl_header + std::uint64_t{stl_facet} * facets;
    const auto lower = [](std::string_view word) {
        std::string text(word);
        std::transform(text.begin(), text.end(), text.begin(),
                       [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
        return text;
    };
    std::string_view start(bytes);
    start = start.substr(0, 512);
    const std::size_t first = start.find_first_not_of(" \t\r\n");
    const bool solid = first != std::string_view::npos && lower(start.substr(first, 5)) == "solid" &&
                       start.find('\0') == std::string_view::npos;
    if (exact || (!solid && bytes.size() >= stl_header)) return mend_binary_stl(name, std::move(bytes));
    if (!solid) refuse(name, "is no STL file: neither begins with 'solid' nor has the 84 bytes of a binary header");

    Mended mended;
    mended.objects = 0;
    bool inside = false;
    each_line(bytes, [&](std::string_view line, std::uint32_t number) {
        const std::string keyword = lower(next_word(line));
        if (keyword == "solid") {
            if (inside) refuse(name, fmt::format("line {}: a solid begins inside another", number));
            inside = true;
            ++mended.objects;
            put_line(mended, "solid", number);  // without the name, which could be a keyword
        } else if (keyword == "vertex") {
            check_coordinates(name, line, number);
            put_line(mended, fmt::format("vertex {}", line), number);
        } else if (keyword == "facet" || keyword == "endfacet" || keyword == "endsolid") {
            if (keyword == "facet") mended.face_lines.push_back(number);
            if (keyword == "endsolid") inside = false;
            put_line(mended, keyword, number);
        } else if (!keyword.empty() && keyword != "outer" && keyword != "endloop") {
            refuse(name, fmt::format("line {}: '{}' is no word of an STL file", number, keyword));
        }
    });
    if (inside) refuse(name, fmt::format("ends inside a solid, after {} facets: truncated", mended.face_lines.size()));
    mended.faces = mended.face_lines.size();
    return mended;
}

}  // namespace hausbench::readers
