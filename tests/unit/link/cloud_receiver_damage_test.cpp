// SPDX-License-Identifier: BSD-3-Clause
// The receiver of compact frames: scans whole and in pieces, every cause of refusal, losses.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "tests/unit/link/cloud_receiver.hpp"
#include "tests/unit/link/cloud_tools.hpp"

namespace jink::link::cloud {
namespace {

using namespace test;

TEST_F(CloudReceiver, LessPointsThanSaidAreLost)
{
    Part part = driver.first;
    part.parts = 2;
    part.scan_points = 100;
    hear(frame_of(part, std::vector<RawPoint>(40)));
    part.part = 1;
    hear(frame_of(part, std::vector<RawPoint>(20)));
    EXPECT_TRUE(sink.scans.at(0).ended);
    EXPECT_EQ(sink.scans[0].lost, 40U);
}

TEST_F(CloudReceiver, PointsThatCannotBeRefuseTheirFrame)
{
    for (const RawPoint bad : {RawPoint{31417, 0, 5}, RawPoint{-31417, 0, 5}, RawPoint{0, 15709, 5},
                               RawPoint{0, -15709, 5}, RawPoint{INT16_MIN, 0, 5}}) {
        hear(driver.scan(std::vector<RawPoint>{{0, 0, 100}, bad}, sender_ms()));
    }
    EXPECT_EQ(count().out_of_range, 5U);
    EXPECT_TRUE(sink.scans.empty());
    hear(driver.scan(std::vector<RawPoint>{{31416, -15708, 5}, {-31416, 15708, 5}}, sender_ms()));
    EXPECT_EQ(sink.rays(), 2U);
}

TEST_F(CloudReceiver, HeadersThatCannotBeAreRefused)
{
    Part part = driver.first;
    part.part = 1;
    part.scan_points = 1;
    const Bytes frame = frame_of(part, std::vector<RawPoint>(1));
    hear(frame);
    EXPECT_EQ(count().out_of_range, 1U);
    EXPECT_TRUE(sink.scans.empty());
    EXPECT_EQ(count().noise_bytes, frame.size());
}

TEST_F(CloudReceiver, UnknownVersion)
{
    Bytes bytes = joined(frames(5));
    bytes[2] = std::byte{2};
    hear(bytes);
    EXPECT_EQ(count().unknown_version, 1U);
    EXPECT_TRUE(sink.scans.empty());
    hear(frames(5));
    EXPECT_EQ(sink.rays(), 5U);
}

TEST_F(CloudReceiver, DamagedFrameCostsItsPointsAlone)
{
    std::vector<Bytes> all = frames(360);
    all[1][400] ^= std::byte{4};
    hear(all);
    hear(frames(1));
    EXPECT_EQ(count().bad_checksum, 1U);
    EXPECT_EQ(sink.scans.at(0).rays.size(), 240U);
    EXPECT_EQ(sink.scans[0].lost, 120U);
}

TEST_F(CloudReceiver, DamagedHeaderClaimsNothing)
{
    std::vector<Bytes> all = frames(360);
    all[1][12] = std::byte{119};  // one point less: a length that is wrong
    hear(all);
    hear(frames(1));
    EXPECT_EQ(count().bad_header, 1U);
    EXPECT_EQ(sink.scans.at(0).rays.size(), 240U);
}

TEST_F(CloudReceiver, CutFrameCostsNoOther)
{
    std::vector<Bytes> all = frames(360);
    for (const std::size_t left : {std::size_t{1}, std::size_t{2}, kHeaderSize - 1, kHeaderSize, std::size_t{500}}) {
        std::vector<Bytes> cut = frames(360);
        cut[1].resize(left);
        hear(cut);
        hear(frames(1));
        EXPECT_EQ(sink.scans[sink.scans.size() - 2].rays.size(), 240U) << left;
    }
}

TEST_F(CloudReceiver, SilentLineGivesUpACutFrame)
{
    // A frame inside the length claimed by a cut frame.
    Bytes bytes = frames(120)[0];
    bytes.resize(100);
    const Bytes inside = frames(20)[0];
    bytes.insert(bytes.end(), inside.begin(), inside.end());
    hear(bytes);
    EXPECT_TRUE(sink.scans.empty());
    wait(0.11F);
    EXPECT_EQ(count().cut, 1U);
    EXPECT_EQ(sink.rays(), 20U);
    EXPECT_EQ(receiver->pending(), 0U);
    expect_sums(bytes.size());
}

TEST_F(CloudReceiver, GoodFramesInGarbage)
{
    Random random(20261123);
    std::size_t bytes = 0;
    for (int i = 0; i < 200; ++i) {
        Bytes noise(random.below(300));
        for (std::byte& b : noise) {
            // Many start bytes among it.
            b = random.below(4) == 0 ? kSync[random.below(2)] : static_cast<std::byte>(random.below(256));
        }
        const Bytes frame = joined(frames(50));
        hear(noise);
        hear(frame);
        bytes += noise.size() + frame.size();
    }
    EXPECT_EQ(count().scans_complete, 200U);
    EXPECT_EQ(sink.rays(), 10'000U);
    expect_sums(bytes);
}

TEST_F(CloudReceiver, WorkPerByteIsBounded)
{
    // Valid headers, each claiming the longest frame: worst case of the search.
    Part part = driver.first;
    part.scan_points = kMaxPoints;
    Bytes header = frame_of(part, std::vector<RawPoint>(kMaxPoints));
    header.resize(kHeaderSize);
    Bytes bytes;
    for (int i = 0; i < 3000; ++i) {
        bytes.insert(bytes.end(), header.begin(), header.end());
    }
    hear(bytes);
    EXPECT_GT(receiver->checksum_bytes(), 10 * bytes.size());  // or it is not the worst that was meant
    EXPECT_LE(receiver->checksum_bytes(), Receiver::kMaxWorkPerByte * bytes.size());
    // And false starts, every second byte.
    bytes.clear();
    const std::uint64_t before = receiver->checksum_bytes();
    for (int i = 0; i < 50'000; ++i) {
        bytes.push_back(kSync[0]);
        bytes.push_back(kSync[1]);
    }
    hear(bytes);
    EXPECT_LE(receiver->checksum_bytes() - before, Receiver::kMaxWorkPerByte * bytes.size());
}

TEST_F(CloudReceiver, StampsAreMappedByTheQuickestArrival)
{
    hear(driver.scan(row(1), 1000));
    now = now + 0.15F;  // 0.1 s on the sender's clock: 0.05 s late
    hear(driver.scan(row(1), 1100));
    EXPECT_EQ(sink.scans.at(0).scan.stamp, TimePoint{10'000'000});
    EXPECT_EQ(sink.scans.at(1).scan.stamp, TimePoint{10'100'000});
}

TEST_F(CloudReceiver, StaleScansAreRefused)
{
    hear(driver.scan(row(1), 60'000));
    now = now + 5.0F;
    hear(driver.scan(row(300), 63'900));
    EXPECT_EQ(count().stale, 3U);
    EXPECT_EQ(sink.scans.size(), 1U);
    hear(driver.scan(row(1), 64'100));
    EXPECT_EQ(sink.scans.size(), 2U);
}

TEST_F(CloudReceiver, SendersClockThatRestartsIsFollowed)
{
    hear(driver.scan(row(1), 600'000));
    driver.number = 0;
    driver.sequence = 20'000;
    int taken = 0;
    for (std::uint32_t i = 0; i < 10; ++i) {
        now = now + 0.1F;
        const std::size_t before = sink.scans.size();
        driver.number = static_cast<std::uint16_t>(1000 + i);
        hear(driver.scan(row(300), 500 + 100 * i));  // several frames, one sample of the clock
        taken += sink.scans.size() > before ? 1 : 0;
    }
    EXPECT_EQ(taken, 8);  // the third consecutive one is accepted
    EXPECT_EQ(count().clock_relocks, 1U);
    EXPECT_EQ(count().restarts, 1U);
}

/// Its clock shows more than when it was heard last, and less than it would have shown without the restart.
TEST_F(CloudReceiver, SendersClockThatRestartsUnheardIsFollowed)
{
    hear(driver.scan(row(1), 22'000));
    wait(60.0F);
    hear(driver.scan(row(1), 30'000));
    EXPECT_EQ(count().stale, 0U);
    ASSERT_EQ(sink.scans.size(), 2U);
    EXPECT_EQ(sink.scans[1].scan.stamp, now);
}

TEST_F(CloudReceiver, StaleScansAreHeard)
{
    hear(driver.scan(row(1), 60'000));
    for (std::uint32_t i = 0; i < 20; ++i) {
        wait(1.0F);
        hear(driver.scan(row(1), 59'000 + 1000 * i));
    }
    EXPECT_EQ(count().stale, 20U) << "a queue of two seconds";
}

TEST_F(CloudReceiver, SenderThatBeginsAnewIsHeard)
{
    driver.number = 5000;
    driver.sequence = 5000;
    hear(frames(200));
    driver.number = 0;
    driver.sequence = 0;
    hear(frames(200));
    EXPECT_EQ(count().scans_complete, 2U);
    EXPECT_EQ(count().restarts, 1U);
    EXPECT_EQ(count().scans_missed + count().frames_missed, 0U);
}

TEST_F(CloudReceiver, AnotherSensorEndsTheScan)
{
    hear(frames(250)[0]);
    driver.first.sensor = 4;
    hear(frames(5));
    ASSERT_EQ(sink.scans.size(), 2U);
    EXPECT_EQ(sink.scans[0].lost, 130U);
    EXPECT_EQ(sink.scans[1].scan.sensor, 4);
    EXPECT_FALSE(sink.broken);
}

}  // namespace
}  // namespace jink::link::cloud
