// A certificate checker in rational arithmetic, written from docs/certificate.md alone: slow, but without rounding errors.
#pragma once

#include "tests/support/certificates.h"

#include <bit>
#include <cmath>
#include <string>
#include <vector>

namespace hausbench::certificates {

enum class Claim {
    holds,      // the bound of every leaf is at most the claim
    is_open,    // leaves of kind `centre` exceed the claim, but by no more than the rounding of their centre
    is_false,   // the bound of a leaf exceeds the claim
    no_format,  // the bytes are not a certificate of A
};

class ExactChecker {
public:
    // Both shapes are at rest.
    ExactChecker(const Shape& a, const Shape& b)
        : source_(triangles_of(a)), target_(triangles_of(b)), size_(both_diagonal(points_of(a), points_of(b))) {}

    Claim claim(const std::string& bytes, double proven) {
        bytes_ = &bytes, at_ = 0;
        claim_ = proven >= 0 ? Claim::holds : Claim::is_false;  // a NaN is false, too
        limit_ = std::isfinite(proven) && proven >= 0 ? proven : 0;
        limited_ = std::isfinite(proven);
        try {
            proof.clear();
            for (Index i = 0; i < source_.triangles.rows(); ++i) triangle(i);
            if (at_ != bytes.size()) throw NoFormat();
        } catch (const NoFormat&) {
            return Claim::no_format;
        }
        return claim_;
    }

    // The nodes of the last certificate, which tests change and write again.
    Proof proof;

private:
    using Rational = exact::Rational;
    using RVec3 = exact::RVec3;
    struct NoFormat {};

    static double both_diagonal(const Points& a, const Points& b) {
        Points both(a.rows() + b.rows(), 3);
        both << a, b;
        return diagonal(both);
    }

    // --- bytes -------------------------------------------------------------------------------------------------------

    static void demand(bool condition) {
        if (!condition) throw NoFormat();
    }

    unsigned byte() {
        demand(at_ < bytes_->size());
        return static_cast<unsigned char>((*bytes_)[at_++]);
    }

    std::uint64_t number() {
        std::vector<unsigned> digits;
        do digits.push_back(byte());
        while (digits.back() >= 0x80);
        demand(digits.size() <= 9 && (digits.size() == 1 || digits.back() != 0));
        std::uint64_t value = 0;
        for (std::size_t i = digits.size(); i-- > 0;) value = value * 128 + digits[i] % 128;
        return value;
    }

    double eight_bytes() {
        std::uint64_t bits = 0, unit = 1;
        for (int i = 0; i < 8; ++i, unit *= 256) bits += unit * byte();
        return std::bit_cast<double>(bits);
    }

    CutPoint cut_point(std::uint64_t bits, std::size_t corners) {
        const bool corner = bits % 2 == 1, backward = bits / 2 % 2 == 1;
        const std::size_t place = bits / 4;
        demand(place < corners && !(corner && backward));
        return corner ? CutPoint::corner(place) : backward ? CutPoint::back(place, 0) : CutPoint::along(place, 0);
    }

    void read_t(CutPoint& point) {
        if (point.t < 0) return;
        point.t = eight_bytes();
        demand(point.t >= 0 && point.t <= 1 && !std::signbit(point.t));
    }

    // --- cuts and leaves ---------------------------------------------------------------------------------------------

    // Counts the corners strictly between two points of the boundary, going round the polygon.
    static std::size_t between(const CutPoint& from, const CutPoint& to, std::size_t corners) {
        const auto place = [](const CutPoint& p) { return 2 * p.place + (p.t < 0 ? 0 : 1); };
        demand(place(from) != place(to));
        std::size_t count = 0;
        for (std::size_t i = (place(from) + 1) % (2 * corners); i != place(to); i = (i + 1) % (2 * corners))
            count += i % 2 == 0;
        return count;
    }

