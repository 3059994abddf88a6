// Reads FBX 7.0 to 7.7, binary and text: the polygons and lines of the geometries that the models of the scene show,
// moved by the transforms of the models. Animations, constraints, cameras and lights are left out.
//
// A point p of a geometry of a model moves to G1 ... Gn Gt Gr Gs p, with a factor G for the model and each model above
// it: G = T Roff Rp Rpre R Rpost^-1 Rp^-1 Soff Sp S Sp^-1, as Autodesk documents it ("Computing transformation
// matrices"), and the geometric translation, rotation and scaling of the model alone. Properties that a model does not
// have are those of the template in Definitions, or else the identity.
//
// Refuses, where a geometry is concerned, everything on which programs differ: PreRotation, PostRotation and
// RotationOrder while RotationActive is 0; active limits that a value exceeds; InheritType 0 for a model that is turned
// below a scale that differs between the axes, and InheritType 2 below any scale. Also refuses deformers, geometries
// other than Mesh and Line, levels of detail and polygons that are marked as holes. Hidden models are read, and the
// control mesh of a smoothed mesh.
//
// Unit: UnitScaleFactor of GlobalSettings, in centimetres; 1 cm if it is missing. Axes: UpAxis, FrontAxis (towards the
// viewer) and CoordAxis (to the right); Y, Z and X if they are missing. Both are only stated. The axis that points up
// is stated only if the three axes are those of convert_to_up() (datasets/units.h).
//
// Error of a coordinate: none if no transform is above the geometry, or only identities. Below k factors other than the
// identity (each rotation about an axis counts as one) it is at most 4 k u of the sum of the magnitudes of the terms of
// |M1| ... |Mk| |p|, plus 16 u of it for each rotation. Rotations by multiples of 90 degrees are exact.
#include "algorithms/error.h"
#include "datasets/circle.h"
#include "datasets/formats/affine.h"
#include "datasets/formats/fbx_tree.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"
#include "datasets/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hausbench::readers {
namespace {

constexpr int deepest = 256;  // levels of models

// Limits on a scene, because a small file can show a geometry so often that it fills the memory: `parts_a_byte` parts
// for each byte of the file, and `parts_anyway` parts in any case.
constexpr std::size_t parts_a_byte = 200,
                      parts_anyway = std::size_t{1} << 18;  // a part: a model, point or corner, each time it occurs

// Returns the name of an object for messages: "Model::cube" in text, "cube\0\1Model" in a binary file.
std::string name_of(const FbxNode& object) {
    std::string_view name = object.text(1);
    name = name.substr(0, name.find('\0'));
    if (const std::size_t colons = name.find("::"); colons != std::string_view::npos) name.remove_prefix(colons + 2);
    return shown(name);
}

// The points and faces of a geometry, before any model moves it.
struct FbxMesh {
    std::vector<Vec3> points;
    std::vector<std::vector<std::size_t>> faces;
    std::size_t corners = 0;  // of all faces
    bool float32 = false;
    bool unlisted_sides = false;  // Edges has some sides of the polygons, and not all
};

// A model or geometry of the scene.
struct FbxObject {
    const FbxNode* node = nullptr;
    std::vector<std::int64_t> children = {};  // models, geometries and attributes
    std::string deformer = {};                // the class of one that is connected to it
    std::size_t parents = 0;                  // models, or the root
    bool targeted = false;                    // LookAtProperty turns it towards another model
    bool drawn = false;
};

// The placement of a model, and the faults of the models above it, which matter only if they show a geometry.
struct FbxPlacement {
    Affine map;
    bool scaled = false;     // a model above has a scale other than 1
    bool stretched = false;  // a model above scales its axes differently
    bool hidden = false;
    const FbxNode* wrong_at = nullptr;
    std::string wrong;

