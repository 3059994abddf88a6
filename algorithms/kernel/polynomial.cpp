#include "algorithms/kernel/polynomial.h"

#include "algorithms/error.h"
#include "algorithms/kernel/watched.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

namespace hausbench {
namespace {

constexpr int most_power = 40;
constexpr std::size_t most_products =
    10'000'000;               // per text; takes seconds. ((1+x)*(1+y)*(1+z))^40, the densest, needs half as many
constexpr int deepest = 100;  // nested parentheses; a limit, because each level takes some 500 bytes of stack

using Powers = std::array<int, 3>;
using Sum = std::map<Powers, Interval>;  // an expanded polynomial: maps the powers of each term to its coefficient

bool is_zero(const Interval& x) { return x.inf() == 0 && x.sup() == 0; }

// Throws an InputError with a one-line message. Control characters in the text, such as line breaks, become spaces, so
// that column numbers stay correct.
[[noreturn]] void refuse(std::string_view text, const std::string& what) {
    std::string message = fmt::format("polynomial '{}': {}", text, what);
    std::replace_if(
        message.begin(), message.end(),
        [](unsigned char c) { return WATCHED("polynomial: a message is one line", c < 0x20) || c == 0x7f; }, ' ');
    throw InputError(message);
}

// A recursive descent parser that expands the polynomial while reading it. sum(), term(), raised() and atom() read the
// rules "sum", "product", "power" and "atom" of the grammar in polynomial.h.
class Reader {
public:
    Reader(std::string_view text, const Vec3& origin) : text_(text), origin_(origin) {}

    Sum read() {
        Sum all = sum();
        if (more()) fail(expected_operator());
        return all;
    }

private:
    [[noreturn]] void fail(const std::string& what) const { fail_at(at_, what); }
    [[noreturn]] void fail_at(std::size_t at, const std::string& what) const {
        refuse(text_, fmt::format("column {}: {}", at + 1, what));
    }

    bool more() {
        while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
        return at_ < text_.size();
    }
    char peek() { return more() ? text_[at_] : '\0'; }
    bool take(char c) {
        if (peek() != c) return false;
        ++at_;
        return true;
    }

    std::string expected_operator() {
        const char c = peek();
        if (c == ')') return "a ')' without its '(': remove it or add the other";
        if (std::isalnum(static_cast<unsigned char>(c)) || c == '(')
            return "an operator is missing: write products with *, such as 4*x";
        return fmt::format("'{}' is none of + - * / ^ ( ): remove it", c);
    }

    Sum sum() {
        const bool minus = take('-');
        if (!minus) take('+');
        Sum all = term();
        if (minus) negate(all);
        for (;;) {
            const bool add = take('+');
            if (!add && !take('-')) return all;
            Sum next = term();
            if (!add) negate(next);
            for (const auto& [powers, x] : next) {
                const auto [at, fresh] = all.emplace(powers, x);
                if (!fresh) at->second += x;
            }
        }
    }

    Sum product(const Sum& a, const Sum& b) {
        products_ += a.size() * b.size();
        if (products_ > most_products)
            fail(fmt::format(
                "multiplying it out takes more than {} products of terms: use lower powers or fewer parentheses",
                most_products));
        Sum out;
        for (const auto& [p, x] : a) {
            for (const auto& [q, y] : b) {
                const Powers powers{p[0] + q[0], p[1] + q[1], p[2] + q[2]};
                const auto [at, fresh] = out.emplace(powers, x * y);
                if (!fresh) at->second += x * y;
            }
        }
        return out;
    }

    static void negate(Sum& of) {
        for (auto& [powers, x] : of) x = -x;
    }

    Sum term() {
        Sum all = raised();
        for (;;) {
            if (take('*')) {
                all = product(all, raised());
                check_size(all);
            } else if (take('/')) {
                more();
                const std::size_t from = at_;
                const Sum by = raised();
                const Powers none{};
                if (by.size() != 1 || by.begin()->first != none)
                    fail_at(from, "only a number may stand after '/': a polynomial has no x, y or z below");
                const Interval divisor = by.begin()->second;
                if (divisor.inf() <= 0 && divisor.sup() >= 0) fail_at(from, "a division by zero: write another number");
                for (auto& [powers, x] : all) x /= divisor;
            } else {
                return all;
            }
        }
    }

