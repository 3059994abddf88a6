// Reads DXF as text: 3DFACE, SOLID and TRACE, MESH of subdivision level 0, POLYLINE (polyface mesh, polygon mesh, 2D
// and 3D polyline), LWPOLYLINE, LINE and POINT, in the model space and in the blocks that INSERT repeats there. Lines
// are segments. Entities on layers that are off or frozen, and invisible ones, are read like all others; a note counts
// them.
//
// Texts, dimensions, viewports, images and other annotations are left out with a note, and so are the paper space and
// blocks that no INSERT names. Refuses every other entity, such as CIRCLE, SPLINE or 3DSOLID, and everything that makes
// more of an entity than its corners: thickness, width, bulge, fitted curves and smooth surfaces. Refuses binary DXF.
//
// Unit: $INSUNITS in the header; none if it is 0 or missing. Axes: not stated.
//
// Error of a coordinate: none outside of blocks, and for entities in object coordinates with the extrusion direction
// 0 0 1 or 0 0 -1. A point p moves by an INSERT to ocs(insertion + rotation(offset + scale * (p - base))), rounded after
// each operation: at most 16 u of the sum of the magnitudes of all terms for each INSERT above a point, and as much for
// another extrusion direction. Rotations by multiples of 90 degrees exchange coordinates exactly.
#include "algorithms/error.h"
#include "algorithms/kernel/direction.h"
#include "datasets/circle.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"
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

constexpr int deepest = 64;  // levels of blocks in blocks

// Limits on a drawing, because INSERT can repeat blocks so often that a small file fills the memory. It may have
// `parts_a_byte` parts for each byte of the file, and `parts_anyway` parts in any case.
constexpr std::size_t parts_a_byte = 200,
                      parts_anyway = std::size_t{1} << 18;  // a part: an INSERT, point or corner, each time it occurs

// A group: a code and a value, on a line each.
struct Tag {
    int code = 0;
    std::string_view value;  // without blanks at its ends
    std::uint32_t line = 0;  // of the value
};

std::vector<Tag> tags_of(const std::string& name, std::string_view bytes) {
    if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
    std::vector<Tag> tags;
    for (std::uint32_t line = 1; !bytes.empty(); line += 2) {
        const std::string_view word = trimmed(next_line(bytes));
        if (word.empty() && trimmed(bytes).find_first_not_of(" \t\r\n\v\f") == std::string_view::npos) break;
        const auto code = whole<int>(word);
        if (!code || *code < -5 || *code > 1071)
            refuse(name, line, fmt::format("'{}' is not a group code of DXF", shown(word)));
        if (bytes.empty()) refuse(name, line, "ends after a group code: it is truncated, fetch or save it again");
        tags.push_back({*code, trimmed(next_line(bytes)), line + 1});
        if (*code == 0 && tags.back().value == "EOF") return tags;
    }
    throw InputError(name +
                     ": does not end with the group EOF: it is truncated, or no DXF file; fetch or save it again");
}

// The groups of an entity: its type, and everything up to the next group 0.
class Entity {
public:
    Entity(const std::string& name, const Tag* begin, const Tag* end) : name_(name), begin_(begin), end_(end) {}

    std::string_view type() const { return begin_->value; }
    std::uint32_t line() const { return begin_->line; }
    const Tag* begin() const { return begin_ + 1; }
    const Tag* end() const { return end_; }

    [[noreturn]] void refuse(const std::string& why) const {
        readers::refuse(name_, line(), fmt::format("{} {}", shown(type()), why));
    }