    void refuse_later(const FbxNode& model, const std::string& why) {
        if (wrong_at) return;
        wrong_at = &model;
        wrong = fmt::format(
            "model '{}' {}, and programs differ on the result: apply the transforms in the program that wrote "
            "the file, or export glTF or OBJ",
            name_of(model), why);
    }
};

Affine shift_by(const Vec3& by) { return {Eigen::Matrix3d::Identity(), by}; }
Affine scale_by(const Vec3& by) { return {by.asDiagonal(), Vec3::Zero()}; }

// Returns the rotation about axis 0, 1 or 2 by an angle in degrees.
Affine turn_about(int axis, double degrees) {
    Affine map;
    if (degrees == 0) return map;
    const auto [cosine, sine] = circle_at_degrees(degrees);
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    map.matrix(next, next) = map.matrix(last, last) = cosine;
    map.matrix(last, next) = sine;
    map.matrix(next, last) = -sine;
    return map;
}

// Returns the rotation about the axes in this order, the first of them first.
Affine turn_by(const Vec3& degrees, std::array<int, 3> order = {0, 1, 2}) {
    const auto about = [&](std::size_t i) { return turn_about(order[i], degrees[order[i]]); };
    return about(2) * about(1) * about(0);
}

// Returns the inverse of turn_by(degrees).
Affine turn_back(const Vec3& degrees) { return turn_by(-degrees, {2, 1, 0}); }

// The properties of a model, and of the template where the model has none.
class FbxProperties {
public:
    // `of` may be null: then all properties are those of the template, which may be null, too.
    FbxProperties(const FbxTree& tree, const FbxNode* of, const FbxProperties* or_else)
        : tree_(tree), or_else_(or_else) {
        const FbxNode* const list = of ? tree.child(*of, "Properties70") : nullptr;
        if (!list) return;
        for (const FbxNode& property : list->children) {
            if (property.name != "P") continue;
            const auto [entry, added] = all_.emplace(property.text(0), &property);
            if (!added) twice_.insert(property.text(0));
        }
    }

    // Returns the property with this name, or null.
    const FbxNode* find(std::string_view name) const {
        const auto entry = all_.find(name);
        if (entry == all_.end()) return or_else_ ? or_else_->find(name) : nullptr;
        if (twice_.contains(name))
            tree_.refuse(*entry->second, fmt::format("{} stands twice: remove one", shown(name)));
        return entry->second;
    }
    double number(std::string_view name, double otherwise) const {
        const FbxNode* const property = find(name);
        return property ? finite(*property, 4) : otherwise;
    }
    Vec3 vector(std::string_view name, double otherwise = 0) const {
        const FbxNode* const property = find(name);
        if (!property) return Vec3::Constant(otherwise);
        return {finite(*property, 4), finite(*property, 5), finite(*property, 6)};
    }
    bool flag(std::string_view name, bool otherwise = false) const { return number(name, otherwise ? 1 : 0) != 0; }

private:
    double finite(const FbxNode& property, std::size_t i) const {
        const double value = tree_.real(property, i);
        if (!std::isfinite(value))
            tree_.refuse(property, fmt::format("{} is not finite: correct it", shown(property.text(0))));
        return value;
    }

    const FbxTree& tree_;
    const FbxProperties* or_else_;
    std::map<std::string_view, const FbxNode*> all_;
    std::set<std::string_view> twice_;
};

// Computes the places of models.
class FbxTransforms {
public:
    explicit FbxTransforms(const FbxTree& tree) : tree_(tree), template_(tree, template_of(tree), nullptr) {}

