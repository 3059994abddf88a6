// `hausbench measure`: bounds the distance between any two files.
#include "harness/commands/measurement.h"

#include "algorithms/error.h"
#include "harness/commands/measurement_pairs.h"
#include "harness/commands/scripts.h"
#include "harness/commands/verb.h"
#include "harness/record/json.h"
#include "process/whole_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <tuple>

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

std::vector<Statistic> parse_statistics(const std::string& list) {
    std::vector<Statistic> all;
    std::istringstream in(list);
    for (std::string text; std::getline(in, text, ',');) {
        try {
            all.push_back(statistic_of(text));
        } catch (const InputError& error) {
            throw InputError(fmt::format("--statistics: {}", error.what()));
        }
        if (all.back().over != Statistic::Over::source)
            throw InputError(fmt::format("--statistics: '{}': leave out '{}'; --symmetric gives all of these", text,
                                         to_string(all.back().over)));
    }
    if (all.empty()) throw InputError("--statistics: name at least one, such as mean");
    return all;
}

// The values of the options and arguments of `measure`.
struct Arguments {
    MeasureRequest request;
    std::vector<std::string> parameters;
    std::filesystem::path pairs, picture;
    bool json = false, distribution = false, by_vertex = false;
    std::string statistics;
};

void take_arguments(CLI::App* verb, Arguments& given) {
    MeasureRequest& request = given.request;
    verb->add_option("A", request.source, "source: a file, a model, or a quoted pattern such as 'scans/*.ply'")
        ->type_name("MODEL");
    verb->add_option("B", request.target, "target, likewise; of two patterns, files of one name are a pair")
        ->type_name("MODEL");
    take_shape_options(verb, request.reading);
    for (const auto& [name, file, shape] : {std::tuple{"--transform-source", &request.source_matrix, "A"},
                                            std::tuple{"--transform-target", &request.target_matrix, "B"}})
        verb->add_option(name, *file, fmt::format("moves {} by the 4 x 4 matrix in this text file", shape))
            ->type_name("M");
    verb->add_option("--pairs", given.pairs, "instead of A and B: a file with a line \"A, B\" for each pair")
        ->type_name("FILE")
        ->check(CLI::ExistingFile);
    verb->add_option("--solver", request.solver,
                     "default: cover for meshes, scan for points, surface_enclosure for surfaces")
        ->type_name("SOLVER");
    verb->add_option("--tolerance", request.tolerance, "largest gap between lower and upper bound")
        ->type_name("NUMBER")
        ->capture_default_str();
    verb->add_option("--of", request.of,
                     "unit of tolerance and cutoff: A's diagonal or longest side, a length, or the lower bound")
        ->type_name("diagonal|longest|absolute|lower")
        ->capture_default_str()
        ->check([](const std::string& of) {
            return std::find(tolerance_units.begin(), tolerance_units.end(), of) != tolerance_units.end()
                       ? ""
                       : fmt::format("unknown unit '{}'{}", of, nearest_hint(of, tolerance_units));
        });
    verb->add_flag("--symmetric", request.symmetric, "also h(B,A), and H(A,B), the larger of the two");
    verb->add_flag("--penetration", request.penetration,
                   "instead of a distance, how deep two closed meshes are in each other");
    verb->add_flag("--distribution", given.distribution,
                   "instead: mean, RMS, deviation, median, 95 % quantile and maximum");
    verb->add_option("--statistics", given.statistics,
                     "these, such as \"mean, quantile 0.99, within 0.1\" (the share up to 0.1)")
        ->type_name("LIST");
    verb->add_flag("--by-vertex", given.by_vertex,
                   "statistics count each vertex once, instead of each part by its area");
    verb->add_option("--share-tolerance", request.share_tolerance, "largest gap of shares, which have no unit")
        ->type_name("N")
        ->capture_default_str();
    verb->add_option("--set", given.parameters,
                     "a parameter of the solver, see `hausbench list SOLVER`; may be repeated")
        ->type_name("NAME=VALUE");
    verb->add_option("--cutoff", request.cutoff,
                     "only asks whether the distance is above this, for 10 s or --time-limit")
        ->type_name("NUMBER");
    verb->add_option("--time-limit", request.time_limit,
                     "limit for preparing, and for solving; bounds hold also when it is reached")
        ->type_name("SECONDS");
    verb->add_option("--budget", request.budget, "most units of work, for --picture")->group("");
    verb->add_flag("--in-process", request.in_process, "solves in this process, for debuggers");
    verb->add_option("--threads", request.threads, "threads that the solver may use, if it supports them")
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
    verb->add_option("--fields", request.fields, "writes A with the distance to B at each vertex, as .ply or .vtk")
        ->type_name("FILE");
    verb->add_option("--resolution", request.resolution, "largest error of --fields between vertices, a fraction of h")
        ->type_name("NUMBER")
        ->capture_default_str();
    verb->add_option("--picture", given.picture,
                     "draws A coloured by its distance to B, and a histogram (.png, .pdf, .svg)")
        ->type_name("FILE");
    verb->add_option("--witness", request.witness, "writes the farthest point and the line to B, as .ply, .vtk or .obj")
        ->type_name("FILE");
    verb->add_option("--certificate", request.certificate,
                     "writes a proof of the upper bound, for `hausbench verify --certificate`")
        ->type_name("FILE");
    verb->add_flag("--json", given.json, "prints one JSON object");
}

