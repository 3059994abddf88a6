// Reads Collada 1.4 and 1.5: the meshes that the nodes of the scene instantiate, moved by the transforms of the nodes.
// Reads triangles, trifans, tristrips, polylist, polygons, lines and linestrips; a mesh without any of them is a set of
// points. Nodes may instantiate other nodes. Animations, cameras, lights and physics are left out. All triangles of a
// strip have the orientation of its first one. A node that a program hides by <visibility> in an <extra> is read, with
// a note.
//
// Refuses skins and morphs (<instance_controller>), polygons with holes, convex_mesh, spline and brep geometries, URLs
// that lead out of the file, perspective matrices, and <skew>, whose axes the specification describes in two ways that
// contradict each other.
//
// Unit: <unit meter="..."> in the <asset> of the document; 1 metre if it is missing. Axes: <up_axis>; Y_UP if it is
// missing. Both are only stated: coordinates are the numbers of the file, and no axis is exchanged. An <asset> deeper
// in the file has no effect, as in other readers; a note says so if its unit or axis differ.
//
// Error of a coordinate: none if no transform is above the mesh, or only identities. Below k transform elements it is
// at most 4 k u of the sum of the magnitudes of the terms of |M1| ... |Mk| |p|, plus 16 u of it for each <rotate> or
// <lookat>. Rotations by multiples of 90 degrees about x, y or z are exact matrices of 0, 1 and -1.
#include "algorithms/error.h"
#include "algorithms/kernel/direction.h"
#include "datasets/circle.h"
#include "datasets/formats/affine.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"
#include "datasets/formats/xml.h"
#include "datasets/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hausbench::readers {
namespace {

constexpr int deepest = 256;  // levels of nodes, with those that <instance_node> repeats

// Limits on a scene, because instances can repeat nodes so often that a small file fills the memory. The scene may have
// `parts_a_byte` parts for each byte of the file, and `parts_anyway` parts in any case.
constexpr std::size_t parts_a_byte = 200,
                      parts_anyway = std::size_t{1} << 18;  // a part: a node, point or corner, each time it occurs

bool is_element(pugi::xml_node node, std::string_view name) {
    return node.type() == pugi::node_element && local_name(node.name()) == name;
}

bool is_one_of(pugi::xml_node node, const std::set<std::string_view>& names) {
    return node.type() == pugi::node_element && names.contains(local_name(node.name()));
}

// Returns how a message names an element: <geometry> 'id'.
std::string called(pugi::xml_node node) {
    const pugi::xml_attribute id = node.attribute("id");
    return fmt::format("<{}>{}", shown(local_name(node.name())), id ? fmt::format(" '{}'", shown(id.value())) : "");
}

// The mesh of a <geometry>, before any node moves it.
struct ColladaMesh {
    std::vector<Vec3> points;
    std::vector<std::vector<std::size_t>> faces;
    std::size_t corners = 0;  // of all faces
};

// Elements with the same oddity, for a note: the first of them and their number.
struct Occurrences {
    std::string first;
    std::size_t count = 0;

    void add(pugi::xml_node element) {
        if (count++ == 0) first = called(element);
    }
    // Adds a note that begins with the elements.
    void note(const char* after_one, const char* after_several, std::vector<std::string>& notes) const {
        if (count == 1) notes.push_back(first + after_one);
        if (count > 1) notes.push_back(fmt::format("{} and {} more{}", first, count - 1, after_several));
    }
};

struct Oddities {
    Occurrences no_primitives, empty, short_polygons;
};

// Reads the <mesh> of one <geometry>.
class MeshReader {
public:
    MeshReader(const Xml& xml, pugi::xml_node geometry, Oddities& odd) : xml_(xml), geometry_(geometry), odd_(odd) {}

