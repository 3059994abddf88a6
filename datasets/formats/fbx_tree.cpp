// Parses FBX into a tree. The format has no public specification; its structure is described by the Blender developers
// ("FBX binary file format specification", 2013) and by the sources of ufbx.
//
// Binary: a header of 27 bytes with the version; then records: end offset, number of values, size of the values (each
// 32 bits below version 7500, 64 bits from then on), name, values, nested records and a record of zeros. Text: `Name:
// value, value {` nodes `}`, arrays `*count { a: number, ... }`, comments from ';' to the end of the line.
#include "datasets/formats/fbx_tree.h"

#include "algorithms/error.h"
#include "datasets/formats/parse.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <type_traits>
#include <utility>

namespace hausbench::readers {
namespace {

constexpr int deepest = 64;  // levels of nodes; programs write about ten
constexpr std::string_view binary_start("Kaydara FBX Binary  \0\x1a\0", 23);
constexpr std::string_view damaged = "it is truncated or damaged, save or fetch it again";

// Arrays may inflate to `inflation` times the size of the file, and to `inflated_anyway` bytes in any case. No deflated
// bytes inflate to more than `most_by_deflate` times their number.
constexpr std::uint64_t inflation = 200, inflated_anyway = std::uint64_t{1} << 24, most_by_deflate = 1032;

// Returns the size of a number of a binary file, by its type code; 0 for other types.
std::size_t size_of(char type) {
    const auto is_one_of = [&](std::string_view types) { return types.find(type) != std::string_view::npos; };
    return is_one_of("CBZbc") ? 1 : is_one_of("Y") ? 2 : is_one_of("IFif") ? 4 : is_one_of("DLdl") ? 8 : 0;
}

// Returns how a number of a binary file is stored.
Stored stored(char type) {
    const bool real = std::string_view("FDfd").find(type) != std::string_view::npos;
    return {real ? 'F' : 'I', size_of(type)};
}

// Reads the records of a binary file.
class BinaryParser {
public:
    BinaryParser(const std::string& name, std::string_view bytes, std::uint64_t version)
        : name_(name), bytes_(bytes), wide_(version >= 7500) {}

    std::vector<FbxNode> parse() {
        at_ = binary_start.size() + 4;
        std::vector<FbxNode> nodes;
        while (auto node = record(bytes_.size(), 0)) nodes.push_back(std::move(*node));
        return nodes;
    }

private:
    [[noreturn]] void refuse(const std::string& why) const {
        throw InputError(fmt::format("{}: at byte {}: {}: {}", name_, at_, why, damaged));
    }

    // Returns the next bytes, which must end at `end` at the latest.
    std::string_view take(std::uint64_t size, std::uint64_t end) {
        if (size > end - at_) refuse("a node ends too early");
        const std::string_view taken = bytes_.substr(at_, size);
        at_ += size;
        return taken;
    }
    std::uint64_t integer(std::uint64_t size, std::uint64_t end) {
        std::uint64_t value = 0, shift = 0;
        for (const char c : take(size, end)) {
            value |= std::uint64_t{static_cast<unsigned char>(c)} << shift;
            shift += 8;
        }
        return value;
    }

    // Returns the next record before `outer_end`, or nothing for the record of zeros that ends a list.
    std::optional<FbxNode> record(std::uint64_t outer_end, int depth) {
        if (depth > deepest) refuse(fmt::format("nodes are nested deeper than {}", deepest));
        FbxNode node;
        node.place = at_;
        const std::uint64_t width = wide_ ? 8 : 4;
        const std::uint64_t end = integer(width, outer_end), values = integer(width, outer_end),
                            size = integer(width, outer_end), name_size = integer(1, outer_end);
        if (end == 0 && values == 0 && size == 0 && name_size == 0) return std::nullopt;
        if (end < at_ || end > outer_end) refuse("a node ends beyond the one that holds it, or beyond the file");
        node.name = take(name_size, end);
        if (size > end - at_ || values > size) refuse("the values of a node are larger than the node");
        const std::uint64_t values_end = at_ + size;
        node.values.reserve(values);
        for (std::uint64_t i = 0; i < values; ++i) node.values.push_back(value(values_end));
        if (at_ != values_end) refuse("the values of a node have another size than it says");
        if (at_ == end) return node;
        while (auto child = record(end, depth + 1)) node.children.push_back(std::move(*child));
        if (at_ != end) refuse("a node does not end where it says");
        return node;
    }

