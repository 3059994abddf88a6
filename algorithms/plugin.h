// Plug-ins: shared libraries (CMake's MODULE libraries) with more solvers, which the program loads at run time.
//
// A plug-in consists of one or more solvers (solver.h) and one line at the end of one of its files:
//
//     HAUSBENCH_PLUGIN(my_solver(), my_other_solver())   // expressions of type SolverEntry
//
// Build it against the installed headers and library with find_package(hausbench); tests/outside_plugin/ is an example.
// C++ objects pass between a plug-in and the program, so both must be built with the same headers, C++ library and
// Eigen. load_plugin() refuses a plug-in whose `plugin_interface` or plugin_layout() is not the same as the program's.
#pragma once

#include "algorithms/solver.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

// Increase this with every change of meaning in the public headers, because plugin_layout() notices only changed sizes
// and library versions. CHANGELOG.md says under "For plug-ins" what to change; a name that goes stays as one whose use
// does not compile, with a text that says so (SolverInfo::NowAnAbility).
inline constexpr int plugin_interface = 12;

#define HAUSBENCH_TEXT_OF(x) #x
#define HAUSBENCH_TEXT(x) HAUSBENCH_TEXT_OF(x)

// Describes the binary interface: the versions of Eigen and libstdc++, and the sizes of the objects that pass between a
// plug-in and the program.
inline std::string plugin_layout() {
    std::string text =
        "Eigen " HAUSBENCH_TEXT(EIGEN_WORLD_VERSION) "." HAUSBENCH_TEXT(EIGEN_MAJOR_VERSION) ", alignment " +
        std::to_string(EIGEN_MAX_ALIGN_BYTES) + ", libstdc++ ABI " HAUSBENCH_TEXT(_GLIBCXX_USE_CXX11_ABI) ", sizes";
    for (const std::size_t size :
         {sizeof(Scene), sizeof(Prepared), sizeof(PreparedShape), sizeof(Query), sizeof(Result), sizeof(QuerySet),
          sizeof(Trace), sizeof(Options), sizeof(ParameterSpec), sizeof(SolverInfo), sizeof(SolverEntry)}) {
        text += ' ' + std::to_string(size);
    }
    return text;
}

// HAUSBENCH_COMPILED says how the including file is compiled, such as "optimized, no assertions, GCC 12.2.0". It omits
// -fsanitize=undefined, for which GCC predefines no macro.
#ifdef __OPTIMIZE__
#define HAUSBENCH_OPTIMIZED "optimized"
#else
#define HAUSBENCH_OPTIMIZED "not optimized"
#endif
#ifdef NDEBUG
#define HAUSBENCH_ASSERTIONS "no assertions"
#else
#define HAUSBENCH_ASSERTIONS "assertions"
#endif
#ifdef __clang__
#define HAUSBENCH_COMPILED_BY __VERSION__
#else
#define HAUSBENCH_COMPILED_BY "GCC " __VERSION__
#endif
#if defined(__SANITIZE_ADDRESS__)
#define HAUSBENCH_SANITIZERS ", address sanitizer"
#elif defined(__SANITIZE_THREAD__)
#define HAUSBENCH_SANITIZERS ", thread sanitizer"
#else
#define HAUSBENCH_SANITIZERS ""
#endif
#define HAUSBENCH_COMPILED HAUSBENCH_OPTIMIZED ", " HAUSBENCH_ASSERTIONS ", " HAUSBENCH_COMPILED_BY HAUSBENCH_SANITIZERS

// Defines the functions that a plug-in exports. They have C linkage, so that load_plugin() finds them by name.
#define HAUSBENCH_PLUGIN(...)                                                                                        \
    extern "C" __attribute__((visibility("default"))) const char* hausbench_plugin_compiled() {                      \
        return HAUSBENCH_COMPILED;                                                                                   \
    }                                                                                                                \
    extern "C" __attribute__((visibility("default"))) int hausbench_plugin_interface() {                             \
        return ::hausbench::plugin_interface;                                                                        \
    }                                                                                                                \
    extern "C" __attribute__((visibility("default"))) void hausbench_plugin_layout(char* text, unsigned long size) { \
        ::hausbench::plugin_layout().copy(text, size);                                                               \
    }                                                                                                                \
    extern "C" __attribute__((visibility("default"))) void hausbench_plugin_solvers(                                 \
        std::vector<::hausbench::SolverEntry>& to) {                                                                 \
        to = {__VA_ARGS__};                                                                                          \
    }

// Loads a plug-in and adds its solvers to the registry. The plug-in stays loaded until the program ends. Call it before
// anything looks up a solver, because it invalidates references to solvers (add_solvers() in registry.h).
//
// Throws InputError, which names the file and says what to do, if the file is missing or is not a plug-in; if it was
// built for another interface or with other libraries; if the name of a solver is already in use; or if a solver breaks
// its contract (contract.h). The registry may then contain the faulty solvers, so the program should end.
void load_plugin(const std::filesystem::path& file);

// A loaded plug-in.
struct Plugin {
    std::filesystem::path file;        // absolute
    std::vector<std::string> solvers;  // names
    std::string compiled;              // its HAUSBENCH_COMPILED
};
const std::vector<Plugin>& plugins();  // in the order of loading

// Returns the plug-in that a solver comes from; null for a built-in solver.
const Plugin* plugin_of(std::string_view solver);

// Returns a one-line warning for each plug-in that was compiled without optimization, if this program is optimized:
// their times are then not comparable.
std::vector<std::string> slow_plugins();

}  // namespace hausbench
