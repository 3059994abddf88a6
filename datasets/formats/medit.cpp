// Reads Medit meshes, the Gamma Mesh Format of INRIA's libMeshb: text (.mesh) and binary (.meshb) in either byte order,
// told apart by their first bytes, of MeshVersionFormatted 1 to 4 and of dimension 2 (then z = 0) or 3.
//
// Read: Vertices, Edges, Triangles and Quadrilaterals. Without any of the last three, the file is a point set. Volume
// cells are left out with a note, or refused if there are no surface cells. References (the last number of each line),
// normals, tangents, corners, ridges, required elements, solutions and relations to a geometry are ignored.
// Refused: curved elements (TrianglesP2, QuadrilateralsQ2, ...), polygons, polyhedra and unknown keywords. Keywords are
// case sensitive.
//
// The format has no unit and no axes. A coordinate is the number of the file exactly. Version 1, or
// FloatingPointPrecision 32, defines single precision, so the decimal numbers of such a text are rounded to float32, as
// libMeshb does; a note says so if they have more digits than that.
#include "algorithms/error.h"
#include "datasets/formats/cells.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"
#include "datasets/formats/scanner.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <set>

namespace hausbench::readers {
namespace {

enum class Holds { version, dimension, precision, vertices, cells, volumes, curved, polygons, lines, nothing, end };

struct Keyword {
    std::string_view name;
    int code;  // in binary files
    Holds holds;
    std::size_t corners = 0;  // of cells and volumes
};

// The keywords that matter. `Holds::lines`: as text, each item is a line of free text.
constexpr std::array keywords = {
    Keyword{"MeshVersionFormatted", 1, Holds::version},
    Keyword{"Dimension", 3, Holds::dimension},
    Keyword{"Vertices", 4, Holds::vertices},
    Keyword{"Edges", 5, Holds::cells, 2},
    Keyword{"Triangles", 6, Holds::cells, 3},
    Keyword{"Quadrilaterals", 7, Holds::cells, 4},
    Keyword{"Tetrahedra", 8, Holds::volumes, 4},
    Keyword{"Prisms", 9, Holds::volumes, 6},
    Keyword{"Pentahedra", 0, Holds::volumes, 6},  // older names, in text only
    Keyword{"Hexaedra", 0, Holds::volumes, 8},
    Keyword{"Hexahedra", 10, Holds::volumes, 8},
    Keyword{"Pyramids", 49, Holds::volumes, 5},
    Keyword{"TrianglesP2", 24, Holds::curved},
    Keyword{"EdgesP2", 25, Holds::curved},
    Keyword{"QuadrilateralsQ2", 27, Holds::curved},
    Keyword{"TetrahedraP2", 30, Holds::curved},
    Keyword{"HexahedraQ2", 33, Holds::curved},
    Keyword{"ExtraVerticesAtEdges", 34, Holds::curved},
    Keyword{"ExtraVerticesAtTriangles", 35, Holds::curved},
    Keyword{"ExtraVerticesAtQuadrilaterals", 36, Holds::curved},
    Keyword{"ExtraVerticesAtTetrahedra", 37, Holds::curved},
    Keyword{"ExtraVerticesAtPrisms", 38, Holds::curved},
    Keyword{"ExtraVerticesAtHexahedra", 39, Holds::curved},
    Keyword{"Polyhedra", 46, Holds::polygons},
    Keyword{"Polygons", 47, Holds::polygons},
    Keyword{"End", 54, Holds::end},
    Keyword{"Comments", 81, Holds::lines},
    Keyword{"PrismsP2", 86, Holds::curved},
    Keyword{"PyramidsP2", 87, Holds::curved},
    Keyword{"QuadrilateralsQ3", 88, Holds::curved},
    Keyword{"QuadrilateralsQ4", 89, Holds::curved},
    Keyword{"TrianglesP3", 90, Holds::curved},
    Keyword{"TrianglesP4", 91, Holds::curved},
    Keyword{"EdgesP3", 92, Holds::curved},
    Keyword{"EdgesP4", 93, Holds::curved},
    Keyword{"IRefGroups", 94, Holds::lines},
    Keyword{"TetrahedraP3", 96, Holds::curved},
    Keyword{"TetrahedraP4", 97, Holds::curved},
    Keyword{"HexahedraQ3", 98, Holds::curved},
    Keyword{"HexahedraQ4", 99, Holds::curved},
    Keyword{"PyramidsP3", 100, Holds::curved},
    Keyword{"PyramidsP4", 101, Holds::curved},
    Keyword{"PrismsP3", 102, Holds::curved},
    Keyword{"PrismsP4", 103, Holds::curved},
    Keyword{"FloatingPointPrecision", 155, Holds::precision},
    Keyword{"ReferenceStrings", 199, Holds::lines},
    Keyword{"Prisms9", 200, Holds::curved},
    Keyword{"Hexahedra12", 201, Holds::curved},
    Keyword{"Quadrilaterals6", 202, Holds::curved},
    Keyword{"BoundaryPolygonHeaders", 203, Holds::polygons},
    Keyword{"BoundaryPolygonVertices", 204, Holds::polygons},
    Keyword{"InnerPolygonHeaders", 205, Holds::polygons},
    Keyword{"InnerPolygonVertices", 206, Holds::polygons},
    Keyword{"PolyhedraHeaders", 207, Holds::polygons},
    Keyword{"PolyhedraFaces", 208, Holds::polygons},
};
constexpr int last_code = 240;  // the last keyword of libMeshb 7.8; those not listed above hold no cells

// The beginnings and ends of keywords that hold no cells.
constexpr std::array<std::string_view, 24> ignored_beginnings = {
    "Required", "Normal",     "Tangent",  "Corners",     "Ridges",      "Sol",         "ISol",       "DSol",
    "HOSol",    "Fault_",     "Periodic", "SubDomain",   "BoundingBox", "Iterations",  "Time",       "DRefGroups",
    "Parallel", "AngleOfCor", "Domains",  "BezierBasis", "ByteFlow",    "PrivateTabl", "Identifier", "Geometry"};
constexpr std::array<std::string_view, 9> ignored_ends = {"Ordering",         "GID",
                                                          "Colour",           "Grain",
                                                          "GrainPartitions",  "ColorPartitions",
                                                          "ReferenceElement", "BoundaryLayers",
                                                          "CoarseHexahedra"};

const Keyword* with_code(int code) {
    const auto* const match =
        std::find_if(keywords.begin(), keywords.end(), [&](auto& keyword) { return keyword.code == code; });
    return match == keywords.end() || code == 0 ? nullptr : match;
}

const Keyword* with_name(std::string_view name) {
    const auto* const match =
        std::find_if(keywords.begin(), keywords.end(), [&](auto& keyword) { return keyword.name == name; });
    return match == keywords.end() ? nullptr : match;
}

bool is_ignored(std::string_view name) {
    // VerticesOnGeometricEdges, VertexOnGeometryFace, ...
    return name.find("OnGeometr") != std::string_view::npos ||
           std::any_of(ignored_beginnings.begin(), ignored_beginnings.end(),
                       [&](std::string_view beginning) { return name.starts_with(beginning); }) ||
           std::any_of(ignored_ends.begin(), ignored_ends.end(),
                       [&](std::string_view ending) { return name.ends_with(ending); });
}

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

// Returns whether a word of text is a keyword rather than a number, such as nan.
bool is_keyword(std::string_view word) { return !word.empty() && is_letter(word[0]) && !decimal(word); }

// Returns the kind of a file that ends with .mesh but is not a Medit mesh.
std::string other_kind(std::string_view bytes, std::string_view word) {
    if (bytes.substr(0, 64).find("[MeshSerializer_v") != std::string_view::npos) return "a binary mesh of Ogre";
    if (word == "MFEM") return "a mesh of MFEM";
    if (bytes.starts_with("%YAML")) return "a YAML file, such as Unity writes";
    if (bytes.starts_with("version ")) return "a mesh of Roblox";
    if (word.starts_with("<")) {
        for (std::size_t at = 0; (at = bytes.find('<', at)) != std::string_view::npos; ++at) {
            std::size_t end = at + 1;
            while (end < bytes.size() && is_letter(bytes[end])) ++end;
            if (end == at + 1) continue;
            const std::string_view tag = bytes.substr(at + 1, end - at - 1);
            return fmt::format("an XML file with the element <{}>{}", shown(tag),
                               tag == "mesh" ? ", as Ogre writes" : "");
        }
        return "an XML file";
    }
    return "";
}

class MeditReader {
public:
    explicit MeditReader(const Input& input) : name_(input.name), scan_(input.name, input.bytes, '#') {}