    const Tag* find(int code) const {
        const Tag* const group = std::find_if(begin(), end(), [&](const Tag& tag) { return tag.code == code; });
        return group == end() ? nullptr : group;
    }
    // Returns the only group with this code, or null. Refuses the entity if it has two.
    const Tag* only(int code) const {
        const Tag* const group = find(code);
        if (group && std::find_if(group + 1, end(), [&](const Tag& tag) { return tag.code == code; }) != end())
            refuse(fmt::format("has two groups {}: save the file again", code));
        return group;
    }
    std::string_view text(int code) const {
        const Tag* const tag = only(code);
        return tag ? tag->value : "";
    }
    double number(const Tag& tag) const {
        const auto value = decimal(tag.value);
        if (!value) readers::refuse(name_, tag.line, fmt::format("'{}' is not a number", shown(tag.value)));
        return *value;
    }
    double number(int code, double unless_given) const {
        const Tag* const tag = only(code);
        return tag ? number(*tag) : unless_given;
    }
    std::int64_t integer(const Tag& tag) const {
        const auto value = whole<std::int64_t>(tag.value);
        if (!value) readers::refuse(name_, tag.line, fmt::format("'{}' is not an integer", shown(tag.value)));
        return *value;
    }
    std::int64_t integer(int code, std::int64_t unless_given) const {
        const Tag* const tag = only(code);
        return tag ? integer(*tag) : unless_given;
    }

    bool has_point(int code) const { return find(code) && find(code + 10); }
    // Returns the point whose x has this group code. z is 0 if it is missing, as in flat drawings.
    Vec3 point(int code) const {
        if (!has_point(code)) refuse(fmt::format("has no groups {} and {}: save the file again", code, code + 10));
        return {number(code, 0), number(code + 10, 0), number(code + 20, 0)};
    }

    // Refuses the entity if a group has a value other than 0.
    void expect_none(int code, const char* what, const char* remedy) const {
        for (const Tag& tag : *this)
            if (tag.code == code && number(tag) != 0)
                readers::refuse(name_, tag.line,
                                fmt::format("{} with a {} is not supported: {}", shown(type()), what, remedy));
    }
    void expect_thin() const { expect_none(39, "thickness", "convert it to 3DFACE, or set the thickness to 0"); }
    // Before release 11, group 38 raised entities whose points have no z.
    void expect_low() const { expect_none(38, "elevation", "save it as DXF of release 12 or later"); }

private:
    const std::string& name_;
    const Tag *begin_, *end_;
};

// The axes of the object coordinate system of an extrusion direction, by the arbitrary axis algorithm of DXF.
struct ObjectAxes {
    bool world = true;  // the system is that of the world
    Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();

    Vec3 operator()(const Vec3& p) const {
        if (world) return p;
        Vec3 moved;
        for (int k = 0; k < 3; ++k) moved[k] = x[k] * p[0] + y[k] * p[1] + z[k] * p[2];
        return moved;
    }
};

ObjectAxes axes_of(const Entity& entity) {
    ObjectAxes axes;
    const auto unit = [](const Vec3& v) -> Vec3 {
        const Vec3 scaled = at_unit_scale(v);
        return scaled / scaled.norm();
    };
    axes.z = unit({entity.number(210, 0), entity.number(220, 0), entity.number(230, 1)});
    if (!axes.z.allFinite()) entity.refuse("has no extrusion direction (groups 210, 220 and 230): save the file again");
    if (axes.z == Vec3::UnitZ()) return axes;
    axes.world = false;
    constexpr double limit = 1.0 / 64;
    const double across = std::max(std::abs(axes.z.x()), std::abs(axes.z.y()));
    if (std::abs(across - limit) < 1e-12)
        entity.refuse("has an extrusion direction at which the axes of its coordinates jump: turn it a little");
    axes.x = unit((across < limit ? Vec3(Vec3::UnitY()) : Vec3(Vec3::UnitZ())).cross(axes.z));
    axes.y = unit(axes.z.cross(axes.x));
    return axes;
}

// What the entities of the model space or of a block define.
struct Content {
    // An INSERT: a block, and where its copies are.
    struct Copy {
        std::string block;  // in lower case
        std::uint32_t line = 0;
        Vec3 at, scale;
        Circle rotation{1, 0};
        ObjectAxes axes;
        std::size_t columns = 1, rows = 1;
        double column_spacing = 0, row_spacing = 0;
    };

    std::vector<Vec3> points;
    std::vector<std::uint32_t> point_lines;
    std::vector<std::vector<std::size_t>> faces;
    std::vector<std::uint32_t> face_lines;
    std::vector<Copy> copies;
    std::size_t corners = 0, objects = 0;
};

