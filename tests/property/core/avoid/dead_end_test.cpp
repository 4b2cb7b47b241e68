// SPDX-License-Identifier: BSD-3-Clause
// Dead ends against the way back to the route in double precision: the route by its parts (route_oracle.hpp), the point
// abeam by search, the way in steps of millimetres against spheres and boxes.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/avoid/objective.hpp"
#include "tests/oracle/route_oracle.hpp"
#include "tests/property/core/geometry/oracle.hpp"
#include "tests/property/core/world/separation_oracle.hpp"

namespace jink::avoid {
namespace {

using geometry::oracle::case_count;
using geometry::oracle::seed_of;
using jink::oracle::TwinRoute;
using jink::oracle::Vec3d;
using world::test::Scene;

/// A way that comes this near to contact, either way, is not judged [m]: float coordinates, and the resolution of
/// distances from solids.
constexpr double kNear = 0.05;

/// Arc length abeam of `position` on the one segment of a route, or on all of a route of one.
double abeam(const TwinRoute& twin, const Vec3d& position)
{
    constexpr double kStep = 0.001;
    double best = 0.0;
    double least = 1e18;
    for (double s = 0.0; s <= twin.length(); s += kStep) {
        const double off = (twin.at(s) - position).squaredNorm();
        best = off < least ? s : best;
        least = std::min(off, least);
    }
    return best;
}

/// Least distance of the box that flies straight from `from` to `to` from a sphere or an upright box; 0 in contact.
double least_margin(const Scene& scene, const Vec3d& from, const Vec3d& to)
{
    const Vec3d half = scene.limits.half_extents.cast<double>();
    double least = 1e9;
    const double length = (to - from).norm();
    const int steps = 1 + static_cast<int>(length / 0.01);
    for (const world::Obstacle& obstacle : scene.obstacles) {
        const geometry::Shape& shape = obstacle.shape;
        const bool sphere = shape.kind == geometry::ShapeKind::sphere;
        const Vec3d grown = sphere ? half : Vec3d(half + shape.half.cast<double>());
        for (int i = 0; i <= steps; ++i) {
            const Vec3d at = from + (to - from) * (static_cast<double>(i) / steps);
            const double apart = world::oracle::point_box(shape.centre.cast<double>() - at, grown);
            least = std::min(least, apart - (sphere ? double(shape.radius) : 0.0));
        }
    }
    return least;
}

TEST(DeadEndLaw, OfRandomRoutesEndsAndObstacles)
{
    const std::uint64_t seed = seed_of(20261128);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t blocked = 0;
    std::size_t clear = 0;
    const auto within = [&](float most) {
        return Vec3(random.uniform(-most, most), random.uniform(-most, most), random.uniform(-most, most));
    };
    for (std::size_t n = 0; n < case_count(400); ++n) {
        // One segment: which one is abeam is another law (tests/property/core/path).
        TwinRoute twin;
        const Vec3 start(random.uniform(-200.0F, 200.0F), random.uniform(-200.0F, 200.0F),
                         random.uniform(20.0F, 60.0F));
        if (random.below(2) == 0) {
            ASSERT_TRUE(twin.leg(start, start + Vec3(random.uniform(5.0F, 80.0F), random.uniform(-40.0F, 40.0F), 0)));
        } else {
            const Vec3 centre = start + Vec3(0, random.uniform(15.0F, 60.0F), 0);
            ASSERT_TRUE(twin.arc(start, centre, Vec3::UnitZ(), random.uniform(0.3F, 2.5F)));
        }
        Scene scene;
        const float speed = random.uniform(1.0F, 8.0F);
        scene.reference = world::Reference(twin.route, speed);
        scene.rules.lookahead = random.uniform(1.0F, 12.0F);
        scene.limits.half_extents = Vec3(random.uniform(0.2F, 1.5F), random.uniform(0.2F, 1.5F), 0.4F);
        const double on = double(random.uniform(0.0F, 1.0F)) * twin.length();
        const Vec3 end = twin.at(on).cast<float>() + within(8.0F);
        const double ahead =
            std::min(abeam(twin, end.cast<double>()) + double(scene.rules.lookahead * speed), twin.length());
        const Vec3d target = twin.at(ahead);
        for (std::size_t i = 0, count = 1 + random.below(3); i < count; ++i) {
            const Vec3 beside = (end + random.uniform(-0.3F, 1.3F) * (target.cast<float>() - end)) + within(5.0F);
            scene.obstacle(random.below(2) == 0
                               ? geometry::make_sphere(beside, random.uniform(0.3F, 3.0F))
                               : geometry::make_box(beside, Vec3(0.3F, 0.3F, 0.3F) + within(2.0F).cwiseAbs()));
        }
        // Not from inside: there the escape rule judges.
        const double at_start = least_margin(scene, end.cast<double>(), end.cast<double>());
        const double margin = least_margin(scene, end.cast<double>(), target);
        if (at_start < kNear || (margin > 0.0 && margin < kNear)) {
            continue;
        }
        const std::vector<path::PathPoint> flown{{start, Vec3::Zero(), 0.0F}, {end, Vec3::Zero(), 4.0F}};
        WorkBudget budget(world::test::kPlenty);
        const ManoeuvreCost cost = cost_of(scene.situation(), {}, flown, {1.0F, 0.0F, {}}, budget);
        // How deep a contact is, is not known of a box: the same with a vehicle that is smaller.
        Scene smaller = scene;
        smaller.limits.half_extents -= Vec3::Constant(float(kNear));
        if (margin <= 0.0 && least_margin(smaller, end.cast<double>(), target) > 0.0) {
            continue;
        }
        (margin > 0.0 ? clear : blocked) += 1;
        ASSERT_EQ(cost.dead_end, margin > 0.0 ? 0.0F : 6.0F) << "case " << n << ", margin " << margin;
    }
    std::printf("[ measured ] %zu blocked, %zu clear\n", blocked, clear);
    EXPECT_GT(blocked, case_count(400) / 8);
    EXPECT_GT(clear, case_count(400) / 8);
}

}  // namespace
}  // namespace jink::avoid
