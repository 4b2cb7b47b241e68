// SPDX-License-Identifier: BSD-3-Clause
// Cylinders against dense samples of time in double, and against general solids in the cylinder's own frame.
#include "core/world/cylinder.hpp"

#include <gtest/gtest.h>

#include "core/world/conflict.hpp"
#include "tests/property/core/world/separation_oracle.hpp"

namespace jink::world {
namespace {

using geometry::oracle::case_count;
using geometry::oracle::in_cube;
using geometry::oracle::seed_of;
using oracle::Vec3d;
using test::kPlenty;
using test::Scene;
using test::separation;

/// The code may say that much more than the truth: rounding of coordinates up to 100 m.
constexpr double kOptimism = 1e-3;

Cylinder any_cylinder(Random& random, float reach)
{
    Cylinder cylinder;
    cylinder.circle.centre = in_cube(random, reach).head<2>();
    cylinder.circle.radius = random.below(4) == 0 ? random.uniform(20.0F, 60.0F) : random.uniform(0.1F, 12.0F);
    cylinder.velocity = random.below(3) == 0 ? Vec2(Vec2::Zero()) : Vec2(in_cube(random, 12.0F).head<2>());
    cylinder.bottom = random.uniform(-15.0F, 10.0F);
    cylinder.top = cylinder.bottom + random.uniform(0.05F, 12.0F);
    cylinder.margin = random.uniform(0.0F, 20.0F);
    return cylinder;
}

void any_vehicle(Random& random, Scene& scene)
{
    scene.limits.half_extents =
        Vec3(random.uniform(0.2F, 3.0F), random.uniform(0.2F, 3.0F), random.uniform(0.2F, 2.0F));
    scene.own.sigma_position = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 0.4F);
    scene.rules.k_sigma = random.uniform(0.0F, 4.0F);
}

path::TimedPath any_flight(Random& random, std::size_t points, float speed)
{
    path::TimedPath path;
    Vec3 position = in_cube(random, 8.0F);
    Vec3 velocity = in_cube(random, speed);
    Seconds t = 0.0F;
    for (std::size_t i = 0; i < points; ++i) {
        velocity = random.below(6) == 0 ? Vec3(Vec3::Zero()) : Vec3(0.6F * velocity + 0.4F * in_cube(random, speed));
        if (i + 1 == points && i > 0) {
            velocity = path.points.back().velocity;
        }
        path.points.unchecked_push_back({position, velocity, t});
        const Seconds step = random.below(5) == 0 ? random.uniform(1.0F, 8.0F) : random.uniform(0.05F, 0.5F);
        position += velocity * step;
        t += step;
    }
    return path;
}

TEST(CylinderSeparation, NeverOptimisticAndExactInTime)
{
    const std::uint64_t seed = seed_of(20261123);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t contacts = 0;
    std::size_t inside = 0;
    for (std::size_t i = 0; i < case_count(4000); ++i) {
        Scene scene;
        any_vehicle(random, scene);
        for (std::size_t n = 1 + random.below(3); n > 0; --n) {
            scene.cylinders.push_back(any_cylinder(random, 40.0F));
        }
        scene.airspace.cylinders = scene.cylinders;
        const path::TimedPath path = any_flight(random, 1 + random.below(random.below(3) == 0 ? 40 : 8), 8.0F);
        const Seconds horizon = random.below(4) == 0 ? random.uniform(0.0F, 3.0F) : 100.0F;
        const EscapeRule escape =
            random.below(4) == 0 ? EscapeRule{random.uniform(0.02F, 0.2F), random.uniform(0.1F, 2.0F)} : EscapeRule{};
        double least = double(kSeparationCap);
        for (const Cylinder& cylinder : scene.cylinders) {
            const auto at = [&](double t) {
                return oracle::cylinder_margin_at(scene, oracle::position_at(path, t), cylinder, t);
            };
            inside += at(0.0) < 0.0 ? 1U : 0U;
            least = std::min(least, std::max(oracle::least(at, oracle::flight_end(path, double(horizon)), escape),
                                             -double(kSeparationCap)));
        }
        const Separation found = separation(scene, path, horizon, escape);
        contacts += least < 0.0 ? 1U : 0U;
        ASSERT_LE(double(found.margin), least + kOptimism) << "case " << i;
        ASSERT_GE(double(found.margin), least - 2e-3) << "case " << i;
        ASSERT_EQ(found.against.kind == ThreatKind::none, found.margin >= kSeparationCap) << "case " << i;
    }
    EXPECT_GT(contacts, case_count(4000) / 10);
    EXPECT_LT(contacts, case_count(4000) * 9 / 10);
    EXPECT_GT(inside, case_count(4000) / 50);
}

/// A moving cylinder in its own frame: a static cylinder, for the general solids' distance (Wolfe's method).
TEST(CylinderSeparation, IsTheDistanceOfACylinderInItsOwnFrame)
{
    const std::uint64_t seed = seed_of(20261124);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t apart = 0;
    for (std::size_t i = 0; i < case_count(1500); ++i) {
        Scene scene;
        any_vehicle(random, scene);
        scene.own.sigma_position = 0.0F;
        const Cylinder& cylinder = scene.cylinders.emplace_back(any_cylinder(random, 25.0F));
        scene.airspace.cylinders = scene.cylinders;
        const path::TimedPath path = any_flight(random, 2, 8.0F);
        const geometry::Shape solid = geometry::make_cylinder(
            {cylinder.circle.centre.x(), cylinder.circle.centre.y(), cylinder.bottom},
            {cylinder.circle.centre.x(), cylinder.circle.centre.y(), cylinder.top}, cylinder.circle.radius);
        const Seconds end = path.points[1].time;
        const Vec3 drift = end * Vec3(cylinder.velocity.x(), cylinder.velocity.y(), 0.0F);
        const double distance = geometry::oracle::swept_box_bounds(scene.limits.half_extents, path.points[0].position,
                                                                   path.points[1].position - drift, solid, 1e-4)
                                    .lower;
        const Separation found = separation(scene, path, 100.0F, EscapeRule{});
        if (distance > 0.0) {
            ++apart;
            ASSERT_NEAR(double(found.margin), std::min(distance, double(kSeparationCap)), 2e-3) << "case " << i;
        } else if (oracle::cylinder_margin_at(scene, path.points[0].position.cast<double>(), cylinder, 0.0) > 0.0) {
            ASSERT_LT(found.margin, 1e-3F) << "case " << i;
        }
    }
    EXPECT_GT(apart, case_count(1500) / 3);
}

TEST(CylinderSeparation, AtOneInstantIsTheDefinition)
{
    const std::uint64_t seed = seed_of(20261125);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t i = 0; i < case_count(20000); ++i) {
        Scene scene;
        any_vehicle(random, scene);
        scene.cylinders.push_back(any_cylinder(random, 40.0F));
        scene.airspace.cylinders = scene.cylinders;
        const Vec3 own = in_cube(random, 30.0F);
        const Seconds t = random.uniform(0.0F, 10.0F);
        WorkBudget budget(kPlenty);
        const float found = separation_at(scene.situation(), own, t, budget).margin;
        const double truth = std::clamp(
            oracle::cylinder_margin_at(scene, own.cast<double>(), scene.cylinders[0], double(t)), -50.0, 50.0);
        ASSERT_LE(double(found), truth + 1e-5) << "case " << i;
        ASSERT_GE(double(found), truth - 1e-3) << "case " << i;
    }
}

