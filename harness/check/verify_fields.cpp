#include "check/verify_fields.h"

#include "check/verify_exact.h"
#include "fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hausbench {
namespace {

constexpr std::size_t samples = 100;

// At most 100 of 0, 1, ..., count - 1, the first and the last among them.
std::vector<std::size_t> spread(std::size_t count) {
    const std::size_t n = std::min(samples, count);
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < n; ++i) out.push_back(n == 1 ? 0 : i * (count - 1) / (n - 1));
    return out;
}

struct Unsound {
    std::string reason;
};
struct Stopped {};

class FieldCheck {
public:
    FieldCheck(const Standing& source, const Standing& target, double slack, const Stop& stop)
        : source_(source), target_(target), slack_(slack), stop_(stop) {}

    void all(const Fields& fields) const {
        const Field *distance = nullptr, *nearest = nullptr;
        for (const Field& field : fields) {
            const auto due = std::size_t(field.of == Field::Of::vertices ? source_.points().rows() : source_.count());
            if (field.values.size() != due)
                throw Unsound{fmt::format("field {}: {} values for {} {}", field.name, field.values.size(), due,
                                          to_string(field.of))};
            if (field.of == Field::Of::vertices && field.name == "distance" && !distance) distance = &field;
            if (field.of == Field::Of::vertices && field.name == "nearest" && !nearest) nearest = &field;
        }
        if (!distance || !nearest) throw Unsound{"the fields distance and nearest are missing"};
        in_order(fields);
        for (std::size_t i : spread(distance->values.size())) near(i, distance->values[i], nearest->values[i]);
        for (const Field& field : fields) {
            if (field.meaning == Field::Meaning::number) continue;
            for (std::size_t i : spread(field.values.size())) bound(field, i);
        }
    }

private:
    void go_on() const {
        if (stop_ && stop_()) throw Stopped{};
    }

    Vec3 vertex(std::size_t i) const { return source_.points().row(Eigen::Index(i)).transpose(); }

    std::optional<Rational> nearer(const Vec3& p, double r) const {
        bool stopped = false;
        const auto squared = nearer_than(target_, p, r, stop_, stopped);
        if (stopped) throw Stopped{};
        return squared;
    }

    void near(std::size_t i, double distance, double nearest) const {
        go_on();
        const auto what = [&] { return fmt::format("vertex {}: distance {:.17g}", i, distance); };
        if (!(distance >= 0) || std::isinf(distance)) throw Unsound{what() + " is no distance"};
        if (!(nearest >= 0 && nearest < target_.count() && nearest == std::floor(nearest)))
            throw Unsound{fmt::format("vertex {}: nearest {} is no element of B", i, nearest)};
        const double magnitude =
            std::max(source_.points().cwiseAbs().maxCoeff(), target_.points().cwiseAbs().maxCoeff());
        const double error = field_error(magnitude);
        const Rational most = Rational(distance) + Rational(error), least = Rational(distance) - Rational(error);
        if (squared_distance(vertex(i), target_[Index(nearest)]) > most * most)
            throw Unsound{fmt::format("{}, but element {} of B, which it names, is farther", what(), nearest)};
        if (least <= 0) return;
        // Rounded up, which only makes more elements doubtful.
        const double away = std::nextafter(distance - error, std::numeric_limits<double>::infinity());
        const auto squared = nearer(vertex(i), away);
        if (squared && *squared < least * least) throw Unsound{what() + ", but an element of B is nearer"};
    }

    void in_order(const Fields& fields) const {
        for (const Field& low : fields) {
            for (const Field& high : fields) {
                if (low.meaning != Field::Meaning::lower || high.meaning != Field::Meaning::upper || low.of != high.of)
                    continue;
                for (std::size_t i = 0; i < low.values.size(); ++i) {
                    if (low.values[i] <= high.values[i] + slack_) continue;
                    throw Unsound{fmt::format("{} {}: {} {:.17g} is not at most {} {:.17g}", to_string(low.of), i,
                                              low.name, low.values[i], high.name, high.values[i])};
                }
            }
        }
    }

    Index about_nearest(const Vec3& p) const {
        Index best = 0;
        double least = std::numeric_limits<double>::infinity();
        for (Index k = 0; k < target_.count(); ++k) {
            if (target_.beyond(k, p, least)) continue;
            const double d = rough_offset(p, target_[k]).stableNorm();
            if (d < least) least = d, best = k;
        }
        return best;
    }

    void bound(const Field& field, std::size_t i) const {
        const Element corners = field.of == Field::Of::vertices ? Element{vertex(i)} : source_[Index(i)];
        const double value = field.values[i];
        const auto refuse = [&](const char* how) {
            throw Unsound{fmt::format("{} {}: {} {:.17g} is {}", to_string(field.of), i, field.name, value, how)};
        };
        if (std::isnan(value)) refuse("not a number");
        Element points = corners;
        if (corners.size() == 3) points.push_back(corners[0] / 3 + corners[1] / 3 + corners[2] / 3);
        std::optional<Rational> farthest;  // no point of the element is farther from B, squared
        for (const Vec3& p : points) {
            go_on();
            const Element b = target_[about_nearest(p)];
            if (field.meaning == Field::Meaning::upper) {
                if (!covers(value + slack_, p, corners, b)) refuse("below the distance of one of its points");
                continue;
            }
            Rational most = 0;
            for (const Vec3& corner : corners) most = std::max(most, squared_distance(corner, b));
            if (!farthest || most < *farthest) farthest = most;
        }
        const double least = value - slack_;
        if (!farthest || least <= 0) return;
        if (std::isinf(least) || Rational(least) * Rational(least) > *farthest)
            refuse("above the distance of all its points");
    }

    // Whether p, but for how far it is off the element itself, is at most so far from B.
    bool covers(double upper, const Vec3& p, const Element& corners, const Element& likely) const {
        if (std::isinf(upper)) return upper > 0;
        const double off = root_at_least(squared_distance(p, corners));
        const Rational most = Rational(upper) + Rational(off);
        if (most < 0) return false;
        if (squared_distance(p, likely) <= most * most) return true;
        return *nearer(p, std::numeric_limits<double>::infinity()) <= most * most;  // all of them, exactly
    }

    const Standing &source_, &target_;
    double slack_;  // of each bound
    const Stop& stop_;
};

}  // namespace

Verdict check_fields(const Fields& fields, const Shape& source, const Pose& source_pose, const Shape& target,
                     const Pose& target_pose, double slack, const Stop& stop, std::string& reason) {
    const Standing a(source, source_pose), b(target, target_pose);
    if (!a.finite() || !b.finite()) return Verdict::not_checked;
    try {
        FieldCheck(a, b, slack, stop).all(fields);
        return Verdict::holds;
    } catch (const Unsound& found) {
        reason = found.reason;
        return Verdict::unsound;
    } catch (const Stopped&) {
        return Verdict::not_checked;
    }
}

}  // namespace hausbench