bool is_annotation(std::string_view type) {
    static const std::set<std::string_view> all = {
        "TEXT",       "MTEXT",      "ATTRIB",      "ATTDEF",      "DIMENSION",         "ARC_DIMENSION",
        "LEADER",     "MLEADER",    "MULTILEADER", "TOLERANCE",   "VIEWPORT",          "IMAGE",
        "WIPEOUT",    "OLEFRAME",   "OLE2FRAME",   "PDFUNDERLAY", "DWFUNDERLAY",       "DGNUNDERLAY",
        "XLINE",      "RAY",        "LIGHT",       "SUN",         "ARCALIGNEDTEXT",    "RTEXT",
        "ACAD_TABLE", "CAMERA",     "SEQEND",      "SECTION",     "GEOPOSITIONMARKER", "LARGE_RADIAL_DIMENSION",
        "ENDBLK",     "ATTBLOCKREF"};
    return all.contains(type);
}

// Numbers of entities, for notes.
struct Counts {
    std::map<std::string, std::size_t> left_out;       // by type
    std::map<std::string, std::string> hidden_layers;  // that are off or frozen: names, by the name in lower case
    std::map<std::string, std::size_t> on_hidden;      // that are read, by the name of their hidden layer
    std::size_t invisible = 0;                         // that are read although group 60 hides them
};

// Reads the entities of a section or block.
class EntityReader {
public:
    EntityReader(const std::string& name, const std::vector<Entity>& entities, Counts& counts)
        : name_(name), entities_(entities), counts_(counts) {}

    Content read() {
        while (next_ < entities_.size()) {
            const Entity& entity = entities_[next_++];
            if (entity.integer(67, 0) != 0) {
                skip_followers(entity);
                ++counts_.left_out["entity in the paper space"];
            } else {
                add(entity);
            }
        }
        for (const auto& face : content_.faces) content_.corners += face.size();
        content_.objects += loose_ ? 1 : 0;
        return std::move(content_);
    }

private:
    void add(const Entity& entity) {
        const std::string_view type = entity.type();
        if (!is_annotation(type)) count_hidden(entity);
        if (type == "3DFACE") return add_quad(entity, false);
        if (type == "SOLID" || type == "TRACE") return add_quad(entity, true);
        if (type == "POLYLINE") return add_polyline(entity);
        if (type == "LWPOLYLINE") return add_light_polyline(entity);
        if (type == "MESH") return add_mesh(entity);
        if (type == "INSERT") return add_insert(entity);
        if (type == "LINE" || type == "POINT") {
            entity.expect_thin();
            entity.expect_low();
            std::vector<Vec3> ends{entity.point(10)};
            if (type == "LINE") ends.push_back(entity.point(11));
            return add_chain(entity, ends, false);
        }
        if (!is_annotation(type))
            entity.refuse("is not supported: convert it to 3DFACE or POLYLINE in a CAD program, or export STL");
        ++counts_.left_out[std::string(type)];
    }

    void count_hidden(const Entity& entity) {
        const auto layer = counts_.hidden_layers.find(lower_case(entity.text(8)));
        if (layer != counts_.hidden_layers.end()) ++counts_.on_hidden[layer->second];
        if (entity.integer(60, 0) != 0) ++counts_.invisible;
    }

    // Skips the entities that belong to this one.
    void skip_followers(const Entity& entity) {
        if (entity.type() == "POLYLINE" || (entity.type() == "INSERT" && entity.integer(66, 0) != 0)) followers(entity);
    }

    // Removes the entities up to SEQEND and returns them.
    std::vector<const Entity*> followers(const Entity& entity) {
        std::vector<const Entity*> following;
        for (; next_ < entities_.size(); ++next_) {
            const std::string_view type = entities_[next_].type();
            if (type == "SEQEND") {
                ++next_;
                return following;
            }
            if (type != "VERTEX" && type != "ATTRIB") break;
            following.push_back(&entities_[next_]);
        }
        entity.refuse("does not end with SEQEND: the file is truncated or damaged, fetch or save it again");
    }

    std::size_t add_point(const Entity& entity, const Vec3& point) {
        content_.points.push_back(point);
        content_.point_lines.push_back(entity.line());
        return content_.points.size() - 1;
    }
    void add_face(const Entity& entity, std::vector<std::size_t> face) {
        content_.faces.push_back(std::move(face));
        content_.face_lines.push_back(entity.line());
    }

