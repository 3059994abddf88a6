// Readers that the program has, and the C library has not.
#include "datasets/formats/readers.h"
#include "datasets/surface_file.h"

namespace hausbench::readers {

LoadedShape read_surface(const std::filesystem::path& file) {
    LoadedShape loaded{read_surface_file(file), {}};
    loaded.report.format = "surface";
    return loaded;
}

}  // namespace hausbench::readers
