// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/separation.hpp"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/base/work_units.hpp"
#include "core/world/obstacle_distance.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

TEST(ThreatRadius, AddsBodyDoubtAndAcceleration)
{
    Scene scene;
    scene.own.sigma_position = 0.5F;
    Track& track = scene.track(Vec3(10, 0, 0), Vec3::Zero(), 2.0F);
    EXPECT_FLOAT_EQ(threat_radius(scene.situation(), track, 0.0F), 2.0F + 3.0F * 0.5F);
    track.sigma_position = 0.25F;
    track.sigma_velocity = 0.1F;
    track.max_acceleration = 0.2F;
    const float both = std::sqrt(0.5F * 0.5F + 0.25F * 0.25F);
    EXPECT_FLOAT_EQ(threat_radius(scene.situation(), track, 4.0F), 2.0F + 3.0F * (both + 0.4F) + 0.1F * 16.0F);
    track.stamp = scene.now - 2.0F;
    EXPECT_FLOAT_EQ(threat_radius(scene.situation(), track, 4.0F), 2.0F + 3.0F * (both + 0.6F) + 0.1F * 36.0F);
    track.stamp = scene.now + 1.0F;
    EXPECT_FLOAT_EQ(threat_radius(scene.situation(), track, 0.0F), 2.0F + 3.0F * both) << "no negative age";
    scene.rules.k_sigma = 0.0F;
    track.stamp = scene.now;
    EXPECT_FLOAT_EQ(threat_radius(scene.situation(), track, 4.0F), 2.0F + 0.1F * 16.0F);
}

TEST(LeastSeparation, NothingAnywhereIsTheCap)
{
    Scene scene;
    const Separation found = separation(scene, flight({Vec3::Zero(), Vec3(10, 0, 0)}, 2.0F));
    EXPECT_EQ(found.margin, kSeparationCap);
    EXPECT_EQ(found.against.kind, ThreatKind::none);
    scene.track(Vec3::Zero(), Vec3::Zero());
    EXPECT_EQ(separation(scene, {}).margin, kSeparationCap) << "an empty path goes nowhere";
}

std::uint32_t spent_on(const Scene& scene, const path::TimedPath& path)
{
    WorkBudget budget(kPlenty);
    static_cast<void>(least_separation(scene.situation(), path, 100.0F, budget));
    return budget.spent();
}

/// Every loop costs work units: each piece, bound, threat, chunk of pieces and part has its weight.
TEST(LeastSeparation, EachLoopIsPaidFor)
{
    const path::TimedPath path = flight({Vec3::Zero(), Vec3(1, 0, 0), Vec3(2, 0, 0)}, 1.0F);
    Scene scene;
    std::uint32_t spent = 1 + 3 * units::kPathPiece;  // one for the check itself
    EXPECT_EQ(spent_on(scene, path), spent);
    scene.airspace.has_ceiling = scene.airspace.has_floor = true;
    scene.airspace.floor = -20.0F;
    scene.airspace.ceiling = 20.0F;
    spent += 3 * 2 * units::kBoundPiece;
    EXPECT_EQ(spent_on(scene, path), spent);
    scene.track(Vec3(900, 0, 0), Vec3::Zero());
    scene.obstacle(geometry::make_sphere(Vec3(-900, 0, 0), 1.0F));
    scene.obstacle(geometry::make_box(Vec3(0, 900, 0), Vec3::Ones()));
    spent += 3 * (units::kThreat + units::kThreatChunk);
    EXPECT_EQ(spent_on(scene, path), spent) << "far away";
    scene.track(Vec3(1, 5, 0), Vec3::Zero());
    spent += units::kThreat + units::kThreatChunk + 2 * units::kThreatPiece + 2 * units::kSpherePart;
    EXPECT_EQ(spent_on(scene, path), spent) << "two pieces near";
    scene.tracks.back().sigma_velocity = 0.1F;
    EXPECT_EQ(spent_on(scene, path), spent + 6 * units::kSpherePart) << "four parts of each, while it grows";
}

TEST(LeastSeparation, LooksAtNothingWithoutABudget)
{
    const path::TimedPath path = flight({Vec3::Zero(), Vec3(1, 0, 0)}, 1.0F);
    WorkBudget less(2 * units::kPathPiece - 1);
    EXPECT_EQ(least_separation(Scene().situation(), path, 100.0F, less).margin, -kSeparationCap);
    EXPECT_TRUE(less.exhausted());
}

TEST(SeparationAt, ASpentBudgetIsContact)
{
    Scene scene;
    scene.track(Vec3(50, 0, 0), Vec3::Zero());
    scene.obstacle(geometry::make_sphere(Vec3(0, 50, 0), 1.0F));
    WorkBudget ample(kPlenty);
    ASSERT_GT(separation_at(scene.situation(), Vec3::Zero(), 0.0F, ample).margin, 40.0F);
    for (std::uint32_t n = 0; n < ample.spent(); ++n) {
        WorkBudget budget(n);
        ASSERT_LT(separation_at(scene.situation(), Vec3::Zero(), 0.0F, budget).margin, 0.0F) << n;
    }
}

