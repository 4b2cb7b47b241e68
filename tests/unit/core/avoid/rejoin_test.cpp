// SPDX-License-Identifier: BSD-3-Clause
// The command on the path back to the leg, at the bounds of the airspace; and where the vehicle is beside its leg.
#include <cmath>

#include <gtest/gtest.h>

#include "core/avoid/tick.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;

/// Command in control with a clear path. The vehicle is at 30 m and flies along a leg in `direction`.
Vec3 command_back(Flight& f, const Vec3& direction, float speed)
{
    f.scene.leg(f.scene.own.position, f.scene.own.position + 200.0F * direction.normalized(), speed);
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    const Guidance g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::rejoining);
    EXPECT_EQ(g.kind, world::ManoeuvreKind::velocity);
    EXPECT_TRUE(g.wants_control);
    return g.velocity;
}

void expect_near(const Vec3& v, const Vec3& expected, const char* what)
{
    EXPECT_NEAR((v - expected).norm(), 0.0F, 2e-4F)
        << what << ": (" << v.x() << ", " << v.y() << ", " << v.z() << ") for (" << expected.x() << ", " << expected.y()
        << ", " << expected.z() << ")";
}

/// Box of 1 x 2 x 0.5 m half extents, position known to 0.2 m: 0.6 m at three standard deviations.
Flight uncertain()
{
    Flight f;
    f.scene.limits.half_extents = Vec3(1.0F, 2.0F, 0.5F);
    f.scene.own.sigma_position = 0.2F;
    f.scene.own.sigma_velocity = 5.0F;  // not the tested quantity
    return f;
}

/// The remaining distance to a bound, less box and position uncertainty, lasts at least a second.
TEST(PathBack, SlowsDownBelowTheCeiling)
{
    const auto climb = [](float ceiling) {
        Flight f = uncertain();
        f.scene.airspace.has_ceiling = true;
        f.scene.airspace.ceiling = ceiling;
        return command_back(f, Vec3(0, 0, 1), 3.0F);
    };
    expect_near(climb(40.0F), Vec3(0, 0, 3), "far away");
    expect_near(climb(33.0F), Vec3(0, 0, 1.9F), "3 m above, 1.1 m of them taken");
    expect_near(climb(31.1F), Vec3(0, 0, 0), "there");
    expect_near(climb(25.0F), Vec3(0, 0, 0), "beyond it");
}

TEST(PathBack, SlowsDownAboveTheFloor)
{
    const auto descent = [](float floor) {
        Flight f = uncertain();
        f.scene.airspace.has_floor = true;
        f.scene.airspace.floor = floor;
        return command_back(f, Vec3(0, 0, -1), 3.0F);
    };
    expect_near(descent(20.0F), Vec3(0, 0, -3), "far away");
    expect_near(descent(27.0F), Vec3(0, 0, -1.9F), "3 m below, 1.1 m of them taken");
    expect_near(descent(28.9F), Vec3(0, 0, 0), "there");
    expect_near(descent(35.0F), Vec3(0, 0, 0), "beyond it");
}

/// Inwards everything is free: beyond a bound no velocity is made up.
TEST(PathBack, IsFreeAwayFromABoundThatWasPassed)
{
    Flight f = uncertain();
    f.scene.airspace.has_ceiling = f.scene.airspace.has_keep_in = true;
    f.scene.airspace.ceiling = 25.0F;
    f.scene.airspace.home = Vec3(-50, 0, 0);
    f.scene.airspace.keep_in_radius = 30.0F;
    expect_near(command_back(f, Vec3(-4, 0, -3), 5.0F), Vec3(-4, 0, -3), "down and inwards");
    f.scene.airspace.has_ceiling = false;
    f.scene.airspace.has_floor = true;
    f.scene.airspace.floor = 35.0F;
    expect_near(command_back(f, Vec3(-4, 0, 3), 5.0F), Vec3(-4, 0, 3), "up and inwards");
    f.scene.airspace.keep_in_radius = 100.0F;
    expect_near(command_back(f, Vec3(-4, 0, 3), 5.0F), Vec3(-4, 0, 3), "inwards with much left");
}

