// The last line of result and certificate files: the SHA-256 of all bytes before it. Written
// independently of the code under test.
#pragma once

#include "datasets/hash.h"

#include <string>
#include <string_view>

namespace hausbench {

inline constexpr std::size_t seal_bytes = 73;  // "\nsha256 ", 64 digits and a newline

inline std::string sealed(std::string_view bytes) {
    return std::string(bytes) + "\nsha256 " + Sha256().add(bytes.data(), bytes.size()).hex() + '\n';
}

}  // namespace hausbench
