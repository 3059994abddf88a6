#include "harness/check/verify_fields.h"

#include "algorithms/kernel/watched.h"
#include "harness/ask/fields.h"
#include "harness/check/verify_exact.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>

namespace hausbench {
namespace {

constexpr std::size_t samples = 100;

// Returns at most 100 indices from 0 to count - 1, evenly spread, including the first and the last.
std::vector<std::size_t> spread(std::size_t count) {
    const std::size_t n = std::min(samples, count);
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < n; ++i) out.push_back(n == 1 ? 0 : i * (count - 1) / (n - 1));
    return out;
}

// Exceptions that end the check: a field is unsound, or `stop` returned true.
struct Unsound {
    std::string reason;
};
struct Stopped {};

const Field* first(const Fields& fields, Field::Of of, std::string_view name) {
    const auto at =
        std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.of == of && f.name == name; });
    return at == fields.end() ? nullptr : &*at;
}

// The shape A after cutting: the fields x, y, z contain its vertices, and a, b, c, element its pieces. Without these
// fields, A was not cut.
class DrawnShape {
public:
    DrawnShape(const Fields& fields, const Standing& source, double error) : source_(source), error_(error) {
        const double largest = source.points().cwiseAbs().maxCoeff();
        exponent_ = largest > 0 ? std::ilogb(largest) + 1 : 0;
        constexpr std::string_view of_vertices[] = {"x", "y", "z"}, of_pieces[] = {"a", "b", "c", "element"};
        for (int k = 0; k < 3; ++k) places_[k] = first(fields, Field::Of::vertices, of_vertices[k]);
        for (int k = 0; k < 4; ++k) pieces_[k] = first(fields, Field::Of::pieces, of_pieces[k]);
        const auto missing = [](const Field* field) { return field == nullptr; };
        moved_ = std::none_of(std::begin(places_), std::end(places_), missing);
        cut_ = moved_ && std::none_of(std::begin(pieces_), std::end(pieces_), missing);
    }

    // Returns whether the field must also have values for the vertices that cuts added.
    bool has(const Field& field) const {
        return moved_ && field.of == Field::Of::vertices &&
               (field.name == "distance" || field.name == "nearest" ||
                std::find(std::begin(places_), std::end(places_), &field) != std::end(places_));
    }
    std::size_t vertices() const { return moved_ ? places_[0]->values.size() : own_vertices(); }
    std::size_t own_vertices() const { return std::size_t(source_.points().rows()); }
    std::size_t pieces() const { return cut_ ? pieces_[0]->values.size() : 0; }
    Vec3 vertex(std::size_t i) const {
        if (!moved_) return source_.points().row(Eigen::Index(i)).transpose();
        return {places_[0]->values[i], places_[1]->values[i], places_[2]->values[i]};
    }

    // Checks vertices and pieces. Requires that every field has the right number of values.
    void check() const {
        if (vertices() > own_vertices() && !cut_) throw Unsound{"vertices were added, but there are no pieces"};
        const Vec3 low = source_.points().colwise().minCoeff().transpose();
        const Vec3 high = source_.points().colwise().maxCoeff().transpose();
        for (std::size_t i = 0; i < vertices(); ++i) {
            const Vec3 p = vertex(i);
            if (WATCHED("verify: the vertices of A come first", i < own_vertices()) &&
                p != Vec3(source_.points().row(Eigen::Index(i))))
                throw Unsound{fmt::format("vertex {} is not where A has it", i)};
            for (int k = 0; k < 3; ++k) {
                if (!(p[k] >= low[k] - 2 * error_ && p[k] <= high[k] + 2 * error_))  // also if p is NaN
                    throw Unsound{fmt::format("vertex {} is not on A", i)};
            }
        }
        if (!cut_) return;
        std::vector<double> areas(std::size_t(source_.count())), rough(areas.size());
        for (std::size_t i = 0; i < pieces(); ++i) {
            const std::size_t element = index(3, i, areas.size());
            const Element corners{vertex(index(0, i, vertices())), vertex(index(1, i, vertices())),
                                  vertex(index(2, i, vertices()))};
            areas[element] += area(corners);
            rough[element] += rounding_of(corners);
        }
        for (std::size_t i : spread(pieces())) near_its_triangle(i);
        for (std::size_t t = 0; t < areas.size(); ++t) {
            const Element whole = source_[Index(t)];
            const double off = std::abs(areas[t] - area(whole));
            if (WATCHED("verify: pieces cover their triangle",
                        !(off <= rough[t] + rounding_of(whole) + 1e-12 * area(whole))))
                throw Unsound{fmt::format("element {}: its pieces have {:.9g} of its area", t, areas[t] / area(whole))};
        }
    }

private:
    std::size_t index(int column, std::size_t piece, std::size_t count) const {
        const double value = pieces_[column]->values[piece];
        if (!(value >= 0 && value < double(count) && value == std::floor(value)))
            throw Unsound{fmt::format("piece {}: {} {} is out of range", piece, pieces_[column]->name, value)};
        return std::size_t(value);
    }

