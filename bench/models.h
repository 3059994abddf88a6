// Meshes for benchmarks: models of datasets/manifest.toml, and one that is made on the spot.
#pragma once

#include "algorithms/scene.h"

#include <string>

namespace hausbench {

// A mesh by its name in the manifest. `make datasets` fetches what must be fetched. Throws InputError for one that is
// not there or is no mesh.
TriangleMesh model_mesh(const std::string& name);

// A bumpy torus of 2 n^2 triangles, needing no file: neighbouring vertices stand off by up to a tenth of an edge.
TriangleMesh bumpy_torus(Index n);

}  // namespace hausbench