    FbxValue value(std::uint64_t end) {
        FbxValue value;
        value.type = take(1, end)[0];
        const std::uint64_t size = size_of(value.type);
        if (value.type == 'S' || value.type == 'R') {
            value.bytes = take(integer(4, end), end);
        } else if (size == 0) {
            refuse(fmt::format("a value has the unknown type '{}'", shown(std::string_view(&value.type, 1))));
        } else if (value.is_array()) {
            value.count = static_cast<std::uint32_t>(integer(4, end));
            const std::uint64_t encoding = integer(4, end), length = integer(4, end);
            if (encoding > 1) refuse(fmt::format("an array has the unknown encoding {}", encoding));
            value.deflated = encoding == 1;
            if (value.deflated ? value.count * size > length * most_by_deflate : value.count * size != length)
                refuse(fmt::format("an array of {} elements has {} bytes", value.count, length));
            value.bytes = take(length, end);
        } else {
            value.bytes = take(size, end);
        }
        return value;
    }

    const std::string& name_;
    std::string_view bytes_;
    bool wide_;
    std::uint64_t at_ = 0;
};

// Reads the nodes of a text file.
class TextParser {
public:
    TextParser(const std::string& name, std::string_view bytes) : name_(name), bytes_(bytes) {}

    std::vector<FbxNode> parse() {
        std::vector<FbxNode> nodes = list(0);
        if (at_ < bytes_.size()) refuse("'}' closes nothing");
        return nodes;
    }

private:
    [[noreturn]] void refuse(const std::string& why) const {
        readers::refuse(name_, static_cast<std::uint32_t>(line_), fmt::format("{}: {}", why, damaged));
    }

    char next() const { return at_ < bytes_.size() ? bytes_[at_] : '\0'; }

    // Moves beyond blanks, line ends and comments.
    void skip() {
        for (; at_ < bytes_.size(); ++at_) {
            if (bytes_[at_] == ';') at_ = std::min(bytes_.find_first_of("\r\n", at_), bytes_.size());
            if (at_ == bytes_.size()) return;
            const char c = bytes_[at_];
            if (c != '\n' && blanks.find(c) == std::string_view::npos) return;
            count_line(c);
        }
    }
    void count_line(char c) { line_ += c == '\n' || (c == '\r' && bytes_.substr(at_ + 1, 1) != "\n") ? 1 : 0; }

    // Returns the text up to the next of `ends`, and moves to it.
    std::string_view up_to(std::string_view ends) {
        const std::size_t start = at_;
        for (; at_ < bytes_.size() && ends.find(bytes_[at_]) == std::string_view::npos; ++at_) count_line(bytes_[at_]);
        return bytes_.substr(start, at_ - start);
    }
    std::string_view word() { return up_to(" \t\r\n\v\f,:;{}\"*"); }

    // Reads nodes up to the end of the file or the '}' of the node around them.
    std::vector<FbxNode> list(int depth) {
        if (depth > deepest) refuse(fmt::format("nodes are nested deeper than {}", deepest));
        std::vector<FbxNode> nodes;
        for (skip(); at_ < bytes_.size() && next() != '}'; skip()) {
            FbxNode node;
            node.place = line_;
            node.name = word();
            skip();
            if (node.name.empty() || next() != ':') refuse("expected the name of a node and ':'");
            ++at_;
            read_values(node);
            if (next() == '{') {
                ++at_;
                node.children = list(depth + 1);
                close();
            }
            nodes.push_back(std::move(node));
        }
        return nodes;
    }
    void close() {
        if (next() != '}') refuse("the file ends before a '}'");
        ++at_;
    }

    // Reads the values of a node, up to '{', '}', the end of the file or the name of the next node.
    void read_values(FbxNode& node) {
        for (bool comma = true;;) {
            skip();
            const char c = next();
            if (c == ',') {
                ++at_;
                comma = true;
                continue;
            }
            if (c == '\0' || c == '{' || c == '}') return;
            if (c == '"') {
                node.values.push_back({'S', quoted()});
            } else if (c == '*') {
                node.values.push_back(array());
            } else {
                const std::size_t start = at_, line = line_;
                const FbxValue value{'N', word()};
                skip();
                if (next() == ':') {
                    at_ = start;
                    line_ = line;
                    return;
                }
                if (value.bytes.empty() || !comma) refuse("expected ',' between the values of a node");
                node.values.push_back(value);
            }
            comma = false;
        }
    }

