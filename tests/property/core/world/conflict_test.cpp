// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/conflict.hpp"

#include <gtest/gtest.h>

#include "tests/property/core/world/separation_oracle.hpp"

namespace jink::world {
namespace {

using geometry::oracle::case_count;
using geometry::oracle::in_cube;
using geometry::oracle::seed_of;
using oracle::Vec3d;
using test::kPlenty;
using test::Scene;

/// The way in double precision: straight to the leg, along it to its end, then hovering.
Vec3d place_on_way(const Scene& scene, const Way& way, double t)
{
    const double joining = double(way.ahead.straight) / std::max(double(way.speed), 1e-9);
    if (t < joining) {
        return way.origin.cast<double>() + way.direction.cast<double>() * (double(way.speed) * t);
    }
    if (!(way.length > 0.0F)) {
        return way.origin.cast<double>();
    }
    const path::RouteSegment& leg = scene.reference.route().segments().front();
    const Vec3 velocity = vehicle::clamped_velocity(leg.along, scene.reference.speed, scene.limits);
    const double on = double(way.ahead.joined_at) + double(velocity.norm()) * (t - joining);
    return leg.start.cast<double>() + leg.along.cast<double>() * std::min(on, double(leg.length));
}

double margin_at(const Scene& scene, const Way& way, const Track& track, double t)
{
    const Vec3d threat = track.position.cast<double>() + track.velocity.cast<double>() * t;
    return oracle::point_box(threat - place_on_way(scene, way, t), scene.limits.half_extents.cast<double>()) -
           oracle::radius_of(scene, track, t);
}

Scene any_scene(Random& random)
{
    Scene scene;
    scene.limits.half_extents =
        Vec3(random.uniform(0.2F, 2.0F), random.uniform(0.2F, 2.0F), random.uniform(0.2F, 2.0F));
    scene.own.sigma_position = random.below(3) == 0 ? random.uniform(0.0F, 0.5F) : 0.0F;
    scene.own.position = in_cube(random, 20.0F);
    scene.rules.k_sigma = random.uniform(0.0F, 4.0F);
    const Vec3 end = random.below(4) == 0 ? Vec3(scene.own.position + in_cube(random, 5.0F)) : in_cube(random, 100.0F);
    scene.leg(random.below(2) == 0 ? scene.own.position : in_cube(random, 30.0F), end, random.uniform(0.5F, 15.0F));
    Track& track = scene.track(Vec3::Zero(), in_cube(random, 10.0F), random.uniform(0.0F, 3.0F));
    track.stamp = scene.now - random.uniform(0.0F, 2.0F);
    // Aimed near some point of the nominal path.
    const Way way = way_of(scene.situation());
    const Seconds meet = random.uniform(0.0F, 9.0F);
    track.position =
        place_on_way(scene, way, double(meet)).cast<float>() - track.velocity * meet + in_cube(random, 3.0F);
    track.sigma_position = random.uniform(0.0F, 0.3F);
    track.sigma_velocity = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 0.5F);
    track.max_acceleration = random.below(3) == 0 ? random.uniform(0.0F, 0.5F) : 0.0F;
    return scene;
}

/// Growth of the track's sphere in `dt` at the end of the look-ahead, at most.
double growth(const Scene& scene, const Track& track, double lookahead, double dt)
{
    const double age = std::max(0.0, double(scene.now.us - track.stamp.us) * 1e-6) + lookahead;
    return dt * (double(scene.rules.k_sigma) * double(track.sigma_velocity) + double(track.max_acceleration) * age);
}

TEST(PredictConflict, FindsEachLossAndNeverTooLate)
{
    const std::uint64_t seed = seed_of(20260721);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t conflicts = 0;
    for (std::size_t i = 0; i < case_count(20000); ++i) {
        const Scene scene = any_scene(random);
        const Track& track = scene.tracks[0];
        const double lookahead = double(random.uniform(1.0F, 10.0F));
        const Way way = way_of(scene.situation());
        double loss = -1;
        double least = 1e9;
        for (double t = 0; t <= lookahead; t += 2e-3) {
            const double margin = margin_at(scene, way, track, t);
            least = std::min(least, margin);
            if (margin <= -1e-3 && loss < 0) {
                loss = t;
            }
        }
        Conflict conflict;
        WorkBudget budget(100'000);
        const bool found =
            test::predict_conflict(scene.situation(), way, 0, static_cast<float>(lookahead), budget, conflict);
        conflicts += found ? 1U : 0U;
        const bool inside = margin_at(scene, way, track, 0.0) <= 0;
        if (loss >= 0 && !inside) {
            ASSERT_TRUE(found) << "case " << i;
            ASSERT_LE(double(conflict.time_to_loss), loss + 1e-3) << "case " << i;
        }
        if (!found) {
            continue;
        }
        ASSERT_LE(least, growth(scene, track, lookahead, 0.5) + 0.02) << "case " << i << ": nothing there";
        const double then = margin_at(scene, way, track, double(conflict.time_to_loss));
        ASSERT_LE(then, growth(scene, track, lookahead, 0.5) + 2e-3) << "case " << i << ": too early";
        ASSERT_GE(conflict.time_to_closest, conflict.time_to_loss);
        ASSERT_LE(double(conflict.time_to_closest), lookahead + 1e-3);
        const Vec3d own = place_on_way(scene, way, double(conflict.time_to_closest));
        const Vec3d threat = (track.position + track.velocity * conflict.time_to_closest).cast<double>();
        ASSERT_NEAR((own - conflict.own_at_closest.cast<double>()).norm(), 0, 1e-3) << "case " << i;
        ASSERT_NEAR((threat - conflict.threat_at_closest.cast<double>()).norm(), 0, 1e-3) << "case " << i;
        ASSERT_NEAR(double(conflict.miss_distance), (own - threat).norm(), 1e-3) << "case " << i;
        ASSERT_NEAR(double(conflict.radius_at_closest),
                    oracle::radius_of(scene, track, double(conflict.time_to_closest)), 1e-3);
        ASSERT_NEAR(double(conflict.margin), margin_at(scene, way, track, double(conflict.time_to_closest)), 2e-3)
            << "case " << i;
        if (conflict.time_to_closest > conflict.time_to_loss) {
            for (double t = 0; t <= lookahead; t += 0.01) {
                const double distance =
                    (place_on_way(scene, way, t) - track.position.cast<double>() - track.velocity.cast<double>() * t)
                        .norm();
                ASSERT_GE(distance, double(conflict.miss_distance) - 1e-3) << "case " << i << " at " << t;
            }
        }
    }
    EXPECT_GT(conflicts, case_count(20000) / 5) << "the cases have to be worth something";
}

/// Inside a margin only threats that leave it for good may be skipped.
TEST(PredictConflict, InsideAMarginOnlyLeavingIsNoConflict)
{
    const std::uint64_t seed = seed_of(20260722);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t passed_over = 0;
    for (std::size_t i = 0; i < case_count(20000); ++i) {
        Scene scene = any_scene(random);
        Track& track = scene.tracks[0];
        track.position = scene.own.position + in_cube(random, 3.0F);
        const Way way = way_of(scene.situation());
        if (margin_at(scene, way, track, 0.0) >= 0) {
            continue;
        }
        Conflict conflict;
        WorkBudget budget(100'000);
        if (test::predict_conflict(scene.situation(), way, 0, 8.0F, budget, conflict)) {
            ASSERT_EQ(conflict.time_to_loss, 0.0F) << "case " << i;
            continue;
        }
        ++passed_over;
        const double shrunk = double(kDrawingApart.slack) - margin_at(scene, way, track, 0.0);
        for (double t = 0; t <= 8.0; t += 0.02) {
            const double left = std::max(0.0, shrunk - double(kDrawingApart.speed) * t);
            ASSERT_GE(margin_at(scene, way, track, t) + left, -1e-3)
                << "case " << i << ": stays, or comes back, at " << t;
        }
    }
    EXPECT_GT(passed_over, case_count(20000) / 50);
}

/// A solid on the path is detected, never too late; skipped parts are clear of it.
TEST(MainConflict, SolidsAreFoundInTime)
{
    const std::uint64_t seed = seed_of(20260723);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::vector<Point3> vertices;
    for (std::size_t i = 0; i < case_count(2000); ++i) {
        Scene scene = any_scene(random);
        scene.tracks.clear();
        constexpr geometry::ShapeKind kKinds[] = {geometry::ShapeKind::sphere, geometry::ShapeKind::box,
                                                  geometry::ShapeKind::capsule, geometry::ShapeKind::cylinder,
                                                  geometry::ShapeKind::hull};
        const Way way = way_of(scene.situation());
        const float meet = random.uniform(-2.0F, 9.0F);
        const Vec3 centre = place_on_way(scene, way, double(meet)).cast<float>() + in_cube(random, 5.0F);
        scene.obstacle(geometry::oracle::any_shape(random, kKinds[random.below(5)], centre, random.uniform(0.5F, 15.0F),
                                                   vertices));
        const geometry::Shape& shape = scene.obstacles[0].shape;
        const Seconds lookahead = random.uniform(1.0F, 10.0F);
        const double extra = double(scene.rules.k_sigma) * double(scene.own.sigma_position);
        const auto distance_until = [&](double t) {
            const Vec3 joint = way.origin + way.direction * std::min(way.ahead.straight, way.speed * float(t));
            const Vec3& half = scene.limits.half_extents;
            auto bounds = geometry::oracle::swept_box_bounds(half, way.origin, joint, shape, 1e-4);
            const auto rest =
                geometry::oracle::swept_box_bounds(half, joint, place_on_way(scene, way, t).cast<float>(), shape, 1e-4);
            bounds.lower = std::min(bounds.lower, rest.lower);
            bounds.upper = std::min(bounds.upper, rest.upper);
            return bounds;
        };
        WorkBudget budget(kPlenty);
        Conflict conflict;
        const bool found = main_conflict(scene.situation(), way, lookahead, budget, conflict);
        const bool inside = distance_until(0.0).upper <= extra;
        if (!found) {
            if (!inside) {
                ASSERT_GE(distance_until(double(lookahead)).upper, extra - 2e-3) << "case " << i;
            }
            continue;
        }
        ASSERT_LE(distance_until(double(lookahead)).lower, extra + 2e-2) << "case " << i << ": nothing there";
        if (!inside && conflict.time_to_loss > 0.0F) {
            ASSERT_GE(distance_until(double(conflict.time_to_loss) * 0.999).upper, extra - 2e-3)
                << "case " << i << ": too late";
        }
        ASSERT_GE(conflict.time_to_closest, conflict.time_to_loss);
    }
}

TEST(MainConflict, IsTheFirstOfAll)
{
    const std::uint64_t seed = seed_of(20260724);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t i = 0; i < case_count(3000); ++i) {
        Scene scene = any_scene(random);
        for (std::size_t n = random.below(6); n > 0; --n) {
            scene.tracks.push_back(any_scene(random).tracks[0]);
        }
        const Way way = way_of(scene.situation());
        WorkBudget budget(kPlenty);
        Conflict main;
        const bool found = main_conflict(scene.situation(), way, 8.0F, budget, main);
        bool any = false;
        Conflict first;
        for (std::size_t k = 0; k < scene.tracks.size(); ++k) {
            Conflict c;
            if (test::predict_conflict(scene.situation(), way, k, 8.0F, budget, c) &&
                (!any || c.time_to_loss < first.time_to_loss ||
                 (c.time_to_loss == first.time_to_loss && c.margin < first.margin))) {
                first = c;
                any = true;
            }
        }
        ASSERT_EQ(found, any) << "case " << i;
        if (found) {
            ASSERT_EQ(main.threat, first.threat) << "case " << i;
        }
    }
}

}  // namespace
}  // namespace jink::world
