#include "algorithms/registry.h"

#include "algorithms/built_solvers.h"
#include "algorithms/error.h"

#include <set>

namespace hausbench {

namespace {

std::vector<SolverEntry>& list_of_solvers() {
    static std::vector<SolverEntry> list = built_solvers();
    return list;
}

}  // namespace

const std::vector<SolverEntry>& solvers() { return list_of_solvers(); }

void add_solvers(const std::vector<SolverEntry>& more, const std::string& origin) {
    std::set<std::string> names;
    for (const SolverEntry& entry : solvers()) names.insert(entry.info.name);
    for (const NotBuilt& absent : solvers_not_built()) names.insert(absent.name);
    for (const SolverEntry& entry : more) {
        if (entry.info.name.empty() || !entry.make)
            throw InputError(origin + ": offers a solver without a name or without a function that makes it");
        if (!names.insert(entry.info.name).second) {
            throw InputError(origin + ": a solver '" + entry.info.name +
                             "' exists already: give this one another name");
        }
    }
    list_of_solvers().insert(list_of_solvers().end(), more.begin(), more.end());
}

const SolverEntry& find_solver(std::string_view name) {
    std::vector<std::string> names;
    for (const SolverEntry& entry : solvers()) {
        if (entry.info.name == name) return entry;
        names.push_back(entry.info.name);
    }
    for (const NotBuilt& missing : solvers_not_built()) {
        if (missing.name == name) {
            throw InputError("solver '" + missing.name + "' is not built into this program: " + missing.reason);
        }
    }
    throw InputError("unknown solver '" + std::string(name) + "'" + nearest_hint(name, names) +
                     "; a solver of a plug-in needs --plugin FILE");
}

}  // namespace hausbench
