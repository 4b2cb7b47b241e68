// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/follow_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace jink::app {
namespace {

const Vec3 kNorth(0.0F, 5.0F, 0.0F), kEast(5.0F, 0.0F, 0.0F), kWest(-5.0F, 0.0F, 0.0F);
const Vec3 kNowhere = Vec3::Constant(std::numeric_limits<float>::quiet_NaN());

/// A check with its clock: ticks of 20 ms.
struct Followed {
    FollowCheck check;
    vehicle::VehicleLimits limits;
    TimePoint now{1'000'000};

    bool tick(const Vec3& command, const Vec3& velocity, Seconds dt = 0.02F)
    {
        now = now + dt;
        return check.update(command, velocity, limits, now);
    }
    /// Time of the alarm after this call at a constant velocity [s]; negative: none within `time`.
    float found(const Vec3& command, const Vec3& velocity, float time = 8.0F)
    {
        for (int i = 0; i < static_cast<int>(time * 50.0F); ++i) {
            if (tick(command, velocity)) {
                return 0.02F * static_cast<float>(i);
            }
        }
        return -1.0F;
    }
    /// The velocity changes from `first` to `last` in equal steps; whether there was an alarm.
    bool changes(const Vec3& command, const Vec3& first, const Vec3& last, float time)
    {
        const int ticks = static_cast<int>(time * 50.0F);
        bool alarm = false;
        for (int i = 0; i <= ticks; ++i) {
            const float share = static_cast<float>(i) / static_cast<float>(ticks);
            alarm = tick(command, first + share * (last - first)) || alarm;
        }
        return alarm;
    }
};

constexpr float kTickAndAHalf = 0.03F;  ///< when a sum of steps reaches its bound
#define EXPECT_FOUND_AT(time, found) EXPECT_NEAR(found, time, kTickAndAHalf)
/// Until the change that is expected has turned to another command, as it adds up for a turn that is ignored.
constexpr float kTurned = 1.5F * FollowCheck::kAnswer;
#define EXPECT_FOUND_TURNED_AT(time, found) EXPECT_NEAR(found, (time) + kTurned, 0.12F)

Followed plane()
{
    Followed f;
    f.limits.kind = vehicle::VehicleKind::fixed_wing;
    return f;
}

TEST(FollowCheck, ToleranceItselfStillFollows)
{
    EXPECT_LT(Followed().found(Vec3(2.0F, 0.0F, 0.0F), Vec3(3.0F, 0.0F, 0.0F)), 0.0F) << "1 m/s too fast";
    EXPECT_LT(Followed().found(Vec3(2.0F, 0.0F, 0.0F), Vec3(1.5F, 1.0F, 0.0F)), 0.0F) << "1 m/s across, and slow";
    EXPECT_LT(Followed().found(Vec3(8.0F, 0.0F, 0.0F), Vec3(4.0F, 0.0F, 0.0F)), 0.0F) << "kSlow of the speed";
    EXPECT_FOUND_AT(1.0F, Followed().found(Vec3(8.0F, 0.0F, 0.0F), Vec3(3.9F, 0.0F, 0.0F)));
}

TEST(FollowCheck, ToleranceGrowsWithTheCommandedSpeed)
{
    EXPECT_LT(Followed().found(Vec3(10.0F, 0.0F, 0.0F), Vec3(10.0F, 2.9F, 0.0F)), 0.0F) << "kShare of 10 m/s";
    EXPECT_GE(Followed().found(Vec3(10.0F, 0.0F, 0.0F), Vec3(10.0F, 3.2F, 0.0F)), 0.0F);
    EXPECT_GE(Followed().found(Vec3(2.0F, 0.0F, 0.0F), Vec3(2.0F, 1.1F, 0.0F)), 0.0F) << "kTolerance at least";
}

TEST(FollowCheck, FasterThanCommandedIsNotFollowed)
{
    EXPECT_FOUND_AT(1.0F, Followed().found(Vec3(2.0F, 0.0F, 0.0F), Vec3(6.0F, 0.0F, 0.0F)));
}

TEST(FollowCheck, CommandSlowerThanTheToleranceHasNoCourseToFlyMoreSlowly)
{
    EXPECT_FOUND_AT(1.0F, Followed().found(Vec3(0.5F, 0.0F, 0.0F), Vec3(0.3F, 0.99F, 0.0F)));
    EXPECT_FOUND_AT(1.0F, Followed().found(Vec3(1.0F, 0.0F, 0.0F), Vec3(0.6F, 0.95F, 0.0F))) << "the tolerance itself";
    EXPECT_FOUND_AT(1.0F, Followed().found(Vec3::Zero(), kNorth)) << "it shall stop";
}

TEST(FollowCheck, PlaneUnderACommandWithoutACourseIsComparedWithItsSpeed)
{
    for (const float speed : {0.0F, 0.5F, 1.0F}) {
        EXPECT_FOUND_AT(2.5F, plane().found(Vec3(speed, 0.0F, 0.0F), Vec3(18.0F, 0.0F, 0.0F))) << speed;
    }
    EXPECT_LT(plane().found(Vec3(9.0F, 0.0F, 0.0F), Vec3(18.0F, 0.0F, 0.0F)), 0.0F) << "its speed is its own";
}

TEST(FollowCheck, PlaneThatRollsOutOfATurnFirstIsNotAccused)
{
    Followed f = plane();
    const auto course = [](float angle) { return Vec3(18.0F * std::cos(angle), 18.0F * std::sin(angle), 0.0F); };
    const Vec3 command = course(-0.8F);
    for (int i = 0; i < 100; ++i) {
        ASSERT_FALSE(f.tick(command, course(0.006F * static_cast<float>(i)))) << "2 s the wrong way, 5.4 m/s2";
    }
    for (int i = 0; i < 250; ++i) {
        ASSERT_FALSE(f.tick(command, course(std::max(0.6F - 0.006F * static_cast<float>(i), -0.8F)))) << i;
    }
}

TEST(FollowCheck, StallCountsAsATenthOfASecondAtMost)
{
    Followed f;
    EXPECT_LT(f.found(kEast, kNorth, 0.52F), 0.0F);
    EXPECT_FALSE(f.tick(kEast, kNorth, 10.0F));
    EXPECT_FOUND_AT(0.38F, f.found(kEast, kNorth));
}

TEST(FollowCheck, ClockThatGoesBackTakesNothingOff)
{
    Followed f;
    EXPECT_LT(f.found(kEast, kNorth, 0.52F), 0.0F);
    EXPECT_FALSE(f.tick(kEast, kNorth, -10.0F));
    EXPECT_FOUND_AT(0.48F, f.found(kEast, kNorth));
}

TEST(FollowCheck, WhatIsNotANumberDoesNotBlindTheCheck)
{
    for (const bool at_first : {true, false}) {
        for (const bool command : {true, false}) {
            Followed f;
            EXPECT_LT(f.found(kEast, kNorth, at_first ? 0.0F : 0.52F), 0.0F);
            EXPECT_FALSE(f.tick(command ? kNowhere : kEast, command ? kNorth : kNowhere));
            const float found = f.found(kEast, kNorth);
            EXPECT_GE(found, 0.4F) << at_first << command;
            EXPECT_LE(found, 1.1F) << at_first << command;
        }
    }
}

TEST(FollowCheck, AllowanceIsGivenAlsoAfterAFirstCommandThatWasNotANumber)
{
    Followed f;
    EXPECT_FALSE(f.tick(kNowhere, Vec3::Zero()));
    EXPECT_FALSE(f.changes(kNorth, Vec3::Zero(), kNorth, 2.0F));
    EXPECT_FOUND_TURNED_AT(FollowCheck::kPatience + FollowCheck::kAllowance, f.found(kEast, kNorth));
}

TEST(FollowCheck, WeakAnswerIsEnoughOnlyUpToTheMostThatIsExpected)
{
    const Vec3 far(30.0F, 0.0F, 0.0F);
    Followed strong;
    strong.limits.max_acceleration = 10.0F;
    EXPECT_FALSE(strong.changes(far, Vec3::Zero(), Vec3(10.0F, 0.0F, 0.0F), 5.0F)) << "2 m/s2 of 1.5 m/s2";
    Followed weak;
    weak.limits.max_acceleration = 2.0F;
    EXPECT_FALSE(weak.changes(far, Vec3::Zero(), Vec3(5.0F, 0.0F, 0.0F), 5.0F)) << "1 m/s2 of 0.6 m/s2";
    EXPECT_TRUE(strong.changes(far, Vec3::Zero(), Vec3(5.0F, 0.0F, 0.0F), 5.0F)) << "1 m/s2 of 1.5 m/s2";
}

TEST(FollowCheck, CommandThatWasIgnoredGivesNoAllowanceForTheNextOne)
{
    Followed f;
    EXPECT_FALSE(f.changes(kNorth, Vec3::Zero(), kNorth, 2.0F));
    EXPECT_LT(f.found(kEast, kNorth, 2.0F), 0.0F);
    EXPECT_FOUND_TURNED_AT(FollowCheck::kPatience + FollowCheck::kAllowance - 2.0F + kTurned, f.found(kWest, kNorth));
}

TEST(FollowCheck, CommandThatWasAnsweredByTheToleranceGivesTheAllowance)
{
    Followed f;
    EXPECT_FALSE(f.tick(kNorth, Vec3::Zero()));
    EXPECT_FALSE(f.tick(kNorth, Vec3(0.0F, 1.0F, 0.0F)));
    EXPECT_FOUND_TURNED_AT(FollowCheck::kPatience + FollowCheck::kAllowance, f.found(kEast, Vec3(0.0F, 1.0F, 0.0F)));
}

TEST(FollowCheck, GustAgainstTheAnswerDoesNotTakeTheAllowanceAway)
{
    Followed f;
    const Vec3 answered(0.0F, 1.1F, 0.0F), pushed(0.0F, 0.8F, 0.0F);
    EXPECT_FALSE(f.changes(kNorth, Vec3::Zero(), answered, 0.4F));
    EXPECT_FALSE(f.changes(kNorth, answered, pushed, 0.1F));
    EXPECT_FOUND_TURNED_AT(FollowCheck::kPatience + FollowCheck::kAllowance, f.found(kEast, pushed));
}

TEST(FollowCheck, LeavesAVelocityThatWasExactlyTheCommand)
{
    Followed f;
    EXPECT_LT(f.found(kNorth, kNorth, 1.0F), 0.0F);
    EXPECT_FOUND_TURNED_AT(1.0F, f.found(kNorth, kEast));
}

TEST(FollowCheck, AlarmComesWhenASecondsWorthIsMissing)
{
    Followed f;
    f.limits.max_acceleration = 10.0F;  // 1.5 m/s2 expected
    int ticks = -1;                     // the first one begins
    while (ticks < 100 && !f.tick(kEast, Vec3::Zero(), 0.0625F)) {
        ++ticks;
    }
    EXPECT_EQ(ticks + 1, 16) << "1 s in steps that a float holds exactly";
}

TEST(FollowCheck, GustThatCarriesTheVehicleAwayAtFirstIsAnsweredBeforeAnyAlarm)
{
    Followed f;
    Vec3 velocity = Vec3::Zero();
    for (int i = 0; i < 200; ++i) {
        // 0.3 s against the command with 3 m/s2, then with 2.5 m/s2 towards it.
        const Vec3 change = 0.02F * (i < 15 ? Vec3(-3.0F * kNorth.normalized()) : Vec3(2.5F * kNorth.normalized()));
        EXPECT_FALSE(f.tick(kNorth, velocity)) << i;
        velocity += (velocity - kNorth).norm() > 0.05F ? change : Vec3(Vec3::Zero());
    }
}

TEST(FollowCheck, ResetForgetsWhatWasMissing)
{
    Followed f;
    EXPECT_LT(f.found(kEast, kNorth, 0.9F), 0.0F);
    f.check.reset();
    EXPECT_FOUND_AT(1.0F, f.found(kEast, kNorth));
}

TEST(FollowCheck, FollowingForAnInstantDoesNotUndoWhatIsMissing)
{
    Followed f;
    EXPECT_FALSE(f.tick(kEast, kNorth));
    int ticks = 0;
    while (ticks < 400 && !f.tick(ticks % 4 == 3 ? kNorth : kEast, kNorth)) {
        ++ticks;
    }
    // Of four ticks one is taken off, and of the other three's change no more is expected than the square of three
    // quarters.
    EXPECT_NEAR(0.02F * static_cast<float>(ticks), 4.8F, 0.09F);
}

TEST(FollowCheck, CommandThatDiffersByTheToleranceIsTheSameOne)
{
    for (const float change : {FollowCheck::kTolerance, 1.001F * FollowCheck::kTolerance}) {
        Followed f;
        EXPECT_FALSE(f.changes(kNorth, Vec3::Zero(), kNorth, 2.0F));
        const bool same = change <= FollowCheck::kTolerance;
        const Vec3 next = kNorth - Vec3(0.0F, change, 0.0F);
        EXPECT_FOUND_TURNED_AT(FollowCheck::kPatience + (same ? 0.0F : FollowCheck::kAllowance), f.found(next, kEast))
            << change;
    }
}

TEST(FollowCheck, VehicleThatClosesTheWholeToleranceHasAnswered)
{
    for (const float off : {FollowCheck::kTolerance, 0.999F * FollowCheck::kTolerance}) {
        Followed f;
        EXPECT_FALSE(f.tick(kNorth, kNorth - Vec3(0.0F, off, 0.0F)));
        EXPECT_FALSE(f.tick(kNorth, kNorth));
        const bool answered = off >= FollowCheck::kTolerance;
        EXPECT_FOUND_TURNED_AT(FollowCheck::kPatience + (answered ? FollowCheck::kAllowance : 0.0F),
                               f.found(kEast, kNorth))
            << off;
    }
}

TEST(FollowCheck, DescentThatIsIgnoredIsNoticed)
{
    EXPECT_FOUND_AT(1.0F, Followed().found(Vec3(0.0F, 0.0F, -3.0F), Vec3::Zero()));
    EXPECT_FOUND_AT(2.5F, plane().found(Vec3(18.0F, 0.0F, 8.0F), Vec3(18.0F, 0.0F, 0.0F)));
}

TEST(FollowCheck, PlaneIsComparedByItsCourseAtItsOwnSpeed)
{
    EXPECT_FOUND_AT(2.5F, plane().found(Vec3(0.0F, 9.0F, 0.0F), Vec3(18.0F, 0.0F, 0.0F))) << "a right angle off";
    EXPECT_LT(plane().found(Vec3(30.0F, 0.0F, 0.0F), Vec3(12.0F, 0.0F, 0.0F)), 0.0F) << "slower than commanded";
    EXPECT_FOUND_AT(1.0F, Followed().found(Vec3(30.0F, 0.0F, 0.0F), Vec3(12.0F, 0.0F, 0.0F))) << "no plane";
}

}  // namespace
}  // namespace jink::app
