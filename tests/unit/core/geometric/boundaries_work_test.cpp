// SPDX-License-Identifier: BSD-3-Clause
// Too few work units remove answers and never change them: an unfinished check is not clear.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "core/base/work_units.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

/// With every share of work up to the needed one: the same choice, or none.
void expect_same_or_none(Scene scene, std::uint32_t step)
{
    scene.settings.evaluate_all = false;
    scene.settings.check_units = 1'000'000;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    const std::size_t chosen = scene.result.chosen;
    std::size_t hits = 0;
    for (const Candidate& c : scene.result.candidates) {
        hits += c.status == CandidateStatus::hits_static || c.status == CandidateStatus::hits_moving ? 1U : 0U;
    }
    ASSERT_GT(hits, 0U) << "something cheaper has to be in the way of something";
    std::size_t found = 0;
    std::size_t none = 0;
    for (std::uint32_t units = 0; units < 3'000; units += step) {
        scene.settings.check_units = units;
        scene.budget = WorkBudget{1'000'000};
        const PlanStatus status = scene.run();
        if (status == PlanStatus::found) {
            ASSERT_EQ(scene.result.chosen, chosen) << units;
            ++found;
        } else {
            ASSERT_EQ(status, PlanStatus::none_available) << units;
            ASSERT_TRUE(scene.result.cut_short) << units;
            ++none;
        }
    }
    EXPECT_GT(found, 0U);
    EXPECT_GT(none, 0U);
}

Scene flat()
{
    Scene scene;
    scene.settings.simple = false;
    scene.settings.offsets = 8;
    return scene;
}

TEST(WorkBorder, SpheresThatStandInTheWay)
{
    for (const bool verify : {false, true}) {
        Scene scene = flat();
        scene.settings.verify_flight = verify;
        scene.threats.push_back(Scene::still(Vec3(20.0F, -4.0F, 50.0F), 2.0F));
        scene.threats.push_back(Scene::still(Vec3(22.0F, 4.0F, 50.0F), 1.5F));
        expect_same_or_none(scene, 3);
        for (int i = 0; i < 6; ++i) {
            scene.threats.push_back(Scene::still(Vec3(10.0F + 2.0F * static_cast<float>(i), 6.0F, 55.0F), 0.3F));
        }
        expect_same_or_none(scene, 3);
    }
}

TEST(WorkBorder, SpheresThatCross)
{
    for (const SecurityMode security : {SecurityMode::time_aware, SecurityMode::swept}) {
        for (const bool verify : {false, true}) {
            Scene scene = flat();
            scene.settings.verify_flight = verify;
            scene.settings.security = security;
            scene.settings.weights = {0.8F, 0.2F, 0.0F};  // close candidates are as cheap
            scene.settings.escape_from_margin = security == SecurityMode::time_aware;
            scene.threats.push_back({{Vec3(20.0F, -12.0F, 50.0F), Vec3(0.0F, 2.0F, 0.0F)}, 1.5F});
            scene.threats.push_back({{Vec3(20.0F, 12.0F, 50.0F), Vec3(0.0F, -2.0F, 0.0F)}, 1.5F});
            expect_same_or_none(scene, 3);
        }
    }
}

TEST(WorkBorder, SolidsInTheWay)
{
    const Mat3 axes = Eigen::AngleAxisf(0.6F, Vec3(1.0F, 2.0F, 0.3F).normalized()).toRotationMatrix();
    for (const bool verify : {false, true}) {
        Scene scene = flat();
        scene.settings.verify_flight = verify;
        scene.obstacles = {{1, geometry::make_box(Vec3(20.0F, -4.0F, 50.0F), Vec3(1.0F, 2.0F, 1.5F), axes)},
                           {2, geometry::make_cylinder(Vec3(18.0F, 3.0F, 49.0F), Vec3(21.0F, 5.0F, 51.0F), 1.0F)}};
        expect_same_or_none(scene, 7);
    }
}

