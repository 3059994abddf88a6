// Reads VRML 2.0 (VRML97) as text: the faces of every IndexedFaceSet, the lines of every IndexedLineSet, whose parts
// are segments, and the points of every PointSet, moved by the Transform nodes that contain them. USE repeats a node
// that DEF named. A LOD is seen at its first level, a Switch at its choice, and a Billboard as it is stored; notes say
// so. Nothing moves: a note says if ROUTE, scripts, sensors or interpolators are left out. Ignores other nodes without
// a shape (colours, lights). Refuses other shapes, PROTO, Inline, nodes that VRML97 does not define, and a field that a
// node has twice.
//
// VRML97 defines that the unit is the metre and that y points up (section 4.4.5). A point outside of all Transform
// nodes has the doubles nearest to its decimal numbers. A Transform computes matrix * point + shift in doubles; the
// matrices of nested nodes are multiplied first, from the outer to the inner. A point p under n of them, with angles of
// at most one turn, is within 200 n u S (|p| + T) of the exact one, where u = 2^-53, S is the product of the largest
// scale of each (1 if less), and T the sum of the lengths of all translations and, twice, of all centers.
#include "algorithms/error.h"
#include "algorithms/kernel/direction.h"
#include "datasets/circle.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"
#include "datasets/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <deque>
#include <map>
#include <set>
#include <utility>

namespace hausbench::readers {
namespace {

constexpr int deepest = 256;  // levels of nodes; each takes a few hundred bytes of stack

// Limits on a scene, because USE can repeat nodes so often that a small file fills the memory. The scene may have
// `parts_a_byte` parts for each byte of the file, and `parts_anyway` parts in any case.
constexpr std::size_t parts_a_byte = 200,
                      parts_anyway = std::size_t{1} << 18;  // a part: a node, point or corner, each time it occurs

struct Word {
    std::string_view text;
    std::uint32_t line = 0;
};

struct Node;

struct VrmlField {
    std::vector<Word> words;
    std::vector<const Node*> nodes;
};

struct Node {
    Word type;
    std::map<std::string_view, VrmlField> fields;  // only the fields that VrmlScene needs

    const VrmlField& field(std::string_view name) const {
        static const VrmlField none;
        const auto at = fields.find(name);
        return at == fields.end() ? none : at->second;
    }
    bool is(const std::set<std::string_view>& types) const { return types.contains(type.text); }
};

bool one_of(char c, std::string_view characters) { return characters.find(c) != std::string_view::npos; }

// Parses text into nodes.
class VrmlText {
public:
    VrmlText(const std::string& name, std::string_view bytes) : name_(name), rest_(bytes) {}

    VrmlField read() {
        if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
        if (rest_.starts_with("#VRML V1"))
            refuse(name_, 1, "is VRML 1.0, which is not supported: convert it to VRML 2.0, OBJ or STL");
        if (!rest_.starts_with("#VRML V2.0"))
            refuse(name_, 1, "is not a VRML file: it does not begin with '#VRML V2.0'");
        if (rest_.find('\0') != std::string_view::npos)
            throw InputError(name_ + ": has a zero byte, which no VRML file has: save or fetch it again");
        VrmlField scene;
        while (peek()) read_value(scene, 0);
        if (!scene.words.empty())
            refuse(name_, scene.words[0].line, fmt::format("'{}' is not a node", shown(scene.words[0].text)));
        return scene;
    }

    bool has_routes() const { return routes_; }

private:
    // Skips white space and comments. Returns the first character of the next word, without removing it; 0 at the end.
    char peek() {
        while (!rest_.empty()) {
            const char c = rest_[0];
            if (c == '#') {
                rest_.remove_prefix(std::min(rest_.find_first_of("\r\n"), rest_.size()));
                continue;
            }
            if (!one_of(c, " \t\r\n\v\f,")) return c;
            line_ += c == '\n' || (c == '\r' && !rest_.starts_with("\r\n")) ? 1 : 0;
            rest_.remove_prefix(1);
        }
        return '\0';
    }

