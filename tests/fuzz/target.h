// Common parts of the fuzz targets. A target is a function of bytes that throws if something is wrong.
// libFuzzer calls it (`make fuzz`, HAUSBENCH_LIBFUZZER), and so does tests/fuzz/replay/fuzz_replay_test.cpp,
// which any compiler builds and which replays the files of tests/fuzz/corpus.
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

// Makes numbers from bytes; after their end all numbers are 0. libFuzzer's FuzzedDataProvider is
// part of clang, but GCC builds the replay.
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

// An error message for users is one non-empty line.
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
