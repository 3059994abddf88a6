#include "algorithms/search/cut_options.h"

namespace hausbench {

ParameterSpec split_parameter() {
    return {.name = "split",
            .default_value = std::string("midpoint"),
            .paper_value = "midpoint",
            .description =
                "how a piece of A is cut: into four at the midpoints of its edges, or into two at the midpoint of the "
                "longest edge (for needles)",
            .choices = {"midpoint", "longest_edge"}};
}

Split split_of(const Options& options) {
    return options.text("split") == "longest_edge" ? Split::longest_edge : Split::midpoint;
}

std::vector<ParameterSpec> cutting_parameters() {
    return {
        {.name = "split",
         .default_value = std::string("voronoi"),
         .paper_value = "voronoi",
         .description =
             "how a piece of A is cut: into four, where its edges are equally far from two triangles of B (voronoi) or "
             "at their midpoints; or into two at the midpoint of the longest edge (for needles)",
         .choices = {"voronoi", "midpoint", "longest_edge"}},
        {.name = "least_part",
         .default_value = 0.05,
         .unit = "edges",
         .description = "a Voronoi cut leaves at least this part of an edge on either side",
         .least = 0.01,
         .most = 0.5},
    };
}

Cutting cutting_of(const Options& options) {
    const std::string split = options.text("split");
    return split == "voronoi" ? Cutting::voronoi : split == "midpoint" ? Cutting::midpoint : Cutting::longest_edge;
}

}  // namespace hausbench
