#include "result_file.h"

#include "machine.h"
#include "surface_file.h"

#include <fmt/format.h>

namespace hausbench {

void describe_run(ResultFile& result, const Experiment& experiment, const std::string& started,
                  const std::string& finished) {
    const Build& build = this_build();
    const Machine& machine = this_machine();
    result.texts = {{"stem", experiment.stem},
                    {"title", experiment.title},
                    {"paper", experiment.paper},
                    {"profile", experiment.profile},
                    {"experiment_toml", experiment.toml},
                    {"started", started},
                    {"finished", finished},
                    {"commit", build.commit},
                    {"dirty", build.dirty},
                    {"build", build.id},
                    {"compiler", build.compiler},
                    {"flags", build.flags},
                    {"build_type", build.type},
                    {"libraries", build.libraries},
                    {"hausbench_version", build.version},
                    {"machine", machine.id},
                    {"cpu", machine.cpu},
                    {"caches", machine.caches},
                    {"kernel", machine.kernel},
                    {"system", machine.system}};
    result.integers = {{"cores", machine.cores}, {"memory_bytes", machine.memory_bytes}};
}

namespace {

// The equation of a surface is what it is.
std::string note_of(const ModelInfo& model) {
    if (!model.surface) return model.note;
    return describe(*model.surface) + (model.note.empty() ? "" : "; " + model.note);
}

}  // namespace

ModelRecord record_of(const ModelRow& model) {
    const ResolvedModel& r = model.resolved;
    return {model.info->name,
            r.content_hash,
            std::string(to_string(r.kind)),
            r.report.precision,
            model.info->source,
            model.info->licence,
            note_of(*model.info),
            r.elements,
            r.vertices,
            r.report.unreferenced.value_or(-1),
            r.diagonal};
}

}  // namespace hausbench
