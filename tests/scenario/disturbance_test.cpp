// SPDX-License-Identifier: BSD-3-Clause
// Errors of the estimator, gusts and the steps of ADS-B: against the published figures.
#include "toolchain/sim/disturbance.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "toolchain/sim/sensors.hpp"

namespace jink::sim {
namespace {

constexpr double kMinute = 60.0;

TEST(OwnEstimate, IsTheTruthWhereNothingIsAskedFor)
{
    OwnEstimate estimate({}, 7);
    Truth truth;
    for (int i = 0; i < 100; ++i) {
        truth.position = Vec(i, 2.0 * i, 30.0);
        estimate.step(truth);
        ASSERT_EQ(estimate.reported().position, truth.position);
    }
}

TEST(OwnEstimate, IsAsOldAsTheLatency)
{
    OwnSensor sensor;
    sensor.latency = 0.2;
    OwnEstimate estimate(sensor, 7);
    Truth truth;
    for (int i = 0; i <= 400; ++i) {
        truth.position.x() = 5.0 * to_seconds(i * kStep);
        estimate.step(truth);
    }
    EXPECT_NEAR(truth.position.x() - estimate.reported().position.x(), 1.0, 1e-9);
}

TEST(OwnEstimate, BiasHasItsSizeAndItsCorrelationTime)
{
    OwnSensor sensor;
    sensor.bias = 2.0;
    sensor.bias_vertical = 3.0;
    sensor.bias_time = 10.0;
    double square = 0.0;
    double vertical = 0.0;
    double product = 0.0;
    constexpr int kSeeds = 2000;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        OwnEstimate estimate(sensor, static_cast<std::uint64_t>(seed));
        const double before = estimate.bias().x();
        for (int i = 0; i < 400; ++i) {  // 2 s
            estimate.step(Truth());
        }
        square += estimate.bias().x() * estimate.bias().x() / kSeeds;
        vertical += estimate.bias().z() * estimate.bias().z() / kSeeds;
        product += before * estimate.bias().x() / kSeeds;
    }
    // Standard error of a variance over 2000: 3 %.
    EXPECT_NEAR(square, 4.0, 0.5);
    EXPECT_NEAR(vertical, 9.0, 1.2);
    EXPECT_NEAR(product, 4.0 * std::exp(-0.2), 0.5);
}

/// MIL-F-8785C, 3.7.3.3: at 100 ft in a moderate wind (30 kt at 20 ft) sigma_w is 3 kt and sigma_u 5.0 kt.
TEST(Gusts, HaveTheStandardDeviationsOfTheirSource)
{
    constexpr double kKnot = 0.5144;
    double along = 0.0;
    double across = 0.0;
    double up = 0.0;
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        Gusts gusts({30.0 * kKnot}, seed);
        for (int i = 0; i < static_cast<int>(kMinute / to_seconds(kStep)); ++i) {
            gusts.step(100.0 * 0.3048, 20.0);
            if (i > 6000 && i % 200 == 0) {
                const Vec v = gusts.velocity(0.0);
                along += v.x() * v.x();
                across += v.y() * v.y();
                up += v.z() * v.z();
                ++count;
            }
        }
    }
    EXPECT_NEAR(std::sqrt(up / count) / kKnot, 3.0, 0.4);
    EXPECT_NEAR(std::sqrt(along / count) / kKnot, 5.0, 0.8);
    EXPECT_NEAR(std::sqrt(across / count) / kKnot, 5.0, 0.8);
}

TEST(Gusts, AreNoneInACalm)
{
    Gusts gusts({}, 1);
    gusts.step(30.0, 10.0);
    EXPECT_TRUE(gusts.is_calm());
    EXPECT_EQ(gusts.velocity(0.3), Vec(Vec::Zero()));
}

TEST(TrafficReceiver, QuantisedHeightsAreMultiplesOf25Feet)
{
    Scenario s;
    s.mission = {Vec(0, 0, 30), Vec(200, 0, 30)};
    Threat threat;
    threat.position = Vec(101.3, 57.7, 33.3);
    threat.velocity = Vec(-7.3, 2.2, 0.9);
    s.threats = {threat};
    s.traffic.rate = 1.0;
    s.traffic.quantised = true;
    World world(s);
    TrafficReceiver receiver(world);
    int seen = 0;
    for (int i = 0; i < 2000; ++i) {
        for (const Sighting& sighting : receiver.poll()) {
            ++seen;
            const double steps = sighting.position.z() / (25.0 * 0.3048);
            EXPECT_NEAR(steps, std::round(steps), 1e-9);
            const double true_height = threat.position.z() + threat.velocity.z() * (seen - 1);
            EXPECT_NEAR(sighting.position.z(), true_height, 0.5 * 25.0 * 0.3048 + 1e-6);
        }
        world.step(Vec(5, 0, 0));
    }
    EXPECT_EQ(seen, 10);
}

}  // namespace
}  // namespace jink::sim
