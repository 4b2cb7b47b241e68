// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "core/world/conflict.hpp"
#include "tests/oracle/route_oracle.hpp"
#include "tests/property/core/world/separation_oracle.hpp"

// Conflicts of a nominal path along a route against sampling in small steps, in double precision.

namespace jink::world {
namespace {

using geometry::oracle::case_count;
using geometry::oracle::in_cube;
using geometry::oracle::seed_of;
using jink::oracle::TwinRoute;
using oracle::Vec3d;
using test::Scene;

constexpr Seconds kAhead = 8.0F;
/// A chord deviates from the path, and the corner of a box enlarged by this deviation deviates further.
const double kWider = 1.0 + std::sqrt(3.0);

struct Course {
    Scene scene;
    TwinRoute twin;
    Way way;

    explicit Course(Random& random)
        : twin(jink::oracle::random_route(random, in_cube(random, 300.0F), random.below(2) == 0, 1.5F))
    {
        scene.limits.half_extents =
            Vec3(random.uniform(0.2F, 2.0F), random.uniform(0.2F, 2.0F), random.uniform(0.2F, 2.0F));
        scene.limits.max_climb = scene.limits.max_descent = 30.0F;  // never binding: the oracle flies one speed
        const float off = random.below(2) == 0 ? 0.2F : 6.0F;
        const auto s = random.uniform(0.0F, static_cast<float>(twin.length()));
        scene.own.position = twin.at(double(s)).cast<float>() + off * in_cube(random, 0.5F);
        scene.reference.valid = true;
        scene.reference.speed = random.uniform(1.0F, 10.0F);
        scene.reference = world::Reference(twin.route, scene.reference.speed);
        way = way_of(scene.situation());
    }
    Course(const Course&) = delete;
    Course& operator=(const Course&) = delete;

