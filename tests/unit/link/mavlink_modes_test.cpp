// SPDX-License-Identifier: BSD-3-Clause
// Mode numbers as the autopilots' sources have them (docs/guides/take_over.md), and the transmit buffer.
#include "firmware/link/mavlink/modes.hpp"

#include <gtest/gtest.h>

#include <deque>

#include "firmware/link/mavlink/transmit_buffer.hpp"
#include "tests/unit/link/mavlink_tools.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;
using S = AutopilotStack;
using V = VehicleClass;
using F = FlightMode;

TEST(MavlinkModes, CopterModes)
{
    const auto mode = [](std::uint32_t m) { return classify(S::ardupilot, V::copter, m); };
    EXPECT_EQ(mode(3), F::mission);
    EXPECT_EQ(mode(4), F::external);
    EXPECT_EQ(mode(5), F::hold);
    EXPECT_EQ(mode(17), F::hold);
    EXPECT_EQ(mode(6), F::going_home);
    EXPECT_EQ(mode(0), F::manual);
    EXPECT_EQ(mode(1000), F::other);
    EXPECT_EQ(mode(0xFFFFFFFFU), F::other);
}

TEST(MavlinkModes, PlaneModes)
{
    const auto mode = [](std::uint32_t m) { return classify(S::ardupilot, V::plane, m); };
    EXPECT_EQ(mode(10), F::mission);
    EXPECT_EQ(mode(15), F::external);
    EXPECT_EQ(mode(12), F::hold);
    EXPECT_EQ(mode(11), F::going_home);
    EXPECT_EQ(mode(0), F::manual);
    EXPECT_EQ(mode(3), F::other) << "AUTO of a copter is TRAINING of a plane";
}

TEST(MavlinkModes, Px4Modes)
{
    const auto mode = [](std::uint32_t main, std::uint32_t sub) {
        return classify(S::px4, V::copter, main << 16U | sub << 24U);
    };
    EXPECT_EQ(mode(4, 4), F::mission);
    EXPECT_EQ(mode(6, 0), F::external);
    EXPECT_EQ(mode(4, 3), F::hold);
    EXPECT_EQ(mode(4, 5), F::going_home);
    EXPECT_EQ(mode(3, 0), F::manual);
    EXPECT_EQ(mode(4, 2), F::other) << "take-off";
    EXPECT_EQ(mode(0, 0), F::other);
    EXPECT_EQ(classify(S::px4, V::copter, 4), F::other) << "numbers of the other stack mean nothing";
}

TEST(MavlinkModes, NothingIsKnownOfOtherStacks)
{
    for (std::uint32_t m = 0; m < 30; ++m) {
        EXPECT_EQ(classify(S::unknown, V::copter, m), F::unknown);
    }
}

TEST(MavlinkModes, RequestedModesAreWhatTheyShouldBe)
{
    for (const V v : {V::copter, V::plane}) {
        for (const S s : {S::ardupilot, S::px4}) {
            EXPECT_EQ(classify(s, v, external_mode(s, v)), F::external);
            EXPECT_EQ(classify(s, v, hold_mode(s, v)), F::hold);
        }
    }
    EXPECT_EQ(external_mode(S::ardupilot, V::copter), 4U);
    EXPECT_EQ(external_mode(S::ardupilot, V::plane), 15U);
    EXPECT_EQ(px4_main(external_mode(S::px4, V::copter)), 6U);
    EXPECT_EQ(px4_main(hold_mode(S::px4, V::copter)), 4U);
    EXPECT_EQ(px4_sub(hold_mode(S::px4, V::copter)), 3U);
}

TEST(MavlinkTransmitBuffer, TakesWholeFramesOrNothing)
{
    TransmitBuffer<10> buffer;
    EXPECT_TRUE(buffer.push(Bytes(6, std::byte{1})));
    EXPECT_FALSE(buffer.push(Bytes(5, std::byte{2})));
    EXPECT_EQ(buffer.pending().size(), 6U);
    EXPECT_TRUE(buffer.push(Bytes(4, std::byte{3})));
    EXPECT_FALSE(buffer.push(Bytes(1, std::byte{4})));
    EXPECT_TRUE(buffer.push({}));
    buffer.consume(3);
    EXPECT_TRUE(buffer.push(Bytes(3, std::byte{5}))) << "closes ranks";
    EXPECT_EQ(to_hex(buffer.pending()), "01010103030303050505");
    buffer.consume(100);
    EXPECT_TRUE(buffer.pending().empty());
    EXPECT_TRUE(buffer.push(Bytes(10, std::byte{6})));
    buffer.clear();
    EXPECT_TRUE(buffer.pending().empty());
}

TEST(MavlinkTransmitBuffer, KeepsOrderThroughRandomUse)
{
    Random random(31);
    TransmitBuffer<64> buffer;
    std::deque<std::byte> expected;
    for (int i = 0; i < 50'000; ++i) {
        if (random.below(2) == 0) {
            const Bytes frame = random_bytes(random, random.below(30));
            const bool fits = expected.size() + frame.size() <= 64;
            ASSERT_EQ(buffer.push(frame), fits);
            if (fits) {
                expected.insert(expected.end(), frame.begin(), frame.end());
            }
        } else {
            const std::size_t n = std::min<std::size_t>(random.below(40), expected.size());
            buffer.consume(n);
            expected.erase(expected.begin(), expected.begin() + static_cast<std::ptrdiff_t>(n));
        }
        ASSERT_TRUE(std::equal(expected.begin(), expected.end(), buffer.pending().begin(), buffer.pending().end()));
    }
}

}  // namespace
}  // namespace jink::link::mavlink
