// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/clock_sync.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "core/base/random.hpp"

namespace jink::link::mavlink {
namespace {

constexpr std::int64_t kOffset = 77'000'000;  ///< our clock less the remote one

TEST(MavlinkClockSync, KnowsNothingAtFirst)
{
    ClockSync clock;
    EXPECT_FALSE(clock.to_local(5).has_value());
}

TEST(MavlinkClockSync, KeepsTheQuickestOneWaySample)
{
    ClockSync clock;
    EXPECT_EQ(clock.one_way(0, kOffset + 30'000), ClockEvent::none);
    EXPECT_EQ(clock.to_local(0), kOffset + 30'000);
    EXPECT_EQ(clock.one_way(100'000, kOffset + 105'000), ClockEvent::none);
    EXPECT_EQ(clock.to_local(0), kOffset + 5'000);
    EXPECT_EQ(clock.one_way(200'000, kOffset + 260'000), ClockEvent::none);
    EXPECT_EQ(clock.to_local(0), kOffset + 5'000);
}

TEST(MavlinkClockSync, ARoundTripHalvesTheDelay)
{
    ClockSync clock;
    clock.one_way(0, kOffset + 40'000);
    // 10 ms there, 10 ms back
    EXPECT_EQ(clock.round_trip(kOffset + 100'000, 110'000, kOffset + 120'000), ClockEvent::none);
    EXPECT_EQ(clock.to_local(0), kOffset);
    // a slower one changes nothing
    EXPECT_EQ(clock.round_trip(kOffset + 200'000, 290'000, kOffset + 300'000), ClockEvent::none);
    EXPECT_EQ(clock.to_local(0), kOffset);
}

TEST(MavlinkClockSync, RoundTripsOverASecondOrIntoThePastAreRefused)
{
    ClockSync clock;
    clock.round_trip(0, 500'000, 1'000'001);
    clock.round_trip(10, 500'000, 9);
    EXPECT_FALSE(clock.to_local(0).has_value());
    clock.round_trip(0, 500'000, 1'000'000);
    EXPECT_TRUE(clock.to_local(0).has_value());
}

TEST(MavlinkClockSync, OldSamplesGiveWayWithinTwoBuckets)
{
    ClockSync clock;
    clock.one_way(0, kOffset);  // a lucky one
    for (std::int64_t t = 0; t < 2 * ClockSync::kBucket + 200'000; t += 100'000) {
        clock.one_way(t, kOffset + t + 50'000);
    }
    EXPECT_EQ(clock.to_local(0), kOffset + 50'000);
}

TEST(MavlinkClockSync, FollowsDriftWithinAMillisecond)
{
    // 100 ppm fast and slow, line delay 5 to 15 ms, one sample each 20 ms for ten minutes
    for (const double rate : {1.0 + 100e-6, 1.0 - 100e-6}) {
        ClockSync clock;
        Random random(5);
        double worst = 0.0;
        for (int i = 0; i < 30'000; ++i) {
            const double remote = i * 20'000.0;
            const double local = static_cast<double>(kOffset) + remote * rate;
            const auto delay = static_cast<std::int64_t>(5'000 + random.below(10'000));
            EXPECT_EQ(clock.one_way(static_cast<std::int64_t>(remote), static_cast<std::int64_t>(local) + delay),
                      ClockEvent::none);
            const double mapped = static_cast<double>(*clock.to_local(static_cast<std::int64_t>(remote)));
            // the least delay is unknowable one way; a second's worth of samples must have found nearly the least
            worst = i > 50 ? std::max(worst, std::abs(mapped - local - 5'000)) : worst;
        }
        EXPECT_LT(worst, 2'500.0);
    }
}

TEST(MavlinkClockSync, ThreeSamplesFromTheFutureMoveTheClockForward)
{
    ClockSync clock;
    clock.one_way(0, kOffset);
    EXPECT_EQ(clock.one_way(1'000'000, kOffset), ClockEvent::none);
    EXPECT_EQ(clock.one_way(1'020'000, kOffset + 20'000), ClockEvent::none);
    EXPECT_EQ(clock.to_local(0), kOffset) << "not believed yet";
    EXPECT_EQ(clock.one_way(1'040'000, kOffset + 40'000), ClockEvent::relocked_forward);
    EXPECT_EQ(clock.to_local(1'000'000), kOffset);
}

TEST(MavlinkClockSync, OneGoodSampleInBetweenForgivesTheBadOnes)
{
    ClockSync clock;
    clock.one_way(0, kOffset);
    for (std::int64_t i = 1; i < 20; ++i) {
        const std::int64_t t = i * 20'000;
        const bool wild = i % 3 != 0;
        EXPECT_EQ(clock.one_way(wild ? t + 5'000'000 : t, kOffset + t), ClockEvent::none);
    }
    EXPECT_EQ(clock.to_local(0), kOffset);
}

TEST(MavlinkClockSync, ThreeStampsFromThePastMeanARestart)
{
    ClockSync clock;
    for (std::int64_t t = 0; t < 1'000'000; t += 20'000) {
        clock.one_way(60'000'000 + t, kOffset + t);
    }
    EXPECT_EQ(clock.one_way(3'000'000, kOffset + 2'000'000), ClockEvent::none);
    EXPECT_EQ(clock.one_way(3'020'000, kOffset + 2'020'000), ClockEvent::none);
    EXPECT_EQ(clock.one_way(3'040'000, kOffset + 2'040'000), ClockEvent::relocked_backward);
    EXPECT_EQ(clock.to_local(3'000'000), kOffset + 2'000'000);
}

TEST(MavlinkClockSync, LateStampsInOrderMoveNothing)
{
    for (const std::int64_t stall : {300'000, 1'000'000, 10'000'000}) {
        ClockSync clock;
        clock.one_way(0, kOffset);
        for (std::int64_t t = 20'000; t < stall; t += 20'000) {
            EXPECT_EQ(clock.one_way(t, kOffset + stall), ClockEvent::none);
            EXPECT_EQ(clock.to_local(t), kOffset + t) << "age must show";
        }
    }
}

TEST(MavlinkClockSync, ARestartSoonAfterTheStartIsFoundByRoundTrips)
{
    // up for 1 s, then away for 20 s: the new stamps are late, not from the past
    ClockSync clock;
    clock.one_way(1'000'000, kOffset);
    const std::int64_t later = kOffset + 20'000'000;
    for (std::int64_t i = 0; i < 2; ++i) {
        const std::int64_t t = i * 1'000'000;
        EXPECT_EQ(clock.one_way(2'000'000 + t, later + t), ClockEvent::none);
        EXPECT_EQ(clock.round_trip(later + t, 2'010'000 + t, later + t + 20'000), ClockEvent::none);
    }
    EXPECT_EQ(clock.round_trip(later + 2'000'000, 4'010'000, later + 2'020'000), ClockEvent::relocked_backward);
    EXPECT_EQ(clock.to_local(2'000'000), later);
}

TEST(MavlinkClockSync, RoundTripsThatAreAheadMoveItForward)
{
    ClockSync clock;
    clock.one_way(0, kOffset + 900'000);  // the first sample was delayed
    ClockEvent event = ClockEvent::none;
    for (std::int64_t i = 0; i < 3; ++i) {
        const std::int64_t t = i * 1'000'000;
        event = clock.round_trip(kOffset + t, t + 5'000, kOffset + t + 10'000);
    }
    EXPECT_EQ(event, ClockEvent::relocked_forward);
    EXPECT_EQ(clock.to_local(0), kOffset);
}

TEST(MavlinkClockSync, ASlowRoundTripMayDisagreeByHalfItsDuration)
{
    ClockSync clock;
    clock.one_way(0, kOffset);
    for (std::int64_t i = 0; i < 10; ++i) {  // 800 ms there, none back: the midpoint is 400 ms off
        const std::int64_t t = i * 1'000'000;
        EXPECT_EQ(clock.round_trip(kOffset + t, t + 800'000, kOffset + t + 800'000), ClockEvent::none);
    }
}

TEST(MavlinkClockSync, BootClockIsExtendedOverItsWrapAndBack)
{
    ClockSync clock;
    EXPECT_EQ(clock.extend(0xFFFFFFF0U), 0xFFFFFFF0LL * 1000);
    EXPECT_EQ(clock.extend(0x00000010U), 0x100000010LL * 1000);
    EXPECT_EQ(clock.extend(0xFFFFFFFFU), 0xFFFFFFFFLL * 1000) << "streams may interleave";
    EXPECT_EQ(clock.extend(0x00000020U), 0x100000020LL * 1000);
}

TEST(MavlinkClockSync, ABlockedReadWithTheClockReadBeforeItIsNoRestart)
{
    // The clock was read, then the read blocked for 0.5 s: messages received meanwhile appear to be from the future.
    ClockSync clock;
    std::int64_t t = 0;
    for (; t < 10'000'000; t += 40'000) {
        clock.one_way(t, kOffset + t + 3'000);
        if (t % 1'000'000 == 0) {
            clock.round_trip(kOffset + t, t + 5'000, kOffset + t + 10'000);
        }
    }
    for (std::int64_t i = 0; i < 12; ++i) {
        EXPECT_EQ(clock.one_way(t + i * 40'000, kOffset + t), ClockEvent::none);
    }
    for (t += 500'000; t < 20'000'000; t += 40'000) {
        EXPECT_EQ(clock.one_way(t, kOffset + t + 3'000), ClockEvent::none);
        if (t % 1'000'000 < 40'000) {
            EXPECT_EQ(clock.round_trip(kOffset + t, t + 5'000, kOffset + t + 10'000), ClockEvent::none);
        }
    }
    EXPECT_EQ(clock.to_local(0), kOffset);
}

TEST(MavlinkClockSync, ASlowFirstRoundTripIsNoRestart)
{
    ClockSync clock;  // 0.9 s there, nothing back: its midpoint is 0.45 s off
    clock.round_trip(kOffset, 900'000, kOffset + 900'000);
    for (std::int64_t t = 1'000'000; t < 10'000'000; t += 1'000'000) {
        EXPECT_EQ(clock.round_trip(kOffset + t, t + 2'000, kOffset + t + 4'000), ClockEvent::none);
    }
    EXPECT_EQ(clock.to_local(0), kOffset);
}

TEST(MavlinkClockSync, OneWaySamplesTakeOverWhenAnswersEnd)
{
    // The remote clock is 100 ppm fast and answers no more after a minute: an hour later the map is off by 0.36 s.
    ClockSync clock;
    for (std::int64_t t = 0; t < 3'600'000'000; t += 200'000) {
        const std::int64_t remote = t + t / 10'000;
        EXPECT_EQ(clock.one_way(remote, kOffset + t + 5'000), ClockEvent::none);
        if (t < 60'000'000 && t % 1'000'000 == 0) {
            clock.round_trip(kOffset + t - 4'000, remote, kOffset + t + 4'000);
        }
        const std::int64_t mapped = *clock.to_local(remote);
        ASSERT_NEAR(static_cast<double>(mapped), static_cast<double>(kOffset + t), 7'000.0) << t;
    }
}

TEST(MavlinkClockSync, FollowsAnAutopilotThatWrappedBeforeWeStarted)
{
    constexpr std::int64_t kUp = (1LL << 32) * 1000 + 5'000'000;  // 49.7 days and 5 s [us]
    ClockSync clock;
    int relocks = 0;
    for (std::int64_t t = 0; t < 20'000'000; t += 40'000) {
        const auto low = static_cast<std::uint32_t>((kUp + t) / 1000);
        const std::int64_t extended = clock.extend(low, kOffset + t);
        relocks += clock.one_way(extended, kOffset + t) != ClockEvent::none ? 1 : 0;
        if (t % 1'000'000 == 0) {
            const ClockEvent event = clock.round_trip(kOffset + t, kUp + t, kOffset + t);
            EXPECT_NE(event, ClockEvent::relocked_backward);
            relocks += event != ClockEvent::none ? 1 : 0;
        }
        EXPECT_EQ(clock.to_local(clock.extend(low, kOffset + t)), kOffset + t) << t;
    }
    EXPECT_LE(relocks, 1);
}

TEST(MavlinkClockSync, ARestartAfterMoreThanHalfTheWrapIsARestart)
{
    constexpr std::int64_t kUp = 30LL * 86'400 * 1'000'000;  // [us]
    for (const bool answers : {false, true}) {
        ClockSync clock;
        for (std::int64_t t = 0; t < 4'000'000; t += 40'000) {
            clock.one_way(clock.extend(static_cast<std::uint32_t>((kUp + t) / 1000), kOffset + t), kOffset + t);
            if (answers && t % 1'000'000 == 0) {
                clock.round_trip(kOffset + t, kUp + t, kOffset + t);
            }
        }
        int restarts = 0;
        for (std::int64_t t = 4'000'000; t < 10'000'000; t += 40'000) {
            const std::int64_t boot = t - 3'000'000;
            const auto low = static_cast<std::uint32_t>(boot / 1000);
            restarts += clock.one_way(clock.extend(low, kOffset + t), kOffset + t) == ClockEvent::relocked_backward;
            if (answers && t % 1'000'000 == 0) {
                restarts += clock.round_trip(kOffset + t, boot, kOffset + t) == ClockEvent::relocked_backward;
            }
        }
        EXPECT_EQ(restarts, 1) << answers;
        const auto low = static_cast<std::uint32_t>(7'000);
        EXPECT_EQ(clock.to_local(clock.extend(low, kOffset + 10'000'000)), kOffset + 10'000'000) << answers;
    }
}

TEST(MavlinkClockSync, ForgetsEverything)
{
    ClockSync clock;
    clock.one_way(0, kOffset);
    EXPECT_EQ(clock.extend(0xFFFFFFFFU), 0xFFFFFFFFLL * 1000);
    clock.forget();
    EXPECT_FALSE(clock.to_local(0).has_value());
    EXPECT_EQ(clock.extend(5), 5000);
}

}  // namespace
}  // namespace jink::link::mavlink