    [[nodiscard]] Vec3d at(double t) const
    {
        const double flown = std::min(double(way.speed) * t, double(way.length));
        const double straight = double(way.ahead.straight);
        return flown < straight ? Vec3d(way.origin.cast<double>() + flown * way.direction.cast<double>())
                                : twin.at(double(way.ahead.joined_at) + flown - straight);
    }
    /// Largest deviation of chords from the path, by the header: half an angle of 0.2 rad, or of a tenth of the turn.
    [[nodiscard]] double slack() const
    {
        double turn = 0.0;
        double largest = 0.0;
        for (const auto& piece : twin.pieces) {
            if (piece.is_arc) {
                const double radius = (piece.start - piece.centre).norm();
                turn += std::min(piece.length, double(way.speed) * double(kAhead)) / radius;
                largest = std::max(largest, radius);
            }
        }
        return 3e-3 + 1.02 * largest * (1.0 - std::cos(0.5 * std::max(0.4, turn / 10.0)));
    }
    [[nodiscard]] double margin(const Track& track, double t) const
    {
        const Vec3d threat = track.position.cast<double>() + track.velocity.cast<double>() * t;
        return oracle::point_box(threat - at(t), scene.limits.half_extents.cast<double>()) -
               oracle::radius_of(scene, track, t);
    }
};

TEST(RouteWay, LeadsBackToTheRouteAndAlongIt)
{
    const std::uint64_t seed = seed_of(20261125);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t i = 0; i < case_count(3000); ++i) {
        const Course c(random);
        const path::Abeam abeam = c.twin.route.abeam_of(c.scene.own.position);
        ASSERT_EQ(c.way.origin, c.scene.own.position);
        ASSERT_GE(c.way.ahead.joined_at, abeam.arc_length);
        ASSERT_LE(c.way.ahead.joined_at, static_cast<float>(c.twin.length()) + 2e-3F);
        const Vec3 joint = c.way.origin + c.way.direction * c.way.ahead.straight;
        ASSERT_LE((joint.cast<double>() - c.twin.at(double(c.way.ahead.joined_at))).norm(), 3e-3) << "case " << i;
        ASSERT_NEAR(double(c.way.length),
                    double(c.way.ahead.straight) + c.twin.length() - double(c.way.ahead.joined_at), 5e-3);
        // On the route, the straight beginning does not leave it by more than the vehicle may be beside it.
        const bool near_end = abeam.left < 1.0F;
        if (abeam.off < 0.05F && !near_end) {
            const Vec3d middle = (0.5 * (c.way.origin + joint).cast<double>());
            ASSERT_LE(c.twin.distance(middle, 0.0), 0.25) << "case " << i;
        }
    }
}

TEST(RouteConflict, FindsEachLossAndNeverTooLate)
{
    const std::uint64_t seed = seed_of(20261126);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t conflicts = 0;
    std::size_t past_bend = 0;
    for (std::size_t i = 0; i < case_count(6000); ++i) {
        Course c(random);
        Track& track = c.scene.track(Vec3::Zero(), in_cube(random, 10.0F), random.uniform(0.0F, 3.0F));
        const float meet = random.uniform(0.0F, 9.0F);
        track.position = c.at(double(meet)).cast<float>() - track.velocity * meet + in_cube(random, 4.0F);
        track.sigma_velocity = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 0.3F);
        double loss = -1;
        double least = 1e9;
        for (double t = 0; t <= double(kAhead); t += 4e-3) {
            const double margin = c.margin(track, t);
            least = std::min(least, margin);
            loss = margin <= -2e-3 && loss < 0 ? t : loss;
        }
        Conflict conflict;
        WorkBudget budget(100'000);
        const bool found = test::predict_conflict(c.scene.situation(), c.way, 0, kAhead, budget, conflict);
        Conflict main;
        ASSERT_EQ(main_conflict(c.scene.situation(), c.way, kAhead, budget, main), found);
        if (loss >= 0 && c.margin(track, 0.0) > c.slack()) {
            ASSERT_TRUE(found) << "case " << i << ": loss at " << loss;
            ASSERT_LE(double(conflict.time_to_loss), loss + 2e-3) << "case " << i;
        }
        if (!found) {
            continue;
        }
        ++conflicts;
        const double grown = 0.5 * double(c.scene.rules.k_sigma) * double(track.sigma_velocity);
        ASSERT_LE(least, kWider * c.slack() + grown + 0.02) << "case " << i << ": nothing there";
        const double closest = double(conflict.time_to_closest);
        past_bend += conflict.way_at_closest > c.way.ahead.straight ? 1U : 0U;
        ASSERT_NEAR(double(conflict.way_at_closest), std::min(double(c.way.speed) * closest, double(c.way.length)),
                    5e-3);
        ASSERT_LE((conflict.own_at_closest.cast<double>() - c.at(closest)).norm(), 6e-3) << "case " << i;
        ASSERT_EQ(main.time_to_loss, conflict.time_to_loss);
    }
    EXPECT_GT(conflicts, case_count(6000) / 3);
    EXPECT_GT(past_bend, case_count(6000) / 8);
}

TEST(RouteConflict, ObstaclesBesideAndOnIt)
{
    const std::uint64_t seed = seed_of(20261127);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t conflicts = 0;
    for (std::size_t i = 0; i < case_count(3000); ++i) {
        Course c(random);
        const float meet = random.uniform(0.0F, 9.0F);
        const Vec3 centre = c.at(double(meet)).cast<float>() + in_cube(random, 4.0F);
        const float radius = random.uniform(0.2F, 2.0F);
        c.scene.obstacle(geometry::make_sphere(centre, radius));
        double loss = -1;
        double least = 1e9;
        const auto margin_at = [&](double t) {
            return oracle::point_box(centre.cast<double>() - c.at(t), c.scene.limits.half_extents.cast<double>()) -
                   double(radius);
        };
        for (double t = 0; t <= double(kAhead); t += 4e-3) {
            least = std::min(least, margin_at(t));
            loss = margin_at(t) <= -2e-3 && loss < 0 ? t : loss;
        }
        Conflict conflict;
        WorkBudget budget(100'000);
        const bool found = main_conflict(c.scene.situation(), c.way, kAhead, budget, conflict);
        if (loss >= 0 && margin_at(0.0) > c.slack()) {
            ASSERT_TRUE(found) << "case " << i << ": loss at " << loss;
            ASSERT_LE(double(conflict.time_to_loss), loss + 2e-3) << "case " << i;
        }
        if (found) {
            ++conflicts;
            ASSERT_LE(least, kWider * c.slack() + 0.02) << "case " << i;
            ASSERT_LE((conflict.own_at_closest.cast<double>() - c.at(double(conflict.time_to_closest))).norm(), 6e-3);
            ASSERT_GE(conflict.time_to_closest, conflict.time_to_loss);
        }
    }
    EXPECT_GT(conflicts, case_count(3000) / 6);
}

/// A route of one leg and the leg that a reference holds are flown alike, to the bit.
TEST(RouteConflict, OneLegIsALeg)
{
    const std::uint64_t seed = seed_of(20261128);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t conflicts = 0;
    for (std::size_t i = 0; i < case_count(3000); ++i) {
        Scene scene;
        scene.own.position = in_cube(random, 20.0F);
        const Vec3 start = random.below(2) == 0 ? scene.own.position : Vec3(in_cube(random, 30.0F));
        const Vec3 end = in_cube(random, 100.0F);
        scene.leg(start, end, random.uniform(0.5F, 15.0F));
        const Way aim = way_of(scene.situation());
        const Seconds meet = random.uniform(1.0F, 9.0F);
        const Vec3 velocity = in_cube(random, 10.0F);
        const Vec3 at = aim.origin + aim.direction * std::min(aim.speed * meet, aim.length) + in_cube(random, 4.0F);
        Track& track = scene.track(at - meet * velocity, velocity, random.uniform(0.5F, 3.0F));
        track.sigma_velocity = 0.1F;
        const Situation on_leg = scene.situation();
        Conflict with_leg;
        WorkBudget budget(100'000);
        const bool found = main_conflict(on_leg, way_of(on_leg), kAhead, budget, with_leg);
        path::Route route;
        ASSERT_EQ(route.add_leg(start, end), path::RouteStatus::ok);
        scene.reference = Reference(route, scene.reference.speed);
        Conflict along;
        WorkBudget other(100'000);
        ASSERT_EQ(main_conflict(on_leg, way_of(on_leg), kAhead, other, along), found) << "case " << i;
        ASSERT_EQ(other.spent(), budget.spent());
        conflicts += found ? 1U : 0U;
        if (found) {
            ASSERT_EQ(along.time_to_loss, with_leg.time_to_loss) << "case " << i;
            ASSERT_EQ(along.own_at_closest, with_leg.own_at_closest) << "case " << i;
        }
    }
    EXPECT_GT(conflicts, case_count(3000) / 10);
}

}  // namespace
}  // namespace jink::world
