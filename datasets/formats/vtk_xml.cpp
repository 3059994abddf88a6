// Reads VTK's XML files of PolyData, .vtp, and of unstructured grids, .vtu, with any number of pieces, in either byte
// order: arrays as text, inline base64 or appended (raw or base64), uncompressed or compressed by zlib.
//
// Refused: files compressed by LZ4 or LZMA, several time steps, other datasets and parallel files, curved cells, datasets
// whose cells are all volumes. Left out with a note: volume cells beside surface cells, and cells that the array
// vtkGhostType marks as duplicate, refined or hidden, which VTK does not show. A dataset with points and no cells is a
// point set. All other arrays are ignored.
//
// The format states no unit and no axes. A coordinate is the double nearest to the number of the file: text of an array
// of Float32 is rounded once to float32, as the format defines, and only integers beyond 2^53 are rounded to double.
#include "algorithms/error.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"
#include "datasets/formats/vtk_cells.h"
#include "datasets/formats/xml.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

namespace hausbench::readers {
namespace {

using pugi::xml_node;

const std::map<std::string, Stored, std::less<>> types = {
    {"Int8", {'I', 1}},   {"UInt8", {'U', 1}}, {"Int16", {'I', 2}},  {"UInt16", {'U', 2}},  {"Int32", {'I', 4}},
    {"UInt32", {'U', 4}}, {"Int64", {'I', 8}}, {"UInt64", {'U', 8}}, {"Float32", {'F', 4}}, {"Float64", {'F', 8}}};

int base64_digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

// The bytes of an array, raw or in base64. Base64 is decoded in groups of four digits: padding may end a group within
// the array, as the header of compressed arrays is encoded by itself.
class Bytes {
public:
    Bytes(std::string_view text, bool base64) : text_(text), base64_(base64) {}

    // Returns no less than the number of bytes that are left.
    std::uint64_t most() const { return base64_ ? text_.size() / 4 * 3 + pending_.size() : text_.size(); }

    // Returns the next bytes, fewer if the text ends or is not base64.
    std::string take(std::uint64_t size) {
        std::string bytes;
        if (size > most()) return bytes;
        if (!base64_) {
            bytes = text_.substr(0, size);
            text_.remove_prefix(bytes.size());
            return bytes;
        }
        bytes.reserve(size + 3);
        bytes.swap(pending_);
        while (bytes.size() < size && decode_group(bytes)) {
        }
        pending_.clear();
        if (bytes.size() > size) {
            pending_ = bytes.substr(size);
            bytes.resize(size);
        }
        return bytes;
    }

private:
    // Appends up to three bytes. Returns false at the end of the base64 text.
    bool decode_group(std::string& bytes) {
        std::uint32_t bits = 0;
        int digits = 0, padding = 0;
        while (digits + padding < 4) {
            text_.remove_prefix(std::min(text_.find_first_not_of(" \t\r\n"), text_.size()));
            if (text_.empty()) return false;
            const int digit = base64_digit(text_[0]);
            if (digit < 0 && (text_[0] != '=' || digits < 2)) return false;
            if (digit >= 0 && padding > 0) return false;
            bits = bits << 6 | static_cast<std::uint32_t>(std::max(digit, 0));
            ++(digit < 0 ? padding : digits);
            text_.remove_prefix(1);
        }
        for (int i = 0; i < 3 - padding; ++i) bytes += static_cast<char>(bits >> (16 - 8 * i) & 0xff);
        return true;
    }

