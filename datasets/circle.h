// Cosines and sines with the same bits on every machine, unlike those from the C library, which depend on its version
// and on the processor.
#pragma once

#include <cmath>

namespace hausbench {

// A point of the unit circle.
struct Circle {
    double cosine, sine;
};

// Returns the cosine and sine of an angle in radians, by their Taylor series. Requires |angle| <= pi / 4. The error is
// a few units in the last place.
inline Circle circle_near_zero(double angle) {
    double cosine = 1, sine = angle, term_c = 1, term_s = angle;
    for (int i = 1; i <= 10; ++i) {
        term_c = -term_c * angle * angle / ((2 * i - 1) * (2 * i));
        term_s = -term_s * angle * angle / ((2 * i) * (2 * i + 1));
        cosine += term_c;
        sine += term_s;
    }
    return {cosine, sine};
}

// Returns the point after this number of quarter turns counterclockwise.
inline Circle turned(Circle circle, int quarters) {
    for (; quarters > 0; --quarters) circle = {-circle.sine, circle.cosine};
    return circle;
}

// Returns the point at a finite angle in degrees. The error is a few units in the last place; none for multiples of 90.
inline Circle circle_at_degrees(double degrees) {
    constexpr double radians_a_degree = 0.017453292519943295;  // pi / 180, the nearest double
    const double within = std::fmod(degrees, 360.0), quarters = std::round(within / 90);
    const Circle rest = circle_near_zero((within - quarters * 90) * radians_a_degree);
    return turned(rest, (static_cast<int>(quarters) + 4) % 4);
}

}  // namespace hausbench