    Soup read(std::string_view bytes) {
        using namespace std::string_view_literals;
        if (bytes.starts_with("\1\0\0\0"sv) || bytes.starts_with("\0\0\0\1"sv))
            read_binary(bytes);
        else
            read_text(bytes);
        if (!seen_.contains("Vertices")) throw InputError(name_ + ": has no keyword Vertices: it holds no mesh");
        check_corners();
        if (!ended_) soup_.notes.push_back("the keyword End is missing: the file may be truncated");
        if (dimension_ == 2) soup_.notes.push_back("the mesh has dimension 2: z is 0");
        if (rounded_ > 0)
            soup_.notes.push_back(fmt::format(
                "coordinates with more digits than float32 holds are rounded to it, as {} defines ({}): to keep the "
                "digits, write 'MeshVersionFormatted 2' in the file",
                seen_.contains("FloatingPointPrecision") ? "FloatingPointPrecision 32" : "MeshVersionFormatted 1",
                rounded_));
        keep_surface(
            name_, volumes_,
            "extract its surface: convert it with `meshio convert FILE.mesh FILE.vtu`, apply the filter Extract "
            "Surface of ParaView, and save a .vtp",
            soup_);
        return std::move(soup_);
    }

private:
    void read_text(std::string_view bytes) {
        if (bytes.starts_with("\xef\xbb\xbf")) scan_.move_to(3);  // a byte order mark
        const std::string_view first = scan_.word();
        if (first != "MeshVersionFormatted") {
            const std::string kind = other_kind(bytes, first);
            throw InputError(
                fmt::format("{}: is not a Medit mesh: {}: convert it to OBJ, PLY or STL with the program that wrote it",
                            name_, kind.empty() ? "it does not begin with MeshVersionFormatted" : "it is " + kind));
        }
        set_version();
        for (std::string_view word = scan_.word(); !word.empty(); word = scan_.word()) {
            const Keyword* const keyword = with_name(word);
            if (keyword && keyword->holds == Holds::end) {
                ended_ = true;
                if (!scan_.word().empty()) scan_.refuse("the file goes on after the keyword End: remove the rest");
                return;
            }
            if (keyword && keyword->holds == Holds::lines) {
                skip_lines(word);
            } else if (keyword) {
                read_section(*keyword);
            } else {
                if (!is_keyword(word)) refuse_number(word);
                if (!is_ignored(word)) refuse_unknown(word);
                skip_numbers();
            }
            last_ = word;
        }
    }

