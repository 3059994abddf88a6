// Reads Gmsh meshes (.msh): version 1.0 as text, and 2.0 to 2.2, 4.0 and 4.1 as text or binary in either byte order.
//
// Read: $Nodes (also $ParametricNodes, and parametric coordinates, which are skipped) and the points, lines, triangles
// and quadrangles of $Elements. A file without elements is a point set. Volume elements are left out with a note, or
// refused if there are no surface elements. Lines that are sides of surface elements, and points, are left out
// unless the file has nothing else (cells.h). Names, entities, partitions, ghosts, periodic links and data are ignored, and a note names
// any section that the format does not define.
// Refused: curved elements (order 2 and higher), polygons, polyhedra, other versions, and other formats with the same
// ending (Fluent, FreeFem, GiD).
//
// The format has no unit and no axes. A coordinate is the number of the file exactly.
#include "algorithms/error.h"
#include "datasets/formats/cells.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"
#include "datasets/formats/scanner.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace hausbench::readers {
namespace {

struct Type {
    std::size_t nodes = 0;
    bool volume = false;
};

// The element types of order 1, by number.
constexpr std::array<Type, 16> types = {Type{}, {2}, {3}, {4}, {4, true}, {8, true}, {6, true}, {5, true},
                                        {},     {},  {},  {},  {},        {},        {},        {1}};
constexpr std::int64_t first_curved = 8, polygon = 34, polyhedron = 35;

std::string curved_name(std::int64_t type) {
    constexpr std::array<std::string_view, 24> names = {
        "3-node line",        "6-node triangle",     "9-node quadrangle",   "10-node tetrahedron",
        "27-node hexahedron", "18-node prism",       "14-node pyramid",     "",
        "8-node quadrangle",  "20-node hexahedron",  "15-node prism",       "13-node pyramid",
        "9-node triangle",    "10-node triangle",    "12-node triangle",    "15-node triangle",
        "15-node triangle",   "21-node triangle",    "4-node line",         "5-node line",
        "6-node line",        "20-node tetrahedron", "35-node tetrahedron", "56-node tetrahedron"};
    const auto i = static_cast<std::size_t>(type - first_curved);
    return i < names.size() ? fmt::format(" ({})", names[i]) : "";
}

// Returns the kind of a file that ends with .msh but is not a Gmsh mesh, and what to do with it.
std::string other_kind(std::string_view bytes) {
    std::string_view rest = bytes;
    std::string_view first;
    while (first.empty() && !rest.empty()) first = trimmed(next_line(rest));
    if (first.starts_with('('))
        return "it is a mesh of Fluent (ANSYS): open it in ParaView, extract its surface and save it as PLY or STL";
    std::string_view words = first;
    const std::string word = lower_case(next_word(words));
    if (word == "mesh") return "it is a mesh of GiD: save it as STL or OBJ with the program that wrote it";
    if (word.starts_with('<')) return "it is an XML file: save it as OBJ or STL with the program that wrote it";
    if (whole<std::int64_t>(word) && whole<std::int64_t>(next_word(words)) && whole<std::int64_t>(next_word(words)) &&
        trimmed(words).empty())
        return "it looks like a mesh of FreeFem: save it there with savemesh(Th, \"NAME.mesh\")";
    return "it does not begin with $MeshFormat: save it as OBJ, PLY or STL with the program that wrote it";
}

class GmshReader {
public:
    explicit GmshReader(const Input& input) : name_(input.name), bytes_(input.bytes), scan_(input.name, input.bytes) {}

