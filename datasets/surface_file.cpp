#include "surface_file.h"

#include "error.h"
#include "kernel/polynomial.h"

#include <fmt/format.h>

namespace hausbench {

AlgebraicSurface surface_of(const toml::table& table, const std::string& where) {
    AlgebraicSurface surface;
    const auto text = table["polynomial"].value_exact<std::string>();
    if (!text)
        throw InputError(where +
                         ": has no 'polynomial': write one as text, such as polynomial = \"x^2 + y^2 + z^2 - 1\"");
    surface.polynomial = *text;
    surface.box.resize(2, 3);
    const toml::array* box = table["box"].as_array();
    bool good = box && box->size() == 3;
    for (std::size_t k = 0; k < 3 && good; ++k) {
        const toml::array* pair = (*box)[k].as_array();
        good = pair && pair->size() == 2 && (*pair)[0].is_number() && (*pair)[1].is_number();
        for (std::size_t i = 0; i < 2 && good; ++i)
            surface.box(Eigen::Index(i), Eigen::Index(k)) = *(*pair)[i].value<double>();
    }
    if (!good)
        throw InputError(where + ": 'box' must be three pairs of numbers, such as box = [[-2, 2], [-2, 2], [-2, 2]]");
    if (const std::string problem = surface_problem(surface); !problem.empty())
        throw InputError(where + ": " + problem);
    return surface;
}

AlgebraicSurface read_surface_file(const std::filesystem::path& file) {
    toml::table table;
    try {
        table = toml::parse_file(file.string());
    } catch (const toml::parse_error& error) {
        throw InputError(fmt::format("{}: line {}: {}", file.string(), error.source().begin.line, error.description()));
    }
    for (const auto& [key, node] : table) {
        if (key.str() != "polynomial" && key.str() != "box") {
            throw InputError(fmt::format("{}: line {}: unknown key '{}'{}", file.string(), node.source().begin.line,
                                         key.str(), nearest_hint(key.str(), {"polynomial", "box"})));
        }
    }
    return surface_of(table, file.string());
}

std::string describe(const AlgebraicSurface& s) {
    return fmt::format("{} = 0 in [{}, {}] x [{}, {}] x [{}, {}]", s.polynomial, s.box(0, 0), s.box(1, 0), s.box(0, 1),
                       s.box(1, 1), s.box(0, 2), s.box(1, 2));
}

}  // namespace hausbench
