// SPDX-License-Identifier: BSD-3-Clause
// Every counter of ParserDiagnostics is provoked here, each by the frame that its comment describes.
#include <gtest/gtest.h>

#include "tests/unit/link/mavlink_tools.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

Bytes parser_heartbeat(std::uint8_t sequence, std::uint8_t system = 1, std::uint8_t component = 1)
{
    Heartbeat m;
    m.custom_mode = 4;
    return frame_of(m, {system, component, sequence});
}

Bytes operator+(Bytes a, const Bytes& b)
{
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

std::size_t accepted(Parser& parser, const Bytes& stream) { return parse(parser, stream).size(); }

RawFrame raw_heartbeat()
{
    RawFrame raw;
    raw.payload = Bytes(9, std::byte{1});
    raw.crc_extra = 50;
    return raw;
}

TEST(MavlinkParser, NothingFromNothing)
{
    Parser parser;
    std::span<const std::byte> nothing;
    EXPECT_FALSE(parser.next(nothing).has_value());
    EXPECT_FALSE(parser.flush().has_value());
    EXPECT_EQ(parser.pending(), 0U);
}

TEST(MavlinkParser, GluedFramesComeOneByOneWhateverTheChunks)
{
    Bytes stream;
    for (std::uint8_t i = 0; i < 40; ++i) {
        stream = stream + parser_heartbeat(i);
    }
    for (std::size_t chunk = 1; chunk <= stream.size(); ++chunk) {
        Parser parser;
        ASSERT_EQ(parse(parser, stream, chunk).size(), 40U) << chunk;
        ASSERT_EQ(parser.diagnostics().noise_bytes, 0U);
        ASSERT_EQ(parser.diagnostics().lost, 0U);
        ASSERT_EQ(parser.pending(), 0U);
    }
}

TEST(MavlinkParser, AcceptsUntrimmedTrimmedAndEmptyPayloads)
{
    for (std::size_t length = 0; length <= 28; ++length) {
        RawFrame raw;
        raw.id = Attitude::kInfo.id;
        raw.crc_extra = Attitude::kInfo.crc_extra;
        raw.payload = Bytes(length, std::byte{0});
        Parser parser;
        const auto frames = parse(parser, raw.bytes());
        ASSERT_EQ(frames.size(), 1U) << length;
        EXPECT_EQ(frames[0].length, length);
        EXPECT_EQ(frames[0].payload, Bytes(kMaxPayload, std::byte{0}));
    }
}

TEST(MavlinkParser, PayloadOfAnEarlierFrameDoesNotShineThrough)
{
    Parser parser;
    Tunnel full = from_payload<Tunnel>(Bytes(Tunnel::kInfo.max_length, std::byte{0xFF}));
    ASSERT_EQ(accepted(parser, frame_of(full)), 1U);
    const auto frames = parse(parser, frame_of(Tunnel{}));
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(frames[0].payload, Bytes(kMaxPayload, std::byte{0}));
}

TEST(MavlinkParser, PayloadsOfAnyLengthAreFollowedByZeros)
{
    Parser parser;
    for (const std::size_t length : {254U, 0U, 100U, 30U, 31U, 29U, 254U, 1U}) {
        RawFrame raw;
        raw.id = 110;
        raw.crc_extra = 84;
        raw.payload = Bytes(length, std::byte{3});
        const auto frames = parse(parser, raw.bytes());
        ASSERT_EQ(frames.size(), 1U) << length;
        EXPECT_EQ(frames[0].payload, raw.payload + Bytes(kMaxPayload - length, std::byte{0})) << length;
    }
}

TEST(MavlinkParser, FramesOfMessagesNotDecodedAreSteppedOverWhole)
{
    // A file transfer that carries a recorded telemetry log: the frame inside must not be taken for a live one.
    RawFrame transfer;
    transfer.id = 110;
    transfer.crc_extra = 84;
    transfer.payload = parser_heartbeat(9) + Bytes(200, std::byte{3});
    Parser parser;
    const auto frames = parse(parser, transfer.bytes() + parser_heartbeat(1));
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_EQ(frames[0].message_id, 110U);
    EXPECT_EQ(frames[1].message_id, 0U);
    EXPECT_EQ(frames[1].header.sequence, 1);
}

TEST(MavlinkParser, SystemZeroIsPassedOnForTheReceiverToJudge)
{
    Parser parser;
    EXPECT_EQ(accepted(parser, parser_heartbeat(0, 0, 0)), 1U);
}

TEST(MavlinkParserDiagnostics, Accepted)
{
    Parser parser;
    EXPECT_EQ(accepted(parser, parser_heartbeat(0) + legacy_frame_of(Heartbeat{}, {1, 1, 1})), 2U);
    EXPECT_EQ(parser.diagnostics().accepted, 2U);
    EXPECT_EQ(parser.diagnostics().checksum_bytes, (10U + 9U) + (6U + 9U));
}

TEST(MavlinkParserDiagnostics, NoiseBytes)
{
    Parser parser;
    EXPECT_EQ(accepted(parser, Bytes(17, std::byte{0x20}) + parser_heartbeat(0)), 1U);
    EXPECT_EQ(parser.diagnostics().noise_bytes, 17U);
}

TEST(MavlinkParserDiagnostics, IncompatibleFlags)
{
    for (unsigned flags = 2; flags < 256; ++flags) {  // 0: none; 1: signed, see mavlink_signing_test.cpp
        RawFrame raw = raw_heartbeat();
        raw.incompatible = static_cast<std::uint8_t>(flags);
        Parser parser;
        EXPECT_EQ(accepted(parser, raw.bytes() + parser_heartbeat(0)), 1U) << flags;
        EXPECT_GE(parser.diagnostics().incompatible_flags, 1U) << flags;  // FD and FE are start bytes themselves
    }
}

TEST(MavlinkParser, CompatibleFlagsAreIgnored)
{
    RawFrame raw = raw_heartbeat();
    raw.compatible = 0xFF;
    Parser parser;
    EXPECT_EQ(accepted(parser, raw.bytes()), 1U);
}

TEST(MavlinkParserDiagnostics, UnknownMessageDoesNotHideTheNextFrame)
{
    for (const unsigned version : {1U, 2U}) {
        RawFrame raw = raw_heartbeat();
        raw.version = version;
        raw.id = 3;
        raw.payload = parser_heartbeat(5);
        Parser parser;
        const auto frames = parse(parser, raw.bytes() + parser_heartbeat(0));
        EXPECT_EQ(parser.diagnostics().unknown_message, 1U);
        ASSERT_EQ(frames.size(), 2U) << "an unknown id cannot be checked: what looks like a frame inside counts as one";
    }
}

TEST(MavlinkParserDiagnostics, NoiseThatClaimsTheFrameBehindIt)
{
    // FD 01 02 FE swallowed the next frame of a well-known peer (docs/guides/mavlink_frames.md).
    for (const std::string_view noise : {"fd0102fe", "fdff00", "feff", "fd", "fe", "fdfdfdfd", "fefefefefe", "fd0901",
                                         "fd09000000010100000000", "fe09000101000000000000"}) {
        Parser parser;
        const auto frames = parse(parser, from_hex(noise) + parser_heartbeat(0) + parser_heartbeat(1), 1, true);
        EXPECT_EQ(frames.size(), 2U) << noise;
    }
}

TEST(MavlinkParserDiagnostics, TooShort)
{
    RawFrame raw = raw_heartbeat();
    raw.version = 1;
    raw.payload.resize(8);
    Parser parser;
    EXPECT_EQ(accepted(parser, raw.bytes() + parser_heartbeat(0)), 1U);
    EXPECT_EQ(parser.diagnostics().too_short, 1U);
}

TEST(MavlinkParserDiagnostics, TooLong)
{
    for (const unsigned version : {1U, 2U}) {
        RawFrame raw = raw_heartbeat();
        raw.version = version;
        raw.payload.resize(10, std::byte{1});
        Parser parser;
        EXPECT_EQ(accepted(parser, raw.bytes() + parser_heartbeat(0)), 1U);
        EXPECT_EQ(parser.diagnostics().too_long, 1U);
    }
    // v1 carries no extensions
    RawFrame ack;
    ack.version = 1;
    ack.id = CommandAck::kInfo.id;
    ack.crc_extra = CommandAck::kInfo.crc_extra;
    ack.payload = Bytes(CommandAck::kInfo.max_length, std::byte{0});
    Parser parser;
    EXPECT_EQ(accepted(parser, ack.bytes()), 0U);
    EXPECT_EQ(parser.diagnostics().too_long, 1U);
}

TEST(MavlinkParser, LongerPayloadsOfALaterRevisionAreTakenOnRequest)
{
    RawFrame raw = raw_heartbeat();
    raw.payload = Bytes(255, std::byte{2});
    Parser parser(nullptr, LongerPayload::accept);
    const auto frames = parse(parser, raw.bytes());
    ASSERT_EQ(frames.size(), 1U);
    Heartbeat m;
    ASSERT_TRUE(decode(frames[0].frame(), m));
    EXPECT_EQ(m.custom_mode, 0x02020202U);
    raw.version = 1;
    EXPECT_EQ(accepted(parser, raw.bytes()), 0U) << "v1 has no extensions to gain";
    EXPECT_EQ(parser.diagnostics().too_long, 1U);
}

TEST(MavlinkParserDiagnostics, BadChecksum)
{
    RawFrame raw = raw_heartbeat();
    raw.crc_extra = 51;  // another definition of the message
    Parser parser;
    EXPECT_EQ(accepted(parser, raw.bytes() + parser_heartbeat(0)), 1U);
    EXPECT_EQ(parser.diagnostics().bad_checksum, 1U);
}

TEST(MavlinkParserDiagnostics, CutFramesGiveWayToTheNext)
{
    Random random(3);
    const Bytes whole = frame_of(random_message<ObstacleDistance>(random));
    for (std::size_t n = 1; n < whole.size(); ++n) {
        Parser parser;
        const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n));
        EXPECT_EQ(accepted(parser, cut), 0U);
        const auto frames = parse(parser, parser_heartbeat(0), 1, true);
        ASSERT_EQ(frames.size(), 1U) << n;
        EXPECT_EQ(frames[0].message_id, 0U);
        EXPECT_EQ(parser.pending(), 0U);
    }
    Parser parser;
    EXPECT_EQ(accepted(parser, Bytes(whole.begin(), whole.end() - 1)), 0U);
    EXPECT_FALSE(parser.flush().has_value());
    EXPECT_GE(parser.diagnostics().cut, 1U);
    EXPECT_EQ(parser.diagnostics().noise_bytes, whole.size() - 1);
}

