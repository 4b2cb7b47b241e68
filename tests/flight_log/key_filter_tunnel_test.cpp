// SPDX-License-Identifier: BSD-3-Clause
// Signing keys in the tunnel of a bus on which one node sends more than one stream.
#include <gtest/gtest.h>

#include "firmware/link/dronecan/node.hpp"
#include "tests/flight_log/recorded_input.hpp"
#include "tests/flight_log/setup_signing.hpp"

namespace {

using namespace jink;
using namespace jink::test;
using namespace jink::flightlog;
using link::dronecan::TunnelTargetted;

constexpr std::size_t kLongestByChance = 2;  ///< bytes of the key that other bytes of a log may have in common with it
constexpr std::uint32_t kTargettedId = 3001U << 8U;
constexpr std::uint32_t kBroadcastId = 2010U << 8U;

/// The frames that a node sends through its tunnels.
class TunnellingNode {
public:
    void send(std::uint8_t target, std::int8_t serial, std::uint8_t flags, std::span<const std::byte> bytes)
    {
        TunnelTargetted message;
        message.protocol = 1;
        message.target = target;
        message.serial = serial;
        message.options = flags;
        for (const std::byte byte : bytes) {
            message.bytes.unchecked_push_back(std::to_integer<std::uint8_t>(byte));
        }
        ASSERT_TRUE(node_.send(message, link::dronecan::Priority::medium));
        while (const link::dronecan::Frame* const out = node_.outgoing().front()) {
            add(out->id, std::span(out->data).first(out->length));
            node_.outgoing().pop();
        }
    }
    void add(std::uint32_t id, std::span<const std::byte> data)
    {
        hal::CanFrame frame;
        frame.id = id;
        frame.extended = true;
        frame.length = static_cast<std::uint8_t>(data.size());
        std::copy(data.begin(), data.end(), frame.data.begin());
        frames_.push_back(frame);
    }
    [[nodiscard]] std::vector<hal::CanFrame>& frames() { return frames_; }
    /// A log of these frames, each in a step of its own.
    [[nodiscard]] std::vector<Bytes> log() const
    {
        RecordedInput input;
        for (const hal::CanFrame& frame : frames_) {
            input.step([&](HalRecorder& recorder) { recorder.received(&frame); });
        }
        return input.messages();
    }

private:
    static link::dronecan::NodeOptions options()
    {
        link::dronecan::NodeOptions options;
        options.node = 10;
        return options;
    }
    link::dronecan::Node node_{options()};
    std::vector<hal::CanFrame> frames_;
};

std::ptrdiff_t count_of_other(const Bytes& log) { return std::count(log.begin(), log.end(), std::byte{0x55}); }

/// The frame in transfers of `piece` bytes, and behind each of them one to another node or port.
TEST(KeyFilterTunnel, FindsAKeyBesideASecondPort)
{
    const Bytes frame = setup_signing_frame();
    for (std::size_t piece = 1; piece <= frame.size(); ++piece) {
        for (const bool same_target : {false, true}) {
            TunnellingNode node;
            std::uint8_t flags = 0;
            for (std::span<const std::byte> rest(frame); !rest.empty();) {
                const std::size_t n = std::min(piece, rest.size());
                node.send(42, 0, flags, rest.first(n));
                node.send(same_target ? 42 : 43, same_target ? 1 : 0, 0, Bytes(1 + 37 * n % 120, std::byte{0x55}));
                rest = rest.subspan(n);
                flags ^= 1U;  // the same port, whether or not it is kept for the tunnel
            }
            const std::vector<Bytes> messages = node.log();
            const Bytes log = filtered(messages);
            ASSERT_LE(longest_part(log, secret()), kLongestByChance) << piece;
            ASSERT_EQ(count_of_other(log), count_of_other(joined(messages))) << "what the other port carries stays";
            for (std::size_t i = 0; i < messages.size(); i += 3) {
                std::vector<Bytes> left = messages;
                left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
                ASSERT_LE(longest_part(filtered(left), secret()), kLongestByChance) << piece << " without " << i;
            }
        }
    }
}

/// Frames of a Broadcast transfer between those of a Targetted one.
TEST(KeyFilterTunnel, FindsAKeyBetweenTheFramesOfAnotherType)
{
    constexpr std::byte kOther{0x55};
    const std::array<std::array<std::byte, 8>, 3> transfer{
        {{std::byte{1}, std::byte{2}, std::byte{1}, std::byte{0}, kOther, kOther, kOther, std::byte{0x80}},
         {kOther, kOther, kOther, kOther, kOther, kOther, kOther, std::byte{0x20}},
         {kOther, kOther, kOther, kOther, kOther, kOther, kOther, std::byte{0x40}}}};
    const Bytes frame = setup_signing_frame();
    for (std::size_t piece = 1; piece <= frame.size(); ++piece) {
        TunnellingNode only;
        for (std::span<const std::byte> rest(frame); !rest.empty(); rest = rest.subspan(std::min(piece, rest.size()))) {
            only.send(42, 0, 0, rest.first(std::min(piece, rest.size())));
        }
        TunnellingNode both;
        for (std::size_t i = 0; i < only.frames().size(); ++i) {
            both.frames().push_back(only.frames()[i]);
            both.add(16U << 24U | kBroadcastId | 10U, transfer[i % transfer.size()]);
        }
        const std::vector<Bytes> messages = both.log();
        const Bytes log = filtered(messages);
        ASSERT_LE(longest_part(log, secret()), kLongestByChance) << piece;
        ASSERT_EQ(count_of_other(log), count_of_other(joined(messages))) << "what the other type carries stays";
    }
}

/// The log begins within the transfer that carries the beginning of the frame.
TEST(KeyFilterTunnel, FindsAKeyWhoseFirstTransferBeganBeforeTheLog)
{
    const Bytes frame = setup_signing_frame();
    for (std::size_t cut = 1; cut < frame.size(); ++cut) {
        TunnellingNode node;
        Bytes first(30, std::byte{0x55});
        first.insert(first.end(), frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(cut));
        node.send(42, 0, 0, first);
        node.send(42, 0, 0, std::span(frame).subspan(cut));
        for (std::size_t missing = 1; missing < 5; ++missing) {
            node.frames().erase(node.frames().begin());
            ASSERT_LE(longest_part(filtered(node.log()), secret()), kLongestByChance) << cut << " " << missing;
        }
    }
}

/// More streams than are followed at once begin between two transfers of the frame.
TEST(KeyFilterTunnel, FindsAKeyAmongManyStreams)
{
    const Bytes frame = setup_signing_frame();
    for (std::size_t cut = 1; cut < frame.size(); ++cut) {
        TunnellingNode node;
        node.send(42, 0, 0, std::span(frame).first(cut));
        for (std::uint32_t i = 0; i < 600; ++i) {
            const std::array data{std::byte{1},    static_cast<std::byte>(i / 100 << 1U),
                                  std::byte{0},    std::byte{0},
                                  std::byte{0},    std::byte{0},
                                  std::byte{0x55}, std::byte{0xC0}};
            node.add(16U << 24U | kTargettedId | (20U + i % 100U), data);
        }
        node.send(42, 0, 0, std::span(frame).subspan(cut));
        ASSERT_LE(longest_part(filtered(node.log(), 10), secret()), kLongestByChance) << cut;
    }
}

/// A first frame that is too short to name target and port.
TEST(KeyFilterTunnel, FindsAKeyBehindAShortFirstFrame)
{
    const Bytes frame = setup_signing_frame();
    for (std::size_t cut = 1; cut < frame.size(); ++cut) {
        TunnellingNode node;
        node.send(42, 0, 0, std::span(frame).first(cut));
        for (std::size_t i = node.frames().size(); i > 0; --i) {
            node.add(16U << 24U | kTargettedId | 10U, std::array{std::byte{1}, std::byte{2}, std::byte{0x81}});
        }
        node.send(42, 0, 0, std::span(frame).subspan(cut));
        ASSERT_LE(longest_part(filtered(node.log()), secret()), kLongestByChance) << cut;
    }
}

}  // namespace
