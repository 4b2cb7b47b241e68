// SPDX-License-Identifier: BSD-3-Clause
// Double-float numbers against double: each operation alone, and cancellation.
#include "core/orca/double_float.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace jink::orca {
namespace {

constexpr double kExact = 0x1p-43;  // of the result

double value(const DoubleFloat& w) { return static_cast<double>(w.hi) + static_cast<double>(w.lo); }

/// Of any sign and size from 1e-4 to 1e4, exact in double.
DoubleFloat any(Random& random)
{
    const float size = std::pow(10.0F, random.uniform(-4.0F, 4.0F));
    const float high = random.uniform(-1.0F, 1.0F) * size;
    return DoubleFloat(high) + DoubleFloat(high * random.uniform(-1.0F, 1.0F) * 0x1p-24F);
}

void expect_exact(const DoubleFloat& found, double exact)
{
    ASSERT_LE(std::fabs(value(found) - exact), kExact * std::fabs(exact));
    ASSERT_EQ(found.hi, static_cast<float>(value(found))) << "the halves overlap";
}

TEST(DoubleFloat, EachOperationIsExactToTwoToTheMinus43)
{
    Random random(20261125);
    for (int i = 0; i < 200'000; ++i) {
        const DoubleFloat a = any(random);
        // Often nearly the same, or nearly opposite.
        DoubleFloat b = any(random);
        if (random.below(3) == 0) {
            b = DoubleFloat(a.hi * (1.0F + random.uniform(-1.0F, 1.0F) * 1e-6F)) + DoubleFloat(a.lo);
            b = random.below(2) == 0 ? -b : b;
        }
        expect_exact(a + b, value(a) + value(b));
        expect_exact(a - b, value(a) - value(b));
        expect_exact(a * b, value(a) * value(b));
        expect_exact(a / b, value(a) / value(b));
        expect_exact(sqrt(fabs(a)), std::sqrt(std::fabs(value(a))));
        ASSERT_EQ(a < b, value(a) < value(b));
        ASSERT_EQ(a <= b, value(a) <= value(b));
        ASSERT_EQ(a == b, value(a) == value(b));
    }
}

TEST(DoubleFloat, RootOfNothingAndOfLess)
{
    EXPECT_EQ(sqrt(DoubleFloat(0.0F)), DoubleFloat(0.0F));
    EXPECT_EQ(sqrt(DoubleFloat(-1.0F)), DoubleFloat(0.0F));
}

/// Differences that single precision rounds to 0: a product of three numbers near 1 less the same with its last bit
/// flipped.
TEST(DoubleFloat, VectorsOfItKeepWhatCancels)
{
    Random random(20261126);
    for (int i = 0; i < 20'000; ++i) {
        const Vec3 n = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1F, 1)).normalized();
        const Vec3 x(random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-4, 4));
        const float offset = n.dot(x);
        const DoubleFloat left = DoubleFloat(offset) - n.cast<DoubleFloat>().dot(x.cast<DoubleFloat>());
        const double exact = static_cast<double>(offset) - n.cast<double>().dot(x.cast<double>());
        ASSERT_NEAR(value(left), exact, 1e-12);
        const DoubleFloatVec3 across = n.cast<DoubleFloat>().cross(x.cast<DoubleFloat>());
        ASSERT_NEAR(value(across.dot(x.cast<DoubleFloat>())), 0.0, 1e-11);
    }
}

}  // namespace
}  // namespace jink::orca