    // Returns the place of a model within `outer`.
    FbxPlacement within(const FbxPlacement& outer, const FbxNode& model) const {
        const FbxProperties of(tree_, &model, &template_);
        FbxPlacement inner = outer;
        inner.hidden = outer.hidden || !of.flag("Visibility", true) || !of.flag("Show", true);
        const Vec3 scale = of.vector("Lcl Scaling", 1);
        const Affine turn = rotation(of, model, inner);
        check_inherited(of, model, outer, turn, inner);
        check_limits(of, model, inner);
        inner.scaled = outer.scaled || scale != Vec3::Ones();
        inner.stretched = outer.stretched || scale != Vec3::Constant(scale[0]);
        const Vec3 rotation_pivot = of.vector("RotationPivot"), scaling_pivot = of.vector("ScalingPivot");
        inner.map = outer.map * shift_by(of.vector("Lcl Translation")) * shift_by(of.vector("RotationOffset")) *
                    about(rotation_pivot, turn) * shift_by(of.vector("ScalingOffset")) *
                    about(scaling_pivot, scale_by(scale));
        return inner;
    }

    // Returns the geometric transform of a model, which moves its geometries alone.
    Affine geometric(const FbxNode& model) const {
        const FbxProperties of(tree_, &model, &template_);
        return shift_by(of.vector("GeometricTranslation")) * turn_by(of.vector("GeometricRotation")) *
               scale_by(of.vector("GeometricScaling", 1));
    }

private:
    static const FbxNode* template_of(const FbxTree& tree) {
        const FbxNode* const definitions = tree.child(tree.root(), "Definitions");
        if (!definitions) return nullptr;
        for (const FbxNode& type : definitions->children)
            if (type.name == "ObjectType" && type.text(0) == "Model") return tree.child(type, "PropertyTemplate");
        return nullptr;
    }

    // Returns the map with another origin.
    static Affine about(const Vec3& pivot, const Affine& map) { return shift_by(pivot) * map * shift_by(-pivot); }

    // Returns Rpre R Rpost^-1.
    Affine rotation(const FbxProperties& of, const FbxNode& model, FbxPlacement& inner) const {
        static constexpr std::array<std::array<int, 3>, 6> orders = {
            {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}}};
        const Vec3 degrees = of.vector("Lcl Rotation"), before = of.vector("PreRotation"),
                   after = of.vector("PostRotation");
        const bool ordered = (degrees.array() != 0).count() > 1;  // whether the order of the axes matters
        const double order = ordered ? of.number("RotationOrder", 0) : 0;
        if (!of.flag("RotationActive") && (before != Vec3::Zero() || after != Vec3::Zero() || order != 0))
            inner.refuse_later(model, "has a PreRotation, PostRotation or RotationOrder while RotationActive is 0");
        if (!(order >= 0 && order < 6 && order == std::floor(order))) {
            inner.refuse_later(model, fmt::format("has the RotationOrder {}, which is not one of Euler angles", order));
            return {};
        }
        return turn_by(before) * turn_by(degrees, orders[static_cast<std::size_t>(order)]) * turn_back(after);
    }

    // The three rules of how a scale is inherited agree as long as the models above have no scale that differs between
    // the axes, or (rule 2) no scale at all. Rule 1 is the product of the matrices, also below such scales.
    static void check_inherited(const FbxProperties& of, const FbxNode& model, const FbxPlacement& outer,
                                const Affine& turn, FbxPlacement& inner) {
        const double rule = of.number("InheritType", 0);
        if (rule == 0 && outer.stretched && !turn.is_identity())
            inner.refuse_later(model, "is turned, with InheritType 0, below a scale that differs between the axes");
        if (rule == 2 && outer.scaled) inner.refuse_later(model, "has InheritType 2 below a scale");
        if (rule != 0 && rule != 1 && rule != 2)
            inner.refuse_later(model, fmt::format("has the unknown InheritType {}", rule));
    }

    static void check_limits(const FbxProperties& of, const FbxNode& model, FbxPlacement& inner) {
        for (const std::string kind : {"Translation", "Rotation", "Scaling"}) {
            if (!of.flag(kind + "Active")) continue;
            const Vec3 value = of.vector("Lcl " + kind, kind == "Scaling" ? 1 : 0), least = of.vector(kind + "Min"),
                       most = of.vector(kind + "Max");
            for (int i = 0; i < 3; ++i)
                if ((of.flag(fmt::format("{}Min{}", kind, "XYZ"[i])) && value[i] < least[i]) ||
                    (of.flag(fmt::format("{}Max{}", kind, "XYZ"[i])) && value[i] > most[i]))
                    inner.refuse_later(model, fmt::format("has a Lcl {} beyond its limits", kind));
        }
    }