    ColladaMesh read() {
        static const std::set<std::string_view> primitives = {"triangles", "trifans", "tristrips", "polylist",
                                                              "polygons",  "lines",   "linestrips"};
        const pugi::xml_node mesh = checked_mesh();
        for (const pugi::xml_node source : Xml::children(mesh, "source")) {
            const auto [at, added] = sources_.emplace(source.attribute("id").value(), source);
            if (!added) at->second = {};  // refused only if it is used
        }
        vertices_ = xml_.only_child(mesh, "vertices");
        if (!vertices_) xml_.refuse(mesh, "<mesh> has no <vertices>: add it, or save the file again");
        mesh_.points = positions();
        bool any = false;
        for (const pugi::xml_node child : mesh.children()) {
            if (!is_one_of(child, primitives)) continue;
            any = true;
            add_primitive(child);
        }
        if (!any)
            for (std::size_t i = 0; i < mesh_.points.size(); ++i) mesh_.faces.push_back({i});
        for (const auto& face : mesh_.faces) mesh_.corners += face.size();
        if (mesh_.faces.empty())
            odd_.empty.add(geometry_);
        else if (!any)
            odd_.no_primitives.add(geometry_);
        if (short_polygons_ > 0) odd_.short_polygons.add(geometry_);
        return std::move(mesh_);
    }

private:
    pugi::xml_node checked_mesh() const {
        for (const pugi::xml_node child : geometry_.children())
            if (is_one_of(child, {"convex_mesh", "spline", "brep"}))
                xml_.refuse(child, fmt::format("<{}> is not supported, only <mesh>: convert the geometry to triangles "
                                               "in the program that wrote it",
                                               local_name(child.name())));
        const auto meshes = Xml::children(geometry_, "mesh");
        if (meshes.size() != 1)
            xml_.refuse(geometry_, fmt::format("{} has {} <mesh> elements, not one: save the file again",
                                               called(geometry_), meshes.size()));
        return meshes[0];
    }

    // Returns the element that "#id" in an attribute of `input` names. It must be in the same mesh.
    pugi::xml_node source_of(pugi::xml_node input) const {
        const std::string url = xml_.text(input, "source");
        const auto entry = url.starts_with('#') ? sources_.find(std::string_view(url).substr(1)) : sources_.end();
        if (entry == sources_.end())
            xml_.refuse(input, fmt::format("source=\"{}\" names no <source> of the same <mesh>: move it there, or save "
                                           "the file again",
                                           shown(url)));
        if (!entry->second)
            xml_.refuse(input, fmt::format("two <source> elements have the id '{}': rename one", shown(entry->first)));
        return entry->second;
    }

    std::vector<Vec3> positions() const {
        pugi::xml_node position;
        for (const pugi::xml_node input : Xml::children(vertices_, "input")) {
            if (xml_.text(input, "semantic") != "POSITION") continue;
            if (position) xml_.refuse(input, "<vertices> has two inputs POSITION: leave one out");
            position = input;
        }
        if (!position) xml_.refuse(vertices_, "<vertices> has no input POSITION: add it, or save the file again");
        const pugi::xml_node source = source_of(position);
        const pugi::xml_node accessor = xml_.only_child(xml_.only_child(source, "technique_common"), "accessor");
        if (!accessor)
            xml_.refuse(source,
                        fmt::format("{} has no <accessor> in <technique_common>: save the file again", called(source)));
        return read_points(accessor, array_of(source, accessor));
    }

    // Returns the numbers of the array that an accessor names. It must be in the same <source>, as all exporters write
    // it, so that the arrays read for all meshes together are not larger than the file.
    std::vector<double> array_of(pugi::xml_node source, pugi::xml_node accessor) const {
        const std::string url = xml_.text(accessor, "source");
        for (const pugi::xml_node array : source.children()) {
            if (!is_one_of(array, {"float_array", "int_array"}) ||
                url != "#" + std::string(array.attribute("id").value()))
                continue;
            const std::string text = xml_.content(array);
            std::vector<double> values = xml_.numbers(array, text);
            if (array.attribute("count") && xml_.index(array, "count") != values.size())
                xml_.refuse(array, fmt::format("{} announces {} numbers and has {}: it is damaged, save the file again",
                                               called(array), xml_.index(array, "count"), values.size()));
            return values;
        }
        xml_.refuse(accessor,
                    fmt::format("source=\"{}\" names no <float_array> of the same <source>: move it there, or "
                                "save the file again",
                                shown(url)));
    }

