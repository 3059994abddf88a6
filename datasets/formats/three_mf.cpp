// Reads 3MF (core specification 1.4, production extension 1.1): the meshes of all objects that the build section places,
// moved by the transforms of its items and of the components that contain them. Parts of the model in other files of the
// archive are read too. All triangles count, also those inside of other objects, although a printer unites them.
//
// Left out, each with a note: objects that the build does not use, because the specification says that they are not part
// of the model; objects of type "support" and "solidsupport", which the specification allows to ignore; elements of
// private namespaces. Slices beside a mesh of full resolution, materials, colours and sets of triangles do not change
// the surface.
//
// Refused: every other required extension; beam lattices, boolean operations, volumetric data, displacement, mirrored
// meshes and alternatives in an object that is used; meshes of low resolution; objects of type "other" in the build;
// encrypted parts; parts with different units; an empty build section, because nothing else is part of the model.
//
// Unit: the attribute of <model>, millimetre by default. Axes: right-handed, Z up, by section 3.1 of the specification.
// A coordinate that no transform moves is the double nearest to the number in the file. A transform takes p to
// p.x * m0 + p.y * m1 + p.z * m2 + m3, with rows m of the matrix, summed in this order; a component's transforms act
// from the innermost to the outermost. Each is within 4 u (|p.x * m0| + |p.y * m1| + |p.z * m2| + |m3|) of the exact
// result; one that only translates rounds once.
#include "algorithms/error.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"
#include "datasets/formats/xml.h"
#include "datasets/formats/zip_file.h"
#include "datasets/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

namespace hausbench::readers {
namespace {

constexpr std::string_view core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02",
                           production = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
                           slices = "http://schemas.microsoft.com/3dmanufacturing/slice/2015/07",
                           alternatives =
                               "http://schemas.microsoft.com/3dmanufacturing/production/alternatives/2021/04",
                           start_part = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";

// Extensions that a file may require: those that are read, and those that do not change the surface.
const std::set<std::string_view> supported = {core, production, slices,
                                              "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
                                              "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07"};

constexpr std::size_t deepest = 256;  // levels of components

// Limits on the instances of objects, because a small file can repeat objects so often that they fill the memory. The
// model may have `parts_a_byte` parts for each byte of XML, and `parts_anyway` parts in any case.
constexpr std::size_t parts_a_byte = 64,
                      parts_anyway = std::size_t{1} << 22;  // a part: an object, point or corner, each time it occurs

// Returns the prefix of a qualified name: "m" for "m:mesh", and "" for "mesh".
std::string_view prefix_of(const char* name) {
    const std::string_view whole(name), local = local_name(name);
    return whole.substr(0, whole.size() == local.size() ? 0 : whole.size() - local.size() - 1);
}

bool declares_namespaces(pugi::xml_node node) {
    for (const pugi::xml_attribute attribute : node.attributes())
        if (std::string_view(attribute.name()).starts_with("xmlns")) return true;
    return false;
}

std::string name_of_extension(std::string_view uri) {
    static const std::vector<std::pair<std::string_view, std::string_view>> names = {
        {"/balls/", "beam lattices with balls"},       {"/beamlattice/", "beam lattices"},
        {"/booleanoperations/", "boolean operations"}, {"/volumetric/", "volumetric data"},
        {"/implicit/", "implicit functions"},          {"/displacement/", "displacement"},
        {"/securecontent/", "encrypted parts"},        {"/mirroring/", "mirrored meshes"},
        {"/alternatives/", "alternatives of objects"}};
    for (const auto& [part, name] : names)
        if (uri.find(part) != std::string_view::npos)
            return fmt::format("{} ({})", name, one_line(std::string(uri.substr(0, 200))));
    return fmt::format("'{}'", one_line(std::string(uri.substr(0, 200))));
}

struct ThreeMfTransform {
    std::array<double, 12> m;

