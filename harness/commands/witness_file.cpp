#include "harness/commands/witness_file.h"

#include "algorithms/error.h"
#include "process/whole_file.h"

#include <fmt/format.h>

#include <string>

namespace hausbench {

namespace {

// The text before and after the two points, and the word before each point.
struct Layout {
    std::string head, word, tail;
};

// Returns the layout for the extension of a file, or null if there is none.
const Layout* layout_of(const std::filesystem::path& file) {
    const std::string about = "the witness: a point of A, then a point of B\n";
    static const Layout ply = {"ply\nformat ascii 1.0\ncomment " + about +
                                   "element vertex 2\nproperty double x\nproperty double y\nproperty double z\n"
                                   "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n",
                               "", "0 1\n"};
    static const Layout vtk = {"# vtk DataFile Version 3.0\n" + about + "ASCII\nDATASET POLYDATA\nPOINTS 2 double\n",
                               "", "LINES 1 3\n2 0 1\n"};
    static const Layout obj = {"# " + about, "v ", "l 1 2\n"};
    const std::string extension = file.extension().string();
    return extension == ".ply" ? &ply : extension == ".vtk" ? &vtk : extension == ".obj" ? &obj : nullptr;
}

}  // namespace

void check_witness_place(const std::filesystem::path& file) {
    if (!layout_of(file))
        throw InputError(fmt::format("--witness {}: end the name with .ply, .vtk or .obj", file.string()));
    check_place_to_write(file);
}

void write_witness(const std::filesystem::path& file, const Vec3& on_a, const Vec3& on_b) {
    const Layout& layout = *layout_of(file);
    std::string text = layout.head;
    for (const Vec3& p : {on_a, on_b}) text += fmt::format("{}{} {} {}\n", layout.word, p[0], p[1], p[2]);
    write_whole_file(file, text + layout.tail);
}

}  // namespace hausbench
