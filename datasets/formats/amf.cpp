// Reads AMF (ISO/ASTM 52915), as XML or as a ZIP archive with one .amf file: the triangles of all volumes of all
// meshes. If there are constellations, their instances place the objects; otherwise all objects stand at their own
// coordinates, with a note if there are several, because the standard then leaves their relative positions open. The
// standard does not say whether an object and a constellation may share an id, as in files of FreeCAD. If they do, an
// instance in the constellation of that id names the object, because no constellation may contain itself; any other
// instance of the id is refused.
//
// An instance rotates by rx, ry or rz degrees about an axis through the origin, by the right-hand rule, and then moves
// by deltax, deltay and deltaz. The standard executes rotations "in order of x first, then y, then z", which programs
// understand as turns about the fixed axes or about the turned axes, with different results. Therefore rotations about
// more than one axis are refused. Volumes of type "support" are left out, with a note.
//
// Refused: curved triangles, which normals of vertices and <edge> define; materials that are functions of the place,
// which may define lattices; objects that no constellation places, beside others that one does; scale factors and
// mirrors of instances, which some slicers add, and rotations beside them, which they write in radians.
//
// Unit: the attribute of <amf>, millimetre by default. Axes: the standard does not say which points up.
// A coordinate that no instance moves is the double nearest to the number in the file. Each instance around an object
// moves it to within 8 u (|x| + |y| + |z| + |delta|) of the exact place; one without rotation rounds once.
#include "algorithms/error.h"
#include "datasets/circle.h"
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
#include <optional>
#include <set>
#include <utility>

namespace hausbench::readers {
namespace {

constexpr std::size_t deepest = 256;  // levels of constellations

// Limits on instances, because a small file can repeat objects so often that they fill the memory. The model may have
// `parts_a_byte` parts for each byte of XML, and `parts_anyway` parts in any case.
constexpr std::size_t parts_a_byte = 64,
                      parts_anyway = std::size_t{1} << 22;  // a part: an instance, point or corner, each time it occurs

struct AmfMove {
    int axis = -1;      // of the rotation: 0, 1 or 2; -1: none
    Circle turn{1, 0};  // cosine and sine of its angle
    Vec3 delta{0, 0, 0};

    Vec3 operator()(Vec3 p) const {
        if (axis >= 0) {
            const Eigen::Index u = (axis + 1) % 3, v = (axis + 2) % 3;
            const double along_u = turn.cosine * p[u] - turn.sine * p[v],
                         along_v = turn.sine * p[u] + turn.cosine * p[v];
            p[u] = along_u;
            p[v] = along_v;
        }
        return p + delta;
    }
};

// Returns the point of the unit circle at an angle in degrees, exact for multiples of 90.
Circle circle_at_degrees(double degrees) {
    const double within = std::fmod(degrees, 360), quarters = std::round(within / 90);
    const Circle rest = circle_near_zero((within - quarters * 90) * 0.017453292519943295);
    return turned(rest, (static_cast<int>(quarters) + 4) % 4);
}

struct AmfMesh {
    std::vector<Vec3> points;
    std::vector<std::array<std::size_t, 3>> triangles;
};

struct AmfObject {
    std::vector<AmfMesh> meshes;
    pugi::xml_node node;
    bool used = false;
};

class AmfFile {
public:
    AmfFile(const std::string& name, std::string_view bytes)
        : xml_(name, bytes, "amf", "AMF"), name_(name), parts_left_(parts_anyway + parts_a_byte * bytes.size()) {
        soup_.objects = 0;
    }

    Soup read() {
        for (pugi::xml_node next = xml_.root().next_sibling(); next; next = next.next_sibling())
            if (next.type() == pugi::node_element) xml_.refuse(next, "a second root element: XML has one");
        read_unit();
        find_materials();
        for (const pugi::xml_node node : children(xml_.root(), "object")) {
            const std::string id = xml_.text(node, "id");
            if (!objects_.try_emplace(id).second) refuse_second(node, id);
            AmfObject& object = objects_[id];
            object.node = node;
            for (const pugi::xml_node mesh : children(node, "mesh")) object.meshes.push_back(mesh_of(mesh));
        }
        for (const pugi::xml_node node : children(xml_.root(), "constellation")) {
            const std::string id = xml_.text(node, "id");
            if (!constellations_.emplace(id, node).second) refuse_second(node, id);
        }
        if (constellations_.empty())
            place_all();
        else
            place_constellations();
        if (soup_.faces.empty())
            throw InputError(fmt::format("{}: its objects have no triangle{}", name_,
                                         supports_ ? ", except supports, which are left out" : ""));
        if (supports_ > 0)
            note(
                fmt::format("{} volume{} of type support {} left out: supports only hold the model while it is printed",
                            supports_, supports_ == 1 ? "" : "s", supports_ == 1 ? "is" : "are"));
        return std::move(soup_);
    }

private:
    [[noreturn]] void refuse_second(pugi::xml_node node, const std::string& id) const {
        xml_.refuse(node, fmt::format("a second <{}> with id '{}': give it another", shown(node.name()), shown(id)));
    }

