// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/planner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <optional>

#include "core/avoid/final_check.hpp"
#include "core/reach/scan_picture.hpp"
#include "tests/oracle/planner_oracle.hpp"
#include "tests/oracle/random_situation.hpp"
#include "tests/reach/unit_sets.hpp"

// The reach planner on random situations: its result must pass the supervisor's check, which measures by other means,
// and must never contact a track that grows by world::threat_radius.

namespace jink::reach {
namespace {

using oracle::RandomSituation;
using world::PlanStatus;

constexpr std::uint32_t kPlannerPlenty = 1'000'000;

Settings unit_settings()
{
    Settings settings;
    settings.sets = &test::unit_sets();
    return settings;
}

Planner& planner()
{
    static Planner one{unit_settings()};
    return one;
}

/// Plans, and checks the general properties of every plan.
PlanStatus plan(const world::Situation& situation, world::Manoeuvre& out, std::uint32_t units = kPlannerPlenty)
{
    WorkBudget budget(units);
    return planner().plan(situation, budget, out);
}

float planned_margin(const RandomSituation& s, const world::Manoeuvre& manoeuvre)
{
    WorkBudget budget(kPlannerPlenty);
    return world::least_separation(s.view(), manoeuvre.path, 100.0F, budget).margin;
}

TEST(ReachPlannerLaws, WhatIsFoundPassesTheFinalCheck)
{
    std::size_t found = 0;
    std::size_t none = 0;
    std::size_t rejected = 0;
    std::size_t emergencies = 0;
    std::size_t with_room = 0;
    std::size_t more_tries = 0;
    for (std::uint64_t seed = 1; seed <= 5000; ++seed) {
        const RandomSituation s(seed);
        world::Manoeuvre manoeuvre;
        const PlanStatus status = plan(s.view(), manoeuvre);
        if (status != PlanStatus::found) {
            ASSERT_EQ(status, PlanStatus::none_available) << "seed " << seed;
            ASSERT_TRUE(manoeuvre.path.points.empty()) << "seed " << seed << ": written without an answer";
            ++none;
            continue;
        }
        ++found;
        const Report& report = planner().last();
        emergencies += report.emergency ? 1U : 0U;
        with_room += report.run == AvoidanceRun::soft_constraints ? 1U : 0U;
        more_tries += report.tries > 1 ? 1U : 0U;
        ASSERT_GE(planned_margin(s, manoeuvre), -0.06F) << "seed " << seed;  // distances of solids have a resolution of
                                                                             // 0.05 m
        WorkBudget budget(kPlannerPlenty);
        rejected += avoid::check_manoeuvre(s.view(), manoeuvre, avoid::Settings{}, budget).margin < 0.0F ? 1U : 0U;
    }
    EXPECT_GT(found, 4000U);
    EXPECT_GT(emergencies, 100U);
    EXPECT_GT(found - with_room, 5U);
    EXPECT_GT(more_tries, 10U);
    // The vehicle does not fly a path to the centimetre; a rejection costs a plan, not safety.
    EXPECT_LE(rejected * 100, found);
    std::printf("[ measured ] %zu plans, %zu of them by the emergency set, %zu without room to spare; %zu whose first "
                "end would not do; %zu rejected by the final check; %zu times nothing\n",
                found, emergencies, found - with_room, more_tries, rejected, none);
}

TEST(ReachPlannerLaws, TracksAreNeverTouchedAsTheyGrow)
{
    std::size_t samples = 0;
    for (std::uint64_t seed = 10001; seed <= 12000; ++seed) {
        const RandomSituation s(seed);
        world::Manoeuvre manoeuvre;
        if (plan(s.view(), manoeuvre) != PlanStatus::found) {
            continue;
        }
        const oracle::Box box{oracle::to_double(s.limits.half_extents)};
        for (const world::Track& track : s.tracks) {
            const double at_start = oracle::box_distance(box, oracle::to_double(Vec3(s.own.position - track.position)));
            if (at_start < static_cast<double>(world::threat_radius(s.view(), track, 0.0F)) + 0.7) {
                continue;  // judged by the escape rule, now or when the vehicle answers
            }
            for (float t = 0.0F; t < manoeuvre.path.duration(); t += 0.02F) {
                const Vec3 apart = path::sample(manoeuvre.path, t).position - (track.position + track.velocity * t);
                ASSERT_GT(oracle::box_distance(box, oracle::to_double(apart)),
                          static_cast<double>(world::threat_radius(s.view(), track, t)) - 1e-3)
                    << "seed " << seed;
                ++samples;
            }
        }
    }
    EXPECT_GT(samples, 100000U);
}

/// The path begins at the vehicle's position when it responds, along its course, and no point exceeds the vehicle's
/// speed.
TEST(ReachPlannerLaws, BeginsWhereTheVehicleAnswersAndKeepsItsSpeed)
{
    std::size_t found = 0;
    for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
        const RandomSituation s(seed);
        world::Manoeuvre m;
        if (plan(s.view(), m) != PlanStatus::found) {
            continue;
        }
        ++found;
        const auto& points = m.path.points;
        const float speed = s.own.velocity.norm();
        const Vec3 answered = s.own.position + s.rules.latency * s.own.velocity;
        ASSERT_EQ(points[0].position, s.own.position) << "seed " << seed;
        ASSERT_LT((points[1].position - answered).norm(), 1e-4F) << "seed " << seed;
        ASSERT_EQ(m.kind, world::ManoeuvreKind::follow_path);
        ASSERT_TRUE(m.cost >= 0.0F && m.cost <= 1.0F);
        ASSERT_TRUE(m.side == Vec3::Zero() || std::abs(m.side.norm() - 1.0F) < 1e-4F);
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            ASSERT_GT(points[i + 1].time, points[i].time);
            const Vec3 reached = points[i].position + (points[i + 1].time - points[i].time) * points[i].velocity;
            ASSERT_LT((reached - points[i + 1].position).norm(), 1e-3F) << "seed " << seed << " point " << i;
            ASSERT_LT(points[i].velocity.norm(), 1.01F * speed) << "seed " << seed << " point " << i;
        }
        // The first half movement turns by 7.5 degrees to each side at most; the root is level.
        const Vec3 level(s.own.velocity.x(), s.own.velocity.y(), 0.0F);
        ASSERT_GT(points[1].velocity.normalized().dot(level.normalized()), std::cos(0.19F)) << "seed " << seed;
    }
    EXPECT_GT(found, 500U);
}

