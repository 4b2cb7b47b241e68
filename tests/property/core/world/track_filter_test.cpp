// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/world/track_table.hpp"
#include "tests/property/core/geometry/oracle.hpp"

#if defined(__GNUC__) && !defined(__clang__)
// GCC 12 ends in an internal error (expand_LOOP_VECTORIZED) on the bounded matrices below.
#pragma GCC optimize("no-tree-vectorize")
#endif

namespace jink::world {
namespace {

using geometry::oracle::case_count;
using geometry::oracle::in_cube;
using geometry::oracle::seed_of;

constexpr TimePoint kStart{1'000'000'000};

/// The filter as textbooks have it: 2 x 2 matrices in double precision, position and velocity taken in at once.
struct Reference {
    /// Up to three rows and columns, off the heap: the core's headers forbid Eigen to allocate.
    using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    Eigen::Matrix<double, 2, 3> state = Eigen::Matrix<double, 2, 3>::Zero();  // rows: position, velocity

    void start(const TrackMeasurement& m, double first_sigma_velocity)
    {
        const double sigma_velocity = m.has_velocity ? double(m.sigma_velocity) : first_sigma_velocity;
        covariance = Eigen::Vector2d(std::pow(double(m.sigma_position), 2), std::pow(sigma_velocity, 2)).asDiagonal();
        state.row(0) = m.position.cast<double>();
        state.row(1) = m.has_velocity ? Eigen::RowVector3d(m.velocity.cast<double>()) : Eigen::RowVector3d::Zero();
    }
    void update(const TrackMeasurement& m, double dt, double q)
    {
        Eigen::Matrix2d f;
        f << 1, dt, 0, 1;
        Eigen::Matrix2d noise;
        noise << dt * dt * dt / 3, dt * dt / 2, dt * dt / 2, dt;
        state = f * state;
        covariance = f * covariance * f.transpose() + q * q * noise;
        const int rows = m.has_velocity ? 2 : 1;
        const Small h = Eigen::Matrix2d::Identity().topRows(rows);
        Small r = Small::Zero(rows, rows);
        Small z(rows, 3);
        r(0, 0) = std::pow(double(m.sigma_position), 2);
        z.row(0) = m.position.cast<double>();
        if (m.has_velocity) {
            r(1, 1) = std::pow(double(m.sigma_velocity), 2);
            z.row(1) = m.velocity.cast<double>();
        }
        const Small gain = covariance * h.transpose() * (h * covariance * h.transpose() + r).inverse();
        state += gain * (z - h * state);
        covariance = (Eigen::Matrix2d::Identity() - gain * h) * covariance;
    }
};

struct Truth {
    Vec3 position, velocity;
};

Vec3 noise(Random& random, float sigma)
{
    return {sigma * random.normal(), sigma * random.normal(), sigma * random.normal()};
}

TrackMeasurement see(Random& random, const Truth& truth, TimePoint stamp, bool with_velocity, float sigma_p,
                     float sigma_v)
{
    TrackMeasurement m;
    m.id = 1;
    m.stamp = stamp;
    m.position = truth.position + noise(random, sigma_p);
    m.has_velocity = with_velocity;
    m.velocity = with_velocity ? Vec3(truth.velocity + noise(random, sigma_v)) : Vec3(Vec3::Zero());
    m.sigma_position = sigma_p;
    m.sigma_velocity = sigma_v;
    return m;
}

TEST(TrackFilter, EqualsTheTextbookInDoublePrecision)
{
    const std::uint64_t seed = seed_of(20260701);
    SCOPED_TRACE(seed);
    Random random(seed);
    TrackTableSettings settings;
    settings.jump_gate = 1e6F;
    settings.max_age = 100.0F;
    for (std::size_t i = 0; i < case_count(2000); ++i) {
        settings.process_acceleration = random.below(4) == 0 ? 0.0F : random.uniform(0.01F, 5.0F);
        settings.first_sigma_velocity = random.uniform(0.5F, 20.0F);
        TrackTable table(settings);
        vehicle::VehicleState own;
        Reference reference;
        Truth truth{in_cube(random, 500.0F), in_cube(random, 20.0F)};
        TimePoint now = kStart;
        TimePoint last = now;
        for (int step = 0; step < 30; ++step) {
            const TrackMeasurement m =
                see(random, truth, now, random.below(2) == 0, random.uniform(0.05F, 5.0F), random.uniform(0.05F, 3.0F));
            if (step == 0) {
                reference.start(m, double(settings.first_sigma_velocity));
            } else {
                reference.update(m, double(m.stamp.us - last.us) * 1e-6, double(settings.process_acceleration));
            }
            last = now;
            ASSERT_EQ(table.update(m, own, now), step == 0 ? TrackStatus::created : TrackStatus::updated);
            const Track& track = table.snapshot(now)[0];
            // Float carries positions of 1 km to 6e-5 m; 30 steps add up.
            for (int axis = 0; axis < 3; ++axis) {
                ASSERT_NEAR(double(track.position[axis]), reference.state(0, axis), 2e-3) << "case " << i;
                ASSERT_NEAR(double(track.velocity[axis]), reference.state(1, axis), 2e-3) << "case " << i;
            }
            ASSERT_NEAR(double(track.sigma_position), std::sqrt(reference.covariance(0, 0)), 1e-3) << "case " << i;
            ASSERT_NEAR(double(track.sigma_velocity), std::sqrt(reference.covariance(1, 1)), 1e-3) << "case " << i;
            const TimePoint next = now + (random.below(10) == 0 ? 1e-3F : random.uniform(0.02F, 1.5F));
            truth.position += truth.velocity * (next - now);
            now = next;
        }
    }
}

/// Share of errors within 1, 2 and 3 sigmas of a normal distribution.
constexpr double kShare[] = {0.682689, 0.954500, 0.997300};

struct Tally {
    std::size_t within[3] = {};
    std::size_t all = 0;

    void note(float error, float sigma)
    {
        ++all;
        for (int k = 0; k < 3; ++k) {
            within[k] += std::abs(error) <= static_cast<float>(k + 1) * sigma ? 1U : 0U;
        }
    }
    [[nodiscard]] double share(int k) const { return double(within[k]) / double(all); }
    /// Five standard deviations of the count itself: a false alarm is out of the question.
    [[nodiscard]] double chance(int k) const { return 5.0 * std::sqrt(kShare[k] * (1.0 - kShare[k]) / double(all)); }
};

/// Flies one track by the filter's own model (white acceleration of density q squared), measured with the sighting's
/// accuracy.
struct Flown {
    TrackTable table;
    Truth truth;
    TimePoint now = kStart;
};

void fly(Random& random, Flown& flown, float q, float sigma_p, float sigma_v, bool with_velocity, int sightings)
{
    const vehicle::VehicleState own;
    for (int i = 0; i < sightings; ++i) {
        ASSERT_LE(
            flown.table.update(see(random, flown.truth, flown.now, with_velocity, sigma_p, sigma_v), own, flown.now),
            TrackStatus::created);
        if (i + 1 == sightings) {
            break;
        }
        const TimePoint next = flown.now + random.uniform(0.1F, 1.0F);
        const Seconds dt = next - flown.now;
        const Vec3 kick = noise(random, q * std::sqrt(dt));
        const Vec3 rest = noise(random, q * std::sqrt(dt * dt * dt / 12.0F));
        flown.truth.position += flown.truth.velocity * dt + 0.5F * dt * kick + rest;
        flown.truth.velocity += kick;
        flown.now = next;
    }
}

/// For a target that follows the filter's model, its covariance is consistent.
TEST(TrackFilter, DoubtIsWhatTheErrorsAre)
{
    const std::uint64_t seed = seed_of(20260702);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (const bool with_velocity : {false, true}) {
        Tally position, velocity;
        for (std::size_t i = 0; i < case_count(10000); ++i) {
            TrackTableSettings settings;
            settings.process_acceleration = random.below(3) == 0 ? 0.0F : random.uniform(0.1F, 2.0F);
            Flown flown{TrackTable(settings), {in_cube(random, 300.0F), noise(random, settings.first_sigma_velocity)}};
            fly(random, flown, settings.process_acceleration, random.uniform(0.1F, 3.0F), random.uniform(0.1F, 2.0F),
                with_velocity, 1 + static_cast<int>(random.below(12)));
            EXPECT_EQ(flown.table.diagnostics().jumps, 0U) << "case " << i;
            const Track& track = flown.table.snapshot(flown.now)[0];
            for (int axis = 0; axis < 3; ++axis) {
                position.note(track.position[axis] - flown.truth.position[axis], track.sigma_position);
                velocity.note(track.velocity[axis] - flown.truth.velocity[axis], track.sigma_velocity);
            }
        }
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(position.share(k), kShare[k], position.chance(k)) << k + 1 << " sigmas";
            EXPECT_NEAR(velocity.share(k), kShare[k], velocity.chance(k)) << k + 1 << " sigmas";
        }
    }
}

/// A target that flies straight is inside its grown sphere, per axis, at least as often as k sigmas promise, whenever
/// asked.
TEST(TrackFilter, TheGrownSphereHoldsAStraightFlyer)
{
    const std::uint64_t seed = seed_of(20260703);
    SCOPED_TRACE(seed);
    Random random(seed);
    Tally ahead[4];
    constexpr Seconds kAhead[] = {0.0F, 1.0F, 3.0F, 8.0F};
    for (std::size_t i = 0; i < case_count(10000); ++i) {
        Flown flown{TrackTable(), {in_cube(random, 300.0F), in_cube(random, 15.0F)}};
        fly(random, flown, 0.0F, random.uniform(0.1F, 3.0F), random.uniform(0.1F, 2.0F), true,
            1 + static_cast<int>(random.below(12)));
        vehicle::VehicleState own;
        vehicle::VehicleLimits limits;
        vehicle::Airframe airframe;
        world::Reference reference;
        const FlightRules rules{.k_sigma = 1.0F};
        const auto tracks = flown.table.snapshot(flown.now);
        const Situation situation{flown.now, own, limits, airframe, reference, rules};
        for (std::size_t a = 0; a < 4; ++a) {
            const float sigma = threat_radius(situation, tracks[0], kAhead[a]);  // no body, one sigma
            const Vec3 error = tracks[0].position + tracks[0].velocity * kAhead[a] - flown.truth.position -
                               flown.truth.velocity * kAhead[a];
            for (int axis = 0; axis < 3; ++axis) {
                ahead[a].note(error[axis], sigma);
            }
        }
    }
    for (const Tally& tally : ahead) {
        for (int k = 0; k < 3; ++k) {
            EXPECT_GE(tally.share(k), kShare[k] - tally.chance(k)) << k + 1 << " sigmas";
        }
    }
}

/// For any finite inputs the outputs are finite.
TEST(TrackFilter, NothingButNumbersComesOut)
{
    const std::uint64_t seed = seed_of(20260704);
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto any = [&] {
        const float size = geometry::oracle::power_of_ten(random, -45.0F, 38.0F);
        return random.below(3) == 0 ? random.uniform(-10.0F, 10.0F) : (random.below(2) == 0 ? size : -size);
    };
    for (std::size_t i = 0; i < case_count(200000); ++i) {
        TrackTableSettings settings;
        settings.process_acceleration = random.below(2) == 0 ? 0.0F : 0.5F;
        TrackTable table(settings);
        const vehicle::VehicleState own;
        TimePoint now = kStart;
        for (int step = 0; step < 4; ++step) {
            TrackMeasurement m;
            m.id = 1;
            m.stamp = now;
            m.position = random.below(2) == 0 ? Vec3(any(), any(), any()) : in_cube(random, 100.0F);
            m.velocity = random.below(2) == 0 ? Vec3(any(), any(), any()) : in_cube(random, 10.0F);
            m.has_velocity = random.below(2) == 0;
            m.radius = any();
            m.sigma_position = any();
            m.sigma_velocity = any();
            m.max_acceleration = any();
            static_cast<void>(table.update(m, own, now));
            now = now + (random.below(2) == 0 ? 1e-6F : random.uniform(0.0F, 0.7F));
        }
        for (const Track& track : table.snapshot(now)) {
            ASSERT_TRUE(is_finite(track.position) && is_finite(track.velocity)) << "case " << i;
            ASSERT_TRUE(std::isfinite(track.sigma_position) && std::isfinite(track.sigma_velocity)) << "case " << i;
            const vehicle::VehicleLimits limits;
            const vehicle::Airframe airframe;
            const world::Reference reference;
            const FlightRules rules{.k_sigma = 6.0F};
            const Situation situation{now, own, limits, airframe, reference, rules};
            ASSERT_TRUE(std::isfinite(threat_radius(situation, track, 60.0F))) << "case " << i;
            ASSERT_GE(threat_radius(situation, track, 60.0F), 0.0F) << "case " << i;
        }
    }
}

bool equal(const Track& a, const Track& b)
{
    return a.id == b.id && a.stamp == b.stamp && a.position == b.position && a.velocity == b.velocity &&
           a.radius == b.radius && a.sigma_position == b.sigma_position && a.sigma_velocity == b.sigma_velocity;
}

/// Sightings of different tracks may arrive in any order, those of one in theirs.
TEST(TrackFilter, OrderOfArrivalDoesNotMatter)
{
    const std::uint64_t seed = seed_of(20260705);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t i = 0; i < case_count(300); ++i) {
        const std::size_t tracks = 1 + random.below(kMaxTracks);
        std::vector<std::vector<TrackMeasurement>> queues(tracks);
        for (std::size_t id = 0; id < tracks; ++id) {
            Truth truth{in_cube(random, 300.0F), in_cube(random, 10.0F)};
            for (std::size_t k = 0; k < 1 + random.below(5); ++k) {
                TrackMeasurement m = see(random, truth, kStart + 0.5F * static_cast<float>(k), true, 1.0F, 0.5F);
                m.id = static_cast<TrackId>(id * 37 % 101);
                queues[id].push_back(m);
                truth.position += truth.velocity * 0.5F;
            }
        }
        const TimePoint now = kStart + 2.0F;
        const auto run = [&](TrackTable& table) {
            const vehicle::VehicleState own;
            std::vector<std::size_t> next(tracks, 0);
            for (std::size_t left = tracks; left > 0;) {
                const std::size_t id = random.below(tracks);
                if (next[id] < queues[id].size()) {
                    static_cast<void>(table.update(queues[id][next[id]++], own, now));
                    left -= next[id] == queues[id].size() ? 1U : 0U;
                }
            }
            return table.snapshot(now);
        };
        TrackTable first, second;
        const auto a = run(first);
        const auto b = run(second);
        ASSERT_EQ(a.size(), tracks);
        ASSERT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end(), equal)) << "case " << i;
    }
}

