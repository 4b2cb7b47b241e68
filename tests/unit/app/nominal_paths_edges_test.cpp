// SPDX-License-Identifier: BSD-3-Clause
// NominalPaths, the bounds of its contract: which motion contradicts a leg, which agrees with it, and for how long.
#include "firmware/app/nominal_paths.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/oracle/reference_ends.hpp"

namespace jink::app {
namespace {

constexpr float kDegree = kPi / 180.0F;
constexpr Seconds kSixteenth = 0.0625F;  ///< sums of it are exact

/// On a leg to the east, 50 m high; the test sets the vehicle's position and motion.
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
    /// Constant position relative to a leg that moves along.
    void hold(const Vec3& velocity, int ticks, bool in_control = false)
    {
        own.velocity = velocity;
        for (int i = 0; i < ticks; ++i) {
            tick(kSixteenth, in_control);
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
    EXPECT_EQ(ticks_until_doubted(Vec3(0, MotionEstimate::kMoving, 0)), 24);
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

TEST_F(NominalEdges, TwoMetresThemselvesAreOnTheLeg)
{
    EXPECT_TRUE(is_doubted_by(Vec3(100, -2.0F, 50), at_angle(130.0F))) << "no way back from there";
    EXPECT_FALSE(is_doubted_by(Vec3(100, -2.001F, 50), at_angle(130.0F)));
    EXPECT_FALSE(is_doubted_by(Vec3(100, 2.0F, 50), at_angle(30.0F))) << "nor is it getting further off";
    EXPECT_TRUE(is_doubted_by(Vec3(100, 2.001F, 50), at_angle(30.0F)));
}

TEST_F(NominalEdges, WithoutALegNothingIsDoubted)
{
    has_leg = false;
    hold(Vec3(0, 5, 0), 100);
    EXPECT_EQ(paths.legs_doubted(), 0U);
}

TEST_F(NominalEdges, BesideTheLegItMayBeFollowedOrItsEndAimedAt)
{
    EXPECT_FALSE(is_doubted_by(Vec3(100, -12, 50), Vec3(5, 0, 0))) << "along it";
    EXPECT_FALSE(is_doubted_by(Vec3(497, -1.9F, 50), at_angle(70.0F, 1.5F))) << "no farther than its end";
    EXPECT_TRUE(is_doubted_by(Vec3(400, -1.9F, 50), at_angle(70.0F, 1.5F)));
}

TEST_F(NominalEdges, BeforeItsStartAndBeyondItsEnd)
{
    EXPECT_FALSE(is_doubted_by(Vec3(-40, 3, 50), at_angle(20.0F))) << "nearer to the start, not further off";
    EXPECT_TRUE(is_doubted_by(Vec3(40, 3, 50), at_angle(20.0F)));
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
    EXPECT_EQ(paths.other(), nullptr) << "until the next update";
    hold(Vec3(0, 5, 0), 1);
    paths.reset();
    EXPECT_EQ(ticks_until_doubted(Vec3(0, 5, 0)), 24);
}

TEST_F(NominalEdges, SpeedUnderOurCommandsIsNotTheMissionsUntilASecondLater)
{
    hold(Vec3(5, 0, 0), 20);
    hold(Vec3(3, 0, 0), 40, true);
    hold(Vec3(3, 0, 0), 16);
    EXPECT_EQ(paths.primary().speed, 5.0F) << "15 sixteenths after the giving back";
    hold(Vec3(3, 0, 0), 1);
    EXPECT_EQ(paths.primary().speed, 3.0F);
}

TEST_F(NominalEdges, MotionUnderASlowCruiseSpeedIsKeptFromHalfOfItOn)
{
    has_leg = false;
    for (const float speed : {0.55F, 0.65F}) {
        limits.cruise_speed = 1.2F;
        paths.reset();
        hold(Vec3(speed, 0, 0), 4);
        hold(Vec3(speed, 0, 0), 1, true);
        EXPECT_EQ(end_of(paths.primary()) == own.position, speed < 0.6F) << speed;
    }
}

TEST_F(NominalEdges, StandingIsSlowerThanItsBound)
{
    has_leg = false;
    hold(Vec3(0.499F, 0, 0), 1);
    EXPECT_EQ(end_of(paths.primary()), own.position);
    EXPECT_EQ(paths.primary().speed, limits.cruise_speed);
    hold(Vec3(MotionPath::kStanding, 0, 0), 1);
    EXPECT_EQ(paths.primary().speed, MotionPath::kStanding);
    EXPECT_NEAR(end_of(paths.primary()).x() - own.position.x(), 30.0F, 1e-3F) << "kAhead";
    hold(Vec3(3.0F, -4.0F, 1.0F), 1);
    EXPECT_LT((end_of(paths.primary()) - own.position - 60.0F * own.velocity).norm(), 1e-3F);
    EXPECT_NEAR(paths.primary().speed, std::sqrt(26.0F), 1e-5F);
}

}  // namespace
}  // namespace jink::app
