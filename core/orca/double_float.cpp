// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/double_float.hpp"

#include <cmath>

namespace jink::orca {

namespace {

/// a + b without an error, whichever is larger (Knuth).
DoubleFloat two_sum(float a, float b) noexcept
{
    const float s = a + b;
    const float back = s - a;
    return {s, (a - (s - back)) + (b - back)};
}

/// The same for |a| >= |b| (Dekker).
DoubleFloat ordered_sum(float a, float b) noexcept
{
    const float s = a + b;
    return {s, b - (s - a)};
}

/// a * b without an error. Its rest is a float, so that both ways to it give the same one.
DoubleFloat two_product(float a, float b) noexcept
{
    const float p = a * b;
#ifdef FP_FAST_FMAF
    return {p, std::fma(a, b, -p)};
#else
    constexpr float kSplit = 4097.0F;  // 2^12 + 1: halves of 12 bits (Veltkamp)
    const float a_wide = kSplit * a;
    const float b_wide = kSplit * b;
    const float a_high = a_wide - (a_wide - a);
    const float b_high = b_wide - (b_wide - b);
    const float a_low = a - a_high;
    const float b_low = b - b_high;
    return {p, ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low};
#endif
}

}  // namespace

DoubleFloat operator+(DoubleFloat a, DoubleFloat b) noexcept
{
    const DoubleFloat high = two_sum(a.hi, b.hi);
    const DoubleFloat low = two_sum(a.lo, b.lo);
    const DoubleFloat first = ordered_sum(high.hi, high.lo + low.hi);
    return ordered_sum(first.hi, first.lo + low.lo);
}

DoubleFloat operator*(DoubleFloat a, DoubleFloat b) noexcept
{
    const DoubleFloat p = two_product(a.hi, b.hi);
    return ordered_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

DoubleFloat operator/(DoubleFloat a, DoubleFloat b) noexcept
{
    const float first = a.hi / b.hi;
    const DoubleFloat left = a - DoubleFloat(first) * b;
    const float second = left.hi / b.hi;
    const DoubleFloat rest = left - DoubleFloat(second) * b;
    const DoubleFloat both = ordered_sum(first, second);
    return ordered_sum(both.hi, both.lo + rest.hi / b.hi);
}

DoubleFloat sqrt(DoubleFloat a) noexcept
{
    if (!(a.hi > 0.0F)) {
        return {};
    }
    // Newton's step from the root in single precision.
    const float root = std::sqrt(a.hi);
    return ordered_sum(root, (a - two_product(root, root)).hi / (2.0F * root));
}

}  // namespace jink::orca
