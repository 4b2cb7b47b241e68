// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <type_traits>

#include "core/base/random.hpp"
#include "core/orca/optimum.hpp"

// Programs in both precisions, for their laws.

namespace jink::orca::precision {

inline constexpr std::uint64_t kOptimumSeed = 20261124;
inline constexpr std::uint32_t kEnoughWork = 100'000'000;

inline Vec3 unit_vector(Random& random)
{
    while (true) {
        const Vec3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        if (v.squaredNorm() > 1e-2F && v.squaredNorm() < 1.0F) {
            return v.normalized();
        }
    }
}

template <class Real>
double as_double(Real value)
{
    if constexpr (std::is_same_v<Real, float>) {
        return static_cast<double>(value);
    } else {
        return static_cast<double>(value.hi) + static_cast<double>(value.lo);
    }
}
template <class Real>
Eigen::Vector3d as_double(const Vec3Of<Real>& v)
{
    return {as_double(v.x()), as_double(v.y()), as_double(v.z())};
}

/// In single precision corners of small angles are less exact.
template <class Real>
struct Precision : public ::testing::Test {
    static constexpr bool kIsSingle = std::is_same_v<Real, float>;
    static constexpr double kOutside = kIsSingle ? 5e-5 : 1e-6;  ///< [m/s] a half-space or a sphere
    static constexpr double kWorse = kIsSingle ? 3e-4 : 2e-5;    ///< [m/s] than the best
};
using Precisions = ::testing::Types<float, DoubleFloat>;

}  // namespace jink::orca::precision
