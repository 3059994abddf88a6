// Estimates how large a model becomes before it is made.
#pragma once

#include "datasets/catalogue.h"

namespace hausbench {

// Estimates how many points and triangles together the model has, given those of its origin (of a file: its bytes). An upper bound,
// except for `triangulate` and `remesh`, whose size depends on the shape.
double estimated_elements(const ModelInfo& model, double origin);

}  // namespace hausbench
