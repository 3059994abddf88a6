#include "harness/plan/severity.h"

#include "datasets/model_table.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <charconv>
#include <limits>
#include <set>
#include <system_error>
#include <utility>

namespace hausbench {

namespace {

constexpr std::string_view place_of_value = "{}";

// Returns a short string that reads back as exactly this number and looks as people write it: "1e8", "0.25", "1000".
std::string text_of(double value) {
    std::array<char, 64> buffer{};
    const auto written = [&](std::chars_format format) {
        const auto end = std::to_chars(buffer.begin(), buffer.end(), value, format);
        return end.ec == std::errc() ? std::string(buffer.begin(), end.ptr) : "";  // 1e300 in full does not fit
    };
    std::string power = written(std::chars_format::scientific);
    std::size_t digits = power.find('e') + 1;
    if (power[digits] == '-') ++digits;
    while (digits + 1 < power.size() && (power[digits] == '+' || power[digits] == '0')) power.erase(digits, 1);
    const std::string plain = written(std::chars_format::fixed);
    return plain.empty() || power.size() + 2 <= plain.size() ? power : plain;
}

// Replaces every character that is not allowed in the name of a model with '_'.
std::string as_model_name(std::string text) {
    for (char& c : text)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-') c = '_';
    return text;
}

const toml::array* severities(const ExperimentTable& scene) {
    const toml::node* node = scene.find("severity");
    return node ? node->as_array() : nullptr;
}

ModelInfo model_in(const ExperimentTable& scene, const toml::node& node, const std::string& name,
                   const std::string& from = "") {
    if (!node.is_table()) scene.fail(node, "a shape is described by a table, as [model.NAME] is");
    return read_model(scene, name, *node.as_table(), ModelsOf::experiment, from);
}

}  // namespace

std::vector<ExperimentTable> by_severity(const ExperimentTable& scene) {
    const toml::array* values = severities(scene);
    if (!values) return {scene};
    const toml::node& node = *scene.find("severity");
    for (const char* key : {"each", "sources", "recording"})
        if (const toml::node* other = scene.find(key))
            scene.fail(*other,
                       fmt::format("'{}' cannot be combined with a list of severities: remove one of the two", key));
    if (values->empty()) scene.fail(node, "'severity' has no value: give some, or remove it");
    if (scene.text("name").find(place_of_value) == std::string::npos)
        scene.fail(*scene.find("name"), "'name' has no {}, the place of each severity");
    std::vector<ExperimentTable> scenes;
    std::set<double> seen;
    for (std::size_t i = 0; i < values->size(); ++i) {
        const double value = scene.number(*values->get(i), "severity");
        if (!seen.insert(value).second) scene.fail(*values->get(i), "'severity' has a value twice");
        scenes.push_back(scene);
        scenes.back().fill({text_of(value), value, i});
    }
    return scenes;
}

double severity_of(const ExperimentTable& scene) {
    if (scene.filling()) return scene.filling()->number;
    const toml::node* node = scene.find("severity");
    return node ? scene.number(*node, "severity") : std::numeric_limits<double>::quiet_NaN();
}

std::string family_of(const ExperimentTable& scene) {
    if (scene.find("family")) return scene.text("family");
    const toml::node* name = scene.find("name");
    if (!scene.filling() || !name) return "";
    std::string family = name->value_or<std::string>("");
    if (const std::size_t at = family.find(place_of_value); at != std::string::npos)
        family.erase(at, place_of_value.size());
    while (family.ends_with(' ') || family.ends_with(',')) family.pop_back();
    return family;
}

std::string model_name(const ExperimentTable& scene, std::string_view key) {
    const toml::node& node = scene.required(key);
    if (!node.is_table() && !node.is_array()) return scene.text(key);
    return as_model_name(scene.text("name")) + (key == "source" ? ".A" : ".B");
}

std::vector<ModelInfo> models_in(const ExperimentTable& scene) {
    std::vector<ModelInfo> models;
    for (const char* key : {"source", "target"}) {
        const toml::node* node = scene.find(key);
        if (!node || node->is_string()) continue;
        if (const toml::node* each = scene.find("each"))
            scene.fail(*each, fmt::format("'each' takes names of models, and '{}' describes a shape: name one", key));
        const std::string name = model_name(scene, key);
        const toml::array* steps = node->as_array();
        if (!steps) {
            models.push_back(model_in(scene, *node, name));
            continue;
        }
        if (steps->empty()) scene.fail(*node, fmt::format("'{}' describes no shape", key));
        for (std::size_t i = 0; i < steps->size(); ++i) {
            const bool last = i + 1 == steps->size();
            const std::string from = i == 0 ? "" : models.back().name;
            models.push_back(model_in(scene, *steps->get(i), last ? name : fmt::format("{}.{}", name, i), from));
        }
    }
    return models;
}

}  // namespace hausbench
