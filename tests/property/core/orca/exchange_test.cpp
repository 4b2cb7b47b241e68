// SPDX-License-Identifier: BSD-3-Clause
// The exchange of corners by itself, in both precisions: the conditions of optimality hold where it ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <Eigen/Dense>

#include "core/orca/exchange.hpp"
#include "tests/property/core/orca/precision.hpp"

namespace jink::orca {
namespace {

using namespace precision;

template <class Real>
class ExchangeLaws : public Precision<Real> {
};
TYPED_TEST_SUITE(ExchangeLaws, Precisions);

/// Half-spaces of which the first `soft` never yield, and four contradicting ones.
struct Contradiction {
    std::vector<Row> rows;
    std::vector<float> yields;
    std::size_t soft = 0;
    std::array<std::uint16_t, 4> start{};
    bool has_start = false;

    [[nodiscard]] double yield(std::size_t i) const { return i < soft ? 0.0 : static_cast<double>(yields[i]); }

    explicit Contradiction(Random& random, std::size_t hard) : soft(hard)
    {
        const std::size_t count = 5 + random.below(12);
        for (std::size_t i = 0; i < count; ++i) {
            rows.push_back({unit_vector(random), i < soft ? -1.0F : random.uniform(-0.3F, 1.0F)});
            yields.push_back(random.below(3) == 0 ? random.uniform(0.5F, 3.0F) : 1.0F);
        }
        for (int tries = 0; tries < 60 && !has_start; ++tries) {
            std::vector<std::uint16_t> order(count);
            std::iota(order.begin(), order.end(), std::uint16_t{0});
            for (std::size_t k = count - 1; k > 0; --k) {
                std::swap(order[k], order[random.below(k + 1)]);
            }
            Eigen::Matrix4d m;
            for (int k = 0; k < 4; ++k) {
                start[static_cast<std::size_t>(k)] = order[static_cast<std::size_t>(k)];
                const std::size_t i = order[static_cast<std::size_t>(k)];
                m.col(k) << rows[i].normal.cast<double>(), yield(i);
            }
            if (std::fabs(m.determinant()) < 0.02) {
                continue;
            }
            const Eigen::Vector4d shares = m.inverse() * Eigen::Vector4d(0, 0, 0, 1);
            has_start = shares.minCoeff() > 0.05;
        }
    }
};

/// A corner that is returned is the least violation: none is broken more, the four are broken equally, and their
/// normals cancel each other with shares that are not negative.
TYPED_TEST(ExchangeLaws, AnExchangeEndsAtTheLeastViolation)
{
    Random random(kOptimumSeed + 3);
    int started = 0;
    int ended = 0;
    for (int i = 0; i < 2500; ++i) {
        const std::size_t hard = i % 3 == 0 ? 1 + random.below(2) : 0;
        Contradiction c(random, hard);
        if (!c.has_start) {
            continue;
        }
        started += hard == 0 ? 1 : 0;
        WorkBudget budget(kEnoughWork);
        Corner<TypeParam> corner;
        corner.rows = c.start;
        const std::vector<Sphere> wide{{Vec3::Zero(), 100.0F}};
        const Tolerance<TypeParam> tolerance(4.0F);
        if (!exchange<TypeParam>(c.rows, c.yields, c.soft, wide, tolerance, budget, corner)) {
            continue;
        }
        ended += hard == 0 ? 1 : 0;
        const Eigen::Vector3d x = as_double<TypeParam>(corner.x);
        const double d = as_double(corner.d);
        const auto beyond = [&](std::size_t k) {
            return static_cast<double>(c.rows[k].offset) - c.rows[k].normal.cast<double>().dot(x) - d * c.yield(k);
        };
        const double exact = std::is_same_v<TypeParam, float> ? 2e-4 : 1e-5;
        bool is_clear = true;  // no fifth one is nearly as far broken
        for (std::size_t k = 0; k < c.rows.size(); ++k) {
            ASSERT_LE(beyond(k), exact) << "seed " << kOptimumSeed << ", case " << i;
            const bool decides = std::find(corner.rows.begin(), corner.rows.end(), k) != corner.rows.end();
            is_clear = is_clear && (decides || beyond(k) < -1e-2);
        }
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        double yields = 0.0;
        double most = 1.0;
        for (std::size_t k = 0; k < 4; ++k) {
            const double share = as_double(corner.shares[k]);
            ASSERT_GE(share, 0.0) << i;
            ASSERT_LE(std::fabs(beyond(corner.rows[k])), exact) << "seed " << kOptimumSeed << ", case " << i;
            sum += share * c.rows[corner.rows[k]].normal.template cast<double>();
            yields += share * c.yield(corner.rows[k]);
            most = std::max(most, share);
        }
        ASSERT_LE(sum.norm(), 1e-3 * most) << i;
        ASSERT_NEAR(yields, 1.0, 1e-3) << i;
        ASSERT_TRUE(corner.is_alone || !is_clear) << "seed " << kOptimumSeed << ", case " << i;
        // Nothing is known where a sphere decides too, or no work may be done.
        const float reach = corner.x.template cast<float>().norm();
        Corner<TypeParam> again = corner;
        const std::vector<Sphere> holds{{Vec3::Zero(), 1.01F * reach + 0.01F}};
        ASSERT_TRUE(exchange<TypeParam>(c.rows, c.yields, c.soft, holds, tolerance, budget, again)) << i;
        again = corner;
        const std::vector<Sphere> decides{{Vec3::Zero(), 100.0F}, {Vec3::Zero(), 0.99F * reach - 0.01F}};
        if (decides[1].radius > 0.0F) {
            ASSERT_FALSE(exchange<TypeParam>(c.rows, c.yields, c.soft, decides, tolerance, budget, again)) << i;
        }
        again = corner;
        WorkBudget none(0);
        ASSERT_FALSE(exchange<TypeParam>(c.rows, c.yields, c.soft, wide, tolerance, none, again)) << i;
        // The same half-space twice: a fifth one is as far broken.
        c.rows.push_back(c.rows[corner.rows[0]]);
        c.yields.push_back(corner.rows[0] < c.soft ? 1.0F : c.yields[corner.rows[0]]);
        if (corner.rows[0] >= c.soft) {
            again = corner;
            ASSERT_TRUE(exchange<TypeParam>(c.rows, c.yields, c.soft, wide, tolerance, budget, again)) << i;
            ASSERT_FALSE(again.is_alone) << i;
        }
    }
    EXPECT_GT(started, 700);
    EXPECT_GE(100 * ended, 95 * started) << ended << " of " << started;
}

TYPED_TEST(ExchangeLaws, WhatIsNoCornerIsSaid)
{
    const std::vector<Sphere> spheres{{Vec3::Zero(), 10.0F}};
    const std::vector<float> yields(5, 1.0F);
    const auto ends = [&](const std::vector<Row>& rows, std::size_t soft) {
        WorkBudget budget(kEnoughWork);
        Corner<TypeParam> corner;
        corner.rows = {0, 1, 2, 3};
        return exchange<TypeParam>(rows, std::span(yields).first(rows.size()), soft, spheres,
                                   Tolerance<TypeParam>(2.0F), budget, corner);
    };
    const float s = 1.0F / std::sqrt(3.0F);
    const std::vector<Row> corners{{{s, s, s}, 0.5F}, {{s, -s, -s}, 0.5F}, {{-s, s, -s}, 0.5F}, {{-s, -s, s}, 0.5F}};
    EXPECT_TRUE(ends(corners, 0));
    EXPECT_TRUE(ends(corners, 3)) << "one that gives way is enough";
    EXPECT_FALSE(ends(corners, 4)) << "none gives way";
    std::vector<Row> flat = corners;
    for (Row& row : flat) {
        row.normal.z() = 0.0F;
        row.normal.normalize();
    }
    EXPECT_FALSE(ends(flat, 0));
    std::vector<Row> agree = corners;
    agree[0].normal = -agree[0].normal;  // all have the same direction
    EXPECT_FALSE(ends(agree, 0));
}

}  // namespace
}  // namespace jink::orca
