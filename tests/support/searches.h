// The number of tries of a random search. `make test` makes a fifth of them, to end within minutes.
// HAUSBENCH_SEARCHES=all makes all, as CI and the mutants do; `make searches` runs only these programs. The first fifth
// is the same in both.
#pragma once

#include <cstdlib>
#include <string_view>

namespace hausbench {

inline bool whole_searches() {
    const char* asked = std::getenv("HAUSBENCH_SEARCHES");
    return asked && std::string_view(asked) == "all";
}

inline int tries(int all) { return whole_searches() ? all : all / 5; }

}  // namespace hausbench
