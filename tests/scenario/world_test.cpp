// SPDX-License-Identifier: BSD-3-Clause
// The simulator's physics: against closed forms, brute force and its own limits.
#include <gtest/gtest.h>

#include "toolchain/sim/world.hpp"

#include <cmath>

#include "core/base/random.hpp"
#include "toolchain/sim/geodesy.hpp"
#include "toolchain/sim/mission_pilot.hpp"
#include "toolchain/sim/random_scenario.hpp"
#include "toolchain/sim/record.hpp"
#include "toolchain/sim/sensors.hpp"

namespace jink::sim {
namespace {

constexpr double kDt = 0.005;

double uniform(Random& random, double low, double high)
{
    return low + (high - low) * static_cast<double>(random.uniform());
}
Vec uniform_vec(Random& random, double size)
{
    return {uniform(random, -size, size), uniform(random, -size, size), uniform(random, -size, size)};
}

Scenario quiet_scenario()
{
    Scenario s;
    s.name = "test";
    s.mission = {Vec(0, 0, 30), Vec(100, 0, 30)};
    s.start_position = s.mission[0];
    s.start_velocity = Vec(5, 0, 0);
    return s;
}

TEST(TruthVehicle, StepResponseIsThatOfASecondOrderSystem)
{
    TruthLimits limits;
    limits.max_acceleration = limits.max_vertical_acceleration = limits.max_climb = limits.max_descent = 1e6;
    Truth truth;
    const double w = limits.omega;
    const double z = limits.damping;
    const double wd = w * std::sqrt(1.0 - z * z);
    for (int i = 1; i <= 600; ++i) {
        fly(truth, Vec(1.0, -2.0, 0.5), limits, kDt);
        const double t = i * kDt;
        const double step = 1.0 - std::exp(-z * w * t) * (std::cos(wd * t) + z * w / wd * std::sin(wd * t));
        // First-order integration of a loop with omega dt = 0.025.
        ASSERT_NEAR(truth.velocity.x(), step, 0.01) << "t " << t;
        ASSERT_NEAR(truth.velocity.y(), -2.0 * step, 0.02) << "t " << t;
        ASSERT_NEAR(truth.velocity.z(), 0.5 * step, 0.005) << "t " << t;
    }
}

TEST(TruthVehicle, LimitsHoldUnderAnyCommands)
{
    Random random(7);
    TruthLimits limits;
    limits.max_course_rate = 0.8;
    Truth truth;
    truth.velocity = Vec(5, 0, 0);
    Vec command = Vec::Zero();
    for (int i = 0; i < 40000; ++i) {
        if (i % 100 == 0) {
            command = uniform_vec(random, 12.0);
        }
        const Truth before = truth;
        fly(truth, command, limits, kDt);
        const Vec a = (truth.velocity - before.velocity) / kDt;
        ASSERT_LE(a.head<2>().norm(), limits.max_acceleration + 1e-9);
        ASSERT_LE(std::abs(a.z()), limits.max_vertical_acceleration + 1e-9);
        ASSERT_LE(truth.velocity.z(), limits.max_climb + 1e-9);
        ASSERT_GE(truth.velocity.z(), -limits.max_descent - 1e-9);
        ASSERT_LE(std::abs(std::remainder(truth.yaw - before.yaw, 2 * M_PI)), limits.max_yaw_rate * kDt + 1e-9);
        const Eigen::Vector2d v = before.velocity.head<2>();
        if (v.norm() > 0.6 && truth.velocity.head<2>().norm() > 0.6) {
            const Eigen::Vector2d u = truth.velocity.head<2>();
            const double turned = std::atan2(v.x() * u.y() - v.y() * u.x(), v.dot(u));
            ASSERT_LE(std::abs(turned), limits.max_course_rate * kDt * 1.1) << i;
        }
    }
}

/// The integrator has to let go of what it held: the way to a stop is drag x speed / integral gain, whatever the other
/// gains are. A new velocity is reached to gain / (gain + drag) before the integrator has changed.
TEST(TruthVehicle, AgainstDragItStopsLateAndReachesACommandInPart)
{
    constexpr double kSpeed = 5.0;
    constexpr double kGain = 1.8;
    constexpr double kIntegral = 0.4;
    for (const double drag : {0.2, 0.5, kRecordedDrag}) {
        TruthLimits limits;
        limits.max_acceleration = limits.max_vertical_acceleration = 50.0;
        limits.drag = drag;
        Truth stops;
        stops.velocity = Vec(kSpeed, 0, 0);
        stops.held = held_at(stops.velocity, limits);
        for (int i = 0; i < 20000; ++i) {
            fly(stops, Vec::Zero(), limits, kDt);
        }
        EXPECT_NEAR(stops.position.x(), drag * kSpeed / kIntegral, 0.05) << drag;
        EXPECT_NEAR(stops.velocity.norm(), 0.0, 1e-6) << drag;
        Truth starts;
        for (int i = 0; i < 200; ++i) {
            fly(starts, Vec(0, kSpeed, 0), limits, kDt);
        }
        // After 1 s; what the integrator has gained by then is less than half of what is missing.
        const double in_part = kSpeed * kGain / (kGain + drag);
        EXPECT_GT(starts.velocity.y(), 0.85 * in_part) << drag;
        EXPECT_LT(starts.velocity.y(), kSpeed - 0.5 * (kSpeed - in_part)) << drag;
    }
}

TEST(TruthVehicle, SettlesOnTheCommandAndStops)
{
    const TruthLimits limits;
    Truth truth;
    truth.velocity = Vec(5, 0, 0);
    for (int i = 0; i < 1000; ++i) {
        fly(truth, Vec::Zero(), limits, kDt);
    }
    EXPECT_LT(truth.velocity.norm(), 1e-3);
    // Not before the distance at full deceleration from the first instant on, not after a second more of flight.
    EXPECT_GT(truth.position.x(), 25.0 / (2.0 * limits.max_acceleration));
    EXPECT_LT(truth.position.x(), 25.0 / (2.0 * limits.max_acceleration) + 5.0);
}

TEST(TruthVehicle, AlongKeepsTheDirectionAndTheVerticalLimit)
{
    const TruthLimits limits;
    const Vec level = along(Vec(3, 4, 0), 5.0, limits);
    EXPECT_NEAR((level - Vec(3, 4, 0)).norm(), 0.0, 1e-12);
    const Vec steep = along(Vec(1, 0, 1), 5.0, limits);
    EXPECT_NEAR(steep.z(), 3.0, 1e-12);
    EXPECT_NEAR(steep.x(), 3.0, 1e-12);
    EXPECT_EQ(along(Vec::Zero(), 5.0, limits), Vec(Vec::Zero()));
}

TEST(Threat, FliesItsTurns)
{
    Threat threat;
    threat.position = Vec(1, 2, 3);
    threat.velocity = Vec(1, 0, 0);
    threat.turns = {{2.0, Vec(0, 2, 0)}, {3.0, Vec(0, 0, -1)}};
    EXPECT_EQ(threat.position_at(0.0), Vec(1, 2, 3));
    EXPECT_EQ(threat.position_at(2.0), Vec(3, 2, 3));
    EXPECT_EQ(threat.position_at(2.5), Vec(3, 3, 3));
    EXPECT_EQ(threat.position_at(5.0), Vec(3, 4, 1));
    EXPECT_EQ(threat.velocity_at(1.0), Vec(1, 0, 0));
    EXPECT_EQ(threat.velocity_at(2.5), Vec(0, 2, 0));
    EXPECT_EQ(threat.velocity_at(9.0), Vec(0, 0, -1));
    EXPECT_FALSE(threat.at_rest());
    EXPECT_TRUE(Threat{}.at_rest());
}

TEST(Threat, NearestInStepIsThatOfBruteForce)
{
    Random random(3);
    for (int k = 0; k < 2000; ++k) {
        Threat threat;
        threat.radius = uniform(random, 0.1, 3.0);
        const Vec a = uniform_vec(random, 5.0);
        const Vec b = uniform_vec(random, 5.0);
        const Vec c = uniform_vec(random, 5.0);
        const Vec d = uniform_vec(random, 5.0);
        double least = 1e9;
        for (int i = 0; i <= 2000; ++i) {
            const double u = i / 2000.0;
            least = std::min(least, ((c + (d - c) * u) - (a + (b - a) * u)).norm() - threat.radius);
        }
        const Nearest nearest = nearest_in_step(threat, a, b, c, d);
        ASSERT_LE(nearest.distance, least + 1e-12) << k;
        ASSERT_NEAR(nearest.distance, least, 0.02) << k;  // 2000 steps of up to 35 m
        const double u = nearest.share;
        ASSERT_NEAR(surface_distance(threat, a + (b - a) * u, c + (d - c) * u), nearest.distance, 1e-9) << k;
    }
}

TEST(Threat, BoxAndCapsuleDistances)
{
    Threat sphere;
    sphere.radius = 1.0;
    EXPECT_NEAR(box_distance(sphere, Vec(5, 0, 0), Vec::Zero(), Vec::Ones()), 3.0, 1e-12);
    EXPECT_NEAR(box_distance(sphere, Vec(4, 4, 0), Vec::Zero(), Vec::Ones()), std::sqrt(18.0) - 1.0, 1e-12);
    EXPECT_EQ(box_distance(sphere, Vec(1.5, 0, 0), Vec::Zero(), Vec::Ones()), 0.0);
    Threat pillar = sphere;
    pillar.half_height = 4.0;
    EXPECT_NEAR(surface_distance(pillar, Vec::Zero(), Vec(3, 0, 3.5)), 2.0, 1e-12);
    EXPECT_NEAR(surface_distance(pillar, Vec::Zero(), Vec(0, 0, 7.0)), 2.0, 1e-12);
    EXPECT_LT(surface_distance(pillar, Vec::Zero(), Vec(0.5, 0, 2)), 0.0);
    EXPECT_NEAR(box_distance(pillar, Vec::Zero(), Vec(5, 0, 4.5), Vec::Ones()), 3.0, 1e-12);
}

TEST(World, MeasuresTheClosestApproachOfAHeadOnPass)
{
    Scenario s = quiet_scenario();
    Threat threat;
    threat.radius = 1.0;
    threat.velocity = Vec(-8, 0, 0);
    threat.position = Vec(65, 3, 30);
    s.threats = {threat};
    World world(s);
    for (int i = 0; i < 2000; ++i) {
        world.step(Vec(5, 0, 0));
    }
    EXPECT_NEAR(world.closest().surface, 2.0, 1e-6);
    EXPECT_NEAR(world.closest().time, 5.0, 1e-3);
    EXPECT_NEAR(world.closest().box, 1.0, 0.05);  // at the ends of steps only
    EXPECT_TRUE(world.all_past());
}

TEST(World, ThreatsAppearByTimeAndByDistance)
{
    Scenario s = quiet_scenario();
    Threat late;
    late.position = Vec(90, 0, 30);
    late.appears_at = 2.0;
    Threat near = late;
    near.appears_at = 0.0;
    near.collision_point = Vec(40, 0, 30);
    near.appears_when_own_within = 10.0;
    s.threats = {late, near};
    World world(s);
    EXPECT_FALSE(world.visible(0));
    EXPECT_FALSE(world.visible(1));
    for (int i = 0; i < 1400; ++i) {
        world.step(Vec(5, 0, 0));
    }
    EXPECT_EQ(world.appeared(0), 2 * kSecond);
    EXPECT_NEAR(to_seconds(world.appeared(1)), 6.0, 0.0051);
}

TEST(TrafficReceiver, NoiseHasTheAskedSizeAndDependsOnTheSeedAlone)
{
    Scenario s = quiet_scenario();
    s.traffic = {
        .rate = 5.0, .sigma_position = 0.3, .sigma_velocity = 0.2, .latency = 0.1, .jitter = 0.05, .dropout = 0.1};
    Threat threat;
    threat.velocity = Vec(1, 2, 0);
    threat.position = Vec(500, 0, 30);
    s.threats = {threat};
    const auto listen = [&](std::uint64_t seed, const Vec& command) {
        s.seed = seed;
        World world(s);
        TrafficReceiver receiver(world);
        std::vector<Sighting> all;
        for (int i = 0; i < 80000; ++i) {
            for (const Sighting& seen : receiver.poll()) {
                EXPECT_LE(seen.arrives, world.now());
                all.push_back(seen);
            }
            world.step(command);
        }
        return all;
    };
    const auto one = listen(1, Vec(5, 0, 0));
    const auto other_flight = listen(1, Vec(0, -3, 1));
    const auto other_seed = listen(2, Vec(5, 0, 0));
    ASSERT_EQ(one.size(), other_flight.size());
    EXPECT_NE(one[5].position, other_seed[5].position);
    double position2 = 0.0;
    double velocity2 = 0.0;
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].position, other_flight[i].position);
        // Measured 0.1 to 0.15 s before it arrived, on the grid of the sensor's rate.
        const double measured = std::floor(to_seconds(one[i].arrives) * 5.0 - 0.4999) / 5.0;
        position2 += (one[i].position - threat.position_at(measured)).squaredNorm() / 3.0;
        velocity2 += (one[i].velocity - threat.velocity).squaredNorm() / 3.0;
    }
    const auto n = static_cast<double>(one.size());
    EXPECT_NEAR(n, 1800.0, 60.0);  // 400 s at 5 Hz, a tenth lost: five standard deviations are 67
    EXPECT_NEAR(std::sqrt(position2 / n), 0.3, 0.02);
    EXPECT_NEAR(std::sqrt(velocity2 / n), 0.2, 0.015);
}