/// More tracks than the capacity, once each: the table keeps the most dangerous ones, for any order.
TEST(TrackFilter, AFullTableKeepsTheMostDangerousInAnyOrder)
{
    const std::uint64_t seed = seed_of(20260706);
    SCOPED_TRACE(seed);
    Random random(seed);
    for (std::size_t i = 0; i < case_count(300); ++i) {
        vehicle::VehicleState own;
        own.position = in_cube(random, 100.0F);
        own.velocity = in_cube(random, 10.0F);
        std::vector<TrackMeasurement> all;
        std::vector<std::pair<double, TrackId>> danger;
        for (TrackId id = 0; id < kMaxTracks + 1 + random.below(kMaxTracks); ++id) {
            const Truth truth{in_cube(random, 1000.0F), in_cube(random, 20.0F)};
            const Seconds age = random.uniform(0.0F, 2.0F);
            TrackMeasurement m = see(random, truth, kStart - age, true, 1.0F, 0.5F);
            m.id = id;
            m.radius = random.uniform(0.0F, 5.0F);
            all.push_back(m);
            // Closest approach ahead by sampling, in double precision, from where the track is now.
            const Eigen::Vector3d gap =
                (m.position - own.position).cast<double>() + m.velocity.cast<double>() * double(kStart - m.stamp);
            const Eigen::Vector3d closing = (m.velocity - own.velocity).cast<double>();
            double best = gap.norm();
            double when = 0;
            for (double t = 0, step = 64; step > 1e-4; step /= 2) {
                while ((gap + closing * (t + step)).norm() < best && t < 1e4) {
                    t += step;
                    best = (gap + closing * t).norm();
                }
                while (t >= step && (gap + closing * (t - step)).norm() < best) {
                    t -= step;
                    best = (gap + closing * t).norm();
                }
                when = t;
            }
            // Seconds: the time to it, one for each 3 m of it, and the age.
            danger.emplace_back(when + std::max(best - double(m.radius), 0.0) / 3.0 + double(kStart - m.stamp), id);
        }
        std::sort(danger.begin(), danger.end());
        if (danger[kMaxTracks].first - danger[kMaxTracks - 1].first < 0.01) {
            continue;  // too close to call in float
        }
        std::vector<TrackId> expected;
        for (std::size_t k = 0; k < kMaxTracks; ++k) {
            expected.push_back(danger[k].second);
        }
        std::sort(expected.begin(), expected.end());
        for (int order = 0; order < 3; ++order) {
            for (std::size_t k = all.size(); k > 1; --k) {
                std::swap(all[k - 1], all[random.below(k)]);
            }
            TrackTable table;
            for (const TrackMeasurement& m : all) {
                static_cast<void>(table.update(m, own, kStart));
            }
            std::vector<TrackId> kept;
            for (const Track& track : table.snapshot(kStart)) {
                kept.push_back(track.id);
            }
            ASSERT_EQ(kept, expected) << "case " << i;
            ASSERT_EQ(table.diagnostics().full + table.diagnostics().replaced, all.size() - kMaxTracks);
        }
    }
}

}  // namespace
}  // namespace jink::world