    Node read_cut(std::uint64_t rest, std::size_t corners) {
        Node node;
        node.kind = Node::Kind::cut;
        demand(rest < 65536);
        node.p = cut_point(rest % 256, corners);
        node.q = cut_point(rest / 256, corners);
        read_t(node.p);
        read_t(node.q);
        const std::size_t one = between(node.p, node.q, corners), two = between(node.q, node.p, corners);
        demand(one >= 1 && two >= 1 && one <= 62 && two <= 62);
        return node;
    }

    void triangle(Index i) {
        std::vector<std::vector<RVec3>> waiting(1);
        for (int c = 0; c < 3; ++c) waiting[0].push_back(corner(source_, i, c));
        proof.emplace_back();
        while (!waiting.empty()) {
            const std::vector<RVec3> polygon = std::move(waiting.back());
            waiting.pop_back();
            const std::uint64_t first = number();
            if (first % 4 != 0) {
                leaf(polygon, first);
                continue;
            }
            const Node node = read_cut(first / 4, polygon.size());
            proof.back().push_back(node);
            demand(waiting.size() < 4096);
            const auto exactly = [](const RVec3& from, const RVec3& to, double t) {
                return exact::along(from, Rational(t), exact::operator-(to, from));
            };
            Children<RVec3> children(polygon, node.p, node.q, exactly);
            waiting.push_back(std::move(children.second));
            waiting.push_back(std::move(children.first));
        }
    }

    void leaf(const std::vector<RVec3>& polygon, std::uint64_t first) {
        Node node;
        node.kind = first % 4 == 1 ? Node::Kind::one : first % 4 == 2 ? Node::Kind::centre : Node::Kind::vertex;
        demand(first / 4 < std::uint64_t(target_.triangles.rows()));
        node.k = Index(first / 4);
        if (node.kind == Node::Kind::vertex) {
            const std::uint64_t v = number();
            demand(v < std::uint64_t(source_.vertices.rows()));
            node.v = Index(v);
        }
        proof.back().push_back(node);
        if (!limited_ || claim_ == Claim::is_false) return;
        judge(polygon, node);
    }

    void judge(const std::vector<RVec3>& polygon, const Node& node) {
        if (node.kind == Node::Kind::one) {
            for (const RVec3& p : polygon) {
                if (squared(p, node.k) > limit_ * limit_) claim_ = Claim::is_false;
            }
            return;
        }
        RVec3 at = node.kind == Node::Kind::vertex ? exact::vector(source_.vertices.row(node.v)) : RVec3{0, 0, 0};
        if (node.kind == Node::Kind::centre) {
            for (const RVec3& p : polygon)
                at = exact::along(at, Rational(1) / Rational(static_cast<int>(polygon.size())), p);
        }
        Rational radius = 0;
        for (const RVec3& p : polygon) radius = std::max(radius, exact::squared_distance(at, p));
        const Rational distance = squared(at, node.k);
        if (roots_at_most(distance, radius, limit_)) return;
        const Rational rounding = Rational(0x1p-46) * Rational(size_);
        const bool open = node.kind == Node::Kind::centre && roots_at_most(distance, radius, limit_ + rounding);
        claim_ = open ? Claim::is_open : Claim::is_false;
    }

    // Checks sqrt(a) + sqrt(b) <= limit without roots: limit^2 - a - b >= 0 and 2 sqrt(ab) <= limit^2 - a - b.
    static bool roots_at_most(const Rational& a, const Rational& b, const Rational& limit) {
        const Rational rest = limit * limit - a - b;
        return rest >= 0 && 4 * a * b <= rest * rest;
    }

    static RVec3 corner(const TriangleMesh& mesh, Index i, int c) {
        return exact::vector(mesh.vertices.row(mesh.triangles(i, c)));
    }
    Rational squared(const RVec3& p, Index k) const {
        return exact::squared_distance_to_triangle(p, corner(target_, k, 0), corner(target_, k, 1),
                                                   corner(target_, k, 2));
    }

    TriangleMesh source_, target_;
    double size_;
    const std::string* bytes_ = nullptr;
    std::size_t at_ = 0;
    Claim claim_ = Claim::holds;
    Rational limit_;
    bool limited_ = true;
};

}  // namespace hausbench::certificates
