// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/smoothing.hpp"

#include <gtest/gtest.h>

namespace jink::orca {
namespace {

Vec3 along_x(float speed) { return {speed, 0.0F, 0.0F}; }

/// Section 17, filter: N = 3, commands 0, 0, 6 (newest last) -> 3.
TEST(CommandFilter, CheckValueOfThreeCommands)
{
    CommandFilter filter(3);
    EXPECT_EQ(filter.add(along_x(0.0F)).x(), 0.0F);
    EXPECT_EQ(filter.add(along_x(0.0F)).x(), 0.0F);
    EXPECT_NEAR(filter.add(along_x(6.0F)).x(), 3.0F, 1e-6F);
}
/// Section 17, filter: constant 6 -> 6, from the first command on.
TEST(CommandFilter, CheckValueOfAConstant)
{
    CommandFilter filter(3);
    for (int i = 0; i < 3000; ++i) {
        ASSERT_NEAR(filter.add(along_x(6.0F)).x(), 6.0F, 1e-5F) << i;
    }
}
/// D16: without the weights' sum the gain at rest would be 2 / (N + 1), 0.18 for N = 10.
TEST(CommandFilter, TheFlownFilterDoesNotLoseSpeed)
{
    CommandFilter filter;
    EXPECT_EQ(filter.length(), 10U);
    Vec3 out = Vec3::Zero();
    for (int i = 0; i < 10; ++i) {
        out = filter.add(Vec3(1.0F, -2.0F, 0.5F));
    }
    EXPECT_LT((out - Vec3(1.0F, -2.0F, 0.5F)).norm(), 1e-6F);
}
/// Section 12: N = 10 at 40 Hz is 75 ms late.
TEST(CommandFilter, CheckValueOfTheDelay) { EXPECT_NEAR(CommandFilter(10).delay(0.025F), 0.075F, 1e-7F); }

/// Until there are N, those that are there with their own weights: 1 / 3 and 2 / 3 of two.
TEST(CommandFilter, WarmsUpWithItsOwnWeights)
{
    CommandFilter filter(10);
    EXPECT_EQ(filter.add(along_x(3.0F)).x(), 3.0F);
    EXPECT_NEAR(filter.add(along_x(6.0F)).x(), 5.0F, 1e-6F);
    EXPECT_NEAR(filter.add(along_x(0.0F)).x(), (3.0F + 12.0F) / 6.0F, 1e-6F);
}
TEST(CommandFilter, ClearedItWarmsUpAgain)
{
    CommandFilter filter(4);
    for (int i = 0; i < 9; ++i) {
        static_cast<void>(filter.add(along_x(5.0F)));
    }
    filter.clear();
    EXPECT_EQ(filter.add(along_x(-1.0F)).x(), -1.0F);
    EXPECT_NEAR(filter.add(along_x(2.0F)).x(), 1.0F, 1e-6F);
}
TEST(CommandFilter, OfLengthOneItPassesEverything)
{
    CommandFilter filter(1);
    for (const float v : {1.0F, -7.0F, 0.25F}) {
        EXPECT_EQ(filter.add(along_x(v)).x(), v);
    }
    EXPECT_EQ(filter.delay(0.025F), 0.0F);
}
TEST(CommandFilter, LengthsOutsideAreTheNearerEnd)
{
    EXPECT_EQ(CommandFilter(0).length(), 1U);
    EXPECT_EQ(CommandFilter(33).length(), CommandFilter::kMax);
}

}  // namespace
}  // namespace jink::orca
