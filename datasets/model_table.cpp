#include "datasets/model_table.h"

#include "algorithms/error.h"
#include "datasets/derive.h"
#include "datasets/generate.h"
#include "datasets/surface_file.h"

#include <fmt/format.h>

#include <cmath>
#include <type_traits>
#include <utility>

namespace hausbench {
namespace {

// Returns the source of a model of an experiment if its table has no key `source`.
std::string kind_of_model(const toml::table& content) {
    return content.contains("path") ? "file" : content.contains("from") ? "derived" : "generated";
}

// Reads one [model.NAME] table.
class ModelTable {
public:
    ModelTable(const TomlReader& in, const std::string& name, const toml::table& content, const std::string& from)
        : content_(content), table_(in.file(), content, fmt::format("model '{}'", name)) {
        if (in.filling()) table_.fill(*in.filling());
        model_.name = name;
        model_.from = from;
        model_.folder = in.file().parent_path();
    }

    ModelInfo read(ModelsOf of) {
        const std::string& source = model_.source;
        constexpr std::string_view allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
        if (model_.name.empty() || model_.name.find_first_not_of(allowed) != std::string::npos)
            table_.fail(fmt::format("model '{}': a name is made of letters, digits, '_', '.' and '-'", model_.name));
        model_.source = !model_.from.empty()       ? "derived"
                        : of == ModelsOf::manifest ? required("source")
                                                   : table_.text("source", kind_of_model(content_));
        model_.note = table_.text("note", "");
        model_.licence = table_.text("licence", "");
        const bool package = source == "debian" || source == "npm";
        if (package && of == ModelsOf::experiment)
            table_.fail(*content_.get("source"),
                        "packages are fetched for datasets/manifest.toml alone: define it there");
        if (package || source == "file")
            read_file(package);
        else if (source == "generated")
            read_generated();
        else if (source == "derived")
            read_derived();
        else
            table_.fail(*content_.get("source"),
                        fmt::format("unknown source '{}' of model '{}'{}", source, model_.name,
                                    nearest_hint(source, {"debian", "npm", "file", "generated", "derived"})));
        table_.refuse_other_keys();
        return model_;
    }

private:
    std::string required(const char* key) const {
        const std::string text = table_.text(key, "");
        if (text.empty()) table_.fail(fmt::format("model '{}' has no '{}'", model_.name, key));
        return text;
    }

    void read_file(bool package) {
        if (package) {
            model_.package = required("package");
            model_.version = required("version");
        }
        model_.path = required("path");
        model_.sha256 = package ? required("sha256") : table_.text("sha256", "");
        model_.format = table_.text("format", "");
        table_.allow({"triangles"});  // not used; for human readers of the manifest
        if (!model_.sha256.empty() &&
            (model_.sha256.size() != 64 || model_.sha256.find_first_not_of("0123456789abcdef") != std::string::npos))
            table_.fail(*content_.get("sha256"), "sha256 must be 64 digits of 0-9 and a-f");
    }

    void read_generated() {
        if (content_.contains("vertices") || content_.contains("points")) return read_listed();
        model_.recipe = required("recipe");
        if (model_.recipe == "surface")
            model_.written = read_surface(table_);
        else
            check_numbers(where(content_), read_numbers("recipe", recipes()), model_.numbers);
    }

    // Reads `vertices` and `triangles`, or `points`.
    void read_listed() {
        model_.recipe = "listed";
        if (!content_.contains("vertices")) {
            model_.written = PointSet{rows<double>("points")};
            return;
        }
        TriangleMesh mesh{rows<double>("vertices"), rows<Index>("triangles")};
        if (mesh.triangles.size() > 0 && mesh.triangles.maxCoeff() >= mesh.vertices.rows())
            table_.fail(*content_.get("triangles"),
                        fmt::format("'triangles' names vertex {}, but there are {}: they are counted from 0",
                                    mesh.triangles.maxCoeff(), mesh.vertices.rows()));
        model_.written = std::move(mesh);
    }

    template <class T> Eigen::Matrix<T, Eigen::Dynamic, 3, Eigen::RowMajor> rows(const char* key) const {
        const toml::array* list = table_.required(key).as_array();
        const auto expect = [&](const toml::node& node, bool good) {
            const char* of = std::is_same_v<T, Index> ? "numbers of vertices, from 0" : "coordinates";
            if (!good) table_.fail(node, fmt::format("'{}' must be a list of three {} each", key, of));
        };
        expect(table_.required(key), list);
        Eigen::Matrix<T, Eigen::Dynamic, 3, Eigen::RowMajor> all(Eigen::Index(list->size()), 3);
        for (std::size_t i = 0; i < list->size(); ++i) {
            const toml::array* row = list->get(i)->as_array();
            expect(*list->get(i), row && row->size() == 3);
            for (std::size_t k = 0; k < 3; ++k) {
                const double value = table_.number(*row->get(k), key);
                if constexpr (std::is_same_v<T, Index>)
                    expect(*row->get(k), value >= 0 && value <= 0x7fffffff && value == std::floor(value));
                all(Eigen::Index(i), Eigen::Index(k)) = T(value);
            }
        }
        return all;
    }

    void read_derived() {
        if (model_.from.empty()) model_.from = required("from");
        model_.recipe = required("operation");
        check_operation(where(content_), read_numbers("operation", operations()), model_.numbers);
    }

    // Returns the recipe or operation with the name model_.recipe, after reading its numbers into model_.numbers.
    const Recipe& read_numbers(const char* key, const std::vector<Recipe>& recipes) {
        const std::string what = fmt::format("{}: unknown {}", where(*content_.get(key)), key);
        const Recipe& recipe = find_recipe(recipes, model_.recipe, what);
        for (const NumberSpec& spec : recipe.numbers)
            if (const toml::node* node = table_.find(spec.name))
                model_.numbers[spec.name] = table_.number(*node, spec.name);
        table_.refuse_other_keys();
        return recipe;
    }

    std::string where(const toml::node& node) const {
        return fmt::format("{}: model '{}'", table_.where(node), model_.name);
    }

    const toml::table& content_;
    TomlReader table_;
    ModelInfo model_;
};

}  // namespace

ModelInfo read_model(const TomlReader& in, const std::string& name, const toml::table& table, ModelsOf of,
                     const std::string& from) {
    return ModelTable(in, name, table, from).read(of);
}

std::vector<ModelInfo> read_models(const TomlReader& root, ModelsOf of, const std::string& group) {
    const toml::node* models = root.find(group);
    if (!models) return {};
    if (!models->is_table()) root.fail(*models, fmt::format("'{0}' is not [{0}.NAME]", group));
    std::vector<ModelInfo> read;
    for (const auto& [key, table] : *models->as_table()) {
        if (!table.is_table()) root.fail(table, fmt::format("'{}' is not [{}.NAME]", key.str(), group));
        read.push_back(read_model(root, std::string(key.str()), *table.as_table(), of));
    }
    return read;
}

}  // namespace hausbench
