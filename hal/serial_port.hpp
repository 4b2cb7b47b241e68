// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "hal/port_health.hpp"

namespace jink::hal {

/// A stream of bytes in both directions.
///
/// Nothing here blocks, throws or keeps a pointer to the caller's memory. A port that is not open reads nothing and
/// accepts nothing; `health()` counts all losses.
class SerialPort {
public:
    /// Fills `into` from its start with the bytes that have arrived, oldest first.
    /// @return number of bytes; 0 if there are none. O(into.size()).
    [[nodiscard]] virtual std::size_t read(std::span<std::byte> into) noexcept = 0;

    /// Accepts as many bytes from the start of `from` as fit now; the caller keeps or drops the rest.
    /// @return number of bytes accepted, 0 .. from.size(). O(from.size()).
    [[nodiscard]] virtual std::size_t write(std::span<const std::byte> from) noexcept = 0;

    [[nodiscard]] virtual PortHealth health() const noexcept = 0;

protected:
    ~SerialPort() = default;
};

}  // namespace jink::hal
