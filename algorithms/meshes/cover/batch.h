// Collects the corners of neighbouring pieces of A without duplicates, so that the distances of each corner to B are
// computed once.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/splitmix.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/cover/work.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

namespace hausbench::cover {

// The corners of up to eight pieces (triangles of A or parts of one). Corners that pieces share are stored once.
struct Batch {
    static constexpr std::size_t most_pieces = 8;

    std::array<Vec3, 3 * most_pieces> corner;
    std::array<std::array<std::size_t, 3>, most_pieces> of_piece;  // for each piece, indices into `corner`
    LocalPoints<float> points;                                     // the corners in local coordinates
    LocalUnits place;
    Vec3 centre;        // the origin of the local coordinates
    double radius = 0;  // the largest distance from `centre` to a corner

    Batch(std::span<const Piece> pieces, double magnitude) {
        Box box;
        std::array<std::uint8_t, slots> number{};  // a hash table: 1 + the index of a corner; 0: empty slot
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3& at = pieces[i].corners[k];
                std::size_t slot = slot_of(at);
                while (number[slot] != 0 && !same(corner[number[slot] - 1U], at)) slot = (slot + 1) % slots;
                if (number[slot] == 0) {
                    corner[points.count++] = at;
                    number[slot] = static_cast<std::uint8_t>(points.count);
                    box.add(at);
                }
                of_piece[i][k] = number[slot] - 1U;
            }
        }
        place.set(box, magnitude * least_place);
        centre = Vec3(place.origin[0], place.origin[1], place.origin[2]);
        for (std::size_t i = 0; i < points.count; ++i) {
            const Vec3 local = corner[i] - centre;
            radius = std::max(radius, squared_length(local));
            points.x[i] = static_cast<float>(local[0] * place.inverse);
            points.y[i] = static_cast<float>(local[1] * place.inverse);
            points.z[i] = static_cast<float>(local[2] * place.inverse);
        }
        radius = std::sqrt(radius);
    }

    // Returns an upper bound on the length of any point of the pieces, and of the corners of cuts, in local coordinates
    // (OffsetCover::extent). With u = 2^-24, rounding to float moves a point by at most u * radius. A new corner is off by
    // at most 5u * radius, and slack allows a chain of at most 36 cuts (OffsetCover::most_slack): 181u < 2^-16 in all.
    double extent() const {
        return WATCHED_ELSE("offset cover: the extent of a batch", radius, 0.5 * radius) * place.inverse *
               (1 + WATCHED("offset cover: rounding in the extent of a batch", 0x1p-10));
    }

private:
    static constexpr std::size_t slots = 64;  // of the hash table; there are at most 24 corners

    // Returns the slot at which to begin the search for a point: six bits of a hash of its coordinates.
    static std::size_t slot_of(const Vec3& at) {
        const std::uint64_t mixed = bits(at[0]) ^ std::rotl(bits(at[1]), 21) ^ std::rotl(bits(at[2]), 42);
        return mixed * golden_step >> 58;
    }
    // Compares bits, which is faster. So 0 and -0 differ: then a corner is stored twice.
    static bool same(const Vec3& a, const Vec3& b) {
        return ((bits(a[0]) ^ bits(b[0])) | (bits(a[1]) ^ bits(b[1])) | (bits(a[2]) ^ bits(b[2]))) == 0;
    }
    static std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }
};

}  // namespace hausbench::cover
