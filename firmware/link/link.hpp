// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "firmware/link/cloud.hpp"
#include "firmware/link/global_position.hpp"
#include "firmware/link/messages.hpp"

namespace jink::link {

/// Health as sent to the autopilot and ground station (MAV_STATE of the HEARTBEAT).
enum class SystemState : std::uint8_t { boot = 1, standby = 3, active = 4, critical = 5, emergency = 6 };

/// State of the application as sent to a bus.
struct BusStatus {
    SystemState state = SystemState::boot;
    bool advising_only = false;  ///< at work, but there is no autopilot to steer
    std::uint16_t faults = 0;    ///< the application's own fault bits
};

enum class Severity : std::uint8_t { critical = 2, error = 3, warning = 4, notice = 5, info = 6 };

/// COLLISION.action / threat_level.
enum class CollisionAction : std::uint8_t {
    none = 0,
    report = 1,
    ascend_or_descend = 2,
    move_horizontally = 3,
    move_perpendicular = 4,
    hover = 6
};
enum class ThreatLevel : std::uint8_t { none = 0, low = 1, high = 2 };

struct CollisionWarning {
    std::uint32_t id = 0;
    Seconds time_to_closest = 0.0F;
    float vertical_miss = 0.0F;    ///< [m]
    float horizontal_miss = 0.0F;  ///< [m]
    CollisionAction action = CollisionAction::none;
    ThreatLevel level = ThreatLevel::none;
};

/// Counters of the link since start; every cause of a refusal has its own.
struct LinkDiagnostics {
    std::uint32_t frames_in = 0;
    std::uint32_t frames_out = 0;
    std::uint32_t frames_refused = 0;  ///< by the parser, all causes together
    std::uint32_t frames_ignored = 0;  ///< decoded, but not for us or not of interest
    std::uint32_t not_finite = 0;      ///< reports with NaN or infinity
    std::uint32_t out_of_range = 0;    ///< implausible values, zero increments, unknown frames
    std::uint32_t stale_stamp = 0;     ///< stamps too old or in the future
    std::uint32_t no_origin = 0;       ///< traffic that could not be placed yet
    std::uint32_t inbox_full = 0;      ///< reports dropped because the inbox was full
    std::uint32_t clock_relocks = 0;   ///< jumps of the autopilot's clock that the mapping followed
    std::uint32_t outbox_full = 0;     ///< frames not sent because the transmit buffer was full
    // Queued on a line that accepted nothing, and withdrawn whole: outdated, or replaced by newer ones.
    std::uint32_t setpoints_dropped = 0;
    std::uint32_t requests_dropped = 0;    ///< for a mode
    std::uint32_t heartbeats_dropped = 0;  ///< our own
    std::uint32_t bytes_discarded = 0;     ///< queued when the port was lost
    std::uint32_t rate_requests = 0;       ///< messages requested
    std::uint32_t rates_refused = 0;       ///< answers that did not grant a requested rate
    std::uint32_t own_heard = 0;           ///< reports about ourselves that came back as another vehicle
    std::uint32_t pressure_heights = 0;    ///< traffic whose height is a pressure altitude
    std::uint32_t heights_compared = 0;    ///< of these, heights compared with the own pressure altitude
    std::uint32_t traffic_relayed = 0;     ///< ADSB_VEHICLE of other systems, accepted
    std::uint32_t systems_evicted = 0;     ///< other systems on the link whose clock was forgotten: there are too many
    std::uint32_t sensors_evicted = 0;     ///< range sensors whose number was given away: there are too many
    std::uint32_t keys_set = 0;            ///< for signatures, over the link; taking the key away counts too
    std::uint32_t keys_refused = 0;        ///< unsigned, armed, or without a place to store them
};

/// A link to the autopilot, independent of the wire format. The application moves bytes between the link and a port.
///
/// Nothing here blocks or allocates. Messages to send are queued in a bounded transmit buffer; a message that does not
/// fit is dropped whole and counted.
///
/// Of set-points, mode requests and heartbeats at most one whole frame each waits: a newer frame replaces a frame of
/// which nothing has been consumed. A partly consumed frame stays, so that the other end's framing survives.
class Link {
public:
    /// Processes bytes that arrived at time `now`; fills the inbox. O(bytes).
    virtual void receive(std::span<const std::byte> bytes, TimePoint now, Inbox& inbox) noexcept = 0;
    /// Periodic work of the link itself: time synchronisation requests, fetching the mission. Call every tick.
    virtual void service(TimePoint now) noexcept = 0;

