#include "datasets/formats/zip_file.h"

#include "algorithms/error.h"
#include "datasets/formats/parse.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <vector>

namespace hausbench::readers {
namespace {

// The entries that are read may inflate to `inflation` times the size of the archive, and to `inflated_anyway` bytes in
// any case. XML shrinks to a tenth or less; only text that repeats itself shrinks to a thousandth.
constexpr std::uint64_t inflation = 200, inflated_anyway = std::uint64_t{1} << 24;

// No deflated bytes inflate to more than this many times their number.
constexpr std::uint64_t most_by_deflate = 1032;

constexpr std::uint64_t in_zip64 = 0xffffffff;  // a size or place that stands in the ZIP64 field instead

std::optional<char> decoded(std::string_view text) {
    if (text.size() < 3 || text[0] != '%') return std::nullopt;
    unsigned value = 0;
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + 3, value, 16);
    if (error != std::errc() || end != text.data() + 3) return std::nullopt;
    return static_cast<char>(value);
}

// Returns the little-endian integer of `size` bytes at a place. Requires that they exist.
std::uint64_t integer(std::string_view bytes, std::uint64_t at, int size) {
    std::uint64_t value = 0;
    for (int k = size - 1; k >= 0; --k)
        value = value << 8U | static_cast<unsigned char>(bytes[at + static_cast<std::uint64_t>(k)]);
    return value;
}

// Returns whether a record of `size` bytes that begins with `mark` lies at a place.
bool record_at(std::string_view bytes, std::uint64_t at, std::uint64_t size, std::string_view mark) {
    return at <= bytes.size() && size <= bytes.size() - at && bytes.substr(at).starts_with(mark);
}

struct Directory {
    std::uint64_t at = 0, size = 0, count = 0;
};

// Finds the directory through the records at the end of the archive.
std::optional<Directory> find_directory(std::string_view bytes) {
    constexpr std::uint64_t end_size = 22, longest_comment = 0xffff, locator_size = 20, zip64_size = 56;
    if (bytes.size() < end_size) return std::nullopt;
    std::uint64_t end = bytes.size() - end_size;
    const std::uint64_t first = end - std::min(end, longest_comment);
    while (!record_at(bytes, end, end_size, "PK\x05\x06") ||
           integer(bytes, end + 20, 2) != bytes.size() - end - end_size) {
        if (end == first) return std::nullopt;
        --end;
    }
    Directory directory{integer(bytes, end + 16, 4), integer(bytes, end + 12, 4), integer(bytes, end + 10, 2)};
    if (directory.at == in_zip64 || directory.size == in_zip64 || directory.count == 0xffff) {
        if (end < locator_size || !record_at(bytes, end - locator_size, locator_size, "PK\x06\x07"))
            return std::nullopt;
        const std::uint64_t zip64 = integer(bytes, end - locator_size + 8, 8);
        if (!record_at(bytes, zip64, zip64_size, "PK\x06\x06")) return std::nullopt;
        directory = {integer(bytes, zip64 + 48, 8), integer(bytes, zip64 + 40, 8), integer(bytes, zip64 + 32, 8)};
    }
    if (directory.at > end || directory.size > end - directory.at) return std::nullopt;
    return directory;
}

// Replaces the values that stand in the ZIP64 field among the extra fields of an entry, in this order.
bool take_zip64(std::string_view extra, const std::vector<std::uint64_t*>& values) {
    std::vector<std::uint64_t*> missing;
    for (std::uint64_t* value : values)
        if (*value == in_zip64) missing.push_back(value);
    while (!missing.empty()) {
        if (extra.size() < 4) return false;
        const std::uint64_t id = integer(extra, 0, 2), size = integer(extra, 2, 2);
        extra.remove_prefix(4);
        if (size > extra.size()) return false;
        if (id != 1) {
            extra.remove_prefix(size);
            continue;
        }
        if (size < 8 * missing.size()) return false;
        for (std::size_t k = 0; k < missing.size(); ++k) *missing[k] = integer(extra, 8 * k, 8);
        return true;
    }
    return true;
}

// Inflates `packed` into exactly the bytes of a string. Returns whether it did.
bool inflate_all(std::string_view packed, std::string& bytes) {
    z_stream stream{};
    if (inflateInit2(&stream, -15) != Z_OK) return false;
    constexpr std::uint64_t step = std::uint64_t{1} << 30;
    std::uint64_t taken = 0, made = 0;
    char spare = 0;  // zlib needs a place to write to, even at the end
    int code = Z_OK;
    while (code == Z_OK) {
        const std::uint64_t in = std::min(step, packed.size() - taken), out = std::min(step, bytes.size() - made);
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + taken));
        stream.avail_in = static_cast<uInt>(in);
        stream.next_out = reinterpret_cast<Bytef*>(out > 0 ? bytes.data() + made : &spare);
        stream.avail_out = static_cast<uInt>(out > 0 ? out : 1);
        code = inflate(&stream, Z_NO_FLUSH);
        taken += in - stream.avail_in;
        made += (out > 0 ? out : 1) - stream.avail_out;
        if (made > bytes.size()) code = Z_DATA_ERROR;
    }
    inflateEnd(&stream);
    return code == Z_STREAM_END && made == bytes.size() && taken == packed.size();
}

}  // namespace

