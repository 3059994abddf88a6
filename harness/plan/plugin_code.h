// Runs the code of plug-ins outside the process of the user, because it may end, crash or hang it.
#pragma once

#include "algorithms/solver.h"

#include <filesystem>

namespace hausbench {

// Like load_plugin() (algorithms/plugin.h), in a copy of this process, which goes on with the verb (process/stand_in.h).
// Worker processes load plug-ins themselves, by load_plugin(). Throws InputError, in the process that waits, if the plug-in
// ends the copy, or does not end within 30 s of loading.
void load_plugin_in_copy(const std::filesystem::path& file);

// Returns whether a solver promises bounds that hold under rounding, with these parameters. A solver of a plug-in is made
// in a child process, which has 10 s. If it ends or hangs there, it promises nothing; its cases then fail in the same way.
// Throws InputError if the solver refuses the parameters.
bool promises(const SolverEntry& entry, const ParameterMap& given);

}  // namespace hausbench
