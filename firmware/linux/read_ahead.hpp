// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "hal/can_port.hpp"
#include "hal/serial_port.hpp"

namespace jink::host {

/// Sits between a serial device and a reader that reads once per step: pump() reads the device, read() returns the
/// bytes of the last pump() and nothing newer.
///
/// For the autopilot's line: pump(), then the clock, then the step. So no byte of the step is newer than its clock,
/// whatever delays the thread in between: a stamp that seems to come from the future would mislead the clock mapping.
/// For point clouds: a Linux terminal holds 4096 bytes for its reader, and a cloud brings thirty times as many in 20
/// ms, so pump() is called more often than once per step.
///
/// Bytes that do not fit stay with the driver, which discards them when its buffer is full: the receiver misses those
/// frames, and counts them. Memory: `room`, once.
class ReadAhead final : public hal::SerialPort {
public:
    /// A scan of 10^5 points, 630 024 bytes, and the bytes that four steps may read.
    static constexpr std::size_t kCloudRoom = 640U * 1024U;

    /// @param device  outlives this
    /// @param room    capacity for waiting bytes, > 0
    ReadAhead(hal::SerialPort& device, std::size_t room) : device_(device), bytes_(room) {}

    /// Reads as many bytes as fit. O(bytes), and at times O(room) to make space in one piece.
    void pump() noexcept;

    [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override;
    [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override { return device_.write(from); }
    /// The device's, but bytes that wait here are not counted yet: `bytes_in` is what read() returned.
    [[nodiscard]] hal::PortHealth health() const noexcept override;

private:
    hal::SerialPort& device_;
    std::vector<std::byte> bytes_;
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
};

/// The same for a CAN controller, whose bus may carry the autopilot's line. Memory: 76 bytes for each of `room`, once.
class CanReadAhead final : public hal::CanPort {
public:
    CanReadAhead(hal::CanPort& device, std::size_t room) : device_(device), frames_(room) {}

    /// Reads as many frames as fit. O(room).
    void pump() noexcept;

    [[nodiscard]] bool receive(hal::CanFrame& frame) noexcept override;
    [[nodiscard]] bool send(const hal::CanFrame& frame) noexcept override { return device_.send(frame); }
    /// The device's, but frames that wait here are not counted yet.
    [[nodiscard]] hal::CanHealth health() const noexcept override;

private:
    hal::CanPort& device_;
    std::vector<hal::CanFrame> frames_;
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
};

}  // namespace jink::host
