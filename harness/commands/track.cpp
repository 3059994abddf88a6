// `hausbench track`: whether the solvers of a checkout have become slower. What it does is bench/tracking, where scipy is.
#include "harness/commands/python_module.h"
#include "harness/commands/verb.h"

namespace hausbench {

void add_track(CLI::App& app, int&) {
    auto* verb = app.add_subcommand(
        "track",
        "tell whether solvers have become slower: work counters, instructions, then times beside an older build");
    verb->prefix_command();  // all that follows is for the tracker, --help too
    verb->set_help_flag();
    verb->callback([verb] {
        become_python("track", folder_with("track", "bench/tracking/__main__.py"), "bench.tracking", verb->remaining());
    });
}

}  // namespace hausbench
