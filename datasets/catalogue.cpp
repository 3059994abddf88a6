#include "catalogue.h"

#include "corpus.h"
#include "derive.h"
#include "error.h"
#include "hash.h"
#include "isolated.h"
#include "model_table.h"
#include "shape_file.h"
#include "surface_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <set>

namespace hausbench {
namespace {

// Part of every key of the shape cache. Increase it whenever the output of a reader, a recipe or an operation
// changes.
constexpr std::string_view shapes_version = "1";

template <class List> std::vector<std::string> names_of(const List& list) {
    std::vector<std::string> names;
    for (const auto& one : list) names.push_back(one.name);
    return names;
}

std::string key_of(const ModelInfo& model, const std::string& input) {
    Sha256 hash;
    hash.add("shape").add(shapes_version).add(model.source).add(model.recipe).add(model.format).add(input);
    for (const auto& [name, value] : model.numbers) hash.add(name).add(fmt::format("{:a}", value));
    if (model.surface) hash.add(describe(*model.surface));
    return hash.hex();
}

}  // namespace

Catalogue::Catalogue(const std::filesystem::path& manifest, std::filesystem::path cache, std::filesystem::path program)
    : cache_(std::move(cache)), program_(std::move(program)) {
    if (manifest.empty()) return;
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(manifest, ignored))
        throw InputError(manifest.string() + ": cannot be opened: set HAUSBENCH_ROOT to the checkout");
    toml::table root;
    try {
        root = toml::parse_file(manifest.string());
    } catch (const toml::parse_error& error) {
        throw InputError(
            fmt::format("{}: line {}: {}", manifest.string(), error.source().begin.line, error.description()));
    }
    for (const auto& [key, node] : root)
        if (key.str() != "model" || !node.is_table())
            throw InputError(fmt::format("{}: line {}: '{}' is not [model.NAME]", manifest.string(),
                                         node.source().begin.line, key.str()));
    add(manifest, read_models(manifest, root, ModelsOf::manifest));
    const std::filesystem::path corpus_file = corpus_beside(manifest);
    if (corpus_file.empty()) return;
    Corpus corpus = read_corpus(corpus_file, models_);
    add(corpus_file, std::move(corpus.models));
    corpus_ = std::move(corpus.names);
}

void Catalogue::add(const std::filesystem::path& file, std::vector<ModelInfo> models) {
    for (ModelInfo& model : models) {
        if (has(model.name) && models_[index_[model.name]].by_rule()) {
            models_[index_[model.name]] = std::move(model);
            continue;
        }
        if (has(model.name))
            throw InputError(fmt::format("{}: model '{}' is one of datasets/manifest.toml too: give it another name",
                                         file.string(), model.name));
        index_[model.name] = models_.size();
        models_.push_back(std::move(model));
    }
    for (const ModelInfo& model : models_) {
        std::set<std::string> seen;
        for (const ModelInfo* at = &model; at->source == "derived";) {
            if (!seen.insert(at->name).second)
                throw InputError(fmt::format("{}: model '{}' is derived from itself", file.string(), at->name));
            const auto origin = index_.find(at->from);
            if (origin == index_.end())
                throw InputError(fmt::format("{}: model '{}' is derived from '{}', which does not exist{}",
                                             file.string(), at->name, at->from,
                                             nearest_hint(at->from, names_of(models_))));
            at = &models_[origin->second];
        }
    }
}

bool Catalogue::has(const std::string& name) const { return index_.contains(name); }

const ModelInfo& Catalogue::find(const std::string& name) const {
    if (const auto at = index_.find(name); at != index_.end()) return models_[at->second];
    throw InputError(fmt::format("no model '{}' in the manifest{}", name, nearest_hint(name, names_of(models_))));
}

void Catalogue::make_folders() const {
    std::error_code error;
    std::filesystem::create_directories(cache_ / "shapes", error);
    if (error)
        throw InputError(fmt::format("{}: cannot be made ({}): name another folder with HAUSBENCH_CACHE",
                                     (cache_ / "shapes").string(), error.message()));
}

std::variant<ResolvedModel, MissingModel> Catalogue::resolve(const std::string& name) const {
    const ModelInfo& model = find(name);
    std::filesystem::path file, origin_shape;
    std::string file_sha256, input;  // input: what of the key is not in the manifest's table
    if (model.source == "derived") {
        auto origin = resolve(model.from);
        if (const auto* missing = std::get_if<MissingModel>(&origin))
            return MissingModel{fmt::format("its origin '{}' is missing: {}", model.from, missing->reason)};
        input = std::get<ResolvedModel>(origin).content_hash;
        origin_shape = std::get<ResolvedModel>(origin).shape_file;
    } else if (model.source != "generated") {
        const bool local = model.source == "file";
        file = local ? model.folder / model.path
                     : cache_ / "raw" / model.sha256 / model.path.substr(model.path.rfind('/') + 1);
        if (!std::filesystem::exists(file))
            return MissingModel{local ? fmt::format("file {} does not exist", file.string())
                                      : fmt::format("package {} was not fetched: run `make datasets`", model.package)};
        input = file_sha256 = sha256_of_file(file);
        if (!model.sha256.empty() && input != model.sha256)
            throw InputError(
                fmt::format("model '{}': {} has SHA-256 {}, the {} says {}: {}", name, file.string(), input,
                            local ? "model's table" : "manifest", model.sha256,
                            local ? "put the right file there, or correct sha256" : "delete it and fetch it again"));
        input += file.filename().string();  // the extension chooses the reader
    }

    const std::filesystem::path shape_file = cache_ / "shapes" / (key_of(model, input) + ".h5");
    LoadedShape loaded;
    if (std::filesystem::exists(shape_file)) {
        loaded = read_shape(shape_file);
    } else {
        try {
            if (model.source == "derived") {
                loaded = made_in_a_process(model.recipe) && !program_.empty()
                             ? derive_isolated(program_, model.recipe, model.numbers, origin_shape)
                             : derive(model.recipe, model.numbers, read_shape(origin_shape));
            } else if (model.source == "generated") {
                loaded.shape = model.surface ? Shape(*model.surface) : generate(model.recipe, model.numbers);
                loaded.report.format = "generated";
            } else {
                loaded = load_isolated(program_, file, model.format);
            }
        } catch (const InputError& error) {
            throw InputError(fmt::format("model '{}': {}", name, error.what()));
        }
        const std::string problem = shape_problem(loaded.shape);
        if (!problem.empty()) throw InputError(fmt::format("model '{}': {}", name, problem));
        make_folders();
        write_shape(shape_file, loaded);
    }
    return ResolvedModel{shape_file,
                         content_hash(loaded.shape),
                         loaded.report,
                         kind_of(loaded.shape),
                         element_count(loaded.shape),
                         static_cast<Index>(points_of(loaded.shape).rows()),
                         diagonal(points_of(loaded.shape)),
                         longest_side(points_of(loaded.shape)),
                         file_sha256};
}

}  // namespace hausbench
