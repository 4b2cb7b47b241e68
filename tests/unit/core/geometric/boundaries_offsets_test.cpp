// SPDX-License-Identifier: BSD-3-Clause
// Clearing offsets: the innermost one clears any main threat at any distance, by no more than necessary; the outermost
// one extends to its stated value.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/geometric/offsets.hpp"
#include "core/geometry/convex.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

/// Only the inputs of the offsets.
struct OffsetScene : Scene {
    OffsetScene(Family family, float distance)
    {
        settings.simple = family == Family::simple;
        settings.symmetric = family == Family::symmetric;
        settings.smooth = family == Family::smooth;
        settings.check_acceleration = settings.verify_flight = false;
        settings.waypoints = kMaxPathPoints;
        problem.distance = distance;
        threats.clear();
        problem.main = kNoThreat;
    }
    void set_main(const geometry::Shape& shape, float radius)
    {
        obstacles = {{1, shape}};
        problem.main_shape = shape.kind == geometry::ShapeKind::sphere ? nullptr : &obstacles[0].shape;
        problem.main_radius = radius;
    }
    std::vector<float> offsets(float plane)
    {
        budget = WorkBudget{1'000'000};
        static_cast<void>(run());
        std::vector<float> out;
        for (const Candidate& c : result.candidates) {
            if (std::abs(c.shape.plane - plane) < 1e-4F) {
                out.push_back(c.shape.offset);
            }
        }
        return out;
    }
    /// Least distance of the vehicle's box along a candidate from the main threat.
    float margin(const CandidateShape& shape) const
    {
        path::TimedPath path;
        EXPECT_TRUE(make_candidate_path(problem, shape, settings.waypoints, limits, path));
        float least = 1e9F;
        for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
            WorkBudget units(geometry::kUnitsPerQuery);
            least = std::min(least, geometry::swept_box_distance(limits.half_extents, path.points[i].position,
                                                                 path.points[i + 1].position, obstacles[0].shape, 1e6F,
                                                                 1e-3F, units));
        }
        return least;
    }
};

float smallest_to_the_left(const OffsetScene& scene, Family family, const Vec3& half)
{
    const Vec3 left = Vec3::UnitY();
    const detail::MainExtent extent = detail::with_sides(scene.problem, left, detail::extent_along(scene.problem));
    return detail::smallest_clearing_offset(scene.problem, scene.settings, family, half, left, extent, extent.left);
}

/// The innermost offset on either side: clear, and a share less of it would not be.
void expect_tight(OffsetScene& scene, Family family, float plane, float clearance, float share)
{
    const std::vector<float> offsets = scene.offsets(plane);
    ASSERT_GE(offsets.size(), 2U);
    for (const bool left : {false, true}) {
        float innermost = left ? 1e9F : -1e9F;
        for (const float offset : offsets) {
            innermost = left ? (offset > 0.0F ? std::min(innermost, offset) : innermost)
                             : (offset < 0.0F ? std::max(innermost, offset) : innermost);
        }
        ASSERT_LT(std::abs(innermost), 1e8F) << "no offset on this side";
        EXPECT_GE(scene.margin({family, plane, innermost}), clearance) << innermost;
        EXPECT_LT(scene.margin({family, plane, share * innermost}), clearance + 1e-3F) << innermost;
    }
}

TEST(OffsetBorder, ASphereIsClearedAndByNoMoreThanItHasToBe)
{
    for (const Family family : {Family::simple, Family::symmetric, Family::smooth}) {
        for (const float radius : {1.0F, 3.0F}) {
            for (const float distance : {12.0F * radius, 30.0F * radius}) {
                OffsetScene scene(family, distance);
                scene.set_main(geometry::make_sphere(Vec3(distance, 0.0F, 50.0F), radius), radius);
                expect_tight(scene, family, 0.0F, 0.0F, 0.90F);
                expect_tight(scene, family, 0.5F * kPi, 0.0F, 0.90F);
            }
        }
    }
}