    const FbxTree& tree_;
    const FbxProperties template_;  // of models
};

// Reads one Geometry.
class FbxGeometry {
public:
    FbxGeometry(const FbxTree& tree, const FbxNode& node) : tree_(tree), node_(node) {}

    FbxMesh read() {
        const std::string_view kind = node_.text(2);
        if (kind != "Mesh" && kind != "Line")
            tree_.refuse(node_,
                         fmt::format("geometry '{}' is a {}, which is not supported: convert it to polygons in the "
                                     "program that wrote the file, or leave it out",
                                     name_of(node_), kind.empty() ? "geometry without a class" : shown(kind)));
        const bool lines = kind == "Line";
        if (const FbxNode* const shape = tree_.child(node_, "Shape"))
            tree_.refuse(*shape,
                         fmt::format("geometry '{}' has blend shapes, which are not supported: apply them in the "
                                     "program that wrote the file, and export the mesh alone",
                                     name_of(node_)));
        if (const FbxNode* const points = tree_.child(node_, lines ? "Points" : "Vertices")) read_points(*points);
        if (const FbxNode* const corners = tree_.child(node_, lines ? "PointsIndex" : "PolygonVertexIndex"))
            read_faces(*corners, lines);
        if (const FbxNode* const edges = tree_.child(node_, "Edges"); edges && !lines) compare_sides(*edges);
        check_holes();
        return std::move(mesh_);
    }

private:
    void read_points(const FbxNode& node) {
        const std::vector<double> values = tree_.reals(node);
        if (values.size() % 3 != 0)
            tree_.refuse(node, fmt::format("{} has {} numbers, not a multiple of 3: it is damaged, save the file again",
                                           node.name, values.size()));
        mesh_.float32 = tree_.is_float32(node);
        mesh_.points.reserve(values.size() / 3);
        for (std::size_t i = 0; i < values.size(); i += 3)
            mesh_.points.emplace_back(values[i], values[i + 1], values[i + 2]);
    }

    // Reads the corners of polygons or lines, whose last corner v stands as -1 - v. Lines become segments.
    void read_faces(const FbxNode& node, bool lines) {
        const std::vector<std::int64_t> indices = tree_.integers(node);
        std::vector<std::size_t> face;
        for (const std::int64_t index : indices) {
            const auto vertex = static_cast<std::uint64_t>(index < 0 ? -1 - index : index);
            if (vertex >= mesh_.points.size())
                tree_.refuse(node,
                             fmt::format("{} in {} names none of the {} vertices, which are counted from 0: it is "
                                         "damaged, save the file again",
                                         index, node.name, mesh_.points.size()));
            face.push_back(vertex);
            if (lines && face.size() == 2) {
                mesh_.faces.push_back(face);
                face.erase(face.begin());
            }
            if (index >= 0) continue;
            if (!lines) mesh_.faces.push_back(face);
            face.clear();
        }
        if (!face.empty())
            tree_.refuse(node, fmt::format("the last number of {} is not negative, so that a face has no end: it is "
                                           "damaged, save the file again",
                                           node.name));
        mesh_.corners = indices.size();
    }

