// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/planner.hpp"

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::orca {
namespace {

using world::PlanStatus;
using world::test::kPlenty;
using world::test::Scene;

static_assert(world::AvoidanceMethod<Planner>);

/// A vehicle on its leg to the east at 30 m height, at 5 m/s.
Scene eastward()
{
    Scene scene;
    scene.leg(Vec3(0, 0, 30), Vec3(300, 0, 30), 5.0F);
    scene.own.position = Vec3(0, 0, 30);
    scene.own.velocity = Vec3(5, 0, 0);
    scene.own.stamp = scene.now;
    return scene;
}

PlanStatus plan(Planner& planner, const Scene& scene, world::Manoeuvre& out, std::uint32_t units = kPlenty)
{
    WorkBudget budget(units);
    return planner.plan(scene.situation(), budget, out);
}

world::Manoeuvre found(const Scene& scene, const Settings& settings = {})
{
    Planner planner(settings);
    world::Manoeuvre out;
    EXPECT_EQ(plan(planner, scene, out), PlanStatus::found);
    return out;
}

TEST(OrcaPlanner, FliesTheLegWhereNothingIsInTheWay)
{
    const world::Manoeuvre m = found(eastward());
    EXPECT_EQ(m.kind, world::ManoeuvreKind::velocity);
    EXPECT_LT((m.command - Vec3(5, 0, 0)).norm(), 1e-4F);
    EXPECT_GE(m.path.duration(), 8.0F);
    EXPECT_EQ(m.path.points.front().position, Vec3(0, 0, 30));
}

TEST(OrcaPlanner, SlowsDownBeforeTheEndOfTheReference)
{
    Scene scene = eastward();
    scene.own.position = Vec3(298, 0, 30);
    EXPECT_NEAR(found(scene).command.norm(), 2.5F, 1e-3F);  // 2 m to go; half a second of 5 m/s2 is all it may ask for
    scene.own.velocity = Vec3(2, 0, 0);
    EXPECT_NEAR(found(scene).command.norm(), 2.0F, 1e-3F);
}

TEST(OrcaPlanner, WhoDoesNotGiveWayIsGivenTwiceAsMuchRoom)
{
    Scene scene = eastward();
    scene.own_id = 7;
    world::Track& track = scene.track(Vec3(40, 0.5F, 30), Vec3(-5, 0, 0));
    const float alone = found(scene).command.y();
    track.cooperative = true;
    const float shared = found(scene).command.y();
    EXPECT_LT(alone, -0.1F);
    EXPECT_LT(shared, -0.05F);
    EXPECT_NEAR(shared / alone, 0.5F, 0.15F);
    // An outdated track does not count as cooperative, and may have turned since.
    track.stamp = scene.now - 1.5F;
    EXPECT_LT(found(scene).command.y(), alone);
}

/// A report hides what both have turned since: while it is old, a little to the left does not count as a side.
TEST(OrcaPlanner, AnOldReportDoesNotChooseTheSide)
{
    for (const Seconds age : {0.0F, 0.5F, 1.0F, 1.5F}) {
        Scene scene = eastward();
        world::Track& track = scene.track(Vec3(40, 0, 30), Vec3(-5, -0.4F, 0));
        track.cooperative = true;
        track.stamp = scene.now - age;
        EXPECT_EQ(found(scene).command.y() < 0.0F, age > 0.0F) << age;
    }
}

/// Two cooperative vehicles head-on pass on opposite sides: each to its right.
TEST(OrcaPlanner, TwoThatMeetPassEachOtherOnTheRight)
{
    Scene east = eastward();
    east.track(Vec3(40, 0, 30), Vec3(-5, 0, 0)).cooperative = true;
    Scene west = eastward();
    west.leg(Vec3(40, 0, 30), Vec3(-260, 0, 30), 5.0F);
    west.own.position = Vec3(40, 0, 30);
    west.own.velocity = Vec3(-5, 0, 0);
    west.track(Vec3(0, 0, 30), Vec3(5, 0, 0)).cooperative = true;
    const Vec3 a = found(east).command;
    const Vec3 b = found(west).command;
    EXPECT_LT(a.y(), -0.05F);
    EXPECT_LT((a + b).norm(), 1e-4F);
}

TEST(OrcaPlanner, BoundsOfTheAirspaceAreKept)
{
    Scene scene = eastward();
    scene.leg(Vec3(0, 0, 30), Vec3(30, 0, 0), 5.0F);
    scene.own.velocity = Vec3(0, 0, -1);
    scene.own.position = Vec3(24, 0, 6);
    scene.airspace.has_floor = true;
    scene.airspace.floor = 4.5F;  // half a metre below the box
    EXPECT_GE(found(scene).command.z(), -0.51F);
    scene.own.position.z() = 5.0F;  // half a metre in its margin
    EXPECT_GE(found(scene).command.z(), 0.29F);
    scene.airspace.has_floor = false;
    EXPECT_LT(found(scene).command.z(), -1.0F);

    Scene inside = eastward();
    inside.airspace.has_keep_in = true;
    inside.airspace.keep_in_radius = 1.9F;  // 1.414 to the box's corner
    EXPECT_LE(found(inside).command.x(), 5.0F - 2.4F);
}

TEST(OrcaPlanner, CylindersAreFlownAround)
{
    Scene scene = eastward();
    scene.cylinder(world::Vec2(20, 1), 10.0F);
    scene.airspace.cylinders = scene.cylinders;
    scene.cylinders.front().top = 60.0F;
    const Vec3 command = found(scene).command;
    EXPECT_LE(command.x(), 5.0F);
    EXPECT_LT(command.x(), 9.0F);
    Planner planner;
    world::Manoeuvre out;
    for (int i = 0; i < 2000 && scene.own.position.x() < 200.0F; ++i) {
        ASSERT_EQ(plan(planner, scene, out), PlanStatus::found);
        vehicle::advance(scene.own, out.command, scene.limits, 0.05F);
        scene.now = scene.now + 0.05F;
        scene.own.stamp = scene.now;
        ASSERT_GE(
            world::cylinder_distance(scene.limits.half_extents, scene.own.position, scene.cylinders.front(), 0.0F),
            0.0F)
            << i;
    }
}

TEST(OrcaPlanner, MoreCylindersThanRoomKeepsTheNearest)
{
    Scene scene = eastward();
    for (int i = 0; i < 30; ++i) {
        scene.cylinder(world::Vec2(300.0F + 30.0F * static_cast<float>(i), 0), 5.0F);
    }
    scene.cylinder(world::Vec2(8, 0), 5.0F);  // 1.6 m from the box
    scene.cylinders.back().top = 60.0F;
    scene.airspace.cylinders = scene.cylinders;
    EXPECT_LE(found(scene).command.x(), 2.6F);
}

TEST(OrcaPlanner, RefusesWhatIsNoReferenceAndWhatIsNoBudget)
{
    Planner planner;
    world::Manoeuvre out;
    Scene scene = eastward();
    scene.track(Vec3(40, 0, 30), Vec3(-5, 0, 0));
    EXPECT_EQ(plan(planner, scene, out, 3), PlanStatus::budget_spent);
    scene.reference.valid = false;
    EXPECT_EQ(plan(planner, scene, out), PlanStatus::bad_input);
    EXPECT_TRUE(out.path.points.empty()) << "out is written only on found";
}

TEST(OrcaPlanner, SettingsOutOfRangeChangeNothing)
{
    Planner planner;
    const auto refused = [&](auto change) {
        Settings settings;
        change(settings);
        return !planner.configure(settings);
    };
    EXPECT_TRUE(refused([](Settings& s) { s.conflict_ratio = 1.0F; }));
    EXPECT_TRUE(refused([](Settings& s) { s.reach = std::numeric_limits<float>::quiet_NaN(); }));
    EXPECT_TRUE(refused([](Settings& s) { s.stale = 0.0F; }));
    EXPECT_TRUE(refused([](Settings& s) { s.smoothing = 0; }));
    EXPECT_TRUE(refused([](Settings& s) { s.smoothing = CommandFilter::kMax + 1; }));
    EXPECT_EQ(planner.settings().smoothing, Settings{}.smoothing);
}

/// Enclosed on all sides it makes no progress, and reports this once another method is available.
TEST(OrcaPlanner, BlockedIsNoAnswer)
{
    Scene scene = eastward();
    scene.own.velocity = Vec3::Zero();
    scene.obstacle(geometry::make_box(Vec3(10, 0, 30), Vec3(1, 100, 100)));
    scene.own.position = Vec3(7.4F, 0, 30);
    for (const bool gives_up : {true, false}) {
        Settings settings;
        settings.gives_up_blocked = gives_up;
        Planner planner(settings);
        world::Manoeuvre out;
        PlanStatus status = PlanStatus::found;
        Scene now = scene;
        world::Commanded sent;
        for (int i = 0; i < 400 && status == PlanStatus::found; ++i) {
            status = plan(planner, now, out);
            ASSERT_LT(out.command.x(), 0.1F);
            sent = {out.command, now.now};
            now.commanded = &sent;
            now.now = now.now + 0.02F;
            now.own.stamp = now.now;
        }
        EXPECT_EQ(status, gives_up ? PlanStatus::none_available : PlanStatus::found);
        EXPECT_NE(planner.last().status & kBlocked, 0U);
    }
}

/// Settings made from any vehicle that is valid are such as it can stop with: the filter refuses none.
TEST(OrcaPlanner, AnyVehicleHasSettings)
{
    Random random(20261123);
    for (int i = 0; i < 2000; ++i) {
        Scene scene = eastward();
        vehicle::VehicleLimits& v = scene.limits;
        v.cruise_speed = random.uniform(0.2F, 40.0F);
        v.max_climb = random.uniform(0.1F, 10.0F);
        v.max_descent = random.uniform(0.1F, 10.0F);
        v.max_acceleration = random.uniform(0.2F, 20.0F);
        v.max_vertical_acceleration = random.uniform(0.2F, 10.0F);
        v.velocity_lag = random.uniform(0.0F, 1.0F);
        v.half_extents = Vec3(random.uniform(0.05F, 5.0F), random.uniform(0.05F, 5.0F), random.uniform(0.05F, 5.0F));
        v.kind = random.below(2) == 0 ? vehicle::VehicleKind::multirotor : vehicle::VehicleKind::fixed_wing;
        ASSERT_TRUE(vehicle::is_valid(v));
        scene.reference.speed = random.uniform(0.1F, v.cruise_speed);
        scene.own.velocity = v.cruise_speed * Vec3(1, 0, 0);
        scene.track(Vec3(random.uniform(20, 80), random.uniform(-9, 9), 30), Vec3(random.uniform(-9, 9), 0, 0));
        Settings settings;
        scene.rules.latency = random.uniform(0.0F, 1.0F);
        settings.smoothing = static_cast<std::uint16_t>(1 + random.below(CommandFilter::kMax));
        Planner planner(settings);
        world::Manoeuvre out;
        const PlanStatus status = plan(planner, scene, out);
        ASSERT_EQ(status, PlanStatus::found) << i;
        ASSERT_LE(out.command.norm(), std::max(v.cruise_speed, scene.reference.speed) * 1.0001F) << i;
    }
}

}  // namespace
}  // namespace jink::orca
