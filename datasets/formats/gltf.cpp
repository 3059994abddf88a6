// Reads glTF 2.0, as .glb and as .gltf with its buffers in data: URIs or in files beside it: the triangles, lines and
// points of the meshes in the default scene, moved by the nodes that contain them.
//
// Reads sparse accessors, KHR_mesh_quantization, EXT_meshopt_compression and KHR_meshopt_compression (but not
// version 1 of its vertex codec), KHR_draco_mesh_compression, EXT_mesh_gpu_instancing, KHR_node_visibility, and morph
// targets with their default weights. Ignores materials, textures, cameras and animations, whose files are never
// opened.
//
// Refuses: skins, every other required extension, several scenes without a default one, and files without a scene,
// because such a file is a collection of parts and does not say which of them are shown.
//
// The unit is the metre, and y points up, as the specification defines.
//
// The error of a coordinate, with u = 2^-53: none for a float32 or an integer under nodes without a transform; u for a
// normalized integer. Each applied morph target adds 3 u of the sum of all |weight * displacement| and |position|. A
// point p under k nodes with a transform is within (20 k + 4) u of |M_1| ... |M_k| |p|, where each entry of a rotation
// counts as 1, and a rotation is the one of the quaternion divided by its length. Draco stores integers on a grid; the
// positions are the float32 numbers that its library computes from them.
#include "algorithms/error.h"
#include "datasets/formats/gltf_codecs.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"
#include "datasets/units.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hausbench::readers {
namespace gltf {
namespace {

using Json = nlohmann::json;

constexpr int deepest = 128;  // levels of JSON

// Limits on a scene, because nodes can repeat a mesh so often that a small file fills the memory. The scene may have
// `parts_a_byte` parts for each byte of its files, and `parts_anyway` parts in any case.
constexpr std::size_t parts_a_byte = 200,
                      parts_anyway = std::size_t{1} << 22;  // a part: a node, point or corner, each time it occurs
constexpr std::size_t meshopt_bytes_a_byte = 64;            // the codec cannot do better

constexpr int byte = 5120, unsigned_byte = 5121, short_integer = 5122, unsigned_short = 5123, unsigned_int = 5125,
              float_number = 5126;

// Extensions that this reader applies.
const std::set<std::string_view> applied = {"KHR_mesh_quantization",
                                            "EXT_meshopt_compression",
                                            "KHR_meshopt_compression",
                                            "EXT_mesh_gpu_instancing",
                                            "KHR_draco_mesh_compression",
                                            "KHR_node_visibility",
                                            "MSFT_lod"};

// Extensions that change colours, lights, textures or data about the model, but no geometry.
const std::set<std::string_view> harmless = {
    "ADOBE_materials_clearcoat_specular",
    "ADOBE_materials_clearcoat_tint",
    "ADOBE_materials_thin_transparency",
    "EXT_instance_features",
    "EXT_lights_ies",
    "EXT_lights_image_based",
    "EXT_mesh_features",
    "EXT_structural_metadata",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MSFT_packing_normalRoughnessMetallic",
    "MSFT_packing_occlusionRoughnessMetallic",
    "MSFT_texture_dds",
};

[[noreturn]] void no(const std::string& place, const std::string& why) { throw InputError(place + ": " + why); }

// --- JSON ------------------------------------------------------------------------------------------------------------

// Returns where a sound JSON object ends before the place of a parse error; the size of the text if none does.
std::size_t end_of_object(std::string_view text, const Json::exception& error) {
    const auto* const at = dynamic_cast<const Json::parse_error*>(&error);
    if (!at || at->byte < 2) return text.size();
    const std::size_t brace = text.rfind('}', at->byte - 2);  // `byte` is the end of a word that cannot follow
    return brace != std::string_view::npos && Json::accept(text.substr(0, brace + 1)) ? brace + 1 : text.size();
}

// Parses JSON. Refuses deep nesting, and a key that an object has twice, because programs differ in which one they
// take.
Json parsed(const std::string& name, std::string_view text) {
    std::vector<std::set<std::string>> keys;
    const auto check = [&](int depth, Json::parse_event_t event, const Json& value) {
        if (depth > deepest)
            throw InputError(fmt::format("{}: its JSON is nested deeper than {} levels: save it again without `extras`",
                                         name, deepest));
        if (event == Json::parse_event_t::object_start) keys.emplace_back();
        if (event == Json::parse_event_t::object_end) keys.pop_back();
        if (event == Json::parse_event_t::key && !keys.back().insert(value.get_ref<const std::string&>()).second)
            throw InputError(fmt::format("{}: an object of its JSON has the key '{}' twice: remove one of them", name,
                                         shown(value.get_ref<const std::string&>())));
        return true;
    };
    // The parser stops at a zero byte. Some programs pad the JSON of a .glb file with zero bytes.
    const std::size_t zero = std::min(text.find('\0'), text.size());
    if (text.find_first_not_of('\0', zero) != std::string_view::npos)
        throw InputError(
            fmt::format("{}: its JSON has a zero byte at byte {}: fetch or save the file again", name, zero));
    try {
        return Json::parse(text, check);
    } catch (const Json::exception& error) {
        if (const std::size_t end = end_of_object(text, error); end < text.size())
            throw InputError(
                fmt::format("{}: {} bytes follow the end of its JSON, at byte {}, which is neither JSON nor glTF: "
                            "remove them",
                            name, text.size() - end, end));
        throw InputError(fmt::format("{}: its JSON cannot be parsed: {}: fetch or save the file again", name,
                                     one_line(std::string(error.what()).substr(0, 200))));
    }
}

// An object of the file, and its place for messages.
struct Part {
    const Json* json;
    std::string place;

    // Returns the value of a key, or null.
    const Json* find(const char* key) const {
        const auto at = json->find(key);
        return at == json->end() ? nullptr : &*at;
    }

    std::optional<Part> object(const char* key) const {
        const Json* const value = find(key);
        if (!value) return std::nullopt;
        if (!value->is_object()) no(place, fmt::format("'{}' is not an object", key));
        return Part{value, place};
    }

    // Returns the members of an array; none if there is no such key.
    const Json& array(const char* key) const {
        static const Json none = Json::array();
        const Json* const value = find(key);
        if (!value) return none;
        if (!value->is_array()) no(place, fmt::format("'{}' is not an array", key));
        return *value;
    }