    Soup read() {
        if (bytes_.starts_with("\xef\xbb\xbf")) scan_.move_to(3);  // a byte order mark
        if (!scan_.peek().starts_with('$'))
            throw InputError(fmt::format("{}: is not a Gmsh mesh: {}", name_, other_kind(bytes_)));
        while (read_section()) {
        }
        if (version_ == 0) throw InputError(name_ + ": has no section $MeshFormat: it is not a Gmsh mesh");
        if (!has_nodes_) throw InputError(name_ + ": has no section $Nodes: it holds no mesh");
        resolve_tags();
        if (soup_.faces.empty() && volumes_.empty())
            soup_.notes.push_back("the file has no elements: its nodes are read as points");
        for (const std::string& section : unknown_)
            soup_.notes.push_back(fmt::format("the section {} is not known, and is ignored", shown(section)));
        keep_surface(name_, volumes_,
                     "save it from gmsh with the option Mesh.SaveAll = 1, or convert it with `meshio convert FILE.msh "
                     "FILE.vtu`, apply the filter Extract Surface of ParaView, and save a .vtp",
                     soup_);
        return std::move(soup_);
    }

private:
    // Reads or skips a section. Returns false at the end of the file.
    bool read_section() {
        const std::string_view word = scan_.word();
        if (word.empty()) return false;
        if (!word.starts_with('$') || word.starts_with("$End") || word.starts_with("$END"))
            scan_.refuse(fmt::format("expected a section such as $Elements, found '{}'", shown(word)));
        const std::string section(word.substr(1));
        if (section == "MeshFormat") {
            read_format();
        } else if (section == "NOD" || section == "NOE" || section == "ELM") {
            if (version_ != 0 && version_ != 10) scan_.refuse(fmt::format("${} belongs to version 1", section));
            version_ = 10;
            section == "ELM" ? read_elements_1() : read_nodes_2(false);
            end_section(section == "ELM" ? "$ENDELM" : section == "NOD" ? "$ENDNOD" : "$ENDNOE");
        } else if (section == "Nodes" || section == "ParametricNodes" || section == "Elements") {
            if (version_ == 0) scan_.refuse(fmt::format("${} stands before $MeshFormat", section));
            if (section == "Elements")
                read_elements();
            else
                read_nodes(section == "ParametricNodes");
            end_section("$End" + section);
        } else {
            skip_section(section);
        }
        return true;
    }

    void end_section(const std::string& end) {
        const std::string_view word = scan_.word();
        if (word != end && word.starts_with(end))
            scan_.refuse(fmt::format("expected {}, found '{}': remove what follows {}", end, shown(word), end));
        if (word != end)
            scan_.refuse(
                fmt::format("expected {}, found {}: the section has more numbers than it announces, or the "
                            "file is truncated",
                            end, word.empty() ? "the end of the file" : fmt::format("'{}'", shown(word))));
    }

    void skip_section(const std::string& section) {
        static const std::set<std::string_view> ignored = {
            "PhysicalNames", "Entities",    "PartitionedEntities", "Periodic",         "GhostElements",
            "NodeData",      "ElementData", "ElementNodeData",     "Parametrizations", "InterpolationScheme",
            "Comments",      "Comment"};
        if (section == "PostFormat" || section == "View")
            scan_.refuse("is a Gmsh view of results, not a mesh: save the mesh with File > Export in gmsh");
        if (!ignored.contains(section) && std::find(unknown_.begin(), unknown_.end(), "$" + section) == unknown_.end())
            unknown_.push_back("$" + section);
        const std::string end = "$End" + section;
        if (!scan_.skip_to(end)) scan_.refuse(fmt::format("${} has no {}: the file is truncated", section, end));
        end_section(end);
    }

    void read_format() {
        if (version_ != 0) scan_.refuse("a second $MeshFormat");
        const std::string_view version = scan_.word();
        static const std::map<double, int> versions = {{2.0, 20}, {2.1, 21}, {2.2, 22}, {4.0, 40}, {4.1, 41}};
        const auto number = decimal(version);  // a number, which netgen writes as 2.000000
        const auto entry = number && std::isfinite(*number) ? versions.find(*number) : versions.end();
        if (entry == versions.end())
            scan_.refuse(
                fmt::format("version {} of the format is not supported: convert the file to version 4.1 with "
                            "`gmsh FILE.msh -0 -format msh41 -o NEW.msh`",
                            shown(version)));
        version_ = entry->second;
        const std::int64_t kind = scan_.integer(4, "0 (text) or 1 (binary)");
        const std::int64_t size = scan_.integer(4, "the size of a number");
        if (kind != 0 && kind != 1) scan_.refuse(fmt::format("file type {} is neither 0 (text) nor 1 (binary)", kind));
        if (kind == 1 && size != 8)
            scan_.refuse(
                fmt::format("numbers of {} bytes are not supported: only 8 are. Convert the file to text with "
                            "`gmsh FILE.msh -0 -format msh41 -o NEW.msh`",
                            size));
        if (kind == 1) {
            scan_.rest_of_line();
            binary_ = true;
            scan_.set_binary(false);
            const std::int64_t byte_order = scan_.integer(4, "the number 1, which tells the byte order");
            if (byte_order != 1 && byte_order != 0x1000000)
                scan_.refuse(fmt::format("expected the number 1, which tells the byte order, found {}", byte_order));
            scan_.set_binary(byte_order != 1);
        }
        end_section("$EndMeshFormat");
    }