    // Adds a point, or segments between each two neighbours.
    void add_chain(const Entity& entity, const std::vector<Vec3>& points, bool closed) {
        const std::size_t first = content_.points.size();
        for (const Vec3& point : points) add_point(entity, point);
        for (std::size_t i = 1; i < points.size(); ++i) add_face(entity, {first + i - 1, first + i});
        if (points.size() == 1) add_face(entity, {first});
        if (closed && points.size() > 2) add_face(entity, {first + points.size() - 1, first});
        loose_ = loose_ || !points.empty();
    }

    // Adds a 3DFACE, or a SOLID or TRACE, whose third and fourth corners are crossed. The fourth may be missing, or
    // equal to the third: then it is a triangle.
    void add_quad(const Entity& entity, bool crossed) {
        entity.expect_low();
        ObjectAxes axes;
        if (crossed) {
            entity.expect_thin();
            axes = axes_of(entity);
        }
        std::vector<Vec3> corners;
        for (const int code : {10, 11, 12, 13})
            if (code != 13 || entity.has_point(13)) corners.push_back(entity.point(code));
        if (corners.size() == 4 && corners[3] == corners[2]) corners.pop_back();
        if (crossed && corners.size() == 4) std::swap(corners[2], corners[3]);
        std::vector<std::size_t> face;
        for (const Vec3& corner : corners) face.push_back(add_point(entity, axes(corner)));
        add_face(entity, std::move(face));
        loose_ = true;
    }

    void add_polyline(const Entity& entity) {
        const std::vector<const Entity*> vertices = followers(entity);
        const std::int64_t flags = entity.integer(70, 0);
        if ((flags & (2 | 4)) != 0 || entity.integer(75, 0) != 0)
            entity.refuse(
                "that is fitted to a curve or smooth surface is not supported: convert it to 3DFACE or lines "
                "(in AutoCAD: explode it)");
        if ((flags & 64) != 0) return add_polyface(vertices);
        entity.expect_low();
        if ((flags & 16) != 0) return add_grid(entity, vertices, flags);
        const bool flat = (flags & 8) == 0;
        ObjectAxes axes;
        double elevation = 0;
        if (flat) {
            entity.expect_thin();
            expect_straight(entity);
            axes = axes_of(entity);
            elevation = entity.number(30, 0);
        }
        std::vector<Vec3> points;
        for (const Entity* vertex : vertices) {
            Vec3 point = vertex->point(10);
            if (flat) {
                expect_straight(*vertex);
                if (point.z() != elevation && vertex->find(30) && (point.z() != 0 || !entity.find(30)))
                    vertex->refuse(
                        fmt::format("of a 2D polyline of elevation {} has z = {}: set flag 8 in group 70 of "
                                    "POLYLINE if it is a 3D polyline",
                                    elevation, point.z()));
                point.z() = elevation;
            }
            points.push_back(axes(point));
        }
        add_chain(entity, points, (flags & 1) != 0);
    }

    // Refuses arcs and widths.
    static void expect_straight(const Entity& entity) {
        entity.expect_none(42, "bulge", "convert its arcs to lines");
        for (const int code : {40, 41, 43}) entity.expect_none(code, "width", "set the width to 0");
    }

    void add_polyface(const std::vector<const Entity*>& vertices) {
        const auto is_face = [](const Entity& entity) { return (entity.integer(70, 0) & (64 | 128)) == 128; };
        const std::size_t first = content_.points.size();
        for (const Entity* vertex : vertices)
            if (!is_face(*vertex)) add_point(*vertex, vertex->point(10));
        const std::size_t count = content_.points.size() - first;
        for (const Entity* vertex : vertices) {
            if (!is_face(*vertex)) continue;
            std::vector<std::size_t> face;
            for (const int code : {71, 72, 73, 74}) {
                const std::int64_t index = vertex->integer(code, 0);  // negative: the edge from it on is invisible
                if (index == 0) break;
                const std::uint64_t place =
                    index < 0 ? -static_cast<std::uint64_t>(index) : static_cast<std::uint64_t>(index);
                if (place > count)
                    vertex->refuse(fmt::format("of a polyface mesh names vertex {}, but there are {}", index, count));
                face.push_back(first + place - 1);
            }
            if (face.empty()) vertex->refuse("is a face of a polyface mesh without corners: save the file again");
            add_face(*vertex, std::move(face));
        }
        ++content_.objects;
    }

