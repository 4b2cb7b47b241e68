// SPDX-License-Identifier: BSD-3-Clause
// The simulator of many vehicles: its radio, its places, its measures.
#include "toolchain/sim/swarm.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/property/core/geometry/oracle.hpp"
#include "toolchain/sim/swarm_command.hpp"

namespace jink::sim {
namespace {

std::vector<std::byte> message(unsigned value) { return {static_cast<std::byte>(value), std::byte{7}}; }

TEST(Radio, EverybodyElseHearsItLaterAndInOrder)
{
    Radio radio(3, 0.0, 200'000, 1);
    radio.send(1, message(1), 0);
    radio.send(1, message(2), 5'000);
    EXPECT_TRUE(radio.take(0, 199'999).empty());
    EXPECT_EQ(radio.take(0, 200'000), message(1));
    EXPECT_TRUE(radio.take(0, 200'000).empty()) << "once";
    EXPECT_EQ(radio.take(0, 300'000), message(2));
    EXPECT_TRUE(radio.take(1, 300'000).empty()) << "not the sender";
    const std::vector<std::byte> both = radio.take(2, 300'000);
    ASSERT_EQ(both.size(), 4U);
    EXPECT_EQ(both[0], std::byte{1});
    EXPECT_EQ(both[2], std::byte{2});
}

TEST(Radio, LosesItsShareForEachReceiverByItself)
{
    constexpr int kMessages = 20'000;
    Radio radio(3, 0.1, 0, 2);
    int heard[3] = {};
    int both = 0;
    for (int i = 0; i < kMessages; ++i) {
        radio.send(0, message(1), i);
        const bool first = !radio.take(1, i).empty();
        const bool second = !radio.take(2, i).empty();
        heard[1] += first ? 1 : 0;
        heard[2] += second ? 1 : 0;
        both += first && second ? 1 : 0;
    }
    EXPECT_EQ(heard[0], 0);
    // Four standard deviations.
    EXPECT_NEAR(heard[1], 0.9 * kMessages, 170);
    EXPECT_NEAR(heard[2], 0.9 * kMessages, 170);
    EXPECT_NEAR(both, 0.81 * kMessages, 222) << "independent";
    Radio deaf(2, 1.0, 0, 3);
    deaf.send(0, message(1), 0);
    EXPECT_TRUE(deaf.take(1, 1).empty());
}

SwarmSetup small()
{
    SwarmSetup setup;
    setup.vehicles = 4;
    setup.circle = 6.0;
    setup.duration = 60.0;
    return setup;
}

TEST(Swarm, ChangesPlacesAcrossTheCircle)
{
    SwarmSetup setup = small();
    setup.vehicles = 5;  // an odd number: no vehicle starts at the opposite place
    setup.obstacles = 25;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        std::vector<Threat> obstacles;
        for (unsigned i = 0; i < setup.vehicles; ++i) {
            setup.back = i % 2 == 1;
            const Scenario s = swarm_scenario(setup, seed, i);
            EXPECT_EQ(s.system, i + 1);
            ASSERT_EQ(s.mission.size(), setup.back ? 3U : 2U);
            EXPECT_EQ(s.mission[0], s.start_position);
            const Vec home(0.0, 0.0, setup.height);
            EXPECT_NEAR((s.mission[1] - home).norm(), setup.circle, 1e-9);
            EXPECT_NEAR((s.mission[1] + s.mission[0] - 2.0 * home).norm(), 0.0, std::sqrt(3.0) * setup.spread + 1e-9);
            EXPECT_EQ(s.threats.size(), setup.obstacles);
            for (std::size_t k = 0; k < s.threats.size(); ++k) {
                const Threat& sphere = s.threats[k];
                EXPECT_GT((sphere.position - s.start_position).norm(), 2.5) << "room to begin";
                EXPECT_LE(sphere.velocity.norm(), 0.6 * setup.cruise) << "slower than any vehicle";
                EXPECT_EQ(sphere.velocity.z(), 0.0);
                if (i > 0) {
                    EXPECT_EQ(sphere.position, obstacles[k].position) << "the same for everybody";
                    EXPECT_EQ(sphere.velocity, obstacles[k].velocity);
                }
            }
            obstacles = s.threats;
        }
    }
}

TEST(Swarm, TiltedCircleStandsOnItsHeight)
{
    SwarmSetup setup = small();
    setup.spread = 0.0;
    for (const double tilt : {0.0, 30.0, 90.0}) {
        setup.tilt = tilt;
        double lowest = 1e9;
        for (unsigned i = 0; i < setup.vehicles; ++i) {
            const Scenario s = swarm_scenario(setup, 1, i);
            lowest = std::min(lowest, s.start_position.z());
            EXPECT_NEAR((s.mission[1] - s.start_position).norm(), 2.0 * setup.circle, 1e-9);
        }
        EXPECT_NEAR(lowest, setup.height, 1e-9);
    }
    const Vec top = swarm_scenario(setup, 1, 0).start_position;
    const Vec bottom = swarm_scenario(setup, 1, 2).start_position;
    EXPECT_NEAR((top - bottom - Vec(0.0, 0.0, 2.0 * setup.circle)).norm(), 0.0, 1e-9);
}

TEST(Swarm, RefusesParametersAndNumbersThatAreNone)
{
    SwarmSetup setup = small();
    setup.parameters = {{"JNK_NONE", 1.0}};
    EXPECT_THROW(static_cast<void>(swarm_parameters(setup)), std::runtime_error);
    setup.parameters = {{"JNK_LOOKAHEAD", 1000.0}};
    EXPECT_THROW(static_cast<void>(swarm_parameters(setup)), std::runtime_error);
    setup.parameters = {{"JNK_LOOKAHEAD", 5.0}, {"TRK_RADIUS", 0.5}};
    const app::Parameters parameters = swarm_parameters(setup);
    EXPECT_EQ(parameters.get(app::Param::lookahead), 5.0F);
    EXPECT_EQ(parameters.get(app::Param::track_radius), 0.5F) << "what is said wins";
    EXPECT_FLOAT_EQ(parameters.get(app::Param::half_xy), 0.45F);
    setup.vehicles = 65;
    EXPECT_THROW(Swarm(setup, 1), std::runtime_error);
    setup.vehicles = 1;
    EXPECT_THROW(Swarm(setup, 1), std::runtime_error);
}

TEST(Swarm, WithoutAvoidanceTheyMeetAndItIsSeen)
{
    SwarmSetup setup = small();
    setup.spread = 0.0;
    setup.parameters = {{"JNK_MODE", 0.0}};
    const SwarmResult result = fly_swarm(setup, 1, {});
    EXPECT_EQ(result.collisions, 6U) << "each with each, once";
    EXPECT_LT(result.distance, 0.01);
    EXPECT_LT(result.margin, 0.02);
    EXPECT_EQ(result.arrived, 4U);
    EXPECT_EQ(result.takeovers, 0U);
    EXPECT_FALSE(result.good());
    EXPECT_TRUE(result.faults.empty());
}

TEST(Swarm, OfFourChangesPlacesOverAPoorRadioBitByBitTheSame)
{
    SwarmSetup setup = small();
    setup.loss = 0.1;
    setup.delay = 0.2;
    setup.obstacles = 3;
    for (const Stack stack : {Stack::ardupilot, Stack::px4}) {
        setup.stack = stack;
        // With PX4 this seed takes 77 s; 47 s before old reports made vehicles wider. A shortfall (swarms.md).
        setup.duration = stack == Stack::px4 ? 90.0 : 60.0;
        const SwarmResult result = fly_swarm(setup, 3, {});
        EXPECT_TRUE(result.good()) << to_line(result);
        EXPECT_GE(result.margin, 1.0);
        EXPECT_GT(result.takeovers, 0U);
        EXPECT_EQ(to_line(fly_swarm(setup, 3, {})), to_line(result));
        EXPECT_NE(fly_swarm(setup, 4, {}).digest, result.digest);
    }
}

/// Fast ones whose reports are 2 m of flight old: seeds in which bodies touched before all could stop.
TEST(Swarm, FliesNoFasterThanAllCanStop)
{
    SwarmSetup setup;
    setup.delay = 0.4;
    struct Case {
        unsigned vehicles;
        double circle;
        double cruise;
        std::uint64_t seed;
    };
    for (const Case& c : {Case{13, 10.0, 5.0, 6}, {8, 10.0, 6.0, 1}, {13, 10.0, 6.0, 2}, {24, 15.0, 6.0, 2}}) {
        setup.vehicles = c.vehicles;
        setup.circle = c.circle;
        setup.cruise = c.cruise;
        const SwarmResult result = fly_swarm(setup, c.seed, {});
        EXPECT_TRUE(result.good()) << to_line(result);
        EXPECT_GE(result.margin, 1.0) << to_line(result);
    }
}

/// 97 of 100 reports are lost and the others are a second late: nothing is heard of the other one for seconds.
TEST(Swarm, StandsStillWhereAVehicleIsNotHeardAnyMore)
{
    SwarmSetup setup;
    setup.vehicles = 2;
    setup.circle = 60.0;
    setup.cruise = 6.0;
    setup.loss = 0.97;
    setup.delay = 1.0;
    for (const std::uint64_t seed : {8U, 13U, 17U, 29U}) {
        const SwarmResult result = fly_swarm(setup, seed, {});
        EXPECT_TRUE(result.good()) << to_line(result);
        EXPECT_GE(result.margin, 1.0) << to_line(result);
    }
}

/// Two with the bodies and separations of docs/evidence/pairs.md, `cruise` in m/s.
SwarmSetup two(double cruise)
{
    SwarmSetup setup;
    setup.vehicles = 2;
    setup.circle = 25.0;
    setup.level = 2.5;
    setup.vertical = 2.0;
    setup.body = 0.5;
    setup.cruise = cruise;
    return setup;
}

/// The age of reports rises and falls between them. Commands that jumped with it were taken for set-points that are not
/// followed, and the vehicle was left standing.
TEST(Swarm, OfTwoIsHeldBackSmoothly)
{
    struct Case {
        double sector;
        double cruise;
        std::uint64_t seed;
    };
    for (const Case& c :
         {Case{360.0, 15.0, 950004}, {180.0, 8.0, 950006}, {180.0, 8.0, 950009}, {180.0, 8.0, 950019}}) {
        SwarmSetup setup = two(c.cruise);
        setup.sector = c.sector;
        setup.delay = 1.0;
        const SwarmResult result = fly_swarm(setup, c.seed, {});
        EXPECT_TRUE(result.good()) << to_line(result);
    }
}

/// A manoeuvre and a stop took turns several times a second: the set-points were followed, as well as that can be.
TEST(Swarm, OfTwoThatGoAndStopIsNotAccused)
{
    SwarmSetup setup = two(15.0);
    setup.delay = 1.0;
    setup.both_stacks = true;
    setup.parameters = {{"JNK_METHODS", 1.0}};
    setup.others = {{"JNK_METHODS", 4.0}};
    for (const std::uint64_t seed : {950041U, 950187U}) {
        const SwarmResult result = fly_swarm(setup, seed, {});
        EXPECT_TRUE(result.good()) << to_line(result);
    }
}

/// Autopilots that accelerate twice as hard as VEH_ACC says, reports 1 s late and 60 % of them lost. Seeds in which two
/// that cross touched as long as nobody measured how hard the other one accelerates.
TEST(Swarm, OfTwoThatAccelerateHarderThanTheyShouldKeepsItsSeparations)
{
    SwarmSetup setup = two(15.0);
    setup.sector = 90.0;
    setup.delay = 1.0;
    setup.loss = 0.6;
    setup.acceleration = 4.0;
    setup.parameters = {{"VEH_ACC", 2.0}, {"VEH_ACC_Z", 2.0}};
    for (const std::uint64_t seed : {950009U, 950044U, 950063U, 950072U}) {
        const SwarmResult result = fly_swarm(setup, seed, {});
        EXPECT_EQ(result.collisions, 0U) << to_line(result);
        EXPECT_GE(result.margin, 1.0) << to_line(result);
    }
}

/// What a vehicle may have done unheard grows with its acceleration (docs/guides/common_stop.md). Eight whose goals are
/// 3.1 m apart, with reports 1 s late, do not get there at 2 m/s2: neighbours may be anywhere within 3.6 m.
TEST(Swarm, OfEightWithOldReportsArrivesAtASmallAcceleration)
{
    SwarmSetup setup;
    setup.vehicles = 8;
    setup.circle = 4.0;
    setup.cruise = 6.0;
    setup.delay = 1.0;
    setup.acceleration = 1.0;
    setup.duration = 100.0;
    for (const std::uint64_t seed : {1U, 2U}) {
        const SwarmResult result = fly_swarm(setup, seed, {});
        EXPECT_TRUE(result.good()) << to_line(result);
        EXPECT_GE(result.margin, 1.0) << to_line(result);
    }
}

/// Two head-on and crossing that hear of each other late: seeds in which both once chose the same side.
TEST(Swarm, OfTwoPassesOnItsSidesHoweverOldTheReports)
{
    SwarmSetup setup = two(5.0);
    for (const double sector : {360.0, 180.0}) {
        setup.sector = sector;
        for (const double delay : {0.3, 0.5, 1.0}) {
            setup.delay = delay;
            for (const std::uint64_t seed : {950000U, 950013U, 950158U}) {
                for (const double methods : {3.0, 7.0}) {
                    setup.others = {{"JNK_METHODS", methods}};  // beside one that has the delivered methods
                    const SwarmResult result = fly_swarm(setup, seed, {});
                    EXPECT_TRUE(result.good()) << sector << " " << delay << " " << methods << " " << to_line(result);
                }
            }
        }
    }
}

/// Two whose ways cross while both gain speed: reports a second old show each of them far behind where it is. Seeds in
/// which both once came to the crossing together.
TEST(Swarm, OfTwoThatCrossWhileTheyGainSpeedKeepsItsSeparations)
{
    SwarmSetup setup = two(10.0);
    setup.delay = 1.0;
    setup.loss = 0.5;
    for (const double sector : {180.0, 90.0}) {
        setup.sector = sector;
        for (const std::uint64_t seed : {960010U, 960017U, 960022U, 960029U}) {
            for (const double methods : {3.0, 4.0, 7.0}) {
                setup.others = {{"JNK_METHODS", methods}};
                const SwarmResult result = fly_swarm(setup, seed, {});
                EXPECT_TRUE(result.good()) << sector << " " << methods << " " << to_line(result);
                EXPECT_GE(result.margin, 1.0) << sector << " " << methods << " " << to_line(result);
            }
        }
    }
}

/// A vehicle that turns at its waypoint comes back at others, which had counted on it flying on; its autopilot
/// accelerates there as it likes, and nobody holds it back. Swarms in which bodies once touched, or nearly.
TEST(Swarm, ThatTurnsBackTouchesNobody)
{
    struct Case {
        unsigned vehicles;
        double circle, sector, tilt, cruise, delay, loss, level, vertical, body;
        double methods, others;  // others 0: the same
        Stack stack;
        std::uint64_t seed;
    };
    constexpr Case kCases[] = {
        {2, 44.5, 314, 0, 10.65, 0.38, 0.13, 2.5, 2.0, 0.5, 7, 1, Stack::ardupilot, 7001681},
        {2, 32.1, 51, 0, 9.83, 0.49, 0.33, 0.7, 0.5, 0.25, 3, 0, Stack::ardupilot, 7002211},
        {2, 32.1, 51, 0, 9.83, 0.49, 0.33, 0.7, 0.5, 0.25, 3, 0, Stack::ardupilot, 7002214},
        {3, 48.1, 360, 28, 13.59, 0.46, 0.08, 2.5, 2.0, 0.5, 1, 0, Stack::ardupilot, 7000831},
        {3, 14.9, 40, 88, 7.4, 0.06, 0.1, 0.7, 0.5, 0.25, 7, 5, Stack::ardupilot, 7001322},
        {3, 13.1, 90, 38, 11.89, 0.34, 0.1, 2.5, 2.0, 0.5, 2, 0, Stack::px4, 7002711},
    };
    for (const Case& c : kCases) {
        SwarmSetup setup;
        setup.vehicles = c.vehicles;
        setup.circle = c.circle;
        setup.sector = c.sector;
        setup.tilt = c.tilt;
        setup.cruise = c.cruise;
        setup.back = true;
        setup.level = c.level;
        setup.vertical = c.vertical;
        setup.body = c.body;
        setup.delay = c.delay;
        setup.loss = c.loss;
        setup.duration = 90.0;
        setup.stack = c.stack;
        setup.parameters = {{"JNK_METHODS", c.methods}};
        if (c.others > 0.0) {
            setup.others = {{"JNK_METHODS", c.others}};
        }
        const SwarmResult result = fly_swarm(setup, c.seed, {});
        EXPECT_EQ(result.collisions, 0U) << to_line(result);
        EXPECT_TRUE(result.faults.empty()) << to_line(result);
        EXPECT_GE(result.margin, 0.9) << to_line(result);
    }
}

/// Whatever the swarm, there and back or with ways that merge: no contact.
TEST(Swarm, TouchesNobodyAtRandom)
{
    const std::size_t cases = geometry::oracle::case_count(40);
    for (std::size_t i = 0; i < cases; ++i) {
        const std::uint64_t seed = geometry::oracle::seed_of(77) + i;
        Random random(seed);
        SwarmSetup setup;
        setup.vehicles = 2 + static_cast<unsigned>(random.below(2));
        setup.back = random.below(3) != 0;
        setup.cruise = double(random.uniform(6.0F, 15.0F));
        setup.delay = double(random.uniform(0.0F, 1.0F));
        setup.loss = double(random.uniform(0.0F, 0.6F));
        setup.stack = random.below(2) == 0 ? Stack::px4 : Stack::ardupilot;
        setup.both_stacks = random.below(2) == 0;
        const double size = double(random.uniform(0.25F, 1.0F));
        setup.body = size;
        setup.level = 5.0 * size;
        setup.vertical = 3.0 * size;
        setup.circle = double(random.uniform(12.0F, 50.0F));
        setup.sector = random.below(2) == 0 ? 360.0 : double(random.uniform(40.0F, 300.0F));
        setup.tilt = random.below(3) == 0 ? double(random.uniform(0.0F, 90.0F)) : 0.0;
        setup.duration = 90.0;
        setup.parameters = {{"JNK_METHODS", double(1 + random.below(7))}};
        setup.others = {{"JNK_METHODS", double(1 + random.below(7))}};
        const SwarmResult result = fly_swarm(setup, seed, {});
        EXPECT_EQ(result.collisions, 0U) << seed << ": " << to_line(result);
        EXPECT_TRUE(result.faults.empty()) << seed << ": " << to_line(result);
    }
}

TEST(Swarm, AndBackAgain)
{
    SwarmSetup setup = small();
    setup.back = true;
    const SwarmResult result = fly_swarm(setup, 1, {});
    EXPECT_TRUE(result.good()) << to_line(result);
    EXPECT_GT(result.time, 4.0 * setup.circle / setup.cruise * 0.9) << "twice across";
}

TEST(Swarm, WhoHearsNobodyAvoidsNobody)
{
    SwarmSetup setup = small();
    setup.spread = 0.0;
    setup.loss = 1.0;
    const SwarmResult result = fly_swarm(setup, 1, {});
    EXPECT_EQ(result.takeovers, 0U);
    EXPECT_EQ(result.collisions, 6U);
}

TEST(Swarm, TimeThatRunsOutIsAGoalMissed)
{
    SwarmSetup setup = small();
    setup.duration = 5.0;
    const SwarmResult result = fly_swarm(setup, 1, {});
    EXPECT_EQ(result.arrived, 0U);
    EXPECT_NEAR(result.time, 5.0, 0.01);
    EXPECT_FALSE(result.good());
}

TEST(Swarm, SummaryNamesTheWorst)
{
    SwarmResult a;
    a.seed = 1;
    a.vehicles = a.arrived = 4;
    a.distance = 0.9;
    a.margin = 1.2;
    a.time = 20.0;
    a.jumps = 2;
    SwarmResult b = a;
    b.seed = 2;
    b.margin = 0.8;
    b.stall = 3.0;
    SwarmResult c = a;
    c.seed = 3;
    c.collisions = 1;
    c.distance = 0.4;
    c.arrived = 3;
    c.obstacle = 0.3;
    c.time = 60.0;
    const std::string text = summarise({a, b, c});
    EXPECT_NE(text.find("3 swarms: 1 with collisions, 1 with goals missed, 1 nearer than the separations"),
              std::string::npos);
    EXPECT_NE(text.find("least distance 0.400 m (seed 3), least margin 0.800 (seed 2), least to an obstacle 0.300 m"),
              std::string::npos);
    EXPECT_NE(text.find("longest stall 3.00 s (seed 2), time median 20.00 s, most 60.00 s, 6 jumps of the command"),
              std::string::npos);
}

}  // namespace
}  // namespace jink::sim
