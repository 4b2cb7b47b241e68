// SPDX-License-Identifier: BSD-3-Clause
// Clocks of the other systems of a link.
#include "firmware/link/mavlink/neighbours.hpp"

#include <cstdlib>
#include <memory>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "firmware/link/mavlink/clock_sync.hpp"

namespace jink::link::mavlink {
namespace {

constexpr std::int64_t kStart = 1'000'000'000;
constexpr std::uint8_t kNeighbourSystem = 9;

/// One other system: its boot clock and ours.
struct MavlinkNeighbours : testing::Test {
    /// Sent at `at` of its clock, arrives `delay` later [ms]. @return the age that it is given [ms]
    std::int64_t age(std::int64_t at, std::int64_t delay, std::uint8_t system = kNeighbourSystem)
    {
        const TimePoint now{kStart + (at + delay) * 1000};
        const TimePoint stamp = neighbours->stamp(system, static_cast<std::uint32_t>(boot + at), now);
        EXPECT_LE(stamp, now);
        return (now.us - stamp.us) / 1000;
    }
    std::unique_ptr<Neighbours> neighbours = std::make_unique<Neighbours>();
    std::int64_t boot = 5'000;  ///< of its clock at our kStart [ms]
};

TEST_F(MavlinkNeighbours, TheQuickestMessageCountsAsNew)
{
    EXPECT_EQ(age(0, 120), 0) << "the first one";
    EXPECT_EQ(age(100, 20), 0) << "quicker";
    EXPECT_EQ(age(200, 120), 100);
    EXPECT_EQ(age(300, 20), 0);
}

TEST_F(MavlinkNeighbours, AStalledLineBringsOldNews)
{
    for (std::int64_t t = 0; t < 2000; t += 100) {
        EXPECT_EQ(age(t, 30), 0);
    }
    // It stalls for 4 s, and then everything comes at once.
    for (std::int64_t t = 2000; t < 6000; t += 100) {
        EXPECT_EQ(age(t, 6030 - t), 6000 - t) << t;
    }
    EXPECT_EQ(age(6100, 30), 0);
}

TEST_F(MavlinkNeighbours, AConstantDelayGrownByLessThanAJumpIsBelievedAfterTwoBuckets)
{
    for (std::int64_t t = 0; t < 1000; t += 100) {
        static_cast<void>(age(t, 30));
    }
    EXPECT_EQ(age(1000, 130), 100);
    for (std::int64_t t = 1100; t < 12'000; t += 100) {
        static_cast<void>(age(t, 130));
    }
    EXPECT_EQ(age(12'000, 130), 0);
}

TEST_F(MavlinkNeighbours, ARestartIsFollowedAtTheThirdStamp)
{
    for (std::int64_t t = 0; t < 60'000; t += 100) {
        static_cast<void>(age(t, 30));
    }
    boot = -60'500;
    EXPECT_GT(age(60'600, 30), 60'000) << "out of order, as far as can be known";
    EXPECT_GT(age(60'700, 30), 60'000);
    EXPECT_EQ(age(60'800, 30), 0);
    EXPECT_EQ(age(60'900, 230), 200);
}

/// Its clock shows more than when it was heard last, and less than it would have shown without the restart.
TEST_F(MavlinkNeighbours, ARestartWhileUnheardIsFollowedAtTheFirstStamp)
{
    for (std::int64_t t = 0; t < 40'000; t += 100) {
        static_cast<void>(age(t, 30));
    }
    for (std::int64_t t = 40'000; t < 160'000; t += 1000) {  // heartbeats show no clock
        neighbours->note_armed(kNeighbourSystem, true, TimePoint{kStart + t * 1000});
    }
    boot -= 100'000;
    EXPECT_EQ(age(160'000, 30), 0);
    EXPECT_EQ(age(160'100, 230), 200);
}

TEST_F(MavlinkNeighbours, TheDriftOfALongSilenceIsForgotten)
{
    static_cast<void>(age(0, 30));
    boot -= 720;  // 100 ppm, two hours
    EXPECT_EQ(age(7'200'000, 30), 0);
    EXPECT_EQ(age(7'200'100, 130), 100);
}

TEST_F(MavlinkNeighbours, OfAShortSilenceNothingIsForgotten)
{
    for (std::int64_t t = 0; t < 1000; t += 100) {
        static_cast<void>(age(t, 30));
    }
    EXPECT_EQ(age(1000, 9900), 9870);
    EXPECT_EQ(age(11'000, 9800), 9770) << "late messages are heard";
    EXPECT_EQ(age(30'000, 30), 0);
}

TEST_F(MavlinkNeighbours, TwoOldMessagesAreNoRestart)
{
    for (std::int64_t t = 0; t < 60'000; t += 100) {
        static_cast<void>(age(t, 30));
    }
    EXPECT_EQ(age(1000, 60'000), 59'970);
    EXPECT_EQ(age(1100, 60'000), 59'970);
    EXPECT_EQ(age(61'100, 30), 0);
    EXPECT_EQ(age(1200, 61'000), 60'970) << "not the third in a row";
}

TEST_F(MavlinkNeighbours, AClockThatLeapsAheadIsFollowedAtTheThirdStamp)
{
    for (std::int64_t t = 0; t < 1000; t += 100) {
        static_cast<void>(age(t, 30));
    }
    boot += 10'000;
    EXPECT_EQ(age(1000, 30), 0) << "never from the future";
    EXPECT_EQ(age(1100, 30), 0);
    EXPECT_EQ(age(1200, 30), 0);
    EXPECT_EQ(age(1300, 130), 100) << "by the new clock";
}

TEST_F(MavlinkNeighbours, TheWrapOfTheWiresClockIsNoEvent)
{
    boot = 0xFFFFFFFFLL - 1500;
    for (std::int64_t t = 0; t < 4000; t += 100) {
        EXPECT_EQ(age(t, t % 300 == 0 ? 30 : 90), t % 300 == 0 ? 0 : 60) << t;
    }
}

TEST_F(MavlinkNeighbours, TheLongestUnheardGivesWay)
{
    for (std::size_t i = 0; i < kMaxTracks; ++i) {
        EXPECT_EQ(age(static_cast<std::int64_t>(i), 0, static_cast<std::uint8_t>(i + 1)), 0);
    }
    EXPECT_EQ(age(300, 0, 1), 0) << "heard again";
    EXPECT_EQ(neighbours->evicted(), 0U);
    EXPECT_EQ(age(310, 50, kMaxTracks + 1), 0);
    EXPECT_EQ(neighbours->evicted(), 1U);
    EXPECT_EQ(age(320, 90, 1), 90) << "its clock is known still";
    EXPECT_EQ(age(330, 90, 2), 0) << "its is not";
    EXPECT_EQ(neighbours->evicted(), 2U);
}

TEST_F(MavlinkNeighbours, WhoeverSaysSoIsDisarmed)
{
    EXPECT_FALSE(neighbours->is_disarmed(kNeighbourSystem)) << "nothing was said";
    neighbours->note_armed(kNeighbourSystem, false, {kStart});
    EXPECT_TRUE(neighbours->is_disarmed(kNeighbourSystem));
    EXPECT_FALSE(neighbours->is_disarmed(kNeighbourSystem + 1));
    EXPECT_EQ(age(0, 50), 0) << "a heartbeat brings no stamp";
    EXPECT_TRUE(neighbours->is_disarmed(kNeighbourSystem));
    neighbours->note_armed(kNeighbourSystem, true, {kStart});
    EXPECT_FALSE(neighbours->is_disarmed(kNeighbourSystem));
}

/// As ClockSync has it, over stalls, losses, jumps and restarts at random: never more than its rounding apart.
TEST_F(MavlinkNeighbours, AgreesWithClockSync)
{
    Random random(20261);
    const auto below = [&](std::uint64_t n) { return static_cast<std::int64_t>(random.below(n)); };
    for (int run = 0; run < 50; ++run) {
        neighbours = std::make_unique<Neighbours>();
        ClockSync oracle;
        std::int64_t offset = below(1'000'000);
        std::int64_t now = 10'000;
        std::int64_t stall = 0;
        for (int i = 0; i < 1500; ++i) {
            now += 20 + below(200);
            stall = stall > 0 ? stall - 50 : (below(200) == 0 ? below(5000) : 0);
            if (below(400) == 0) {
                offset = below(2) == 0 ? now - below(1000) : offset - 5000;
            }
            const std::int64_t sent = now - 10 - below(120) - std::max<std::int64_t>(stall, 0);
            const std::int64_t boot_ms = std::max<std::int64_t>(0, sent - offset);
            static_cast<void>(oracle.one_way(boot_ms * 1000, now * 1000));
            const std::int64_t theirs = std::min(oracle.to_local(boot_ms * 1000).value(), now * 1000);
            const TimePoint ours =
                neighbours->stamp(kNeighbourSystem, static_cast<std::uint32_t>(boot_ms), TimePoint{now * 1000});
            ASSERT_EQ(ours.us, theirs) << "run " << run << " message " << i;
        }
    }
}

}  // namespace
}  // namespace jink::link::mavlink
