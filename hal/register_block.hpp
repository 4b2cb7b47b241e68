// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstdint>

namespace jink::hal {

/// The 32-bit registers of one peripheral, by their offset from its base [bytes]. Drivers are templates over it: on the
/// target it is the memory itself and costs nothing; in tests it is a model of the hardware.
template <class T>
concept RegisterBlock = requires(T& block, std::uint32_t offset, std::uint32_t value)
{
    {
        block.read(offset)
        } -> std::same_as<std::uint32_t>;
    block.write(offset, value);
};

/// Raises an interrupt of the driver in software.
template <class T>
concept InterruptWake = requires(T& wake)
{
    wake();
};

}  // namespace jink::hal
