#include "model_table.h"

#include "derive.h"
#include "error.h"
#include "generate.h"
#include "surface_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace hausbench {
namespace {

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

// Which kind it is, where an experiment does not say.
std::string kind_of_model(const toml::table& content) {
    return content.contains("path") ? "file" : content.contains("from") ? "derived" : "generated";
}

ModelInfo read_model(const std::filesystem::path& manifest, const std::string& name, const toml::table& content,
                     ModelsOf of) {
    ModelTable table(manifest, name, content);
    constexpr std::string_view allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
    if (name.empty() || name.find_first_not_of(allowed) != std::string::npos)
        throw InputError(table.where() + ": a name is made of letters, digits, '_', '.' and '-'");
    ModelInfo model;
    model.name = name;
    model.folder = manifest.parent_path();
    model.source = table.text("source", of == ModelsOf::manifest);
    if (model.source.empty()) model.source = kind_of_model(content);
    model.note = table.text("note", false);
    model.licence = table.text("licence", false);
    const bool package = model.source == "debian" || model.source == "npm";
    if (package && of == ModelsOf::experiment)
        throw InputError(fmt::format("{}: packages are fetched for datasets/manifest.toml alone: define it there",
                                     table.where("source")));
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

}  // namespace

std::vector<ModelInfo> read_models(const std::filesystem::path& file, const toml::table& root, ModelsOf of) {
    const toml::node* node = root.get("model");
    if (!node) return {};
    const auto refuse = [&](const toml::node& at, std::string_view key) {
        throw InputError(
            fmt::format("{}: line {}: '{}' is not [model.NAME]", file.string(), at.source().begin.line, key));
    };
    if (!node->is_table()) refuse(*node, "model");
    std::vector<ModelInfo> models;
    for (const auto& [key, table] : *node->as_table()) {
        if (!table.is_table()) refuse(table, key.str());
        models.push_back(read_model(file, std::string(key.str()), *table.as_table(), of));
    }
    return models;
}

}  // namespace hausbench
