// SPDX-License-Identifier: BSD-3-Clause
// The range image against double precision: its obstacles cover all hits, and every hit is counted once.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "core/base/random.hpp"
#include "firmware/app/cloud.hpp"
#include "tests/unit/app/cloud_bench.hpp"

namespace jink::app {
namespace {

using link::Ray;
using P = Eigen::Vector3d;

constexpr double kHalfTurn = 3.14159265358979323846;
constexpr double kDegrees = 180.0 / kHalfTurn;

/// A hit, and the bin that double precision puts it in; none where a rounding could put it in another.
struct Hit {
    Vec3 point;
    double range = 0.0;
    int bin = -1;
};

Hit hit_at(const Vec3& point)
{
    const P p = point.cast<double>();
    const double column = (std::atan2(p.y(), p.x()) * kDegrees + 180.0) / 10.0;
    const double row = (std::atan2(p.z(), std::hypot(p.x(), p.y())) * kDegrees + 45.0) / 10.0;
    const auto near_border = [](double x) { return std::abs(x - std::round(x)) < 1e-5; };
    const bool unsure = near_border(column) || (row > 0.5 && row < 8.5 && near_border(row));
    const int bin = static_cast<int>(std::floor(column)) * 9 + std::clamp(static_cast<int>(std::floor(row)), 0, 8);
    return {point, p.norm(), unsure ? -1 : bin};
}

double depth_at(double range) { return std::max(1.0, 0.3 * range); }

/// Difficult scenes: scattered points, an oblique plane, wires, shells.
std::vector<Hit> random_scene(Random& random)
{
    std::vector<Hit> hits;
    const auto direction = [&] {
        const Vec3 v(random.normal(), random.normal(), random.normal());
        return v.norm() > 1e-3F ? Vec3(v.normalized()) : Vec3(Vec3::UnitX());
    };
    const auto kind = random.below(4);
    const Vec3 normal = direction();
    const float away = random.uniform(3.0F, 80.0F);
    const std::size_t n = 1 + random.below(kind == 1 ? 3000 : 400);
    const Vec3 along = direction();
    for (std::size_t i = 0; i < n; ++i) {
        Vec3 point;
        if (kind == 0) {
            point = direction() * random.uniform(3.0F, 599.0F);
        } else if (kind == 1) {  // a plane as seen by the rays
            const Vec3 ray = direction();
            const float steep = ray.dot(normal);
            point = steep > 0.01F ? Vec3(ray * (away / steep)) : Vec3(ray * 3.0F);
        } else if (kind == 2) {
            point = normal * away + along * random.uniform(-30.0F, 30.0F);
        } else {
            point = direction() * (away + random.uniform(0.0F, 1.3F * away));
        }
        if (point.norm() > 2.9F && point.norm() < 599.0F) {
            hits.push_back(hit_at(point));
        }
    }
    return hits;
}

class CloudLaws : public ::testing::Test {
protected:
    /// Runs one scan into an empty table, own place at the world's origin with this yaw.
    void scan(const std::vector<Hit>& hits, float yaw)
    {
        table->clear();
        CloudView view;
        view.is_placed = true;
        view.yaw = yaw;
        view.half_extents = Vec3(1, 1, 1);
        image->look_from(view);
        link::CloudScan s;
        s.max_range = 600.0F;
        image->begin_scan(s);
        for (const Hit& hit : hits) {
            image->add(Ray::hit, hit.point);
        }
        image->end_scan(0);
    }
    std::unique_ptr<world::ObstacleTable> table = std::make_unique<world::ObstacleTable>();
    std::unique_ptr<CloudObstacles> image = [this] {
        auto made = std::make_unique<CloudObstacles>(0);
        made->give_to(*table);
        return made;
    }();
};

TEST_F(CloudLaws, EveryHitOfAPatchLiesWithinAnObstacle)
{
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    std::size_t checked = 0;
    std::size_t crowded = 0;
    for (int scene = 0; scene < 2000; ++scene) {
        const std::vector<Hit> hits = random_scene(random);
        const float yaw = random.uniform(-kPi, kPi);
        scan(hits, yaw);
        std::array<double, CloudObstacles::kBins> nearest{};
        nearest.fill(1e9);
        bool all_sure = true;
        for (const Hit& hit : hits) {
            all_sure = all_sure && hit.bin >= 0;
            if (hit.bin >= 0) {
                double& best = nearest[static_cast<std::size_t>(hit.bin)];
                best = std::min(best, hit.range);
            }
        }
        if (!all_sure) {
            continue;  // the nearest of a bin is not known to this oracle
        }
        std::array<double, CloudObstacles::kBins> order = nearest;
        std::sort(order.begin(), order.end());
        // Of bins that differ by less than the image's resolution either may come first.
        const double last = order[kMaxCloudObstacles] - 0.02;
        crowded += order[kMaxCloudObstacles] < 1e9 ? 1 : 0;
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(static_cast<double>(yaw), P::UnitZ()).toRotationMatrix();
        for (const Hit& hit : hits) {
            const double first = nearest[static_cast<std::size_t>(hit.bin)];
            if (first > last || hit.range > first + depth_at(first)) {
                continue;
            }
            ++checked;
            const P world = turn * hit.point.cast<double>();
            const bool covered =
                std::any_of(table->obstacles().begin(), table->obstacles().end(), [&](const world::Obstacle& o) {
                    return (o.shape.centre.cast<double>() - world).norm() <= static_cast<double>(o.shape.radius);
                });
            ASSERT_TRUE(covered) << "seed " << kSeed << " scene " << scene << " range " << hit.range;
        }
        ASSERT_LE(table->obstacles().size(), kMaxCloudObstacles);
    }
    EXPECT_GT(checked, 100'000U);
    EXPECT_GT(crowded, 100U);
}

TEST_F(CloudLaws, NoObstacleReachesMuchNearerThanWhatWasHit)
{
    Random random(20261124);
    double least = 1.0;
    for (int scene = 0; scene < 1000; ++scene) {
        const std::vector<Hit> hits = random_scene(random);
        scan(hits, 0.0F);
        for (const world::Obstacle& o : table->obstacles()) {
            double nearest = 1e9;
            for (const Hit& hit : hits) {
                const bool inside = (o.shape.centre - hit.point).norm() <= o.shape.radius;
                nearest = inside ? std::min(nearest, hit.range) : nearest;
            }
            ASSERT_LT(nearest, 1e9) << "an obstacle without a hit, scene " << scene;
            const double surface = static_cast<double>(o.shape.centre.norm() - o.shape.radius);
            const bool is_outer = o.id % 9 == 0 || o.id % 9 == 8;
            // Geometry of a bin: 0.877 within the rows, 0.52 where they reach to the poles; and the least radius.
            ASSERT_GE(surface, (is_outer ? 0.5 : 0.87) * nearest - 0.28) << "scene " << scene;
            least = std::min(least, surface / nearest);
        }
    }
    EXPECT_LT(least, 0.9);  // or the scenes try nothing
}

TEST_F(CloudLaws, EveryRayIsCountedOnce)
{
    Random random(20261125);
    const auto some = std::make_unique<CloudObstacles>(0);
    std::uint64_t hits = 0;
    std::uint64_t others = 0;
    for (int scene = 0; scene < 500; ++scene) {
        CloudView view;
        view.is_placed = random.below(4) != 0;
        view.position = Vec3(0, 0, random.uniform(0.0F, 50.0F));
        view.half_extents = Vec3(4, 4, 4);
        view.has_floor = random.below(2) == 0;
        view.floor = 5.0F;
        some->look_from(view);
        some->begin_scan({});
        for (std::size_t i = random.below(500); i > 0; --i) {
            const Vec3 v(random.normal(), random.normal(), random.normal());
            const auto ray = static_cast<Ray>(random.below(3));
            ++(ray == Ray::hit ? hits : others);
            some->add(ray, ray == Ray::hit ? Vec3(v * std::pow(10.0F, random.uniform(-1.0F, 3.0F)))
                                           : Vec3(v.stableNormalized()));
        }
        some->end_scan(0);
    }
    const CloudDiagnostics& d = some->diagnostics();
    EXPECT_EQ(d.hits, hits);
    EXPECT_EQ(d.nothing + d.invalid, others);
    EXPECT_EQ(d.body + d.below_floor + d.beyond + d.behind + d.kept, hits);
    for (const std::uint64_t cause : {d.body, d.below_floor, d.beyond, d.behind, d.kept}) {
        EXPECT_GT(cause, 100U);
    }
}

/// 10^5 points ten times a second, a fifth of a scan in each tick, for 100 scans: nothing waits, nothing is lost.
TEST(CloudLoad, HundredThousandPointsTenTimesASecond)
{
    using namespace test;
    constexpr std::size_t kPoints = 100'000;
    constexpr std::uint64_t kScans = 100;
    const auto f = std::make_unique<CloudFlight>();
    cloud::test::Counter counter;
    f->flight.coprocessor.forward_clouds_to(counter);
    f->fly(60);
    Random random(20261126);
    std::vector<cloud::RawPoint> points = cloud::test::random_points(random, kPoints);
    for (cloud::RawPoint& point : points) {
        point.range = static_cast<std::uint16_t>(4000 + random.below(3) * 30'000);
    }
    for (std::uint64_t scan = 0; scan < kScans; ++scan) {
        const auto bytes = cloud::test::joined(f->driver.scan(points, f->driver_ms()));
        const std::size_t share = (bytes.size() + 4) / 5;
        for (std::size_t tick = 0; tick < 5; ++tick) {
            const std::size_t at = tick * share;
            f->line.feed(std::span(bytes).subspan(at, std::min(share, bytes.size() - at)));
            f->fly(1);
            ASSERT_EQ(f->line.waiting(), 0U);
        }
    }
    const link::cloud::ReceiverDiagnostics& d = f->input.receiver_diagnostics();
    EXPECT_EQ(d.points, kScans * kPoints);
    EXPECT_EQ(d.scans_complete, kScans);
    EXPECT_EQ(d.points_lost, 0U);
    EXPECT_EQ(d.noise_bytes, 0U);
    EXPECT_EQ(f->input.full_steps(), 0U);
    EXPECT_EQ(counter.points, kScans * kPoints);
    EXPECT_EQ(counter.ended, kScans);
    const CloudDiagnostics& c = f->input.port_diagnostics();
    EXPECT_EQ(c.hits, kScans * kPoints);
    EXPECT_EQ(c.body + c.below_floor + c.beyond + c.behind + c.kept, kScans * kPoints);
    EXPECT_EQ(c.obstacles, kScans * kMaxCloudObstacles);
}

/// Twice the read limit of a step: the line's losses are reported, and every point is accounted for once.
TEST(CloudLoad, WhatALineLosesIsCounted)
{
    using namespace test;
    constexpr std::size_t kPoints = 50'000;
    const auto f = std::make_unique<CloudFlight>();
    cloud::test::Counter counter;
    f->flight.coprocessor.forward_clouds_to(counter);
    f->fly(60);
    Random random(20261127);
    const std::vector<cloud::RawPoint> points = cloud::test::random_points(random, kPoints);
    std::uint64_t announced = 0;
    for (int scan = 0; scan < 20; ++scan) {
        std::vector<cloud::test::Bytes> frames = f->driver.scan(points, f->driver_ms());
        announced += kPoints;
        // A buffer of 200 KiB before the port: excess bytes are lost, in the middle of a frame.
        auto bytes = cloud::test::joined(frames);
        const std::size_t room = 200U * 1024U > f->line.waiting() ? 200U * 1024U - f->line.waiting() : 0;
        bytes.resize(std::min(bytes.size(), room));
        f->line.feed(bytes);
        f->fly(1);
    }
    f->fly(30);
    const link::cloud::ReceiverDiagnostics& d = f->input.receiver_diagnostics();
    EXPECT_GT(f->input.full_steps(), 10U);
    EXPECT_GT(d.points_lost, 0U);
    EXPECT_GT(d.frames_missed, 0U);
    EXPECT_EQ(d.scans + d.scans_missed, 20U);
    EXPECT_EQ(d.points + d.points_lost + d.scans_missed * kPoints, announced);
    EXPECT_EQ(counter.points, d.points);
    EXPECT_EQ(counter.lost, d.points_lost);
}

}  // namespace
}  // namespace jink::app
