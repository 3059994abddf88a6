// Models that an experiment brings along: [model.NAME] tables, and files that its scenes name in the place of a model.
//
// In `source`, `target`, `sources` and `targets`, a text is the name of a model if there is such a model. Otherwise it is the path of a
// file if it has a '/' or an extension that is read (names_a_file), relative to the experiment's folder; the path as written is then the
// model's name.
#pragma once

#include "harness/plan/experiment.h"
#include "harness/result/result_file.h"

namespace hausbench {

// Adds them to the models of the manifest. Throws InputError with the experiment's file and line for a name that is neither, with the
// nearest name, and for a file that does not exist.
void add_own_models(Catalogue& catalogue, const Experiment& experiment);

// Those of a result, by what it recorded of its experiment; a file that is gone is found missing by Catalogue::resolve.
void add_own_models(Catalogue& catalogue, const ResultFile& result);

}  // namespace hausbench