    std::optional<std::size_t> integer(const char* key) const {
        const Json* const value = find(key);
        if (!value) return std::nullopt;
        return count(*value, key);
    }

    std::optional<std::size_t> integer(const char* object_key, const char* key) const {
        if (const auto inner = object(object_key)) return inner->integer(key);
        return std::nullopt;
    }

    std::size_t required(const char* key) const {
        const auto value = integer(key);
        if (!value) no(place, fmt::format("has no '{}', which the format requires: save the file again", key));
        return *value;
    }

    std::size_t count(const Json& value, const char* key) const {
        const double number = value.is_number() ? value.get<double>() : -1;
        if (!(number >= 0 && number <= 0x1p53 && std::floor(number) == number))
            no(place, fmt::format("'{}' is not a count or an index: save the file again", key));
        return static_cast<std::size_t>(number);
    }

    std::string text(const char* key) const {
        const Json* const value = find(key);
        if (!value) return "";
        if (!value->is_string()) no(place, fmt::format("'{}' is not a string", key));
        return value->get<std::string>();
    }

    bool yes(const char* key, bool unless_given = false) const {
        const Json* const value = find(key);
        if (!value) return unless_given;
        if (!value->is_boolean()) no(place, fmt::format("'{}' is neither true nor false", key));
        return value->get<bool>();
    }

    std::vector<double> numbers(const char* key) const {
        std::vector<double> all;
        for (const Json& value : array(key)) {
            if (!value.is_number()) no(place, fmt::format("'{}' has a value that is not a number", key));
            all.push_back(value.get<double>());
        }
        return all;
    }

    // Returns the numbers of a key. If there is no such key, each is `unless_given`.
    template <std::size_t n> std::array<double, n> vector(const char* key, std::array<double, n> unless_given) const {
        if (!find(key)) return unless_given;
        const std::vector<double> all = numbers(key);
        if (all.size() != n) no(place, fmt::format("'{}' has {} numbers, not {}", key, all.size(), n));
        std::copy(all.begin(), all.end(), unless_given.begin());
        return unless_given;
    }

    std::optional<Part> extension(const char* name) const {
        const auto all = object("extensions");
        return all ? all->object(name) : std::nullopt;
    }
};

// --- bytes -----------------------------------------------------------------------------------------------------------

struct Container {
    std::string_view json;
    std::optional<std::string_view> binary;  // the BIN chunk
    std::size_t after = 0;                   // bytes after the end that a .glb states
};

std::size_t little_endian(std::string_view bytes, std::size_t at) {
    std::size_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value * 256 + static_cast<unsigned char>(bytes[at + i]);
    return value;
}

Container opened(const std::string& name, std::string_view bytes) {
    if (!bytes.starts_with("glTF")) return {bytes, std::nullopt, 0};
    if (bytes.size() < 12) no(name, "ends inside of its header: it is truncated, fetch or save it again");
    const std::size_t version = little_endian(bytes, 4), length = little_endian(bytes, 8);
    if (version != 2)
        no(name, fmt::format("is GLB of version {}, only 2 is supported: convert it with `gltf-pipeline`", version));
    if (length > bytes.size())
        no(name,
           fmt::format("has {} of the {} bytes that its header announces: it is truncated, fetch or save it again",
                       bytes.size(), length));
    Container container;
    container.after = bytes.size() - length;
    bytes = bytes.substr(0, length);
    std::size_t chunks = 0;
    for (std::size_t at = 12; at < bytes.size(); ++chunks) {
        if (bytes.size() - at < 8 || little_endian(bytes, at) > bytes.size() - at - 8)
            no(name, fmt::format("chunk {} (from 0) ends after the end of the file: fetch or save it again", chunks));
        const std::string_view kind = bytes.substr(at + 4, 4), data = bytes.substr(at + 8, little_endian(bytes, at));
        if (chunks == 0 && kind != "JSON") break;
        if (chunks == 0) container.json = data;
        if (chunks == 1 && kind == std::string_view("BIN\0", 4)) container.binary = data;
        at += 8 + data.size();
    }
    if (chunks == 0) no(name, "does not begin with a JSON chunk: fetch or save it again");
    return container;
}

// Returns the bytes that base64 text stands for, or nothing if it is not such text.
std::optional<std::string> from_base64(std::string_view text) {
    static constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    static const std::array<int, 256> values = [] {
        std::array<int, 256> all{};
        all.fill(-1);
        for (std::size_t i = 0; i < digits.size(); ++i)
            all[static_cast<unsigned char>(digits[i])] = static_cast<int>(i);
        return all;
    }();
    for (int i = 0; i < 2 && text.ends_with('='); ++i) text.remove_suffix(1);
    if (text.size() % 4 == 1) return std::nullopt;
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    unsigned bits = 0, pending = 0;
    for (const char c : text) {
        const int value = values[static_cast<unsigned char>(c)];
        if (value < 0) return std::nullopt;
        bits = (bits << 6 | static_cast<unsigned>(value)) & 0xffff;
        pending += 6;
        if (pending < 8) continue;
        pending -= 8;
        bytes.push_back(static_cast<char>(bits >> pending & 0xff));
    }
    return bytes;
}

// Returns the text with %20 and the like replaced, or nothing if a '%' has no two hexadecimal digits.
std::optional<std::string> from_percent(std::string_view text) {
    const auto digit = [](char c) {
        return c >= '0' && c <= '9'   ? c - '0'
               : c >= 'a' && c <= 'f' ? c - 'a' + 10
               : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                      : -1;
    };
    std::string decoded;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            decoded.push_back(text[i]);
            continue;
        }
        if (i + 2 >= text.size() || digit(text[i + 1]) < 0 || digit(text[i + 2]) < 0) return std::nullopt;
        decoded.push_back(static_cast<char>(16 * digit(text[i + 1]) + digit(text[i + 2])));
        i += 2;
    }
    return decoded;
}

std::size_t size_of(int component) {
    switch (component) {
        case byte:
        case unsigned_byte:
            return 1;
        case short_integer:
        case unsigned_short:
            return 2;
        default:
            return 4;
    }
}

