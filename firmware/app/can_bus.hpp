// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/link/dronecan/endpoint.hpp"
#include "firmware/link/dronecan/tunnel.hpp"
#include "firmware/link/sensor_bus.hpp"
#include "hal/can_port.hpp"
#include "hal/serial_port.hpp"

namespace jink::app {

struct CanBusDiagnostics {
    std::uint32_t full_steps = 0;       ///< that ended at kMaxFramesPerStep: what was left came a step later
    std::uint32_t frames_late = 0;      ///< waited in the port while we did not step: of unknown age, dropped
    std::uint32_t frames_foreign = 0;   ///< of CAN FD; refused and counted by the receiver as well
    std::uint32_t stalls = 0;           ///< times the bus took nothing for kStall, and what waited was dropped
    std::uint32_t losses = 0;           ///< times the port was lost with frames waiting, which were dropped
    std::uint32_t near_not_sent = 0;    ///< NearObjects that found other frames waiting
    std::uint32_t tunnel_withheld = 0;  ///< times the tunnel took no byte, because frames waited
    std::uint32_t tunnel_dropped = 0;   ///< bytes that came through the tunnel while it counted as lost
};

/// A CAN controller as a DroneCAN node: the sensor bus of Coprocessor, and a serial port through the bus for MAVLink.
///
/// What is old does not go out:
/// * the tunnel takes bytes only while no frame waits, so that set-points wait in the Link, which takes them back;
/// * NearObjects likewise;
/// * when the controller takes no frame for kStall, or is lost, everything that waits is dropped. What a driver has
///   taken (10 frames in Linux, 19 with bxCAN) is out of our hands;
/// * a controller that is error-passive counts as lost for the tunnel: one whose frames nobody acknowledges is so, and
///   it repeats the same frame until somebody does.
///
/// And what is old is not taken in: when receive() was not called for kStall, everything that waits in the port is
/// dropped, because frames carry no time of arrival. MAVLink inside the tunnel loses as much, and finds it out.
///
/// Memory: sizeof(CanBus), 8.9 KiB. receive() is O(kMaxFramesPerStep), service() O(frames that wait).
class CanBus final : public link::SensorBus {
public:
    /// The shortest frames fill 20 ms of 1 Mbit/s with 267.
    static constexpr std::size_t kMaxFramesPerStep = 512;
    static constexpr Seconds kStall = 0.1F;

    CanBus(hal::CanPort& port, const link::dronecan::NodeOptions& node,
           const link::dronecan::EndpointOptions& options = {},
           const link::dronecan::TunnelOptions& tunnel = {}) noexcept;
    CanBus(const CanBus&) = delete;
    CanBus& operator=(const CanBus&) = delete;

    void receive(TimePoint now, link::Inbox& inbox) noexcept override;
    void service(TimePoint now, const link::BusStatus& status) noexcept override;
    /// The controller is down, off the bus or closed.
    [[nodiscard]] bool is_lost() const noexcept override;
    void follow_origin(const std::optional<link::GlobalPosition>& origin) noexcept override
    {
        endpoint_.follow_origin(origin);
    }
    void serve(link::ParamServer& params) noexcept override { endpoint_.node().serve(params); }
    void send_text(link::Severity severity, std::string_view text) noexcept override
    {
        endpoint_.send_text(severity, text);
    }
    bool send_near(const link::NearObject& object) noexcept override;

    /// The way to the autopilot where there is no serial line: lost when the controller is, and while it is
    /// error-passive. Whether anybody is at the other end shows in the HEARTBEATs alone.
    [[nodiscard]] hal::SerialPort& serial() noexcept { return serial_; }

    [[nodiscard]] link::dronecan::Endpoint& endpoint() noexcept { return endpoint_; }
    [[nodiscard]] const link::dronecan::Endpoint& endpoint() const noexcept { return endpoint_; }
    [[nodiscard]] const link::dronecan::Tunnel& tunnel() const noexcept { return tunnel_; }
    [[nodiscard]] hal::CanHealth health() const noexcept { return port_.health(); }
    [[nodiscard]] const CanBusDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    class Serial final : public hal::SerialPort {
    public:
        explicit Serial(CanBus& bus) noexcept : bus_(bus) {}
        [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override;
        [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override;
        [[nodiscard]] hal::PortHealth health() const noexcept override;
        void note_state() noexcept;

    private:
        CanBus& bus_;
        hal::PortHealth health_;
    };

    void take(const hal::CanFrame& frame, TimePoint now, link::Inbox& inbox) noexcept;
    /// Gives the port what it takes. Frames that nobody took for too long go nowhere.
    void flush() noexcept;

    hal::CanPort& port_;
    link::dronecan::Endpoint endpoint_;
    link::dronecan::Tunnel tunnel_;
    Serial serial_;
    TimePoint now_;
    bool has_received_ = false;
    bool behind_ = false;  ///< the port still holds frames from before
    TimePoint last_receive_;
    TimePoint last_progress_;  ///< no frame waited, or one was taken
    CanBusDiagnostics diagnostics_;
};

}  // namespace jink::app
