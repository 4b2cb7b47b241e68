// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/orca/planner.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::orca::test {

using world::PlanStatus;
using world::test::Scene;

/// A static vehicle at (0, 0, 30) with an eastward preferred velocity of 5 m/s. Its box is 2 m wide: its cylinder has a
/// half width of 1.414 m and a half height of 1 m.
class OrcaInput : public ::testing::Test {
protected:
    static constexpr float kHalfWidth = 1.41421356F;
    static constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();

    OrcaInput()
    {
        scene.own.position = Vec3(0, 0, 30);
        scene.own.stamp = scene.now;
        towards(Vec3(1, 0, 0));
    }
    void towards(const Vec3& direction, float speed = 5.0F)
    {
        scene.leg(scene.own.position, scene.own.position + 300.0F * direction, speed);
    }
    PlanStatus plan(std::uint32_t units = world::test::kPlenty)
    {
        WorkBudget budget(units);
        out = {};
        const PlanStatus status = planner.plan(scene.situation(), budget, out);
        spent = budget.spent();
        return status;
    }
    /// The first command of a new planner.
    Vec3 command()
    {
        planner = Planner(settings);
        EXPECT_EQ(plan(), PlanStatus::found);
        return out.command;
    }
    /// Least distance of a pair, relative to its conflict region: sqrt(2) of both half widths.
    float nearest()
    {
        static_cast<void>(command());
        return planner.last().nearest;
    }
    void step(Seconds dt)
    {
        scene.now = scene.now + dt;
        scene.own.stamp = scene.now;
    }

    Settings settings;
    Planner planner;
    Scene scene;
    world::Manoeuvre out;
    std::uint32_t spent = 0;
};

}  // namespace jink::orca::test