    // Returns where x, y and z are in the values of one element of an accessor. A <param> without a name is skipped.
    std::array<std::size_t, 3> places_of(pugi::xml_node accessor, std::size_t stride) const {
        std::vector<std::pair<std::string, std::size_t>> named;
        std::size_t place = 0;
        for (const pugi::xml_node param : Xml::children(accessor, "param")) {
            const std::string_view type = param.attribute("type").value();
            if (type != "float" && type != "double" && type != "int")
                xml_.refuse(param,
                            fmt::format("a coordinate has the type '{}', not float: save the file again", shown(type)));
            if (!std::string_view(param.attribute("name").value()).empty())
                named.emplace_back(param.attribute("name").value(), place);
            ++place;
        }
        if (named.size() != 3)
            xml_.refuse(accessor, fmt::format("positions have {} named params, not the three X, Y and Z: name them",
                                              named.size()));
        if (place > stride)
            xml_.refuse(accessor, fmt::format("has {} params and the stride {}: save the file again", place, stride));
        std::array<std::size_t, 3> places{};
        std::array<bool, 3> seen{};
        for (const auto& [name, at] : named) {
            const std::size_t k = std::string_view("XYZ").find(name.size() == 1 ? name[0] & ~0x20 : '?');
            if (k >= 3 || seen[k])
                xml_.refuse(
                    accessor,
                    fmt::format("has a param '{}' where X, Y and Z are expected, once each: rename it", shown(name)));
            places[k] = at;
            seen[k] = true;
        }
        return places;
    }

    std::vector<Vec3> read_points(pugi::xml_node accessor, const std::vector<double>& values) const {
        const std::size_t count = xml_.index(accessor, "count");
        const std::size_t offset = accessor.attribute("offset") ? xml_.index(accessor, "offset") : 0;
        const std::size_t stride = accessor.attribute("stride") ? xml_.index(accessor, "stride") : 1;
        const std::array<std::size_t, 3> places = places_of(accessor, stride);
        const std::size_t used = 1 + *std::max_element(places.begin(), places.end());
        if (count > 0 && (offset > values.size() || values.size() - offset < used ||
                          (values.size() - offset - used) / stride < count - 1))
            xml_.refuse(accessor,
                        fmt::format("reaches beyond the {} numbers of its array: {} elements with the stride {}, from "
                                    "number {}: it is damaged, save the file again",
                                    values.size(), count, stride, offset));
        std::vector<Vec3> points;
        points.reserve(count);
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t first = offset + i * stride;
            points.emplace_back(values[first + places[0]], values[first + places[1]], values[first + places[2]]);
        }
        return points;
    }

    // Returns the integers in the text of an element.
    std::vector<std::size_t> integers(pugi::xml_node node) const {
        const std::string text = xml_.content(node);
        constexpr std::string_view spaces = " \t\r\n\v\f";
        std::vector<std::size_t> values;
        for (std::size_t at = text.find_first_not_of(spaces); at != std::string::npos;) {
            const std::size_t end = std::min(text.find_first_of(spaces, at), text.size());
            const std::string_view word = std::string_view(text).substr(at, end - at);
            const auto value = whole<std::size_t>(word);
            if (!value) xml_.refuse(node, fmt::format("'{}' is not an integer of at least 0", shown(word)));
            values.push_back(*value);
            at = text.find_first_not_of(spaces, end);
        }
        return values;
    }

    // Returns the place of the vertex among the indices of a corner, and the number of these indices.
    std::pair<std::size_t, std::size_t> layout(pugi::xml_node primitive) const {
        std::optional<std::size_t> vertex;
        std::size_t most = 0;
        for (const pugi::xml_node input : Xml::children(primitive, "input")) {
            const std::size_t offset = xml_.index(input, "offset");
            if (offset >= std::numeric_limits<std::uint32_t>::max())
                xml_.refuse(input, fmt::format("offset=\"{}\" is too large", offset));
            most = std::max(most, offset);
            if (xml_.text(input, "semantic") != "VERTEX") continue;
            if (vertex) xml_.refuse(input, "has two inputs VERTEX: leave one out");
            vertex = offset;
            if (xml_.text(input, "source") != "#" + std::string(vertices_.attribute("id").value()))
                xml_.refuse(input, fmt::format("source=\"{}\" does not name the <vertices> of the same <mesh>",
                                               shown(xml_.text(input, "source"))));
        }
        if (!vertex)
            xml_.refuse(primitive, fmt::format("<{}> has no input VERTEX: add it, or save the file again",
                                               local_name(primitive.name())));
        return {*vertex, most + 1};
    }

