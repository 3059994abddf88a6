#include "corpus.h"

#include "error.h"
#include "model_table.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <set>

namespace hausbench {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const toml::node& at, const std::string& what) {
    throw InputError(fmt::format("{}: line {}: {}", file.string(), at.source().begin.line, what));
}

toml::table parsed(const std::filesystem::path& file) {
    try {
        return toml::parse_file(file.string());
    } catch (const toml::parse_error& error) {
        throw InputError(fmt::format("{}: line {}: {}", file.string(), error.source().begin.line, error.description()));
    }
}

struct Listed {
    std::string name;
    const toml::node* at;
};

// Of `manifest`: the models of manifest.toml that belong to the corpus.
std::vector<Listed> of_manifest(const std::filesystem::path& file, const toml::table& root) {
    std::vector<Listed> names;
    const toml::node* node = root.get("manifest");
    if (!node) return names;
    if (!node->is_array()) refuse(file, *node, "'manifest' must be a list of names of models");
    for (const toml::node& item : *node->as_array()) {
        const auto name = item.value_exact<std::string>();
        if (!name) refuse(file, item, "'manifest' must be a list of names of models");
        names.push_back({*name, &item});
    }
    return names;
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

std::filesystem::path corpus_beside(const std::filesystem::path& manifest) {
    if (manifest.empty()) return {};
    const std::filesystem::path file = manifest.parent_path() / "corpus.toml";
    std::error_code ignored;
    return std::filesystem::is_regular_file(file, ignored) ? file : std::filesystem::path();
}

Corpus read_corpus(const std::filesystem::path& file, const std::vector<ModelInfo>& manifest) {
    const toml::table root = parsed(file);
    for (const auto& [key, node] : root)
        if (key.str() != "manifest" && key.str() != "model")
            refuse(file, node,
                   fmt::format("unknown key '{}'{}", key.str(), nearest_hint(key.str(), {"manifest", "model"})));
    Corpus corpus;
    corpus.models = read_models(file, root, ModelsOf::manifest);
    for (ModelInfo& model : corpus.models) {
        model.of_corpus = true;
        corpus.names.push_back(model.name);
    }
    std::set<std::string> there;
    for (const ModelInfo& model : manifest) there.insert(model.name);
    for (const auto& [name, at] : of_manifest(file, root)) {
        if (!there.contains(name))
            refuse(file, *at,
                   fmt::format("'manifest' names '{}', which datasets/manifest.toml does not have{}", name,
                               nearest_hint(name, {there.begin(), there.end()})));
        corpus.names.push_back(name);
    }
    std::sort(corpus.names.begin(), corpus.names.end());
    const auto twice = std::adjacent_find(corpus.names.begin(), corpus.names.end());
    if (twice != corpus.names.end()) refuse(file, root, fmt::format("'{}' is listed twice: remove one", *twice));
    for (const std::string& name : corpus.names)
        for (const CorpusRule& rule : corpus_rules())
            if (!there.contains(name + rule.ending)) corpus.models.push_back(by_rule(rule, name));
    return corpus;
}

std::vector<std::string> corpus_names(const std::filesystem::path& file) {
    const toml::table root = parsed(file);
    std::vector<std::string> names;
    if (const toml::table* models = root["model"].as_table())
        for (const auto& [key, table] : *models) names.emplace_back(key.str());
    for (const Listed& one : of_manifest(file, root)) names.push_back(one.name);
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace hausbench