// Checks the options for a picture. Throws InputError for what it cannot show.
void check_picture(const CLI::App& verb, const Arguments& given) {
    const std::string extension = given.picture.extension().string();
    if (extension != ".png" && extension != ".pdf" && extension != ".svg")
        throw InputError(fmt::format("--picture {}: end the name with .png, .pdf or .svg", given.picture.string()));
    for (const char* other : {"--distribution", "--statistics", "--penetration", "--cutoff", "--pairs"}) {
        if (verb.count(other) > 0)
            throw InputError(fmt::format("--picture: shows the distance of one A to B: leave out {}", other));
    }
    if (is_pattern(given.request.source) || is_pattern(given.request.target))
        throw InputError("--picture: not with several pairs, which are written as CSV");
    if (!given.request.fields.empty() && given.request.fields.extension() != ".ply")
        throw InputError("--picture: is drawn from the fields in PLY: end the name after --fields with .ply");
    if (!given.request.certificate.empty() && is_same_file(given.picture, given.request.certificate))
        throw InputError(
            fmt::format("--picture {}: --certificate is the same file: choose another name", given.picture.string()));
    check_place_to_write(given.picture);
}

// Checks the options for several pairs. Throws InputError for options of a single pair, for --pairs with A, and for a
// missing B.
void check_batch(const MeasureRequest& request, const std::filesystem::path& pairs, bool json) {
    if (!pairs.empty() && !request.source.empty())
        throw InputError("--pairs: the list names the shapes: leave out A and B");
    if (pairs.empty() && request.target.empty()) throw InputError("measure: name B, too");
    const std::pair<bool, const char*> alone[] = {{json, "--json"},
                                                  {!request.source_matrix.empty(), "--transform-source"},
                                                  {!request.target_matrix.empty(), "--transform-target"},
                                                  {!request.fields.empty(), "--fields"},
                                                  {!request.certificate.empty(), "--certificate"},
                                                  {!request.witness.empty(), "--witness"}};
    for (const auto& [given, name] : alone) {
        if (given) throw InputError(fmt::format("{}: not with several pairs, which are written as CSV", name));
    }
}

}  // namespace

void add_measure(CLI::App& app, int& code) {
    static Arguments given;
    static MeasureRequest& request = given.request;
    auto* verb = add_verb(app, "measure", "bounds the distance from A to B: meshes, point sets or algebraic surfaces",
                          "hausbench measure scan.ply part.stl --of absolute --tolerance 0.01",
                          "h(A,B) is the largest distance of a point of A to B. Exit codes with --cutoff: 0: at most "
                          "the cutoff; 1: above it; 3: open. docs/measure.md says more about each option.");
    take_arguments(verb, given);
    take_plugins(verb);
    verb->callback([verb, &code] {
        for (const auto& [name, file] : {std::pair{"--fields", &request.fields},
                                         {"--certificate", &request.certificate},
                                         {"--witness", &request.witness},
                                         {"--picture", &given.picture}}) {
            if (verb->count(name) > 0 && file->empty()) throw InputError(fmt::format("{}: name a file", name));
        }
        request.options = parse_parameters(given.parameters);
        if (given.by_vertex) request.weigh = WeighBy::number;
        const char* alone = given.by_vertex                        ? "--by-vertex"
                            : verb->count("--share-tolerance") > 0 ? "--share-tolerance"
                                                                   : "";
        if (*alone && !given.distribution && verb->count("--statistics") == 0)
            throw InputError(fmt::format("{}: is about statistics: add --distribution or --statistics", alone));
        if (verb->count("--statistics") > 0)
            request.statistics = parse_statistics(given.statistics);
        else if (given.distribution)
            request.statistics = parse_statistics("mean, rms, deviation, median, quantile 0.95, maximum");
        request.of_given = verb->count("--of") > 0;
        request.tolerance_given = verb->count("--tolerance") > 0 || request.of_given;
        if (!given.picture.empty()) check_picture(*verb, given);
        const bool many = is_pattern(request.source) || is_pattern(request.target);
        if (!given.pairs.empty() || many) {
            check_batch(request, given.pairs, given.json);
            code = measure_pairs(
                given.pairs.empty() ? pairs_of_patterns(request.source, request.target) : read_pairs(given.pairs),
                request);
            return;
        }
        if (request.source.empty() || request.target.empty())
            throw InputError("measure: name two shapes, A and B; `hausbench measure --help`");
        if (!given.picture.empty())
            become_python("measure", folder_with("measure", "analysis/picture.py"), "analysis.picture",
                          words_of(*verb));
        const Measured measured = measure(request);
        constexpr auto replace = nlohmann::json::error_handler_t::replace;  // output of a program may not be UTF-8
        print(given.json ? to_json(measured, request).dump(-1, ' ', false, replace) + "\n"
                         : describe(measured, request));
        code = exit_code(measured, request);
        if (const std::string why = no_answer(measured); !why.empty())
            say({fmt::format("solver '{}' gave no answer: {}", measured.solver, why)});
    });
}

}  // namespace hausbench
