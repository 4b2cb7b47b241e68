// SPDX-License-Identifier: BSD-3-Clause
// The compact frame: layout, checksums, bounds.
#include <gtest/gtest.h>

#include "tests/unit/link/cloud_tools.hpp"
#include "tests/unit/link/mavlink_tools.hpp"

namespace jink::link::cloud {
namespace {

using namespace test;
using mavlink::test::from_hex;
using mavlink::test::reference_crc;
using mavlink::test::to_hex;

Part golden_part()
{
    Part part;
    part.sensor = 7;
    part.sequence = 0x0102;
    part.scan = 0x0304;
    part.part = 5;
    part.parts = 9;
    part.max_range = 12000;
    part.stamp_ms = 0x0A0B0C0D;
    part.roll = -500;
    part.pitch = 1234;
    part.ray_pitch_level = 349;
    part.ray_pitch_vertical = 3491;
    part.scan_points = 1000;
    return part;
}

const std::vector<RawPoint> kGoldenPoints{{-31416, 15708, 1}, {0, -1, 65535}, {31416, 0, 0}};

/// Composed from the table of offsets in frame.hpp by Python's struct.pack:
///   h = pack('<BBHHHHHHIhhHHI', 1, 7, 0x102, 0x304, 5, 9, 3, 12000, 0x0A0B0C0D, -500, 1234, 349, 3491, 1000)
///   b = h + pack('<H', crc(h)) + points; frame = 6AC7 + b + pack('<H', crc(b)), crc: CRC-16/MCRF4XX bit by bit
constexpr std::string_view kGolden = "6ac7010702010403050009000300e02e0d0c0b0a0cfed2045d01a30de8030000dc00"
                                     "48855c3d01000000ffffffffb87a000000001b9f";

TEST(CloudFrame, GoldenFrame) { EXPECT_EQ(to_hex(frame_of(golden_part(), kGoldenPoints)), kGolden); }

TEST(CloudFrame, GoldenFrameIsRead)
{
    const Bytes frame = from_hex(kGolden);
    const std::optional<Part> part = read_header(frame);
    ASSERT_TRUE(part);
    EXPECT_EQ(part->sensor, 7);
    EXPECT_EQ(part->sequence, 0x0102);
    EXPECT_EQ(part->scan, 0x0304);
    EXPECT_EQ(part->part, 5);
    EXPECT_EQ(part->parts, 9);
    EXPECT_EQ(part->points, 3);
    EXPECT_EQ(part->max_range, 12000);
    EXPECT_EQ(part->stamp_ms, 0x0A0B0C0DU);
    EXPECT_EQ(part->roll, -500);
    EXPECT_EQ(part->pitch, 1234);
    EXPECT_EQ(part->ray_pitch_level, 349);
    EXPECT_EQ(part->ray_pitch_vertical, 3491);
    EXPECT_EQ(part->scan_points, 1000U);
    EXPECT_TRUE(is_plausible(*part));
    ASSERT_EQ(frame.size(), frame_size(part->points));
    EXPECT_TRUE(checksum_holds(frame));
    for (std::size_t i = 0; i < kGoldenPoints.size(); ++i) {
        const RawPoint point = read_point(frame, i);
        EXPECT_EQ(point.azimuth, kGoldenPoints[i].azimuth);
        EXPECT_EQ(point.elevation, kGoldenPoints[i].elevation);
        EXPECT_EQ(point.range, kGoldenPoints[i].range);
    }
}

TEST(CloudFrame, ChecksumsAreThoseOfAnotherImplementation)
{
    const Bytes frame = from_hex(kGolden);
    // Its last byte fed as MAVLink's extra one: the reference always takes one.
    const auto crc_to = [&](std::size_t end) {
        return reference_crc(std::span(frame).subspan(2, end - 3), std::to_integer<std::uint8_t>(frame[end - 1]));
    };
    for (const std::size_t at : {kHeaderSize - 2, frame.size() - 2}) {
        EXPECT_EQ(crc_to(at), std::to_integer<unsigned>(frame[at]) | std::to_integer<unsigned>(frame[at + 1]) << 8U);
    }
}

TEST(CloudFrame, EveryFlippedBitIsSeen)
{
    const Bytes frame = from_hex(kGolden);
    for (std::size_t bit = 16; bit < 8 * frame.size(); ++bit) {  // the checksum does not cover the start bytes: they
                                                                 // are searched
        Bytes flipped = frame;
        flipped[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
        EXPECT_FALSE(read_header(flipped) && checksum_holds(flipped)) << "bit " << bit;
    }
}

TEST(CloudFrame, WhatDoesNotFitIsNotWritten)
{
    Bytes out(kMaxFrame);
    const std::vector<RawPoint> many(kMaxPoints + 1);
    EXPECT_EQ(write_frame({}, many, out), 0U);
    EXPECT_EQ(write_frame({}, std::span(many).first(kMaxPoints), out), kMaxFrame);
    EXPECT_EQ(write_frame({}, std::span(many).first(kMaxPoints), std::span(out).first(kMaxFrame - 1)), 0U);
    EXPECT_EQ(write_frame({}, {}, out), frame_size(0));
}

TEST(CloudFrame, ImplausibleHeaders)
{
    Part good = golden_part();
    good.points = 3;
    ASSERT_TRUE(is_plausible(good));
    const auto bad = [&](auto change) {
        Part part = good;
        change(part);
        return !is_plausible(part);
    };
    EXPECT_TRUE(bad([](Part& p) { p.parts = 0; }));
    EXPECT_TRUE(bad([](Part& p) { p.parts = kMaxParts + 1; }));
    EXPECT_TRUE(bad([](Part& p) { p.part = p.parts; }));
    EXPECT_TRUE(bad([](Part& p) { p.points = kMaxPoints + 1; }));
    EXPECT_TRUE(bad([](Part& p) { p.scan_points = 2; }));
    EXPECT_TRUE(bad([](Part& p) { p.scan_points = 9 * kMaxPoints + 1; }));
    EXPECT_TRUE(bad([](Part& p) { p.max_range = 0; }));
    EXPECT_TRUE(bad([](Part& p) { p.max_range = 65535; }));
    EXPECT_TRUE(bad([](Part& p) { p.roll = kHalfTurn + 1; }));
    EXPECT_TRUE(bad([](Part& p) { p.roll = INT16_MIN; }));
    EXPECT_TRUE(bad([](Part& p) { p.pitch = kQuarterTurn + 1; }));
    EXPECT_TRUE(bad([](Part& p) { p.pitch = -kQuarterTurn - 1; }));
}

}  // namespace
}  // namespace jink::link::cloud
