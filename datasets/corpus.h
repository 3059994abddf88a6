// The corpus: many real meshes, for experiments with each = "corpus". datasets/corpus.toml, beside the manifest, lists them.
#pragma once

#include "datasets/catalogue.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

struct Corpus {
    std::vector<std::string> names;  // meshes of the corpus, sorted
    std::vector<std::string> whole;  // meshes of the whole corpus, `names` included, sorted
    // Models that the manifest does not have, and the models that the rules derive from all.
    std::vector<ModelInfo> models;
};

// What every mesh NAME of the whole corpus has without a table of its own, unless the manifest has a model of that name:
// NAME_half      half of its triangles, by edge collapse
// NAME_remeshed  even edges, 0.01 of its diagonal
struct CorpusRule {
    std::string ending, operation, number, note;
    double value;
};
const std::vector<CorpusRule>& corpus_rules();

// The corpus.toml in the folder of the manifest; empty if there is none.
std::filesystem::path corpus_beside(const std::filesystem::path& manifest);

// Throws InputError with file and line for an unknown key, a name in `manifest` that the manifest does not have, a bad table.
Corpus read_corpus(const std::filesystem::path& file, const std::vector<ModelInfo>& manifest);

// Names alone, sorted, of the corpus or of the whole corpus; nothing of the tables is checked.
std::vector<std::string> corpus_names(const std::filesystem::path& file, bool whole);

}  // namespace hausbench
