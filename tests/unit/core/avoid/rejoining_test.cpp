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
    f.scene.track(Vec3(50, 9, 30), Vec3::Zero(), 2.0F);  // nor is there a way beside the leg
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

}  // namespace
}  // namespace jink::avoid
