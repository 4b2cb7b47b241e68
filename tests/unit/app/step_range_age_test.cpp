// SPDX-License-Identifier: BSD-3-Clause
// A range is measured from where the vehicle was then, not from where it is when the report arrives.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/app/shown_world.hpp"
#include "tests/unit/app/step_bench.hpp"

namespace jink::app::test {
namespace {

/// At 10 m/s along x, at x = 0 when the report arrives; own states come in each step, stamped `own_age` before.
class StepRangeAge : public testing::TestWithParam<std::pair<Seconds, Seconds>> {
protected:
    StepRangeAge()
    {
        bench.coprocessor.use_clouds(shown);
        bench.hear_autopilot();
        step(-0.04F);
        step(-0.02F);
    }
    void step(Seconds time)
    {
        link::OwnStateReport& own = bench.hear_own(own_age());
        own.state.position = Vec3(kSpeed * (time - own_age()), 0.0F, 30.0F);
        own.state.velocity = Vec3(kSpeed, 0.0F, 0.0F);
        bench.step();
    }
    [[nodiscard]] static Seconds latency() { return GetParam().first; }
    [[nodiscard]] static Seconds own_age() { return GetParam().second; }
    /// Least x of all obstacles on the way.
    [[nodiscard]] float nearest() const
    {
        float least = 1e9F;
        for (const world::Obstacle& o : shown.table->obstacles()) {
            least = std::min(least, nearest_point(o.shape, Vec3(-100.0F, 0.0F, 30.0F)).x());
        }
        return least;
    }

    static constexpr float kSpeed = 10.0F;
    static constexpr float kRange = 20.0F;
    ShownWorld shown;
    StepBench bench{{Param::scan_latency, latency()}, {Param::floor, 3.0F}, {Param::bounds, 1.0F}};
};

TEST_P(StepRangeAge, AScanOfAWall)
{
    link::RangeScan scan;
    scan.stamp = bench.next();
    scan.yaw_first = 0.0F;
    scan.increment = 0.02F;
    scan.ranges.unchecked_push_back(kRange);
    bench.wire.in.scans.unchecked_push_back(scan);
    step(0.0F);
    const float wall = kRange - kSpeed * latency();
    EXPECT_LE(nearest(), wall);
    EXPECT_GT(nearest(), wall - 0.01F * kRange);
}

TEST_P(StepRangeAge, AReadingAhead)
{
    link::RangeReading ahead;
    ahead.stamp = bench.next();
    ahead.direction = Vec3::UnitX();
    ahead.range = kRange;
    ahead.half_angle = 0.01F;
    bench.wire.in.readings.unchecked_push_back(ahead);
    step(0.0F);
    const float wall = kRange - kSpeed * latency();
    EXPECT_LE(nearest(), wall + 1e-3F);
    EXPECT_GT(nearest(), wall - 0.01F * kRange);
}

TEST_P(StepRangeAge, TheGroundUnderAVehicleThatSinks)
{
    link::OwnStateReport& own = bench.hear_own(own_age());
    own.state.position = Vec3(0.0F, 0.0F, 30.0F + 2.0F * own_age());
    own.state.velocity = Vec3(0.0F, 0.0F, -2.0F);
    link::RangeReading down;
    down.stamp = bench.next();
    down.direction = -Vec3::UnitZ();
    down.range = 12.0F;
    bench.wire.in.readings.unchecked_push_back(down);
    bench.step();
    EXPECT_NEAR(shown.view.floor, 30.0F + 2.0F * latency() - 12.0F + 3.0F, 1e-3F);
}

/// A LiDAR of 40 m and a sonar of 5 m look down: the ground that one sees is not what the other one does not see.
TEST(StepGround, OfTwoSensorsThatLookDownTheHighestCounts)
{
    ShownWorld shown;
    StepBench bench{{Param::floor, 3.0F}, {Param::bounds, 1.0F}};
    bench.coprocessor.use_clouds(shown);
    bench.hear_autopilot();
    const auto floor_after = [&](std::uint8_t sensor, float range, float reach) {
        link::OwnStateReport& own = bench.hear_own(0.0F);
        own.state.position = Vec3(0.0F, 0.0F, 30.0F);
        own.state.velocity = Vec3::Zero();
        link::RangeReading down;
        down.stamp = bench.next();
        down.direction = -Vec3::UnitZ();
        down.range = range;
        down.max_range = reach;
        down.sensor = sensor;
        bench.wire.in.readings.unchecked_push_back(down);
        bench.step();
        return shown.view.floor;
    };
    constexpr float kNothing = link::RangeScan::kNothing;
    EXPECT_NEAR(floor_after(0, 12.0F, 40.0F), 21.0F, 0.01F);
    EXPECT_NEAR(floor_after(1, kNothing, 5.0F), 21.0F, 0.01F) << "beyond its reach";
    EXPECT_NEAR(floor_after(1, 4.0F, 5.0F), 29.0F, 0.01F) << "a tree";
    EXPECT_NEAR(floor_after(0, 12.0F, 40.0F), 29.0F, 0.01F);
    EXPECT_NEAR(floor_after(0, kNothing, 40.0F), 3.0F, 0.01F) << "it would have seen that";
    EXPECT_NEAR(floor_after(0, 12.0F, 40.0F), 21.0F, 0.01F);
    EXPECT_NEAR(floor_after(0, 14.0F, 40.0F), 19.0F, 0.01F) << "its own newest counts";
    EXPECT_NEAR(floor_after(0, kNothing, 40.0F), 3.0F, 0.01F);
}

INSTANTIATE_TEST_SUITE_P(Of, StepRangeAge,
                         testing::Values(std::pair{0.0F, 0.0F}, std::pair{0.0F, 0.1F}, std::pair{0.1F, 0.0F},
                                         std::pair{0.25F, 0.04F}, std::pair{0.4F, 0.1F}),
                         [](const testing::TestParamInfo<std::pair<Seconds, Seconds>>& tested) {
                             return std::to_string(std::lround(tested.param.first * 1e3F)) + "msOwn" +
                                    std::to_string(std::lround(tested.param.second * 1e3F)) + "ms";
                         });

}  // namespace
}  // namespace jink::app::test