TEST(LeastSeparation, HeadOnMeetsInTheMiddle)
{
    Scene scene;
    scene.track(Vec3(20, 0, 0), Vec3(-5, 0, 0), 1.5F);
    const Separation found = separation(scene, flight({Vec3::Zero(), Vec3(50, 0, 0)}, 10.0F));
    EXPECT_NEAR(found.margin, -1.5F, 1e-4F);
    EXPECT_NEAR(found.when, 1.9F, 1e-4F) << "first touch of the box: 19 m at 10 m/s";
    EXPECT_EQ(found.against, (ThreatRef{ThreatKind::track, 0}));
}

TEST(LeastSeparation, OnlyUpToTheHorizonAndToThePathsEnd)
{
    Scene scene;
    scene.track(Vec3(20, 0, 0), Vec3::Zero(), 1.0F);
    const path::TimedPath path = flight({Vec3::Zero(), Vec3(20, 0, 0)}, 4.0F);
    EXPECT_LT(separation(scene, path).margin, 0.0F);
    EXPECT_NEAR(separation(scene, path, 2.0F).margin, 8.0F, 1e-4F);
    EXPECT_NEAR(separation(scene, path, 0.0F).margin, 18.0F, 1e-4F);
    EXPECT_NEAR(separation(scene, flight({Vec3::Zero(), Vec3(10, 0, 0)}, 2.0F)).margin, 8.0F, 1e-4F);
    EXPECT_NEAR(separation(scene, flight({Vec3::Zero()}, 1.0F)).margin, 18.0F, 1e-4F) << "a single point is an instant";
}

/// The own uncertainty brings every contact forward.
TEST(LeastSeparation, OwnUncertaintyCountsTowardsEverything)
{
    using Place = void (*)(Scene&);
    const std::pair<ThreatKind, Place> places[] = {
        {ThreatKind::floor, [](Scene& s) { s.airspace.has_floor = true, s.airspace.floor = -10.0F; }},
        {ThreatKind::ceiling, [](Scene& s) { s.airspace.has_ceiling = true, s.airspace.ceiling = 10.0F; }},
        {ThreatKind::keep_in, [](Scene& s) { s.airspace.has_keep_in = true, s.airspace.keep_in_radius = 20.0F; }},
        {ThreatKind::track, [](Scene& s) { s.track(Vec3(5, 8, 0), Vec3::Zero(), 1.0F); }},
        {ThreatKind::obstacle, [](Scene& s) { s.obstacle(geometry::make_sphere(Vec3(5, 8, 0), 1.0F)); }},
        {ThreatKind::obstacle, [](Scene& s) { s.obstacle(geometry::make_box(Vec3(5, 6, 0), Vec3(2, 2, 2))); }},
    };
    const path::TimedPath path = flight({Vec3::Zero(), Vec3(10, 0, 0)}, 2.0F);
    for (const auto& [kind, place] : places) {
        Scene scene;
        place(scene);
        const Separation sure = separation(scene, path);
        scene.own.sigma_position = 0.5F;  // 1.5 m at three standard deviations
        EXPECT_EQ(sure.against.kind, kind);
        EXPECT_NEAR(separation(scene, path).margin, sure.margin - 1.5F, 1e-5F) << static_cast<int>(kind);
        WorkBudget budget(kPlenty);
        const Vec3 end(10, 0, 0);
        const float there = separation_at(scene.situation(), end, 2.0F, budget).margin;
        scene.own.sigma_position = 0.0F;
        EXPECT_NEAR(there, separation_at(scene.situation(), end, 2.0F, budget).margin - 1.5F,
                    2.0F * kObstacleResolution)
            << static_cast<int>(kind);
    }
}

/// A share of the uncertainty is the same as that share of the standard deviations, but for the own vehicle's towards
/// obstacles.
TEST(LeastSeparation, AShareOfTheUncertaintyIsThatShareOfTheDeviations)
{
    Random random(20261126);
    int apart = 0;
    for (int i = 0; i < 500; ++i) {
        Scene scene;
        scene.rules.k_sigma = 3.0F;
        const Vec3 velocity(random.uniform(-6.0F, 6.0F), random.uniform(-6.0F, 6.0F), random.uniform(-2.0F, 2.0F));
        const Vec3 meets(random.uniform(0.0F, 20.0F), random.uniform(-4.0F, 4.0F), random.uniform(-4.0F, 4.0F));
        Track& track = scene.track(meets - 2.0F * velocity, velocity, random.uniform(0.3F, 2.0F));
        track.sigma_position = random.uniform(0.0F, 1.0F);
        track.sigma_velocity = random.uniform(0.0F, 0.5F);
        track.half_height = random.below(2) == 0 ? 0.0F : 1.0F;
        const path::TimedPath path = flight({Vec3::Zero(), Vec3(10, 1, 0), Vec3(20, 0, 1)}, 2.0F);
        const float share = random.uniform(0.0F, 1.0F);
        const Cutoff cutoff{-kSeparationCap, kSeparationCap, {}, share};
        WorkBudget budget(kPlenty);
        const EscapeRule escape{};
        const float shared = least_separation(scene.situation(), path, 10.0F, budget, escape, cutoff).margin;
        const float whole = least_separation(scene.situation(), path, 10.0F, budget, escape).margin;
        scene.rules.k_sigma *= share;
        const float fewer = least_separation(scene.situation(), path, 10.0F, budget, escape).margin;
        EXPECT_NEAR(shared, fewer, 1e-4F) << i;
        EXPECT_GE(shared, whole - 1e-4F) << i;
        apart += shared > whole + 0.1F ? 1 : 0;
    }
    EXPECT_GT(apart, 100);
}

