// The corpus: many real meshes, for experiments with each = "corpus". datasets/corpus.toml,
// beside the manifest, lists them.
#pragma once

#include "datasets/catalogue.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

struct Corpus {
    std::vector<std::string> names;  // meshes of the corpus, sorted
    std::vector<std::string> whole;  // meshes of the whole corpus, which includes `names`, sorted
    // Models that the manifest does not have, and models that the rules derive from all meshes.
    std::vector<ModelInfo> models;
};

// A model that every mesh NAME of the whole corpus has without a table, unless the manifest has a model of that name:
// NAME_half      half of its triangles, by edge collapse
// NAME_remeshed  even edges, 0.01 of its diagonal
struct CorpusRule {
    std::string ending, operation, number, note;
    double value;
};
const std::vector<CorpusRule>& corpus_rules();

// Returns the path of corpus.toml in the folder of the manifest, or an empty path if there is none.
std::filesystem::path corpus_beside(const std::filesystem::path& manifest);

// Throws InputError with file and line for an unknown key, a bad table, or a name in `manifest`
// that the manifest does not have.
Corpus read_corpus(const std::filesystem::path& file, const std::vector<ModelInfo>& manifest);

// Returns only the names, sorted, of the corpus or of the whole corpus, without checking the tables.
std::vector<std::string> corpus_names(const std::filesystem::path& file, bool whole);

}  // namespace hausbench
