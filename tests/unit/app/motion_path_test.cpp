// SPDX-License-Identifier: BSD-3-Clause
// MotionPath, the bounds of what is taken for a turn.
#include "firmware/app/motion_path.hpp"

#include <gtest/gtest.h>

#include "tests/oracle/reference_ends.hpp"

namespace jink::app {
namespace {

/// The path of a vehicle that flies east at `speed`, or at `velocity`, and turns at `rate`.
struct Extrapolated {
    Extrapolated(float speed, float rate) : Extrapolated(Vec3(speed, 0.0F, 0.0F), rate, Vec3::Zero()) {}
    Extrapolated(const Vec3& velocity, float rate, const Vec3& position)
    {
        own.position = position;
        own.velocity = velocity;
        path.extrapolate(own, rate, limits);
    }
    [[nodiscard]] bool is_turn() const { return world::turns(path.reference()); }

    vehicle::VehicleState own;
    vehicle::VehicleLimits limits;
    MotionPath path;
};

TEST(MotionPath, TheSmallestAndTheLargestArcThatARouteTakesAreTurns)
{
    EXPECT_TRUE(Extrapolated(0.5F, 1.0F).is_turn()) << "Route::kMinRadius";
    EXPECT_FALSE(Extrapolated(0.5F, 1.01F).is_turn());
    constexpr float kRate = 1.0F / 1024.0F;
    EXPECT_TRUE(Extrapolated(path::Route::kLargestRadius * kRate, kRate).is_turn());
    EXPECT_FALSE(Extrapolated(path::Route::kLargestRadius * kRate * 1.001F, kRate).is_turn());
}

TEST(MotionPath, WhereARouteTakesNoArcTheMotionGoesStraightOn)
{
    const Vec3 far(1e8F, 0.0F, 0.0F);
    const Extrapolated motion(Vec3(5.0F, 0.0F, 0.0F), 0.5F, far);
    EXPECT_FALSE(motion.is_turn());
    EXPECT_EQ(world::start_of(motion.path.reference()), far);
    EXPECT_EQ(motion.path.reference().speed, 5.0F);
}

TEST(MotionPath, AClimbingTurnThatLeavesTheRangeOfRoutesOnItsSecondLegGoesStraightOn)
{
    // On a circle of 10 m, 30 degrees before its way due east: 10 m further east after the first leg, 15 m after the
    // second.
    const Vec3 position(path::Route::kFarthest - 12.0F, 0.0F, 0.0F);
    const Vec3 velocity(4.330127F, -2.5F, 1.0F);
    EXPECT_FALSE(Extrapolated(velocity, 0.5F, position).is_turn());
    EXPECT_TRUE(Extrapolated(velocity, 0.5F, position - Vec3(10.0F, 0.0F, 0.0F)).is_turn());
}

}  // namespace
}  // namespace jink::app
