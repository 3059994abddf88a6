#include "harness/check/verify_exact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace hausbench {
namespace {

double down(double x) { return std::nextafter(x, -std::numeric_limits<double>::infinity()); }

}  // namespace

Checker::Checker(const Shape& source, const Shape& target, Stop stop)
    : source_(source), target_(target), stop_(std::move(stop)) {}

Verdict Checker::lower(double lower, const Witness& witness, const Pose& source_pose, const Pose& target_pose,
                       double& shown) const {
    shown = 0;
    const Standing source(source_, source_pose), target(target_, target_pose);
    const bool forward = witness.direction == Witness::Direction::source_to_target;
    const Standing &from = forward ? source : target, &to = forward ? target : source;
    const Vec3 p = forward ? witness.source_point : witness.target_point;
    const Index named = forward ? witness.source_element : witness.target_element;
    if (!to.finite()) return Verdict::not_checked;
    // How far p is from the shape that it should lie on: from the element that the witness names, else from the nearest.
    std::optional<Element> nearest_off;  // none where posing it leaves the range of doubles
    const auto off = [&](Index i) -> std::optional<Element> {
        Element corners = from[i];
        for (const Vec3& v : corners) {
            if (!v.allFinite()) return std::nullopt;
        }
        return corners;
    };
    if (named >= 0 && named < from.count()) {
        nearest_off = off(named);
    } else {
        double least = std::numeric_limits<double>::infinity();
        for (Index i = 0; i < from.count(); ++i) {
            const auto corners = off(i);
            if (!corners) continue;
            const double d = rough_offset(p, *corners).stableNorm();
            if (!nearest_off || d < least) {
                least = d;
                nearest_off = corners;
            }
        }
    }
    if (!nearest_off) return Verdict::not_checked;
    const double e = root_at_least(squared_distance(p, *nearest_off));
    if (!std::isfinite(e)) return Verdict::unsound;
    const double r = e == 0 ? lower : std::nextafter(lower + e, infinity);

    bool stopped = false;
    const std::optional<Rational> nearest = nearer_than(to, p, r, stop_, stopped);
    if (stopped) return Verdict::not_checked;
    if (!nearest) {
        shown = lower;
        return Verdict::holds;
    }
    const double distance = root_at_most(*nearest);
    shown = e == 0 ? distance : std::max(0.0, down(distance - e));
    const Rational wanted = Rational(lower) + Rational(e);
    return wanted * wanted <= *nearest ? Verdict::holds : Verdict::unsound;
}

}  // namespace hausbench