TEST(OffsetBorder, AWallIsClearedOnEitherSide)
{
    // Long across, long along before the collision point, or behind it; off the leg to one side.
    struct Wall {
        Vec3 centre;
        Vec3 half;
    };
    for (const Wall& wall : {Wall{Vec3(40.0F, 2.0F, 50.0F), Vec3(1.0F, 5.0F, 20.0F)},
                             Wall{Vec3(37.0F, 0.0F, 50.0F), Vec3(6.0F, 1.0F, 20.0F)},
                             Wall{Vec3(44.0F, -1.0F, 50.0F), Vec3(6.0F, 2.0F, 20.0F)},
                             Wall{Vec3(40.0F, 0.0F, 50.0F), Vec3(0.5F, 0.5F, 20.0F)}}) {
        for (const Family family : {Family::simple, Family::symmetric, Family::smooth}) {
            OffsetScene scene(family, 40.0F);
            scene.set_main(geometry::make_box(wall.centre, wall.half), wall.half.x());
            scene.problem.main_centre_offset = wall.centre - Vec3(40.0F, 0.0F, 50.0F);
            expect_tight(scene, family, 0.0F, 0.0F, 0.80F);
            scene.uncertainty = scene.problem.main_clearance = 1.5F;
            expect_tight(scene, family, 0.0F, 1.5F, 0.80F);
        }
    }
}

TEST(OffsetBorder, WhatIsHardlyInTheWayIsLeftAtTheLeastOffset)
{
    // A sphere far to the left: on the right there is nothing to clear, and a zero offset is no avoidance.
    OffsetScene scene(Family::symmetric, 40.0F);
    scene.set_main(geometry::make_sphere(Vec3(40.0F, 8.0F, 50.0F), 1.0F), 1.0F);
    scene.problem.main_centre_offset = Vec3(0.0F, 8.0F, 0.0F);
    const std::vector<float> offsets = scene.offsets(0.0F);
    ASSERT_EQ(offsets.size(), 4U);
    EXPECT_FLOAT_EQ(offsets[1], -0.3F);
    EXPECT_GT(offsets[2], 10.0F);
    // The fan ends at 3.2 R of the body, or one box width past the first where that is more.
    EXPECT_NEAR(offsets[0], -0.3F - (3.2F - 0.3F), 1e-4F);
    EXPECT_NEAR(offsets[3] - offsets[2], 2.0F, 1e-4F);
    // A threat there is cleared by the same amount as elsewhere.
    scene.problem.main_centre_offset = Vec3(0.0F, 1.75F, 0.0F);
    const std::vector<float> near = scene.offsets(0.0F);
    EXPECT_NEAR(near[1], -0.3F, 0.02F) << "R + 1 m - 1.75 m + 5 cm is as much";
}

TEST(OffsetBorder, OneOffsetOfASideIsTheInnermost)
{
    OffsetScene scene(Family::symmetric, 40.0F);
    scene.set_main(geometry::make_sphere(Vec3(40.0F, 0.0F, 50.0F), 1.0F), 1.0F);
    scene.settings.offsets = 4;
    const std::vector<float> four = scene.offsets(0.0F);
    ASSERT_EQ(four.size(), 4U);
    scene.settings.offsets = 2;
    const std::vector<float> two = scene.offsets(0.0F);
    ASSERT_EQ(two.size(), 2U);
    EXPECT_EQ(two[0], four[1]);
    EXPECT_EQ(two[1], four[2]);
    // Equal steps from the innermost to the outermost.
    scene.settings.offsets = 10;
    const std::vector<float> ten = scene.offsets(0.0F);
    ASSERT_EQ(ten.size(), 10U);
    EXPECT_EQ(ten[5], four[2]);
    EXPECT_EQ(ten[9], four[3]);
    for (std::size_t i = 6; i < 9; ++i) {
        EXPECT_NEAR(ten[i] - ten[i - 1], (ten[9] - ten[5]) / 4.0F, 1e-4F);
    }
}

