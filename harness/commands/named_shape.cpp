#include "harness/commands/named_shape.h"

#include "algorithms/error.h"
#include "datasets/corpus.h"
#include "datasets/paths.h"
#include "datasets/separate_process.h"
#include "datasets/shape_file.h"
#include "datasets/units.h"
#include "harness/commands/verb.h"
#include "harness/plan/motion.h"
#include "process/progress_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>

namespace hausbench {

namespace {

// The models of the project. Reading them takes longer than loading a small one, so all shapes of a command share them.
Catalogue& known_models() {
    static Catalogue models = catalogue();
    return models;
}

}  // namespace

void take_shape_options(CLI::App* verb, ShapeOptions& options) {
    verb->add_option("--columns", options.columns, "columns of x, y and z in a text file of points, by number or name")
        ->type_name("2,3,4");
    verb->add_flag("--drop-invalid", options.drop_invalid,
                   "leaves out points that are not finite, and faces that use them");
    verb->add_option("--unit", options.unit, "converts from the units that files state: mm, m, inch, ... or none")
        ->type_name("UNIT");
    verb->add_option("--up", options.up, "turns from the axes that files state so that this one points up; or none")
        ->type_name("X|Y|Z|none")
        ->check(CLI::IsMember({"X", "Y", "Z", "none"}, CLI::ignore_case));
}

namespace {

LoadedShape load_unconverted(const std::string& name, const LoadOptions& options) {
    ProgressLine progress;
    const auto reading = [&] { progress.draw("reading " + name); };
    if (names_a_file(name)) return load_separately(program_path(), name, options, reading);
    Catalogue& models = known_models();
    models.while_waiting([&] { progress.draw("making model " + name); });
    if (!models.has(name)) {
        if (std::filesystem::exists(name)) return load_separately(program_path(), name, options, reading);
        std::vector<std::string> names;
        for (const ModelInfo& model : models.models()) names.push_back(model.name);
        throw InputError(fmt::format("'{}' is neither a model nor a file{}", name, nearest_hint(name, names)));
    }
    const auto resolved = models.resolve(name);
    models.while_waiting({});
    if (const auto* missing = std::get_if<MissingModel>(&resolved))
        throw InputError(fmt::format("model '{}': {}", name, missing->reason));
    return read_shape(std::get<ResolvedModel>(resolved).shape_file);
}

void expect_vertices(const LoadedShape& loaded, const std::string& why) {
    if (kind_of(loaded.shape) == ShapeKind::surface)
        throw InputError(
            fmt::format("{}: an algebraic surface has no vertices to move: write its polynomial anew", why));
}

// Reads the 16 numbers of a 4 x 4 matrix, row by row; '#' begins a comment.
Pose read_matrix(const std::filesystem::path& file) {
    std::ifstream in(file);
    if (!in || std::filesystem::is_directory(file))
        throw InputError(fmt::format("{}: cannot be opened: name a text file with a 4 x 4 matrix", file.string()));
    std::string all;
    for (std::string line; std::getline(in, line) && all.size() < 10'000;) {
        std::replace(line.begin(), line.end(), ',', ' ');
        all += line.substr(0, line.find('#')) + ' ';
    }
    std::istringstream words(all);
    const auto m = finite_numbers(words, 16);
    if (!m)
        throw InputError(
            fmt::format("{}: is not a 4 x 4 matrix: write four rows of four finite numbers", file.string()));
    if ((*m)[12] != 0 || (*m)[13] != 0 || (*m)[14] != 0 || (*m)[15] != 1)
        throw InputError(
            fmt::format("{}: the last row is {} {} {} {}, not 0 0 0 1: the translation belongs in the last "
                        "column",
                        file.string(), (*m)[12], (*m)[13], (*m)[14], (*m)[15]));
    Pose pose;
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) pose.rotation(i, k) = (*m)[std::size_t(4 * i + k)];
        pose.translation[i] = (*m)[std::size_t(4 * i + 3)];
    }
    return pose;
}

}  // namespace

std::string reading_text(const LoadReport& report) {
    std::string text;
    if (report.precision != "float64") text += fmt::format(", {} coordinates", report.precision);
    const auto also = [&](std::int64_t count, const char* what, const char* end = "") {
        if (count > 0) text += fmt::format(", {} {}{}{}", count, what, count == 1 ? "" : "s", end);
    };
    also(report.segments, "line segment");
    also(report.single_points, "single point");
    also(report.dropped_points, "point", " dropped because not finite");
    also(report.dropped_faces, "face", " dropped with them");
    if (report.unreferenced.value_or(0) > 0)
        text += fmt::format(", {} unreferenced vertices dropped", *report.unreferenced);
    return text;
}

LoadedShape load_named(const std::string& name, const ShapeOptions& options) {
    const std::string columns = has_columns(name) ? options.columns : "";
    LoadedShape loaded = load_unconverted(name, {.columns = columns, .drop_invalid = options.drop_invalid});
    Stated& stated = loaded.report.stated;
    if (options.unit == "none") {
        stated.unit = "";
        stated.micrometres = 0;
    } else if (!options.unit.empty()) {
        const auto unit = unit_named(options.unit);
        if (!unit)
            throw InputError(fmt::format("--unit: '{}' is not a known unit: choose one of {}, or none",
                                         one_line(options.unit), unit_names()));
        expect_vertices(loaded, "--unit");
        convert_to_unit(loaded, *unit, name);
    }
    if (options.up == "none") {
        stated.up = 0;
    } else if (!options.up.empty()) {
        expect_vertices(loaded, "--up");
        convert_to_up(loaded, char(std::toupper(options.up[0])));
    }
    return loaded;
}

void transform(LoadedShape& loaded, const std::filesystem::path& matrix) {
    expect_vertices(loaded, matrix.string());
    const Pose pose = read_matrix(matrix);
    auto* mesh = std::get_if<TriangleMesh>(&loaded.shape);
    Points& points = mesh ? mesh->vertices : std::get<PointSet>(loaded.shape).points;
    points = posed(points, pose);
    if (!points.allFinite())
        throw InputError(
            fmt::format("{}: moves a vertex beyond the largest double: choose smaller numbers", matrix.string()));
    loaded.report.notes.push_back(fmt::format("is moved by the matrix of {}, and rounded", matrix.string()));
}

std::filesystem::path file_behind(const std::string& name) {
    if (names_a_file(name)) return name;
    const Catalogue& models = known_models();
    if (!models.has(name)) return name;
    const ModelInfo* model = &models.find(name);
    while (model->source == "derived") model = &models.find(model->from);
    return model->source == "file" ? model->folder / model->path : std::filesystem::path();
}

}  // namespace hausbench