TEST(WorkBorder, AStartInsideOfMargins)
{
    const Mat3 axes = Eigen::AngleAxisf(0.6F, Vec3(1.0F, 2.0F, 0.3F).normalized()).toRotationMatrix();
    Scene scene = flat();
    scene.settings.verify_flight = false;
    scene.threats.push_back(Scene::still(Vec3(-1.2F, -1.0F, 50.0F), 0.6F));
    scene.threats.push_back(Scene::still(Vec3(20.0F, -4.0F, 50.0F), 2.0F));
    expect_same_or_none(scene, 3);
    scene.threats.erase(scene.threats.begin() + 1);
    scene.obstacles = {{1, geometry::make_box(Vec3(-1.6F, -1.0F, 50.0F), Vec3(1.0F, 0.5F, 0.7F), axes)}};
    expect_same_or_none(scene, 7);
}

/// Each threat that a run takes in.
constexpr std::uint32_t kTaken = units::kThreatValid + units::kCollected;

/// Units of a run of two symmetric level candidates, 9.6 m to either side, checked as curves.
std::uint32_t spent_on(const std::vector<world::Obstacle>& obstacles, bool escape)
{
    Scene scene = two_level_candidates(3.0F);
    scene.settings.escape_from_margin = escape;
    scene.settings.check_units = 1'000;
    scene.obstacles = obstacles;
    EXPECT_EQ(scene.run(), PlanStatus::found);
    EXPECT_EQ(scene.result.candidates.size(), 2U);
    return scene.budget.spent();
}

TEST(WorkBorder, ASolidCostsWhatItsPlaceSays)
{
    const std::uint32_t none = spent_on({}, true);
    const auto more = [&](const Vec3& at, bool escape) {
        return spent_on({{1, geometry::make_box(at, Vec3::Ones())}}, escape) - none;
    };
    // Out of reach, detected by a quick reject.
    EXPECT_EQ(more(Vec3(60.0F, 100.0F, 50.0F), true), kTaken);
    // Within the common reach of all candidates, but far from each, and from the start: one check each.
    const std::uint32_t beside = kTaken + 2 * units::kSolidCheck;
    EXPECT_EQ(more(Vec3(60.0F, 0.0F, 59.0F), true), beside);
    EXPECT_EQ(more(Vec3(60.0F, 0.0F, 59.0F), false), beside);
    // Beside the start: the escape rule asks how near.
    EXPECT_GT(more(Vec3(-2.6F, 0.0F, 50.0F), true), more(Vec3(-2.6F, 0.0F, 50.0F), false));
}

TEST(WorkBorder, ManySpheresOutOfACurvesReachCostALookEach)
{
    constexpr std::uint32_t kSpheres = 7;
    const auto spent = [](SecurityMode security, const Vec3& velocity) {
        Scene scene = two_level_candidates(3.0F);
        scene.settings.escape_from_margin = false;
        scene.settings.security = security;
        scene.settings.closeness_nearest = 1;
        // Within the common reach of both level candidates, and far above either.
        scene.threats.assign(kSpheres, {{Vec3(60.0F, 0.0F, 59.0F), velocity}, 0.1F});
        EXPECT_EQ(scene.run(), PlanStatus::found);
        return scene.budget.spent();
    };
    const std::uint32_t none = spent_on({}, false);
    constexpr std::uint32_t kPassed = kSpheres * (kTaken + 2 * units::kFarItem);
    for (const SecurityMode security : {SecurityMode::time_aware, SecurityMode::swept}) {
        // Volumes end with the longest candidate: both are made for that first.
        const std::uint32_t made = security == SecurityMode::swept ? 2 * 25 * units::kCandidatePoint : 0;
        EXPECT_EQ(spent(security, Vec3::Zero()), none + kPassed + made);
    }
    // Moving threats are also evaluated for closeness, at most one here.
    const std::uint32_t costed = 2 * units::closeness_units(25, 1);
    EXPECT_EQ(spent(SecurityMode::time_aware, Vec3(0.0F, 0.0F, 0.01F)), none + kPassed + costed);
    EXPECT_GT(spent(SecurityMode::swept, Vec3(0.0F, 0.0F, 0.01F)), none + kPassed + costed);
}

}  // namespace
}  // namespace jink::geometric