    void read_binary(std::string_view bytes) {
        scan_.set_binary(bytes[0] == '\0');  // written as a 1
        scan_.move_to(4);
        set_version();
        for (std::size_t next = 8; next != 0;) {
            scan_.move_to(next);
            const auto code = static_cast<int>(scan_.integer(4, "the code of a keyword"));
            const std::int64_t link = scan_.integer(version_ < 3 ? 4 : 8, "the position of the next keyword");
            if (link != 0 &&
                (link < static_cast<std::int64_t>(scan_.at()) || link > static_cast<std::int64_t>(bytes.size())))
                scan_.refuse(
                    fmt::format("the next keyword is said to be at byte {} of {}: the file is truncated or "
                                "damaged",
                                link, bytes.size()));
            next = static_cast<std::size_t>(link);
            const Keyword* const keyword = with_code(code);
            if (!keyword && (code < 1 || code > last_code)) refuse_unknown(fmt::format("of code {}", code));
            if (keyword && keyword->holds == Holds::end) {
                ended_ = true;
                return;
            }
            if (!keyword || keyword->holds == Holds::lines) continue;
            read_section(*keyword);
            const std::size_t end = next == 0 ? bytes.size() : next;
            if (scan_.at() != end && keyword->holds != Holds::curved && keyword->holds != Holds::polygons)
                scan_.refuse(fmt::format("{} ends at byte {}, but the next keyword is at {}: the file is damaged",
                                         keyword->name, scan_.at(), end));
        }
    }

