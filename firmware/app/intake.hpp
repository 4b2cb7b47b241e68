// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/app/diagnostics.hpp"
#include "firmware/link/link.hpp"
#include "firmware/link/sensor_bus.hpp"
#include "hal/serial_port.hpp"

namespace jink::app {

/// What became of the frame that the bus places its reports in.
enum class FrameChange : std::uint8_t {
    none,
    moved,  ///< another origin: own state of the bus no longer holds
    begun,  ///< likewise, and from the bus's own frame to the autopilot's: no place known before holds
};

/// The way in: bytes of the port and frames of the bus, decoded into the inbox of one step, all in one frame of
/// reference.
///
/// Memory: the inbox and kMaxBytesPerStep. read() is O(bytes).
class Intake {
public:
    /// Bytes read per step; 921600 baud bring 1843 in 20 ms.
    static constexpr std::size_t kMaxBytesPerStep = 4096;

    /// @param bus  may be null
    Intake(link::Link& link, hal::SerialPort& port, link::SensorBus* bus, Diagnostics& counts) noexcept
        : link_(link), port_(port), bus_(bus), counts_(counts)
    {
    }

    /// Reads the bus, then the port: the link's bytes may come through the bus.
    /// @return bytes of the port
    std::uint32_t read(TimePoint now) noexcept;
    /// One frame for both: the autopilot's as soon as an autopilot was heard. Reports of the bus that were placed
    /// before the frame changed are dropped. Geometric heights of the bus cover both readings, as those of the link do.
    [[nodiscard]] FrameChange settle_frame(bool has_autopilot) noexcept;
    /// At the end of a step.
    void clear() noexcept { inbox_.clear(); }

    [[nodiscard]] const link::Inbox& inbox() const noexcept { return inbox_; }
    [[nodiscard]] bool is_port_open() const noexcept { return port_.health().state == hal::PortState::open; }
    /// False without a bus.
    [[nodiscard]] bool is_bus_lost() const noexcept { return bus_ != nullptr && bus_->is_lost(); }
    /// Since start, in any step.
    [[nodiscard]] bool was_bus_up() const noexcept { return was_bus_up_; }

private:
    void drop_bus_reports() noexcept;

    link::Link& link_;
    hal::SerialPort& port_;
    link::SensorBus* bus_;
    Diagnostics& counts_;
    link::Inbox inbox_;
    std::size_t bus_tracks_ = 0;  ///< the inbox's first tracks: from the bus
    std::array<std::byte, kMaxBytesPerStep> bytes_{};
    bool was_bus_up_ = false;
    bool follows_origin_ = false;
    std::optional<link::GlobalPosition> origin_;  ///< that the bus follows
};

}  // namespace jink::app
