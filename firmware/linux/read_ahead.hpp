// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "hal/can_port.hpp"
#include "hal/serial_port.hpp"

namespace jink::host {

/// Stands between a serial device and who reads it once per step: pump() reads the device, read() hands out what pump()
/// has taken and nothing newer.
///
/// For the autopilot's line: pump(), then the clock, then the step. Whatever holds the thread up between those, no byte
/// of the step is newer than its clock: a stamp that seems to come from the future would mislead the map of clocks.
/// For point clouds: a terminal of Linux holds 4096 bytes for its reader, and a cloud brings thirty times as many in
/// 20 ms, so pump() is called more often than once per step.
///
/// What finds no room stays with the driver, which throws it away when it must: the receiver misses those frames, and
/// counts them. Memory: `room`, once.
class ReadAhead final : public hal::SerialPort {
public:
    /// A scan of 10^5 points, 630 024 bytes, and what four steps may read.
    static constexpr std::size_t kCloudRoom = 640U * 1024U;

    /// @param device  outlives this
    /// @param room    bytes that wait at most, > 0
    ReadAhead(hal::SerialPort& device, std::size_t room) : device_(device), bytes_(room) {}

    /// Takes what has come and has room. O(bytes), and at times O(room) to make room in one piece.
    void pump() noexcept;

    [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override;
    [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override { return device_.write(from); }
    [[nodiscard]] hal::PortHealth health() const noexcept override { return device_.health(); }

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

    /// Takes what has come and has room. O(room).
    void pump() noexcept;

    [[nodiscard]] bool receive(hal::CanFrame& frame) noexcept override;
    [[nodiscard]] bool send(const hal::CanFrame& frame) noexcept override { return device_.send(frame); }
    [[nodiscard]] hal::CanHealth health() const noexcept override { return device_.health(); }

private:
    hal::CanPort& device_;
    std::vector<hal::CanFrame> frames_;
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
};

}  // namespace jink::host
