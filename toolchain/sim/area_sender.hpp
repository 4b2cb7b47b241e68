// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "firmware/link/constraint.hpp"
#include "firmware/link/mavlink/parser.hpp"
#include "toolchain/sim/closed_area.hpp"
#include "toolchain/sim/frame_writer.hpp"
#include "toolchain/sim/modes.hpp"

namespace jink::sim {

/// The ground station's side of reporting closed areas (docs/guides/closed_areas.md). One set at the start of the
/// flight; each area is repeated until the co-processor answers.
class AreaSender {
public:
    /// @param areas  outlive the sender; kMaxReportedConstraints at most
    explicit AreaSender(const std::vector<ClosedArea>& areas) : areas_(areas), results_(areas.size()) {}

    /// Frames to relay at `now` [us since the start of the flight].
    [[nodiscard]] std::vector<std::byte> send(Micros now);
    /// Bytes from the co-processor.
    void receive(std::span<const std::byte> bytes, Micros now);
    /// The error in words; empty: all areas are in force, or the set is empty.
    [[nodiscard]] std::string fault() const;

private:
    struct Result {
        bool answered = false;
        link::ConstraintResult result = link::ConstraintResult::kept;
    };

    const std::vector<ClosedArea>& areas_;
    std::vector<Result> results_;
    link::mavlink::Parser parser_;
    FrameWriter writer_;
    Micros sent_at_ = -1;
    Micros in_force_at_ = -1;
};

}  // namespace jink::sim