    Word next() {
        const char first = peek();
        if (!first) refuse(name_, line_, "the file ends inside of a node: it is truncated, fetch or save it again");
        std::size_t size = 1;
        if (first == '"') {
            while (size < rest_.size() && rest_[size] != '"') size += rest_[size] == '\\' ? 2 : 1;
            if (size >= rest_.size()) refuse(name_, line_, "a text begins here and does not end: add its '\"'");
            ++size;
        } else if (!one_of(first, "{}[]")) {
            size = std::min(rest_.find_first_of(" \t\r\n\v\f,{}[]\"#"), rest_.size());
        }
        const Word word{rest_.substr(0, size), line_};
        line_ += static_cast<std::uint32_t>(std::count(word.text.begin(), word.text.end(), '\n'));
        rest_.remove_prefix(size);
        return word;
    }

    // Returns whether a word begins the statement ROUTE a TO b, and skips the rest of it: it connects events, which
    // have no effect here. Refuses statements that define new kinds of nodes.
    bool is_statement(const Word& word) {
        if (word.text == "PROTO" || word.text == "EXTERNPROTO")
            refuse(name_, word.line, fmt::format("{} is not supported: convert the file to OBJ or STL", word.text));
        if (word.text != "ROUTE") return false;
        routes_ = true;
        for (int i = 0; i < 3; ++i) next();
        return true;
    }

    // Reads a node or a plain word, and adds it to the field.
    void read_value(VrmlField& field, int depth) {
        const Word word = next();
        if (is_statement(word)) return;
        if (one_of(word.text[0], "{}[]"))
            refuse(name_, word.line, fmt::format("'{}' where a value is expected", word.text));
        if (word.text == "DEF") {
            const Word name = next();
            const Node& node = read_node(next(), depth);
            field.nodes.push_back(defined_[name.text] = &node);
        } else if (word.text == "USE") {
            const Word name = next();
            const auto node = defined_.find(name.text);
            if (node == defined_.end())
                refuse(name_, name.line, fmt::format("USE of '{}', which no DEF before it names", shown(name.text)));
            field.nodes.push_back(node->second);
        } else if (peek() == '{') {
            field.nodes.push_back(&read_node(word, depth));
        } else {
            field.words.push_back(word);
        }
    }

    // Reads one value, several numbers, or a list in brackets.
    VrmlField read_field(int depth) {
        VrmlField field;
        if (peek() == '[') {
            for (next(); peek() != ']';) read_value(field, depth);
            next();
            return field;
        }
        do read_value(field, depth);
        while (field.nodes.empty() && peek() && one_of(peek(), "+-.0123456789\""));
        return field;
    }

    const Node& read_node(Word type, int depth) {
        static const std::set<std::string_view> kept = {
            "center", "ccw",   "children", "choice",           "coord",       "coordIndex", "geometry",
            "level",  "point", "rotation", "scaleOrientation", "translation", "scale",      "whichChoice"};
        if (depth > deepest)
            refuse(name_, type.line, fmt::format("nodes are nested deeper than {}: take some of them apart", deepest));
        const Word open = next();
        if (open.text != "{")
            refuse(name_, open.line,
                   fmt::format("expected '{{' after {}, found '{}'", shown(type.text), shown(open.text)));
        Node& node = nodes_.emplace_back(Node{type, {}});
        if (type.text == "Script") {  // skipped, because it may declare fields of any name and type
            for (int open_braces = 1; open_braces > 0;) {
                const Word word = next();
                open_braces += word.text == "{" ? 1 : word.text == "}" ? -1 : 0;
            }
            return node;
        }
        for (Word name = next(); name.text != "}"; name = next()) {
            if (is_statement(name)) continue;
            if (!std::isalpha(static_cast<unsigned char>(name.text[0])) && name.text[0] != '_')
                refuse(name_, name.line,
                       fmt::format("'{}' where {} needs the name of a field", shown(name.text), shown(type.text)));
            VrmlField field = read_field(depth + 1);
            if (kept.contains(name.text) && !node.fields.emplace(name.text, std::move(field)).second)
                refuse(name_, name.line,
                       fmt::format("a second '{}' of one {}: remove one of them", name.text, shown(type.text)));
        }
        return node;
    }

