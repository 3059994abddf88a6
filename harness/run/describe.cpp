#include "harness/run/describe.h"

#include "harness/result/provenance.h"

#include <fmt/format.h>

namespace hausbench {

void describe_run(ResultFile& result, const Plan& plan, const std::string& started, const std::string& finished) {
    const Experiment& experiment = plan.experiment;
    const Build& build = this_build();
    const Machine& machine = this_machine();
    result.texts = {
        {"stem", experiment.stem},
        {"title", experiment.title},
        {"paper", experiment.paper},
        {"profile", experiment.profile},
        {"experiment_toml", experiment.toml},
        {"experiment_file", experiment.file.empty() ? "" : std::filesystem::absolute(experiment.file).string()},
        {"started", started},
        {"finished", finished},
        {"commit", build.commit},
        {"dirty", build.dirty},
        {"build", build_id()},
        {"compiler", build.compiler},
        {"flags", build.flags},
        {"build_type", build.type},
        {"libraries", build.libraries},
        {"hausbench_version", build.version},
        {"plugins", plugins_json()},
        {"titles", titles_json()},
        {"shard", plan.shard.whole() ? "" : to_string(plan.shard)},
        {"machine", machine.id},
        {"cpu", machine.cpu},
        {"caches", machine.caches},
        {"kernel", machine.kernel},
        {"system", machine.system}};
    result.integers = {{"cores", machine.cores}, {"memory_bytes", machine.memory_bytes}};
}

ModelRecord record_of(const ModelRow& model) {
    const ResolvedModel& r = model.resolved;
    ModelRecord record{model.info->name,
                       r.content_hash,
                       std::string(to_string(r.kind)),
                       r.report.precision,
                       model.info->source,
                       model.info->licence,
                       model.info->note,
                       "",
                       r.elements,
                       r.vertices,
                       r.report.unreferenced.value_or(-1),
                       r.diagonal,
                       r.longest_side,
                       no_box,
                       model.info->path,
                       r.file_sha256};
    const std::optional<Shape>& written = model.info->written;
    if (const auto* surface = written ? std::get_if<AlgebraicSurface>(&*written) : nullptr) {
        record.polynomial = surface->polynomial;
        for (std::size_t i = 0; i < 6; ++i) record.box[i] = surface->box(Eigen::Index(i % 2), Eigen::Index(i / 2));
    }
    return record;
}

}  // namespace hausbench