    // Moves to the binary numbers, which follow the line with the name of the section or the count.
    void start_numbers() {
        if (binary_) scan_.rest_of_line();
    }

    // Reads the count of a section of version 1 or 2, which is text in a binary file too.
    std::uint64_t count_line(std::string_view what, std::uint64_t numbers, std::uint64_t bytes) {
        if (!binary_) return scan_.count(4, what, numbers, bytes);
        scan_.rest_of_line();
        const std::string_view line = trimmed(scan_.rest_of_line());
        const auto count = whole<std::int64_t>(line);
        if (!count) scan_.refuse(fmt::format("expected the number of {}, found '{}'", what, shown(line)));
        scan_.check_count(*count, what, numbers, bytes);
        return static_cast<std::uint64_t>(*count);
    }

    void add_node(std::int64_t tag) {
        nodes_.emplace_back(tag, soup_.points.size());
        add_point();
    }

    void add_point() {
        Vec3 point;
        for (double& coordinate : point) coordinate = scan_.real(8, "a coordinate of a node");
        soup_.points.push_back(point);
        if (!binary_) soup_.point_lines.push_back(scan_.line());
    }

    void read_nodes(bool parametric) {
        has_nodes_ = true;
        if (version_ < 40) return read_nodes_2(parametric);
        start_numbers();
        const std::uint64_t blocks = scan_.count(8, "blocks of nodes", 4, 20);
        const std::uint64_t all = scan_.count(8, "nodes", 4, 28);
        if (version_ == 41) {
            scan_.integer(8, "the least tag of a node");
            scan_.integer(8, "the greatest tag of a node");
        }
        std::uint64_t read = 0;
        for (std::uint64_t b = 0; b < blocks; ++b) read += read_node_block();
        if (read != all) scan_.refuse(fmt::format("$Nodes announces {} nodes, but its blocks have {}", all, read));
    }

    std::uint64_t read_node_block() {
        // 4.0: tag, dimension; 4.1: dimension, tag.
        const std::int64_t first = scan_.integer(4, "the entity of a block of nodes");
        const std::int64_t second = scan_.integer(4, "the entity of a block of nodes");
        const std::int64_t dimension = version_ == 40 ? second : first;
        const std::int64_t parametric = scan_.integer(4, "whether nodes are parametric");
        if (dimension < 0 || dimension > 3) scan_.refuse(fmt::format("an entity has dimension {}", dimension));
        if (parametric != 0 && parametric != 1)
            scan_.refuse(fmt::format("expected 0 or 1 (whether nodes are parametric), found {}", parametric));
        const auto parameters = static_cast<std::uint64_t>(parametric * dimension);
        const std::uint64_t tag_size = version_ == 40 ? 4 : 8;
        const std::uint64_t count = scan_.count(8, "nodes", 4 + parameters, tag_size + 8 * (3 + parameters));
        const auto skip_parameters = [&] {
            for (std::uint64_t k = 0; k < parameters; ++k) scan_.real(8, "a parameter of a node");
        };
        const std::size_t before = nodes_.size();
        for (std::uint64_t i = 0; i < count; ++i) {
            const std::int64_t tag = scan_.integer(tag_size, "the tag of a node");
            if (version_ == 41) {
                nodes_.emplace_back(tag, soup_.points.size() + i);
                continue;
            }
            add_node(tag);
            skip_parameters();
        }
        for (std::size_t i = before; version_ == 41 && i < nodes_.size(); ++i) {
            add_point();
            skip_parameters();
        }
        return count;
    }