TEST(MavlinkParserDiagnostics, LostRepeatedAndWrappedNumbers)
{
    Parser parser;
    EXPECT_EQ(
        accepted(parser, parser_heartbeat(254) + parser_heartbeat(255) + parser_heartbeat(0) + parser_heartbeat(1)),
        4U);
    EXPECT_EQ(parser.diagnostics().lost, 0U);
    EXPECT_EQ(accepted(parser, parser_heartbeat(1) + parser_heartbeat(1)), 2U);
    EXPECT_EQ(parser.diagnostics().repeated, 2U);
    EXPECT_EQ(accepted(parser, parser_heartbeat(5)), 1U);
    EXPECT_EQ(parser.diagnostics().lost, 3U);
    EXPECT_EQ(accepted(parser, parser_heartbeat(4)), 1U);  // backwards: as if 254 had gone missing
    EXPECT_EQ(parser.diagnostics().lost, 3U + 254U);
    EXPECT_EQ(accepted(parser, parser_heartbeat(200, 1, 2) + parser_heartbeat(90, 2, 1)),
              2U);  // other senders count for themselves
    EXPECT_EQ(parser.diagnostics().lost, 3U + 254U);
}

TEST(MavlinkParserDiagnostics, UntrackedSenders)
{
    Parser parser;
    for (std::uint8_t system = 1; system <= kMaxSenders; ++system) {
        EXPECT_EQ(accepted(parser, parser_heartbeat(0, system)), 1U);
    }
    EXPECT_EQ(parser.diagnostics().untracked_senders, 0U);
    EXPECT_EQ(accepted(parser, parser_heartbeat(0, kMaxSenders + 1) + parser_heartbeat(7, kMaxSenders + 1)), 2U);
    EXPECT_EQ(parser.diagnostics().untracked_senders, 2U);
    EXPECT_EQ(parser.diagnostics().lost, 0U);
    EXPECT_EQ(accepted(parser, parser_heartbeat(3, 1)), 1U);
    EXPECT_EQ(parser.diagnostics().lost, 2U);
}

}  // namespace
}  // namespace jink::link::mavlink
