// The number of tries of a random search. `make test` makes a fifth of them, to end within minutes.
// HAUSBENCH_SEARCHES=all makes all, as CI and the mutants do; `make searches` runs only these programs. The first fifth
// is the same in both.
#pragma once

#include <cstdlib>
#include <string_view>

namespace hausbench {

inline bool whole_searches() {
    const char* setting = std::getenv("HAUSBENCH_SEARCHES");
    return setting && std::string_view(setting) == "all";
}

inline int tries(int all) { return whole_searches() ? all : all / 5; }

}  // namespace hausbench
