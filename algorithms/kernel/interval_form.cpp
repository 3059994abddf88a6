#include "algorithms/kernel/interval_form.h"

#include "algorithms/kernel/watched.h"

#include <cmath>
#include <limits>

namespace hausbench {
namespace {

// Computes the middle and the half widths of a box. The half widths are measured from the middle as rounded, and are
// rounded up, so that middle +- half contains the box. Requires UpwardRounding.
void centre(const Box& box, Vec3& middle, Vec3& half) {
    for (int k = 0; k < 3; ++k) {
        middle[k] = 0.5 * box.low[k] + 0.5 * box.high[k];
        half[k] = std::max(box.high[k] - middle[k], middle[k] - box.low[k]);
    }
}

// Returns whether both ends are finite. Callers replace any other interval with unbounded(), because an interval whose
// ends are NaN would contain no number.
bool finite(const Interval& x) { return std::isfinite(x.inf()) && std::isfinite(x.sup()); }

Interval unbounded() {
    constexpr double most = std::numeric_limits<double>::infinity();
    return {-most, most};
}

// A value in affine arithmetic: a linear function m + s.u of the position u in [-1, 1]^3 in the box, with an error of
// at most e.
struct Affine {
    Interval m;
    std::array<Interval, 3> s;
    double e = 0;
};

// Returns an upper bound on the distance of the value from its constant part m.
double radius(const Affine& a) { return magnitude(a.s[0]) + magnitude(a.s[1]) + magnitude(a.s[2]) + a.e; }

// Returns the product of two affine values. All parts that are not linear in the position u go into the error e.
Affine operator*(const Affine& a, const Affine& b) {
    Affine out;
    out.m = a.m * b.m;
    for (std::size_t k = 0; k < 3; ++k) out.s[k] = a.m * b.s[k] + b.m * a.s[k];
    out.e = magnitude(a.m) * b.e + magnitude(b.m) * a.e + radius(a) * radius(b);
    return out;
}

}  // namespace

Interval LinearForm::range() const {
    const double most = std::abs(slope[0]) + std::abs(slope[1]) + std::abs(slope[2]);  // rounded up
    return rest + Interval(-most, most);
}

FormEvaluator::FormEvaluator(const Polynomial& polynomial)
    : polynomial_(polynomial),
      derivatives_{polynomial.derivative(0), polynomial.derivative(1), polynomial.derivative(2)} {
    for (std::size_t k = 0; k < 3; ++k) powers_[k].resize(std::size_t(polynomial_.degree(static_cast<int>(k))) + 1);
    sums_.resize((kept + 1) * (kept + 1) * (kept + 1));
}

// Computes the powers (m + h u)^p along each axis, expanded in u. Here m is the middle of the box relative to the
// polynomial's origin, h its half width, and u in [-1, 1] the position in the box.
void FormEvaluator::set_powers(const Vec3& middle, const Vec3& half) {
    for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Index axis = Eigen::Index(k);
        const Interval m = Interval(middle[axis]) -
                           Interval(WATCHED("polynomial: the origin of linear forms", polynomial_.origin()[axis])),
                       h(half[axis]);
        Power next{{}, Interval(0.0), Interval(0.0), 0};
        next.low.fill(Interval(0.0));
        next.low[0] = Interval(1.0);
        powers_[k][0] = next;
        for (std::size_t p = 1; p < powers_[k].size(); ++p) {
            const Power& last = powers_[k][p - 1];
            next.top = std::min(static_cast<int>(p), kept);
            next.low[0] = m * last.low[0];
            for (std::size_t q = 1; q <= std::size_t(next.top); ++q)
                next.low[q] = m * last.low[q] + h * last.low[q - 1];
            products_ += 2 * std::uint64_t(next.top) + 1;
            if (p > kept) {  // `kept` is even, so u times u^kept is an odd power
                next.even = m * last.even + h * last.odd;
                next.odd = m * last.odd + h * (last.even + last.low[kept]);
                products_ += 4;
            }
            powers_[k][p] = next;
        }
    }
}

