// SPDX-License-Identifier: BSD-3-Clause
#include "core/path/follower.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace jink::path {
namespace {

TimedPath straight(float length, float speed = 5.0F)
{
    TimedPath path;
    const std::vector<Vec3> positions{Vec3::Zero(), Vec3(length, 0.0F, 0.0F)};
    EXPECT_TRUE(make_timed_path(positions, speed, vehicle::VehicleLimits{}, path));
    return path;
}

TEST(Follow, OnTheTimedPointThePathsVelocity)
{
    const TimedPath path = straight(20.0F);
    EXPECT_LT((follow(path, 1.0F, Vec3(5.0F, 0.0F, 0.0F), {}, {}) - Vec3(5.0F, 0.0F, 0.0F)).norm(), 1e-5F);
}

TEST(Follow, LooksOneLagAhead)
{
    TimedPath path;
    const std::vector<Vec3> positions{Vec3::Zero(), Vec3(5.0F, 0.0F, 0.0F), Vec3(5.0F, 5.0F, 0.0F)};
    ASSERT_TRUE(make_timed_path(positions, 5.0F, vehicle::VehicleLimits{}, path));
    const vehicle::VehicleLimits limits;  // lag 0.25 s
    // The corner is 1 s after the start and blended over 0.25 s on either side.
    EXPECT_LT((follow(path, 0.49F, Vec3(2.45F, 0.0F, 0.0F), limits, {}) - Vec3(5.0F, 0.0F, 0.0F)).norm(), 1e-5F);
    EXPECT_LT((follow(path, 0.75F, Vec3(3.75F, 0.0F, 0.0F), limits, {}) - Vec3(2.5F, 2.5F, 0.0F)).norm(), 1e-4F);
    EXPECT_LT((follow(path, 1.01F, Vec3(5.0F, 0.05F, 0.0F), limits, {}) - Vec3(0.0F, 5.0F, 0.0F)).norm(), 1e-4F);
}

TEST(Follow, CorrectionIsBounded)
{
    TimedPath path;
    const std::vector<Vec3> positions{Vec3::Zero(), Vec3(20.0F, 0.0F, 0.0F)};
    ASSERT_TRUE(make_timed_path(positions, 4.0F, vehicle::VehicleLimits{}, path));
    const Vec3 command = follow(path, 1.0F, Vec3(4.0F, 100.0F, 0.0F), {}, FollowerGains{1.0F, 2.0F});
    EXPECT_LT((command - Vec3(4.0F, -2.0F, 0.0F)).norm(), 1e-5F);
    const Vec3 gentle = follow(path, 1.0F, Vec3(4.0F, 1.0F, 0.0F), {}, FollowerGains{0.5F, 2.0F});
    EXPECT_LT((gentle - Vec3(4.0F, -0.5F, 0.0F)).norm(), 1e-5F);
}

TEST(Follow, ClimbAndDescentWithinLimits)
{
    TimedPath path;
    const std::vector<Vec3> positions{Vec3::Zero(), Vec3(20.0F, 0.0F, 0.0F)};
    ASSERT_TRUE(make_timed_path(positions, 4.0F, vehicle::VehicleLimits{}, path));
    const FollowerGains hard{1.0F, 50.0F};
    EXPECT_FLOAT_EQ(follow(path, 1.0F, Vec3(4.0F, 0.0F, -40.0F), {}, hard).z(), 3.0F);
    EXPECT_FLOAT_EQ(follow(path, 1.0F, Vec3(4.0F, 0.0F, 40.0F), {}, hard).z(), -3.0F);
}

/// Late on a path at cruise speed, it does not catch up; late on a slower one it does, up to cruise speed.
TEST(Follow, NeverFasterThanCruiseSpeed)
{
    const TimedPath path = straight(20.0F);
    EXPECT_LT((follow(path, 1.0F, Vec3(1.0F, 0.0F, 0.0F), {}, {}) - Vec3(5.0F, 0.0F, 0.0F)).norm(), 1e-5F);
    const Vec3 aside = follow(path, 1.0F, Vec3(5.0F, 100.0F, 0.0F), {}, {});
    EXPECT_NEAR(aside.norm(), 5.0F, 1e-5F);
    EXPECT_NEAR(aside.y() / aside.x(), -2.0F / 5.0F, 1e-5F);
    TimedPath slow;
    const std::vector<Vec3> positions{Vec3::Zero(), Vec3(20.0F, 0.0F, 0.0F)};
    ASSERT_TRUE(make_timed_path(positions, 3.5F, vehicle::VehicleLimits{}, slow));
    EXPECT_LT((follow(slow, 1.0F, Vec3::Zero(), {}, {}) - Vec3(5.0F, 0.0F, 0.0F)).norm(), 1e-5F);
    TimedPath fast;  // the mission's speed, above ours
    ASSERT_TRUE(make_timed_path(positions, 8.0F, vehicle::VehicleLimits{}, fast));
    EXPECT_LT((follow(fast, 1.0F, Vec3::Zero(), {}, {}) - Vec3(8.0F, 0.0F, 0.0F)).norm(), 1e-5F);
}

TEST(Follow, PastTheEndTheEndIsHeld)
{
    const TimedPath path = straight(20.0F);
    EXPECT_EQ(follow(path, 4.0F, Vec3(20.0F, 0.0F, 0.0F), {}, {}), Vec3::Zero());
    EXPECT_LT((follow(path, 9.0F, Vec3(19.0F, 0.0F, 0.0F), {}, {}) - Vec3(1.0F, 0.0F, 0.0F)).norm(), 1e-5F);
    // Until then it flies on, one lag before the end too.
    EXPECT_LT((follow(path, 3.99F, Vec3(19.95F, 0.0F, 0.0F), {}, {}) - Vec3(5.0F, 0.0F, 0.0F)).norm(), 1e-4F);
}

TEST(Follow, PathOfOnePointIsHeld)
{
    TimedPath path;
    path.points.unchecked_push_back({Vec3(1.0F, 0.0F, 0.0F), Vec3::Zero(), 0.0F});
    EXPECT_LT((follow(path, -1.0F, Vec3::Zero(), {}, {}) - Vec3(1.0F, 0.0F, 0.0F)).norm(), 1e-6F);
    EXPECT_LT((follow(path, 1.0F, Vec3::Zero(), {}, {}) - Vec3(1.0F, 0.0F, 0.0F)).norm(), 1e-6F);
}

TEST(PredictVelocityCommand, BrakeStopsWithinTheStoppingDistance)
{
    vehicle::VehicleState state;
    state.velocity = Vec3(5.0F, 0.0F, 0.0F);
    const vehicle::VehicleLimits limits;
    TimedPath flight;
    predict_velocity_command(state, Vec3::Zero(), 5.0F, 0.1F, limits, flight);
    EXPECT_FLOAT_EQ(flight.duration(), 5.0F);
    EXPECT_NEAR(flight.points.back().position.x(), vehicle::stopping_distance(5.0F, limits), 1e-3F);
    EXPECT_LT(flight.points.back().velocity.norm(), vehicle::kStandstillSpeed);
}

TEST(PredictVelocityCommand, HorizonThatIsNoMultipleOfTheStep)
{
    vehicle::VehicleState state;
    TimedPath flight;
    predict_velocity_command(state, Vec3(1.0F, 0.0F, 0.0F), 0.25F, 0.1F, {}, flight);
    ASSERT_EQ(flight.points.size(), 4U);
    EXPECT_FLOAT_EQ(flight.duration(), 0.25F);
    predict_velocity_command(state, Vec3(1.0F, 0.0F, 0.0F), 100.0F, 0.1F, {}, flight);
    EXPECT_EQ(flight.points.size(), kMaxPathPoints);
}

}  // namespace
}  // namespace jink::path