    /// Whether `service` may request messages that the autopilot sends too seldom. Off at first.
    virtual void ask_for_rates(bool on) noexcept = 0;
    /// Sets the sink of single points in space, called within `receive`; without a sink points are ignored. The sink
    /// must outlive the link.
    virtual void report_points_to(CloudSink& sink) noexcept = 0;

    /// Bytes waiting to be sent (contiguous part). `consume` removes `n` of them once the port has accepted them.
    [[nodiscard]] virtual std::span<const std::byte> pending() const noexcept = 0;
    virtual void consume(std::size_t n) noexcept = 0;
    /// Drops everything queued: on a lost port no outdated frame may be sent later.
    virtual void discard_pending() noexcept = 0;
    /// Withdraws the waiting set-point if nothing of it has been consumed: it is outdated, or the stream ends.
    virtual void drop_setpoint() noexcept = 0;
    /// The same for a mode request.
    virtual void drop_mode_request() noexcept = 0;

    virtual void send_heartbeat(SystemState state) noexcept = 0;
    /// Velocity set-point [m/s, ENU] for the autopilot's external mode.
    virtual void send_velocity(const Vec3& velocity, TimePoint now) noexcept = 0;
    virtual void send_collision(const CollisionWarning& warning) noexcept = 0;
    /// At most 50 characters are sent.
    virtual void send_text(Severity severity, std::string_view text) noexcept = 0;
    virtual void send_param(const ParamName& name, float value, std::uint16_t index, std::uint16_t count) noexcept = 0;
    virtual void acknowledge(const CommandRequest& request, CommandResult result) noexcept = 0;
    /// Reports the result of a part of a set of constraints to its sender.
    virtual void acknowledge(const ConstraintPart& part, ConstraintResult result) noexcept = 0;
    /// Sends the version of the software, and what the protocol can ask of it.
    virtual void send_version(const Version& version) noexcept = 0;
    /// Queues one part of a log. @return false: no receiver is known yet, or the transmit buffer is full; counted
    [[nodiscard]] virtual bool send_log(const LogPart& part) noexcept = 0;
    /// Requests the autopilot's external mode (GUIDED, OFFBOARD).
    virtual void request_external_mode() noexcept = 0;
    /// Requests a mode by its wire number, to restore the former mode.
    virtual void request_mode(std::uint32_t custom_mode) noexcept = 0;
    /// Requests the autopilot's HEARTBEAT now, for its present mode.
    virtual void request_heartbeat() noexcept = 0;
    /// Requests the stack's holding mode (BRAKE/LOITER, AUTO.LOITER).
    virtual void request_hold_mode() noexcept = 0;

    /// Origin of the autopilot's local frame; nothing while unknown.
    [[nodiscard]] virtual std::optional<GlobalPosition> origin() const noexcept = 0;
    /// Height of sea level above the ellipsoid around the vehicle [mm]; nothing while unknown.
    [[nodiscard]] virtual std::optional<std::int32_t> undulation() const noexcept { return std::nullopt; }

    /// Writes the frames to send if the processor faults, in wire format: HEARTBEAT (EMERGENCY with `hold`, else
    /// CRITICAL), the request of the hold mode if `hold`, twice, and `text` unless it is empty. Nothing is queued.
    ///
    /// Call it again in every step before the step's frames go to the port: sequence numbers and signatures continue
    /// those sent so far, and receivers refuse a signature that is not newer than the last.
    /// @return bytes written; 0 if `out` is too small
    [[nodiscard]] virtual std::size_t compose_last_words(std::span<std::byte> out, bool hold,
                                                         std::string_view text) noexcept = 0;

    /// Our own id to the other systems on this link (track_ids.hpp); 0 if there is none or it is unknown.
    [[nodiscard]] virtual world::TrackId own_track() const noexcept { return 0; }

    [[nodiscard]] virtual const LinkDiagnostics& diagnostics() const noexcept = 0;

protected:
    ~Link() = default;
};

}  // namespace jink::link
