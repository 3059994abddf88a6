// Reads VTK's legacy files, .vtk, as text or binary (big endian), of the versions 1.0 to 5.1: PolyData (vertices, lines,
// polygons, triangle strips) and unstructured grids (points, lines, triangles, strips, polygons, pixels, quadrilaterals).
//
// Refused: structured and rectilinear grids, images and all other datasets, curved cells, datasets whose cells are all
// volumes. Left out with a note: volume cells beside surface cells, and cells that the array vtkGhostType marks as
// duplicate, refined or hidden, which VTK does not show. A dataset with points and no cells is a point set. All other
// arrays are ignored.
//
// The format states no unit and no axes. A coordinate is the double nearest to the number of the file: text of an array
// of floats is rounded once to float32, as the format defines, and only integers beyond 2^53 are rounded to double.
#include "algorithms/error.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"
#include "datasets/formats/vtk_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace hausbench::readers {
namespace {

const std::map<std::string, Stored, std::less<>> types = {{"char", {'I', 1}},
                                                          {"signed_char", {'I', 1}},
                                                          {"unsigned_char", {'U', 1}},
                                                          {"short", {'I', 2}},
                                                          {"unsigned_short", {'U', 2}},
                                                          {"int", {'I', 4}},
                                                          {"unsigned_int", {'U', 4}},
                                                          {"long", {'I', 8}},
                                                          {"unsigned_long", {'U', 8}},
                                                          {"long_long", {'I', 8}},
                                                          {"unsigned_long_long", {'U', 8}},
                                                          {"vtktypeint64", {'I', 8}},
                                                          {"vtktypeuint64", {'U', 8}},
                                                          {"vtkidtype", {'I', 4}},
                                                          {"float", {'F', 4}},
                                                          {"double", {'F', 8}}};

constexpr std::array<std::string_view, 11> sections = {"points",          "vertices",  "lines",      "polygons",
                                                       "triangle_strips", "cells",     "cell_types", "connectivity",
                                                       "point_data",      "cell_data", "field"};

struct Cells {
    std::vector<std::int64_t> ends, corners;
};

class VtkReader {
public:
    explicit VtkReader(const Input& input) : name_(input.name), all_(input.bytes), rest_(input.bytes) {}

    Soup read() {
        read_header();
        for (std::string_view keyword = next(); !keyword.empty(); keyword = next()) {
            const std::string lower = lower_case(keyword);
            if (lower == "point_data" || lower == "cell_data") {
                rest_ = all_.substr(static_cast<std::size_t>(keyword.data() - all_.data()));
                break;
            }
            if (!read_section(lower))
                refuse_here(
                    fmt::format("'{}' is not the name of a section: the file is damaged, or of a kind that is "
                                "not supported",
                                shown(keyword)));
        }
        return finished();
    }

private:
    [[noreturn]] void refuse_here(const std::string& why) const {
        const std::size_t at = all_.size() - rest_.size();
        if (binary_) throw InputError(fmt::format("{}: byte {}: {}", name_, at, why));
        const auto lines = std::count(all_.begin(), all_.begin() + static_cast<std::ptrdiff_t>(at), '\n');
        // `rest_` begins after the word, or after the line, that is wrong.
        refuse(name_, static_cast<std::uint32_t>(lines + (at > 0 && all_[at - 1] == '\n' ? 0 : 1)), why);
    }

    // Returns the next word, or "" at the end of the file.
    std::string_view next() {
        constexpr std::string_view spaces = " \t\r\v\f\n";
        rest_.remove_prefix(std::min(rest_.find_first_not_of(spaces), rest_.size()));
        const std::string_view word = rest_.substr(0, rest_.find_first_of(spaces));
        rest_.remove_prefix(word.size());
        return word;
    }

    // Removes the rest of the line, up to \n: a binary array begins after it.
    std::string_view line() {
        const std::string_view rest = rest_.substr(0, rest_.find('\n'));
        rest_.remove_prefix(std::min(rest.size() + 1, rest_.size()));
        return trimmed(rest);
    }

    // Goes to the first number of an array.
    void begin_array() {
        if (binary_) line();
    }

    std::uint64_t count(const char* what) {
        const std::string_view word = next();
        const auto value = whole<std::uint64_t>(word);
        if (!value) refuse_here(fmt::format("'{}' is not the number of {}", shown(word), what));
        return *value;
    }

    Stored type() {
        const std::string_view word = next();
        const auto entry = types.find(lower_case(word));
        if (entry == types.end())
            refuse_here(
                fmt::format("'{}' is not a type of numbers that is supported: save the file with double", shown(word)));
        return entry->second;
    }