TEST(OffsetBorder, NoOffsetIsBeyondItsShareOfTheDistanceAndOneOnItStays)
{
    // Widened spans reach 1.28 D; the last offset within it is kept, the first one beyond it is not.
    OffsetScene scene(Family::symmetric, 10.0F);
    scene.set_main(geometry::make_sphere(Vec3(10.0F, 0.0F, 50.0F), 1.0F), 1.0F);
    scene.problem.span_from = 0.0F;
    scene.settings.offsets = 2;
    const float widest = 1.2801F * 10.0F;
    // The only offset of a side is where the span begins to end.
    scene.problem.span_from = 1.0F;
    std::size_t kept = 0;
    std::size_t dropped = 0;
    for (int i = 0; i < 4000; ++i) {
        scene.problem.span_to = 5.0F + 1e-3F * static_cast<float>(i);
        const std::vector<float> offsets = scene.offsets(0.0F);
        for (const float offset : offsets) {
            EXPECT_LE(std::abs(offset), widest);
        }
        (offsets.size() == 2 ? kept : dropped) += 1;
        ASSERT_TRUE(offsets.size() == 2 || offsets.empty());
    }
    EXPECT_GT(kept, 0U);
    EXPECT_GT(dropped, 0U);
}

TEST(OffsetBorder, AnOffsetThatIsTheWidestToTheBitStays)
{
    OffsetScene scene(Family::symmetric, 10.0F);
    scene.set_main(geometry::make_sphere(Vec3(10.0F, 0.0F, 50.0F), 1.0F), 1.0F);
    scene.settings.offsets = 2;
    scene.problem.span_from = 1.0F;  // the only offset of a side is where the span ends
    const float widest = detail::kLargestRatio * scale_of(scene.problem);
    std::size_t met = 0;
    float last = 0.0F;
    for (float to = 2.0F; to < 12.0F && last <= widest; to += 1e-3F) {
        // From a thousandth below the border on, by the smallest steps there are.
        scene.problem.span_to = to;
        const std::vector<float> offsets = scene.offsets(0.0F);
        last = offsets.empty() ? widest + 1.0F : offsets[1];
        if (last < widest - 0.005F || last > widest) {
            continue;
        }
        for (int i = 0; i < 20'000; ++i) {
            const std::vector<float> next = scene.offsets(0.0F);
            if (next.empty()) {
                break;
            }
            met += next[1] == widest && next[0] == -widest ? 1U : 0U;
            scene.problem.span_to = std::nextafter(scene.problem.span_to, 100.0F);
        }
        break;
    }
    EXPECT_GT(met, 0U);
}

TEST(OffsetBorder, NearAndFarEndsOfACurveAreNotAskedToClear)
{
    // So near that the box is over the threat at the start, so long behind that the curve has ended: some offset all
    // the same, and never less than straight past would need.
    for (const Family family : {Family::simple, Family::symmetric, Family::smooth}) {
        for (const float along : {3.0F, 9.0F, 30.0F}) {
            OffsetScene scene(family, 10.0F);
            scene.set_main(geometry::make_box(Vec3(10.0F, 0.0F, 50.0F), Vec3(along, 0.5F, 20.0F)), 0.5F);
            const std::vector<float> offsets = scene.offsets(0.0F);
            ASSERT_GE(offsets.size(), 2U) << along;
            for (const float offset : offsets) {
                EXPECT_TRUE(std::isfinite(offset));
                EXPECT_GE(std::abs(offset), 1.5F);
                EXPECT_LE(std::abs(offset), 1.2801F * 10.0F);
            }
            if (along > 8.0F) {
                // Beyond the ends no offset clears: the offset for a third of the path is offered, three times 1.55 m.
                EXPECT_NEAR(offsets[offsets.size() / 2], 4.65F, 0.01F) << along;
            }
        }
    }
}

