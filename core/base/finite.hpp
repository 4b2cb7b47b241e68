// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace jink {

/// Finite and above zero: the requirement on a length, a speed or a limit.
[[nodiscard]] inline bool is_positive(float value) noexcept { return std::isfinite(value) && value > 0.0F; }

/// Finite and not below zero: the requirement on a margin, a weight or a rate.
[[nodiscard]] inline bool is_not_negative(float value) noexcept { return std::isfinite(value) && value >= 0.0F; }

}  // namespace jink