    // Each number of Edges is a position in PolygonVertexIndex: the side goes from that corner to the next.
    void compare_sides(const FbxNode& edges) {
        using Side = std::pair<std::size_t, std::size_t>;
        std::vector<Side> from_corner;
        from_corner.reserve(mesh_.corners);
        for (const auto& face : mesh_.faces)
            for (std::size_t i = 0; i < face.size(); ++i)
                from_corner.emplace_back(std::minmax(face[i], face[(i + 1) % face.size()]));
        std::set<Side> listed;
        for (const std::int64_t at : tree_.integers(edges))
            if (at >= 0 && static_cast<std::uint64_t>(at) < from_corner.size())
                listed.insert(from_corner[static_cast<std::size_t>(at)]);
        mesh_.unlisted_sides = !listed.empty() && std::any_of(from_corner.begin(), from_corner.end(), [&](Side side) {
            return side.first != side.second && !listed.contains(side);
        });
    }

    void check_holes() const {
        const FbxNode* const layer = tree_.child(node_, "LayerElementHole");
        const FbxNode* const holes = layer ? tree_.child(*layer, "Hole") : nullptr;
        if (!holes) return;
        const std::vector<std::int64_t> flags = tree_.integers(*holes);
        if (std::any_of(flags.begin(), flags.end(), [](std::int64_t flag) { return flag != 0; }))
            tree_.refuse(*holes,
                         fmt::format("geometry '{}' marks polygons as holes, which is not supported: delete them in "
                                     "the program that wrote the file",
                                     name_of(node_)));
    }

    const FbxTree& tree_;
    const FbxNode& node_;
    FbxMesh mesh_;
};

// Turns the models of the scene into faces.
class FbxScene {
public:
    FbxScene(const FbxTree& tree, std::size_t bytes)
        : tree_(tree), transforms_(tree), parts_left_(std::max(parts_anyway, parts_a_byte * bytes)) {
        soup_.objects = 0;
    }

    Soup draw(const std::string& name) {
        list_objects();
        connect();
        state();
        const std::vector<std::int64_t> top = top_;
        for (const std::int64_t id : top) draw_model(id, {}, 0);
        note_left_out();
        if (soup_.faces.empty())
            throw InputError(name +
                             ": no model of its scene shows a polygon or a line: export the meshes with their "
                             "models, or convert it to OBJ or PLY");
        return std::move(soup_);
    }

private:
    void list_objects() {
        const FbxNode* const objects = tree_.child(tree_.root(), "Objects");
        if (!objects) return;
        for (const FbxNode& node : objects->children) {
            if (node.name == "SceneReference")
                tree_.refuse(node, "refers to another file, which is not supported: export everything into one file");
            animations_ += node.name == "AnimationCurve" || node.name == "AnimationCurveNode" ? 1 : 0;
            constraints_ += node.name == "Constraint" ? 1 : 0;
            if (!objects_.emplace(tree_.integer(node, 0), FbxObject{&node}).second)
                tree_.refuse(node,
                             fmt::format("two objects have the id {}: save the file again", tree_.integer(node, 0)));
        }
    }

    // Reads the connections: kind, child, parent, and for "OP" the property of the parent.
    void connect() {
        const FbxNode* const connections = tree_.child(tree_.root(), "Connections");
        if (!connections) return;
        for (const FbxNode& node : connections->children) {
            if (node.name != "C") continue;
            const auto child = objects_.find(tree_.integer(node, 1)), parent = objects_.find(tree_.integer(node, 2));
            if (node.text(0) == "OP" && node.text(3) == "LookAtProperty" && parent != objects_.end())
                parent->second.targeted = true;
            if (node.text(0) != "OO") continue;
            if (child == objects_.end()) {
                if (parent != objects_.end() && parent->second.node->name == "Model")
                    tree_.refuse(node, fmt::format("object {}, a part of model '{}', is not in the file: save it again",
                                                   tree_.integer(node, 1), name_of(*parent->second.node)));
                continue;
            }
            connect(node, child->first, child->second, parent == objects_.end() ? nullptr : &parent->second);
        }
    }

