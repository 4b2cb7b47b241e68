// SPDX-License-Identifier: BSD-3-Clause
// Contact of candidates at the limits: solids in exact contact, or overlapping by less than the quick rejects'
// tolerance; airspace used to the last number; exact ends of volumes; the cost of all checks.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/work_units.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;
using world::ThreatKind;

float just_below(float x) { return std::nextafter(x, -std::numeric_limits<float>::infinity()); }

const std::array kDirections{Vec3(1.0F, 0.0F, 0.0F),  Vec3(-1.0F, 0.0F, 0.0F), Vec3(0.0F, 1.0F, 0.0F),
                             Vec3(0.0F, -1.0F, 0.0F), Vec3(0.0F, 0.0F, 1.0F),  Vec3(0.0F, 0.0F, -1.0F)};

/// Straight candidates: all of them wait, along one of the world's axes, so that where they end is known exactly.
struct StraightScene : Scene {
    explicit StraightScene(const Vec3& direction)
    {
        settings.simple = settings.symmetric = false;
        settings.wait = true;
        settings.verify_flight = false;
        settings.escape_from_margin = false;
        threats.clear();
        problem.main = kNoThreat;
        problem.frame = make_path_frame(Vec3::Zero(), direction);
        problem.start_velocity = 5.0F * direction;
        airspace = {};
    }
    /// End of the cheapest candidate; static threats do not change which is cheapest.
    Vec3 end()
    {
        EXPECT_EQ(run(), PlanStatus::found);
        chosen = result.chosen;
        return result.path.points.back().position;
    }
    CandidateStatus status()
    {
        budget = WorkBudget(10'000'000);  // of this plan alone
        static_cast<void>(run());
        EXPECT_LT(chosen, result.candidates.size());
        return result.candidates[chosen].status;
    }
    std::size_t chosen = 0;
};

/// Spheres far beside the end, within reach of the candidates' common bounds or not: only their number matters.
void add_far_spheres(StraightScene& scene, const Vec3& end, std::size_t count)
{
    for (std::size_t i = 0; i < count; ++i) {
        scene.threats.push_back(Scene::still(end + 1.05F * end + Vec3::Constant(0.5F), 0.1F));
    }
}

TEST(ContactBorder, WhatIsTouchedByAHairAheadIsHit)
{
    // A sphere behind the end of the path, a tenth of a millimetre within the box's reach: no bound on the sum of all
    // lengths may skip it, for any direction of the leg and any number of other threats.
    for (const Vec3& direction : kDirections) {
        for (const std::size_t others : {std::size_t{0}, std::size_t{6}}) {
            for (const SecurityMode security : {SecurityMode::time_aware, SecurityMode::swept}) {
                StraightScene scene(direction);
                scene.settings.security = security;
                const Vec3 end = scene.end();
                add_far_spheres(scene, end, others);
                ASSERT_EQ(scene.status(), CandidateStatus::chosen) << others;
                scene.threats.push_back(Scene::still(end + (1.5F - 1e-4F) * direction, 0.5F));
                EXPECT_EQ(scene.status(), CandidateStatus::hits_static) << others;
                scene.threats.back().motion.position = end + (1.5F + 1e-3F) * direction;
                EXPECT_EQ(scene.status(), CandidateStatus::chosen) << others;
                // The same of an obstacle that no closed form knows.
                scene.threats.pop_back();
                const Vec3 half = Vec3::Constant(0.5F);
                scene.obstacles = {{1, geometry::make_box(end + (1.5F - 1e-4F) * direction, half)}};
                EXPECT_EQ(scene.status(), CandidateStatus::hits_static) << others;
                scene.obstacles = {{1, geometry::make_box(end + (1.5F + 1e-2F) * direction, half)}};
                EXPECT_EQ(scene.status(), CandidateStatus::chosen) << others;
            }
        }
    }
}

