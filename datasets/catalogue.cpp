#include "datasets/catalogue.h"

#include "algorithms/error.h"
#include "datasets/corpus.h"
#include "datasets/derive.h"
#include "datasets/hash.h"
#include "datasets/model_table.h"
#include "datasets/separate_process.h"
#include "datasets/shape_file.h"
#include "datasets/surface_file.h"
#include "datasets/toml_reader.h"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace hausbench {

namespace {

double of_shape(const Shape& shape) { return double(points_of(shape).rows()) + double(element_count(shape)); }

// These two functions do the work of estimated_elements(), for a generated and for a derived model.
double generated(const ModelInfo& model) {
    if (model.written) return of_shape(*model.written);
    const auto number = [&](const char* name) { return model.numbers.at(name); };
    const std::string& recipe = model.recipe;
    if (recipe == "icosphere") return 30 * std::pow(4, number("level")) + 2;
    if (recipe == "cube") return 18 * number("subdivisions") * number("subdivisions") + 2;
    if (recipe == "torus") return 3 * number("rings") * number("sides");
    if (recipe == "gear") return 6 * number("teeth") * number("steps") * (number("rings") + number("layers"));
    if (recipe == "plane") return 3 * (number("n") + 1) * (number("n") + 1);
    if (recipe == "needle") return 4;
    if (recipe == "fan") return 2 * number("triangles") + 1;
    const auto clusters = model.numbers.find("clusters");
    return 2 * number("count") + (clusters == model.numbers.end() ? 0 : clusters->second);
}

double derived(const ModelInfo& model, double origin) {
    const auto number = [&](const char* name) { return model.numbers.at(name); };
    const std::string& operation = model.recipe;
    // Let a mesh have V vertices and T triangles. It has at most 3 * T edges, so one level adds at most 3 * T vertices
    // and makes 4 * T triangles. n levels make 4^n * T triangles and at most V + 4^n * T vertices, because
    // 3 * T * (1 + 4 + ... + 4^(n-1)) < 4^n * T.
    if (operation == "subdivide") return 2 * std::pow(4, number("levels")) * origin;
    if (operation == "repeat") return number("count") * origin;
    if (operation == "sample") return 2 * number("count");
    if (operation == "triangulate") return 36 * number("cells") * number("cells");
    if (operation == "remesh") return 10 / (number("edge") * number("edge"));
    return 2 * origin + 4;  // two_clusters doubles the shape; all others add at most a triangle and its vertices
}

// Estimates the number of points plus triangles of a model. `origin` is the same number for the model that it is
// derived from, or the number of bytes of the file that it is read from. The estimate is an upper bound, except for the
// operations `triangulate` and `remesh`, whose results depend on the shape.
double estimated_elements(const ModelInfo& model, double origin) {
    if (model.source == "generated") return generated(model);
    if (model.source == "derived") return derived(model, origin);
    return origin / 4;  // the densest format takes four bytes for each point or triangle
}

constexpr int most_derivations = 100;  // limit on the length of a chain of models, each derived from the next

// Part of every key of the shape cache. Increase it whenever a reader, a recipe or an operation changes its output.
constexpr std::string_view shapes_version = "3";

std::string key_of(const ModelInfo& model, const std::string& input) {
    Sha256 hash;
    hash.add("shape").add(shapes_version).add(model.source).add(model.recipe).add(model.format).add(input);
    for (const auto& [name, value] : model.numbers) hash.add(name).add(fmt::format("{:a}", value));
    if (model.written) {
        const auto* surface = std::get_if<AlgebraicSurface>(&*model.written);
        hash.add(surface ? describe(*surface) : content_hash(*model.written));
    }
    return hash.hex();
}

// Reads a shape from the cache. Returns nothing if it is not there, or cannot be used.
std::optional<LoadedShape> cached(const std::filesystem::path& shape_file, const std::string& key) {
    std::error_code gone;
    if (!std::filesystem::is_regular_file(shape_file, gone)) return std::nullopt;
    try {
        return read_shape(shape_file, key);
    } catch (const InputError&) {
        return std::nullopt;
    }
}

// Renames a folder that has the name of a shape, because a file cannot replace it.
void move_folder_away(const std::filesystem::path& shape_file) {
    std::error_code error;
    if (!std::filesystem::is_directory(std::filesystem::symlink_status(shape_file, error))) return;
    std::filesystem::path away = shape_file;
    away += fmt::format(".{}.folder", ::getpid());
    std::filesystem::rename(shape_file, away, error);
    if (error)
        throw InputError(fmt::format("{}: is a folder in the place of a shape and cannot be renamed ({}): move it away",
                                     shape_file.string(), error.message()));
}

}  // namespace