template <class Stored> Stored stored(const char* at) {
    Stored value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

// Returns a component of an accessor as the specification defines its value.
double number_at(const char* at, int component, bool normalized) {
    switch (component) {
        case byte: {
            const double value = stored<std::int8_t>(at);
            return normalized ? std::max(value / 127, -1.0) : value;
        }
        case unsigned_byte: {
            const double value = stored<std::uint8_t>(at);
            return normalized ? value / 255 : value;
        }
        case short_integer: {
            const double value = stored<std::int16_t>(at);
            return normalized ? std::max(value / 32767, -1.0) : value;
        }
        case unsigned_short: {
            const double value = stored<std::uint16_t>(at);
            return normalized ? value / 65535 : value;
        }
        case unsigned_int:
            return stored<std::uint32_t>(at);
        default:
            return stored<float>(at);
    }
}

// An array of vectors in a buffer.
struct Accessor {
    std::string place;
    std::size_t count = 0, components = 1;
    int component = float_number;
    bool normalized = false;
    std::string_view data;  // from the first element on; empty: all elements are 0
    std::size_t stride = 0;
    // Elements that differ from `data`, by ascending index.
    std::size_t replaced = 0;
    std::string_view indices, values;
    int index_component = unsigned_int;

    std::size_t element_size() const { return components * size_of(component); }

    std::size_t replaced_index(std::size_t i) const {
        return static_cast<std::size_t>(
            number_at(indices.data() + i * size_of(index_component), index_component, false));
    }

    // Returns component k of element i.
    double operator()(std::size_t i, std::size_t k) const {
        std::size_t from = 0, to = replaced;
        while (from < to) {
            const std::size_t middle = (from + to) / 2;
            if (replaced_index(middle) < i)
                from = middle + 1;
            else
                to = middle;
        }
        const char* at = data.empty() ? nullptr : data.data() + i * stride;
        if (from < replaced && replaced_index(from) == i) at = values.data() + from * element_size();
        return at ? number_at(at + k * size_of(component), component, normalized) : 0;
    }
};

// Gives access to buffers, bufferViews and accessors by their index. Loads and decodes only those that are asked for.
class Data {
public:
    Data(const Input& input, const Part& root, const Container& container, bool needs_meshopt)
        : input_(input),
          root_(root),
          binary_(container.binary),
          needs_meshopt_(needs_meshopt),
          size_(input.bytes.size()) {}

    // Returns an object of a list of the file, such as node 3.
    Part element(const char* list, const char* what, std::size_t index) const {
        const Json& all = root_.array(list);
        if (index >= all.size())
            no(input_.name,
               fmt::format("refers to {} {} (from 0), but there are {}: save the file again", what, index, all.size()));
        const std::string place = fmt::format("{}: {} {} (from 0)", input_.name, what, index);
        if (!all[index].is_object()) no(place, "is not an object");
        return {&all[index], place};
    }

    // Returns whether an accessor has elements of its own. Otherwise they are 0, unless an extension gives them.
    bool has_elements(std::size_t index) const {
        const Part part = element("accessors", "accessor", index);
        return part.find("bufferView") || part.find("sparse");
    }

    const Accessor& accessor(std::size_t index) {
        const auto cached = accessors_.find(index);
        return cached != accessors_.end() ? cached->second : accessors_[index] = read_accessor(index);
    }

    // Returns the bytes of a bufferView.
    std::string_view view(std::size_t index) {
        const Part part = element("bufferViews", "bufferView", index);
        const std::size_t buffer = part.required("buffer");
        for (const char* const name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
            const auto meshopt = part.extension(name);
            if (meshopt && (needs_meshopt_ || !has_data(buffer))) return decompressed(index, part, *meshopt, name);
        }
        if (!has_data(buffer))
            no(part.place, fmt::format("buffer {} (from 0) has no data: save the file again", buffer));
        return range(part, buffer);
    }

    const DracoMesh& draco(std::size_t index, DracoStream stream) {
        const auto key = std::pair(index, stream.attribute);
        const auto cached = meshes_.find(key);
        if (cached != meshes_.end()) return cached->second;
        stream.bytes = view(index);
        const std::string place = fmt::format("{}: bufferView {} (from 0)", input_.name, index);
        return meshes_[key] = decode_draco(place, stream);
    }

    std::size_t size() const { return size_; }  // bytes of all files that were opened

private:
    // Returns the bytes from byteOffset on, byteLength in number, of a buffer.
    std::string_view range(const Part& part, std::size_t buffer) {
        const std::string_view all = bytes(buffer);
        const std::size_t offset = part.integer("byteOffset").value_or(0), length = part.required("byteLength");
        if (offset > all.size() || length > all.size() - offset)
            no(part.place, fmt::format("ends at byte {}, but buffer {} (from 0) has {} bytes: save the file again",
                                       offset + length, buffer, all.size()));
        return all.substr(offset, length);
    }

    bool has_data(std::size_t buffer) const {
        const Part part = element("buffers", "buffer", buffer);
        for (const char* const name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
            if (const auto meshopt = part.extension(name); meshopt && meshopt->yes("fallback") && !part.find("uri"))
                return false;
        return part.find("uri") || (buffer == 0 && binary_);
    }

    std::string_view bytes(std::size_t index) {
        const Part part = element("buffers", "buffer", index);
        const std::size_t length = part.required("byteLength");
        std::string_view all;
        if (part.find("uri"))
            all = resource(part, index);
        else if (index == 0 && binary_)
            all = *binary_;
        else
            no(part.place, "has no data: save the file again");
        if (length > all.size())
            no(part.place,
               fmt::format("has {} bytes, not the {} of its 'byteLength': it is truncated, fetch or save it again",
                           all.size(), length));
        return all.substr(0, length);
    }

    std::string_view resource(const Part& part, std::size_t index) {
        const std::string& uri =
            part.find("uri")->is_string() ? part.find("uri")->get_ref<const std::string&>() : empty_;
        if (uri.starts_with("data:")) {
            const auto cached = inside_.find(index);
            if (cached != inside_.end()) return cached->second;
            const std::size_t comma = uri.find(',');
            const bool base64 =
                comma != std::string::npos && std::string_view(uri).substr(0, comma).ends_with(";base64");
            auto decoded = base64 ? from_base64(std::string_view(uri).substr(comma + 1)) : std::nullopt;
            if (!decoded) no(part.place, "has a data: URI that is not base64: save the file again");
            return inside_[index] = std::move(*decoded);
        }
        const std::size_t colon = uri.find(':');
        if (uri.starts_with("//") || (colon != std::string::npos && colon < uri.find('/')))
            no(part.place,
               fmt::format("refers to '{}', which is not a file beside this one: save it as .glb", shown(uri)));
        const auto path = from_percent(uri);
        if (!path)
            no(part.place,
               fmt::format("refers to '{}', which has a '%' without two digits: write it as %25", shown(uri)));
        const std::string key = std::filesystem::path(*path).lexically_normal().string();
        const auto cached = beside_.find(key);
        if (cached != beside_.end()) return cached->second;
        std::string contents = input_.beside(*path);
        size_ += contents.size();
        return beside_[key] = std::move(contents);
    }

    std::string_view decompressed(std::size_t index, const Part& view, const Part& meshopt, const char* extension) {
        const auto cached = decoded_.find(index);
        if (cached != decoded_.end()) return cached->second;
        MeshoptStream stream;
        stream.extension = extension;
        stream.bytes = range(meshopt, meshopt.required("buffer"));
        stream.count = meshopt.required("count");
        stream.stride = meshopt.required("byteStride");
        stream.mode = meshopt.text("mode");
        stream.filter = meshopt.find("filter") ? meshopt.text("filter") : "NONE";
        const std::size_t length = view.required("byteLength");
        if (stream.stride == 0 || stream.stride > 256 || length % stream.stride != 0 ||
            length / stream.stride != stream.count ||
            view.integer("byteStride").value_or(stream.stride) != stream.stride)
            no(view.place,
               fmt::format("{} has {} elements of {} bytes, which does not match the bufferView: save the file "
                           "again",
                           extension, stream.count, stream.stride));
        if (length > meshopt_bytes_a_byte * size_ - decoded_bytes_)
            no(view.place,
               "the compressed data hold more than 64 bytes for each byte of the file: save the file again");
        decoded_bytes_ += length;
        return decoded_[index] = decode_meshopt(view.place, stream);
    }

    Accessor read_accessor(std::size_t index) {
        const Part part = element("accessors", "accessor", index);
        Accessor accessor;
        accessor.place = part.place;
        accessor.count = part.required("count");
        if (accessor.count == 0)
            no(part.place, "has no elements, which the format does not allow: save the file again");
        accessor.component = component(part, part.required("componentType"));
        accessor.normalized = part.yes("normalized");
        static const std::map<std::string, std::size_t> types = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
        const auto type = types.find(part.text("type"));
        if (type == types.end())
            no(part.place, fmt::format("the type '{}' cannot be used here", shown(part.text("type"))));
        accessor.components = type->second;
        accessor.stride = accessor.element_size();
        if (const auto index_of_view = part.integer("bufferView")) {
            const std::size_t stride =
                element("bufferViews", "bufferView", *index_of_view).integer("byteStride").value_or(accessor.stride);
            if (stride < accessor.stride && accessor.count > 1)
                no(part.place, fmt::format("its elements have {} bytes, but the byteStride is {}: save the file again",
                                           accessor.stride, stride));
            accessor.data = within(part, *index_of_view, accessor.count, stride, accessor.element_size());
            accessor.stride = stride;
        }
        if (const auto sparse = part.object("sparse")) add_sparse(*sparse, accessor);
        return accessor;
    }

    // Returns the bytes of a bufferView from the byteOffset of `part` on. Checks that `count` elements fit.
    std::string_view within(const Part& part, std::size_t index, std::size_t count, std::size_t stride,
                            std::size_t size) {
        const std::string_view all = view(index);
        const std::size_t offset = part.integer("byteOffset").value_or(0);
        const std::size_t rest = offset <= all.size() ? all.size() - offset : 0;
        if (rest < size || (count - 1 > 0 && (stride == 0 || count - 1 > (rest - size) / stride)))
            no(part.place,
               fmt::format("its {} elements do not fit into bufferView {} (from 0), which has {} bytes: save the "
                           "file again",
                           count, index, all.size()));
        return all.substr(offset);
    }

    static int component(const Part& part, std::size_t type) {
        if (type < byte || type > float_number || type == 5124)
            no(part.place, fmt::format("the componentType {} is not known: save the file with 5126 (FLOAT)", type));
        return static_cast<int>(type);
    }

    void add_sparse(const Part& part, Accessor& accessor) {
        accessor.replaced = part.required("count");
        const auto indices = part.object("indices"), values = part.object("values");
        if (accessor.replaced == 0 || accessor.replaced > accessor.count || !indices || !values)
            no(part.place, "its 'sparse' is not complete, or has more elements than the accessor: save the file again");
        accessor.index_component = component(part, indices->required("componentType"));
        const std::size_t size = size_of(accessor.index_component);
        if (accessor.index_component != unsigned_byte && accessor.index_component != unsigned_short &&
            accessor.index_component != unsigned_int)
            no(part.place, "the indices of its 'sparse' are not unsigned integers: save the file again");
        accessor.indices = within(*indices, indices->required("bufferView"), accessor.replaced, size, size);
        accessor.values = within(*values, values->required("bufferView"), accessor.replaced, accessor.element_size(),
                                 accessor.element_size());
        replaced_ += accessor.replaced;
        if (replaced_ > parts_anyway + parts_a_byte * size_)
            no(part.place, "the file repeats its 'sparse' elements too often: write them once");
        for (std::size_t i = 0; i < accessor.replaced; ++i)
            if (accessor.replaced_index(i) >= accessor.count ||
                (i > 0 && accessor.replaced_index(i) <= accessor.replaced_index(i - 1)))
                no(part.place,
                   fmt::format("index {} (from 0) of its 'sparse' is out of range or not above the one before "
                               "it: save the file again",
                               i));
    }

    const Input& input_;
    const Part& root_;
    std::optional<std::string_view> binary_;
    bool needs_meshopt_;
    std::size_t size_, decoded_bytes_ = 0, replaced_ = 0;
    const std::string empty_;
    std::map<std::size_t, std::string> inside_, decoded_;
    std::map<std::string, std::string> beside_;
    std::map<std::size_t, Accessor> accessors_;
    std::map<std::pair<std::size_t, std::uint32_t>, DracoMesh> meshes_;
};

// --- placement -------------------------------------------------------------------------------------------------------

// The combined effect of the nodes that contain a mesh: a point p moves to matrix * p + shift.
struct Transform {
    std::array<std::array<double, 3>, 3> matrix = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    std::array<double, 3> shift = {0, 0, 0};

    bool operator==(const Transform&) const = default;

    // Products are added from left to right.
    Vec3 operator*(const Vec3& p) const {
        Vec3 moved;
        for (std::size_t r = 0; r < 3; ++r)
            moved[static_cast<Eigen::Index>(r)] =
                matrix[r][0] * p[0] + matrix[r][1] * p[1] + matrix[r][2] * p[2] + shift[r];
        return moved;
    }

    // Returns the transform that applies `inner` first.
    Transform operator*(const Transform& inner) const {
        Transform both;
        for (std::size_t r = 0; r < 3; ++r) {
            const auto& row = matrix[r];
            for (std::size_t c = 0; c < 3; ++c)
                both.matrix[r][c] =
                    row[0] * inner.matrix[0][c] + row[1] * inner.matrix[1][c] + row[2] * inner.matrix[2][c];
            both.shift[r] = row[0] * inner.shift[0] + row[1] * inner.shift[1] + row[2] * inner.shift[2] + shift[r];
        }
        return both;
    }
};

// Returns the transform that scales first, then rotates by a quaternion (x, y, z, w), then translates. Divides the
// quaternion by its length, which differs from 1 by the rounding of the file; `off` is the allowed difference of its
// square from 1.
Transform translation_rotation_scale(const std::string& place, const std::array<double, 3>& translation,
                                     const std::array<double, 4>& rotation, const std::array<double, 3>& scale,
                                     double off) {
    const auto [x, y, z, w] = rotation;
    const double square = x * x + y * y + z * z + w * w;
    if (!(std::abs(square - 1) <= off))
        no(place,
           fmt::format("its rotation [{}, {}, {}, {}] is not a unit quaternion: divide it by its length", x, y, z, w));
    Transform all;
    all.shift = translation;
    all.matrix = {
        {{(w * w + x * x - y * y - z * z) / square, 2 * (x * y - w * z) / square, 2 * (x * z + w * y) / square},
         {2 * (x * y + w * z) / square, (w * w - x * x + y * y - z * z) / square, 2 * (y * z - w * x) / square},
         {2 * (x * z - w * y) / square, 2 * (y * z + w * x) / square, (w * w - x * x - y * y + z * z) / square}}};
    for (auto& row : all.matrix)
        for (std::size_t c = 0; c < 3; ++c) row[c] *= scale[c];
    return all;
}

// Returns the transform that a node has relative to its parent.
Transform local(const Part& node) {
    if (!node.find("matrix"))
        return translation_rotation_scale(node.place, node.vector<3>("translation", {0, 0, 0}),
                                          node.vector<4>("rotation", {0, 0, 0, 1}), node.vector<3>("scale", {1, 1, 1}),
                                          0.01);
    if (node.find("translation") || node.find("rotation") || node.find("scale"))
        no(node.place, "has a matrix and also a translation, rotation or scale: remove one of them");
    const auto m = node.vector<16>("matrix", {});  // column by column
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
        no(node.place, "the last row of its matrix is not 0 0 0 1: apply the projection before saving the file");
    Transform all;
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) all.matrix[r][c] = m[4 * c + r];
        all.shift[r] = m[12 + r];
    }
    return all;
}

