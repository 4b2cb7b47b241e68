// SPDX-License-Identifier: BSD-3-Clause
// Range scans and readings in Coprocessor::step: positions and expiry of their obstacles, and detection of ground.
#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "firmware/app/near_field.hpp"
#include "firmware/app/range_return.hpp"
#include "tests/unit/app/shown_world.hpp"
#include "tests/unit/app/step_bench.hpp"

namespace jink::app::test {
namespace {

using link::RangeScan;

class StepRanges : public testing::Test {
protected:
    explicit StepRanges(std::initializer_list<std::pair<Param, float>> changes = {}) { fly_to(changes); }
    void fly_to(std::initializer_list<std::pair<Param, float>> changes)
    {
        bench = std::make_unique<StepBench>(changes);
        bench->velocity = Vec3::Zero();
        bench->coprocessor.use_clouds(world);
    }
    [[nodiscard]] RangeScan& scan(std::initializer_list<float> ranges, float yaw_first, float increment)
    {
        bench->wire.in.scans.unchecked_push_back({});
        RangeScan& s = bench->wire.in.scans.back();
        s.stamp = bench->next();
        s.yaw_first = yaw_first;
        s.increment = increment;
        for (const float r : ranges) {
            s.ranges.unchecked_push_back(r);
        }
        return s;
    }
    [[nodiscard]] link::RangeReading& reading(const Vec3& direction, float range, float half_angle = 0.05F)
    {
        bench->wire.in.readings.unchecked_push_back({});
        link::RangeReading& r = bench->wire.in.readings.back();
        r.stamp = bench->next();
        r.direction = direction;
        r.range = range;
        r.half_angle = half_angle;
        return r;
    }
    static Vec3 steep(float sine) { return {std::sqrt(1.0F - sine * sine), 0.0F, sine}; }
    [[nodiscard]] std::span<const world::Obstacle> obstacles() const { return world.table->obstacles(); }
    /// Whether something covers this place, relative to the vehicle of the last step.
    [[nodiscard]] bool covered(const Vec3& place) const
    {
        const Vec3 at = bench->coprocessor.own().position + place;
        return std::any_of(obstacles().begin(), obstacles().end(),
                           [&](const world::Obstacle& o) { return (nearest_point(o.shape, at) - at).norm() < 1e-3F; });
    }
    [[nodiscard]] static Vec3 level(float yaw, float range)
    {
        return {range * std::cos(yaw), range * std::sin(yaw), 0.0F};
    }

