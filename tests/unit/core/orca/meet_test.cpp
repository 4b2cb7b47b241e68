// SPDX-License-Identifier: BSD-3-Clause
// Intersection of two planes of nearly equal or opposite directions; and containment in a sphere to the bit.
#include <gtest/gtest.h>

#include <cmath>

#include "core/orca/meet.hpp"
#include "tests/unit/core/orca/enumerated.hpp"
#include "tests/unit/core/orca/tolerances.hpp"

namespace jink::orca {
namespace {

/// Planes whose angle is 0 within rounding do not intersect.
TEST(WherePlanesMeet, AnAngleOfRoundingIsNone)
{
    const float angle = kSameDirection<float>;
    for (const float sine : {angle, test::above(angle)}) {
        const Row one{Vec3::UnitX(), 0.0F};
        const Row other{{1.0F, sine, 0}, 0.5F};
        Vec3 from;
        Vec3 along;
        EXPECT_EQ(line_of<float>(one, other, Vec3::Zero(), from, along), sine > angle);
    }
}

/// The line lies in both planes to rounding, however small the angle between them is.
TEST(WherePlanesMeet, TheLineLiesInBothPlanes)
{
    Random random(20270108);
    for (int i = 0; i < 200; ++i) {
        const Vec3 normal = enumerated::unit(random);
        const float angle = std::pow(10.0F, random.uniform(-4.0F, -1.0F));
        const float sign = i % 2 == 0 ? 1.0F : -1.0F;
        const Row one{normal, random.uniform(-1.0F, 1.0F)};
        const Vec3 turned = (normal + angle * enumerated::unit(random)).normalized();
        const Row other{sign * turned, sign * one.offset + 0.1F * angle};
        Vec3 from;
        Vec3 along;
        ASSERT_TRUE(line_of<float>(one, other, one.offset * normal, from, along));
        ASSERT_NEAR(along.norm(), 1.0F, 1e-6F);
        ASSERT_LE(std::fabs(along.dot(one.normal)), 1e-6F) << i;
        ASSERT_LE(std::fabs(along.dot(other.normal)), 1e-6F) << i;
    }
}

TEST(WithinASphere, ThatIsToTheTolerance)
{
    const Sphere sphere{Vec3::Zero(), 1.0F};
    const float tolerance = test::kTolerance<float>;
    EXPECT_TRUE(within<float>(sphere, {1.0F + tolerance, 0, 0}, tolerance));
    EXPECT_FALSE(within<float>(sphere, {test::above(1.0F + tolerance), 0, 0}, tolerance));
}

}  // namespace
}  // namespace jink::orca
