// Decodes the compressed geometry of glTF files: EXT_meshopt_compression and KHR_meshopt_compression with the
// meshoptimizer library, and KHR_draco_mesh_compression with the Draco library. The filters of meshopt are computed
// here in double, and rounded once: EXPONENTIAL, the one for coordinates, is exact.
#include "datasets/formats/gltf_codecs.h"

#include "algorithms/error.h"

#include <draco/compression/decode.h>
#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

namespace hausbench::readers {
namespace gltf_codecs {
namespace {

// The largest ratio of decoded to compressed bytes: the codec of attributes spends two bits on 16 bytes.
constexpr std::size_t meshopt_ratio = 64;

const char* const damaged = "the compressed data are damaged: fetch or save the file again";

[[noreturn]] void no(const std::string& place, const std::string& why) { throw InputError(place + ": " + why); }

// Checks the conditions of the extension's specification.
void check(const std::string& place, const MeshoptStream& stream) {
    const bool attributes = stream.mode == "ATTRIBUTES", triangles = stream.mode == "TRIANGLES";
    if (!attributes && !triangles && stream.mode != "INDICES")
        no(place, fmt::format("{} has no mode '{}'", stream.extension, one_line(stream.mode.substr(0, 40))));
    const std::size_t stride = stream.stride;
    if (stream.count == 0 || (triangles && stream.count % 3 != 0))
        no(place, fmt::format("a count of {} is not possible in mode {}", stream.count, stream.mode));
    const bool fits = attributes ? stride % 4 == 0 && stride > 0 && stride <= 256 : stride == 2 || stride == 4;
    const bool filtered = stream.filter != "NONE";
    const bool filter_fits =
        !filtered || (attributes && ((stream.filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) ||
                                     (stream.filter == "QUATERNION" && stride == 8) || stream.filter == "EXPONENTIAL"));
    if (!fits || !filter_fits)
        no(place, fmt::format("a stride of {} with the filter '{}' is not possible in mode {}", stride,
                              one_line(stream.filter.substr(0, 40)), stream.mode));
    if (stream.count > meshopt_ratio * stream.bytes.size() / stride)
        no(place, fmt::format("{} compressed bytes cannot hold {} elements of {} bytes: {}", stream.bytes.size(),
                              stream.count, stride, damaged));
    if (attributes && stream.extension == std::string_view("KHR_meshopt_compression") && stream.bytes[0] == '\xa1')
        no(place,
           "KHR_meshopt_compression with version 1 of its vertex codec is not supported: decompress the file with "
           "`gltf-transform copy`, or compress it with `gltfpack -c`");
    const int version = attributes ? 0xa0 : triangles ? 0xe1 : 0xd1;
    if (static_cast<unsigned char>(stream.bytes[0]) != version)
        no(place, fmt::format("the data of mode {} begin with the byte {:#04x}, not {:#04x}: {}", stream.mode,
                              static_cast<unsigned char>(stream.bytes[0]), version, damaged));
}

template <class Integer> std::array<Integer, 4> four(const char* at) {
    std::array<Integer, 4> values;
    std::memcpy(values.data(), at, sizeof values);
    return values;
}

// A direction in octahedral coordinates becomes a unit vector.
template <class Integer> void octahedral(const std::string& place, char* at) {
    constexpr double most = sizeof(Integer) == 1 ? 127 : 32767;
    std::array<Integer, 4> values = four<Integer>(at);
    const double scale = values[2];
    if (scale <= 0) no(place, "a vector of the OCTAHEDRAL filter has no scale: " + std::string(damaged));
    double x = values[0] / scale, y = values[1] / scale;
    const double z = 1 - std::abs(x) - std::abs(y), fold = std::min(z, 0.0);
    x -= std::copysign(fold, x);
    y -= std::copysign(fold, y);
    const double length = std::sqrt(x * x + y * y + z * z);
    if (!(std::abs(x) <= length && std::abs(y) <= length && length > 0))
        no(place, "a vector of the OCTAHEDRAL filter has no direction: " + std::string(damaged));
    values = {static_cast<Integer>(std::round(x / length * most)), static_cast<Integer>(std::round(y / length * most)),
              static_cast<Integer>(std::round(z / length * most)), values[3]};
    std::memcpy(at, values.data(), sizeof values);
}

// A quaternion whose largest component was left out gets it back.
void quaternion(const std::string& place, char* at) {
    const auto values = four<std::int16_t>(at);
    const double scale = values[3] | 3;
    if (scale <= 0) no(place, "a rotation of the QUATERNION filter has no scale: " + std::string(damaged));
    std::array<std::int16_t, 4> rotation{};
    double rest = 1;
    const auto largest = static_cast<std::size_t>(values[3] & 3);
    for (std::size_t k = 0; k < 3; ++k) {
        const double component = values[k] / scale * std::sqrt(0.5);
        if (std::abs(component) > 1)
            no(place, "a rotation of the QUATERNION filter is out of range: " + std::string(damaged));
        rest -= component * component;
        rotation[(largest + 1 + k) % 4] = static_cast<std::int16_t>(std::round(component * 32767));
    }
    rotation[largest] = static_cast<std::int16_t>(std::round(std::sqrt(std::max(rest, 0.0)) * 32767));
    std::memcpy(at, rotation.data(), sizeof rotation);
}

// A mantissa of 24 bits and an exponent of 8 bits become the float32 m 2^e, without rounding.
void exponential(const std::string& place, char* at) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, at, 4);
    const int exponent = static_cast<std::int8_t>(bits >> 24);
    const int mantissa = static_cast<std::int32_t>(bits << 8) >> 8;
    if (mantissa != 0 && std::abs(exponent) > 100)
        no(place,
           fmt::format("a number of the EXPONENTIAL filter has the exponent {}, which is not between -100 and 100: {}",
                       exponent, damaged));
    const auto value = static_cast<float>(std::ldexp(mantissa, exponent));
    std::memcpy(at, &value, 4);
}

void unfilter(const std::string& place, const MeshoptStream& stream, std::string& bytes) {
    if (stream.filter == "NONE") return;
    const std::size_t step = stream.filter == "EXPONENTIAL" ? 4 : stream.stride;
    for (std::size_t i = 0; i < bytes.size(); i += step) {
        char* const at = bytes.data() + i;
        if (stream.filter == "EXPONENTIAL") exponential(place, at);
        if (stream.filter == "QUATERNION") quaternion(place, at);
        if (stream.filter == "OCTAHEDRAL" && step == 4) octahedral<std::int8_t>(place, at);
        if (stream.filter == "OCTAHEDRAL" && step == 8) octahedral<std::int16_t>(place, at);
    }
}

// Returns the next number of the Draco bitstream, which has seven bits a byte.
std::optional<std::uint64_t> draco_number(std::string_view& bytes) {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 35 && !bytes.empty(); shift += 7) {
        const auto byte = static_cast<unsigned char>(bytes[0]);
        bytes.remove_prefix(1);
        value |= std::uint64_t{byte & 0x7fu} << shift;
        if (byte < 0x80) return value;
    }
    return std::nullopt;
}

