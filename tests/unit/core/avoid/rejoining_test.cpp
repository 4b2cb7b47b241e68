// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/supervisor.hpp"

#include <gtest/gtest.h>

#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;

TEST(Rejoining, GetsBackToTheLegAndReleases)
{
    Flight f;
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    f.scene.own.position = Vec3(20, 8, 32);
    Guidance g = f.update(supervisor, true);
    ASSERT_EQ(g.state, State::rejoining);
    int steps = 0;
    for (; g.wants_control && steps < 400; ++steps) {
        f.pass(g.velocity, 0.05F);
        g = f.update(supervisor, true);
    }
    EXPECT_LT(steps, 400);
    EXPECT_EQ(g.state, State::watching);
    EXPECT_EQ(supervisor.diagnostics().rejoined, 1U);
    EXPECT_LE(std::hypot(f.scene.own.position.y(), f.scene.own.position.z() - 30.0F), 1.0F);
    EXPECT_EQ(supervisor.flying(), nullptr);
    EXPECT_GT(g.velocity.x(), 4.0F) << "still valid: the autopilot needs a moment to take over";
}

TEST(Rejoining, ANewConflictIsAvoided)
{
    Flight f;
    FakeMethod method = always(kLeft, 12.0F);
    Supervisor supervisor(quick(), method);
    f.scene.own.position = Vec3(20, 8, 30);
    ASSERT_EQ(f.update(supervisor, true).state, State::rejoining);
    f.scene.track(Vec3(36, -3, 30), Vec3::Zero(), 2.0F);
    f.scene.track(Vec3(50, 9, 30), Vec3::Zero(), 2.0F);  // nor is there a parallel offset
    EXPECT_EQ(f.update(supervisor, true).state, State::avoiding);
    EXPECT_EQ(supervisor.diagnostics().manoeuvres, 1U);
}

TEST(Rejoining, ANewConflictWithoutAPlanIsBrakedFor)
{
    Flight f;
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    f.scene.own.position = Vec3(20, 8, 30);
    ASSERT_EQ(f.update(supervisor, true).state, State::rejoining);
    f.scene.own.velocity = Vec3(4, -3, 0);
    f.scene.track(f.scene.own.position + Vec3(5, -4, 0), Vec3::Zero(), 1.0F);
    f.scene.track(f.scene.own.position + Vec3(9, 0, 0), Vec3::Zero(), 1.0F);
    EXPECT_EQ(f.update(supervisor, true).state, State::braking);
}

/// Flies on until control is given back, or so many steps of 50 ms.
int rejoin(Flight& f, Supervisor<FakeMethod>& supervisor, int most)
{
    Guidance g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::rejoining);
    int steps = 0;
    for (; g.wants_control && steps < most; ++steps) {
        f.pass(g.velocity, 0.05F);
        const Vec3& at = f.scene.own.position;
        EXPECT_GE(at.z() - 1.0F, 24.99F) << steps;
        g = f.update(supervisor, true);
    }
    return steps;
}

/// Wind keeps the vehicle 3 m off. To its leg the autopilot would have to come back; to measured motion nobody means
/// to.
TEST(Rejoining, BesideMeasuredMotionControlIsGivenBackAfterFiveClearSeconds)
{
    for (const bool measured : {false, true}) {
        Flight f;
        f.scene.reference.measured = measured;
        f.scene.own.position = Vec3(20, 3, 30);
        FakeMethod method = never();
        Supervisor supervisor(quick(), method);
        Guidance g = f.update(supervisor, true);
        int steps = 0;
        for (; g.wants_control && steps < 400; ++steps) {
            f.pass(g.velocity, 0.05F);
            f.scene.own.position.y() = 3.0F;
            g = f.update(supervisor, true);
        }
        EXPECT_NEAR(steps, measured ? 100 : 400, 1) << measured;
    }
}

