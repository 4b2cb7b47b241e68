// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace jink {

/// Finite and above zero: what a length, a speed or a limit has to be.
[[nodiscard]] inline bool is_positive(float value) noexcept { return std::isfinite(value) && value > 0.0F; }

/// Finite and not below zero: what a margin, a weight or a rate has to be.
[[nodiscard]] inline bool is_not_negative(float value) noexcept { return std::isfinite(value) && value >= 0.0F; }

}  // namespace jink