    void near_its_triangle(std::size_t piece) const {
        const Element whole = source_[Index(index(3, piece, std::size_t(source_.count())))];
        const Rational most = Rational(2) * Rational(error_);
        for (int k = 0; k < 3; ++k) {
            if (WATCHED("verify: pieces are on their triangle",
                        squared_distance(vertex(index(k, piece, vertices())), whole) > most * most))
                throw Unsound{fmt::format("piece {} is not on its element", piece)};
        }
    }

    // Returns side k of a triangle as a vector, divided by 2^exponent_ so that its square neither overflows nor
    // underflows.
    Vec3 side(const Element& e, int k) const {
        const auto scaled = [&](const Vec3& p) -> Vec3 {
            return p.unaryExpr([&](double x) { return std::ldexp(x, -exponent_); });
        };
        return scaled(e[std::size_t((k + 1) % 3)]) - scaled(e[std::size_t(k)]);
    }

    double area(const Element& e) const { return e.size() < 3 ? 0 : side(e, 0).cross(side(e, 2)).norm() / 2; }

    // Returns the allowed error of the triangle's area if each corner may be off by 2 * error_.
    double rounding_of(const Element& e) const {
        if (e.size() < 3) return 0;
        const double error = std::ldexp(error_, -exponent_);
        return 4 * error * (side(e, 0).norm() + side(e, 1).norm() + side(e, 2).norm() + error);
    }

    const Standing& source_;
    double error_;
    int exponent_;  // of the largest coordinate of A
    const Field* places_[3];
    const Field* pieces_[4];
    bool moved_, cut_;  // whether the fields x, y, z exist, and whether also a, b, c, element do
};

class FieldCheck {
public:
    FieldCheck(const Standing& source, const Standing& target, double slack, const Stop& stop)
        : source_(source), target_(target), slack_(slack), stop_(stop) {}

