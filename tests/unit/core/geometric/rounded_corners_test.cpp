// SPDX-License-Identifier: BSD-3-Clause
// The reference ahead: its corners are rounded where they lie, once each, and as gently as half of the
// vehicle's acceleration allows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geometric/along_reference.hpp"
#include "tests/oracle/route_oracle.hpp"

namespace jink::geometric {
namespace {

using detail::ReferenceAhead;
using oracle::TwinRoute;
using oracle::Vec3d;

/// Two legs that join at (40, 0, 50), the second one in `direction`.
TwinRoute legs(const Vec3& direction, float first = 40.0F)
{
    TwinRoute twin;
    EXPECT_TRUE(twin.leg(Vec3(0.0F, 0.0F, 50.0F), Vec3(first, 0.0F, 50.0F)));
    EXPECT_TRUE(twin.leg(Vec3(first, 0.0F, 50.0F), Vec3(first, 0.0F, 50.0F) + 60.0F * direction.normalized()));
    return twin;
}

/// From `start` straight to where the route is joined, at 3 m/s.
Problem problem_to(const TwinRoute& twin, const Vec3& start, float joined_at)
{
    const Vec3 joint = twin.at(double(joined_at)).cast<float>();
    Problem problem;
    problem.frame = make_path_frame(start, joint - start);
    problem.ahead = {twin.route, (joint - start).norm(), joined_at};
    problem.distance = 30.0F;
    problem.speed = 3.0F;
    return problem;
}

/// The single corner at arc length `way`, where the tangent turns from `before` to `after`: a parabola symmetric about
/// the corner, flown at the problem's speed with half of the vehicle's acceleration.
void expect_one_corner(const Problem& problem, float way, const Vec3d& before, const Vec3d& after,
                       double tolerance = 2e-4)
{
    const vehicle::VehicleLimits limits;
    const ReferenceAhead ahead(problem, limits, 60.0F);
    const Vec3d change = after - before;
    const double speed = double(problem.speed);
    const double asked = std::max(change.head<2>().norm() / double(limits.max_acceleration),
                                  std::abs(change.z()) / double(limits.max_vertical_acceleration));
    const double half = speed * speed * asked;  // 2 half / speed is the time that it takes
    ASSERT_LT(half, double(way));
    const Vec3d corner = double(way) * before;
    for (int i = -40; i <= 40; ++i) {
        const double past = half * i / 20.0;
        const Vec3d sharp = corner + past * (past < 0.0 ? before : after);
        const double in = std::max(0.0, half - std::abs(past));
        const Vec3d expected = sharp + change * (in * in / (4.0 * half));
        const Vec3d is = ahead.position(way + static_cast<float>(past)).cast<double>();
        ASSERT_LT((is - expected).norm(), tolerance) << past << " of " << half;
    }
    // And nowhere else.
    for (float s = 0.5F; s < 55.0F; s += 0.5F) {
        const double past = double(s) - double(way);
        if (std::abs(past) > half) {
            const Vec3d sharp = corner + past * (past < 0.0 ? before : after);
            ASSERT_LT((ahead.position(s).cast<double>() - sharp).norm(), tolerance) << s;
        }
    }
}

TEST(RoundedCorners, TurnAsGentlyAsHalfOfTheAccelerationAllows)
{
    for (const Vec3& direction : {Vec3(1.0F, 1.0F, 0.0F), Vec3(1.0F, -3.0F, 0.0F), Vec3(2.0F, 0.0F, 1.0F),
                                  Vec3(2.0F, 0.0F, -1.0F), Vec3(2.0F, 1.0F, 1.0F), Vec3(1.0F, 2.0F, -0.2F)}) {
        const TwinRoute twin = legs(direction);
        // From the route's start, and from farther along it, having come straight on for a while.
        for (const float joined_at : {10.0F, 25.0F}) {
            for (const float start : {0.0F, 5.0F}) {
                const Problem problem = problem_to(twin, Vec3(start, 0.0F, 50.0F), joined_at);
                expect_one_corner(problem, 40.0F - start, Vec3d::UnitX(), direction.cast<double>().normalized());
            }
        }
    }
}

/// A path that joins the route at a joint turns once, from its straight beginning into the following segment, for any
/// rounding of the joining arc length.
TEST(RoundedCorners, AJointThatIsJoinedAtIsTurnedOnce)
{
    constexpr float kPast = 1e-3F;
    const Vec3 direction(1.0F, 2.0F, 0.0F);
    for (const float joint : {40.0F, 40.0F + kPast}) {
        const TwinRoute twin = legs(direction, joint);
        for (const float joined_at : {40.0F, joint, std::nextafter(joint, 0.0F), std::nextafter(joint, 50.0F)}) {
            const Vec3 start(20.0F, -15.0F, 50.0F);
            const Problem problem = problem_to(twin, start, joined_at);
            const Vec3d before = Vec3(problem.frame.axes.col(0)).cast<double>();
            expect_one_corner(problem, problem.ahead.straight, before, direction.cast<double>().normalized(),
                              2.0 * double(kPast));
        }
    }
}

TEST(RoundedCorners, JointsThatHardlyTurnAreNone)
{
    // Short of a ten-thousandth, and that to the bit.
    for (const float aside : {0.5e-4F, 0.9e-4F, 1e-4F}) {
        TwinRoute twin;
        ASSERT_TRUE(twin.leg(Vec3(0.0F, 0.0F, 50.0F), Vec3(40.0F, 0.0F, 50.0F)));
        ASSERT_TRUE(twin.leg(Vec3(40.0F, 0.0F, 50.0F), Vec3(41.0F, aside, 50.0F)));
        ASSERT_EQ(twin.route.segments()[1].along, Vec3(1.0F, aside, 0.0F));
        Problem problem = problem_to(twin, Vec3(0.0F, 0.0F, 50.0F), 10.0F);
        problem.speed = 30.0F;
        const ReferenceAhead ahead(problem, vehicle::VehicleLimits{}, 60.0F);
        for (float way = 39.5F; way < 40.5F; way += 1.0F / 64.0F) {
            const Vec3 sharp = path::point_of(problem.ahead, problem.frame.origin, Vec3::UnitX(), way).position;
            ASSERT_EQ(ahead.position(way), sharp - problem.frame.origin) << way;
        }
    }
}

}  // namespace
}  // namespace jink::geometric
