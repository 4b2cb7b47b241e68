// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

#include "firmware/link/link.hpp"
#include "firmware/link/param_server.hpp"

namespace jink::link {

/// A near object, relative to the vehicle.
struct NearObject {
    float yaw = 0.0F;       ///< clockwise from the nose [rad], -pi .. pi
    float pitch = 0.0F;     ///< upwards from the horizon [rad]
    float distance = 0.0F;  ///< to its nearest surface [m], > 0
};

/// A second source of reports beside the autopilot's link: sensors, traffic receivers and listeners on a bus. It
/// carries no set-points and no modes.
///
/// Nothing here blocks or allocates; the implementation counts all losses.
///
/// Frame: positions are in a frame of the bus's own (about its first fix) until `follow_origin` is called. From then on
/// they are relative to the given origin; without a known origin they are refused. Own state comes as Inbox::bus_state,
/// never as own_state.
class SensorBus {
public:
    /// Processes what has arrived, a bounded amount per call; fills the inbox. Call once a step, before the link reads:
    /// the link's bytes may come through the bus.
    virtual void receive(TimePoint now, Inbox& inbox) noexcept = 0;
    /// Sends our status to the bus and the queued frames. Call once a step.
    virtual void service(TimePoint now, const BusStatus& status) noexcept = 0;

    /// The bus is absent: nothing can be received, so silence has no meaning.
    [[nodiscard]] virtual bool is_lost() const noexcept = 0;

    /// See Endpoint::follow_origin; nothing: there is an origin, but it is unknown.
    virtual void follow_origin(const std::optional<GlobalPosition>& origin) noexcept = 0;
    /// Sets the server of the parameters; it must outlive the bus's use.
    virtual void serve(ParamServer& params) noexcept = 0;

    /// At most 90 characters are sent.
    virtual void send_text(Severity severity, std::string_view text) noexcept = 0;
    /// False if it cannot be sent now: the value is outdated at once, so it is not queued.
    virtual bool send_near(const NearObject& object) noexcept = 0;

protected:
    ~SensorBus() = default;
};

}  // namespace jink::link