/// The nominal path in double precision: straight to its end, then hovering.
Vec3d on_way(const Way& way, double t)
{
    const double flown = std::min(double(way.speed) * t, double(way.length));
    return way.origin.cast<double>() + way.direction.cast<double>() * flown;
}

TEST(CylinderConflict, FindsEachLossAndNeverTooLate)
{
    const std::uint64_t seed = seed_of(20261126);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t conflicts = 0;
    std::size_t none = 0;
    for (std::size_t i = 0; i < case_count(4000); ++i) {
        Scene scene;
        any_vehicle(random, scene);
        scene.own.position = in_cube(random, 10.0F);
        scene.leg(scene.own.position, in_cube(random, random.below(4) == 0 ? 10.0F : 90.0F),
                  random.uniform(0.5F, 15.0F));
        scene.cylinders.push_back(any_cylinder(random, 50.0F));
        scene.airspace.cylinders = scene.cylinders;
        const Way way = way_of(scene.situation());
        const double lookahead = double(random.uniform(1.0F, 10.0F));
        const auto margin = [&](double t) {
            return oracle::cylinder_margin_at(scene, on_way(way, t), scene.cylinders[0], t);
        };
        double loss = -1.0;
        double least = 1e9;
        for (double t = 0; t <= lookahead; t += 5e-3) {
            least = std::min(least, margin(t));
            loss = loss < 0.0 && margin(t) <= -1e-3 ? t : loss;
        }
        Conflict conflict;
        WorkBudget budget(kPlenty);
        const bool found = main_conflict(scene.situation(), way, static_cast<float>(lookahead), budget, conflict);
        if (margin(0.0) <= 0.0) {
            // Inside, only motion that leaves for good is skipped.
            const double shrunk = double(kDrawingApart.slack) - margin(0.0);
            for (double t = 0; !found && t <= lookahead; t += 0.02) {
                ASSERT_GE(margin(t) + std::max(0.0, shrunk - double(kDrawingApart.speed) * t), -1e-3) << "case " << i;
            }
            continue;
        }
        if (loss >= 0.0) {
            ASSERT_TRUE(found) << "case " << i;
            ASSERT_LE(double(conflict.time_to_loss), loss + 1e-4) << "case " << i;
        }
        none += found ? 0U : 1U;
        if (!found) {
            continue;
        }
        ++conflicts;
        ASSERT_EQ(conflict.threat, (ThreatRef{ThreatKind::cylinder, 0}));
        ASSERT_LE(least, 0.2) << "case " << i << ": nothing there";  // between two samples, 36 m/s
        ASSERT_LE(margin(double(conflict.time_to_loss)), 0.01) << "case " << i << ": too early";
        ASSERT_NEAR(double(conflict.margin), least, 0.1) << "case " << i;
        ASSERT_GE(conflict.time_to_closest, conflict.time_to_loss);
    }
    EXPECT_GT(conflicts, case_count(4000) / 30);
    EXPECT_GT(none, case_count(4000) / 5);
}

}  // namespace
}  // namespace jink::world
