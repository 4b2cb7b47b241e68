// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

#include "firmware/link/link.hpp"
#include "firmware/link/param_server.hpp"

namespace jink::link {

/// Something near, as seen from the vehicle.
struct NearObject {
    float yaw = 0.0F;       ///< clockwise from the nose [rad], -pi .. pi
    float pitch = 0.0F;     ///< upwards from the horizon [rad]
    float distance = 0.0F;  ///< to its nearest surface [m], > 0
};

/// A second source of reports beside the autopilot's link: sensors and traffic receivers on a bus, and who listens
/// there. It carries no set-points and no modes.
///
/// Nothing here blocks or allocates; what is lost is counted by the implementation.
///
/// Frame: positions are in a frame of the bus's own (about its first fix) until `follow_origin` is called, and from
/// then on about what it was given, or refused. Own state comes as Inbox::bus_state, never as own_state.
class SensorBus {
public:
    /// Takes what has arrived, a bounded part of it per call; fills the inbox. Call once a step, before the link reads:
    /// the link's bytes may come through the bus.
    virtual void receive(TimePoint now, Inbox& inbox) noexcept = 0;
    /// Tells the bus how we are and sends what waits. Call once a step.
    virtual void service(TimePoint now, const BusStatus& status) noexcept = 0;

    /// The bus is not there: nothing can be heard on it, so that silence means nothing.
    [[nodiscard]] virtual bool is_lost() const noexcept = 0;

    /// See Endpoint::follow_origin: nothing for "there is a frame, and where it lies is not known".
    virtual void follow_origin(const std::optional<GlobalPosition>& origin) noexcept = 0;
    /// Who answers for parameters; has to outlive the bus's use.
    virtual void serve(ParamServer& params) noexcept = 0;

    /// At most 90 characters are sent.
    virtual void send_text(Severity severity, std::string_view text) noexcept = 0;
    /// False where it cannot go out now: it is out of date at once, so it does not wait.
    virtual bool send_near(const NearObject& object) noexcept = 0;

protected:
    ~SensorBus() = default;
};

}  // namespace jink::link
