// SPDX-License-Identifier: BSD-3-Clause
// The judge of avoidability, the outcome of a flight, and that flights in process repeat byte by byte.
#include <gtest/gtest.h>

#include "toolchain/sim/judge.hpp"

#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/plant.hpp"
#include "toolchain/sim/random_scenario.hpp"
#include "toolchain/sim/report.hpp"

namespace jink::sim {
namespace {

Scenario with_standing_threat(double seen_within)
{
    Scenario s;
    s.name = "test";
    s.mission = {Vec(0, 0, 30), Vec(100, 0, 30)};
    s.start_position = s.mission[0];
    s.start_velocity = Vec(5, 0, 0);
    s.traffic.latency = 0.0;
    Threat threat;
    threat.name = "sphere";
    threat.radius = 2.0;
    threat.position = threat.collision_point = Vec(40, 0, 30);
    threat.sensed_by = SensedBy::point;
    threat.appears_when_own_within = seen_within;
    s.threats = {threat};
    s.expect.outcomes = {Outcome::avoided};
    return s;
}

TEST(Judge, FindsAWayWhenThereIsRoomAndNoneWhenThereIsNot)
{
    const Verdict far = judge(with_standing_threat(30.0));
    EXPECT_TRUE(far.conflict);
    EXPECT_TRUE(far.avoidable);
    EXPECT_EQ(far.tried, 721U);
    EXPECT_GT(far.keep, 500U);
    // 3.5 m from the centre at 5 m/s, surface 1.5 m away: neither stopping nor turning helps.
    const Verdict close = judge(with_standing_threat(3.5));
    EXPECT_TRUE(close.conflict);
    EXPECT_FALSE(close.avoidable);
    EXPECT_EQ(close.keep, 0U);
    EXPECT_LT(close.best, 0.7);
}

/// If the least separation precedes the report of the threat, the failure is unavoidable, independent of later
/// manoeuvres.
TEST(Report, AThreatReportedOfTooLateIsNoFailureToAvoid)
{
    Scenario s = with_standing_threat(30.0);
    s.duration = 20.0;
    s.threats[0].appears_when_own_within.reset();
    for (const double appears : {10.0, 1e9}) {  // abeam at 8 s; later, or never
        s.threats[0].appears_at = appears;
        const ReportedFlight flight = report_on(s, fly_in_process(s), true);
        ASSERT_LT(flight.record.closest.surface, s.promise);
        EXPECT_TRUE(flight.reported_too_late);
        EXPECT_FALSE(flight.failed_avoidable);
    }
    s.threats[0].appears_at = 7.2;  // 4 m before its centre
    const ReportedFlight late = report_on(s, fly_in_process(s), true);
    ASSERT_LT(late.record.closest.surface, s.promise);
    EXPECT_FALSE(late.reported_too_late);
    EXPECT_EQ(late.last_chance.tried, 721U);
    EXPECT_FALSE(late.failed_avoidable);
    EXPECT_EQ(late.late_chance.tried, 721U);
    EXPECT_NEAR(late.late_chance.detected, late.last_chance.detected + kReaction, 0.02 + 1e-9);
    EXPECT_LT(late.late_chance.best, late.last_chance.best);
}

TEST(Judge, SeesNoConflictBesideTheWay)
{
    Scenario s = with_standing_threat(30.0);
    s.threats[0].position.y() = 2.0 + s.promise + 0.01;
    EXPECT_FALSE(judge(s).conflict);
    s.threats[0].position.y() = 2.0 + s.promise - 0.01;
    EXPECT_TRUE(judge(s).conflict);
}

TEST(Judge, ThreatsNotYetReportedOfAreNoConflictButCountAgainstEveryManoeuvre)
{
    Scenario s = with_standing_threat(30.0);
    s.threats[0].appears_when_own_within.reset();
    s.threats[0].appears_at = 1e9;
    EXPECT_FALSE(judge(s).conflict);
    s = with_standing_threat(30.0);
    Threat cage = s.threats[0];
    cage.appears_when_own_within.reset();
    cage.appears_at = 1e9;
    cage.radius = 1.0;
    cage.position = Vec(10.0, 0, 30);  // the vehicle's position when the other threat is detected
    s.threats.push_back(cage);
    EXPECT_EQ(judge(s).keep, 0U);
}

TEST(Judge, TheFloorShutsTheWayBelow)
{
    Scenario s = with_standing_threat(8.0);
    const unsigned free = judge(s).keep;
    s.floor = 29.0;
    const unsigned low = judge(s).keep;
    EXPECT_LT(low, free);
    EXPECT_GT(low, 0U);
}

/// The outcome, from hand-made records.
class Conclusion : public ::testing::Test {
protected:
    Scenario scenario = with_standing_threat(30.0);
    Record record;