    // Adds the M x N grid of a polygon mesh.
    void add_grid(const Entity& entity, const std::vector<const Entity*>& vertices, std::int64_t flags) {
        const std::int64_t m = entity.integer(71, 0), n = entity.integer(72, 0);
        const auto count = static_cast<std::int64_t>(vertices.size());
        if (m < 2 || n < 2 || m > count || n > count || m * n != count)
            entity.refuse(
                fmt::format("is a polygon mesh of {} x {} vertices, and has {}: save the file again", m, n, count));
        const std::size_t first = content_.points.size();
        for (const Entity* vertex : vertices) add_point(*vertex, vertex->point(10));
        const auto at = [&](std::int64_t i, std::int64_t k) {
            return first + static_cast<std::size_t>((i % m) * n + k % n);
        };
        for (std::int64_t i = 0; i < ((flags & 1) != 0 ? m : m - 1); ++i)
            for (std::int64_t k = 0; k < ((flags & 32) != 0 ? n : n - 1); ++k)
                add_face(entity, {at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)});
        ++content_.objects;
    }

    void add_light_polyline(const Entity& entity) {
        entity.expect_thin();
        expect_straight(entity);
        const ObjectAxes axes = axes_of(entity);
        const double elevation = entity.number(38, 0);
        std::vector<Vec3> points;
        bool complete = true;
        for (const Tag& tag : entity) {
            if (tag.code == 10 && complete) points.emplace_back(entity.number(tag), 0, elevation);
            if (tag.code == 20 && !complete) points.back().y() = entity.number(tag);
            if (tag.code != 10 && tag.code != 20) continue;
            if ((tag.code == 10) != complete) readers::refuse(name_, tag.line, "LWPOLYLINE: x and y do not alternate");
            complete = tag.code == 20;
        }
        if (!complete ||
            entity.integer(90, static_cast<std::int64_t>(points.size())) != static_cast<std::int64_t>(points.size()))
            entity.refuse(fmt::format("announces {} vertices and has {}: save the file again", shown(entity.text(90)),
                                      points.size()));
        for (Vec3& point : points) point = axes(point);
        add_chain(entity, points, (entity.integer(70, 0) & 1) != 0);
    }

    // Returns the next group of a MESH, which must have this code.
    const Tag& expected(const Entity& entity, const Tag*& at, int code) const {
        if (at == entity.end() || at->code != code)
            entity.refuse(fmt::format("has no group {} where one is expected: save the file again", code));
        return *at++;
    }

    // Skips the groups of a MESH up to one with this code, which gives the size of a list, and returns the size.
    std::size_t list_size(const Entity& entity, const Tag*& at, int code) const {
        while (at != entity.end() && at->code != code) ++at;
        const std::int64_t size = entity.integer(expected(entity, at, code));
        if (size < 0 || size > entity.end() - at)
            entity.refuse(
                fmt::format("announces {} elements in group {}, and has fewer: save the file again", size, code));
        return static_cast<std::size_t>(size);
    }

    void add_mesh(const Entity& entity) {
        const Tag* at = std::find_if(entity.begin(), entity.end(),
                                     [](const Tag& tag) { return tag.code == 100 && tag.value == "AcDbSubDMesh"; });
        if (at == entity.end()) entity.refuse("has no subclass AcDbSubDMesh: save the file again");
        while (at != entity.end() && at->code != 91) ++at;
        if (const std::int64_t level = entity.integer(expected(entity, at, 91)); level != 0)
            entity.refuse(
                fmt::format("of subdivision level {} is not supported: convert it to faces (in AutoCAD: explode "
                            "it), or set the level to 0",
                            level));
        const std::size_t first = content_.points.size(), count = list_size(entity, at, 92);
        for (std::size_t i = 0; i < count; ++i) {
            Vec3 point;
            for (int k = 0; k < 3; ++k) point[k] = entity.number(expected(entity, at, 10 + 10 * k));
            add_point(entity, point);
        }
        for (std::size_t left = list_size(entity, at, 93); left > 0;) {
            const std::int64_t corners = entity.integer(expected(entity, at, 90));
            --left;
            if (corners < 1 || static_cast<std::uint64_t>(corners) > left)
                entity.refuse(
                    fmt::format("has a face of {} corners, and {} numbers are left in its list", corners, left));
            std::vector<std::size_t> face;
            for (; static_cast<std::int64_t>(face.size()) < corners; --left) {
                const std::int64_t index = entity.integer(expected(entity, at, 90));
                if (index < 0 || static_cast<std::uint64_t>(index) >= count)
                    entity.refuse(fmt::format("names vertex {} (from 0), but there are {}", index, count));
                face.push_back(first + static_cast<std::size_t>(index));
            }
            add_face(entity, std::move(face));
        }
        ++content_.objects;
    }

    void add_insert(const Entity& entity) {
        skip_followers(entity);  // attributes, which are texts
        Content::Copy copy;
        copy.block = lower_case(entity.text(2));
        copy.line = entity.line();
        copy.at = entity.point(10);
        copy.scale = {entity.number(41, 1), entity.number(42, 1), entity.number(43, 1)};
        const double degrees = entity.number(50, 0);
        if (!std::isfinite(degrees)) entity.refuse("has a rotation that is not finite");
        copy.rotation = circle_at_degrees(degrees);
        copy.axes = axes_of(entity);
        // 0 columns or rows count as 1, as in AutoCAD.
        copy.columns = static_cast<std::size_t>(std::max<std::int64_t>(entity.integer(70, 1), 1));
        copy.rows = static_cast<std::size_t>(std::max<std::int64_t>(entity.integer(71, 1), 1));
        copy.column_spacing = entity.number(44, 0);
        copy.row_spacing = entity.number(45, 0);
        content_.copies.push_back(std::move(copy));
    }

    const std::string& name_;
    const std::vector<Entity>& entities_;
    Counts& counts_;
    std::size_t next_ = 0;
    bool loose_ = false;  // there are entities of a single face or line, which count as one object together
    Content content_;
};

