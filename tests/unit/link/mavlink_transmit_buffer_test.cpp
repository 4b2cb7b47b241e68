// SPDX-License-Identifier: BSD-3-Clause
// The transmit buffer against a list of frames: output is whole frames in order, and a perishable frame can be
// withdrawn until its first byte is sent.
#include <deque>
#include <optional>

#include <gtest/gtest.h>

#include "firmware/link/mavlink/transmit_buffer.hpp"
#include "tests/unit/link/mavlink_tools.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

TEST(MavlinkTransmitBuffer, TakesBackAWaitingSetpointFromTheMiddle)
{
    TransmitBuffer<20> buffer;
    ASSERT_TRUE(buffer.push(Bytes(2, std::byte{1})));
    ASSERT_TRUE(buffer.push(Bytes(3, std::byte{2}), Perishable::setpoint));
    ASSERT_TRUE(buffer.push(Bytes(2, std::byte{3}), Perishable::mode_request));
    EXPECT_TRUE(buffer.take_back(Perishable::setpoint));
    EXPECT_FALSE(buffer.take_back(Perishable::setpoint));
    EXPECT_EQ(to_hex(buffer.pending()), "01010303");
    EXPECT_TRUE(buffer.take_back(Perishable::mode_request));
    EXPECT_EQ(to_hex(buffer.pending()), "0101");
}

TEST(MavlinkTransmitBuffer, LeavesAPartlyWrittenSetpointWhole)
{
    TransmitBuffer<20> buffer;
    ASSERT_TRUE(buffer.push(Bytes(3, std::byte{2}), Perishable::setpoint));
    EXPECT_TRUE(buffer.holds(Perishable::setpoint));
    buffer.consume(1);
    EXPECT_FALSE(buffer.holds(Perishable::setpoint));
    EXPECT_FALSE(buffer.take_back(Perishable::setpoint));
    ASSERT_TRUE(buffer.push(Bytes(3, std::byte{3}), Perishable::setpoint));
    EXPECT_TRUE(buffer.take_back(Perishable::setpoint)) << "the one behind it can still go";
    EXPECT_EQ(to_hex(buffer.pending()), "0202");
}

struct Waiting {
    Bytes bytes;
    Perishable kind;
    bool begun = false;
};

TEST(MavlinkTransmitBuffer, RandomUseMatchesAListOfFrames)
{
    Random random(47);
    TransmitBuffer<64> buffer;
    std::deque<Waiting> list;
    const auto total = [&] {
        std::size_t n = 0;
        for (const Waiting& w : list) {
            n += w.bytes.size();
        }
        return n;
    };
    /// The youngest of a kind, if nothing of it has gone.
    const auto newest = [&](Perishable kind) -> std::optional<std::size_t> {
        for (std::size_t i = list.size(); i-- > 0;) {
            if (list[i].kind == kind) {
                return list[i].begun ? std::nullopt : std::optional<std::size_t>(i);
            }
        }
        return std::nullopt;
    };
    for (int i = 0; i < 100'000; ++i) {
        const auto kind = static_cast<Perishable>(random.below(kPerishables));
        const std::size_t what = random.below(4);
        if (what < 2) {
            const auto old = newest(kind);
            if (kind != Perishable::no) {  // as the endpoint does: the old frame is replaced
                ASSERT_EQ(buffer.take_back(kind), old.has_value()) << i;
                if (old) {
                    list.erase(list.begin() + static_cast<std::ptrdiff_t>(*old));
                }
            }
            const Bytes frame = random_bytes(random, 1 + random.below(20));
            const bool fits = total() + frame.size() <= 64;
            ASSERT_EQ(buffer.push(frame, kind), fits) << i;
            if (fits) {
                list.push_back({frame, kind});
            }
        } else if (what == 2) {
            std::size_t n = std::min<std::size_t>(random.below(30), total());
            buffer.consume(n);
            while (n > 0) {
                const std::size_t part = std::min(n, list.front().bytes.size());
                list.front().bytes.erase(list.front().bytes.begin(),
                                         list.front().bytes.begin() + static_cast<std::ptrdiff_t>(part));
                list.front().begun = true;
                if (list.front().bytes.empty()) {
                    list.pop_front();
                }
                n -= part;
            }
        } else if (kind != Perishable::no) {
            const auto old = newest(kind);
            ASSERT_EQ(buffer.holds(kind), old.has_value()) << i;
            ASSERT_EQ(buffer.take_back(kind), old.has_value()) << i;
            if (old) {
                list.erase(list.begin() + static_cast<std::ptrdiff_t>(*old));
            }
        }
        Bytes expected;
        for (const Waiting& w : list) {
            expected.insert(expected.end(), w.bytes.begin(), w.bytes.end());
        }
        ASSERT_EQ(to_hex(buffer.pending()), to_hex(expected)) << i;
    }
}

}  // namespace
}  // namespace jink::link::mavlink