    void SetUp() override
    {
        record.closest.surface = 3.0;
        record.takeovers = 1;
        record.duration = 20.0;
        record.lowest = 30.0;
        record.heard.heartbeats = 20;
    }
    Outcome concluded()
    {
        conclude(scenario, record);
        return record.outcome;
    }
};

TEST_F(Conclusion, Avoided) { EXPECT_EQ(concluded(), Outcome::avoided); }
TEST_F(Conclusion, Clear)
{
    record.takeovers = 0;
    EXPECT_EQ(concluded(), Outcome::clear);
}
TEST_F(Conclusion, Braked)
{
    record.longest_hold = 0.6;
    EXPECT_EQ(concluded(), Outcome::braked);
}
TEST_F(Conclusion, Breach)
{
    record.closest.surface = 0.699;
    EXPECT_EQ(concluded(), Outcome::breach);
}
TEST_F(Conclusion, Collision)
{
    record.closest.surface = 0.499;
    EXPECT_EQ(concluded(), Outcome::collision);
}
TEST_F(Conclusion, EachBrokenRuleFails)
{
    const auto fails = [&](auto&& break_it) {
        Record copy = record;
        break_it(copy);
        conclude(scenario, copy);
        return copy.outcome == Outcome::failed && copy.faults.size() == 1;
    };
    EXPECT_TRUE(fails([](Record& r) { r.heard.heartbeats = 0; }));
    EXPECT_TRUE(fails([](Record& r) { r.heard.bad_setpoints = 1; }));
    EXPECT_TRUE(fails([](Record& r) { r.heard.setpoints_overruled = 1; }));
    EXPECT_TRUE(fails([](Record& r) { r.heard.frames_refused = 1; }));
    EXPECT_TRUE(fails([](Record& r) { r.heard.longest_heartbeat_gap = 2 * kSecond; }));
    EXPECT_TRUE(fails([](Record& r) { r.heard.longest_setpoint_gap = kSecond; }));
    EXPECT_TRUE(fails([](Record& r) { r.final_mode = Mode::external; }));
    EXPECT_TRUE(fails([](Record& r) { r.faults.emplace_back("another"); }));
    EXPECT_TRUE(fails([](Record& r) { r.below_floor = true; }));
}
TEST_F(Conclusion, AConflictThatIsStillWarnedOfMayEndInExternalMode)
{
    record.final_mode = Mode::external;
    record.heard.last_warning = 18 * kSecond;
    EXPECT_EQ(concluded(), Outcome::avoided);
}
TEST_F(Conclusion, ExpectationsAreComparedOneByOne)
{
    conclude(scenario, record);
    EXPECT_TRUE(unmet(scenario, record).empty());
    scenario.expect.given_back = true;
    scenario.expect.final_mode = Mode::hold;
    scenario.expect.flips_at_most = 0;
    scenario.expect.outcomes = {Outcome::clear, Outcome::braked};
    record.flips = 1;
    EXPECT_EQ(unmet(scenario, record).size(), 4U);
}

/// A leg that leads below the floor is permitted; leaving a leg above the floor downwards is a fault.
TEST(InProcess, TheFloorIsBrokenWhereTheLegIsNot)
{
    Scenario s = with_standing_threat(30.0);
    s.threats[0].position.y() = 60.0;  // far from the leg
    s.floor = 20.0;
    s.mission[1] = Vec(100, 0, 0);
    s.start_velocity = along(s.mission[1] - s.mission[0], s.vehicle.cruise, s.vehicle);
    s.duration = 19.0;
    const Record down = fly_in_process(s);
    EXPECT_LT(down.lowest, 10.0);
    EXPECT_FALSE(down.below_floor);
    EXPECT_EQ(down.outcome, Outcome::clear);
    // The same flight, started so low that the leg, at first above the floor, is reached from below.
    s.start_position.z() = 19.0;
    const Record low = fly_in_process(s);
    EXPECT_TRUE(low.below_floor);
    EXPECT_EQ(low.outcome, Outcome::failed);
    // An autopilot that follows its own leg down through the floor is below it a little sooner.
    const Vec down_the_leg = s.mission[1] - s.mission[0];
    s.start_position = s.mission[0] + (20.2 - s.mission[0].z()) / down_the_leg.z() * down_the_leg - Vec(0, 0, 0.3);
    const Record follows = fly_in_process(s);
    EXPECT_LT(follows.lowest, 19.0);
    EXPECT_FALSE(follows.below_floor);
    // One that believes to be higher than it is still follows its leg.
    s.start_position = s.mission[0];
    s.own.bias_vertical = 1.0;
    s.own.bias_time = 60.0;
    for (s.seed = 1; s.seed <= 20; ++s.seed) {
        EXPECT_FALSE(fly_in_process(s).below_floor) << "seed " << s.seed;
    }
}

TEST(InProcess, TheSameSeedGivesTheSameBytes)
{
    for (const std::uint64_t seed : {3ULL, 12ULL}) {
        const Scenario s = random_scenario(seed);
        const std::string one = run_text({report_on(s, fly_in_process(s), true)}, true);
        const std::string two = run_text({report_on(s, fly_in_process(s), true)}, true);
        EXPECT_EQ(one, two) << "seed " << seed;
        EXPECT_GT(one.size(), 1000U);
    }
}

TEST(InProcess, WithoutACoprocessorTheMissionFliesIntoTheThreat)
{
    const Scenario s = with_standing_threat(30.0);
    EXPECT_NEAR(fly_alone(s).closest.surface, -2.0, 0.01);
}

TEST(InProcess, AParameterThatIsNotTakenFailsTheFlight)
{
    Scenario s = with_standing_threat(30.0);
    s.parameters["JNK_SETTLE"] = 99.0;  // beyond its range
    const Record record = fly_in_process(s);
    EXPECT_EQ(record.outcome, Outcome::failed);
    ASSERT_FALSE(record.faults.empty());
    EXPECT_EQ(record.faults[0], "parameter JNK_SETTLE was not taken");
}

}  // namespace
}  // namespace jink::sim
