// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <gtest/gtest.h>

#include "toolchain/sim/encounter_kind.hpp"
#include "toolchain/sim/random_scenario.hpp"
#include "toolchain/sim/sensors.hpp"

namespace jink::sim {
namespace {

double course_rate(const Threat& threat, double t)
{
    const Vec before = threat.velocity_at(t);
    const Vec after = threat.velocity_at(t + 1.0);
    if (before.head<2>().norm() < 0.1 || after.head<2>().norm() < 0.1) {
        return 0.0;
    }
    const double turned =
        std::atan2(before.x() * after.y() - before.y() * after.x(), before.head<2>().dot(after.head<2>()));
    return std::abs(turned) * 180.0 / 3.14159265358979;
}

/// Each kind changes one thing, and its intruders come as near to the vehicle on its leg as the straight ones.
TEST(EncounterKinds, ChangeOneThingEach)
{
    for (const EncounterKind kind : kEncounterKinds) {
        if (kind == EncounterKind::built_up) {
            continue;  // scenes of its own: built_up_test.cpp
        }
        unsigned bent = 0;
        double most_rate = 0.0;
        double most_climb = 0.0;
        double most_speeding = 0.0;
        for (std::uint64_t seed = 1; seed <= 50; ++seed) {
            const Scenario plain = open_encounter(seed);
            const Scenario s = encounter_of(kind, seed);
            const std::size_t intruders = kind == EncounterKind::late ? 1 : plain.threats.size();
            ASSERT_GE(s.threats.size(), intruders);
            EXPECT_EQ(s.threats.size() > intruders, kind == EncounterKind::cluttered);
            for (std::size_t i = 0; i < intruders; ++i) {
                bent += s.threats[i].turns.empty() ? 0U : 1U;
                double nearest = 1e9;
                for (double t = 0.0; t < 40.0; t += 0.05) {
                    nearest = std::min(nearest,
                                       (s.threats[i].position_at(t) - s.start_position - s.start_velocity * t).norm());
                    const Vec change = s.threats[i].velocity_at(t + 1.0) - s.threats[i].velocity_at(t);
                    most_rate = std::max(most_rate, course_rate(s.threats[i], t));
                    most_climb = std::max(most_climb, std::abs(change.z()));
                    most_speeding = std::max(most_speeding, std::abs(s.threats[i].velocity_at(t + 1.0).norm() -
                                                                     s.threats[i].velocity_at(t).norm()));
                }
                EXPECT_LT(nearest, 2.0) << to_string(kind) << ' ' << seed;
            }
        }
        const bool straight =
            kind != EncounterKind::turning && kind != EncounterKind::climbing && kind != EncounterKind::speeding;
        EXPECT_EQ(bent == 0, straight) << to_string(kind);
        EXPECT_EQ(most_rate > 3.0, kind == EncounterKind::turning) << to_string(kind) << ' ' << most_rate;
        EXPECT_LT(most_rate, 1.2 * 6.01) << "a second touches six pieces";
        EXPECT_EQ(most_climb > 0.95, kind == EncounterKind::climbing || kind == EncounterKind::speeding)
            << to_string(kind) << ' ' << most_climb;
        EXPECT_EQ(most_speeding > 1.5, kind == EncounterKind::speeding) << to_string(kind) << ' ' << most_speeding;
        EXPECT_LT(most_speeding, 1.2 * 2.01);
    }
    EXPECT_EQ(encounter_of(EncounterKind::seldom, 3).traffic.rate, 1.0);
    EXPECT_EQ(encounter_of(EncounterKind::windy, 3).wind.at_20_ft, 8.0);
}

TEST(EncounterKinds, LateOnesAreReportedShortlyBeforeTheyMeet)
{
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        const Scenario s = encounter_of(EncounterKind::late, seed);
        ASSERT_EQ(s.threats.size(), 1U);
        const Threat& only = s.threats[0];
        const auto distance = [&](double t) {
            return (only.position_at(t) - s.start_position - s.start_velocity * t).norm();
        };
        EXPECT_LT(distance(only.appears_at + 0.4), distance(only.appears_at + 0.38)) << seed << ": still coming";
        EXPECT_GT(distance(only.appears_at + 1.62), distance(only.appears_at + 1.6)) << seed << ": has passed";
    }
}

/// Of errors that stay: their size, and how much of one is left after the correlation time.
TEST(EncounterKinds, DriftIsAsLargeAndAsSlowAsItsModel)
{
    Scenario s;
    s.seed = 5;
    s.mission = {Vec(0, 0, 40), Vec(300, 0, 40)};
    s.traffic.rate = 5.0;
    s.traffic.latency = 0.0;
    s.traffic.sigma_drift = 1.5;
    s.traffic.drift_time = 2.0;
    s.threats.resize(200);
    for (Threat& threat : s.threats) {
        threat.position = Vec(1000, 0, 40);
    }
    s.duration = 10.0;
    World world(s);
    TrafficReceiver receiver(world);
    std::vector<std::vector<double>> errors(s.threats.size());
    while (world.now() < to_micros(s.duration)) {
        world.step(Vec::Zero());
        for (const Sighting& seen : receiver.poll()) {
            errors[seen.threat].push_back(seen.position.y());
        }
    }
    double squares = 0.0;
    double products = 0.0;
    unsigned count = 0;
    for (const std::vector<double>& one : errors) {
        ASSERT_GT(one.size(), 40U);
        for (std::size_t i = 0; i + 10 < one.size(); ++i) {
            squares += one[i] * one[i];
            products += one[i] * one[i + 10];  // 2 s later
            ++count;
        }
    }
    EXPECT_NEAR(std::sqrt(squares / count), 1.5, 0.1);
    EXPECT_NEAR(products / squares, std::exp(-1.0), 0.07);
}

}  // namespace
}  // namespace jink::sim