    void read_nodes_2(bool parametric) {
        has_nodes_ = true;
        const std::uint64_t count = count_line("nodes", 4, 28);
        for (std::uint64_t i = 0; i < count; ++i) {
            add_node(scan_.integer(4, "the tag of a node"));
            if (!parametric) continue;
            const std::int64_t dimension = scan_.integer(4, "the dimension of an entity");
            scan_.integer(4, "the tag of an entity");
            if (dimension < 0 || dimension > 3) scan_.refuse(fmt::format("an entity has dimension {}", dimension));
            for (std::int64_t k = 0; k < dimension && dimension < 3; ++k) scan_.real(8, "a parameter of a node");
        }
    }

    // Returns the type with this number. Refuses all but the types of order 1.
    Type type_of(std::int64_t number) const {
        if (number > 0 && static_cast<std::size_t>(number) < types.size() &&
            types[static_cast<std::size_t>(number)].nodes > 0)
            return types[static_cast<std::size_t>(number)];
        if (number == polygon || number == polyhedron)
            scan_.refuse(fmt::format("elements of type {} ({}) are not supported: write the mesh with triangles",
                                     number, number == polygon ? "polygon" : "polyhedron"));
        if (number < first_curved || number > 140)
            scan_.refuse(fmt::format("element type {} is not known: the file is damaged", number));
        scan_.refuse(fmt::format(
            "elements of type {}{} are curved, and are not supported: mesh the model again with elements of order 1 "
            "(`gmsh MODEL.geo -2 -order 1`), small enough to follow the curves",
            number, curved_name(number)));
    }

    void add_element(Type type, std::size_t size, std::int64_t tag) {
        std::vector<std::size_t> face(type.nodes);
        for (std::size_t& node : face) node = static_cast<std::size_t>(scan_.integer(size, "a node of an element"));
        if (type.volume) {
            std::vector<std::size_t>& corners = volumes_[type.nodes];
            corners.insert(corners.end(), face.begin(), face.end());
            return;
        }
        soup_.faces.push_back(std::move(face));
        element_tags_.push_back(tag);
        if (!binary_) soup_.face_lines.push_back(scan_.line());
    }

    void read_elements() {
        if (version_ < 40) return binary_ ? read_binary_elements_2() : read_text_elements_2();
        start_numbers();
        const std::uint64_t blocks = scan_.count(8, "blocks of elements", 4, 20);
        const std::uint64_t tag_size = version_ == 40 ? 4 : 8;
        const std::uint64_t all = scan_.count(8, "elements", 2, 2 * tag_size);
        if (version_ == 41) {
            scan_.integer(8, "the least tag of an element");
            scan_.integer(8, "the greatest tag of an element");
        }
        std::uint64_t read = 0;
        for (std::uint64_t b = 0; b < blocks; ++b) {
            scan_.integer(4, "the entity of a block of elements");
            scan_.integer(4, "the entity of a block of elements");
            const std::int64_t number = scan_.integer(4, "the type of elements");
            const Type type = type_of(number);
            const std::uint64_t count = scan_.count(8, "elements", 1 + type.nodes, (1 + type.nodes) * tag_size);
            for (std::uint64_t i = 0; i < count; ++i)
                add_element(type, tag_size, scan_.integer(tag_size, "the tag of an element"));
            read += count;
        }
        if (read != all)
            scan_.refuse(fmt::format("$Elements announces {} elements, but its blocks have {}", all, read));
    }

    // Skips the tags of an element of version 2: its physical group, entity and partitions.
    void skip_tags(std::int64_t count) {
        scan_.check_count(count, "tags of an element", 1, 4);
        for (std::int64_t i = 0; i < count; ++i) scan_.integer(4, "a tag of an element");
    }

    void read_text_elements_2() {
        const std::uint64_t count = count_line("elements", 4, 16);
        for (std::uint64_t i = 0; i < count; ++i) {
            const std::int64_t tag = scan_.integer(4, "the number of an element");
            const Type type = type_of(scan_.integer(4, "the type of an element"));
            skip_tags(scan_.integer(4, "the number of tags of an element"));
            add_element(type, 4, tag);
        }
    }