void FormEvaluator::add(const Polynomial::Term& term) {
    Power x = powers_[0][std::size_t(term.powers[0])];
    const Power &y = powers_[1][std::size_t(term.powers[1])], &z = powers_[2][std::size_t(term.powers[2])];
    for (Interval& c : x.low) c *= term.coefficient;
    x.even *= term.coefficient;
    x.odd *= term.coefficient;
    for (int i = 0; i <= x.top; ++i) {
        for (int j = 0; j <= std::min(y.top, kept - i); ++j) {
            const Interval both = x.low[std::size_t(i)] * y.low[std::size_t(j)];
            const int last = std::min(z.top, kept - i - j);
            for (int k = 0; k <= last; ++k) sum_of(i, j, k) += both * z.low[std::size_t(k)];
            products_ += std::uint64_t(last) + 2;
        }
    }
    if (term.powers[0] + term.powers[1] + term.powers[2] > kept) add_beyond(x, y, z);
}

// Adds bounds on the monomials of total degree above `kept` that arise from one term of the polynomial. x, y and z are
// the expanded powers of the term; x includes its coefficient.
//
// If all powers of a monomial are even, its value without the coefficient is in [0, 1]. The coefficients of these
// monomials have the same sign, so their sum lies between 0 and the sum of the coefficients; this interval is added to
// rest_. All other monomials are bounded by the absolute values of their coefficients, whose sum is added to others_.
void FormEvaluator::add_beyond(const Power& x, const Power& y, const Power& z) {
    // `all` holds absolute values of coefficients, by degree; `even` holds coefficients of even powers, by half the
    // degree. The last entry of each is the sum for all degrees above `kept`.
    constexpr int n = kept + 2, half = kept / 2 + 2;
    const Power* of[3] = {&x, &y, &z};
    double all[3][n], all_from[n + 1];
    Interval even[3][half], even_from[half + 1];
    for (int k = 0; k < 3; ++k) {
        for (std::size_t q = 0; q <= kept; ++q) {
            all[k][q] = magnitude(of[k]->low[q]);
            if (q % 2 == 0) even[k][q / 2] = of[k]->low[q];
        }
        all[k][n - 1] = magnitude(of[k]->even) + magnitude(of[k]->odd);
        even[k][half - 1] = of[k]->even;
    }
    // Returns the sum of all products a[i] * b[j] * c[k] whose total degree is above `kept`.
    const auto beyond = [](auto* a, auto* b, auto* c, auto* c_from, int size) {
        c_from[size] = 0.0;  // c_from[i] becomes the sum of c[i] to c[size - 1]
        for (int i = size - 1; i >= 0; --i) c_from[i] = c_from[i + 1] + c[i];
        auto sum = c_from[size];
        for (int i = 0; i < size; ++i) {
            for (int j = 0; j < size; ++j) {
                const bool over = i == size - 1 || j == size - 1;
                sum += a[i] * b[j] * c_from[over ? 0 : std::max(size - 1 - i - j, 0)];
            }
        }
        return sum;
    };
    const double everything = beyond(all[0], all[1], all[2], all_from, n);
    const Interval squares = beyond(even[0], even[1], even[2], even_from, half);
    if (!finite(squares)) {
        others_ = std::numeric_limits<double>::infinity();
        return;
    }
    if (WATCHED("linear form: even monomials beyond the sixth degree", true))
        rest_ += Interval(std::min(squares.inf(), 0.0), std::max(squares.sup(), 0.0));
    const double least = std::max(std::max(squares.inf(), -squares.sup()), 0.0);  // lower bound on |squares|
    others_ += WATCHED("linear form: monomials beyond the sixth degree", everything - least);
    products_ += 2 * n * n + 2 * half * half;
}

