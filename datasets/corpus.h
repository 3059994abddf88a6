// The corpus: hundreds of real meshes, for experiments with each = "corpus". The whole corpus (each = "whole_corpus")
// contains them and also the smaller, larger and broken meshes of the same packages. Both are listed in
// datasets/corpus.toml, beside the manifest.
#pragma once

#include "datasets/catalogue.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

struct Corpus {
    std::vector<std::string> names;  // meshes of the corpus, sorted
    std::vector<std::string> whole;  // meshes of the whole corpus, sorted; includes `names`
    // The models that corpus.toml adds to the manifest: its tables, and the models derived from all meshes by the
    // rules.
    std::vector<ModelInfo> models;
};

// A rule that derives a model from every mesh NAME of the whole corpus, so that the model needs no table:
// NAME_half      half of its triangles, by edge collapse
// NAME_remeshed  edges of even length, 0.01 of its diagonal
// A model of the manifest with the same name takes precedence.
struct CorpusRule {
    std::string ending, operation, number, note;  // "_half", "simplify", "ratio", ...
    double value;                                 // of the number of that name
};
const std::vector<CorpusRule>& corpus_rules();

// Returns the path of corpus.toml in the folder of the manifest, or an empty path if there is none.
std::filesystem::path corpus_beside(const std::filesystem::path& manifest);

// Reads corpus.toml; `manifest` has the models of the manifest. Throws InputError, with file and line, for an unknown
// key, a bad table, a mesh that is listed twice, or a mesh that should be in the manifest but is not.
Corpus read_corpus(const std::filesystem::path& file, const std::vector<ModelInfo>& manifest);

// Returns the sorted names of the meshes of the corpus, or of the whole corpus. Does not check their tables.
std::vector<std::string> corpus_names(const std::filesystem::path& file, bool whole);

}  // namespace hausbench