    Vec3 operator()(const Vec3& p) const {
        Vec3 moved;
        for (std::size_t k = 0; k < 3; ++k)
            moved[static_cast<Eigen::Index>(k)] = p.x() * m[k] + p.y() * m[k + 3] + p.z() * m[k + 6] + m[k + 9];
        return moved;
    }
    bool is_identity() const { return m == std::array<double, 12>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}; }
    bool mirrors() const {
        return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
                   m[2] * (m[3] * m[7] - m[4] * m[6]) <
               0;
    }
};

struct ThreeMfMesh {
    std::vector<Vec3> points;
    std::vector<std::array<std::size_t, 3>> triangles;
};

// An object resource. Each has either a mesh or components.
struct ThreeMfObject {
    pugi::xml_node node;
    bool used = false;
    std::optional<ThreeMfMesh> mesh;  // when it was read
};

// A model part: one XML file of the archive.
class ModelPart {
public:
    // Parses the part. Throws InputError if it requires an extension that is not supported.
    ModelPart(const std::string& name, const std::string& text, bool is_root)
        : is_root(is_root), xml(name, text, "model", "3MF") {
        if (text.find("<!DOCTYPE") != std::string::npos)
            throw InputError(name + ": has a document type definition, which 3MF does not allow: remove it");
        for (pugi::xml_node next = xml.root().next_sibling(); next; next = next.next_sibling())
            if (next.type() == pugi::node_element) xml.refuse(next, "a second root element: XML has one");
        if (!xml.root().attribute("xmlns") && prefix_of(xml.root().name()).empty()) core_ = "";  // as JSCAD writes
        if (namespace_of(xml.root()) != core_)
            xml.refuse(xml.root(), fmt::format("<model> is in the namespace '{}', which is not the core of 3MF, {}: "
                                               "export the file with another program",
                                               shown(namespace_of(xml.root())), core));
        check_required();
        read_unit();
        if (const auto resources = only_child(xml.root(), "resources"))
            for (const pugi::xml_node node : children(resources, "object")) {
                const std::size_t id = xml.index(node, "id");
                if (!objects.emplace(id, ThreeMfObject{node, false, {}}).second)
                    xml.refuse(node, fmt::format("a second object with id {}: give it another", id));
            }
    }

    // Returns the namespace that a prefix stands for at a node; empty if it stands for none.
    std::string_view namespace_at(pugi::xml_node node, std::string_view prefix) const {
        const std::string name = prefix.empty() ? "xmlns" : "xmlns:" + std::string(prefix);
        for (; node && node != xml.root(); node = node.parent()) {
            std::size_t count = 0;
            for (const pugi::xml_attribute attribute : node.attributes()) {
                if (attribute.name() == name) return attribute.value();
                if (++count > 100) xml.refuse(node, "has more than 100 attributes");
            }
        }
        if (namespaces_.empty())
            for (const pugi::xml_attribute attribute : xml.root().attributes())
                namespaces_.emplace(attribute.name(), attribute.value());
        const auto entry = namespaces_.find(name);
        return entry == namespaces_.end() ? std::string_view() : entry->second;
    }

    std::string_view namespace_of(pugi::xml_node node) const { return namespace_at(node, prefix_of(node.name())); }

    // Returns whether a child of an element of the core is one itself.
    bool in_core(pugi::xml_node node) const {
        if (prefix_of(node.name()) == prefix_of(node.parent().name()) && !declares_namespaces(node)) return true;
        return namespace_of(node) == core_;
    }

    bool is(pugi::xml_node node, std::string_view name) const {
        return local_name(node.name()) == name && in_core(node);
    }

    // Returns the children with this name in the core's namespace.
    std::vector<pugi::xml_node> children(pugi::xml_node node, std::string_view name) const {
        std::vector<pugi::xml_node> matches;
        for (const pugi::xml_node child : node.children())
            if (is(child, name)) matches.push_back(child);
        return matches;
    }

    // Returns the child with this name, or a null node. Throws InputError if there are two.
    pugi::xml_node only_child(pugi::xml_node node, std::string_view name) const {
        const auto matches = children(node, name);
        if (matches.size() > 1) xml.refuse(matches[1], fmt::format("a second <{}>, where 3MF has one", name));
        return matches.empty() ? pugi::xml_node() : matches[0];
    }