TEST(PathBack, SlowsDownTowardsTheKeepInRadius)
{
    const auto way = [](float radius, const Vec3& direction) {
        Flight f = uncertain();
        f.scene.own.position = Vec3(10, -20, 30) + Vec3(12, 16, 0);  // 20 m from home
        f.scene.airspace.has_keep_in = true;
        f.scene.airspace.home = Vec3(10, -20, 5);
        f.scene.airspace.keep_in_radius = radius;
        return command_back(f, direction, 5.0F);
    };
    const Vec3 outward(0.6F, 0.8F, 0.0F);
    const Vec3 across(-0.8F, 0.6F, 0.0F);
    const float taken = std::sqrt(5.0F) + 0.6F;
    expect_near(way(90.0F, outward), 5.0F * outward, "far away");
    expect_near(way(20.0F + taken + 1.5F, outward), 1.5F * outward, "1.5 m left");
    expect_near(way(20.0F + taken - 1.0F, outward), Vec3(0, 0, 0), "beyond it");
    expect_near(way(20.0F + taken + 1.5F, 0.8F * outward + 0.6F * across), 1.5F * outward + 3.0F * across,
                "across stays");
    expect_near(way(10.0F, -0.8F * outward + 0.6F * across), -4.0F * outward + 3.0F * across, "back inside");
}

TEST(PathBack, AboveHomeItselfThereIsNoOutwards)
{
    Flight f = uncertain();
    f.scene.airspace.has_keep_in = true;
    f.scene.airspace.home = Vec3(0, 0, 3);
    f.scene.airspace.keep_in_radius = 1.0F;
    expect_near(command_back(f, Vec3(1, 0, 0), 5.0F), Vec3(5, 0, 0), "above home");
}

TEST(PathBack, ABoundThatIsNotSetIsNone)
{
    Flight f = uncertain();
    f.scene.airspace.floor = 100.0F;
    f.scene.airspace.ceiling = 1.0F;
    f.scene.airspace.keep_in_radius = 0.0F;
    f.scene.airspace.home = Vec3(-50, 0, 0);
    expect_near(command_back(f, Vec3(4, 0, 3), 5.0F), Vec3(4, 0, 3), "up");
    expect_near(command_back(f, Vec3(4, 0, -3), 5.0F), Vec3(4, 0, -3), "down");
}

/// The command follows the path: climb and descent within limits, the mission's speed instead of cruise speed.
TEST(PathBack, FliesAtTheSpeedOfTheLeg)
{
    Flight f;
    expect_near(command_back(f, Vec3(0, 1, 0), 2.0F), Vec3(0, 2, 0), "slow leg");
    expect_near(command_back(f, Vec3(0, 0, 1), 8.0F), Vec3(0, 0, 3), "climb limit");
}

/// At the leg's end nothing is left to fly.
TEST(PathBack, StandsAtTheEndOfTheLeg)
{
    Flight f;
    f.scene.leg(f.scene.own.position - Vec3(50, 0, 0), f.scene.own.position, 5.0F);
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    EXPECT_EQ(f.update(supervisor, true).velocity, Vec3(0, 0, 0));
}

// --- is_held_by_bounds ---

/// 8 m beside a leg to the east, or on it.
TEST(IsHeldByBounds, AtTheKeepInRadiusWhereverItIs)
{
    Flight f;
    for (const float beside : {0.0F, 8.0F}) {
        f.scene.own.position = Vec3(20, beside, 30);
        EXPECT_TRUE(is_held_by_bounds(f.scene.situation(), Vec3(0.1F, 0, 0), Vec3(5, 0, 0), 1.0F));
        EXPECT_TRUE(is_held_by_bounds(f.scene.situation(), Vec3(0, -0.1F, 0), Vec3(5, 0, 0), 1.0F));
        EXPECT_FALSE(is_held_by_bounds(f.scene.situation(), Vec3(0, 0, 0), Vec3(0, 0, 0), 1.0F)) << "nothing is taken";
    }
}

TEST(IsHeldByBounds, ByFloorOrCeilingAboveItsLegOrWhereNextToNothingIsLeft)
{
    Flight f;
    const auto held = [&](float beside, float left) {
        f.scene.own.position = Vec3(20, beside, 33);
        return is_held_by_bounds(f.scene.situation(), Vec3(0, 0, -2), Vec3(0, -left, 0), 1.0F);
    };
    EXPECT_TRUE(held(0.0F, 5.0F)) << "above its leg";
    EXPECT_TRUE(held(1.0F, 5.0F)) << "as good as above it";
    EXPECT_FALSE(held(1.001F, 5.0F)) << "beside it, and going there";
    EXPECT_FALSE(held(8.0F, 0.2F));
    EXPECT_TRUE(held(8.0F, 0.199F)) << "beside it, and getting nowhere";
    f.scene.own.position = Vec3(20, 8, 27);
    EXPECT_TRUE(is_held_by_bounds(f.scene.situation(), Vec3(0, 0, 2), Vec3(0, 0, 0), 1.0F)) << "a ceiling likewise";
}

// --- cross_track and parallel_offset ---

