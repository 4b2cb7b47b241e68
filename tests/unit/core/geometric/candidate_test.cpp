// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometric/candidate.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/geometric/planner.hpp"

namespace jink::geometric {
namespace {

TEST(PathFrame, LevelLegHasYToTheLeftAndZUp)
{
    const PathFrame frame = make_path_frame(Vec3(1.0F, 2.0F, 3.0F), Vec3(7.0F, 0.0F, 0.0F));
    EXPECT_EQ(frame.origin, Vec3(1.0F, 2.0F, 3.0F));
    EXPECT_TRUE(frame.axes.isApprox(Mat3::Identity()));
}

TEST(PathFrame, ClimbingLegKeepsYLevel)
{
    const PathFrame frame = make_path_frame(Vec3::Zero(), Vec3(3.0F, 4.0F, 5.0F));
    EXPECT_NEAR(frame.axes.col(1).z(), 0.0F, 1e-7F);
    EXPECT_GT(frame.axes.col(2).z(), 0.0F);
    EXPECT_TRUE(frame.axes.isUnitary(1e-5F));
    EXPECT_NEAR(frame.axes.determinant(), 1.0F, 1e-5F);
}

TEST(PathFrame, VerticalLegTakesNorthForY)
{
    for (const float up : {1.0F, -1.0F}) {
        const PathFrame frame = make_path_frame(Vec3::Zero(), Vec3(0.0F, 0.0F, up));
        EXPECT_EQ(frame.axes.col(0), Vec3(0.0F, 0.0F, up));
        EXPECT_EQ(frame.axes.col(1), Vec3::UnitY());
        EXPECT_NEAR(frame.axes.determinant(), 1.0F, 1e-6F);
    }
    const PathFrame nearly = make_path_frame(Vec3::Zero(), Vec3(1e-6F, 2e-6F, 1.0F));
    EXPECT_TRUE(nearly.axes.isUnitary(1e-5F));
}

TEST(PathFrame, AnyLengthOfDirection)
{
    for (const float length : {1e-30F, 1.0F, 1e30F}) {
        const PathFrame frame = make_path_frame(Vec3::Zero(), length * Vec3(1.0F, -1.0F, 0.5F));
        EXPECT_TRUE(frame.axes.isUnitary(1e-5F)) << length;
    }
}

TEST(PathFrame, AcrossIsTakenAsFarAsItIsAcross)
{
    // Along the world's axes and between them, for any lengths.
    for (const Vec3& x : {Vec3(1.0F, 0.0F, 0.0F), Vec3(0.0F, 0.0F, -1.0F), Vec3(0.6F, -0.8F, 0.0F)}) {
        for (const Vec3& aside : {Vec3(0.0F, 1.0F, 0.0F), Vec3(1.0F, 0.0F, 0.0F), Vec3(0.3F, 2.0F, -1.0F)}) {
            const Vec3 y = (aside - aside.dot(x) * x);
            if (y.norm() < 1e-3F) {
                continue;
            }
            for (const float length : {1e-25F, 1.0F, 1e25F}) {
                const PathFrame frame = make_path_frame(Vec3::Ones(), length * x, length * (aside + 0.5F * x));
                EXPECT_EQ(frame.origin, Vec3::Ones());
                EXPECT_TRUE(frame.axes.col(0).isApprox(x, 1e-6F)) << length;
                EXPECT_TRUE(frame.axes.col(1).isApprox(y.normalized(), 1e-6F)) << length;
                EXPECT_TRUE(frame.axes.isUnitary(1e-5F));
                EXPECT_NEAR(frame.axes.determinant(), 1.0F, 1e-5F);
            }
        }
    }
}

TEST(Curve, MeetsItsDefinition)
{
    const float distance = 8.0F;
    for (const float offset : {-5.0F, 2.0F, 9.6F}) {
        const CandidateShape simple{Family::simple, 0.0F, offset};
        const CandidateShape symmetric{Family::symmetric, 0.0F, offset};
        EXPECT_EQ(curve_offset(simple, distance, 0.0F), 0.0F);
        EXPECT_FLOAT_EQ(curve_offset(simple, distance, distance), offset);
        EXPECT_NEAR(curve_offset(simple, distance, 1.5F * distance), 0.0F, 1e-5F);
        EXPECT_FLOAT_EQ(curve_offset(symmetric, distance, distance), offset);
        EXPECT_NEAR(curve_offset(symmetric, distance, 2.0F * distance), 0.0F, 1e-5F);
        for (float s = 0.0F; s <= distance; s += 0.5F) {
            // Pinheiro's polynomial: a s^3 + b s^2, a = -2 w / D^3, b = 3 w / D^2 (Pinheiro eq. 3.1 to 3.4).
            const float a = -2.0F * offset / (distance * distance * distance);
            const float b = 3.0F * offset / (distance * distance);
            EXPECT_NEAR(curve_offset(simple, distance, s), a * s * s * s + b * s * s, 1e-4F);
            EXPECT_NEAR(curve_offset(symmetric, distance, 2.0F * distance - s), curve_offset(symmetric, distance, s),
                        1e-5F);
            EXPECT_EQ(curve_offset({Family::simple, 0.0F, -offset}, distance, s), -curve_offset(simple, distance, s));
        }
    }
    EXPECT_FLOAT_EQ(curve_length_x(Family::simple, 8.0F), 12.0F);
    EXPECT_FLOAT_EQ(curve_length_x(Family::symmetric, 8.0F), 16.0F);
}

TEST(Curve, ContinuousWithItsSlope)
{
    const float h = 1e-3F;
    for (const Family family : kCurves) {
        // |y''| is 12 at most on the simple curve, 10 / sqrt(3) on the smooth one, and that over kPlateauRise^2.
        const float bend = family == Family::plateau ? 38.0F : 13.0F;
        const float end = curve_length_x(family, 1.0F);
        for (float u = 2.0F * h; u < end - 2.0F * h; u += h) {
            const float before = (unit_offset(family, u) - unit_offset(family, u - h)) / h;
            const float after = (unit_offset(family, u + h) - unit_offset(family, u)) / h;
            ASSERT_LT(std::abs(after - before), bend * h) << to_string(family) << " at u " << u;
        }
        EXPECT_NEAR(unit_offset(family, h) / h, 0.0F, 4.0F * h);
    }
    // It rejoins the leg at a slope of -4.5 w / D (simple).
    EXPECT_NEAR((unit_offset(Family::simple, 1.5F) - unit_offset(Family::simple, 1.5F - h)) / h, -4.5F, 0.02F);
}

double unit_offset_in_double(Family family, double u)
{
    const double back = u > 1.0 ? 2.0 - u : u;
    const double v = family == Family::plateau ? std::min(back / static_cast<double>(kPlateauRise), 1.0) : back;
    return std::pow(v, 3.0) * (10.0 - 15.0 * v + 6.0 * v * v);
}

TEST(Curve, SmoothAndPlateauLeaveAndMeetTheLegAlongItAndWithoutCurvature)
{
    for (const Family family : {Family::smooth, Family::plateau}) {
        constexpr double kStep = 1e-4;
        const auto f = [&](double u) { return unit_offset_in_double(family, u); };
        for (double u = 0.0; u <= 2.0; u += 0.01) {
            ASSERT_NEAR(static_cast<double>(unit_offset(family, static_cast<float>(u))), f(u), 3e-6) << u;
        }
        EXPECT_EQ(unit_offset(family, 0.0F), 0.0F);
        EXPECT_EQ(unit_offset(family, 1.0F), 1.0F);
        EXPECT_EQ(unit_offset(family, 2.0F), 0.0F);
        for (const double end : {0.0, 2.0}) {
            const double inwards = end > 0.0 ? -1.0 : 1.0;
            const double slope = (f(end + inwards * kStep) - f(end)) / kStep;
            const double bend =
                (f(end + 2.0 * inwards * kStep) - 2.0 * f(end + inwards * kStep) + f(end)) / (kStep * kStep);
            EXPECT_NEAR(slope, 0.0, 1e-5) << to_string(family) << " at " << end;
            EXPECT_NEAR(bend, 0.0, 0.2) << to_string(family) << " at " << end;  // 60 kStep / kPlateauRise^3 at most
        }
        // Without a jump of curvature anywhere: third derivatives stay below 60 / kPlateauRise^3.
        for (double u = 3.0 * kStep; u < 2.0 - 3.0 * kStep; u += 0.003) {
            const auto second = [&](double x) { return (f(x + kStep) - 2.0 * f(x) + f(x - kStep)) / (kStep * kStep); };
            ASSERT_LT(std::abs(second(u + kStep) - second(u)) / kStep, 1000.0) << to_string(family) << " at " << u;
        }
    }
    EXPECT_EQ(unit_offset(Family::plateau, 0.7F), 1.0F);
    EXPECT_EQ(unit_offset(Family::plateau, 1.5F), 1.0F);
    EXPECT_EQ(unit_offset(Family::wait, 0.7F), 0.0F);
}

TEST(MakeCandidatePath, IsThePathOfTheRule)
{
    Problem problem;
    problem.frame = make_path_frame(Vec3(100.0F, -50.0F, 30.0F), Vec3(2.0F, 1.0F, 0.4F));
    problem.distance = 9.0F;
    problem.main_radius = 1.0F;
    const vehicle::VehicleLimits limits;
    const CandidateShape shape{Family::symmetric, 2.0F, -3.0F};
    path::TimedPath path;
    ASSERT_TRUE(make_candidate_path(problem, shape, 25, limits, path));
    ASSERT_EQ(path.points.size(), 25U);
    const Vec3 side = std::cos(2.0F) * problem.frame.axes.col(1) + std::sin(2.0F) * problem.frame.axes.col(2);
    std::vector<Vec3> positions;
    for (int i = 0; i < 25; ++i) {
        const float s = 18.0F * static_cast<float>(i) / 24.0F;
        positions.push_back(problem.frame.origin + s * problem.frame.axes.col(0) + curve_offset(shape, 9.0F, s) * side);
    }
    path::TimedPath expected;
    ASSERT_TRUE(path::make_timed_path(positions, problem.speed, limits, expected));
    for (std::size_t i = 0; i < 25; ++i) {
        EXPECT_LT((path.points[i].position - expected.points[i].position).norm(), 1e-4F) << i;
        EXPECT_LT((path.points[i].velocity - expected.points[i].velocity).norm(), 1e-3F) << i;
        EXPECT_NEAR(path.points[i].time, expected.points[i].time, 1e-4F) << i;
    }
}

TEST(MakeCandidatePath, RefusesBadInput)
{
    Problem problem;
    problem.distance = 9.0F;
    problem.main_radius = 1.0F;
    path::TimedPath path;
    const vehicle::VehicleLimits limits;
    EXPECT_TRUE(make_candidate_path(problem, {}, 8, limits, path));
    EXPECT_FALSE(make_candidate_path(problem, {}, 7, limits, path));
    EXPECT_FALSE(make_candidate_path(problem, {}, kMaxPathPoints + 1, limits, path));
    EXPECT_FALSE(make_candidate_path(problem, {Family::simple, NAN, 1.0F}, 25, limits, path));
    EXPECT_FALSE(make_candidate_path(problem, {Family::simple, 0.0F, NAN}, 25, limits, path));
    problem.distance = 0.0F;
    EXPECT_FALSE(make_candidate_path(problem, {}, 25, limits, path));
}

}  // namespace
}  // namespace jink::geometric
