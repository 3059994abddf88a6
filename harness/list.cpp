#include "list.h"

#include "catalogue.h"
#include "error.h"
#include "experiment.h"
#include "paths.h"
#include "registry.h"

#include <fmt/format.h>

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
    json parameters = json::array(), may_need = json::array();
    for (const ParameterSpec& p : info.parameters) {
        json one = {{"name", p.name},
                    {"type", type_name(p.default_value)},
                    {"unit", p.unit},
                    {"paper_value", p.paper_value},
                    {"description", p.description},
                    {"choices", p.choices},
                    {"required", p.required()}};
        std::visit([&](const auto& v) { one["default"] = v; }, p.default_value);
        parameters.push_back(one);
    }
    for (const Need& need : info.may_need) may_need.push_back(to_string(need));
    return {{"name", info.name},
            {"title", info.title},
            {"paper", info.paper},
            {"source", shapes_json(info.source)},
            {"target", shapes_json(info.target)},
            {"certified", info.certified},
            {"known_wrong", info.known_wrong},
            {"exact", info.exact},
            {"traces", info.traces},
            {"may_need", may_need},
            {"parameters", parameters}};
}

}  // namespace

json list_as_json() {
    json out = {{"solvers", json::array()},
                {"not_built", json::array()},
                {"experiments", json::array()},
                {"models", json::array()}};
    for (const SolverEntry& entry : solvers()) out["solvers"].push_back(solver_json(entry.info));
    for (const NotBuilt& absent : solvers_not_built())
        out["not_built"].push_back({{"name", absent.name}, {"reason", absent.reason}});
    for (const auto& file : experiment_files(project_root() / "experiments")) {
        json scenes = json::array();
        std::string title;
        for (const char* profile : {"quick", "paper"}) {
            const Experiment experiment = read_experiment(file, profile);
            title = experiment.title;
            for (const ScenePlan& s : experiment.scenes) {
                scenes.push_back({{"name", s.name},
                                  {"profile", profile},
                                  {"source", s.source},
                                  {"target", s.target},
                                  {"note", s.note}});
            }
        }
        out["experiments"].push_back({{"stem", file.stem().string()}, {"title", title}, {"scenes", scenes}});
    }
    const Catalogue catalogue(project_root() / "datasets" / "manifest.toml", cache_folder(), program_path());
    for (const ModelInfo& m : catalogue.models()) {
        out["models"].push_back({{"name", m.name},
                                 {"source", m.source},
                                 {"from", m.from},
                                 {"package", m.package},
                                 {"recipe", m.recipe},
                                 {"licence", m.licence},
                                 {"note", m.note}});
    }
    return out;
}

std::string list_as_text() {
    const json all = list_as_json();
    std::string text = "SOLVERS\n";
    const auto joined = [](const json& list) {
        std::string out;
        for (const json& item : list) out += (out.empty() ? "" : ", ") + item.get<std::string>();
        return out.empty() ? "no structure" : out;
    };
    for (const json& s : all["solvers"]) {
        const auto of = s["paper"].get<std::string>();
        text += fmt::format("  {:<12} {}{}; {} to {}; {}; may need {}\n", s["name"].get<std::string>(),
                            s["title"].get<std::string>(), of.empty() ? "" : " (" + of + ")", joined(s["source"]),
                            joined(s["target"]), s["certified"].get<bool>() ? "certified" : "not certified",
                            joined(s["may_need"]));
        for (const json& p : s["parameters"]) {
            const auto paper = p["paper_value"].get<std::string>(), unit = p["unit"].get<std::string>();
            text += fmt::format("    {} = {} ({}{}{}): {}{}\n", p["name"].get<std::string>(),
                                p["required"].get<bool>() ? "(required)" : p["default"].dump(),
                                p["type"].get<std::string>(), unit.empty() ? "" : ", in " + unit,
                                paper.empty() ? "" : ", in the paper " + paper, p["description"].get<std::string>(),
                                p["choices"].empty() ? "" : ": " + joined(p["choices"]));
        }
    }
    for (const json& s : all["not_built"])
        text += fmt::format("  {:<12} not built: {}\n", s["name"].get<std::string>(), s["reason"].get<std::string>());
    text += "EXPERIMENTS\n";
    for (const json& e : all["experiments"]) {
        text += fmt::format("  {}: {}\n", e["stem"].get<std::string>(), e["title"].get<std::string>());
        for (const json& s : e["scenes"]) {
            text +=
                fmt::format("    {:<16} {} -> {} ({})\n", s["name"].get<std::string>(), s["source"].get<std::string>(),
                            s["target"].get<std::string>(), s["profile"].get<std::string>());
        }
    }
    text += "MODELS\n";
    for (const json& m : all["models"]) {
        const auto source = m["source"].get<std::string>(), package = m["package"].get<std::string>(),
                   from = m["from"].get<std::string>(), recipe = m["recipe"].get<std::string>();
        const std::string origin = source == "derived"     ? recipe + " of " + from
                                   : source == "generated" ? recipe
                                                           : source + " " + package;
        text += fmt::format("  {:<28} {:<36} {}\n", m["name"].get<std::string>(), origin, m["note"].get<std::string>());
    }
    return text;
}

}  // namespace hausbench
