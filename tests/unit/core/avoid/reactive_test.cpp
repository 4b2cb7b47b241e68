// SPDX-License-Identifier: BSD-3-Clause
// A method that decides every tick anew, beside others that plan.
#include <gtest/gtest.h>

#include "core/orca/planner.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;

/// Always the same velocity.
ReactiveFake holding(const Vec3& velocity)
{
    return {{[=](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out.kind = ManoeuvreKind::velocity;
        out.start = s.now;
        out.valid_until = s.now + 8.0F;
        out.command = velocity;
        out.side = Vec3::Zero();
        path::predict_velocity_command(s.own, velocity, 8.0F, 0.2F, s.limits, out.path);
        return PlanStatus::found;
    }}};
}

Settings asking(const MethodOrder& order)
{
    Settings s = quick();
    s.order = order;
    return s;
}
const MethodOrder kAlone(kReacting);

TEST(ReactiveMethods, AreAskedOnlyWhereTheOrderNamesThem)
{
    for (const MethodOrder& order : {MethodOrder(kFirst), MethodOrder(kReacting, kFirst), kAlone}) {
        Flight f;
        head_on(f, 20.0F);
        FakeMethod planning = always(kLeft);
        ReactiveFake deciding = holding(Vec3(3, -4, 0));
        Supervisor supervisor(asking(order), planning, deciding);
        static_cast<void>(f.update(supervisor, false));
        EXPECT_EQ(deciding.asked > 0, order.contains(kReacting));
        EXPECT_EQ(planning.asked > 0, order.contains(kFirst));
    }
}

TEST(ReactiveMethods, TheNextIsAskedWhereTheyHaveNoAnswer)
{
    for (const bool alone : {false, true}) {
        Flight f;
        head_on(f);
        FakeMethod planning = always(kLeft);
        ReactiveFake deciding{{[](const Situation&, WorkBudget&, Manoeuvre&) { return PlanStatus::none_available; }}};
        Supervisor supervisor(asking(alone ? kAlone : MethodOrder(kReacting, kFirst)), planning, deciding);
        const Guidance g = f.update(supervisor, true);
        EXPECT_EQ(planning.asked > 0, !alone);
        EXPECT_EQ(g.state, alone ? State::rejoining : State::avoiding);
        EXPECT_EQ(supervisor.diagnostics().found_by_next, alone ? 0U : 1U);
    }
}

/// A velocity is renewed by its method alone; all methods are asked again a second later, and a path that costs less is
/// flown then.
TEST(ReactiveMethods, AreRenewedAloneUntilAllAreAskedAgain)
{
    Flight f;
    head_on(f, 40.0F);
    bool plans = false;
    FakeMethod planning{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = detour(s, kLeft, 6.0F, 60.0F);
        return plans ? PlanStatus::found : PlanStatus::none_available;
    }};
    ReactiveFake deciding = holding(Vec3(4, 3, 0));
    Supervisor supervisor(asking(MethodOrder(kFirst, kReacting)), planning, deciding);
    EXPECT_EQ(f.update(supervisor, true).kind, ManoeuvreKind::velocity);
    EXPECT_EQ(supervisor.flying()->by, kReacting);
    plans = true;
    // Nothing moves: the same question at each update.
    const auto wait = [&](Seconds dt) {
        f.scene.now = f.scene.now + dt;
        f.scene.own.stamp = f.scene.tracks[0].stamp = f.scene.now;
    };
    const int asked = planning.asked;
    for (int i = 1; i < 50; ++i) {
        wait(0.02F);
        ASSERT_EQ(f.update(supervisor, true).by, kReacting) << i;
        ASSERT_EQ(planning.asked, asked) << i;
        ASSERT_EQ(deciding.asked, i + 1);
    }
    wait(0.03F);
    EXPECT_EQ(f.update(supervisor, true).kind, ManoeuvreKind::follow_path);
    EXPECT_EQ(supervisor.flying()->by, kFirst);
}

/// Without an answer of its own, nothing is waited for.
TEST(ReactiveMethods, AllAreAskedAtOnceWhereAVelocityCannotBeRenewed)
{
    Flight f;
    head_on(f, 30.0F);
    bool decides = true;
    FakeMethod planning{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = detour(s, kLeft, 6.0F, 60.0F);
        return decides ? PlanStatus::none_available : PlanStatus::found;
    }};
    ReactiveFake deciding{{[&](const Situation& s, WorkBudget& budget, Manoeuvre& out) {
        return decides ? holding(Vec3(4, 3, 0)).answer(s, budget, out) : PlanStatus::none_available;
    }}};
    Supervisor supervisor(asking(MethodOrder(kFirst, kReacting)), planning, deciding);
    ASSERT_EQ(f.update(supervisor, true).by, kReacting);
    decides = false;
    // What is flown stays clear for a while; then, or before, the other method's path is flown.
    Guidance g;
    for (int i = 0; i < 2; ++i) {
        f.pass(Vec3(4, 3, 0), 0.02F);
        g = f.update(supervisor, true);
    }
    EXPECT_EQ(g.by, kFirst);
}

