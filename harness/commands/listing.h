// `hausbench list`: solvers, experiments and models; one screen for people, everything as JSON for programs.
#pragma once

#include "commands/text_table.h"

#include <nlohmann/json.hpp>

#include <string>

namespace hausbench {

// Outside a project there are solvers, the models that were installed with the program, and no experiments.
// `what`: as below; the models of a tier are there only where it asks for them.
nlohmann::json list_as_json(const std::string& what = "");

// `what` is empty (a line for each solver), "solvers", "models", "corpus", "kicad" (a tier of the corpus) or "experiments", or the name of
// one of these: all that is known of it.
// Throws InputError for another name.
std::string list_as_text(const std::string& what, const Paper& paper);

}  // namespace hausbench
