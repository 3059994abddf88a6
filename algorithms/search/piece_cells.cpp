#include "algorithms/search/piece_cells.h"

#include "algorithms/kernel/watched.h"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace hausbench {
namespace {

using Kind = PieceArgument::Kind;
using Polygon = std::vector<Vec3>;

// Returns the fraction along an edge at which a linear function is 0, given its values at the ends, which have opposite
// signs. Never returns -0, because the fractions in a certificate have no sign.
double zero_between(double from, double to) { return std::abs(from) / (std::abs(from) + std::abs(to)); }

// The line on which a linear function is 0 in a polygon, given by the two points where it meets the boundary.
struct Chord {
    std::size_t into, out_of;   // going around: the edges where the function turns positive, and where it ceases to be
    double into_at, out_of_at;  // how far along these edges, in [0, 1]
};

// Returns the line on which a linear function is 0, given its values at the corners of a polygon. Returns nothing if
// the function does not change sign.
std::optional<Chord> chord_of(const std::vector<double>& values) {
    std::optional<std::size_t> into, out_of;
    const auto next = [&](std::size_t i) { return (i + 1) % values.size(); };
    for (std::size_t i = 0; i < values.size(); ++i) {
        const bool here = values[i] > 0, there = values[next(i)] > 0;
        if (!here && there && !into) into = i;
        if (here && !there && !out_of) out_of = i;
    }
    if (!into || !out_of) return std::nullopt;
    return Chord{*into, *out_of, zero_between(values[*into], values[next(*into)]),
                 zero_between(values[*out_of], values[next(*out_of)])};
}

// Writes the cut of a polygon along a chord. The first child is the part where the linear function is positive.
void write(CertificateTree& tree, const Chord& chord) {
    tree.cut(CutPoint::along(chord.into, chord.into_at), CutPoint::along(chord.out_of, chord.out_of_at));
}

// --- a cell for each corner (u2) -------------------------------------------------------------------------------------

// The two parts of a polygon that was cut along the line on which a linear function is 0.
struct Halves {
    Polygon positive, other;  // the part where the function is positive, and the rest
};

Halves cut(const Polygon& whole, const Chord& chord) {
    const std::size_t n = whole.size();
    const auto at = [&](std::size_t edge, double t) { return Vec3((1 - t) * whole[edge] + t * whole[(edge + 1) % n]); };
    const Vec3 p = at(chord.into, chord.into_at), q = at(chord.out_of, chord.out_of_at);
    const auto part = [&](const Vec3& first, std::size_t from, std::size_t to, const Vec3& last) {
        Polygon polygon = {first};
        for (std::size_t i = from; i != to; i = (i + 1) % n) polygon.push_back(whole[(i + 1) % n]);
        polygon.push_back(last);
        return polygon;
    };
    return {part(p, chord.into, chord.out_of, q), part(q, chord.out_of, chord.into, p)};
}

// A corner of the piece, and the triangle of B nearest to it.
struct Site {
    Vec3 point;
    Index triangle;
};

// Cuts a polygon into cells, each with the points nearest to one site, and writes them. `sites` must include every site
// that is nearest to some point of the polygon.
void write_nearest(CertificateTree& tree, const Polygon& polygon, const std::vector<Site>& sites) {
    if (sites.size() == 1) return tree.one(sites[0].triangle);
    const Vec3 &a = sites[0].point, &b = sites[1].point, way = b - a;
    std::vector<double> nearer;  // positive: a is nearer
    for (const Vec3& x : polygon) nearer.push_back(0.5 * dot(way, way) - dot(x - a, way));
    std::vector<Site> without_a(sites.begin() + 1, sites.end()), without_b = sites;
    without_b.erase(without_b.begin() + 1);
    const auto chord = chord_of(nearer);
    if (!chord) return write_nearest(tree, polygon, nearer[0] > 0 ? without_b : without_a);
    write(tree, *chord);
    const Halves halves = cut(polygon, *chord);
    write_nearest(tree, halves.positive,
                  WATCHED_ELSE("proofs: the cells of the points nearest to a corner", without_b, without_a));
    write_nearest(tree, halves.other, without_a);
}

void write_nearest_corner(CertificateTree& tree, const PieceCorners& v, PieceTurn turn) {
    Polygon polygon(3);
    std::vector<Site> sites;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 place = v[i].point - v[0].point;
        polygon[turn.place(i)] = place;
        sites.push_back({place, v[i].triangle});
    }
    write_nearest(tree, polygon, sites);
}

// --- the other kinds of cells ----------------------------------------------------------------------------------------

// Writes the cut across the two edges at corner `alone`. The first child holds the other two corners.
void write_corner_cut_off(CertificateTree& tree, const PieceArgument& argument, const PieceCorners& v, PieceTurn turn) {
    const auto& [at_corner, at_next, at_last] = argument.ends;
    tree.cut(CutPoint::along(turn.place(argument.alone), zero_between(at_corner, at_next)),
             WATCHED_ELSE("proofs: a corner that is cut off", CutPoint::back, CutPoint::along)(
                 turn.place(argument.alone + 2), zero_between(at_corner, at_last)));
    tree.one(v[WATCHED_ELSE("proofs: the two triangles of a corner that is cut off", (argument.alone + 1) % 3,
                            argument.alone)]
                 .triangle);
    tree.one(v[argument.alone].triangle);
}

// Cuts first along the median from the midpoint of edge 01 to corner 2. The barycentre is a third of the way along it.
void write_three(CertificateTree& tree, const PieceCorners& v, PieceTurn turn) {
    constexpr double third = 1.0 / 3;
    tree.cut(CutPoint::along(turn.place(0), 0.5), CutPoint::corner(turn.place(2)));
    // Cuts the first child, whose corners are the midpoint of edge 01, corner 1 and corner 2.
    tree.cut(CutPoint::along(1, 0.5), CutPoint::back(2, third));
    tree.one(v[2].triangle);
    tree.one(v[1].triangle);
    // Cuts the second child, whose corners are corner 2, corner 0 and the midpoint of edge 01.
    tree.cut(CutPoint::along(0, 0.5), CutPoint::along(2, third));
    tree.one(v[WATCHED_ELSE("proofs: three quadrilaterals", 0, 1)].triangle);
    tree.one(v[2].triangle);
}

void write_nearest_foot(CertificateTree& tree, const PieceArgument& argument, const PieceCorners& v, PieceTurn turn) {
    std::vector<double> nearer(3);
    for (std::size_t i = 0; i < 3; ++i) nearer[turn.place(i)] = argument.nearer[i];
    const Index first = v[argument.feet[0]].triangle, second = v[argument.feet[1]].triangle;
    const auto chord = chord_of(nearer);
    if (!chord) return tree.one(nearer[0] > 0 ? second : first);
    write(tree, *chord);
    tree.one(WATCHED_ELSE("proofs: the cells of two closest points", second, first));
    tree.one(WATCHED_ELSE("proofs: the cells of two closest points", first, second));
}

}  // namespace

void write_cells(CertificateTree& tree, const PieceArgument& argument, const PieceCorners& corners, PieceTurn turn) {
    if (argument.kind == Kind::whole_piece) tree.one(argument.near);
    if (argument.kind == Kind::nearest_corner) write_nearest_corner(tree, corners, turn);
    if (argument.kind == Kind::corner_cut_off) write_corner_cut_off(tree, argument, corners, turn);
    if (argument.kind == Kind::three) write_three(tree, corners, turn);
    if (argument.kind == Kind::nearest_foot) write_nearest_foot(tree, argument, corners, turn);
}

}  // namespace hausbench
