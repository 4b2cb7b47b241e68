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
    // Nose up by 0.3 rad: points ahead of the platform are above. Right side down: points to the left are above.
    driver.first.pitch = 3000;
    hear(driver.scan(std::vector<RawPoint>{{0, 0, 1000}}, sender_ms()));
    EXPECT_NEAR((sink.scans.at(0).rays[0].second - Vec3(9.5534F, 0, 2.9552F)).norm(), 0.0F, 1e-3F);
    driver.first.pitch = 0;
    driver.first.roll = 3000;
    hear(driver.scan(std::vector<RawPoint>{{15708, 0, 1000}}, sender_ms()));
    EXPECT_NEAR((sink.scans.at(1).rays[0].second - Vec3(0, 9.5534F, 2.9552F)).norm(), 0.0F, 1e-3F);
    // Both: the pitch is about the level axis, so points to the left keep their height.
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

TEST_F(CloudReceiver, LostPartIsReportedByTheNextScan)
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

TEST_F(CloudReceiver, LostPartIsReportedByAPause)
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
    // More points than the scan's stated number.
    hear(all[1]);
    part.part = 2;
    hear(frame_of(part, std::vector<RawPoint>(11)));
    EXPECT_EQ(count().inconsistent, 9U);
    hear(all[2]);
    EXPECT_EQ(sink.rays(), 250U);
    EXPECT_TRUE(sink.scans.at(0).ended);
}

}  // namespace
}  // namespace jink::link::cloud