    // Returns the vertices of the corners in a <p>.
    std::vector<std::size_t> corners(pugi::xml_node p, std::size_t vertex, std::size_t stride) const {
        const std::vector<std::size_t> indices = integers(p);
        if (indices.size() % stride != 0)
            xml_.refuse(p, fmt::format("<p> has {} indices, not {} for each corner: it is damaged, save the file again",
                                       indices.size(), stride));
        std::vector<std::size_t> vertices;
        for (std::size_t i = vertex; i < indices.size(); i += stride) {
            if (indices[i] >= mesh_.points.size())
                xml_.refuse(p, fmt::format("'{}' names none of the {} vertices, which are counted from 0", indices[i],
                                           mesh_.points.size()));
            vertices.push_back(indices[i]);
        }
        return vertices;
    }

    void add_primitive(pugi::xml_node primitive) {
        const std::string_view kind = local_name(primitive.name());
        if (const pugi::xml_node holes = Xml::child(primitive, "ph"))
            xml_.refuse(holes, "<ph>, a polygon with holes, is not supported: split it into triangles");
        const auto lists = Xml::children(primitive, "p");
        if (lists.empty() && Xml::children(primitive, "input").empty()) return check_count(primitive, 0);
        const auto [vertex, stride] = layout(primitive);
        std::size_t elements = 0;  // in the sense of the attribute `count`
        if (kind == "polylist") {
            std::vector<std::size_t> all;
            for (const pugi::xml_node p : lists)
                for (const std::size_t v : corners(p, vertex, stride)) all.push_back(v);
            elements = add_polylist(primitive, all);
        } else {
            for (const pugi::xml_node p : lists) elements += add_list(p, kind, corners(p, vertex, stride));
        }
        check_count(primitive, elements);
    }

    void check_count(pugi::xml_node primitive, std::size_t elements) const {
        if (primitive.attribute("count") && xml_.index(primitive, "count") != elements)
            xml_.refuse(primitive,
                        fmt::format("<{}> announces count=\"{}\" and has {}: it is damaged, or correct the count",
                                    local_name(primitive.name()), xml_.index(primitive, "count"), elements));
    }

    std::size_t add_polylist(pugi::xml_node primitive, const std::vector<std::size_t>& all) {
        const pugi::xml_node vcount = xml_.only_child(primitive, "vcount");
        const std::vector<std::size_t> sizes = vcount ? integers(vcount) : std::vector<std::size_t>();
        std::size_t at = 0;
        for (const std::size_t size : sizes) {
            if (size > all.size() - at) break;
            add_polygon(
                {all.begin() + static_cast<std::ptrdiff_t>(at), all.begin() + static_cast<std::ptrdiff_t>(at + size)});
            at += size;
        }
        std::size_t sum = 0;
        for (const std::size_t size : sizes) sum = size > all.size() - sum ? all.size() + 1 : sum + size;
        if (sum != all.size())
            xml_.refuse(primitive,
                        fmt::format("<vcount> of <polylist> does not add up to the {} corners in <p>: it is damaged, "
                                    "save the file again",
                                    all.size()));
        return sizes.size();
    }

    void add_polygon(std::vector<std::size_t> face) {
        short_polygons_ += face.size() < 3 ? 1 : 0;
        if (!face.empty()) mesh_.faces.push_back(std::move(face));
    }

    // Adds the faces of one <p>. Returns how many elements it counts for.
    std::size_t add_list(pugi::xml_node p, std::string_view kind, const std::vector<std::size_t>& list) {
        const std::size_t each = kind == "triangles" ? 3 : kind == "lines" ? 2 : 1;
        const std::size_t least = kind == "trifans" || kind == "tristrips" ? 3 : kind == "linestrips" ? 2 : 0;
        if (list.size() % each != 0 || list.size() < least)
            xml_.refuse(
                p, fmt::format("<p> of <{}> has {} corners, {} {}: it is damaged, save the file again", kind,
                               list.size(), least > 0 ? "fewer than" : "not a multiple of", least > 0 ? least : each));
        auto& faces = mesh_.faces;
        if (kind == "polygons") add_polygon(list);
        if (each > 1)
            for (std::size_t i = 0; i < list.size(); i += each)
                faces.emplace_back(list.begin() + static_cast<std::ptrdiff_t>(i),
                                   list.begin() + static_cast<std::ptrdiff_t>(i + each));
        if (kind == "trifans")
            for (std::size_t i = 2; i < list.size(); ++i) faces.push_back({list[0], list[i - 1], list[i]});
        if (kind == "tristrips")
            for (std::size_t i = 2; i < list.size(); ++i)
                faces.push_back({list[i - 2 + i % 2], list[i - 1 - i % 2], list[i]});
        if (kind == "linestrips")
            for (std::size_t i = 1; i < list.size(); ++i) faces.push_back({list[i - 1], list[i]});
        return each > 1 ? list.size() / each : 1;
    }