/// For any work budget: an answer is clear, and with more work it is the same.
TEST(ReachPlannerLaws, LessWorkNeverGivesAnAnswerThatIsNotClear)
{
    std::size_t cut = 0;
    std::size_t found = 0;
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        const RandomSituation s(seed);
        world::Manoeuvre all;
        const PlanStatus status = plan(s.view(), all);
        for (std::uint32_t units = 50; units < 20000; units = units * 3 / 2) {
            world::Manoeuvre some;
            const PlanStatus with_less = plan(s.view(), some, units);
            if (with_less == PlanStatus::found) {
                ++found;
                ASSERT_EQ(status, PlanStatus::found) << "seed " << seed << " units " << units;
                ASSERT_GE(planned_margin(s, some), -0.06F) << "seed " << seed << " units " << units;
            } else {
                cut += with_less == PlanStatus::budget_spent ? 1U : 0U;
                ASSERT_TRUE(with_less == PlanStatus::budget_spent || with_less == PlanStatus::none_available);
                ASSERT_TRUE(with_less == PlanStatus::budget_spent || status == with_less)
                    << "seed " << seed << ": nothing is there to find, or work has ended";
            }
        }
    }
    EXPECT_GT(cut, 1000U);
    EXPECT_GT(found, 500U);
}

TEST(ReachPlannerLaws, TheSameInputGivesTheSameAnswerWhateverRanBefore)
{
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        const RandomSituation s(seed);
        world::Manoeuvre first;
        world::Manoeuvre between;
        world::Manoeuvre again;
        const PlanStatus status = plan(s.view(), first);
        static_cast<void>(plan(RandomSituation(seed + 7000).view(), between));
        ASSERT_EQ(plan(s.view(), again), status);
        ASSERT_EQ(first.path.points.size(), again.path.points.size());
        for (std::size_t i = 0; i < first.path.points.size(); ++i) {
            ASSERT_EQ(first.path.points[i].position, again.path.points[i].position) << "seed " << seed;
        }
    }
}

// Named cases. The vehicle flies east at 5 m/s, 30 m above the ground, on a long leg.
struct Case : RandomSituation {
    Case() : RandomSituation(1)
    {
        own = {};
        own.stamp = now;
        own.position = Vec3(0.0F, 0.0F, 30.0F);
        own.velocity = Vec3(5.0F, 0.0F, 0.0F);
        limits = {};
        reference = world::Reference({Vec3(-20.0F, 0.0F, 30.0F), Vec3(500.0F, 0.0F, 30.0F), 5.0F});
        tracks.clear();
        obstacles.clear();
    }
    void wall(float at, float half_width)
    {
        obstacles.push_back({static_cast<world::ObstacleId>(obstacles.size()),
                             geometry::make_box(Vec3(at, 0.0F, 30.0F), Vec3(0.5F, half_width, 100.0F))});
    }
};

