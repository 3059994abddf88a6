// A batch of pieces of A that are covered together. They share their corners and the triangles of B near them.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/splitmix.h"
#include "algorithms/meshes/cover/worker.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

namespace hausbench {

// The corners of a batch of pieces. A corner that several pieces share is stored once.
struct CoverBatch {
    static constexpr std::size_t most_pieces = 8;

    std::array<Vec3, 3 * most_pieces> corner;
    std::array<std::array<std::size_t, 3>, most_pieces> of_piece;  // the corners of each piece, as indices
    CoverPoints<float> points;                                     // all corners in local coordinates
    LocalUnits place;                                              // the local coordinates
    Vec3 centre;                                                   // the origin of the local coordinates
    double radius = 0;                                             // largest distance of a corner from `centre`

    CoverBatch(std::span<const CoverPiece> pieces, double magnitude) {
        Box box;
        std::array<std::uint8_t, slots> number{};  // a hash table: 1 + the index of a corner; 0: empty slot
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3& at = pieces[i].corners[k];
                std::size_t slot = slot_of(at);
                while (number[slot] != 0 && corner[number[slot] - 1U] != at) slot = (slot + 1) % slots;
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

private:
    static constexpr std::size_t slots = 64;  // of the hash table: more than twice the number of corners

    // Returns a hash of the bits of a point.
    static std::size_t slot_of(const Vec3& at) {
        std::uint64_t mixed = 0;
        for (const double x : at) mixed = (mixed ^ std::bit_cast<std::uint64_t>(x)) * golden_step;
        return mixed >> 58;
    }
};

}  // namespace hausbench