struct Block {
    Vec3 base = Vec3::Zero();
    std::vector<Entity> entities;
    bool external = false, twice = false;
    std::uint32_t line = 0;
    std::optional<Content> content = {};  // read when the first INSERT names it
    bool open = false;                    // it is being drawn
};

// How the points of a block move.
struct Move {
    const Content::Copy* copy = nullptr;
    Vec3 base, offset;
    const Move* outer = nullptr;

    Vec3 operator()(Vec3 p) const {
        for (const Move* move = this; move; move = move->outer) {
            for (int k = 0; k < 3; ++k) p[k] = move->offset[k] + move->copy->scale[k] * (p[k] - move->base[k]);
            const auto [cosine, sine] = move->copy->rotation;
            if (sine != 0 || cosine != 1) p = Vec3(cosine * p.x() - sine * p.y(), sine * p.x() + cosine * p.y(), p.z());
            p = move->copy->axes(p + move->copy->at);
        }
        return p;
    }
};

class Drawing {
public:
    explicit Drawing(const Input& input)
        : name_(input.name),
          tags_(tags_of(input.name, input.bytes)),
          parts_left_(std::max(parts_anyway, parts_a_byte * input.bytes.size())) {
        soup_.objects = 0;
    }

    Soup draw() {
        read_sections();
        const Content model = EntityReader(name_, model_, counts_).read();
        draw(model, nullptr, 0);
        note_left_out();
        note_hidden();
        if (soup_.faces.empty())
            throw InputError(name_ +
                             ": has no face, line or point in the model space: export 3DFACE, MESH or POLYLINE, "
                             "or convert it to OBJ or STL");
        return std::move(soup_);
    }

private:
    bool is(std::size_t i, std::string_view type) const { return tags_[i].code == 0 && tags_[i].value == type; }