TEST(ReachPlanner, FliesStraightWhereNothingIsInTheWay)
{
    const Case c;
    world::Manoeuvre m;
    ASSERT_EQ(plan(c.view(), m), PlanStatus::found);
    EXPECT_FALSE(planner().last().emergency);
    EXPECT_EQ(planner().last().path, PathStatus::found);
    EXPECT_EQ(m.side, Vec3::Zero());
    for (const path::PathPoint& point : m.path.points) {
        EXPECT_NEAR(point.position.y(), 0.0F, 1e-3F);
    }
    EXPECT_NEAR(m.path.points.back().position.x(), 0.5F + 25.0F, 0.1F);
}

TEST(ReachPlanner, GoesAroundAWallAndStopsBeforeOneThatIsTooWide)
{
    Case narrow;
    narrow.wall(15.0F, 3.0F);
    world::Manoeuvre m;
    ASSERT_EQ(plan(narrow.view(), m), PlanStatus::found);
    EXPECT_GT(std::abs(m.side.y()) + std::abs(m.side.z()), 0.9F);
    Case wide;
    wide.wall(6.0F, 100.0F);
    ASSERT_EQ(plan(wide.view(), m), PlanStatus::none_available);
}

TEST(ReachPlanner, StandingItTurnsAside)
{
    Case c;
    c.own.velocity = Vec3::Zero();
    c.wall(2.2F, 3.0F);
    world::Manoeuvre m;
    ASSERT_EQ(plan(c.view(), m), PlanStatus::found);
    EXPECT_GT(planner().last().headings, 1);
    c.limits.kind = vehicle::VehicleKind::fixed_wing;
    EXPECT_EQ(plan(c.view(), m), PlanStatus::none_available) << "a wing has no choice of its course";
}

TEST(ReachPlanner, RefusesWhatItIsNotFor)
{
    world::Manoeuvre m;
    Case fast;
    fast.own.velocity = Vec3(11.0F, 0.0F, 0.0F);
    EXPECT_EQ(plan(fast.view(), m), PlanStatus::none_available) << "faster than any set is for";
    Case steep;
    steep.own.velocity = Vec3(3.0F, 0.0F, 4.0F);
    EXPECT_EQ(plan(steep.view(), m), PlanStatus::none_available);
    Case aimless;
    aimless.reference.valid = false;
    EXPECT_EQ(plan(aimless.view(), m), PlanStatus::bad_input);
    Planner without{Settings{}};
    WorkBudget budget(kPlannerPlenty);
    EXPECT_EQ(without.plan(Case().view(), budget, m), PlanStatus::bad_input);
    for (const auto& spoil :
         std::vector<void (*)(Settings&)>{[](Settings& s) { s.sets = nullptr; }, [](Settings& s) { s.tries = 0; },
                                          [](Settings& s) { s.tries = 65; }}) {
        Settings bad = unit_settings();
        spoil(bad);
        EXPECT_FALSE(is_valid(bad));
        EXPECT_FALSE(planner().configure(bad));
    }
    EXPECT_EQ(planner().settings().tries, Settings{}.tries);
}

TEST(ReachPlanner, KeepsToTheAirspace)
{
    Case low;
    low.airspace.has_floor = low.airspace.has_ceiling = true;
    low.airspace.floor = 28.5F;
    low.airspace.ceiling = 31.5F;
    low.wall(15.0F, 3.0F);
    world::Manoeuvre m;
    ASSERT_EQ(plan(low.view(), m), PlanStatus::found);
    for (const path::PathPoint& point : m.path.points) {
        EXPECT_NEAR(point.position.z(), 30.0F, 0.5F);
    }
    Case fenced;
    fenced.airspace.has_keep_in = true;
    fenced.airspace.home = Vec3(-5.0F, 0.0F, 0.0F);
    fenced.airspace.keep_in_radius = 26.0F;
    ASSERT_EQ(plan(fenced.view(), m), PlanStatus::found);
    EXPECT_GT(planner().last().tries, 1) << "ahead there is no room to stop";
    EXPECT_GE(planned_margin(fenced, m), 0.0F);
    WorkBudget budget(kPlannerPlenty);
    EXPECT_GE(avoid::check_manoeuvre(fenced.view(), m, avoid::Settings{}, budget).margin, 0.0F);
}