// Skips a length and as many bytes.
bool skip_bytes(std::string_view& bytes, std::optional<std::uint64_t> length) {
    if (!length || *length > bytes.size()) return false;
    bytes.remove_prefix(static_cast<std::size_t>(*length));
    return true;
}

bool skip_name(std::string_view& bytes) {
    if (bytes.empty()) return false;
    const auto length = static_cast<unsigned char>(bytes[0]);
    bytes.remove_prefix(1);
    return skip_bytes(bytes, length);
}

// Skips a table of names and values, which may contain further tables. Returns false if it is damaged, or nested deeper
// than any encoder writes it.
bool skip_metadata(std::string_view& bytes, int depth = 0) {
    const auto entries = draco_number(bytes);
    if (!entries || depth > 8) return false;
    for (std::uint64_t i = 0; i < *entries; ++i)
        if (!skip_name(bytes) || !skip_bytes(bytes, draco_number(bytes))) return false;
    const auto tables = draco_number(bytes);
    if (!tables) return false;
    for (std::uint64_t i = 0; i < *tables; ++i)
        if (!skip_name(bytes) || !skip_metadata(bytes, depth + 1)) return false;
    return true;
}

// Skips the tables of all attributes and of the mesh.
bool skip_all_metadata(std::string_view& bytes) {
    const auto attributes = draco_number(bytes);
    if (!attributes) return false;
    for (std::uint64_t i = 0; i < *attributes; ++i)
        if (!draco_number(bytes) || !skip_metadata(bytes)) return false;
    return skip_metadata(bytes);
}

