#include "harness/run/mesh_file.h"

#include "algorithms/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iterator>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

// Writes text to FILE.unfinished, a megabyte at a time. finish() renames it to FILE; the destructor removes a file that
// was not finished.
class Writer {
public:
    explicit Writer(fs::path file) : file_(std::move(file)), unfinished_(file_.string() + ".unfinished") {
        stream_ = std::fopen(unfinished_.c_str(), "wb");
        if (!stream_) fail();
    }
    ~Writer() {
        if (!stream_) return;
        std::fclose(stream_);
        std::error_code ignored;
        fs::remove(unfinished_, ignored);
    }
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;

    template <class... Arguments> void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
        fmt::format_to(std::back_inserter(buffer_), format, std::forward<Arguments>(arguments)...);
        if (buffer_.size() > (std::size_t(1) << 20)) flush();
    }

    void finish() {
        flush();
        const bool closed = std::fclose(stream_) == 0;
        stream_ = nullptr;
        std::error_code failed;
        if (closed) fs::rename(unfinished_, file_, failed);
        if (!closed || failed) {
            if (failed) errno = failed.value();
            std::error_code ignored;
            fs::remove(unfinished_, ignored);
            fail();
        }
    }

private:
    [[noreturn]] void fail() const {
        throw InputError(fmt::format("{}: cannot be written ({}): choose another place, or make room", file_.string(),
                                     std::strerror(errno)));
    }
    void flush() {
        if (std::fwrite(buffer_.data(), 1, buffer_.size(), stream_) != buffer_.size()) fail();
        buffer_.clear();
    }

    fs::path file_, unfinished_;
    std::FILE* stream_ = nullptr;
    fmt::memory_buffer buffer_;
};

}  // namespace

MeshFormat mesh_format_of(const fs::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    if (extension == ".off") return MeshFormat::off;
    if (extension == ".obj") return MeshFormat::obj;
    if (extension == ".ply") return MeshFormat::ply;
    throw InputError(
        fmt::format("{}: only .off, .obj and .ply can be written: end the name with one of them", file.string()));
}

void write_mesh_file(const fs::path& file, const Shape& shape, MeshFormat format) {
    if (kind_of(shape) == ShapeKind::surface) {
        throw InputError(fmt::format(
            "{}: an algebraic surface has no triangles to write: export a model derived from it by 'triangulate'",
            file.string()));
    }
    const Points& points = points_of(shape);
    const auto* mesh = std::get_if<TriangleMesh>(&shape);
    const Index faces = mesh ? Index(mesh->triangles.rows()) : 0;
    Writer out(file);
    if (format == MeshFormat::off) out.add("OFF\n{} {} 0\n", points.rows(), faces);
    if (format == MeshFormat::ply) {
        out.add("ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n",
                points.rows());
        if (mesh) out.add("element face {}\nproperty list uchar int vertex_indices\n", faces);
        out.add("end_header\n");
    }
    const char* before = format == MeshFormat::obj ? "v " : "";
    for (Index i = 0; i < points.rows(); ++i)
        out.add("{}{:.17g} {:.17g} {:.17g}\n", before, points(i, 0), points(i, 1), points(i, 2));
    const char* corners = format == MeshFormat::obj ? "f" : "3";
    const Index first = format == MeshFormat::obj ? 1 : 0;
    for (Index i = 0; i < faces; ++i) {
        const auto row = mesh->triangles.row(i);
        out.add("{} {} {} {}\n", corners, row[0] + first, row[1] + first, row[2] + first);
    }
    out.finish();
}

}  // namespace hausbench