    void note(std::string text) {
        if (noted_.insert(text).second && noted_.size() <= 20) soup_.notes.push_back(std::move(text));
    }

    // Returns the child elements with this name and the prefix of the root element.
    std::vector<pugi::xml_node> children(pugi::xml_node node, std::string_view name) const {
        std::vector<pugi::xml_node> matches;
        for (const pugi::xml_node child : node.children())
            if (is(child, name)) matches.push_back(child);
        return matches;
    }

    bool is(pugi::xml_node node, std::string_view name) const {
        const std::string_view whole = node.name(), root = xml_.root().name();
        const std::string_view prefix = root.substr(0, root.size() - local_name(xml_.root().name()).size());
        return whole.size() == prefix.size() + name.size() && whole.starts_with(prefix) && whole.ends_with(name);
    }

    pugi::xml_node only_child(pugi::xml_node node, std::string_view name) const {
        const auto matches = children(node, name);
        if (matches.size() != 1)
            xml_.refuse(node, fmt::format("<{}> has {} <{}>, not one", shown(node.name()), matches.size(), name));
        return matches[0];
    }

    // Returns the text of an element, without blanks at its ends.
    std::string text_of(pugi::xml_node node) const {
        for (const pugi::xml_node child : node.children())
            if (child.type() == pugi::node_element)
                xml_.refuse(child, fmt::format("<{}> inside of <{}>, where a number is expected", shown(child.name()),
                                               shown(node.name())));
        const std::string text = xml_.content(node);
        constexpr std::string_view spaces = " \t\r\n";
        const std::size_t first = text.find_first_not_of(spaces);
        return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(spaces) - first + 1);
    }

    double number_of(pugi::xml_node node) const {
        const std::string text = text_of(node);
        const auto number = decimal(text);
        if (!number) xml_.refuse(node, fmt::format("'{}' is not a number", shown(text)));
        return *number;
    }

    void read_unit() {
        static const std::set<std::string> units = {"millimeter", "inch", "feet", "meter", "micron"};
        const std::string unit = xml_.root().attribute("unit").as_string("millimeter");
        if (!units.contains(unit))
            xml_.refuse(xml_.root(),
                        fmt::format("unit=\"{}\" is not a unit of AMF: write millimeter, inch, feet, meter or micron",
                                    shown(unit)));
        soup_.stated = stated_unit(unit_named(unit).value());
    }

    // Finds the materials that are functions of the place.
    void find_materials() {
        for (const pugi::xml_node material : children(xml_.root(), "material"))
            for (const pugi::xml_node composite : children(material, "composite"))
                if (!decimal(text_of(composite))) graded_.emplace(material.attribute("id").value());
    }

    AmfMesh mesh_of(pugi::xml_node node) {
        AmfMesh mesh;
        for (const pugi::xml_node child : only_child(node, "vertices").children()) {
            if (is(child, "edge"))
                xml_.refuse(child,
                            "<edge> defines curved triangles, which are not supported: export flat triangles, or "
                            "remove all <edge> and <normal> if they are meant to be flat");
            if (is(child, "vertex"))
                mesh.points.push_back(vertex_of(child));
            else
                note_unknown(child, {});
        }
        for (const pugi::xml_node child : node.children())
            if (is(child, "volume"))
                read_volume(child, mesh);
            else
                note_unknown(child, {"vertices"});
        return mesh;
    }

    void note_unknown(pugi::xml_node node, std::initializer_list<std::string_view> expected) {
        static const std::set<std::string_view> harmless = {"metadata", "color", "texmap", "map"};
        const std::string_view name = local_name(node.name());
        if (node.type() == pugi::node_element && !harmless.contains(name) &&
            std::find(expected.begin(), expected.end(), name) == expected.end())
            note(fmt::format("<{}> in <{}> is not an element of AMF, and is left out", shown(node.name()),
                             shown(node.parent().name())));
    }

