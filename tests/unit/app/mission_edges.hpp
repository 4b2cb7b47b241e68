// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <functional>
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/app/mission_bench.hpp"

namespace jink::app::test {

class MissionEdges : public ::testing::Test {
protected:
    const std::unique_ptr<Line> owned_ = std::make_unique<Line>();
    Line& line_ = *owned_;
    MissionProtocol& protocol_ = line_.protocol;

    [[nodiscard]] MissionInput input() const { return owned_->protocol.input(owned_->now); }
    [[nodiscard]] bool has(MissionFault fault) const { return (input().faults & bit(fault)) != 0; }
    [[nodiscard]] vehicle::VehicleState own(Seconds age = 0.0F) const
    {
        vehicle::VehicleState state;
        state.stamp = owned_->now - age;
        return state;
    }
    /// Whether an own state is taken after this change.
    bool takes(const std::function<void(vehicle::VehicleState&)>& change)
    {
        line_.now.us += 1000;
        vehicle::VehicleState state = own();
        change(state);
        const MissionDiagnostics before = protocol_.diagnostics();
        protocol_.take_own_state(state, line_.now);
        const MissionDiagnostics& after = protocol_.diagnostics();
        const bool taken = after.states == before.states + 1;
        EXPECT_EQ(after.states + after.refused + after.older, before.states + before.refused + before.older + 1);
        EXPECT_EQ(input().own.stamp == state.stamp, taken);
        return taken;
    }
    bool takes_neighbour(std::uint16_t id, const std::function<void(StateNeighbour&)>& change)
    {
        StateNeighbour state;
        change(state);
        const std::uint32_t before = protocol_.diagnostics().refused;
        line_.send(state, id);
        return protocol_.diagnostics().refused == before;
    }
    [[nodiscard]] bool knows(std::uint16_t id) const
    {
        const auto all = owned_->protocol.neighbours();
        return std::any_of(all.begin(), all.end(), [&](const MissionNeighbour& n) { return n.heard.id == id; });
    }
};

}  // namespace jink::app::test
