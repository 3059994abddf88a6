#include "datasets/hash.h"

#include "algorithms/error.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <vector>

namespace hausbench {

static_assert(std::endian::native == std::endian::little, "numbers are hashed as they stand in memory");

Sha256::Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1)
        throw std::runtime_error("OpenSSL has no SHA-256");
}

Sha256& Sha256::add(const void* bytes, std::size_t count) {
    if (count > 0 && EVP_DigestUpdate(context_.get(), bytes, count) != 1) throw std::runtime_error("SHA-256 failed");
    return *this;
}

Sha256& Sha256::add(std::string_view text) {
    const std::uint64_t length = text.size();
    return add(&length, sizeof length).add(text.data(), text.size());
}

Sha256& Sha256::add_stream(std::istream& in, std::uint64_t most) {
    std::vector<char> buffer(1 << 20);
    while (most > 0 && in) {
        in.read(buffer.data(), static_cast<std::streamsize>(std::min<std::uint64_t>(most, buffer.size())));
        add(buffer.data(), static_cast<std::size_t>(in.gcount()));
        most -= static_cast<std::uint64_t>(in.gcount());
    }
    return *this;
}

std::string Sha256::hex() {
    std::array<unsigned char, 32> digest{};
    if (EVP_DigestFinal_ex(context_.get(), digest.data(), nullptr) != 1) throw std::runtime_error("SHA-256 failed");
    return fmt::format("{:02x}", fmt::join(digest, ""));
}

std::string sha256_of_file(const std::filesystem::path& file) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored)) throw InputError(file.string() + ": is a directory, not a file");
    errno = 0;
    std::ifstream in(file, std::ios::binary);
    if (!in) throw InputError(file.string() + ": cannot be read: " + std::strerror(errno));
    Sha256 hash;
    hash.add_stream(in, std::numeric_limits<std::uint64_t>::max());
    if (in.bad()) throw InputError(file.string() + ": cannot be read to its end");
    return hash.hex();
}

namespace {

template <class Matrix> void add_matrix(Sha256& hash, const Matrix& matrix) {
    const std::int64_t rows = matrix.rows();
    hash.add(&rows, sizeof rows);
    hash.add(matrix.data(), sizeof(typename Matrix::Scalar) * static_cast<std::size_t>(matrix.size()));
}

}  // namespace

std::string content_hash(const Shape& shape) {
    Sha256 hash;
    hash.add(to_string(kind_of(shape)));
    add_matrix(hash, points_of(shape));
    if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) add_matrix(hash, mesh->triangles);
    if (const auto* surface = std::get_if<AlgebraicSurface>(&shape)) hash.add(surface->polynomial);
    return hash.hex();
}

}  // namespace hausbench
