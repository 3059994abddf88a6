// Models that an experiment brings along: [model.NAME] tables, and files that its scenes name in place of a model.
//
// A string in `source`, `target`, `sources` or `targets` is the name of a model if such a model exists. Otherwise it
// is the path of a file, relative to the experiment's folder, if it contains a '/' or has an extension that can be
// read (names_a_file); the path as written is then the model's name.
#pragma once

#include "harness/plan/experiment.h"
#include "harness/result/result_file.h"

namespace hausbench {

// Adds the experiment's models to the catalogue. Throws InputError, with the experiment's file and the line, for a file
// that does not exist, and for a name that is neither a model nor a file; the message suggests the nearest name.
void add_own_models(Catalogue& catalogue, const Experiment& experiment);

// Adds the models of a result, as recorded in it. A file that no longer exists is reported by Catalogue::resolve.
void add_own_models(Catalogue& catalogue, const ResultFile& result);

}  // namespace hausbench
