// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/stm32/reset_cause.hpp"

namespace jink::hal::stm32f4 {

/// RCC_CSR (ST RM0090, 7.3.21). Others: window watchdog, low power.
inline constexpr stm32::ResetFlags kResetFlags{0x74,      1U << 24U, 1U << 25U | 1U << 27U, 1U << 26U, 1U << 28U,
                                               1U << 29U, 3U << 30U};

}  // namespace jink::hal::stm32f4
