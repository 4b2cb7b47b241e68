// SPDX-License-Identifier: BSD-3-Clause
#include "core/path/dense_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace jink::path {
namespace {

Vec3 along_x(float x) { return {x, 0.0F, 0.0F}; }

/// A straight line of `n` samples 1 cm apart, 10 ms each, from `from` on.
DenseStatus load_line(DensePath& path, bool continues, bool last, float from, int n = 100)
{
    if (const DenseStatus status = path.begin(continues); status != DenseStatus::ok) {
        return status;
    }
    for (int i = 0; i <= n; ++i) {
        const auto t = static_cast<std::uint32_t>(10 * i);
        if (const DenseStatus status = path.add(along_x(from + 0.01F * static_cast<float>(i)), t);
            status != DenseStatus::ok) {
            return status;
        }
    }
    return path.commit(last);
}

class DensePathTest : public ::testing::Test {
protected:
    std::unique_ptr<DensePath> path = std::make_unique<DensePath>();
};

TEST_F(DensePathTest, AStraightLineIsTwoPoints)
{
    ASSERT_EQ(load_line(*path, false, true, 0.0F, 60'000), DenseStatus::ok) << "10 min sampled at 0.01 s";
    ASSERT_EQ(path->size(), 2U);
    EXPECT_NEAR(path->along(1), 600.0F, 1e-3F);
    EXPECT_EQ(path->point(1).arrival_ms, 600'000U);
    EXPECT_TRUE(path->is_complete());
}

TEST_F(DensePathTest, ACornerIsKept)
{
    ASSERT_EQ(path->begin(false), DenseStatus::ok);
    std::uint32_t t = 0;
    for (int i = 0; i <= 100; ++i) {
        ASSERT_EQ(path->add(along_x(0.01F * static_cast<float>(i)), t++ * 10), DenseStatus::ok);
    }
    for (int i = 1; i <= 100; ++i) {
        ASSERT_EQ(path->add(Vec3(1.0F, 0.01F * static_cast<float>(i), 0.0F), t++ * 10), DenseStatus::ok);
    }
    ASSERT_EQ(path->commit(true), DenseStatus::ok);
    // The corner itself, or a sample next to it: the error decides.
    ASSERT_GE(path->size(), 3U);
    ASSERT_LE(path->size(), 4U);
    float nearest = 1.0F;
    for (std::size_t i = 0; i < path->size(); ++i) {
        nearest = std::min(nearest, (path->point(i).position - Vec3(1, 0, 0)).norm());
    }
    EXPECT_LE(nearest, 0.0101F);
}

/// 13.3: speed changes of more than 2 % are kept, with their arrival times.
TEST_F(DensePathTest, AChangeOfSpeedIsKept)
{
    const auto load = [&](std::uint32_t second_ms) {
        EXPECT_EQ(path->begin(false), DenseStatus::ok);
        std::uint32_t t = 0;
        for (int i = 0; i <= 100; ++i) {
            EXPECT_EQ(path->add(along_x(0.1F * static_cast<float>(i)), t), DenseStatus::ok);
            t += i < 50 ? 100 : second_ms;
        }
        EXPECT_EQ(path->commit(true), DenseStatus::ok);
        return path->size();
    };
    EXPECT_EQ(load(102), 2U) << "0.98 m/s after 1 m/s";
    EXPECT_EQ(load(105), 3U) << "0.952 m/s";
    EXPECT_EQ(path->point(1).arrival_ms, 5000U);
    EXPECT_NEAR(path->point(1).position.x(), 5.0F, 1e-5F);
}

/// A pause is kept as two points at one place.
TEST_F(DensePathTest, APauseIsKept)
{
    ASSERT_EQ(path->begin(false), DenseStatus::ok);
    const float xs[] = {0, 1, 2, 2, 2, 3, 4};
    for (std::uint32_t i = 0; i < 7; ++i) {
        ASSERT_EQ(path->add(along_x(xs[i]), 1000 * i), DenseStatus::ok);
    }
    ASSERT_EQ(path->commit(true), DenseStatus::ok);
    ASSERT_EQ(path->size(), 4U);
    EXPECT_EQ(path->point(1).arrival_ms, 2000U);
    EXPECT_EQ(path->point(2).arrival_ms, 4000U);
}

/// A way back on itself: the turning point is no nearer to any chord than its distance.
TEST_F(DensePathTest, ATurnBackIsKept)
{
    ASSERT_EQ(path->begin(false), DenseStatus::ok);
    for (std::uint32_t i = 0; i <= 200; ++i) {
        const float x = i <= 100 ? static_cast<float>(i) : static_cast<float>(200 - i);
        ASSERT_EQ(path->add(along_x(0.05F * x), 100 * i), DenseStatus::ok);
    }
    ASSERT_EQ(path->commit(true), DenseStatus::ok);
    ASSERT_EQ(path->size(), 3U);
    EXPECT_NEAR(path->point(1).position.x(), 5.0F, 1e-5F);
    EXPECT_NEAR(path->along(2), 10.0F, 1e-4F);
}

/// Zigzag of 10 cm: every sample has to be kept.
DenseStatus load_zigzag(DensePath& path, std::size_t points)
{
    EXPECT_EQ(path.begin(false), DenseStatus::ok);
    for (std::size_t i = 0; i < points; ++i) {
        const Vec3 p(0.1F * static_cast<float>(i), i % 2 == 0 ? 0.0F : 0.1F, 0.0F);
        if (const DenseStatus status = path.add(p, static_cast<std::uint32_t>(100 * i)); status != DenseStatus::ok) {
            return status;
        }
    }
    return path.commit(true);
}

/// 13.3, section 18: one point more than fit, and nothing is accepted: PATH_TOO_LONG.
TEST_F(DensePathTest, TooLongIsRefusedAsAWhole)
{
    ASSERT_EQ(load_line(*path, false, true, 7.0F), DenseStatus::ok);
    const std::uint32_t before = path->generation();
    EXPECT_EQ(load_zigzag(*path, kMaxDensePoints + 1), DenseStatus::too_long);
    EXPECT_EQ(path->generation(), before);
    EXPECT_EQ(path->size(), 2U);
    EXPECT_EQ(path->point(0).position.x(), 7.0F);
    EXPECT_EQ(path->add(along_x(1.0F), 1), DenseStatus::no_path) << "the load is over";
    EXPECT_EQ(path->commit(true), DenseStatus::no_path);
    EXPECT_EQ(load_zigzag(*path, kMaxDensePoints), DenseStatus::ok);
    EXPECT_EQ(path->size(), kMaxDensePoints);
    EXPECT_NE(path->generation(), before);
}

TEST_F(DensePathTest, RefusesWhatIsNoPath)
{
    EXPECT_EQ(path->add(Vec3::Zero(), 0), DenseStatus::no_path);
    ASSERT_EQ(path->begin(false), DenseStatus::ok);
    EXPECT_EQ(path->commit(true), DenseStatus::too_few) << "no point";
    ASSERT_EQ(path->begin(false), DenseStatus::ok);
    ASSERT_EQ(path->add(Vec3::Zero(), 0), DenseStatus::ok);
    EXPECT_EQ(path->commit(true), DenseStatus::too_few) << "one point";
    ASSERT_EQ(path->begin(false), DenseStatus::ok);
    ASSERT_EQ(path->add(Vec3::Zero(), 0), DenseStatus::ok);
    ASSERT_EQ(path->add(Vec3::Zero(), 1), DenseStatus::ok);
    EXPECT_EQ(path->commit(true), DenseStatus::too_few) << "one place";
    ASSERT_EQ(path->begin(false), DenseStatus::ok);
    ASSERT_EQ(path->add(Vec3::Zero(), 5), DenseStatus::ok);
    EXPECT_EQ(path->add(along_x(1.0F), 5), DenseStatus::time_not_later);
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1.1e5F}) {
        ASSERT_EQ(path->begin(false), DenseStatus::ok);
        EXPECT_EQ(path->add(along_x(bad), 0), DenseStatus::not_finite);
    }
    EXPECT_TRUE(path->empty());
}

/// Double buffer: one chunk is flown while the next is loaded; a third finds no room until the first is flown.
TEST_F(DensePathTest, StreamsChunkByChunk)
{
    ASSERT_EQ(load_line(*path, false, false, 0.0F), DenseStatus::ok);
    EXPECT_FALSE(path->is_complete());
    EXPECT_EQ(load_line(*path, true, false, 1.2F), DenseStatus::gap);
    ASSERT_EQ(load_line(*path, true, false, 1.0F), DenseStatus::ok);
    EXPECT_EQ(path->size(), 3U);
    EXPECT_NEAR(path->along(2), 2.0F, 1e-5F);
    EXPECT_EQ(path->begin(true), DenseStatus::busy);
    EXPECT_EQ(path->advance(0), 0U) << "still on the first";
    EXPECT_EQ(path->advance(1), 0U);
    EXPECT_EQ(path->size(), 2U);
    EXPECT_NEAR(path->point(0).position.x(), 1.0F, 1e-5F);
    ASSERT_EQ(load_line(*path, true, true, 2.0F), DenseStatus::ok);
    EXPECT_TRUE(path->is_complete());
    EXPECT_NEAR(path->along(2), 2.0F, 1e-5F);
    EXPECT_EQ(path->generation(), 1U) << "one path";
    EXPECT_EQ(path->advance(1), 0U);
    EXPECT_EQ(load_line(*path, true, true, 3.0F), DenseStatus::gap) << "it is complete: whoever flies it may be done";
}

TEST_F(DensePathTest, ToReplaceAPathGivesItsContinuationUp)
{
    ASSERT_EQ(load_line(*path, false, false, 0.0F), DenseStatus::ok);
    ASSERT_EQ(load_line(*path, true, true, 1.0F), DenseStatus::ok);
    ASSERT_EQ(path->begin(false), DenseStatus::ok);
    EXPECT_EQ(path->size(), 2U);
    EXPECT_FALSE(path->is_complete());
    path->abandon();
    EXPECT_EQ(path->size(), 2U);
    EXPECT_EQ(path->generation(), 1U);
}

}  // namespace
}  // namespace jink::path
