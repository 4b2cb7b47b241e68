// SPDX-License-Identifier: BSD-3-Clause
// The movement automaton: what is planned, under way and flown, by the reach-set specification, section 4.2.
#include "core/reach/automaton.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace jink::reach {
namespace {

constexpr auto kStraight = Movement::straight;
constexpr auto kLeft = Movement::left;
constexpr auto kRight = Movement::right;

constexpr TimePoint at_second(double seconds) { return {static_cast<std::int64_t>(seconds * 1e6)}; }

class Automaton : public ::testing::Test {
protected:
    Segments segments;
    MovementAutomaton automaton{AutomatonSettings{}, segments};
    FlightState state;

    void SetUp() override { automaton.begin({}, at_second(0)); }
    float x_at(double seconds)
    {
        EXPECT_TRUE(automaton.project(at_second(seconds), state)) << seconds;
        return state.pose.position.x();
    }
};

/// The same figures as Predictor.ChainsTheExampleOfTheSource, movement by movement as time goes on.
TEST_F(Automaton, FliesTheExampleOfTheSource)
{
    FlightState stands;
    stands.speed = 0.0F;
    automaton.begin(stands, at_second(0));
    ASSERT_EQ(automaton.push({kStraight, 5.0F, 10.0F}), PushStatus::taken);
    ASSERT_EQ(automaton.push({kStraight, 10.0F, 0.0F}), PushStatus::taken);
    ASSERT_EQ(automaton.push({kStraight, 7.0F, 4.0F}), PushStatus::taken);
    ASSERT_EQ(automaton.step(at_second(5)), StepStatus::running);
    EXPECT_EQ(automaton.planned().size(), 2U) << "at its end an order is still under way";
    EXPECT_FLOAT_EQ(x_at(5), 50.0F);
    ASSERT_EQ(automaton.step(at_second(15)), StepStatus::running);
    EXPECT_FLOAT_EQ(x_at(15), 50.0F);
    ASSERT_EQ(automaton.step(at_second(22)), StepStatus::running);
    EXPECT_FLOAT_EQ(x_at(22), 78.0F);
    EXPECT_EQ(automaton.executed(), 2U);
    EXPECT_EQ(automaton.executed(1).order.duration, 10.0F);
    EXPECT_EQ(automaton.executed(1).begin, at_second(5));
    EXPECT_FALSE(automaton.project(at_second(22.1), state)) << "nothing is planned there";
    EXPECT_FALSE(automaton.project(at_second(14), state)) << "nor known of what is over";
}

TEST_F(Automaton, AFullPlanRefusesAndStaysAsItIs)
{
    for (std::size_t i = 0; i < kMaxPlanned; ++i) {
        ASSERT_EQ(automaton.push({kStraight, 1.0F, static_cast<float>(i)}), PushStatus::taken);
    }
    EXPECT_EQ(automaton.push({kLeft, 1.0F, 1.0F}), PushStatus::full);
    EXPECT_EQ(automaton.refused(), 1U);
    ASSERT_EQ(automaton.planned().size(), kMaxPlanned);
    for (std::size_t i = 0; i < kMaxPlanned; ++i) {
        EXPECT_EQ(automaton.planned()[i].movement, kStraight);
        EXPECT_EQ(automaton.planned()[i].speed, static_cast<float>(i));
    }
}

TEST_F(Automaton, WhatIsTooShortIsRefused)
{
    EXPECT_EQ(automaton.push({kLeft, 0.99F, 1.0F}), PushStatus::too_short);
    EXPECT_EQ(automaton.push({kLeft, NAN, 1.0F}), PushStatus::too_short);
    EXPECT_EQ(automaton.push({kLeft, 1.0F, NAN}), PushStatus::too_short);
    EXPECT_TRUE(automaton.planned().empty());
    EXPECT_EQ(automaton.refused(), 3U);
}

TEST_F(Automaton, ANewPlanNeverCutsWhatIsUnderWay)
{
    ASSERT_EQ(automaton.push({kLeft, 2.0F, 1.0F}), PushStatus::taken);
    ASSERT_EQ(automaton.push({kLeft, 1.0F, 1.0F}), PushStatus::taken);
    ASSERT_EQ(automaton.step(at_second(0.5)), StepStatus::running);
    const Leg before = automaton.running();
    const std::vector<Order> other{{kRight, 1.0F, 1.0F}, {kStraight, 1.0F, 1.0F}};
    ASSERT_EQ(automaton.replan(other), PushStatus::taken);
    ASSERT_EQ(automaton.step(at_second(1.9)), StepStatus::running);
    EXPECT_EQ(automaton.running().order.movement, kLeft);
    EXPECT_EQ(automaton.running().order.duration, before.order.duration);
    ASSERT_EQ(automaton.step(at_second(2.1)), StepStatus::running);
    EXPECT_EQ(automaton.running().order.movement, kRight);
    EXPECT_EQ(automaton.running_since(), at_second(2));
    // The end of the left turn is where the right one began.
    EXPECT_NEAR(automaton.running().from.pose.yaw, 2.0F * 15.0F * kPi / 180.0F, 1e-6F);
}

TEST_F(Automaton, ANewPlanIsTakenAsAWholeOrNotAtAll)
{
    ASSERT_EQ(automaton.push({kLeft, 1.0F, 1.0F}), PushStatus::taken);
    const std::vector<Order> bad{{kRight, 1.0F, 1.0F}, {kStraight, 0.5F, 1.0F}};
    EXPECT_EQ(automaton.replan(bad), PushStatus::too_short);
    const std::vector<Order> many(kMaxPlanned + 1, Order{});
    EXPECT_EQ(automaton.replan(many), PushStatus::full);
    ASSERT_EQ(automaton.planned().size(), 1U);
    EXPECT_EQ(automaton.planned()[0].movement, kLeft);
    EXPECT_EQ(automaton.refused(), bad.size() + many.size());
    EXPECT_EQ(automaton.replan({}), PushStatus::taken) << "nothing is a plan too";
    EXPECT_TRUE(automaton.planned().empty());
}

TEST_F(Automaton, AfterAPlanHasRunDryNothingBeginsUnasked)
{
    ASSERT_EQ(automaton.push({kLeft, 1.0F, 1.0F}), PushStatus::taken);
    EXPECT_EQ(automaton.step(at_second(1)), StepStatus::running);
    EXPECT_EQ(automaton.step(at_second(1.5)), StepStatus::ran_dry);
    EXPECT_FALSE(automaton.is_running());
    ASSERT_EQ(automaton.push({kLeft, 1.0F, 1.0F}), PushStatus::taken);
    EXPECT_EQ(automaton.step(at_second(1.6)), StepStatus::ran_dry) << "where the vehicle is now nobody has said";
    EXPECT_FALSE(automaton.project(at_second(1.6), state));
    automaton.begin({}, at_second(2));
    EXPECT_EQ(automaton.step(at_second(2)), StepStatus::ran_dry) << "nothing is planned yet, and nothing is late";
    ASSERT_EQ(automaton.push({kRight, 1.0F, 1.0F}), PushStatus::taken);
    EXPECT_EQ(automaton.step(at_second(2)), StepStatus::running);
    EXPECT_EQ(automaton.executed(), 1U);
}

TEST_F(Automaton, TimeThatGoesBackIsRefused)
{
    ASSERT_EQ(automaton.push({kLeft, 1.0F, 1.0F}), PushStatus::taken);
    ASSERT_EQ(automaton.step(at_second(0.5)), StepStatus::running);
    EXPECT_EQ(automaton.step(at_second(0.4)), StepStatus::went_back);
    EXPECT_TRUE(automaton.is_running());
}

TEST_F(Automaton, ASpeedThatIsTooFarIsRefusedWhenItsTurnComes)
{
    ASSERT_EQ(segments.set(0, {0.2F, 0.2F, 1.0F}), SegmentStatus::good);
    ASSERT_EQ(automaton.push({kStraight, 1.0F, 1.0F}), PushStatus::taken);
    ASSERT_EQ(automaton.push({kStraight, 1.0F, 3.0F}), PushStatus::taken);
    ASSERT_EQ(automaton.step(at_second(0.5)), StepStatus::running);
    EXPECT_EQ(automaton.step(at_second(1.5)), StepStatus::refused);
    EXPECT_FALSE(automaton.is_running());
}

TEST_F(Automaton, SettingsThatAreWrongDoNotRun)
{
    AutomatonSettings settings;
    settings.period = -1.0F;
    MovementAutomaton wrong{settings, segments};
    wrong.begin({}, at_second(0));
    EXPECT_EQ(wrong.step(at_second(0)), StepStatus::not_usable);
}

TEST_F(Automaton, StatesOutsideTheEnvelopeAreCounted)
{
    ASSERT_EQ(segments.split(Impact::speed, 5.0F, 10.0F, {}), SegmentStatus::good);
    ASSERT_EQ(automaton.push({kStraight, 1.0F, 6.0F}), PushStatus::taken);
    ASSERT_EQ(automaton.push({kStraight, 1.0F, 6.0F}), PushStatus::taken);
    ASSERT_EQ(automaton.step(at_second(1.5)), StepStatus::running);
    EXPECT_EQ(automaton.outside(), 1U) << "1 m/s before the first, 6 m/s before the second";
}

TEST_F(Automaton, TheLogKeepsTheNewestAndCountsTheRest)
{
    const std::size_t flown = 2 * kMaxExecuted + 7;
    for (std::size_t i = 0; i < flown; ++i) {
        ASSERT_EQ(automaton.push({kStraight, 1.0F, static_cast<float>(i)}), PushStatus::taken);
        ASSERT_EQ(automaton.step(at_second(static_cast<double>(i) + 1.0)), StepStatus::running);
    }
    EXPECT_EQ(automaton.executed(), kMaxExecuted);
    EXPECT_EQ(automaton.overwritten(), flown - 1 - kMaxExecuted) << "the last one is under way";
    EXPECT_EQ(automaton.executed(kMaxExecuted - 1).order.speed, static_cast<float>(flown - 2));
    EXPECT_EQ(automaton.executed(0).order.speed, static_cast<float>(flown - 1 - kMaxExecuted));
    EXPECT_EQ(automaton.executed(0).begin, at_second(static_cast<double>(flown - 1 - kMaxExecuted)));
}

/// A tick that comes late takes every order that has ended meanwhile.
TEST_F(Automaton, ALateStepCatchesUp)
{
    for (int i = 0; i < 4; ++i) {
        ASSERT_EQ(automaton.push({i == 3 ? kRight : kLeft, 1.0F, 1.0F}), PushStatus::taken);
    }
    ASSERT_EQ(automaton.step(at_second(3.5)), StepStatus::running);
    EXPECT_EQ(automaton.running().order.movement, kRight);
    EXPECT_EQ(automaton.executed(), 3U);
    EXPECT_NEAR(automaton.running().from.pose.yaw, 3.0F * 15.0F * kPi / 180.0F, 1e-6F);
}

TEST_F(Automaton, APlanMayBeAsLongAsThereIsRoom)
{
    const std::vector<Order> full(kMaxPlanned, Order{kRight, 1.0F, 2.0F});
    EXPECT_EQ(automaton.replan(full), PushStatus::taken);
    EXPECT_EQ(automaton.planned().size(), kMaxPlanned);
    EXPECT_EQ(automaton.planned()[0].movement, kRight);
    EXPECT_EQ(automaton.refused(), 0U);
}

TEST_F(Automaton, NothingBeginsBeforeTheVehicleIsPlaced)
{
    MovementAutomaton fresh{AutomatonSettings{}, segments};
    EXPECT_EQ(fresh.step(at_second(0)), StepStatus::ran_dry);
    ASSERT_EQ(fresh.push({kLeft, 1.0F, 1.0F}), PushStatus::taken);
    EXPECT_EQ(fresh.step(at_second(0)), StepStatus::ran_dry);
    EXPECT_FALSE(fresh.is_running());
    EXPECT_FALSE(fresh.project(at_second(0), state));
}

TEST_F(Automaton, APlanThatHasNotBegunIsKnownFromWhereTheVehicleIs)
{
    EXPECT_FALSE(automaton.project(at_second(0), state)) << "nothing is planned";
    ASSERT_EQ(automaton.push({kStraight, 1.0F, 3.0F}), PushStatus::taken);
    ASSERT_EQ(automaton.push({kStraight, 1.0F, 5.0F}), PushStatus::taken);
    EXPECT_FLOAT_EQ(x_at(0.5), 1.5F);
    EXPECT_FLOAT_EQ(x_at(2.0), 8.0F);
    EXPECT_FALSE(automaton.project(at_second(2.1), state));
    Trajectory all;
    EXPECT_EQ(automaton.trajectory(all), PredictStatus::complete);
    EXPECT_EQ(all.legs.size(), 2U);
}

/// Whole microseconds of the clock do not lose the end of a plan.
TEST_F(Automaton, TwoMicrosecondsPastTheEndAreTheEnd)
{
    ASSERT_EQ(automaton.push({kStraight, 2.0F, 1.0F}), PushStatus::taken);
    EXPECT_FLOAT_EQ(x_at(2.000002), 2.0F);
    EXPECT_EQ(state.pose.position.x(), 2.0F);
    EXPECT_FALSE(automaton.project(at_second(2.00001), state));
    ASSERT_EQ(automaton.step(at_second(1.0)), StepStatus::running);
    EXPECT_FLOAT_EQ(x_at(2.000002), 2.0F);
    EXPECT_FALSE(automaton.project(at_second(2.00001), state));
}

/// What begins anew forgets the plan and what is under way, keeps the log, and counts time from there.
TEST_F(Automaton, BeginningAnewForgetsThePlanAndKeepsTheLog)
{
    for (int i = 0; i < 3; ++i) {
        ASSERT_EQ(automaton.push({kLeft, 1.0F, 1.0F}), PushStatus::taken);
    }
    ASSERT_EQ(automaton.step(at_second(1.5)), StepStatus::running);
    FlightState there;
    there.pose.position = Vec3(7, 8, 9);
    there.speed = 4.0F;
    automaton.begin(there, at_second(1.0));
    EXPECT_FALSE(automaton.is_running());
    EXPECT_TRUE(automaton.planned().empty());
    EXPECT_EQ(automaton.executed(), 1U);
    ASSERT_EQ(automaton.push({kStraight, 1.0F, 2.0F}), PushStatus::taken);
    ASSERT_EQ(automaton.step(at_second(1.2)), StepStatus::running) << "it may begin earlier than the last step";
    EXPECT_EQ(automaton.running_since(), at_second(1.0));
    EXPECT_FLOAT_EQ(x_at(1.5), 8.0F) << "2 m/s for half a second";
}

/// A change of speed takes its time at the old speed; what was flown last says which change it is.
TEST_F(Automaton, ChangesAreThoseFromWhatWasFlownLast)
{
    AutomatonSettings slow;
    slow.transitions = {0.5F, 0.0F, 0.25F};
    MovementAutomaton changing{slow, segments};
    FlightState four;
    four.speed = 4.0F;
    changing.begin(four, at_second(0));
    ASSERT_EQ(changing.push({kStraight, 2.0F, 4.0F}), PushStatus::taken);
    ASSERT_EQ(changing.push({kLeft, 3.0F, 4.0F}), PushStatus::taken);
    ASSERT_EQ(changing.push({kLeft, 3.0F, 4.0F}), PushStatus::taken);
    ASSERT_EQ(changing.step(at_second(1)), StepStatus::running);
    EXPECT_EQ(changing.running().entry, 0.0F) << "it flew straight at this speed";
    ASSERT_EQ(changing.step(at_second(3)), StepStatus::running);
    EXPECT_EQ(changing.running().entry, 0.5F) << "from straight flight into a turn";
    EXPECT_EQ(changing.running().leave, 0.0F) << "a turn follows";
    ASSERT_EQ(changing.step(at_second(6)), StepStatus::running);
    EXPECT_EQ(changing.running().entry, 0.0F) << "it turns already";
    EXPECT_EQ(changing.running().leave, 0.5F) << "nothing follows";
    Trajectory all;
    ASSERT_EQ(changing.trajectory(all), PredictStatus::complete);
    ASSERT_EQ(all.legs.size(), 1U);
    EXPECT_EQ(all.begin, 0.0F);
    EXPECT_FLOAT_EQ(all.end(), 3.0F);
    EXPECT_EQ(all.start.pose.position, changing.running().from.pose.position);
}

TEST_F(Automaton, TheTrajectoryIsWhatIsUnderWayAndWhatIsPlanned)
{
    for (const Movement movement : {kLeft, kStraight, kRight}) {
        ASSERT_EQ(automaton.push({movement, 1.0F, 2.0F}), PushStatus::taken);
    }
    ASSERT_EQ(automaton.step(at_second(0.5)), StepStatus::running);
    Trajectory all;
    ASSERT_EQ(automaton.trajectory(all), PredictStatus::complete);
    ASSERT_EQ(all.legs.size(), 3U);
    EXPECT_EQ(all.legs[0].order.movement, kLeft);
    EXPECT_EQ(all.legs[1].order.movement, kStraight);
    EXPECT_EQ(all.legs[2].order.movement, kRight);
    EXPECT_EQ(all.legs[1].begin, 1.0F);
    EXPECT_EQ(all.end(), 3.0F);
}

}  // namespace
}  // namespace jink::reach
