// SPDX-License-Identifier: BSD-3-Clause
// Frames of the mission line, and finding them in what comes in.
#include "firmware/link/mission/frame.hpp"

#include <algorithm>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace jink::link::mission {
namespace {

using Bytes = std::vector<std::byte>;

struct Recorder final : FrameSink {
    void take(const Frame& frame, TimePoint /*now*/) noexcept override { frames.push_back(frame); }
    std::vector<Frame> frames;
};

template <class M>
Bytes frame_of(const M& message, std::uint16_t sender = 0x0102, std::uint16_t sequence = 0x0304)
{
    Frame frame = pack(message);
    frame.sender = sender;
    frame.sequence = sequence;
    Bytes bytes(kMaxFrame);
    bytes.resize(write_frame(frame, bytes));
    return bytes;
}

/// Checksum bit by bit, as its definition says: reflected 0x1021, start 0xFFFF.
std::uint16_t checksum_of(const Bytes& bytes, std::size_t from, std::size_t to)
{
    unsigned crc = 0xFFFF;
    for (std::size_t i = from; i < to; ++i) {
        crc ^= std::to_integer<unsigned>(bytes[i]);
        for (int bit = 0; bit < 8; ++bit) {
            crc = (crc & 1U) != 0 ? crc >> 1U ^ 0x8408U : crc >> 1U;
        }
    }
    return static_cast<std::uint16_t>(crc);
}

/// By hand from the header's comment: what another implementation has to write.
TEST(MissionFrame, GoldenFrame)
{
    const Bytes bytes = frame_of(Config{0x1234, 1, 1.0F});
    const unsigned expected[] = {0x6A, 0xC9, 1, 9, 0x02, 0x01, 0x04, 0x03, 7, 0x34, 0x12, 1, 0x00, 0x00, 0x80, 0x3F};
    ASSERT_EQ(bytes.size(), 18U);
    for (std::size_t i = 0; i < 16; ++i) {
        EXPECT_EQ(std::to_integer<unsigned>(bytes[i]), expected[i]) << i;
    }
    const std::uint16_t checksum = checksum_of(bytes, 2, 16);
    EXPECT_EQ(std::to_integer<unsigned>(bytes[16]), checksum & 0xFFU);
    EXPECT_EQ(std::to_integer<unsigned>(bytes[17]), static_cast<unsigned>(checksum) >> 8U);
}

/// Payloads have the sizes that their fields add up to, and all fit.
TEST(MissionFrame, SizesOfMessages)
{
    EXPECT_EQ(payload_size(0), 0U);
    EXPECT_EQ(payload_size(12), 0U);
    EXPECT_EQ(payload_size(255), 0U);
    EXPECT_EQ(size_of(TaskUpload::kFields), 22U + 12U * 16U);
    EXPECT_EQ(size_of(StateNeighbour::kFields), 2U + 36U + 28U + 2U + 16U + 96U);
    for (std::uint8_t type = 1; type < 12; ++type) {
        EXPECT_GT(payload_size(type), 0U);
        EXPECT_LE(payload_size(type), mavlink::kMaxPayload);
    }
}

/// Every bit of every field survives: random payloads, unpacked and packed again.
template <class M>
void expect_round_trip(Random& random)
{
    Frame frame;
    frame.type = M::kType;
    for (std::size_t i = 0; i < size_of(M::kFields); ++i) {
        frame.payload[i] = static_cast<std::byte>(random.below(256));
    }
    EXPECT_EQ(pack(unpack<M>(frame)).payload, frame.payload) << static_cast<int>(M::kType);
}
TEST(MissionFrame, EveryFieldSurvives)
{
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        Random random(seed);
        expect_round_trip<TaskUpload>(random);
        expect_round_trip<TaskAck>(random);
        expect_round_trip<StateOwn>(random);
        expect_round_trip<StateNeighbour>(random);
        expect_round_trip<CommandSent>(random);
        expect_round_trip<MissionReport>(random);
        expect_round_trip<MonitorTrip>(random);
        expect_round_trip<TripAck>(random);
        expect_round_trip<Config>(random);
        expect_round_trip<ConfigAck>(random);
        expect_round_trip<MapInfo>(random);
    }
}

TEST(MissionFrame, NoRoomNoFrame)
{
    Bytes small(frame_size(size_of(Config::kFields)) - 1);
    EXPECT_EQ(write_frame(pack(Config{}), small), 0U);
    Frame unknown;
    unknown.type = static_cast<MessageType>(99);
    Bytes large(kMaxFrame);
    EXPECT_EQ(write_frame(unknown, large), 0U);
}