std::string normal_part_name(std::string_view path) {
    std::string plain;
    for (std::size_t i = 0; i < path.size(); ++i) {
        const auto character = decoded(path.substr(i));
        plain += character.value_or(path[i] == '\\' ? '/' : path[i]);
        i += character ? 2 : 0;
    }
    if (plain.find('\0') != std::string::npos) return "";
    std::string normal;
    for (std::size_t at = 0; at <= plain.size();) {
        const std::size_t end = std::min(plain.find('/', at), plain.size());
        const std::string_view step = std::string_view(plain).substr(at, end - at);
        if (step == "..") return "";
        if (!step.empty() && step != ".") {
            if (!normal.empty()) normal += '/';
            normal += step;
        }
        at = end + 1;
    }
    return lower_case(normal);
}

ZipFile::ZipFile(const std::string& name, std::string_view bytes)
    : name_(name), bytes_(bytes), budget_(std::max<std::uint64_t>(inflated_anyway, inflation * bytes.size())) {
    const auto directory = find_directory(bytes);
    if (!bytes.starts_with("PK") || !directory)
        throw InputError(name + ": is not a sound ZIP archive: it is truncated or damaged, save or fetch it again");
    read_directory(directory->at, directory->at + directory->size, directory->count);
}

void ZipFile::read_directory(std::uint64_t at, std::uint64_t end, std::uint64_t count) {
    constexpr std::uint64_t record_size = 46;
    const auto check = [&](bool sound) {
        if (!sound) throw InputError(name_ + ": the directory of its ZIP archive is damaged: save or fetch it again");
    };
    for (; count > 0; --count) {
        check(at + record_size <= end && record_at(bytes_, at, record_size, "PK\x01\x02"));
        const std::uint64_t flags = integer(bytes_, at + 8, 2), name_size = integer(bytes_, at + 28, 2),
                            extra_size = integer(bytes_, at + 30, 2), comment_size = integer(bytes_, at + 32, 2);
        Entry entry{integer(bytes_, at + 10, 2), integer(bytes_, at + 16, 4), integer(bytes_, at + 20, 4),
                    integer(bytes_, at + 24, 4), integer(bytes_, at + 42, 4)};
        check(name_size + extra_size + comment_size <= end - at - record_size);
        const std::string name(bytes_.substr(at + record_size, name_size)), normal = normal_part_name(name);
        check(take_zip64(bytes_.substr(at + record_size + name_size, extra_size),
                         {&entry.size, &entry.packed, &entry.header}));
        at += record_size + name_size + extra_size + comment_size;
        const auto no = [&](const char* why) {
            throw InputError(fmt::format("{}: its entry '{}' {}", name_, shown(name), why));
        };
        if (normal.empty()) no("does not lie in the archive: make the archive anew");
        if (flags & 0x2041U) no("is encrypted: save the file without a password");
        if (name.ends_with('/') || name.ends_with('\\')) continue;
        if (!names_.emplace(normal, name).second)
            no("is there twice, perhaps in upper and lower case: remove one of the two");
        entries_[normal] = entry;
    }
    check(at == end);
}

std::string ZipFile::read(std::string_view path) {
    constexpr std::uint64_t record_size = 30;
    const auto no = [&](const std::string& why) {
        throw InputError(fmt::format("{}: its entry '{}' {}", name_, shown(path), why));
    };
    const auto position = entries_.find(normal_part_name(path));
    if (position == entries_.end()) no("is not in the archive: save or fetch the file again");
    const Entry& entry = position->second;
    const std::string damaged = "is damaged: save or fetch the file again";
    if (entry.method != 0 && entry.method != Z_DEFLATED)
        no(fmt::format("is compressed by method {}, which is not supported: make the archive anew with 'deflate'",
                       entry.method));
    if (entry.size > budget_)
        no(
            fmt::format("inflates to more than {} times the size of the archive, as no mesh does: unpack it and save "
                        "the mesh in another format if it is sound",
                        inflation));
    if (!record_at(bytes_, entry.header, record_size, "PK\x03\x04")) no(damaged);
    std::string_view rest = bytes_.substr(entry.header + record_size);
    const std::uint64_t name_size = integer(bytes_, entry.header + 26, 2),
                        extra_size = integer(bytes_, entry.header + 28, 2);
    if (name_size + extra_size > rest.size() || rest.substr(0, name_size) != names_.at(position->first)) no(damaged);
    rest.remove_prefix(name_size + extra_size);
    if (entry.packed > rest.size()) no(damaged);
    const std::string_view packed = rest.substr(0, entry.packed);
    if (entry.method == 0 ? entry.size != entry.packed : entry.size / most_by_deflate > entry.packed) no(damaged);
    budget_ -= entry.size;
    std::string bytes(entry.method == 0 ? 0 : entry.size, '\0');
    if (entry.method == 0)
        bytes = packed;
    else if (!inflate_all(packed, bytes))
        no(damaged);
    if (crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()) != entry.crc)
        no("is damaged, because its checksum is wrong: save or fetch the file again");
    return bytes;
}

}  // namespace hausbench::readers
