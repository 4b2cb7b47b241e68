// SPDX-License-Identifier: BSD-3-Clause
// The region considered for all candidates together: the last one still flying, the widest, the slowest.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/cost/cost.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

/// Curves alone, checked as such, without threats.
struct CurveScene : Scene {
    explicit CurveScene(Family family)
    {
        settings.simple = family == Family::simple;
        settings.symmetric = family == Family::symmetric;
        settings.smooth = family == Family::smooth;
        settings.plateau = family == Family::plateau;
        settings.check_acceleration = settings.verify_flight = false;
        threats.clear();
        problem.main = kNoThreat;
    }
    path::TimedPath path_of(std::size_t candidate) const
    {
        path::TimedPath path;
        EXPECT_TRUE(make_candidate_path(problem, result.candidates[candidate].shape, settings.waypoints, limits, path));
        return path;
    }
};

/// A threat at a candidate's end at its end time is in contact, from any initial distance.
void expect_ends_in_sight(CurveScene& scene)
{
    ASSERT_EQ(scene.run(), PlanStatus::found);
    const std::size_t count = scene.result.candidates.size();
    ASSERT_GT(count, 0U);
    for (std::size_t i = 0; i < count; ++i) {
        scene.threats.clear();
        ASSERT_EQ(scene.run(), PlanStatus::found);
        const path::TimedPath path = scene.path_of(i);
        const Seconds then = path.duration() - 0.02F;
        for (const Vec3& velocity : {Vec3(6.0F, 0.0F, 0.0F), Vec3(0.0F, 6.0F, 0.0F), Vec3(0.0F, 0.0F, -6.0F)}) {
            scene.threats = {{{path::sample(path, then).position - then * velocity, velocity}, 0.1F}};
            static_cast<void>(scene.run());
            ASSERT_EQ(scene.result.candidates[i].status, CandidateStatus::hits_moving) << i << " of " << count;
        }
    }
}

TEST(ReachBorder, EveryCandidateIsWatchedToItsEnd)
{
    for (const Family family : kCurves) {
        CurveScene scene(family);
        expect_ends_in_sight(scene);
        CurveScene slow(family);
        slow.problem.speed = 0.8F;
        expect_ends_in_sight(slow);
        CurveScene climbing(family);
        climbing.limits.max_climb = 0.4F;
        expect_ends_in_sight(climbing);
        CurveScene sinking(family);
        sinking.limits.max_descent = 0.2F;
        sinking.limits.max_climb = 20.0F;
        expect_ends_in_sight(sinking);
        // Wide for its length, and everything as fast.
        CurveScene wide(family);
        wide.problem.main_radius = 7.0F;
        wide.limits.max_climb = wide.limits.max_descent = 5.0F;
        expect_ends_in_sight(wide);
    }
}

TEST(ReachBorder, TheWidestCandidateIsWatchedOnWhicheverSideItIs)
{
    for (const float side : {-1.0F, 1.0F}) {
        for (const Family family : kCurves) {
            CurveScene scene(family);
            scene.settings.extra_planes = 0;
            // The main threat's centre lies to one side, so that there the offsets are larger.
            scene.problem.main_centre_offset = Vec3(0.0F, 4.0F * side, 0.0F);
            ASSERT_EQ(scene.run(), PlanStatus::found);
            const auto& c = scene.result.candidates;
            const std::size_t i = side < 0.0F ? 0 : c.size() - 1;
            for (const Candidate& other : c) {
                ASSERT_LE(std::abs(other.shape.offset), std::abs(c[i].shape.offset));
            }
            // A sphere beyond its apex that reaches into its box by a centimetre.
            const Vec3 apex(20.0F, c[i].shape.offset + 1.49F * side, 50.0F);
            scene.threats = {Scene::still(apex, 0.5F)};
            static_cast<void>(scene.run());
            EXPECT_EQ(scene.result.candidates[i].status, CandidateStatus::hits_static) << c[i].shape.offset;
        }
    }
}

