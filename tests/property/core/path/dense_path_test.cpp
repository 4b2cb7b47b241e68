// SPDX-License-Identifier: BSD-3-Clause
// What a decimated path leaves out (G-ORCA 13.3), measured in double against all samples that were given.
#include "core/path/dense_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "core/base/random.hpp"

namespace jink::path {
namespace {

struct Sample {
    Eigen::Vector3d position;
    std::uint32_t arrival_ms;
};

/// A smooth random flight, sampled every 10 ms: speed and turn rates wander, with stops, corners and turns back.
std::vector<Sample> random_flight(Random& random, int samples, float away)
{
    std::vector<Sample> flight;
    Eigen::Vector3d position(static_cast<double>(random.uniform(-away, away)),
                             static_cast<double>(random.uniform(-away, away)), 10.0);
    double heading = static_cast<double>(random.uniform(-kPi, kPi));
    double speed = 1.0;
    double rate = 0.0;
    double climb = 0.0;
    double goal = 1.0;
    for (int i = 0; i < samples; ++i) {
        flight.push_back({position, static_cast<std::uint32_t>(10 * i)});
        if (random.below(200) == 0) {
            rate = random.below(2) == 0 ? 0.0 : static_cast<double>(random.uniform(-1.5F, 1.5F));
            climb = random.below(3) != 0 ? 0.0 : static_cast<double>(random.uniform(-0.5F, 0.5F));
            goal = random.below(4) == 0 ? 0.0 : static_cast<double>(random.uniform(0.1F, 5.0F));
        }
        if (random.below(1000) == 0) {
            heading += static_cast<double>(random.uniform(-kPi, kPi));
        }
        speed += std::clamp(goal - speed, -0.02, 0.02);
        heading += 0.01 * rate;
        position += 0.01 * speed * Eigen::Vector3d(std::cos(heading), std::sin(heading), climb);
    }
    return flight;
}

double distance_to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b)
{
    const Eigen::Vector3d way = b - a;
    const double length = way.squaredNorm();
    const double share = length > 0.0 ? std::clamp(way.dot(p - a) / length, 0.0, 1.0) : 0.0;
    return (p - (a + share * way)).norm();
}

/// Each sample between two kept ones lies near their segment, and at most 2 % and the rounding from its speed.
TEST(DensePathLaws, WhatIsLeftOutIsWithinACentimetre)
{
    double worst = 0.0;
    std::size_t given = 0;
    std::size_t kept = 0;
    const auto path = std::make_unique<DensePath>();
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        Random random(seed);
        const float away = seed % 2 == 0 ? 10.0F : 1000.0F;
        const std::vector<Sample> flight = random_flight(random, 1500, away);
        ASSERT_EQ(path->begin(false), DenseStatus::ok);
        for (const Sample& s : flight) {
            ASSERT_EQ(path->add(s.position.cast<float>(), s.arrival_ms), DenseStatus::ok);
        }
        ASSERT_EQ(path->commit(true), DenseStatus::ok);
        given += flight.size();
        kept += path->size();
        std::size_t at = 0;
        const double rounding = static_cast<double>(away) * 1.2e-7;
        for (const Sample& s : flight) {
            while (at + 2 < path->size() && path->point(at + 1).arrival_ms < s.arrival_ms) {
                ++at;
            }
            ASSERT_LE(path->point(at).arrival_ms, s.arrival_ms);
            ASSERT_GE(path->point(at + 1).arrival_ms, s.arrival_ms);
            const double off = distance_to_segment(s.position, path->point(at).position.cast<double>(),
                                                   path->point(at + 1).position.cast<double>());
            ASSERT_LE(off, 0.01 + 4.0 * rounding) << "seed " << seed << ", " << s.arrival_ms << " ms";
            worst = std::max(worst, off);
        }
        EXPECT_EQ(path->point(0).arrival_ms, 0U);
        EXPECT_EQ(path->point(path->size() - 1).arrival_ms, flight.back().arrival_ms);
    }
    std::printf("[ measured ] %zu of %zu samples kept, the others at most %.4f m off\n", kept, given, worst);
    EXPECT_LT(kept * 3, given);
    EXPECT_GT(worst, 0.007) << "it makes use of what it may";
}

/// On an arc at steady speed: chords as long as the error allows, 2 sqrt(2 r e), less what is left to rounding.
TEST(DensePathLaws, AnArcIsCutAsCoarselyAsItMayBe)
{
    const auto path = std::make_unique<DensePath>();
    for (const double radius : {2.0, 10.0, 50.0}) {
        ASSERT_EQ(path->begin(false), DenseStatus::ok);
        const int samples = static_cast<int>(2.0 * 3.14159 * radius / 0.01);
        for (int i = 0; i < samples; ++i) {
            const double a = 0.01 * i / radius;
            const Eigen::Vector3d p(radius * std::cos(a), 0.6 * radius * std::sin(a), 0.8 * radius * std::sin(a));
            ASSERT_EQ(path->add(p.cast<float>(), static_cast<std::uint32_t>(10 * i)), DenseStatus::ok);
        }
        ASSERT_EQ(path->commit(true), DenseStatus::ok);
        const double fewest = 2.0 * 3.14159 * radius / (2.0 * std::sqrt(2.0 * radius * 0.01));
        EXPECT_GE(static_cast<double>(path->size()), fewest) << radius;
        EXPECT_LE(static_cast<double>(path->size()), 1.12 * fewest + 2.0) << radius;
    }
}

}  // namespace
}  // namespace jink::path