TEST(Scan, SeesAPillarAheadInTheRightSectors)
{
    Scenario s = quiet_scenario();
    Threat pillar;
    pillar.radius = 1.0;
    pillar.half_height = 5.0;
    pillar.position = Vec(11, 0, 30);
    pillar.sensed_by = SensedBy::scan;
    s.threats = {pillar};
    s.start_velocity = Vec(5, 0, 0);
    const auto ahead = scan(World(s));
    EXPECT_NEAR(ahead[0], 10.0, 0.01);
    EXPECT_GT(ahead[1], 0.0);  // half angle 5.2 deg: sectors at -5, 0, 5
    EXPECT_GT(ahead[71], 0.0);
    EXPECT_LT(ahead[2], 0.0);
    EXPECT_LT(ahead[36], 0.0);
    s.start_velocity = Vec(0, 5, 0);  // nose to the north: the pillar is on the right, clockwise by 90 deg
    EXPECT_NEAR(scan(World(s))[18], 10.0, 0.01);
    s.scan.range = 9.0;
    EXPECT_LT(scan(World(s))[18], 0.0);
    s.scan.range = 30.0;
    s.threats[0].position.z() = 37.0;  // its lower end is 1 m above the scan: round ends reach 0 there
    EXPECT_LT(scan(World(s))[18], 0.0);
}