Catalogue::Catalogue(const std::filesystem::path& manifest, std::filesystem::path cache, std::filesystem::path program)
    : cache_(std::move(cache)), program_(std::move(program)) {
    if (manifest.empty()) return;
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(manifest, ignored))
        throw InputError(manifest.string() + ": cannot be opened: set HAUSBENCH_ROOT to the checkout");
    const toml::table root = parse_toml(manifest);
    const TomlReader reader(manifest, root);
    reader.allow({"model"});
    reader.refuse_other_keys();
    add(manifest, read_models(reader, ModelsOf::manifest));
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
            throw InputError(one_line(fmt::format(
                "{}: model '{}' is also in datasets/manifest.toml or in another scene: give it another name (a shape "
                "described in a scene has the scene's name, with '_' for characters other than letters and digits)",
                file.string(), model.name)));
        index_[model.name] = models_.size();
        models_.push_back(std::move(model));
    }
    for (const ModelInfo& model : models_) {
        std::set<std::string> seen;
        for (const ModelInfo* at = &model; at->source == "derived";) {
            if (!seen.insert(at->name).second)
                throw InputError(
                    one_line(fmt::format("{}: model '{}' is derived from itself", file.string(), at->name)));
            const auto origin = index_.find(at->from);
            if (origin == index_.end())
                throw InputError(
                    one_line(fmt::format("{}: model '{}' is derived from '{}', which does not exist{}", file.string(),
                                         at->name, at->from, nearest_hint(at->from, names_of(models_)))));
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
    if (!apart_.empty()) return;
    std::error_code error;
    std::filesystem::create_directories(cache_ / "shapes", error);
    if (error)
        throw InputError(fmt::format("{}: cannot be made ({}): name another folder with HAUSBENCH_CACHE",
                                     (cache_ / "shapes").string(), error.message()));
}

void Catalogue::keep_apart(std::filesystem::path folder, double most_bytes) {
    apart_ = std::move(folder);
    most_bytes_ = most_bytes;
}

// Returns where a new shape is written: in the cache, or in the folder of keep_apart() if that was called.
std::filesystem::path Catalogue::new_shape_file(const std::string& key) const {
    return (apart_.empty() ? cache_ / "shapes" : apart_) / (key + ".h5");
}

void Catalogue::expect_room(const ModelInfo& model, const Input& input) const {
    if (apart_.empty()) return;
    constexpr double bytes_an_element = 24;  // three coordinates of a point; a triangle's three indices take half
    const double bytes = bytes_an_element * estimated_elements(model, input.size);
    double taken = 0;
    for (const auto& file : std::filesystem::directory_iterator(apart_)) taken += double(file.file_size());
    if (bytes + taken <= most_bytes_) return;
    throw InputError(
        fmt::format("model '{}' would take about {:.3g} MB, and the models of this file more than {:.3g} MB together: "
                    "if you trust the file, make them first with `hausbench explain` of its experiment",
                    model.name, bytes / 1e6, most_bytes_ / 1e6));
}

std::variant<Catalogue::Input, MissingModel> Catalogue::input_of(const ModelInfo& model) const {
    if (model.source == "generated") return Input{};
    if (model.source == "derived") {
        const auto origin = resolve(model.from);
        if (const auto* missing = std::get_if<MissingModel>(&origin))
            return MissingModel{fmt::format("its origin '{}' is missing: {}", model.from, missing->reason)};
        const auto& shape = std::get<ResolvedModel>(origin);
        return Input{shape.shape_file, "", shape.content_hash, double(shape.elements) + double(shape.vertices)};
    }
    const bool local = model.source == "file";
    const std::filesystem::path path(model.path);
    const std::filesystem::path file = local ? model.folder / path : cache_ / "raw" / model.sha256 / path.filename();
    if (!std::filesystem::exists(file))
        return MissingModel{local ? fmt::format("file {} does not exist", file.string())
                                  : fmt::format("package {} was not fetched: run `hausbench fetch{}`", model.package,
                                                model.of_corpus ? " --corpus" : "")};
    if (!std::filesystem::is_regular_file(file))
        throw InputError(fmt::format("model '{}': {} is not a regular file: name a file that holds a shape", model.name,
                                     file.string()));
    if (std::filesystem::file_size(file) == 0)  // also true for files in /proc, some of which never end
        throw InputError(
            fmt::format("model '{}': {} is empty: name a file that holds a shape", model.name, file.string()));
    const std::string sha256 = sha256_of_file(file);
    if (!model.sha256.empty() && sha256 != model.sha256)
        throw InputError(
            fmt::format("model '{}': {} has SHA-256 {}, the {} says {}: {}", model.name, file.string(), sha256,
                        local ? "model's table" : "manifest", model.sha256,
                        local ? "put the right file there, or correct sha256" : "delete it and fetch it again"));
    return Input{file, sha256, sha256 + file.filename().string(),  // the extension chooses the reader
                 double(std::filesystem::file_size(file))};
}

LoadedShape Catalogue::made(const ModelInfo& model, const Input& input) const {
    if (const auto* mesh = model.written ? std::get_if<TriangleMesh>(&*model.written) : nullptr) {
        LoadReport report{"generated"};
        // Unused vertices are dropped, as they are from files.
        TriangleMesh used = without_unused(mesh->vertices, mesh->triangles);
        report.unreferenced = mesh->vertices.rows() - used.vertices.rows();
        return {std::move(used), report};
    }
    if (model.source == "generated")
        return {model.written ? *model.written : generate(model.recipe, model.numbers), {"generated"}};
    if (model.source != "derived") return load_separately(program_, input.file, {.format = model.format}, waiting_);
    if (made_in_a_process(model.recipe) && !program_.empty())
        return derive_separately(program_, model.recipe, model.numbers, input.file, waiting_);
    return derive(model.recipe, model.numbers, read_shape(input.file));
}

std::variant<ResolvedModel, MissingModel> Catalogue::resolve(const std::string& name) const {
    const ModelInfo& model = find(name);
    int steps = 0;
    for (const ModelInfo* ancestor = &model; ancestor->source == "derived"; ancestor = &find(ancestor->from)) {
        if (++steps > most_derivations)
            throw InputError(fmt::format("model '{}': is derived through more than {} models: shorten the chain", name,
                                         most_derivations));
    }
    const auto source = input_of(model);
    if (const auto* missing = std::get_if<MissingModel>(&source)) return *missing;
    const Input& input = std::get<Input>(source);
    const std::string key = key_of(model, input.identity);
    std::filesystem::path shape_file = cache_ / "shapes" / (key + ".h5");
    std::optional<LoadedShape> loaded = cached(shape_file, key);
    if (!loaded && !apart_.empty()) loaded = cached(shape_file = new_shape_file(key), key);
    if (!loaded) {
        expect_room(model, input);
        try {
            loaded = made(model, input);
        } catch (const InputError& error) {
            throw InputError(fmt::format("model '{}': {}", name, error.what()));
        }
        const std::string problem = shape_problem(loaded->shape);
        if (!problem.empty()) throw InputError(fmt::format("model '{}': {}", name, problem));
        make_folders();
        shape_file = new_shape_file(key);
        move_folder_away(shape_file);
        write_shape(shape_file, *loaded, key);
    }
    const Points& points = points_of(loaded->shape);
    return ResolvedModel{shape_file,
                         content_hash(loaded->shape),
                         loaded->report,
                         kind_of(loaded->shape),
                         element_count(loaded->shape),
                         static_cast<Index>(points.rows()),
                         diagonal(points),
                         longest_side(points),
                         input.sha256};
}

}  // namespace hausbench
