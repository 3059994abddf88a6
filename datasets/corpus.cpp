#include "corpus.h"

#include "error.h"
#include "model_table.h"
#include "toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

namespace hausbench {
namespace {

// Of the corpus, and of the whole corpus besides: the tables, and the list of models of manifest.toml.
struct Part {
    const char *models, *manifest;
};
constexpr Part chosen = {"model", "manifest"}, rest = {"whole", "whole_manifest"};

std::vector<std::string> of_manifest(const TomlReader& corpus, const Part& part) {
    return corpus.texts(part.manifest, "names of models");
}

std::filesystem::path beside(const std::filesystem::path& manifest, const std::string& name) {
    if (manifest.empty()) return {};
    const std::filesystem::path file = manifest.parent_path() / name;
    std::error_code ignored;
    return std::filesystem::is_regular_file(file, ignored) ? file : std::filesystem::path();
}

// The name of the model, as datasets/fetch.py makes it: the file's, without its extension, of what names are made of.
std::string model_of_tier(const std::string& tier, std::string_view file) {
    file.remove_prefix(file.rfind('/') + 1);
    std::string name = tier + "_" + std::string(file.substr(0, file.rfind('.')));
    const auto is_of_names = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '.' || c == '-'; };
    std::replace_if(
        name.begin(), name.end(), [&](char c) { return !is_of_names(static_cast<unsigned char>(c)); }, '_');
    return name;
}

// "SHA-256 TRIANGLES FILE"; a file's name may hold blanks. No file: it is no such line.
struct TierLine {
    std::string_view sha256, file;

    explicit TierLine(std::string_view line) {
        const std::size_t triangles = line.find(' '), path = line.find(' ', triangles + 1);
        sha256 = line.substr(0, triangles);
        if (path != std::string_view::npos) file = line.substr(path + 1);
    }
};

// The lines of a tier's list, one for each mesh.
std::vector<std::string_view> lines_of(const TomlReader& tier) {
    const auto* text = tier.required("meshes").as_string();
    if (!text) tier.fail(tier.required("meshes"), "'meshes' must be a text with a line for each mesh");
    std::vector<std::string_view> lines;
    for (std::string_view left = text->get(); !left.empty();) {
        const std::string_view line = left.substr(0, left.find('\n'));
        left.remove_prefix(std::min(line.size() + 1, left.size()));
        if (!line.empty()) lines.push_back(line);
    }
    return lines;
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
    reader.allow({chosen.manifest, chosen.models, rest.manifest, rest.models});
    reader.refuse_other_keys();
    std::set<std::string> there;
    for (const ModelInfo& model : manifest) there.insert(model.name);
    Corpus corpus;
    for (const Part& part : {chosen, rest}) {
        for (ModelInfo& model : read_models(file, root, ModelsOf::manifest, part.models)) {
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
        if (corpus.names.empty()) corpus.names = corpus.whole;  // the first part
    }
    for (auto* names : {&corpus.names, &corpus.whole}) std::sort(names->begin(), names->end());
    const auto twice = std::adjacent_find(corpus.whole.begin(), corpus.whole.end());
    if (twice != corpus.whole.end()) reader.fail(fmt::format("'{}' is listed twice: remove one", *twice));
    for (const std::string& name : corpus.whole)
        for (const CorpusRule& rule : corpus_rules())
            if (!there.contains(name + rule.ending)) corpus.models.push_back(by_rule(rule, name));
    return corpus;
}

const std::vector<std::string>& tiers() {
    static const std::vector<std::string> all = {"kicad"};
    return all;
}

std::filesystem::path tier_beside(const std::filesystem::path& manifest, const std::string& tier) {
    return tier.empty() ? std::filesystem::path() : beside(manifest, tier + ".toml");
}

std::string tier_of(const std::string& model) {
    for (const std::string& tier : tiers())
        if (model.starts_with(tier + "_")) return tier;
    return "";
}

void add_tier_of(const std::string& model, const std::filesystem::path& manifest, Catalogue& catalogue) {
    const std::filesystem::path file = tier_beside(manifest, tier_of(model));
    if (file.empty() || catalogue.has(model)) return;
    std::vector<ModelInfo> models = read_tier(file);
    if (!models.empty() && !catalogue.has(models.front().name)) catalogue.add(file, std::move(models));
}

std::vector<std::string> tier_names(const std::filesystem::path& file) {
    const toml::table root = parse_toml(file);
    const std::string tier = file.stem().string();
    std::vector<std::string> names;
    for (const std::string_view line : lines_of(TomlReader(file, root)))
        names.push_back(model_of_tier(tier, TierLine(line).file));
    std::sort(names.begin(), names.end());
    return names;
}

std::vector<ModelInfo> read_tier(const std::filesystem::path& file) {
    const toml::table root = parse_toml(file);
    const TomlReader reader(file, root);
    const std::string tier = file.stem().string();
    ModelInfo common;
    common.source = "debian";
    common.package = reader.text("package");
    common.version = reader.text("version");
    common.licence = reader.text("licence");
    common.of_corpus = true;
    const std::string folder = reader.text("folder");
    const auto lines = lines_of(reader);
    reader.refuse_other_keys();
    std::vector<ModelInfo> models;
    std::set<std::string> names;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const TierLine line(lines[i]);
        ModelInfo& model = models.emplace_back(common);
        model.sha256 = line.sha256;
        if (line.file.empty() || model.sha256.size() != 64 ||
            model.sha256.find_first_not_of("0123456789abcdef") != std::string::npos)
            reader.fail(*reader.find("meshes"),
                        fmt::format("mesh {} of 'meshes' is not \"SHA-256 TRIANGLES FILE\"", i + 1));
        model.path = folder + std::string(line.file);
        model.name = model_of_tier(tier, line.file);
        model.note = line.file;
        if (!names.insert(model.name).second)
            reader.fail(*reader.find("meshes"), fmt::format("'{}' is listed twice: remove one", model.name));
    }
    for (const std::string& name : names)
        for (const CorpusRule& rule : corpus_rules())
            if (!names.contains(name + rule.ending)) models.push_back(by_rule(rule, name));
    return models;
}

std::vector<std::string> corpus_names(const std::filesystem::path& file, bool whole) {
    const toml::table root = parse_toml(file);
    std::vector<std::string> names;
    for (const Part& part : whole ? std::vector{chosen, rest} : std::vector{chosen}) {
        for (const std::string& name : of_manifest(TomlReader(file, root), part)) names.push_back(name);
        if (const toml::table* models = root[part.models].as_table())
            for (const auto& [key, table] : *models) names.emplace_back(key.str());
    }
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace hausbench
