// SPDX-License-Identifier: BSD-3-Clause
// Slow traffic along the leg: passed beside it, on the side once taken, and not at a crawl.
#include "core/avoid/supervisor.hpp"

#include <gtest/gtest.h>

#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;

float margin_now(const Flight& f)
{
    WorkBudget budget(world::test::kPlenty);
    return world::separation_at(f.scene.situation(), f.scene.own.position, 0.0F, budget).margin;
}

/// Off the leg by 8 m, beside and behind something that flies along it at 2 m/s.
Flight behind_slow_traffic()
{
    Flight f;
    f.scene.own.position = Vec3(20, 8, 30);
    f.scene.track(Vec3(27, 0, 30), Vec3(2, 0, 0), 2.0F);
    return f;
}

TEST(ParallelOffset, SlowTrafficIsPassedBeforeTheLegIsRejoined)
{
    Flight f = behind_slow_traffic();
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    Guidance g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::rejoining);
    EXPECT_EQ(g.kind, ManoeuvreKind::velocity);
    EXPECT_NEAR((g.velocity - Vec3(5, 0, 0)).norm(), 0.0F, 1e-4F);
    EXPECT_GE(g.margin, 0.0F);
    EXPECT_TRUE(g.wants_control);
    for (int i = 0; i < 600 && g.state == State::rejoining; ++i) {
        f.pass(g.velocity, 0.05F);
        ASSERT_GE(margin_now(f), 0.0F) << "step " << i;
        g = f.update(supervisor, true);
    }
    EXPECT_EQ(g.state, State::watching);
    EXPECT_GT(f.scene.own.position.x(), f.scene.tracks[0].position.x()) << "overtaken";
    EXPECT_LT(std::abs(f.scene.own.position.y()), 1.01F);
    EXPECT_EQ(supervisor.diagnostics().holds, 1U);
    EXPECT_EQ(supervisor.diagnostics().rejoined, 1U);
    EXPECT_EQ(method.asked, 0);
}

TEST(ParallelOffset, AManoeuvreThatWouldReturnBehindSlowTrafficIsLeftForIt)
{
    Flight f;
    f.scene.track(Vec3(13, 0, 30), Vec3(2.5F, 0, 0), 1.0F);
    FakeMethod method = always(kLeft, 8.0F, 24.0F);
    Supervisor supervisor(quick(), method);
    Guidance g = f.update(supervisor, true);
    ASSERT_EQ(g.state, State::avoiding);
    for (int i = 0; i < 800 && g.state != State::watching; ++i) {
        f.pass(g.velocity, 0.05F);
        ASSERT_GE(margin_now(f), 0.0F) << "step " << i;
        g = f.update(supervisor, true);
    }
    EXPECT_EQ(g.state, State::watching);
    EXPECT_GT(f.scene.own.position.x(), f.scene.tracks[0].position.x());
    EXPECT_GE(supervisor.diagnostics().holds, 1U);
    EXPECT_EQ(supervisor.diagnostics().manoeuvres, 1U) << "went around once";
    EXPECT_EQ(supervisor.diagnostics().flips, 0U);
}

TEST(ParallelOffset, IsNotFlownIntoSomethingElse)
{
    Flight f = behind_slow_traffic();
    f.scene.track(Vec3(50, 8, 30), Vec3::Zero(), 1.0F);  // contact in 6 s
    FakeMethod method = always(kLeft, 10.0F);
    Supervisor supervisor(quick(), method);
    EXPECT_EQ(f.update(supervisor, true).state, State::avoiding);
    EXPECT_EQ(supervisor.diagnostics().holds, 0U);
}

