// `hausbench measure`: bounds the distance between any two files.
#include "harness/commands/measurement.h"

#include "algorithms/error.h"
#include "harness/commands/measurement_pairs.h"
#include "harness/commands/verb.h"
#include "harness/record/json.h"

#include <fmt/format.h>

#include <algorithm>

namespace hausbench {

namespace {

ParameterMap parse_parameters(const std::vector<std::string>& texts) {
    ParameterMap parameters;
    for (const std::string& text : texts) {
        const auto equals = text.find('=');
        if (equals == std::string::npos) throw InputError(fmt::format("--set {}: write it as name=value", text));
        const auto value = nlohmann::json::parse(text.substr(equals + 1), nullptr, false);
        const bool plain = value.is_boolean() || value.is_number();
        parameters[text.substr(0, equals)] = plain ? value.get<ParameterValue>() : text.substr(equals + 1);
    }
    return parameters;
}

void take_arguments(CLI::App* verb, MeasureRequest& request, std::vector<std::string>& parameters,
                    std::filesystem::path& pairs, bool& json) {
    verb->add_option("A", request.source,
                     "source: a file, or a model of the project; h(A,B) = max over a in A of the distance from a to B");
    verb->add_option(
        "B", request.target,
        "target, likewise; A or B may be a quoted pattern, 'scans/*.ply', and both: files of one name are a pair");
    verb->add_option("--pairs", pairs, "instead of A and B: a file with a line for each pair, A, B")
        ->check(CLI::ExistingFile);
    verb->add_option(
        "--solver", request.solver,
        "see `hausbench list` (default: cover for meshes, scan for points, surface_enclosure for surfaces)");
    verb->add_option("--tolerance", request.tolerance, "largest gap between lower and upper bound, in the unit of --of")
        ->capture_default_str();
    verb->add_option("--of", request.of,
                     "diagonal, longest: a fraction of the diagonal or of the longest side of A's box; absolute: a "
                     "length in the files' unit; lower: a fraction of the lower bound")
        ->capture_default_str()
        ->check([](const std::string& of) {
            return std::find(tolerance_units.begin(), tolerance_units.end(), of) != tolerance_units.end()
                       ? ""
                       : fmt::format("unknown unit '{}'{}", of, nearest_hint(of, tolerance_units));
        });
    verb->add_flag("--symmetric", request.symmetric,
                   "h(A,B), h(B,A), each to the full tolerance, and H(A,B), the larger of the two");
    verb->add_flag("--penetration", request.penetration,
                   "instead of a distance, how deep two closed meshes are in each other: the deepest pair of points, "
                   "of the volume that they have in common");
    verb->add_option("--set", parameters, "a solver parameter, name=value; may be repeated");
    verb->add_option("--cutoff", request.cutoff,
                     "only ask whether the distance is above this length: exit code 0 if it is at most that, 1 if it "
                     "is above, 3 if that is open; --time-limit is then 10 unless it is given");
    verb->add_option("--time-limit", request.time_limit,
                     "seconds for preparing, and as many for solving; the bounds hold also when it is reached. A "
                     "solver that goes on is killed after a tenth more, and at least 1 s");
    verb->add_flag("--in-process", request.in_process,
                   "solve in this process, for debuggers: a solver that hangs or crashes then takes it along");
    verb->add_option("--threads", request.threads, "that the solver may use, where it offers that")
        ->check(CLI::Range(1, 1024));
    verb->add_option(
        "--fields", request.fields,
        "write A, cut finely enough to show how far each place of it is from B, with the distance and the "
        "nearest element of each vertex, into this file: .ply (MeshLab, CloudCompare) or .vtk (ParaView), "
        "which also takes the solver's bounds of each triangle; with --symmetric, B too, into NAME.back.ply "
        "or NAME.back.vtk");
    verb->add_option(
            "--resolution", request.resolution,
            "for --fields: how far drawn values may be from the distance, as a fraction of h; inf: A is not cut")
        ->capture_default_str();
    verb->add_option("--certificate", request.certificate,
                     "write a proof of the upper bound, from a second run, into this file, for `verify --certificate`");
    verb->add_flag("--json", json, "print one JSON object");
}

// Refuses options that only make sense for a single pair.
void check_batch(const MeasureRequest& request, const std::filesystem::path& pairs, bool json) {
    if (!pairs.empty() && !request.source.empty())
        throw InputError("--pairs: the list names the shapes: leave out A and B");
    if (pairs.empty() && request.target.empty()) throw InputError("measure: name B, too");
    const std::pair<bool, const char*> alone[] = {
        {json, "--json"}, {!request.fields.empty(), "--fields"}, {!request.certificate.empty(), "--certificate"}};
    for (const auto& [given, name] : alone) {
        if (given) throw InputError(fmt::format("{}: not with several pairs, which are written as CSV", name));
    }
}

}  // namespace

void add_measure(CLI::App& app, int& code) {
    static MeasureRequest request;
    static std::vector<std::string> parameters;
    static std::filesystem::path pairs;
    static bool as_json = false;
    auto* verb = app.add_subcommand("measure",
                                    "bound the distance from A to B (meshes or point sets in any common format, or "
                                    "algebraic surfaces as .surface.toml)");
    take_arguments(verb, request, parameters, pairs, as_json);
    take_plugins(verb);
    verb->callback([verb, &code] {
        for (const auto& [name, file] :
             {std::pair{"--fields", &request.fields}, {"--certificate", &request.certificate}}) {
            if (verb->count(name) > 0 && file->empty()) throw InputError(fmt::format("{}: name a file", name));
        }
        request.options = parse_parameters(parameters);
        request.tolerance_given = verb->count("--tolerance") + verb->count("--of") > 0;
        const bool many = is_pattern(request.source) || is_pattern(request.target);
        if (!pairs.empty() || many) {
            check_batch(request, pairs, as_json);
            code = measure_pairs(pairs.empty() ? pairs_of_patterns(request.source, request.target) : read_pairs(pairs),
                                 request);
            return;
        }
        if (request.source.empty() || request.target.empty())
            throw InputError("measure: name two shapes, A and B; `hausbench measure --help`");
        const Measured measured = measure(request);
        constexpr auto replace = nlohmann::json::error_handler_t::replace;  // output of a program may not be UTF-8
        print(as_json ? to_json(measured, request).dump(-1, ' ', false, replace) + "\n" : describe(measured, request));
        code = exit_code(measured, request);
        if (const std::string why = no_answer(measured); !why.empty())
            say({fmt::format("solver '{}' gave no answer: {}", measured.solver, why)});
    });
}

}  // namespace hausbench