    void read_sections() {
        for (std::size_t i = 0; i + 1 < tags_.size(); ++i) {
            if (!is(i, "SECTION") || tags_[i + 1].code != 2) continue;
            std::size_t end = i + 2;
            while (!is(end, "ENDSEC") && !is(end, "EOF")) ++end;
            if (is(end, "EOF"))
                refuse(name_, tags_[i].line,
                       fmt::format("section {} does not end with ENDSEC: the file is truncated or "
                                   "damaged, fetch or save it again",
                                   shown(tags_[i + 1].value)));
            const std::string_view section = tags_[i + 1].value;
            if (section == "HEADER") read_header(i + 2, end);
            if (section == "TABLES") read_layers(i + 2, end);
            if (section == "BLOCKS") read_blocks(i + 2, end);
            if (section == "ENTITIES")
                for (Entity& entity : entities(i + 2, end)) model_.push_back(std::move(entity));
            i = end;
        }
    }

    std::vector<Entity> entities(std::size_t begin, std::size_t end) const {
        std::vector<Entity> list;
        while (begin < end && tags_[begin].code != 0) ++begin;
        while (begin < end) {
            std::size_t after = begin + 1;
            while (after < end && tags_[after].code != 0) ++after;
            list.emplace_back(name_, tags_.data() + begin, tags_.data() + after);
            begin = after;
        }
        return list;
    }