/// A velocity leads up to what stays and waits there: in front of a wall the planners are asked, and braking backs off;
/// a velocity that is flown when the wall becomes known ends. Alone in the order, in one that is empty or beside
/// methods that are not there, it is all there is.
TEST(ReactiveMethods, AreNotAskedInFrontOfWhatStaysUnlessTheyAreAlone)
{
    for (const MethodOrder& order :
         {MethodOrder(), MethodOrder(kReacting, kFirst), kAlone, MethodOrder(std::uint8_t{99}, kReacting)}) {
        const bool alone = !order.empty() && !order.contains(kFirst);
        Flight f;
        FakeMethod planning{{[](const Situation&, WorkBudget&, Manoeuvre&) { return PlanStatus::none_available; }}};
        ReactiveFake deciding = holding(Vec3(0, 0, 0.5F));
        Supervisor supervisor(asking(order), planning, deciding);
        head_on(f, 20.0F);
        deciding = holding(Vec3(1, 4, 0));
        EXPECT_EQ(f.update(supervisor, true).by, kReacting);
        const int asked = deciding.asked;
        f.scene.tracks.clear();
        f.scene.obstacle(geometry::make_box(Vec3(6, 0, 30), Vec3(1, 200, 200)));
        deciding = holding(Vec3(0, 0, 0.5F));
        deciding.asked = asked;
        const Guidance g = f.update(supervisor, true);
        EXPECT_EQ(deciding.asked > asked, alone);
        EXPECT_EQ(planning.asked > 1, !alone);
        EXPECT_EQ(g.state, alone ? State::avoiding : State::braking);
    }
}

TEST(ReactiveMethods, AreAskedAtEveryUpdateAndTheirCommandIsFlownAsItIs)
{
    Flight f;
    head_on(f, 30.0F);
    Vec3 wanted(4, -3, 0);
    ReactiveFake deciding{{[&](const Situation& s, WorkBudget& budget, Manoeuvre& out) {
        return holding(wanted).answer(s, budget, out);
    }}};
    Supervisor supervisor(asking(kAlone), deciding);
    Guidance g = f.update(supervisor, false);
    for (int i = 0; i < 10; ++i) {
        wanted.x() -= 0.05F;
        g = f.update(supervisor, true);
        EXPECT_EQ(deciding.asked, i + 2);
        EXPECT_EQ(g.state, State::avoiding);
        EXPECT_EQ(g.kind, ManoeuvreKind::velocity);
        EXPECT_EQ(g.velocity, wanted);
        f.pass(g.velocity, 0.02F);
    }
    EXPECT_EQ(supervisor.diagnostics().manoeuvres, 1U);
    EXPECT_EQ(supervisor.diagnostics().replans, 0U);
}

/// No method is trusted: one that flies into a track is not flown.
TEST(ReactiveMethods, AnswersAreCheckedLikeAllOthers)
{
    Flight f;
    head_on(f, 20.0F);
    ReactiveFake deciding = holding(Vec3(5, 0, 0));
    Supervisor supervisor(asking(kAlone), deciding);
    const Guidance g = f.update(supervisor, true);
    EXPECT_NE(g.velocity, Vec3(5, 0, 0));
    EXPECT_EQ(supervisor.diagnostics().answers_rejected, 1U);
}

/// The motion of a cooperative track beyond the stopping time is unknown: it is checked until then.
TEST(ReactiveMethods, TracksThatShareTheReactionAreLookedAtAsFarAsTheStop)
{
    for (const bool cooperative : {false, true}) {
        Flight f;
        head_on(f, 40.0F);  // 3.7 s off; the vehicle stops within 2
        f.scene.tracks.back().cooperative = cooperative;
        ReactiveFake deciding = holding(Vec3(5, 0, 0));
        Supervisor supervisor(asking(kAlone), deciding);
        static_cast<void>(f.update(supervisor, true));
        EXPECT_EQ(supervisor.diagnostics().answers_rejected, cooperative ? 0U : 1U);
    }
    Flight f;
    head_on(f, 12.0F);
    f.scene.tracks.back().cooperative = true;
    ReactiveFake deciding = holding(Vec3(5, 0, 0));
    Supervisor supervisor(asking(kAlone), deciding);
    static_cast<void>(f.update(supervisor, true));
    EXPECT_EQ(supervisor.diagnostics().answers_rejected, 1U);
}