TEST(ParallelToALeg, IsMeasuredAcrossIt)
{
    Flight f;
    f.scene.leg(Vec3(10, 10, 30), Vec3(10, 110, 30), 4.0F);
    f.scene.own.position = Vec3(14, 40, 33);
    EXPECT_NEAR(cross_track(f.scene.situation()), 5.0F, 1e-5F);
    const ParallelOffset parallel = parallel_offset(f.scene.situation());
    EXPECT_NEAR((parallel.off - Vec3(4, 0, 3)).norm(), 0.0F, 1e-5F);
    EXPECT_NEAR(parallel.left, 70.0F, 1e-4F);
    EXPECT_NEAR((parallel.command - Vec3(0, 4, 0)).norm(), 0.0F, 1e-5F);
    f.scene.own.position = Vec3(14, 123, 30);
    EXPECT_NEAR(cross_track(f.scene.situation()), std::sqrt(16.0F + 169.0F), 1e-4F) << "past its end: from the end";
    EXPECT_EQ(parallel_offset(f.scene.situation()).left, 0.0F);
    EXPECT_NEAR((parallel_offset(f.scene.situation()).off - Vec3(4, 0, 0)).norm(), 0.0F, 1e-4F);
}

TEST(ParallelToALeg, WithoutALengthIsNowhere)
{
    Flight f;
    f.scene.leg(Vec3(10, 10, 30), Vec3(10, 10, 30), 4.0F);
    f.scene.own.position = Vec3(14, 40, 33);
    const ParallelOffset parallel = parallel_offset(f.scene.situation());
    EXPECT_EQ(parallel.off, Vec3(0, 0, 0));
    EXPECT_EQ(parallel.command, Vec3(0, 0, 0));
    EXPECT_EQ(parallel.left, 0.0F);
}

/// 100 m east, then a quarter circle to the north about (100, 50), then 60 m north. The leg of the reference lies
/// elsewhere.
struct OnARoute : testing::Test {
    OnARoute()
    {
        EXPECT_EQ(route.add_leg(Vec3(0, 0, 30), Vec3(100, 0, 30)), path::RouteStatus::ok);
        EXPECT_EQ(route.add_arc(Vec3(100, 0, 30), Vec3(100, 50, 30), Vec3::UnitZ(), 0.5F * kPi), path::RouteStatus::ok);
        EXPECT_EQ(route.add_leg(Vec3(150, 50, 30), Vec3(150, 110, 30)), path::RouteStatus::ok);
        f.scene.leg(Vec3(-500, -500, 0), Vec3(-400, -500, 0), 4.0F);
        f.scene.reference = world::Reference(route, f.scene.reference.speed);
    }
    void expect(const Vec3& at, std::size_t segment, float off, float left, const Vec3& along)
    {
        f.scene.own.position = at;
        f.scene.reference.segment = segment;
        EXPECT_NEAR(cross_track(f.scene.situation()), off, 1e-3F);
        const ParallelOffset parallel = parallel_offset(f.scene.situation());
        EXPECT_NEAR(parallel.off.norm(), off, 1e-3F);
        EXPECT_NEAR(parallel.left, left, 1e-2F);
        EXPECT_NEAR((parallel.command - 4.0F * along).norm(), 0.0F, 1e-3F);
    }
    path::Route route;
    Flight f;
};

TEST_F(OnARoute, TheTangentAbeamIsFlownUntilTheRoutesEnd)
{
    const float arc = 25.0F * kPi;
    expect(Vec3(40, -3, 34), 0, 5.0F, 60.0F + arc + 60.0F, Vec3(1, 0, 0));
    const Vec3 outward(std::sqrt(0.5F), -std::sqrt(0.5F), 0);
    expect(Vec3(100, 50, 30) + 56.0F * outward, 0, 6.0F, 0.5F * arc + 60.0F, Vec3(std::sqrt(0.5F), std::sqrt(0.5F), 0));
    expect(Vec3(153, 70, 30), 2, 3.0F, 40.0F, Vec3(0, 1, 0));
}

/// From the segment on that is being flown: one that was passed is nearer, and does not count.
TEST_F(OnARoute, ASegmentThatIsPassedDoesNotCount)
{
    f.scene.own.position = Vec3(60, 2, 30);
    f.scene.reference.segment = 2;
    EXPECT_NEAR(cross_track(f.scene.situation()), (Vec3(60, 2, 0) - Vec3(150, 50, 0)).norm(), 1e-2F);
    EXPECT_NEAR(parallel_offset(f.scene.situation()).command.y(), 4.0F, 1e-3F);
}

}  // namespace
}  // namespace jink::avoid
