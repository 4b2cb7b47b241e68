// SPDX-License-Identifier: BSD-3-Clause
// The receiver of compact frames: scans whole and in pieces, every cause of refusal, what is lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "tests/unit/link/cloud_tools.hpp"

namespace jink::link::cloud {
namespace {

using namespace test;

class CloudReceiver : public ::testing::Test {
protected:
    void hear(std::span<const std::byte> bytes) { receiver->receive(bytes, now, sink); }
    void hear(const std::vector<Bytes>& frames) { hear(joined(frames)); }
    void wait(float seconds)
    {
        now = now + seconds;
        hear(std::span<const std::byte>{});
    }
    [[nodiscard]] std::uint32_t sender_ms() const { return static_cast<std::uint32_t>(now.us / 1000) - 7000; }
    /// `n` points ahead, a metre apart.
    static std::vector<RawPoint> row(std::size_t n)
    {
        std::vector<RawPoint> points(n);
        for (std::size_t i = 0; i < n; ++i) {
            points[i].range = static_cast<std::uint16_t>(100 * (i + 1));
        }
        return points;
    }
    std::vector<Bytes> frames(std::size_t points, std::size_t per_frame = kMaxPoints)
    {
        return driver.scan(row(points), sender_ms(), per_frame);
    }
    [[nodiscard]] const ReceiverDiagnostics& count() const { return receiver->diagnostics(); }
    /// Every byte and every point is accounted for.
    void expect_sums(std::size_t bytes_heard) const
    {
        EXPECT_FALSE(sink.broken);
        EXPECT_EQ(count().frame_bytes + count().noise_bytes + receiver->pending(), bytes_heard);
        EXPECT_EQ(count().points + (receiver->is_scan_open() ? sink.scans.back().rays.size() : 0), sink.rays());
    }