    Sum raised() {
        const Sum base = atom();
        if (!take('^')) return base;
        more();
        const std::size_t from = at_;
        int n = 0;
        while (at_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_])) && n <= most_power)
            n = 10 * n + (text_[at_++] - '0');
        if (at_ == from) fail_at(from, "write an integer of at least 0 after '^', such as x^2");
        if (n > most_power) fail_at(from, fmt::format("powers above {} are not supported", most_power));
        if (base.size() == 1) {  // a single term, such as -2 or x: power() gives the smallest interval
            const auto& [powers, x] = *base.begin();
            Sum all{{{powers[0] * n, powers[1] * n, powers[2] * n}, power(x, n)}};
            check_size(all);
            return all;
        }
        Sum all{{Powers{}, Interval(1.0)}};
        for (int i = 0; i < n; ++i) {
            all = product(all, base);
            check_size(all);
        }
        return all;
    }

    void check_size(const Sum& all) {
        for (const auto& [powers, x] : all) {
            if (*std::max_element(powers.begin(), powers.end()) > most_power)
                fail(fmt::format("the product has a power above {}: use lower powers", most_power));
        }
    }

    Sum atom() {
        const char c = peek();
        if (c == 'x' || c == 'y' || c == 'z') {
            ++at_;
            Powers powers{};
            powers[static_cast<std::size_t>(c - 'x')] = 1;
            Sum variable{{powers, Interval(1.0)}};
            if (const double from = origin_[c - 'x']; from != 0) variable.emplace(Powers{}, Interval(from));
            return variable;
        }
        if (c == '(') {
            if (depth_ == deepest) fail(fmt::format("parentheses are nested more than {} deep: remove some", deepest));
            const std::size_t opened = at_++;
            ++depth_;
            Sum inside = sum();
            --depth_;
            if (!take(')')) {
                if (more()) fail(expected_operator());
                fail_at(opened, "this '(' is not closed: add a ')'");
            }
            return inside;
        }
        if (std::isdigit(static_cast<unsigned char>(c)) || c == '.') return {{Powers{}, number()}};
        if (c == '\0') fail("the text ends where a number, x, y, z or '(' is expected");
        fail(fmt::format("'{}' where a number, x, y, z or '(' is expected", c));
    }

    // Reads a decimal number, digit by digit, in interval arithmetic. The result is an interval that contains the
    // number; it is exact for integers that fit in a double.
    Interval number() {
        const std::size_t from = at_;
        Interval value(0.0);
        long decimals = 0;
        bool digits = false, point = false;
        for (; at_ < text_.size(); ++at_) {
            const char c = text_[at_];
            if (c == '.' && !point) {
                point = true;
            } else if (std::isdigit(static_cast<unsigned char>(c))) {
                digits = true;
                value = value * 10.0 + double(c - '0');
                decimals += point;
            } else {
                break;
            }
        }
        if (!digits) fail_at(from, "a '.' without digits: write a number");
        long exponent = 0;
        if (at_ < text_.size() && (text_[at_] == 'e' || text_[at_] == 'E')) {
            ++at_;
            const bool minus = at_ < text_.size() && text_[at_] == '-';
            if (at_ < text_.size() && (text_[at_] == '-' || text_[at_] == '+')) ++at_;
            const std::size_t begin = at_;
            while (at_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_])) && exponent < 1000)
                exponent = 10 * exponent + (text_[at_++] - '0');
            if (at_ == begin) fail_at(begin, "write digits after 'e', such as 1e-3");
            if (minus) exponent = -exponent;
        }
        exponent -= decimals;
        if (std::abs(exponent) > 300) fail_at(from, "this number is beyond double precision");
        const Interval scale = power(Interval(10.0), static_cast<int>(std::abs(exponent)));
        return exponent < 0 ? value / scale : value * scale;
    }

    std::string_view text_;
    Vec3 origin_;
    std::size_t at_ = 0;
    int depth_ = 0;  // number of open parentheses
    std::size_t products_ = 0;
};

}  // namespace

Polynomial::Polynomial(std::string_view text, const Vec3& origin) : origin_(origin) {
    const UpwardRounding upward;
    for (const auto& [powers, x] : Reader(text, origin).read()) {
        if (!std::isfinite(x.inf()) || !std::isfinite(x.sup()))
            refuse(text, "a coefficient is beyond double precision");
        if (!is_zero(x)) terms_.push_back({powers, x});
    }
    finish();
    if (degrees_[0] + degrees_[1] + degrees_[2] == 0)
        refuse(text, "is a constant, which has no surface: write one in x, y and z");
}

