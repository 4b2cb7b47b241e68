// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/quick_reject.hpp"

#include <gtest/gtest.h>

#include <cstdio>

#include "core/base/random.hpp"
#include "core/geometry/sweep.hpp"
#include "tests/property/core/geometry/oracle.hpp"

namespace jink::geometry {
namespace {

Vec3 vector(Random& random, float size)
{
    return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

TEST(QuickReject, SaysNothingThatTheExactTestWouldNotSay)
{
    std::size_t apart = 0;
    std::size_t touches = 0;
    std::size_t unclear = 0;
    for (std::uint64_t seed = 1; seed <= 1'000'000; ++seed) {
        Random random(seed);
        const float scale = std::pow(10.0F, random.uniform(-2.0F, 3.0F));
        const Vec3 half = scale * vector(random, 1.0F).cwiseAbs();
        const Vec3 from = scale * vector(random, 4.0F);
        const Vec3 to = from + scale * vector(random, random.uniform() < 0.5F ? 1.0F : 6.0F);
        float radius = scale * random.uniform(0.0F, 3.0F);
        if (random.uniform() < 0.5F) {
            // Grazing to a few last bits.
            const float least = least_distance(half, {}, {-from, from - to}, 1.0F).distance;
            radius = least * (1.0F + random.uniform(-1e-6F, 1e-6F));
        }
        const bool contact = contact_interval(half, {}, {-from, from - to}, radius, 1.0F).has_value();
        const QuickReject said = quick_reject(half, from, to, radius);
        ASSERT_FALSE(contact && said == QuickReject::apart) << "seed " << seed;
        ASSERT_FALSE(!contact && said == QuickReject::touches) << "seed " << seed;
        apart += said == QuickReject::apart ? 1U : 0U;
        touches += said == QuickReject::touches ? 1U : 0U;
        unclear += said == QuickReject::unclear ? 1U : 0U;
    }
    std::printf("[ measured ] %zu apart, %zu touch, %zu unclear, half of all grazing\n", apart, touches, unclear);
    EXPECT_GT(apart, 100'000U);
    EXPECT_GT(touches, 50'000U);
}

TEST(QuickReject, EdgeCases)
{
    const Vec3 half = Vec3::Ones();
    EXPECT_EQ(quick_reject(half, Vec3(3, 0, 0), Vec3(3, 0, 0), 1.0F), QuickReject::apart);
    EXPECT_EQ(quick_reject(half, Vec3(2, 0, 0), Vec3(2, 0, 0), 1.0F),
              QuickReject::unclear);  // contact is left to the exact test
    EXPECT_EQ(quick_reject(half, Vec3(0, 0, 0), Vec3(0, 0, 0), 0.0F), QuickReject::touches);  // inside
    EXPECT_EQ(quick_reject(half, Vec3(-5, 0, 0), Vec3(5, 0, 0), 0.0F), QuickReject::touches);
    EXPECT_EQ(quick_reject(half, Vec3(-9, 3, 0), Vec3(9, 3, 0), 1.0F), QuickReject::apart);  // along a face
    EXPECT_EQ(quick_reject(Vec3::Zero(), Vec3(1, 0, 0), Vec3(1, 0, 0), 0.0F), QuickReject::apart);
}

}  // namespace
}  // namespace jink::geometry
