// SHA-256, through OpenSSL.
#pragma once

#include "algorithms/scene.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <memory>
#include <string>
#include <string_view>

struct evp_md_ctx_st;  // OpenSSL's

namespace hausbench {

class Sha256 {
public:
    Sha256();
    Sha256& add(const void* bytes, std::size_t count);
    // Also adds the length of the text, so that "ab", "c" and "a", "bc" give different hashes.
    Sha256& add(std::string_view text);
    // Adds the rest of the stream, but at most `most` bytes.
    Sha256& add_stream(std::istream& in, std::uint64_t most);
    // Returns the hash as 64 lower-case hexadecimal digits. Nothing can be added after this call.
    std::string hex();

private:
    std::unique_ptr<evp_md_ctx_st, void (*)(evp_md_ctx_st*)> context_;
};

// Returns the hash of the file's bytes. Throws InputError if the file cannot be read.
std::string sha256_of_file(const std::filesystem::path& file);

// Returns the SHA-256 (hexadecimal) of the kind, counts, coordinates and indices of a shape, or of the polynomial and
// box of a surface. Two shapes with the same hash count as the same input.
std::string content_hash(const Shape& shape);

}  // namespace hausbench
