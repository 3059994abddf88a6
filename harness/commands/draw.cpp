// `hausbench draw`: tables and figures of any result. analysis/draw.py does it.
#include "datasets/paths.h"
#include "harness/commands/python_module.h"
#include "harness/commands/verb.h"

#include <cstdlib>

namespace hausbench {

void add_draw(CLI::App& app, int&) {
    auto* verb = app.add_subcommand("draw", "tables and figures of any result, for papers: draw RESULT.h5 --as table");
    verb->prefix_command();  // the rest is for the script, --help too
    verb->set_help_flag();
    verb->callback([verb] {
        ::setenv("HAUSBENCH_CACHE", cache_folder().c_str(), 1);  // where its shapes are
        become_python("draw", folder_with("draw", "analysis/draw.py"), "analysis.draw", verb->remaining());
    });
}

}  // namespace hausbench