LinearForm FormEvaluator::linear(const Box& box) {
    LinearForm form;
    centre(box, form.middle, form.half);
    set_powers(form.middle, form.half);
    const int top[3] = {std::min(polynomial_.degree(0), kept), std::min(polynomial_.degree(1), kept),
                        std::min(polynomial_.degree(2), kept)};
    const auto each = [&](auto&& visit) {
        for (int i = 0; i <= top[0]; ++i) {
            for (int j = 0; j <= std::min(top[1], kept - i); ++j) {
                for (int k = 0; k <= std::min(top[2], kept - i - j); ++k) visit(i, j, k);
            }
        }
    };
    each([&](int i, int j, int k) { sum_of(i, j, k) = Interval(0.0); });
    rest_ = Interval(0.0);
    others_ = 0;
    for (const Polynomial::Term& term : polynomial_.terms()) add(term);
    form.slope.setZero();
    each([&](int i, int j, int k) {
        const Interval& x = sum_of(i, j, k);
        if (!finite(x)) {
            others_ = std::numeric_limits<double>::infinity();
        } else if (i + j + k == 0) {
            rest_ += x;
        } else if (i + j + k == 1) {
            const double middle = 0.5 * x.inf() + 0.5 * x.sup();
            form.slope[i == 1 ? 0 : j == 1 ? 1 : 2] = middle;
            others_ += WATCHED("linear form: width of the slope", magnitude(x - Interval(middle)));
        } else if (i % 2 == 0 && j % 2 == 0 && k % 2 == 0) {
            rest_ += Interval(std::min(x.inf(), 0.0), std::max(x.sup(), 0.0));
        } else {
            others_ += magnitude(x);
        }
    });
    form.rest = WATCHED_ELSE("linear form: sums that overflow", std::isfinite(others_) && finite(rest_), true)
                    ? rest_ + Interval(-others_, others_)
                    : unbounded();
    return form;
}

Interval FormEvaluator::affine(const Vec3& middle, const Vec3& half) const {
    Affine sum{Interval(0.0), {Interval(0.0), Interval(0.0), Interval(0.0)}, 0};
    for (const Polynomial::Term& term : polynomial_.terms()) {
        Affine product{term.coefficient, {Interval(0.0), Interval(0.0), Interval(0.0)}, 0};
        for (std::size_t k = 0; k < 3; ++k) {
            const Interval from_origin =
                Interval(middle[Eigen::Index(k)]) - Interval(polynomial_.origin()[Eigen::Index(k)]);
            Affine variable{from_origin, {Interval(0.0), Interval(0.0), Interval(0.0)}, 0};
            variable.s[k] = Interval(half[Eigen::Index(k)]);
            for (int i = 0; i < term.powers[k]; ++i) product = product * variable;
        }
        sum.m += product.m;
        for (std::size_t k = 0; k < 3; ++k) sum.s[k] += product.s[k];
        sum.e += product.e;
    }
    const double r = radius(sum);
    return WATCHED_ELSE("affine form: sums that overflow", std::isfinite(r) && finite(sum.m), true)
               ? sum.m + Interval(-r, r)
               : unbounded();
}

Interval FormEvaluator::range(Form form, const Box& box) {
    if (form == Form::modified_affine) return linear(box).range();
    std::array<Interval, 3> x;
    for (int k = 0; k < 3; ++k) x[std::size_t(k)] = Interval(box.low[k], box.high[k]);
    if (form == Form::natural) return polynomial_.natural(x);
    Vec3 middle, half;
    centre(box, middle, half);
    if (form == Form::affine) return affine(middle, half);
    std::array<Interval, 3> c;
    for (int k = 0; k < 3; ++k) c[std::size_t(k)] = Interval(middle[k]);
    Interval value = polynomial_.natural(c);
    for (std::size_t k = 0; k < 3; ++k) value += derivatives_[k].natural(x) * (x[k] - c[k]);
    return value;
}

}  // namespace hausbench
