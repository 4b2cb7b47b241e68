// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "firmware/app/can_bus.hpp"
#include "hal/memory/memory_can_bus.hpp"

namespace jink::sim {

/// The autopilot's end of a line.
class LineEnd {
public:
    virtual ~LineEnd() = default;
    /// Reads received bytes. @return number of bytes
    virtual std::size_t read(std::span<std::byte> into) = 0;
    /// False when the bytes exceed the line's capacity.
    virtual bool write(std::span<const std::byte> bytes) = 0;
};

/// A DroneCAN bus of 1 Mbit/s in memory, the co-processor's node 42 at one end, the autopilot's node 10 at the other,
/// with MAVLink in tunnel.Targetted between them.
class TunnelLine final : public LineEnd {
public:
    static constexpr std::uint8_t kAutopilotNode = 10;
    static constexpr std::uint8_t kOurNode = 42;
    /// Largest queue of telemetry [bytes]: a serial driver's buffer.
    static constexpr std::size_t kWaitingBytes = 4096;

    TunnelLine(hal::Clock& clock, std::uint64_t seed);

    std::size_t read(std::span<std::byte> into) override;
    bool write(std::span<const std::byte> bytes) override;

    [[nodiscard]] app::CanBus& bus() { return bus_; }
    [[nodiscard]] hal::MemoryCanBus& wire() { return wire_; }
    [[nodiscard]] const link::dronecan::Tunnel& peer() const { return peer_tunnel_; }

private:
    void flush();

    hal::Clock& clock_;
    hal::MemoryCanBus wire_;
    app::CanBus bus_;
    link::dronecan::Node peer_;
    link::dronecan::Tunnel peer_tunnel_;
    std::vector<std::byte> waiting_;
};

}  // namespace jink::sim
