// SPDX-License-Identifier: BSD-3-Clause
#include "core/path/route.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <vector>

#include "tests/property/core/geometry/oracle.hpp"

// Routes of random legs and arcs against points that were placed one by one in double precision.

namespace jink::path {
namespace {

using geometry::oracle::case_count;
using geometry::oracle::in_cube;
using geometry::oracle::seed_of;
using Vec3d = Eigen::Vector3d;

constexpr double kStep = 0.02;

struct Chain {
    Route route;
    std::vector<Vec3d> points;  ///< kStep apart along each segment, its end included
    std::vector<double> at;     ///< arc lengths
    std::vector<std::size_t> of;
    double length = 0.0;

    void follow(std::size_t segment, double span, const auto& place)
    {
        for (double s = 0.0; s < span + kStep; s += kStep) {
            points.push_back(place(std::min(s, span)));
            at.push_back(length + std::min(s, span));
            of.push_back(segment);
        }
        length += span;
    }

    explicit Chain(Random& random)
    {
        Vec3 start = in_cube(random, 500.0F);
        const std::size_t count = 1 + random.below(kMaxRouteSegments);
        for (std::size_t i = 0; i < count; ++i) {
            if (random.below(2) == 0) {
                const Vec3 end = start + in_cube(random, 40.0F);
                if (route.add_leg(start, end) != RouteStatus::ok) {
                    continue;
                }
                const Vec3d a = start.cast<double>();
                const Vec3d b = end.cast<double>();
                follow(i, (b - a).norm(), [&](double s) -> Vec3d { return a + (b - a).normalized() * s; });
            } else {
                const Vec3 axis = random.below(3) == 0 ? Vec3(Vec3::UnitZ()) : in_cube(random, 1.0F);
                const Vec3 across = in_cube(random, 1.0F).cross(axis).normalized();
                const Vec3 centre = start + random.uniform(0.6F, 40.0F) * across;
                const float angle = random.uniform(-6.28F, 6.28F);
                if (route.add_arc(start, centre, axis, angle) != RouteStatus::ok) {
                    continue;
                }
                const Vec3d c = centre.cast<double>();
                const Vec3d r = start.cast<double>() - c;
                const Vec3d up = axis.cast<double>().normalized();
                const double turn = double(angle);
                follow(i, r.norm() * std::abs(turn), [&](double s) -> Vec3d {
                    return c + Eigen::AngleAxisd(std::copysign(s / r.norm(), turn), up) * r;
                });
            }
            start = points.back().cast<float>();
        }
    }
};

TEST(Route, LiesWhereItsSegmentsDo)
{
    const std::uint64_t seed = seed_of(20261122);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t i = 0; i < case_count(2000); ++i) {
        const Chain chain(random);
        if (chain.route.empty()) {
            continue;
        }
        ASSERT_NEAR(double(chain.route.length()), chain.length, 2e-3) << "case " << i;
        for (std::size_t k = 0; k < chain.points.size(); k += 7) {
            const RoutePoint point = chain.route.at(static_cast<float>(chain.at[k]));
            ASSERT_LE((point.position.cast<double>() - chain.points[k]).norm(), 2e-3) << "case " << i << " at " << k;
            ASSERT_NEAR(point.along.norm(), 1.0F, 1e-5F);
            // At a joint, rounding decides which of its two tangents is returned.
            if (k > 0 && k + 2 < chain.points.size() && chain.of[k + 2] == chain.of[k - 1] &&
                chain.at[k + 2] - chain.at[k - 1] > 2.5 * kStep) {
                const Vec3d chord = chain.points[k + 1] - chain.points[k];
                ASSERT_GT(chord.normalized().dot(point.along.cast<double>()), 0.9997) << "case " << i << " at " << k;
            }
        }
    }
}

TEST(Route, NothingOnTheSegmentIsNearerThanAbeam)
{
    const std::uint64_t seed = seed_of(20261123);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t later = 0;
    for (std::size_t i = 0; i < case_count(3000); ++i) {
        const Chain chain(random);
        if (chain.route.empty()) {
            continue;
        }
        const Vec3d aim = chain.points[random.below(chain.points.size())];
        const Vec3 position = aim.cast<float>() + in_cube(random, 15.0F);
        const std::size_t from = random.below(chain.route.segments().size());
        const Abeam abeam = chain.route.abeam_of(position, from);
        ASSERT_GE(abeam.segment, from);
        later += abeam.segment > from ? 1U : 0U;
        const RoutePoint there = chain.route.at(abeam.arc_length);
        ASSERT_LE((there.position - abeam.point.position).norm(), 2e-3F) << "case " << i;
        ASSERT_NEAR((position - abeam.point.position).norm(), abeam.off, 1e-3F);
        std::vector<double> least(chain.route.segments().size(), 1e9);
        std::size_t dense = 0;
        std::size_t last = chain.of.front();
        for (std::size_t k = 0; k < chain.points.size(); ++k) {
            dense += chain.of[k] != last ? 1U : 0U;
            last = chain.of[k];
            least[dense] = std::min(least[dense], (chain.points[k] - position.cast<double>()).norm());
        }
        ASSERT_NEAR(double(abeam.off), least[abeam.segment], 0.02) << "case " << i;
        for (std::size_t k = from; k < abeam.segment; ++k) {
            ASSERT_GE(least[k] + 0.02, least[k + 1]) << "case " << i << ": passed over";
        }
        if (abeam.segment + 1 < least.size()) {
            ASSERT_GE(least[abeam.segment + 1] + 0.02, least[abeam.segment]) << "case " << i << ": the next is nearer";
        }
    }
    EXPECT_GT(later, case_count(3000) / 60);
}

/// Carried along a closed circle a side comes back as it was; along any route it stays across, and turns no more than
/// the tangent does.
TEST(Route, SidesAreCarriedWithoutTwist)
{
    const std::uint64_t seed = seed_of(20261124);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t i = 0; i < case_count(500); ++i) {
        const Vec3 axis = in_cube(random, 1.0F);
        const Vec3 across = in_cube(random, 1.0F).cross(axis).normalized();
        Route circle;
        ASSERT_EQ(circle.add_arc(Vec3::Zero(), 10.0F * across, axis, 2.0F * kPi), RouteStatus::ok);
        Vec3 from = circle.at(0.0F).along;
        const Vec3 first = in_cube(random, 1.0F).cross(from).normalized();
        Vec3 side = first;
        const int steps = 3 + static_cast<int>(random.below(40));
        for (int k = 1; k <= steps; ++k) {
            const Vec3 to = circle.at(circle.length() * static_cast<float>(k) / static_cast<float>(steps)).along;
            const Vec3 next = carried(side, from, to);
            ASSERT_NEAR(next.dot(to), 0.0F, 2e-5F);
            ASSERT_NEAR(next.norm(), 1.0F, 2e-5F);
            ASSERT_LE((next - side).norm(), (to - from).norm() + 1e-5F);
            side = next;
            from = to;
        }
        ASSERT_LE((side - first).norm(), 1e-3F) << "case " << i;
        // Level plane: an upward vector stays upward.
        ASSERT_NEAR(carried(Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY()).z(), 1.0F, 1e-6F);
    }
}