    void connect(const FbxNode& node, std::int64_t id, FbxObject& child, FbxObject* parent) {
        const std::string_view kind = child.node->name;
        if (parent && parent->node->name == "Geometry" && kind == "Deformer")
            parent->deformer = fmt::format("Deformer '{}'", shown(child.node->text(2)));
        const bool root = !parent && tree_.integer(node, 2) == 0;
        if (!root && (!parent || parent->node->name != "Model")) return;
        if (kind == "Model" && child.parents++ > 0)
            tree_.refuse(node,
                         fmt::format("model '{}' is below two others, and programs differ on the result: save the "
                                     "file again, or export glTF or OBJ",
                                     name_of(*child.node)));
        if (root && kind == "Model") top_.push_back(id);
        if (parent && (kind == "Model" || kind == "Geometry" || kind == "NodeAttribute"))
            parent->children.push_back(id);
    }

    // States the unit and the axis that points up.
    void state() {
        const FbxProperties settings(tree_, tree_.child(tree_.root(), "GlobalSettings"), nullptr);
        const double centimetres = settings.number("UnitScaleFactor", 1);
        // Through decimals, so that 2.54 gives an inch, also if it was rounded to float32.
        const auto narrow = static_cast<float>(centimetres);
        const auto metres =
            decimal(double{narrow} == centimetres ? fmt::format("{}e-2", narrow) : fmt::format("{}e-2", centimetres));
        if (centimetres > 0 && metres && std::isfinite(*metres * 1e6))
            soup_.stated = stated_unit(*metres);
        else
            soup_.notes.emplace_back("its UnitScaleFactor is not a positive number, and counts as not stated");
        const std::string up = direction(settings, "Up", 1), front = direction(settings, "Front", 2),
                          right = direction(settings, "Coord", 0);
        const std::string axes = right + up + front;
        if (axes == "-Y+X+Z" || axes == "+X+Y+Z" || axes == "+X+Z-Y")
            soup_.stated.up = up[1];
        else
            soup_.notes.push_back(fmt::format(
                "in its axes {} points up, {} to the viewer and {} to the right: --up knows no such axes, so it "
                "counts as stating none",
                up, front, right));
    }

    // Returns an axis of GlobalSettings: "+X", "-Y", ..., or "?".
    static std::string direction(const FbxProperties& settings, const std::string& axis, int otherwise) {
        const double number = settings.number(axis + "Axis", otherwise), sign = settings.number(axis + "AxisSign", 1);
        for (int i = 0; i < 3; ++i)
            if (number == i && std::abs(sign) == 1) return {sign > 0 ? '+' : '-', "XYZ"[i]};
        return "?";
    }

    // Refuses the file if these parts exceed the limit for the whole scene.
    void spend(const FbxNode& node, std::size_t parts) {
        if (parts > parts_left_)
            tree_.refuse(node,
                         fmt::format("models repeat geometries so often that it is more than {} models, points and "
                                     "corners for each byte of the file: write fewer of them",
                                     parts_a_byte));
        parts_left_ -= parts;
    }

    void draw_model(std::int64_t id, const FbxPlacement& outer, int depth) {
        FbxObject& model = objects_.at(id);
        const FbxNode& node = *model.node;
        if (depth > deepest)
            tree_.refuse(node, fmt::format("models are nested deeper than {}: take some of them apart", deepest));
        spend(node, 1);
        model.drawn = true;
        FbxPlacement at = transforms_.within(outer, node);
        if (model.targeted) at.refuse_later(node, "has a LookAtProperty, which turns it towards another");
        bool shows = false;
        for (const std::int64_t child : model.children) {
            FbxObject& object = objects_.at(child);
            if (object.node->name == "Model") draw_model(child, at, depth + 1);
            if (object.node->name == "Geometry") {
                draw_geometry(child, object, at, transforms_.geometric(node));
                shows = true;
            }
            if (object.node->text(2) == "LodGroup" && object.node->name == "NodeAttribute") refuse_levels(node);
        }
        if (node.text(2) == "LodGroup") refuse_levels(node);
        hidden_ += shows && at.hidden ? 1 : 0;
    }