// Compares the sizes at the beginning of the stream with the announced ones, before Draco reserves memory for them.
void check_draco_header(const std::string& place, const DracoStream& stream) {
    std::string_view bytes = stream.bytes;
    if (!bytes.starts_with("DRACO") || bytes.size() < 11)
        no(place, "does not hold Draco data: fetch or save the file again");
    const unsigned major = static_cast<unsigned char>(bytes[5]), minor = static_cast<unsigned char>(bytes[6]);
    if (major != 2 || minor != 2)
        no(place, fmt::format("holds data of version {}.{} of Draco, but glTF has version 2.2: compress the file again",
                              major, minor));
    if (bytes[7] != 1) no(place, "holds Draco data that are not a mesh: save the file again");
    const bool edgebreaker = bytes[8] == 1, metadata = (static_cast<unsigned char>(bytes[10]) & 0x80) != 0;
    bytes.remove_prefix(11);
    if ((metadata && !skip_all_metadata(bytes)) || bytes.empty()) no(place, damaged);
    if (edgebreaker) bytes.remove_prefix(1);
    const auto first = draco_number(bytes), second = draco_number(bytes);
    const auto faces = edgebreaker ? second : first, points = edgebreaker ? first : second;
    const bool right = faces && points && *faces * 3 == stream.corners &&
                       (edgebreaker ? *points <= stream.corners : *points == stream.points);
    if (!right)
        no(place, fmt::format("its Draco data announce {} triangles and {} points, but the accessors {} indices and {} "
                              "points: save the file again",
                              faces.value_or(0), points.value_or(0), stream.corners, stream.points));
}

int component_of(draco::DataType type) {
    switch (type) {
        case draco::DT_INT8:
            return 5120;
        case draco::DT_UINT8:
            return 5121;
        case draco::DT_INT16:
            return 5122;
        case draco::DT_UINT16:
            return 5123;
        case draco::DT_FLOAT32:
            return 5126;
        default:
            return 0;
    }
}

DracoMesh copied(const std::string& place, const DracoStream& stream, const draco::Mesh& mesh) {
    if (mesh.num_points() != stream.points || std::size_t{mesh.num_faces()} * 3 != stream.corners)
        no(place, fmt::format("its Draco data have {} triangles and {} points, but the accessors {} indices and {} "
                              "points: save the file again",
                              mesh.num_faces(), mesh.num_points(), stream.corners, stream.points));
    const draco::PointAttribute* const at = mesh.GetAttributeByUniqueId(stream.attribute);
    if (!at)
        no(place,
           fmt::format("its Draco data have no attribute {} for POSITION: save the file again", stream.attribute));
    if (at->num_components() != 3 || component_of(at->data_type()) != stream.component)
        no(place, fmt::format("the positions in its Draco data are not of the type that the accessor states ({}): save "
                              "the file again",
                              stream.component));
    const auto size = static_cast<std::size_t>(3 * draco::DataTypeLength(at->data_type()));
    DracoMesh decoded;
    decoded.positions.resize(stream.points * size);
    for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
        const draco::AttributeValueIndex value = at->mapped_index(draco::PointIndex(i));
        if (value.value() >= at->size()) no(place, damaged);
        at->GetValue(value, decoded.positions.data() + i * size);
    }
    decoded.corners.reserve(stream.corners);
    for (std::uint32_t f = 0; f < mesh.num_faces(); ++f)
        for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(f))) {
            if (corner.value() >= mesh.num_points()) no(place, damaged);
            decoded.corners.push_back(corner.value());
        }
    return decoded;
}

std::string meshopt(const std::string& place, const MeshoptStream& stream) {
    check(place, stream);
    std::string bytes(stream.count * stream.stride, '\0');
    // The library reads unsigned bytes.
    const auto* const compressed = static_cast<const unsigned char*>(static_cast<const void*>(stream.bytes.data()));
    void* const to = bytes.data();
    const std::size_t count = stream.count, stride = stream.stride, size = stream.bytes.size();
    const int failed = stream.mode == "ATTRIBUTES"  ? meshopt_decodeVertexBuffer(to, count, stride, compressed, size)
                       : stream.mode == "TRIANGLES" ? meshopt_decodeIndexBuffer(to, count, stride, compressed, size)
                                                    : meshopt_decodeIndexSequence(to, count, stride, compressed, size);
    if (failed) no(place, damaged);
    unfilter(place, stream, bytes);
    return bytes;
}

DracoMesh draco_mesh(const std::string& place, const DracoStream& stream) {
    check_draco_header(place, stream);
    draco::DecoderBuffer buffer;
    buffer.Init(stream.bytes.data(), stream.bytes.size());
    draco::Decoder decoder;
    try {
        auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
        if (!mesh.ok()) no(place, fmt::format("{} ({})", damaged, one_line(mesh.status().error_msg_string())));
        return copied(place, stream, *mesh.value());
    } catch (const std::bad_alloc&) {
        no(place, damaged);
    } catch (const std::length_error&) {
        no(place, damaged);
    }
}

}  // namespace
}  // namespace gltf_codecs

std::string decode_meshopt(const std::string& place, const MeshoptStream& stream) {
    return gltf_codecs::meshopt(place, stream);
}

DracoMesh decode_draco(const std::string& place, const DracoStream& stream) {
    return gltf_codecs::draco_mesh(place, stream);
}

}  // namespace hausbench::readers
