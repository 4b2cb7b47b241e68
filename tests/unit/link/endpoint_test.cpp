// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <gtest/gtest.h>

#include "tests/numbers.hpp"
#include "tests/unit/link/endpoint_tools.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

TEST(Endpoint, LearnsItsSystemFromTheFirstAutopilotAndListensToThatOne)
{
    Wire wire;
    wire.hear(local_position(wire.boot_ms(), Vec3(1, 2, 3)));
    EXPECT_EQ(wire.diagnostics().frames_ignored, 1U) << "nobody is known yet";
    wire.hear(heartbeat(0, false, 8), 255, 190);  // a ground station
    EXPECT_EQ(wire.endpoint.system_id(), 0);
    wire.hear(heartbeat(), kSystem, 191);  // a companion
    EXPECT_EQ(wire.endpoint.system_id(), 0);
    wire.hear(heartbeat());
    EXPECT_EQ(wire.endpoint.system_id(), kSystem);
    wire.inbox.clear();
    wire.hear(heartbeat(kCopterGuided), 8);
    wire.hear(local_position(wire.boot_ms(), Vec3(1, 2, 3)), 8);
    EXPECT_FALSE(wire.inbox.has_autopilot);
    EXPECT_FALSE(wire.inbox.has_own_state);
    wire.hear(local_position(wire.boot_ms(), Vec3(1, 2, 3), Vec3(4, 5, 6)));
    ASSERT_TRUE(wire.inbox.has_own_state);
    EXPECT_EQ(wire.inbox.own_state.state.position, Vec3(1, 2, 3));
    EXPECT_EQ(wire.inbox.own_state.state.velocity, Vec3(4, 5, 6));
    EXPECT_EQ(wire.inbox.own_state.state.stamp, wire.now);
}

TEST(Endpoint, RefusesOwnStateThatIsNotANumberOrAbsurd)
{
    for (const float bad : {kNan, kInfinity, -kInfinity, 1e30F, 3e5F}) {
        for (int field = 0; field < 6; ++field) {
            Wire wire;
            wire.hear(heartbeat());
            LocalPositionNed m = local_position(wire.boot_ms(), Vec3::Ones(), Vec3::Ones());
            float* const fields[] = {&m.x, &m.y, &m.z, &m.vx, &m.vy, &m.vz};
            *fields[field] = bad;
            wire.hear(m);
            EXPECT_FALSE(wire.inbox.has_own_state) << bad << " in field " << field;
            EXPECT_EQ(wire.diagnostics().not_finite, std::isfinite(bad) ? 0U : 1U);
            EXPECT_EQ(wire.diagnostics().out_of_range, std::isfinite(bad) ? 1U : 0U);
        }
    }
}

}  // namespace
}  // namespace jink::link::mavlink
