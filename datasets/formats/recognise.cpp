// Recognises formats by the first bytes of a file, for messages about files with another format's ending.
#include "datasets/formats/formats.h"
#include "datasets/formats/parse.h"

#include <cstdint>
#include <cstring>

namespace hausbench {
namespace {

struct Start {
    std::string_view begins;  // after blanks, in lower case; a letter may not follow
    std::string_view ending;
    std::string_view has = {};  // must be in the first bytes too
};

constexpr Start starts[] = {
    {"ply", "ply", "element"},
    {"off", "off"},
    {"coff", "off"},
    {"noff", "off"},
    {"stoff", "off"},
    {"solid", "stl", "facet"},
    {"gltf", "glb"},
    {"# vtk datafile", "vtk"},
    {"$meshformat", "msh"},
    {"$nod", "msh"},
    {"meshversionformatted", "mesh"},
    {"# .pcd", "pcd"},
    {"kaydara fbx binary", "fbx"},
    {"; fbx", "fbx"},
    {"#vrml", "wrl"},
    {"mtllib", "obj", "\nv "},
    {"o ", "obj", "\nv "},
    {"v ", "obj", "\nf "},
    {"# blender", "obj", "\nv "},
    {"<vtkfile", "vtp"},
    {"<collada", "dae"},
    {"<amf", "amf"},
};

// Returns the text from the first element of an XML file, or the whole text of any other file.
std::string_view after_prolog(std::string_view text) {
    while (text.starts_with("<?") || text.starts_with("<!--")) {
        const std::size_t end = text.find('>');
        if (end == std::string_view::npos) return "";
        text = text.substr(end + 1);
        text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    }
    return text;
}

bool is_binary_stl(std::string_view bytes) {
    std::uint32_t facets = 0;
    if (bytes.size() < 134) return false;
    std::memcpy(&facets, bytes.data() + 80, sizeof facets);
    return bytes.size() == 84 + 50 * std::uint64_t{facets};
}

// Returns the name of a format, or an empty text.
std::string_view recognised(std::string_view bytes) {
    if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
    if (bytes.starts_with("PK\3\4")) {
        if (bytes.find("3dmodel.model") != std::string_view::npos) return "3mf";
        return bytes.substr(0, 256).find(".amf") == std::string_view::npos ? "" : "amf";
    }
    if (is_binary_stl(bytes)) return "stl";
    std::string_view text = bytes.substr(0, 4096);
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    const std::string lower = readers::lower_case(after_prolog(text));
    for (const Start& start : starts) {
        const char next = lower.size() > start.begins.size() ? lower[start.begins.size()] : '\n';
        const bool word_ends = start.begins.ends_with(' ') || next < 'a' || next > 'z';
        if (lower.starts_with(start.begins) && word_ends && lower.find(start.has) != std::string::npos)
            return start.ending;
    }
    if (lower.starts_with('{') && lower.find("\"asset\"") != std::string::npos) return "gltf";
    const std::size_t section = lower.find("section");
    if (lower.starts_with("0") && section != std::string::npos && section < 8) return "dxf";
    return "";
}

}  // namespace

const Format* recognised_format(std::string_view bytes) { return find_format(recognised(bytes)); }

}  // namespace hausbench
