// SPDX-License-Identifier: BSD-3-Clause
#include "core/vehicle/vehicle.hpp"
#include "firmware/vehicles/uav2/vehicle.hpp"
#include "tests/numbers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace jink::vehicle {
namespace {

TEST(ClampedVelocity, WorkedExampleOfPinheiroFigure310)
{
    const Vec3 velocity = clamped_velocity(Vec3(2.0F, 0.0F, 2.0F), 5.0F, VehicleLimits{});
    EXPECT_NEAR(velocity.x(), 3.0F, 1e-5F);
    EXPECT_NEAR(velocity.y(), 0.0F, 1e-6F);
    EXPECT_FLOAT_EQ(velocity.z(), 3.0F);
    EXPECT_NEAR(velocity.norm(), 4.2426F, 1e-4F);
}

TEST(ClampedVelocity, DescentHasItsOwnLimit)
{
    VehicleLimits limits;
    limits.max_descent = 1.0F;
    EXPECT_FLOAT_EQ(clamped_velocity(-Vec3::UnitZ(), 5.0F, limits).z(), -1.0F);
    EXPECT_FLOAT_EQ(clamped_velocity(Vec3::UnitZ(), 5.0F, limits).z(), 3.0F);
}

TEST(ClampedVelocity, WithinLimitsTheSpeedStays)
{
    EXPECT_FLOAT_EQ(clamped_velocity(Vec3(3.0F, 4.0F, 0.0F), 5.0F, VehicleLimits{}).norm(), 5.0F);
}

TEST(ClampedVelocity, ZeroDirectionGivesZero)
{
    EXPECT_EQ(clamped_velocity(Vec3::Zero(), 5.0F, VehicleLimits{}), Vec3::Zero());
}

TEST(ClampedVelocity, AnyLengthOfDirection)
{
    const VehicleLimits limits;
    const Vec3 expected = clamped_velocity(Vec3(1.0F, -2.0F, 0.5F), 5.0F, limits);
    for (const float length : {1e-37F, 1e-20F, 1e20F, 1e37F}) {
        const Vec3 velocity = clamped_velocity(length * Vec3(1.0F, -2.0F, 0.5F), 5.0F, limits);
        EXPECT_LT((velocity - expected).norm(), 1e-4F) << "length " << length;
    }
}

TEST(StoppingDistance, FullDecelerationThenTheLag)
{
    VehicleLimits limits;
    limits.max_acceleration = 5.0F;
    limits.velocity_lag = 0.2F;
    // From 5 m/s: 0.8 s down to 1 m/s (2.4 m), then 1 m/s * 0.2 s.
    EXPECT_FLOAT_EQ(stopping_distance(5.0F, limits), 2.6F);
    EXPECT_FLOAT_EQ(stopping_distance(0.5F, limits), 0.1F);
    EXPECT_EQ(stopping_distance(0.0F, limits), 0.0F);
    limits.velocity_lag = 0.0F;
    EXPECT_FLOAT_EQ(stopping_distance(5.0F, limits), 2.5F);
}

TEST(StoppingDistance, AgreesWithTheModelFlown)
{
    for (const float lag : {0.0F, 0.02F, 0.25F, 1.5F}) {
        for (const float speed : {0.04F, 0.3F, 2.0F, 5.0F, 15.0F}) {
            VehicleLimits limits;
            limits.velocity_lag = lag;
            VehicleState state;
            state.velocity = Vec3(0.6F * speed, -0.8F * speed, 0.0F);
            const Seconds time = stopping_time(speed, limits);
            if (time > 0.0F) {
                advance(state, Vec3::Zero(), limits, time);
                EXPECT_LE(state.velocity.norm(), kStandstillSpeed * 1.001F) << "lag " << lag << " speed " << speed;
            }
            VehicleState before;
            before.velocity = Vec3(0.6F * speed, -0.8F * speed, 0.0F);
            if (time > 0.02F) {
                advance(before, Vec3::Zero(), limits, time - 0.02F);
                EXPECT_GT(before.velocity.norm(), kStandstillSpeed) << "lag " << lag << " speed " << speed;
            }
            advance(state, Vec3::Zero(), limits, 50.0F);
            EXPECT_NEAR(state.position.norm(), stopping_distance(speed, limits), 1e-4F * (1.0F + speed * speed))
                << "lag " << lag << " speed " << speed;
        }
    }
}

TEST(StoppingTime, NothingToStop)
{
    EXPECT_EQ(stopping_time(0.0F, VehicleLimits{}), 0.0F);
    EXPECT_EQ(stopping_time(kStandstillSpeed, VehicleLimits{}), 0.0F);
}

TEST(Advance, ReachesTheCommandAndMovesTheStamp)
{
    VehicleState state;
    state.stamp = {1'000'000};
    advance(state, Vec3(4.0F, 0.0F, 1.0F), VehicleLimits{}, 0.02F);
    EXPECT_NEAR(static_cast<double>(state.stamp.us), 1'020'000.0, 1.0);
    advance(state, Vec3(4.0F, 0.0F, 1.0F), VehicleLimits{}, 20.0F);
    EXPECT_LT((state.velocity - Vec3(4.0F, 0.0F, 1.0F)).norm(), 1e-4F);
}

TEST(Advance, ClimbAndDescentCommandsAreBounded)
{
    VehicleState state;
    advance(state, Vec3(0.0F, 0.0F, 100.0F), VehicleLimits{}, 20.0F);
    EXPECT_LE(state.velocity.z(), 3.0F + 1e-5F);
    advance(state, Vec3(0.0F, 0.0F, -100.0F), VehicleLimits{}, 20.0F);
    EXPECT_GE(state.velocity.z(), -3.0F - 1e-5F);
}

TEST(Advance, WithoutLagOnlyTheAccelerationBounds)
{
    VehicleLimits limits;
    limits.velocity_lag = 0.0F;
    VehicleState state;
    advance(state, Vec3(5.0F, 0.0F, 0.0F), limits, 0.5F);
    EXPECT_FLOAT_EQ(state.velocity.x(), 2.5F);
    EXPECT_FLOAT_EQ(state.position.x(), 0.625F);
    advance(state, Vec3(5.0F, 0.0F, 0.0F), limits, 1.0F);
    EXPECT_FLOAT_EQ(state.velocity.x(), 5.0F);
    EXPECT_FLOAT_EQ(state.position.x(), 0.625F + 1.875F + 2.5F);
}

TEST(Advance, StandingOnZeroCommandStays)
{
    VehicleState state;
    advance(state, Vec3::Zero(), VehicleLimits{}, 1.0F);
    EXPECT_EQ(state.position, Vec3::Zero());
    EXPECT_EQ(state.velocity, Vec3::Zero());
}

TEST(IsValid, EachLimitIsChecked)
{
    EXPECT_TRUE(is_valid(VehicleLimits{}));
    EXPECT_TRUE(is_valid(uav2_limits()));
    const std::vector<float VehicleLimits::*> positives{&VehicleLimits::cruise_speed, &VehicleLimits::max_climb,
                                                        &VehicleLimits::max_descent, &VehicleLimits::max_acceleration,
                                                        &VehicleLimits::max_vertical_acceleration};
    for (const auto field : positives) {
        for (const float bad : {0.0F, -1.0F, kNan, kInfinity}) {
            VehicleLimits limits;
            limits.*field = bad;
            EXPECT_FALSE(is_valid(limits));
        }
    }
    VehicleLimits limits;
    limits.velocity_lag = 0.0F;
    EXPECT_TRUE(is_valid(limits));
    for (const float bad : {-0.1F, kNan, kInfinity}) {
        limits.velocity_lag = bad;
        EXPECT_FALSE(is_valid(limits));
    }
    for (int axis = 0; axis < 3; ++axis) {
        for (const float bad : {0.0F, -1.0F, kNan, kInfinity}) {
            VehicleLimits box;
            box.half_extents[axis] = bad;
            EXPECT_FALSE(is_valid(box));
        }
    }
}

TEST(IsValid, EachAirframeFigureIsChecked)
{
    EXPECT_TRUE(is_valid(Airframe{}));
    EXPECT_TRUE(is_valid(uav2_airframe()));
    const std::vector<float Airframe::*> positives{&Airframe::mass,         &Airframe::blades, &Airframe::chord,
                                                   &Airframe::rotor_radius, &Airframe::rotors, &Airframe::air_density,
                                                   &Airframe::tip_speed};
    for (const auto field : positives) {
        for (const float bad : {0.0F, -1.0F, kNan, kInfinity}) {
            Airframe airframe;
            airframe.*field = bad;
            EXPECT_FALSE(is_valid(airframe));
        }
    }
    for (const auto field :
         {&Airframe::drag_coefficient, &Airframe::effective_area, &Airframe::blade_drag_coefficient}) {
        Airframe airframe;
        airframe.*field = 0.0F;
        EXPECT_TRUE(is_valid(airframe));
        airframe.*field = -1.0F;
        EXPECT_FALSE(is_valid(airframe));
    }
}

VehicleLimits wing()
{
    VehicleLimits limits;
    limits.kind = VehicleKind::fixed_wing;
    limits.cruise_speed = 18.0F;
    limits.max_climb = limits.max_descent = 2.0F;
    limits.max_acceleration = 4.0F;
    limits.max_vertical_acceleration = 1.0F;
    limits.velocity_lag = 1.2F;
    return limits;
}

// A steep part of a plan asks for 7 m/s; predicted as flown so, a plane of 18 m/s was 40 m ahead after 4 s.
TEST(FixedWing, FliesTheCourseOfASlowCommandAtCruiseSpeed)
{
    VehicleState state;
    state.velocity = Vec3(5.6F, -17.1F, 0.0F);
    const Vec3 command(2.4F, -6.9F, -2.0F);
    for (int i = 0; i < 200; ++i) {
        advance(state, command, wing(), 0.05F);
        EXPECT_NEAR(std::hypot(state.velocity.x(), state.velocity.y()), 18.0F, 0.3F) << i;
    }
    EXPECT_NEAR(state.velocity.x() / state.velocity.y(), command.x() / command.y(), 1e-3F);
    EXPECT_NEAR(state.velocity.z(), -2.0F, 1e-2F);
    EXPECT_GT(state.position.norm(), 170.0F);
    VehicleLimits multirotor = wing();
    multirotor.kind = VehicleKind::multirotor;
    for (int i = 0; i < 200; ++i) {
        advance(state, command, multirotor, 0.05F);
    }
    EXPECT_NEAR((state.velocity - command).norm(), 0.0F, 1e-2F) << "what can fly slowly does";
}

TEST(FixedWing, GoesOnWhereTheCommandHasNoCourse)
{
    for (const Vec3& command : {Vec3(0, 0, 0), Vec3(0.5F, 0.8F, 0), Vec3(0, 0, -1.0F)}) {
        VehicleState state;
        state.velocity = Vec3(-18.0F, 0.0F, 1.0F);
        advance(state, command, wing(), 10.0F);
        EXPECT_NEAR(state.velocity.x(), -18.0F, 1e-3F);
        EXPECT_NEAR(state.velocity.y(), 0.0F, 1e-3F);
        EXPECT_NEAR(state.velocity.z(), command.z(), 1e-2F);
    }
    VehicleState standing;
    advance(standing, Vec3::Zero(), wing(), 1.0F);
    EXPECT_EQ(standing.velocity, Vec3::Zero()) << "no course at all, and finite";
}

TEST(LimitsInFlight, AFixedWingsCruiseSpeedIsTheOneThatItFlies)
{
    EXPECT_FLOAT_EQ(limits_in_flight(wing(), Vec3(0, 22, 2)).cruise_speed, 22.0F);
    EXPECT_FLOAT_EQ(limits_in_flight(wing(), Vec3(9, 0, 0)).cruise_speed, 9.0F);
    EXPECT_FLOAT_EQ(limits_in_flight(wing(), Vec3(8.9F, 0, 2)).cruise_speed, 18.0F) << "on the ground, or hand-held";
    EXPECT_FLOAT_EQ(limits_in_flight(wing(), Vec3(kNan, 22, 0)).cruise_speed, 18.0F);
    VehicleLimits multirotor = wing();
    multirotor.kind = VehicleKind::multirotor;
    EXPECT_FLOAT_EQ(limits_in_flight(multirotor, Vec3(0, 22, 2)).cruise_speed, 18.0F);
}

TEST(Uav2, FiguresOfPinheiroTable45)
{
    EXPECT_EQ(uav2_limits().cruise_speed, 15.0F);
    EXPECT_EQ(uav2_limits().max_climb, 8.0F);
    EXPECT_EQ(uav2_airframe().mass, 10.0F);
    EXPECT_EQ(uav2_airframe().drag_coefficient, 0.8F);
    EXPECT_EQ(uav2_airframe().effective_area, 10.0F);
}

}  // namespace
}  // namespace jink::vehicle
