// SPDX-License-Identifier: BSD-3-Clause
// The cloud receiver under random losses, doublings, swaps and damage; geometry against double precision.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <memory>

#include "tests/unit/link/cloud_tools.hpp"

namespace jink::link::cloud {
namespace {

using namespace test;

TEST(CloudReceiverLaws, EveryPointOfEveryScanIsInOnePlace)
{
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    for (int run = 0; run < 300; ++run) {
        const auto receiver = std::make_unique<Receiver>();
        Recorder sink;
        Driver driver;
        TimePoint now{50'000'000};
        std::uint64_t bytes_heard = 0;
        for (int scan = 0; scan < 20; ++scan) {
            now = now + 0.1F;
            // The range names the point.
            std::vector<RawPoint> points(random.below(1000));
            for (std::size_t i = 0; i < points.size(); ++i) {
                points[i].range = static_cast<std::uint16_t>(i + 1);
            }
            std::vector<Bytes> frames =
                driver.scan(points, static_cast<std::uint32_t>(now.us / 1000), 1 + random.below(kMaxPoints));
            for (std::size_t faults = random.below(4); faults > 0 && !frames.empty(); --faults) {
                const std::size_t at = random.below(frames.size());
                if (frames[at].empty()) {
                    continue;
                }
                switch (random.below(5)) {
                case 0: frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(at)); break;
                case 1: frames.push_back(frames[at]); break;
                case 2: std::swap(frames[at], frames[random.below(frames.size())]); break;
                case 3:
                    frames[at][random.below(frames[at].size())] ^= static_cast<std::byte>(1U << random.below(8));
                    break;
                default: frames[at].resize(random.below(frames[at].size())); break;
                }
            }
            const Bytes bytes = joined(frames);
            bytes_heard += bytes.size();
            for (std::size_t at = 0; at < bytes.size();) {
                const std::size_t n = std::min<std::size_t>(1 + random.below(3000), bytes.size() - at);
                receiver->receive(std::span(bytes).subspan(at, n), now, sink);
                at += n;
            }
        }
        for (int idle = 0; idle < 2; ++idle) {  // the first may find a frame within a cut one, and a scan continues
            now = now + 1.0F;
            receiver->receive({}, now, sink);
        }
        const ReceiverDiagnostics& d = receiver->diagnostics();
        ASSERT_FALSE(sink.broken) << "seed " << kSeed << " run " << run;
        ASSERT_EQ(d.frame_bytes + d.noise_bytes, bytes_heard) << "run " << run;
        ASSERT_EQ(receiver->pending(), 0U);
        ASSERT_EQ(d.points, sink.rays());
        std::uint64_t lost = 0;
        for (const Recorder::Scan& scan : sink.scans) {
            ASSERT_TRUE(scan.ended);
            lost += scan.lost;
            std::vector<int> seen(1001);
            for (const auto& [ray, point] : scan.rays) {
                ASSERT_EQ(ray, Ray::hit);
                const auto name = static_cast<std::size_t>(std::lround(point.norm() * 100.0F));
                ASSERT_LE(name, 1000U);
                ASSERT_EQ(++seen[name], 1) << "twice";
            }
        }
        ASSERT_EQ(lost, d.points_lost);
    }
}

TEST(CloudReceiverLaws, PointsAreLevelWithinRounding)
{
    Random random(20261124);
    const auto receiver = std::make_unique<Receiver>();
    Recorder sink;
    Driver driver;
    TimePoint now{50'000'000};
    using V = Eigen::Vector3d;
    for (int scan = 0; scan < 500; ++scan) {
        now = now + 0.1F;
        driver.first.roll = static_cast<std::int16_t>(static_cast<int>(random.below(2 * kHalfTurn + 1)) - kHalfTurn);
        driver.first.pitch =
            static_cast<std::int16_t>(static_cast<int>(random.below(2 * kQuarterTurn + 1)) - kQuarterTurn);
        const std::vector<RawPoint> points = random_points(random, 100);
        receiver->receive(joined(driver.scan(points, static_cast<std::uint32_t>(now.us / 1000))), now, sink);
        // FRD to level by quaternions, then y and z change their sign; the platform's axes are x, -y, -z of FRD.
        const Eigen::Quaterniond turn = Eigen::AngleAxisd(1e-4 * driver.first.pitch, V::UnitY()) *
                                        Eigen::AngleAxisd(1e-4 * driver.first.roll, V::UnitX());
        ASSERT_EQ(sink.scans.back().rays.size(), points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double a = 1e-4 * points[i].azimuth;
            const double e = 1e-4 * points[i].elevation;
            const double range = points[i].range == 0 || points[i].range == 65535 ? 1.0 : 0.01 * points[i].range;
            const V frd(std::cos(e) * std::cos(a), -std::cos(e) * std::sin(a), -std::sin(e));
            const V turned = range * (turn * frd);
            const V expected(turned.x(), -turned.y(), -turned.z());
            const auto& [ray, point] = sink.scans.back().rays[i];
            ASSERT_LT((point.cast<double>() - expected).norm(), 1e-6 * range + 1e-6);
            ASSERT_EQ(ray, points[i].range == 0 ? Ray::invalid : points[i].range == 65535 ? Ray::nothing : Ray::hit);
        }
        sink.scans.clear();
    }
}

TEST(CloudReceiverLaws, GarbageNeverWorksLongerThanItsBound)
{
    Random random(20261125);
    for (int run = 0; run < 200; ++run) {
        const auto receiver = std::make_unique<Receiver>();
        Counter sink;
        Driver driver;
        const std::vector<Bytes> frames = driver.scan(random_points(random, 600), 1000);
        Bytes bytes;
        // Pieces of frames in any order, with start bytes among them.
        while (bytes.size() < 20'000) {
            const Bytes& frame = frames[random.below(frames.size())];
            const std::size_t from = random.below(3) == 0 ? random.below(frame.size()) : 0;
            const std::size_t to = std::min(frame.size(), from + 1 + random.below(60));
            bytes.insert(bytes.end(), frame.begin() + static_cast<std::ptrdiff_t>(from),
                         frame.begin() + static_cast<std::ptrdiff_t>(to));
        }
        receiver->receive(bytes, TimePoint{50'000'000}, sink);
        ASSERT_LE(receiver->checksum_bytes(), Receiver::kMaxWorkPerByte * bytes.size() + kHeaderSize * 20);
        receiver->receive({}, TimePoint{60'000'000}, sink);
        receiver->receive({}, TimePoint{70'000'000}, sink);
        ASSERT_EQ(receiver->pending(), 0U);
        ASSERT_EQ(sink.begun, sink.ended);
    }
}

}  // namespace
}  // namespace jink::link::cloud