    const std::string& name_;
    std::string_view rest_;
    std::uint32_t line_ = 1;
    bool routes_ = false;
    std::deque<Node> nodes_;  // all nodes in one list, so that a deep tree is freed without recursion
    std::map<std::string_view, const Node*> defined_;
};

// The combined effect of the Transform nodes that contain a node: a point p moves to matrix * p + shift.
struct Placement {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
    Vec3 shift = Vec3::Zero();
};

// Returns the point of the unit circle at an angle in radians. Subtracts the nearest multiple of pi / 2, because
// circle_near_zero() requires a small angle, and then turns the point by as many quarters of a turn.
Circle circle_at(double angle) {
    constexpr double quarter = 1.5707963267948966, and_more = 6.123233995736766e-17;  // their sum is pi / 2
    const double within = std::fmod(angle, 4 * quarter), quarters = std::round(within / quarter);
    const Circle rest = circle_near_zero(within - quarters * quarter - quarters * and_more);
    return turned(rest, (static_cast<int>(quarters) + 4) % 4);
}

// Turns nodes into faces.
class VrmlScene {
public:
    VrmlScene(const std::string& name, std::size_t bytes)
        : name_(name), parts_left_(std::max(parts_anyway, parts_a_byte * bytes)) {
        soup_.objects = 0;
    }

    // `moves`: the file has ROUTE statements.
    Soup draw(const VrmlField& scene, bool moves) {
        if (moves) moving_.insert("ROUTE");
        for (const Node* node : scene.nodes) draw(*node, {}, 0);
        add_notes();
        if (soup_.faces.empty())
            throw InputError(name_ +
                             ": holds no IndexedFaceSet with a face, no IndexedLineSet with a line, and no "
                             "PointSet with a point");
        return std::move(soup_);
    }

private:
    [[noreturn]] void refuse_at(const Word& word, const std::string& why) const { refuse(name_, word.line, why); }

    // Refuses the file if these parts exceed the limit for the whole scene.
    void spend(const Node& node, std::size_t parts) {
        if (parts > parts_left_)
            refuse_at(
                node.type,
                fmt::format("USE repeats what DEF names so often that it is more than {} nodes, points and corners "
                            "for each byte of the file: write fewer of them",
                            parts_a_byte));
        parts_left_ -= parts;
    }

    // Returns a number that may be infinite or NaN, which finish() refuses or drops.
    double any_number(const Word& word) const {
        const auto value = decimal(word.text);
        if (!value) refuse_at(word, fmt::format("'{}' is not a number", shown(word.text)));
        return *value;
    }

    double number(const Word& word) const {
        const auto value = decimal(word.text);
        if (!value || !std::isfinite(*value))
            refuse_at(word, fmt::format("'{}' is not a {}number", shown(word.text), value ? "finite " : ""));
        return *value;
    }

    // Returns the n numbers of a field. If the node does not have the field, each is `unless_given`.
    template <int n>
    Eigen::Matrix<double, n, 1> vector(const Node& node, std::string_view name, double unless_given) const {
        const auto& words = node.field(name).words;
        Eigen::Matrix<double, n, 1> values = Eigen::Matrix<double, n, 1>::Constant(unless_given);
        if (words.empty()) return values;
        if (words.size() != n) refuse_at(words[0], fmt::format("'{}' has {} numbers, not {}", name, words.size(), n));
        for (int i = 0; i < n; ++i) values[i] = number(words[static_cast<std::size_t>(i)]);
        return values;
    }

    // Returns the rotation that a field gives as an axis and an angle, by the right-hand rule.
    Eigen::Matrix3d rotation(const Node& node, std::string_view name) const {
        const auto values = vector<4>(node, name, 0);
        if (values[3] == 0) return Eigen::Matrix3d::Identity();
        const Vec3 scaled = at_unit_scale(values.head<3>()), axis = scaled / scaled.norm();
        if (!axis.allFinite()) refuse_at(node.field(name).words[0], fmt::format("'{}' has no axis", name));
        const auto [cosine, sine] = circle_at(values[3]);
        Eigen::Matrix3d across;
        across << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
        const Eigen::Matrix3d along = axis * axis.transpose();
        return along + cosine * (Eigen::Matrix3d::Identity() - along) + sine * across;
    }

    // Returns the effect of a Transform node. By section 6.52 of VRML97 it is the product translation * center *
    // rotation * scaleOrientation * scale * -scaleOrientation * -center, where a minus means the inverse.
    Placement placement(const Node& node) const {
        const Vec3 scale = vector<3>(node, "scale", 1), center = vector<3>(node, "center", 0);
        const Eigen::Matrix3d oriented = rotation(node, "scaleOrientation");
        Placement here;
        here.matrix = rotation(node, "rotation") * oriented * scale.asDiagonal() * oriented.transpose();
        here.shift = vector<3>(node, "translation", 0) + (center - here.matrix * center);
        return here;
    }

