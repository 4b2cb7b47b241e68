// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/snapshot.hpp"

#include <array>
#include <memory>

#include <gtest/gtest.h>

#include "core/world/cost_to_go_field.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

/// One of each kind of threat, known badly.
void fill(Scene& scene)
{
    scene.leg(Vec3(0, 0, 10), Vec3(100, 0, 10));
    scene.own.position = Vec3(0, 0, 10);
    scene.own.velocity = Vec3(5, 0, 0);
    scene.own.sigma_position = 0.2F;
    scene.airspace.has_floor = scene.airspace.has_ceiling = scene.airspace.has_keep_in = true;
    scene.airspace.floor = 0.0F;
    scene.airspace.ceiling = 50.0F;
    scene.airspace.keep_in_radius = 80.0F;
    Track& track = scene.track(Vec3(30, 5, 10), Vec3(-5, -1, 0), 1.5F);
    track.sigma_position = 0.4F;
    track.half_height = 1.0F;
    track.cooperative = true;
    track.stamp = scene.now - 0.8F;
    scene.track(Vec3(-30, 5, 12), Vec3(9, -1, 0), 0.5F);
    scene.cylinder(Vec2(20, 12), 5.0F, Vec2(0.5F, 0.0F));
    scene.obstacle(geometry::make_box(Vec3(25, -4, 10), Vec3(2, 1, 8)));
    scene.obstacle(geometry::make_sphere(Vec3(15, -6, 10), 1.0F));
    scene.obstacles.back().uncertainty = 0.3F;
}

/// What a flight keeps from each kind of threat alone.
std::array<float, 7> margins(const Situation& s)
{
    std::array<float, 7> out{};
    const path::TimedPath path = flight({Vec3(0, 0, 10), Vec3(20, 3, 12), Vec3(40, 0, 10)}, 4.0F);
    for (const ThreatKind kind : {ThreatKind::floor, ThreatKind::ceiling, ThreatKind::keep_in, ThreatKind::track,
                                  ThreatKind::cylinder, ThreatKind::obstacle}) {
        Situation alone = s;
        alone.threats = of_kind(s.threats, kind);
        WorkBudget budget(kPlenty);
        out[static_cast<std::size_t>(kind)] = least_separation(alone, path, 10.0F, budget, s.rules.escape).margin;
    }
    return out;
}

TEST(Snapshot, IsTheSituationAsItWas)
{
    Scene scene;
    fill(scene);
    Manoeuvre flying;
    flying.cost = 0.25F;
    const Commanded commanded{Vec3(4, 1, 0), scene.now};
    scene.flying = &flying;
    scene.commanded = &commanded;
    scene.own_id = 7;
    scene.shared_horizon = 2.0F;
    const CostToGoField field;
    scene.cost_to_go = &field;
    const auto snapshot = std::make_unique<Snapshot>();
    EXPECT_FALSE(is_complete(snapshot->situation()));
    snapshot->take(scene.situation());
    const auto before = margins(scene.situation());
    // Everything changes.
    flying.cost = 0.75F;
    for (Track& track : scene.tracks) {
        track.position = Vec3(10, 0, 10);
        track.radius = 5.0F;
    }
    for (Obstacle& obstacle : scene.obstacles) {
        obstacle.shape.centre = Vec3(10, 0, 10);
    }
    for (Cylinder& cylinder : scene.cylinders) {
        cylinder.circle.centre = Vec2(10, 0);
    }
    scene.airspace.ceiling = 12.0F;
    scene.own.position = Vec3(1, 1, 1);
    scene.limits.half_extents *= 2.0F;
    scene.leg(Vec3(0, 0, 0), Vec3(0, 1, 0));
    const Situation s = snapshot->situation();
    EXPECT_TRUE(is_complete(s));
    EXPECT_EQ(margins(s), before);
    EXPECT_NE(margins(scene.situation()), before);
    EXPECT_EQ(s.own.position, Vec3(0, 0, 10));
    EXPECT_EQ(s.own_id, 7U);
    EXPECT_EQ(s.shared_horizon, 2.0F);
    EXPECT_EQ(s.cost_to_go, &field);
    ASSERT_NE(s.flying, nullptr);
    EXPECT_EQ(s.flying->cost, 0.25F);
    ASSERT_NE(s.commanded, nullptr);
    EXPECT_EQ(s.commanded->velocity, Vec3(4, 1, 0));
    EXPECT_EQ(s.reference.route().length(), 100.0F);
    for (const Threat& threat : of_kind(s.threats, ThreatKind::track)) {
        EXPECT_NE(threat.track, &scene.tracks[threat.ref.index]);
        EXPECT_EQ(threat.track->id, scene.tracks[threat.ref.index].id);
    }
}

TEST(Snapshot, HoldsARouteOfItsOwn)
{
    Scene scene;
    fill(scene);
    path::Route route;
    ASSERT_EQ(route.add_leg(Vec3(0, 0, 10), Vec3(30, 0, 10)), path::RouteStatus::ok);
    ASSERT_EQ(route.add_leg(Vec3(30, 0, 10), Vec3(30, 40, 10)), path::RouteStatus::ok);
    scene.reference = Reference(route, 4.0F, 1);
    const auto snapshot = std::make_unique<Snapshot>();
    snapshot->take(scene.situation());
    route.clear();
    const Situation s = snapshot->situation();
    EXPECT_EQ(s.reference.route().length(), 70.0F);
    EXPECT_EQ(s.reference.segment, 1U);
    EXPECT_EQ(s.reference.speed, 4.0F);
}

TEST(Snapshot, OfThreatsThatWereNeverCollectedHasNone)
{
    Scene scene;
    fill(scene);
    const auto snapshot = std::make_unique<Snapshot>();
    snapshot->take(scene.situation());
    Situation none = scene.situation();
    none.threats = {};
    none.flying = nullptr;
    snapshot->take(none);
    EXPECT_EQ(snapshot->situation().threats.data(), nullptr);
    EXPECT_FALSE(is_complete(snapshot->situation()));
    none.threats = std::span<const Threat>(scene.threats.all().data(), 0);
    snapshot->take(none);
    EXPECT_NE(snapshot->situation().threats.data(), nullptr) << "nothing to keep clear of is not the same";
    EXPECT_TRUE(snapshot->situation().threats.empty());
}

}  // namespace
}  // namespace jink::world
