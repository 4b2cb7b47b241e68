// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <iostream>

#include "core/orca/obstacle_plane.hpp"
#include "core/orca/obstacle_way.hpp"
#include "tests/oracle/hull_obstacles.hpp"
#include "tests/property/core/geometry/convex_oracle.hpp"

// Theorem 7.2.1: a velocity within all half-spaces has no contact with a convex piece within the horizon. Judged by
// distances in double precision (Wolfe's method) along the path.

namespace jink::orca {
namespace {

namespace go = geometry::oracle;
using go::Vec3d;

using Hulls = std::vector<std::vector<Vec3>>;

Hulls any_hulls(Random& random, std::size_t count, float room)
{
    Hulls hulls(count);
    for (auto& hull : hulls) {
        const Vec3 centre = go::in_cube(random, room);
        const float size = random.uniform(0.2F, 2.0F);
        hull.resize(random.below(4) == 0 ? 3 : 4 + random.below(28));
        for (Vec3& v : hull) {
            v = centre + go::in_cube(random, size);
        }
    }
    return hulls;
}

/// Least distance of the pieces from `point` in the space stretched by `stretch`, never above the truth by `tolerance`.
double true_distance(const Hulls& hulls, const Vec3d& point, double stretch, double beyond)
{
    double least = 1e300;
    for (const auto& hull : hulls) {
        const auto support = [&](const Vec3d& direction) -> Vec3d {
            Vec3d best = Vec3d::Zero();
            double most = -1e300;
            for (const Vec3& v : hull) {
                Vec3d w = v.cast<double>() - point;
                w.z() *= stretch;
                if (w.dot(direction) > most) {
                    most = w.dot(direction);
                    best = w;
                }
            }
            return best;
        };
        // A plane that keeps it off far enough spares the search.
        const Vec3d middle = support(Vec3d(1, 0, 0));
        if (middle.dot(support(-middle)) > std::min(least, beyond) * middle.norm()) {
            continue;
        }
        least = std::min(least, go::distance_from_origin(support, 1e-7).upper);
    }
    return least;
}

ObstacleSettings any_settings(Random& random)
{
    ObstacleSettings settings;
    settings.horizontal = random.uniform(0.2F, 1.5F);
    settings.vertical = settings.horizontal / random.uniform(0.5F, 4.0F);
    settings.horizon = random.uniform(0.5F, 4.0F);
    settings.covers_cylinder = random.below(4) == 0;
    if (random.below(4) == 0) {
        settings.braking = random.uniform(0.5F, 5.0F);
        settings.delay = random.uniform(0.0F, 0.5F);
    }
    return settings;
}

/// The velocity at which the envelope contacts the plane's obstacle at its nearest point at the end of the horizon.
Vec3 touching(const HalfSpace& plane, float stretch)
{
    const Vec3 towards = -plane.normal;
    const Vec3 along = Vec3(towards.x(), towards.y(), towards.z() / stretch).normalized();
    const Vec3 step(along.x(), along.y(), along.z() / stretch);
    return step * (-plane.offset / towards.dot(step)) * (1.0F - 1e-6F);
}

/// A velocity that all half-spaces and the cap admit, if a few trials find one: often one that comes to the border.
bool admitted(Random& random, const ObstaclePlanes& planes, float stretch, float speed, Vec3& velocity)
{
    const float most = std::min(speed, planes.speed_cap);
    for (int trial = 0; trial < 30; ++trial) {
        if (!planes.planes.empty() && random.below(2) == 0) {
            velocity = touching(planes.planes[random.below(planes.planes.size())], stretch);
        } else {
            velocity = go::in_cube(random, 1.0F);
            velocity *= most * random.uniform() / std::max(velocity.norm(), 1e-3F);
        }
        // Repeatedly onto the border of a violated half-space.
        for (int round = 0; round < 8; ++round) {
            for (const HalfSpace& plane : planes.planes) {
                velocity += std::max(0.0F, plane.violation(velocity)) * plane.normal;
            }
        }
        bool good = velocity.norm() <= most;
        for (const HalfSpace& plane : planes.planes) {
            good = good && plane.violation(velocity) <= 0.0F;
        }
        if (good) {
            return true;
        }
    }
    return false;
}

class Theorem : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(FewAndMany, Theorem, ::testing::Values(false, true));

TEST_P(Theorem, T4AdmittedVelocitiesMeetNothingWithinTheHorizon)
{
    Random random(go::seed_of(GetParam() ? 22 : 21));
    std::size_t flown = 0;
    std::size_t border = 0;
    std::size_t truncated = 0;
    for (std::size_t n = 0; n < go::case_count(GetParam() ? 60 : 300); ++n) {
        const Hulls hulls = any_hulls(random, GetParam() ? 60 : 1 + random.below(6), GetParam() ? 7.0F : 5.0F);
        const oracle::HullObstacles solids(hulls);
        const ObstacleSettings settings = any_settings(random);
        const Envelope envelope = envelope_of(settings);
        OwnMotion own;
        own.position = go::in_cube(random, 4.0F);
        own.velocity = go::in_cube(random, 2.0F);
        own.reach_speed = random.uniform(0.1F, 5.0F);
        WorkBudget budget(random.below(4) == 0 ? static_cast<std::uint32_t>(random.below(500)) : 1'000'000);
        const ObstaclePlanes planes = obstacle_planes(solids.threats(), own, settings, budget);
        truncated += planes.truncated ? 1 : 0;
        const double stretch = double(envelope.stretch);
        if (true_distance(hulls, own.position.cast<double>(), stretch, 1e9) < double(envelope.radius)) {
            continue;
        }
        Vec3 velocity;
        if (!admitted(random, planes, envelope.stretch, own.reach_speed, velocity)) {
            continue;
        }
        ++flown;
        constexpr int kSamples = 1000;
        double nearest = 1e300;
        for (int i = 0; i <= kSamples; ++i) {
            const double t = double(settings.horizon) * i / kSamples;
            const Vec3d point = own.position.cast<double>() + t * velocity.cast<double>();
            nearest = std::min(nearest, true_distance(hulls, point, stretch, double(envelope.radius) + 1e-3));
            ASSERT_GE(nearest, double(envelope.radius) - 2e-5) << "case " << n << " at " << t << " s";
        }
        border += nearest < double(envelope.radius) + 1e-3 ? 1 : 0;
        // The check along the path agrees.
        WorkBudget plenty(10'000'000);
        const WayClearance way =
            clearance_along(solids.threats(), own.position, 0.999F * velocity, settings.horizon, settings, plenty);
        ASSERT_TRUE(way.clear || way.clear_until > 0.99F * settings.horizon) << "case " << n;
    }
    std::cout << flown << " velocities flown, " << border << " to the border, " << truncated << " with a speed cap\n";
    EXPECT_GT(flown, go::case_count(GetParam() ? 60 : 300) / 5);
    EXPECT_GT(border, flown / 20);
    // Rare if the capacity suffices for all: below a tenth of the cases.
    EXPECT_TRUE(truncated > 0 || go::case_count(300) < 300);
}

/// A half-space forbids no more than its obstacle's margin over the horizon: the nearest point reached straight on.
TEST(Theorem, OneHalfSpaceIsTangentToWhatIsForbidden)
{
    Random random(go::seed_of(23));
    for (std::size_t n = 0; n < go::case_count(2'000); ++n) {
        const Hulls hulls = any_hulls(random, 1, 6.0F);
        const oracle::HullObstacles solids(hulls);
        const ObstacleSettings settings = [&] {
            ObstacleSettings s = any_settings(random);
            s.braking = 0.0F;
            return s;
        }();
        const Envelope envelope = envelope_of(settings);
        OwnMotion own;
        own.position = go::in_cube(random, 4.0F);
        own.reach_speed = 20.0F;
        WorkBudget budget(1'000'000);
        const ObstaclePlanes planes = obstacle_planes(solids.threats(), own, settings, budget);
        const double stretch = double(envelope.stretch);
        const double distance = true_distance(hulls, own.position.cast<double>(), stretch, 1e9);
        if (distance < double(envelope.radius) + 1e-3 || planes.planes.empty()) {
            continue;
        }
        // Fly along the stretched normal for the whole horizon at the bound: the envelope ends in contact.
        const HalfSpace& plane = planes.planes[0];
        const Vec3d end =
            own.position.cast<double>() + touching(plane, envelope.stretch).cast<double>() * double(settings.horizon);
        ASSERT_NEAR(true_distance(hulls, end, stretch, 1e9), double(envelope.radius), 4e-4 * (1.0 + distance))
            << "case " << n;
    }
}

/// Clear duration of a path, against small steps in double precision: never later than the first contact, and not much
/// earlier unless marked as a bound.
TEST(ClearanceAlong, EndsAtTheFirstContact)
{
    Random random(go::seed_of(24));
    std::size_t met = 0;
    std::size_t bounded = 0;
    std::size_t clear = 0;
    for (std::size_t n = 0; n < go::case_count(300); ++n) {
        const Hulls hulls = any_hulls(random, 1 + random.below(20), 6.0F);
        const oracle::HullObstacles solids(hulls);
        const ObstacleSettings settings = any_settings(random);
        const Envelope envelope = envelope_of(settings);
        const Vec3 position = go::in_cube(random, 6.0F);
        const Vec3 velocity = go::in_cube(random, 3.0F);
        const double stretch = double(envelope.stretch);
        if (true_distance(hulls, position.cast<double>(), stretch, 1e9) < double(envelope.radius) + 1e-3) {
            continue;
        }
        WorkBudget budget(1'000'000);
        const WayClearance way =
            clearance_along(solids.threats(), position, velocity, settings.horizon, settings, budget);
        constexpr int kSamples = 300;
        double contact = 1e300;
        for (int i = 0; i <= kSamples && contact > 1e299; ++i) {
            const double t = double(settings.horizon) * i / kSamples;
            const Vec3d point = position.cast<double>() + t * velocity.cast<double>();
            if (true_distance(hulls, point, stretch, double(envelope.radius)) < double(envelope.radius) - 2e-5) {
                contact = t;
            }
        }
        met += contact < 1e299 ? 1 : 0;
        bounded += way.bounded ? 1 : 0;
        clear += way.clear ? 1 : 0;
        ASSERT_LE(double(way.clear_until), std::min(contact, double(settings.horizon)) + 1e-4) << "case " << n;
        if (!way.clear && !way.bounded) {
            // At its end the envelope is nearly in contact.
            const Vec3d end = position.cast<double>() + double(way.clear_until) * velocity.cast<double>();
            ASSERT_LE(true_distance(hulls, end, stretch, 1e9), double(envelope.radius) + 1e-3) << "case " << n;
        }
    }
    std::cout << met << " contacts, " << clear << " clear, " << bounded << " bounded\n";
    EXPECT_GT(met, go::case_count(300) / 40);  // a sanitized run has a tenth of the cases
    EXPECT_GT(clear, go::case_count(300) / 10);
    EXPECT_LT(bounded, go::case_count(300) / 50 + 2);
}

/// Inside the margin, every preferred velocity gives a command out of the margin.
TEST(Theorem, RecoveryLeadsAway)
{
    Random random(go::seed_of(25));
    std::size_t inside = 0;
    for (std::size_t n = 0; n < go::case_count(2'000); ++n) {
        const Hulls hulls = any_hulls(random, 1, 1.0F);
        const oracle::HullObstacles solids(hulls);
        const ObstacleSettings settings = any_settings(random);
        const Envelope envelope = envelope_of(settings);
        const double stretch = double(envelope.stretch);
        OwnMotion own;
        own.position = go::in_cube(random, 2.0F);
        own.reach_speed = 5.0F;
        const double before = true_distance(hulls, own.position.cast<double>(), stretch, 1e9);
        if (before > double(envelope.radius) - 1e-3 || before < 1e-3) {
            inside += before < 1e-3 ? 1 : 0;
            continue;
        }
        WorkBudget budget(1'000'000);
        const ObstaclePlanes planes = obstacle_planes(solids.threats(), own, settings, budget);
        ASSERT_TRUE(planes.penetrating) << "case " << n;
        ASSERT_EQ(planes.planes.size(), 1U);
        ASSERT_GT(planes.planes[0].offset, 0.0F);
        Vec3 velocity = go::in_cube(random, 1.0F);
        velocity += std::max(0.0F, planes.planes[0].violation(velocity)) * planes.planes[0].normal;
        const Vec3d later = own.position.cast<double>() + 0.5 * velocity.cast<double>();
        ASSERT_GT(true_distance(hulls, later, stretch, 1e9), before) << "case " << n;
    }
    EXPECT_GT(inside, go::case_count(2'000) / 200);
}

}  // namespace
}  // namespace jink::orca