    std::string_view text_;
    bool base64_;
    std::string pending_;  // decoded bytes that are not taken yet
};

// A file in two parts: XML, and the appended data, which need not be XML.
struct Parts {
    std::string xml;
    std::optional<std::string_view> appended;  // from the underscore on, without it
    bool base64 = true;
};

Parts split(const Input& input) {
    Parts parts;
    const std::size_t tag = input.bytes.find("<AppendedData");
    if (tag == std::string_view::npos) {
        parts.xml = input.bytes;
        return parts;
    }
    const std::size_t close = std::min(input.bytes.find('>', tag), input.bytes.size());
    const std::size_t start = input.bytes.find_first_not_of(" \t\r\n", close + 1);
    const std::size_t end = input.bytes.rfind("</AppendedData");
    if (start == std::string_view::npos || input.bytes[start] != '_')
        throw InputError(input.name + ": its appended data do not begin with an underscore: the file is damaged");
    if (end == std::string_view::npos || end < start)
        throw InputError(input.name + ": is truncated: its appended data do not end");
    std::string_view head = input.bytes.substr(tag, close - tag);
    if (head.ends_with('/')) head.remove_suffix(1);
    parts.appended = input.bytes.substr(start + 1, end - start - 1);
    parts.xml = std::string(input.bytes.substr(0, tag)) + std::string(head) + "/></VTKFile>";
    return parts;
}

class VtkXmlReader {
public:
    explicit VtkXmlReader(const Input& input)
        : name_(input.name),
          parts_(split(input)),
          xml_(input.name, parts_.xml, "VTKFile", "VTK XML"),
          cells_(name_, soup_) {}

    Soup read() {
        const xml_node root = xml_.root();
        read_header(root);
        const std::string kind = xml_.text(root, "type");
        if (kind != "PolyData" && kind != "UnstructuredGrid")
            xml_.refuse(root,
                        fmt::format("holds a dataset {}: only PolyData and UnstructuredGrid are read: {}", shown(kind),
                                    kind.starts_with('P') ? "name the files of its pieces, or open it in ParaView "
                                                            "and save one .vtp or .vtu file"
                                                          : "extract its surface, in ParaView with Extract "
                                                            "Surface or Contour, and save that"));
        const auto datasets = Xml::children(root, kind);
        if (datasets.size() != 1)
            xml_.refuse(root,
                        fmt::format("has {} elements <{}> instead of one: split the file", datasets.size(), kind));
        if (Xml::children(root, "AppendedData").size() > 1) xml_.refuse(root, "has appended data twice");
        if (text_or(datasets[0], "TimeValues", "").find_first_of(" \t\n") != std::string::npos)
            refuse_time(datasets[0]);
        const auto pieces = Xml::children(datasets[0], "Piece");
        for (std::size_t i = 0; i < pieces.size(); ++i)
            read_piece(pieces[i], kind == "PolyData",
                       pieces.size() > 1 ? fmt::format("piece {} (from 0): ", i) : std::string());
        cells_.end();
        soup_.objects = std::max<std::int64_t>(static_cast<std::int64_t>(pieces.size()), 1);
        return std::move(soup_);
    }

private:
    static std::string text_or(xml_node node, const char* attribute, const char* otherwise) {
        return node.attribute(attribute).as_string(otherwise);
    }

    // Refuses everything that changes the meaning of the arrays.
    void read_header(xml_node root) {
        const std::string version = text_or(root, "version", "0.1");
        const auto major = whole<unsigned>(std::string_view(version).substr(0, version.find('.')));
        if (!major || *major > 2)
            xml_.refuse(root,
                        fmt::format("version '{}' is not supported, only 0.1 to 2.x: save it with an older version",
                                    shown(version)));
        const std::string order = text_or(root, "byte_order", "LittleEndian");
        if (order != "LittleEndian" && order != "BigEndian")
            xml_.refuse(root, fmt::format("byte_order '{}' is neither LittleEndian nor BigEndian", shown(order)));
        big_endian_ = order == "BigEndian";
        const std::string header = text_or(root, "header_type", "UInt32");
        if (header != "UInt32" && header != "UInt64")
            xml_.refuse(root, fmt::format("header_type '{}' is neither UInt32 nor UInt64", shown(header)));
        header_ = {'U', header == "UInt32" ? std::uint64_t{4} : std::uint64_t{8}};
        const std::string compressor = text_or(root, "compressor", "");
        if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
            xml_.refuse(root, fmt::format("is compressed by '{}', which is not supported: save it with zlib or without "
                                          "compression (in ParaView Compressor Type: ZLib)",
                                          shown(compressor)));
        compressed_ = !compressor.empty();
        if (!parts_.appended) return;
        const std::string encoding = text_or(Xml::child(root, "AppendedData"), "encoding", "base64");
        if (encoding != "raw" && encoding != "base64")
            xml_.refuse(root, fmt::format("its appended data have the unknown encoding '{}'", shown(encoding)));
        parts_.base64 = encoding == "base64";
    }