/// A leg below the floor is permitted: our command leads down to the floor, and when the path is clear control returns
/// to the autopilot.
TEST(Rejoining, AFloorAboveTheLegIsKept)
{
    for (const float beside : {0.0F, 15.0F}) {
        Flight f;
        f.scene.leg(Vec3(0, 0, 20), Vec3(300, 0, 20), 5.0F);
        f.scene.airspace.has_floor = true;
        f.scene.airspace.floor = 25.0F;
        f.scene.own.position = Vec3(20, beside, 34);
        FakeMethod method = never();
        Supervisor supervisor(quick(), method);
        EXPECT_LT(rejoin(f, supervisor, 400), 400) << beside;
        EXPECT_LE(std::abs(f.scene.own.position.y()), 1.0F) << "back above the leg first";
        EXPECT_EQ(supervisor.state(), State::watching);
    }
}

/// A descent that continues below the floor: the vehicle hovers above the rest of it, beside it for good.
TEST(Rejoining, ADescentThatEndsBelowTheFloorIsGivenBack)
{
    for (const Vec3& slope : {Vec3(-12, 0, -90), Vec3(-30, 10, -90), Vec3(0, 0, -90)}) {
        Flight f;
        f.scene.leg(Vec3(0, 0, 40), Vec3(0, 0, 40) + slope, 1.5F);
        f.scene.airspace.has_floor = true;
        f.scene.airspace.floor = 25.0F;
        f.scene.own.position = Vec3(4, 6, 34);
        f.scene.own.velocity = Vec3::Zero();
        FakeMethod method = never();
        Supervisor supervisor(quick(), method);
        EXPECT_LT(rejoin(f, supervisor, 1200), 1200) << slope.x();
        EXPECT_EQ(supervisor.state(), State::watching);
        Guidance g = f.update(supervisor, true);
        for (int i = 0; i < 40; ++i) {
            EXPECT_FALSE(g.wants_control) << "control is not taken back, " << slope.x();
            f.pass(g.velocity, 0.05F);
            g = f.update(supervisor, true);
        }
    }
}

TEST(Rejoining, BelowTheFloorItGoesNoDeeper)
{
    Flight f;
    f.scene.leg(Vec3(0, 0, 10), Vec3(300, 0, 10), 5.0F);
    f.scene.airspace.has_floor = true;
    f.scene.airspace.floor = 25.0F;
    f.scene.own.position = Vec3(20, 0, 22);
    FakeMethod method = never();
    Settings settings = quick();
    settings.settle = settings.least_control = 0.0F;
    Supervisor supervisor(settings, method);
    const Guidance g = f.update(supervisor, true);
    EXPECT_FALSE(g.wants_control) << "above its leg, as near as our command may bring it";
    EXPECT_GE(g.velocity.z(), 0.0F);
    EXPECT_GT(g.velocity.x(), 1.0F);
}

TEST(Rejoining, CeilingAndKeepInAreKept)
{
    Flight f;
    f.scene.leg(Vec3(0, 0, 40), Vec3(300, 0, 40), 5.0F);
    f.scene.airspace.has_ceiling = f.scene.airspace.has_keep_in = true;
    f.scene.airspace.ceiling = 30.0F;
    f.scene.airspace.keep_in_radius = 60.0F;
    f.scene.own.position = Vec3(30, 9, 25);
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    Guidance g = f.update(supervisor, true);
    ASSERT_EQ(g.state, State::rejoining);
    for (int i = 0; i < 400 && g.wants_control; ++i) {
        f.pass(g.velocity, 0.05F);
        const Vec3& at = f.scene.own.position;
        ASSERT_LE(at.z() + 1.0F, 30.01F) << i;
        ASSERT_LE(std::hypot(at.x(), at.y()) + 1.41F, 60.05F) << i;
        g = f.update(supervisor, true);
    }
    EXPECT_FALSE(g.wants_control);
}

