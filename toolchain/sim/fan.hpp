// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/app/coprocessor.hpp"
#include "toolchain/sim/record.hpp"

namespace jink::sim {

/// The candidates of the co-processor's latest plan, for plotting; `chosen` names the chosen candidate in words.
[[nodiscard]] std::vector<FanCurve> fan_of(const app::Coprocessor& coprocessor, const app::StepReport& report,
                                           std::string& chosen);

}  // namespace jink::sim
