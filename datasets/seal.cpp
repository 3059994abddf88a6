#include "datasets/seal.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace hausbench::h5 {
namespace {

constexpr std::string_view seal_mark = "\nsha256 ";
constexpr std::size_t seal_length = seal_mark.size() + 64 + 1;

// Returns the number of bytes of an HDF5 file's data, the "end of file address" in its superblock, or nothing if the
// file does not begin with a superblock of version 0 to 3 with addresses of 8 bytes. See "Superblock" in the HDF5 File
// Format Specification.
std::optional<std::uint64_t> end_of_data(std::istream& in) {
    constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
    std::array<char, 64> block{};
    in.read(block.data(), block.size());
    if (!in || std::string_view(block.data(), signature.size()) != signature) return std::nullopt;
    const int version = block[8];
    if (version < 0 || version > 3 || block[version < 2 ? 13 : 9] != 8) return std::nullopt;
    const std::size_t at = version == 0 ? 40 : version == 1 ? 44 : 28;
    std::uint64_t end = 0;
    for (std::size_t i = 8; i-- > 0;) end = end << 8 | static_cast<unsigned char>(block[at + i]);
    return end;
}

[[noreturn]] void fail(const std::filesystem::path& file, const char* why) {
    throw std::runtime_error(file.string() + ": " + why);
}

}  // namespace

std::string seal_of(Sha256& hash) { return std::string(seal_mark) + hash.hex() + "\n"; }

void check_seal(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    const std::streamoff bytes = in.tellg(), sealed_bytes = bytes - std::streamoff(seal_length);
    in.seekg(0);
    const auto end = end_of_data(in);
    in.clear();
    if (end && std::uint64_t(bytes) > *end && (sealed_bytes < 0 || std::uint64_t(sealed_bytes) != *end))
        fail(file, "what follows its data is not their SHA-256");
    if (sealed_bytes < 0) return;
    std::string seal(seal_length, '\0');
    in.seekg(sealed_bytes);
    in.read(seal.data(), std::streamsize(seal_length));
    if (!seal.starts_with(seal_mark)) {
        if (end && std::uint64_t(sealed_bytes) == *end) fail(file, "what follows its data is not their SHA-256");
        return;
    }
    Sha256 hash;
    in.seekg(0);
    if (seal != seal_of(hash.add_stream(in, std::uint64_t(sealed_bytes))))
        fail(file, "some of its bytes are not those that were written");
}

}  // namespace hausbench::h5
