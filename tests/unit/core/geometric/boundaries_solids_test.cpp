// SPDX-License-Identifier: BSD-3-Clause
// One curve against solids without a closed form: marginal contact, starts inside margins and the duration of their
// tolerance, and the low cost of far solids.
#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include <Eigen/Geometry>

#include "core/base/random.hpp"
#include "core/base/work_units.hpp"
#include "tests/unit/core/geometric/curve_bench.hpp"

namespace jink::geometric {
namespace {

using Part = detail::Clearance::Part;

/// A wall behind x = `face`, 4 m deep and 40 m wide.
world::Obstacle wall(float face)
{
    return {1, geometry::make_box(Vec3(face - 2.0F, 0.0F, 0.0F), Vec3(2.0F, 20.0F, 20.0F))};
}

/// A bar along z, on its edge at `x`: the edge is nearest to a path along x, `gap` from a box of half a metre.
world::Obstacle bar(float x, float gap)
{
    const Mat3 turned = Eigen::AngleAxisf(0.25F * kPi, Vec3::UnitZ()).toRotationMatrix();
    const float out = 0.5F * std::numbers::sqrt2_v<float>;
    return {1, geometry::make_box(Vec3(x, 0.5F + gap + out, 0.0F), Vec3(0.5F, 0.5F, 3.0F), turned)};
}

TEST(SolidBorder, OneSegmentMayPassByLessThanWhatIsStraightMayBeOff)
{
    CurveBench bench({{Vec3::Zero(), 0.0F}, {Vec3::UnitX(), 1.0F}});
    bench.obstacles = {bar(0.5F, 0.7F * detail::kStraight)};
    EXPECT_EQ(bench.status(), CandidateStatus::available);
    bench.obstacles = {bar(0.5F, -0.1F * detail::kStraight)};
    EXPECT_EQ(bench.status(), CandidateStatus::hits_static);
}

TEST(SolidBorder, ARunThatIsStraightBarAHairIsHitByThatHair)
{
    // The straight path from end to end is clear; the point in the middle, almost on it, is not.
    const Vec3 middle(0.5F, 0.9F * detail::kStraight, 0.0F);
    CurveBench bench({{Vec3::Zero(), 0.0F}, {middle, 0.5F}, {Vec3::UnitX(), 1.0F}});
    bench.obstacles = {bar(0.5F, 0.5F * detail::kStraight)};
    EXPECT_EQ(bench.status(), CandidateStatus::hits_static);
    CurveBench straight({{Vec3::Zero(), 0.0F}, {Vec3::UnitX(), 1.0F}});
    straight.obstacles = bench.obstacles;
    EXPECT_EQ(straight.status(), CandidateStatus::available);
}

/// Starts inside of a margin, or not: the escape rule at work.
CurveBench escaping(const std::vector<CurvePoint>& points, float slack, float speed)
{
    CurveBench bench(points);
    bench.settings.escape_from_margin = true;
    bench.problem.rules.escape = {slack, speed};
    return bench;
}

TEST(SolidBorder, AStartThatIsClearIsNoStartInside)
{
    // 0.01 m off a wall that never grows back; the path leads 0.02 m into it.
    for (const float into : {0.02F, 0.2F}) {
        CurveBench bench = escaping({{Vec3::Zero(), 0.0F}, {Vec3(-0.01F - into, 0.0F, 0.0F), 1.0F}}, 0.05F, 0.0F);
        bench.obstacles = {wall(-0.51F)};
        EXPECT_EQ(bench.status(), CandidateStatus::hits_static) << into;
    }
}

TEST(SolidBorder, AlongAWallThatDoesNotGrowBackOneMayGlide)
{
    // A tenth of a metre inside of it all along, and twice as deep.
    for (const float deeper : {0.0F, 0.2F}) {
        CurveBench bench = escaping({{Vec3::Zero(), 0.0F},
                                     {Vec3(0.0F, 1.0F, 0.0F), 1.0F},
                                     {Vec3(-deeper, 2.0F, 0.0F), 2.0F},
                                     {Vec3(-deeper, 3.0F, 0.0F), 3.0F}},
                                    0.05F, 0.0F);
        bench.obstacles = {wall(-0.4F)};
        EXPECT_EQ(bench.status(), deeper > 0.0F ? CandidateStatus::hits_static : CandidateStatus::available);
    }
}

TEST(SolidBorder, AMarginIsForgivenByTheClock)
{
    // A quarter of a metre inside and as much slack: half a metre is forgiven, by half a metre a second less. Who
    // leaves after a quarter of a second at 1 m/s is out in time; at a tenth of that the wall comes up from behind.
    for (const float speed : {1.0F, 0.1F}) {
        CurveBench bench = escaping(
            {{Vec3::Zero(), 0.0F}, {Vec3::Zero(), 0.25F}, {Vec3(0.5F, 0.0F, 0.0F), 0.25F + 0.5F / speed}}, 0.25F, 0.5F);
        bench.obstacles = {wall(-0.25F)};
        EXPECT_EQ(bench.status(), speed < 1.0F ? CandidateStatus::hits_static : CandidateStatus::available) << speed;
    }
    // As slowly, after a second and a half, from a wall that takes five to grow back.
    CurveBench bench =
        escaping({{Vec3::Zero(), 0.0F}, {Vec3::Zero(), 1.5F}, {Vec3(0.3F, 0.0F, 0.0F), 3.5F}}, 0.25F, 0.1F);
    bench.obstacles = {wall(-0.25F)};
    EXPECT_EQ(bench.status(), CandidateStatus::available);
}

TEST(SolidBorder, WithNothingLeftToForgiveBesideIsClear)
{
    // Off the bar's edge in an eighth of a second, and on beside it, nearer than the distance resolution.
    CurveBench bench = escaping({{Vec3::Zero(), 0.0F},
                                 {Vec3(0.0F, -0.12F, 0.0F), 0.15F},
                                 {Vec3(0.3F, -0.12F, 0.0F), 0.45F},
                                 {Vec3(0.6F, -0.12F, 0.0F), 0.75F}},
                                0.02F, 1.0F);
    bench.obstacles = {bar(0.0F, -0.1F)};
    EXPECT_EQ(bench.status(), CandidateStatus::available);
    bench.obstacles = {bar(0.0F, -0.13F)};
    EXPECT_EQ(bench.status(), CandidateStatus::hits_static) << "but in it is not";
}

TEST(SolidBorder, WhateverOneStartsInsideOfOneMayLeave)
{
    Random random(72);
    for (int i = 0; i < 400; ++i) {
        const auto number = [&](float size) { return random.uniform(-size, size); };
        const Vec3 out = Vec3(number(1.0F), number(1.0F), number(1.0F)).normalized();
        CurveBench bench =
            escaping({{Vec3::Zero(), 0.0F}, {0.5F * out, 0.5F}, {2.0F * out, 1.0F}, {9.0F * out, 2.0F}}, 0.0F, 0.0F);
        const Mat3 turned =
            Eigen::AngleAxisf(number(3.0F), Vec3(number(1.0F), number(1.0F), 1.0F).normalized()).toRotationMatrix();
        // Its face, perpendicular to the exit direction, is beside the box; the box may be within the clearance or
        // beyond the face.
        const geometry::Shape drum =
            geometry::make_cylinder(random.uniform(-6.0F, -5.0F) * out, random.uniform(-1.0F, 0.0F) * out, 4.0F);
        const geometry::Shape box =
            geometry::make_box(random.uniform(-3.0F, -1.0F) * out, Vec3(1.0F, 0.7F, 1.5F), turned);
        bench.obstacles = {{1, i % 2 == 0 ? drum : box}};
        bench.uncertainty = i % 4 < 2 ? 0.0F : random.uniform(0.0F, 2.0F);
        ASSERT_EQ(bench.status(), CandidateStatus::available) << i;
    }
}

TEST(SolidBorder, WithoutSlackASurfaceThatGrowsBackIsFollowedAllTheSame)
{
    // Solids are tolerated within the distance resolution: out at twice the speed at which this one grows back.
    CurveBench bench = escaping({{Vec3::Zero(), 0.0F}, {Vec3(1.0F, 0.0F, 0.0F), 1.0F}}, 0.0F, 0.5F);
    bench.obstacles = {wall(-0.25F)};
    EXPECT_EQ(bench.status(), CandidateStatus::available);
}

TEST(SolidBorder, WhatIsFarFromACurveCostsALook)
{
    const Mat3 turned = Eigen::AngleAxisf(0.25F * kPi, Vec3::UnitZ()).toRotationMatrix();
    CurveBench bench({{Vec3(-20.0F, 0.0F, 0.0F), 0.0F}, {Vec3(20.0F, 0.0F, 0.0F), 10.0F}});
    const auto spent_on = [&](const geometry::Shape& shape) {
        bench.obstacles = {{1, shape}};
        EXPECT_EQ(bench.check(Part::all, {Vec3(0.0F, 6.0F, 0.0F)}).status, CandidateStatus::available);
        EXPECT_EQ(bench.counted_solids, 1U);
        return bench.spent;
    };
    const std::uint32_t near = units::kSolidCheck + units::kSolidNear;
    // The sphere about it is, though no face of it lies between; a face does, though the sphere about it reaches
    // farther.
    EXPECT_EQ(spent_on(geometry::make_box(Vec3(0.0F, 6.0F, 0.0F), Vec3::Ones(), turned)), near - units::kSolidNear);
    EXPECT_EQ(spent_on(geometry::make_box(Vec3(0.0F, 6.0F, 0.0F), Vec3(30.0F, 1.0F, 1.0F))), near);
}

TEST(SolidBorder, SegmentsThatAreFarAreNotLookedAtCloser)
{
    // Round two sides of a square with a box in its middle.
    CurveBench bench({{Vec3::Zero(), 0.0F}, {Vec3(10.0F, 0.0F, 0.0F), 2.0F}, {Vec3(10.0F, 10.0F, 0.0F), 4.0F}});
    bench.obstacles = {{1, geometry::make_box(Vec3(4.0F, 6.0F, 0.0F), Vec3::Ones())}};
    ASSERT_EQ(bench.status(), CandidateStatus::available);
    EXPECT_EQ(bench.spent, units::kSolidCheck + units::kSolidNear + units::points_units(3) + 2 * units::kSolidSegment);
}

TEST(SolidBorder, WhoFliesIntoAWallAtItsTopTakesNoCloserLook)
{
    // Inside at one point only, half or two thirds of the path out.
    for (const std::size_t top : {3U, 4U}) {
        std::vector<CurvePoint> points;
        for (std::size_t i = 0; i <= 6; ++i) {
            points.push_back({Vec3(static_cast<float>(i), i == top ? 6.0F : 0.0F, 0.0F), static_cast<float>(i)});
        }
        CurveBench bench(points);
        bench.obstacles = {{1, geometry::make_box(Vec3(static_cast<float>(top), 8.0F, 0.0F), Vec3::Constant(2.0F))}};
        ASSERT_EQ(bench.status(), CandidateStatus::hits_static);
        EXPECT_EQ(bench.spent, units::kSolidCheck + units::kSolidNear) << top;
    }
}

}  // namespace
}  // namespace jink::geometric