// --- meshes ----------------------------------------------------------------------------------------------------------

// The topologies of primitives, by their number in the format.
enum class Mode { points, lines, line_loop, line_strip, triangles, triangle_strip, triangle_fan };

// Returns whether a primitive can have this many corners.
bool complete(Mode mode, std::size_t corners) {
    switch (mode) {
        case Mode::points:
            return corners >= 1;
        case Mode::lines:
            return corners >= 2 && corners % 2 == 0;
        case Mode::line_loop:
        case Mode::line_strip:
            return corners >= 2;
        case Mode::triangles:
            return corners >= 3 && corners % 3 == 0;
        default:
            return corners >= 3;
    }
}

// Returns the faces of a primitive with these corners.
std::vector<std::vector<std::size_t>> faces_of(Mode mode, const std::vector<std::size_t>& v) {
    std::vector<std::vector<std::size_t>> faces;
    const std::size_t n = v.size();
    switch (mode) {
        case Mode::points:
            for (const std::size_t corner : v) faces.push_back({corner});
            break;
        case Mode::lines:
            for (std::size_t i = 0; i + 1 < n; i += 2) faces.push_back({v[i], v[i + 1]});
            break;
        case Mode::line_loop:
        case Mode::line_strip:
            for (std::size_t i = 0; i + 1 < n; ++i) faces.push_back({v[i], v[i + 1]});
            if (mode == Mode::line_loop) faces.push_back({v[n - 1], v[0]});
            break;
        case Mode::triangles:
            for (std::size_t i = 0; i + 2 < n; i += 3) faces.push_back({v[i], v[i + 1], v[i + 2]});
            break;
        case Mode::triangle_strip:
            for (std::size_t i = 0; i + 2 < n; ++i) faces.push_back({v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]});
            break;
        case Mode::triangle_fan:
            for (std::size_t i = 0; i + 2 < n; ++i) faces.push_back({v[i + 1], v[i + 2], v[0]});
            break;
    }
    return faces;
}

