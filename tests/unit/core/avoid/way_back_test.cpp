// SPDX-License-Identifier: BSD-3-Clause
// The flight back to the nominal path is not that path: the vehicle goes on with its velocity until it has turned.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;

constexpr float kTick = 0.05F;

/// Gap between the own box and an upright box [m]; below 0: contact.
double gap_to(const world::test::Scene& scene, const geometry::Shape& box)
{
    double gap = -1e9;
    for (int i = 0; i < 3; ++i) {
        gap = std::max(gap, std::abs(double(scene.own.position[i]) - double(box.centre[i])) -
                                double(scene.limits.half_extents[i]) - double(box.half[i]));
    }
    return gap;
}

/// Off its leg by 21 m and past a wall that stands beside it: the straight way back is clear, the turn to it is not.
TEST(WayBack, AWallBesideTheFlownPathIsNotTurnedInto)
{
    for (const float speed : {6.0F, 9.0F, 11.6F, 14.0F}) {
        Flight f;
        f.scene.limits.cruise_speed = speed;
        f.scene.limits.max_acceleration = 4.0F;
        f.scene.limits.velocity_lag = 0.25F;
        f.scene.leg(Vec3(-40, 0, 60), Vec3(800, 0, 60), speed);
        f.scene.own.position = Vec3(192, -21.2F, 60);
        f.scene.own.velocity = Vec3(speed, 0, 0);
        f.scene.obstacle(geometry::make_box(Vec3(211.2F, -12.4F, 30), Vec3(1.7F, 7.4F, 60)));
        FakeMethod method = never();
        Supervisor supervisor(Settings{}, method);
        double least = 1e9;
        for (int step = 0; step < 400; ++step) {
            const Guidance g = f.update(supervisor, true);
            least = std::min(least, gap_to(f.scene, f.scene.obstacles[0].shape));
            if (!g.wants_control) {
                break;
            }
            f.pass(g.velocity, kTick);
        }
        EXPECT_GE(least, 0.0) << speed;
    }
}

/// A fixed wing at constant speed, which turns at its acceleration.
void turn(vehicle::VehicleState& own, const Vec3& command, const vehicle::VehicleLimits& limits)
{
    constexpr double kStep = 0.01;
    constexpr double kResponse = 0.4;
    const double speed = double(own.velocity.head<2>().norm());
    for (int i = 0; i < 5; ++i) {
        const double course = std::atan2(double(own.velocity.y()), double(own.velocity.x()));
        const double wanted = std::atan2(double(command.y()), double(command.x()));
        const double most = double(limits.max_acceleration) / speed;
        const double rate = std::clamp(std::remainder(wanted - course, 2.0 * M_PI) / kResponse, -most, most);
        const double now = course + rate * kStep;
        own.velocity = Vec3(float(speed * std::cos(now)), float(speed * std::sin(now)), 0.0F);
        own.position += own.velocity * float(kStep);
    }
    own.yaw = std::atan2(own.velocity.y(), own.velocity.x());
}