TEST(Geodesy, StacksAgreeNearHomeAndDifferByTheirRadii)
{
    for (const Stack stack : {Stack::ardupilot, Stack::px4}) {
        const GlobalPosition home = to_global(Vec::Zero(), stack);
        const GlobalPosition north = to_global(Vec(0, 1000, 10), stack);
        const GlobalPosition east = to_global(Vec(1000, 0, 0), stack);
        const double radius = stack == Stack::px4 ? 6371000.0 : 6378100.0;
        const double degree = radius * M_PI / 180.0;
        EXPECT_NEAR((north.lat - home.lat) * 1e-7 * degree, 1000.0, 0.02);
        EXPECT_EQ(north.lon, home.lon);
        EXPECT_NEAR((east.lon - home.lon) * 1e-7 * degree * std::cos(kHomeLatitude * M_PI / 180.0), 1000.0, 0.02);
        EXPECT_EQ(north.alt - home.alt, 10000);
    }
}

TEST(MissionPilot, FliesTheLegsAndHoversAtTheEnd)
{
    Scenario s = quiet_scenario();
    s.mission = {Vec(0, 0, 30), Vec(40, 0, 30), Vec(40, 30, 40)};
    World world(s);
    MissionPilot pilot(s);
    double worst = 0.0;
    for (int i = 0; i < 6000; ++i) {
        world.step(pilot.command(world.own().position));
        worst = std::max(worst, pilot.cross_track(world.own().position));
    }
    EXPECT_EQ(pilot.target(), 2U);
    EXPECT_LT(worst, 3.0);
    EXPECT_LT((world.own().position - s.mission[2]).norm(), 0.05);
    EXPECT_LT(world.own().velocity.norm(), 0.05);
}