    [[noreturn]] void refuse_time(xml_node node) const {
        xml_.refuse(node, "holds several time steps: save one of them, in ParaView with Save Data");
    }

    // Returns the array with this name in an element, or a null node. Every array has a name, except the points.
    xml_node array(xml_node parent, std::string_view name) const {
        xml_node match;
        for (const xml_node candidate : Xml::children(parent, "DataArray")) {
            if (!name.empty() && candidate.attribute("Name").value() != name) continue;
            if (match && match.attribute("TimeStep")) refuse_time(candidate);
            if (match)
                xml_.refuse(candidate, fmt::format("<{}> has a second array '{}'", shown(parent.name()), shown(name)));
            match = candidate;
        }
        return match;
    }

    // Returns the number of cells in an element <Verts>, <Lines>, <Polys> or <Strips> of PolyData.
    std::uint64_t number_of(xml_node piece, const std::string& element) const {
        const std::string attribute = "NumberOf" + element;
        if (piece.attribute(attribute.c_str())) return xml_.index(piece, attribute.c_str());
        if (Xml::child(xml_.only_child(piece, element), "DataArray"))
            xml_.refuse(piece, fmt::format("<Piece> has <{}> and no attribute {}", element, attribute));
        return 0;
    }

    void read_piece(xml_node piece, bool poly_data, const std::string& place) {
        VtkPiece cells;
        cells.place = place;
        cells.first_point = soup_.points.size();
        const std::uint64_t points = xml_.index(piece, "NumberOfPoints");
        if (points > 0) read_points(piece, points);
        if (poly_data) {
            read_cells(piece, "Verts", number_of(piece, "Verts"), VtkType::poly_vertex, cells);
            read_cells(piece, "Lines", number_of(piece, "Lines"), VtkType::poly_line, cells);
            read_cells(piece, "Polys", number_of(piece, "Polys"), VtkType::polygon, cells);
            read_cells(piece, "Strips", number_of(piece, "Strips"), VtkType::triangle_strip, cells);
        } else if (const std::uint64_t count = xml_.index(piece, "NumberOfCells"); count > 0) {
            const xml_node parent = read_cells(piece, "Cells", count, VtkType::polygon, cells);
            cells.types = integers(needed(parent, "types"), count);
        }
        cells.cell_ghosts = ghosts(xml_.only_child(piece, "CellData"), cells.types.size());
        cells.point_ghosts = ghosts(xml_.only_child(piece, "PointData"), points);
        cells_.add(cells);
    }

    void read_points(xml_node piece, std::uint64_t count) {
        const xml_node node = array(xml_.only_child(piece, "Points"), "");
        if (!node) xml_.refuse(piece, "<Piece> has no <Points> with a <DataArray>");
        if (const std::string components = text_or(node, "NumberOfComponents", "3"); trimmed(components) != "3")
            xml_.refuse(node, fmt::format("the points have {} components instead of 3", shown(components)));
        if (count > parts_most())
            xml_.refuse(piece, fmt::format("NumberOfPoints=\"{}\" is too large for this file", count));
        std::size_t at = 0;
        const Stored type = each_value(node, 3 * count, [&](double value) {
            if (at % 3 == 0) soup_.points.emplace_back();
            soup_.points.back()[static_cast<Eigen::Index>(at++ % 3)] = value;
        });
        soup_.float32 = soup_.float32 || type.is_float32();
    }

    // Returns no less than the number of values that any array of this file can have. zlib compresses up to 1032 times.
    std::uint64_t parts_most() const {
        return 1100 * (parts_.xml.size() + parts_.appended.value_or(std::string_view()).size());
    }

    xml_node needed(xml_node parent, std::string_view name) const {
        const xml_node data_array = array(parent, name);
        if (!data_array)
            xml_.refuse(parent, fmt::format("<{}> has no <DataArray Name=\"{}\">", shown(parent.name()), name));
        return data_array;
    }

