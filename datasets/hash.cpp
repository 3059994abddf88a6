#include "hash.h"

#include "error.h"

#include <openssl/evp.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace hausbench {

struct Sha256::State {
    EVP_MD_CTX* context = EVP_MD_CTX_new();
    ~State() { EVP_MD_CTX_free(context); }
};

Sha256::Sha256() : state_(std::make_unique<State>()) {
    if (!state_->context || EVP_DigestInit_ex(state_->context, EVP_sha256(), nullptr) != 1)
        throw std::runtime_error("OpenSSL has no SHA-256");
}

Sha256::~Sha256() = default;

Sha256& Sha256::add(const void* bytes, std::size_t count) {
    if (count > 0 && EVP_DigestUpdate(state_->context, bytes, count) != 1) throw std::runtime_error("SHA-256 failed");
    return *this;
}

Sha256& Sha256::add(std::string_view text) {
    std::array<unsigned char, 8> length{};  // little-endian on every machine
    for (std::size_t i = 0; i < length.size(); ++i)
        length[i] = static_cast<unsigned char>((static_cast<std::uint64_t>(text.size()) >> (8 * i)) & 0xff);
    return add(length.data(), length.size()).add(text.data(), text.size());
}

std::string Sha256::hex() {
    std::array<unsigned char, 32> digest{};
    if (EVP_DigestFinal_ex(state_->context, digest.data(), nullptr) != 1) throw std::runtime_error("SHA-256 failed");
    std::string text;
    for (const unsigned char byte : digest) {
        text += "0123456789abcdef"[byte >> 4];
        text += "0123456789abcdef"[byte & 15];
    }
    return text;
}

std::string sha256_of_file(const std::filesystem::path& file) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored)) throw InputError(file.string() + ": is a directory, not a file");
    errno = 0;
    std::ifstream in(file, std::ios::binary);
    if (!in) throw InputError(file.string() + ": cannot be read: " + std::strerror(errno));
    Sha256 hash;
    std::vector<char> buffer(1 << 20);
    while (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || in.gcount() > 0)
        hash.add(buffer.data(), static_cast<std::size_t>(in.gcount()));
    if (in.bad()) throw InputError(file.string() + ": cannot be read to its end");
    return hash.hex();
}

}  // namespace hausbench
