// SPDX-License-Identifier: BSD-3-Clause
#include "core/path/prediction.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/base/work_units.hpp"

namespace jink::path {
namespace {

TimedPath leg_of(float length)
{
    TimedPath path;
    const std::vector<Vec3> positions{Vec3::Zero(), Vec3(length, 0.0F, 0.0F)};
    EXPECT_TRUE(make_timed_path(positions, 5.0F, vehicle::VehicleLimits{}, path));
    return path;
}

Prediction predicted(const TimedPath& path, const vehicle::VehicleState& state, Seconds start = 0.0F,
                     Seconds step = 0.2F, std::size_t most = kMaxPathPoints)
{
    Prediction flight;
    WorkBudget budget(1'000'000);
    EXPECT_TRUE(predict_flight(state, path, start, step, {}, {}, most, budget, flight));
    EXPECT_EQ(budget.spent(), units::kFlightPart * setpoints_of(path.duration() - start));
    return flight;
}

vehicle::VehicleState at_cruise(float x = 0.0F)
{
    vehicle::VehicleState state;
    state.position = Vec3(x, 0.0F, 0.0F);
    state.velocity = Vec3(5.0F, 0.0F, 0.0F);
    return state;
}

TEST(PredictFlight, StartsWithThePresentAndEndsWithTheFirstSetPointAfterThePath)
{
    const Prediction flight = predicted(leg_of(18.3F), at_cruise());  // 3.66 s
    const auto& points = flight.path.points;
    EXPECT_EQ(points.front().position, Vec3(Vec3::Zero()));
    EXPECT_EQ(points.front().time, 0.0F);
    EXPECT_FLOAT_EQ(flight.path.duration(), 3.7F);
    EXPECT_LT((points.back().position - Vec3(18.5F, 0.0F, 0.0F)).norm(), 1e-3F);
    EXPECT_LT((flight.velocity - Vec3(5.0F, 0.0F, 0.0F)).norm(), 1e-4F);
    ASSERT_EQ(flight.sagittas.size() + 1, points.size());
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const PathPoint& from = points[i];
        const PathPoint& to = points[i + 1];
        ASSERT_GT(to.time, from.time);
        ASSERT_LT((from.position + from.velocity * (to.time - from.time) - to.position).norm(), 1e-5F);
    }
    EXPECT_EQ(points.back().velocity, points[points.size() - 2].velocity);
}

TEST(PredictFlight, TheFirstChordsAreShort)
{
    const Prediction flight = predicted(leg_of(20.0F), at_cruise());
    const float times[] = {0.0F, 0.05F, 0.15F, 0.35F, 0.55F};
    for (std::size_t i = 0; i < std::size(times); ++i) {
        EXPECT_FLOAT_EQ(flight.path.points[i].time, times[i]);
    }
}

TEST(PredictFlight, StartsInTheMiddleOfThePath)
{
    const Prediction flight = predicted(leg_of(20.0F), at_cruise(15.0F), 3.0F);
    EXPECT_NEAR(flight.path.duration(), 1.0F, 1e-5F);
    EXPECT_LT((flight.path.points.back().position - Vec3(20.0F, 0.0F, 0.0F)).norm(), 1e-3F);
}

TEST(PredictFlight, NothingLeftGivesOnePoint)
{
    for (const Seconds start : {4.0F, 40.0F}) {
        const Prediction flight = predicted(leg_of(20.0F), at_cruise(19.0F), start);
        ASSERT_EQ(flight.path.points.size(), 1U);
        EXPECT_EQ(flight.path.points[0].position, Vec3(19.0F, 0.0F, 0.0F));
        EXPECT_TRUE(flight.sagittas.empty());
    }
}

/// A long path is flown to its end in longer chords, never cut.
TEST(PredictFlight, ALongPathFitsIntoThePoints)
{
    for (const std::size_t most : {std::size_t{4}, std::size_t{5}, std::size_t{20}, kMaxPathPoints}) {
        for (const float length : {0.1F, 1.0F, 30.0F, 300.0F, 1000.0F}) {
            const Prediction flight = predicted(leg_of(length), at_cruise(), 0.0F, 0.01F, most);
            EXPECT_LE(flight.path.points.size(), most);
            EXPECT_GE(flight.path.duration(), length / 5.0F - 1e-4F);
            EXPECT_LT(flight.path.duration(), length / 5.0F + kSetpointPeriod + 1e-3F);
        }
    }
}

/// Chords only say how the flight is written down.
TEST(PredictFlight, TheStepDoesNotChangeTheFlight)
{
    TimedPath path;
    const std::vector<Vec3> positions{Vec3::Zero(), Vec3(10.0F, 0.0F, 0.0F), Vec3(20.0F, 5.0F, 3.0F),
                                      Vec3(30.0F, 5.0F, 0.0F)};
    ASSERT_TRUE(make_timed_path(positions, 5.0F, vehicle::VehicleLimits{}, path));
    const Prediction fine = predicted(path, {}, 0.0F, 0.15F);
    const Prediction coarse = predicted(path, {}, 0.0F, 0.45F);
    std::size_t compared = 0;
    for (const PathPoint& point : coarse.path.points) {
        for (const PathPoint& other : fine.path.points) {
            if (point.time == other.time) {
                EXPECT_EQ(point.position, other.position) << "t " << point.time;
                ++compared;
            }
        }
    }
    EXPECT_GE(compared, 10U);
}

TEST(PredictFlight, AStraightFlightHasNoSagittaAndABrakingOneThatOfItsDeceleration)
{
    for (const Sagitta& s : predicted(leg_of(20.0F), at_cruise()).sagittas) {
        EXPECT_LT(s.any, 1e-5F);
    }
    vehicle::VehicleState state = at_cruise();
    state.velocity.z() = -2.0F;
    Prediction flight;
    predict_velocity_command(state, Vec3::Zero(), 1.0F, 0.2F, {}, flight);
    constexpr float kOneChord = 0.2F * 0.2F / 8.0F;
    EXPECT_FLOAT_EQ(flight.sagittas[2].any, kOneChord * std::hypot(5.0F, 3.0F));
    EXPECT_FLOAT_EQ(flight.sagittas[2].vertical, kOneChord * 3.0F);
}

TEST(PredictFlight, WithoutALagTheVelocityIsFlownOffAtTheLimit)
{
    vehicle::VehicleLimits limits;
    limits.velocity_lag = 0.0F;
    Prediction flight;
    predict_velocity_command(at_cruise(), Vec3::Zero(), 1.5F, 0.5F, limits, flight);
    EXPECT_FLOAT_EQ(flight.sagittas[2].any, 5.0F * 0.5F * 0.5F / 8.0F);
    EXPECT_LT(flight.velocity.norm(), 1e-5F);
    EXPECT_NEAR(flight.path.points.back().position.x(), 2.5F, 1e-4F);
}

TEST(SetpointsOf, CountsThoseBeforeTheEnd)
{
    EXPECT_EQ(setpoints_of(-1.0F), 0U);
    EXPECT_EQ(setpoints_of(0.0F), 0U);
    EXPECT_EQ(setpoints_of(0.001F), 1U);
    EXPECT_EQ(setpoints_of(1.01F), 21U);
    EXPECT_EQ(setpoints_of(1e30F), kMaxSetpoints);
    EXPECT_EQ(setpoints_of(std::numeric_limits<float>::quiet_NaN()), 0U);
}

TEST(ExtendByVelocityCommand, GoesOnFromTheTrueVelocity)
{
    Prediction flight;
    predict_velocity_command(at_cruise(), Vec3::Zero(), 0.5F, 0.2F, {}, flight);
    Prediction at_once;
    predict_velocity_command(at_cruise(), Vec3::Zero(), 2.0F, 0.2F, {}, at_once);
    extend_by_velocity_command(Vec3::Zero(), 1.5F, 0.2F, {}, flight);
    EXPECT_FLOAT_EQ(flight.path.duration(), 2.0F);
    EXPECT_LT((flight.path.points.back().position - at_once.path.points.back().position).norm(), 1e-5F);
    EXPECT_LT((flight.velocity - at_once.velocity).norm(), 1e-5F);
}

}  // namespace
}  // namespace jink::path
