// Reads 3D Studio files (.3ds), which are chunks in chunks: the triangles of every mesh in the 3D editor section,
// hidden or not; a note names a hidden one. A mesh without faces is a set of points. Ignores materials, smoothing
// groups, lights and cameras.
//
// No public specification exists. By the convention of the format, which lib3ds and assimp share, the vertices of a
// mesh (chunk 4110) are in world coordinates; its local axes (4160) do not move them. The keyframer section (B000)
// describes an animation, which in files of usual exporters begins where the vertices are. It is left out, with a note.
// The master scale (0100) changes no coordinate; assimp divides by it, lib3ds does not.
//
// Refuses meshes whose local axes are left-handed, because lib3ds and assimp mirror such a mesh and other programs do
// not, and meshes that several nodes of the keyframer repeat.
//
// Unit: none. Axes: not stated; z points up in 3D Studio. Coordinates are the float32 numbers of the file.
#include "algorithms/error.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace hausbench::readers {
namespace {

enum ChunkId : std::uint16_t {
    main_chunk = 0x4d4d,
    project = 0xc23d,
    editor = 0x3d3d,
    master_scale = 0x0100,
    object = 0x4000,
    object_hidden = 0x4010,
    mesh_chunk = 0x4100,
    vertex_list = 0x4110,
    face_list = 0x4120,
    local_axes = 0x4160,
    keyframer = 0xb000,
    object_node = 0xb002,
    node_name = 0xb010,
};

struct Chunk {
    std::uint16_t id = 0;
    std::string_view body;  // without the id and length
    std::size_t at = 0;     // in the file, in bytes
};

class ThreeDs {
public:
    explicit ThreeDs(const Input& input) : name_(input.name), bytes_(input.bytes) {
        static_assert(std::endian::native == std::endian::little);
        soup_.objects = 0;
        soup_.float32 = true;
    }

    Soup read() {
        const std::uint16_t first = bytes_.size() < 6 ? 0 : number<std::uint16_t>(bytes_);
        if (first != main_chunk && first != project)
            throw InputError(name_ + ": is not a 3D Studio file: it does not begin with the chunk 4D4D");
        std::string_view rest = bytes_;
        const Chunk whole = next(rest);  // bytes after it are ignored
        for (std::string_view in = whole.body; !in.empty();) {
            const Chunk chunk = next(in);
            if (chunk.id == editor) read_editor(chunk.body);
            if (chunk.id == keyframer) read_keyframer(chunk.body);
        }
        check_instances();
        if (objects_.empty())
            throw InputError(name_ + ": holds no mesh: export one, or convert the file to OBJ or PLY");
        return std::move(soup_);
    }

private:
    [[noreturn]] void refuse_at(std::size_t at, const std::string& why) const {
        throw InputError(fmt::format("{}: byte {}: {}", name_, at, why));
    }
    std::size_t place(std::string_view in) const { return static_cast<std::size_t>(in.data() - bytes_.data()); }

    template <class Number> static Number number(std::string_view in, std::size_t at = 0) {
        Number value;
        std::memcpy(&value, in.data() + at, sizeof value);
        return value;
    }

    // Removes the next chunk from `in` and returns it.
    Chunk next(std::string_view& in) const {
        const std::size_t at = place(in);
        if (in.size() < 6) refuse_at(at, "a chunk ends too early: the file is damaged, fetch or save it again");
        const auto id = number<std::uint16_t>(in);
        const std::size_t size = number<std::uint32_t>(in, 2);
        if (size < 6 || size > in.size())
            refuse_at(at, fmt::format("chunk {:04X} announces {} bytes, and there are {}: the file is truncated or "
                                      "damaged, fetch or save it again",
                                      id, size, in.size()));
        const Chunk chunk{id, in.substr(6, size - 6), at};
        in.remove_prefix(size);
        return chunk;
    }

    // Removes a text that ends with a zero byte from `in` and returns it.
    std::string_view text(std::string_view& in) const {
        const std::size_t size = in.find('\0');
        if (size == std::string_view::npos) refuse_at(place(in), "a name does not end: the file is damaged");
        const std::string_view content = in.substr(0, size);
        in.remove_prefix(size + 1);
        return content;
    }

    void read_editor(std::string_view in) {
        while (!in.empty()) {
            const Chunk chunk = next(in);
            if (chunk.id == object) read_object(chunk.body);
            if (chunk.id != master_scale) continue;
            const float scale = chunk.body.size() < 4 ? 1 : number<float>(chunk.body);
            if (scale != 1 && scale != 0 && !std::exchange(scale_noted_, true))
                soup_.notes.push_back(fmt::format("has the master scale {}, which changes no coordinate", scale));
        }
    }

    void read_object(std::string_view in) {
        const std::string_view called = text(in);
        bool hidden = false, mesh = false;
        while (!in.empty()) {
            const Chunk chunk = next(in);
            hidden = hidden || chunk.id == object_hidden;
            mesh = mesh || chunk.id == mesh_chunk;
            if (chunk.id == mesh_chunk) read_mesh(called, chunk);
        }
        if (hidden && mesh && hidden_++ == 0) first_hidden_ = shown(called);
    }

