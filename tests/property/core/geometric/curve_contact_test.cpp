// SPDX-License-Identifier: BSD-3-Clause
// Curves and spheres in contact by less than any bound leaves for rounding, against distances in double: no quick
// reject skips these contacts, for any distance and flight time of the sphere.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "tests/property/core/geometric/random_problem.hpp"
#include "tests/unit/core/geometric/curve_bench.hpp"

namespace jink::geometric {
namespace {

/// A short curve, from the origin on or far out, and a sphere: static, or moving in a plane of two of the world's axes
/// or anywhere, and near some point of the curve at that point's time.
struct Encounter {
    CurveBench bench;
    oracle::Flight flight;
    double lengths = 0.0;  ///< sum of the involved lengths [m]

    static std::vector<CurvePoint> curve(Random& random)
    {
        const bool far = random.below(2) == 0;
        std::vector<CurvePoint> points{{Vec3::Zero(), 0.0F}};
        if (far) {
            points[0].position = RandomProblem::vector(random, 1000.0F).cwiseAbs();
        }
        for (std::uint64_t i = 0, n = 1 + random.below(5); i < n; ++i) {
            const CurvePoint& last = points.back();
            Vec3 step = RandomProblem::vector(random, 6.0F);
            if (far) {
                step = step.cwiseAbs();  // all of it in one octant
            }
            points.push_back({last.position + step, last.time + random.uniform(0.5F, 3.0F)});
        }
        return points;
    }

