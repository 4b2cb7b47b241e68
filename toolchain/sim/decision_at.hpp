// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "firmware/app/coprocessor.hpp"
#include "toolchain/sim/record.hpp"

namespace jink::sim {

/// As in run.json: "available", "chosen", "hits_static", ...
[[nodiscard]] std::string_view status_name(geometric::CandidateStatus status) noexcept;

/// The chosen candidate of the geometric planner's last plan in words; empty: none was chosen.
[[nodiscard]] std::string chosen_candidate(const app::Coprocessor& coprocessor);

/// What was decided in the step of this report, at `time` of the flight [s].
[[nodiscard]] DecisionAt decision_at(const app::Coprocessor& coprocessor, const app::StepReport& report, double time);

}  // namespace jink::sim
