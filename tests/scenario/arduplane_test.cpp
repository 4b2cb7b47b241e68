// SPDX-License-Identifier: BSD-3-Clause
// Planes: the simulated ArduPlane behaves as ArduPlane's sources specify, and jink keeps it clear of traffic.
// JINK_CASES and JINK_SEED.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "toolchain/sim/arduplane.hpp"
#include "toolchain/sim/autopilot.hpp"
#include "toolchain/sim/geodesy.hpp"
#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/scenario_file.hpp"
#include "toolchain/sim/timing.hpp"

namespace jink::sim {
namespace {

using link::mavlink::CommandInt;

constexpr std::uint8_t kTaken = 0, kRefused = 2, kNotThere = 3, kWrongMode = 4;

TruthLimits plane_limits()
{
    TruthLimits limits;
    limits.cruise = 18.0;
    limits.min_speed = 12.0;
    limits.max_acceleration = 5.66;
    limits.max_vertical_acceleration = 1.5;
    limits.max_climb = limits.max_descent = 2.5;
    return limits;
}

CommandInt reposition(const Vec& place)
{
    const GlobalPosition global = to_global(place, Stack::ardupilot);
    CommandInt m;
    m.command = 192;
    m.frame = 5;
    m.x = global.lat;
    m.y = global.lon;
    m.z = static_cast<float>(global.alt) * 1e-3F;
    return m;
}

Truth eastward()
{
    Truth truth;
    truth.position = Vec(0, 0, 100);
    truth.velocity = Vec(18, 0, 0);
    return truth;
}

void fly_guided(Truth& truth, const PlaneGuidance& guidance, const TruthLimits& limits, double seconds)
{
    for (double t = 0.0; t < seconds; t += 0.01) {
        move_plane(truth, guidance.command(truth), limits, 0.01);
    }
}

TEST(SimPlane, TakesGuidedPointsInGuidedAlone)
{
    const TruthLimits limits = plane_limits();
    PlaneGuidance guidance(limits);
    const Vec here(0, 0, 100);
    guidance.hold(here);
    const Vec there(300, 400, 110);
    EXPECT_EQ(guidance.hear(reposition(there), false, here), kWrongMode);
    EXPECT_EQ(guidance.point(), here);
    CommandInt m = reposition(there);
    m.command = 43002;
    EXPECT_EQ(guidance.hear(m, true, here), kNotThere);
    m = reposition(there);
    m.frame = 1;
    EXPECT_EQ(guidance.hear(m, true, here), kRefused);
    m = reposition(there);
    m.x = 910000000;
    EXPECT_EQ(guidance.hear(m, true, here), kRefused);
    EXPECT_EQ(guidance.hear(reposition(there), true, here), kTaken);
    EXPECT_LT((guidance.point() - there).norm(), 0.05);
}

TEST(SimPlane, HeadsForAPointFarAwayAndCirclesOneThatItReaches)
{
    const TruthLimits limits = plane_limits();
    PlaneGuidance guidance(limits);
    Truth truth = eastward();
    guidance.hold(truth.position);
    const Vec there(0, 1500, 112);
    ASSERT_EQ(guidance.hear(reposition(there), true, truth.position), kTaken);
    fly_guided(truth, guidance, limits, 20.0);
    const Vec to_there = there - truth.position;
    EXPECT_NEAR(std::atan2(truth.velocity.y(), truth.velocity.x()), std::atan2(to_there.y(), to_there.x()), 0.05);
    EXPECT_NEAR(truth.velocity.norm(), 18.0, 0.3);
    EXPECT_GT(truth.position.z(), 108.0);
    double nearest = 1e9, farthest = 0.0;
    fly_guided(truth, guidance, limits, 120.0);
    for (int i = 0; i < 60; ++i) {
        fly_guided(truth, guidance, limits, 1.0);
        const double distance = (truth.position - there).head<2>().norm();
        nearest = std::min(nearest, distance);
        farthest = std::max(farthest, distance);
    }
    EXPECT_GT(nearest, 50.0);
    EXPECT_LT(farthest, 75.0) << "WP_LOITER_RAD 60";
    EXPECT_NEAR(truth.position.z(), 112.0, 0.5);
}

TEST(SimPlane, ALargeDescentIsStretchedOverTheWay)
{
    const TruthLimits limits = plane_limits();
    for (const double below : {14.0, 40.0}) {
        PlaneGuidance guidance(limits);
        Truth truth = eastward();
        guidance.hold(truth.position);
        ASSERT_EQ(guidance.hear(reposition(Vec(1800, 0, 100 - below)), true, truth.position), kTaken);
        fly_guided(truth, guidance, limits, 10.0);
        if (below < 15.0) {
            EXPECT_LT(truth.position.z(), 90.0);
        } else {
            EXPECT_GT(truth.position.z(), 95.0) << "a tenth of the way, a tenth of the descent";
        }
    }
}

TEST(SimPlane, NeverFliesSlowerThanItMayNorBanksBeyondItsLimit)
{
    const TruthLimits limits = plane_limits();
    Truth truth = eastward();
    for (int i = 0; i < 3000; ++i) {
        const double course = i < 1500 ? 2.5 : -2.0;
        move_plane(truth, Vec(0.1 * std::cos(course), 0.1 * std::sin(course), -9.0), limits, 0.01);
        EXPECT_GE(truth.velocity.head<2>().norm(), 12.0);
        EXPECT_LE(truth.acceleration.head<2>().norm(), 5.66 + 2.0);
        EXPECT_GE(truth.velocity.z(), -2.5 - 1e-9);
    }
}

/// The autopilot of a plane with the test at the other end of the cable.
template <link::mavlink::Message M>
void say(Autopilot& autopilot, const M& message)
{
    std::array<std::byte, link::mavlink::kMaxFrame> frame{};
    const std::size_t n = link::mavlink::encode(message, {1, kJink, 0}, frame);
    autopilot.receive({frame.data(), n});
}

TEST(SimPlane, DiscardsVelocitiesAndCountsThemAndFliesGuidedPoints)
{
    Scenario scenario;
    scenario.vehicle = plane_limits();
    scenario.mission = {Vec(0, 0, 100), Vec(2000, 0, 100)};
    scenario.start_position = scenario.mission[0];
    scenario.start_velocity = Vec(18, 0, 0);
    World world(scenario);
    Autopilot autopilot(world);
    EXPECT_EQ(autopilot.heartbeat().type, 1);
    EXPECT_EQ(autopilot.heartbeat().custom_mode, 10U) << "AUTO";
    link::mavlink::CommandLong mode;
    mode.command = 176;
    mode.param1 = 129.0F;
    mode.param2 = 15.0F;
    mode.target_system = mode.target_component = 1;
    say(autopilot, mode);
    EXPECT_EQ(autopilot.heartbeat().custom_mode, 15U) << "GUIDED";
    link::mavlink::SetPositionTargetLocalNed velocity;
    velocity.vx = 18.0F;
    velocity.type_mask = kVelocityMask;
    velocity.coordinate_frame = kLocalNed;
    velocity.target_system = velocity.target_component = 1;
    for (int i = 0; i < 8000; ++i) {
        if (i % 80 == 0) {
            say(autopilot, velocity);
        }
        autopilot.step();
    }
    EXPECT_EQ(autopilot.heard().bad_setpoints, 100U);
    EXPECT_LT(std::abs(world.own().position.x()), 300.0) << "circles where GUIDED began";
    CommandInt point = reposition(world.own().position + Vec(0, 1500, 0));
    point.target_system = point.target_component = 1;
    say(autopilot, point);
    for (int i = 0; i < 4000; ++i) {
        autopilot.step();
    }
    EXPECT_GT(world.own().velocity.y(), 17.0);
    EXPECT_EQ(autopilot.heard().bad_setpoints, 100U);
    mode.param2 = 10.0F;
    say(autopilot, mode);
    say(autopilot, point);
    EXPECT_EQ(autopilot.heartbeat().custom_mode, 10U) << "a point does not change the mode";
}

struct Tally {
    int hits = 0;      ///< bodies in contact
    int breaches = 0;  ///< separation below the promise
    int not_back = 0;  ///< control was taken and the mission not given back
    int takeovers = 0;
    double least = 1e9;  ///< [m]
};

Tally fly_seeds(const std::string& name, double mode)
{
    const char* cases = std::getenv("JINK_CASES");
    const char* first = std::getenv("JINK_SEED");
    const std::uint64_t begin = first != nullptr ? std::strtoull(first, nullptr, 0) : 1;
    const std::uint64_t count = cases != nullptr ? std::strtoull(cases, nullptr, 0) : 20;
    Tally tally;
    for (std::uint64_t seed = begin; seed < begin + count; ++seed) {
        Scenario scenario = load_scenario(std::filesystem::path(JINK_SCENARIOS) / ("plane_" + name + ".yaml"), seed);
        scenario.parameters["JNK_MODE"] = mode;
        // Another instant of the encounter's geometry in each: up to half a second and 2 m beside.
        Threat& threat = scenario.threats[0];
        const double shift = 0.5 * std::sin(static_cast<double>(7 * seed));
        threat.position += threat.velocity * shift + Vec(0, 0, 1.0 * std::cos(static_cast<double>(3 * seed)));
        const Record record = fly_in_process(scenario);
        tally.hits += record.outcome == Outcome::collision ? 1 : 0;
        tally.breaches += record.closest.surface < scenario.promise ? 1 : 0;
        tally.takeovers += static_cast<int>(record.takeovers);
        tally.not_back += record.takeovers > 0 && !record.given_back ? 1 : 0;
        tally.least = std::min(tally.least, record.closest.surface);
        EXPECT_TRUE(record.faults.empty()) << name << " JINK_CASES=1 JINK_SEED=" << seed << ": " << record.faults[0];
        if (mode > 1.0 && record.closest.surface < scenario.promise) {
            std::printf("[ plane     ] %s seed %d: %.2f m at %.1f s, %u takeovers\n", name.c_str(),
                        static_cast<int>(seed), record.closest.surface, record.closest.time, record.takeovers);
        }
    }
    std::printf("[ plane     ] %s, mode %.0f: %d of %d hit, least %.2f m, %d take-overs\n", name.c_str(), mode,
                tally.hits, static_cast<int>(count), tally.least, tally.takeovers);
    return tally;
}

class SimPlaneEncounter : public ::testing::TestWithParam<const char*> {};

TEST_P(SimPlaneEncounter, HitsWhenAdvisedOnlyAndIsAvoidedWhenSteered)
{
    const Tally before = fly_seeds(GetParam(), 1.0);
    EXPECT_EQ(before.takeovers, 0);
    EXPECT_GT(before.hits, 0) << "an encounter that is none shows nothing";
    const Tally after = fly_seeds(GetParam(), 2.0);
    EXPECT_EQ(after.hits, 0);
    EXPECT_EQ(after.breaches, 0);
    EXPECT_EQ(after.not_back, 0);
}

INSTANTIATE_TEST_SUITE_P(All, SimPlaneEncounter, ::testing::Values("head_on", "crossing", "overtaking"));

}  // namespace
}  // namespace jink::sim