/// Closed cylinders near the leg, no traffic: wherever straight on is clear, the turn back is flown clear of them
/// too.
TEST(WayBack, AFixedWingTurnsAroundWhatStandsBesideItsLeg)
{
    std::mt19937 random(20261130);
    const auto draw = [&](double low, double high) {
        return float(std::uniform_real_distribution<>(low, high)(random));
    };
    int flown = 0;
    for (int round = 0; round < 400; ++round) {
        Flight f;
        const float speed = draw(14, 20);
        f.scene.limits.kind = vehicle::VehicleKind::fixed_wing;
        f.scene.limits.cruise_speed = speed;
        f.scene.limits.max_acceleration = draw(4, 6);
        f.scene.limits.velocity_lag = 0.4F;
        f.scene.rules.lookahead = 12.0F;
        f.scene.leg(Vec3(-200, 0, 60), Vec3(1500, 0, 60), speed);
        const float course = draw(-3.14, 3.14);
        f.scene.own.position = Vec3(0, draw(-120, 120), 60);
        f.scene.own.velocity = speed * Vec3(std::cos(course), std::sin(course), 0);
        f.scene.own.yaw = course;
        const float far = draw(2.5, 6.0) * speed;
        const float bearing = draw(-3.14, 3.14);
        const world::Vec2 centre(far * std::cos(bearing), f.scene.own.position.y() + far * std::sin(bearing));
        const float radius = draw(5, 25);
        f.scene.cylinder(centre, radius);
        f.scene.cylinders[0].bottom = -10.0F;
        f.scene.cylinders[0].top = 200.0F;
        f.scene.airspace.cylinders = f.scene.cylinders;
        const auto gap = [&](const Vec3& at) {
            const Vec3& half = f.scene.limits.half_extents;
            const double dx = std::max(0.0, std::abs(double(at.x() - centre.x())) - double(half.x()));
            const double dy = std::max(0.0, std::abs(double(at.y() - centre.y())) - double(half.y()));
            return std::hypot(dx, dy) - double(radius);
        };
        bool clear = true;
        for (int i = 0; i < 200 && clear; ++i) {
            clear = gap(f.scene.own.position + f.scene.own.velocity * (kTick * float(i))) >= 0.5;
        }
        if (!clear) {
            continue;
        }
        ++flown;
        FakeMethod method = never();
        Supervisor supervisor(Settings{}, method);
        double least = 1e9;
        for (int step = 0; step < 800; ++step) {
            const Guidance g = f.update(supervisor, true);
            least = std::min(least, gap(f.scene.own.position));
            if (!g.wants_control) {
                break;
            }
            turn(f.scene.own, g.velocity, f.scene.limits);
            f.scene.now = f.scene.now + kTick;
            f.scene.own.stamp = f.scene.now;
        }
        EXPECT_GE(least, -0.05) << round;
    }
    EXPECT_GT(flown, 300);
}

/// However fast it comes and however badly it brakes, the way back does not lead out of the airspace.
TEST(WayBack, BoundsAreKeptAtAnySpeedThatCanBeBraked)
{
    for (const float speed : {5.0F, 8.0F, 12.0F}) {
        for (const float acceleration : {3.0F, 5.0F}) {
            Flight f;
            f.scene.limits.cruise_speed = speed;
            f.scene.limits.max_acceleration = acceleration;
            f.scene.limits.velocity_lag = 0.4F;
            f.scene.leg(Vec3(-40, 0, 60), Vec3(800, 0, 60), speed);
            f.scene.airspace.has_keep_in = true;
            f.scene.airspace.keep_in_radius = 200.0F;
            f.scene.own.position = Vec3(150, 10, 60);
            f.scene.own.velocity = Vec3(speed, 0, 0);
            FakeMethod method = never();
            Supervisor supervisor(Settings{}, method);
            for (int step = 0; step < 400; ++step) {
                const Guidance g = f.update(supervisor, true);
                const float left =
                    200.0F - f.scene.own.position.head<2>().norm() - f.scene.limits.half_extents.head<2>().norm();
                ASSERT_GE(left, 0.0F) << speed << " " << acceleration << " " << step;
                if (!g.wants_control) {
                    break;
                }
                f.pass(g.velocity, kTick);
            }
        }
    }
    for (const float descent : {3.0F, 6.0F}) {
        Flight f;
        f.scene.limits.cruise_speed = 10.0F;
        f.scene.limits.max_descent = f.scene.limits.max_climb = descent;
        f.scene.limits.max_vertical_acceleration = 2.0F;
        f.scene.limits.velocity_lag = 0.4F;
        f.scene.leg(Vec3(-40, 0, 10), Vec3(800, 0, 10), 10.0F);
        f.scene.airspace.has_floor = true;
        f.scene.airspace.floor = 30.0F;
        f.scene.own.position = Vec3(0, 0, 50);
        f.scene.own.velocity = Vec3(8, 0, -descent);
        FakeMethod method = never();
        Supervisor supervisor(Settings{}, method);
        for (int step = 0; step < 400; ++step) {
            const Guidance g = f.update(supervisor, true);
            ASSERT_GE(f.scene.own.position.z() - f.scene.limits.half_extents.z(), 30.0F) << descent << " " << step;
            if (!g.wants_control) {
                break;
            }
            f.pass(g.velocity, kTick);
        }
    }
}