// Moves the origin to the middle of the box only along axes on which the box is far from 0, compared with its size.
Polynomial Polynomial::of(const AlgebraicSurface& surface) {
    Vec3 origin = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
        const double low = surface.box(0, k), high = surface.box(1, k), middle = 0.5 * low + 0.5 * high;
        if (std::abs(middle) > 4 * (high - low)) origin[k] = middle;
    }
    Polynomial polynomial(surface.polynomial);
    if (origin != Vec3::Zero()) {
        try {
            polynomial = Polynomial(surface.polynomial, origin);
        } catch (const InputError&) {  // too many terms or too large coefficients: keeps the origin 0
        }
    }
    if (WATCHED("polynomial: values whose squares overflow", true)) polynomial.normalise(surface.box);
    return polynomial;
}

// Multiplies the polynomial by a power of two if its values in the box may be very large (above 2^100) or are all very
// small (below 2^-100). This keeps its zeros. A coefficient that underflows stays inside its interval.
void Polynomial::normalise(const Points& box) {
    const UpwardRounding upward;
    std::array<Interval, 3> x;
    for (int k = 0; k < 3; ++k) x[std::size_t(k)] = Interval(box(0, k), box(1, k));
    const double most = magnitude(natural(x));
    if (!(most > 0) || !std::isfinite(most) || std::abs(std::ilogb(most)) <= 100) return;
    const Interval factor(std::ldexp(1.0, -std::ilogb(most)));
    for (Term& term : terms_) term.coefficient *= factor;
    finish();
}

void Polynomial::finish() {
    degrees_ = {};
    middles_.clear();
    for (const Term& term : terms_) {
        for (std::size_t k = 0; k < 3; ++k) degrees_[k] = std::max(degrees_[k], term.powers[k]);
        middles_.push_back(0.5 * term.coefficient.inf() + 0.5 * term.coefficient.sup());
    }
}

Polynomial Polynomial::derivative(int axis) const {
    const UpwardRounding upward;
    Polynomial out;
    out.origin_ = origin_;
    for (Term term : terms_) {
        int& p = term.powers[static_cast<std::size_t>(axis)];
        if (p == 0) continue;
        term.coefficient *= double(p--);
        out.terms_.push_back(term);
    }
    out.finish();
    return out;
}

double Polynomial::value(const Vec3& at) const {
    Vec3 ignored;
    return value(at, ignored);
}

double Polynomial::value(const Vec3& at, Vec3& gradient) const {
    double powers[3][most_power + 1];
    for (int k = 0; k < 3; ++k) {
        const double x = at[k] - origin_[k];
        powers[k][0] = 1;
        for (int i = 1; i <= degree(k); ++i) powers[k][i] = powers[k][i - 1] * x;
    }
    double sum = 0;
    gradient.setZero();
    for (std::size_t t = 0; t < terms_.size(); ++t) {
        const auto [i, j, k] = terms_[t].powers;
        const double c = middles_[t], x = powers[0][i], y = powers[1][j], z = powers[2][k];
        sum += c * x * y * z;
        if (i > 0) gradient[0] += c * i * powers[0][i - 1] * y * z;
        if (j > 0) gradient[1] += c * j * x * powers[1][j - 1] * z;
        if (k > 0) gradient[2] += c * k * x * y * powers[2][k - 1];
    }
    return sum;
}

Interval Polynomial::natural(const std::array<Interval, 3>& box) const {
    std::array<Interval, 3> x;
    for (std::size_t k = 0; k < 3; ++k) x[k] = box[k] - Interval(origin_[Eigen::Index(k)]);
    Interval sum(0.0);
    for (const Term& term : terms_) {
        Interval summand = term.coefficient;
        for (std::size_t k = 0; k < 3; ++k) {
            if (term.powers[k] > 0) summand *= power(x[k], term.powers[k]);
        }
        sum += summand;
    }
    return sum;
}

std::string surface_problem(const AlgebraicSurface& surface) {
    if (surface.box.rows() != 2) return "its box does not have two corners";
    if (!surface.box.allFinite()) return "its box has a coordinate that is not finite: write numbers";
    for (int k = 0; k < 3; ++k) {
        if (!(surface.box(0, k) < surface.box(1, k)) || !std::isfinite(surface.box(1, k) - surface.box(0, k))) {
            return fmt::format("its box is [{}, {}] in {}, and has no volume: write the smaller number first",
                               surface.box(0, k), surface.box(1, k), "xyz"[k]);
        }
    }
    try {
        const Polynomial polynomial(surface.polynomial);
        const UpwardRounding upward;
        std::array<Interval, 3> box;
        for (int k = 0; k < 3; ++k) box[std::size_t(k)] = Interval(surface.box(0, k), surface.box(1, k));
        const Interval value = polynomial.natural(box);
        if (!(magnitude(value) < 1e250)) return "its polynomial overflows in its box: write a smaller box";
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

}  // namespace hausbench
