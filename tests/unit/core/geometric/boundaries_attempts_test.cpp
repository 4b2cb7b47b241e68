// SPDX-License-Identifier: BSD-3-Clause
// The attempts, their conditions, and their contents.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

/// Nothing is ever available: a sphere round all that can be flown.
struct Hopeless : Scene {
    Workspace workspace;
    std::size_t attempts = 0;

    Hopeless()
    {
        settings.verify_flight = false;
        settings.check_acceleration = false;
        settings.escape_from_margin = false;
        threats.push_back(Scene::still(Vec3(0.0F, 0.0F, 50.0F), 500.0F));
    }
    PlanStatus run_all()
    {
        put_into(problem);
        return solve_with_retries(problem, settings, limits, airframe, budget, workspace, result, attempts);
    }
    std::size_t count_of(Family family) const
    {
        return static_cast<std::size_t>(std::count_if(result.candidates.begin(), result.candidates.end(),
                                                      [=](const Candidate& c) { return c.shape.family == family; }));
    }
    std::size_t planes() const
    {
        std::set<float> angles;
        for (const Candidate& c : result.candidates) {
            angles.insert(c.shape.plane);
        }
        return angles.size();
    }
};

TEST(Attempts, AsManyAsHaveSomethingToAdd)
{
    struct Case {
        vehicle::VehicleKind kind;
        OffsetRule rule;
        std::size_t attempts;
        std::size_t last;
    };
    // planner.hpp: a fixed wing does not fly slower, nor wait; source offsets know other speeds and ends only.
    for (const Case& c : {Case{vehicle::VehicleKind::multirotor, OffsetRule::clearing, 10, 9},
                          Case{vehicle::VehicleKind::fixed_wing, OffsetRule::clearing, 5, 8},
                          Case{vehicle::VehicleKind::multirotor, OffsetRule::source, 4, 4},
                          Case{vehicle::VehicleKind::fixed_wing, OffsetRule::source, 2, 2}}) {
        Hopeless scene;
        scene.limits.kind = c.kind;
        scene.settings.offset_rule = c.rule;
        EXPECT_EQ(scene.run_all(), PlanStatus::none_available);
        EXPECT_EQ(scene.attempts, c.attempts);
        EXPECT_EQ(scene.result.attempt, c.last);
        EXPECT_FALSE(scene.result.cut_short);
    }
}

TEST(Attempts, NoMoreThanAreAskedFor)
{
    for (std::size_t retries = 0; retries < kAttempts.size(); ++retries) {
        Hopeless scene;
        scene.settings.retries = static_cast<std::uint8_t>(retries);
        EXPECT_EQ(scene.run_all(), PlanStatus::none_available);
        EXPECT_EQ(scene.attempts, retries + 1);
        EXPECT_EQ(scene.result.attempt, retries);
    }
}

TEST(Attempts, EachTriesWhatItSays)
{
    for (std::size_t i = 0; i < kAttempts.size(); ++i) {
        Hopeless scene;
        scene.settings.offsets = 8;
        scene.settings.retries = static_cast<std::uint8_t>(i);
        EXPECT_EQ(scene.run_all(), PlanStatus::none_available);
        ASSERT_EQ(scene.result.attempt, i);
        const auto kind = kAttempts[i].kind;
        const bool as_set = kind == Attempt::Kind::as_set || kind == Attempt::Kind::more_planes;
        EXPECT_EQ(scene.count_of(Family::simple) > 0, as_set) << i;
        EXPECT_EQ(scene.count_of(Family::symmetric) > 0, as_set || kind == Attempt::Kind::in_a_row) << i;
        EXPECT_EQ(scene.count_of(Family::plateau) > 0, kind == Attempt::Kind::plateau) << i;
        EXPECT_EQ(scene.count_of(Family::wait), kind == Attempt::Kind::wait ? kWaits : 0) << i;
        const std::size_t planes = kind == Attempt::Kind::more_planes ? 8 : kind == Attempt::Kind::wait ? 1 : 4;
        EXPECT_EQ(scene.planes(), planes) << i;
        if (kind == Attempt::Kind::more_planes) {
            EXPECT_EQ(scene.result.candidates.size(), 2U * 8U * 4U) << "half the offsets on twice the planes";
        }
    }
}