TEST(ContactBorder, WhatTouchesExactlyBesideTheWayIsHit)
{
    for (const Vec3& direction : kDirections) {
        const Vec3 aside(direction.y(), direction.z(), direction.x());
        for (const float side : {-1.0F, 1.0F}) {
            for (const SecurityMode security : {SecurityMode::time_aware, SecurityMode::swept}) {
                StraightScene scene(direction);
                scene.settings.security = security;
                static_cast<void>(scene.end());
                const Vec3 place = 15.0F * direction + side * 1.5F * aside;
                scene.threats = {Scene::still(place, 0.5F)};
                EXPECT_EQ(scene.status(), CandidateStatus::hits_static);
                // One that moves alongside the path, always in contact.
                scene.threats = {{{place, -0.25F * direction}, 0.5F}};
                EXPECT_EQ(scene.status(), CandidateStatus::hits_moving);
                scene.threats = {{{place + 1e-3F * side * aside, -0.25F * direction}, 0.5F}};
                EXPECT_NE(scene.status(), CandidateStatus::hits_moving);
                scene.threats.clear();
                scene.obstacles = {{1, geometry::make_box(place, Vec3::Constant(0.5F))}};
                EXPECT_EQ(scene.status(), CandidateStatus::hits_static);
                scene.obstacles.clear();
            }
        }
    }
}

TEST(ContactBorder, AClearanceOfObstaclesIsKeptInFullOfEveryKind)
{
    StraightScene scene(Vec3::UnitX());
    static_cast<void>(scene.end());
    for (const float clearance : {0.25F, 4.0F}) {
        scene.uncertainty = clearance;
        const Vec3 place(15.0F, 1.5F + clearance, 0.0F);
        for (const geometry::Shape& shape :
             {geometry::make_sphere(place, 0.5F), geometry::make_box(place, Vec3::Constant(0.5F)),
              geometry::make_cylinder(place - Vec3::UnitX(), place + Vec3::UnitX(), 0.5F)}) {
            scene.obstacles = {{1, shape}};
            EXPECT_EQ(scene.status(), CandidateStatus::hits_static) << int(shape.kind);
            scene.obstacles[0].shape.centre.y() += 1e-2F;
            EXPECT_EQ(scene.status(), CandidateStatus::chosen) << int(shape.kind);
        }
    }
}

TEST(ContactBorder, KeepInIsUsedUpToItsLastNumber)
{
    for (const Vec3& direction : {kDirections[0], kDirections[1], kDirections[2], kDirections[3]}) {
        for (const Vec3& home : {Vec3(0.0F, 0.0F, 0.0F), Vec3(-8.0F, 0.0F, 0.0F), Vec3(0.0F, -8.0F, 0.0F),
                                 Vec3(0.0F, 8.0F, 0.0F), Vec3(8.0F, 0.0F, 0.0F)}) {
            StraightScene scene(direction);
            scene.limits.half_extents = Vec3(3.0F, 4.0F, 1.0F);  // 5 m across, exactly
            const Vec3 end = scene.end();
            scene.airspace.has_keep_in = true;
            scene.airspace.home = home;
            const float x = end.x() - home.x();
            const float y = end.y() - home.y();
            const float farthest = std::max(std::sqrt(x * x + y * y), home.norm());
            scene.airspace.keep_in_radius = farthest + 5.01F;
            EXPECT_EQ(scene.status(), CandidateStatus::chosen) << home.x() << " " << home.y();
            scene.airspace.keep_in_radius = farthest + 4.99F;
            EXPECT_EQ(scene.status(), CandidateStatus::hits_airspace) << home.x() << " " << home.y();
            EXPECT_EQ(scene.result.candidates[scene.chosen].hit.kind, ThreatKind::keep_in);
        }
    }
    StraightScene scene(Vec3::UnitX());
    scene.limits.half_extents = Vec3(3.0F, 4.0F, 1.0F);
    const float end = scene.end().x();
    scene.airspace.has_keep_in = true;
    for (float radius = end + 5.0F; radius > end + 4.99F; radius = just_below(radius)) {
        scene.airspace.keep_in_radius = radius;
        ASSERT_EQ(scene.status() == CandidateStatus::chosen, radius - 5.0F >= end) << "no farther, and as far";
    }
}

