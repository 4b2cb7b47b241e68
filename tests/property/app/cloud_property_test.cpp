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
        image = std::make_unique<CloudObstacles>(0);
        image->give_to(*table);
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
    std::unique_ptr<CloudObstacles> image;
};

/// How far outside a box or an upright capsule a point lies, in double precision [m].
double outside(const geometry::Shape& shape, const P& point)
{
    const P local = shape.axes.cast<double>().transpose() * (point - shape.centre.cast<double>());
    const P past = (local.cwiseAbs() - shape.half.cast<double>()).cwiseMax(0.0);
    const P level(local.x(), local.y(), past.z());
    return shape.kind == geometry::ShapeKind::box ? past.norm()
                                                  : std::max(0.0, level.norm() - static_cast<double>(shape.radius));
}

TEST_F(CloudLaws, EveryHitLiesWithinAnObstacle)
{
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    std::size_t checked = 0;
    std::size_t full = 0;
    std::size_t whole = 0;
    for (int scene = 0; scene < 1000; ++scene) {
        const std::vector<Hit> hits = random_scene(random);
        const float yaw = random.uniform(-kPi, kPi);
        scan(hits, yaw);
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(static_cast<double>(yaw), P::UnitZ()).toRotationMatrix();
        const bool is_all = image->diagnostics().left_out == 0;
        whole += is_all ? 1 : 0;
        for (const Hit& hit : hits) {
            if (!is_all && hit.range > static_cast<double>(CloudObstacles::sure_range({}))) {
                continue;
            }
            const P world = turn * hit.point.cast<double>();
            double least = 1e9;
            for (const world::Obstacle& o : table->obstacles()) {
                ASSERT_TRUE(o.shape.kind == geometry::ShapeKind::box || o.shape.kind == geometry::ShapeKind::capsule);
                least = std::min(least, outside(o.shape, world));
            }
            ASSERT_LE(least, 1e-3) << "seed " << kSeed << " scene " << scene << " range " << hit.range;
            ++checked;
        }
        ASSERT_LE(table->obstacles().size(), kMaxCloudObstacles);
        full += table->obstacles().size() == kMaxCloudObstacles ? 1 : 0;
    }
    EXPECT_GT(whole, 100U);
    EXPECT_GT(checked, 100'000U);
    EXPECT_GT(full, 100U);
}

TEST_F(CloudLaws, NoObstacleReachesMuchNearerThanWhatWasHit)
{
    Random random(20261124);
    std::size_t judged = 0;
    std::size_t nearer = 0;
    std::size_t much_nearer = 0;
    for (int scene = 0; scene < 1000; ++scene) {
        const std::vector<Hit> hits = random_scene(random);
        scan(hits, 0.0F);
        const bool is_coarse = image->diagnostics().coarse > 0;
        for (const world::Obstacle& o : table->obstacles()) {
            double nearest = 1e9;
            for (const Hit& hit : hits) {
                const bool inside = outside(o.shape, hit.point.cast<double>()) <= 1e-3;
                nearest = inside ? std::min(nearest, hit.range) : nearest;
            }
            ASSERT_LT(nearest, 1e9) << "an obstacle without a hit, scene " << scene;
            const double surface = outside(o.shape, P::Zero());
            if (!is_coarse) {
                ++judged;
                nearer += surface + 0.4 < 0.8 * nearest ? 1 : 0;
                much_nearer += surface + 0.4 < 0.5 * nearest ? 1 : 0;
            }
        }
    }
    // Upright boxes hold slanting things with what is beside them: 9 and 2 of 100 here.
    EXPECT_GT(judged, 20'000U);
    EXPECT_LT(nearer, judged / 8);
    EXPECT_LT(much_nearer, judged / 40);
}

/// How far a box or an upright capsule reaches past the plane `normal * p = away`, towards the origin [m].
double before_plane(const geometry::Shape& shape, const P& normal, double away)
{
    const P local = shape.axes.cast<double>().transpose() * normal;
    const double reach =
        local.cwiseAbs().dot(shape.half.cast<double>()) +
        (shape.kind == geometry::ShapeKind::box ? 0.0 : static_cast<double>(shape.radius) * local.head<2>().norm());
    return away - (normal.dot(shape.centre.cast<double>()) - reach);
}

/// An upright wall at any slant, as a sensor with noise sees it.
struct Wall {
    Vec3 normal;
    float away = 0.0F;
    std::vector<Hit> hits;
};

Wall random_wall(Random& random)
{
    const float angle = random.uniform(-kPi, kPi);
    Wall wall{Vec3(std::cos(angle), std::sin(angle), 0.0F), random.uniform(3.0F, 12.0F), {}};
    const Vec3 across(-wall.normal.y(), wall.normal.x(), 0.0F);
    const float left = random.uniform(-20.0F, 0.0F);
    const float right = left + random.uniform(4.0F, 30.0F);
    for (float azimuth = -kPi; azimuth < kPi; azimuth += 0.035F) {
        for (float elevation = -0.6F; elevation < 0.6F; elevation += 0.05F) {
            const Vec3 ray(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                           std::sin(elevation));
            const float steep = ray.dot(wall.normal);
            const Vec3 point = ray * (wall.away / std::max(steep, 0.01F));
            if (steep > 0.01F && point.dot(across) > left && point.dot(across) < right) {
                wall.hits.push_back(hit_at(point + 0.02F * random.normal() * ray));
            }
        }
    }
    return wall;
}

/// Seen, and when no ray sees it any more: obstacles stand out of it by little. An obstacle is at least 0.5 m thick;
/// what is about as wide becomes a pillar.
TEST_F(CloudLaws, AnUprightWallStaysThin)
{
    Random random(20261128);
    std::array<std::size_t, 2> judged{};
    std::array<std::size_t, 2> thick{};
    for (int scene = 0; scene < 1000; ++scene) {
        const Wall wall = random_wall(random);
        if (wall.hits.size() < 50) {
            continue;
        }
        scan(wall.hits, 0.0F);
        CloudView view;
        view.is_placed = true;
        view.half_extents = Vec3(1, 1, 1);
        for (const std::size_t later : {0U, 1U}) {
            if (later == 1) {
                view.yaw = random.uniform(-kPi, kPi);
                view.position = Vec3(random.normal(), random.normal(), 0.0F);
                image->look_from(view);
                image->begin_scan({});
                image->end_scan(1000);
            }
            for (const world::Obstacle& o : table->obstacles()) {
                const double out = before_plane(o.shape, wall.normal.cast<double>(), static_cast<double>(wall.away));
                ASSERT_LT(out, later == 0 ? 1.1 : 1.6) << "scene " << scene << " later " << later;
                ++judged[later];
                thick[later] += out > 0.4 ? 1 : 0;
            }
            for (const Hit& hit : wall.hits) {
                ASSERT_TRUE(std::ranges::any_of(
                    table->obstacles(),
                    [&](const world::Obstacle& o) { return outside(o.shape, hit.point.cast<double>()) <= 1e-3; }))
                    << "scene " << scene << " later " << later;
            }
        }
    }
    EXPECT_GT(judged[0], 1000U);
    EXPECT_LT(thick[0], judged[0] / 40);
    EXPECT_GT(judged[1], 1000U);
    EXPECT_LT(thick[1], judged[1] / 6);
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
    EXPECT_EQ(d.body + d.below_floor + d.beyond + d.kept, hits);
    for (const std::uint64_t cause : {d.body, d.below_floor, d.beyond, d.kept}) {
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
    EXPECT_EQ(c.body + c.below_floor + c.beyond + c.kept, kScans * kPoints);
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
