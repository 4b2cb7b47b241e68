// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "core/base/vec3.hpp"

// Numbers of twice single precision, for units that compute in single precision alone: a sum of two floats that do not
// overlap. For the few programs whose answer rounding would leave open.

namespace jink::orca {

/// hi + lo, |lo| <= half a unit in the last place of hi: 48 bits. Finite numbers below 1e30 only, and what is
/// below 1e-30 is not distinguished from 0. Each operation is exact to 2^-43 of its result (Dekker; Knuth's sum), 10 to
/// 60 operations of single precision. The same bits with and without a fused multiply-add: the rest of a product is
/// exact.
struct DoubleFloat {
    float hi = 0.0F;
    float lo = 0.0F;

    constexpr DoubleFloat() noexcept = default;
    // As any float is one, it converts without a word.
    constexpr DoubleFloat(float value) noexcept : hi(value) {}  // NOLINT(google-explicit-constructor)
    constexpr DoubleFloat(int value) noexcept
        : hi(static_cast<float>(value)) {}  // NOLINT(google-explicit-constructor): Eigen
    constexpr DoubleFloat(float high, float low) noexcept : hi(high), lo(low) {}
    [[nodiscard]] explicit constexpr operator float() const noexcept { return hi; }

    [[nodiscard]] constexpr DoubleFloat operator-() const noexcept { return {-hi, -lo}; }
    // By value and out of line: two registers each, and a third less code.
    friend DoubleFloat operator+(DoubleFloat a, DoubleFloat b) noexcept;
    [[nodiscard]] friend DoubleFloat operator-(DoubleFloat a, DoubleFloat b) noexcept { return a + (-b); }
    friend DoubleFloat operator*(DoubleFloat a, DoubleFloat b) noexcept;
    friend DoubleFloat operator/(DoubleFloat a, DoubleFloat b) noexcept;
    DoubleFloat& operator+=(DoubleFloat b) noexcept { return *this = *this + b; }
    DoubleFloat& operator-=(DoubleFloat b) noexcept { return *this = *this - b; }
    DoubleFloat& operator*=(DoubleFloat b) noexcept { return *this = *this * b; }
    DoubleFloat& operator/=(DoubleFloat b) noexcept { return *this = *this / b; }

    [[nodiscard]] friend constexpr bool operator<(DoubleFloat a, DoubleFloat b) noexcept
    {
        return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo);
    }
    [[nodiscard]] friend constexpr bool operator>(DoubleFloat a, DoubleFloat b) noexcept { return b < a; }
    [[nodiscard]] friend constexpr bool operator<=(DoubleFloat a, DoubleFloat b) noexcept
    {
        return a.hi < b.hi || (a.hi == b.hi && a.lo <= b.lo);
    }
    [[nodiscard]] friend constexpr bool operator>=(DoubleFloat a, DoubleFloat b) noexcept { return b <= a; }
    [[nodiscard]] friend constexpr bool operator==(DoubleFloat a, DoubleFloat b) noexcept
    {
        return a.hi == b.hi && a.lo == b.lo;
    }
    [[nodiscard]] friend constexpr bool operator!=(DoubleFloat a, DoubleFloat b) noexcept { return !(a == b); }

    [[nodiscard]] friend constexpr DoubleFloat fabs(DoubleFloat a) noexcept { return a.hi < 0.0F ? -a : a; }
    /// Of a number; 0 of a negative one.
    friend DoubleFloat sqrt(DoubleFloat a) noexcept;
};

[[nodiscard]] DoubleFloat operator+(DoubleFloat a, DoubleFloat b) noexcept;
[[nodiscard]] DoubleFloat operator*(DoubleFloat a, DoubleFloat b) noexcept;
[[nodiscard]] DoubleFloat operator/(DoubleFloat a, DoubleFloat b) noexcept;
[[nodiscard]] DoubleFloat sqrt(DoubleFloat a) noexcept;

/// A vector of numbers of either kind.
template <class Real>
using Vec3Of = Eigen::Matrix<Real, 3, 1>;
using DoubleFloatVec3 = Vec3Of<DoubleFloat>;

}  // namespace jink::orca

/// What Eigen wants to know of a number.
template <>
struct Eigen::NumTraits<jink::orca::DoubleFloat> : Eigen::GenericNumTraits<jink::orca::DoubleFloat> {
    using Real = jink::orca::DoubleFloat;
    using NonInteger = jink::orca::DoubleFloat;
    using Nested = jink::orca::DoubleFloat;
    using Literal = float;
    enum : int {
        IsComplex = 0,
        IsInteger = 0,
        IsSigned = 1,
        RequireInitialization = 1,
        ReadCost = 2,
        AddCost = 20,
        MulCost = 24
    };
};