TEST(FlipCounter, CountsChangesOfSideAndNotTheWayBack)
{
    const std::vector<Vec> mission{Vec(0, 0, 30), Vec(100, 0, 30)};
    FlipCounter out_and_back(mission);
    for (const auto& [y, v] : {std::pair{0.0, 2.0}, {2.0, 1.0}, {3.0, 0.0}, {2.0, -2.0}, {0.3, -0.3}, {0.0, 0.0}}) {
        out_and_back.note(Vec(10, y, 30), Vec(5, v, 0));
    }
    EXPECT_EQ(out_and_back.flips(), 0);
    FlipCounter hesitant(mission);
    for (const double v : {2.0, -2.0, 2.0, -2.0}) {
        hesitant.note(Vec(10, 0, 30), Vec(5, v, 0));
    }
    EXPECT_EQ(hesitant.flips(), 3);
    FlipCounter quarter(mission);
    quarter.note(Vec(10, 0, 30), Vec(5, 2, 0));
    quarter.note(Vec(10, 0, 30), Vec(5, 0, 2));
    EXPECT_EQ(quarter.flips(), 0);
}

TEST(RandomScenario, IsTheSameForTheSameSeedAndKeepsItsPromises)
{
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        const Scenario s = random_scenario(seed);
        const Scenario again = random_scenario(seed);
        ASSERT_EQ(s.threats.size(), again.threats.size());
        ASSERT_GE(s.threats.size(), 1U);
        ASSERT_LE(s.threats.size(), 3U);
        for (std::size_t i = 0; i < s.threats.size(); ++i) {
            const Threat& threat = s.threats[i];
            ASSERT_EQ(threat.position, again.threats[i].position);
            ASSERT_LE(threat.velocity.norm(), 12.0 + 1e-9);
            ASSERT_GE(threat.radius, 0.5);
            ASSERT_LE(threat.radius, 2.0);
            double least = 1e9;
            for (double t = 0.0; t < 20.0; t += 0.01) {
                least = std::min(least, (s.start_position + s.start_velocity * t - threat.position_at(t)).norm());
            }
            ASSERT_LE(least, i == 0 ? 0.5 : 1.5) << seed;
        }
    }
}

}  // namespace
}  // namespace jink::sim
