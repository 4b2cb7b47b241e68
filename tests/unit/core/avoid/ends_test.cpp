// SPDX-License-Identifier: BSD-3-Clause
// How a manoeuvre is followed, and when it ends.
#include <gtest/gtest.h>

#include "tests/unit/core/avoid/scripted.hpp"

namespace jink::avoid {
namespace {

using namespace test;

/// The follower's gains are those of the settings.
TEST(Follows, WithTheGainsThatAreSet)
{
    const auto sideways = [](float gain, float most) {
        Scripted t;
        t.next = [](const Situation& s, Manoeuvre& out) {
            out = along(s, {s.own.position, s.own.position + Vec3(0, 0, 20)}, Vec3(0, 0, 1));
            return PlanStatus::found;
        };
        t.f.scene.rules.gains = {gain, most};
        t.f.scene.own.velocity = Vec3::Zero();
        t.f.scene.track(Vec3(22, 0, 30), Vec3::Zero(), 1.0F);
        Supervisor supervisor(quick(), t.method);
        EXPECT_EQ(t.f.update(supervisor, true).state, State::avoiding);
        t.f.scene.own.position.y() = -0.8F;
        const Guidance g = t.f.update(supervisor, true);
        EXPECT_EQ(g.state, State::avoiding);
        return g.velocity.y();
    };
    EXPECT_EQ(sideways(0.0F, 2.0F), 0.0F);
    EXPECT_NEAR(sideways(0.5F, 2.0F), 0.4F, 1e-4F);
    EXPECT_NEAR(sideways(2.0F, 0.3F), 0.3F, 1e-4F);
}

// --- the end ---

TEST(Ends, ExactlyAtThePathsDuration)
{
    Scripted t;
    t.next = [](const Situation& s, Manoeuvre& out) {
        out = at_speed(s, {s.own.position, s.own.position + Vec3(0, 40, 0)}, 4.0F, kLeft);
        return PlanStatus::found;
    };
    Supervisor supervisor(quick(), t.method);
    ASSERT_EQ(avoid_head_on(t.f, supervisor).state, State::avoiding);
    ASSERT_EQ(supervisor.flying()->path.duration(), 10.0F);
    t.f.scene.own.position = Vec3(0, 40, 30);
    t.f.scene.own.velocity = Vec3(0, 4, 0);
    t.f.scene.tracks[0].velocity = Vec3::Zero();
    t.f.scene.tracks[0].position = Vec3(20, 28, 30);  // on the path back, far enough
    t.f.scene.now = t.f.scene.now + 9.99F;
    t.f.scene.tracks[0].stamp = t.f.scene.now;
    EXPECT_EQ(t.f.update(supervisor, true).state, State::avoiding);
    t.f.scene.now = supervisor.flying()->start + 10.0F;
    t.f.scene.tracks[0].position = Vec3(200, 28, 30);
    EXPECT_EQ(t.f.update(supervisor, true).state, State::rejoining);
}

/// For any number of searches for a faster one, its own time ends the manoeuvre.
TEST(Ends, OfASlowManoeuvreAreThoseOfItsTime)
{
    Scripted t;
    t.f.scene.own.velocity = Vec3(0, 2, 0);
    t.f.scene.track(Vec3(25, 0, 30), Vec3::Zero(), 1.0F);
    t.next = [](const Situation& s, Manoeuvre& out) {
        out = at_speed(s, {s.own.position, s.own.position + Vec3(0, 20, 0)}, 2.0F, kLeft);
        return PlanStatus::found;
    };
    Supervisor supervisor(quick(), t.method);
    for (int i = 0; i <= 99; ++i) {
        ASSERT_EQ(t.f.update(supervisor, true).state, State::avoiding) << i;
        t.f.scene.now = t.f.scene.now + 0.1F;
        t.f.scene.own.stamp = t.f.scene.tracks[0].stamp = t.f.scene.now;
    }
    EXPECT_EQ(supervisor.diagnostics().manoeuvres, 1U);
    static_cast<void>(t.f.update(supervisor, true));
    EXPECT_EQ(supervisor.diagnostics().manoeuvres, 2U) << "10 s are over: another one is begun";
}

/// Rejoining through a renewed velocity counts once, and ends once.
TEST(Ends, OfAVelocityOverAClearWayGiveBackOnce)
{
    Flight f;
    head_on(f, 30.0F);
    ReactiveFake method{{[](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = velocity_of(s, Vec3(4, -3, 0));
        return PlanStatus::found;
    }}};
    Settings settings = quick();
    settings.order = MethodOrder(kReacting);
    settings.settle = settings.least_control = 0.0F;
    Supervisor supervisor(settings, method);
    ASSERT_EQ(f.update(supervisor, true).state, State::avoiding);
    f.scene.tracks.clear();
    const Guidance g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::watching);
    EXPECT_FALSE(g.wants_control);
    EXPECT_EQ(supervisor.diagnostics().rejoined, 1U);
    EXPECT_EQ(supervisor.flying(), nullptr);
    settings.least_control = 5.0F;
    Supervisor keeping(settings, method);
    head_on(f, 30.0F);
    ASSERT_EQ(f.update(keeping, true).state, State::avoiding);
    f.scene.tracks.clear();
    EXPECT_EQ(f.update(keeping, true).state, State::rejoining);
    EXPECT_EQ(keeping.diagnostics().rejoined, 0U);
}

}  // namespace
}  // namespace jink::avoid
