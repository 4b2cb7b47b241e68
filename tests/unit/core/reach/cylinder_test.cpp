// SPDX-License-Identifier: BSD-3-Clause
// Tables of constraints: merging and relevance (reach-set specification, section 13.3).
#include "core/reach/cylinder_table.hpp"

#include <gtest/gtest.h>

namespace jink::reach {
namespace {

TEST(CylinderTables, WhatHasNoRoomIsMergedWithTheFarthest)
{
    CylinderTable table;
    table.begin(Vec3::Zero(), 0.0F, 10.0F);
    const auto cylinder_at = [](float x, float radius) {
        Cylinder cylinder;
        cylinder.circle = {Vec2(x, 0), radius};
        cylinder.bottom = -x;
        cylinder.top = x;
        cylinder.margin = 0.01F * x;
        return cylinder;
    };
    for (std::size_t i = 0; i < kMaxCylinders; ++i) {
        ASSERT_EQ(table.add(cylinder_at(100.0F + 10.0F * static_cast<float>(i), 1.0F)), AddStatus::added);
    }
    EXPECT_EQ(table.merged(), 0U);
    // A near one: the two farthest of those before become one, and it gets a place of its own.
    ASSERT_EQ(table.add(cylinder_at(50.0F, 1.0F)), AddStatus::constraint_merged);
    EXPECT_EQ(table.merged(), 1U);
    ASSERT_EQ(table.cylinders().size(), kMaxCylinders);
    int near = 0;
    int both = 0;
    for (const Cylinder& cylinder : table.cylinders()) {
        near += cylinder.circle.centre.x() == 50.0F ? 1 : 0;
        if (cylinder.circle.radius > 5.0F) {
            ++both;
            EXPECT_NEAR(cylinder.circle.centre.x(), 405.0F, 0.1F);
            EXPECT_NEAR(cylinder.circle.radius, 6.0F, 0.02F);
            EXPECT_FLOAT_EQ(cylinder.margin, 4.1F);
            EXPECT_FLOAT_EQ(cylinder.top, 410.0F);
            EXPECT_FLOAT_EQ(cylinder.bottom, -410.0F);
        }
    }
    EXPECT_EQ(near, 1);
    EXPECT_EQ(both, 1);
    // A far one becomes part of the farthest itself.
    ASSERT_EQ(table.add(cylinder_at(1000.0F, 1.0F)), AddStatus::constraint_merged);
    EXPECT_EQ(table.merged(), 2U);
    table.begin(Vec3::Zero(), 0.0F, 10.0F);
    EXPECT_TRUE(table.cylinders().empty());
    EXPECT_EQ(table.merged(), 0U);
}

/// Equation 6.110: near enough with the margin, including its motion, and overlapping heights.
TEST(CylinderTables, OnlyWhatMayMatterIsActive)
{
    Cylinder cylinder;
    cylinder.circle = {Vec2(200, 0), 20.0F};
    cylinder.margin = 10.0F;
    cylinder.top = 50.0F;
    const Vec3 vehicle(0, 0, 60);
    EXPECT_FALSE(may_matter(cylinder, vehicle, 100.0F, 0.0F, 10.0F));
    EXPECT_TRUE(may_matter(cylinder, vehicle, 170.1F, 0.0F, 10.0F));
    EXPECT_FALSE(may_matter(cylinder, vehicle, 169.0F, 0.0F, 10.0F));
    cylinder.velocity = Vec2(-7, 0);
    EXPECT_TRUE(may_matter(cylinder, vehicle, 100.0F, 0.0F, 10.0F)) << "it comes nearer";
    EXPECT_TRUE(may_matter(cylinder, vehicle, 100.0F, 9.0F, 1.0F)) << "it has come nearer";
    EXPECT_FALSE(may_matter(cylinder, vehicle, 100.0F, 60.0F, 1.0F)) << "it is past";
    EXPECT_TRUE(may_matter(cylinder, Vec3(200, 0, 149), 100.0F, 0.0F, 10.0F));
    EXPECT_FALSE(may_matter(cylinder, Vec3(200, 0, 151), 100.0F, 0.0F, 10.0F)) << "far below";
}

}  // namespace
}  // namespace jink::reach
