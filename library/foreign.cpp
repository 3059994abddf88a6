// Readers that need a library which only the program links, see datasets/formats/readers.h: here they refuse.
#include "algorithms/error.h"
#include "datasets/formats/gltf_codecs.h"
#include "datasets/formats/readers.h"

namespace hausbench::readers {

LoadedShape read_surface(const std::filesystem::path& file) {
    throw InputError(file.string() + ": algebraic surfaces are read by the program alone: use `hausbench measure`");
}

std::string decode_meshopt(const std::string& place, const MeshoptStream&) {
    throw InputError(place +
                     ": meshopt compression is read by the program alone: convert the file with `hausbench export`, "
                     "or with gltfpack without -c");
}

DracoMesh decode_draco(const std::string& place, const DracoStream&) {
    throw InputError(place +
                     ": KHR_draco_mesh_compression is read by the program alone: convert the file with `hausbench "
                     "export`, or write it without compression");
}

}  // namespace hausbench::readers
