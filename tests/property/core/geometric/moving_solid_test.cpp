// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include <Eigen/Geometry>

#include "core/geometric/planes.hpp"
#include "core/geometry/convex.hpp"
#include "tests/property/core/geometric/random_problem.hpp"

// Solids that move, against dense sampling in double; and the planes that part solids without a search.

namespace jink::geometric {
namespace {

using Vec3d = Eigen::Vector3d;

/// Distance of a point from a solid, in double.
double distance_of(const geometry::Shape& shape, const Vec3d& point)
{
    const Vec3d local = shape.axes.cast<double>().transpose() * (point - shape.centre.cast<double>());
    const Vec3d half = shape.half.cast<double>();
    const auto radius = static_cast<double>(shape.radius);
    const double along = std::max(std::abs(local.z()) - half.z(), 0.0);
    const double aside = std::hypot(local.x(), local.y());
    switch (shape.kind) {
    case geometry::ShapeKind::box: return (local.cwiseAbs() - half).cwiseMax(0.0).norm();
    case geometry::ShapeKind::capsule: return std::hypot(aside, along) - radius;
    case geometry::ShapeKind::cylinder: return std::hypot(std::max(aside - radius, 0.0), along);
    default: return local.norm() - radius;
    }
}

geometry::Shape random_moving_solid(Random& random, const Vec3& centre)
{
    const Vec3 arm = RandomProblem::vector(random, 4.0F) + Vec3(0.1F, 0.0F, 0.0F);
    switch (random.below(4)) {
    case 0:
        return geometry::make_box(
            centre, Vec3(random.uniform(0.2F, 4.0F), random.uniform(0.2F, 4.0F), random.uniform(0.2F, 4.0F)),
            Eigen::AngleAxisf(random.uniform(0.0F, 3.0F), arm.normalized()).toRotationMatrix());
    case 1: return geometry::make_capsule(centre - arm, centre + arm, random.uniform(0.1F, 2.0F));
    case 2: return geometry::make_cylinder(centre - arm, centre + arm, random.uniform(0.2F, 2.0F));
    default: return geometry::make_sphere(centre, random.uniform(0.2F, 3.0F));
    }
}

/// Least distance of 27 points of the own box, and of the box's nearest point to the solid's centre, from a solid.
double sampled(const geometry::Shape& shape, const Vec3d& own, const Vec3d& half)
{
    double least = 1e9;
    for (int n = 0; n < 27; ++n) {
        const Vec3d corner(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
        least = std::min(least, distance_of(shape, own + corner.cwiseProduct(half)));
    }
    const Vec3d to = shape.centre.cast<double>() - own;
    return std::min(least, distance_of(shape, own + to.cwiseMax(-half).cwiseMin(half)));
}

TEST(MovingSolids, AreNeverTouchedAndSolelyHitWhereTheyAre)
{
    static Result result;
    std::size_t free = 0;
    std::size_t hits = 0;
    std::size_t seen_to_touch = 0;
    const std::size_t cases = case_count(1500);
    for (std::uint64_t seed = 1; seed <= cases; ++seed) {
        RandomProblem p(seed);
        Random random(seed * 92821);
        p.threats.clear();
        p.problem.main = kNoThreat;
        std::vector<MovingSolid>& solids = p.solids;
        for (std::uint64_t i = 0, n = 1 + random.below(kMaxMovingSolids); i < n; ++i) {
            const Vec3 velocity = RandomProblem::vector(random, 6.0F);
            const float t = random.uniform(0.0F, 2.0F) * p.problem.distance / p.problem.speed;
            const Vec3 met = p.problem.frame.origin +
                             random.uniform(0.2F, 1.8F) * p.problem.distance * p.problem.frame.axes.col(0) +
                             RandomProblem::vector(random, 5.0F);
            const bool grows = random.uniform() < 0.3F;
            solids.push_back({random_moving_solid(random, met - t * velocity), velocity,
                              random.uniform() < 0.5F ? 0.0F : random.uniform(0.0F, 0.5F),
                              grows ? random.uniform(0.0F, 0.3F) : 0.0F, grows ? random.uniform(0.0F, 0.1F) : 0.0F});
        }
        p.put_into(p.problem);
        p.problem.begins = random.uniform() < 0.5F ? 0.0F : random.uniform(0.0F, 2.0F);
        Settings settings;
        settings.check_acceleration = settings.verify_flight = settings.escape_from_margin = false;
        settings.evaluate_all = true;
        settings.waypoints = 13;
        WorkBudget budget(10'000'000);
        static_cast<void>(solve(p.problem, settings, p.limits, p.airframe, budget, result));
        const Vec3d half = p.limits.half_extents.cast<double>();
        for (const Candidate& c : result.candidates) {
            const bool is_free = c.status == CandidateStatus::available || c.status == CandidateStatus::chosen;
            const oracle::Flight flight = p.flight(c.shape, settings.waypoints);
            double least = 1e9;
            double least_grown = 1e9;  // with the size at the end of each segment, as in the check
            for (std::size_t s = 0; s < solids.size(); ++s) {
                const MovingSolid& solid = solids[s];
                const auto grown_at = [&](double t) {
                    const double since = t + static_cast<double>(p.problem.begins);
                    return static_cast<double>(solid.uncertainty) +
                           since * (static_cast<double>(solid.radius_rate) +
                                    0.5 * static_cast<double>(solid.radius_acceleration) * since);
                };
                for (std::size_t k = 0; k + 1 < flight.p.size(); ++k) {
                    for (int part = 0; part < 6; ++part) {
                        const double share = part / 5.0;
                        const double t = flight.t[k] + share * (flight.t[k + 1] - flight.t[k]);
                        const Vec3d way = (t + static_cast<double>(p.problem.begins)) * solid.velocity.cast<double>();
                        const Vec3d own = Vec3d(flight.p[k].data()) +
                                          share * (Vec3d(flight.p[k + 1].data()) - Vec3d(flight.p[k].data()));
                        const double distance = sampled(solid.shape, own - way, half);  // relative to the solid
                        least = std::min(least, distance - grown_at(t));
                        least_grown = std::min(least_grown, distance - grown_at(flight.t[k + 1]));
                    }
                }
            }
            if (is_free) {
                ++free;
                ASSERT_GT(least, -4e-3) << "seed " << seed;
            } else {
                ASSERT_EQ(c.status, CandidateStatus::hits_moving) << "seed " << seed;
                ASSERT_EQ(c.hit.kind, world::ThreatKind::obstacle);
                ASSERT_LT(c.hit.index, solids.size());
                ++hits;
                seen_to_touch += least < 0.0 ? 1U : 0U;
                // Points of a box that is up to 2.4 m wide lie 0.85 m from any other one, instants 0.3 m of path.
                ASSERT_LT(least_grown, 1.6) << "seed " << seed;
            }
        }
    }
    EXPECT_GT(free, 10 * cases / 3);
    EXPECT_GT(hits, 10 * cases / 3);
    EXPECT_GT(seen_to_touch * 10, hits * 7) << "most contacts are seen by so few points";
    std::printf("[ measured ] %zu candidates free, %zu in contact, %zu of these seen so by samples\n", free, hits,
                seen_to_touch);
}

TEST(Planes, PartOnlyWhatIsApartAndTouchOnlyWhatTouches)
{
    std::size_t parted = 0;
    std::size_t touched = 0;
    std::size_t clear = 0;
    for (std::uint64_t seed = 1; seed <= 200'000; ++seed) {
        Random random(seed);
        const Vec3 half(random.uniform(0.1F, 2.0F), random.uniform(0.1F, 2.0F), random.uniform(0.1F, 2.0F));
        const geometry::Shape solid = random_moving_solid(random, RandomProblem::vector(random, 50.0F));
        const Vec3 a = solid.centre + RandomProblem::vector(random, 8.0F);
        const Vec3 b = a + RandomProblem::vector(random, random.uniform() < 0.3F ? 12.0F : 1.0F);
        const float clearance = random.uniform() < 0.5F ? 0.0F : random.uniform(0.0F, 1.0F);
        WorkBudget budget(1'000'000);
        const bool is_clear =
            geometry::swept_box_contact(half, a, b, solid, clearance, budget) == geometry::Contact::clear;
        clear += is_clear ? 1U : 0U;
        const detail::Planes planes(solid, solid.centre);
        if (planes.part(a, b, half, clearance)) {
            ++parted;
            ASSERT_TRUE(is_clear) << "seed " << seed;
        }
        for (const Vec3& end : {a, b}) {
            if (planes.touch(end, half, clearance)) {
                ++touched;
                ASSERT_FALSE(is_clear) << "seed " << seed;
            }
        }
    }
    EXPECT_GT(parted * 10, clear * 7) << "most of what is clear is seen at once";
    EXPECT_GT(touched, 10'000U);
    std::printf("[ measured ] %zu clear, %zu of them parted by planes\n", clear, parted);
}

}  // namespace
}  // namespace jink::geometric