    void draw(const Node& node, const Placement& at, int depth) {
        if (depth > deepest)
            refuse_at(node.type, fmt::format("nodes are nested deeper than {}, with what USE repeats", deepest));
        spend(node, 1);
        if (node.is({"Inline"})) refuse_at(node.type, "Inline is not supported: convert the file that it names");
        if (node.is({"Shape"}))
            for (const Node* geometry : node.field("geometry").nodes) draw_geometry(*geometry, at);
        if (node.is({"Transform"})) {
            const Placement here = placement(node);
            draw_all(node.field("children").nodes, {at.matrix * here.matrix, at.matrix * here.shift + at.shift}, depth);
        }
        if (node.is({"Group", "Anchor", "Billboard", "Collision"})) draw_all(node.field("children").nodes, at, depth);
        if (node.is({"Billboard"})) ++billboards_;
        if (node.is({"LOD"})) draw_first_level(node, at, depth);
        if (node.is({"Switch"})) draw_choice(node, at, depth);
        static const std::set<std::string_view> allowed = {
            "Shape", "Transform", "Group", "Anchor", "Billboard", "Collision", "LOD", "Switch",
            // nodes without a shape
            "Appearance", "AudioClip", "Background", "Color", "Coordinate", "DirectionalLight", "Fog", "FontStyle",
            "ImageTexture", "Material", "MovieTexture", "NavigationInfo", "Normal", "PixelTexture", "PointLight",
            "Sound", "SpotLight", "TextureCoordinate", "TextureTransform", "Viewpoint", "WorldInfo"};
        // Nodes that may move shapes while the scene is shown.
        static const std::set<std::string_view> moving = {"ColorInterpolator",
                                                          "CoordinateInterpolator",
                                                          "CylinderSensor",
                                                          "NormalInterpolator",
                                                          "OrientationInterpolator",
                                                          "PlaneSensor",
                                                          "PositionInterpolator",
                                                          "ProximitySensor",
                                                          "ScalarInterpolator",
                                                          "Script",
                                                          "SphereSensor",
                                                          "TimeSensor",
                                                          "TouchSensor",
                                                          "VisibilitySensor"};
        if (node.is(moving)) moving_.insert(node.type.text);
        if (!node.is(allowed) && !node.is(moving))
            refuse_at(node.type,
                      fmt::format("{} is not a node of VRML97 that may stand here: remove it, or convert the "
                                  "file to OBJ or STL",
                                  shown(node.type.text)));
    }

    void draw_first_level(const Node& lod, const Placement& at, int depth) {
        const auto& levels = lod.field("level").nodes;
        if (levels.empty()) return;
        if (levels.size() > 1 && !levels_left_out_)
            soup_.notes.push_back("only the first level of each LOD is read, which is seen from near");
        levels_left_out_ = levels_left_out_ || levels.size() > 1;
        draw(*levels[0], at, depth + 1);
    }

    void draw_choice(const Node& node, const Placement& at, int depth) {
        const auto& chosen = node.field("whichChoice").words;
        const auto& choice = node.field("choice").nodes;
        const auto which = chosen.empty() ? -1 : whole<std::int64_t>(chosen[0].text);  // negative or too large: none
        if (!which) refuse_at(chosen[0], fmt::format("'{}' is not an integer", shown(chosen[0].text)));
        const bool shows = *which >= 0 && static_cast<std::uint64_t>(*which) < choice.size();
        not_chosen_ += choice.size() - (shows ? 1 : 0);
        if (shows) draw(*choice[static_cast<std::size_t>(*which)], at, depth + 1);
    }

    void add_notes() {
        auto& notes = soup_.notes;
        if (not_chosen_ > 0)
            notes.push_back(fmt::format("{} {} left out, because no whichChoice of a Switch shows {}", not_chosen_,
                                        not_chosen_ == 1 ? "node is" : "nodes are", not_chosen_ == 1 ? "it" : "them"));
        if (billboards_ > 0)
            notes.emplace_back("a Billboard turns to the viewer: its shapes are read as they are stored");
        if (!moving_.empty())
            notes.push_back(
                fmt::format("left out: {}, so nothing moves from where the file places it", fmt::join(moving_, ", ")));
    }

    void draw_all(const std::vector<const Node*>& nodes, const Placement& at, int depth) {
        for (const Node* node : nodes) draw(*node, at, depth + 1);
    }

