// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/app/coprocessor.hpp"
#include "toolchain/sim/record.hpp"

namespace jink::sim {

/// The candidates of the plan that the co-processor has just made, for a picture; `chosen` says which one it took, in
/// words.
[[nodiscard]] std::vector<FanCurve> fan_of(const app::Coprocessor& coprocessor, const app::StepReport& report,
                                           std::string& chosen);

}  // namespace jink::sim
