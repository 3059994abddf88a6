// `hausbench list`: lists the available solvers, experiments, models and columns.
#include "algorithms/error.h"
#include "algorithms/registry.h"
#include "datasets/catalogue.h"
#include "datasets/corpus.h"
#include "datasets/derive.h"
#include "datasets/formats/formats.h"
#include "datasets/generate.h"
#include "datasets/paths.h"
#include "harness/commands/text_table.h"
#include "harness/commands/verb.h"
#include "harness/plan/experiment.h"
#include "harness/plan/keys.h"
#include "harness/record/columns.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace hausbench {

using nlohmann::json;

namespace {

json shapes_json(const ShapeSet& shapes) {
    json out = json::array();
    if (shapes.points) out.push_back("points");
    if (shapes.mesh) out.push_back("mesh");
    if (shapes.surface) out.push_back("surface");
    return out;
}

std::string type_name(const ParameterValue& value) {
    return std::visit(
        [](const auto& v) -> std::string {
            using T = std::decay_t<decltype(v)>;
            if constexpr (std::is_same_v<T, bool>)
                return "flag";
            else if constexpr (std::is_same_v<T, std::int64_t>)
                return "integer";
            else if constexpr (std::is_same_v<T, double>)
                return "real";
            else
                return "text";
        },
        value);
}

json solver_json(const SolverInfo& info) {
    json parameters = json::array(), abilities = json::array(), may_need = json::array();
    for (const ParameterSpec& p : info.parameters) {
        json parameter = {{"name", p.name},
                          {"type", type_name(p.default_value)},
                          {"unit", p.unit},
                          {"paper_value", p.paper_value},
                          {"description", p.description},
                          {"choices", p.choices},
                          {"required", p.required()}};
        std::visit([&](const auto& v) { parameter["default"] = v; }, p.default_value);
        parameters.push_back(parameter);
    }
    for (const Ability ability : info.abilities) abilities.push_back(to_string(ability));
    for (const Need& need : info.may_need) may_need.push_back(to_string(need));
    return {{"name", info.name},
            {"title", info.title},
            {"paper", info.paper},
            {"source", shapes_json(info.source)},
            {"target", shapes_json(info.target)},
            {"certified", info.certified},
            {"known_wrong", info.known_wrong},
            {"ignores_tolerance", info.ignores_tolerance},
            {"abilities", abilities},
            {"may_need", may_need},
            {"parameters", parameters}};
}

json experiment_json(const std::filesystem::path& file) {
    struct Found {
        ScenePlan scene;
        std::vector<std::string> profiles;
    };
    std::vector<Found> scenes;
    std::string title;
    std::set<std::string> labels;
    for (const char* profile : {"quick", "paper"}) {
        const Experiment experiment = read_experiment(file, profile, PlugIns::refused);
        title = experiment.title;
        for (const SolverPlan& solver : experiment.solvers) labels.insert(solver.label);
        for (const ScenePlan& s : experiment.scenes) {
            const auto at = std::find_if(scenes.begin(), scenes.end(), [&](const Found& f) {
                return f.scene.name == s.name && f.scene.source == s.source && f.scene.target == s.target;
            });
            if (at == scenes.end())
                scenes.push_back({s, {profile}});
            else
                at->profiles.push_back(profile);
        }
    }
    json out = {{"stem", file.stem().string()}, {"title", title}, {"scenes", json::array()}, {"solvers", labels}};
    for (const auto& [s, profiles] : scenes) {
        out["scenes"].push_back(
            {{"name", s.name}, {"profiles", profiles}, {"source", s.source}, {"target", s.target}, {"note", s.note}});
        if (!s.each.empty()) out["scenes"].back()["each"] = s.each;
    }
    return out;
}

// Describes an experiment. If it cannot be read, the reason takes the place of its title.
json experiment_or_error(const std::filesystem::path& file) {
    try {
        return experiment_json(file);
    } catch (const InputError& error) {
        return {{"stem", file.stem().string()},
                {"title", error.what()},
                {"scenes", json::array()},
                {"solvers", json::array()}};
    }
}

json model_json(const ModelInfo& m) {
    return {{"name", m.name},       {"source", m.source},   {"from", m.from},
            {"package", m.package}, {"recipe", m.recipe},   {"path", m.path},
            {"sha256", m.sha256},   {"licence", m.licence}, {"note", m.note}};
}

json format_json(const Format& f) {
    return {{"name", f.endings.front()}, {"endings", f.endings}, {"title", f.title}, {"reads", f.reads},
            {"refuses", f.refuses},      {"unit", f.unit},       {"axes", f.axes},   {"error", f.error}};
}

std::string text_of(const json& object, const char* key) { return object.at(key).get<std::string>(); }

std::string joined(const json& list) {
    std::string out;
    for (const json& item : list) out += (out.empty() ? "" : ", ") + item.get<std::string>();
    return out;
}

std::string origin(const json& model) {
    const std::string source = text_of(model, "source");
    return source == "derived"     ? text_of(model, "recipe") + " of " + text_of(model, "from")
           : source == "generated" ? text_of(model, "recipe")
           : source == "file"      ? text_of(model, "path")
                                   : source + " " + text_of(model, "package");
}

std::string solvers_text(const json& all, const Paper& paper) {
    TextTable table({{"solver"}, {"measures"}, {"bounds", false, 1}, {"what it is", false, 0, true}});
    for (const json& s : all["solvers"]) {
        const std::string source = joined(s["source"]), target = joined(s["target"]), of = text_of(s, "paper");
        table.add({{text_of(s, "name"), source == target ? source : source + " to " + target,
                    s["certified"].get<bool>() ? "certified" : "not certified",
                    text_of(s, "title") + (of.empty() ? "" : " (" + of + ")")}});
    }
    for (const json& s : all["not_built"])
        table.add({{text_of(s, "name"), "not built", "", text_of(s, "reason")}, "", Colour::grey});
    return table.text(paper);
}

std::string formats_text(const json& all, const Paper& paper) {
    TextTable table({{"format"}, {"endings", false, 1}, {"what is read", false, 0, true}});
    for (const json& f : all["formats"]) table.add({{text_of(f, "title"), joined(f["endings"]), text_of(f, "reads")}});
    return table.text(paper) + wrapped(
                                   "a file may be gzipped; `hausbench list ENDING` says what is refused, and what "
                                   "a file says of its unit and axes",
                                   0, paper.width);
}

std::string one_format(const json& f, const Paper& paper) {
    std::string text = wrapped(fmt::format("{}: {}", joined(f["endings"]), text_of(f, "title")), 0, paper.width);
    for (const auto& [key, title] :
         {std::pair{"reads", "read"}, std::pair{"refuses", "refused"}, std::pair{"unit", "unit"},
          std::pair{"axes", "axes"}, std::pair{"error", "error of a coordinate"}})
        text += wrapped(fmt::format("{}: {}", title, text_of(f, key)), 2, paper.width);
    return text;
}

std::string experiments_text(const json& all, const Paper& paper) {
    if (all["experiments"].empty())
        return "no experiments: there is no project here: set HAUSBENCH_ROOT to a checkout\n";
    TextTable table({{"experiment"}, {"scenes", true, 1}, {"what it is", false, 0, true}});
    for (const json& e : all["experiments"])
        table.add({{text_of(e, "stem"), std::to_string(e["scenes"].size()), text_of(e, "title")}});
    return table.text(paper);
}

// Returns the number of meshes in the corpus that are not derived from others.
std::size_t meshes_of_corpus(const json& all) {
    const json& corpus = all["corpus"];
    return std::size_t(
        std::count_if(corpus.begin(), corpus.end(), [](const json& m) { return text_of(m, "source") != "derived"; }));
}

std::string models_text(const json& all, const Paper& paper) {
    if (all["models"].empty()) return "no models: there is no project here: set HAUSBENCH_ROOT to a checkout\n";
    TextTable table({{"model"}, {"made by, or from", false, 1}, {"what it is", false, 0, true}});
    for (const json& m : all["models"]) table.add({{text_of(m, "name"), origin(m), text_of(m, "note")}});
    const std::size_t meshes = meshes_of_corpus(all);
    if (meshes == 0) return table.text(paper);
    return table.text(paper) +
           wrapped(fmt::format("and {} more meshes of the corpus, see `hausbench list corpus`", meshes), 0,
                   paper.width);
}

std::string corpus_text(const json& all, const Paper& paper) {
    TextTable table({{"model"}, {"from", false, 1}, {"file", false, 0, true}});
    bool any = false;
    for (const json& m : all["corpus"]) {
        if (text_of(m, "source") == "derived") continue;
        table.add({{text_of(m, "name"), origin(m), text_of(m, "path")}});
        any = true;
    }
    std::string text = any ? table.text(paper) : "no corpus: there is no datasets/corpus.toml here\n";
    for (const CorpusRule& rule : corpus_rules())
        text += wrapped(fmt::format("NAME{}: NAME{} ({}, {} = {})", rule.ending, rule.note, rule.operation, rule.number,
                                    rule.value),
                        0, paper.width);
    return text;
}

std::string one_solver(const json& s, const Paper& paper) {
    const auto line = [&](const std::string& text, std::size_t indent = 2) {
        return wrapped(text, indent, paper.width);
    };
    const std::string of = text_of(s, "paper"), wrong = text_of(s, "known_wrong");
    std::string text =
        line(fmt::format("{}: {}{}", text_of(s, "name"), text_of(s, "title"), of.empty() ? "" : " (" + of + ")"), 0);
    text += line(fmt::format("measures {} against {}", joined(s["source"]), joined(s["target"])));
    text +=
        line(s["certified"].get<bool>() ? "certified: its bounds hold under rounding"
                                        : "not certified: its bounds hold in exact arithmetic, or it promises less");
    if (!wrong.empty()) text += line("known to be wrong: " + wrong);
    text += line(s["may_need"].empty() ? "needs no structure" : "may need " + joined(s["may_need"]));
    if (!s["parameters"].empty())
        text += line("parameters (measure --set NAME=VALUE; [solver.parameters] of an experiment)", 0);
    for (const json& p : s["parameters"]) {
        const std::string in_paper = text_of(p, "paper_value"), unit = text_of(p, "unit");
        text +=
            line(fmt::format("{} = {} ({}{}{})", text_of(p, "name"),
                             p["required"].get<bool>() ? "(required)" : p["default"].dump(), text_of(p, "type"),
                             unit.empty() ? "" : ", in " + unit, in_paper.empty() ? "" : ", in the paper " + in_paper));
        text += line(text_of(p, "description") + (p["choices"].empty() ? "" : ": " + joined(p["choices"])), 6);
    }
    return text;
}

json recipes_json(const std::vector<Recipe>& recipes) {
    json out = json::array();
    for (const Recipe& recipe : recipes) {
        json numbers = json::array();
        for (const NumberSpec& number : recipe.numbers)
            numbers.push_back({{"name", number.name}, {"integer", number.whole}, {"required", number.required}});
        out.push_back({{"name", recipe.name}, {"numbers", numbers}, {"meaning", recipe.meaning}});
    }
    return out;
}

json keys_json() {
    json tables = json::array();
    for (const KeyTable& table : key_tables()) {
        json keys = json::array();
        for (const Key& key : table.keys)
            keys.push_back({{"name", key.name}, {"default", key.fallback}, {"meaning", key.meaning}});
        tables.push_back({{"table", table.title}, {"keys", keys}});
    }
    return {{"tables", tables}, {"recipes", recipes_json(recipes())}, {"operations", recipes_json(operations())}};
}

std::string keys_text(const Paper& paper) {
    std::string text;
    const json all = keys_json();
    for (const json& key_table : all["tables"]) {
        const std::string title = text_of(key_table, "table");
        TextTable table({{title.empty() ? "key" : title}, {"default", false, 1}, {"meaning", false, 0, true}});
        for (const json& key : key_table["keys"])
            table.add({{text_of(key, "name"), text_of(key, "default"), text_of(key, "meaning")}});
        text += (text.empty() ? "" : "\n") + table.text(paper);
    }
    for (const char* group : {"recipes", "operations"}) {
        TextTable table({{group}, {"numbers", false, 0, true}, {"meaning", false, 0, true}});
        for (const json& recipe : all[group]) {
            std::string numbers;
            for (const json& number : recipe["numbers"])
                numbers += (numbers.empty() ? "" : ", ") + text_of(number, "name");
            table.add({{text_of(recipe, "name"), numbers, text_of(recipe, "meaning")}});
        }
        text += "\n" + table.text(paper);
    }
    return text;
}

std::string each_of(const json& scene) { return scene.value("each", ""); }

std::string one_experiment(const json& e, const Paper& paper) {
    std::string text = wrapped(text_of(e, "stem") + ": " + text_of(e, "title"), 0, paper.width);
    text += wrapped("solvers: " + joined(e["solvers"]), 2, paper.width);
    TextTable table(
        {{"scene"}, {"A", false, 0, true}, {"B", false, 0, true}, {"profiles", false, 1}, {"note", false, 2, true}});
    std::map<std::string, std::size_t> of_each;  // value of the key `each` -> number of scenes that it makes
    for (const json& s : e["scenes"]) ++of_each[each_of(s)];
    for (const json& s : e["scenes"]) {
        const std::string each = each_of(s);
        const std::size_t count = std::exchange(of_each[each], 0);
        if (!each.empty() && count)
            table.add({{each, "", "", joined(s["profiles"]),
                        fmt::format("{} scenes, such as '{}': {} to {}", count, text_of(s, "name"),
                                    text_of(s, "source"), text_of(s, "target"))}});
        if (!each.empty()) continue;
        table.add({{text_of(s, "name"), text_of(s, "source"), text_of(s, "target"), joined(s["profiles"]),
                    text_of(s, "note")}});
    }
    return text + table.text(paper);
}

std::string one_model(const json& m, const Paper& paper) {
    std::string text = wrapped(fmt::format("{}: {}", text_of(m, "name"), text_of(m, "note")), 0, paper.width);
    text += wrapped(fmt::format("{}: {}", text_of(m, "source"), origin(m)), 2, paper.width);
    for (const char* key : {"path", "sha256", "licence"}) {
        if (!text_of(m, key).empty()) text += wrapped(fmt::format("{}: {}", key, text_of(m, key)), 2, paper.width);
    }
    return text;
}

std::string screen(const json& all, const Paper& paper) {
    std::string text = solvers_text(all, paper);
    text += wrapped(fmt::format("{} experiments and {} models: `hausbench list experiments`, `list models`; `list "
                                "NAME` describes one solver, experiment or model, `list keys` the keys of experiment "
                                "files, `list columns` the columns of results",
                                all["experiments"].size(), all["models"].size()),
                    0, paper.width);
    return text;
}

// Lists everything. Outside a project, lists the experiments and models that were installed with the program. Reading
// all experiments takes long: unless all are wanted, those other than `experiment` have only their name.
json list_as_json(bool all_experiments, const std::string& experiment = "") {
    json out = {{"solvers", json::array()},     {"not_built", json::array()}, {"formats", json::array()},
                {"experiments", json::array()}, {"models", json::array()},    {"corpus", json::array()}};
    for (const SolverEntry& entry : solvers()) out["solvers"].push_back(solver_json(entry.info));
    for (const NotBuilt& absent : solvers_not_built())
        out["not_built"].push_back({{"name", absent.name}, {"reason", absent.reason}});
    for (const Format& format : formats()) out["formats"].push_back(format_json(format));
    for (const auto& file : experiment_files(experiments_folder())) {
        const std::string stem = file.stem().string();
        out["experiments"].push_back(all_experiments || stem == experiment ? experiment_or_error(file)
                                                                           : json{{"stem", stem}});
    }
    if (manifest_file().empty()) return out;
    Catalogue catalogue(manifest_file(), cache_folder(), program_path());
    for (const ModelInfo& m : catalogue.models()) out[m.of_corpus ? "corpus" : "models"].push_back(model_json(m));
    return out;
}

// Lists a group, such as "models", or describes the solver, experiment or model named `what`. If `what` is empty, lists
// the solvers. Throws InputError for an unknown name.
std::string list_as_text(const std::string& what, const Paper& paper) {
    const json all = list_as_json(what == "experiments", what);
    if (what.empty()) return screen(all, paper);
    if (what == "solvers") return solvers_text(all, paper);
    if (what == "formats") return formats_text(all, paper);
    if (what == "experiments") return experiments_text(all, paper);
    if (what == "models") return models_text(all, paper);
    if (what == "corpus") return corpus_text(all, paper);
    struct Kind {
        const char *group, *key;
        std::string (*text)(const json&, const Paper&);
    };
    constexpr Kind kinds[] = {{"solvers", "name", one_solver},
                              {"formats", "name", one_format},
                              {"experiments", "stem", one_experiment},
                              {"models", "name", one_model},
                              {"corpus", "name", one_model}};
    std::string text;  // describes every match, because a solver and a model may have the same name
    std::vector<std::string> names = {"solvers", "formats", "experiments", "models", "corpus", "keys", "columns"};
    for (const Kind& kind : kinds) {
        for (const json& entry : all[kind.group]) {
            names.push_back(text_of(entry, kind.key));
            const bool other_ending =
                entry.contains("endings") &&
                std::find(entry["endings"].begin(), entry["endings"].end(), what) != entry["endings"].end();
            if (names.back() == what || other_ending) text += kind.text(entry, paper);
        }
    }
    for (const json& absent : all["not_built"]) {
        names.push_back(text_of(absent, "name"));
        if (names.back() == what) text += fmt::format("{}: not built: {}\n", what, text_of(absent, "reason"));
    }
    if (text.empty())
        throw InputError(fmt::format("list {}: no solver, format, experiment or model of that name{}", what,
                                     nearest_hint(what, names)));
    return text;
}

}  // namespace

void add_list(CLI::App& app, int&) {
    static bool as_json = false;
    static std::string what;
    auto* verb =
        add_verb(app, "list", "lists solvers, formats, experiments, models, keys or columns", "hausbench list cover");
    verb->add_option("what", what,
                     "solvers, formats, experiments, models, corpus, keys (of experiments) or columns (of results, as "
                     "JSON); or the "
                     "name of a solver, format, experiment or model (default: solvers)")
        ->type_name("solvers|formats|experiments|models|corpus|keys|columns");
    verb->add_flag("--json", as_json, "prints all lists as one JSON object (with keys: the keys)");
    take_plugins(verb);
    verb->callback([] {
        if (what == "columns")
            print(columns_json().dump(1) + "\n");
        else if (what == "keys")
            print(as_json ? keys_json().dump(1) + "\n" : keys_text(paper_of_output()));
        else
            print(as_json ? list_as_json(true).dump(2) + "\n" : list_as_text(what, paper_of_output()));
    });
}

}  // namespace hausbench