// Points and faces of one mesh, before nodes move them.
struct MeshShape {
    std::vector<Vec3> points;
    std::vector<std::vector<std::size_t>> faces;
};

struct Extensions {
    std::set<std::string> used, required;

    bool any(const std::string& name) const { return used.contains(name) || required.contains(name); }
};

// Turns the scene into a soup.
class Scene {
public:
    Scene(const Input& input, const Part& root, const Container& container, const Extensions& extensions)
        : input_(input),
          root_(root),
          extensions_(extensions),
          data_(input, root, container,
                extensions.required.contains("EXT_meshopt_compression") ||
                    extensions.required.contains("KHR_meshopt_compression")) {
        soup_.objects = 0;
        soup_.merge = true;  // vertices are repeated where their normals or colours differ
    }

    Soup draw();

private:
    using Targets = std::vector<std::pair<const Accessor*, double>>;
    struct Shown {
        std::size_t node;
        Transform parent;
    };

    void find_parents();
    std::vector<std::size_t> roots() const;
    void draw_node(const Part& node, const Transform& at);
    std::vector<Transform> instances(const Part& node);
    std::vector<double> weights(const Part& node, const Part& mesh) const;
    void add_primitive(const Part& primitive, const std::vector<double>& weights, MeshShape& shape);
    std::vector<std::size_t> indices(const Part& primitive, std::size_t points);
    std::vector<std::size_t> decompressed(const Part& primitive, const Part& draco, Accessor& at);
    Targets targets(const Part& primitive, const std::vector<double>& weights, std::size_t points);
    const Accessor& positions(const Part& part, std::size_t index);
    void add_points(const Accessor& at, const Targets& targets, std::vector<std::size_t>& corners, MeshShape& shape);
    void note(std::size_t count, const char* singular, const char* plural, const std::string& rest);
    void add_notes();

