// The trees of cuts in a certificate (docs/certificate.md), for the checker: a reader of the bytes, polygons whose
// corners are intervals, and the cuts of polygons. CGAL's intervals round outward only while the rounding mode is
// upward; the caller must set it.
#pragma once

#ifndef __ROUNDING_MATH__
#error \
    "certificate_tree.h: compile with -frounding-math: without it the compiler may move arithmetic across a change of the rounding mode"
#endif

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

// The most corners of a polygon, and the most polygons that may wait for their nodes at the same time.
inline constexpr std::size_t most_corners = 64, most_pending = 4096;

// An error in a certificate; its text goes into CertificateCheck::refusal.
struct Refused : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// --- the bytes --------------------------------------------------------------------------------------------------------

// Reads the bytes of a certificate from first to last. Throws Refused if they are malformed or end too early.
class Reader {
public:
    explicit Reader(const std::string& bytes) : bytes_(bytes) {}

    bool at_end() const { return at_ == bytes_.size(); }

    // Reads a number: seven bits per byte, lowest first, in as few bytes as possible, so that no number can be
    // written in two ways.
    std::uint64_t number() {
        std::uint64_t value = 0;
        for (int shift = 0; shift < 63; shift += 7) {
            const std::uint64_t byte = next();
            value |= (byte & 0x7f) << shift;
            if (byte < 0x80) {
                if (byte == 0 && shift > 0) throw Refused("a number is not written in as few bytes as it takes");
                return value;
            }
        }
        throw Refused("a number has more than 63 bits");
    }

    // Reads a double in [0, 1]: eight bytes, lowest first.
    double parameter() {
        std::uint64_t bits = 0;
        for (int shift = 0; shift < 64; shift += 8) bits |= next() << shift;
        // As integers, the bits of negative numbers, of -0 and of NaN are above the bits of 1, so one comparison
        // refuses them.
        if (bits > std::bit_cast<std::uint64_t>(1.0)) throw Refused("a cut is not between the ends of its edge");
        return std::bit_cast<double>(bits);
    }

private:
    std::uint64_t next() {
        if (at_end()) throw Refused("the certificate ends here");
        return static_cast<unsigned char>(bytes_[at_++]);
    }

    const std::string& bytes_;
    std::size_t at_ = 0;
};

// --- polygons of a triangle of A ----------------------------------------------------------------------------------------

// The point a + v * (b - a) + w * (c - a) of a triangle abc of A. The intervals contain the exact v and w.
struct Corner {
    Interval v, w;
};

// Returns a + t * (b - a). Computes it as (1 - t) * a + t * b, so that intervals grow from cut to cut only by rounding.
inline Corner between(const Corner& a, const Corner& b, double t) {
    const Interval to(t), from = Interval(1) - to;
    return {from * a.v + to * b.v, from * a.w + to * b.w};
}

// A convex part of a triangle of A, given by its corners.
struct Polygon {
    std::size_t count = 0;
    std::array<Corner, most_corners> corners;

    void add(const Corner& corner) {
        if (count == most_corners) throw Refused(fmt::format("a polygon has more than {} corners", most_corners));
        corners[count++] = corner;
    }
};

// The point at which a cut meets the boundary of a polygon of n corners: a corner, or a point of an edge. `place`
// numbers the corners and edges as they follow each other around the polygon, from 0 to 2n - 1: corner i has the place
// 2i, and edge i, from corner i to the next corner, the place 2i + 1. On an edge, the point is the fraction t of the
// way along the edge, or along the reversed edge if `backward`.
struct Meeting {
    std::size_t place = 0;
    bool backward = false;
    double t = 0;

    bool on_edge() const { return place % 2 == 1; }
};

// Decodes the eight bits of a meeting. If the meeting is on an edge, the caller then reads its t.
inline Meeting read_meeting(std::uint64_t bits, std::size_t corners) {
    const bool corner = bits & 1;
    const std::size_t i = bits >> 2;
    if (i >= corners) throw Refused(fmt::format("a cut names {} {} of {}", corner ? "corner" : "edge", i, corners));
    if (corner && (bits & 2)) throw Refused("a cut at a corner has a direction");
    return {2 * i + !corner, (bits & 2) != 0, 0};
}

inline Corner point_at(const Polygon& polygon, const Meeting& meeting) {
    const std::size_t i = meeting.place / 2, next = (i + 1) % polygon.count;
    if (!meeting.on_edge()) return polygon.corners[i];
    return between(polygon.corners[meeting.backward ? next : i], polygon.corners[meeting.backward ? i : next],
                   meeting.t);
}

// Returns the part of a polygon on one side of a cut. Its corners are the point `first` at the place `from`, the
// corners with places after `from` and before `to`, and the point `last` at the place `to`.
inline Polygon part(const Polygon& whole, const Meeting& from, const Meeting& to, const Corner& first,
                    const Corner& last) {
    const std::size_t places = 2 * whole.count;
    Polygon child;
    child.add(first);
    for (std::size_t place = (from.place + 1) % places; place != to.place; place = (place + 1) % places) {
        if (place % 2 == 0) child.add(whole.corners[place / 2]);
    }
    child.add(last);
    if (child.count < 3) throw Refused("a cut runs along an edge");
    return child;
}

// Cuts a polygon from p to q. Returns the two children of the node, in their order.
inline std::pair<Polygon, Polygon> cut(const Polygon& whole, const Meeting& p, const Meeting& q) {
    if (p.place == q.place) throw Refused("a cut begins and ends at one corner or edge");
    const Corner at_p = point_at(whole, p), at_q = point_at(whole, q);
    return {part(whole, p, q, at_p, at_q), part(whole, q, p, at_q, at_p)};
}

}  // namespace hausbench::certificate