TEST(Attempts, HalfOfTwoOffsetsAreTwo)
{
    Hopeless scene;
    scene.settings.offsets = 2;
    scene.settings.retries = 8;
    ASSERT_EQ(kAttempts[8].kind, Attempt::Kind::more_planes);
    EXPECT_EQ(scene.run_all(), PlanStatus::none_available);
    EXPECT_EQ(scene.attempts, 9U);
    // Of one family, so that there are no more of them than before.
    EXPECT_EQ(scene.result.candidates.size(), 8U * 2U);
}

TEST(Attempts, AnyThatWasCutShortIsReported)
{
    Hopeless scene;
    scene.threats.pop_back();
    scene.settings.check_units = 1;
    EXPECT_EQ(scene.run_all(), PlanStatus::none_available);
    EXPECT_TRUE(scene.result.cut_short);
    scene.settings.retries = 0;
    EXPECT_EQ(scene.run_all(), PlanStatus::none_available);
    EXPECT_TRUE(scene.result.cut_short);
}

TEST(Attempts, BadSettingsAreRefusedHoweverOftenTheyAreTried)
{
    for (const std::uint8_t retries : {std::uint8_t{0}, std::uint8_t{8}, std::uint8_t{9}, std::uint8_t{255}}) {
        Hopeless scene;
        scene.settings.retries = retries;
        scene.settings.max_cost = 2.0F;
        EXPECT_EQ(scene.run_all(), PlanStatus::bad_input) << int(retries);
        EXPECT_TRUE(scene.result.candidates.empty());
    }
}

TEST(Attempts, OneThatWasCutShortIsReportedWhateverComesAfterIt)
{
    std::size_t reported = 0;
    for (std::uint32_t units = 0; units < 4'000; units += 100) {
        bool cut = false;
        for (std::size_t retries = 0; retries < kAttempts.size(); ++retries) {
            Hopeless scene;
            scene.settings.evaluate_all = scene.settings.all_terms = false;
            scene.settings.check_units = units;
            scene.settings.retries = static_cast<std::uint8_t>(retries);
            ASSERT_EQ(scene.run_all(), PlanStatus::none_available);
            ASSERT_TRUE(scene.result.cut_short || !cut) << units << " units, " << retries << " retries";
            cut = scene.result.cut_short;
        }
        reported += cut ? 1U : 0U;
    }
    EXPECT_GT(reported, 0U);
    EXPECT_LT(reported, 40U) << "some of them are enough";
}

/// Manoeuvres of two parts are for straight legs and threats that are where they are, when.
TEST(Attempts, TwoPartsAreNeitherForRoutesNorForSweptVolumes)
{
    path::Route route;
    ASSERT_EQ(route.add_leg(Vec3(0.0F, 0.0F, 50.0F), Vec3(200.0F, 0.0F, 50.0F)), path::RouteStatus::ok);
    Hopeless along;
    along.problem.ahead.route = route;
    EXPECT_EQ(along.run_all(), PlanStatus::none_available);
    EXPECT_EQ(along.attempts, 9U);
    Hopeless swept;
    swept.settings.security = SecurityMode::swept;
    EXPECT_EQ(swept.run_all(), PlanStatus::none_available);
    EXPECT_EQ(swept.attempts, 9U);
    EXPECT_EQ(swept.result.attempt, 8U);
}

TEST(Attempts, MorePlanesAreOfNoFamilyThatWasNotAskedFor)
{
    ASSERT_EQ(kAttempts[8].kind, Attempt::Kind::more_planes);
    for (const Family left_out : {Family::simple, Family::symmetric}) {
        for (const std::uint16_t offsets : {std::uint16_t{2}, std::uint16_t{8}}) {
            Hopeless scene;
            scene.settings.*flag_of(left_out) = false;
            scene.settings.offsets = offsets;
            scene.settings.retries = 8;
            EXPECT_EQ(scene.run_all(), PlanStatus::none_available);
            ASSERT_EQ(scene.result.attempt, 8U);
            EXPECT_EQ(scene.count_of(left_out), 0U);
            EXPECT_EQ(scene.planes(), 8U) << "and of the other there are some";
        }
    }
}

}  // namespace
}  // namespace jink::geometric
