// Meshes for benchmarks: models of datasets/manifest.toml, and a generated one.
#pragma once

#include "algorithms/scene.h"

#include <string>

namespace hausbench {

// Returns a mesh by its name in the manifest. `make datasets` fetches the models. Throws
// InputError if the model is missing or not a mesh.
TriangleMesh model_mesh(const std::string& name);

// Returns a torus of 2 * n^2 triangles without reading a file. Each coordinate of each vertex is moved at random by up
// to 0.04 / n, which is about 4 % of the shortest edges.
TriangleMesh bumpy_torus(Index n);

}  // namespace hausbench