    // Returns an attribute of an extension, or a null attribute.
    pugi::xml_attribute attribute(pugi::xml_node node, std::string_view uri, std::string_view name) const {
        for (const pugi::xml_attribute candidate : node.attributes())
            if (local_name(candidate.name()) == name && !prefix_of(candidate.name()).empty() &&
                namespace_at(node, prefix_of(candidate.name())) == uri)
                return candidate;
        return {};
    }

    bool has_namespace() const { return !core_.empty(); }

    const bool is_root;
    const Xml xml;
    Unit unit{};
    std::map<std::size_t, ThreeMfObject> objects;
    std::vector<std::string> not_read;  // recommended extensions that are not supported

private:
    std::string_view core_ = core;  // the namespace of its elements

    void check_required() {
        for (const char* kind : {"requiredextensions", "recommendedextensions"}) {
            std::string text = xml.root().attribute(kind).value();
            std::replace(text.begin(), text.end(), '\n', ' ');
            std::string_view rest = text;
            for (auto prefix = next_word(rest); !prefix.empty(); prefix = next_word(rest)) {
                const std::string_view uri = namespace_at(xml.root(), prefix);
                if (supported.contains(uri)) continue;
                const std::string what =
                    uri.empty() ? fmt::format("'{}', which no xmlns declares", shown(prefix)) : name_of_extension(uri);
                if (kind == std::string_view("recommendedextensions"))
                    not_read.push_back(what);
                else
                    xml.refuse(xml.root(), fmt::format("the file requires an extension that is not supported, {}: "
                                                       "export it as a plain mesh",
                                                       what));
            }
        }
    }

    void read_unit() {
        static const std::set<std::string> units = {"micron", "millimeter", "centimeter", "inch", "foot", "meter"};
        const std::string name = xml.root().attribute("unit").as_string("millimeter");
        if (!units.contains(name))
            xml.refuse(xml.root(),
                       fmt::format("unit=\"{}\" is not a unit of 3MF: write micron, millimeter, centimeter, inch, foot "
                                   "or meter",
                                   shown(name)));
        unit = unit_named(name).value();
    }

    mutable std::map<std::string, std::string> namespaces_;  // the attributes of the root element
};

// Places the objects of the build section.
class ThreeMfBuild {
public:
    ThreeMfBuild(const std::string& name, ZipFile& zip) : name_(name), zip_(zip) { soup_.objects = 0; }

    Soup read(const std::string& start) {
        ModelPart& root = part(start, true);
        const pugi::xml_node build = root.only_child(root.xml.root(), "build");
        const auto items = root.children(build, "item");
        if (items.empty())
            throw InputError(name_ +
                             ": its build section is empty, so that no object is part of the model: add the objects to "
                             "the build, or export the model again");
        for (const pugi::xml_node item : items) place_reference(root, item);
        if (soup_.faces.empty())
            throw InputError(fmt::format("{}: the objects of its build have no triangle{}", name_,
                                         supports_ ? ", except supports, which are left out" : ""));
        soup_.stated = stated_unit(root.unit);
        soup_.stated.up = 'Z';
        add_notes();
        return std::move(soup_);
    }

private:
    ModelPart& part(const std::string& path, bool is_root) {
        auto& model_part = parts_[normal_part_name(path)];
        if (!model_part) {
            if (!zip_.has(path))
                throw InputError(fmt::format("{}: refers to '{}', which is not in its archive: save or fetch it again",
                                             name_, shown(path)));
            const std::string text = zip_.read(path);
            model_part = std::make_unique<ModelPart>(fmt::format("{}: {}", name_, one_line(path)), text, is_root);
            parts_left_ += parts_a_byte * text.size();
            if (!model_part->has_namespace())
                note("its <model> names no XML namespace, as 3MF requires: it is read as the core of 3MF");
            for (const std::string& what : model_part->not_read)
                note(fmt::format("recommends an extension that is not supported and is left out, {}", what));
        }
        return *model_part;
    }

    void note(std::string text) {
        if (noted_.insert(text).second && noted_.size() <= 20) soup_.notes.push_back(std::move(text));
    }

