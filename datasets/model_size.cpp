#include "datasets/model_size.h"

#include <algorithm>
#include <cmath>

namespace hausbench {
namespace {

double of_shape(const Shape& shape) { return double(points_of(shape).rows()) + double(element_count(shape)); }

double generated(const ModelInfo& model) {
    if (model.written) return of_shape(*model.written);
    const auto number = [&](const char* name) { return model.numbers.at(name); };
    const std::string& recipe = model.recipe;
    if (recipe == "icosphere") return 30 * std::pow(4, number("level")) + 2;
    if (recipe == "cube") return 18 * number("subdivisions") * number("subdivisions") + 2;
    if (recipe == "torus") return 3 * number("rings") * number("sides");
    if (recipe == "gear") return 6 * number("teeth") * number("steps") * (number("rings") + number("layers"));
    if (recipe == "plane") return 3 * (number("n") + 1) * (number("n") + 1);
    if (recipe == "needle") return 4;
    if (recipe == "fan") return 2 * number("triangles") + 1;
    const auto clusters = model.numbers.find("clusters");
    return 2 * number("count") + (clusters == model.numbers.end() ? 0 : clusters->second);
}

double derived(const ModelInfo& model, double origin) {
    const auto number = [&](const char* name) { return model.numbers.at(name); };
    const std::string& operation = model.recipe;
    // From V vertices and T triangles, 4^n T triangles and at most V + 4^n T vertices: a mesh has at most 3 T edges to split.
    if (operation == "subdivide") return 2 * std::pow(4, number("levels")) * origin;
    if (operation == "repeat") return number("count") * origin;
    if (operation == "sample") return 2 * number("count");
    if (operation == "triangulate") return 36 * number("cells") * number("cells");
    if (operation == "remesh") return 10 / (number("edge") * number("edge"));
    return 2 * origin + 4;  // two_clusters; the others add an element at most
}

}  // namespace

double estimated_elements(const ModelInfo& model, double origin) {
    if (model.source == "generated") return generated(model);
    if (model.source == "derived") return derived(model, origin);
    return origin / 4;  // a file in the densest format has four bytes for each
}

}  // namespace hausbench
