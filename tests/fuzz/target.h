// Common parts of the fuzz targets. A target is a function of bytes that throws if it finds an error.
// libFuzzer calls it with changing bytes (`make fuzz`, HAUSBENCH_LIBFUZZER), and
// tests/fuzz/replay/fuzz_replay_test.cpp with the files of tests/fuzz/corpus, with any compiler.
#pragma once

#include "algorithms/error.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

namespace hausbench::fuzz {

using Target = void (*)(std::string_view bytes);

inline std::map<std::string, Target>& targets() {
    static std::map<std::string, Target> all;
    return all;
}

struct Registered {
    Registered(const char* name, Target target) { targets()[name] = target; }
};

struct Wrong : std::logic_error {
    using std::logic_error::logic_error;
};

inline void expect(bool holds, const std::string& what) {
    if (!holds) throw Wrong(what);
}

// Makes numbers from bytes; when no bytes are left, zeros. Replaces libFuzzer's FuzzedDataProvider, which
// GCC lacks.
class Bytes {
public:
    explicit Bytes(std::string_view bytes) : rest_(bytes) {}

    bool empty() const { return rest_.empty(); }
    std::string_view rest() const { return rest_; }

    template <class Number> Number next() {
        Number value{};
        const std::size_t count = std::min(sizeof value, rest_.size());
        std::memcpy(&value, rest_.data(), count);
        rest_.remove_prefix(count);
        return value;
    }
    std::uint32_t byte() { return next<std::uint8_t>(); }
    std::uint32_t below(std::uint32_t n) { return byte() % n; }  // n <= 256
    std::string_view text(std::size_t most) {
        const std::string_view taken = rest_.substr(0, most);
        rest_.remove_prefix(taken.size());
        return taken;
    }

private:
    std::string_view rest_;
};

inline void expect_one_line(const InputError& error) {
    const std::string_view text = error.what();
    expect(!text.empty() && text.find('\n') == std::string_view::npos, "the message is not one line");
}

}  // namespace hausbench::fuzz

#ifdef HAUSBENCH_LIBFUZZER
#define HAUSBENCH_FUZZ_TARGET(name)                                                         \
    extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {     \
        hausbench::fuzz::name(std::string_view(reinterpret_cast<const char*>(data), size)); \
        return 0;                                                                           \
    }
#else
#define HAUSBENCH_FUZZ_TARGET(name) \
    static const hausbench::fuzz::Registered registered_##name(#name, hausbench::fuzz::name);
#endif
