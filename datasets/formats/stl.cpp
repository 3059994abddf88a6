// Reads STL, text or binary: the facets of all solids. A file counts as binary if its size matches the number of
// triangles in its header, even if it begins with "solid" like a text file, because some programs write such binary
// files. Keywords of a text file may be in upper or lower case. Ignores normals, and the attribute bytes of a binary
// facet (colours).
//
// STL states no unit and no axes. A coordinate of a binary file is exactly the stored float32; of a text file, the
// double nearest to the decimal number. Corners with equal coordinates become one vertex.
#include "algorithms/error.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"

#include <fmt/format.h>

#include <cstring>

namespace hausbench::readers {
namespace {

constexpr std::size_t header = 84, facet = 50;  // bytes

// Returns the number of facets in the header of a binary file.
std::size_t facets_of(std::string_view bytes) {
    std::uint32_t facets = 0;
    if (bytes.size() >= header) std::memcpy(&facets, bytes.data() + 80, sizeof facets);
    return facets;
}

Soup read_binary(const std::string& name, std::string_view bytes, bool drop_invalid) {
    const std::size_t facets = facets_of(bytes), expected = header + facet * facets;
    // A file that is too long was usually transferred as text, which inserts bytes; its coordinates would be wrong.
    if (bytes.size() != expected)
        throw InputError(
            fmt::format("{}: is {}, or not an STL file: {} facets take {} bytes, {} bytes found: fetch or "
                        "save it again",
                        name, bytes.size() < expected ? "truncated" : "damaged", facets, expected, bytes.size()));
    Soup soup;
    soup.merge = soup.float32 = true;
    soup.points.reserve(3 * facets);
    for (std::size_t f = 0; f < facets; ++f) {
        for (std::size_t k = 0; k < 3; ++k) {
            std::array<float, 3> corner;
            std::memcpy(corner.data(), bytes.data() + header + f * facet + 12 * (k + 1), sizeof corner);
            soup.points.emplace_back(corner[0], corner[1], corner[2]);
            if (!drop_invalid && !soup.points.back().allFinite())
                throw InputError(fmt::format(
                    "{}: vertex {} of facet {} (both from 0) has a coordinate that is not finite: mend it, or leave "
                    "such facets out with --drop-invalid (in Python drop_invalid=True)",
                    name, k, f));
        }
        soup.faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
    }
    return soup;
}

Soup read_text(const std::string& name, std::string_view bytes) {
    Soup soup;
    soup.merge = true;
    soup.objects = 0;
    bool in_solid = false, in_facet = false;
    for (std::uint32_t number = 1; !bytes.empty(); ++number) {
        std::string_view line = next_line(bytes);
        const std::string keyword = lower_case(next_word(line));
        const std::size_t first = 3 * soup.faces.size(), corners = soup.points.size() - first;  // in this facet
        const auto nothing_more = [&](std::string_view rest) {
            const std::string_view word = next_word(rest);
            if (!word.empty())
                refuse(name, number,
                       fmt::format("'{}' follows '{}': write it on a line of its own", shown(word), keyword));
        };
        if (keyword == "solid") {
            if (lower_case(line).find("facet normal") != std::string::npos)
                refuse(name, number, "'facet' follows 'solid': write it on a line of its own");
            if (in_solid) refuse(name, number, "a solid begins inside another");
            in_solid = true;
            ++soup.objects;
        } else if (keyword == "facet") {
            if (in_facet) refuse(name, number, "a facet begins inside another");
            in_facet = true;
            if (const std::string_view word = next_word(line); lower_case(word) == "normal")
                for (int k = 0; k < 3; ++k) next_word(line);
            nothing_more(line);
        } else if (keyword == "vertex") {
            if (!in_facet) refuse(name, number, "a vertex stands outside of a facet");
            add_point(name, line, number, soup);
            for (int k = 0; k < 3; ++k) next_word(line);
            nothing_more(line);
        } else if (keyword == "endfacet") {
            if (!in_facet) refuse(name, number, "a facet ends here that did not begin");
            if (corners != 3) refuse(name, number, fmt::format("a facet of {} vertices ends here", corners));
            nothing_more(line);
            soup.faces.push_back({first, first + 1, first + 2});
            in_facet = false;
        } else if (keyword == "endsolid") {
            in_solid = false;
        } else if (keyword == "outer" || keyword == "endloop") {
            if (keyword == "outer") next_word(line);
            nothing_more(line);
        } else if (!keyword.empty()) {
            refuse(name, number, fmt::format("'{}' is not a word of an STL file", shown(keyword)));
        }
    }
    if (in_solid || in_facet)
        throw InputError(fmt::format("{}: ends inside a solid, after {} facets: truncated", name, soup.faces.size()));
    return soup;
}

}  // namespace

Soup read_stl(const Input& input) {
    const std::string& name = input.name;
    std::string_view bytes = input.bytes;
    if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
    const std::string_view start = bytes.substr(0, 512);
    const std::size_t first = start.find_first_not_of(" \t\r\n");
    const bool solid = first != std::string_view::npos && lower_case(start.substr(first, 5)) == "solid" &&
                       start.find('\0') == std::string_view::npos;
    if (bytes.size() >= header && (!solid || bytes.size() == header + facet * facets_of(bytes)))
        return read_binary(name, bytes, input.options.drop_invalid);
    if (!solid)
        throw InputError(
            name + ": is not an STL file: it neither begins with 'solid' nor has the 84 bytes of a binary header");
    return read_text(name, bytes);
}

}  // namespace hausbench::readers
