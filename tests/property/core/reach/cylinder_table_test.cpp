// SPDX-License-Identifier: BSD-3-Clause
// Merged constraints: every point of either constraint, at any time, is in the merged constraint.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/base/random.hpp"
#include "core/reach/cylinder_table.hpp"

namespace jink::reach {
namespace {

Cylinder random_cylinder(Random& random)
{
    Cylinder cylinder;
    cylinder.circle = {Vec2(random.uniform(-300.0F, 300.0F), random.uniform(-300.0F, 300.0F)),
                       random.uniform(0.0F, 60.0F)};
    cylinder.velocity =
        random.below(3) == 0 ? Vec2(Vec2::Zero()) : Vec2(random.uniform(-15.0F, 15.0F), random.uniform(-15.0F, 15.0F));
    cylinder.bottom = random.uniform(0.0F, 80.0F);
    cylinder.top = cylinder.bottom + random.uniform(0.0F, 100.0F);
    cylinder.margin = random.uniform(0.0F, 40.0F);
    return cylinder;
}

/// Where a point is of a cylinder at a time: the definition itself, in double.
enum class Part : std::uint8_t { outside, margin, body };
Part part_at(const Cylinder& cylinder, double x, double y, double z, double t)
{
    const double apart = std::hypot(
        x - static_cast<double>(cylinder.circle.centre.x()) - t * static_cast<double>(cylinder.velocity.x()),
        y - static_cast<double>(cylinder.circle.centre.y()) - t * static_cast<double>(cylinder.velocity.y()));
    if (z < static_cast<double>(cylinder.bottom) || z > static_cast<double>(cylinder.top)) {
        return Part::outside;
    }
    const auto radius = static_cast<double>(cylinder.circle.radius);
    return apart <= radius                                          ? Part::body
           : apart <= radius + static_cast<double>(cylinder.margin) ? Part::margin
                                                                    : Part::outside;
}

TEST(CylinderTableLaws, NothingIsLostInAMerge)
{
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    std::size_t closed = 0;
    for (int i = 0; i < 300; ++i) {
        CylinderTable table;
        const float from = random.uniform(0.0F, 5.0F);
        const float to = from + random.uniform(0.0F, 20.0F);
        table.begin(Vec3(random.uniform(-50.0F, 50.0F), random.uniform(-50.0F, 50.0F), 50.0F), from, to);
        std::vector<Cylinder> all;
        const std::size_t count = kMaxCylinders + random.below(20);
        for (std::size_t n = 0; n < count; ++n) {
            all.push_back(random_cylinder(random));
            ASSERT_EQ(table.add(all.back()), n < kMaxCylinders ? AddStatus::added : AddStatus::constraint_merged);
        }
        ASSERT_EQ(table.merged(), count - kMaxCylinders);
        for (int k = 0; k < 500; ++k) {
            // A point in or about some cylinder at some time.
            const Cylinder& cylinder = all[random.below(all.size())];
            const double t = static_cast<double>(random.uniform(from, to));
            const double angle = static_cast<double>(random.uniform(-kPi, kPi));
            const double away =
                static_cast<double>(random.uniform(0.0F, 1.0F) * (cylinder.circle.radius + cylinder.margin));
            const double x = static_cast<double>(cylinder.circle.centre.x()) +
                             t * static_cast<double>(cylinder.velocity.x()) + away * std::cos(angle);
            const double y = static_cast<double>(cylinder.circle.centre.y()) +
                             t * static_cast<double>(cylinder.velocity.y()) + away * std::sin(angle);
            const double z = static_cast<double>(random.uniform(cylinder.bottom, cylinder.top));
            Part before = Part::outside;
            for (const Cylinder& b : all) {
                before = std::max(before, part_at(b, x, y, z, t));
            }
            Part after = Part::outside;
            for (const Cylinder& b : table.cylinders()) {
                after = std::max(after, part_at(b, x, y, z, t));
            }
            ASSERT_GE(after, before) << "seed " << kSeed << ", case " << i << ", point " << k;
            closed += before == Part::body ? 1U : 0U;
        }
    }
    EXPECT_GT(closed, 50000U);
}

/// A constraint that comes within range at some time is active.
TEST(CylinderTableLaws, WhatComesNearIsActive)
{
    constexpr std::uint64_t kSeed = 9;
    Random random(kSeed);
    int near = 0;
    for (int i = 0; i < 20000; ++i) {
        const Cylinder cylinder = random_cylinder(random);
        const Vec3 vehicle(random.uniform(-200.0F, 200.0F), random.uniform(-200.0F, 200.0F),
                           random.uniform(0.0F, 99.0F));
        const float range = random.uniform(10.0F, 150.0F);
        const float since = random.uniform(0.0F, 30.0F);
        const float horizon = random.uniform(0.0F, 20.0F);
        const float t = since + random.uniform() * horizon;
        const Vec2 apart = cylinder.circle.centre + t * cylinder.velocity - vehicle.head<2>();
        const bool is_near = apart.norm() <= range + cylinder.circle.radius + cylinder.margin - 0.05F &&
                             vehicle.z() + range >= cylinder.bottom && vehicle.z() - range <= cylinder.top;
        if (is_near) {
            ++near;
            ASSERT_TRUE(may_matter(cylinder, vehicle, range, since, horizon)) << "seed " << kSeed << ", case " << i;
        }
    }
    EXPECT_GT(near, 1000);
}

}  // namespace
}  // namespace jink::reach
