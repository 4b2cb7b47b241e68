// SPDX-License-Identifier: BSD-3-Clause
// NominalPaths, the bounds of its contract: which motion contradicts a leg and for how long, what is a turn and what is
// a steady speed, what is kept in control.
#include "firmware/app/nominal_paths.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace jink::app {
namespace {

constexpr float kDegree = kPi / 180.0F;
constexpr Seconds kSixteenth = 0.0625F;  ///< sums of it are exact

/// On a leg to the east, 50 m high; the test says where the vehicle is and how it moves.
class NominalEdges : public ::testing::Test {
protected:
    NominalEdges()
    {
        own.position = Vec3(100.0F, 0.0F, 50.0F);
        own.velocity = Vec3(5.0F, 0.0F, 0.0F);
    }
    void tick(Seconds dt = kSixteenth, bool in_control = false)
    {
        now = now + dt;
        own.stamp = now;
        paths.update(own, own, has_leg ? &leg : nullptr, limits, in_control);
    }
    /// Stays where it is: as seen from a leg that moves along.
    void hold(const Vec3& velocity, int ticks, bool in_control = false)
    {
        own.velocity = velocity;
        for (int i = 0; i < ticks; ++i) {
            tick(kSixteenth, in_control);
        }
    }
    /// Flies at `speed` on a heading that turns at `rate`.
    void turn(float speed, float rate, Seconds span, float climb = 0.0F, bool in_control = false)
    {
        constexpr Seconds kDt = 0.02F;
        for (int i = 0; i < static_cast<int>(std::lround(span / kDt)); ++i) {
            heading += rate * kDt;
            own.velocity = Vec3(speed * std::cos(heading), speed * std::sin(heading), climb);
            own.position += kDt * own.velocity;
            tick(kDt, in_control);
        }
    }
    /// Ticks of contradiction until the leg is doubted, 100 at most.
    int ticks_until_doubted(const Vec3& velocity)
    {
        int n = 0;
        while (n < 100 && paths.believes_leg()) {
            hold(velocity, 1);
            ++n;
        }
        return n;
    }
    [[nodiscard]] bool is_doubted_by(const Vec3& position, const Vec3& velocity)
    {
        paths.reset();
        own.position = position;
        hold(velocity, 60);
        return !paths.believes_leg();
    }
    static Vec3 at_angle(float degrees, float speed = 5.0F)
    {
        return {speed * std::cos(degrees * kDegree), speed * std::sin(degrees * kDegree), 0.0F};
    }

