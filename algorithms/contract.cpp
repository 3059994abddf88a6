#include "algorithms/contract.h"

#include "algorithms/kernel/watched.h"
#include "algorithms/plugin.h"
#include "paper_keys.h"  // written by CMake from papers.bib

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace hausbench {
namespace {

std::string parameter_error(const ParameterSpec& spec) {
    const auto* text = std::get_if<std::string>(&spec.default_value);
    const auto* integer = std::get_if<std::int64_t>(&spec.default_value);
    const auto* real = std::get_if<double>(&spec.default_value);
    if (!spec.choices.empty()) {
        if (!text) return "has choices but is not a text: make its default a text, or give least and most";
        if (WATCHED("contract: a default is one of the choices",
                    std::find(spec.choices.begin(), spec.choices.end(), *text) == spec.choices.end()))
            return fmt::format("the default '{}' is not one of its choices{}", *text,
                               nearest_hint(*text, spec.choices));
    }
    if (spec.command && !text) return "is declared a command line but is not a text: make its default a text";
    if (!integer && !real) return "";
    const double value = integer ? static_cast<double>(*integer) : *real;
    if (!(spec.least <= value && value <= spec.most))
        return fmt::format("the default {} is outside [{}, {}]: change one of them", value, spec.least, spec.most);
    return "";
}

}  // namespace

std::string declaration_error(const SolverInfo& info) {
    const auto any = [](const ShapeSet& shapes) { return shapes.points || shapes.mesh || shapes.surface; };
    if (info.name.empty()) return "its name is empty: name it";
    if (info.title.empty()) return "its title is empty: give the name that tables and legends show";
    if (!any(info.source) || !any(info.target))
        return fmt::format("takes no shape as {}: set points, mesh or surface there",
                           any(info.source) ? "target" : "source");
    if (info.certified && !info.known_wrong.empty())
        return "is certified, and declares `known_wrong`: bounds that may not hold are never certified";
    const std::vector<std::string> papers(std::begin(paper_keys), std::end(paper_keys));
    if (!info.paper.empty() && std::find(papers.begin(), papers.end(), info.paper) == papers.end())
        return fmt::format("its paper '{}' is not a key of papers.bib{}: leave it empty for any other paper",
                           info.paper, nearest_hint(info.paper, papers));
    std::set<std::string> names;
    for (const ParameterSpec& spec : info.parameters) {
        if (spec.name.empty()) return "has a parameter without a name: give it one";
        if (!names.insert(spec.name).second) return fmt::format("declares parameter '{}' twice: rename one", spec.name);
        if (const std::string error = parameter_error(spec); !error.empty())
            return fmt::format("parameter '{}': {}", spec.name, error);
    }
    return "";
}

bool is_of_plugin(const std::string& solver) { return plugin_of(solver) != nullptr; }

void break_contract(const std::string& solver, const std::string& what) {
    const std::string text = fmt::format("solver '{}' {}", solver, one_line(what));
    if (const Plugin* plugin = plugin_of(solver))
        throw ContractError(fmt::format("{}: {} (mend the plug-in and build it again)", plugin->file.string(), text));
    throw std::logic_error(text);
}

void check_contract(const SolverEntry& entry) {
    const SolverInfo& info = entry.info;
    if (const std::string error = declaration_error(info);
        WATCHED("contract: plug-ins are checked when they are loaded", !error.empty()))
        break_contract(info.name, "breaks its contract: " + error);
    const bool incomplete =
        std::any_of(info.parameters.begin(), info.parameters.end(), [](const auto& p) { return p.required(); });
    if (incomplete) return;
    try {
        (void)make_solver(entry, Options(info.name, info.parameters, {}));
    } catch (const ContractError&) {
        throw;
    } catch (const InputError&) {
        // This is allowed: the constructor may reject the defaults, for example if the user must give one of two
        // strings.
    }
}

std::unique_ptr<Solver> make_solver(const SolverEntry& entry, const Options& options) {
    std::unique_ptr<Solver> solver;
    held_to_contract(entry.info.name, "its constructor", [&] { solver = entry.make(options); });
    if (!solver) break_contract(entry.info.name, "is null: its function returns no solver");
    if (const auto unread = options.unread(); WATCHED("contract: every parameter is read", !unread.empty()))
        break_contract(
            entry.info.name,
            fmt::format("does not read its parameter '{}': read it in the constructor, or remove it", unread.front()));
    return solver;
}

Needs checked_needs(const SolverEntry& entry, const Solver& solver, const Scene& scene, const QuerySet& queries) {
    Needs needs;
    held_to_contract(entry.info.name, "needs()", [&] { needs = solver.needs(scene, queries); });
    const Needs& declared = entry.info.may_need;
    for (const Need& need : needs) {
        if (WATCHED("contract: what a solver needs is declared",
                    std::find(declared.begin(), declared.end(), need) == declared.end()))
            break_contract(entry.info.name,
                           fmt::format("needs a {} that is not in may_need: declare it there", to_string(need)));
    }
    return needs;
}

}  // namespace hausbench