    std::string_view quoted() {
        ++at_;
        const std::string_view text = up_to("\"");
        if (next() != '"') refuse("the file ends within a text in quotes");
        ++at_;
        return text;
    }

    // Reads "*3 { a: 1,2,3 }".
    FbxValue array() {
        ++at_;
        FbxValue value{'A', {}};
        const auto count = whole<std::uint32_t>(word());
        skip();
        if (!count || next() != '{') refuse("expected the number of elements of an array and '{'");
        ++at_;
        skip();
        value.count = *count;
        if (next() != '}') {
            if (word() != "a" || next() != ':') refuse("expected 'a:' in an array");
            ++at_;
            value.bytes = up_to("{}\";:");
        }
        close();
        return value;
    }

    const std::string& name_;
    std::string_view bytes_;
    std::size_t at_ = 0, line_ = 1;
};

// Returns a number of a text file. `Number` is double or std::int64_t.
template <class Number> std::optional<Number> number(std::string_view word) {
    if constexpr (std::is_same_v<Number, double>)
        return decimal(word);
    else
        return whole<Number>(word);
}

}  // namespace

std::string_view FbxNode::text(std::size_t i) const {
    return i < values.size() && values[i].type == 'S' ? values[i].bytes : std::string_view();
}

FbxTree::FbxTree(const std::string& name, std::string_view bytes)
    : name_(name),
      binary_(bytes.starts_with(binary_start)),
      budget_(std::max(inflated_anyway, inflation * bytes.size())) {
    if (binary_) {
        if (bytes.size() < binary_start.size() + 4) throw InputError(fmt::format("{}: {}", name, damaged));
        const auto version = static_cast<std::int64_t>(Stored{'U', 4}.value(bytes.data() + binary_start.size()));
        check_version(version);
        root_.children = BinaryParser(name, bytes, static_cast<std::uint64_t>(version)).parse();
        return;
    }
    std::string_view start = bytes.substr(0, 1000);
    start.remove_prefix(std::min(start.find_first_not_of(" \t\r\n"), start.size()));
    if (start.empty() || start.find("FBX") == std::string_view::npos || (start[0] != ';' && !start.starts_with("FBX")))
        throw InputError(name + ": does not begin like a binary or a text FBX file: save or fetch it again");
    root_.children = TextParser(name, bytes).parse();
    const FbxNode* const header = child(root_, "FBXHeaderExtension");
    const FbxNode* const version = header ? child(*header, "FBXVersion") : nullptr;
    if (!version) throw InputError(name + ": has no FBXVersion in an FBXHeaderExtension: save or fetch it again");
    check_version(integer(*version, 0));
}

void FbxTree::check_version(std::int64_t version) const {
    if (version < 7000 || version > 7700)
        throw InputError(
            fmt::format("{}: is version {} of FBX, and only 7000 to 7700 are supported: export it as FBX 2011 "
                        "or later (7.x), glTF or OBJ",
                        name_, version));
}

void FbxTree::refuse(const FbxNode& node, const std::string& why) const {
    throw InputError(fmt::format("{}: {} {}: {}", name_, binary_ ? "at byte" : "line", node.place, why));
}

const FbxNode* FbxTree::child(const FbxNode& node, std::string_view name) const {
    const FbxNode* match = nullptr;
    for (const FbxNode& candidate : node.children) {
        if (candidate.name != name) continue;
        if (match) refuse(candidate, fmt::format("{} stands twice in {}: save the file again", name, shown(node.name)));
        match = &candidate;
    }
    return match;
}

double FbxTree::real(const FbxNode& node, std::size_t i) const {
    if (i < node.values.size()) {
        const FbxValue& value = node.values[i];
        if (value.type == 'N')
            if (const auto parsed = decimal(value.bytes)) return *parsed;
        if (binary_ && !value.is_array() && size_of(value.type) > 0)
            return stored(value.type).value(value.bytes.data());
    }
    refuse(node, fmt::format("value {} of {} is not a number: {}", i + 1, shown(node.name), damaged));
}

std::int64_t FbxTree::integer(const FbxNode& node, std::size_t i) const {
    if (i < node.values.size()) {
        const FbxValue& value = node.values[i];
        if (value.type == 'N')
            if (const auto parsed = whole<std::int64_t>(value.bytes)) return *parsed;
        if (value.type == 'L') {
            std::int64_t wide = 0;
            std::memcpy(&wide, value.bytes.data(), sizeof wide);
            return wide;
        }
        if (binary_ && std::string_view("CBZYI").find(value.type) != std::string_view::npos)
            return static_cast<std::int64_t>(stored(value.type).value(value.bytes.data()));
    }
    refuse(node, fmt::format("value {} of {} is not an integer: {}", i + 1, shown(node.name), damaged));
}

const FbxValue& FbxTree::array(const FbxNode& node, std::string_view types) const {
    if (node.values.size() != 1 || (node.values[0].type != 'A' && types.find(node.values[0].type) == types.npos))
        refuse(node, fmt::format("{} is not an array of {}: save the file again", shown(node.name),
                                 types == "df" ? "float32 or float64 numbers" : "integers of 32 or 64 bits"));
    return node.values[0];
}

bool FbxTree::is_float32(const FbxNode& node) const { return !node.values.empty() && node.values[0].type == 'f'; }

std::string FbxTree::inflated(const FbxNode& node, const FbxValue& value) const {
    const std::uint64_t size = value.count * size_of(value.type);
    if (size == 0) return "";
    if (size > budget_)
        refuse(node, fmt::format("its arrays inflate to more than {} times its size, as no mesh does: save it without "
                                 "compression, or as OBJ, if it is sound",
                                 inflation));
    budget_ -= size;
    std::string bytes(size, '\0');
    uLongf length = size;
    uLong packed = value.bytes.size();
    const int code = uncompress2(reinterpret_cast<Bytef*>(bytes.data()), &length,
                                 reinterpret_cast<const Bytef*>(value.bytes.data()), &packed);
    if (code != Z_OK || length != size || packed != value.bytes.size())
        refuse(node,
               fmt::format("the array of {} cannot be inflated to {} bytes: {}", shown(node.name), size, damaged));
    return bytes;
}

// Returns the elements of an array. `parse` turns the bytes of a binary number into it.
template <class Number, class Parse>
std::vector<Number> FbxTree::elements(const FbxNode& node, std::string_view types, const Parse& parse) const {
    const FbxValue& value = array(node, types);
    std::vector<Number> all;
    const auto check_count = [&](bool right) {
        if (!right)
            refuse(node, fmt::format("{} does not have the {} elements that it says: {}", shown(node.name), value.count,
                                     damaged));
    };
    if (value.type != 'A') {
        const std::string unpacked = value.deflated ? inflated(node, value) : "";
        const std::string_view bytes = value.deflated ? std::string_view(unpacked) : value.bytes;
        const std::size_t size = size_of(value.type);
        all.reserve(value.count);
        for (std::size_t at = 0; at < bytes.size(); at += size) all.push_back(parse(value.type, bytes.data() + at));
        return all;
    }
    check_count(value.count <= value.bytes.size());
    all.reserve(value.count);
    for (std::string_view rest = value.bytes;;) {
        const std::size_t end = std::min(rest.find(','), rest.size());
        const std::size_t first = rest.find_first_not_of(" \t\r\n");
        if (end == rest.size() && first >= rest.size()) break;  // nothing after the last ','
        const std::string_view piece = rest.substr(0, end);
        const std::string_view word =
            piece.substr(std::min(first, end), piece.find_last_not_of(" \t\r\n") + 1 - std::min(first, end));
        const auto parsed = number<Number>(word);
        if (!parsed)
            refuse(node, fmt::format("'{}' in {} is not a number: {}", shown(word), shown(node.name), damaged));
        all.push_back(*parsed);
        check_count(all.size() <= value.count);
        if (end == rest.size()) break;
        rest.remove_prefix(end + 1);
    }
    check_count(all.size() == value.count);
    return all;
}

std::vector<double> FbxTree::reals(const FbxNode& node) const {
    return elements<double>(node, "df", [](char type, const char* at) { return stored(type).value(at); });
}

std::vector<std::int64_t> FbxTree::integers(const FbxNode& node) const {
    return elements<std::int64_t>(node, "il", [](char type, const char* at) {
        std::int32_t narrow = 0;
        std::int64_t wide = 0;
        std::memcpy(&narrow, at, sizeof narrow);
        if (type == 'l') std::memcpy(&wide, at, sizeof wide);
        return type == 'l' ? wide : std::int64_t{narrow};
    });
}

}  // namespace hausbench::readers