    void spend(const ModelPart& part, pugi::xml_node node, std::size_t parts) {
        if (parts > parts_left_)
            part.xml.refuse(node, fmt::format("items and components repeat objects so often that they are more than {} "
                                              "objects, points and corners for each byte of the file: write fewer",
                                              parts_a_byte));
        parts_left_ -= parts;
    }

    static ThreeMfTransform transform_of(const ModelPart& part, pugi::xml_node node) {
        ThreeMfTransform transform{{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}};
        const pugi::xml_attribute text = node.attribute("transform");
        if (!text) return transform;
        const auto numbers = part.xml.numbers(node, text.value());
        if (numbers.size() != 12 ||
            !std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::isfinite(n); }))
            part.xml.refuse(node, fmt::format("transform=\"{}\" is not 12 finite numbers", shown(text.value())));
        std::copy(numbers.begin(), numbers.end(), transform.m.begin());
        return transform;
    }

    // Returns the part with the object that an item or component names.
    ModelPart& part_of_reference(ModelPart& from, pugi::xml_node node) {
        if (node.attribute("path"))
            from.xml.refuse(node, "'path' stands without the prefix of the production extension: add it");
        const pugi::xml_attribute path = from.attribute(node, production, "path");
        if (!path) return from;
        if (!from.is_root)
            from.xml.refuse(node,
                            "a component outside of the root model part has a path, which the production "
                            "extension does not allow: export the file again");
        ModelPart& to = part(path.value(), false);
        if (to.unit.micrometres != from.unit.micrometres)
            from.xml.refuse(node, fmt::format("refers to '{}', which is in {}, from a part in {}: 3MF does not say how "
                                              "they combine, write both in one unit",
                                              shown(path.value()), to.unit.name, from.unit.name));
        return to;
    }

    // Places the object that an item or component names.
    void place_reference(ModelPart& from, pugi::xml_node node) {
        if (node.attribute("printable").as_string("1") == std::string_view("0"))
            note("an item of its build is marked as not printable, which 3MF does not define: it counts");
        ModelPart& to = part_of_reference(from, node);
        const std::size_t id = from.xml.index(node, "objectid");
        const auto entry = to.objects.find(id);
        if (entry == to.objects.end())
            from.xml.refuse(node, fmt::format("objectid={} names no object of its model part", id));
        if (!inside_.insert(&entry->second).second) from.xml.refuse(node, fmt::format("object {} contains itself", id));
        if (inside_.size() > deepest)
            from.xml.refuse(node,
                            fmt::format("components are nested deeper than {}: take some of them apart", deepest));
        const ThreeMfTransform transform = transform_of(from, node);
        if (!transform.is_identity()) transforms_.push_back(transform);
        place(to, entry->second);
        if (!transform.is_identity()) transforms_.pop_back();
        inside_.erase(&entry->second);
    }

    void place(ModelPart& part, ThreeMfObject& object) {
        const std::string_view type = object.node.attribute("type").as_string("model");
        spend(part, object.node, 1);
        object.used = true;
        if (type == "support" || type == "solidsupport") {
            ++supports_;
            return;
        }
        if (type == "other")
            part.xml.refuse(object.node,
                            "an object of type 'other' is used by the build, which 3MF does not allow: give "
                            "it the type 'model', or remove it from the build");
        if (type != "model" && type != "surface")
            part.xml.refuse(object.node, fmt::format("type=\"{}\" is not a type of objects in 3MF: write model, "
                                                     "surface, support or solidsupport",
                                                     shown(type)));
        check_object(part, object.node);
        const pugi::xml_node mesh = part.only_child(object.node, "mesh"),
                             components = part.only_child(object.node, "components");
        if (!mesh == !components) part.xml.refuse(object.node, "an object needs either a <mesh> or <components>");
        for (const pugi::xml_node child : components.children())
            if (part.is(child, "component"))
                place_reference(part, child);
            else
                check_foreign(part, child, {});
        if (mesh) place_mesh(part, object, mesh);
    }

    // Refuses an object whose mesh is not its surface.
    void check_object(const ModelPart& part, pugi::xml_node object) {
        if (part.attribute(object, slices, "meshresolution").value() == std::string_view("lowres"))
            part.xml.refuse(object,
                            "the mesh of this object has low resolution, and its slices are not supported: "
                            "export it with a mesh of full resolution");
        if (part.attribute(object, slices, "slicestackid"))
            note("slices of objects are left out: their meshes have full resolution");
        const std::string_view resolution =
            part.attribute(object, alternatives, "modelresolution").as_string("fullres");
        if (resolution != "fullres")
            part.xml.refuse(object, fmt::format("this object has modelresolution=\"{}\": export the full resolution",
                                                shown(resolution)));
        for (const pugi::xml_node child : object.children())
            check_foreign(part, child, {"mesh", "components", "metadatagroup"});
    }

    // Refuses a child of an element of the core that is not one of `expected` but may have a surface. Notes others.
    void check_foreign(const ModelPart& part, pugi::xml_node node, std::initializer_list<std::string_view> expected) {
        if (node.type() != pugi::node_element) return;
        if (part.in_core(node)) {
            if (std::find(expected.begin(), expected.end(), local_name(node.name())) == expected.end())
                part.xml.refuse(node, fmt::format("<{}> is not an element that 3MF has here: export the file again",
                                                  shown(node.name())));
            return;
        }
        const std::string_view uri = part.namespace_of(node);
        if (supported.contains(uri)) return;
        if (uri.find("/3dmanufacturing/") != std::string_view::npos)
            part.xml.refuse(node, fmt::format("<{}> belongs to an extension that is not supported, {}: export the file "
                                              "as a plain mesh",
                                              shown(node.name()), name_of_extension(uri)));
        note(fmt::format("<{}> of the private namespace {} is left out", shown(node.name()), name_of_extension(uri)));
    }

    const ThreeMfMesh& mesh_of(const ModelPart& part, ThreeMfObject& object, pugi::xml_node node) {
        if (object.mesh) return *object.mesh;
        for (const pugi::xml_node child : node.children()) check_foreign(part, child, {"vertices", "triangles"});
        ThreeMfMesh& mesh = object.mesh.emplace();
        for (const pugi::xml_node child : part.only_child(node, "vertices").children()) {
            check_foreign(part, child, {"vertex"});
            if (!part.is(child, "vertex")) continue;
            const auto texts = three_attributes(part, child, {"x", "y", "z"});
            Vec3 point;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto number = decimal(trimmed(texts[k]));
                if (!number) part.xml.refuse(child, fmt::format("'{}' is not a number", shown(texts[k])));
                point[static_cast<Eigen::Index>(k)] = *number;
            }
            mesh.points.push_back(point);
        }
        for (const pugi::xml_node child : part.only_child(node, "triangles").children()) {
            check_foreign(part, child, {"triangle"});
            if (!part.is(child, "triangle")) continue;
            const auto texts = three_attributes(part, child, {"v1", "v2", "v3"});
            auto& corners = mesh.triangles.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) {
                const auto index = whole<std::size_t>(trimmed(texts[k]));
                if (!index || *index >= mesh.points.size())
                    part.xml.refuse(child, fmt::format("v{}=\"{}\" names none of the {} vertices, which are counted "
                                                       "from 0",
                                                       k + 1, shown(texts[k]), mesh.points.size()));
                corners[k] = *index;
            }
        }
        return mesh;
    }

    // Returns the values of three attributes, each of which must be there.
    static std::array<std::string_view, 3> three_attributes(const ModelPart& part, pugi::xml_node node,
                                                            const std::array<const char*, 3>& names) {
        std::array<std::string_view, 3> values;
        for (std::size_t k = 0; k < 3; ++k) {
            const pugi::xml_attribute attribute = node.attribute(names[k]);
            if (!attribute)
                part.xml.refuse(node, fmt::format("<{}> has no attribute '{}'", shown(node.name()), names[k]));
            values[k] = attribute.value();
        }
        return values;
    }

    void place_mesh(const ModelPart& part, ThreeMfObject& object, pugi::xml_node node) {
        const ThreeMfMesh& mesh = mesh_of(part, object, node);
        spend(part, node, mesh.points.size() * (1 + transforms_.size()) + 3 * mesh.triangles.size());
        ++soup_.objects;
        const std::size_t first = soup_.points.size();
        for (Vec3 point : mesh.points) {
            for (auto t = transforms_.rbegin(); t != transforms_.rend(); ++t) point = (*t)(point);
            soup_.points.push_back(point);
        }
        const bool mirrored =
            std::count_if(transforms_.begin(), transforms_.end(), [](const auto& t) { return t.mirrors(); }) % 2 == 1;
        for (const auto& [a, b, c] : mesh.triangles)
            if (mirrored)
                soup_.faces.push_back({first + a, first + c, first + b});
            else
                soup_.faces.push_back({first + a, first + b, first + c});
    }

    void add_notes() {
        std::size_t unused = 0;
        for (const auto& [path, part] : parts_)
            for (const auto& [id, object] : part->objects) unused += object.used ? 0 : 1;
        if (unused > 0)
            note(fmt::format("{} object{} that its build does not use {} left out", unused, unused == 1 ? "" : "s",
                             unused == 1 ? "is" : "are"));
        if (supports_ > 0)
            note(
                fmt::format("{} object{} of type support {} left out: supports only hold the model while it is printed",
                            supports_, supports_ == 1 ? "" : "s", supports_ == 1 ? "is" : "are"));
        note_slicer_volumes();
    }

    // Slicers state in files of their own that some triangles are not part of the surface.
    void note_slicer_volumes() {
        for (const auto& [path, entry] : zip_.names()) {
            if (path != "metadata/slic3r_pe_model.config" && path != "metadata/model_settings.config") continue;
            const std::string text = zip_.read(path);
            for (const char* word : {"ParameterModifier", "NegativeVolume", "SupportEnforcer", "SupportBlocker",
                                     "modifier_part", "negative_part", "support_enforcer", "support_blocker"})
                if (text.find(fmt::format("\"{}\"", word)) != std::string::npos)
                    note(fmt::format("by {} some triangles are a {}, which 3MF does not define: they count as surface",
                                     shown(entry), word));
        }
    }

    const std::string& name_;
    ZipFile& zip_;
    std::map<std::string, std::unique_ptr<ModelPart>> parts_;  // by normal names
    std::size_t parts_left_ = parts_anyway;
    std::vector<ThreeMfTransform> transforms_;  // of the objects around, from the outermost
    std::set<const ThreeMfObject*> inside_;     // the objects around
    std::set<std::string> noted_;
    std::size_t supports_ = 0;
    Soup soup_;
};