    // Adds the cells of an element <Verts>, ..., and returns it.
    xml_node read_cells(xml_node piece, const char* element, std::uint64_t count, VtkType type, VtkPiece& cells) {
        const xml_node parent = xml_.only_child(piece, element);
        if (count == 0) return parent;
        if (!parent) xml_.refuse(piece, fmt::format("<Piece> has {} cells and no <{}>", count, element));
        const std::vector<std::int64_t> ends = integers(needed(parent, "offsets"), count);
        if (ends.back() < 0 || static_cast<std::uint64_t>(ends.back()) > parts_most())
            xml_.refuse(parent, fmt::format("the last offset is {}: the file is damaged", ends.back()));
        const xml_node corners = needed(parent, "connectivity");
        cells.append(name_, type, ends, integers(corners, static_cast<std::uint64_t>(ends.back())));
        return parent;
    }

    std::vector<std::int64_t> ghosts(xml_node data, std::uint64_t count) {
        if (!data || count == 0) return {};
        if (const xml_node node = array(data, "vtkGhostType")) return integers(node, count);
        const xml_node levels = array(data, "vtkGhostLevels");  // before VTK 7; a level above 0 marks a duplicate
        if (!levels) return {};
        std::vector<std::int64_t> values = integers(levels, count);
        for (std::int64_t& value : values) value = value > 0 ? VtkGhost::duplicate_cell : 0;
        return values;
    }

    std::vector<std::int64_t> integers(xml_node node, std::uint64_t count) {
        std::vector<std::int64_t> values;
        const Stored type = each_value(node, count, [&](double value) { values.push_back(vtk_integer(value)); });
        if (type.kind == 'F')
            xml_.refuse(node, fmt::format("the array '{}' must have integers", shown(text_or(node, "Name", ""))));
        return values;
    }

    // Calls `add` for each number of an array, which must have `count`. Returns their type.
    template <class Add> Stored each_value(xml_node node, std::uint64_t count, const Add& add) {
        const std::string type_name = xml_.text(node, "type");
        const auto type = types.find(type_name);
        if (type == types.end())
            xml_.refuse(node, fmt::format("type '{}' is not a type of numbers that is supported: save it as Float64 or "
                                          "Int64",
                                          shown(type_name)));
        if (count == 0) return type->second;
        const std::string format = text_or(node, "format", "ascii");
        const std::string inline_text = xml_.content(node);
        if (format == "ascii") {
            each_word(node, inline_text, type->second, count, add);
            return type->second;
        }
        if (format != "binary" && format != "appended")
            xml_.refuse(node, fmt::format("format '{}' is not ascii, binary or appended", shown(format)));
        const std::string bytes = format == "binary"
                                      ? unpacked(node, Bytes(inline_text, true), count, type->second.size)
                                      : unpacked(node, appended(node), count, type->second.size);
        for (std::size_t at = 0; at < bytes.size(); at += type->second.size)
            add(value(std::string_view(bytes).substr(at), type->second));
        return type->second;
    }

    template <class Add>
    void each_word(xml_node node, std::string_view text, Stored type, std::uint64_t count, const Add& add) const {
        constexpr std::string_view spaces = " \t\r\n\v\f";
        std::uint64_t words = 0;
        for (std::size_t at = text.find_first_not_of(spaces); at != std::string_view::npos; ++words) {
            const std::size_t end = std::min(text.find_first_of(spaces, at), text.size());
            const auto value = vtk_number(text.substr(at, end - at), type);
            if (!value)
                xml_.refuse(node, fmt::format("'{}' is not a number of the type {}", shown(text.substr(at, end - at)),
                                              text_or(node, "type", "")));
            if (words < count) add(*value);
            at = text.find_first_not_of(spaces, end);
        }
        if (words != count)
            xml_.refuse(node, fmt::format("the array '{}' has {} numbers instead of {}",
                                          shown(text_or(node, "Name", "")), words, count));
    }