    explicit Encounter(Random& random) : bench(curve(random))
    {
        const detail::Curve& curve = bench.curve;
        for (std::size_t i = 0; i < curve.points; ++i) {
            flight.p.push_back(oracle::to_double(curve.position(i)));
            flight.t.push_back(double(curve.t[i]));
        }
        const std::size_t met = random.below(curve.points);
        const Vec3 place = curve.position(met) + RandomProblem::vector(random, random.below(4) == 0 ? 200.0F : 8.0F);
        Sphere threat;
        threat.motion.position = place;
        if (random.below(3) == 0 && met > 0) {
            // From beside the origin to beside that point.
            threat.motion.position = RandomProblem::vector(random, 1.0F);
            threat.motion.velocity =
                (curve.position(met) + RandomProblem::vector(random, 2.0F) - threat.motion.position) / curve.t[met];
        } else if (random.below(3) > 0) {
            Vec3 velocity = RandomProblem::vector(random, std::pow(10.0F, random.uniform(0.0F, 2.5F)));
            if (random.below(2) == 0) {
                velocity[static_cast<int>(random.below(3))] = 0.0F;
            }
            threat.motion = {place - curve.t[met] * velocity, velocity};
        }
        if (random.below(2) == 0) {  // level: as far out as it may be otherwise, there it is near the origin
            threat.motion.position.z() = threat.motion.velocity.z() = 0.0F;
        }
        bench.threats = {threat};
        const detail::Extent reach = detail::extent_of(curve);
        lengths = double(threat.motion.position.cwiseAbs().sum()) +
                  double(reach.low.cwiseAbs().sum() + reach.high.cwiseAbs().sum()) + 10.0 +
                  double(curve.duration()) * double(threat.motion.velocity.cwiseAbs().sum());
    }
    [[nodiscard]] oracle::Moving sphere() const
    {
        return {oracle::to_double(bench.threats[0].motion.position),
                oracle::to_double(bench.threats[0].motion.velocity), 0.0};
    }
    [[nodiscard]] CandidateStatus status(double radius)
    {
        bench.threats[0].radius = static_cast<float>(radius);
        return bench.status();
    }
};

TEST(CurveContact, ASphereIsMetWhereItTouchesByAHair)
{
    Random random(831);
    const oracle::Box box{{0.5, 0.5, 0.5}};
    unsigned touching = 0;
    for (std::size_t i = 0; i < case_count(3'000); ++i) {
        Encounter encounter(random);
        const bool moves = detail::is_moving(encounter.bench.threats[0].threat(0));
        const double distance = oracle::margin(encounter.flight, encounter.sphere(), box);
        const double hair = 1e-6 * (encounter.lengths + 2.0 * distance);  // twice the error bound of the exact test
        if (distance > 4.0 * hair) {
            ASSERT_EQ(encounter.status(distance - 4.0 * hair), CandidateStatus::available) << i;
        }
        ASSERT_EQ(encounter.status(distance + hair),
                  moves ? CandidateStatus::hits_moving : CandidateStatus::hits_static)
            << i << " at " << distance;
        touching += distance > 0.0 ? 1U : 0U;
    }
    EXPECT_GT(touching, case_count(3'000) / 2);
}

TEST(CurveContact, AVolumeIsMetWhereItTouches)
{
    Random random(832);
    const oracle::Box box{{0.5, 0.5, 0.5}};
    unsigned touching = 0;
    for (std::size_t i = 0; i < case_count(1'500); ++i) {
        Encounter encounter(random);
        encounter.bench.settings.security = SecurityMode::swept;
        const bool moves = detail::is_moving(encounter.bench.threats[0].threat(0));
        const double end = double(encounter.bench.curve.duration());
        const double distance = oracle::swept_margin(encounter.flight, encounter.sphere(), end, box);
        // Contact counts, to the last bit of the radius.
        const float radius = std::nextafter(static_cast<float>(distance), std::numeric_limits<float>::infinity());
        if (moves) {
            ASSERT_EQ(encounter.status(double(radius)), CandidateStatus::hits_moving) << i << " at " << distance;
            touching += distance > 0.0 ? 1U : 0U;
        }
        const double beyond = 4e-5 * (encounter.lengths + distance);
        if (distance > beyond) {
            ASSERT_EQ(encounter.status(distance - beyond), CandidateStatus::available) << i;
        }
    }
    EXPECT_GT(touching, case_count(1'500) / 4);
}

/// Signed distance of a box about `own` from an upright cylinder, in double precision: inside negative, to the nearest
/// surface.
double cylinder_distance(const world::Cylinder& body, double t, const Eigen::Vector3d& own, double half)
{
    const Eigen::Vector2d centre = body.circle.centre.cast<double>() + t * body.velocity.cast<double>();
    const Eigen::Vector2d to = centre - own.head<2>();
    const Eigen::Vector2d off = to - to.cwiseMax(-half).cwiseMin(half);
    const double level = off.norm() - double(body.circle.radius);
    const double height = std::max(double(body.bottom) - half - own.z(), own.z() - half - double(body.top));
    return level > 0.0 && height > 0.0 ? std::hypot(level, height) : std::max(level, height);
}

TEST(CurveContact, ACylinderIsTouchedWhereItIsWhenTheCurveIsThere)
{
    Random random(833);
    std::size_t hits = 0;
    std::size_t clear = 0;
    for (std::size_t i = 0; i < case_count(3'000); ++i) {
        Encounter encounter(random);
        CurveBench& bench = encounter.bench;
        const detail::Curve& curve = bench.curve;
        bench.threats.clear();
        bench.problem.lead = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 1.0F);
        bench.problem.begins = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 3.0F);
        bench.uncertainty = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 1.0F);
        const float before = bench.problem.lead + bench.problem.begins;
        const std::size_t met = random.below(curve.points);
        const Vec3 place = curve.position(met) + RandomProblem::vector(random, 8.0F);
        world::Cylinder body;
        body.circle.radius = random.uniform(0.5F, 6.0F);
        body.velocity = random.below(3) == 0 ? world::Vec2(world::Vec2::Zero())
                                             : world::Vec2(random.uniform(-8.0F, 8.0F), random.uniform(-8.0F, 8.0F));
        body.circle.centre = place.head<2>() - (curve.t[met] + before) * body.velocity;
        body.bottom = place.z() - random.uniform(0.0F, 6.0F);
        body.top = place.z() + random.uniform(0.0F, 6.0F);
        const std::array cylinders{body};
        bench.airspace.cylinders = cylinders;
        double least = 1e9;
        for (std::size_t k = 0; k + 1 < curve.points; ++k) {
            for (int part = 0; part <= 400; ++part) {
                const double share = part / 400.0;
                const double t = double(curve.t[k]) + share * (double(curve.t[k + 1]) - double(curve.t[k]));
                const Eigen::Vector3d own = curve.position(k).cast<double>() +
                                            share * (curve.position(k + 1) - curve.position(k)).cast<double>();
                least = std::min(least, cylinder_distance(body, double(before) + t, own, 0.5));
            }
        }
        least -= double(bench.uncertainty);
        // Sampling finds contact up to half a step late; rounding is a share of all coordinates.
        const double rounding = 1e-5 * (encounter.lengths + 100.0);
        if (least < -1e-9) {
            ASSERT_EQ(bench.status(), CandidateStatus::hits_airspace) << i << " at " << least;
            ++hits;
        } else if (least > 0.1 + rounding) {
            ASSERT_EQ(bench.status(), CandidateStatus::available) << i << " at " << least;
            ++clear;
        }
    }
    EXPECT_GT(hits, case_count(3'000) / 5);
    EXPECT_GT(clear, case_count(3'000) / 5);
}

TEST(CurveContact, OutOfACylinderTheWayOutIsClearAndTheWayThroughIsNot)
{
    world::Cylinder body;
    body.circle = {world::Vec2(-1.9F, 0.0F), 2.0F};
    body.bottom = -10.0F;
    body.top = 10.0F;
    const std::array cylinders{body};
    for (const float way : {-4.0F, 4.0F}) {
        CurveBench bench({{Vec3::Zero(), 0.0F}, {Vec3(way, 0.0F, 0.0F), 2.0F}});
        bench.airspace.cylinders = cylinders;
        EXPECT_EQ(bench.status(), CandidateStatus::hits_airspace) << "inside of it, without the escape rule";
        bench.settings.escape_from_margin = true;
        EXPECT_EQ(bench.status(), way > 0.0F ? CandidateStatus::available : CandidateStatus::hits_airspace) << way;
    }
}

}  // namespace
}  // namespace jink::geometric
