#include "registry.h"

#include "error.h"

#include <set>

namespace hausbench {

// The function of each solver, defined in its own file; the list below calls it.
SolverEntry naive_solver();                 // points/naive.cpp
SolverEntry earlybreak_solver();            // points/earlybreak.cpp
SolverEntry inc_solver();                   // points/inc.cpp
SolverEntry nohd_solver();                  // points/nohd.cpp
SolverEntry ohd_solver();                   // points/ohd.cpp
SolverEntry adaptive_solver();              // points/adaptive.cpp
SolverEntry nohd_as_printed_solver();       // points/nohd_as_printed.cpp
SolverEntry ohd_as_printed_solver();        // points/ohd_as_printed.cpp
SolverEntry scan_solver();                  // points/scan.cpp
SolverEntry guthe_solver();                 // meshes/guthe.cpp
SolverEntry tang_solver();                  // meshes/tang.cpp
SolverEntry kang_solver();                  // meshes/kang.cpp
SolverEntry sacht_solver();                 // meshes/sacht.cpp
SolverEntry zheng_solver();                 // meshes/zheng.cpp
SolverEntry sampling_solver();              // meshes/sampling.cpp
SolverEntry cover_solver();                 // meshes/cover.cpp
SolverEntry interval_subdivision_solver();  // surfaces/interval_subdivision.cpp
SolverEntry surface_enclosure_solver();     // surfaces/surface_enclosure.cpp
SolverEntry surface_meshes_solver();        // surfaces/surface_meshes.cpp
SolverEntry kdtree_solver();                // peers/kdtree.cpp
SolverEntry penetration_solver();           // meshes/penetration.cpp
SolverEntry cgal_solver();                  // peers/cgal.cpp
SolverEntry cgal_kdtree_solver();           // peers/cgal_kdtree.cpp

namespace {

std::vector<SolverEntry>& list_of_solvers() {
    static std::vector<SolverEntry> list = {
        naive_solver(),
        earlybreak_solver(),
        inc_solver(),
        nohd_solver(),
        ohd_solver(),
        adaptive_solver(),
        nohd_as_printed_solver(),
        ohd_as_printed_solver(),
        scan_solver(),
        guthe_solver(),
        tang_solver(),
        kang_solver(),
        zheng_solver(),
        sacht_solver(),
        sampling_solver(),
        cover_solver(),
        interval_subdivision_solver(),
        surface_enclosure_solver(),
        surface_meshes_solver(),
#ifdef HAUSBENCH_HAS_KDTREE
        kdtree_solver(),
#endif
#ifdef HAUSBENCH_HAS_CGAL
        penetration_solver(),
        cgal_solver(),
        cgal_kdtree_solver(),
#endif
    };
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
            throw InputError(origin + ": there is a solver '" + entry.info.name +
                             "' already: give this one another name");
        }
    }
    list_of_solvers().insert(list_of_solvers().end(), more.begin(), more.end());
}

const std::vector<NotBuilt>& solvers_not_built() {
    static const std::vector<NotBuilt> list = {
#ifndef HAUSBENCH_HAS_KDTREE
        {"kdtree", "nanoflann was not found, or HAUSBENCH_WITH_KDTREE_PEER is off"},
#endif
#ifndef HAUSBENCH_HAS_CGAL
        {"penetration", "HAUSBENCH_WITH_CGAL_PEER is off (CGAL's corefinement is GPL)"},
        {"cgal", "HAUSBENCH_WITH_CGAL_PEER is off"},
        {"cgal_kdtree", "HAUSBENCH_WITH_CGAL_PEER is off (CGAL's k-d tree is GPL)"},
#endif
    };
    return list;
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
                     "; one of a plug-in needs --plugin FILE");
}

}  // namespace hausbench