    // Counts parts, and refuses the file if they exceed the limit for the whole scene.
    void spend(const std::string& place, std::size_t parts) {
        const std::size_t most = std::max(parts_anyway, parts_a_byte * data_.size());
        if (parts > most - std::min(most, parts_))
            no(place,
               fmt::format("the scene repeats its meshes so often that it has more than {} points and corners for each "
                           "byte of the file: write fewer of them",
                           parts_a_byte));
        parts_ += parts;
    }

    const Input& input_;
    const Part& root_;
    const Extensions& extensions_;
    Data data_;
    Soup soup_;
    std::vector<std::optional<std::size_t>> parents_, finer_;  // of each node; `finer_`: the node that it simplifies
    std::size_t parts_ = 0;
    // What was left out.
    std::size_t drawn_ = 0, hidden_ = 0, flat_ = 0, without_position_ = 0, stitches_ = 0, morphed_ = 0,
                draco_copies_ = 0;
};

// Reads the tree of nodes. Refuses a node that has two parents.
void Scene::find_parents() {
    const std::size_t nodes = root_.array("nodes").size();
    parents_.assign(nodes, std::nullopt);
    finer_.assign(nodes, std::nullopt);
    for (std::size_t i = 0; i < nodes; ++i) {
        const Part node = data_.element("nodes", "node", i);
        for (const Json& child : node.array("children")) {
            const std::size_t index = node.count(child, "children");
            data_.element("nodes", "node", index);
            if (parents_[index])
                no(input_.name,
                   fmt::format("node {} (from 0) is a child of node {} and of node {}: give each a node of its own",
                               index, *parents_[index], i));
            parents_[index] = i;
        }
        if (const auto levels = node.extension("MSFT_lod"))
            for (const Json& level : levels->array("ids")) {
                const std::size_t index = node.count(level, "ids");
                data_.element("nodes", "node", index);
                finer_[index] = i;
            }
    }
}

// Returns the root nodes of the default scene.
std::vector<std::size_t> Scene::roots() const {
    const std::size_t scenes = root_.array("scenes").size();
    if (scenes == 0)
        no(input_.name, "has no scene, so it does not say which of its meshes are shown: add a scene with their nodes");
    if (scenes > 1 && !root_.find("scene"))
        no(input_.name,
           fmt::format("has {} scenes and does not say which is the default: add \"scene\": 0 or another number",
                       scenes));
    const Part scene = data_.element("scenes", "scene", root_.integer("scene").value_or(0));
    std::vector<std::size_t> all;
    std::set<std::size_t> seen;
    for (const Json& value : scene.array("nodes")) {
        const std::size_t index = scene.count(value, "nodes");
        data_.element("nodes", "node", index);
        if (parents_[index])
            no(scene.place,
               fmt::format("lists node {} (from 0), which is a child of node {}: list only nodes without a parent",
                           index, *parents_[index]));
        if (!seen.insert(index).second)
            no(scene.place, fmt::format("lists node {} (from 0) twice: list it once", index));
        all.push_back(index);
    }
    return all;
}

Soup Scene::draw() {
    const auto global = root_.extension("CESIUM_RTC");
    if (global)
        no(input_.name, "moves its meshes by the extension CESIUM_RTC, which is not supported: write a node instead");
    find_parents();
    std::vector<Shown> waiting;
    for (const std::size_t root : roots()) waiting.push_back({root, {}});
    std::reverse(waiting.begin(), waiting.end());
    while (!waiting.empty()) {  // a tree, since no node has two parents and no root has one
        const auto [index, parent] = waiting.back();
        waiting.pop_back();
        const Part node = data_.element("nodes", "node", index);
        spend(node.place, 1);
        if (finer_[index])
            no(node.place,
               fmt::format("is a lower level of detail of node {} (MSFT_lod), but the scene shows both: take it out "
                           "of the scene",
                           *finer_[index]));
        const auto visibility = node.extension("KHR_node_visibility");
        if (visibility && !visibility->yes("visible", true)) {
            ++hidden_;
            continue;
        }
        const Transform at = parent * local(node);
        if (node.find("mesh")) draw_node(node, at);
        const Json& children = node.array("children");
        for (std::size_t i = children.size(); i-- > 0;) waiting.push_back({node.count(children[i], "children"), at});
    }
    add_notes();
    if (soup_.points.empty())
        no(input_.name, "its scene shows no mesh with a position: add a node with a mesh to the scene");
    return std::move(soup_);
}

// Adds the mesh of a node, once for each instance.
void Scene::draw_node(const Part& node, const Transform& at) {
    if (node.find("skin"))
        no(node.place,
           "its mesh has a skin, which is not supported: apply the armature before saving the file, or remove it");
    ++drawn_;
    const Part mesh = data_.element("meshes", "mesh", node.required("mesh"));
    const std::vector<double> morph = weights(node, mesh);
    spend(mesh.place, morph.size());
    MeshShape shape;
    const Json& primitives = mesh.array("primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        spend(mesh.place, 1 + morph.size());
        const Part primitive{&primitives[i], fmt::format("{}: primitive {} (from 0)", mesh.place, i)};
        if (!primitives[i].is_object()) no(primitive.place, "is not an object");
        add_primitive(primitive, morph, shape);
    }
    std::size_t corners = 0;
    for (const auto& face : shape.faces) corners += face.size();
    for (const Transform& instance : instances(node)) {
        const Transform moved = at * instance;
        if (moved.matrix == std::array<std::array<double, 3>, 3>{}) {
            ++flat_;
            continue;
        }
        spend(node.place, shape.points.size() + corners);
        const std::size_t first = soup_.points.size();
        const bool stays = moved == Transform();
        for (const Vec3& p : shape.points) soup_.points.push_back(stays ? p : moved * p);
        for (std::vector<std::size_t> face : shape.faces) {
            for (std::size_t& v : face) v += first;
            soup_.faces.push_back(std::move(face));
        }
        soup_.objects += shape.faces.empty() ? 0 : 1;
    }
}