    Vec3 vertex_of(pugi::xml_node node) {
        for (const pugi::xml_node child : node.children()) {
            if (is(child, "normal"))
                xml_.refuse(child,
                            "the <normal> of a vertex defines curved triangles, which are not supported: export "
                            "flat triangles, or remove all <edge> and <normal> if they are meant to be flat");
            note_unknown(child, {"coordinates"});
        }
        const pugi::xml_node coordinates = only_child(node, "coordinates");
        return {number_of(only_child(coordinates, "x")), number_of(only_child(coordinates, "y")),
                number_of(only_child(coordinates, "z"))};
    }

    void read_volume(pugi::xml_node node, AmfMesh& mesh) {
        const std::string material = node.attribute("materialid").value();
        if (graded_.contains(material))
            xml_.refuse(node, fmt::format("material '{}' is a function of the place, which may define a lattice and is "
                                          "not supported: give the volume another material",
                                          shown(material)));
        if (node.attribute("type").value() == std::string_view("support")) {
            ++supports_;
            return;
        }
        for (const pugi::xml_node child : node.children()) {
            if (is(child, "metadata") && child.attribute("type").value() == std::string_view("slic3r.volume_type") &&
                text_of(child) != "ModelPart")
                note(fmt::format("a volume is a {} of a slicer, which AMF does not define: it counts as surface",
                                 shown(text_of(child))));
            if (!is(child, "triangle")) {
                note_unknown(child, {});
                continue;
            }
            auto& corners = mesh.triangles.emplace_back();
            constexpr std::array<std::string_view, 3> names = {"v1", "v2", "v3"};
            for (std::size_t k = 0; k < 3; ++k) {
                const pugi::xml_node corner = only_child(child, names[k]);
                const std::string text = text_of(corner);
                const auto index = whole<std::size_t>(text);
                if (!index || *index >= mesh.points.size())
                    xml_.refuse(corner, fmt::format("'{}' names none of the {} vertices, which are counted from 0",
                                                    shown(text), mesh.points.size()));
                corners[k] = *index;
            }
        }
    }

    void place_all() {
        for (auto& [id, object] : objects_) place(object);
        if (objects_.size() > 1)
            note(fmt::format("{} objects stand at their own coordinates: no constellation places them",
                             objects_.size()));
    }

    void place_constellations() {
        std::set<std::string> inner;
        for (const auto& [id, node] : constellations_)
            for (const pugi::xml_node instance : children(node, "instance"))
                if (const std::string to = xml_.text(instance, "objectid"); to != id || !objects_.contains(to))
                    inner.insert(to);
        std::size_t outer = 0;
        for (const auto& [id, node] : constellations_)
            if (!inner.contains(id)) {
                ++outer;
                place(id, node);
            }
        if (outer == 0) throw InputError(name_ + ": every constellation is an instance in another one: leave one out");
        if (outer > 1)
            note(fmt::format("{} constellations stand at their own coordinates: none places the others", outer));
        for (const auto& [id, object] : objects_)
            if (!object.used)
                xml_.refuse(object.node, fmt::format("object '{}' is in no constellation, while others are: add an "
                                                     "instance of it, or remove it",
                                                     shown(id)));
    }

    void place(const std::string& id, pugi::xml_node constellation) {
        if (!inside_.insert(id).second)
            xml_.refuse(constellation, fmt::format("constellation '{}' contains itself", shown(id)));
        if (inside_.size() > deepest)
            xml_.refuse(constellation, fmt::format("constellations are nested deeper than {}: merge some", deepest));
        for (const pugi::xml_node instance : children(constellation, "instance")) {
            spend(instance, 1);
            const std::string to = xml_.text(instance, "objectid");
            const auto object = objects_.find(to);
            const auto inner = constellations_.find(to);
            if (object == objects_.end() && inner == constellations_.end())
                xml_.refuse(instance, fmt::format("objectid=\"{}\" names no object or constellation", shown(to)));
            if (object != objects_.end() && inner != constellations_.end() && to != id)
                xml_.refuse(instance,
                            fmt::format("objectid=\"{}\" names an object and a constellation: give one of them "
                                        "another id",
                                        shown(to)));
            moves_.push_back(move_of(instance));
            if (object != objects_.end())
                place(object->second);
            else
                place(to, inner->second);
            moves_.pop_back();
        }
        inside_.erase(id);
    }

