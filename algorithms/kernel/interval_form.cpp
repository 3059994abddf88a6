#include "interval_form.h"

namespace hausbench {
namespace {

// Any middle will do; half widths are rounded up, as the rounding mode is.
void centre(const Box& box, Vec3& middle, Vec3& half) {
    for (int k = 0; k < 3; ++k) {
        middle[k] = 0.5 * box.low[k] + 0.5 * box.high[k];
        half[k] = std::max(box.high[k] - middle[k], middle[k] - box.low[k]);
    }
}

// m + s.u + e v, |v| <= 1, e >= 0.
struct Affine {
    Interval m;
    std::array<Interval, 3> s;
    double e = 0;
};

double radius(const Affine& a) { return magnitude(a.s[0]) + magnitude(a.s[1]) + magnitude(a.s[2]) + a.e; }

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
    for (int k = 0; k < 3; ++k) sizes_[std::size_t(k)] = std::size_t(polynomial_.degree(k)) + 1;
    dense_.assign(sizes_[0] * sizes_[1] * sizes_[2], Interval(0.0));
    for (const Polynomial::Term& term : polynomial_.terms()) {
        const auto i = std::size_t(term.powers[0]), j = std::size_t(term.powers[1]), k = std::size_t(term.powers[2]);
        dense_[(i * sizes_[1] + j) * sizes_[2] + k] = term.coefficient;
    }
    work_ = dense_;
}

// Horner's shift along each axis in turn, then the k-th coefficient times half^k.
void FormEvaluator::expand(const Vec3& middle, const Vec3& half) {
    work_ = dense_;
    std::size_t stride = 1;
    for (std::size_t axis = 3; axis-- > 0;) {
        const std::size_t n = sizes_[axis];
        const Interval c(middle[Eigen::Index(axis)]);
        const double r = half[Eigen::Index(axis)];
        for (std::size_t line = 0; line < work_.size() / n; ++line) {
            Interval* p = work_.data() + (line / stride) * stride * n + line % stride;
            for (std::size_t i = 0; i + 1 < n; ++i) {
                for (std::size_t j = n - 1; j-- > i;) p[j * stride] += c * p[(j + 1) * stride];
            }
            Interval scale(r);
            for (std::size_t i = 1; i < n; ++i, scale *= r) p[i * stride] *= scale;
        }
        stride *= n;
    }
}

LinearForm FormEvaluator::linear(const Box& box) {
    LinearForm form;
    centre(box, form.middle, form.half);
    expand(form.middle, form.half);
    Interval rest(0.0);
    double others = 0;  // terms that may have either sign
    std::size_t at = 0;
    form.slope.setZero();
    for (std::size_t i = 0; i < sizes_[0]; ++i) {
        for (std::size_t j = 0; j < sizes_[1]; ++j) {
            for (std::size_t k = 0; k < sizes_[2]; ++k, ++at) {
                const Interval& x = work_[at];
                if (i + j + k == 0) {
                    rest += x;
                } else if (i + j + k == 1) {
                    const double middle = 0.5 * x.inf() + 0.5 * x.sup();
                    form.slope[i == 1 ? 0 : j == 1 ? 1 : 2] = middle;
                    others += magnitude(x - Interval(middle));
                } else if (i % 2 == 0 && j % 2 == 0 && k % 2 == 0) {
                    rest += Interval(std::min(x.inf(), 0.0), std::max(x.sup(), 0.0));
                } else {
                    others += magnitude(x);
                }
            }
        }
    }
    form.rest = rest + Interval(-others, others);
    return form;
}

Interval FormEvaluator::affine(const Vec3& middle, const Vec3& half) const {
    Affine sum{Interval(0.0), {Interval(0.0), Interval(0.0), Interval(0.0)}, 0};
    for (const Polynomial::Term& term : polynomial_.terms()) {
        Affine product{term.coefficient, {Interval(0.0), Interval(0.0), Interval(0.0)}, 0};
        for (std::size_t k = 0; k < 3; ++k) {
            Affine variable{Interval(middle[Eigen::Index(k)]), {Interval(0.0), Interval(0.0), Interval(0.0)}, 0};
            variable.s[k] = Interval(half[Eigen::Index(k)]);
            for (int i = 0; i < term.powers[k]; ++i) product = product * variable;
        }
        sum.m += product.m;
        for (std::size_t k = 0; k < 3; ++k) sum.s[k] += product.s[k];
        sum.e += product.e;
    }
    const double r = radius(sum);
    return sum.m + Interval(-r, r);
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
