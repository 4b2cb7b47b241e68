// SPDX-License-Identifier: BSD-3-Clause
#include <bit>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <string>

#include "firmware/link/mavlink/checksum.hpp"
#include "firmware/link/mavlink/text.hpp"
#include "tests/unit/link/mavlink_tools.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

TEST(MavlinkChecksum, KnownAnswers)
{
    Checksum empty;
    EXPECT_EQ(empty.value(), 0xFFFF);
    Checksum digits;
    for (const char c : std::string("123456789")) {
        digits.add(static_cast<std::byte>(c));
    }
    EXPECT_EQ(digits.value(), 0x6F91);  // the catalogue's check value of CRC-16/MCRF4XX
}

TEST(MavlinkChecksum, EqualsBitwiseForm)
{
    Random random(1);
    for (int round = 0; round < 2000; ++round) {
        const Bytes data = random_bytes(random, random.below(300));
        Checksum checksum;
        checksum.add(data);
        checksum.add(std::byte{77});
        ASSERT_EQ(checksum.value(), reference_crc(data, 77));
    }
}

TEST(MavlinkCatalogue, FindsEveryDecodedMessageAndNothingElse)
{
    for_each_message([]<class M>() {
        const MessageInfo* info = find_message(M::kInfo.id);
        ASSERT_NE(info, nullptr);
        EXPECT_EQ(info->id, M::kInfo.id);
        EXPECT_EQ(info->crc_extra, M::kInfo.crc_extra);
        EXPECT_EQ(info->min_length, M::kInfo.min_length);
        EXPECT_EQ(info->max_length, M::kInfo.max_length);
    });
    ASSERT_NE(find_message(110), nullptr);  // FILE_TRANSFER_PROTOCOL: checked, not decoded
    EXPECT_EQ(find_message(110)->crc_extra, 84);
    for (const std::uint32_t id : {3U, 255U, 12921U, 0xFFFFFFU, 0xFFFFFFFFU}) {
        EXPECT_EQ(find_message(id), nullptr) << id;
    }
}

TEST(MavlinkCodec, FieldTablesCoverThePayloadWithoutGaps)
{
    for_each_message([]<class M>() {
        std::size_t next = 0;
        for (const Field& field : M::kFields) {
            EXPECT_EQ(field.wire_offset, next) << M::kInfo.id;
            next += element_size(field.type) * field.count;
            EXPECT_LE(field.object_offset + element_size(field.type) * field.count, sizeof(M)) << M::kInfo.id;
        }
        EXPECT_EQ(next, M::kInfo.max_length) << M::kInfo.id;
    });
}

TEST(MavlinkCodec, WireIsLittleEndian)
{
    Timesync m;
    m.tc1 = 0x0102030405060708;
    m.target_component = 9;
    EXPECT_EQ(to_hex(payload_of(m)), "080706050403020100000000000000000009");
}

TEST(MavlinkCodec, WrongMessageIsNotDecoded)
{
    Parser parser;
    const std::vector<Received> frames = parse(parser, frame_of(Heartbeat{}));
    ASSERT_EQ(frames.size(), 1U);
    Attitude attitude;
    attitude.roll = 7.0F;
    EXPECT_FALSE(decode(frames[0].frame(), attitude));
    EXPECT_EQ(attitude.roll, 7.0F);
}

TEST(MavlinkCodec, SpecialFloatsPassBitExactly)
{
    constexpr std::array<std::uint32_t, 12> kPatterns{0x00000000, 0x80000000, 0x7F800000, 0xFF800000,
                                                      0x7FC00000, 0xFFC00001, 0x7F800001, 0xFFBFFFFF,
                                                      0x00000001, 0x807FFFFF, 0x7F7FFFFF, 0x00800000};
    for (const std::uint32_t pattern : kPatterns) {
        for_each_message([pattern]<class M>() {
            Bytes payload(M::kInfo.max_length, std::byte{0x55});
            for (const Field& field : M::kFields) {
                for (std::size_t e = 0; field.type == FieldType::f32 && e < field.count; ++e) {
                    for (std::size_t i = 0; i < 4; ++i) {
                        payload[field.wire_offset + 4 * e + i] = static_cast<std::byte>((pattern >> (8 * i)) & 0xFFU);
                    }
                }
            }
            const Bytes frame = frame_of(from_payload<M>(payload));
            Parser parser;
            const std::vector<Received> frames = parse(parser, frame);
            ASSERT_EQ(frames.size(), 1U);
            M decoded;
            ASSERT_TRUE(decode(frames[0].frame(), decoded));
            EXPECT_EQ(payload_of(decoded), payload) << M::kInfo.id;
        });
    }
}

