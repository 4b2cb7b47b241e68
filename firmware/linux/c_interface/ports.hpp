// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "hal/can_port.hpp"
#include "hal/ring.hpp"
#include "hal/serial_port.hpp"

namespace jink::c_interface {

/// A line whose far end is the caller. Nothing is lost while it is open: what does not fit is not accepted.
///
/// @tparam In, Out  bytes that wait at most, powers of two
template <std::size_t In, std::size_t Out>
class CallersLine final : public hal::SerialPort {
public:
    [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override
    {
        const std::size_t n = in_.pop(into);
        health_.bytes_in += n;
        return n;
    }
    [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override
    {
        const std::size_t n = is_open() ? out_.push(from) : 0;
        health_.bytes_out += n;
        health_.bytes_refused += from.size() - n;
        return n;
    }
    [[nodiscard]] hal::PortHealth health() const noexcept override { return health_; }

    [[nodiscard]] bool is_open() const noexcept { return health_.state == hal::PortState::open; }
    /// @return bytes accepted; 0 while the line is not open
    [[nodiscard]] std::size_t feed(std::span<const std::byte> bytes) noexcept
    {
        return is_open() ? in_.push(bytes) : 0;
    }
    /// Bytes that feed() accepts now.
    [[nodiscard]] std::size_t space() const noexcept { return is_open() ? In - in_.size() : 0; }
    [[nodiscard]] std::size_t take(std::span<std::byte> into) noexcept { return out_.pop(into); }
    void set_open(bool open) noexcept
    {
        if (open != is_open()) {
            ++(open ? health_.reconnects : health_.disconnects);
            health_.state = open ? hal::PortState::open : hal::PortState::lost;
            std::byte gone{};
            while (in_.pop(gone) || out_.pop(gone)) {
            }
        }
    }

private:
    hal::PortHealth health_{hal::PortState::open};
    hal::ByteRing<In> in_;
    hal::ByteRing<Out> out_;
};

/// A CAN controller whose bus is the caller.
class CallersBus final : public hal::CanPort {
public:
    [[nodiscard]] bool receive(hal::CanFrame& frame) noexcept override;
    [[nodiscard]] bool send(const hal::CanFrame& frame) noexcept override;
    [[nodiscard]] hal::CanHealth health() const noexcept override { return health_; }

    /// False where it is full or takes no part in the bus.
    [[nodiscard]] bool feed(const hal::CanFrame& frame) noexcept { return takes_part() && in_.push(frame); }
    [[nodiscard]] bool take(hal::CanFrame& frame) noexcept { return out_.pop(frame); }
    void become(hal::CanState state) noexcept;

private:
    static constexpr std::size_t kFrames = 512;  ///< that wait at most: all that 20 ms of 1 Mbit/s bring, twice

    [[nodiscard]] bool takes_part() const noexcept
    {
        return health_.state == hal::CanState::active || health_.state == hal::CanState::error_passive;
    }

    hal::CanHealth health_{hal::CanState::active};
    hal::Ring<hal::CanFrame, kFrames> in_;
    hal::Ring<hal::CanFrame, kFrames> out_;
};

}  // namespace jink::c_interface