    [[noreturn]] void refuse_levels(const FbxNode& model) const {
        tree_.refuse(model,
                     fmt::format("model '{}' is a LodGroup, which holds several versions of one thing: leave all but "
                                 "one out in the program that wrote the file",
                                 name_of(model)));
    }

    void draw_geometry(std::int64_t id, FbxObject& object, const FbxPlacement& at, const Affine& geometric) {
        const FbxNode& node = *object.node;
        if (!object.deformer.empty())
            tree_.refuse(node, fmt::format("geometry '{}' is deformed by {}, which is not supported: apply it in the "
                                           "program that wrote the file, and export the mesh alone",
                                           name_of(node), object.deformer));
        if (at.wrong_at) tree_.refuse(*at.wrong_at, at.wrong);
        auto entry = meshes_.find(id);
        if (entry == meshes_.end()) {
            entry = meshes_.emplace(id, FbxGeometry(tree_, node).read()).first;
            const FbxNode* const smoothness = tree_.child(node, "Smoothness");
            smoothed_ += smoothness && tree_.integer(*smoothness, 0) != 0 ? 1 : 0;
            empty_ += entry->second.faces.empty() ? 1 : 0;
            unlisted_ += entry->second.unlisted_sides ? 1 : 0;
        }
        object.drawn = true;
        const FbxMesh& mesh = entry->second;
        spend(node, mesh.points.size() + mesh.faces.size() + mesh.corners);
        if (mesh.faces.empty()) return;
        ++soup_.objects;
        soup_.float32 = soup_.float32 || mesh.float32;
        const Affine map = at.map * geometric;
        const bool moves = !map.is_identity();
        const std::size_t first = soup_.points.size();
        for (const Vec3& point : mesh.points) soup_.points.push_back(moves ? map(point) : point);
        for (const auto& face : mesh.faces) {
            auto& added = soup_.faces.emplace_back();
            for (const std::size_t v : face) added.push_back(first + v);
        }
    }

    void note_left_out() {
        std::size_t models = 0, geometries = 0;
        for (const auto& [id, object] : objects_) {
            models += object.node->name == "Model" && !object.drawn ? 1 : 0;
            geometries += object.node->name == "Geometry" && !object.drawn && object.node->text(2) != "Shape" ? 1 : 0;
        }
        const auto note = [&](std::size_t count, const char* what) {
            if (count > 0) soup_.notes.push_back(fmt::format("{} {}", count, what));
        };
        note(models, "of its models are left out: the scene does not hold them");
        note(geometries, "of its geometries are left out: no model of the scene shows them");
        note(empty_, "of its geometries have no polygons and no lines, and add nothing");
        note(hidden_, "of its models are hidden, and read like the others");
        note(smoothed_, "of its meshes are shown smoothed: their control meshes are read");
        note(
            unlisted_,
            "of its meshes have polygons with sides that are not among their Edges: Blender writes loose edges so, two "
            "as one polygon; export without them if you have them");
        note(constraints_, "constraints are left out: the transforms of the models count");
        if (animations_ > 0)
            soup_.notes.emplace_back("its animations are left out: the transforms of the models count");
    }

    const FbxTree& tree_;
    const FbxTransforms transforms_;
    std::size_t parts_left_;
    Soup soup_;
    std::map<std::int64_t, FbxObject> objects_;
    std::map<std::int64_t, FbxMesh> meshes_;  // by the id of the Geometry, each read once
    std::vector<std::int64_t> top_;           // models below the root
    std::size_t animations_ = 0, constraints_ = 0, hidden_ = 0, smoothed_ = 0, empty_ = 0, unlisted_ = 0;
};

}  // namespace

Soup read_fbx(const Input& input) {
    const FbxTree tree(input.name, input.bytes);
    return FbxScene(tree, input.bytes.size()).draw(input.name);
}

}  // namespace hausbench::readers
