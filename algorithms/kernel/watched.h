// Switches beside the terms of bounds, for `make mutants`, which shows that a test fails without each of them.
//
// WATCHED("name", term) is the term. In the preset `mutants` it is T{} instead, that is 0, false or an empty value of the
// term's type T, if the environment variable HAUSBENCH_MUTANT is the name. WATCHED_ELSE("name", value, without) is
// `without` then. tests/mutants.toml lists the names and their tests. A name may stand in several places, which are
// switched together. Examples:
//
//     error += WATCHED("distance: the underflow", 0x1p-500);
//     return f * (1 - WATCHED("distance: the rounding error", 4 * unit_roundoff));
//     return WATCHED_ELSE("distance: the rounding of the product", next_down(x), x);
//     if (WATCHED("search: triangles that overflow", !std::isfinite(x))) return unbounded;
//     if (!WATCHED("search: distances that are too large", x > most)) settle(x);
//     if (WATCHED("bounds: pieces that are left", true)) upper = std::max(upper, left);
#pragma once

#ifdef HAUSBENCH_MUTANTS

#include <cstdlib>
#include <string_view>
#include <type_traits>

namespace hausbench {

inline bool switched_off(std::string_view name) {
    const char* wanted = std::getenv("HAUSBENCH_MUTANT");
    return wanted && name == wanted;
}

}  // namespace hausbench

// The lambda asks once for each place in the code.
#define HAUSBENCH_SWITCHED_OFF(name)                                  \
    ([]() -> bool {                                                   \
        static const bool off_here = ::hausbench::switched_off(name); \
        return off_here;                                              \
    }())
#define WATCHED(name, ...) (HAUSBENCH_SWITCHED_OFF(name) ? std::decay_t<decltype(__VA_ARGS__)>{} : (__VA_ARGS__))
#define WATCHED_ELSE(name, value, without) (HAUSBENCH_SWITCHED_OFF(name) ? (without) : (value))

#else

#define WATCHED(name, ...) (__VA_ARGS__)
#define WATCHED_ELSE(name, value, without) (value)

#endif
