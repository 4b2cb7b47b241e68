// SPDX-License-Identifier: BSD-3-Clause
// Trajectories of orders: the reference result of the reach-set specification, section 4.3 (Gomola 6.2.2), and the
// requirements of sections 4 to 7.
#include "tests/reference/reach/predictor.hpp"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace jink::reach {
namespace {

constexpr auto kGoStraight = Movement::straight;
constexpr auto kGoLeft = Movement::left;

FlightState standing()
{
    FlightState state;
    state.speed = 0.0F;
    return state;
}

/// Stay is straight at speed 0, Move(v) straight at v.
const std::vector<Order> kExample{{kGoStraight, 5.0F, 10.0F}, {kGoStraight, 10.0F, 0.0F}, {kGoStraight, 7.0F, 4.0F}};

/// Section 4.3, REFERENCE RESULTS: Move 5 s at 10 m/s, Stay 10 s, Move 7 s at 4 m/s; p(5) = 50, p(15) = 50, p(22) = 78.
TEST(Predictor, ChainsTheExampleOfTheSource)
{
    Trajectory trajectory;
    ASSERT_EQ(predict({}, Segments(), standing(), {kGoStraight, 0.0F}, 0.0F, kExample, trajectory),
              PredictStatus::complete);
    EXPECT_EQ(trajectory.end(), 22.0F);
    const auto p = [&](float t) {
        FlightState state;
        EXPECT_TRUE(project(trajectory, t, state)) << t;
        EXPECT_EQ(state.pose.position.y(), 0.0F);
        return state.pose.position.x();
    };
    EXPECT_FLOAT_EQ(p(5.0F), 50.0F);
    EXPECT_FLOAT_EQ(p(15.0F), 50.0F);
    EXPECT_FLOAT_EQ(p(22.0F), 78.0F);
    EXPECT_FLOAT_EQ(p(2.5F), 25.0F);
    EXPECT_FLOAT_EQ(p(0.0F), 0.0F);
}

/// Intervals are (begin, end]: at the end of one order the state is its own, not the next one's.
TEST(Predictor, TheEndOfAnOrderIsItsOwn)
{
    Trajectory trajectory;
    ASSERT_EQ(predict({}, Segments(), standing(), {kGoStraight, 0.0F}, 0.0F, kExample, trajectory),
              PredictStatus::complete);
    FlightState state;
    ASSERT_TRUE(project(trajectory, 0.0F, state));
    EXPECT_EQ(state.speed, 0.0F) << "the start is the state before any order";
    ASSERT_TRUE(project(trajectory, 5.0F, state));
    EXPECT_EQ(state.speed, 10.0F);
    ASSERT_TRUE(project(trajectory, std::nextafter(5.0F, 6.0F), state));
    EXPECT_EQ(state.speed, 0.0F);
}

TEST(Predictor, OutsideOfItsTimesATrajectoryHasNoState)
{
    Trajectory trajectory;
    ASSERT_EQ(predict({}, Segments(), standing(), {}, 3.0F, kExample, trajectory), PredictStatus::complete);
    FlightState state;
    state.speed = 42.0F;
    EXPECT_FALSE(project(trajectory, std::nextafter(3.0F, 0.0F), state));
    EXPECT_FALSE(project(trajectory, std::nextafter(25.0F, 30.0F), state));
    EXPECT_FALSE(project(trajectory, std::numeric_limits<float>::quiet_NaN(), state));
    EXPECT_EQ(state.speed, 42.0F) << "nothing is written";
    EXPECT_TRUE(project(trajectory, 3.0F, state));
    EXPECT_TRUE(project(trajectory, 25.0F, state));
    ASSERT_EQ(predict({}, Segments(), standing(), {}, 3.0F, {}, trajectory), PredictStatus::complete);
    EXPECT_TRUE(project(trajectory, 3.0F, state)) << "no order: the start alone";
    EXPECT_FALSE(project(trajectory, 3.1F, state));
}

/// Section 4.1: changes are flown straight before the order is, and straight flight is reached at the end.
TEST(Predictor, TheBuilderPutsInTheChanges)
{
    AutomatonSettings settings;
    settings.transitions = {0.2F, 0.1F, 0.4F};
    const FlightState start;
    const std::vector<Order> orders{{kGoLeft, 2.0F, 1.0F}, {Movement::right, 2.0F, 1.0F}, {Movement::up, 2.0F, 3.0F}};
    Trajectory t;
    ASSERT_EQ(predict(settings, Segments(), start, {kGoStraight, 1.0F}, 0.0F, orders, t), PredictStatus::complete);
    EXPECT_FLOAT_EQ(t.legs[0].entry, 0.2F);
    EXPECT_EQ(t.legs[0].leave, 0.0F) << "something follows";
    EXPECT_FLOAT_EQ(t.legs[1].entry, 0.4F) << "out of one turn and into the other";
    EXPECT_FLOAT_EQ(t.legs[2].entry, 0.4F) << "three changes at once, of which speed takes longest";
    EXPECT_FLOAT_EQ(t.legs[2].leave, 0.1F);
    FlightState state;
    ASSERT_TRUE(project(t, 0.2F, state));
    EXPECT_EQ(state.pose.yaw, 0.0F);
    EXPECT_NEAR(state.pose.position.x(), 0.2F, 1e-6F);
    ASSERT_TRUE(project(t, 2.0F, state));
    EXPECT_NEAR(state.pose.yaw, 1.8F * 15.0F * kPi / 180.0F, 1e-6F) << "15 degrees a second for the time that is left";
    ASSERT_TRUE(project(t, 6.0F, state));
    EXPECT_NEAR(state.pose.yaw, 0.2F * 15.0F * kPi / 180.0F, 1e-6F);
    EXPECT_NEAR(state.pose.pitch, -1.5F * 15.0F * kPi / 180.0F, 1e-6F);
    ASSERT_TRUE(project(t, 4.39F, state));
    EXPECT_EQ(state.speed, 1.0F) << "the old speed until the change is over";
    ASSERT_TRUE(project(t, 4.41F, state));
    EXPECT_EQ(state.speed, 3.0F);
}

/// Equation 6.7 with the maximum of the sum over possible transitions before and after.
TEST(Predictor, TheLeastDurationHasRoomForAllChanges)
{
    AutomatonSettings settings;
    EXPECT_EQ(least_duration(settings, {kGoStraight, 1.0F, 1.0F}), 1.0F);
    settings.least_holding = 0.5F;
    settings.transitions = {0.2F, 0.05F, 0.1F};
    EXPECT_FLOAT_EQ(least_duration(settings, {kGoStraight, 1.0F, 1.0F}), 0.5F + 0.2F);
    EXPECT_FLOAT_EQ(least_duration(settings, {kGoLeft, 1.0F, 1.0F}), 0.5F + 0.4F + 0.2F);
    EXPECT_FLOAT_EQ(least_duration(settings, {Movement::up, 1.0F, 1.0F}), 0.5F + 0.2F + 0.05F);
    Trajectory t;
    const Order good{kGoLeft, 1.1F, 1.0F};
    const Order bad{kGoLeft, 1.09F, 1.0F};
    EXPECT_EQ(predict(settings, Segments(), {}, {}, 0.0F, {&good, 1}, t), PredictStatus::complete);
    EXPECT_EQ(predict(settings, Segments(), {}, {}, 0.0F, {&bad, 1}, t), PredictStatus::refused);
    EXPECT_EQ(t.not_emitted, 1U);
    EXPECT_TRUE(t.legs.empty());
}

TEST(Predictor, WhatCannotBeFlownEndsTheTrajectory)
{
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    const std::vector<Order> wrong{{kGoLeft, kNaN, 1.0F},     {kGoLeft, -1.0F, 1.0F},
                                   {kGoLeft, INFINITY, 1.0F}, {kGoLeft, 1.0F, kNaN},
                                   {kGoLeft, 1.0F, -1.0F},    {static_cast<Movement>(9), 1.0F, 1.0F}};
    for (const Order& order : wrong) {
        const std::vector<Order> orders{{kGoStraight, 1.0F, 1.0F}, order, {kGoStraight, 1.0F, 1.0F}};
        Trajectory t;
        EXPECT_EQ(predict({}, Segments(), {}, {}, 0.0F, orders, t), PredictStatus::refused);
        EXPECT_EQ(t.legs.size(), 1U);
        EXPECT_EQ(t.not_emitted, 2U);
    }
    AutomatonSettings settings;
    settings.period = 0.0F;
    Trajectory t;
    EXPECT_EQ(predict(settings, Segments(), {}, {}, 0.0F, kExample, t), PredictStatus::bad_setting);
    settings = {};
    settings.transitions.turn = kNaN;
    EXPECT_FALSE(is_usable(settings));
}

/// Equation 6.48: the turn of each movement is that of the segment its state before is in.
TEST(Predictor, TheSegmentIsThatOfTheStateBefore)
{
    Segments segments;
    const float separators[] = {5.0F};
    ASSERT_EQ(segments.split(Impact::speed, 0.0F, 10.0F, separators), SegmentStatus::good);
    ASSERT_EQ(segments.set(0, {0.1F, 0.1F, 100.0F}), SegmentStatus::good);
    ASSERT_EQ(segments.set(1, {0.1F, 0.4F, 2.0F}), SegmentStatus::good);
    FlightState start;
    start.speed = 4.0F;
    std::vector<Order> orders{{kGoLeft, 1.0F, 6.0F}, {kGoLeft, 1.0F, 6.0F}, {kGoLeft, 1.0F, 12.0F}};
    Trajectory t;
    EXPECT_EQ(predict({}, segments, start, {kGoStraight, 4.0F}, 0.0F, orders, t), PredictStatus::refused)
        << "6 m/s more than the segment has";
    ASSERT_EQ(t.legs.size(), 2U);
    EXPECT_NEAR(at(t.legs[0], 1.0F).pose.yaw, 0.1F, 1e-6F) << "slow before, though fast in it";
    EXPECT_NEAR(at(t.legs[1], 1.0F).pose.yaw, 0.5F, 1e-6F);
    EXPECT_EQ(t.outside, 0U);
    orders = {{kGoStraight, 1.0F, 12.0F}, {kGoStraight, 1.0F, 12.0F}};
    start.speed = 11.0F;
    EXPECT_EQ(predict({}, segments, start, {kGoStraight, 11.0F}, 0.0F, orders, t), PredictStatus::complete);
    EXPECT_EQ(t.outside, 2U) << "beyond the envelope, and said so";
}

/// Section 7: n + 1 samples, or n M + 1; orders beyond the capacity are counted.
TEST(Predictor, SamplesHaveTheStartAndEveryEnd)
{
    Trajectory t;
    ASSERT_EQ(predict({}, Segments(), standing(), {kGoStraight, 0.0F}, 100.0F, kExample, t), PredictStatus::complete);
    Reference reference;
    ASSERT_EQ(sample(t, 1, reference), PredictStatus::complete);
    ASSERT_EQ(reference.samples.size(), 4U);
    const float times[] = {100.0F, 105.0F, 115.0F, 122.0F};
    const float places[] = {0.0F, 50.0F, 50.0F, 78.0F};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(reference.samples[i].time, times[i]);
        EXPECT_FLOAT_EQ(reference.samples[i].position.x(), places[i]);
    }
    ASSERT_EQ(sample(t, 4, reference), PredictStatus::complete);
    EXPECT_EQ(reference.samples.size(), 13U);
    EXPECT_FLOAT_EQ(reference.samples[2].position.x(), 25.0F);
    EXPECT_EQ(sample(t, 0, reference), PredictStatus::bad_setting);
}

TEST(Predictor, WhatThereIsNoRoomForIsCounted)
{
    const std::vector<Order> orders(kMaxLegs + 5, Order{});
    Trajectory t;
    EXPECT_EQ(predict({}, Segments(), {}, {}, 0.0F, orders, t), PredictStatus::truncated);
    EXPECT_EQ(t.legs.size(), kMaxLegs);
    EXPECT_EQ(t.not_emitted, 5U);
    Reference reference;
    EXPECT_EQ(sample(t, 1, reference), PredictStatus::truncated) << "the trajectory already is";
    EXPECT_EQ(reference.samples.size(), kMaxLegs + 1);
    EXPECT_EQ(reference.not_emitted, 5U);
    EXPECT_EQ(sample(t, 8, reference), PredictStatus::truncated);
    EXPECT_EQ(reference.samples.size(), 16U * 8U + 1U);
    EXPECT_EQ(reference.not_emitted, kMaxLegs - 16U + 5U);
}

}  // namespace
}  // namespace jink::reach
