// Reads and cuts polygons for the certificate checker (docs/certificate.md). Their corners are intervals. The caller
// must set the rounding mode to upward, because only then do CGAL's intervals round outward.
#pragma once

#ifndef __ROUNDING_MATH__
#error \
    "certificate_tree.h: compile with -frounding-math: without it the compiler may move arithmetic across a change of the rounding mode"
#endif

#include "algorithms/kernel/watched.h"

#include <CGAL/Interval_nt.h>

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

namespace hausbench::certificate {

using Interval = CGAL::Interval_nt<false>;

// Limits on the checker's memory: the corners of a polygon, and the polygons whose nodes have not been read yet.
inline constexpr std::size_t most_corners = 64, most_pending = 4096;

// Thrown for an invalid certificate. The message becomes CertificateCheck::refusal.
struct Refused : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// --- the bytes --------------------------------------------------------------------------------------------------------

// Reads the bytes of a certificate in order. Throws Refused if they are malformed or end too early.
class Reader {
public:
    explicit Reader(const std::string& bytes) : bytes_(bytes) {}

    bool at_end() const { return at_ == bytes_.size(); }

    // Reads an integer with seven bits per byte, lowest bits first. Throws Refused if it takes more bytes than
    // necessary, so that each integer has only one encoding.
    std::uint64_t number() {
        std::uint64_t value = 0;
        for (int shift = 0; shift < WATCHED_ELSE("certificates: numbers of too many bits", 63, 700); shift += 7) {
            const std::uint64_t byte = next();
            value |= (byte & 0x7f) << shift;
            if (byte < 0x80) {
                if (WATCHED("certificates: numbers in as few bytes as they take", byte == 0 && shift > 0))
                    throw Refused("a number is not written in as few bytes as it takes");
                return value;
            }
        }
        throw Refused("a number has more than 63 bits");
    }

    // Reads a double in [0, 1] from eight bytes, lowest byte first.
    double parameter() {
        std::uint64_t bits = 0;
        for (int shift = 0; shift < 64; shift += 8) bits |= next() << shift;
        // Compares the bits as integers. Negative numbers, -0 and NaN have larger bits than 1, so one comparison
        // refuses them all.
        if (WATCHED("certificates: t between 0 and 1", bits > std::bit_cast<std::uint64_t>(1.0)))
            throw Refused("a cut is not between the ends of its edge");
        return std::bit_cast<double>(bits);
    }

private:
    std::uint64_t next() {
        return at_end()
                   ? WATCHED_ELSE("certificates: the end of the bytes", throw Refused("the certificate ends here"), 1U)
                   : static_cast<unsigned char>(bytes_[at_++]);
    }

    const std::string& bytes_;
    std::size_t at_ = 0;
};

// --- polygons of a triangle of A ----------------------------------------------------------------------------------------

// The point a + v * (b - a) + w * (c - a) of a triangle with corners a, b, c. The intervals contain the exact v and w.
struct Corner {
    Interval v, w;
};

// Returns a + t * (b - a), computed as (1 - t) * a + t * b. In this form a and b occur once each, so repeated cuts
// widen the intervals only by rounding.
inline Corner between(const Corner& a, const Corner& b, double t) {
    const Interval to(t), from = WATCHED_ELSE("certificates: 1 - t is an interval", Interval(1) - to, Interval(1 - t));
    return {from * a.v + to * b.v, from * a.w + to * b.w};
}

// A convex polygon within a triangle of A.
struct Polygon {
    std::size_t count = 0;
    std::array<Corner, most_corners> corners;

    void add(const Corner& corner) {
        if (WATCHED("certificates: corners of a polygon", count == most_corners))
            throw Refused(fmt::format("a polygon has more than {} corners", most_corners));
        corners[count++] = corner;
    }
};

// An end of a cut on the boundary of a polygon: a corner, or a point on an edge. `place` numbers corners and edges
// together around the polygon: corner i has place 2 * i, and the edge from corner i to the next corner has place
// 2 * i + 1. A point on an edge lies at the fraction `t` of the edge, measured from the edge's end if `backward`.
struct Meeting {
    std::size_t place = 0;
    bool backward = false;
    double t = 0;

    bool on_edge() const { return place % 2 == 1; }
};

// Decodes the eight bits that describe one end of a cut. If this end is on an edge, the caller then reads `t`.
inline Meeting read_meeting(std::uint64_t bits, std::size_t corners) {
    const bool corner = bits & 1;
    const std::size_t i = bits >> 2;
    if (WATCHED("certificates: a cut names a corner that is there", i >= corners))
        throw Refused(fmt::format("a cut names {} {} of {}", corner ? "corner" : "edge", i, corners));
    if (corner && (bits & 2)) throw Refused("a cut at a corner has a direction");
    return {2 * i + !corner, (bits & 2) != 0, 0};
}

inline Corner point_at(const Polygon& polygon, const Meeting& meeting) {
    const std::size_t i = meeting.place / 2, next = (i + 1) % polygon.count;
    if (!meeting.on_edge()) return polygon.corners[i];
    return between(
        polygon.corners[WATCHED("certificates: a point that is measured backward", meeting.backward) ? next : i],
        polygon.corners[meeting.backward ? i : next], meeting.t);
}

// Returns the part of a polygon on one side of a cut. Its corners are `first`, then all corners of `whole` between the
// places `from` and `to`, then `last`.
inline Polygon part(const Polygon& whole, const Meeting& from, const Meeting& to, const Corner& first,
                    const Corner& last) {
    const std::size_t places = 2 * whole.count;
    Polygon child;
    child.add(first);
    for (std::size_t place = (from.place + 1) % places; place != to.place; place = (place + 1) % places) {
        if (WATCHED("certificates: the corners between the ends of a cut", place % 2 == 0))
            child.add(whole.corners[place / 2]);
    }
    child.add(last);
    if (WATCHED("certificates: a child is a polygon", child.count < 3)) throw Refused("a cut runs along an edge");
    return child;
}

// Cuts a polygon along the segment from p to q. Returns the two parts in the order of the certificate.
inline std::pair<Polygon, Polygon> cut(const Polygon& whole, const Meeting& p, const Meeting& q) {
    if (WATCHED("certificates: P and Q are two places", p.place == q.place))
        throw Refused("a cut begins and ends at one corner or edge");
    const Corner at_p = point_at(whole, p), at_q = point_at(whole, q);
    return {part(whole, p, q, at_p, at_q), part(whole, q, p, at_q, at_p)};
}

}  // namespace hausbench::certificate
