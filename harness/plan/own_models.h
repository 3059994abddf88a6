// Adds the models that an experiment defines itself to the catalogue: [model.NAME] tables, and files that its scenes
// name directly.
//
// A scene names its shapes by strings. If a model of that name exists, it is used. Otherwise the string is the path of
// a file, relative to the experiment's folder, if it contains a '/' or ends in an extension that can be read
// (names_a_file). The model is then named after the path as written.
#pragma once

#include "harness/plan/experiment.h"
#include "harness/result/result_file.h"

namespace hausbench {

// Adds the experiment's own models to the catalogue. Throws InputError if a file does not exist, or if a name is
// neither a model nor a file; the message suggests the nearest name.
void add_own_models(Catalogue& catalogue, const Experiment& experiment);

// Adds the own models of the experiment that a result records. Does not check whether their files still exist;
// Catalogue::resolve reports a missing file.
void add_own_models(Catalogue& catalogue, const ResultFile& result);

}  // namespace hausbench
