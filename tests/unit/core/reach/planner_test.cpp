// SPDX-License-Identifier: BSD-3-Clause
// The reach planner with trees of a few movements: placement, refusals, contents of an answer.
#include "core/reach/planner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/core/reach/planner_bench.hpp"

namespace jink::reach {
namespace {

using test::PlannerBench;
using world::PlanStatus;

class PlannerTest : public ::testing::Test, protected PlannerBench {
protected:
    /// Course of the path's second part [rad].
    [[nodiscard]] float course() const
    {
        const Vec3 along = end() - out.path.points[out.path.points.size() - 3].position;
        return std::atan2(along.y(), along.x());
    }
};

constexpr float kFifteenDegrees = kPi / 12.0F;

TEST_F(PlannerTest, AWayStraightOnIsLaidOutInHalfMovements)
{
    ASSERT_EQ(plan(), PlanStatus::found);
    ASSERT_EQ(out.path.points.size(), 10U);
    EXPECT_EQ(out.path.points[0].position, own.position);
    EXPECT_EQ(out.path.points[0].time, 0.0F);
    for (std::size_t i = 1; i < 10; ++i) {
        const auto half = static_cast<float>(i - 1);
        EXPECT_NEAR((out.path.points[i].position - Vec3(0.5F + 1.25F * half, 0.0F, 30.0F)).norm(), 0.0F, 1e-4F) << i;
        EXPECT_NEAR(out.path.points[i].time, 0.1F + 0.25F * half, 1e-6F) << i;
    }
    for (const path::PathPoint& point : out.path.points) {
        EXPECT_NEAR((point.velocity - Vec3(5.0F, 0.0F, 0.0F)).norm(), 0.0F, 1e-3F);
    }
    EXPECT_EQ(out.kind, world::ManoeuvreKind::follow_path);
    EXPECT_EQ(out.start, now);
    EXPECT_NEAR(out.valid_until - now, 2.1F, 1e-5F);
    EXPECT_EQ(out.command, Vec3::Zero());
    EXPECT_EQ(out.side, Vec3::Zero());
    EXPECT_NEAR(out.cost, 0.25F, 1e-6F) << "1280 of 1024 each movement";
}

TEST_F(PlannerTest, TheReportSaysWhatWasFound)
{
    add_track(Vec3(-8.0F, 0.0F, 30.0F), Vec3::Zero(), 0.5F);
    add_track(Vec3(200.0F, 0.0F, 30.0F), Vec3::Zero(), 0.5F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_EQ(report().path, PathStatus::found);
    EXPECT_EQ(report().run, AvoidanceRun::soft_constraints);
    EXPECT_FALSE(report().emergency);
    EXPECT_EQ(report().headings, 1);
    EXPECT_EQ(report().tries, 1);
    EXPECT_EQ(report().near, 1) << "of two tracks one is within reach";
    EXPECT_EQ(report().free_nodes, 8);
    EXPECT_EQ(report().node, 4) << "the end of the chain straight on";
    reference.valid = false;
    ASSERT_EQ(plan(), PlanStatus::bad_input);
    EXPECT_EQ(report().path, PathStatus::no_path) << "nothing is left of the plan before";
    EXPECT_EQ(report().headings, 0);
    EXPECT_EQ(report().tries, 0);
    EXPECT_EQ(report().node, kNoNode);
}

TEST_F(PlannerTest, NodesThatAreNotFreeAreNotCounted)
{
    add_box(Vec3(8.0F, 0.0F, 30.0F), Vec3(0.2F, 0.2F, 5.0F));
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(course(), kFifteenDegrees, 1e-3F);
    EXPECT_LT(report().free_nodes, 8);
    EXPECT_GE(report().free_nodes, 4) << "the left chain and what is before the box";
}

TEST_F(PlannerTest, TheGridLiesAlongTheCourseNotTheYaw)
{
    own.yaw = 1.0F;
    own.velocity = Vec3(-3.0F, 4.0F, 0.0F);
    leg(own.position, Vec3(-300.0F, 400.0F, 30.0F));
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR((out.path.points[1].position - Vec3(-0.3F, 0.4F, 30.0F)).norm(), 0.0F, 1e-4F) << "after the latency";
    EXPECT_NEAR((end() - Vec3(-6.3F, 8.4F, 30.0F)).norm(), 0.0F, 1e-3F);
}

TEST_F(PlannerTest, SpeedScalesTheMovements)
{
    own.velocity = Vec3(8.0F, 0.0F, 0.0F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(end().x(), 0.8F + 16.0F, 1e-3F);
    EXPECT_NEAR(out.path.duration(), 2.1F, 1e-5F) << "of the same length in time";
}

TEST_F(PlannerTest, WithoutLatencyThePathBeginsInItsFirstMovement)
{
    rules.latency = 0.0F;
    ASSERT_EQ(plan(), PlanStatus::found);
    ASSERT_EQ(out.path.points.size(), 9U);
    EXPECT_EQ(out.path.points[0].position, own.position);
    EXPECT_NEAR(out.path.points[1].position.x(), 1.25F, 1e-4F);
    EXPECT_NEAR(out.path.duration(), 2.0F, 1e-6F);
    rules.latency = 0.4F;
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(out.path.points[1].position.x(), 2.0F, 1e-4F);
    EXPECT_NEAR(out.path.points[1].time, 0.4F, 1e-6F);
    EXPECT_NEAR(out.path.duration(), 2.4F, 1e-6F);
}

/// Nose up is a pitch below 0: a climbing vehicle flies the sets of the climbing segment.
TEST_F(PlannerTest, TheSegmentIsThatOfTheFlightPathAngle)
{
    test::SmallTree left(kGrid);
    left.chain(Movement::left, 4, 1024);
    test::SmallTree right(kGrid);
    right.chain(Movement::right, 4, 1024);
    pairs[static_cast<std::size_t>(PitchSegment::descending)] = {keep(left), &views.back(), false};
    pairs[static_cast<std::size_t>(PitchSegment::climbing)] = {keep(right), &views.back(), false};
    own.velocity = Vec3(4.8F, 0.0F, 1.4F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(course(), -kFifteenDegrees, 1e-3F) << "climbing";
    own.velocity = Vec3(4.8F, 0.0F, -1.4F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(course(), kFifteenDegrees, 1e-3F) << "descending";
    own.velocity = Vec3(4.8F, 0.0F, 0.5F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(course(), 0.0F, 1e-3F);
    own.velocity = Vec3(2.0F, 0.0F, -2.2F);
    EXPECT_EQ(plan(), PlanStatus::none_available) << "steeper than any set is for";
}

TEST_F(PlannerTest, MirroredTablesClimbWhereTheyWereBuiltToDescend)
{
    test::SmallTree down(kGrid);
    down.chain(Movement::down, 4, 1024);
    only(down);
    ASSERT_EQ(plan(), PlanStatus::found);
    const Vec3 fallen = end();
    EXPECT_LT(fallen.z(), 28.0F);
    for (SegmentSets& segment : pairs) {
        segment.upside_down = true;
    }
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR((end() - Vec3(fallen.x(), fallen.y(), 60.0F - fallen.z())).norm(), 0.0F, 1e-4F);
    // The trajectory is checked at its end.
    add_sphere(Vec3(2.97F, 0.0F, 31.05F), 0.3F);
    EXPECT_EQ(plan(), PlanStatus::none_available);
    obstacles.clear();
    add_sphere(Vec3(2.97F, 0.0F, 28.95F), 0.3F);
    EXPECT_EQ(plan(), PlanStatus::found);
}

TEST_F(PlannerTest, FasterThanAnySetNothingIsAvailable)
{
    own.velocity = Vec3(10.0F, 0.0F, 0.0F);
    EXPECT_EQ(plan(), PlanStatus::found) << "most_speed itself";
    own.velocity = Vec3(10.1F, 0.0F, 0.0F);
    EXPECT_EQ(plan(), PlanStatus::none_available);
    EXPECT_EQ(report().headings, 0);
    own.velocity = Vec3(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
    EXPECT_EQ(plan(), PlanStatus::none_available);
    EXPECT_TRUE(out.path.points.empty());
}

/// A nearly static multirotor: no latency, along the nominal path, at the least speed of the sets.
TEST_F(PlannerTest, StandingItBeginsAlongTheLegFromWhereItIs)
{
    own.velocity = Vec3(0.0F, 1.2F, 0.0F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_EQ(out.path.points.size(), 9U);
    EXPECT_EQ(out.path.points[0].position, own.position);
    EXPECT_NEAR((end() - Vec3(2.5F, 0.0F, 30.0F)).norm(), 0.0F, 1e-3F) << "4 movements at 1.25 m/s";
    EXPECT_NEAR(out.path.duration(), 2.0F, 1e-5F);
    own.velocity = Vec3(0.0F, 1.25F, 0.0F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_EQ(out.path.points.size(), 10U) << "it moves";
    EXPECT_NEAR(out.path.points[1].position.y(), 0.125F, 1e-4F);
    EXPECT_GT(end().y(), 2.4F) << "and goes on where it moves to";
}

TEST_F(PlannerTest, ASlowWingKeepsItsCourse)
{
    limits.kind = vehicle::VehicleKind::fixed_wing;
    own.velocity = Vec3(0.0F, 1.0F, 0.0F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(out.path.points[1].position.y(), 0.1F, 1e-4F);
    EXPECT_NEAR(end().y(), 0.1F + 2.5F, 1e-3F);
    add_box(Vec3(0.0F, 1.4F, 30.0F), Vec3::Constant(0.3F));
    EXPECT_EQ(plan(), PlanStatus::none_available);
    EXPECT_EQ(report().headings, 1);
}

TEST_F(PlannerTest, StandingItTriesTheLeftThenTheRightThenBackwards)
{
    test::SmallTree ahead(kGrid);
    ahead.chain(Movement::straight, 4, 1024);
    only(ahead);
    own.velocity = Vec3::Zero();
    add_sphere(Vec3(1.15F, 0.0F, 30.0F), 0.2F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(course(), kPi / 3.0F, 1e-3F);
    EXPECT_EQ(report().headings, 2);
    add_sphere(Vec3(0.575F, 0.996F, 30.0F), 0.2F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(course(), -kPi / 3.0F, 1e-3F);
    EXPECT_EQ(report().headings, 3);
    EXPECT_NEAR((out.side - Vec3(0.0F, -1.0F, 0.0F)).norm(), 0.0F, 1e-3F);
    add_sphere(Vec3(0.575F, -0.996F, 30.0F), 0.2F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(course(), 2.0F * kPi / 3.0F, 1e-3F);
    EXPECT_EQ(report().headings, 4);
    add_sphere(Vec3(-0.575F, 0.996F, 30.0F), 0.2F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(course(), -2.0F * kPi / 3.0F, 1e-3F);
    add_sphere(Vec3(-0.575F, -0.996F, 30.0F), 0.2F);
    EXPECT_EQ(plan(), PlanStatus::none_available);
    EXPECT_EQ(report().headings, 5);
}

TEST_F(PlannerTest, StandingItTurnsFromTheCourseOfItsWay)
{
    test::SmallTree ahead(kGrid);
    ahead.chain(Movement::straight, 4, 1024);
    only(ahead);
    own.velocity = Vec3::Zero();
    reference = world::Reference({Vec3(0.0F, -20.0F, 30.0F), Vec3(0.0F, 500.0F, 30.0F), 5.0F});
    add_sphere(Vec3(0.0F, 1.15F, 30.0F), 0.2F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(course(), 5.0F * kPi / 6.0F, 1e-3F) << "from north by 60 degrees to the left";
}

/// For a nearly static vehicle the vertical velocity is ignored.
TEST_F(PlannerTest, SinkingSlowlyItIsLevel)
{
    test::SmallTree left(kGrid);
    left.chain(Movement::left, 4, 1024);
    const ReachSet* const steep = keep(left);
    pairs[static_cast<std::size_t>(PitchSegment::descending)] = {steep, steep, false};
    pairs[static_cast<std::size_t>(PitchSegment::climbing)] = {steep, steep, false};
    for (const float climb : {-1.0F, 1.0F}) {
        own.velocity = Vec3(0.0F, 0.0F, climb);
        ASSERT_EQ(plan(), PlanStatus::found);
        EXPECT_NEAR(course(), 0.0F, 1e-3F);
        EXPECT_FALSE(report().emergency);
    }
}

TEST_F(PlannerTest, StandingOnALegStraightUpItFacesItsYaw)
{
    own.velocity = Vec3::Zero();
    own.yaw = 0.5F * kPi;
    reference = world::Reference({Vec3(0.0F, 0.0F, 0.0F), Vec3(0.0F, 0.0F, 100.0F), 3.0F});
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_GT(end().y(), 2.0F);
    EXPECT_EQ(report().headings, 1);
}

TEST_F(PlannerTest, WhereNavigationHasNoWayTheEmergencySetIsFlown)
{
    add_sphere(Vec3(3.6F, 0.75F, 30.0F), 0.3F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_TRUE(report().emergency);
    EXPECT_NEAR(course(), -kFifteenDegrees, 1e-3F);
    EXPECT_NEAR(out.cost, 0.75F, 1e-6F);
    EXPECT_LT(out.side.y(), -0.999F);
    EXPECT_EQ(report().headings, 1);
    obstacles.clear();
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_FALSE(report().emergency) << "navigation first";
}

TEST_F(PlannerTest, CostsStayWithinAShare)
{
    test::SmallTree expensive(kGrid);
    expensive.chain(Movement::straight, 4, 5000);
    test::SmallTree cheap(kGrid);
    cheap.chain(Movement::straight, 4, 500);
    only(expensive);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_EQ(out.cost, 1.0F);
    only(cheap);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_EQ(out.cost, 0.0F);
}

TEST_F(PlannerTest, ASmallStepAsideHasNoSide)
{
    test::SmallTree left(kGrid);
    left.chain(Movement::left, 4, 1024);
    only(left);
    leg(Vec3(-20.0F, 0.0F, 30.0F), Vec3(100.0F, 0.0F, 30.0F));
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_GT(out.side.y(), 0.999F) << "from the way towards the path";
    // On a way that leads along the path there is no side: (3.886, 0.907) is where the tree ends.
    leg(Vec3(0.5F, 0.0F, 30.0F) - 3.0F * Vec3(3.886F, 0.907F, 0.0F),
        Vec3(0.5F, 0.0F, 30.0F) + 30.0F * Vec3(3.886F, 0.907F, 0.0F));
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(out.side.norm(), 1.0F, 1e-5F) << "the turn bends off the chord by more than the least side";
    test::SmallTree straight(kGrid);
    straight.chain(Movement::straight, 4, 1024);
    only(straight);
    own.position.y() = 0.2F;
    reference = world::Reference({Vec3(-20.0F, 0.0F, 30.0F), Vec3(500.0F, 0.0F, 30.0F), 5.0F});
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_EQ(out.side, Vec3::Zero());
}

/// With fewer work units than needed there is no answer, and nothing is written.
TEST_F(PlannerTest, ABudgetThatRunsOutIsNoAnswer)
{
    add_track(Vec3(12.0F, 0.0F, 30.0F), Vec3::Zero(), 0.5F);
    add_box(Vec3(20.0F, 5.0F, 30.0F), Vec3::Ones());
    const auto sweep = [&] {
        ASSERT_EQ(plan(), PlanStatus::found);
        const std::uint32_t needed = spent;
        for (std::uint32_t units = 0; units < needed; ++units) {
            ASSERT_EQ(plan(units), PlanStatus::budget_spent) << units;
            ASSERT_TRUE(out.path.points.empty()) << units;
        }
        EXPECT_EQ(plan(needed), PlanStatus::found);
    };
    sweep();
    add_sphere(Vec3(3.6F, 0.75F, 30.0F), 0.3F);  // the emergency set
    sweep();
    EXPECT_TRUE(report().emergency);
    limits.kind = vehicle::VehicleKind::fixed_wing;
    sweep();
}

/// Non-finite values count as contact, or give no answer: never a free trajectory.
TEST_F(PlannerTest, NumbersThatAreNotFiniteAreNeverClear)
{
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        own.position = Vec3(bad, 0.0F, 30.0F);
        EXPECT_NE(plan(), PlanStatus::found) << "own place";
        own.position = Vec3(0.0F, 0.0F, bad);
        EXPECT_NE(plan(), PlanStatus::found) << "own height";
        own.position = Vec3(0.0F, 0.0F, 30.0F);
        add_track(Vec3(10.0F, 0.0F, 30.0F), Vec3::Zero(), bad);
        EXPECT_NE(plan(), PlanStatus::found) << "a track's radius";
        tracks.clear();
    }
    const float nan = std::numeric_limits<float>::quiet_NaN();
    add_track(Vec3(nan, 0.0F, 30.0F), Vec3::Zero(), 0.5F);
    EXPECT_NE(plan(), PlanStatus::found) << "a track's place";
    tracks.clear();
    add_track(Vec3(10.0F, 0.0F, 30.0F), Vec3(0.0F, nan, 0.0F), 0.5F);
    EXPECT_NE(plan(), PlanStatus::found) << "a track's velocity";
    tracks.clear();
    own.sigma_position = nan;
    add_box(Vec3(3.5F, 0.0F, 30.0F), Vec3::Ones());
    EXPECT_NE(plan(), PlanStatus::found) << "own uncertainty, a box";
    obstacles.clear();
    add_sphere(Vec3(3.5F, 0.0F, 30.0F), 1.0F);
    EXPECT_NE(plan(), PlanStatus::found) << "own uncertainty, a sphere";
    obstacles.clear();
    add_track(Vec3(10.0F, 0.0F, 30.0F), Vec3::Zero(), 0.5F);
    EXPECT_NE(plan(), PlanStatus::found) << "own uncertainty, a track";
}

}  // namespace
}  // namespace jink::reach