    void read_binary_elements_2() {
        const std::uint64_t count = count_line("elements", 4, 8);
        for (std::uint64_t read = 0; read < count;) {
            const Type type = type_of(scan_.integer(4, "the type of elements"));
            const std::int64_t block = scan_.integer(4, "the number of elements of a block");
            const std::int64_t tags = scan_.integer(4, "the number of tags of an element");
            scan_.check_count(block, "elements", 2, 4 * (1 + type.nodes));
            if (block < 1 || static_cast<std::uint64_t>(block) > count - read)
                scan_.refuse(fmt::format("a block has {} elements, but {} are left in $Elements", block, count - read));
            for (std::int64_t i = 0; i < block; ++i) {
                const std::int64_t tag = scan_.integer(4, "the number of an element");
                skip_tags(tags);
                add_element(type, 4, tag);
            }
            read += static_cast<std::uint64_t>(block);
        }
    }

    void read_elements_1() {
        const std::uint64_t count = count_line("elements", 6, 24);
        for (std::uint64_t i = 0; i < count; ++i) {
            const std::int64_t tag = scan_.integer(4, "the number of an element");
            const Type type = type_of(scan_.integer(4, "the type of an element"));
            skip_tags(2);
            const std::int64_t nodes = scan_.integer(4, "the number of nodes of an element");
            if (nodes != static_cast<std::int64_t>(type.nodes))
                scan_.refuse(fmt::format("element {} has {} nodes, but its type has {}", tag, nodes, type.nodes));
            add_element(type, 4, tag);
        }
    }

    // Replaces the tags of nodes in soup_.faces by indices into soup_.points.
    void resolve_tags() {
        std::sort(nodes_.begin(), nodes_.end());
        for (std::size_t i = 1; i < nodes_.size(); ++i)
            if (nodes_[i].first == nodes_[i - 1].first &&
                soup_.points[nodes_[i].second] != soup_.points[nodes_[i - 1].second])
                throw InputError(fmt::format("{}: $Nodes has node {} twice, with different coordinates: renumber them",
                                             name_, nodes_[i].first));
        for (std::size_t f = 0; f < soup_.faces.size(); ++f)
            for (std::size_t& node : soup_.faces[f]) node = index_of(static_cast<std::int64_t>(node), f);
        for (auto& [size, corners] : volumes_)
            for (std::size_t& node : corners) node = index_of(static_cast<std::int64_t>(node), soup_.faces.size());
    }

    // Returns the index of the node with this tag. `face`: that names it, for the message.
    std::size_t index_of(std::int64_t tag, std::size_t face) const {
        // Most files number their nodes from 1.
        if (tag > 0 && static_cast<std::size_t>(tag) <= nodes_.size())
            if (const auto& node = nodes_[static_cast<std::size_t>(tag) - 1]; node.first == tag) return node.second;
        const auto position = std::lower_bound(nodes_.begin(), nodes_.end(), std::pair(tag, std::size_t{0}));
        if (position == nodes_.end() || position->first != tag)
            throw InputError(fmt::format(
                "{}: {}{} names node {}, which $Nodes does not have: the file is damaged or a part of a mesh", name_,
                face < soup_.face_lines.size() ? fmt::format("line {}: ", soup_.face_lines[face]) : "",
                face < element_tags_.size() ? fmt::format("element {}", element_tags_[face]) : "a volume element",
                tag));
        return position->second;
    }

    const std::string& name_;
    std::string_view bytes_;
    Scanner scan_;
    int version_ = 0;  // times 10; 0: not known yet
    bool binary_ = false, has_nodes_ = false;
    std::vector<std::pair<std::int64_t, std::size_t>> nodes_;  // tag and index into soup_.points
    std::vector<std::int64_t> element_tags_;                   // of soup_.faces
    std::vector<std::string> unknown_;                         // sections
    VolumeCells volumes_;
    Soup soup_;
};

}  // namespace

Soup read_gmsh(const Input& input) { return GmshReader(input).read(); }

}  // namespace hausbench::readers