    void read_header(std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i + 1 < end; ++i) {
            if (tags_[i].code != 9 || tags_[i].value != "$INSUNITS" || tags_[i + 1].code != 70) continue;
            // The lengths of the units 1 to 24 in metres.
            constexpr std::array<double, 24> metres = {0.0254,
                                                       0.3048,
                                                       1609.344,
                                                       1e-3,
                                                       1e-2,
                                                       1,
                                                       1e3,
                                                       2.54e-8,
                                                       2.54e-5,
                                                       0.9144,
                                                       1e-10,
                                                       1e-9,
                                                       1e-6,
                                                       0.1,
                                                       10,
                                                       100,
                                                       1e9,
                                                       149597870700.0,
                                                       9460730472580800.0,
                                                       3.0856775814913673e16,
                                                       1200.0 / 3937,
                                                       100.0 / 3937,
                                                       3600.0 / 3937,
                                                       6336000.0 / 3937};
            const auto unit = whole<std::size_t>(tags_[i + 1].value);
            if (unit && *unit >= 1 && *unit <= metres.size()) soup_.stated = stated_unit(metres[*unit - 1]);
            if (!unit || *unit > metres.size())
                soup_.notes.push_back(fmt::format("its unit $INSUNITS = {} is unknown, and counts as not stated",
                                                  shown(tags_[i + 1].value)));
            return;
        }
    }

    // Finds the layers that are frozen, or whose colour is negative because they are off.
    void read_layers(std::size_t begin, std::size_t end) {
        for (const Entity& layer : entities(begin, end))
            if (layer.type() == "LAYER" && ((layer.integer(70, 0) & 1) != 0 || layer.integer(62, 7) < 0))
                counts_.hidden_layers.emplace(lower_case(layer.text(2)), shown(layer.text(2)));
    }

    void read_blocks(std::size_t begin, std::size_t end) {
        Block* block = nullptr;
        for (Entity& entity : entities(begin, end)) {
            if (entity.type() == "ENDBLK") {
                block = nullptr;
            } else if (entity.type() == "BLOCK") {
                const auto [at, added] = blocks_.try_emplace(lower_case(entity.text(2)));
                block = &at->second;
                block->twice = !added;
                block->line = entity.line();
                block->external = (entity.integer(70, 0) & (4 | 8)) != 0;
                if (entity.has_point(10)) block->base = entity.point(10);
            } else if (block) {
                block->entities.push_back(std::move(entity));
            }
        }
    }

    void spend(std::uint32_t line, std::size_t parts) {
        if (parts > parts_left_)
            refuse(name_, line,
                   fmt::format("INSERT repeats blocks so often that it is more than {} inserts, points and "
                               "corners for each byte of the file: write fewer of them",
                               parts_a_byte));
        parts_left_ -= parts;
    }

    Block& block_of(const Content::Copy& copy) {
        const auto entry = blocks_.find(copy.block);
        const std::string called = shown(copy.block);
        if (entry == blocks_.end())
            refuse(name_, copy.line, fmt::format("INSERT names the block '{}', which is not in the file", called));
        Block& block = entry->second;
        if (block.twice) refuse(name_, block.line, fmt::format("a second block has the name '{}': rename one", called));
        if (block.external)
            refuse(name_, copy.line,
                   fmt::format("the block '{}' is a reference to another file, which is not supported: "
                               "bind it (in AutoCAD: XREF, Bind)",
                               called));
        if (block.open)
            refuse(name_, copy.line, fmt::format("the block '{}' contains an INSERT of itself: leave it out", called));
        if (!block.content) block.content = EntityReader(name_, block.entities, counts_).read();
        return block;
    }

    void draw(const Content& content, const Move* move, int depth) {
        const std::uint32_t line = move ? move->copy->line : 0;
        const auto levels = static_cast<std::size_t>(depth) + 1;
        spend(line, 1 + content.faces.size() + content.corners + levels * content.points.size());
        const std::size_t first = soup_.points.size();
        for (std::size_t i = 0; i < content.points.size(); ++i) {
            soup_.points.push_back(move ? (*move)(content.points[i]) : content.points[i]);
            soup_.point_lines.push_back(content.point_lines[i]);
        }
        for (std::size_t f = 0; f < content.faces.size(); ++f) {
            auto& face = soup_.faces.emplace_back();
            for (const std::size_t v : content.faces[f]) face.push_back(first + v);
            soup_.face_lines.push_back(content.face_lines[f]);
        }
        soup_.objects += static_cast<std::int64_t>(content.objects);
        for (const Content::Copy& copy : content.copies) draw_copies(copy, move, depth + 1);
    }

    void draw_copies(const Content::Copy& copy, const Move* outer, int depth) {
        if (depth > deepest)
            refuse(name_, copy.line, fmt::format("blocks are nested deeper than {}: take some of them apart", deepest));
        Block& block = block_of(copy);
        block.open = true;
        for (std::size_t row = 0; row < copy.rows; ++row)
            for (std::size_t column = 0; column < copy.columns; ++column) {
                spend(copy.line, 1);
                const Vec3 offset(static_cast<double>(column) * copy.column_spacing,
                                  static_cast<double>(row) * copy.row_spacing, 0);
                const Move move{&copy, block.base, offset, outer};
                draw(*block.content, &move, depth);
            }
        block.open = false;
    }

    void note_left_out() {
        std::string list;
        for (const auto& [type, count] : counts_.left_out)
            if (type != "SEQEND") list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, type);
        if (!list.empty()) soup_.notes.push_back("left out: " + list);
        std::size_t unused = 0;
        for (const auto& [called, block] : blocks_)
            unused += !block.content && !block.entities.empty() && !called.starts_with('*') ? 1 : 0;
        if (unused > 0)
            soup_.notes.push_back(
                fmt::format("blocks that no INSERT in the model space names are left out: {}", unused));
    }

    void note_hidden() {
        constexpr std::size_t most = 5;  // names in a note
        std::size_t entities = 0, named = 0;
        std::string names;
        for (const auto& [layer, count] : counts_.on_hidden) {
            entities += count;
            if (named++ < most) names += fmt::format("{}'{}'", names.empty() ? "" : ", ", layer);
        }
        if (named > most) names += fmt::format(" and {} more", named - most);
        if (entities > 0)
            soup_.notes.push_back(fmt::format("{} {} on the hidden layer{} {} {} read", entities,
                                              entities == 1 ? "entity" : "entities", named == 1 ? "" : "s", names,
                                              entities == 1 ? "is" : "are"));
        if (counts_.invisible > 0)
            soup_.notes.push_back(fmt::format("{} invisible {} (group 60) {} read", counts_.invisible,
                                              counts_.invisible == 1 ? "entity" : "entities",
                                              counts_.invisible == 1 ? "is" : "are"));
    }

    const std::string& name_;
    const std::vector<Tag> tags_;
    std::size_t parts_left_;
    std::vector<Entity> model_;
    std::map<std::string, Block> blocks_;  // by the name in lower case
    Counts counts_;
    Soup soup_;
};

}  // namespace

Soup read_dxf(const Input& input) {
    if (input.bytes.starts_with("AutoCAD Binary DXF"))
        throw InputError(input.name + ": is binary DXF, which is not supported: save it as text (ASCII) DXF");
    return Drawing(input).draw();
}

}  // namespace hausbench::readers
