// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "hal/serial_port.hpp"

namespace jink::host {

/// Stands between a serial device and who reads it once per step. A terminal of Linux holds 4096 bytes for its reader,
/// and a point cloud brings thirty times as many in 20 ms: pump() is called more often than that and keeps them here.
///
/// What finds no room stays with the driver, which throws it away when it must: the receiver misses those frames, and
/// counts them. Memory: kRoom, once.
class CloudLine final : public hal::SerialPort {
public:
    /// A scan of 10^5 points, 630 024 bytes, and what four steps may read.
    static constexpr std::size_t kRoom = 640U * 1024U;

    /// @param device  outlives this
    explicit CloudLine(hal::SerialPort& device) : device_(device), bytes_(kRoom) {}

    /// Takes what has come and has room. O(bytes), and at times O(kRoom) to make room in one piece.
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

}  // namespace jink::host
