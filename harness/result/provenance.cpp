#include "harness/result/provenance.h"

#include "algorithms/plugin.h"
#include "algorithms/registry.h"
#include "build_flags.h"  // written by CMake, as is build_info.h
#include "build_info.h"
#include "datasets/hash.h"
#include "datasets/paths.h"

#include <CGAL/version.h>
#include <Eigen/Core>
#include <H5public.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <sys/utsname.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <fstream>
#include <sstream>

namespace hausbench {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

std::string first_line(const fs::path& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    return line;
}

// Returns the value of the first line "KEY<separator>value" in a file, or "unknown" if there is none.
std::string field(const fs::path& file, const std::string& key, char separator) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        const auto at = line.find(separator);
        if (at == std::string::npos || line.compare(0, key.size(), key) != 0) continue;
        auto value = line.substr(at + 1);
        const auto begin = value.find_first_not_of(" \t\"");
        const auto end = value.find_last_not_of(" \t\"");
        return begin == std::string::npos ? "" : value.substr(begin, end - begin + 1);
    }
    return "unknown";
}

std::string cache_sizes() {
    std::string text;
    for (int i = 0; i < 8; ++i) {
        const fs::path folder = fmt::format("/sys/devices/system/cpu/cpu0/cache/index{}", i);
        if (!fs::exists(folder)) break;
        text += fmt::format("{}L{} {} {}", text.empty() ? "" : ", ", first_line(folder / "level"),
                            first_line(folder / "type"), first_line(folder / "size"));
    }
    return text.empty() ? "unknown" : text;
}

Build read_build() {
    Build build;
    build.version = HAUSBENCH_VERSION;
    build.compiler = HAUSBENCH_COMPILER;
    build.flags = HAUSBENCH_FLAGS;
    build.type = HAUSBENCH_BUILD_TYPE;
    unsigned hdf5[3] = {};
    H5get_libversion(&hdf5[0], &hdf5[1], &hdf5[2]);
    json libraries = json::parse(HAUSBENCH_LIBRARIES);
    libraries["CGAL"] = CGAL_VERSION_STR;
    libraries["Eigen"] = fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
    libraries["HDF5"] = fmt::format("{}.{}.{}", hdf5[0], hdf5[1], hdf5[2]);
    build.libraries = libraries.dump();
    // The commit is in a separate file, so that a commit that changes no code keeps the build's id. The file is beside
    // the program or, in an installation, with the data.
    const fs::path folder = program_path().parent_path();
    std::ifstream in(folder / "commit.json");
    if (!in) in.open(folder / HAUSBENCH_COMMIT_FILE);
    const json commit = in ? json::parse(in, nullptr, false) : json();
    build.commit = commit.is_object() ? commit.value("commit", "unknown") : "unknown";
    build.dirty = commit.is_object() ? commit.value("dirty", "unknown") : "unknown";
    return build;
}

Machine read_machine() {
    Machine machine;
    machine.cpu = field("/proc/cpuinfo", "model name", ':');
    machine.caches = cache_sizes();
    machine.cores = sysconf(_SC_NPROCESSORS_ONLN);
    machine.memory_bytes = std::int64_t(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGE_SIZE);
    utsname name{};
    uname(&name);
    machine.kernel = fmt::format("{} {} {}", name.sysname, name.release, name.machine);
    machine.system = field("/etc/os-release", "PRETTY_NAME", '=');
    machine.id = Sha256()
                     .add(machine.cpu)
                     .add(machine.caches)
                     .add(machine.kernel)
                     .add(machine.system)
                     .add(fmt::format("{} {}", machine.cores, machine.memory_bytes))
                     .hex();
    return machine;
}

}  // namespace

const std::string& build_id() {
    static const std::string id = sha256_of_file("/proc/self/exe");
    return id;
}

const Build& this_build() {
    static const Build build = read_build();
    return build;
}

std::string version_text() {
    const Build& b = this_build();
    return fmt::format("hausbench {}, commit {}{}, {}, {}, plug-in interface {}", b.version, b.commit.substr(0, 12),
                       b.dirty == "yes" ? " with changes" : "", b.type, b.compiler, plugin_interface);
}

const Machine& this_machine() {
    static const Machine machine = read_machine();
    return machine;
}

const std::map<fs::path, std::string>& plugin_hashes() {
    static const std::map<fs::path, std::string> hashes = [] {
        std::map<fs::path, std::string> all;
        for (const Plugin& plugin : plugins()) all[plugin.file] = sha256_of_file(plugin.file);
        return all;
    }();
    return hashes;
}

std::string plugins_json() {
    json all = json::array();
    for (const Plugin& plugin : plugins()) {
        all.push_back({{"file", plugin.file.filename().string()},
                       {"sha256", plugin_hashes().at(plugin.file)},
                       {"compiled", plugin.compiled},
                       {"solvers", plugin.solvers}});
    }
    return all.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string titles_json() {
    json titles = json::object();
    for (const SolverEntry& entry : solvers()) titles[entry.info.name] = entry.info.title;
    return titles.dump(-1, ' ', false, json::error_handler_t::replace);
}

const std::string& build_of(const std::string& solver) {
    static const std::map<std::string, std::string> builds = [] {
        std::map<std::string, std::string> all;
        for (const Plugin& plugin : plugins()) {
            for (const std::string& name : plugin.solvers) {
                all[name] = Sha256().add(build_id()).add(plugin_hashes().at(plugin.file)).hex();
            }
        }
        return all;
    }();
    const auto at = builds.find(solver);
    return at == builds.end() ? build_id() : at->second;
}

Programs::Programs(const std::map<std::string, std::string>& texts) {
    const auto text = [&](const char* name) {
        const auto at = texts.find(name);
        return at == texts.end() ? std::string() : at->second;
    };
    program_ = text("build");
    const json plugins = json::parse(text("plugins"), nullptr, false);
    if (!plugins.is_array()) return;
    for (const json& plugin : plugins) {
        const auto hash = plugin.is_object() ? plugin.find("sha256") : plugin.end();
        if (hash != plugin.end() && hash->is_string())
            with_plugin_.insert(Sha256().add(program_).add(hash->get<std::string>()).hex());
    }
}

std::string utc_now() {
    const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    std::tm parts{};
    gmtime_r(&now, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text;
}

}  // namespace hausbench
