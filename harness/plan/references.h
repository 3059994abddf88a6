// The reference answers of an experiment: one certified answer for each scene, pose and quantity, not timed, with a
// hundredth of the finest tolerance that the experiment requests there. The bounds of every row are checked against
// it (check/verify.h), and the true errors of the row follow from it.
#pragma once

#include "harness/plan/plan.h"

#include <optional>

namespace hausbench {

inline constexpr const char* rows_are_compared = "the rows are compared with them";

// Returns the experiment that asks for the reference answers of a plan: its scenes, with `scan` for two point sets,
// `surface_enclosure` for two surfaces and `cover` for everything else. Returns nothing if the plan's experiment says
// `reference = false`, or if there is nothing to ask. Searches and penetration depths have no reference: a search has
// too many pairs to answer each, and no solver certifies a depth.
std::optional<Experiment> references_of(const Plan& plan);

}  // namespace hausbench
