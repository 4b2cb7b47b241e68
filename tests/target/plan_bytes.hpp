// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <new>

#include "firmware/app/plan_memory.hpp"

namespace jink::target {

/// The memory that an image has for its plans, as at a start. What was made in it before is gone.
inline app::PlanMemory& fresh_plan_memory() noexcept
{
#ifdef __linux__
    alignas(app::PlanMemory) static std::byte bytes[sizeof(app::PlanMemory)];
#else
    alignas(app::PlanMemory) __attribute__((section(".plan_emulated"))) static std::byte bytes[sizeof(app::PlanMemory)];
#endif
    return *new (bytes) app::PlanMemory;
}

}  // namespace jink::target
