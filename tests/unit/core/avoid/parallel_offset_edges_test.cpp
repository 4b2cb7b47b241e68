// SPDX-License-Identifier: BSD-3-Clause
// When a parallel offset is begun, kept and left; and what is left for it.
#include <gtest/gtest.h>

#include "tests/unit/core/avoid/scripted.hpp"

namespace jink::avoid {
namespace {

using namespace test;

/// 4 m above the leg, on the flown manoeuvre. The path back is blocked, flying on above the leg is free.
struct Outside : Scripted {
    /// The flown manoeuvre leads from 4 m above the leg `rise` metres up over the next 40 m, at `speed`.
    Outside(float speed, float rise, const Settings& settings = quick()) : supervisor(settings, method)
    {
        f.scene.own.velocity = Vec3(speed, 0, 0);
        head_on(f, 48.0F);
        next = [=](const Situation& s, Manoeuvre& out) {
            out = at_speed(s, {Vec3(0, 0, 34), Vec3(40, 0, 34.0F + rise)}, speed, Vec3(0, 0, 1));
            return PlanStatus::found;
        };
        EXPECT_EQ(f.update(supervisor, true).state, State::avoiding);
        f.scene.tracks.clear();
        f.scene.own.position = Vec3(0, 0, 34);
        f.scene.track(Vec3(12, 0, 30), Vec3::Zero(), 1.5F);  // where the path back joins the leg
    }
    Supervisor<FakeMethod> supervisor;
};

TEST(ParallelOffsetWhileAvoiding, IsNotTakenWhereWhatIsFlownIsClearGoesOutAndIsNotSlow)
{
    Outside t(5.0F, 10.0F);
    const Guidance g = t.f.update(t.supervisor, true);
    ASSERT_TRUE(g.conflict.has_value());
    EXPECT_GE(g.margin, 0.0F);
    EXPECT_EQ(g.state, State::avoiding);
    EXPECT_EQ(t.supervisor.diagnostics().holds, 0U);
}

TEST(ParallelOffsetWhileAvoiding, IsTakenWhereWhatIsFlownIsNotClear)
{
    Outside t(5.0F, 10.0F);
    t.f.scene.track(Vec3(32, 0, 44), Vec3::Zero(), 4.0F);
    const Guidance g = t.f.update(t.supervisor, true);
    EXPECT_EQ(g.state, State::rejoining);
    EXPECT_EQ(t.supervisor.diagnostics().holds, 1U);
    EXPECT_NEAR((g.velocity - Vec3(5, 0, 0)).norm(), 0.0F, 1e-4F);
    EXPECT_GE(g.margin, t.f.scene.rules.clearance);
}

TEST(ParallelOffsetWhileAvoiding, IsTakenInsteadOfACrawl)
{
    Outside t(1.5F, 10.0F);
    const Guidance g = t.f.update(t.supervisor, true);
    EXPECT_EQ(g.state, State::rejoining);
    EXPECT_EQ(t.supervisor.diagnostics().holds, 1U);
}

TEST(ParallelOffsetWhileAvoiding, IsTakenWhereThePathLeadsBack)
{
    Outside t(5.0F, -2.0F);
    const Guidance g = t.f.update(t.supervisor, true);
    ASSERT_TRUE(g.conflict.has_value());
    EXPECT_EQ(g.state, State::rejoining);
    EXPECT_EQ(t.supervisor.diagnostics().holds, 1U);
}

/// Outwards and level on the floor: exactly clear is clear, and no alternative is searched.
TEST(ParallelOffsetWhileAvoiding, IsNotTakenWhereWhatIsFlownIsExactlyClear)
{
    Settings settings = quick();
    Scripted t;
    t.f.scene.rules.clearance = 0.0F;
    t.next = [](const Situation& s, Manoeuvre& out) {
        out = at_speed(s, {Vec3(0, 4, 30), Vec3(40, 8, 30)}, 5.0F, kLeft);
        return PlanStatus::found;
    };
    t.f.scene.airspace.has_floor = true;
    t.f.scene.airspace.floor = 29.0F;
    head_on(t.f, 48.0F);
    Supervisor supervisor(settings, t.method);
    ASSERT_EQ(t.f.update(supervisor, true).state, State::avoiding);
    t.f.scene.tracks.clear();
    t.f.scene.own.position = Vec3(0, 4, 30);
    t.f.scene.track(Vec3(12, 0, 30), Vec3::Zero(), 1.5F);
    const Guidance g = t.f.update(supervisor, true);
    ASSERT_TRUE(g.conflict.has_value());
    EXPECT_EQ(g.margin, 0.0F);
    EXPECT_EQ(g.state, State::avoiding);
    EXPECT_FALSE(g.new_manoeuvre);
    EXPECT_EQ(supervisor.diagnostics().holds, 0U);
    EXPECT_EQ(supervisor.diagnostics().replans, 0U);
}

/// `y` metres off the leg, with a threat on the path back and one `gap` metres beside the flight along the leg.
Flight along_side(float y, float gap)
{
    Flight f;
    f.scene.own.position = Vec3(20, y, 30);
    f.scene.track(Vec3(32, 0, 30), Vec3::Zero(), 1.0F);  // where the path back joins the leg
    f.scene.track(Vec3(40, y + 2.0F + gap, 30), Vec3::Zero(), 1.0F);
    return f;
}

std::uint32_t holds_of(const Flight& f, const Settings& settings = quick())
{
    FakeMethod method = never();
    Supervisor supervisor(settings, method);
    const Guidance g = supervisor.update(f.scene.situation(), true);
    EXPECT_TRUE(g.conflict.has_value());
    return supervisor.diagnostics().holds;
}

TEST(ParallelToTheLeg, IsBegunWithTheClearanceBufferAndKeptWhileClear)
{
    EXPECT_EQ(holds_of(along_side(8.0F, 0.45F)), 1U);
    EXPECT_EQ(holds_of(along_side(8.0F, 0.35F)), 0U) << "0.4 m are asked for";
    Flight f = along_side(8.0F, 0.6F);
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    EXPECT_EQ(f.update(supervisor, true).state, State::rejoining);
    f.scene.tracks[1].position.y() -= 0.4F;
    const Guidance g = f.update(supervisor, true);
    EXPECT_NEAR((g.velocity - Vec3(5, 0, 0)).norm(), 0.0F, 1e-4F) << "0.2 m are enough to go on";
    EXPECT_NEAR(g.margin, 0.2F, 0.05F);
    f.scene.tracks[1].position.y() -= 0.4F;
    EXPECT_GT((f.update(supervisor, true).velocity - Vec3(5, 0, 0)).norm(), 0.5F) << "contact is not";
    f.scene.tracks[1].position.y() += 0.4F;
    static_cast<void>(f.update(supervisor, true));
    EXPECT_EQ(supervisor.diagnostics().holds, 1U) << "once left, it is begun with room again";
}

TEST(ParallelToTheLeg, IsBegunAnewAfterThePathBackWasClear)
{
    Flight f = along_side(8.0F, 0.6F);
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    static_cast<void>(f.update(supervisor, true));
    ASSERT_EQ(supervisor.diagnostics().holds, 1U);
    const std::vector<world::Track> tracks = f.scene.tracks;
    f.scene.tracks.clear();
    EXPECT_GT((f.update(supervisor, true).velocity - Vec3(5, 0, 0)).norm(), 0.5F) << "back to the leg";
    f.scene.tracks = tracks;
    f.scene.tracks[1].position.y() -= 0.4F;
    EXPECT_GT((f.update(supervisor, true).velocity - Vec3(5, 0, 0)).norm(), 0.5F) << "0.2 m do not begin it";
    EXPECT_EQ(supervisor.diagnostics().holds, 1U);
}

TEST(ParallelToTheLeg, ExactlyClearIsClear)
{
    Flight f;
    f.scene.own.position = Vec3(20, 8, 30);
    f.scene.track(Vec3(32, 0, 30), Vec3::Zero(), 1.0F);
    f.scene.airspace.has_floor = true;
    f.scene.airspace.floor = 29.0F;
    Settings settings = quick();
    f.scene.rules.clearance = 0.0F;
    EXPECT_EQ(holds_of(f, settings), 1U);
    f.scene.airspace.floor = 29.01F;
    EXPECT_EQ(holds_of(f, settings), 0U);
}

TEST(ParallelToTheLeg, BeginsBeyondTheLegsWidthAndBeforeItsEnd)
{
    const auto holds = [](float off, float left) {
        Flight f;
        f.scene.own.position = Vec3(20, 0, 30.0F + off);
        f.scene.leg(Vec3(0, 0, 30), Vec3(20.0F + left, 0, 30), 5.0F);
        f.scene.limits.half_extents = Vec3(0.25F, 0.25F, 0.25F);
        f.scene.track(Vec3(31, 0, 29.2F), Vec3::Zero(), 1.0F);
        f.scene.tracks[0].position.z() = 30.0F + off - 1.75F;
        return holds_of(f);
    };
    EXPECT_EQ(holds(2.0F, 100.0F), 1U);
    EXPECT_EQ(holds(1.0F, 100.0F), 0U) << "on it";
    EXPECT_EQ(holds(1.01F, 100.0F), 1U);
    EXPECT_EQ(holds(2.0F, 12.0F), 0U) << "12 m before the end there is no sense in it";
    EXPECT_EQ(holds(2.0F, 12.01F), 1U);
}

/// The check covers the whole look-ahead, not the fallback's horizon.
TEST(ParallelToTheLeg, IsClearForAsLongAsConflictsAreLookedFor)
{
    Flight f = along_side(8.0F, 3.0F);
    f.scene.track(Vec3(20.0F + 33.0F, 8, 30), Vec3::Zero(), 1.0F);  // contact in 6.2 s
    EXPECT_EQ(holds_of(f), 0U);
}

}  // namespace
}  // namespace jink::avoid