    const Xml& xml_;
    const pugi::xml_node geometry_;
    Oddities& odd_;
    std::map<std::string, pugi::xml_node, std::less<>> sources_;
    pugi::xml_node vertices_;
    ColladaMesh mesh_;
    std::size_t short_polygons_ = 0;
};

// Where a node stands: its transforms and those of the nodes above it.
struct Placement {
    Affine map;
    pugi::xml_node wrong;  // a transform that is not supported; refused only if a mesh is below it
    std::string why;
};

// Turns the nodes of the scene into faces.
class ColladaScene {
public:
    ColladaScene(const Xml& xml, std::size_t bytes)
        : xml_(xml), parts_left_(std::max(parts_anyway, parts_a_byte * bytes)) {
        soup_.objects = 0;
        list_ids();
    }

    Soup draw() {
        read_asset();
        const pugi::xml_node scene = visual_scene();
        for (const pugi::xml_node node : Xml::children(scene, "node")) draw(node, {}, 0);
        note_left_out();
        if (soup_.faces.empty() && soup_.points.empty())
            xml_.refuse(scene,
                        "the scene instantiates no mesh: export the meshes with their nodes, or convert the file "
                        "to OBJ or PLY");
        return std::move(soup_);
    }

private:
    // Lists the elements that URLs may name, by "kind#id". An id that two elements of a kind have leads to a null node.
    void list_ids() {
        static const std::set<std::string_view> kinds = {"geometry", "node", "visual_scene", "controller"};
        for (pugi::xml_node at = xml_.root(); at;) {
            const pugi::xml_attribute id = at.attribute("id");
            if (id && is_one_of(at, kinds)) {
                const auto [entry, added] = ids_.emplace(fmt::format("{}#{}", local_name(at.name()), id.value()), at);
                if (!added) entry->second = {};
            }
            if (is_element(at, "asset") && at.parent() != xml_.root()) inner_assets_.push_back(at);
            if (is_element(at, "animation")) ++animations_;
            at = next_in_order(at);
        }
    }

    // Returns the node after this one in the order of the document, or a null node at its end.
    pugi::xml_node next_in_order(pugi::xml_node at) const {
        if (at.first_child()) return at.first_child();
        while (at && at != xml_.root() && !at.next_sibling()) at = at.parent();
        return !at || at == xml_.root() ? pugi::xml_node() : at.next_sibling();
    }

    pugi::xml_node named(pugi::xml_node instance, std::string_view kind) const {
        const std::string url = xml_.text(instance, "url");
        if (!url.starts_with('#'))
            xml_.refuse(instance, fmt::format("url=\"{}\" leads out of the file, which is not supported: export "
                                              "everything into one file",
                                              shown(url)));
        const auto entry = ids_.find(std::string(kind) + url);
        if (entry == ids_.end())
            xml_.refuse(instance, fmt::format("url=\"{}\" names no <{}>: save the file again", shown(url), kind));
        if (!entry->second)
            xml_.refuse(instance, fmt::format("two <{}> elements have the id '{}': rename one", kind,
                                              shown(std::string_view(url).substr(1))));
        return entry->second;
    }

    void read_asset() {
        const pugi::xml_node asset = xml_.only_child(xml_.root(), "asset");
        soup_.stated = unit_of(xml_.only_child(asset, "unit"));
        const std::string text = xml_.content(xml_.only_child(asset, "up_axis")), up(trimmed(text));
        soup_.stated.up = up.empty() ? 'Y' : up[0];
        if (!up.empty() && up != "X_UP" && up != "Y_UP" && up != "Z_UP") {
            soup_.stated.up = 0;
            soup_.notes.push_back(
                fmt::format("its up_axis '{}' is none of X_UP, Y_UP and Z_UP, and counts as not stated", shown(up)));
        }
        for (const pugi::xml_node inner : inner_assets_) note_inner(inner);
    }

