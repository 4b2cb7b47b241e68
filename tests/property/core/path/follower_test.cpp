// SPDX-License-Identifier: BSD-3-Clause
#include "core/path/prediction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.hpp"

namespace jink::path {
namespace {

/// A curve of the geometric planner's kind: out by `offset` at `distance`, back at 1.5 times (simple) or twice that
/// (symmetric).
std::vector<Vec3> bump(float distance, float offset, float heading, float tilt, bool simple, std::size_t points)
{
    std::vector<Vec3> positions;
    const float end = simple ? 1.5F : 2.0F;
    for (std::size_t i = 0; i < points; ++i) {
        const float s = end * static_cast<float>(i) / static_cast<float>(points - 1);
        const float u = simple || s <= 1.0F ? s : 2.0F - s;
        const float y = offset * u * u * (3.0F - 2.0F * u);
        const float level = y * std::cos(tilt);
        const float x = s * distance;
        positions.emplace_back(x * std::cos(heading) - level * std::sin(heading),
                               x * std::sin(heading) + level * std::cos(heading), y * std::sin(tilt));
    }
    return positions;
}

/// Greatest acceleration that the path asks for, as a share of the vehicle's limits.
float demand(const TimedPath& path, const vehicle::VehicleLimits& limits)
{
    float most = 0.0F;
    for (std::size_t i = 1; i + 1 < path.points.size(); ++i) {
        const Vec3 change = path.points[i].velocity - path.points[i - 1].velocity;
        const Seconds time = 0.5F * (path.points[i + 1].time - path.points[i - 1].time);
        most = std::max({most, change.head<2>().norm() / (time * limits.max_acceleration),
                         std::abs(change.z()) / (time * limits.max_vertical_acceleration)});
    }
    return most;
}

/// Worst distances from the timed point [m], on curves that ask for up to half and up to all of the acceleration.
struct Worst {
    float modest = 0.0F;
    float full = 0.0F;
    int flown = 0;
};

Worst worst_tracking(float share_of_cruise)
{
    Worst worst;
    for (std::uint64_t seed = 1; seed <= 40000; ++seed) {
        Random random(seed);
        vehicle::VehicleLimits limits;
        limits.velocity_lag = random.uniform(0.05F, 0.4F);
        const float distance = random.uniform(4.0F, 40.0F);
        const float offset = random.uniform(-1.3F, 1.3F) * distance;
        const float heading = random.uniform(-kPi, kPi);
        const float tilt = random.uniform(-kPi, kPi);
        const float speed = share_of_cruise * limits.cruise_speed;
        TimedPath path;
        EXPECT_TRUE(
            make_timed_path(bump(distance, offset, heading, tilt, random.uniform() < 0.5F, 25), speed, limits, path));
        const float demanded = demand(path, limits);
        if (demanded > 1.0F) {
            continue;
        }
        ++worst.flown;
        vehicle::VehicleState state;
        state.position = path.points.front().position;
        state.velocity = speed * Vec3(std::cos(heading), std::sin(heading), 0.0F);
        Prediction flight;
        WorkBudget budget(1'000'000);
        EXPECT_TRUE(predict_flight(state, path, 0.0F, 0.1F, limits, {}, kMaxPathPoints, budget, flight));
        EXPECT_GE(flight.path.duration(), path.duration() - 1e-3F) << "seed " << seed;
        flight.path.points.pop_back();  // beyond the end of the path
        for (const PathPoint& point : flight.path.points) {
            const float error = (point.position - sample(path, point.time).position).norm();
            float& of = demanded <= 0.5F ? worst.modest : worst.full;
            of = std::max(of, error);
        }
    }
    std::printf("[ measured ] at %.1f of cruise speed: worst tracking error %.3f m up to half, %.3f m up to all of the "
                "acceleration limits, %d flights\n",
                static_cast<double>(share_of_cruise), static_cast<double>(worst.modest),
                static_cast<double>(worst.full), worst.flown);
    return worst;
}

TEST(FollowerLaws, StaysNearTheTimedPointOfAFeasibleCurve)
{
    const Worst slower = worst_tracking(0.9F);
    EXPECT_GT(slower.flown, 10000);
    EXPECT_LE(slower.modest, 0.25F);
    EXPECT_LE(slower.full, 0.4F);
    // The lag from a corner is not recovered at cruise speed.
    const Worst at_cruise = worst_tracking(1.0F);
    EXPECT_GT(at_cruise.flown, 10000);
    EXPECT_LE(at_cruise.modest, 0.4F);
    EXPECT_LE(at_cruise.full, 0.95F);
}

/// At cruise speed there is nothing left to catch up with: an error along the path stays, one across it dies away.
TEST(FollowerLaws, APositionErrorDiesAway)
{
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
        Random random(seed);
        vehicle::VehicleLimits limits;
        limits.velocity_lag = random.uniform(0.0F, 0.6F);
        const bool at_cruise = random.below(2) == 0;
        TimedPath path;
        const std::vector<Vec3> positions{Vec3::Zero(), Vec3(100.0F, 0.0F, 0.0F)};
        ASSERT_TRUE(make_timed_path(positions, at_cruise ? 5.0F : 4.0F, limits, path));
        vehicle::VehicleState state;
        state.position = Vec3(random.uniform(-3.0F, 3.0F), random.uniform(-3.0F, 3.0F), random.uniform(-3.0F, 3.0F));
        state.velocity = Vec3(random.uniform(0.0F, 6.0F), random.uniform(-3.0F, 3.0F), random.uniform(-2.0F, 2.0F));
        Prediction flight;
        WorkBudget budget(1'000'000);
        EXPECT_TRUE(predict_flight(state, path, 0.0F, 0.4F, limits, {}, kMaxPathPoints, budget, flight));
        const PathPoint& end = flight.path.points.back();
        const Vec3 error = end.position - sample(path, end.time).position;
        if (at_cruise) {
            ASSERT_LT(std::hypot(error.y(), error.z()), 0.1F) << "seed " << seed;
            ASSERT_LT(error.x(), 0.02F) << "seed " << seed;
            ASSERT_GT(error.x(), -7.0F) << "seed " << seed << ": 3 m to begin with, 1 s to get to speed";
        } else {
            ASSERT_LT(error.norm(), 0.02F) << "seed " << seed;
        }
    }
}

/// For any path and vehicle position.
TEST(FollowerLaws, CommandsStayWithinLimits)
{
    for (std::uint64_t seed = 1; seed <= 20000; ++seed) {
        Random random(seed);
        vehicle::VehicleLimits limits;
        limits.cruise_speed = random.uniform(1.0F, 20.0F);
        limits.max_climb = random.uniform(0.5F, 25.0F);
        limits.max_descent = random.uniform(0.5F, 25.0F);
        std::vector<Vec3> positions;
        for (std::uint64_t i = 0, n = 2 + random.below(kMaxPathPoints - 1); i < n; ++i) {
            positions.emplace_back(random.uniform(-20.0F, 20.0F), random.uniform(-20.0F, 20.0F),
                                   random.uniform(-20.0F, 20.0F));
        }
        TimedPath path;
        const float speed = random.uniform(0.2F, 1.0F) * limits.cruise_speed;
        ASSERT_TRUE(make_timed_path(positions, speed, limits, path));
        const Vec3 own(random.uniform(-30.0F, 30.0F), random.uniform(-30.0F, 30.0F), random.uniform(-30.0F, 30.0F));
        const FollowerGains gains{random.uniform(0.0F, 3.0F), random.uniform(0.0F, 10.0F)};
        const Vec3 command = follow(path, random.uniform(0.0F, 1.2F) * path.duration(), own, limits, gains);
        ASSERT_LE(command.norm(), limits.cruise_speed * 1.00001F) << "seed " << seed;
        ASSERT_LE(command.z(), limits.max_climb) << "seed " << seed;
        ASSERT_GE(command.z(), -limits.max_descent) << "seed " << seed;
    }
}

TEST(SampleLaws, ContinuousAndOnThePath)
{
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
        Random random(seed);
        std::vector<Vec3> positions;
        for (std::uint64_t i = 0, n = 2 + random.below(kMaxPathPoints - 1); i < n; ++i) {
            positions.emplace_back(random.uniform(-20.0F, 20.0F), random.uniform(-20.0F, 20.0F),
                                   random.uniform(-20.0F, 20.0F));
        }
        TimedPath path;
        const vehicle::VehicleLimits limits;
        ASSERT_TRUE(make_timed_path(positions, random.uniform(0.5F, 10.0F), limits, path));
        for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
            const PathPoint& from = path.points[i];
            const PathPoint& to = path.points[i + 1];
            ASSERT_GT(to.time, from.time) << "seed " << seed;
            const Vec3 reached = from.position + from.velocity * (to.time - from.time);
            ASSERT_LT((reached - to.position).norm(), 2e-2F) << "seed " << seed;
            ASSERT_LE(std::abs(from.velocity.z()), 3.0F) << "seed " << seed;
            const Seconds t = random.uniform(from.time, to.time);
            const PathSample at = sample(path, t);
            const Vec3 expected = from.position + from.velocity * (t - from.time);
            ASSERT_LT((at.position - expected).norm(), 2e-2F) << "seed " << seed;
            ASSERT_EQ(at.velocity, from.velocity) << "seed " << seed;
        }
        ASSERT_EQ(sample(path, path.duration()).position, positions.back()) << "seed " << seed;
    }
}

}  // namespace
}  // namespace jink::path