TEST(ReachPlanner, DoesNotGoWhereAScanDoesNotSee)
{
    static Planner seeing{unit_settings()};
    static ScanPicture picture;
    ASSERT_TRUE(picture.configure(test::unit_sets().segments[0].emergency->grid));
    seeing.look_at(&picture);
    const Case c;
    ScanStart start;
    start.stamp = c.now;
    start.position = c.own.position;
    start.unit = 2.5F;
    start.horizontal_pitch = start.vertical_pitch = 0.02F;
    const auto scan_with = [&](auto&& points) {
        ASSERT_TRUE(picture.begin(start));
        for (float h = -1.1F; h < 1.1F; h += 0.02F) {
            for (float v = -0.6F; v < 0.6F; v += 0.02F) {
                picture.add_nothing(Vec3(std::cos(v) * std::cos(h), std::cos(v) * std::sin(h), std::sin(v)));
            }
        }
        points();
        picture.end();
    };
    const auto plan_now = [&](world::Manoeuvre& m) {
        WorkBudget budget(kPlannerPlenty);
        return seeing.plan(c.view(), budget, m);
    };
    world::Manoeuvre m;
    scan_with([] {});
    EXPECT_EQ(plan_now(m), PlanStatus::found);
    EXPECT_EQ(m.side, Vec3::Zero()) << "all clear as far as it sees";
    scan_with([] { picture.add(Vec3(12.0F, 0.0F, 0.0F)); });
    ASSERT_EQ(plan_now(m), PlanStatus::found);
    EXPECT_NE(m.side, Vec3::Zero()) << "around what was hit and what is behind it";
    start.stamp = c.now - 0.6F;
    scan_with([] {});
    EXPECT_EQ(plan_now(m), PlanStatus::none_available) << "blind where it used to see";
    picture.block_unseen(false);
    EXPECT_EQ(plan_now(m), PlanStatus::found);
}

/// Somebody who says where to go.
struct KnownWay final : world::CostToGo {
    std::optional<Vec3> place;

    [[nodiscard]] std::optional<Seconds> lost_from(const Vec3& /*from*/) const noexcept override { return {}; }
    [[nodiscard]] std::optional<Vec3> way_around(const Vec3& /*from*/, float /*distance*/) const noexcept override
    {
        return place;
    }
};

TEST(ReachPlanner, FollowsTheWayPastObstaclesFromAStand)
{
    Case c;
    c.own.velocity = Vec3::Zero();
    KnownWay way;
    world::Situation situation = c.view();
    situation.cost_to_go = &way;
    const auto end_of_plan = [&] {
        world::Manoeuvre m;
        EXPECT_EQ(plan(situation, m), PlanStatus::found);
        EXPECT_EQ(planner().last().headings, 1) << "the first course is that of the way";
        return m.path.points.empty() ? Vec3(Vec3::Zero()) : Vec3(m.path.points.back().position - c.own.position);
    };
    EXPECT_GT(end_of_plan().x(), 1.0F) << "no way known: along the leg";
    for (float azimuth = -3.0F; azimuth < 3.2F; azimuth += 0.4F) {
        const Vec3 to(std::cos(azimuth), std::sin(azimuth), 0.0F);
        way.place = c.own.position + 6.0F * to;
        const Vec3 end = end_of_plan();
        EXPECT_GT(end.dot(to), 0.95F * end.norm()) << azimuth;
        EXPECT_GT(end.norm(), 1.0F) << azimuth;
    }
    way.place = c.own.position + Vec3(0.0F, 0.0F, 6.0F);
    EXPECT_GT(end_of_plan().x(), 0.5F) << "straight above there is no course: along the leg";
}

TEST(ReachPlanner, InFlightTheWayPastObstaclesIsTheGoal)
{
    Case c;
    KnownWay way;
    world::Situation situation = c.view();
    situation.cost_to_go = &way;
    for (const float side : {-1.0F, 1.0F}) {
        way.place = c.own.position + Vec3(20.0F, 12.0F * side, 0.0F);
        world::Manoeuvre m;
        ASSERT_EQ(plan(situation, m), PlanStatus::found);
        EXPECT_GT(m.path.points.back().position.y() * side, 3.0F);
    }
}

}  // namespace
}  // namespace jink::reach