    void set_version() {
        version_ = scan_.integer(4, "the number of MeshVersionFormatted");
        if (version_ < 1 || version_ > 4)
            scan_.refuse(
                fmt::format("MeshVersionFormatted {} is not known: 1 to 4 are, of which 2 keeps all digits of "
                            "the numbers",
                            version_));
        real_ = version_ == 1 ? 4 : 8;
    }

    std::size_t integer_size() const { return version_ == 4 ? 8 : 4; }

    std::uint64_t count(const Keyword& keyword, std::size_t integers, std::size_t reals) {
        return scan_.count(integer_size(), keyword.name, integers + reals, integers * integer_size() + reals * real_);
    }

    void read_section(const Keyword& keyword) {
        if (!seen_.insert(keyword.name).second || keyword.holds == Holds::version)
            scan_.refuse(fmt::format("a second {}: join both into one", keyword.name));
        switch (keyword.holds) {
            case Holds::dimension:
                return set_dimension();
            case Holds::precision:
                return set_precision();
            case Holds::vertices:
                return read_vertices(keyword);
            case Holds::cells:
                return read_cells(keyword);
            case Holds::volumes:
                return read_volumes(keyword);
            case Holds::curved:
                if (count(keyword, 1, 0) > 0)
                    scan_.refuse(
                        fmt::format("{}: curved cells are not supported: write the mesh with flat cells "
                                    "(degree 1), small enough to follow the curves",
                                    keyword.name));
                return;
            default:
                scan_.refuse(fmt::format("{}: polygons and polyhedra are not supported: write the mesh with Triangles",
                                         keyword.name));
        }
    }

    void set_dimension() {
        dimension_ = scan_.integer(4, "2 or 3 after Dimension");
        if (dimension_ != 2 && dimension_ != 3)
            scan_.refuse(fmt::format("Dimension {} is not supported: only 2 and 3 are", dimension_));
    }

    void set_precision() {
        const std::int64_t bits = scan_.integer(4, "32 or 64 after FloatingPointPrecision");
        if (bits != 32 && bits != 64)
            scan_.refuse(fmt::format("FloatingPointPrecision {} is not supported: only 32 and 64 are", bits));
        if (seen_.contains("Vertices"))
            scan_.refuse("FloatingPointPrecision stands after Vertices: move it before them");
        real_ = static_cast<std::size_t>(bits) / 8;
    }

    void read_vertices(const Keyword& keyword) {
        if (dimension_ == 0) scan_.refuse("Vertices stand before Dimension: write 'Dimension 3' before them");
        const std::uint64_t points = count(keyword, 1, static_cast<std::size_t>(dimension_));
        soup_.float32 = real_ == 4;
        for (std::uint64_t i = 0; i < points; ++i) {
            Vec3 point = Vec3::Zero();
            for (std::int64_t k = 0; k < dimension_; ++k) {
                point[k] = scan_.real(real_, "a coordinate of a vertex");
                if (real_ == 4 && !scan_.binary()) rounded_ += has_more_digits(scan_.last_word(), point[k]) ? 1 : 0;
            }
            soup_.points.push_back(point);
            if (!scan_.binary()) soup_.point_lines.push_back(scan_.line());
            reference();
        }
    }

    // Returns whether rounding to float32 lost digits of a word: the shortest text of the float32 is another number.
    static bool has_more_digits(std::string_view word, double rounded) {
        const auto shortest = decimal(fmt::format("{}", static_cast<float>(rounded)));
        return decimal(word) != shortest && decimal(word) != rounded;
    }

    // Skips the reference of a vertex or cell, which some programs write as a real number.
    void reference() {
        if (scan_.binary())
            scan_.integer(integer_size(), "a reference");
        else
            scan_.real(8, "a reference");
    }