    void all(const Fields& fields) const {
        const Field* distance = first(fields, Field::Of::vertices, "distance");
        const Field* nearest = first(fields, Field::Of::vertices, "nearest");
        if (!distance || !nearest) throw Unsound{"the fields distance and nearest are missing"};
        const DrawnShape drawn(fields, source_, error());
        for (const Field& field : fields) {
            const std::size_t due = field.of == Field::Of::pieces     ? drawn.pieces()
                                    : field.of == Field::Of::elements ? std::size_t(source_.count())
                                    : drawn.has(field)                ? std::max(drawn.vertices(), drawn.own_vertices())
                                                                      : drawn.own_vertices();
            if (field.values.size() != due)
                throw Unsound{fmt::format("field {}: {} values for {} {}", field.name, field.values.size(), due,
                                          to_string(field.of))};
        }
        in_order(fields);
        drawn.check();
        for (std::size_t i : spread(distance->values.size()))
            near(i, drawn.vertex(i), distance->values[i], nearest->values[i]);
        for (const Field& field : fields) {
            if (field.meaning == Field::Meaning::number || field.of == Field::Of::pieces) continue;
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

    double error() const {
        return field_error(std::max(source_.points().cwiseAbs().maxCoeff(), target_.points().cwiseAbs().maxCoeff()));
    }

    void near(std::size_t i, const Vec3& p, double distance, double nearest) const {
        go_on();
        const auto what = [&] { return fmt::format("vertex {}: distance {:.17g}", i, distance); };
        if (!(distance >= 0) || std::isinf(distance)) throw Unsound{what() + " is no distance"};
        if (!(nearest >= 0 && nearest < target_.count() && nearest == std::floor(nearest)))
            throw Unsound{fmt::format("vertex {}: nearest {} is not an element of B", i, nearest)};
        const Rational most = Rational(distance) + Rational(error()), least = Rational(distance) - Rational(error());
        if (WATCHED("verify: the element that is named is the nearest",
                    squared_distance(p, target_[Index(nearest)]) > most * most))
            throw Unsound{fmt::format("{}, but element {} of B, which it names, is farther", what(), nearest)};
        if (least <= 0) return;
        // Rounding this radius up is safe: it can only make nearer() compute more exact distances.
        const double away = std::nextafter(distance - error(), std::numeric_limits<double>::infinity());
        const auto squared = nearer(p, away);
        if (WATCHED("verify: no element is nearer than the distance of a vertex", squared && *squared < least * least))
            throw Unsound{what() + ", but an element of B is nearer"};
    }

    // Checks that no lower bound is above an upper bound of the same element or vertex.
    void in_order(const Fields& fields) const {
        for (const Field& low : fields) {
            for (const Field& high : fields) {
                if (low.meaning != Field::Meaning::lower || high.meaning != Field::Meaning::upper || low.of != high.of)
                    continue;
                for (std::size_t i = 0; i < low.values.size(); ++i) {
                    if (WATCHED_ELSE(
                            "verify: no lower bound of an element is above its upper bound",
                            low.values[i] <= high.values[i] + WATCHED("fields: the slack of bounds in order", slack_),
                            true))
                        continue;
                    throw Unsound{fmt::format("{} {}: {} {:.17g} is not at most {} {:.17g}", to_string(low.of), i,
                                              low.name, low.values[i], high.name, high.values[i])};
                }
            }
        }
    }

    // Returns the index of the element of B nearest to p, up to rounding.
    Index about_nearest(const Vec3& p) const {
        Index best = 0;
        double least = std::numeric_limits<double>::infinity();
        for (Index k = 0; k < target_.count(); ++k) {
            if (target_.beyond(k, p, least)) continue;
            const double d = rough_offset(p, target_[k]).stableNorm();
            if (d < least) {
                least = d;
                best = k;
            }
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
        if (WATCHED("verify: an upper bound covers the centroid", corners.size() == 3))
            points.push_back(corners[0] / 3 + corners[1] / 3 + corners[2] / 3);
        std::optional<Rational> farthest;  // square of an upper bound on h(element, B)
        for (const Vec3& p : points) {
            go_on();
            const Element b = target_[about_nearest(p)];
            if (field.meaning == Field::Meaning::upper) {
                if (WATCHED_ELSE("verify: an upper bound covers the corners", true, &p == &points.back()) &&
                    !covers(value + WATCHED("fields: the slack of upper bounds", slack_), p, corners, b))
                    refuse("below the distance of one of its points");
                continue;
            }
            Rational most = 0;
            for (const Vec3& corner : corners) most = std::max(most, squared_distance(corner, b));
            if (!farthest || most < *farthest) farthest = most;
        }
        const double least = value - WATCHED("fields: the slack of lower bounds", slack_);
        if (!farthest || least <= 0) return;
        if (std::isinf(least) ||
            WATCHED("verify: a lower bound of an element is not above the distance of all its points",
                    Rational(least) * Rational(least) > *farthest))
            refuse("above the distance of all its points");
    }

    // Returns whether p is at most `upper` away from B. Because p may be a rounded centroid slightly off its element of
    // A, `corners`, its distance from this element is added to `upper`. First tries `likely`, an element of B that is
    // probably near.
    bool covers(double upper, const Vec3& p, const Element& corners, const Element& likely) const {
        if (std::isinf(upper)) return upper > 0;
        const double off = root_at_least(squared_distance(p, corners));
        const Rational most = Rational(upper) + Rational(WATCHED("verify: the centroid is off its element", off));
        if (most < 0) return false;
        if (squared_distance(p, likely) <= most * most) return true;
        return *nearer(p, std::numeric_limits<double>::infinity()) <= most * most;  // exact distances to all of B
    }

    const Standing &source_, &target_;
    double slack_;  // how far each bound may be off
    const Stop& stop_;
};

}  // namespace

Verdict check_fields(const Fields& fields, const Shape& source, const Pose& source_pose, const Shape& target,
                     const Pose& target_pose, double slack, const Stop& stop, std::string& reason) {
    const Standing a(source, source_pose),
        b(target, WATCHED_ELSE("verify: fields are of posed shapes", target_pose, Pose{}));
    if (!a.finite() || !b.finite()) return Verdict::not_checked;
    try {
        FieldCheck(a, b, slack, stop).all(fields);
        return Verdict::holds;
    } catch (const Unsound& refutation) {
        reason = refutation.reason;
        return Verdict::unsound;
    } catch (const Stopped&) {
        return Verdict::not_checked;
    }
}

}  // namespace hausbench
