// SPDX-License-Identifier: BSD-3-Clause
// Smoothing in the filter's loop (G-ORCA specification, section 12): the output satisfies all hard constraints, and has
// the documented delay.
#include <gtest/gtest.h>

#include "core/orca/obstacle_way.hpp"
#include "tests/property/core/geometry/oracle.hpp"
#include "tests/property/core/orca/closed_loop_report.hpp"
#include "tests/property/core/orca/random_tick.hpp"

namespace jink::orca {
namespace {

using namespace closed_loop;

/// Checks every command of a flight: slew and speed, obstacles and conflict regions, recomputed from the inputs.
class HardLevels {
public:
    explicit HardLevels(std::size_t vehicles) : last_(vehicles, Vec3::Zero()) {}

    void watch(const Watched& tick)
    {
        random_tick::Seen seen;
        seen.settings = tick.filter.settings();
        seen.input = tick.input;
        seen.neighbours.assign(tick.input.neighbours.begin(), tick.input.neighbours.end());
        const std::uint32_t status = tick.decision.status;
        const ObstacleSettings& kept = seen.settings.obstacles;
        WorkBudget budget(1'000'000);
        const WayClearance way = clearance_along(tick.input.obstacles, tick.input.own.position, tick.decision.command,
                                                 kept.horizon, kept, budget);
        ASSERT_EQ(tick.decision.clear_until, way.clear_until);
        ASSERT_EQ((status & kObstacleAhead) == 0, way.clear);
        const bool newest = (status & kNotSmoothed) != 0;
        not_smoothed_ += newest ? 1U : 0U;
        ++ticks_;
        if (!newest) {
            ASSERT_TRUE(random_tick::is_flyable(tick.decision, seen.settings.limits, last_[tick.vehicle]));
        }
        last_[tick.vehicle] = tick.decision.command;
        if ((status & (kRelaxedObstacle | kRelaxedConflict)) != 0) {
            return;
        }
        OwnMotion own;
        own.position = tick.input.own.position;
        own.velocity = tick.input.own.velocity;
        own.reach_speed = seen.settings.limits.max_speed;
        for (const HalfSpace& plane : obstacle_planes(tick.input.obstacles, own, kept, budget).planes) {
            check(plane, tick.decision.command);
        }
        // The conflict half-spaces alone: warnings may be broken by the mean.
        for (const HalfSpace& plane : random_tick::planes_of(seen)) {
            if (plane.level == Level::conflict) {
                check(plane, tick.decision.command);
            }
        }
    }
    [[nodiscard]] std::size_t ticks() const { return ticks_; }
    [[nodiscard]] std::size_t not_smoothed() const { return not_smoothed_; }
    [[nodiscard]] std::size_t tight() const { return tight_; }

private:
    void check(const HalfSpace& plane, const Vec3& command)
    {
        // Obstacles that the filter leaves out as implied hold to 1e-5.
        const float by = plane.violation(command);
        ASSERT_LE(by, 2e-5F) << "level " << static_cast<int>(plane.level);
        tight_ += by > -1e-3F ? 1U : 0U;
    }
    std::vector<Vec3> last_;
    std::size_t ticks_ = 0;
    std::size_t not_smoothed_ = 0;
    std::size_t tight_ = 0;
};

void fly_watched(const char* name, Scene scene)
{
    HardLevels levels(scene.agents.size());
    scene.watch = [&](const Watched& tick) { levels.watch(tick); };
    const Outcome o = fly(name, scene);
    std::printf("[ measured ] %s: %zu of %zu commands not smoothed, %zu hard half-spaces held the command\n", name,
                levels.not_smoothed(), levels.ticks(), levels.tight());
    EXPECT_GT(o.time, 0.0) << name;
    EXPECT_GT(levels.tight(), levels.ticks() / 100) << name;
    EXPECT_LT(levels.not_smoothed(), levels.ticks() / 20) << name;
}

TEST(SmoothingLoop, CommandsKeepToAllThatIsHard)
{
    Scene scene;
    scene.settings = testbed_settings();
    scene.settings.smoothing = CommandFilter::kFlown;
    scene.settings.delay = 0.175F;
    scene.settings.pair.ramp_speed = 0.3F;
    scene.agents = on_a_circle(8, 4.0, 1.5);
    scene.bodies = {{Vec3d(0, -1, 1.0), Vec3d(2, 0, 0), 0.15}, {Vec3d(0, 1, 1.8), Vec3d(2, 0, 0), 0.15}};
    fly_watched("8 among pipes", scene);
    // Conflict half-spaces that hold more often.
    scene.settings.pair.conflict = Conflict::at_rest;
    scene.settings.pair.brake = 0.75F;
    fly_watched("8 among pipes, about rest", scene);
    scene.bodies.clear();
    scene.agents = on_a_circle(16, 5.0, 1.5);
    scene.until = 90.0;
    fly_watched("16 on a circle, about rest", scene);
}

/// (N - 1) / 3 periods, which settings.delay must include.
TEST(SmoothingLoop, ASlowChangeComesAsLateAsIsSaid)
{
    for (const std::size_t length : {2U, 10U, 32U}) {
        FilterSettings settings;
        settings.smoothing = length;
        settings.delay = 0.3F;
        VelocityFilter filter(settings);
        FilterInput input;
        constexpr float kSlope = 0.2F;  // [m/s2], of the 2 that it may
        float late = 0.0F;
        for (int i = 1; i < 200; ++i) {
            const float wanted = kSlope * 0.025F * static_cast<float>(i);
            input.preferred = {wanted, 0, 0};
            WorkBudget budget(10'000);
            const Decision decision = filter.decide(input, budget);
            ASSERT_EQ(decision.status, 0U);
            ASSERT_TRUE(filter.issued({25'000 * i}, decision.command));
            input.own.velocity = decision.command;
            late = (wanted - decision.command.x()) / kSlope;
        }
        EXPECT_NEAR(late, CommandFilter(length).delay(0.025F), 1e-4F) << length;
    }
}

}  // namespace
}  // namespace jink::orca
