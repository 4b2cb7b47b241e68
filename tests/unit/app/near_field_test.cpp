// SPDX-License-Identifier: BSD-3-Clause
// What is near, against points sampled on the solids and an own search over all things.
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

Shape any_shape(Random& random)
{
    const Vec3 a = any(random, 20.0F);
    const float radius = random.uniform(0.1F, 4.0F);
    const Vec3 axis = any(random, 1.0F).normalized();
    const Vec3 other = axis.unitOrthogonal();
    Mat3 axes;
    axes << other, axis.cross(other), axis;
    switch (random.below(4)) {
    case 0: return geometry::make_sphere(a, radius);
    case 1: return geometry::make_capsule(a, a + any(random, 6.0F), radius);
    case 2: return geometry::make_box(a, Vec3::Constant(0.1F) + any(random, 3.0F).cwiseAbs(), axes);
    default: return geometry::make_cylinder(a, a + axis * random.uniform(0.5F, 6.0F), radius);
    }
}

bool is_exact(const Shape& shape) { return shape.kind != geometry::ShapeKind::cylinder; }

TEST(NearField, NoPointOfASolidIsNearerThanTheNearest)
{
    Random random(11);
    for (int i = 0; i < 20'000; ++i) {
        const Shape shape = any_shape(random);
        const Vec3 from = any(random, 30.0F);
        const Vec3 nearest = nearest_point(shape, from);
        const float distance = (nearest - from).norm();
        // Along the way there nothing of the solid reaches beyond the nearest point, so none is nearer in this
        // direction; and in any other direction the solid's farthest point towards us is not nearer either.
        if (distance > 0.0F) {
            const Vec3 towards = (from - nearest) / distance;
            const float reach = (geometry::support(shape, towards) - from).dot(-towards);
            ASSERT_GE(reach, distance - 1e-3F);
            if (is_exact(shape)) {
                ASSERT_LE(reach, distance + 1e-3F) << "and the nearest point is of the solid";
            }
        }
    }
}

TEST(NearField, InsideIsNoDistance)
{
    Random random(12);
    for (int i = 0; i < 1000; ++i) {
        const Shape shape = any_shape(random);
        EXPECT_LE((nearest_point(shape, shape.centre) - shape.centre).norm(), 1e-5F);
    }
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
        std::vector<double> told;
        for (const link::NearObject& object : find_near(own, tracks, {}, k)) {
            told.push_back(static_cast<double>(object.distance));
        }
        std::sort(expected.begin(), expected.end());
        std::sort(told.begin(), told.end());
        ASSERT_EQ(told.size(), expected.size());
        for (std::size_t n = 0; n < told.size(); ++n) {
            ASSERT_NEAR(told[n], expected[n], 1e-3);
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

}  // namespace
}  // namespace jink::app
