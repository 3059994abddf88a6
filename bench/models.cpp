#include "bench/models.h"

#include "algorithms/error.h"
#include "datasets/catalogue.h"
#include "datasets/generate.h"
#include "datasets/paths.h"
#include "datasets/random.h"
#include "datasets/shape_file.h"

#include <cstdlib>

namespace hausbench {

TriangleMesh model_mesh(const std::string& name) {
    // The catalogue starts this program to read foreign files in a separate process.
    const char* program = std::getenv("HAUSBENCH_PROGRAM");
    const Catalogue catalogue(
        project_root() / "datasets" / "manifest.toml", cache_folder(),
        program != nullptr ? std::filesystem::path(program) : program_path().parent_path() / "hausbench");
    const auto resolved = catalogue.resolve(name);
    if (const auto* missing = std::get_if<MissingModel>(&resolved)) throw InputError(name + ": " + missing->reason);
    LoadedShape loaded = read_shape(std::get<ResolvedModel>(resolved).shape_file);
    if (!std::holds_alternative<TriangleMesh>(loaded.shape))
        throw InputError(name + ": is not a mesh: name a model with triangles");
    return std::get<TriangleMesh>(std::move(loaded.shape));
}

TriangleMesh bumpy_torus(Index n) {
    TriangleMesh mesh =
        std::get<TriangleMesh>(generate("torus", {{"rings", n}, {"sides", n}, {"major", 0.4}, {"minor", 0.15}}));
    const RandomNumbers random(1);
    const double most = 0.1 * 0.4 / n;
    for (Eigen::Index i = 0; i < mesh.vertices.size(); ++i) {
        mesh.vertices.data()[i] += most * (2 * random.uniform(static_cast<std::uint64_t>(i)) - 1);
    }
    return mesh;
}

}  // namespace hausbench