    void read_cells(const Keyword& keyword) {
        const std::uint64_t cells = count(keyword, keyword.corners + 1, 0);
        for (std::uint64_t i = 0; i < cells; ++i) {
            std::vector<std::size_t> face(keyword.corners);
            for (std::size_t& vertex : face) vertex = corner();
            soup_.faces.push_back(std::move(face));
            if (!scan_.binary()) soup_.face_lines.push_back(scan_.line());
            reference();
        }
    }

    void read_volumes(const Keyword& keyword) {
        const std::uint64_t cells = count(keyword, keyword.corners + 1, 0);
        std::vector<std::size_t>& corners = volumes_[keyword.corners];
        for (std::uint64_t i = 0; i < cells; ++i) {
            for (std::size_t k = 0; k < keyword.corners; ++k) corners.push_back(corner());
            reference();
        }
    }

    // Reads the number of a vertex. Number 0 becomes a very large index, which check_corners() refuses.
    std::size_t corner() {
        return static_cast<std::size_t>(scan_.integer(integer_size(), "the number of a vertex")) - 1;
    }

    void check_corners() const {
        for (std::size_t f = 0; f < soup_.faces.size(); ++f)
            check_cell(soup_.faces[f],
                       f < soup_.face_lines.size() ? fmt::format("line {}: ", soup_.face_lines[f]) : "");
        for (const auto& [size, corners] : volumes_) check_cell(corners, "in a volume cell: ");
    }

    void check_cell(const std::vector<std::size_t>& corners, const std::string& place) const {
        for (const std::size_t vertex : corners)
            if (vertex >= soup_.points.size())
                throw InputError(fmt::format("{}: {}a cell names vertex {}, but the vertices are numbered 1 to {}",
                                             name_, place, static_cast<std::int64_t>(vertex + 1), soup_.points.size()));
    }

    // Skips the numbers and quoted texts of a keyword that is ignored.
    void skip_numbers() {
        for (std::string_view word = scan_.peek(); !word.empty() && !is_keyword(word); word = scan_.peek()) {
            scan_.word();
            if (word.starts_with('"') && (word.size() == 1 || !word.ends_with('"')))
                while (!word.empty() && !word.ends_with('"')) word = scan_.word();
        }
    }

    void skip_lines(std::string_view keyword) {
        const std::uint64_t lines = scan_.count(4, keyword, 1, 1);
        scan_.rest_of_line();
        for (std::uint64_t i = 0; i < lines; ++i) scan_.rest_of_line();
    }

    [[noreturn]] void refuse_number(std::string_view word) {
        scan_.refuse(fmt::format(
            "expected a keyword, found '{}': {} has more numbers than it announces, or more in a line than the format "
            "has{}",
            shown(word), last_.empty() ? "MeshVersionFormatted" : last_,
            last_ == "Vertices" ? fmt::format(" ({} coordinates and a reference)", dimension_) : ""));
    }

    [[noreturn]] void refuse_unknown(std::string_view word) {
        for (const Keyword& keyword : keywords)
            if (lower_case(keyword.name) == lower_case(word))
                scan_.refuse(fmt::format("unknown keyword '{}': keywords are case sensitive, write '{}'", shown(word),
                                         keyword.name));
        scan_.refuse(fmt::format("unknown keyword {}: it may define a part of the surface. Remove it if it does not",
                                 scan_.binary() ? std::string(word) : fmt::format("'{}'", shown(word))));
    }

    const std::string& name_;
    Scanner scan_;
    std::int64_t version_ = 0, dimension_ = 0;
    std::size_t real_ = 8;  // bytes of a real number
    std::set<std::string_view> seen_;
    std::string_view last_;  // keyword of the last section of a text
    VolumeCells volumes_;
    std::uint64_t rounded_ = 0;  // coordinates with more digits than float32 holds
    bool ended_ = false;
    Soup soup_;
};

}  // namespace

Soup read_medit(const Input& input) { return MeditReader(input).read(input.bytes); }

}  // namespace hausbench::readers
