// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/nominal_paths.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>

#include "tests/property/core/geometry/oracle.hpp"

// The turn rate of measured motion, and the arc that comes of it, against double precision and the C library.

namespace jink::app {
namespace {

using geometry::oracle::case_count;
using geometry::oracle::seed_of;
using Vec3d = Eigen::Vector3d;

constexpr Seconds kSampleTime = 0.1F;  ///< each of them is a sample
constexpr std::size_t kFitted = 11;    ///< samples within the window
constexpr double kExactHalfTurn = 3.14159265358979323846;

/// Slope of the line fitted to the headings, counter-clockwise [rad/s].
double fitted_rate(const std::array<Vec3, kFitted>& velocities)
{
    std::array<double, kFitted> heading{};
    double t_mean = 0.0;
    double h_mean = 0.0;
    for (std::size_t i = 0; i < kFitted; ++i) {
        const double angle = std::atan2(double(velocities[i].y()), double(velocities[i].x()));
        heading[i] = i == 0 ? angle : heading[i - 1] + std::remainder(angle - heading[i - 1], 2.0 * kExactHalfTurn);
        t_mean += 0.1 * double(i) / double(kFitted);
        h_mean += heading[i] / double(kFitted);
    }
    double covariance = 0.0;
    double variance = 0.0;
    for (std::size_t i = 0; i < kFitted; ++i) {
        covariance += (0.1 * double(i) - t_mean) * (heading[i] - h_mean);
        variance += (0.1 * double(i) - t_mean) * (0.1 * double(i) - t_mean);
    }
    return covariance / variance;
}

struct Turning {
    NominalPaths paths;
    vehicle::VehicleState own;
    std::array<Vec3, kFitted> velocities;

    explicit Turning(Random& random)
    {
        const float speed = random.uniform(1.5F, 30.0F);
        const float rate = random.uniform(-3.0F, 3.0F);
        const float noise = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 0.2F);
        const float climb = random.below(2) == 0 ? 0.0F : random.uniform(-2.0F, 2.0F);
        const float first = random.uniform(-3.0F, 3.0F);
        own.position = Vec3(random.uniform(-500.0F, 500.0F), random.uniform(-500.0F, 500.0F), 50.0F);
        own.stamp.us = 1'000'000;
        for (std::size_t i = 0; i < kFitted + 3; ++i) {
            const float heading = first + rate * kSampleTime * static_cast<float>(i);
            own.velocity = Vec3(speed * std::cos(heading) + random.uniform(-noise, noise),
                                speed * std::sin(heading) + random.uniform(-noise, noise), climb);
            own.stamp.us += 100'000;
            if (i >= 3) {
                velocities[i - 3] = own.velocity;
            }
            paths.update(own, own, nullptr, {}, false);
        }
    }
};

TEST(TurnRate, IsTheSlopeOfTheHeadings)
{
    const std::uint64_t seed = seed_of(20261127);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t turning = 0;
    for (std::size_t i = 0; i < case_count(20'000); ++i) {
        const Turning flight(random);
        const double exact = fitted_rate(flight.velocities);
        if (std::abs(exact) < double(MotionEstimate::kMinTurn) - 1e-5) {
            ASSERT_EQ(flight.paths.turn_rate(), 0.0F) << "case " << i;
        } else if (std::abs(exact) > double(MotionEstimate::kMinTurn) + 1e-5) {
            ASSERT_NEAR(double(flight.paths.turn_rate()), exact, 1e-5) << "case " << i;
            ++turning;
        }
    }
    EXPECT_GT(turning, case_count(20'000) / 2);
}

TEST(TurnRate, ASlowSampleWithinTheWindowIsNoTurn)
{
    for (const float least : {0.0F, 0.5F, 0.99F}) {
        NominalPaths paths;
        vehicle::VehicleState own;
        for (int i = 0; i < 40; ++i) {
            const auto angle = 0.2F * static_cast<float>(i);
            const float speed = i % 11 == 5 ? least : 5.0F;
            own.velocity = Vec3(speed * std::cos(angle), speed * std::sin(angle), 0.0F);
            own.stamp.us += 100'000;
            paths.update(own, own, nullptr, {}, false);
            ASSERT_EQ(paths.turn_rate(), 0.0F) << "a sample of the window is slower than kMoving: " << least;
        }
    }
}

TEST(TurnRate, ItsPathLiesOnTheExactCircleAndLeavesAtHalfATurn)
{
    const std::uint64_t seed = seed_of(20261128);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t arcs = 0;
    for (std::size_t i = 0; i < case_count(5'000); ++i) {
        const Turning flight(random);
        const path::RouteView route = flight.paths.primary().route();
        if (!route.segments().front().is_arc()) {
            continue;
        }
        ++arcs;
        const Vec3d position = flight.own.position.cast<double>();
        const Vec3d level(double(flight.own.velocity.x()), double(flight.own.velocity.y()), 0.0);
        const double rate = double(flight.paths.turn_rate());
        const Vec3d centre = position + Vec3d(-level.y(), level.x(), 0.0) / rate;
        const double radius = level.norm() / std::abs(rate);
        for (double turned = 0.0; turned < kExactHalfTurn; turned += 0.3) {
            const Vec3d exact =
                centre + Eigen::AngleAxisd(std::copysign(turned, rate), Vec3d::UnitZ()) * (position - centre);
            const Vec3d ours = route.at(static_cast<float>(turned * radius)).position.cast<double>();
            ASSERT_LT((ours - exact).norm(), 1e-3) << "case " << i << " after " << turned;
        }
        const Vec3 out = route.at(static_cast<float>(kExactHalfTurn * radius) + 10.0F).along;
        const Vec3d back = -flight.own.velocity.cast<double>();
        ASSERT_GT(out.cast<double>().head<2>().normalized().dot(back.head<2>().normalized()), 0.99999) << "case " << i;
    }
    EXPECT_GT(arcs, case_count(5'000) / 4);
}

}  // namespace
}  // namespace jink::app
