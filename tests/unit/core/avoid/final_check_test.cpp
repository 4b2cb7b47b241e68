// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/final_check.hpp"

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/base/work_units.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;
using world::test::kPlenty;

TEST(CheckManoeuvre, LooksBeyondTheEndOfThePath)
{
    Flight f;
    f.scene.track(Vec3(23, 0, 30), Vec3::Zero(), 1.0F);
    const Situation s = f.scene.situation();
    WorkBudget budget(kPlenty);
    const auto margin = [&](float length) {
        const Manoeuvre m = along(s, {s.own.position, s.own.position + Vec3(length, 0, 0)}, Vec3(0, 1, 0));
        return check_manoeuvre(s, m, Settings{}, budget).margin;
    };
    EXPECT_GT(margin(16.0F), 0.0F);
    EXPECT_LT(margin(20.0F), 0.0F) << "it takes more than a metre to stop from 5 m/s";
}

TEST(CheckManoeuvre, JudgesOnlyWhatIsLeftToFly)
{
    Flight f;
    f.scene.track(Vec3(10, 0, 30), Vec3::Zero(), 1.0F);
    Manoeuvre m = detour(f.scene.situation(), Vec3(0, 1, 0), 0.0F, 100.0F);
    f.scene.own.position = Vec3(20, 0, 30);
    m.start = f.scene.now - 4.0F;
    WorkBudget budget(kPlenty);
    EXPECT_GT(check_manoeuvre(f.scene.situation(), m, Settings{}, budget).margin, 5.0F);
}

TEST(CheckManoeuvre, FollowsFromWhereTheVehicleReallyIs)
{
    Flight f;
    f.scene.track(Vec3(2, 4, 30), Vec3::Zero(), 1.0F);
    const Manoeuvre m = detour(f.scene.situation(), Vec3(0, 1, 0), 0.0F, 100.0F);
    f.scene.own.position = Vec3(0, 4.5F, 30);  // blown off
    WorkBudget budget(kPlenty);
    EXPECT_LT(check_manoeuvre(f.scene.situation(), m, Settings{}, budget).margin, 0.0F);
}

/// In the middle of a detour that comes back to the leg in front of a threat.
TEST(CheckManoeuvre, CountsTheTimeSinceTheManoeuvreBegan)
{
    Flight f;
    const Manoeuvre begun = detour(f.scene.situation(), Vec3(0, 1, 0), 6.0F, 50.0F);
    f.scene.track(Vec3(45, 0, 30), Vec3::Zero(), 1.0F);
    WorkBudget budget(kPlenty);
    const path::PathSample at = path::sample(begun.path, 5.0F);
    f.scene.own.position = at.position;
    f.scene.own.velocity = at.velocity;
    Manoeuvre m = begun;
    m.start = f.scene.now - 5.0F;
    EXPECT_LT(check_manoeuvre(f.scene.situation(), m, Settings{}, budget).margin, 0.0F);
    // Contact at present with the detour's beginning, which is already flown.
    f.scene.tracks.clear();
    f.scene.track(begun.path.points.front().position, Vec3::Zero(), 1.0F);
    EXPECT_GT(check_manoeuvre(f.scene.situation(), m, Settings{}, budget).margin, 5.0F);
}

/// One number each, in a manoeuvre that is clear otherwise.
TEST(CheckManoeuvre, NumbersThatAreNotFiniteAreContact)
{
    Flight f;
    WorkBudget budget(kPlenty);
    const Situation s = f.scene.situation();
    for (const float bad : {kNan, kInfinity, -kInfinity}) {
        for (int axis = 0; axis < 3; ++axis) {
            for (const ManoeuvreKind kind : {ManoeuvreKind::follow_path, ManoeuvreKind::velocity, ManoeuvreKind::brake,
                                             ManoeuvreKind::hold_turn}) {
                Manoeuvre good = detour(s, Vec3(0, 1, 0), 6.0F, 50.0F);
                good.kind = kind;
                good.command = Vec3(5, 0, 0);
                ASSERT_GT(check_manoeuvre(s, good, Settings{}, budget).margin, 0.0F);
                Manoeuvre m = good;
                m.path.points[4].velocity[axis] = bad;
                EXPECT_EQ(check_manoeuvre(s, m, Settings{}, budget).margin, -world::kSeparationCap);
                m = good;
                m.path.points.back().velocity[axis] = bad;
                EXPECT_EQ(check_manoeuvre(s, m, Settings{}, budget).margin, -world::kSeparationCap);
                m = good;
                m.path.points[4].position[axis] = bad;
                EXPECT_EQ(check_manoeuvre(s, m, Settings{}, budget).margin, -world::kSeparationCap);
                m = good;
                m.command[axis] = bad;
                EXPECT_EQ(check_manoeuvre(s, m, Settings{}, budget).margin, -world::kSeparationCap);
            }
            Vec3 command(5, 0, 0);
            command[axis] = bad;
            EXPECT_EQ(margin_of(f, command), -world::kSeparationCap);
        }
    }
}

/// Prediction costs work units too; an unfinished check is contact.
TEST(CheckManoeuvre, IsPaidForAndContactWithout)
{
    Flight f;
    const Situation s = f.scene.situation();
    const Manoeuvre m = along(s, {s.own.position, s.own.position + Vec3(10, 0, 0)}, Vec3(0, 1, 0));
    WorkBudget ample(kPlenty);
    ASSERT_GT(check_manoeuvre(s, m, Settings{}, ample).margin, 0.0F);
    const auto parts = static_cast<std::uint32_t>(m.path.duration() / path::kFollowerPeriod);
    ASSERT_GE(ample.spent(), parts * units::kFlightPart);
    WorkBudget held(kPlenty);
    ASSERT_GT(command_margin(s, Vec3(1, 0, 0), Settings{}, held), 0.0F);
    ASSERT_GE(held.spent(), 20 * units::kCommandStep) << "4 s in steps of 0.2 s";
    for (std::uint32_t n = 0; n < ample.spent(); ++n) {
        WorkBudget budget(n);
        ASSERT_LT(check_manoeuvre(s, m, Settings{}, budget).margin, 0.0F) << n;
    }
    for (std::uint32_t n = 0; n < held.spent(); ++n) {
        WorkBudget budget(n);
        ASSERT_LT(command_margin(s, Vec3(1, 0, 0), Settings{}, budget), 0.0F) << n;
    }
}

TEST(CheckManoeuvre, APathBeyondMeasureIsContact)
{
    Flight f;
    const Situation s = f.scene.situation();
    Manoeuvre m = along(s, {s.own.position, s.own.position + Vec3(10, 0, 0)}, Vec3(0, 1, 0));
    m.path.points.back().time = 1e30F;
    WorkBudget budget(kPlenty);
    EXPECT_LT(check_manoeuvre(s, m, Settings{}, budget).margin, 0.0F);
    EXPECT_TRUE(budget.exhausted());
}

}  // namespace
}  // namespace jink::avoid
