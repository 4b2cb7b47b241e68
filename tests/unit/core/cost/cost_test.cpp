// SPDX-License-Identifier: BSD-3-Clause
#include "core/cost/cost.hpp"
#include "firmware/vehicles/uav2/vehicle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/numbers.hpp"
#include "tests/oracle/cost_oracle.hpp"

namespace jink::cost {
namespace {

path::TimedPath level(float length, int points = 5)
{
    std::vector<Vec3> positions;
    for (int i = 0; i < points; ++i) {
        positions.emplace_back(length * static_cast<float>(i) / static_cast<float>(points - 1), 0.0F, 0.0F);
    }
    path::TimedPath path;
    EXPECT_TRUE(path::make_timed_path(positions, 5.0F, vehicle::VehicleLimits{}, path));
    return path;
}

TEST(FlightTime, LengthOverSpeed) { EXPECT_FLOAT_EQ(flight_time(level(20.0F)), 4.0F); }

TEST(Energy, LevelFlightPaysDragAlone)
{
    // 1/2 * 0.5 * 1.225 * 2.5 * 20 m * (2 * 5 m/s)^2 / 2
    EXPECT_NEAR(energy(level(20.0F), vehicle::Airframe{}), 765.625F, 0.01F);
}

TEST(Energy, ClimbAndDescentBothPay)
{
    path::TimedPath path;
    const std::vector<Vec3> up_and_down{Vec3::Zero(), Vec3(0.0F, 0.0F, 3.0F), Vec3::Zero()};
    ASSERT_TRUE(path::make_timed_path(up_and_down, 5.0F, vehicle::VehicleLimits{}, path));
    // 3 m/s up, -3 m/s down: the kinetic energy stays, |m g dz| twice; the drag of the first segment vanishes with v1 +
    // v0.
    const float drag = 0.25F * 0.5F * 1.225F * 2.5F * 3.0F * 36.0F;
    EXPECT_NEAR(energy(path, vehicle::Airframe{}), 2.0F * 3.0F * 9.81F * 3.0F + drag, 0.01F);
}

TEST(Energy, HeightAboveTheOriginMakesNoDifference)
{
    std::vector<Vec3> low;
    std::vector<Vec3> high;
    for (int i = 0; i < 40; ++i) {
        const auto x = static_cast<float>(i);
        low.emplace_back(x, 0.0F, std::sin(x));
        high.emplace_back(x, 0.0F, std::sin(x) + 2000.0F);
    }
    path::TimedPath a;
    path::TimedPath b;
    ASSERT_TRUE(path::make_timed_path(low, 5.0F, vehicle::VehicleLimits{}, a));
    ASSERT_TRUE(path::make_timed_path(high, 5.0F, vehicle::VehicleLimits{}, b));
    EXPECT_NEAR(energy(a, {}), energy(b, {}), 1e-3F * energy(a, {}));
}

TEST(Smoothness, StraightLineIsZeroByEveryMethod)
{
    const std::vector<float> x{0.0F, 1.0F, 2.0F, 3.0F};
    const std::vector<float> y(4, 2.0F);
    for (const auto method :
         {SmoothnessMethod::curvature, SmoothnessMethod::deviation, SmoothnessMethod::second_derivative}) {
        EXPECT_EQ(smoothness(x, y, method), 0.0F);
    }
}

TEST(Smoothness, StandardDeviationByHand)
{
    const std::vector<float> x{0.0F, 1.0F, 2.0F, 3.0F};
    const std::vector<float> y{1.0F, 3.0F, 1.0F, 3.0F};
    EXPECT_FLOAT_EQ(smoothness(x, y, SmoothnessMethod::deviation), 1.0F);
}

TEST(Smoothness, MeanSecondDerivativeOfAParabola)
{
    std::vector<float> x;
    std::vector<float> y;
    for (int i = 0; i <= 40; ++i) {
        x.push_back(0.1F * static_cast<float>(i));
        y.push_back(x.back() * x.back());
    }
    // y'' = 2; the one-sided ends give 1 (derivative of the derivative there) in two places and 3/2 beside them.
    EXPECT_NEAR(smoothness(x, y, SmoothnessMethod::second_derivative),
                (37.0F * 2.0F + 2.0F * 1.0F + 2.0F * 1.5F) / 41.0F, 1e-3F);
}

TEST(Smoothness, CurvatureOfACircle)
{
    std::vector<float> x;
    std::vector<float> y;
    for (int i = 0; i <= 200; ++i) {
        const float angle = -0.5F + 0.005F * static_cast<float>(i);
        x.push_back(10.0F * std::sin(angle));
        y.push_back(10.0F * std::cos(angle));
    }
    // kappa = 1/10: 1/100 of the extent in x.
    EXPECT_NEAR(smoothness(x, y, SmoothnessMethod::curvature), 0.01F * 20.0F * std::sin(0.5F), 2e-3F);
}

TEST(Smoothness, FlatCandidatesMeetTheClosedForm)
{
    // For w << D: 54 w^2 / D^3 (simple), 24 w^2 / D^3 (symmetric).
    for (const bool symmetric : {false, true}) {
        const float distance = 10.0F;
        const float offset = 0.1F;
        std::vector<float> x;
        std::vector<float> y;
        for (int i = 0; i < 57; ++i) {
            x.push_back((symmetric ? 2.0F : 1.5F) * distance * static_cast<float>(i) / 56.0F);
            y.push_back(static_cast<float>(oracle::curve(
                symmetric, static_cast<double>(offset), static_cast<double>(distance), static_cast<double>(x.back()))));
        }
        const float exact = (symmetric ? 24.0F : 54.0F) * offset * offset / (distance * distance * distance);
        const float share = smoothness(x, y, SmoothnessMethod::curvature) / exact;
        EXPECT_NEAR(share, symmetric ? 0.91F : 0.93F, 0.01F) << "symmetric " << symmetric;
        std::printf("[ measured ] numerical over exact smoothness, %s: %.4f\n", symmetric ? "symmetric" : "simple",
                    static_cast<double>(share));
    }
}

TEST(PenalisedSmoothness, NothingLevelTwiceUpright)
{
    EXPECT_EQ(penalised_smoothness(0.4F, 0.0F, 1.0F), 0.4F);
    EXPECT_EQ(penalised_smoothness(0.4F, 1.0F, 1.0F), 0.8F);
    EXPECT_EQ(penalised_smoothness(0.4F, -1.0F, 1.0F), 0.8F);
    EXPECT_EQ(penalised_smoothness(0.4F, 0.5F, 2.0F), 0.8F);
}

TEST(Closeness, ThreatAtRestByHand)
{
    // Waypoints at x = 0, 5, 10, 15, 20; threat 3 m to the side of the middle one.
    const geometry::Motion threat{Vec3(10.0F, 3.0F, 0.0F), Vec3::Zero()};
    const float mean = (2.0F * std::hypot(10.0F, 3.0F) + 2.0F * std::hypot(5.0F, 3.0F) + 3.0F) / 5.0F;
    const float expected = 1.0F / (0.5F * (mean - 1.0F) + 0.5F * 2.0F);
    EXPECT_FLOAT_EQ(closeness(level(20.0F), threat, 1.0F, ClosenessMethod::swept, 4.0F), expected);
    EXPECT_FLOAT_EQ(closeness(level(20.0F), threat, 1.0F, ClosenessMethod::time_aware), expected);
}

TEST(Closeness, SweptSeesThePathTimeAwareTheInstant)
{
    // A threat that crosses the path at x = 10 after 8 s, when the vehicle is gone.
    const geometry::Motion late{Vec3(10.0F, -8.0F, 0.0F), Vec3(0.0F, 1.0F, 0.0F)};
    EXPECT_GT(closeness(level(20.0F), late, 1.0F, ClosenessMethod::swept, 10.0F),
              closeness(level(20.0F), late, 1.0F, ClosenessMethod::time_aware));
    // Swept for 4 s only, its path ends 4 m short.
    EXPECT_LT(closeness(level(20.0F), late, 1.0F, ClosenessMethod::swept, 4.0F),
              closeness(level(20.0F), late, 1.0F, ClosenessMethod::swept, 10.0F));
}

TEST(Closeness, ContactIsInfinity)
{
    const geometry::Motion large{Vec3(10.0F, 0.0F, 0.0F), Vec3::Zero()};
    EXPECT_EQ(closeness(level(20.0F), large, 12.0F, ClosenessMethod::swept, 4.0F), kInfinity);
    EXPECT_EQ(closeness(level(20.0F), large, 12.0F, ClosenessMethod::time_aware), kInfinity);
}

TEST(CombinedCloseness, HalfGreatestHalfMean)
{
    EXPECT_EQ(combined_closeness({}), 0.0F);
    const std::vector<float> one{0.4F};
    EXPECT_FLOAT_EQ(combined_closeness(one), 0.4F);
    const std::vector<float> three{0.1F, 0.5F, 0.3F};
    EXPECT_FLOAT_EQ(combined_closeness(three), 0.4F);
    const std::vector<float> contact{0.1F, kInfinity};
    EXPECT_EQ(combined_closeness(contact), kInfinity);
}

TEST(RotorPower, HoverByHand)
{
    // W = 29.43 N, A = 0.45604 m2, v_h = 5.1324 m/s, sigma = 0.11696.
    vehicle::Airframe airframe;
    airframe.blade_drag_coefficient = 0.0F;
    EXPECT_NEAR(rotor_power(0.0F, airframe), 1.15F * 29.43F * 5.1324F, 0.02F);
    airframe.blade_drag_coefficient = 0.5F;
    airframe.tip_speed = 272.2F;
    EXPECT_NEAR(rotor_power(0.0F, airframe) - 1.15F * 29.43F * 5.1324F, 82365.0F, 20.0F);
}

TEST(RotorPower, ContinuousAtHover)
{
    vehicle::Airframe airframe;
    airframe.blade_drag_coefficient = 0.0F;
    const float hover = rotor_power(0.0F, airframe);
    EXPECT_NEAR(rotor_power(1e-4F, airframe), hover, 0.01F);
    EXPECT_NEAR(rotor_power(-1e-4F, airframe), hover, 0.01F);
}

TEST(RotorPower, TheSourceJumpsAtTwiceTheInducedVelocity)
{
    // The quartic gives v_d = 1.176 v_h at V = -2 v_h, momentum theory 1.15 v_h (k_i v_h).
    vehicle::Airframe airframe;
    airframe.blade_drag_coefficient = 0.0F;
    const float hover = std::sqrt(29.43F / (2.0F * 1.225F * 4.0F * kPi * 0.1905F * 0.1905F));
    const float jump = rotor_power(-1.999999F * hover, airframe) - rotor_power(-2.000001F * hover, airframe);
    EXPECT_NEAR(jump, 0.026F * hover * 29.43F, 0.25F);
}

TEST(RotorPower, ClimbCostsMoreDescentInMomentumTheoryLess)
{
    const vehicle::Airframe airframe;
    EXPECT_GT(rotor_power(3.0F, airframe), rotor_power(1.0F, airframe));
    EXPECT_GT(rotor_power(1.0F, airframe), rotor_power(0.0F, airframe));
    EXPECT_LT(rotor_power(-15.0F, airframe), rotor_power(0.0F, airframe));
}

/// Small quadrotors of 3 kg hover at 60 to 120 W per kilogram.
TEST(RotorPower, TheDefaultVehicleHoversAtSomeHundredsOfWatts)
{
    EXPECT_GT(rotor_power(0.0F, {}), 180.0F);
    EXPECT_LT(rotor_power(0.0F, {}), 360.0F);
}

TEST(HoverPower, IsAMeanWhateverTheNumberOfPoints)
{
    EXPECT_NEAR(hover_power(level(20.0F, 5), {}), rotor_power(0.0F, {}), 0.1F);
    EXPECT_NEAR(hover_power(level(20.0F, 50), {}), rotor_power(0.0F, {}), 0.1F);
}

TEST(HoverPower, ASegmentCountsByItsTime)
{
    path::TimedPath path = level(20.0F, 3);
    path.points[1].velocity.z() = 3.0F;
    path.points[1].time = path.points[0].time + 0.25F * (path.points[2].time - path.points[0].time);
    EXPECT_NEAR(hover_power(path, {}), 0.25F * rotor_power(0.0F, {}) + 0.75F * rotor_power(3.0F, {}), 0.1F);
}

TEST(Normalise, TableLimitsAndClipping)
{
    const Caps caps;
    Terms terms;
    terms.time = 1.2530F;
    terms.energy = 249.59F;
    terms.smoothness = std::exp(-3.0F);
    terms.smoothness_penalised = std::exp(-3.0F);
    terms.closeness = std::exp(-3.0F);
    NormalisedTerms n = normalise(terms, caps);
    EXPECT_NEAR(n.time, 0.0F, 1e-6F);
    EXPECT_NEAR(n.energy, 0.0F, 1e-6F);
    EXPECT_NEAR(n.smoothness, 0.0F, 1e-6F);
    EXPECT_NEAR(n.smoothness_penalised, 0.0F, 1e-6F);
    EXPECT_NEAR(n.closeness, 0.0F, 1e-6F);
    terms = {7.0814F, 1.0F, 1.0F, 1.0F, 1759.0F, 0.0F};
    n = normalise(terms, caps);
    EXPECT_NEAR(n.time, (7.0814F - 1.2530F) / (1.15F * 7.0814F - 1.2530F), 1e-6F);
    EXPECT_NEAR(n.energy, 1.0F, 1e-6F);
    EXPECT_NEAR(n.smoothness, 3.0F / 5.5F, 1e-6F);
    EXPECT_NEAR(n.smoothness_penalised, 0.5F, 1e-6F);
    EXPECT_NEAR(n.closeness, 3.0F / 3.001F, 1e-6F);
    terms = {0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F};
    n = normalise(terms, caps);
    EXPECT_EQ(n.time + n.energy + n.smoothness + n.smoothness_penalised + n.closeness, 0.0F);
    terms = {1e9F, 1e9F, 1e9F, kInfinity, 1e9F, 0.0F};
    n = normalise(terms, caps);
    EXPECT_EQ(n.time, 1.0F);
    EXPECT_EQ(n.energy, 1.0F);
    EXPECT_EQ(n.smoothness, 1.0F);
    EXPECT_EQ(n.smoothness_penalised, 1.0F);
    EXPECT_EQ(n.closeness, 1.0F);
}

TEST(Total, WeightsOfEquation435)
{
    NormalisedTerms n;
    n.smoothness_penalised = 1.0F;
    EXPECT_FLOAT_EQ(total(n, {}), 0.30F);
    n = {};
    n.time = 1.0F;
    EXPECT_FLOAT_EQ(total(n, {}), 0.20F);
    n = {};
    n.closeness = 1.0F;
    EXPECT_FLOAT_EQ(total(n, {}), 0.50F);
    n = {.time = 0.0F, .smoothness = 1.0F, .smoothness_penalised = 0.0F, .closeness = 0.0F, .energy = 1.0F};
    EXPECT_EQ(total(n, {}), 0.0F);
}

TEST(WeightsValid, TheSevenTriedAndTheBounds)
{
    for (const Weights& weights : kTriedWeights) {
        EXPECT_TRUE(is_valid(weights));
    }
    EXPECT_FALSE(is_valid(Weights{0.30F, 0.20F, 0.40F}));  // sum
    EXPECT_FALSE(is_valid(Weights{0.10F, 0.15F, 0.75F}));  // closeness
    EXPECT_FALSE(is_valid(Weights{0.45F, 0.05F, 0.50F}));  // time
    EXPECT_FALSE(is_valid(Weights{-0.10F, 0.60F, 0.50F}));
    EXPECT_FALSE(is_valid(Weights{0.80F, 0.30F, -0.10F}));
    EXPECT_FALSE(is_valid(Weights{kNan, 0.20F, 0.50F}));
    EXPECT_FALSE(is_valid(Weights{0.30F, kNan, 0.50F}));
    EXPECT_FALSE(is_valid(Weights{0.30F, 0.20F, kNan}));
}

TEST(CapsValid, OrderAndFiniteness)
{
    EXPECT_TRUE(is_valid(Caps{}));
    EXPECT_FALSE(is_valid(Caps{9.0F, 7.0F, 249.59F, 1759.0F}));
    EXPECT_FALSE(is_valid(Caps{1.0F, 7.0F, 1759.0F, 1759.0F}));
    EXPECT_FALSE(is_valid(Caps{-1.0F, 7.0F, 249.59F, 1759.0F}));
    EXPECT_FALSE(is_valid(Caps{1.0F, kInfinity, 249.59F, 1759.0F}));
    EXPECT_FALSE(is_valid(Caps{1.0F, 7.0F, kNan, 1759.0F}));
}

TEST(ReferenceFlights, LowerEnergyIsThePublishedMinimum)
{
    const Caps flown = reference_flights({}, {});
    EXPECT_NEAR(flown.energy_low, 249.59F, 0.005F * 249.59F);
    // The published 1.2530 s is this flight without its last segment (geometric planner, section 8).
    EXPECT_NEAR(flown.time_low, 1.305F, 0.002F);
    const oracle::Vehicle vehicle;
    const double plane = std::numbers::pi / 2.0;
    const oracle::Flight upper =
        oracle::fly(oracle::candidate({}, {8.25, 0.0, -1.75}, std::hypot(8.25, 1.75), false, plane, -9.6, 57), vehicle);
    EXPECT_NEAR(static_cast<double>(flown.time_high), upper.t.back(), 1e-3);
    EXPECT_NEAR(static_cast<double>(flown.energy_high), oracle::energy(upper, vehicle), 0.1);
}

TEST(CapsFor, DefaultVehicleKeepsThePublishedCaps)
{
    const Caps caps = caps_for({}, {});
    EXPECT_FLOAT_EQ(caps.time_low, 1.2530F);
    EXPECT_FLOAT_EQ(caps.time_high, 7.0814F);
    EXPECT_FLOAT_EQ(caps.energy_low, 249.59F);
    EXPECT_FLOAT_EQ(caps.energy_high, 1759.0F);
}

TEST(CapsFor, SecondVehicleIsFasterAndThirstier)
{
    const Caps caps = caps_for(vehicle::uav2_limits(), vehicle::uav2_airframe());
    EXPECT_TRUE(is_valid(caps));
    EXPECT_NEAR(caps.time_low, 1.2530F / 3.0F, 1e-3F);  // level: the ratio of cruise speeds
    EXPECT_LT(caps.time_high, 7.0814F / 2.0F);
    // Level at constant speed: C_D A_e v^2 alone.
    EXPECT_NEAR(caps.energy_low, 249.59F * (0.8F * 10.0F * 9.0F) / (0.5F * 2.5F), 1.0F);
}

}  // namespace
}  // namespace jink::cost