    AmfMove move_of(pugi::xml_node instance) {
        constexpr std::array<std::string_view, 6> names = {"deltax", "deltay", "deltaz", "rx", "ry", "rz"};
        static const std::set<std::string_view> added = {"scale",   "scalex",  "scaley", "scalez",
                                                         "mirrorx", "mirrory", "mirrorz"};
        std::array<std::optional<double>, 6> values;
        bool by_slicer = false;
        for (const pugi::xml_node child : instance.children()) {
            const std::string_view name = child.name();
            const auto at = static_cast<std::size_t>(
                std::find_if(names.begin(), names.end(), [&](auto expected) { return is(child, expected); }) -
                names.begin());
            if (at < names.size()) {
                if (values[at]) xml_.refuse(child, fmt::format("a second <{}>: remove one", name));
                values[at] = number_of(child);
                if (!std::isfinite(*values[at])) xml_.refuse(child, fmt::format("<{}> is not finite", name));
            } else if (added.contains(name)) {
                by_slicer = true;
                if (number_of(child) != 1)
                    xml_.refuse(child,
                                fmt::format("<{}> of an instance is not part of AMF: apply it to the object", name));
            } else if (name == "printable") {
                if (text_of(child) == "0")
                    note("an instance is marked as not printable, which AMF does not define: it counts");
            } else {
                note_unknown(child, {});
            }
        }
        return move_of(instance, values, by_slicer);
    }

    AmfMove move_of(pugi::xml_node instance, const std::array<std::optional<double>, 6>& values, bool by_slicer) {
        AmfMove move;
        move.delta = Vec3(values[0].value_or(0), values[1].value_or(0), values[2].value_or(0));
        for (int axis = 0; axis < 3; ++axis) {
            const double degrees = values[static_cast<std::size_t>(axis) + 3].value_or(0);
            if (degrees == 0) continue;
            if (move.axis >= 0)
                xml_.refuse(instance,
                            "rotations about more than one axis are not supported, because programs execute "
                            "them in different orders: apply them to the object");
            if (by_slicer)
                xml_.refuse(instance,
                            "the instance is rotated and has scale factors or mirrors, as in files of slicers "
                            "that write angles in radians, where AMF has degrees: apply the rotation to the "
                            "object");
            move.axis = axis;
            move.turn = circle_at_degrees(degrees);
        }
        if (move.axis >= 0 && move.delta != Vec3(0, 0, 0))
            note("instances are rotated first and then moved: the standard does not state this order clearly");
        return move;
    }

    void spend(pugi::xml_node node, std::size_t parts) {
        if (parts > parts_left_)
            xml_.refuse(node,
                        fmt::format("constellations repeat objects so often that they are more than {} instances, "
                                    "points and corners for each byte of the file: write fewer",
                                    parts_a_byte));
        parts_left_ -= parts;
    }

    void place(AmfObject& object) {
        object.used = true;
        for (const AmfMesh& mesh : object.meshes) {
            spend(object.node, mesh.points.size() * (1 + moves_.size()) + 3 * mesh.triangles.size());
            ++soup_.objects;
            const std::size_t first = soup_.points.size();
            for (Vec3 point : mesh.points) {
                for (auto move = moves_.rbegin(); move != moves_.rend(); ++move) point = (*move)(point);
                soup_.points.push_back(point);
            }
            for (const auto& [a, b, c] : mesh.triangles) soup_.faces.push_back({first + a, first + b, first + c});
        }
    }

    const Xml xml_;
    const std::string name_;
    std::size_t parts_left_;
    std::map<std::string, AmfObject> objects_;
    std::map<std::string, pugi::xml_node> constellations_;
    std::set<std::string> graded_, inside_, noted_;  // materials; constellations around; notes
    std::vector<AmfMove> moves_;                     // of the instances around, from the outermost
    std::size_t supports_ = 0;
    Soup soup_;
};

}  // namespace

Soup read_amf(const Input& input) {
    if (!input.bytes.starts_with("PK\x03\x04")) return AmfFile(input.name, input.bytes).read();
    ZipFile zip(input.name, input.bytes);
    std::string model_path;
    for (const auto& [path, entry] : zip.names())
        if (path.ends_with(".amf")) {
            if (!model_path.empty())
                throw InputError(
                    fmt::format("{}: its archive has several .amf files: unpack it, and name one of them", input.name));
            model_path = path;
        }
    if (model_path.empty())
        throw InputError(input.name + ": its archive has no .amf file: unpack it, and name a file in it");
    return AmfFile(fmt::format("{}: {}", input.name, one_line(model_path)), zip.read(model_path)).read();
}

}  // namespace hausbench::readers