    NominalPaths paths;
    vehicle::VehicleState own;
    vehicle::VehicleLimits limits;
    world::Leg leg{Vec3(0, 0, 50), Vec3(500, 0, 50), 0.0F};
    bool has_leg = true;
    float heading = 0.0F;
    TimePoint now{1'000'000};
};

TEST_F(NominalEdges, LegIsDoubtedAfterItsTimeOfContradictionAndBelievedAfterItsTimeOfAgreement)
{
    hold(Vec3(5, 0, 0), 20);
    EXPECT_EQ(ticks_until_doubted(Vec3(0, 5, 0)), 24) << "kContradicted in sixteenths";
    EXPECT_EQ(paths.legs_doubted(), 1U);
    hold(Vec3(5, 0, 0), 15);
    EXPECT_FALSE(paths.believes_leg());
    hold(Vec3(5, 0, 0), 1);
    EXPECT_TRUE(paths.believes_leg()) << "kAgreed";
    EXPECT_EQ(paths.legs_doubted(), 1U);
}

TEST_F(NominalEdges, ContradictionAndAgreementHaveToLast)
{
    hold(Vec3(5, 0, 0), 20);
    for (int i = 0; i < 5; ++i) {
        hold(Vec3(0, 5, 0), 23);
        EXPECT_TRUE(paths.believes_leg());
        hold(Vec3(5, 0, 0), 1);
    }
    hold(Vec3(0, 5, 0), 24);
    ASSERT_FALSE(paths.believes_leg());
    for (int i = 0; i < 5; ++i) {
        hold(Vec3(5, 0, 0), 15);
        EXPECT_FALSE(paths.believes_leg());
        hold(Vec3(0, 5, 0), 1);
    }
}

TEST_F(NominalEdges, StallCountsAsATenthOfASecondAndAClockSetBackAsNothing)
{
    for (const Seconds jump : {10.0F, -10.0F}) {
        paths.reset();
        hold(Vec3(5, 0, 0), 20);
        hold(Vec3(0, 5, 0), 20);
        tick(jump);
        EXPECT_TRUE(paths.believes_leg());
        hold(Vec3(0, 5, 0), jump > 0.0F ? 2 : 3);
        EXPECT_TRUE(paths.believes_leg());
        hold(Vec3(0, 5, 0), 1);
        EXPECT_FALSE(paths.believes_leg());
    }
}

TEST_F(NominalEdges, SlowMotionContradictsNothingAndInterruptsWhatDoes)
{
    hold(Vec3(5, 0, 0), 20);
    EXPECT_EQ(ticks_until_doubted(Vec3(0, 0.99F, 0)), 100);
    hold(Vec3(0, 5, 0), 23);
    hold(Vec3(0, 0.99F, 0), 1);
    EXPECT_EQ(ticks_until_doubted(Vec3(0, NominalPaths::kMoving, 0)), 24);
}

TEST_F(NominalEdges, DirectionsOnTheLeg)
{
    for (const float side : {-1.0F, 1.0F}) {
        EXPECT_FALSE(is_doubted_by(Vec3(100, 0, 50), at_angle(side * 39.0F)));
        EXPECT_TRUE(is_doubted_by(Vec3(100, 0, 50), at_angle(side * 41.0F)));
        hold(at_angle(side * 31.0F), 60);
        EXPECT_FALSE(paths.believes_leg()) << "not contradicted, but not agreed with either";
        hold(at_angle(side * 29.0F), 60);
        EXPECT_TRUE(paths.believes_leg());
    }
    EXPECT_TRUE(is_doubted_by(Vec3(100, 0, 50), Vec3(-5, 0, 0))) << "backwards";
    EXPECT_TRUE(is_doubted_by(Vec3(100, 0, 50), Vec3(1, 0, 3))) << "upwards";
}

TEST_F(NominalEdges, GettingFurtherOffContradictsBeyondTwoMetresOnly)
{
    const float steep = std::asin(0.26F) / kDegree, shallow = std::asin(0.24F) / kDegree;
    for (const float side : {-1.0F, 1.0F}) {
        EXPECT_TRUE(is_doubted_by(Vec3(100, side * 2.1F, 50), at_angle(side * steep)));
        EXPECT_FALSE(is_doubted_by(Vec3(100, side * 2.1F, 50), at_angle(side * shallow)));
        EXPECT_FALSE(is_doubted_by(Vec3(100, side * 1.9F, 50), at_angle(side * steep)));
        EXPECT_FALSE(is_doubted_by(Vec3(100, side * 2.1F, 50), at_angle(side * -steep))) << "coming back";
    }
}

TEST_F(NominalEdges, WayBackAimsTwelveMetresAheadOrStraightAtTheLeg)
{
    EXPECT_FALSE(is_doubted_by(Vec3(100, -12, 50), at_angle(45.0F))) << "to the point 12 m ahead";
    EXPECT_TRUE(is_doubted_by(Vec3(100, 12, 50), at_angle(45.0F)));
    EXPECT_FALSE(is_doubted_by(Vec3(100, -40, 50), at_angle(100.0F))) << "straight at the leg";
    EXPECT_TRUE(is_doubted_by(Vec3(100, -1.9F, 50), at_angle(130.0F))) << "beside the leg there is none";
    EXPECT_TRUE(is_doubted_by(Vec3(100, -40, 50), at_angle(-100.0F)));
    EXPECT_TRUE(is_doubted_by(Vec3(100, -40, 50), at_angle(150.0F)));
}

TEST_F(NominalEdges, BeforeItsStartAndBeyondItsEnd)
{
    EXPECT_FALSE(is_doubted_by(Vec3(-40, 0, 50), Vec3(5, 0, 0)));
    EXPECT_TRUE(is_doubted_by(Vec3(-40, 0, 50), Vec3(-5, 0, 0)));
    EXPECT_TRUE(is_doubted_by(Vec3(540, 0, 50), Vec3(5, 0, 0))) << "it flies on and on";
    EXPECT_FALSE(is_doubted_by(Vec3(540, 0, 50), Vec3(-5, 0, 0))) << "back to the end";
}

TEST_F(NominalEdges, TurnBeforeTheEndOfTheLegContradictsNothing)
{
    EXPECT_TRUE(is_doubted_by(Vec3(490, 0, 50), Vec3(0, 5, 0))) << "kCornerTime at 5 m/s is 10 m";
    EXPECT_FALSE(is_doubted_by(Vec3(490.1F, 0, 50), Vec3(0, 5, 0)));
    EXPECT_FALSE(is_doubted_by(Vec3(481, 0, 50), Vec3(0, 10, 0))) << "faster, and so earlier";
    EXPECT_TRUE(is_doubted_by(Vec3(496, 0, 50), Vec3(0, 2, 0)));
    EXPECT_TRUE(is_doubted_by(Vec3(5, 0, 50), Vec3(0, 5, 0))) << "the start is no end";
}

TEST_F(NominalEdges, PointIsFlownTo)
{
    leg = {Vec3(200, 0, 50), Vec3(200, 0, 50), 0.0F};
    EXPECT_FALSE(is_doubted_by(Vec3(100, 0, 50), Vec3(5, 0, 0)));
    EXPECT_FALSE(is_doubted_by(Vec3(200, 100, 50), Vec3(0, -5, 0)));
    EXPECT_TRUE(is_doubted_by(Vec3(100, 0, 50), Vec3(-5, 0, 0)));
    EXPECT_TRUE(is_doubted_by(Vec3(100, 0, 50), Vec3(0, 5, 0)));
}

TEST_F(NominalEdges, AnotherLegIsOneWhoseEndsMovedByMoreThanHalfAMetre)
{
    const auto believed_after = [&](const Vec3& start, const Vec3& end) {
        leg = {Vec3(0, 0, 50), Vec3(500, 0, 50), 0.0F};
        EXPECT_TRUE(is_doubted_by(Vec3(100, 0, 50), Vec3(0, 5, 0)));
        leg = {start, end, 0.0F};
        tick();
        return paths.believes_leg();
    };
    EXPECT_FALSE(believed_after(Vec3(0.5F, 0, 50), Vec3(500, 0, 50)));
    EXPECT_TRUE(believed_after(Vec3(0.51F, 0, 50), Vec3(500, 0, 50)));
    EXPECT_FALSE(believed_after(Vec3(0, 0, 50), Vec3(500, 0.5F, 50)));
    EXPECT_TRUE(believed_after(Vec3(0, 0, 50), Vec3(500, 0, 50.51F)));
}

TEST_F(NominalEdges, LegThatWasLostAndComesBackIsBelieved)
{
    ASSERT_TRUE(is_doubted_by(Vec3(100, 0, 50), Vec3(0, 5, 0)));
    has_leg = false;
    tick();
    EXPECT_FALSE(paths.believes_leg());
    EXPECT_FALSE(paths.is_intended());
    has_leg = true;
    tick();
    EXPECT_TRUE(paths.believes_leg());
    EXPECT_EQ(ticks_until_doubted(Vec3(0, 5, 0)), 23) << "from then on its contradiction counts anew";
}

TEST_F(NominalEdges, ResetBelievesTheLegAgain)
{
    ASSERT_TRUE(is_doubted_by(Vec3(100, 0, 50), Vec3(0, 5, 0)));
    paths.reset();
    EXPECT_TRUE(paths.believes_leg());
    hold(Vec3(0, 5, 0), 1);
    paths.reset();
    EXPECT_EQ(ticks_until_doubted(Vec3(0, 5, 0)), 24);
}

TEST_F(NominalEdges, StandingIsSlowerThanItsBound)
{
    has_leg = false;
    hold(Vec3(0.499F, 0, 0), 1);
    EXPECT_EQ(paths.primary().leg.end, own.position);
    EXPECT_EQ(paths.primary().leg.speed, limits.cruise_speed);
    hold(Vec3(NominalPaths::kStanding, 0, 0), 1);
    EXPECT_EQ(paths.primary().leg.speed, NominalPaths::kStanding);
    EXPECT_NEAR(paths.primary().leg.end.x() - own.position.x(), 30.0F, 1e-3F) << "kAhead";
    hold(Vec3(3.0F, -4.0F, 1.0F), 1);
    EXPECT_LT((paths.primary().leg.end - own.position - 60.0F * own.velocity).norm(), 1e-3F);
    EXPECT_NEAR(paths.primary().leg.speed, std::sqrt(26.0F), 1e-5F);
}

TEST_F(NominalEdges, TurnRateIsTheSameOnEveryHeading)
{
    has_leg = false;
    for (const float rate : {0.5F, -0.5F}) {
        paths.reset();
        turn(5.0F, rate, 1.5F);
        for (int i = 0; i < 65; ++i) {
            turn(5.0F, rate, 0.2F);
            ASSERT_NEAR(paths.turn_rate(), rate, 0.005F) << "heading " << heading;
            ASSERT_NE(paths.primary().route, nullptr);
        }
    }
}

TEST_F(NominalEdges, SlowerTurnThanTheLeastIsNone)
{
    has_leg = false;
    for (const float side : {-1.0F, 1.0F}) {
        paths.reset();
        turn(5.0F, side * 0.058F, 1.5F);
        EXPECT_EQ(paths.turn_rate(), 0.0F);
        EXPECT_EQ(paths.primary().route, nullptr);
        paths.reset();
        turn(5.0F, side * 0.062F, 1.5F);
        EXPECT_NEAR(paths.turn_rate(), side * 0.062F, 0.002F);
        EXPECT_NE(paths.primary().route, nullptr);
    }
}

TEST_F(NominalEdges, TurnOfASlowVehicleIsNone)
{
    has_leg = false;
    turn(0.98F, 0.5F, 2.0F);
    EXPECT_EQ(paths.turn_rate(), 0.0F);
    turn(0.98F, 0.5F, 2.0F, 4.0F);
    EXPECT_EQ(paths.turn_rate(), 0.0F) << "its climb does not count";
    turn(1.02F, 0.5F, 2.0F);
    EXPECT_NEAR(paths.turn_rate(), 0.5F, 0.01F);
}

TEST_F(NominalEdges, TurnIsMeasuredOverMostOfASecondAndForgottenAfterIt)
{
    has_leg = false;
    turn(5.0F, 0.5F, 0.7F);
    EXPECT_EQ(paths.turn_rate(), 0.0F) << "too short to know";
    turn(5.0F, 0.5F, 0.3F);
    EXPECT_NEAR(paths.turn_rate(), 0.5F, 0.01F);
    turn(5.0F, 0.0F, 0.5F);
    EXPECT_GT(paths.turn_rate(), 0.1F);
    EXPECT_LT(paths.turn_rate(), 0.45F);
    turn(5.0F, 0.0F, 0.7F);
    EXPECT_EQ(paths.turn_rate(), 0.0F);
    EXPECT_EQ(paths.primary().route, nullptr);
}

TEST_F(NominalEdges, GapInOwnStatesBeginsTheMeasurementAnew)
{
    has_leg = false;
    for (const Seconds gap : {0.4F, 0.55F}) {
        paths.reset();
        turn(5.0F, 0.5F, 1.5F);
        heading += 0.5F * gap;
        own.velocity = Vec3(5.0F * std::cos(heading), 5.0F * std::sin(heading), 0.0F);
        tick(gap);
        if (gap < 0.5F) {
            EXPECT_NEAR(paths.turn_rate(), 0.5F, 0.01F);
        } else {
            EXPECT_EQ(paths.turn_rate(), 0.0F);
            turn(5.0F, 0.5F, 0.6F);
            EXPECT_EQ(paths.turn_rate(), 0.0F);
            turn(5.0F, 0.5F, 0.4F);
            EXPECT_NEAR(paths.turn_rate(), 0.5F, 0.01F);
        }
    }
}

TEST_F(NominalEdges, ClockSetBackBeginsTheMeasurementAnew)
{
    has_leg = false;
    turn(5.0F, 0.5F, 1.5F);
    now = now + -5.0F;
    turn(5.0F, 0.5F, 0.6F);
    EXPECT_EQ(paths.turn_rate(), 0.0F);
    turn(5.0F, 0.5F, 0.5F);
    EXPECT_NEAR(paths.turn_rate(), 0.5F, 0.01F);
}

TEST_F(NominalEdges, LevelTurnIsHalfACircleAndAMinuteBack)
{
    has_leg = false;
    for (const float climb : {0.0F, 0.29F, -0.29F}) {
        for (const float rate : {0.5F, -0.5F}) {
            paths.reset();
            turn(5.0F, rate, 1.5F, climb);
            const world::Reference& r = paths.primary();
            ASSERT_NE(r.route, nullptr);
            const auto segments = r.route->segments();
            ASSERT_EQ(segments.size(), 2U);
            const Vec3 forward(std::cos(heading), std::sin(heading), 0.0F);
            const Vec3 inwards = std::copysign(1.0F, rate) * Vec3(-forward.y(), forward.x(), 0.0F);
            EXPECT_TRUE(segments[0].is_arc());
            EXPECT_NEAR(segments[0].radius, 10.0F, 0.1F);
            EXPECT_NEAR(segments[0].length, kPi * 10.0F, 0.3F);
            EXPECT_LT((segments[0].start - own.position).norm(), 1e-2F);
            EXPECT_LT((segments[0].along - forward).norm(), 1e-2F);
            EXPECT_LT((segments[0].towards - inwards).norm(), 1e-2F);
            EXPECT_FALSE(segments[1].is_arc());
            EXPECT_LT((segments[1].start - own.position - 20.0F * inwards).norm(), 0.2F);
            EXPECT_NEAR(segments[1].length, 60.0F * own.velocity.norm(), 0.5F);
            const Vec3 back = (Vec3(0.0F, 0.0F, climb) - 5.0F * forward).normalized();
            EXPECT_LT((segments[1].along - back).norm(), 1e-2F);
            EXPECT_NEAR(r.leg.speed, own.velocity.norm(), 1e-4F);
        }
    }
}

TEST_F(NominalEdges, ClimbingTurnIsThreeLegsOnTheHelixAndClimbsOn)
{
    has_leg = false;
    for (const float climb : {0.31F, 1.5F, -1.5F}) {
        for (const float rate : {0.5F, -0.5F}) {
            paths.reset();
            turn(5.0F, rate, 1.5F, climb);
            ASSERT_NE(paths.primary().route, nullptr);
            const auto segments = paths.primary().route->segments();
            ASSERT_EQ(segments.size(), 4U);
            const Vec3 forward(std::cos(heading), std::sin(heading), 0.0F);
            const Vec3 inwards = std::copysign(1.0F, rate) * Vec3(-forward.y(), forward.x(), 0.0F);
            for (std::size_t i = 0; i <= 3; ++i) {
                const float angle = kPi * static_cast<float>(i) / 3.0F;
                const Vec3 on_helix = own.position + 10.0F * std::sin(angle) * forward +
                                      10.0F * (1.0F - std::cos(angle)) * inwards +
                                      Vec3(0.0F, 0.0F, climb * angle / 0.5F);
                EXPECT_LT((segments[i].start - on_helix).norm(), 0.2F) << i << ' ' << climb << ' ' << rate;
            }
            const Vec3 back = (Vec3(0.0F, 0.0F, climb) - 5.0F * forward).normalized();
            EXPECT_LT((segments[3].along - back).norm(), 1e-2F);
            EXPECT_NEAR(segments[3].length, 60.0F * own.velocity.norm(), 0.5F);
        }
    }
}

TEST_F(NominalEdges, TurnOnTheSpotIsTakenForStraight)
{
    has_leg = false;
    turn(1.2F, 2.6F, 2.0F);
    ASSERT_GT(paths.turn_rate(), 2.4F) << "0.46 m of radius";
    EXPECT_EQ(paths.primary().route, nullptr);
    EXPECT_LT((paths.primary().leg.end - own.position - 60.0F * own.velocity).norm(), 1e-2F);
    turn(1.5F, 2.6F, 2.0F);
    EXPECT_NE(paths.primary().route, nullptr) << "0.58 m";
}

}  // namespace
}  // namespace jink::app