// Returns where a node shows its mesh, relative to the node.
std::vector<Transform> Scene::instances(const Part& node) {
    const auto extension = node.extension("EXT_mesh_gpu_instancing");
    if (!extension) return {Transform()};
    const auto attributes = extension->object("attributes");
    std::array<const Accessor*, 3> given{};  // translation, rotation, scale
    const std::array<const char*, 3> names = {"TRANSLATION", "ROTATION", "SCALE"};
    std::optional<std::size_t> count;
    for (std::size_t i = 0; attributes && i < 3; ++i) {
        const auto index = attributes->integer(names[i]);
        if (!index) continue;
        const Accessor& at = data_.accessor(*index);
        if (at.components != (i == 1 ? 4u : 3u) || count.value_or(at.count) != at.count)
            no(at.place,
               fmt::format("{} of EXT_mesh_gpu_instancing has the wrong type or count: save the file again", names[i]));
        given[i] = &at;
        count = at.count;
    }
    if (!count)
        no(node.place,
           "EXT_mesh_gpu_instancing has no TRANSLATION, ROTATION or SCALE, so it states no number of instances: "
           "remove it");
    spend(node.place, *count);
    std::vector<Transform> all;
    for (std::size_t i = 0; i < *count; ++i) {
        const auto get = [&](std::size_t which, auto values) {
            for (std::size_t k = 0; given[which] && k < values.size(); ++k) values[k] = (*given[which])(i, k);
            return values;
        };
        all.push_back(translation_rotation_scale(
            fmt::format("{}: instance {} (from 0)", node.place, i), get(0, std::array<double, 3>{0, 0, 0}),
            get(1, std::array<double, 4>{0, 0, 0, 1}), get(2, std::array<double, 3>{1, 1, 1}),
            given[1] && given[1]->component == byte ? 0.05 : 0.01));
    }
    return all;
}

// Returns the default weights of the morph targets; empty if none are given, which means 0.
std::vector<double> Scene::weights(const Part& node, const Part& mesh) const {
    return node.find("weights") ? node.numbers("weights") : mesh.numbers("weights");
}

// Returns the accessor of positions or displacements. Refuses types that the format does not allow.
const Accessor& Scene::positions(const Part& part, std::size_t index) {
    const Accessor& at = data_.accessor(index);
    const bool quantized = at.component != float_number;
    if (at.components != 3 || at.component == unsigned_int)
        no(part.place,
           fmt::format("its POSITION, accessor {} (from 0), is not a VEC3 of FLOAT: save the file again", index));
    if (quantized && !extensions_.any("KHR_mesh_quantization"))
        no(part.place, fmt::format("its POSITION, accessor {} (from 0), has integers, but the file does not list "
                                   "KHR_mesh_quantization: add it to extensionsUsed and extensionsRequired",
                                   index));
    soup_.float32 = soup_.float32 || !quantized;
    return at;
}

// Returns the corners of a primitive, as indices of its points.
std::vector<std::size_t> Scene::indices(const Part& primitive, std::size_t points) {
    const auto index = primitive.integer("indices");
    std::vector<std::size_t> all;
    if (!index) {
        spend(primitive.place, points);
        for (std::size_t i = 0; i < points; ++i) all.push_back(i);
        return all;
    }
    const Accessor& at = data_.accessor(*index);
    if (at.components != 1 || at.normalized ||
        (at.component != unsigned_byte && at.component != unsigned_short && at.component != unsigned_int))
        no(at.place, "is used as indices, but does not have unsigned integers: save the file again");
    if (at.data.empty() && at.replaced == 0)
        no(at.place,
           "is used as indices, but has no data, as if an extension compressed it: decompress the file with "
           "`gltf-transform copy`");
    spend(primitive.place, at.count);
    const std::size_t restart = (std::size_t{1} << 8 * size_of(at.component)) - 1;
    for (std::size_t i = 0; i < at.count; ++i) {
        const auto v = static_cast<std::size_t>(at(i, 0));
        if (v == restart)
            no(at.place,
               fmt::format("index {} (from 0) is {}, which the format does not allow because it restarts a primitive: "
                           "save the file with a larger type of index, or without restarts",
                           i, v));
        if (v >= points)
            no(at.place, fmt::format("index {} (from 0) is {}, but the primitive has {} points: save the file again", i,
                                     v, points));
        all.push_back(v);
    }
    return all;
}

// Adds those points that corners use, in their order, and renumbers the corners accordingly.
void Scene::add_points(const Accessor& at, const Targets& targets, std::vector<std::size_t>& corners,
                       MeshShape& shape) {
    std::vector<std::size_t> used = corners;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    spend(at.place, used.size());
    const std::size_t first = shape.points.size();
    for (const std::size_t i : used) {
        std::array<double, 3> p;
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = at(i, k);
            for (const auto& [target, weight] : targets) p[k] += weight * (*target)(i, k);
        }
        shape.points.emplace_back(p[0], p[1], p[2]);
    }
    const bool dense = !used.empty() && used.back() < used.size();  // all points up to the last are used
    for (std::size_t& v : corners)
        v = first +
            (dense ? v : static_cast<std::size_t>(std::lower_bound(used.begin(), used.end(), v) - used.begin()));
}

// Returns the morph targets that move a primitive with this number of points, and their weights.
Scene::Targets Scene::targets(const Part& primitive, const std::vector<double>& weights, std::size_t points) {
    const Json& morphs = primitive.array("targets");
    if (!weights.empty() && weights.size() != morphs.size())
        no(primitive.place, fmt::format("has {} morph targets, but there are {} weights: save the file again",
                                        morphs.size(), weights.size()));
    Targets all;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const Part target{&morphs[i], fmt::format("{}: morph target {} (from 0)", primitive.place, i)};
        if (!morphs[i].is_object()) no(target.place, "is not an object");
        const auto moved = target.integer("POSITION");
        if (weights[i] == 0 || !moved) continue;
        const Accessor& by = positions(target, *moved);
        if (by.count != points)
            no(target.place,
               fmt::format("moves {} points, but the primitive has {}: save the file again", by.count, points));
        all.emplace_back(&by, weights[i]);
    }
    morphed_ += all.size();
    return all;
}

