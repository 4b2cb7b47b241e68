// SPDX-License-Identifier: BSD-3-Clause
#include "core/path/timed_path.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace jink::path {
namespace {

TimedPath corner()
{
    TimedPath path;
    const std::vector<Vec3> positions{Vec3(0.0F, 0.0F, 10.0F), Vec3(10.0F, 0.0F, 10.0F), Vec3(10.0F, 5.0F, 10.0F)};
    EXPECT_TRUE(make_timed_path(positions, 5.0F, vehicle::VehicleLimits{}, path));
    return path;
}

TEST(MakeTimedPath, VelocitiesAndTimes)
{
    const TimedPath path = corner();
    ASSERT_EQ(path.points.size(), 3U);
    EXPECT_EQ(path.points[0].time, 0.0F);
    EXPECT_FLOAT_EQ(path.points[1].time, 2.0F);
    EXPECT_FLOAT_EQ(path.duration(), 3.0F);
    EXPECT_EQ(path.points[0].velocity, Vec3(5.0F, 0.0F, 0.0F));
    EXPECT_EQ(path.points[1].velocity, Vec3(0.0F, 5.0F, 0.0F));
    EXPECT_EQ(path.points[2].velocity, path.points[1].velocity);
    EXPECT_FLOAT_EQ(arc_length(path), 15.0F);
}

TEST(MakeTimedPath, ClimbOfPinheiroFigure310)
{
    TimedPath path;
    const std::vector<Vec3> positions{Vec3::Zero(), Vec3(3.0F, 0.0F, 3.0F)};
    ASSERT_TRUE(make_timed_path(positions, 5.0F, vehicle::VehicleLimits{}, path));
    EXPECT_NEAR(path.duration(), 1.0F, 1e-6F);
}

TEST(MakeTimedPath, NearlyEqualPointsAreDropped)
{
    TimedPath path;
    const std::vector<Vec3> positions{Vec3::Zero(), Vec3(1e-7F, 0.0F, 0.0F), Vec3(1.0F, 0.0F, 0.0F),
                                      Vec3(1.0F, 0.0F, 0.0F)};
    ASSERT_TRUE(make_timed_path(positions, 5.0F, vehicle::VehicleLimits{}, path));
    ASSERT_EQ(path.points.size(), 2U);
    EXPECT_EQ(path.points[0].position, Vec3::Zero());
    EXPECT_EQ(path.points[1].velocity, path.points[0].velocity);
}

TEST(MakeTimedPath, TimesStayStrictlyIncreasing)
{
    TimedPath path;  // 2e-6 m after 100 s at 5 m/s: 4e-7 s are lost in float
    const std::vector<Vec3> positions{Vec3(500.0F, 0.0F, 0.0F), Vec3::Zero(), Vec3(2e-6F, 0.0F, 0.0F),
                                      Vec3(0.0F, 1.0F, 0.0F)};
    ASSERT_TRUE(make_timed_path(positions, 5.0F, vehicle::VehicleLimits{}, path));
    ASSERT_EQ(path.points.size(), 3U);
    EXPECT_GT(path.points[2].time, path.points[1].time);
}

TEST(MakeTimedPath, RefusesTooFewAndTooMany)
{
    TimedPath path = corner();
    EXPECT_FALSE(make_timed_path({}, 5.0F, vehicle::VehicleLimits{}, path));
    EXPECT_TRUE(path.points.empty());
    const std::vector<Vec3> one(1, Vec3::Zero());
    EXPECT_FALSE(make_timed_path(one, 5.0F, vehicle::VehicleLimits{}, path));
    const std::vector<Vec3> same(4, Vec3(1.0F, 2.0F, 3.0F));
    path = corner();
    EXPECT_FALSE(make_timed_path(same, 5.0F, vehicle::VehicleLimits{}, path));
    EXPECT_TRUE(path.points.empty());
    std::vector<Vec3> many;
    for (std::size_t i = 0; i <= kMaxPathPoints; ++i) {
        many.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
    }
    EXPECT_FALSE(make_timed_path(many, 5.0F, vehicle::VehicleLimits{}, path));
    many.pop_back();
    EXPECT_TRUE(make_timed_path(many, 5.0F, vehicle::VehicleLimits{}, path));
    EXPECT_EQ(path.points.size(), kMaxPathPoints);
}

TEST(Sample, BeforeBetweenAndAfter)
{
    const TimedPath path = corner();
    EXPECT_EQ(sample(path, -1.0F).position, path.points[0].position);
    EXPECT_EQ(sample(path, -1.0F).velocity, path.points[0].velocity);
    EXPECT_EQ(sample(path, 1.0F).position, Vec3(5.0F, 0.0F, 10.0F));
    EXPECT_EQ(sample(path, 2.0F).position, path.points[1].position);
    EXPECT_EQ(sample(path, 2.0F).velocity, Vec3(0.0F, 5.0F, 0.0F));
    EXPECT_EQ(sample(path, 2.5F).position, Vec3(10.0F, 2.5F, 10.0F));
    EXPECT_EQ(sample(path, 3.0F).position, path.points[2].position);
    EXPECT_EQ(sample(path, 99.0F).position, path.points[2].position);
    EXPECT_EQ(sample(path, 99.0F).velocity, Vec3(0.0F, 5.0F, 0.0F));
}

TEST(Sample, PathOfOnePoint)
{
    TimedPath path;
    path.points.unchecked_push_back({Vec3(1.0F, 2.0F, 3.0F), Vec3::Zero(), 0.0F});
    EXPECT_EQ(sample(path, 0.0F).position, Vec3(1.0F, 2.0F, 3.0F));
    EXPECT_EQ(sample(path, 1.0F).position, Vec3(1.0F, 2.0F, 3.0F));
    EXPECT_EQ(arc_length(path), 0.0F);
    EXPECT_EQ(path.duration(), 0.0F);
    EXPECT_EQ(TimedPath{}.duration(), 0.0F);
}

}  // namespace
}  // namespace jink::path
