// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include <gtest/gtest.h>

#include "core/orca/optimum.hpp"

// Boundaries of the velocity programs to the bit: speeds whose tolerance is a power of two, so that sums with it are
// exact in single precision.

namespace jink::orca::test {

template <class Real>
inline constexpr float kTolerance = std::is_same_v<Real, float> ? 0x1p-20F : 0x1p-36F;

/// The speed [m/s] for which the programs' tolerance is kTolerance.
template <class Real>
float exact_scale()
{
    float scale = kTolerance<Real> / Tolerance<Real>::kShare;
    while (Tolerance<Real>(scale).outside < kTolerance<Real>) {
        scale = std::nextafter(scale, 100.0F);
    }
    while (Tolerance<Real>(scale).outside > kTolerance<Real>) {
        scale = std::nextafter(scale, 0.0F);
    }
    EXPECT_EQ(Tolerance<Real>(scale).outside, kTolerance<Real>);
    return scale;
}

/// The next larger and the next smaller number.
inline float above(float x) { return std::nextafter(x, std::numeric_limits<float>::infinity()); }
inline float below(float x) { return std::nextafter(x, -std::numeric_limits<float>::infinity()); }

}  // namespace jink::orca::test
