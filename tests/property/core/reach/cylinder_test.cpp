// SPDX-License-Identifier: BSD-3-Clause
// Cylinders: smallest circles against all pairs and triples in double.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/random.hpp"
#include "core/reach/cylinder.hpp"

namespace jink::reach {
namespace {

using LevelPoint = Eigen::Vector2d;

/// Radius of the smallest circle, by trying every circle through two and three points.
double smallest_radius(const std::vector<Vec2>& points)
{
    std::vector<LevelPoint> p;
    for (const Vec2& q : points) {
        p.push_back(q.cast<double>());
    }
    double best = p.size() == 1 ? 0.0 : 1e300;
    const auto attempt = [&](const LevelPoint& centre, double radius) {
        if (!(radius < best)) {
            return;
        }
        for (const LevelPoint& q : p) {
            if ((q - centre).norm() > radius * (1.0 + 1e-9) + 1e-12) {
                return;
            }
        }
        best = radius;
    };
    for (std::size_t i = 0; i < p.size(); ++i) {
        for (std::size_t j = i + 1; j < p.size(); ++j) {
            attempt(0.5 * (p[i] + p[j]), 0.5 * (p[i] - p[j]).norm());
            for (std::size_t k = j + 1; k < p.size(); ++k) {
                const LevelPoint b = p[j] - p[i];
                const LevelPoint c = p[k] - p[i];
                const double twice = 2.0 * (b.x() * c.y() - b.y() * c.x());
                if (twice != 0.0) {
                    const LevelPoint to((c.y() * b.squaredNorm() - b.y() * c.squaredNorm()) / twice,
                                        (b.x() * c.squaredNorm() - c.x() * b.squaredNorm()) / twice);
                    attempt(p[i] + to, to.norm());
                }
            }
        }
    }
    return best;
}

TEST(CylinderLaws, TheSmallestCircleHoldsAllAndIsTheSmallest)
{
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    for (int i = 0; i < 5000; ++i) {
        std::vector<Vec2> points;
        const std::size_t count = 1 + random.below(12);
        const float size = std::pow(10.0F, random.uniform(-1.0F, 4.0F));
        const bool in_line = i % 5 == 0;
        const bool on_circle = i % 7 == 0;
        for (std::size_t n = 0; n < count; ++n) {
            Vec2 p(random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F));
            p.y() = in_line ? 0.5F * p.x() : p.y();
            p = on_circle ? Vec2(p.normalized()) : p;
            points.push_back(size * p + Vec2(size, 0.0F));
            if (random.below(4) == 0) {
                points.push_back(points.back());
            }
        }
        const Circle circle = smallest_circle(points);
        for (const Vec2& p : points) {
            ASSERT_LE((p - circle.centre).norm(), circle.radius * (1.0F + 1e-6F) + 1e-6F * size)
                << "seed " << kSeed << ", case " << i;
        }
        ASSERT_LE(static_cast<double>(circle.radius), smallest_radius(points) + 1e-4 * static_cast<double>(size))
            << "seed " << kSeed << ", case " << i;
    }
    EXPECT_EQ(smallest_circle({}).radius, 0.0F);
}

}  // namespace
}  // namespace jink::reach