TEST(ContactBorder, AStartOutsideOfTheAirspaceHasAWayIn)
{
    // Two metres beyond each bound, and a leg that comes back at once: the bound moves out to the start and returns at
    // the escape rule's speed.
    for (int bound = 0; bound < 3; ++bound) {
        const Vec3 back = bound == 0   ? Vec3(0.0F, 0.0F, 1.0F)
                          : bound == 1 ? Vec3(0.0F, 0.0F, -1.0F)
                                       : Vec3(-1.0F, 0.0F, 0.0F);
        for (const bool escape : {false, true}) {
            for (const float way : {1.0F, -1.0F}) {
                StraightScene scene(way * back);
                scene.settings.escape_from_margin = escape;
                scene.airspace.has_floor = bound == 0;
                scene.airspace.floor = -1.0F + 2.0F;
                scene.airspace.has_ceiling = bound == 1;
                scene.airspace.ceiling = 1.0F - 2.0F;
                scene.airspace.has_keep_in = bound == 2;
                scene.airspace.home = Vec3(-100.0F, 0.0F, 0.0F);
                scene.airspace.keep_in_radius = 100.0F + std::sqrt(2.0F) - 2.0F;
                EXPECT_EQ(scene.run() == PlanStatus::found, escape && way > 0.0F) << bound << " " << way;
            }
        }
    }
}

TEST(ContactBorder, TheMainThreatsVolumeEndsAtTheCollisionPointAndNotBeyondTheLongestCandidate)
{
    // Pinheiro's planner; symmetric candidates 1.6 m off the leg, level.
    const auto free = [](const Vec3& position, const Vec3& velocity) {
        Scene scene;
        scene.settings = source_settings();
        scene.settings.simple = false;
        scene.settings.extra_planes = 0;
        scene.threats = {{{position, velocity}, 1.0F}};
        static_cast<void>(scene.run());
        return scene.count(CandidateStatus::available) + scene.count(CandidateStatus::chosen);
    };
    // Its volume comes down from the left as far as the leg: 3.2 m on the right are beyond it, 1.6 m are not.
    ASSERT_EQ(free(Vec3(20.0F, 24.0F, 50.0F), Vec3(0.0F, -8.0F, 0.0F)), 1U);
    // It moves away from the collision point: the volume behind it does not count.
    EXPECT_EQ(free(Vec3(3.0F, 4.6F, 50.0F), Vec3(0.0F, 2.0F, 0.0F)), 4U);
    // It arrives in 16 s, after the vehicle has left.
    EXPECT_EQ(free(Vec3(3.0F, 8.0F, 50.0F), Vec3(0.0F, -0.5F, 0.0F)), 4U);
}

TEST(ContactBorder, ALookAtWhatIsFarCostsTheSameForEach)
{
    // Up to four spheres are checked singly, more of them first as a group.
    const auto spent = [](std::size_t spheres) {
        Scene scene = two_level_candidates(6.0F);
        for (std::size_t i = 0; i < spheres; ++i) {
            scene.threats.push_back(Scene::still(Vec3(60.0F, 0.0F, 50.0F + 18.0F), 0.5F));
        }
        EXPECT_EQ(scene.run(), PlanStatus::found);
        EXPECT_EQ(scene.result.candidates.size(), 2U);
        return scene.budget.spent();
    };
    const std::uint32_t none = spent(0);
    for (std::uint32_t n = 1; n <= 8; ++n) {
        const std::uint32_t each = n > 4 ? units::kFarItem : units::kItem;
        EXPECT_EQ(spent(n), none + n * (units::kThreatValid + units::kCollected + 2 * each)) << n;
    }
}

}  // namespace
}  // namespace jink::geometric