TEST(Route, RefusesWhatIsNoSegment)
{
    Route route;
    const Vec3 zero = Vec3::Zero();
    EXPECT_EQ(route.add_leg(zero, Vec3(0.001F, 0.0F, 0.0F)), RouteStatus::too_short);
    EXPECT_EQ(route.add_leg(zero, Vec3(NAN, 0.0F, 0.0F)), RouteStatus::not_finite);
    EXPECT_EQ(route.add_leg(Vec3(2e5F, 0.0F, 0.0F), zero), RouteStatus::not_finite);
    EXPECT_EQ(route.add_arc(zero, Vec3(0.0F, 0.4F, 0.0F), Vec3::UnitZ(), 1.0F), RouteStatus::bad_arc);
    EXPECT_EQ(route.add_arc(zero, Vec3(0.0F, 10001.0F, 0.0F), Vec3::UnitZ(), 1.0F), RouteStatus::bad_arc);
    EXPECT_EQ(route.add_arc(zero, Vec3(0.0F, 5.0F, 0.0F), Vec3::Zero(), 1.0F), RouteStatus::bad_arc);
    EXPECT_EQ(route.add_arc(zero, Vec3(0.0F, 5.0F, 0.1F), Vec3::UnitZ(), 1.0F), RouteStatus::bad_arc);
    EXPECT_EQ(route.add_arc(zero, Vec3(0.0F, 5.0F, 0.0F), Vec3::UnitZ(), 6.4F), RouteStatus::bad_arc);
    EXPECT_EQ(route.add_arc(zero, Vec3(0.0F, 5.0F, 0.0F), Vec3::UnitZ(), 1e-4F), RouteStatus::too_short);
    EXPECT_EQ(route.add_arc(zero, Vec3(0.0F, 5.0F, 0.0F), Vec3::UnitZ(), INFINITY), RouteStatus::not_finite);
    EXPECT_TRUE(route.empty());
    ASSERT_EQ(route.add_leg(zero, Vec3(10.0F, 0.0F, 0.0F)), RouteStatus::ok);
    EXPECT_EQ(route.add_leg(Vec3(10.0F, 0.02F, 0.0F), Vec3(20.0F, 0.0F, 0.0F)), RouteStatus::gap);
    EXPECT_EQ(route.add_arc(Vec3(9.0F, 0.0F, 0.0F), Vec3(9.0F, 5.0F, 0.0F), Vec3::UnitZ(), 1.0F), RouteStatus::gap);
    EXPECT_EQ(route.segments().size(), 1U);
    for (std::size_t i = 1; i < kMaxRouteSegments; ++i) {
        const float x = 10.0F * static_cast<float>(i);
        ASSERT_EQ(route.add_leg(Vec3(x, 0.005F, 0.0F), Vec3(x + 10.0F, 0.0F, 0.0F)), RouteStatus::ok);
    }
    const Vec3 end = route.at(route.length()).position;
    EXPECT_EQ(route.add_leg(end, end + Vec3::UnitX()), RouteStatus::full);
    EXPECT_EQ(route.add_arc(end, end + 5.0F * Vec3::UnitY(), Vec3::UnitZ(), 1.0F), RouteStatus::full);
}

