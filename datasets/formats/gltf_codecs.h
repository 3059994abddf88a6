// Compressed geometry in glTF files; private to datasets/. The program decodes it (gltf_codecs.cpp). The C library
// links neither meshoptimizer nor Draco; its definitions refuse.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench::readers {

// The data of a bufferView, as compressed by EXT_meshopt_compression or KHR_meshopt_compression.
struct MeshoptStream {
    const char* extension = "";  // its name
    std::string_view bytes;      // compressed
    std::size_t count = 0, stride = 0;
    std::string mode;    // ATTRIBUTES, TRIANGLES or INDICES
    std::string filter;  // NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL
};

// Returns the count * stride bytes of the bufferView. Throws InputError, with a message that begins with `place`: the
// file and the bufferView.
std::string decode_meshopt(const std::string& place, const MeshoptStream& stream);

// The size of a mesh that a primitive announces, and where its positions are.
struct DracoStream {
    std::string_view bytes;  // compressed
    std::size_t points = 0, corners = 0;
    std::uint32_t attribute = 0;  // the unique id of the positions
    int component = 0;            // their component type in glTF, such as 5126 (FLOAT)
};

struct DracoMesh {
    std::string positions;               // three components of the announced type for each point, tightly packed
    std::vector<std::uint32_t> corners;  // three for each triangle, below the number of points
};

// Decodes a mesh of KHR_draco_mesh_compression. Throws InputError, with a message that begins with `place`: the file
// and the bufferView.
DracoMesh decode_draco(const std::string& place, const DracoStream& stream);

}  // namespace hausbench::readers
