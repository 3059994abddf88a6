// Reads a mesh or points with load_file(), which must give a valid shape or an InputError. The first line names the
// ending of the format, and may have the options `drop` and `columns=...`; the rest is the file.
#include "datasets/formats/formats.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/target.h"

#include <algorithm>
#include <sstream>
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
    for (const bool is_used : used) expect(is_used, "a vertex of no triangle");
}

void readers(std::string_view bytes) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    std::istringstream words(std::string(bytes.substr(0, end)));
    LoadOptions options;
    words >> options.format;
    for (std::string word; words >> word;) {
        options.drop_invalid = options.drop_invalid || word == "drop";
        if (word.starts_with("columns=")) options.columns = word.substr(8);
    }
    const Format* const format = find_format(options.format);
    if (!format) return;
    const MemoryFile file(bytes.substr(std::min(end + 1, bytes.size())));
    try {
        const LoadedShape loaded = load_file(file.path(), options);
        expect_valid(loaded);
        expect(loaded.report.format == options.format, "the report names another format");
    } catch (const InputError& error) {
        expect_one_line(error);
    }
}

}  // namespace
}  // namespace hausbench::fuzz

HAUSBENCH_FUZZ_TARGET(readers)

#ifdef HAUSBENCH_LIBFUZZER
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

// Changes the file, and keeps its format.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned) {
    const auto* const newline = std::find(data, data + size, std::uint8_t{'\n'});
    const auto head = std::min(static_cast<std::size_t>(newline - data) + 1, size);
    return head + LLVMFuzzerMutate(data + head, size - head, most - head);
}
#endif
