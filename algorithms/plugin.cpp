#include "algorithms/plugin.h"

#include "algorithms/contract.h"
#include "algorithms/error.h"
#include "algorithms/registry.h"

#include <dlfcn.h>
#include <elf.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

std::vector<Plugin>& list_of_plugins() {
    static std::vector<Plugin> list;
    return list;
}

// Returns whether the file is truncated, that is, shorter than its ELF program header says. dlopen() would crash on
// such a file (SIGBUS).
bool is_cut_short(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    Elf64_Ehdr header{};
    if (!in.read(reinterpret_cast<char*>(&header), sizeof header) ||
        std::string_view(reinterpret_cast<char*>(header.e_ident), SELFMAG) != ELFMAG) {
        return false;  // dlopen() reports the error
    }
    std::error_code ignored;
    const std::uintmax_t size = fs::file_size(file, ignored);
    in.seekg(static_cast<std::streamoff>(header.e_phoff));
    for (int i = 0; i < header.e_phnum; ++i) {
        Elf64_Phdr part{};
        if (!in.read(reinterpret_cast<char*>(&part), sizeof part)) return true;
        if (part.p_type == PT_LOAD && part.p_offset + part.p_filesz > size) return true;
    }
    return false;
}

template <class Function> Function* symbol(void* library, const char* name, const fs::path& file) {
    void* address = ::dlsym(library, name);
    if (!address) {
        throw InputError(
            fmt::format("{}: is a library but not a plug-in, it has no '{}': put HAUSBENCH_PLUGIN(...) in one of its "
                        "files (plugin.h)",
                        file.string(), name));
    }
    return reinterpret_cast<Function*>(address);
}

// Throws InputError if a new solver and another solver declare structures with the same name but different layouts,
// because the two solvers may share one object.
void check_structures(const std::vector<SolverEntry>& entries, const fs::path& file) {
    for (const SolverEntry& added : entries) {
        for (const Need& need : added.info.may_need) {
            for (const SolverEntry& other : solvers()) {
                for (const Need& existing : other.info.may_need) {
                    if (existing.structure.name != need.structure.name ||
                        existing.structure.layout == need.structure.layout)
                        continue;
                    throw InputError(fmt::format(
                        "{}: was built with another layout of the structure '{}' ({}) than solver '{}' has ({}): build "
                        "it again against this hausbench",
                        file.string(), need.structure.name, need.structure.layout, other.info.name,
                        existing.structure.layout));
                }
            }
        }
    }
}

void* open_library(const fs::path& named, const fs::path& file) {
    if (!fs::exists(file))
        throw InputError(fmt::format("{}: does not exist: name a plug-in, a MODULE library (.so)", named.string()));
    if (fs::is_directory(file))
        throw InputError(fmt::format("{}: is a folder: name a plug-in in it (.so)", named.string()));
    if (!fs::is_regular_file(file))  // reading a pipe could take for ever
        throw InputError(fmt::format("{}: is not a regular file: name a plug-in (.so)", named.string()));
    if (is_cut_short(file))
        throw InputError(fmt::format("{}: the file is truncated: copy or build it again", file.string()));
    void* library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);  // never closed: its solvers stay in use
    if (!library) {
        const char* why = ::dlerror();
        throw InputError(
            fmt::format("{}: cannot be loaded ({}): build it as a MODULE library with find_package(hausbench)",
                        file.string(), why ? why : "no reason given"));
    }
    return library;
}

void check_made_for_this_program(void* library, const fs::path& file) {
    const int interface = symbol<int()>(library, "hausbench_plugin_interface", file)();
    if (interface != plugin_interface) {
        throw InputError(fmt::format(
            "{}: was made for plug-in interface {}, this program has {}: build it again against this hausbench",
            file.string(), interface, plugin_interface));
    }
    std::array<char, 1024> layout{};
    symbol<void(char*, unsigned long)>(library, "hausbench_plugin_layout", file)(layout.data(), layout.size() - 1);
    if (plugin_layout() != layout.data()) {
        throw InputError(
            fmt::format("{}: was built with other headers or libraries ({}) than this program ({}): build it again "
                        "against this hausbench",
                        file.string(), layout.data(), plugin_layout()));
    }
}

std::vector<SolverEntry> solvers_of(void* library, const fs::path& file) {
    std::vector<SolverEntry> entries;
    try {
        symbol<void(std::vector<SolverEntry>&)>(library, "hausbench_plugin_solvers", file)(entries);
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        throw InputError(fmt::format("{}: failed to list its solvers: {}", file.string(), error.what()));
    }
    if (entries.empty())
        throw InputError(fmt::format("{}: offers no solver: name them in HAUSBENCH_PLUGIN(...)", file.string()));
    return entries;
}

}  // namespace

const std::vector<Plugin>& plugins() { return list_of_plugins(); }

void load_plugin(const fs::path& named) {
    const fs::path file = fs::absolute(named).lexically_normal();
    void* library = open_library(named, file);
    check_made_for_this_program(library, file);
    const std::vector<SolverEntry> entries = solvers_of(library, file);
    check_structures(entries, file);
    add_solvers(entries, file.string());
    Plugin plugin{file, {}, symbol<const char*()>(library, "hausbench_plugin_compiled", file)()};
    for (const SolverEntry& entry : entries) plugin.solvers.push_back(entry.info.name);
    list_of_plugins().push_back(std::move(plugin));
    for (const SolverEntry& entry : entries) check_contract(entry);
}

const Plugin* plugin_of(std::string_view solver) {
    for (const Plugin& plugin : plugins()) {
        if (std::find(plugin.solvers.begin(), plugin.solvers.end(), solver) != plugin.solvers.end()) return &plugin;
    }
    return nullptr;
}

std::vector<std::string> slow_plugins() {
    constexpr std::string_view slow = "not optimized";
    std::vector<std::string> lines;
    for (const Plugin& plugin : plugins()) {
        if (!plugin.compiled.starts_with(slow) || std::string_view(HAUSBENCH_COMPILED).starts_with(slow)) continue;
        lines.push_back(
            fmt::format("{}: is not optimized, but this program is, so its times are not comparable: build it with "
                        "-DCMAKE_BUILD_TYPE=Release",
                        plugin.file.string()));
    }
    return lines;
}

}  // namespace hausbench