// Returns the corners of a primitive that Draco compressed, and lets `at` refer to its positions.
std::vector<std::size_t> Scene::decompressed(const Part& primitive, const Part& draco, Accessor& at) {
    const auto id = draco.integer("attributes", "POSITION"), index = primitive.integer("indices");
    if (!id || *id > 0xffffffff || !index || primitive.integer("mode").value_or(4) != 4)
        no(primitive.place,
           "KHR_draco_mesh_compression is supported only for triangles with a POSITION and indices: "
           "decompress the file with `gltf-transform copy`");
    const std::size_t count = data_.element("accessors", "accessor", *index).required("count");
    spend(primitive.place, at.count);
    spend(primitive.place, count);
    const DracoMesh& mesh =
        data_.draco(draco.required("bufferView"), {{}, at.count, count, static_cast<std::uint32_t>(*id), at.component});
    if (mesh.positions.size() != at.count * at.element_size() || mesh.corners.size() != count)
        no(primitive.place, "shares its Draco data with a primitive of another size: save the file again");
    at.data = mesh.positions;
    at.stride = at.element_size();
    at.replaced = 0;
    return {mesh.corners.begin(), mesh.corners.end()};
}

void Scene::add_primitive(const Part& primitive, const std::vector<double>& weights, MeshShape& shape) {
    const std::size_t number = primitive.integer("mode").value_or(4);
    if (number > 6)
        no(primitive.place,
           fmt::format("its mode {} is not one of the format, from 0 (points) to 6 (triangle fan)", number));
    const auto mode = static_cast<Mode>(number);
    const auto position = primitive.integer("attributes", "POSITION");
    if (!position) {
        ++without_position_;
        return;
    }
    Accessor at = positions(primitive, *position);
    const Targets morphs = targets(primitive, weights, at.count);
    const auto draco = primitive.extension("KHR_draco_mesh_compression");
    const auto index = primitive.integer("indices");
    const bool fallback = draco && !extensions_.required.contains("KHR_draco_mesh_compression") &&
                          data_.has_elements(*position) && (!index || data_.has_elements(*index));
    draco_copies_ += fallback ? 1 : 0;
    std::vector<std::size_t> corners =
        draco && !fallback ? decompressed(primitive, *draco, at) : indices(primitive, at.count);
    if (at.data.empty() && at.replaced == 0)
        no(primitive.place,
           "its POSITION has no data, as if an extension compressed it: decompress the file with "
           "`gltf-transform copy`");
    if (!complete(mode, corners.size()))
        no(primitive.place, fmt::format("has {} corners, which cannot be with the mode {}: save the file again",
                                        corners.size(), number));
    add_points(at, morphs, corners, shape);
    for (auto& face : faces_of(mode, corners)) {
        // Strips repeat a vertex to jump from one part to the next. Such a triangle is not a part of the surface.
        const bool strip = mode == Mode::triangle_strip || mode == Mode::triangle_fan;
        if (strip && (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]))
            ++stitches_;
        else
            shape.faces.push_back(std::move(face));
    }
}

void Scene::note(std::size_t count, const char* singular, const char* plural, const std::string& rest) {
    if (count > 0) soup_.notes.push_back(fmt::format("{} {} {}", count, count == 1 ? singular : plural, rest));
}

void Scene::add_notes() {
    std::size_t meshes = 0;
    for (const Json& node : root_.array("nodes")) meshes += node.is_object() && node.contains("mesh") ? 1 : 0;
    const std::size_t left_out = meshes - drawn_;
    note(hidden_, "node", "nodes", "hidden by KHR_node_visibility, with everything below: left out");
    note(left_out, "node with a mesh", "nodes with a mesh", "that the default scene does not show: left out");
    note(flat_, "mesh", "meshes", "scaled to a single point, by which the format hides a mesh: left out");
    note(without_position_, "primitive", "primitives", "without POSITION: left out");
    note(stitches_, "triangle", "triangles", "that only join parts of a strip, with a repeated vertex: left out");
    note(morphed_, "morph target", "morph targets", "applied, by the default weights of the file");
    note(draco_copies_, "primitive", "primitives",
         "with a compressed copy by the optional KHR_draco_mesh_compression: the uncompressed data count");
    if (!root_.array("animations").empty())
        soup_.notes.push_back("has animations, which are not applied: the nodes stay as the file places them");
    for (const std::string& name : extensions_.used)
        if (!extensions_.required.contains(name) && !applied.contains(name) && !harmless.contains(name))
            soup_.notes.push_back(
                fmt::format("uses the optional extension {}, which is not supported: read without it", shown(name)));
}

// Returns the extensions of the file. Refuses required ones that this reader does not know.
Extensions extensions_of(const std::string& name, const Part& root) {
    const auto names = [&](const char* key) {
        std::set<std::string> all;
        for (const Json& value : root.array(key)) {
            if (!value.is_string()) no(name, fmt::format("'{}' has a value that is not a string", key));
            all.insert(value.get<std::string>());
        }
        return all;
    };
    Extensions all{names("extensionsUsed"), names("extensionsRequired")};
    for (const std::string& extension : all.required)
        if (!applied.contains(extension) && !harmless.contains(extension))
            no(name,
               fmt::format(
                   "requires the extension {}, which is not supported: save the file without it, or as PLY or OBJ",
                   shown(extension)));
    return all;
}

void check_version(const std::string& name, const Part& root) {
    const auto asset = root.object("asset");
    if (!asset) no(name, "has no 'asset', so it is not glTF 2.0: save the file again");
    const std::string version = asset->text("version"), least = asset->text("minVersion");
    const bool two = version.starts_with("2.") && whole<unsigned>(std::string_view(version).substr(2));
    if (!two || !(least.empty() || least == "2.0"))
        no(name,
           fmt::format("is glTF of version '{}', only 2.0 is supported: convert it, for example with `gltf-pipeline`",
                       shown(least.empty() ? version : least)));
}

Soup read(const Input& input) {
    const Container container = opened(input.name, input.bytes);
    const Json json = parsed(input.name, container.json);
    if (!json.is_object()) no(input.name, "its JSON is not an object: fetch or save the file again");
    const Part root{&json, input.name};
    check_version(input.name, root);
    const Extensions extensions = extensions_of(input.name, root);
    Soup soup = Scene(input, root, container, extensions).draw();
    soup.stated = stated_unit(*unit_named("m"));
    soup.stated.up = 'Y';
    soup.unreferenced_unknown = true;
    if (container.after > 0)
        soup.notes.push_back(
            fmt::format("has {} bytes after the end that its header states, which are ignored", container.after));
    return soup;
}

}  // namespace
}  // namespace gltf

Soup read_gltf(const Input& input) { return gltf::read(input); }

}  // namespace hausbench::readers