// Returns the path of the root model part.
std::string start_of(const std::string& name, ZipFile& zip) {
    if (!zip.has("_rels/.rels"))
        throw InputError(name +
                         ": is not a 3MF file: its archive has no _rels/.rels: unpack it, and name a file in it");
    const Xml relations(name + ": _rels/.rels", zip.read("_rels/.rels"), "Relationships", "3MF");
    std::string start;
    for (const pugi::xml_node relation : Xml::children(relations.root(), "Relationship")) {
        const std::string_view type = relation.attribute("Type").value();
        if (type.ends_with("/keystore"))
            relations.refuse(relation, "the file has encrypted parts, which are not supported: export it without them");
        if (type != start_part) continue;
        if (!start.empty()) relations.refuse(relation, "a second root model part: export one of the models alone");
        if (relation.attribute("TargetMode").value() == std::string_view("External"))
            relations.refuse(relation, "the model lies outside of the archive, which 3MF does not allow");
        start = relations.text(relation, "Target");
        if (normal_part_name(start).empty())
            relations.refuse(relation, fmt::format("'{}' is not a path in the archive", shown(start)));
    }
    if (start.empty())
        throw InputError(name + ": is not a 3MF file: _rels/.rels names no 3D model: export the file again");
    return start;
}

}  // namespace

Soup read_3mf(const Input& input) {
    ZipFile zip(input.name, input.bytes);
    const std::string start = start_of(input.name, zip);
    return ThreeMfBuild(input.name, zip).read(start);
}

}  // namespace hausbench::readers