TEST(MavlinkEncoder, CutsTrailingZerosButNeverTheFirstByte)
{
    const Bytes zeros = frame_of(Attitude{});
    EXPECT_EQ(zeros.size(), kHeaderV2 + 1 + kChecksumSize);
    EXPECT_EQ(zeros[1], std::byte{1});
    EXPECT_EQ(zeros[kHeaderV2], std::byte{0});

    Attitude one;
    one.time_boot_ms = 1;
    EXPECT_EQ(frame_of(one)[1], std::byte{1});
    Attitude roll;
    roll.roll = 1.0F;  // 0000803f
    EXPECT_EQ(frame_of(roll)[1], std::byte{8});
    Attitude inner;  // zeros inside stay
    inner.time_boot_ms = 0x01000000;
    EXPECT_EQ(frame_of(inner)[1], std::byte{4});
}

TEST(MavlinkEncoder, RefusesWhatDoesNotFit)
{
    for_each_message([]<class M>() {
        const M message = from_payload<M>(Bytes(M::kInfo.max_length, std::byte{0xFF}));
        const std::size_t size = kHeaderV2 + M::kInfo.max_length + kChecksumSize;
        Bytes out(size - 1, std::byte{0xAA});
        EXPECT_EQ(encode(message, {1, 1, 0}, out), 0U);
        EXPECT_EQ(out, Bytes(size - 1, std::byte{0xAA})) << "touched";
        out.resize(size);
        EXPECT_EQ(encode(message, {1, 1, 0}, out), size);

        Signing signing({}, 0, 0);
        out.resize(size + kSignatureSize - 1);
        EXPECT_EQ(encode_signed(message, {1, 1, 0}, signing, out), 0U);
        EXPECT_EQ(signing.time(), 0U) << "a frame that was not made must not use up a time";
        out.resize(size + kSignatureSize);
        EXPECT_EQ(encode_signed(message, {1, 1, 0}, signing, out), size + kSignatureSize);
    });
}

TEST(MavlinkEncoder, LegacyFramesCarryBaseFieldsOnly)
{
    for_each_message([]<class M>() {
        const M message = from_payload<M>(Bytes(M::kInfo.max_length, std::byte{0x5A}));
        Bytes out(kMaxFrame);
        const std::size_t size = encode_legacy(message, {7, 8, 9}, out);
        if (M::kInfo.id > 255) {
            EXPECT_EQ(size, 0U) << M::kInfo.id;
            return;
        }
        ASSERT_EQ(size, kHeaderV1 + M::kInfo.min_length + kChecksumSize);
        EXPECT_EQ(encode_legacy(message, {7, 8, 9}, std::span(out).first(size - 1)), 0U);
        RawFrame raw;
        raw.version = 1;
        raw.header = {7, 8, 9};
        raw.id = M::kInfo.id;
        raw.payload = Bytes(M::kInfo.min_length, std::byte{0x5A});
        raw.crc_extra = M::kInfo.crc_extra;
        out.resize(size);
        EXPECT_EQ(to_hex(out), to_hex(raw.bytes()));
    });
}

TEST(MavlinkText, FullFieldHasNoTerminator)
{
    std::array<char, 4> field{};
    EXPECT_TRUE(set_text(field, "ABCD"));
    EXPECT_EQ(text_of(field), "ABCD");
    EXPECT_TRUE(set_text(field, "A"));
    EXPECT_EQ(text_of(field), "A");
    EXPECT_EQ(field, (std::array<char, 4>{'A', 0, 0, 0}));
    EXPECT_FALSE(set_text(field, "ABCDE"));
    EXPECT_EQ(text_of(field), "ABCD");
    EXPECT_TRUE(set_text(field, ""));
    EXPECT_EQ(text_of(field), "");
}

}  // namespace
}  // namespace jink::link::mavlink
