// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "firmware/link/dronecan/node.hpp"
#include "firmware/link/mavlink/geodesy.hpp"
#include "firmware/link/sensor_slots.hpp"

// DroneCAN side of an inbox: converts messages of sensors and traffic receivers on the bus to the types of messages.hpp
// (ENU, SI). docs/guides/dronecan.md is the reference for users. Handling of each message:
//
// * gnss.Fix2 with a 3D fix: own position and velocity (Inbox::bus_state), sigmas from the covariance if present.
//   Placed about the origin that the application sets; else about the first fix, or not at all (no_origin). Without a
//   3D fix, off the earth or beyond 85 degrees of latitude, faster than 400 m/s or farther than 200 km: out_of_range.
//   Of several receivers the first is followed, until it has given no good fix for a second; a change counts as a reset
//   of the estimator. The others' fixes are frames_ignored. The same holds for attitudes.
// * ahrs.Solution: attitude, as the rotation from body (FRD) to world (NED). Quaternion not of length 1: out_of_range.
// * trafficmonitor.TrafficReport: a track. Without a valid position or an altitude: out_of_range; before there is an
//   origin: no_origin. traffic_type 19 (point obstacle): at_rest; 14 (UAV): unmanned. Stamp = now - tslc.
//   alt_type 2 (WGS84): a geometric height, as reported. The application, which knows the undulation, keeps both
//   possible heights (geoid.hpp). All other values, unknown (0) included, count as a pressure altitude.
// * range_sensor.Measurement, proximity_sensor.Proximity: a reading along the beam, rotated by the attitude, which may
//   not be older than 1 s (no_origin). "Too close" counts as an obstacle at the reported range, or at 0 if the range is
//   no distance; "too far" as no obstacle. Undefined, no data, not connected, or undefined orientation: out_of_range.
//   A scanning sensor uses one id for all directions: readings get a number per sensor and direction (steps of 15
//   degrees; Measurement: of 12), so that one reading does not replace another; see kBeams.
// * Stamps on the wire are ignored unless EndpointOptions::believe_stamps is set: many sensors write their own clock.

namespace jink::link::dronecan {

/// Directions of sensors that are kept apart: a ring of 24 and some fixed ones.
inline constexpr std::size_t kBeams = 48;
/// RangeReading::sensor of the first beam: those before it are MAVLink's.
inline constexpr std::uint8_t kFirstBeam = kMavlinkSensors;
static_assert(kBeams >= 24 && kFirstBeam + kBeams <= 256);

struct EndpointOptions {
    bool has_origin = false;
    GlobalPosition origin;            ///< of the local frame
    bool believe_stamps = false;      ///< all sensors follow GlobalTimeSync
    float max_stamp_age = 1.0F;       ///< older stamps are refused if stamps are believed [s]
    bool first_fix_is_origin = true;  ///< if no origin is given
};

class Endpoint {
public:
    Endpoint(const NodeOptions& node, const EndpointOptions& options, ParamServer* params = nullptr) noexcept
        : node_(node, params), options_(options)
    {
    }

    /// Processes a frame that arrived at time `now`; fills the inbox.
    ///
    /// @return a transfer of a tunnel, valid until the next call (see Tunnel); nullptr: no such transfer
    [[nodiscard]] const Transfer* receive(const Frame& frame, TimePoint now, Inbox& inbox) noexcept;
    /// Periodic work. Call every step, with the current state.
    void service(TimePoint now, const BusStatus& status) noexcept { node_.service(now, status); }
    void service(TimePoint now, SystemState state) noexcept { node_.service(now, state); }

    /// From now on positions are relative to `origin`, and never again to a fix of our own choosing. Without an origin
    /// nothing is placed (no_origin). The caller must discard what was reported before.
    void follow_origin(const std::optional<GlobalPosition>& origin) noexcept
    {
        options_.first_fix_is_origin = false;
        options_.has_origin = origin.has_value();
        options_.origin = origin.value_or(GlobalPosition{});
    }

    /// The frame that waits to be sent (nullptr: none). `consume` removes it once the port has accepted it.
    [[nodiscard]] const Frame* pending() const noexcept { return node_.outgoing().front(); }
    void consume() noexcept
    {
        node_.outgoing().pop();
        ++diagnostics_.frames_out;
    }
    /// Drops everything queued: on a lost port no outdated frame may be sent later.
    void discard_pending() noexcept { node_.outgoing().clear(); }

    void send_text(Severity severity, std::string_view text) noexcept { node_.send_text(severity, text); }

    [[nodiscard]] Node& node() noexcept { return node_; }
    [[nodiscard]] const Node& node() const noexcept { return node_; }
    [[nodiscard]] bool has_origin() const noexcept { return options_.has_origin; }
    [[nodiscard]] const LinkDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    struct Context {
        const Transfer& transfer;
        TimePoint now;
        Inbox& inbox;
    };
    /// The node that is followed, of several with the same data.
    struct Source {
        std::uint8_t node = kAnonymous;
        TimePoint heard;
    };

    void on_fix(const Context& c) noexcept;
    void on_attitude(const Context& c) noexcept;
    void on_traffic(const Context& c) noexcept;
    void on_measurement(const Context& c) noexcept;
    void on_proximity(const Context& c) noexcept;
    void place(const Context& c, RangeReading& reading, const Vec3& body, std::uint32_t beam) noexcept;
    /// False, and counted, while another node is followed. `changed`: the followed node has changed.
    [[nodiscard]] bool follow(Source& source, const Context& c, bool& changed) noexcept;
    [[nodiscard]] bool stamp_of(std::uint64_t wire, const Context& c, TimePoint& stamp) noexcept;

    Node node_;
    EndpointOptions options_;
    vehicle::VehicleState own_;
    Source fix_from_;
    Source attitude_from_;
    bool has_attitude_ = false;
    TimePoint attitude_heard_;
    std::array<float, 4> attitude_{};  ///< x, y, z, w
    SensorSlots<kBeams> beams_;
    LinkDiagnostics diagnostics_;
};

}  // namespace jink::link::dronecan
