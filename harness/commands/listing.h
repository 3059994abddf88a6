// `hausbench list`: solvers, experiments and models; one screen for people, everything as JSON for programs.
#pragma once

#include "harness/commands/text_table.h"

#include <nlohmann/json.hpp>

#include <string>

namespace hausbench {

// Outside a project there are solvers, the models that were installed with the program, and no experiments.
nlohmann::json list_as_json();

// `what` is empty (a line for each solver), "solvers", "models", "corpus" or "experiments", or the name of
// one of these: all that is known of it.
// Throws InputError for another name.
std::string list_as_text(const std::string& what, const Paper& paper);

}  // namespace hausbench