TEST(ParallelOffset, IsNotFlownPastABoundOrTheEndOfTheLeg)
{
    const auto holds = [](auto change) {
        Flight f = behind_slow_traffic();
        change(f);
        FakeMethod method = never();
        Supervisor supervisor(quick(), method);
        static_cast<void>(f.update(supervisor, true));
        return supervisor.diagnostics().holds == 1U;
    };
    EXPECT_TRUE(holds([](Flight&) {}));
    EXPECT_FALSE(holds([](Flight& f) {
        f.scene.airspace.has_keep_in = true;
        f.scene.airspace.keep_in_radius = 50.0F;
    }));
    EXPECT_FALSE(holds([](Flight& f) { f.scene.leg(Vec3(0, 0, 30), Vec3(31, 0, 30)); }));
    EXPECT_FALSE(holds([](Flight& f) { f.scene.own.position.y() = 0.5F; })) << "on the leg already";
    EXPECT_FALSE(holds([](Flight& f) { f.scene.limits.kind = vehicle::VehicleKind::fixed_wing; }));
}

/// The side passed to methods is the vehicle's present side, not the side of an earlier manoeuvre.
TEST(ParallelOffset, MethodsAreReportedTheSideThatIsFlown)
{
    Flight f;
    Vec3 reported = Vec3::Zero();
    FakeMethod method{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        reported = s.flying != nullptr ? s.flying->side : Vec3(Vec3::Zero());
        out = detour(s, kLeft, 6.0F, 60.0F);
        return PlanStatus::found;
    }};
    Supervisor supervisor(quick(), method);
    static_cast<void>(avoid_head_on(f, supervisor));
    f.pass(Vec3(5, 0, 0), 0.1F);
    f.scene.own.position += Vec3(0, -3, 0);  // blown over
    f.scene.track(f.scene.own.position + Vec3(25, 4, 0), Vec3::Zero(), 6.0F);
    static_cast<void>(f.update(supervisor, true));
    EXPECT_LT(reported.y(), -0.99F);
}

/// A crawl of 1.5 m/s around a threat that stays on the path; later a manoeuvre with `speed` is found, to `side`.
struct Crawl {
    Crawl(const Vec3& side, float speed)
        : method{[this, side, speed](const Situation& s, WorkBudget&, Manoeuvre& out) {
              out = detour(s, finds ? side : kLeft, 6.0F, 40.0F);
              const float factor = s.limits.cruise_speed / (finds ? speed : 1.5F);
              for (path::PathPoint& p : out.path.points) {
                  p.time *= factor;
                  p.velocity /= factor;
              }
              return PlanStatus::found;
          }},
          supervisor(quick(), method)
    {
        f.scene.own.velocity = Vec3(1.5F, 0, 0);
        f.scene.track(Vec3(22, 0, 30), Vec3::Zero(), 1.0F);
    }
    Crawl(const Crawl&) = delete;
    Crawl& operator=(const Crawl&) = delete;

    /// Flies on for `span`; only the first metre of the detour, so that no parallel offset begins.
    void fly(Seconds span)
    {
        for (Seconds t = 0.0F; t < span; t += 0.1F) {
            const Guidance g = f.update(supervisor, true);
            EXPECT_EQ(g.state, State::avoiding);
            EXPECT_GE(g.margin, 0.0F);
            f.pass(g.velocity, 0.1F);
        }
    }

    Flight f;
    bool finds = false;
    FakeMethod method;
    Supervisor<FakeMethod> supervisor;
};

TEST(Slow, AFasterManoeuvreOnTheSameSideIsTaken)
{
    Crawl crawl(kLeft, 5.0F);
    crawl.fly(1.5F);
    EXPECT_EQ(crawl.supervisor.diagnostics().replans, 0U) << "1.5 m/s is no better than 1.5 m/s";
    EXPECT_EQ(crawl.method.asked, 2) << "once to begin with, once a second";
    crawl.finds = true;
    crawl.fly(1.2F);
    EXPECT_EQ(crawl.supervisor.diagnostics().replans, 1U);
    EXPECT_EQ(crawl.supervisor.diagnostics().flips, 0U);
}

TEST(Slow, AFasterManoeuvreOnTheOtherSideIsNot)
{
    Crawl crawl(-kLeft, 5.0F);
    crawl.fly(1.2F);
    crawl.finds = true;
    crawl.fly(1.5F);
    EXPECT_GE(crawl.method.asked, 3);
    EXPECT_EQ(crawl.supervisor.diagnostics().replans, 0U);
}

}  // namespace
}  // namespace jink::avoid