class MissionReceiver : public ::testing::Test {
protected:
    void receive(const Bytes& bytes, std::size_t at_once = 1000)
    {
        for (std::size_t i = 0; i < bytes.size(); i += at_once) {
            const std::size_t n = std::min(at_once, bytes.size() - i);
            receiver->receive(std::span(bytes).subspan(i, n), now, heard);
        }
        given += bytes.size();
        const ReceiverDiagnostics& d = receiver->diagnostics();
        EXPECT_EQ(d.frame_bytes + d.noise_bytes + receiver->pending(), given);
    }
    std::unique_ptr<Receiver> receiver = std::make_unique<Receiver>();
    Recorder heard;
    TimePoint now{1'000'000};
    std::size_t given = 0;
};

Bytes operator+(const Bytes& a, const Bytes& b)
{
    Bytes all = a;
    all.insert(all.end(), b.begin(), b.end());
    return all;
}

TEST_F(MissionReceiver, FramesInPiecesOfAnySize)
{
    Bytes stream;
    for (std::uint16_t i = 0; i < 20; ++i) {
        stream = stream + frame_of(TripAck{i}) + frame_of(StateNeighbour{});
    }
    for (const std::size_t at_once : {1U, 7U, 300U, 100'000U}) {
        receiver = std::make_unique<Receiver>();
        heard.frames.clear();
        given = 0;
        receive(stream, at_once);
        ASSERT_EQ(heard.frames.size(), 40U) << at_once;
        EXPECT_EQ(unpack<TripAck>(heard.frames[38]).trip, 19);
        EXPECT_EQ(heard.frames[0].sender, 0x0102);
        EXPECT_EQ(heard.frames[0].sequence, 0x0304);
        EXPECT_EQ(receiver->diagnostics().noise_bytes, 0U);
    }
}
/// Any single damaged byte loses that frame and no other.
TEST_F(MissionReceiver, ADamagedByteCostsOneFrame)
{
    const Bytes first = frame_of(CommandSent{});
    const Bytes second = frame_of(MapInfo{});
    for (std::size_t i = 0; i < first.size(); ++i) {
        receiver = std::make_unique<Receiver>();
        heard.frames.clear();
        given = 0;
        Bytes damaged = first;
        damaged[i] ^= std::byte{0x10};
        // A length or type that is wrong may claim what follows, until enough has come.
        receive(damaged + second + Bytes(kMaxFrame, std::byte{0}));
        ASSERT_EQ(heard.frames.size(), 1U) << i;
        EXPECT_EQ(heard.frames[0].type, MessageType::map_info);
    }
}
TEST_F(MissionReceiver, AFrameWithinAFalseOneIsFound)
{
    Bytes lie = frame_of(TaskUpload{});
    lie.resize(kHeaderSize + 3);
    receive(lie + frame_of(TripAck{5}));
    EXPECT_TRUE(heard.frames.empty()) << "it might still be the rest of the first";
    now = now + 0.2F;
    receiver->receive({}, now, heard);
    ASSERT_EQ(heard.frames.size(), 1U) << "the line was silent";
    EXPECT_EQ(unpack<TripAck>(heard.frames[0]).trip, 5);
    EXPECT_GT(receiver->diagnostics().cut, 0U);
    EXPECT_EQ(receiver->pending(), 0U);
}
TEST_F(MissionReceiver, RefusesOtherVersionsLengthsAndMessages)
{
    for (const std::size_t at : {2U, 3U, 8U}) {
        Bytes other = frame_of(TripAck{5});
        other[at] = std::byte{200};
        const std::uint16_t checksum = checksum_of(other, 2, other.size() - 2);
        other[other.size() - 2] = static_cast<std::byte>(checksum & 0xFFU);
        other[other.size() - 1] = static_cast<std::byte>(static_cast<unsigned>(checksum) >> 8U);
        receive(other);
    }
    EXPECT_TRUE(heard.frames.empty());
    EXPECT_EQ(receiver->diagnostics().unknown, 3U);
    receive(frame_of(TripAck{6}));
    EXPECT_EQ(heard.frames.size(), 1U);
}
TEST_F(MissionReceiver, NoiseIsPassedOver)
{
    Random random(4);
    for (int i = 0; i < 300; ++i) {
        Bytes noise(random.below(60));
        for (std::byte& b : noise) {
            b = static_cast<std::byte>(random.below(256));
            b = b == kSync[0] ? std::byte{0} : b;
        }
        receive(noise + frame_of(TripAck{static_cast<std::uint16_t>(i)}), 1 + random.below(50));
    }
    ASSERT_EQ(heard.frames.size(), 300U);
    EXPECT_EQ(unpack<TripAck>(heard.frames[299]).trip, 299);
}

}  // namespace
}  // namespace jink::link::mission