    std::unique_ptr<Receiver> receiver = std::make_unique<Receiver>();
    Recorder sink;
    Driver driver;
    TimePoint now{10'000'000};
};

TEST_F(CloudReceiver, WholeScan)
{
    driver.first.ray_pitch_level = 349;
    driver.first.ray_pitch_vertical = 3491;
    hear(frames(250));
    ASSERT_EQ(sink.scans.size(), 1U);
    const Recorder::Scan& scan = sink.scans[0];
    EXPECT_TRUE(scan.ended);
    EXPECT_EQ(scan.lost, 0U);
    EXPECT_EQ(scan.scan.sensor, 3);
    EXPECT_EQ(scan.scan.stamp, now);
    EXPECT_NEAR(scan.scan.ray_pitch_level, 0.00349F, 1e-6F);
    EXPECT_NEAR(scan.scan.ray_pitch_vertical, 0.03491F, 1e-6F);
    EXPECT_NEAR(scan.scan.max_range, 100.0F, 1e-4F);
    ASSERT_EQ(scan.rays.size(), 250U);
    for (std::size_t i = 0; i < 250; ++i) {
        EXPECT_EQ(scan.rays[i].first, Ray::hit);
        EXPECT_NEAR((scan.rays[i].second - Vec3(static_cast<float>(i + 1), 0, 0)).norm(), 0.0F, 1e-4F);
    }
    EXPECT_EQ(count().scans_complete, 1U);
    EXPECT_EQ(count().frames, 3U);
}

TEST_F(CloudReceiver, EmptyScan)
{
    hear(frames(0));
    ASSERT_EQ(sink.scans.size(), 1U);
    EXPECT_TRUE(sink.scans[0].ended);
    EXPECT_TRUE(sink.scans[0].rays.empty());
}

TEST_F(CloudReceiver, AzimuthIsToTheLeftAndElevationUp)
{
    hear(driver.scan(std::vector<RawPoint>{{15708, 0, 1000}, {0, 15708, 1000}, {-15708, 7854, 1000}}, sender_ms()));
    const auto& rays = sink.scans.at(0).rays;
    EXPECT_NEAR((rays[0].second - Vec3(0, 10, 0)).norm(), 0.0F, 1e-3F);
    EXPECT_NEAR((rays[1].second - Vec3(0, 0, 10)).norm(), 0.0F, 1e-3F);
    EXPECT_NEAR((rays[2].second - Vec3(0, -7.0711F, 7.0711F)).norm(), 0.0F, 1e-3F);
}

TEST_F(CloudReceiver, RollAndPitchMakeItLevel)
{
    // Nose up by 0.3 rad: what the platform sees ahead lies above. Right side down: what it sees to the left, above.
    driver.first.pitch = 3000;
    hear(driver.scan(std::vector<RawPoint>{{0, 0, 1000}}, sender_ms()));
    EXPECT_NEAR((sink.scans.at(0).rays[0].second - Vec3(9.5534F, 0, 2.9552F)).norm(), 0.0F, 1e-3F);
    driver.first.pitch = 0;
    driver.first.roll = 3000;
    hear(driver.scan(std::vector<RawPoint>{{15708, 0, 1000}}, sender_ms()));
    EXPECT_NEAR((sink.scans.at(1).rays[0].second - Vec3(0, 9.5534F, 2.9552F)).norm(), 0.0F, 1e-3F);
    // Both: the pitch is about the level axis, so what is to the left keeps its height.
    driver.first.pitch = 3000;
    hear(driver.scan(std::vector<RawPoint>{{15708, 0, 1000}}, sender_ms()));
    EXPECT_NEAR(sink.scans.at(2).rays[0].second.z(), 10.0F * std::sin(0.3F) * std::cos(0.3F), 1e-3F);
    EXPECT_NEAR(sink.scans.at(2).rays[0].second.y(), 9.5534F, 1e-3F);
}

TEST_F(CloudReceiver, RaysThatAreNoHitsAreDirections)
{
    hear(driver.scan(std::vector<RawPoint>{{0, 0, kNothingRange}, {15708, 0, kInvalidRange}, {0, 0, 65534}},
                     sender_ms()));
    const auto& rays = sink.scans.at(0).rays;
    EXPECT_EQ(rays[0].first, Ray::nothing);
    EXPECT_NEAR((rays[0].second - Vec3::UnitX()).norm(), 0.0F, 1e-5F);
    EXPECT_EQ(rays[1].first, Ray::invalid);
    EXPECT_NEAR((rays[1].second - Vec3::UnitY()).norm(), 0.0F, 1e-5F);
    EXPECT_EQ(rays[2].first, Ray::hit);  // farther than the sensor's reach: a hit all the same
}

TEST_F(CloudReceiver, ByteByByte)
{
    const Bytes bytes = joined(frames(300));
    for (const std::byte byte : bytes) {
        hear({&byte, 1});
    }
    EXPECT_EQ(sink.scans.at(0).rays.size(), 300U);
    expect_sums(bytes.size());
    EXPECT_EQ(receiver->pending(), 0U);
}

TEST_F(CloudReceiver, AnyOrderOfParts)
{
    std::vector<Bytes> all = frames(600);
    std::reverse(all.begin(), all.end());
    hear(all);
    EXPECT_TRUE(sink.scans.at(0).ended);
    EXPECT_EQ(sink.scans[0].lost, 0U);
    EXPECT_EQ(sink.rays(), 600U);
    EXPECT_EQ(count().reordered, 4U);
}

TEST_F(CloudReceiver, LostPartIsToldByTheNextScan)
{
    std::vector<Bytes> all = frames(600);
    all.erase(all.begin() + 2);
    hear(all);
    EXPECT_FALSE(sink.scans.at(0).ended);
    hear(frames(10));
    EXPECT_TRUE(sink.scans[0].ended);
    EXPECT_EQ(sink.scans[0].lost, 120U);
    EXPECT_EQ(count().points_lost, 120U);
    EXPECT_EQ(count().points, 490U);
    EXPECT_EQ(count().frames_missed, 1U);
    EXPECT_EQ(count().scans_complete, 1U);
}

TEST_F(CloudReceiver, LostPartIsToldByAPause)
{
    std::vector<Bytes> all = frames(250);
    all.pop_back();
    hear(all);
    wait(Receiver::kScanPause);
    EXPECT_FALSE(sink.scans.at(0).ended);
    wait(0.01F);
    EXPECT_TRUE(sink.scans[0].ended);
    EXPECT_EQ(sink.scans[0].lost, 10U);
}

TEST_F(CloudReceiver, DoubledPartIsTakenOnce)
{
    std::vector<Bytes> all = frames(360);
    all.insert(all.begin() + 1, all[0]);
    all.push_back(all.back());  // and once more behind the end
    hear(all);
    EXPECT_EQ(sink.rays(), 360U);
    EXPECT_EQ(count().duplicated, 2U);
    EXPECT_EQ(sink.scans.size(), 1U);
}

TEST_F(CloudReceiver, LatePartsAreRefused)
{
    const std::vector<Bytes> first = frames(250);
    hear(first[0]);
    hear(frames(10));  // ends the first
    hear(first[1]);
    EXPECT_EQ(count().late, 1U);
    EXPECT_EQ(sink.scans.size(), 2U);
    EXPECT_EQ(sink.scans[0].lost, 130U);
    // The same of a scan that a pause has ended.
    const std::vector<Bytes> third = frames(250);
    hear(third[0]);
    wait(1.0F);
    hear(third[1]);
    EXPECT_EQ(count().late, 2U);
    EXPECT_EQ(count().points + count().points_lost, 510U);
}

TEST_F(CloudReceiver, MissedScansAreCounted)
{
    hear(frames(1));
    driver.number = static_cast<std::uint16_t>(driver.number + 3);
    hear(frames(1));
    EXPECT_EQ(count().scans_missed, 3U);
}

TEST_F(CloudReceiver, NumbersWrap)
{
    driver.number = 65534;
    driver.sequence = 65533;
    for (int i = 0; i < 5; ++i) {
        hear(frames(200));
    }
    EXPECT_EQ(count().scans_complete, 5U);
    EXPECT_EQ(count().scans_missed + count().frames_missed + count().restarts + count().late, 0U);
}

TEST_F(CloudReceiver, InconsistentPartsAreRefused)
{
    std::vector<Bytes> all = frames(250);
    Part part = read_header(all[1]).value();
    const auto with = [&](auto change) {
        Part other = part;
        change(other);
        return frame_of(other, std::vector<RawPoint>(120));
    };
    hear(all[0]);
    hear(with([](Part& p) { p.parts = 4; }));
    hear(with([](Part& p) { ++p.stamp_ms; }));
    hear(with([](Part& p) { ++p.roll; }));
    hear(with([](Part& p) { --p.pitch; }));
    hear(with([](Part& p) { ++p.max_range; }));
    hear(with([](Part& p) { ++p.scan_points; }));
    hear(with([](Part& p) { ++p.ray_pitch_level; }));
    hear(with([](Part& p) { ++p.ray_pitch_vertical; }));
    EXPECT_EQ(count().inconsistent, 8U);
    // More points than the scan was said to have.
    hear(all[1]);
    part.part = 2;
    hear(frame_of(part, std::vector<RawPoint>(11)));
    EXPECT_EQ(count().inconsistent, 9U);
    hear(all[2]);
    EXPECT_EQ(sink.rays(), 250U);
    EXPECT_TRUE(sink.scans.at(0).ended);
}

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
    // A frame inside of what a cut one claims.
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
    // Headers that hold, each claiming the longest frame: what a search can be made to do at worst.
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
    EXPECT_EQ(taken, 8);  // the third in a row is believed
    EXPECT_EQ(count().clock_relocks, 1U);
    EXPECT_EQ(count().restarts, 1U);
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
