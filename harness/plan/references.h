// Plans the *reference answers* of an experiment: one certified, untimed answer for each scene, pose and quantity,
// against which the bounds of all rows are checked (check/verify.h). The tolerance is a hundredth of the finest
// tolerance requested on the scene, so the answers also show how far other bounds are from the true distance.
#pragma once

#include "harness/plan/plan.h"

#include <optional>

namespace hausbench {

// The reason that the ledger gives for the time spent on reference answers.
inline constexpr const char* rows_are_compared = "the rows are compared with them";

// Returns an experiment that computes the reference answers of a plan: of two point sets with the solver `scan`, of two
// algebraic surfaces with `surface_enclosure`, and of other pairs without surfaces with `cover`. Searches have none
// because they have too many pairs, and penetration depths because no solver certifies a depth. Returns nothing if no
// answer is needed, or if the experiment says `reference = false`.
std::optional<Experiment> references_of(const Plan& plan);

}  // namespace hausbench
