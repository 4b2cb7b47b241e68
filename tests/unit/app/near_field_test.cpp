// SPDX-License-Identifier: BSD-3-Clause
// Near objects, against an independent search over all objects.
#include <numbers>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "firmware/app/near_field.hpp"

namespace jink::app {
namespace {

using geometry::Shape;

Vec3 any(Random& random, float size)
{
    return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

TEST(NearField, EachSectorTellsItsNearestAndNothingElse)
{
    Random random(13);
    for (int i = 0; i < 3000; ++i) {
        vehicle::VehicleState own;
        own.position = any(random, 100.0F);
        own.yaw = random.uniform(-10.0F, 10.0F);
        std::vector<world::Track> tracks(random.below(12));
        std::array<double, kNearSectors> nearest{};
        nearest.fill(50.0);
        const float k = random.uniform(0.0F, 4.0F);
        bool doubtful = false;
        for (world::Track& track : tracks) {
            track.position = own.position + any(random, 45.0F);
            track.radius = random.uniform(0.1F, 3.0F);
            track.sigma_position = random.uniform(0.0F, 2.0F);
            const Eigen::Vector3d off = (track.position - own.position).cast<double>();
            // Compass angle of the thing less that of the nose, in turns.
            const double nose = std::numbers::pi / 2.0 - static_cast<double>(own.yaw);
            double turns = (std::atan2(off.x(), off.y()) - nose) / (2.0 * std::numbers::pi);
            turns -= std::floor(turns);
            const double place = turns * 8.0 + 0.5;
            doubtful = doubtful || std::abs(place - std::round(place)) < 1e-4;
            double& best = nearest[static_cast<std::size_t>(place) % kNearSectors];
            best = std::min(best,
                            std::max(0.1, off.norm() - static_cast<double>(track.radius + k * track.sigma_position)));
        }
        if (doubtful) {
            continue;
        }
        std::vector<double> expected;
        std::copy_if(nearest.begin(), nearest.end(), std::back_inserter(expected), [](double d) { return d < 50.0; });
        std::vector<double> reported;
        for (const link::NearObject& object : find_near(own, tracks, {}, k)) {
            reported.push_back(static_cast<double>(object.distance));
        }
        std::sort(expected.begin(), expected.end());
        std::sort(reported.begin(), reported.end());
        ASSERT_EQ(reported.size(), expected.size());
        for (std::size_t n = 0; n < reported.size(); ++n) {
            ASSERT_NEAR(reported[n], expected[n], 1e-3);
        }
    }
}

TEST(NearField, AnglesAreThoseOfTheNose)
{
    vehicle::VehicleState own;  // nose east
    world::Obstacle o{1, geometry::make_sphere({0.0F, -10.0F, 10.0F}, 1.0F)};
    NearObjects found = find_near(own, {}, {&o, 1}, 3.0F);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0].yaw, 0.5F * kPi, 1e-5F) << "south is to the right";
    EXPECT_NEAR(found[0].pitch, 0.25F * kPi, 1e-5F) << "and it is above";
    EXPECT_NEAR(found[0].distance, std::sqrt(200.0F) - 1.0F, 1e-4F);
    o.shape = geometry::make_sphere({1.0F, 0.0F, 0.0F}, 5.0F);
    found = find_near(own, {}, {&o, 1}, 3.0F);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].distance, kNearLeast) << "inside: never 0, which may mean no reading";
    EXPECT_NEAR(found[0].yaw, 0.0F, 1e-5F);
    o.shape = geometry::make_sphere({kNearReach + 1.5F, 0.0F, 0.0F}, 1.0F);
    EXPECT_TRUE(find_near(own, {}, {&o, 1}, 3.0F).empty());
}

TEST(NearField, AnglesAgreeWithTheCompassForAnyNose)
{
    Random random(14);
    for (int i = 0; i < 2000; ++i) {
        vehicle::VehicleState own;
        own.position = any(random, 100.0F);
        own.yaw = random.uniform(-10.0F, 10.0F);
        world::Track track;
        const Vec3 off = any(random, 25.0F);
        track.position = own.position + off;
        track.radius = 0.1F;
        if (off.norm() < 1.0F || off.head<2>().norm() < 0.5F) {
            continue;
        }
        const NearObjects found = find_near(own, {&track, 1}, {}, 0.0F);
        ASSERT_EQ(found.size(), 1U);
        // Turned clockwise by the reported yaw, the nose points at it.
        const double nose = static_cast<double>(own.yaw) - static_cast<double>(found[0].yaw);
        const double level = std::hypot(static_cast<double>(off.x()), static_cast<double>(off.y()));
        ASSERT_NEAR(std::cos(nose), static_cast<double>(off.x()) / level, 1e-4) << i;
        ASSERT_NEAR(std::sin(nose), static_cast<double>(off.y()) / level, 1e-4) << i;
        ASSERT_NEAR(std::tan(static_cast<double>(found[0].pitch)), static_cast<double>(off.z()) / level, 1e-2) << i;
        ASSERT_LE(std::abs(found[0].yaw), kPi + 1e-4F);
        ASSERT_NEAR(found[0].distance, off.norm() - 0.1F, 1e-3F);
    }
}

