// Reads text as a polynomial. Every interval form must give a range over a box that contains the exact
// value at a point of the box, which a second reader computes from the text in rationals.
#include "algorithms/kernel/interval_form.h"
#include "tests/fuzz/target.h"

#include <CGAL/Exact_rational.h>

#include <cmath>
#include <optional>

namespace hausbench::fuzz {
namespace {

using Rational = CGAL::Exact_rational;

// Evaluates a polynomial written in the grammar of kernel/polynomial.h. Checks nothing: the text is known to be valid.
class ExactValue {
public:
    ExactValue(std::string_view text, const std::array<Rational, 3>& at) : text_(text), at_(at) {}

    // Returns no value if an exponent such as 1e-99999 is too large for rationals.
    std::optional<Rational> value() {
        const Rational all = sum();
        return given_up_ ? std::nullopt : std::optional(all);
    }

private:
    char peek() {
        while (!text_.empty() && std::string_view(" \t\r\n\v\f").find(text_[0]) != std::string_view::npos)
            text_.remove_prefix(1);
        return text_.empty() ? '\0' : text_[0];
    }
    bool take(char c) {
        if (peek() != c) return false;
        text_.remove_prefix(1);
        return true;
    }
    Rational sum() {
        const bool minus = take('-');
        if (!minus) take('+');
        Rational all = minus ? Rational(-product()) : product();
        for (;;) {
            if (take('+'))
                all += product();
            else if (take('-'))
                all -= product();
            else
                return all;
        }
    }
    Rational product() {
        Rational all = power();
        for (;;) {
            if (take('*')) {
                all *= power();
            } else if (take('/')) {
                const Rational below = power();
                if (below != 0)
                    all /= below;
                else
                    given_up_ = true;  // or 1e-99999, which was skipped
            } else {
                return all;
            }
        }
    }
    Rational power() {
        const Rational base = atom();
        if (!take('^')) return base;
        Rational all = 1;
        for (int n = static_cast<int>(digits()); n > 0; --n) all *= base;
        return all;
    }
    Rational atom() {
        if (take('(')) {
            const Rational inside = sum();
            take(')');
            return inside;
        }
        for (std::size_t k = 0; k < 3; ++k)
            if (take("xyz"[k])) return at_[k];
        return number();
    }
    long digits() {
        long value = 0;
        for (char c = peek(); c >= '0' && c <= '9'; c = text_.empty() ? '\0' : text_[0]) {
            value = std::min(10 * value + (c - '0'), 1'000'000L);
            text_.remove_prefix(1);
        }
        return value;
    }
    static bool digit(std::string_view text) { return !text.empty() && text[0] >= '0' && text[0] <= '9'; }
    Rational number() {
        peek();
        Rational mantissa = 0;
        long exponent = 0;
        for (; digit(text_); text_.remove_prefix(1)) mantissa = 10 * mantissa + (text_[0] - '0');
        if (text_.starts_with('.')) {
            text_.remove_prefix(1);
            for (; digit(text_); text_.remove_prefix(1), --exponent) mantissa = 10 * mantissa + (text_[0] - '0');
        }
        if (text_.starts_with('e') || text_.starts_with('E')) {
            text_.remove_prefix(1);
            const bool minus = text_.starts_with('-');
            if (minus || text_.starts_with('+')) text_.remove_prefix(1);
            exponent += minus ? -digits() : digits();
        }
        if (std::abs(exponent) > 700) {
            given_up_ = true;
            return 0;
        }
        for (; exponent > 0; --exponent) mantissa *= 10;
        for (; exponent < 0; ++exponent) mantissa /= 10;
        return mantissa;
    }

    std::string_view text_;
    std::array<Rational, 3> at_;
    bool given_up_ = false;
};

bool holds(const Interval& range, const Rational& value) {
    if (std::isnan(range.inf()) || std::isnan(range.sup())) return true;  // overflow: the range says nothing
    return (std::isinf(range.inf()) || Rational(range.inf()) <= value) &&
           (std::isinf(range.sup()) || value <= Rational(range.sup()));
}

void compare(const Polynomial& polynomial, const std::string& text, const Box& box, const Vec3& at) {
    const auto value = ExactValue(text, {Rational(at[0]), Rational(at[1]), Rational(at[2])}).value();
    if (!value) return;
    FormEvaluator evaluator(polynomial);
    std::array<Interval, 5> ranges;
    {
        const UpwardRounding upward;
        ranges[4] = polynomial.natural(
            {Interval(box.low[0], box.high[0]), Interval(box.low[1], box.high[1]), Interval(box.low[2], box.high[2])});
        for (std::size_t form = 0; form < 4; ++form) ranges[form] = evaluator.range(static_cast<Form>(form), box);
    }
    for (std::size_t form = 0; form < 5; ++form)
        expect(holds(ranges[form], *value), "range " + std::to_string(form) + " leaves out a value");
}

void polynomials(std::string_view bytes) {
    Bytes in(bytes);
    Box box;
    Vec3 at;
    for (int k = 0; k < 3; ++k) {
        const double size = std::ldexp(1.0, static_cast<int>(in.below(24)) - 12),
                     middle = in.next<std::int8_t>() / 16.0;
        const double part = in.byte() / 255.0;
        box.low[k] = middle - size, box.high[k] = middle + size;
        at[k] = std::clamp(box.low[k] + part * (box.high[k] - box.low[k]), box.low[k], box.high[k]);
    }
    const std::string text(in.text(200));
    try {
        const Polynomial polynomial(text);
        expect(!polynomial.terms().empty(), "a polynomial without terms");
        for (int axis = 0; axis < 3; ++axis) polynomial.derivative(axis);
        if (polynomial.terms().size() <= 500) compare(polynomial, text, box, at);
    } catch (const InputError& error) {
        expect_one_line(error);
    }
}

}  // namespace
}  // namespace hausbench::fuzz

HAUSBENCH_FUZZ_TARGET(polynomials)
