// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/stm32/reset_cause.hpp"

namespace jink::hal::stm32h7 {

/// RCC_RSR (ST RM0433, 8.4.4 and 8.7; ST's stm32h743xx.h). Others: window watchdog, and a domain that was to sleep when
/// it must not. The flags of the processor and of the domains (17, 19, 20) come with these and say nothing more; alone
/// they tell of the domains' sleep, which nothing here asks for.
inline constexpr stm32::ResetFlags kResetFlags{0xD0,      1U << 16U, 1U << 21U | 1U << 23U, 1U << 22U,
                                               1U << 24U, 1U << 26U, 1U << 28U | 1U << 30U};

}  // namespace jink::hal::stm32h7
