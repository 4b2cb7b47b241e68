// SPDX-License-Identifier: BSD-3-Clause
// NominalPaths: the expected path of a vehicle that turns, is static, leaves its leg, or flies faster than the
// parameter.
#include "firmware/app/nominal_paths.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/world/conflict.hpp"
#include "tests/oracle/reference_ends.hpp"

namespace jink::app {
namespace {

class NominalPathsTest : public ::testing::Test {
protected:
    NominalPathsTest() { own.position = Vec3(0, 0, 50); }

    void update(bool in_control = false)
    {
        own.stamp = now;
        paths.update(own, own, has_leg ? &leg : nullptr, limits, in_control);
    }
    /// Flies at `velocity`, which turns at `rate` [rad/s], for `span`.
    void fly(Vec3 velocity, Seconds span, float rate = 0.0F, bool in_control = false)
    {
        constexpr Seconds kDt = 0.02F;
        for (Seconds t = 0.0F; t < span; t += kDt) {
            const float c = std::cos(rate * kDt);
            const float s = std::sin(rate * kDt);
            velocity = Vec3(c * velocity.x() - s * velocity.y(), s * velocity.x() + c * velocity.y(), velocity.z());
            own.velocity = velocity;
            own.position += kDt * velocity;
            now = now + kDt;
            update(in_control);
        }
    }
    /// Where the path leads in `t` seconds, from the own position.
    [[nodiscard]] static Vec3 ahead(const world::Reference& r, Seconds t)
    {
        return r.route().at(std::min(r.speed * t, r.route().length())).position;
    }