/// The leg leads out of the keep-in radius; what may be flown of the way back goes along the boundary, and an obstacle
/// stands there that the way back itself passes.
TEST(Rejoining, AWayBackThatABoundBendsStopsBeforeAnObstacle)
{
    constexpr float kBoundary = 58.5F;
    for (const float degrees : {8.0F, 12.0F, 16.0F}) {
        Flight f;
        f.scene.leg(Vec3(0, -15, 30), Vec3(300, -15, 30), 5.0F);
        f.scene.airspace.has_keep_in = true;
        f.scene.airspace.keep_in_radius = 60.0F;
        const auto on_boundary = [&](float angle) {
            return Vec3(kBoundary * std::cos(angle), kBoundary * std::sin(angle), 30.0F);
        };
        const float begin = std::atan2(-26.2F, 52.3F);
        f.scene.own.position = on_boundary(begin);
        f.scene.own.velocity = Vec3(2.0F, 4.0F, 0.0F);
        const Vec3 pole = on_boundary(begin + degrees * kPi / 180.0F);
        f.scene.obstacle(geometry::make_sphere(pole, 1.0F));
        FakeMethod method = never();
        Supervisor supervisor(quick(), method);
        for (int i = 0; i < 200; ++i) {
            const vehicle::VehicleState& own = f.scene.own;
            const world::Reference motion({own.position, own.position + 8.0F * own.velocity, own.velocity.norm()});
            const Guidance g = supervisor.update(f.scene.situation(), true, &motion);
            f.pass(g.velocity, 0.05F);
            const Vec3 apart = (f.scene.own.position - pole).cwiseAbs();
            ASSERT_GE(std::max(apart.x(), apart.y()), 1.9F) << degrees << " degrees, step " << i;
        }
    }
}

/// Seconds until a vehicle gives back control that begins to rejoin the leg at `position`; -1: not within a minute.
float gives_back_after(vehicle::VehicleKind kind, const Vec3& position)
{
    Flight f;
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    f.scene.limits.kind = kind;
    f.scene.limits.cruise_speed = 15.0F;
    f.scene.leg(Vec3(0, 0, 30), Vec3(300, 0, 30), 15.0F);
    f.scene.own.position = position;
    f.scene.own.velocity = Vec3(15, 0, 0);
    Guidance g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::rejoining);
    for (int steps = 0; steps < 1200; ++steps) {
        if (!g.wants_control) {
            return 0.05F * static_cast<float>(steps);
        }
        f.pass(Vec3(15, 0, 0), 0.05F);  // for any command
        g = f.update(supervisor, true);
    }
    return -1.0F;
}

TEST(Rejoining, AFixedWingAboveOrBelowItsLegHasNothingToTurnFor)
{
    using vehicle::VehicleKind;
    for (const float height : {10.0F, 60.0F}) {
        const float wing = gives_back_after(VehicleKind::fixed_wing, Vec3(20, 0, height));
        EXPECT_NEAR(wing, 5.0F, 0.01F) << "control is kept for so long at least, " << height;
        EXPECT_LT(gives_back_after(VehicleKind::multirotor, Vec3(20, 0, height)), 0.0F) << height;
    }
}

TEST(Rejoining, AFixedWingBesideItsLegComesBackFirstUnlessItIsPastTheEnd)
{
    using vehicle::VehicleKind;
    const float past = gives_back_after(VehicleKind::fixed_wing, Vec3(150, 40, 30));
    EXPECT_NEAR(past, 10.0F, 0.3F) << "150 m at 15 m/s: then nothing of the leg is left";
    EXPECT_LT(gives_back_after(VehicleKind::multirotor, Vec3(150, 40, 30)), 0.0F);
    EXPECT_LT(gives_back_after(VehicleKind::fixed_wing, Vec3(310, 40, 30)), 5.01F) << "past it from the start";
}

}  // namespace
}  // namespace jink::avoid
