// SPDX-License-Identifier: BSD-3-Clause
// Two aircraft with one id on random courses: the truth, kept in double precision, is always within some track.
#include <array>
#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/world/separation.hpp"
#include "core/world/track_table.hpp"
#include "tests/property/core/geometry/oracle.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using geometry::oracle::case_count;
using geometry::oracle::in_cube;
using geometry::oracle::seed_of;
using Vec3d = Eigen::Vector3d;

struct Aircraft {
    Vec3d start = Vec3d::Zero();
    Vec3d velocity = Vec3d::Zero();
    double next = 0.0;
    double period = 0.2;
    int seen = 0;
    [[nodiscard]] Vec3d at(double t) const { return start + t * velocity; }
};

Aircraft random_aircraft(Random& random)
{
    Aircraft a;
    a.start = in_cube(random, 400.0F).cast<double>();
    a.velocity = in_cube(random, 30.0F).cast<double>();
    a.period = static_cast<double>(random.uniform(0.1F, 1.0F));
    a.next = a.period * static_cast<double>(random.uniform(0.0F, 1.0F));
    return a;
}

TrackMeasurement sighting_of(Random& random, const Aircraft& a, double t)
{
    TrackMeasurement m;
    m.id = 7;
    m.stamp = TimePoint{1'000'000'000 + static_cast<std::int64_t>(t * 1e6)};
    // Noise that is bounded by its 2 standard deviations per axis.
    m.position = a.at(t).cast<float>() + in_cube(random, 0.5F);
    m.velocity = a.velocity.cast<float>() + in_cube(random, 0.3F);
    m.has_velocity = true;
    m.radius = 1.0F;
    m.sigma_position = 0.25F;
    m.sigma_velocity = 0.15F;
    return m;
}

bool is_within_some(std::span<const Track> tracks, const Vec3d& place)
{
    for (const Track& t : tracks) {
        const double reach = double(t.radius) + 3.0 * double(t.sigma_position);
        if ((t.position.cast<double>() - place).norm() <= reach) {
            return true;
        }
    }
    return false;
}

TEST(TwoOfOneId, BothAreAlwaysWithinSomeTrack)
{
    const std::uint64_t seed = seed_of(20261124);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t i = 0; i < case_count(300); ++i) {
        std::array<Aircraft, 2> two{random_aircraft(random), random_aircraft(random)};
        if ((two[0].start - two[1].start).norm() < 60.0) {
            continue;  // first received apart, as the table's contract requires
        }
        TrackTable table;
        const vehicle::VehicleState own;
        for (int k = 0; k < 80; ++k) {
            Aircraft& a = two[0].next <= two[1].next ? two[0] : two[1];
            const Aircraft& b = &a == two.data() ? two[1] : two[0];
            const double t = a.next;
            const TrackMeasurement m = sighting_of(random, a, t);
            static_cast<void>(table.update(m, own, m.stamp));
            ++a.seen;
            const auto tracks = table.snapshot(m.stamp);
            ASSERT_TRUE(is_within_some(tracks, a.at(t))) << "case " << i << ", the one seen, t " << t;
            // One second of dead reckoning by a velocity that is 0.3 m/s wrong per axis at most.
            if (b.seen > 0) {
                const double off = t - (b.next - b.period);
                bool near = false;
                for (const Track& track : tracks) {
                    near = near || (track.position.cast<double>() - b.at(t)).norm() <=
                                       double(track.radius) +
                                           3.0 * (double(track.sigma_position) + off * double(track.sigma_velocity));
                }
                ASSERT_TRUE(near) << "case " << i << ", the other one, t " << t;
            }
            ASSERT_LE(tracks.size(), kMaxSameId);
            a.next += a.period;
        }
    }
}

/// The margin against an upright capsule is that against the nearest of all spheres along its axis.
TEST(TwoOfOneId, AnUncertainHeightIsKeptClearOfAtEveryHeight)
{
    const std::uint64_t seed = seed_of(20261125);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t apart = 0;
    const std::size_t cases = case_count(400);
    for (std::size_t i = 0; i < cases; ++i) {
        test::Scene scene;
        scene.limits.half_extents = Vec3(0.5F, 0.5F, 0.3F) + in_cube(random, 0.2F);
        Track& track = scene.track(in_cube(random, 30.0F), in_cube(random, 8.0F), random.uniform(0.5F, 3.0F));
        track.half_height = random.uniform(0.0F, 40.0F);
        std::vector<Vec3> corners;
        for (int k = 0; k < 4; ++k) {
            corners.push_back(in_cube(random, 30.0F));
        }
        const Seconds step = random.uniform(0.5F, 2.0F);
        const path::TimedPath path = test::flight(corners, step);
        const Vec3d half = scene.limits.half_extents.cast<double>();
        double truth = static_cast<double>(kSeparationCap);
        for (int n = 0; n <= 3000; ++n) {
            const double t = 3.0 * static_cast<double>(step) * n / 3000.0;
            const auto leg = std::min<std::size_t>(2, static_cast<std::size_t>(t / static_cast<double>(step)));
            const double share = t / static_cast<double>(step) - static_cast<double>(leg);
            const Vec3d own = corners[leg].cast<double>() * (1 - share) + corners[leg + 1].cast<double>() * share;
            Vec3d gap = track.position.cast<double>() + t * track.velocity.cast<double>() - own;
            // Whichever height within the capsule is nearest to the box.
            const double height = static_cast<double>(track.half_height);
            gap.z() -= std::clamp(gap.z(), -height, height);
            const Vec3d outside = (gap.cwiseAbs() - half).cwiseMax(0.0);
            truth = std::min(truth, outside.norm() - static_cast<double>(track.radius));
        }
        const Separation found = test::separation(scene, path, 100.0F, {});
        if (truth < 0.3) {
            // Within a margin at the start the escape rule counts, not the distance.
            WorkBudget budget(test::kPlenty);
            const float at_start = separation_at(scene.situation(), corners[0], 0.0F, budget).margin;
            if (at_start > 0.0F) {
                ASSERT_LE(found.margin, static_cast<float>(truth) + 1e-2F) << "case " << i;
            }
            continue;
        }
        ++apart;
        // Sampled every 2 ms at up to 130 m/s: the truth may be a little less.
        ASSERT_NEAR(found.margin, truth, 0.1) << "case " << i;
    }
    EXPECT_GT(apart, cases / 8);
}

}  // namespace
}  // namespace jink::world
