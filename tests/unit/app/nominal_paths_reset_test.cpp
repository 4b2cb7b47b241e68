// SPDX-License-Identifier: BSD-3-Clause
// NominalPaths: reset and rebuilt state, and state unaffected by slow motion or a repeated own state.
#include "firmware/app/nominal_paths.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/oracle/reference_ends.hpp"

namespace jink::app {
namespace {

class NominalReset : public ::testing::Test {
protected:
    NominalReset() { own.position = Vec3(0.0F, 0.0F, 50.0F); }
    void show(bool in_control = false)
    {
        own.stamp = now;
        paths.update(own, own, has_leg ? &leg : nullptr, limits, in_control);
    }
    void fly(const Vec3& velocity, int ticks, bool in_control = false)
    {
        own.velocity = velocity;
        for (int i = 0; i < ticks; ++i) {
            now.us += 20'000;
            own.position += 0.02F * own.velocity;
            show(in_control);
        }
    }
    /// To the left at 0.5 rad/s.
    void turn(int ticks, float speed = 5.0F)
    {
        for (int i = 0; i < ticks; ++i) {
            heading += 0.01F;
            fly(Vec3(speed * std::cos(heading), speed * std::sin(heading), 0.0F), 1);
        }
    }

    NominalPaths paths;
    vehicle::VehicleState own;
    vehicle::VehicleLimits limits;
    world::Leg leg{Vec3(0, 0, 50), Vec3(2000, 0, 50), 0.0F};
    bool has_leg = false;
    float heading = 0.0F;
    TimePoint now{1'000'000};
};

TEST_F(NominalReset, TheTurnOfTheFrameBeforeIsForgotten)
{
    turn(75);
    ASSERT_NEAR(paths.turn_rate(), 0.5F, 0.01F);
    paths.reset();
    EXPECT_EQ(paths.turn_rate(), 0.0F) << "at once";
    turn(20);
    EXPECT_EQ(paths.turn_rate(), 0.0F) << "0.4 s are too short to know";
    EXPECT_FALSE(turns(paths.primary()));
    turn(40);
    EXPECT_NEAR(paths.turn_rate(), 0.5F, 0.01F);
}

TEST_F(NominalReset, TheSteadySpeedOfTheFrameBeforeIsForgotten)
{
    has_leg = true;
    leg.speed = 4.0F;
    fly(Vec3(2, 0, 0), 100);
    ASSERT_NEAR(paths.primary().speed, 2.0F, 1e-3F) << "flown steadily";
    paths.reset();
    fly(Vec3(2, 0, 0), 2);
    EXPECT_EQ(paths.primary().speed, 4.0F) << "what is steady has to be measured anew";
}

/// Made anew once: from then on it is kept as before.
TEST_F(NominalReset, ThePathOfAJumpInControlIsKeptFromThereOn)
{
    fly(Vec3(5, 0, 0), 100);
    fly(Vec3(0, 5, 0), 10, true);
    paths.reset();
    own.position += Vec3(1000, 0, 0);
    fly(Vec3(0, 5, 0), 1, true);
    const Vec3 anew = start_of(paths.primary());
    EXPECT_LT((anew - own.position).norm(), 0.2F);
    fly(Vec3(0, 5, 0), 50, true);
    EXPECT_EQ(start_of(paths.primary()), anew);
}

TEST_F(NominalReset, AVehicleThatStopsInATurnStays)
{
    turn(75);
    ASSERT_TRUE(turns(paths.primary()));
    fly(Vec3::Zero(), 1);
    EXPECT_FALSE(turns(paths.primary()));
    EXPECT_EQ(end_of(paths.primary()), own.position);
}

TEST_F(NominalReset, OfATurnThatHasBecomeSlowThePlaceIsKept)
{
    turn(77);  // the next tick is no sample
    fly(Vec3(0.8F * std::cos(heading), 0.8F * std::sin(heading), 0.0F), 1);
    ASSERT_TRUE(turns(paths.primary())) << "its turn is that of the last second";
    fly(own.velocity, 1, true);
    EXPECT_FALSE(turns(paths.primary()));
    EXPECT_EQ(end_of(paths.primary()), start_of(paths.primary()));
    EXPECT_EQ(paths.primary().speed, limits.cruise_speed);
}

TEST_F(NominalReset, MotionAtTheBoundIsKeptAsAPath)
{
    fly(Vec3(MotionEstimate::kMoving, 0, 0), 100);
    fly(Vec3(0, 3, 0), 10, true);
    EXPECT_NEAR(end_of(paths.primary()).x() - start_of(paths.primary()).x(), 60.0F, 0.1F) << "it is not slower";
}

/// Of a ground speed that does not stay above kMoving the turn rate is 0.
TEST_F(NominalReset, AtTheBoundOfMotionThereIsNoTurnRate)
{
    for (const float speed : {MotionEstimate::kMoving, 1.001F * MotionEstimate::kMoving}) {
        paths.reset();
        for (int i = 0; i < 12; ++i) {
            own.velocity = i < 6 ? Vec3(speed, 0.0F, 0.0F) : Vec3(0.0F, speed, 0.0F);
            now.us += 100'000;
            show();
        }
        EXPECT_EQ(paths.turn_rate() > 0.5F, speed > MotionEstimate::kMoving);
        EXPECT_EQ(paths.turn_rate() == 0.0F, speed <= MotionEstimate::kMoving);
    }
}

/// Own states of 10 Hz and ticks of 50 Hz: each one is shown five times.
TEST_F(NominalReset, AnOwnStateThatIsShownFiveTimesIsOneSample)
{
    for (int i = 0; i < 20; ++i) {
        heading += 0.05F;
        own.velocity = Vec3(5.0F * std::cos(heading), 5.0F * std::sin(heading), 0.0F);
        now.us += 100'000;
        for (int k = 0; k < 5; ++k) {
            show();
        }
    }
    EXPECT_NEAR(paths.turn_rate(), 0.5F, 0.01F);
}

TEST_F(NominalReset, MotionThatWasSlowWithinTheSecondIsNotSteady)
{
    has_leg = true;
    limits.cruise_speed = 4.0F;
    fly(Vec3(0.9F, 0, 0), 60);
    fly(Vec3(1.3F, 0, 0), 15);
    EXPECT_EQ(paths.primary().speed, 4.0F) << "from slow motion on, by the parameter";
}

TEST_F(NominalReset, SlowMotionSaysNothingOfASlowMissionsSpeed)
{
    has_leg = true;
    leg.speed = 0.6F;
    fly(Vec3(0.9F, 0, 0), 100);
    EXPECT_EQ(paths.primary().speed, 0.6F);
    fly(Vec3(1.4F, 0, 0), 2);
    EXPECT_NEAR(paths.primary().speed, 1.4F, 1e-4F) << "faster than kMoving, and than the mission";
}

}  // namespace
}  // namespace jink::app
