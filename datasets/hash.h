// SHA-256, through OpenSSL.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace hausbench {

class Sha256 {
public:
    Sha256();
    ~Sha256();
    Sha256& add(const void* bytes, std::size_t count);
    Sha256& add(std::string_view text);  // hashes the length too, so that two fields cannot be confused with one
    std::string hex();                   // 64 lower-case digits; ends the hash

private:
    struct State;
    std::unique_ptr<State> state_;
};

std::string sha256_of_file(const std::filesystem::path& file);  // throws InputError if it cannot be read

}  // namespace hausbench
