// Solvers from outside the tree: a MODULE library that is loaded at run time.
//
// A plug-in is any number of solvers (solver.h) and one line at the end of one of its files:
//
//     HAUSBENCH_PLUGIN(my_solver(), my_other_solver())   // expressions of type SolverEntry
//
// It is built against the installed headers and library with find_package(hausbench); tests/outside_plugin/ is an example.
// C++ objects pass between plug-in and program, so both must agree on the interface, the C++ library and Eigen:
// `plugin_interface` increases with every change of meaning in the public headers, `plugin_layout()` detects the rest.
#pragma once

#include "algorithms/solver.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

inline constexpr int plugin_interface = 11;

#define HAUSBENCH_TEXT_OF(x) #x
#define HAUSBENCH_TEXT(x) HAUSBENCH_TEXT_OF(x)

// Libraries whose objects pass between plug-in and program, and the sizes of these objects.
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

// Flags with which the including file is compiled, as far as the compiler tells (GCC does not reveal -fsanitize=undefined).
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

// Functions that a plug-in exports, with C linkage so that their names are known.
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

// Adds a plug-in's solvers to the registry; it stays loaded. Call it before anything else: see add_solvers() in
// registry.h.
// Throws InputError with the file and the remedy if the file is missing, is not a library or not a plug-in, or was
// built for another interface or with other libraries, if a solver's name is already in use, or if a solver breaks
// its contract (contract.h). The program should then end.
void load_plugin(const std::filesystem::path& file);

struct Plugin {
    std::filesystem::path file;  // absolute
    std::vector<std::string> solvers;
    // How HAUSBENCH_PLUGIN's file was compiled: "optimized, no assertions, GCC 12.2.0".
    std::string compiled;
};
const std::vector<Plugin>& plugins();  // in the order of loading

// Returns the plug-in of a solver; null for a built-in one.
const Plugin* plugin_of(std::string_view solver);

// Returns one line for each plug-in compiled without optimization if this program has it: their times are not comparable.
std::vector<std::string> slow_plugins();

}  // namespace hausbench