    Stated unit_of(pugi::xml_node unit) {
        const pugi::xml_attribute meter = unit.attribute("meter");
        const auto metres = meter ? decimal(trimmed(meter.value())) : std::optional(1.0);
        if (!metres || !(*metres > 0) || !std::isfinite(*metres * 1e6)) {
            soup_.notes.push_back(fmt::format(
                "its unit, meter=\"{}\", is not a positive number, and counts as not stated", shown(meter.value())));
            return {};
        }
        Stated stated = stated_unit(*metres);
        const auto other = unit_named(unit.attribute("name").value());
        if (other && other->micrometres != stated.micrometres)
            soup_.notes.push_back(fmt::format("its unit has the name '{}' and meter=\"{}\": the latter counts",
                                              shown(unit.attribute("name").value()), *metres));
        return stated;
    }

    // Adds a note if an asset within an element states another unit or axis than the document.
    void note_inner(pugi::xml_node asset) {
        const auto metres_of = [&](pugi::xml_node element) {
            return decimal(trimmed(xml_.only_child(element, "unit").attribute("meter").as_string("1")));
        };
        const auto up_of = [&](pugi::xml_node element) {
            const std::string text = xml_.content(xml_.only_child(element, "up_axis"));
            return trimmed(text) == "" ? "Y_UP" : std::string(trimmed(text));
        };
        const pugi::xml_node whole_file = xml_.only_child(xml_.root(), "asset");
        const bool unit = xml_.only_child(asset, "unit") && metres_of(asset) != metres_of(whole_file);
        const bool up = xml_.only_child(asset, "up_axis") && up_of(asset) != up_of(whole_file);
        if ((unit || up) && inner_noted_.insert(asset.parent().name()).second)
            soup_.notes.push_back(fmt::format("an <asset> in {} states another {} than the file; it is not applied",
                                              called(asset.parent()), unit ? "unit" : "up_axis"));
    }

    pugi::xml_node visual_scene() {
        const pugi::xml_node scene = xml_.only_child(xml_.root(), "scene");
        const auto instances = Xml::children(scene, "instance_visual_scene");
        if (!Xml::children(scene, "instance_physics_scene").empty())
            soup_.notes.emplace_back("its physics scene is left out");
        if (instances.size() > 1) xml_.refuse(instances[1], "<scene> has two visual scenes: leave one out");
        if (!instances.empty()) return named(instances[0], "visual_scene");
        std::vector<pugi::xml_node> scenes;
        for (const pugi::xml_node library : Xml::children(xml_.root(), "library_visual_scenes"))
            for (const pugi::xml_node visual_scene : Xml::children(library, "visual_scene"))
                scenes.push_back(visual_scene);
        if (scenes.size() != 1)
            xml_.refuse(xml_.root(), fmt::format("has no <scene> that says which of the {} visual scenes counts: add "
                                                 "<scene> with <instance_visual_scene>",
                                                 scenes.size()));
        soup_.notes.emplace_back("has no <scene>: its only visual scene is read");
        return scenes[0];
    }

    // Returns the numbers of a transform element.
    template <std::size_t n> std::array<double, n> values(pugi::xml_node node) const {
        const std::string text = xml_.content(node);
        const std::vector<double> parsed = xml_.numbers(node, text);
        if (parsed.size() != n)
            xml_.refuse(node, fmt::format("<{}> has {} numbers, not {}", local_name(node.name()), parsed.size(), n));
        std::array<double, n> all{};
        std::copy(parsed.begin(), parsed.end(), all.begin());
        for (const double number : all)
            if (!std::isfinite(number))
                xml_.refuse(node, fmt::format("<{}> has a number that is not finite", local_name(node.name())));
        return all;
    }