/// The command of a flight ends at a wall: clear only where the stop, to the last millimetre, is.
TEST(WayBack, TheFinalCheckFollowsAStopToItsEnd)
{
    for (const float lag : {0.0F, 0.25F, 1.0F, 2.0F}) {
        for (int k = 0; k < 20; ++k) {
            const float speed = 4.0F + 0.274F * float(k);
            world::test::Scene scene;
            scene.limits.cruise_speed = 12.0F;
            scene.limits.velocity_lag = lag;
            scene.leg(Vec3(0, 0, 30), Vec3(300, 0, 30), speed);
            scene.own.position = Vec3(0, 0, 30);
            scene.own.velocity = Vec3(speed, 0, 0);
            scene.own.stamp = scene.now;
            world::Manoeuvre manoeuvre;
            manoeuvre.kind = world::ManoeuvreKind::velocity;
            manoeuvre.command = Vec3(speed, 0, 0);
            manoeuvre.start = scene.now;
            constexpr Seconds kSpan = 12.0F;
            path::Prediction flight;
            path::predict_velocity_command(scene.own, manoeuvre.command, kSpan, 0.2F, scene.limits, flight);
            manoeuvre.path = flight.path;
            vehicle::VehicleState own = scene.own;
            vehicle::advance(own, manoeuvre.command, scene.limits, kSpan);
            for (int i = 0; i < 2000; ++i) {
                vehicle::advance(own, Vec3::Zero(), scene.limits, kTick);
            }
            // The wall begins 1 cm before the box has come to rest.
            const float face = own.position.x() + scene.limits.half_extents.x() - 0.01F;
            scene.obstacle(geometry::make_box(Vec3(face + 10.0F, 0, 30), Vec3(10, 10, 30)));
            WorkBudget budget(10'000'000);
            EXPECT_LT(check_manoeuvre(scene.situation(), manoeuvre, Settings{}, budget).margin, 0.0F)
                << lag << " " << speed;
        }
    }
}

/// Straight down at a roof with weak vertical acceleration, and no method that answers: braked for in time.
TEST(Braking, ARoofBelowIsBrakedForWithTheVerticalAcceleration)
{
    for (const float acceleration : {0.5F, 1.0F, 3.0F}) {
        for (const float speed : {3.0F, 5.0F}) {
            for (const float across : {0.0F, 2.0F}) {
                Flight f;
                f.scene.limits.max_vertical_acceleration = acceleration;
                f.scene.limits.max_descent = speed;
                const Vec3 down(across, 0, -speed);
                f.scene.leg(Vec3(0, 0, 60), Vec3(0, 0, 60) + 30.0F * down, down.norm());
                f.scene.own.position = Vec3(0, 0, 60);
                f.scene.own.velocity = down;
                f.scene.obstacle(geometry::make_box(Vec3(0, 0, 5), Vec3(50, 50, 5)));
                FakeMethod method = never();
                Supervisor supervisor(Settings{}, method);
                bool control = false;
                double least = 1e9;
                for (int step = 0; step < 400; ++step) {
                    const Guidance g = f.update(supervisor, control);
                    control = g.wants_control;
                    f.pass(control ? g.velocity : down, kTick);
                    least = std::min(least, gap_to(f.scene, f.scene.obstacles[0].shape));
                }
                EXPECT_GE(least, 0.0) << acceleration << " " << speed << " " << across;
            }
        }
    }
}

/// A planner that needs all of its units still has its answer checked.
TEST(Planning, AnAnswerFoundWithTheLastUnitsIsChecked)
{
    Flight f;
    FakeMethod method{[](const Situation& s, WorkBudget& budget, Manoeuvre& out) {
        static_cast<void>(budget.spend(budget.left()));
        out = detour(s, kLeft, 6.0F, 60.0F);
        return PlanStatus::found;
    }};
    Supervisor supervisor(Settings{}, method);
    EXPECT_EQ(avoid_head_on(f, supervisor).state, State::avoiding);
    EXPECT_EQ(supervisor.diagnostics().answers_rejected, 0U);
}

}  // namespace
}  // namespace jink::avoid