/// Of an obstacle its own uncertainty counts by its share, and the own vehicle's as it is.
TEST(LeastSeparation, AShareOfAnObstaclesUncertainty)
{
    for (const bool is_box : {false, true}) {
        Scene scene;
        scene.obstacle(is_box ? geometry::make_box(Vec3(5, 9, 0), Vec3(2, 2, 2))
                              : geometry::make_sphere(Vec3(5, 9, 0), 2.0F));
        const path::TimedPath path = flight({Vec3::Zero(), Vec3(10, 0, 0)}, 2.0F);
        const float sure = separation(scene, path).margin;
        scene.obstacles.back().uncertainty = 2.0F;
        scene.own.sigma_position = 0.5F;
        WorkBudget budget(kPlenty);
        const Cutoff half{-kSeparationCap, kSeparationCap, {}, 0.5F};
        const float shared = least_separation(scene.situation(), path, 2.0F, budget, {}, half).margin;
        EXPECT_NEAR(shared, sure - 1.0F - 1.5F, 2.0F * kObstacleResolution) << is_box;
    }
}

TEST(LeastSeparation, NamesWhatItIsMeasuredAgainst)
{
    Scene scene;
    scene.airspace.has_floor = true;
    scene.airspace.floor = -10.0F;
    const path::TimedPath path = flight({Vec3::Zero(), Vec3(10, 0, 0)}, 2.0F);
    EXPECT_EQ(separation(scene, path).against.kind, ThreatKind::floor);
    EXPECT_NEAR(separation(scene, path).margin, 9.0F, 1e-5F);
    scene.airspace.has_ceiling = true;
    scene.airspace.ceiling = 5.0F;
    EXPECT_EQ(separation(scene, path).against.kind, ThreatKind::ceiling);
    scene.airspace.has_keep_in = true;
    scene.airspace.keep_in_radius = 12.0F;
    EXPECT_EQ(separation(scene, path).against.kind, ThreatKind::keep_in);
    EXPECT_NEAR(separation(scene, path).margin, 2.0F - std::sqrt(2.0F), 1e-5F);
    EXPECT_NEAR(separation(scene, path).when, 2.0F, 1e-5F);
    scene.obstacle(geometry::make_sphere(Vec3(50, 0, 0), 1.0F));
    scene.obstacle(geometry::make_sphere(Vec3(5, 2.2F, 0), 1.0F));
    EXPECT_EQ(separation(scene, path).against, (ThreatRef{ThreatKind::obstacle, 1}));
    EXPECT_NEAR(separation(scene, path).margin, 0.2F, 1e-5F);
}

// --- the escape rule
// ---------------------------------------------------------------------------------------------------------

TEST(ObstacleMargin, OfALeaningMastIsThatOfItsTop)
{
    const float reach = 300.0F;
    const Vec3 axis(0.0009F, 0, 1.0F);
    const geometry::Shape mast = geometry::make_capsule(-axis * reach, axis * reach, 0.5F);
    WorkBudget budget(kPlenty);
    // At its top the axis is 0.27 m off.
    const float margin = obstacle_margin(Vec3::Ones(), Vec3(5, 0, 295), Vec3(5, 0, 295), mast, budget);
    const float truth = 5.0F - 1.0F - 0.5F - 0.0009F * 296.0F;
    EXPECT_LE(margin, truth + 1e-4F);
    EXPECT_GE(margin, truth - 2e-3F);
}

TEST(ObstacleMargin, ASpentBudgetIsContact)
{
    for (const geometry::Shape& shape :
         {geometry::make_box(Vec3::Zero(), Vec3::Ones()), geometry::make_sphere(Vec3::Zero(), 1.0F)}) {
        WorkBudget none(0);
        EXPECT_LT(obstacle_margin(Vec3::Ones(), Vec3(5, 0, 0), Vec3(6, 0, 0), shape, none), 0.0F);
        EXPECT_TRUE(none.exhausted());
    }
    WorkBudget exact(units::kSphereQuery);
    EXPECT_GT(
        obstacle_margin(Vec3::Ones(), Vec3(5, 0, 0), Vec3(6, 0, 0), geometry::make_sphere(Vec3::Zero(), 1.0F), exact),
        0.0F);
    EXPECT_EQ(exact.left(), 0U);
}

}  // namespace
}  // namespace jink::world