    // Refuses an array that the rest of the file cannot hold. Call it before allocating.
    void check_room(std::uint64_t values, std::uint64_t times, Stored type) const {
        const std::uint64_t room = binary_ ? rest_.size() / type.size : rest_.size() / 2 + 1;
        if (values > room / times)
            refuse_here(
                fmt::format("announces {} x {} numbers, but the file ends before: it is truncated, or its counts "
                            "are wrong{}",
                            values, times, binary_ ? " (binary data of this format are big endian)" : ""));
    }

    double number(Stored type) {
        if (binary_) {
            if (rest_.size() < type.size) refuse_here("is truncated");
            std::array<char, 8> bytes{};
            std::reverse_copy(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(type.size), bytes.begin());
            rest_.remove_prefix(type.size);
            return type.value(bytes.data());
        }
        const std::string_view word = next();
        if (word.empty()) refuse_here("is truncated: a number is missing");
        const auto value = vtk_number(word, type);
        if (!value) refuse_here(fmt::format("'{}' is not a number of the type of its array", shown(word)));
        return *value;
    }

    // Reads an array of integers, whose header line ends here.
    std::vector<std::int64_t> integers(std::uint64_t size, Stored type) {
        if (type.kind == 'F') refuse_here("the numbers of points and offsets must be integers");
        begin_array();
        check_room(size, 1, type);
        std::vector<std::int64_t> values;
        values.reserve(size);
        for (std::uint64_t i = 0; i < size; ++i) values.push_back(vtk_integer(number(type)));
        return values;
    }

    void read_header() {
        if (!lower_case(line()).starts_with("# vtk datafile version"))
            refuse_here("is not a VTK file: it does not begin with '# vtk DataFile Version'");
        std::string_view version = all_.substr(std::string_view("# vtk DataFile Version").size());
        const std::string_view word = trimmed(next_line(version));
        const auto major = whole<unsigned>(word.substr(0, word.find('.')));
        if (!major || *major > 5)
            refuse_here(fmt::format("version '{}' is not supported, only 1.0 to 5.1: save it with an older version",
                                    shown(word)));
        line();  // the title
        const std::string form = lower_case(next());
        if (form != "ascii" && form != "binary")
            refuse_here(fmt::format("line 3 must be ASCII or BINARY, not '{}'", shown(form)));
        if (lower_case(next()) != "dataset") refuse_here("a line 'DATASET ...' is missing");
        const std::string_view dataset = next();
        dataset_ = lower_case(dataset);
        if (dataset_ != "polydata" && dataset_ != "unstructured_grid")
            refuse_here(
                fmt::format("holds a dataset {}: only POLYDATA and UNSTRUCTURED_GRID are read: extract its "
                            "surface, in ParaView with Extract Surface or Contour, and save that",
                            shown(dataset)));
        binary_ = form == "binary";
    }

    // Returns whether there is such a section.
    bool read_section(const std::string& keyword) {
        if (keyword == "metadata")
            skip_metadata();
        else if (keyword == "field")
            skip_field();
        else if (keyword == "points")
            read_points();
        else if (dataset_ == "unstructured_grid" && keyword == "cells")
            read_cells(keyword);
        else if (dataset_ == "unstructured_grid" && keyword == "cell_types")
            read_cell_types();
        else if (dataset_ == "polydata" &&
                 (keyword == "vertices" || keyword == "lines" || keyword == "polygons" || keyword == "triangle_strips"))
            read_cells(keyword);
        else
            return false;
        return true;
    }

    void once(const std::string& keyword) {
        if (std::exchange(seen_[keyword], true)) refuse_here("a second section of this name");
    }

    void read_points() {
        once("points");
        const std::uint64_t size = count("points");
        const Stored stored = type();
        begin_array();
        check_room(size, 3, stored);
        soup_.float32 = stored.is_float32() && size > 0;
        soup_.points.reserve(size);
        for (std::uint64_t i = 0; i < size; ++i) {
            Vec3 point;
            for (double& coordinate : point) coordinate = number(stored);
            soup_.points.push_back(point);
        }
        components_ = 3;
    }

    // Reads lists of corners. Before version 5 each list begins with its length; since then there are two arrays.
    void read_cells(const std::string& keyword) {
        once(keyword);
        const std::uint64_t first = count("cells"), second = count("corners");
        Cells& cells = cells_[keyword];
        std::string_view ahead = rest_;
        line();
        const std::string_view start = rest_;
        const bool arrays = lower_case(next()) == "offsets";
        rest_ = arrays ? start : ahead;
        components_ = 1;
        if (arrays)
            read_offsets(first, second, cells);
        else
            read_counted(first, second, cells);
    }