/// Others' plans and the fallback count everybody as flying straight on.
TEST(ReactiveMethods, PlansOfOthersDoNotCountOnAnybody)
{
    Flight f;
    head_on(f, 40.0F);
    f.scene.tracks.back().cooperative = true;
    FakeMethod straight{[](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = detour(s, kLeft, 0.1F, 80.0F);
        return PlanStatus::found;
    }};
    Supervisor supervisor(asking(MethodOrder(kFirst)), straight);
    static_cast<void>(f.update(supervisor, true));
    EXPECT_GE(supervisor.diagnostics().answers_rejected, 1U);
}

/// Methods receive the last sent command, and none while the autopilot flies.
TEST(ReactiveMethods, AreReportedTheLastCommand)
{
    Flight f;
    head_on(f, 30.0F);
    std::vector<const world::Commanded*> seen;
    std::vector<world::Commanded> values;
    ReactiveFake deciding{{[&](const Situation& s, WorkBudget& budget, Manoeuvre& out) {
        seen.push_back(s.commanded);
        values.push_back(s.commanded != nullptr ? *s.commanded : world::Commanded{});
        return holding(Vec3(4, -3, 0)).answer(s, budget, out);
    }}};
    Supervisor supervisor(asking(kAlone), deciding);
    static_cast<void>(f.update(supervisor, false));
    const TimePoint first = f.scene.now;
    f.pass(Vec3(5, 0, 0), 0.02F);
    static_cast<void>(f.update(supervisor, true));
    const TimePoint second = f.scene.now;
    f.pass(Vec3(4, -3, 0), 0.02F);
    static_cast<void>(f.update(supervisor, true));
    ASSERT_EQ(seen.size(), 3U);
    EXPECT_EQ(seen[0], nullptr);
    EXPECT_EQ(seen[1], nullptr) << "offered at " << first.us << ", but not flown";
    ASSERT_NE(seen[2], nullptr);
    EXPECT_EQ(values[2].velocity, Vec3(4, -3, 0));
    EXPECT_EQ(values[2].at, second);
}

/// The product's own: two cooperative vehicles pass each other, and both return to their legs.
TEST(ReactiveMethods, TwoVehiclesPassEachOther)
{
    struct Vehicle {
        Flight f;
        orca::Planner planner;
        Supervisor<orca::Planner> supervisor{quick(), planner};
        bool controlled = false;
    };
    std::array<Vehicle, 2> vehicles;
    Flight& west = vehicles[1].f;
    west.scene.leg(Vec3(120, 0, 30), Vec3(-180, 0, 30), 5.0F);
    west.scene.own.position = Vec3(120, 0, 30);
    west.scene.own.velocity = Vec3(-5, 0, 0);
    float least = 1e9F;
    for (int i = 0; i < 2500; ++i) {
        std::array<Vec3, 2> commands;
        for (std::size_t k = 0; k < 2; ++k) {
            Vehicle& v = vehicles[k];
            const vehicle::VehicleState& other = vehicles[1 - k].f.scene.own;
            v.f.scene.own_id = static_cast<world::TrackId>(k + 1);
            v.f.scene.tracks.clear();
            world::Track& track = v.f.scene.track(other.position, other.velocity);
            track.id = static_cast<world::TrackId>(2 - k);
            track.cooperative = true;
            const Guidance g = v.f.update(v.supervisor, v.controlled);
            v.controlled = g.wants_control;
            const world::Way way = world::way_of(v.f.scene.situation());
            commands[k] = g.wants_control ? g.velocity : Vec3(way.direction * way.speed);
        }
        for (std::size_t k = 0; k < 2; ++k) {
            vehicles[k].f.scene.tracks.clear();
            vehicles[k].f.pass(commands[k], 0.02F);
        }
        least = std::min(least, (vehicles[0].f.scene.own.position - vehicles[1].f.scene.own.position).norm());
    }
    EXPECT_GE(least, 2.0F);
    for (const Vehicle& v : vehicles) {
        EXPECT_EQ(v.supervisor.diagnostics().manoeuvres, 1U);
        EXPECT_EQ(v.supervisor.diagnostics().brakes, 0U);
        EXPECT_LT(std::abs(v.f.scene.own.position.y()), 0.5F);
        EXPECT_EQ(v.supervisor.state(), State::watching);
    }
    EXPECT_GT(vehicles[0].f.scene.own.position.x(), 200.0F);
    std::printf("[ measured ] two vehicles head on: least distance %.2f m\n", double(least));
}

}  // namespace
}  // namespace jink::avoid
