// Writes FBX files for tests, from one tree: as text, and as binary files with records of 32 and 64 bits, with raw and
// deflated arrays.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace hausbench::fbx {

using Value = std::variant<std::int32_t, std::int64_t, double, std::string, std::vector<double>, std::vector<float>,
                           std::vector<std::int32_t>, std::vector<std::int64_t>>;

struct Node {
    std::string name;
    std::vector<Value> values = {};
    std::vector<Node> children = {};
};
using Nodes = std::vector<Node>;

// A property of Properties70, with the type by which assimp recognises it.
template <class... Numbers> Node property(const std::string& name, Numbers... numbers) {
    const bool whole = (std::is_same_v<Numbers, std::int32_t> && ...);
    const std::string type = name.starts_with("Lcl ")  ? name
                             : whole                   ? "int"
                             : sizeof...(numbers) == 1 ? "double"
                                                       : "Vector3D";
    return {"P", {name, type, std::string(), std::string("A"), Value(numbers)...}};
}
inline Node properties(Nodes all) { return {"Properties70", {}, std::move(all)}; }
inline Node connect(std::int64_t child, std::int64_t parent) { return {"C", {std::string("OO"), child, parent}}; }
inline Node model(std::int64_t id, Nodes props = {}, const std::string& kind = "Mesh") {
    return {"Model", {id, fmt::format("Model::n{}", id), kind}, {properties(std::move(props))}};
}
inline Node geometry(std::int64_t id, std::vector<double> vertices, std::vector<std::int32_t> corners) {
    return {"Geometry",
            {id, std::string("Geometry::"), std::string("Mesh")},
            {{"Vertices", {std::move(vertices)}}, {"PolygonVertexIndex", {std::move(corners)}}}};
}
inline Nodes document(Nodes objects, Nodes connections, Nodes settings = {}, Nodes definitions = {}) {
    return {{"FBXHeaderExtension", {}, {{"FBXVersion", {std::int32_t{7400}}}}},
            {"GlobalSettings", {}, {properties(std::move(settings))}},
            {"Definitions", {}, std::move(definitions)},
            {"Objects", {}, std::move(objects)},
            {"Connections", {}, std::move(connections)}};
}

inline std::string text_of(const Value& value) {
    return std::visit(
        [](const auto& content) -> std::string {
            using T = std::decay_t<decltype(content)>;
            if constexpr (std::is_same_v<T, std::string>)
                return "\"" + content + "\"";
            else if constexpr (std::is_arithmetic_v<T>)
                return fmt::format("{}", content);
            else
                return fmt::format("*{} {{\n\ta: {}\n}}", content.size(), fmt::join(content, ","));
        },
        value);
}

inline std::string text_of(const Nodes& nodes, const std::string& indent = "") {
    std::string text;
    for (const Node& node : nodes) {
        text += indent + node.name + ":";
        for (std::size_t i = 0; i < node.values.size(); ++i) text += (i > 0 ? ", " : " ") + text_of(node.values[i]);
        if (!node.children.empty()) text += " {\n" + text_of(node.children, indent + "\t") + indent + "}";
        text += "\n";
    }
    return text;
}

// Returns the text file.
inline std::string text(const Nodes& nodes) { return "; FBX 7.4.0 project file\n" + text_of(nodes); }

// Writes a binary file.
class Binary {
public:
    Binary(std::uint32_t version, bool deflate) : wide_(version >= 7500), deflate_(deflate), version_(version) {}

    std::string write(const Nodes& nodes) {
        bytes_ = std::string("Kaydara FBX Binary  \0\x1a\0", 23);
        put(version_);
        for (const Node& node : nodes) write(node);
        end_list();
        return bytes_ + std::string(160, '\7');  // a footer that no reader looks at
    }

private:
    template <class T> void put(T value) {
        char raw[sizeof value];
        std::memcpy(raw, &value, sizeof value);
        bytes_.append(raw, sizeof value);
    }
    void put_size(std::uint64_t size) { wide_ ? put(size) : put(static_cast<std::uint32_t>(size)); }
    void set_size(std::size_t at, std::uint64_t size) { std::memcpy(bytes_.data() + at, &size, wide_ ? 8 : 4); }
    void end_list() { bytes_.append(wide_ ? 25 : 13, '\0'); }

    void write(const Node& node) {
        const std::size_t start = bytes_.size(), width = wide_ ? 8 : 4;
        put_size(0);
        put_size(node.values.size());
        put_size(0);
        put(static_cast<std::uint8_t>(node.name.size()));
        bytes_ += node.name;
        const std::size_t values = bytes_.size();
        for (const Value& value : node.values) std::visit([&](const auto& content) { write_value(content); }, value);
        set_size(start + 2 * width, bytes_.size() - values);
        for (const Node& child : node.children) write(child);
        if (!node.children.empty()) end_list();
        set_size(start, bytes_.size());
    }

    void write_value(const std::string& text) {
        bytes_ += 'S';
        put(static_cast<std::uint32_t>(text.size()));
        bytes_ += text;
    }
    template <class T> void write_value(const std::vector<T>& array) {
        bytes_ += code<T>(true);
        put(static_cast<std::uint32_t>(array.size()));
        const std::string raw(reinterpret_cast<const char*>(array.data()), array.size() * sizeof(T));
        uLongf size = compressBound(raw.size());
        std::string packed(size, '\0');
        compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(raw.data()),
                 raw.size());
        packed.resize(size);
        put(std::uint32_t{deflate_ ? 1u : 0u});
        put(static_cast<std::uint32_t>(deflate_ ? packed.size() : raw.size()));
        bytes_ += deflate_ ? packed : raw;
    }
    template <class T> void write_value(T number) requires std::is_arithmetic_v<T> {
        bytes_ += code<T>(false);
        put(number);
    }
    template <class T> static char code(bool array) {
        const char upper = std::is_same_v<T, double>         ? 'D'
                           : std::is_same_v<T, float>        ? 'F'
                           : std::is_same_v<T, std::int32_t> ? 'I'
                                                             : 'L';
        return static_cast<char>(array ? upper + 32 : upper);
    }

    bool wide_, deflate_;
    std::uint32_t version_;
    std::string bytes_;
};

inline std::string binary(const Nodes& nodes, std::uint32_t version = 7400, bool deflate = true) {
    return Binary(version, deflate).write(nodes);
}

}  // namespace hausbench::fbx