    void read_offsets(std::uint64_t offsets, std::uint64_t corners, Cells& cells) {
        next();
        Stored stored = type();
        cells.ends = integers(offsets, stored);
        std::string_view keyword = next();
        if (lower_case(keyword) == "metadata") {
            skip_metadata();
            keyword = next();
        }
        if (lower_case(keyword) != "connectivity")
            refuse_here(fmt::format("CONNECTIVITY must follow OFFSETS, not '{}'", shown(keyword)));
        stored = type();
        cells.corners = integers(corners, stored);
        if (cells.ends.empty()) return;
        if (cells.ends.front() != 0) refuse_here(fmt::format("the first offset is {}, not 0", cells.ends.front()));
        cells.ends.erase(cells.ends.begin());
    }

    void read_counted(std::uint64_t count, std::uint64_t size, Cells& cells) {
        const std::vector<std::int64_t> list = integers(size, {'I', 4});
        std::size_t at = 0;
        for (std::uint64_t i = 0; i < count; ++i) {
            const std::int64_t corners = at < list.size() ? list[at] : -1;
            if (corners < 0 || static_cast<std::uint64_t>(corners) >= list.size() - at)
                refuse_here(
                    fmt::format("the lists of corners are damaged: cell {} (from 0) of {} does not fit in {} "
                                "numbers",
                                i, count, size));
            const auto begin = list.begin() + static_cast<std::ptrdiff_t>(at) + 1;
            cells.corners.insert(cells.corners.end(), begin, begin + corners);
            cells.ends.push_back(static_cast<std::int64_t>(cells.corners.size()));
            at += static_cast<std::size_t>(corners) + 1;
        }
        if (at != list.size())
            refuse_here(
                fmt::format("the lists of corners are damaged: {} cells take {} of {} numbers", count, at, size));
    }

    void read_cell_types() {
        once("cell_types");
        const std::uint64_t size = count("cells");
        piece_.types = integers(size, {'I', 4});
    }

    // Skips lines up to an empty one. The names of components, one a line, may be empty.
    void skip_metadata() {
        line();
        while (!rest_.empty()) {
            const std::string_view text = line();
            if (text.empty()) return;
            std::string_view copy = text;
            const std::string keyword = lower_case(next_word(copy));
            if (std::find(sections.begin(), sections.end(), keyword) != sections.end())
                refuse_here(fmt::format("an empty line must end METADATA before '{}'", shown(text)));
            if (lower_case(text) == "component_names")
                for (std::uint64_t i = 0; i < components_ && !rest_.empty(); ++i) line();
        }
    }

    void skip_field() {
        next();  // its name
        const std::uint64_t arrays = count("arrays");
        for (std::uint64_t i = 0; i < arrays; ++i) {
            std::string_view array = next();
            if (lower_case(array) == "metadata") {
                skip_metadata();
                array = next();
            }
            if (array.empty()) refuse_here("is truncated: an array of a FIELD is missing");
            if (array == "NULL_ARRAY") continue;
            const std::uint64_t components = count("components"), tuples = count("tuples");
            skip_array(components, tuples);
            components_ = components;
        }
    }

    // Skips an array of a FIELD, which begins with its type. Each text takes a byte at least, and each bit a bit.
    void skip_array(std::uint64_t components, std::uint64_t tuples) {
        const std::string_view ahead = rest_;
        const std::string kind = lower_case(next());
        if (components == 0 || tuples == 0) {
            line();
            return;
        }
        if (kind == "string" || kind == "utf8_string" || kind == "bit") {
            line();
            if (tuples > 8 * rest_.size() / components) refuse_here("is truncated: it ends within an array of a FIELD");
            const std::uint64_t size = tuples * components;
            if (kind == "bit" && binary_)
                rest_.remove_prefix((size + 7) / 8);
            else if (kind == "bit")
                for (std::uint64_t i = 0; i < size; ++i) next();
            else
                for (std::uint64_t i = 0; i < size; ++i) skip_string();
            return;
        }
        rest_ = ahead;
        const Stored stored = type();
        begin_array();
        check_room(tuples, components, stored);
        if (binary_)
            rest_.remove_prefix(tuples * components * stored.size);
        else
            for (std::uint64_t i = 0; i < tuples * components; ++i) next();
    }

    // A text is a line, or in a binary file its length and its bytes. The two highest bits of the length say how many
    // bytes it takes: 8, 4, 2 or 1.
    void skip_string() {
        if (!binary_) {
            line();
            return;
        }
        if (rest_.empty()) refuse_here("is truncated");
        const auto first = static_cast<unsigned char>(rest_[0]);
        const std::size_t bytes = std::size_t{8} >> (first >> 6);
        if (rest_.size() < bytes) refuse_here("is truncated");
        std::uint64_t length = first & 0x3f;
        for (std::size_t i = 1; i < bytes; ++i) length = length << 8 | static_cast<unsigned char>(rest_[i]);
        if (length > rest_.size() - bytes) refuse_here("is truncated");
        rest_.remove_prefix(bytes + static_cast<std::size_t>(length));
    }

