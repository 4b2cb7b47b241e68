// SPDX-License-Identifier: BSD-3-Clause
// Volumes about aircraft against dense samples of time in double.
#include "core/world/well_clear.hpp"

#include <gtest/gtest.h>

#include "tests/property/core/world/separation_oracle.hpp"

namespace jink::world {
namespace {

using geometry::oracle::case_count;
using geometry::oracle::in_cube;
using geometry::oracle::seed_of;
using test::Scene;

constexpr int kSamples = 4000;

double nearness(const Vec3& gap, const Vec3& closing, const Volume& volume, double t)
{
    const Eigen::Vector3d at = gap.cast<double>() + t * closing.cast<double>();
    return std::max(at.head<2>().norm() / static_cast<double>(volume.radius),
                    std::abs(at.z()) / static_cast<double>(volume.height));
}

struct Motion {
    Vec3 gap = Vec3::Zero();
    Vec3 closing = Vec3::Zero();
    Volume volume;
    Seconds span = 0.0F;
};

/// Kilometres and tens of metres, level, upright and standing motions too.
Motion any_motion(Random& random)
{
    Motion m;
    m.gap = in_cube(random, random.below(2) == 0 ? 3000.0F : 700.0F);
    m.gap.z() *= random.below(2) == 0 ? 0.02F : 0.2F;
    m.closing = in_cube(random, 80.0F);
    m.closing.z() *= 0.1F;
    switch (random.below(6)) {
    case 0: m.closing.z() = 0.0F; break;
    case 1: m.closing.head<2>().setZero(); break;
    case 2: m.closing.setZero(); break;
    case 3: m.closing = -m.gap / random.uniform(5.0F, 50.0F); break;
    default: break;
    }
    m.volume = {random.uniform(50.0F, 900.0F), random.uniform(20.0F, 150.0F)};
    m.span = random.uniform(0.0F, 60.0F);
    return m;
}

TEST(WellClear, LeastNearnessIsThatOfDenseSamples)
{
    const std::uint64_t seed = seed_of(0x3442);
    const int cases = case_count(20'000);
    Random random(seed);
    for (int i = 0; i < cases; ++i) {
        const Motion m = any_motion(random);
        const Nearness found = nearest(m.gap, m.closing, m.volume, m.span);
        double least = 1e30;
        for (int k = 0; k <= kSamples; ++k) {
            least = std::min(least, nearness(m.gap, m.closing, m.volume, static_cast<double>(m.span) * k / kSamples));
        }
        const double rounding = 1e-5 * (1.0 + nearness(m.gap, m.closing, m.volume, 0.0));
        ASSERT_LE(static_cast<double>(found.least), least + rounding) << "case " << i << ", seed " << seed;
        ASSERT_GE(found.when, 0.0F);
        ASSERT_LE(found.when, m.span);
        ASSERT_NEAR(static_cast<double>(found.least),
                    nearness(m.gap, m.closing, m.volume, static_cast<double>(found.when)), rounding)
            << "case " << i << ", seed " << seed;
    }
}

TEST(WellClear, FirstInsideIsThatOfDenseSamples)
{
    const std::uint64_t seed = seed_of(0x3443);
    const int cases = case_count(20'000);
    Random random(seed);
    int met = 0;
    for (int i = 0; i < cases; ++i) {
        const Motion m = any_motion(random);
        const Seconds found = first_inside(m.gap, m.closing, m.volume, m.span);
        const double slack = 1e-3;
        for (int k = 0; k < kSamples; ++k) {
            const double t = static_cast<double>(m.span) * k / kSamples;
            const double value = nearness(m.gap, m.closing, m.volume, t);
            if (found < 0.0F || t < static_cast<double>(found)) {
                ASSERT_GE(value, 1.0 - slack) << "case " << i << ", t " << t << ", seed " << seed;
            }
        }
        if (found >= 0.0F) {
            ++met;
            ASSERT_LE(nearness(m.gap, m.closing, m.volume, static_cast<double>(found)), 1.0 + slack)
                << "case " << i << ", seed " << seed;
        }
    }
    EXPECT_GT(met, cases / 20) << "the cases have to reach both";
    EXPECT_LT(met, cases - cases / 20);
}

/// A leg to the east at 12 m/s, 100 m up, and one aircraft.
struct OneAircraft {
    OneAircraft(const Vec3& position, const Vec3& velocity)
    {
        scene.limits.cruise_speed = 12.0F;
        scene.leg(Vec3(0, 0, 100), Vec3(5000, 0, 100), 12.0F);
        scene.own.position = Vec3(0, 0, 100);
        scene.own.velocity = Vec3(12, 0, 0);
        scene.rules.well_clear.radius = 609.6F;
        scene.track(position, velocity, 0.0F).manned = true;
    }

    Alert look(bool gives_way = false)
    {
        WorkBudget budget(test::kPlenty);
        const Situation s = scene.situation();
        return aircraft_conflict(s, way_of(s), gives_way, budget, conflict);
    }

    Scene scene;
    Conflict conflict;
};

TEST(AircraftConflict, SaysWhenTheVolumeIsEnteredAndWhichAlertThatIs)
{
    OneAircraft head_on(Vec3(4000, 0, 100), Vec3(-60, 0, 0));
    EXPECT_EQ(head_on.look(), Alert::medium);
    EXPECT_NEAR(head_on.conflict.time_to_loss, (4000.0F - 609.6F) / 72.0F, 0.01F);
    EXPECT_NEAR(head_on.conflict.time_to_closest, 4000.0F / 72.0F, 0.01F);
    EXPECT_EQ(OneAircraft(Vec3(4000, 300, 100), Vec3(-60, 0, 0)).look(), Alert::low) << "no near mid-air collision";
    EXPECT_EQ(OneAircraft(Vec3(3000, 0, 180), Vec3(-60, 0, 0)).look(), Alert::none) << "80 m above";
    EXPECT_EQ(OneAircraft(Vec3(3000, 0, 170), Vec3(-60, 0, 0)).look(), Alert::low) << "70 m above";
    EXPECT_EQ(OneAircraft(Vec3(3000, 0, 250), Vec3(-60, 0, -4)).look(), Alert::medium) << "descending into it";
    EXPECT_EQ(OneAircraft(Vec3(500, 0, 100), Vec3(-20, 0, 0)).look(), Alert::high);
    EXPECT_EQ(OneAircraft(Vec3(140, 0, 100), Vec3(-20, 0, 0)).look(), Alert::critical);
    EXPECT_EQ(OneAircraft(Vec3(-300, 0, 100), Vec3(-60, 0, 0)).look(), Alert::none) << "it leaves";
    EXPECT_EQ(OneAircraft(Vec3(6000, 0, 100), Vec3(-60, 0, 0)).look(), Alert::none) << "more than a minute away";
}

TEST(AircraftConflict, AnAircraftNearbyMayTurnThisWay)
{
    // It passes 900 m to the side, and would come near by a turn of 45 degrees.
    OneAircraft beside(Vec3(1200, 900, 100), Vec3(-60, 0, 0));
    EXPECT_EQ(beside.look(), Alert::low);
    EXPECT_EQ(OneAircraft(Vec3(1200, 2500, 100), Vec3(-60, 0, 0)).look(), Alert::none);
}

/// Where an aircraft is that turns at a steady rate, in double.
Eigen::Vector3d on_circle(const Track& track, double t)
{
    const auto rate = static_cast<double>(track.turn_rate);
    const double x = rate != 0.0 ? std::sin(rate * t) / rate : t;
    const double y = rate != 0.0 ? (1.0 - std::cos(rate * t)) / rate : 0.0;
    const Eigen::Vector3d v = track.velocity.cast<double>();
    return track.position.cast<double>() + Eigen::Vector3d(x * v.x() - y * v.y(), y * v.x() + x * v.y(), t * v.z());
}

TEST(TurningOn, ChordsEndOnTheCircle)
{
    const std::uint64_t seed = seed_of(0x3444);
    Random random(seed);
    for (int i = 0; i < case_count(5000); ++i) {
        OneAircraft one(in_cube(random, 3000.0F), in_cube(random, 80.0F));
        Track& track = one.scene.tracks[0];
        track.turn_rate = random.uniform(0.015F, 0.5F) * (random.below(2) == 0 ? 1.0F : -1.0F);
        const Situation s = one.scene.situation();
        double t = 0.0;
        for (const TurnPiece& piece : turning_on(of_kind(s.threats, ThreatKind::track)[0])) {
            const Eigen::Vector3d begin = piece.position.cast<double>();
            const Eigen::Vector3d end = begin + static_cast<double>(kTurnPiece) * piece.velocity.cast<double>();
            ASSERT_LT((begin - on_circle(track, t)).norm(), 0.01) << "case " << i << ", seed " << seed;
            t += static_cast<double>(kTurnPiece);
            ASSERT_LT((end - on_circle(track, t)).norm(), 0.01) << "case " << i << ", seed " << seed;
        }
        ASSERT_EQ(t, 40.0);
        track.turn_rate *= 0.014F / std::abs(track.turn_rate);
        const Situation straight = one.scene.situation();
        ASSERT_TRUE(turning_on(of_kind(straight.threats, ThreatKind::track)[0]).empty());
    }
}

/// Whoever flies on along a circle into the well clear volume within 40 s is seen to do so.
TEST(TurningOn, NoneThatComesNearIsOverlooked)
{
    const std::uint64_t seed = seed_of(0x3445);
    Random random(seed);
    int by_turn_alone = 0;
    const int cases = case_count(5000);
    for (int i = 0; i < cases; ++i) {
        OneAircraft one(Vec3(0, 0, 100) + in_cube(random, 3000.0F).cwiseProduct(Vec3(1.0F, 1.0F, 0.03F)),
                        in_cube(random, 60.0F).cwiseProduct(Vec3(1.0F, 1.0F, 0.03F)));
        Track& track = one.scene.tracks[0];
        track.turn_rate = random.uniform(0.015F, 0.1F) * (random.below(2) == 0 ? 1.0F : -1.0F);
        // A chord of 10 s leaves its circle by so much.
        const float off = track.velocity.head<2>().norm() * std::abs(track.turn_rate) * kTurnPiece * kTurnPiece / 8.0F;
        double least = 1e30;
        for (int k = 0; k <= 400; ++k) {
            const Eigen::Vector3d gap = on_circle(track, 0.1 * k) - Eigen::Vector3d(1.2 * k, 0.0, 100.0);
            least = std::min(
                least, std::max(gap.head<2>().norm() / static_cast<double>(609.6F - off), std::abs(gap.z()) / 76.2));
        }
        if (least < 0.999) {
            ASSERT_NE(one.look(), Alert::none) << "case " << i << ", seed " << seed;
            track.turn_rate = 0.0F;
            by_turn_alone += one.look() == Alert::none ? 1 : 0;
        }
    }
    EXPECT_GT(by_turn_alone, cases / 50) << "straight prediction would see them all";
}

TEST(AircraftConflict, OnlyOfMannedAircraftAndWhereTheRuleIsOn)
{
    OneAircraft drone(Vec3(3000, 0, 100), Vec3(-60, 0, 0));
    drone.scene.tracks[0].manned = false;
    EXPECT_EQ(drone.look(), Alert::none);
    OneAircraft off(Vec3(3000, 0, 100), Vec3(-60, 0, 0));
    off.scene.rules.well_clear.radius = 0.0F;
    EXPECT_EQ(off.look(), Alert::none);
}

TEST(AircraftConflict, TheVolumeIsLargerByWhatIsNotKnown)
{
    OneAircraft above(Vec3(3000, 0, 180), Vec3(-60, 0, 0));
    above.scene.tracks[0].sigma_position = 3.0F;
    EXPECT_EQ(above.look(), Alert::low) << "9 m of what is possible";
    OneAircraft pressure(Vec3(3000, 0, 240), Vec3(-60, 0, 0));
    pressure.scene.tracks[0].half_height = 70.0F;
    EXPECT_EQ(pressure.look(), Alert::low) << "70 m of an uncertain height";
}

TEST(AircraftConflict, WithoutUnitsItSaysSo)
{
    OneAircraft head_on(Vec3(3000, 0, 100), Vec3(-60, 0, 0));
    WorkBudget budget(3);
    const Situation s = head_on.scene.situation();
    EXPECT_EQ(aircraft_conflict(s, way_of(s), false, budget, head_on.conflict), Alert::low);
    EXPECT_EQ(head_on.conflict.time_to_loss, 0.0F);
    EXPECT_TRUE(budget.exhausted());
}

}  // namespace
}  // namespace jink::world
