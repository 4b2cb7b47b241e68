// SPDX-License-Identifier: BSD-3-Clause
// Flyability by a vehicle's accelerations, at the limits themselves: the limit is allowed, the next number is not.
#include <gtest/gtest.h>

#include <cmath>

#include "core/geometric/curve.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

/// Allowance for the rounding of differences (curve.cpp).
constexpr float kRounding = 1.001F;

float above(float x) { return std::nextafter(x, kInfinity); }

/// One chord of two seconds, the middle of which is reached after one.
bool flyable(const Vec3& velocity, const Vec3& before, const Vec3& rejoin, const vehicle::VehicleLimits& limits)
{
    detail::Curve curve;
    curve.points = 2;
    const Vec3 end = 2.0F * velocity;
    curve.x[0] = curve.y[0] = curve.z[0] = curve.t[0] = 0.0F;
    curve.x[1] = end.x();
    curve.y[1] = end.y();
    curve.z[1] = end.z();
    curve.t[1] = 2.0F;
    return detail::is_flyable(curve, before, rejoin, limits);
}

TEST(FlyableBorder, AsMuchAccelerationAsThereIs)
{
    vehicle::VehicleLimits limits;
    limits.max_acceleration = 4.0F;
    limits.max_vertical_acceleration = 2.0F;
    const float level = kRounding * 4.0F;
    const float vertical = kRounding * 2.0F;
    for (const float sign : {-1.0F, 1.0F}) {
        for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY())}) {
            EXPECT_TRUE(flyable(sign * level * axis, Vec3::Zero(), axis, limits));
            EXPECT_FALSE(flyable(sign * above(level) * axis, Vec3::Zero(), axis, limits));
        }
        EXPECT_TRUE(flyable(sign * vertical * Vec3::UnitZ(), Vec3::Zero(), Vec3::UnitZ(), limits));
        EXPECT_FALSE(flyable(sign * above(vertical) * Vec3::UnitZ(), Vec3::Zero(), Vec3::UnitZ(), limits));
        EXPECT_FALSE(flyable(sign * 9.0F * Vec3::UnitZ(), Vec3::Zero(), Vec3::UnitZ(), limits));
    }
    // Both level axes together.
    const float each = 0.99F * std::sqrt(0.5F) * level;
    const Vec3 slanted = Vec3(1.0F, 1.0F, 0.0F).normalized();
    EXPECT_TRUE(flyable(Vec3(each, each, 0.0F), Vec3::Zero(), slanted, limits));
    EXPECT_FALSE(flyable(1.02F * Vec3(each, each, 0.0F), Vec3::Zero(), slanted, limits));
}

TEST(FlyableBorder, AsFarPastTheLegAsIsSaid)
{
    // A vehicle that answers after half a second and then at once is carried half a metre by 1 m/s: kRejoinOvershoot.
    static_assert(kRejoinOvershoot == 0.5F);
    vehicle::VehicleLimits limits;
    limits.max_acceleration = limits.max_vertical_acceleration = kInfinity;
    limits.velocity_lag = 0.5F;
    for (const float sign : {-1.0F, 1.0F}) {
        for (const Vec3& across : {Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())}) {
            EXPECT_TRUE(flyable(sign * across, Vec3::Zero(), Vec3::UnitX(), limits));
            EXPECT_FALSE(flyable(sign * above(1.0F) * across, Vec3::Zero(), Vec3::UnitX(), limits));
        }
    }
}

}  // namespace
}  // namespace jink::geometric