    // Finds the array vtkGhostType in the sections POINT_DATA and CELL_DATA, where `rest_` begins. VTK writes it as a
    // field, "vtkGhostType 1 12 unsigned_char", as "SCALARS vtkGhostType unsigned_char" or as
    // "COLOR_SCALARS vtkGhostType 1". A search is enough, as VTK encodes blanks in names and no other program uses this
    // name.
    void read_ghosts() {
        constexpr std::string_view array = "vtkGhostType";
        const auto blank = [](char c) { return std::string_view(" \t\r\n").find(c) != std::string_view::npos; };
        const std::string_view data = rest_;
        for (std::size_t at = data.find(array); at != std::string_view::npos; at = data.find(array, at + 1)) {
            rest_ = data.substr(at + array.size());
            if (at > 0 && blank(data[at - 1]) && !rest_.empty() && blank(rest_[0]))
                read_ghosts_after(data.substr(0, at));
        }
    }

    void read_ghosts_after(std::string_view text) {
        const std::string before = lower_case(text);
        const std::size_t points = before.rfind("point_data"), cells = before.rfind("cell_data");
        const bool of_cells = cells != std::string::npos && (points == std::string::npos || cells > points);
        const std::uint64_t size = of_cells ? piece_.types.size() : soup_.points.size();
        once(of_cells ? "vtkGhostType of cells" : "vtkGhostType of points");
        auto& ghosts = of_cells ? piece_.cell_ghosts : piece_.point_ghosts;
        if (trimmed(before).ends_with("color_scalars")) {
            read_color_ghosts(size, ghosts);
            return;
        }
        const bool scalars = trimmed(before).ends_with("scalars");
        if (!scalars && (count("components") != 1 || count("tuples") != size))
            refuse_here(
                "the array vtkGhostType does not have one number for each point or cell: remove it in ParaView");
        const Stored stored = type();
        if (scalars) {
            line();
            if (lower_case(next()) != "lookup_table") refuse_here("LOOKUP_TABLE must follow SCALARS vtkGhostType");
            next();
        }
        ghosts = integers(size, stored);
    }

    // Reads an array of bytes that is written as colours: in text, each byte is divided by 255.
    void read_color_ghosts(std::uint64_t size, std::vector<std::int64_t>& ghosts) {
        if (count("components") != 1)
            refuse_here("the array vtkGhostType has several components: remove it in ParaView");
        const Stored stored = binary_ ? Stored{'U', 1} : Stored{'F', 4};
        begin_array();
        check_room(size, 1, stored);
        for (std::uint64_t i = 0; i < size; ++i)
            ghosts.push_back(vtk_integer(std::round(number(stored) * (binary_ ? 1 : 255))));
    }

    Soup finished() {
        const std::array<std::pair<const char*, VtkType>, 4> lists = {{{"vertices", VtkType::poly_vertex},
                                                                       {"lines", VtkType::poly_line},
                                                                       {"polygons", VtkType::polygon},
                                                                       {"triangle_strips", VtkType::triangle_strip}}};
        for (const auto& [keyword, type] : lists) {
            const Cells& cells = cells_[keyword];
            piece_.append(name_, type, cells.ends, cells.corners);
        }
        if (dataset_ == "unstructured_grid") {
            const std::vector<std::int64_t> stated = std::move(piece_.types);
            piece_.types.clear();
            piece_.append(name_, VtkType::polygon, cells_["cells"].ends, cells_["cells"].corners);
            if (stated.size() != piece_.types.size())
                throw InputError(fmt::format("{}: has {} cells, but CELL_TYPES gives the types of {}", name_,
                                             piece_.types.size(), stated.size()));
            piece_.types = stated;
        }
        if (!rest_.empty()) read_ghosts();
        VtkCells cells(name_, soup_);
        cells.add(piece_);
        cells.end();
        return std::move(soup_);
    }

    const std::string& name_;
    std::string_view all_, rest_;
    bool binary_ = false;
    std::string dataset_;                 // in lower case
    std::map<std::string, bool> seen_;    // sections
    std::map<std::string, Cells> cells_;  // of each section, by its name
    std::uint64_t components_ = 0;        // of the last array
    VtkPiece piece_;
    Soup soup_;
};

}  // namespace

Soup read_vtk(const Input& input) { return VtkReader(input).read(); }

}  // namespace hausbench::readers