    ShownWorld world;
    std::unique_ptr<StepBench> bench;
};

TEST_F(StepRanges, SectorsLieWhereTheScanSaysToEitherSide)
{
    for (const float increment : {0.1F, -0.1F}) {
        SCOPED_TRACE(increment);
        fly_to({{Param::scan_height, 7.0F}});
        static_cast<void>(scan({RangeScan::kUnknown, 20.0F, RangeScan::kNothing, 0.0F}, 0.5F, increment));
        bench->fly(1);
        ASSERT_EQ(obstacles().size(), 2U);
        EXPECT_EQ(bench->counted().scans, 1U);
        const float yaw = 0.5F + increment;
        for (const float aside : {-0.049F, 0.0F, 0.049F}) {
            EXPECT_TRUE(covered(level(yaw + aside, 20.0F)));
            EXPECT_FALSE(covered(level(yaw + aside, 0.95F * 20.0F)));
        }
        EXPECT_FALSE(covered(level(yaw - 0.2F, 20.0F)));
        EXPECT_FALSE(covered(level(yaw + 0.2F, 20.0F)));
        EXPECT_TRUE(covered(level(yaw, 20.5F) + Vec3(0.0F, 0.0F, 6.9F)));
        EXPECT_TRUE(covered(level(yaw, 20.5F) - Vec3(0.0F, 0.0F, 6.9F)));
        EXPECT_TRUE(covered(Vec3::Zero())) << "range 0 is a return as any other";
    }
}

TEST_F(StepRanges, ASectorSeenEmptyGivesItsObstacleUpAndAnUnknownOneKeepsIt)
{
    scan({20.0F, 25.0F, 30.0F}, 0.0F, 0.1F).sensor = 1;
    bench->fly(1);
    scan({20.0F}, 0.0F, 0.1F).sensor = 2;
    bench->fly(1);
    ASSERT_EQ(obstacles().size(), 4U) << "each sensor has its own";
    scan({RangeScan::kNothing, RangeScan::kUnknown, 31.0F}, 0.0F, 0.1F).sensor = 1;
    bench->fly(1);
    EXPECT_EQ(obstacles().size(), 3U);
    EXPECT_TRUE(covered(level(0.1F, 25.1F)));
    EXPECT_FALSE(covered(level(0.2F, 30.0F)));
    EXPECT_TRUE(covered(level(0.2F, 31.0F)));
    EXPECT_TRUE(covered(level(0.0F, 20.1F))) << "what the other one saw";
}

TEST_F(StepRanges, AWideSectorIsCoveredInPartsAndGivenUpInAllOfThem)
{
    constexpr float kWide = kPi / 3.0F;
    static_cast<void>(scan({20.0F, RangeScan::kNothing, 30.0F}, 0.2F, kWide));
    bench->fly(1);
    std::set<world::ObstacleId> ids;
    for (const world::Obstacle& o : obstacles()) {
        ids.insert(o.id);
    }
    EXPECT_EQ(ids.size(), 12U) << "six parts of 10 degrees each";
    for (float aside = -0.51F; aside <= 0.51F; aside += 0.03F) {
        EXPECT_TRUE(covered(level(0.2F + aside, 20.0F))) << aside;
        EXPECT_TRUE(covered(level(0.2F + 2.0F * kWide + aside, 30.0F))) << aside;
        EXPECT_FALSE(covered(level(0.2F + aside, 0.95F * 20.0F))) << aside;
    }
    static_cast<void>(scan({RangeScan::kNothing, 25.0F, RangeScan::kNothing}, 0.2F, kWide));
    bench->fly(1);
    EXPECT_EQ(obstacles().size(), 6U);
    EXPECT_TRUE(covered(level(0.2F + kWide, 25.0F)));
}

TEST_F(StepRanges, ASectorIsHalfACircleAtMost)
{
    static_cast<void>(scan({20.0F}, 0.0F, 5.0F));
    bench->fly(1);
    ASSERT_EQ(obstacles().size(), kMaxReturnParts);
    for (float yaw = -0.5F * kPi + 0.01F; yaw < 0.5F * kPi; yaw += 0.05F) {
        EXPECT_TRUE(covered(level(yaw, 20.0F))) << yaw;
        EXPECT_FALSE(covered(level(yaw + kPi, 20.0F))) << yaw;
    }
}

TEST_F(StepRanges, WhatAScanSawExpires)
{
    fly_to({{Param::scan_keep, 0.5F}});
    scan({20.0F}, 0.0F, 0.1F).stamp = bench->next() - 0.1F;
    static_cast<void>(reading(steep(0.0F), 20.0F));
    bench->wire.in.readings.back().sensor = 3;
    bench->fly(1);
    ASSERT_EQ(obstacles().size(), 2U);
    bench->fly(20);
    EXPECT_EQ(obstacles().size(), 2U) << "0.5 s after its stamp";
    bench->fly(1);
    EXPECT_EQ(obstacles().size(), 1U);
    bench->fly(4);
    EXPECT_EQ(obstacles().size(), 1U);
    bench->fly(1);
    EXPECT_EQ(obstacles().size(), 0U) << "the reading was newer";
}

TEST_F(StepRanges, WithoutAPlaceNothingIsTaken)
{
    static_cast<void>(scan({20.0F}, 0.0F, 0.1F));
    static_cast<void>(reading(steep(0.0F), 20.0F));
    bench->hear_autopilot();
    bench->step();
    EXPECT_TRUE(obstacles().empty());
    EXPECT_EQ(bench->counted().scans, 0U);
    EXPECT_EQ(bench->counted().readings, 0U);
}

TEST_F(StepRanges, ReadingsAreLevelSlantedCeilingOrGroundByTheirSteepness)
{
    const auto kind_of = [&](float sine) {
        fly_to({});
        static_cast<void>(reading(steep(sine), 10.0F));
        bench->fly(1);
        EXPECT_EQ(bench->counted().readings, 1U);
        EXPECT_EQ(bench->counted().readings_refused, 0U);
        EXPECT_LE(obstacles().size(), 1U);
        if (obstacles().empty()) {
            EXPECT_EQ(world.view.floor, bench->coprocessor.own().position.z() + 10.0F * sine + 2.0F) << "above ground";
            return std::string("ground");
        }
        EXPECT_FALSE(covered(9.0F * steep(sine)));
        EXPECT_TRUE(covered(10.01F * steep(sine)));
        switch (obstacles()[0].shape.kind) {
        case geometry::ShapeKind::capsule: return std::string("level");
        case geometry::ShapeKind::sphere: return std::string("slanted");
        default: return std::string("ceiling");
        }
    };
    EXPECT_EQ(kind_of(-1.0F), "ground");
    EXPECT_EQ(kind_of(-0.701F), "ground");
    EXPECT_EQ(kind_of(-0.7F), "slanted");
    EXPECT_EQ(kind_of(-0.021F), "slanted");
    EXPECT_EQ(kind_of(-0.02F), "level");
    EXPECT_EQ(kind_of(0.02F), "level");
    EXPECT_EQ(kind_of(0.021F), "slanted");
    EXPECT_EQ(kind_of(0.98F), "slanted");
    EXPECT_EQ(kind_of(0.981F), "ceiling");
    EXPECT_EQ(kind_of(1.0F), "ceiling");
}

/// An upward sensor on a tilted vehicle. The return may come from every place at the range within the beam.
TEST_F(StepRanges, AnOverheadReadingCoversAllThatItsBeamMayHaveSeen)
{
    for (const float height : {0.5F, 10.0F}) {
        for (const float sine : {0.981F, 0.99F, 1.0F}) {
            for (const float half_angle : {0.0F, 0.05F, 0.3F}) {
                SCOPED_TRACE(testing::Message() << height << ' ' << sine << ' ' << half_angle);
                fly_to({{Param::scan_height, height}});
                static_cast<void>(reading(steep(sine), 30.0F, half_angle));
                bench->fly(1);
                const Vec3 up = steep(sine);
                const Vec3 across = Vec3::UnitY();
                const Vec3 along(-up.z(), 0.0F, up.x());
                for (int i = 0; i < 12; ++i) {
                    const float turn = static_cast<float>(i) * kPi / 6.0F;
                    const Vec3 aside = std::cos(turn) * across + std::sin(turn) * along;
                    EXPECT_TRUE(covered(30.001F * (std::cos(half_angle) * up + std::sin(half_angle) * aside)));
                }
                const float lean = std::acos(sine);
                EXPECT_FALSE(covered(Vec3(0.0F, 0.0F, 30.0F * std::cos(lean + half_angle) - 0.01F)));
                EXPECT_TRUE(covered(Vec3(0.0F, 0.99F * height, 30.1F))) << "as wide as it is high";
                EXPECT_FALSE(covered(Vec3(0.0F, std::max(height, 30.0F * std::sin(lean + half_angle)) + 0.1F, 30.1F)));
            }
        }
    }
}

TEST_F(StepRanges, ADirectionLongerThanOneByRoundingIsStraightUp)
{
    static_cast<void>(reading(Vec3(0.0F, 0.0F, std::nextafter(1.0F, 2.0F)), 30.0F));
    bench->fly(1);
    ASSERT_EQ(obstacles().size(), 1U);
    EXPECT_TRUE(covered(Vec3(0.0F, 0.0F, 30.01F)));
}

TEST_F(StepRanges, ALevelReadingLooksWhereItSaysAndAsWideAsItSays)
{
    static_cast<void>(reading(Vec3(0.6F, -0.8F, 0.0F), 20.0F, 5.0F));
    bench->fly(1);
    const float yaw = std::atan2(-0.8F, 0.6F);
    ASSERT_EQ(obstacles().size(), kMaxReturnParts) << "half a circle at most";
    for (float aside = -0.5F * kPi + 0.01F; aside < 0.5F * kPi; aside += 0.1F) {
        EXPECT_TRUE(covered(level(yaw + aside, 20.0F))) << aside;
        EXPECT_FALSE(covered(level(yaw + aside + kPi, 20.0F))) << aside;
    }
    static_cast<void>(reading(Vec3(0.6F, -0.8F, 0.0F), RangeScan::kNothing, 5.0F));
    bench->fly(1);
    EXPECT_TRUE(obstacles().empty());
}

TEST_F(StepRanges, ASteepReadingThatIsTooWideIsRefused)
{
    static_cast<void>(reading(steep(0.5F), 20.0F, kWidestSteep));
    bench->fly(1);
    EXPECT_EQ(obstacles().size(), 1U);
    EXPECT_EQ(bench->counted().readings_refused, 0U);
    for (const float sine : {-0.5F, 0.5F, 1.0F}) {
        fly_to({});
        static_cast<void>(reading(steep(sine), 20.0F, kWidestSteep + 0.001F));
        bench->fly(1);
        EXPECT_TRUE(obstacles().empty());
        EXPECT_EQ(bench->counted().readings_refused, 1U);
    }
    fly_to({});
    static_cast<void>(reading(steep(-1.0F), 20.0F, 2.0F));
    bench->fly(1);
    EXPECT_EQ(bench->counted().readings_refused, 0U) << "the ground is below, however wide the beam";
    EXPECT_EQ(world.view.floor, 50.0F - 20.0F + 2.0F);
}

TEST_F(StepRanges, EachReadingSensorHasItsOwn)
{
    reading(steep(0.0F), 20.0F, 0.5F).sensor = 1;
    reading(Vec3(0.0F, 1.0F, 0.0F), 20.0F, 0.5F).sensor = 2;
    reading(steep(0.5F), 20.0F).sensor = 3;
    reading(steep(1.0F), 20.0F).sensor = 4;
    bench->fly(1);
    EXPECT_EQ(obstacles().size(), 14U) << "two of six parts";
    reading(steep(0.0F), RangeScan::kNothing, 0.5F).sensor = 1;
    reading(steep(0.5F), RangeScan::kNothing).sensor = 3;
    bench->fly(1);
    EXPECT_EQ(obstacles().size(), 7U);
    EXPECT_TRUE(covered(Vec3(0.0F, 20.0F, 0.0F)));
    EXPECT_TRUE(covered(Vec3(0.0F, 0.0F, 20.0F)));
    reading(steep(1.0F), RangeScan::kNothing).sensor = 4;
    bench->fly(1);
    EXPECT_EQ(obstacles().size(), 6U);
}

TEST_F(StepRanges, TheFloorIsTheHigherOfHomesAndTheGrounds)
{
    fly_to({{Param::floor, 3.0F}, {Param::scan_keep, 0.5F}});
    bench->wire.in.has_home = true;
    bench->wire.in.home = Vec3(0.0F, 0.0F, 7.0F);
    bench->fly(1);
    EXPECT_TRUE(world.view.has_floor);
    EXPECT_EQ(world.view.floor, 10.0F) << "above home";
    static_cast<void>(reading(steep(-1.0F), 42.0F));
    bench->fly(1);
    EXPECT_EQ(world.view.floor, 11.0F) << "8 m of ground, 3 m above it";
    static_cast<void>(reading(steep(-1.0F), 44.0F));
    bench->fly(1);
    EXPECT_EQ(world.view.floor, 10.0F) << "a valley";
    static_cast<void>(reading(steep(-1.0F), 30.0F));
    bench->fly(1);
    EXPECT_EQ(world.view.floor, 23.0F);
    bench->fly(25);
    EXPECT_EQ(world.view.floor, 23.0F) << "half a second after it was seen";
    bench->fly(1);
    EXPECT_EQ(world.view.floor, 10.0F);
    static_cast<void>(reading(steep(-1.0F), 30.0F));
    bench->fly(1);
    static_cast<void>(reading(steep(-1.0F), RangeScan::kNothing));
    bench->fly(1);
    EXPECT_EQ(world.view.floor, 10.0F) << "out of its reach";
}

TEST_F(StepRanges, AFloorBelowHomeIsNoneBelowTheGround)
{
    fly_to({{Param::floor, -20.0F}});
    static_cast<void>(reading(steep(-1.0F), 45.0F));
    bench->fly(1);
    EXPECT_EQ(world.view.floor, 5.0F);
}

TEST_F(StepRanges, TheGroundBoundsWithoutAnAutopilotToo)
{
    const auto look = [&](std::initializer_list<std::pair<Param, float>> changes, bool sees) {
        fly_to(changes);
        bench->hear_own();
        if (sees) {
            static_cast<void>(reading(steep(-1.0F), 40.0F));
        }
        bench->step();
        return world.view.has_floor;
    };
    EXPECT_FALSE(look({{Param::floor, 30.0F}}, false)) << "no home it could refer to";
    EXPECT_TRUE(look({{Param::floor, 30.0F}}, true));
    EXPECT_EQ(world.view.floor, 40.0F) << "10 m of ground and 30 above it, whatever home would be";
    EXPECT_FALSE(look({{Param::bounds, 6.0F}}, true));
    fly_to({{Param::floor, 30.0F}});
    bench->hear_own();
    static_cast<void>(reading(steep(-1.0F), 70.0F));
    bench->step();
    EXPECT_EQ(world.view.floor, 10.0F) << "ground at -20 m";
}

TEST_F(StepRanges, TheFloorIsOnWhereTheParameterSaysSo)
{
    for (int bounds = 0; bounds < 8; ++bounds) {
        fly_to({{Param::bounds, static_cast<float>(bounds)}});
        bench->fly(1);
        EXPECT_EQ(world.view.has_floor, (bounds & 1) != 0) << bounds;
        static_cast<void>(reading(steep(-1.0F), 10.0F));
        bench->fly(1);
        EXPECT_EQ(world.view.has_floor, (bounds & 1) != 0) << bounds;
    }
}

TEST_F(StepRanges, AJumpOfTheFrameForgetsTheGround)
{
    static_cast<void>(reading(steep(-1.0F), 30.0F));
    bench->fly(1);
    ASSERT_EQ(world.view.floor, 22.0F);
    bench->hear_own().estimator_reset = true;
    bench->step();
    EXPECT_EQ(world.view.floor, 2.0F);
}

}  // namespace
}  // namespace jink::app::test
