// Branch and bound with a cascade of four upper bounds. Sacht, Jacobson: Cascading upper bounds for triangle soup
// Pompeiu-Hausdorff distance, SGP 2024.
//
// The search is in cascade.h, the bounds are in search/piece_bounds.h.
// - From the paper: the exact case, the bounds u1 to u4 and their order, midpoint subdivision, splitting the piece with
//   the largest upper bound first, and max_factor.
// - Ours: certified bounds, the test for triangles of B that are equally near (cascade.h), and `longest_edge`.
// - Corrections: in Eq. 8, |v2 - q3| should be |v2 - q2|; the proof of u2 should use the vertex nearest to p, not to q;
//   u4 does not divide by zero if two closest points coincide.
// - Two failures that section 5.2 of the paper reports cannot happen here: a vertex that no triangle uses does not
//   count, and rounding does not empty the queue too early.
//
// Fields: as in guthe.cpp, and "bound", the last bound computed for a piece of the triangle: 1 to 4 for u1 to u4, or 0
// if it was exact.
//
// Budget: subdivisions; in addition max_factor, as published, limits the number of triangles of A and pieces together.
// Time: O(n log m) for the vertices and O(log m) per subdivision on well-behaved data, for n triangles of A and m of B.
// Memory: O(n + m), and 152 bytes per piece in the queue.
#include "algorithms/meshes/cascade.h"

#include "algorithms/error.h"

#include <algorithm>

namespace hausbench::sacht {
namespace {

// Returns an error message if this is not a valid value of the parameter `order`. Returns an empty string if it is
// valid.
std::string problem_of_order(const std::string& order) {
    std::string digits = order;
    std::sort(digits.begin(), digits.end());
    const bool distinct = std::adjacent_find(digits.begin(), digits.end()) == digits.end();
    if (!order.empty() && distinct && order.find_first_not_of("1234") == std::string::npos) return "";
    return "is not an order of upper bounds: write some of the digits 1 to 4, each at most once, such as \"1234\" or "
           "\"23\"";
}

std::vector<PieceBound> order_of(const std::string& digits) {
    std::vector<PieceBound> order;
    for (const char digit : digits) order.push_back(static_cast<PieceBound>(digit - '0'));
    return order;
}

}  // namespace

SolverEntry solver() {
    SolverInfo info = cascade_info("sacht", "Sacht 2024", "sacht2024");
    info.parameters.push_back({.name = "order",
                               .default_value = std::string("1234"),
                               .paper_value = "1234",
                               .description = "which of the upper bounds u1 to u4 are computed, in which order",
                               .problem = problem_of_order});
    info.parameters.push_back(
        {.name = "max_factor",
         .default_value = 1e7,
         .paper_value = "1e7; 1e3 in Fig. 10",
         .description = "end with status budget at this many triangles and pieces for each triangle of A",
         .least = 1});
    return {info, [](const Options& options) {
                Cascade cascade = cascade_of(options, order_of(options.text("order")));
                cascade.max_factor = options.real("max_factor");
                return cascade_solver(std::move(cascade));
            }};
}

}  // namespace hausbench::sacht