TEST(Route, GoesOnStraightPastItsEnds)
{
    Route route;
    ASSERT_EQ(route.add_arc(Vec3::Zero(), Vec3(0.0F, 10.0F, 0.0F), Vec3::UnitZ(), 0.5F * kPi), RouteStatus::ok);
    EXPECT_LE((route.at(-3.0F).position - Vec3(-3.0F, 0.0F, 0.0F)).norm(), 1e-5F);
    const RoutePoint beyond = route.at(route.length() + 4.0F);
    EXPECT_LE((beyond.position - Vec3(10.0F, 14.0F, 0.0F)).norm(), 1e-4F);
    EXPECT_LE((beyond.along - Vec3::UnitY()).norm(), 1e-5F);
}

/// Two parallel legs: a vehicle pushed off the present leg is not matched to the other.
TEST(Route, HairpinIsNotCutShort)
{
    Route route;
    ASSERT_EQ(route.add_leg(Vec3::Zero(), Vec3(100.0F, 0.0F, 0.0F)), RouteStatus::ok);
    ASSERT_EQ(route.add_arc(Vec3(100.0F, 0.0F, 0.0F), Vec3(100.0F, 5.0F, 0.0F), Vec3::UnitZ(), kPi), RouteStatus::ok);
    ASSERT_EQ(route.add_leg(Vec3(100.0F, 10.0F, 0.0F), Vec3(0.0F, 10.0F, 0.0F)), RouteStatus::ok);
    EXPECT_EQ(route.abeam_of(Vec3(40.0F, 8.0F, 0.0F)).segment, 0U);
    EXPECT_EQ(route.abeam_of(Vec3(40.0F, 8.0F, 0.0F), 1).segment, 2U);
    EXPECT_EQ(route.abeam_of(Vec3(40.0F, 8.0F, 0.0F), 7).segment, 2U);
    EXPECT_NEAR(route.abeam_of(Vec3(40.0F, 8.0F, 0.0F), 1).arc_length, 100.0F + 5.0F * kPi + 60.0F, 1e-3F);
}

}  // namespace
}  // namespace jink::path
