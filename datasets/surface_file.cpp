#include "datasets/surface_file.h"

#include "algorithms/kernel/polynomial.h"

#include <fmt/format.h>

namespace hausbench {

AlgebraicSurface read_surface(const TomlReader& table) {
    if (!table.find("polynomial"))
        table.fail("has no 'polynomial': write one as text, such as polynomial = \"x^2 + y^2 + z^2 - 1\"");
    AlgebraicSurface surface{table.text("polynomial"), Points(2, 3)};
    const toml::node* node = table.find("box");
    const toml::array* box = node ? node->as_array() : nullptr;
    bool good = box && box->size() == 3;
    for (std::size_t k = 0; k < 3 && good; ++k) {
        const toml::array* pair = (*box)[k].as_array();
        good = pair && pair->size() == 2;
        for (std::size_t i = 0; i < 2 && good; ++i)
            surface.box(Eigen::Index(i), Eigen::Index(k)) = table.number((*pair)[i], "box");
    }
    if (!good && node)
        table.fail(*node, "'box' must be three pairs of numbers, such as box = [[-2, 2], [-2, 2], [-2, 2]]");
    if (!good) table.fail("'box' must be three pairs of numbers, such as box = [[-2, 2], [-2, 2], [-2, 2]]");
    if (const std::string problem = surface_problem(surface); !problem.empty())
        table.fail(*table.find(problem.starts_with("polynomial") ? "polynomial" : "box"), problem);
    return surface;
}

AlgebraicSurface read_surface_file(const std::filesystem::path& file) {
    const toml::table content = parse_toml(file);
    const TomlReader table(file, content);
    table.allow({"polynomial", "box"});
    table.refuse_other_keys();
    return read_surface(table);
}

std::string describe(const AlgebraicSurface& s) {
    return fmt::format("{} = 0 in [{}, {}] x [{}, {}] x [{}, {}]", s.polynomial, s.box(0, 0), s.box(1, 0), s.box(0, 1),
                       s.box(1, 1), s.box(0, 2), s.box(1, 2));
}

}  // namespace hausbench
