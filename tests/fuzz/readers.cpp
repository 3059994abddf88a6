// Reads a mesh or points with load_file(), which must give a valid shape or an InputError. First byte:
// the format; the rest: the file.
#include "datasets/load.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/target.h"

#include <vector>

namespace hausbench::fuzz {
namespace {

// Checks the shape without shape_problem(), which the program uses and which may be wrong.
void expect_valid(const LoadedShape& loaded) {
    const Points& points = points_of(loaded.shape);
    expect(points.rows() > 0, "a shape without points");
    expect(points.allFinite(), "a coordinate that is not finite");
    if (kind_of(loaded.shape) != ShapeKind::mesh) return;
    const Triangles& triangles = mesh_of(loaded.shape).triangles;
    expect(triangles.rows() > 0, "a mesh without triangles");
    std::vector<bool> used(static_cast<std::size_t>(points.rows()), false);
    for (const Index corner : triangles.reshaped<Eigen::RowMajor>()) {
        expect(corner >= 0 && corner < points.rows(), "an index out of range");
        used[static_cast<std::size_t>(corner)] = true;
    }
    for (const bool one : used) expect(one, "a vertex of no triangle");
}

void readers(std::string_view bytes) {
    static const std::vector<std::string> formats = {"off", "obj", "stl", "ply", "xyz", "pts", "csv", "pcd", "wrl"};
    if (bytes.empty()) return;
    const auto format = static_cast<std::uint8_t>(bytes[0]) % formats.size();
    const MemoryFile file(bytes.substr(1));
    try {
        const LoadedShape loaded = load_file(file.path(), {.format = formats[format]});
        expect_valid(loaded);
        expect(loaded.report.format == formats[format], "the report names another format");
    } catch (const InputError& error) {
        expect_one_line(error);
    }
}

}  // namespace
}  // namespace hausbench::fuzz

HAUSBENCH_FUZZ_TARGET(readers)
