#include "datasets/units.h"

#include "algorithms/error.h"
#include "datasets/formats/parse.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace hausbench {
namespace {

struct Names {
    Unit unit;
    std::vector<std::string_view> others;
};

const std::vector<Names>& units() {
    static const std::vector<Names> all = {
        {{"um", 1},
         {"micron", "microns", "micrometer", "micrometers", "micrometre", "micrometres", "\xc2\xb5m", "\xce\xbcm"}},
        {{"mm", 1e3}, {"millimeter", "millimeters", "millimetre", "millimetres"}},
        {{"cm", 1e4}, {"centimeter", "centimeters", "centimetre", "centimetres"}},
        {{"dm", 1e5}, {"decimeter", "decimeters", "decimetre", "decimetres"}},
        {{"m", 1e6}, {"meter", "meters", "metre", "metres"}},
        {{"km", 1e9}, {"kilometer", "kilometers", "kilometre", "kilometres"}},
        {{"inch", 25400}, {"in", "inches", "\""}},
        {{"ft", 304800}, {"foot", "feet", "'"}},
        {{"us-ft", 1200e6 / 3937},  // the US survey foot
         {"us ft", "us_ft", "usft", "ftus", "ft us", "ft_us", "us foot", "us feet", "us survey ft", "us survey foot",
          "us survey feet", "u.s. survey foot", "u.s. survey feet", "survey foot", "survey feet"}},
        {{"yd", 914400}, {"yard", "yards"}},
        {{"mile", 1609344000}, {"mi", "miles"}},
        {{"mil", 25.4}, {"thou", "mils"}},
        {{"nm", 1e-3}, {"nanometer", "nanometers", "nanometre", "nanometres"}},
    };
    return all;
}

// The directions to the right, up and towards the viewer, each as an axis and a sign.
struct Axes {
    int right, up, toward;
    double right_sign;
    double toward_sign;
};

Axes axes_of(char up) {
    if (up == 'X') return {1, 0, 2, -1, 1};
    if (up == 'Y') return {0, 1, 2, 1, 1};
    return {0, 2, 1, 1, -1};
}

template <class Change> void change_points(Shape& shape, const Change& change) {
    if (auto* mesh = std::get_if<TriangleMesh>(&shape)) change(mesh->vertices);
    if (auto* points = std::get_if<PointSet>(&shape)) change(points->points);
}

}  // namespace

std::optional<Unit> unit_named(std::string_view name) {
    // No nanometres, but nautical miles or newton metres; perhaps megametres.
    if (name == "NM" || name == "Nm" || name == "Mm") return std::nullopt;
    const std::string lower = readers::lower_case(name);
    for (const Names& names : units())
        if (names.unit.name == lower ||
            std::find(names.others.begin(), names.others.end(), lower) != names.others.end())
            return names.unit;
    return std::nullopt;
}

Stated stated_unit(const Unit& unit) { return {std::string(unit.name), unit.micrometres, 0}; }

Stated unit_stated_as(std::string_view name) {
    const auto unit = unit_named(name);
    return unit ? stated_unit(*unit) : Stated{std::string(name), 0, 0};
}

bool units_differ(const Stated& a, const Stated& b) {
    if (a.unit.empty() || b.unit.empty()) return false;
    return a.micrometres != b.micrometres || (a.micrometres == 0 && a.unit != b.unit);
}

Stated stated_unit(double metres) {
    for (const Names& names : units()) {
        const double length = names.unit.micrometres;  // the number in the file may be rounded in any of these ways
        if (length / 1e6 == metres || length * 1e-6 == metres || length == metres * 1e6) return stated_unit(names.unit);
    }
    return {fmt::format("{} m", metres), metres * 1e6, 0};
}

std::string unit_names() {
    std::string text;
    for (const Names& names : units()) text += (text.empty() ? "" : ", ") + std::string(names.unit.name);
    return text;
}

void convert_to_unit(LoadedShape& loaded, const Unit& unit, const std::string& name) {
    Stated& stated = loaded.report.stated;
    if (stated.micrometres == 0 && !stated.unit.empty())
        throw InputError(
            fmt::format("{}: states the unit '{}', which is not known: write its coordinates in one of {}, or compare "
                        "the numbers as they stand with --unit none (in Python unit=\"none\")",
                        name, one_line(stated.unit), unit_names()));
    if (stated.micrometres == 0)
        loaded.report.notes.push_back(fmt::format("states no unit: its numbers count as {}", unit.name));
    else if (stated.micrometres != unit.micrometres) {
        const double factor = stated.micrometres / unit.micrometres;
        change_points(loaded.shape, [&](Points& points) { points *= factor; });
        if (!points_of(loaded.shape).allFinite())
            throw InputError(
                fmt::format("{}: a coordinate in {} is too large for a double: choose a larger unit", name, unit.name));
        loaded.report.notes.push_back(
            fmt::format("its coordinates are multiplied by {} ({} / {}), and rounded", factor, stated.unit, unit.name));
    }
    const char up = stated.up;
    stated = stated_unit(unit);
    stated.up = up;
}

void convert_to_up(LoadedShape& loaded, char up) {
    char& stated = loaded.report.stated.up;
    if (stated == 0) {
        loaded.report.notes.push_back(fmt::format("does not state which axis points up: {} counts as up", up));
    } else if (stated != up) {
        const Axes from = axes_of(stated), to = axes_of(up);
        change_points(loaded.shape, [&](Points& points) {
            const Points before = points;
            points.col(to.right) = to.right_sign * from.right_sign * before.col(from.right);
            points.col(to.up) = before.col(from.up);
            points.col(to.toward) = to.toward_sign * from.toward_sign * before.col(from.toward);
        });
        loaded.report.notes.push_back(fmt::format("is turned: {} pointed up, and now {} does", stated, up));
    }
    stated = up;
}

}  // namespace hausbench
