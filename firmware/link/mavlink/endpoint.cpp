// SPDX-License-Identifier: BSD-3-Clause
// Reception: senders, modes and clocks. Own state, origin and home: endpoint_state.cpp. Mission and leg:
// endpoint_mission.cpp. Sensors and requests: endpoint_sensors.cpp. Traffic: endpoint_traffic.cpp. Points in space:
// endpoint_points.cpp. Sending: endpoint_sending.cpp. Keys: endpoint_signing.cpp.
#include "firmware/link/mavlink/endpoint.hpp"

#include <algorithm>

#include "firmware/link/mavlink/numbers.hpp"
#include "firmware/link/mavlink/text.hpp"

namespace jink::link::mavlink {
namespace {

constexpr std::uint8_t kAutopilotArduPilot = 3;
constexpr std::uint8_t kAutopilotPx4 = 12;
constexpr std::uint8_t kTypeFixedWing = 1;
/// A line without a byte for this long is no longer in the middle of a frame: 20 bytes take less at 2400 baud [s].
constexpr Seconds kSilence = 0.1F;
/// A stamp may be this far ahead of our clock: resolution of the wire and of the clock mapping [s].
constexpr Seconds kFutureSlack = 0.03F;

}  // namespace

Endpoint::Endpoint(const EndpointOptions& options, Signing* signing) noexcept
    : options_(options), signing_(signing), parser_(signing, LongerPayload::accept), system_(options.system_id)
{
}

bool Endpoint::from_autopilot(const Frame& frame) const noexcept
{
    return system_ != 0 && frame.header.system_id == system_ && frame.header.component_id == kAutopilotComponent;
}

bool Endpoint::for_us(std::uint8_t system, std::uint8_t component) const noexcept
{
    return system == system_ && component == options_.component_id;
}

void Endpoint::receive(std::span<const std::byte> bytes, TimePoint now, Inbox& inbox) noexcept
{
    const bool silent = bytes.empty() && now - last_byte_ > kSilence;
    last_byte_ = bytes.empty() ? last_byte_ : now;
    if (signing_ != nullptr) {
        signing_->follow_clock(now.us);
    }
    while (const std::optional<Frame> frame = silent ? parser_.flush() : parser_.next(bytes)) {
        ++diagnostics_.frames_in;
        dispatch({*frame, now, inbox});
    }
    end_pausing_scan(now);
    const ParserDiagnostics& p = parser_.diagnostics();
    diagnostics_.frames_refused = p.incompatible_flags + p.unknown_message + p.too_short + p.too_long + p.bad_checksum +
                                  p.cut + p.unsigned_refused + p.wrong_signature + p.stale_signature +
                                  p.signature_streams;
    diagnostics_.systems_evicted = neighbours_.evicted();
    diagnostics_.sensors_evicted = range_sensors_.evicted();
    update_leg(inbox, now);
}

void Endpoint::dispatch(const Context& c) noexcept
{
    if (c.frame.message_id == Heartbeat::kInfo.id) {
        on_heartbeat(c);
    } else if (c.frame.message_id == Timesync::kInfo.id) {
        on_timesync(c);
    } else if (system_ == 0) {
        ++diagnostics_.frames_ignored;
    } else {
        dispatch_autopilot(c);
    }
}

void Endpoint::dispatch_autopilot(const Context& c) noexcept
{
    if (dispatch_mission(c)) {
        return;
    }
    if (!from_autopilot(c.frame)) {
        dispatch_sensors(c);
        return;
    }
    streams_.heard(c.frame.message_id);
    switch (c.frame.message_id) {
    case LocalPositionNed::kInfo.id: on_local_position(c); break;
    case AttitudeQuaternion::kInfo.id: on_attitude(c); break;
    case Attitude::kInfo.id: on_euler_attitude(c); break;
    case Odometry::kInfo.id: on_odometry(c); break;
    case GlobalPositionInt::kInfo.id: on_global_position(c); break;
    case GpsRawInt::kInfo.id: on_gps(c); break;
    case ScaledPressure::kInfo.id: on_pressure(c); break;
    case GpsGlobalOrigin::kInfo.id: on_origin(c); break;
    case HomePosition::kInfo.id: on_home(c); break;
    case CommandAck::kInfo.id: on_command_ack(c); break;
    case ExtendedSysState::kInfo.id: {
        ExtendedSysState m;
        autopilot_.landed = decode(c.frame, m) && m.landed_state == 1;
        vtol_state_ = m.vtol_state;
        break;
    }
    case Statustext::kInfo.id: on_status_text(c); break;
    case ParamValue::kInfo.id: on_limit(c); break;
    case RcChannels::kInfo.id:
    case ManualControl::kInfo.id: on_sticks(c); break;
    default: dispatch_sensors(c);
    }
}

void Endpoint::on_heartbeat(const Context& c) noexcept
{
    Heartbeat m;
    const bool is_autopilot = decode(c.frame, m) && c.frame.header.component_id == kAutopilotComponent &&
                              m.autopilot != kAutopilotInvalid && c.frame.header.system_id != 0;
    if (is_autopilot && system_ == 0) {
        system_ = c.frame.header.system_id;
    }
    if (is_autopilot && c.frame.header.system_id != system_) {
        neighbours_.note_armed(c.frame.header.system_id, (m.base_mode & kArmed) != 0, c.now);
        return;
    }
    if (!is_autopilot) {
        ++diagnostics_.frames_ignored;
        return;
    }
    const FlightMode mode_before = autopilot_.mode;
    const bool was_armed = autopilot_.armed;
    autopilot_.stamp = c.now;
    autopilot_.stack = m.autopilot == kAutopilotPx4         ? AutopilotStack::px4
                       : m.autopilot == kAutopilotArduPilot ? AutopilotStack::ardupilot
                                                            : AutopilotStack::unknown;
    vehicle_class_ = vehicle_class(autopilot_.stack, m.type);
    autopilot_.steerable = is_steerable(autopilot_.stack, m.type, vtol_state_);
    autopilot_.fixed_wing = m.type == kTypeFixedWing;
    autopilot_.armed = (m.base_mode & kArmed) != 0;
    autopilot_.custom_mode = m.custom_mode;
    autopilot_.mode = classify(autopilot_.stack, vehicle_class_, m.custom_mode);
    mission_.set_lone(autopilot_.stack == AutopilotStack::ardupilot);
    note_mode(mode_before, was_armed);
    // A reboot detected earlier in the same batch must not be lost when a second heartbeat follows.
    const bool pending_reboot = c.inbox.has_autopilot && c.inbox.autopilot.rebooted;
    const AutopilotReport& last = c.inbox.autopilot;
    const bool differs = last.custom_mode != m.custom_mode || last.armed != autopilot_.armed;
    if (c.inbox.has_autopilot && differs && !c.inbox.earlier_autopilot.try_push_back(last)) {
        c.inbox.earlier_autopilot.back() = last;
    }
    c.inbox.autopilot = autopilot_;
    c.inbox.autopilot.rebooted = rebooted_ || pending_reboot;
    c.inbox.has_autopilot = true;
    rebooted_ = false;
}

void Endpoint::note(ClockEvent event) noexcept
{
    if (event == ClockEvent::none) {
        return;
    }
    ++diagnostics_.clock_relocks;
    if (event == ClockEvent::relocked_backward) {
        rebooted_ = true;
        has_pressure_ = has_yaw_ = has_odometry_ = has_local_ = has_home_ = has_home_on_globe_ = false;
        is_mission_flown_ = has_leg_ = has_anchor_ = has_former_ = has_reached_ = false;
        origin_rank_ = 0;
        vtol_state_ = kVtolUnheard;
        mission_.forget();
        streams_.restart();
        limits_.restart();
    }
}

/// Maps a boot-clock stamp to ours; false, and counted, if the stamp is too old or in the future.
bool Endpoint::stamp_of(std::int64_t boot_us, TimePoint now, TimePoint& stamp) noexcept
{
    note(clock_.one_way(boot_us, now.us));
    const std::optional<std::int64_t> local = clock_.to_local(boot_us);
    if (!local) {
        ++diagnostics_.stale_stamp;
        return false;
    }
    stamp = {*local};
    if (stamp > now + kFutureSlack || now - stamp > options_.max_stamp_age) {
        ++diagnostics_.stale_stamp;
        return false;
    }
    stamp = std::min(stamp, now);
    return true;
}

void Endpoint::on_limit(const Context& c) noexcept
{
    ParamValue m;
    const bool is_float = decode(c.frame, m) && m.param_type == kReal32;
    using Outcome = LimitRequests::Outcome;
    switch (is_float ? limits_.heard(autopilot_.stack, text_of(m.param_id), m.param_value) : Outcome::not_a_limit) {
    case Outcome::not_a_limit: ++diagnostics_.frames_ignored; break;
    case Outcome::refused: ++diagnostics_.out_of_range; break;
    case Outcome::unchanged: break;
    case Outcome::changed:
        c.inbox.limits = limits_.limits();
        c.inbox.has_limits = true;
        break;
    }
}

void Endpoint::on_command_ack(const Context& c) noexcept
{
    CommandAck m;
    const bool known = decode(c.frame, m) &&
                       (m.command == kDoSetMode || m.command == kSetMessageInterval || m.command == kDoReposition);
    if (!known || (m.target_system != 0 && !for_us(m.target_system, m.target_component))) {
        ++diagnostics_.frames_ignored;
        return;
    }
    constexpr std::uint8_t kDenied = 2;
    constexpr std::uint8_t kInProgress = 5;
    if (m.command == kDoReposition) {
        if (m.result == kDenied) {
            plane_.note_refusal();
        }
        return;
    }
    if (m.command == kSetMessageInterval) {
        if (m.result != 0 && m.result != kInProgress) {
            ++diagnostics_.rates_refused;
            streams_.refused();
        }
        return;
    }
    if (m.result != kInProgress && !c.inbox.mode_answers.try_push_back({m.result == 0, m.result})) {
        ++diagnostics_.inbox_full;
    }
}

}  // namespace jink::link::mavlink
