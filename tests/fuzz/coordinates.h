// Makes difficult coordinates from bytes: on small grids, one ulp from an earlier point, on the line
// or in the plane of earlier points, far away, or doubles of moderate exponent.
#pragma once

#include "tests/fuzz/target.h"

#include "algorithms/kernel/geometry.h"

#include <bit>
#include <cmath>
#include <vector>

namespace hausbench::fuzz {

class Coordinates {
public:
    explicit Coordinates(Bytes& in) : in_(in) {}

    // Makes a point and remembers it, so that later points can depend on it.
    Vec3 point() {
        made_.push_back(made_.empty() ? fresh() : any());
        return made_.back();
    }

private:
    double grid() { return (static_cast<int>(in_.byte()) - 128) / 8.0; }

    // Makes a number with any mantissa and an exponent from -64 to 63.
    double wide() {
        const auto bits = in_.next<std::uint64_t>();
        const int exponent = static_cast<int>(bits >> 52 & 0x7f) - 64;
        const double mantissa = std::bit_cast<double>((bits & 0x800fffffffffffff) | 0x3ff0000000000000);
        return std::ldexp(mantissa, exponent);
    }

    Vec3 fresh() {
        const double x = grid(), y = grid(), z = grid();
        return {x, y, z};
    }
    const Vec3& earlier() { return made_[in_.byte() % made_.size()]; }

    Vec3 any() {
        switch (in_.below(10)) {
            case 0:
            case 1:
            case 2:
                return fresh();
            case 3: {
                const double x = wide(), y = wide(), z = wide();
                return {x, y, z};
            }
            case 4:
                return earlier();
            case 5: {  // within an ulp of an earlier point
                Vec3 point = earlier();
                const std::uint32_t ways = in_.byte();
                for (int k = 0; k < 3; ++k)
                    if (const auto way = ways >> 2 * k & 3; way != 0)
                        point[k] = std::nextafter(point[k], way == 1 ? -1e300 : 1e300);
                return point;
            }
            case 6: {  // on the line through two points
                const Vec3 a = earlier(), b = earlier();
                return a + grid() / 8 * (b - a);
            }
            case 7: {  // in the plane of three points
                const Vec3 a = earlier(), b = earlier(), c = earlier();
                const double s = grid() / 8, t = grid() / 8;
                return a + s * (b - a) + t * (c - a);
            }
            case 8: {  // very near an earlier point
                const Vec3 a = earlier();
                const double size = std::ldexp(1.0, -static_cast<int>(in_.below(60)));
                return a + size * fresh();
            }
            default: {  // far away
                const double size = std::ldexp(1.0, static_cast<int>(in_.below(45)));
                return size * fresh();
            }
        }
    }

    Bytes& in_;
    std::vector<Vec3> made_;
};

}  // namespace hausbench::fuzz
