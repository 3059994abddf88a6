#include "datasets/formats/zip_file.h"

#include "algorithms/error.h"
#include "datasets/formats/parse.h"

#include <fmt/format.h>
#include <minizip/unzip.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace hausbench::readers {
namespace {

// The entries that are read may inflate to `inflation` times the size of the archive, and to `inflated_anyway` bytes in
// any case. XML shrinks to a tenth or less; only text that repeats itself shrinks to a thousandth.
constexpr std::uint64_t inflation = 200, inflated_anyway = std::uint64_t{1} << 24;

// The archive, as the file that minizip reads.
struct Memory {
    std::string_view bytes;
    std::uint64_t at = 0;
};

voidpf open_memory(voidpf memory, const void*, int) { return memory; }

uLong read_memory(voidpf, voidpf stream, void* to, uLong size) {
    auto& memory = *static_cast<Memory*>(stream);
    const std::uint64_t count = std::min<std::uint64_t>(size, memory.bytes.size() - memory.at);
    if (count > 0) std::memcpy(to, memory.bytes.data() + memory.at, count);
    memory.at += count;
    return static_cast<uLong>(count);
}

uLong write_memory(voidpf, voidpf, const void*, uLong) { return 0; }

ZPOS64_T tell_memory(voidpf, voidpf stream) { return static_cast<Memory*>(stream)->at; }

long seek_memory(voidpf, voidpf stream, ZPOS64_T offset, int origin) {
    auto& memory = *static_cast<Memory*>(stream);
    const std::uint64_t size = memory.bytes.size();
    const std::uint64_t from = origin == ZLIB_FILEFUNC_SEEK_SET   ? 0
                               : origin == ZLIB_FILEFUNC_SEEK_CUR ? memory.at
                                                                  : size;
    if (offset > size - from) return -1;
    memory.at = from + offset;
    return 0;
}

int close_memory(voidpf, voidpf) { return 0; }

// An archive that minizip has open.
class Unzip {
public:
    explicit Unzip(std::string_view bytes) : memory_{bytes} {
        zlib_filefunc64_def functions{open_memory, read_memory,  write_memory, tell_memory,
                                      seek_memory, close_memory, close_memory, &memory_};
        file_ = unzOpen2_64("", &functions);
    }
    Unzip(const Unzip&) = delete;
    Unzip& operator=(const Unzip&) = delete;
    ~Unzip() {
        if (file_) unzClose(file_);
    }
    unzFile get() const { return file_; }

private:
    Memory memory_;
    unzFile file_;
};

std::optional<char> decoded(std::string_view text) {
    if (text.size() < 3 || text[0] != '%') return std::nullopt;
    unsigned value = 0;
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + 3, value, 16);
    if (error != std::errc() || end != text.data() + 3) return std::nullopt;
    return static_cast<char>(value);
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
        const std::string step = plain.substr(at, end - at);
        if (step == "..") return "";
        if (!step.empty() && step != ".") normal += (normal.empty() ? "" : "/") + step;
        at = end + 1;
    }
    return lower_case(normal);
}

ZipFile::ZipFile(const std::string& name, std::string_view bytes)
    : name_(name), bytes_(bytes), budget_(std::max(inflated_anyway, inflation * bytes.size())) {
    const Unzip zip(bytes);
    if (!bytes.starts_with("PK") || !zip.get())
        throw InputError(name + ": is not a sound ZIP archive: it is truncated or damaged, save or fetch it again");
    for (int code = unzGoToFirstFile(zip.get()); code != UNZ_END_OF_LIST_OF_FILE; code = unzGoToNextFile(zip.get())) {
        unz_file_info64 info{};
        if (code == UNZ_OK) code = unzGetCurrentFileInfo64(zip.get(), &info, nullptr, 0, nullptr, 0, nullptr, 0);
        std::vector<char> text(info.size_filename + 1, '\0');
        if (code == UNZ_OK)
            code = unzGetCurrentFileInfo64(zip.get(), &info, text.data(), text.size(), nullptr, 0, nullptr, 0);
        unz64_file_pos place{};
        if (code == UNZ_OK) code = unzGetFilePos64(zip.get(), &place);
        if (code != UNZ_OK)
            throw InputError(name + ": the directory of its ZIP archive is damaged: save or fetch it again");
        const std::string entry(text.data(), info.size_filename), normal = normal_part_name(entry);
        const auto no = [&](const char* why) {
            throw InputError(fmt::format("{}: its entry '{}' {}", name, shown(entry), why));
        };
        if (normal.empty()) no("does not lie in the archive: make the archive anew");
        if (info.flag & 1U) no("is encrypted: save the file without a password");
        if (entry.ends_with('/') || entry.ends_with('\\')) continue;
        if (!names_.emplace(normal, entry).second) no("is there twice, in upper or lower case: remove one of the two");
        places_[normal] = {place.pos_in_zip_directory, place.num_of_file};
    }
}

std::string ZipFile::read(std::string_view path) {
    const auto no = [&](const std::string& why) {
        throw InputError(fmt::format("{}: its entry '{}' {}", name_, shown(path), why));
    };
    const auto found = places_.find(normal_part_name(path));
    if (found == places_.end()) no("is not in the archive: save or fetch the file again");
    const Unzip zip(bytes_);
    unz64_file_pos place{found->second.in_directory, found->second.number};
    unz_file_info64 info{};
    if (!zip.get() || unzGoToFilePos64(zip.get(), &place) != UNZ_OK ||
        unzGetCurrentFileInfo64(zip.get(), &info, nullptr, 0, nullptr, 0, nullptr, 0) != UNZ_OK)
        no("is damaged: save or fetch the file again");
    if (info.compression_method != 0 && info.compression_method != Z_DEFLATED)
        no(fmt::format("is compressed by method {}, which is not supported: make the archive anew with 'deflate'",
                       info.compression_method));
    if (info.uncompressed_size > budget_)
        no(
            fmt::format("inflates to more than {} times the size of the archive, as no mesh does: unpack it and save "
                        "the mesh in another format if it is sound",
                        inflation));
    budget_ -= info.uncompressed_size;
    std::string bytes(info.uncompressed_size, '\0');
    std::uint64_t size = 0;
    if (unzOpenCurrentFile(zip.get()) != UNZ_OK) no("is damaged: save or fetch the file again");
    int count = 1;
    while (count > 0 && size < bytes.size()) {
        const std::uint64_t most = std::min<std::uint64_t>(bytes.size() - size, std::uint64_t{1} << 20);
        count = unzReadCurrentFile(zip.get(), bytes.data() + size, static_cast<unsigned>(most));
        size += count > 0 ? static_cast<std::uint64_t>(count) : 0;
    }
    if (unzCloseCurrentFile(zip.get()) != UNZ_OK || count < 0 || size != bytes.size())
        no("is damaged, its checksum or size is wrong: save or fetch the file again");
    return bytes;
}

}  // namespace hausbench::readers