TEST(NearField, TrafficOfUncertainHeightIsAsNearAsItMayBe)
{
    vehicle::VehicleState own;
    own.position = Vec3(0.0F, 0.0F, 50.0F);
    world::Track track;
    track.position = Vec3(20.0F, 0.0F, 80.0F);
    track.radius = 1.0F;
    track.half_height = 40.0F;
    NearObjects found = find_near(own, {&track, 1}, {}, 3.0F);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0].distance, 19.0F, 1e-4F) << "it may be at our height";
    EXPECT_NEAR(found[0].pitch, 0.0F, 1e-5F);
    track.half_height = 15.0F;
    found = find_near(own, {&track, 1}, {}, 3.0F);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0].distance, 24.0F, 1e-4F) << "20 m aside and 15 m above, less the body";
    EXPECT_NEAR(found[0].pitch, std::atan2(15.0F, 20.0F), 1e-5F);
}

TEST(NearField, UncertaintyAndBodyBringTrafficNearer)
{
    vehicle::VehicleState own;
    world::Track track;
    track.position = Vec3(0.0F, 30.0F, 0.0F);
    track.radius = 2.0F;
    track.sigma_position = 1.5F;
    EXPECT_NEAR(find_near(own, {&track, 1}, {}, 2.0F)[0].distance, 25.0F, 1e-4F);
    track.radius = 40.0F;
    EXPECT_EQ(find_near(own, {&track, 1}, {}, 2.0F)[0].distance, kNearLeast) << "within its body";
}

TEST(NearField, ObstacleThatHoldsTheVehicleLiesWhereItsCentreIs)
{
    vehicle::VehicleState own;
    for (const float side : {-1.0F, 1.0F}) {
        const world::Obstacle o{1, geometry::make_sphere({0.0F, side, 0.0F}, 5.0F)};
        const NearObjects found = find_near(own, {}, {&o, 1}, 3.0F);
        ASSERT_EQ(found.size(), 1U);
        EXPECT_EQ(found[0].distance, kNearLeast);
        EXPECT_NEAR(found[0].yaw, side * -0.5F * kPi, 1e-5F) << "left is counter-clockwise";
    }
}

TEST(NearField, NearestOfTracksAndObstaclesOfASectorIsReported)
{
    vehicle::VehicleState own;
    world::Track track;
    track.position = Vec3(20.0F, 0.0F, 0.0F);
    track.radius = 1.0F;
    for (const float range : {10.0F, 30.0F}) {
        const world::Obstacle o{1, geometry::make_sphere({range, 0.0F, 0.0F}, 1.0F)};
        const NearObjects found = find_near(own, {&track, 1}, {&o, 1}, 3.0F);
        ASSERT_EQ(found.size(), 1U);
        EXPECT_NEAR(found[0].distance, std::min(range, 20.0F) - 1.0F, 1e-4F);
    }
}

TEST(NearField, ReachEndsAtItsBoundAndTheLeastIsReported)
{
    vehicle::VehicleState own;
    const auto reported = [&](float surface) {
        const world::Obstacle o{1, geometry::make_sphere({surface + 1.0F, 0.0F, 0.0F}, 1.0F)};
        const NearObjects found = find_near(own, {}, {&o, 1}, 3.0F);
        return found.empty() ? -1.0F : found[0].distance;
    };
    EXPECT_EQ(reported(kNearReach), -1.0F);
    EXPECT_NEAR(reported(kNearReach - 0.01F), kNearReach - 0.01F, 1e-4F);
    EXPECT_EQ(reported(0.05F), kNearLeast);
    EXPECT_NEAR(reported(0.15F), 0.15F, 1e-5F);
}

TEST(NearField, PointOfNoSizeIsItself)
{
    const Vec3 at(4.0F, 5.0F, 6.0F);
    EXPECT_EQ(nearest_point(geometry::make_sphere(at, 0.0F), at), at);
    EXPECT_EQ(nearest_point(geometry::make_sphere(at, 0.0F), Vec3::Zero()), at);
}

TEST(NearField, WallIsReportedWhereItIsNearestNotWhereItsCentreIs)
{
    vehicle::VehicleState own;
    const world::Obstacle wall{1, geometry::make_box({10.0F, 40.0F, 0.0F}, {1.0F, 50.0F, 5.0F})};
    const NearObjects found = find_near(own, {}, {&wall, 1}, 3.0F);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0].distance, 9.0F, 1e-5F);
    EXPECT_NEAR(found[0].yaw, 0.0F, 1e-5F) << "straight ahead";
}

}  // namespace
}  // namespace jink::app
