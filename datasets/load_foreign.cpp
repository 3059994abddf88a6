#include "datasets/readers.h"
#include "datasets/surface_file.h"

namespace hausbench::readers {

LoadedShape load_foreign(const std::filesystem::path& file, const std::string& format) {
    if (format != "surface") return load_with_assimp(file, format);
    LoadedShape loaded{read_surface_file(file), {}};
    loaded.report.format = "surface";
    return loaded;
}

}  // namespace hausbench::readers