    void read_mesh(std::string_view called, const Chunk& mesh) {
        const std::size_t first = soup_.points.size(), faces_before = soup_.faces.size();
        bool vertices = false, faces = false;
        Chunk face_chunk;
        for (std::string_view in = mesh.body; !in.empty();) {
            const Chunk chunk = next(in);
            if ((chunk.id == vertex_list && std::exchange(vertices, true)) ||
                (chunk.id == face_list && std::exchange(faces, true)))
                refuse_at(chunk.at, fmt::format("mesh '{}' has two chunks {:04X}: the file is damaged", shown(called),
                                                std::uint16_t{chunk.id}));
            if (chunk.id == vertex_list) add_vertices(chunk);
            if (chunk.id == face_list) face_chunk = chunk;
            if (chunk.id == local_axes) check_axes(called, chunk);
        }
        if (faces) add_faces(called, face_chunk, first);
        const std::size_t points = soup_.points.size() - first;
        if (soup_.faces.size() == faces_before && points > 0) {
            for (std::size_t i = 0; i < points; ++i) soup_.faces.push_back({first + i});
            if (without_faces_++ == 0)
                soup_.notes.push_back(
                    fmt::format("mesh '{}' has no faces: its vertices count as points", shown(called)));
        }
        ++soup_.objects;
        ++objects_[called];
    }

    // Returns the number of elements at the beginning of a list, which have this size in bytes.
    std::size_t count_of(const Chunk& chunk, std::size_t size) const {
        const std::size_t count = chunk.body.size() < 2 ? 0 : number<std::uint16_t>(chunk.body);
        if (chunk.body.size() < 2 || (chunk.body.size() - 2) / size < count)
            refuse_at(chunk.at,
                      fmt::format("chunk {:04X} announces {} elements of {} bytes, and has {} bytes: the file "
                                  "is damaged, fetch or save it again",
                                  chunk.id, count, size, chunk.body.size()));
        return count;
    }

    void add_vertices(const Chunk& chunk) {
        const std::size_t count = count_of(chunk, 12);
        for (std::size_t i = 0; i < count; ++i) {
            const auto xyz = number<std::array<float, 3>>(chunk.body, 2 + 12 * i);
            soup_.points.emplace_back(xyz[0], xyz[1], xyz[2]);
        }
    }

    // Adds faces of three indices and a flag each. `first` is the index in the soup of the mesh's vertex 0.
    void add_faces(std::string_view called, const Chunk& chunk, std::size_t first) {
        const std::size_t count = count_of(chunk, 8), points = soup_.points.size() - first;
        for (std::size_t i = 0; i < count; ++i) {
            const auto corners = number<std::array<std::uint16_t, 3>>(chunk.body, 2 + 8 * i);
            auto& face = soup_.faces.emplace_back();
            for (const std::size_t v : corners) {
                if (v >= points)
                    refuse_at(chunk.at, fmt::format("face {} (from 0) of mesh '{}' names vertex {} (from 0), but there "
                                                    "are {}",
                                                    i, shown(called), v, points));
                face.push_back(first + v);
            }
        }
    }

    // Refuses left-handed axes: three vectors, and the origin.
    void check_axes(std::string_view called, const Chunk& chunk) const {
        if (chunk.body.size() < 48) refuse_at(chunk.at, "chunk 4160 has fewer than 48 bytes: the file is damaged");
        const auto v = number<std::array<float, 9>>(chunk.body);
        const Vec3 x(v[0], v[1], v[2]), y(v[3], v[4], v[5]), z(v[6], v[7], v[8]);
        if (x.cross(y).dot(z) < 0)
            refuse_at(chunk.at,
                      fmt::format("the local axes of mesh '{}' are left-handed, and programs differ on whether "
                                  "that mirrors its vertices: reset its transform in the program that wrote "
                                  "the file, or export OBJ",
                                  shown(called)));
    }

    void read_keyframer(std::string_view in) {
        while (!in.empty()) {
            const Chunk node = next(in);
            if (node.id != object_node) continue;
            for (std::string_view inner = node.body; !inner.empty();) {
                const Chunk chunk = next(inner);
                std::string_view body = chunk.body;
                if (chunk.id == node_name) ++nodes_[text(body)];
            }
        }
    }

    // Refuses meshes that the keyframer shows more often than they are in the file.
    void check_instances() {
        bool animated = false;
        for (const auto& [called, count] : nodes_) {
            const auto mesh = objects_.find(called);
            if (mesh == objects_.end()) continue;  // a dummy, which groups others
            animated = true;
            if (count > mesh->second)
                throw InputError(
                    fmt::format("{}: {} nodes of the keyframer repeat mesh '{}', which is not supported: "
                                "make the instances unique in the program that wrote the file, or export "
                                "OBJ",
                                name_, count, shown(called)));
        }
        if (animated)
            soup_.notes.emplace_back("its keyframer section (animation) is left out: the vertices of the meshes count");
        if (hidden_ > 0)
            soup_.notes.push_back(
                hidden_ == 1 ? fmt::format("the hidden mesh '{}' is read", first_hidden_)
                             : fmt::format("the hidden mesh '{}' and {} more are read", first_hidden_, hidden_ - 1));
        if (without_faces_ > 1) soup_.notes.push_back(fmt::format("{} more meshes have no faces", without_faces_ - 1));
    }

    const std::string& name_;
    const std::string_view bytes_;
    Soup soup_;
    std::map<std::string_view, std::size_t> objects_, nodes_;  // number of meshes and nodes with a name
    std::size_t without_faces_ = 0, hidden_ = 0;
    std::string first_hidden_;
    bool scale_noted_ = false;
};

}  // namespace

Soup read_3ds(const Input& input) { return ThreeDs(input).read(); }

}  // namespace hausbench::readers
