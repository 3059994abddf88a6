// The reference answers of an experiment: one certified answer for each scene, pose and quantity, which is not timed, at a hundredth of the finest
// tolerance that the experiment asks for there. Every row's bounds are held against it (check/verify.h), and its true errors follow from it.
#pragma once

#include "harness/plan/plan.h"

#include <optional>

namespace hausbench {

inline constexpr const char* rows_are_held = "the rows are held against them";

// Returns the experiment that asks for the reference answers of a plan: its scenes, with `scan` for two point sets, `surface_enclosure` for
// two surfaces and `cover` for everything else. Nothing if the plan's experiment says `reference = false`, or there is nothing to ask. Searches and penetration depths have no
// reference: a search is there because its pairs are too many, and no solver certifies a depth.
std::optional<Experiment> references_of(const Plan& plan);

}  // namespace hausbench
