#include "near_grid.h"

#include "rounding.h"

#include <cmath>
#include <cstdlib>

namespace hausbench {
namespace {

// Where the nearest occupied cell is; empty where none is known yet.
struct Place {
    std::int16_t x = -1, y = -1, z = -1;
    bool empty() const { return x < 0; }
};

int squared(const Place& p, int x, int y, int z) {
    return (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y) + (p.z - z) * (p.z - z);
}

}  // namespace

NearGrid::NearGrid(const Points& points, const Box& box) {
    const Vec3 width = box.high - box.low;
    const double longest = width.maxCoeff();
    const double most = static_cast<double>(std::clamp<Eigen::Index>(points.rows() / 8, 1, Eigen::Index{1} << 16));
    for (int k = 0; k < 3; ++k) low_[k] = box.low[k];
    if (longest > 0x1p-900) {
        // As many cells along the longest axis as the total allows.
        for (int along = 1024; along >= 1; along = along * 7 / 8) {
            int size[3];
            double total = 1;
            for (int k = 0; k < 3; ++k) total *= size[k] = 1 + static_cast<int>(along * (width[k] / longest));
            if (total > most && along > 1) continue;
            cells_per_length_ = along / longest;
            for (int k = 0; k < 3; ++k) size_[k] = size[k];
            break;
        }
    }
    for (int k = 0; k < 3; ++k) last_[k] = size_[k] - 1;
    guesses_.assign(
        static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) * static_cast<std::size_t>(size_[2]),
        {{0, 0, 0}, -1});
    for (Index i = 0; i < points.rows(); ++i) {
        const double* p = points.row(i).data();
        guesses_[cell_of(p)] = {{p[0], p[1], p[2]}, i};
    }

    std::vector<Place> places(guesses_.size());
    const auto at = [&](int x, int y, int z) { return static_cast<std::size_t>(x + size_[0] * (y + size_[1] * z)); };
    const auto sweep = [&](bool forward) {
        const int step = forward ? 1 : -1;
        for (int k = 0; k < size_[2]; ++k) {
            const int z = forward ? k : size_[2] - 1 - k;
            for (int j = 0; j < size_[1]; ++j) {
                const int y = forward ? j : size_[1] - 1 - j;
                for (int i = 0; i < size_[0]; ++i) {
                    const int x = forward ? i : size_[0] - 1 - i;
                    Place& here = places[at(x, y, z)];
                    if (guesses_[at(x, y, z)].row >= 0) {
                        here = {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y),
                                static_cast<std::int16_t>(z)};
                        continue;
                    }
                    const auto take = [&](int u, int v, int w) {
                        const Place& other = places[at(u, v, w)];
                        if (!other.empty() && (here.empty() || squared(other, x, y, z) < squared(here, x, y, z)))
                            here = other;
                    };
                    if (i > 0) take(x - step, y, z);
                    if (j > 0) take(x, y - step, z);
                    if (k > 0) take(x, y, z - step);
                }
            }
        }
    };
    // A third sweep reaches cells that only the second could bring news to.
    sweep(true);
    sweep(false);
    sweep(true);
    Guess any{};
    for (const Guess& guess : guesses_) {
        if (guess.row >= 0) any = guess;
    }
    for (std::size_t c = 0; c < guesses_.size(); ++c) {
        if (guesses_[c].row < 0)
            guesses_[c] = places[c].empty() ? any : guesses_[at(places[c].x, places[c].y, places[c].z)];
    }
}

std::size_t NearGrid::mark(const double* point, double radius, std::vector<std::uint8_t>& flags) const {
    int from[3], to[3];
    for (int k = 0; k < 3; ++k) {
        from[k] = cell(next_down(point[k] - radius), k);
        to[k] = cell(next_up(point[k] + radius), k);
    }
    for (int z = from[2]; z <= to[2]; ++z) {
        for (int y = from[1]; y <= to[1]; ++y) {
            std::uint8_t* row = flags.data() + static_cast<std::size_t>(size_[0] * (y + size_[1] * z));
            std::fill(row + from[0], row + to[0] + 1, std::uint8_t{1});
        }
    }
    return static_cast<std::size_t>(to[0] - from[0] + 1) * static_cast<std::size_t>(to[1] - from[1] + 1) *
           static_cast<std::size_t>(to[2] - from[2] + 1);
}

}  // namespace hausbench