    void draw_geometry(const Node& node, const Placement& at) {
        if (!node.is({"IndexedFaceSet", "IndexedLineSet", "PointSet"}))
            refuse_at(node.type, fmt::format("{} is not supported, only IndexedFaceSet, IndexedLineSet and PointSet: "
                                             "convert it, or the file to OBJ or STL",
                                             shown(node.type.text)));
        if (node.field("coord").nodes.empty()) return;
        const Node& coordinate = *node.field("coord").nodes[0];
        if (!coordinate.is({"Coordinate"}))
            refuse_at(coordinate.type, fmt::format("'coord' is a Coordinate, not a {}", shown(coordinate.type.text)));
        const auto& numbers = coordinate.field("point").words;
        if (numbers.size() % 3 != 0)
            refuse_at(numbers.back(), fmt::format("'point' has {} numbers, not three for each", numbers.size()));
        spend(node, numbers.size() / 3 + node.field("coordIndex").words.size());
        ++soup_.objects;
        const std::size_t first = soup_.points.size();
        for (std::size_t i = 0; i < numbers.size(); i += 3) {
            const Vec3 point(any_number(numbers[i]), any_number(numbers[i + 1]), any_number(numbers[i + 2]));
            soup_.points.push_back(at.matrix * point + at.shift);
            soup_.point_lines.push_back(numbers[i].line);
        }
        if (node.is({"PointSet"})) return add_points(first);
        if (node.is({"IndexedLineSet"})) return add_faces(node.field("coordIndex").words, first, false, true);
        const auto& ccw = node.field("ccw").words;
        const bool backwards = !ccw.empty() && ccw[0].text == "FALSE";
        add_faces(node.field("coordIndex").words, first, backwards != (at.matrix.determinant() < 0), false);
    }

    // Adds the points of the soup from index `first` on as single points.
    void add_points(std::size_t first) {
        for (std::size_t i = first; i < soup_.points.size(); ++i) {
            soup_.faces.push_back({i});
            soup_.face_lines.push_back(soup_.point_lines[i]);
        }
    }

    // Adds the segments of a line, or a point if it has one corner.
    void add_line(const std::vector<std::size_t>& line, std::uint32_t number) {
        if (line.size() == 1) {
            soup_.faces.push_back(line);
            soup_.face_lines.push_back(number);
        }
        for (std::size_t i = 1; i < line.size(); ++i) {
            soup_.faces.push_back({line[i - 1], line[i]});
            soup_.face_lines.push_back(number);
        }
    }

    // Adds the faces or lines of a coordIndex list. -1 ends a face; it may be missing after the last one. `first` is the
    // index in the soup of the vertex that the list calls 0. `backwards` reverses the corners of each face.
    void add_faces(const std::vector<Word>& corners, std::size_t first, bool backwards, bool lines) {
        std::vector<std::size_t> face;
        for (std::size_t i = 0; i <= corners.size(); ++i) {
            const bool ends = i == corners.size() || corners[i].text == "-1";
            if (!ends) {
                const auto index = whole<std::size_t>(corners[i].text);
                if (!index || *index >= soup_.points.size() - first)
                    refuse_at(corners[i], fmt::format("'{}' names none of the {} vertices, which are counted from 0",
                                                      shown(corners[i].text), soup_.points.size() - first));
                face.push_back(first + *index);
            } else if (lines && !face.empty()) {
                add_line(std::exchange(face, {}), corners[i - 1].line);
            } else if (!face.empty()) {
                if (backwards) std::reverse(face.begin(), face.end());
                soup_.face_lines.push_back(corners[i - 1].line);
                soup_.faces.push_back(std::exchange(face, {}));
            }
        }
    }

    const std::string& name_;
    std::size_t parts_left_;
    bool levels_left_out_ = false;
    std::size_t not_chosen_ = 0, billboards_ = 0;
    std::set<std::string_view> moving_;  // what may move shapes, by its name
    Soup soup_;
};

}  // namespace

Soup read_vrml(const Input& input) {
    const std::string& name = input.name;
    const std::string_view bytes = input.bytes;
    VrmlText text(name, bytes);
    const VrmlField scene = text.read();
    Soup soup = VrmlScene(name, bytes.size()).draw(scene, text.has_routes());
    soup.merge = soup.unreferenced_unknown = true;  // shapes may share vertices
    soup.stated = stated_unit(1.0);
    soup.stated.up = 'Y';
    return soup;
}

}  // namespace hausbench::readers