    // Returns the map of a transform element, or nothing and the reason.
    std::optional<Affine> transform(pugi::xml_node node, std::string& why) const {
        Affine map;
        const std::string_view kind = local_name(node.name());
        if (kind == "translate") {
            const auto [x, y, z] = values<3>(node);
            map.shift = {x, y, z};
        } else if (kind == "scale") {
            const auto [x, y, z] = values<3>(node);
            map.matrix = Vec3(x, y, z).asDiagonal();
        } else if (kind == "matrix") {
            const auto m = values<16>(node);  // by rows
            if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1) {
                why = "<matrix> does not end with the row 0 0 0 1, which is not supported: write it that way";
                return std::nullopt;
            }
            for (std::size_t i = 0; i < 3; ++i) {
                const auto row = static_cast<int>(i);
                for (std::size_t k = 0; k < 3; ++k) map.matrix(row, static_cast<int>(k)) = m[4 * i + k];
                map.shift[row] = m[4 * i + 3];
            }
        } else if (kind == "rotate") {
            return rotation(values<4>(node), why);
        } else if (kind == "lookat") {
            return lookat(values<9>(node), why);
        } else {
            why = "<skew> is not supported: write it as <matrix>";
            return std::nullopt;
        }
        return map;
    }

    // Returns the rotation about an axis by an angle in degrees, by the right-hand rule.
    static std::optional<Affine> rotation(const std::array<double, 4>& v, std::string& why) {
        Affine map;
        if (v[3] == 0) return map;
        const Vec3 scaled = at_unit_scale(Vec3(v[0], v[1], v[2])), axis = scaled / scaled.norm();
        if (!axis.allFinite()) {
            why = "<rotate> has the axis 0 0 0: give it an axis";
            return std::nullopt;
        }
        const auto [cosine, sine] = circle_at_degrees(v[3]);
        Eigen::Matrix3d across;
        across << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
        const Eigen::Matrix3d along = axis * axis.transpose();
        map.matrix = along + cosine * (Eigen::Matrix3d::Identity() - along) + sine * across;
        return map;
    }

    // Returns the map that places an object at a point so that -z points to the point of interest and y up. This is the
    // inverse of the viewing matrix of gluLookAt.
    static std::optional<Affine> lookat(const std::array<double, 9>& v, std::string& why) {
        const auto unit = [](const Vec3& w) -> Vec3 {
            const Vec3 scaled = at_unit_scale(w);
            return scaled / scaled.norm();
        };
        Affine map;
        map.shift = {v[0], v[1], v[2]};
        const Vec3 forward = unit(Vec3(v[3], v[4], v[5]) - map.shift);
        const Vec3 right = unit(forward.cross(unit(Vec3(v[6], v[7], v[8]))));
        if (!forward.allFinite() || !right.allFinite()) {
            why = "<lookat> has no direction, or its up direction is parallel to it: write it as <matrix>";
            return std::nullopt;
        }
        map.matrix.col(0) = right;
        map.matrix.col(1) = right.cross(forward);
        map.matrix.col(2) = -forward;
        return map;
    }

    // Refuses the file if these parts exceed the limit for the whole scene.
    void spend(pugi::xml_node node, std::size_t parts) {
        if (parts > parts_left_)
            xml_.refuse(node, fmt::format("instances repeat nodes so often that it is more than {} nodes, points and "
                                          "corners for each byte of the file: write fewer of them",
                                          parts_a_byte));
        parts_left_ -= parts;
    }

    void draw(pugi::xml_node node, Placement at, int depth) {
        static const std::set<std::string_view> transforms = {"matrix", "translate", "rotate",
                                                              "scale",  "lookat",    "skew"};
        if (depth > deepest)
            xml_.refuse(node,
                        fmt::format("nodes, including those in <instance_node>, are nested deeper than {}: take some "
                                    "of them apart",
                                    deepest));
        spend(node, 1);
        for (const pugi::xml_node child : node.children()) {
            if (!is_one_of(child, transforms) || at.wrong) continue;
            std::string why;
            const auto map = transform(child, why);
            if (map) at.map = at.map * *map;
            if (!map) at = {{}, child, why};
        }
        const std::size_t before = soup_.faces.size();
        for (const pugi::xml_node child : node.children()) {
            if (is_element(child, "node")) draw(child, at, depth + 1);
            if (is_element(child, "instance_node")) draw_instance(child, at, depth);
            if (is_element(child, "instance_geometry")) draw_geometry(child, at);
            if (is_element(child, "instance_controller")) refuse_controller(child);
        }
        if (soup_.faces.size() > before && is_hidden(node)) hidden_.add(node);
    }

    // Returns whether a technique of some program hides a node, which Collada itself cannot.
    bool is_hidden(pugi::xml_node node) const {
        for (const pugi::xml_node extra : Xml::children(node, "extra"))
            for (const pugi::xml_node technique : Xml::children(extra, "technique"))
                for (const pugi::xml_node visibility : Xml::children(technique, "visibility")) {
                    const std::string text = xml_.content(visibility), value = lower_case(trimmed(text));
                    if (value == "false" || decimal(value) == 0.0) return true;
                }
        return false;
    }

    void draw_instance(pugi::xml_node instance, const Placement& at, int depth) {
        const pugi::xml_node node = named(instance, "node");
        if (!active_.insert(node.internal_object()).second)
            xml_.refuse(instance, fmt::format("{} contains an instance of itself: leave it out", called(node)));
        draw(node, at, depth + 1);
        active_.erase(node.internal_object());
    }

    [[noreturn]] void refuse_controller(pugi::xml_node instance) const {
        const pugi::xml_node controller = named(instance, "controller");
        const bool morph = !Xml::children(controller, "morph").empty();
        xml_.refuse(instance, fmt::format("{} is a {}, which deforms a mesh and is not supported: apply it in the "
                                          "program that wrote the file, and export the mesh alone",
                                          called(controller), morph ? "morph" : "skin"));
    }

    void draw_geometry(pugi::xml_node instance, const Placement& at) {
        const pugi::xml_node geometry = named(instance, "geometry");
        if (at.wrong) xml_.refuse(at.wrong, at.why);
        auto entry = meshes_.find(geometry.internal_object());
        if (entry == meshes_.end())
            entry = meshes_.emplace(geometry.internal_object(), MeshReader(xml_, geometry, odd_).read()).first;
        const ColladaMesh& mesh = entry->second;
        spend(instance, mesh.points.size() + mesh.faces.size() + mesh.corners);
        if (mesh.faces.empty()) return;
        ++soup_.objects;
        const std::size_t first = soup_.points.size();
        const bool moves = !at.map.is_identity();
        for (const Vec3& point : mesh.points) soup_.points.push_back(moves ? at.map(point) : point);
        for (const auto& face : mesh.faces) {
            auto& added = soup_.faces.emplace_back();
            for (const std::size_t v : face) added.push_back(first + v);
        }
    }

    void note_left_out() {
        Occurrences unused;
        for (const pugi::xml_node library : Xml::children(xml_.root(), "library_geometries"))
            for (const pugi::xml_node geometry : Xml::children(library, "geometry"))
                if (!meshes_.contains(geometry.internal_object())) unused.add(geometry);
        auto& notes = soup_.notes;
        unused.note(" is left out: no node of the scene instantiates it",
                    " are left out: no node of the scene instantiates them", notes);
        odd_.no_primitives.note(" has no primitives: its vertices count as points",
                                " have no primitives: their vertices count as points", notes);
        odd_.empty.note(" has no corners, and adds nothing", " have no corners, and add nothing", notes);
        odd_.short_polygons.note(" has polygons of fewer than three corners, which count as segments or points",
                                 " have polygons of fewer than three corners, which count as segments or points",
                                 notes);
        hidden_.note(" is read, although <visibility> in an <extra> hides it",
                     " are read, although <visibility> in an <extra> hides them", notes);
        if (animations_ > 0) soup_.notes.emplace_back("its animations are left out: the transforms in the nodes count");
    }

    const Xml& xml_;
    std::size_t parts_left_;
    Soup soup_;
    Oddities odd_;
    std::map<std::string, pugi::xml_node, std::less<>> ids_;
    std::map<const void*, ColladaMesh> meshes_;  // by the <geometry>, each read once
    std::set<const void*> active_;               // the nodes whose instances are being drawn
    std::vector<pugi::xml_node> inner_assets_;
    std::set<std::string> inner_noted_;  // elements that have a note about their <asset>
    std::size_t animations_ = 0;
    Occurrences hidden_;  // nodes with a mesh
};

}  // namespace

Soup read_collada(const Input& input) {
    const Xml xml(input.name, input.bytes, "COLLADA", "Collada");
    const std::string_view version = xml.root().attribute("version").value();
    if (!version.empty() && !version.starts_with("1.4") && !version.starts_with("1.5"))
        throw InputError(fmt::format("{}: is Collada {}, and only 1.4 and 1.5 are supported: convert it to OBJ or PLY",
                                     input.name, shown(version)));
    return ColladaScene(xml, input.bytes.size()).draw();
}

}  // namespace hausbench::readers
