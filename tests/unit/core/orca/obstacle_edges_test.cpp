// SPDX-License-Identifier: BSD-3-Clause
// Obstacles: range of the check, effect of the cap for obstacles without a half-space, and positions of single ones.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/base/random.hpp"
#include "core/orca/obstacle_plane.hpp"
#include "core/orca/obstacle_view.hpp"
#include "tests/oracle/hull_obstacles.hpp"
#include "tests/oracle/obstacle_threats.hpp"

namespace jink::orca {
namespace {

constexpr std::uint32_t kAllWork = 10'000'000;

Vec3 some_direction(Random& random)
{
    Vec3 out;
    do {
        out = {random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F)};
    } while (out.norm() < 0.1F || out.norm() > 1.0F);
    return out.normalized();
}

ObstacleSettings some_settings(Random& random)
{
    ObstacleSettings s;
    s.vertical = random.uniform(0.3F, 2.0F);
    s.horizontal = s.vertical * random.uniform(0.5F, 4.0F);
    s.horizon = random.uniform(0.3F, 4.0F);
    s.braking = random.below(4) == 0 ? 0.0F : random.uniform(0.2F, 5.0F);
    s.delay = random.uniform(0.0F, 1.0F);
    return s;
}

world::Obstacle sphere_at(const Vec3& centre, float radius) { return {0, geometry::make_sphere(centre, radius)}; }

/// Obstacles beyond the reach give no half-space that an admitted velocity could violate.
TEST(ObstacleEdges, BeyondTheReachNothingBinds)
{
    Random random(20261124);
    for (int i = 0; i < 20000; ++i) {
        const ObstacleSettings settings = some_settings(random);
        const Envelope envelope = envelope_of(settings);
        OwnMotion own;
        own.reach_speed = random.uniform(0.0F, 10.0F);
        own.velocity = random.uniform(0.0F, 12.0F) * some_direction(random);
        const float reach = obstacle_reach(envelope, own, settings);
        const HalfSpace plane =
            obstacle_half_space(reach * 1.0001F + 1e-4F, some_direction(random), envelope, own, settings);
        ASSERT_LE(plane.offset, -own.reach_speed * 0.9999F) << "case " << i;
    }
    // And no farther, for a case computed by hand: 2.4 s at 2 m/s.
    ObstacleSettings round;
    round.vertical = round.horizontal;
    OwnMotion two;
    two.reach_speed = 2.0F;
    EXPECT_FLOAT_EQ(obstacle_reach(envelope_of(round), two, round), 1.1F + 4.8F);
    round.braking = 0.25F;
    round.delay = 0.5F;
    EXPECT_FLOAT_EQ(obstacle_reach(envelope_of(round), two, round), 1.1F + 8.0F + 1.0F) << "braking and the delay";
    two.velocity = {0, 3, 0};
    EXPECT_FLOAT_EQ(obstacle_reach(envelope_of(round), two, round), 1.1F + 8.0F + 1.5F) << "as fast as it is";
}

/// Who flies off from an obstacle is let go back no faster than who hovers there.
TEST(ObstacleEdges, FlyingOffGainsNoSpeedTowardsIt)
{
    ObstacleSettings settings;
    settings.vertical = settings.horizontal;
    settings.horizon = 0.1F;
    settings.braking = 0.5F;
    settings.delay = 1.0F;
    const Envelope envelope = envelope_of(settings);
    OwnMotion own;
    const float hovering = obstacle_half_space(1.6F, Vec3::UnitX(), envelope, own, settings).offset;
    EXPECT_NEAR(hovering, -std::sqrt(2.0F * 0.5F * 0.5F), 1e-5F);
    own.velocity = {-2, 0, 0};
    EXPECT_EQ(obstacle_half_space(1.6F, Vec3::UnitX(), envelope, own, settings).offset, hovering);
    own.velocity = {0.25F, 5, 0};
    EXPECT_NEAR(obstacle_half_space(1.6F, Vec3::UnitX(), envelope, own, settings).offset,
                -std::sqrt(2.0F * 0.5F * 0.25F), 1e-5F)
        << "towards it a quarter of a metre is lost to the delay";
    own.velocity = {1, 0, 0};
    EXPECT_EQ(obstacle_half_space(1.6F, Vec3::UnitX(), envelope, own, settings).offset, 0.0F) << "and no less than 0";
}

/// A cap for an unchecked obstacle satisfies the obstacle's half-space, at any position.
TEST(ObstacleEdges, TheCapKeepsToTheHalfSpaceThatIsMissing)
{
    Random random(7);
    int binding = 0;
    for (int i = 0; i < 3000; ++i) {
        const ObstacleSettings settings = some_settings(random);
        const Envelope envelope = envelope_of(settings);
        OwnMotion own;
        own.reach_speed = random.uniform(0.5F, 10.0F);
        own.velocity = random.uniform(0.0F, 5.0F) * some_direction(random);
        const Vec3 direction = some_direction(random);
        // In the stretched space at this distance, as a small sphere.
        const float distance = random.uniform(0.1F, 20.0F);
        const Vec3 centre(distance * direction.x(), distance * direction.y(),
                          distance * direction.z() / envelope.stretch);
        const world::Obstacle obstacle = sphere_at(centre, 1e-3F);
        WorkBudget none(0);
        const ObstaclePlanes found = obstacle_planes(oracle::threats_of({&obstacle, 1}), own, settings, none);
        if (!found.truncated) {
            continue;
        }
        const HalfSpace plane = obstacle_half_space(distance, direction, envelope, own, settings);
        ASSERT_GE(found.speed_cap, 0.0F);
        ASSERT_LE(found.speed_cap, std::max(-plane.offset, 0.0F) * 1.001F + 1e-3F) << "case " << i;
        binding += found.speed_cap > 0.0F ? 1 : 0;
    }
    EXPECT_GT(binding, 300);
}

TEST(ObstacleEdges, TheNearestOfWhatIsDroppedCounts)
{
    ObstacleSettings settings;
    settings.vertical = settings.horizontal;
    OwnMotion own;
    own.reach_speed = 5.0F;
    const auto cap = [&](const std::vector<world::Obstacle>& obstacles) {
        WorkBudget none(0);
        return obstacle_planes(oracle::threats_of(obstacles), own, settings, none).speed_cap;
    };
    const world::Obstacle near = sphere_at({4, 0, 0}, 0.5F);
    const world::Obstacle far = sphere_at({0, 9, 0}, 0.5F);
    EXPECT_NEAR(cap({near, far}), (3.5F - 1.1F) / 2.4F, 1e-3F);
    EXPECT_NEAR(cap({far, near}), (3.5F - 1.1F) / 2.4F, 1e-3F);
    EXPECT_EQ(cap({sphere_at({0.2F, 0, 0}, 0.5F)}), 0.0F) << "within it: standstill";
}

/// More than there are half-spaces for, in directions far from each other: those that are left out are the farthest,
/// and the nearest of them makes the cap.
TEST(ObstacleEdges, MoreThanThereIsRoomForLeaveTheNearest)
{
    ObstacleSettings settings;
    settings.vertical = settings.horizontal;
    OwnMotion own;
    own.reach_speed = 3.0F;
    constexpr std::size_t kExtra = 3;
    std::vector<world::Obstacle> obstacles;
    std::vector<std::vector<Vec3>> hulls;
    const auto distance_of = [](std::size_t i) { return 2.0F + 0.05F * static_cast<float>(i); };
    for (std::size_t i = 0; i < kMaxObstaclePlanes + kExtra; ++i) {
        // By the golden angle from pole to pole.
        const float z = 1.0F - (2.0F * static_cast<float>(i) + 1.0F) / static_cast<float>(kMaxObstaclePlanes + kExtra);
        const float angle = 2.3999632F * static_cast<float>(i);
        const float level = std::sqrt(1.0F - z * z);
        const Vec3 to(level * std::cos(angle), level * std::sin(angle), z);
        obstacles.push_back(sphere_at((distance_of(i) + 0.05F) * to, 0.05F));
        std::vector<Vec3> corners;
        for (int c = 0; c < 8; ++c) {
            corners.push_back((distance_of(i) + 0.05F) * to + 0.02F * Vec3((c & 1) != 0 ? 1.0F : -1.0F,
                                                                           (c & 2) != 0 ? 1.0F : -1.0F,
                                                                           (c & 4) != 0 ? 1.0F : -1.0F));
        }
        hulls.push_back(corners);
    }
    const float dropped = distance_of(kMaxObstaclePlanes) - 1.1F;
    for (int order = 0; order < 3; ++order) {
        std::vector<world::Obstacle> shuffled = obstacles;
        if (order == 1) {
            std::reverse(shuffled.begin(), shuffled.end());
        } else if (order == 2) {
            std::rotate(shuffled.begin(), shuffled.begin() + 7, shuffled.end());
        }
        WorkBudget budget(kAllWork);
        const ObstaclePlanes found = obstacle_planes(oracle::threats_of(shuffled), own, settings, budget);
        ASSERT_EQ(found.planes.size(), kMaxObstaclePlanes);
        EXPECT_TRUE(found.truncated);
        EXPECT_NEAR(found.speed_cap, dropped / 2.4F, 1e-3F) << order;
        EXPECT_NEAR(found.margin, 2.0F - 1.1F, 1e-3F);
        for (std::size_t k = 0; k < found.planes.size(); ++k) {
            EXPECT_NEAR(-found.planes[k].offset, (distance_of(k) - 1.1F) / 2.4F, 1e-3F) << "nearest first, " << k;
        }
    }
    // Hulls are chosen in the same way.
    const oracle::HullObstacles solids(hulls);
    WorkBudget budget(kAllWork);
    const ObstaclePlanes found = obstacle_planes(solids.threats(), own, settings, budget);
    ASSERT_EQ(found.planes.size(), kMaxObstaclePlanes);
    for (std::size_t k = 0; k < found.planes.size(); ++k) {
        EXPECT_EQ(found.planes[k].source, k);
    }
}

/// One that lies deep in an obstacle has a half-space that it cannot keep to at once: others stay.
TEST(ObstacleEdges, AHalfSpaceThatNothingKeepsToSaysNothingOfOthers)
{
    ObstacleSettings settings;
    settings.vertical = settings.horizontal;
    OwnMotion own;
    own.reach_speed = 0.1F;
    const std::vector<world::Obstacle> two{sphere_at({0.4F, 0, 0}, 0.1F), sphere_at({0, 1.3F, 0}, 0.1F)};
    WorkBudget budget(kAllWork);
    const ObstaclePlanes found = obstacle_planes(oracle::threats_of(two), own, settings, budget);
    EXPECT_EQ(found.planes.size(), 2U);
    EXPECT_TRUE(found.penetrating) << "also where the next one is clear";
    EXPECT_EQ(found.nearest, 0);
}

TEST(ObstacleEdges, SizesThatAreNoneAreRefused)
{
    ObstacleSettings s;
    s.horizontal = s.vertical = -1.0F;
    EXPECT_FALSE(is_valid(s)) << "their ratio is 1";
    s.vertical = 1.0F;
    s.horizontal = 0.5F;
    EXPECT_TRUE(is_valid(s));
    s.horizontal = 0.499F;
    EXPECT_FALSE(is_valid(s));
    s.horizontal = 4.0F;
    EXPECT_TRUE(is_valid(s));
    s.horizontal = 4.01F;
    EXPECT_FALSE(is_valid(s));
    for (float ObstacleSettings::*member :
         {&ObstacleSettings::horizontal, &ObstacleSettings::vertical, &ObstacleSettings::horizon,
          &ObstacleSettings::recovery_speed, &ObstacleSettings::recovery_time, &ObstacleSettings::braking,
          &ObstacleSettings::delay, &ObstacleSettings::resolution}) {
        for (const float bad :
             {-1.0F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
            ObstacleSettings changed;
            changed.*member = bad;
            EXPECT_FALSE(is_valid(changed)) << bad;
        }
    }
}

/// A lower bound, in every stretched space.
TEST(ObstacleSight, TheBoundIsNeverAboveTheDistance)
{
    const world::Obstacle obstacle = sphere_at({10, 0, 0}, 2.0F);
    for (const float stretch : {0.5F, 1.0F, 3.0F}) {
        const std::vector<world::Threat> threats = oracle::threats_of({&obstacle, 1});
        const Obstacles scene(threats);
        const detail::ObstacleView view{scene, {stretch, 1.0F}, 1e-4F};
        EXPECT_LE(view.obstacle_bound(0, Vec3::Zero()), 8.0F);
        EXPECT_LE(view.obstacle_bound(0, {10, 0, 10}), stretch * 8.0F) << stretch;
        EXPECT_EQ(view.obstacle_bound(0, {10, 0, 0}), 0.0F);
        WorkBudget budget(kAllWork);
        const detail::Sighting level = view.obstacle(0, Vec3::Zero(), 100.0F, budget);
        EXPECT_LE(level.distance, 8.0F);
        EXPECT_NEAR(level.distance, 8.0F, 2e-3F);
        EXPECT_GE(level.upper, 8.0F - 1e-4F);
        EXPECT_FALSE(level.bounded);
    }
    const std::vector<world::Threat> threats = oracle::threats_of({&obstacle, 1});
    const Obstacles scene(threats);
    const detail::ObstacleView view{scene, {1.0F, 1.0F}, 1e-4F};
    EXPECT_GT(view.obstacle_bound(0, Vec3::Zero()), 7.99F);
}

/// Within an obstacle the distance is negative, to the nearest surface, and the direction points outwards.
TEST(ObstacleSight, WithinAnObstacleTheWayOutIsSeen)
{
    const world::Obstacle box{0, geometry::make_box({0, 0, 0}, {5, 5, 5})};
    const std::vector<world::Threat> threats = oracle::threats_of({&box, 1});
    const Obstacles scene(threats);
    const detail::ObstacleView view{scene, {1.0F, 1.0F}, 1e-4F};
    WorkBudget budget(kAllWork);
    const detail::Sighting seen = view.obstacle(0, {4, 0, 0}, 100.0F, budget);
    EXPECT_NEAR(seen.distance, -1.0F, 1e-3F);
    EXPECT_EQ(seen.upper, 0.0F);
    EXPECT_NEAR((seen.direction - Vec3(-1, 0, 0)).norm(), 0.0F, 1e-3F);
    EXPECT_FALSE(seen.bounded);
    std::vector<Vec3> corners;
    for (int c = 0; c < 8; ++c) {
        corners.emplace_back((c & 1) != 0 ? 5.0F : -5.0F, (c & 2) != 0 ? 5.0F : -5.0F, (c & 4) != 0 ? 5.0F : -5.0F);
    }
    const oracle::HullObstacles hull({corners});
    const detail::Sighting piece =
        detail::ObstacleView{hull.threats(), {1.0F, 1.0F}, 1e-4F}.obstacle(0, {0, -4.5F, 0}, 100.0F, budget);
    EXPECT_NEAR(piece.distance, -0.5F, 1e-3F);
    EXPECT_EQ(piece.upper, 0.0F);
    EXPECT_NEAR((piece.direction - Vec3(0, 1, 0)).norm(), 0.0F, 1e-3F);
}

}  // namespace
}  // namespace jink::orca
