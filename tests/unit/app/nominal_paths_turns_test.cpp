// SPDX-License-Identifier: BSD-3-Clause
// NominalPaths: measurement of a turn, and the expected path of a turning vehicle.
#include "firmware/app/nominal_paths.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/oracle/reference_ends.hpp"

namespace jink::app {
namespace {

/// Without a leg, 50 m high.
class NominalTurns : public ::testing::Test {
protected:
    NominalTurns() { own.position = Vec3(100.0F, 0.0F, 50.0F); }
    void tick(Seconds dt)
    {
        now = now + dt;
        show();
    }
    void show()
    {
        own.stamp = now;
        paths.update(own, own, nullptr, limits, false);
    }
    /// Flies at `speed` on a heading that turns at `rate`.
    void turn(float speed, float rate, Seconds span, float climb = 0.0F)
    {
        constexpr Seconds kDt = 0.02F;
        for (int i = 0; i < static_cast<int>(std::lround(span / kDt)); ++i) {
            heading += rate * kDt;
            own.velocity = Vec3(speed * std::cos(heading), speed * std::sin(heading), climb);
            own.position += kDt * own.velocity;
            tick(kDt);
        }
    }

    NominalPaths paths;
    vehicle::VehicleState own;
    vehicle::VehicleLimits limits;
    float heading = 0.0F;
    TimePoint now{1'000'000};
};

TEST_F(NominalTurns, TurnRateIsTheSameOnEveryHeading)
{
    for (const float rate : {0.5F, -0.5F}) {
        paths.reset();
        turn(5.0F, rate, 1.5F);
        for (int i = 0; i < 65; ++i) {
            turn(5.0F, rate, 0.2F);
            ASSERT_NEAR(paths.turn_rate(), rate, 0.005F) << "heading " << heading;
            ASSERT_TRUE(turns(paths.primary()));
        }
    }
}

TEST_F(NominalTurns, SlowerTurnThanTheLeastIsNone)
{
    for (const float side : {-1.0F, 1.0F}) {
        paths.reset();
        turn(5.0F, side * 0.058F, 1.5F);
        EXPECT_EQ(paths.turn_rate(), 0.0F);
        EXPECT_FALSE(turns(paths.primary()));
        paths.reset();
        turn(5.0F, side * 0.062F, 1.5F);
        EXPECT_NEAR(paths.turn_rate(), side * 0.062F, 0.002F);
        EXPECT_TRUE(turns(paths.primary()));
    }
}

TEST_F(NominalTurns, TurnOfASlowVehicleIsNone)
{
    turn(0.98F, 0.5F, 2.0F);
    EXPECT_EQ(paths.turn_rate(), 0.0F);
    turn(0.98F, 0.5F, 2.0F, 4.0F);
    EXPECT_EQ(paths.turn_rate(), 0.0F) << "its climb does not count";
    turn(1.02F, 0.5F, 2.0F);
    EXPECT_NEAR(paths.turn_rate(), 0.5F, 0.01F);
}

TEST_F(NominalTurns, TurnIsMeasuredOverMostOfASecondAndForgottenAfterIt)
{
    turn(5.0F, 0.5F, 0.7F);
    EXPECT_EQ(paths.turn_rate(), 0.0F) << "too short to know";
    turn(5.0F, 0.5F, 0.3F);
    EXPECT_NEAR(paths.turn_rate(), 0.5F, 0.01F);
    turn(5.0F, 0.0F, 0.5F);
    EXPECT_GT(paths.turn_rate(), 0.1F);
    EXPECT_LT(paths.turn_rate(), 0.45F);
    turn(5.0F, 0.0F, 0.7F);
    EXPECT_EQ(paths.turn_rate(), 0.0F);
    EXPECT_FALSE(turns(paths.primary()));
}

TEST_F(NominalTurns, GapInOwnStatesBeginsTheMeasurementAnew)
{
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

TEST_F(NominalTurns, ClockSetBackBeginsTheMeasurementAnew)
{
    turn(5.0F, 0.5F, 1.5F);
    now = now + -5.0F;
    turn(5.0F, 0.5F, 0.6F);
    EXPECT_EQ(paths.turn_rate(), 0.0F);
    turn(5.0F, 0.5F, 0.5F);
    EXPECT_NEAR(paths.turn_rate(), 0.5F, 0.01F);
}

TEST_F(NominalTurns, LevelTurnIsHalfACircleAndAMinuteBack)
{
    for (const float climb : {0.0F, 0.3F, -0.3F}) {
        for (const float rate : {0.5F, -0.5F}) {
            paths.reset();
            turn(5.0F, rate, 1.5F, climb);
            const world::Reference& r = paths.primary();
            ASSERT_TRUE(turns(r));
            const auto segments = r.route().segments();
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
            EXPECT_NEAR(r.speed, own.velocity.norm(), 1e-4F);
        }
    }
}

TEST_F(NominalTurns, ClimbingTurnIsThreeLegsOnTheHelixAndClimbsOn)
{
    for (const float climb : {0.31F, 1.5F, -1.5F}) {
        for (const float rate : {0.5F, -0.5F}) {
            paths.reset();
            turn(5.0F, rate, 1.5F, climb);
            ASSERT_TRUE(turns(paths.primary()));
            const auto segments = paths.primary().route().segments();
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

TEST_F(NominalTurns, TurnOnTheSpotIsTakenForStraight)
{
    turn(1.2F, 2.6F, 2.0F);
    ASSERT_GT(paths.turn_rate(), 2.4F) << "0.46 m of radius";
    EXPECT_FALSE(turns(paths.primary()));
    EXPECT_LT((end_of(paths.primary()) - own.position - 60.0F * own.velocity).norm(), 1e-2F);
    turn(1.2F, 2.6F, 2.0F, 0.5F);
    EXPECT_FALSE(turns(paths.primary())) << "climbing too";
    turn(1.5F, 2.6F, 2.0F);
    EXPECT_TRUE(turns(paths.primary())) << "0.58 m";
}

TEST_F(NominalTurns, SlowMotionWithinTheWindowMakesItUnknown)
{
    turn(0.9F, 0.5F, 1.5F);
    turn(2.0F, 0.5F, 0.5F);
    EXPECT_EQ(paths.turn_rate(), 0.0F) << "headings of slow motion are noise";
    turn(2.0F, 0.5F, 0.7F);
    EXPECT_NEAR(paths.turn_rate(), 0.5F, 0.01F);
}

TEST_F(NominalTurns, OwnStateThatIsShownAgainIsNotMeasuredAgain)
{
    for (int i = 0; i < 20; ++i) {
        turn(5.0F, 2.5F, 0.02F);  // 0.05 rad each 0.1 s
        now = now + 0.08F;
        show();
        for (int k = 0; k < 4; ++k) {
            show();
        }
    }
    EXPECT_NEAR(paths.turn_rate(), 0.5F, 0.02F);
    const float rate = paths.turn_rate();
    show();
    EXPECT_EQ(paths.turn_rate(), rate);
    EXPECT_TRUE(turns(paths.primary()));
}

TEST_F(NominalTurns, WindowIsASecondLong)
{
    own.velocity = Vec3(5.0F, 0.0F, 0.0F);
    for (int i = 0; i < 15; ++i) {
        now.us += 100'000;
        show();
    }
    own.velocity = Vec3(5.0F * std::cos(0.5F), 5.0F * std::sin(0.5F), 0.0F);
    for (int i = 0; i < 10; ++i) {
        now.us += 100'000;
        show();
    }
    // Least squares over 11 headings, the oldest 0.5 rad less: (11 * 0.5 - 5.5 * 0.5) / (11 * 3.85 - 5.5 * 5.5).
    EXPECT_NEAR(paths.turn_rate(), 0.2273F, 1e-3F);
    now.us += 100'000;
    show();
    EXPECT_EQ(paths.turn_rate(), 0.0F) << "more than a second ago";
}

TEST_F(NominalTurns, GapOfHalfASecondItselfIsBridged)
{
    for (const std::int64_t gap_us : {500'000, 500'001}) {
        paths.reset();
        for (int i = 0; i < 15; ++i) {
            now.us += 100'000;
            heading += 0.05F;
            own.velocity = Vec3(5.0F * std::cos(heading), 5.0F * std::sin(heading), 0.0F);
            show();
        }
        now.us += gap_us;
        heading += 0.25F;
        own.velocity = Vec3(5.0F * std::cos(heading), 5.0F * std::sin(heading), 0.0F);
        show();
        EXPECT_NEAR(paths.turn_rate(), gap_us == 500'000 ? 0.5F : 0.0F, 0.01F);
    }
}

TEST_F(NominalTurns, TurnThatLeavesTheMapIsTakenForStraight)
{
    for (const float climb : {0.0F, 1.0F}) {
        for (const float inside : {1.0F, 150.0F, 2000.0F}) {
            paths.reset();
            heading = 0.5F * kPi - 0.75F;
            own.position = Vec3(path::Route::kFarthest - inside - 5.0F, 0.0F, 50.0F);
            turn(5.0F, 0.5F, 1.5F, climb);
            turn(0.0F, 0.0F, 0.0F);
            const Vec3 before = own.position;
            heading = 0.0F;
            for (int i = 0; i < 15; ++i) {
                now.us += 100'000;
                heading -= 0.05F;
                own.velocity = Vec3(-5.0F * std::cos(heading), -5.0F * std::sin(heading), climb);
                show();
            }
            ASSERT_NEAR(paths.turn_rate(), -0.5F, 0.01F);
            EXPECT_EQ(own.position, before);
            // It turns from west over north to the east, half a circle, and flies 300 m on.
            EXPECT_EQ(turns(paths.primary()), inside >= 1000.0F) << inside << ' ' << climb;
        }
    }
}

}  // namespace
}  // namespace jink::app