TEST(ReachBorder, VolumesLastAsLongAsTheLongestCandidate)
{
    for (const SecurityMode security : {SecurityMode::time_aware, SecurityMode::swept}) {
        for (const cost::ClosenessMethod closeness :
             {cost::ClosenessMethod::time_aware, cost::ClosenessMethod::swept}) {
            CurveScene scene(Family::symmetric);
            scene.settings.simple = true;
            scene.settings.extra_planes = 0;
            scene.problem.main_centre_offset = Vec3(0.0F, -4.0F, 0.0F);  // the last ones, on the left, are the shortest
            scene.settings.security = security;
            scene.settings.closeness = closeness;
            ASSERT_EQ(scene.run(), PlanStatus::found);
            Seconds longest = 0.0F;
            for (const Candidate& c : scene.result.candidates) {
                longest = std::max(longest, c.duration);
            }
            ASSERT_LT(scene.result.candidates.back().duration, longest);
            // It flies over the leg, far enough above all, and on beyond their ends.
            scene.threats = {{{Vec3(20.0F, 0.0F, 75.0F), Vec3(4.0F, 0.0F, 0.0F)}, 1.0F}};
            ASSERT_EQ(scene.run(), PlanStatus::found);
            for (std::size_t i = 0; i < scene.result.candidates.size(); ++i) {
                path::TimedPath path = scene.path_of(i);
                for (path::PathPoint& point : path.points) {
                    point.position -= scene.problem.frame.origin;
                }
                const geometry::Motion threat{Vec3(20.0F, 0.0F, 25.0F), Vec3(4.0F, 0.0F, 0.0F)};
                const std::array<float, 1> one{cost::closeness(path, threat, 1.0F, closeness, longest)};
                ASSERT_FLOAT_EQ(scene.result.candidates[i].terms.closeness, cost::combined_closeness(one));
            }
            // It crosses the leg after 3 s, behind the vehicle: its swept volume blocks, the threat itself does not.
            scene.threats = {{{Vec3(4.0F, 18.0F, 50.0F), Vec3(0.0F, -6.0F, 0.0F)}, 0.5F}};
            static_cast<void>(scene.run());
            const bool hit = scene.count(CandidateStatus::hits_moving) == scene.result.candidates.size();
            EXPECT_EQ(hit, security == SecurityMode::swept);
        }
    }
}

TEST(ReachBorder, ThePlanesAngleToTheGroundIsReportedOfAnyLeg)
{
    for (const Vec3& direction : {Vec3(1.0F, 0.0F, 0.0F), Vec3(2.0F, 1.0F, 1.0F), Vec3(1.0F, 0.0F, -2.0F)}) {
        for (const float scale : {1.0F, 1.0004F}) {
            CurveScene scene(Family::symmetric);
            scene.problem.frame = make_path_frame(Vec3(0.0F, 0.0F, 50.0F), direction);
            scene.problem.frame.axes *= scale;
            ASSERT_EQ(scene.run(), PlanStatus::found);
            const Mat3& axes = scene.problem.frame.axes;
            for (const Candidate& c : scene.result.candidates) {
                // The normal of the plane that the leg and its side span, against the vertical.
                const Vec3 side = std::cos(c.shape.plane) * axes.col(1) + std::sin(c.shape.plane) * axes.col(2);
                const float level = axes(0, 0) * side.y() - axes(1, 0) * side.x();
                const float expected =
                    std::sqrt(std::max(0.0F, 1.0F - level * level / (scale * scale * scale * scale)));
                ASSERT_NEAR(c.sin_alpha, expected, 2e-3F);
                ASSERT_LE(c.sin_alpha, 1.0F);
            }
        }
    }
}

TEST(ReachBorder, OfMovingThreatsTheNearestSurfaceCountsFirst)
{
    // A small one near, a large one whose surface is nearer.
    Scene scene;
    scene.settings.verify_flight = false;
    const Sphere small{{Vec3(0.0F, 30.0F, 50.0F), Vec3(0.01F, 0.0F, 0.0F)}, 0.5F};
    const Sphere large{{Vec3(0.0F, -40.0F, 50.0F), Vec3(0.01F, 0.0F, 0.0F)}, 20.0F};
    scene.settings.closeness_nearest = 1;
    const auto closeness = [&](std::initializer_list<Sphere> threats) {
        scene.threats = {Scene::still(Vec3(20.0F, 0.0F, 50.0F), 1.0F)};
        scene.threats.insert(scene.threats.end(), threats);
        EXPECT_EQ(scene.run(), PlanStatus::found);
        return scene.result.candidates[2].terms.closeness;
    };
    scene.settings.simple = false;
    EXPECT_EQ(closeness({small, large}), closeness({large}));
    EXPECT_EQ(closeness({large, small}), closeness({large}));
    EXPECT_NE(closeness({large}), closeness({small}));
}

}  // namespace
}  // namespace jink::geometric
