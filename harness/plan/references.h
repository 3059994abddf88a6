// The reference answers of an experiment: one certified answer for each scene, pose and quantity. Its tolerance is a
// hundredth of the finest one that the experiment requests on that scene, and it is not timed. The bounds of every row
// are checked against the reference answer (check/verify.h), which also shows how far they are from the true distance.
#pragma once

#include "harness/plan/plan.h"

#include <optional>

namespace hausbench {

// LedgerEntry::reason for the time that reference answers take.
inline constexpr const char* rows_are_compared = "the rows are compared with them";

// Returns the experiment that asks for the reference answers of a plan. It has the scenes of the plan and the solvers
// `scan` for two point sets, `surface_enclosure` for two surfaces and `cover` for everything else. Searches and
// penetration depths have no reference answers, because a search has too many pairs to answer them all, and no solver
// certifies a depth. Returns nothing if no answer is needed, or if the plan's experiment says `reference = false`.
std::optional<Experiment> references_of(const Plan& plan);

}  // namespace hausbench