TEST(OffsetBorder, SourceOffsetsOnTheLimitAreKept)
{
    // 3.2 R + 6.4 R i / l with l = 32: offsets of 0.2 R steps; R + margin = 1.2 R exactly is kept.
    Scene scene;
    scene.settings = source_settings();
    scene.settings.simple = false;
    scene.settings.offsets = 32;
    scene.settings.extra_planes = 0;
    scene.settings.source_drop_margin = 0.2F;
    static_cast<void>(scene.run());
    EXPECT_EQ(scene.result.candidates.size(), 22U);  // 1.2, 1.4 ... 3.2 on either side
    scene.settings.source_drop_margin = 0.2001F;
    static_cast<void>(scene.run());
    EXPECT_EQ(scene.result.candidates.size(), 20U);
}

TEST(OffsetBorder, AnOffsetAtTheDropLimitIsKept)
{
    OffsetScene scene(Family::symmetric, 20.0F);
    scene.settings.offset_rule = OffsetRule::source;
    scene.settings.offsets = 16;
    const float third = 3.0F * (2.0F * 3.2F / 16.0F);  // 0.4 m apart for a radius of 1 m
    // The margin for which the limit, less the share kept for rounding, is that offset to the bit.
    const auto limit = [](float margin) { return (1.0F - 1e-5F) * (1.0F + margin); };
    float margin = third - 1.0F;
    while (limit(margin) < third) {
        margin = std::nextafter(margin, 1.0F);
    }
    ASSERT_EQ(limit(margin), third);
    scene.settings.source_drop_margin = margin;
    const std::vector<float> kept = scene.offsets(0.0F);
    EXPECT_EQ(std::count(kept.begin(), kept.end(), third), 1);
    scene.settings.source_drop_margin = margin + 1e-6F;
    const std::vector<float> dropped = scene.offsets(0.0F);
    EXPECT_EQ(dropped.size(), kept.size() - 2);
}

TEST(OffsetBorder, ASpheresWidthDoesNotDependOnHowFarAheadItIsNearest)
{
    const Vec3 half(0.4F, 0.4F, 0.2F);
    for (const Family family : {Family::simple, Family::symmetric, Family::smooth}) {
        OffsetScene scene(family, 20.0F);
        const auto smallest = [&](const Vec3& centre_offset) {
            scene.problem.main_centre_offset = centre_offset;
            return smallest_to_the_left(scene, family, half);
        };
        const float abeam = smallest(Vec3::Zero());
        for (const float ahead : {-6.0F, -0.7F, 0.7F, 6.0F}) {
            EXPECT_EQ(smallest(Vec3(ahead, 0.0F, 0.0F)), abeam) << ahead;
        }
    }
}

TEST(OffsetBorder, WhatReachesPastACurvesEndsIsClearedAThirdOfTheWay)
{
    // A wall from the collision point back beyond the start, or on beyond the curve's end: there the curve is on the
    // leg for any offset. The unit curve continues past its ends, and would be far out again there.
    constexpr float kDistance = 20.0F;
    const Vec3 half(0.4F, 0.4F, 0.2F);
    for (const Family family : {Family::simple, Family::symmetric, Family::smooth, Family::plateau}) {
        for (const float length : {1.2F, 2.0F, 3.0F, 5.6F}) {
            for (const float side : {-1.0F, 1.0F}) {
                OffsetScene scene(family, kDistance);
                const float reach = 0.5F * length * kDistance;
                scene.set_main(
                    geometry::make_box(Vec3(kDistance + side * reach, 0.0F, 50.0F), Vec3(reach, 2.0F, 20.0F)), 2.0F);
                const float smallest = smallest_to_the_left(scene, family, half);
                EXPECT_NEAR(smallest, 3.0F * (2.0F + 0.4F + detail::kClearingSlack), 1e-4F) << int(family) << length;
            }
        }
    }
}

}  // namespace
}  // namespace jink::geometric
