#include "datasets/corpus.h"

#include "algorithms/error.h"
#include "datasets/model_table.h"
#include "datasets/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace hausbench {
namespace {

// One of the two parts of corpus.toml: the corpus, and the rest of the whole corpus. A part lists its meshes under two
// keys: `models` is the key of its tables [KEY.NAME], and `manifest` the key of a list of names of manifest.toml.
struct Part {
    const char *models, *manifest;
};
constexpr Part chosen_part = {"model", "manifest"}, rest_part = {"whole", "whole_manifest"};

std::vector<std::string> of_manifest(const TomlReader& corpus, const Part& part) {
    return corpus.texts(part.manifest, "names of models");
}

std::filesystem::path beside(const std::filesystem::path& manifest, const std::string& name) {
    if (manifest.empty()) return {};
    const std::filesystem::path file = manifest.parent_path() / name;
    std::error_code ignored;
    return std::filesystem::is_regular_file(file, ignored) ? file : std::filesystem::path();
}

ModelInfo by_rule(const CorpusRule& rule, const std::string& from) {
    ModelInfo model;
    model.name = from + rule.ending;
    model.source = "derived";
    model.from = from;
    model.recipe = rule.operation;
    model.numbers[rule.number] = rule.value;
    model.note = from + rule.note;
    model.of_corpus = true;
    return model;
}

}  // namespace

const std::vector<CorpusRule>& corpus_rules() {
    static const std::vector<CorpusRule> rules = {
        {"_half", "simplify", "ratio", " with half of its triangles", 0.5},
        {"_remeshed", "remesh", "edge", " meshed again with even edges", 0.01}};
    return rules;
}

std::filesystem::path corpus_beside(const std::filesystem::path& manifest) { return beside(manifest, "corpus.toml"); }

Corpus read_corpus(const std::filesystem::path& file, const std::vector<ModelInfo>& manifest) {
    const toml::table root = parse_toml(file);
    const TomlReader reader(file, root);
    reader.allow({chosen_part.manifest, chosen_part.models, rest_part.manifest, rest_part.models});
    reader.refuse_other_keys();
    std::set<std::string> there;
    for (const ModelInfo& model : manifest) there.insert(model.name);
    Corpus corpus;
    for (const Part& part : {chosen_part, rest_part}) {
        for (ModelInfo& model : read_models(reader, ModelsOf::manifest, part.models)) {
            model.of_corpus = true;
            corpus.whole.push_back(model.name);
            corpus.models.push_back(std::move(model));
        }
        for (std::size_t i = 0; const std::string& name : of_manifest(reader, part)) {
            const toml::node& at = *reader.find(part.manifest)->as_array()->get(i++);
            if (!there.contains(name))
                reader.fail(at, fmt::format("'{}' names '{}', which datasets/manifest.toml does not have{}",
                                            part.manifest, name, nearest_hint(name, {there.begin(), there.end()})));
            corpus.whole.push_back(name);
        }
        if (corpus.names.empty()) corpus.names = corpus.whole;  // `whole` has only the first part so far
    }
    for (auto* names : {&corpus.names, &corpus.whole}) std::sort(names->begin(), names->end());
    const auto twice = std::adjacent_find(corpus.whole.begin(), corpus.whole.end());
    if (twice != corpus.whole.end()) reader.fail(fmt::format("'{}' is listed twice: remove one", *twice));
    for (const std::string& name : corpus.whole)
        for (const CorpusRule& rule : corpus_rules())
            if (!there.contains(name + rule.ending)) corpus.models.push_back(by_rule(rule, name));
    return corpus;
}

std::vector<std::string> corpus_names(const std::filesystem::path& file, bool whole) {
    const toml::table root = parse_toml(file);
    std::vector<std::string> names;
    for (const Part& part : whole ? std::vector{chosen_part, rest_part} : std::vector{chosen_part}) {
        for (const std::string& name : of_manifest(TomlReader(file, root), part)) names.push_back(name);
        if (const toml::table* models = root[part.models].as_table())
            for (const auto& [key, table] : *models) names.emplace_back(key.str());
    }
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace hausbench