    NominalPaths paths;
    vehicle::VehicleState own;
    vehicle::VehicleLimits limits;
    world::Leg leg{Vec3(0, 0, 50), Vec3(500, 0, 50), 0.0F};
    bool has_leg = true;
    TimePoint now{1'000'000};
};

TEST_F(NominalPathsTest, WithoutALegTheMotionIsTheOnlyOne)
{
    has_leg = false;
    fly(Vec3(3, 4, 0), 0.2F);
    EXPECT_EQ(paths.other(), nullptr);
    EXPECT_TRUE(paths.primary().valid);
    EXPECT_TRUE(paths.primary().measured);
    EXPECT_LT((ahead(paths.primary(), 2.0F) - own.position - Vec3(6, 8, 0)).norm(), 1e-3F);
}

TEST_F(NominalPathsTest, TheMotionStandsBesideABelievedLeg)
{
    fly(Vec3(5, 0, 0), 2.0F);
    EXPECT_EQ(end_of(paths.primary()), leg.end);
    EXPECT_FALSE(paths.primary().measured);
    ASSERT_NE(paths.other(), nullptr);
    EXPECT_TRUE(paths.other()->measured);
    EXPECT_LT((ahead(*paths.other(), 2.0F) - own.position - Vec3(10, 0, 0)).norm(), 1e-3F);
}

TEST_F(NominalPathsTest, StandingItStays)
{
    update();
    ASSERT_NE(paths.other(), nullptr);
    EXPECT_EQ(end_of(*paths.other()), own.position);
    EXPECT_EQ(paths.other()->route().segments().size(), 1U);
    EXPECT_EQ(paths.primary().speed, limits.cruise_speed) << "from rest by the parameter";
}

TEST_F(NominalPathsTest, ATurnIsAnArcOfHalfATurnThenStraightOn)
{
    has_leg = false;
    for (const float rate : {0.5F, -0.5F}) {
        paths.reset();
        now = now + 5.0F;
        fly(Vec3(5, 0, 0), 1.5F, rate);
        EXPECT_NEAR(paths.turn_rate(), rate, 0.01F);
        ASSERT_TRUE(turns(paths.primary()));
        const world::Reference& r = paths.primary();
        const Vec3 forward = own.velocity / 5.0F;
        const Vec3 inwards = std::copysign(1.0F, rate) * Vec3(-forward.y(), forward.x(), 0.0F);
        const float radius = 5.0F / std::abs(rate);
        const auto on_circle = [&](Seconds t) {
            const float angle = std::abs(rate) * t;
            return Vec3(own.position + radius * (std::sin(angle) * forward + (1.0F - std::cos(angle)) * inwards));
        };
        EXPECT_LT((ahead(r, 2.0F) - on_circle(2.0F)).norm(), 0.3F);
        EXPECT_LT((ahead(r, 5.0F) - on_circle(5.0F)).norm(), 1.0F);
        const Seconds half = kPi / std::abs(rate);
        EXPECT_LT((ahead(r, half + 2.0F) - (on_circle(half) - 10.0F * forward)).norm(), 1.5F);
    }
}

TEST_F(NominalPathsTest, AClimbingTurnClimbs)
{
    has_leg = false;
    fly(Vec3(5, 0, 1), 1.5F, 0.4F);
    ASSERT_TRUE(turns(paths.primary()));
    EXPECT_NEAR(ahead(paths.primary(), 4.0F).z() - own.position.z(), 4.0F, 0.5F);
}

TEST_F(NominalPathsTest, NoiseIsNoTurn)
{
    has_leg = false;
    for (int i = 0; i < 500; ++i) {
        fly(Vec3(5, i % 2 == 0 ? 0.1F : -0.1F, 0), 0.02F);
        EXPECT_FALSE(turns(paths.primary()));
    }
}

TEST_F(NominalPathsTest, ALegThatTheMotionContradictsIsDroppedAndTakenBack)
{
    fly(Vec3(5, 0, 0), 2.0F);
    fly(Vec3(0, 5, 0), 1.3F);
    EXPECT_TRUE(paths.believes_leg());
    fly(Vec3(0, 5, 0), 0.4F);
    EXPECT_FALSE(paths.believes_leg());
    EXPECT_EQ(paths.legs_doubted(), 1U);
    EXPECT_EQ(paths.other(), nullptr);
    EXPECT_LT((ahead(paths.primary(), 2.0F) - own.position - Vec3(0, 10, 0)).norm(), 1e-3F);
    fly(Vec3(5, -1, 0), 0.8F);
    EXPECT_FALSE(paths.believes_leg());
    fly(Vec3(5, -1, 0), 0.4F);
    EXPECT_TRUE(paths.believes_leg());
}

TEST_F(NominalPathsTest, AnotherLegIsBelievedAtOnce)
{
    fly(Vec3(0, 5, 0), 3.0F);
    ASSERT_FALSE(paths.believes_leg());
    leg = {own.position, own.position + Vec3(0, 300, 0), 0.0F};
    update();
    EXPECT_TRUE(paths.believes_leg());
}

TEST_F(NominalPathsTest, GettingFurtherOffContradictsAtASmallAngleToo)
{
    fly(Vec3(4.5F, 2.0F, 0), 4.0F);
    EXPECT_FALSE(paths.believes_leg());
}

TEST_F(NominalPathsTest, StandingAcceleratingReturningAndTurningAtTheEndContradictNothing)
{
    fly(Vec3(0.1F, 0.3F, 0), 5.0F);
    EXPECT_TRUE(paths.believes_leg()) << "stands";
    for (int i = 0; i < 50; ++i) {
        fly(Vec3(0.1F * static_cast<float>(i), 0, 0), 0.1F);
    }
    EXPECT_TRUE(paths.believes_leg()) << "accelerates";
    own.position.y() += 30.0F;
    fly(Vec3(0, -5, 0), 5.0F);
    EXPECT_TRUE(paths.believes_leg()) << "flies straight back to it";
    own.position = leg.end - Vec3(6, 0, 0);
    fly(Vec3(3, 4, 0), 2.0F);
    EXPECT_TRUE(paths.believes_leg()) << "turns at its end";
    EXPECT_EQ(paths.legs_doubted(), 0U);
}

TEST_F(NominalPathsTest, FlownFasterThanTheParameterItIsExpectedAtThatSpeed)
{
    fly(Vec3(12, 0, 0), 2.0F);
    EXPECT_NEAR(paths.primary().speed, 12.0F, 0.01F);
    fly(Vec3(0, 0, 0), 2.0F);
    EXPECT_NEAR(paths.primary().speed, 12.0F, 0.01F) << "it will fly on at the speed that it flew";
    leg.speed = 7.0F;
    update();
    EXPECT_NEAR(paths.primary().speed, 7.0F, 0.01F) << "the mission says so";
    fly(Vec3(3, 0, 0), 2.0F);
    EXPECT_NEAR(paths.primary().speed, 3.0F, 0.01F) << "it flies steadily otherwise";
    fly(Vec3(9, 0, 0), 0.1F);
    EXPECT_NEAR(paths.primary().speed, 9.0F, 0.01F) << "and never slower than it flies now";
}

TEST_F(NominalPathsTest, AcceleratingItIsExpectedAtTheSpeedToCome)
{
    for (int i = 0; i < 20; ++i) {
        fly(Vec3(0.2F * static_cast<float>(i), 0, 0), 0.1F);
    }
    EXPECT_EQ(paths.primary().speed, limits.cruise_speed);
    ASSERT_NE(paths.other(), nullptr);
    EXPECT_NEAR(paths.other()->speed, 3.8F, 0.01F) << "the motion says the other";
}

TEST_F(NominalPathsTest, TakenOverOnTheMotionThatPathIsKept)
{
    fly(Vec3(5, 0, 0), 2.0F);
    fly(Vec3(0, 5, 0), 0.5F);
    ASSERT_TRUE(paths.believes_leg());
    paths.note(true, true);
    const Vec3 at = own.position;
    fly(Vec3(-5, 0, 0), 3.0F, 0.0F, true);
    EXPECT_LT((start_of(paths.primary()) - at).norm(), 0.2F);
    EXPECT_GT(paths.primary().route().at(0.0F).along.y(), 0.99F) << "not where our commands lead";
    ASSERT_NE(paths.other(), nullptr);
    EXPECT_EQ(end_of(*paths.other()), leg.end) << "the leg has to be clear too";
    EXPECT_TRUE(paths.believes_leg()) << "our commands say nothing of the autopilot's intent";
    paths.note(false, false);
    update(true);
    EXPECT_EQ(end_of(paths.primary()), leg.end) << "what is left to solve is the leg's conflict";
}

TEST_F(NominalPathsTest, OfAVehicleThatDriftsWhileItWaitsThePlaceIsKept)
{
    has_leg = false;
    fly(Vec3(0.5F, 0.2F, 0.3F), 2.0F);
    EXPECT_GT(end_of(paths.primary()).x() - own.position.x(), 10.0F) << "the drift counts for conflicts";
    const Vec3 at = own.position;
    fly(Vec3(3, 0, 0), 2.0F, 0.0F, true);
    EXPECT_LT((start_of(paths.primary()) - at).norm(), 0.2F);
    EXPECT_EQ(end_of(paths.primary()), start_of(paths.primary()));
    EXPECT_FALSE(turns(paths.primary()));
    EXPECT_FALSE(paths.primary().measured) << "to its place a vehicle comes back";
    EXPECT_EQ(paths.primary().speed, limits.cruise_speed);
}

TEST_F(NominalPathsTest, WhatIsKeptIsMadeAnewWhenTheFrameJumps)
{
    has_leg = false;
    fly(Vec3(5, 0, 0), 2.0F);
    fly(Vec3(0, 5, 0), 1.0F, 0.0F, true);
    paths.reset();
    own.position += Vec3(1000, 0, 0);
    fly(Vec3(0, 5, 0), 1.0F, 0.0F, true);
    EXPECT_NEAR(start_of(paths.primary()).x(), own.position.x(), 0.1F);
    EXPECT_NEAR(end_of(paths.primary()).x(), own.position.x(), 0.1F);
}

TEST_F(NominalPathsTest, ATurnIsKeptAsARoute)
{
    has_leg = false;
    fly(Vec3(5, 0, 0), 1.5F, 0.5F);
    const Vec3 at = own.position;
    fly(Vec3(0, 0, 2), 3.0F, 0.0F, true);
    ASSERT_TRUE(turns(paths.primary()));
    EXPECT_TRUE(paths.primary().measured);
    EXPECT_LT((paths.primary().route().at(0.0F).position - at).norm(), 0.2F);
}

/// A turn comes near to itself: its end leads back beside its beginning. From anywhere near it a vehicle that follows
/// the path reaches the straight part and continues.
TEST_F(NominalPathsTest, AKeptTurnIsFlownToItsEnd)
{
    has_leg = false;
    Random random(5);
    const auto sign = [&random] { return random.below(2) == 0 ? -1.0F : 1.0F; };
    const vehicle::Airframe airframe{};
    const world::FlightRules rules;
    for (int i = 0; i < 100; ++i) {
        paths.reset();
        now = now + 5.0F;
        own.position = Vec3(0, 0, 50);
        update();
        const float climb = random.below(2) == 0 ? 0.0F : random.uniform(-1.0F, 1.0F);
        fly(Vec3(4.7F, 0, climb), 1.5F, sign() * random.uniform(0.2F, 0.9F));
        ASSERT_TRUE(turns(paths.primary())) << i;
        own.position += Vec3(random.uniform(-15, 15), random.uniform(-15, 15), random.uniform(-5, 5));
        for (Seconds t = 0.0F; t < 30.0F; t += 0.02F) {
            update(true);
            const world::Way way = world::way_of({now, own, limits, airframe, paths.primary(), rules});
            own.velocity += 0.05F * (way.speed * way.direction - own.velocity);
            own.position += 0.02F * own.velocity;
            now = now + 0.02F;
        }
        const path::Abeam abeam = paths.primary().route().abeam_of(own.position, paths.primary().segment);
        EXPECT_EQ(abeam.segment + 1, paths.primary().route().segments().size()) << i;
        EXPECT_LT(abeam.off, 3.0F) << i;
    }
}

TEST_F(NominalPathsTest, TakenOverOnTheLegTheLegIsFlown)
{
    fly(Vec3(5, 0, 0), 2.0F);
    paths.note(true, false);
    fly(Vec3(3, 3, 0), 3.0F, 0.0F, true);
    EXPECT_EQ(end_of(paths.primary()), leg.end);
    EXPECT_NEAR(paths.primary().speed, 5.0F, 0.01F);
    has_leg = false;
    update(true);
    EXPECT_GT(end_of(paths.primary()).x(), 100.0F) << "a leg lost in control: the motion at the take-over";
    EXPECT_NEAR(end_of(paths.primary()).y(), 0.0F, 0.1F);
    EXPECT_EQ(paths.other(), nullptr);
}

}  // namespace
}  // namespace jink::app