    Bytes appended(xml_node node) const {
        const std::size_t offset = xml_.index(node, "offset");
        if (!parts_.appended) xml_.refuse(node, "format=\"appended\", but the file has no <AppendedData>");
        if (offset >= parts_.appended->size())
            xml_.refuse(node, fmt::format("offset {} is beyond the {} bytes of appended data", offset,
                                          parts_.appended->size()));
        return {parts_.appended->substr(offset), parts_.base64};
    }

    // Returns a number in the byte order of the file.
    double value(std::string_view bytes, Stored type) const {
        std::array<char, 8> copy{};
        std::copy_n(bytes.begin(), type.size, copy.begin());
        if (big_endian_) std::reverse(copy.begin(), copy.begin() + static_cast<std::ptrdiff_t>(type.size));
        return type.value(copy.data());
    }

    std::uint64_t header_value(xml_node node, Bytes& bytes) const {
        const std::string word = bytes.take(header_.size);
        if (word.size() < header_.size) refuse_bytes(node);
        return static_cast<std::uint64_t>(std::min(value(word, header_), 0x1p62));
    }

    [[noreturn]] void refuse_bytes(xml_node node) const {
        xml_.refuse(
            node, fmt::format("the data of the array '{}' are truncated or damaged", shown(text_or(node, "Name", ""))));
    }

    // Counts bytes that an array takes. Many arrays at one offset could need memory that is not proportional to the file.
    void spend(xml_node node, std::uint64_t bytes) {
        const std::uint64_t most = 8 * (parts_.xml.size() + parts_.appended.value_or(std::string_view()).size());
        if (bytes > most - spent_) xml_.refuse(node, "the arrays of the file overlap: it is damaged");
        spent_ += bytes;
    }

    // Returns the bytes of an array, which has `count` numbers of `size` bytes.
    std::string unpacked(xml_node node, Bytes bytes, std::uint64_t count, std::uint64_t size) {
        const auto check = [&](std::uint64_t length) {
            if (length % size != 0 || length / size != count)
                xml_.refuse(node, fmt::format("the array '{}' has {} bytes instead of {} x {}",
                                              shown(text_or(node, "Name", "")), length, count, size));
        };
        if (!compressed_) {
            const std::uint64_t total = header_value(node, bytes);
            check(total);
            spend(node, total);
            std::string all = bytes.take(total);
            if (all.size() < total) refuse_bytes(node);
            return all;
        }
        const std::uint64_t blocks = header_value(node, bytes), block = header_value(node, bytes),
                            last = header_value(node, bytes);
        if (blocks == 0 || blocks > bytes.most() / header_.size || block > (std::uint64_t{1} << 62) / blocks ||
            last > block)
            refuse_bytes(node);
        check((blocks - 1) * block + (last == 0 ? block : last));
        std::vector<std::uint64_t> packed;
        for (std::uint64_t i = 0; i < blocks; ++i) {
            packed.push_back(header_value(node, bytes));
            spend(node, packed.back());
        }
        std::string all;
        for (std::uint64_t i = 0; i < blocks; ++i)
            append_block(node, bytes.take(packed[i]), packed[i], i + 1 < blocks || last == 0 ? block : last, all);
        return all;
    }

    void append_block(xml_node node, const std::string& packed, std::uint64_t expected, std::uint64_t size,
                      std::string& all) const {
        if (packed.size() < expected || size / 1032 > packed.size()) refuse_bytes(node);
        const std::size_t before = all.size();
        all.resize(before + size);
        uLongf length = size;
        const int result = uncompress(reinterpret_cast<Bytef*>(all.data() + before), &length,
                                      reinterpret_cast<const Bytef*>(packed.data()), packed.size());
        if (result != Z_OK || length != size) refuse_bytes(node);
    }

    const std::string& name_;
    Parts parts_;
    Xml xml_;
    bool big_endian_ = false, compressed_ = false;
    Stored header_ = {'U', 4};
    std::uint64_t spent_ = 0;  // bytes of the file that arrays took
    Soup soup_;
    VtkCells cells_;
};

}  // namespace

Soup read_vtk_xml(const Input& input) { return VtkXmlReader(input).read(); }

}  // namespace hausbench::readers
