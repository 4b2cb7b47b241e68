// SPDX-License-Identifier: BSD-3-Clause
// All sent messages: time, rate and mission requests, modes, set-points, answers, last words.
#include <algorithm>

#include "firmware/link/mavlink/constraint_message.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/link/mavlink/numbers.hpp"
#include "firmware/link/mavlink/own_messages.hpp"
#include "firmware/link/mavlink/text.hpp"

namespace jink::link::mavlink {
namespace {

constexpr std::uint8_t kUsualSystem = 1;
constexpr std::uint8_t kCustomModeEnabled = 1;
constexpr std::uint16_t kVelocityOnly = 0x0DC7;
constexpr Seconds kTimesyncPeriod = 1.0F;
constexpr Seconds kFirstPlaces = 2.0F;
constexpr Seconds kPlacesPeriod = 4.0F;
constexpr float kNoSpeed = -1.0F;               // of DO_REPOSITION: unchanged
constexpr std::uint8_t kMissionAccepted = 0;    // MAV_MISSION_ACCEPTED
constexpr std::uint8_t kMissionCancelled = 15;  // MAV_MISSION_OPERATION_CANCELLED

}  // namespace

void Endpoint::take_back(Perishable kind) noexcept
{
    if (!transmit_.take_back(kind)) {
        return;
    }
    switch (kind) {
    case Perishable::setpoint:
        ++diagnostics_.setpoints_dropped;
        plane_.forget_last();
        break;
    case Perishable::mode_request: ++diagnostics_.requests_dropped; break;
    case Perishable::heartbeat: ++diagnostics_.heartbeats_dropped; break;
    case Perishable::no: break;
    }
}

std::size_t Endpoint::encode_as(const Unsent& message, std::uint8_t sequence, std::span<std::byte> out) noexcept
{
    // System id 0 is invalid: until the autopilot is known, its usual id is used.
    const Header header{system_ != 0 ? system_ : kUsualSystem, options_.component_id, sequence};
    Signing* const signing = signing_ != nullptr && signing_->has_key() ? signing_ : nullptr;
    return encode_v2(message.object, message.layout, header, signing, out);
}

/// @return false: not queued
bool Endpoint::send_unsent(const Unsent& message, Perishable kind) noexcept
{
    if (system_ == 0 && !message.is_heartbeat) {  // no receiver is known yet
        return false;
    }
    take_back(kind);
    std::array<std::byte, kMaxFrame> frame;
    const std::size_t size = encode_as(message, sequence_, frame);
    if (!transmit_.push({frame.data(), size}, kind)) {
        ++diagnostics_.outbox_full;
        return false;
    }
    ++sequence_;
    ++diagnostics_.frames_out;
    return true;
}

void Endpoint::on_timesync(const Context& c) noexcept
{
    Timesync m;
    if (!decode(c.frame, m)) {
        return;
    }
    const bool addressed = m.target_system == 0 || for_us(m.target_system, m.target_component);
    if (!addressed || !from_autopilot(c.frame)) {
        ++diagnostics_.frames_ignored;
        return;
    }
    if (m.tc1 == 0) {
        Timesync answer;
        answer.tc1 = c.now.us * 1000;
        answer.ts1 = m.ts1;
        answer.target_system = c.frame.header.system_id;
        answer.target_component = c.frame.header.component_id;
        send(answer);
        return;
    }
    // Accepts the answer to our newest request only: others carry times that we never sent.
    if (!timesync_asked_ || m.ts1 != last_timesync_.us * 1000) {
        ++diagnostics_.frames_ignored;
        return;
    }
    timesync_asked_ = false;
    note(clock_.round_trip(last_timesync_.us, m.tc1 / 1000, c.now.us));
}

void Endpoint::ask_for_streams(TimePoint now) noexcept
{
    if (!asks_for_rates_ || autopilot_.stack == AutopilotStack::unknown) {
        return;
    }
    if (const std::optional<StreamRequest> request = streams_.next(now)) {
        CommandLong m;
        m.command = kSetMessageInterval;
        m.target_system = system_;
        m.target_component = kAutopilotComponent;
        m.param1 = static_cast<float>(request->message_id);
        m.param2 = static_cast<float>(request->interval_us);
        send(m);
        ++diagnostics_.rate_requests;
    }
}

void Endpoint::ask_for_limits(TimePoint now) noexcept
{
    if (!asks_for_rates_ || vehicle_class_ != VehicleClass::copter || !autopilot_.steerable) {
        return;
    }
    if (const std::optional<std::string_view> name = limits_.next(autopilot_.stack, now)) {
        ParamRequestRead m;
        m.param_index = -1;
        m.target_system = system_;
        m.target_component = kAutopilotComponent;
        static_cast<void>(set_text(m.param_id, *name));
        send(m);
    }
}

void Endpoint::service(TimePoint now) noexcept
{
    if (system_ == 0) {
        return;
    }
    if (now - last_timesync_ >= kTimesyncPeriod || last_timesync_.us == 0) {
        last_timesync_ = now;
        timesync_asked_ = true;
        Timesync request;
        request.ts1 = now.us * 1000;
        request.target_system = system_;
        request.target_component = kAutopilotComponent;
        send(request);
    }
    ask_for_streams(now);
    ask_for_limits(now);
    ask_for_places(now);
    service_mission(now);
}

/// Requests origin and home: placing traffic and the mission must not wait for the first period of a stream.
void Endpoint::ask_for_places(TimePoint now) noexcept
{
    if (!asks_for_rates_ || autopilot_.stack == AutopilotStack::unknown || (origin_rank_ > 1 && has_home_on_globe_)) {
        return;
    }
    if (places_asked_.us == 0) {
        places_asked_ = now + (kFirstPlaces - kPlacesPeriod);
    }
    if (now - places_asked_ < kPlacesPeriod) {
        return;
    }
    places_asked_ = now;
    CommandLong m;
    m.command = kRequestMessage;
    m.target_system = system_;
    m.target_component = kAutopilotComponent;
    if (origin_rank_ < 2) {
        m.param1 = static_cast<float>(GpsGlobalOrigin::kInfo.id);
        send(m);
    }
    if (!has_home_on_globe_) {
        m.param1 = static_cast<float>(HomePosition::kInfo.id);
        send(m);
    }
}

void Endpoint::service_mission(TimePoint now) noexcept
{
    const MissionStep step = mission_.next(now);
    switch (step) {
    case MissionStep::list: {
        MissionRequestList m;
        m.target_system = system_;
        m.target_component = kAutopilotComponent;
        send(m);
        break;
    }
    case MissionStep::item: {
        MissionRequestInt m;
        m.seq = mission_.wanted();
        m.target_system = system_;
        m.target_component = kAutopilotComponent;
        send(m);
        break;
    }
    case MissionStep::accept:
    case MissionStep::cancel: {
        MissionAck m;
        m.type = step == MissionStep::accept ? kMissionAccepted : kMissionCancelled;
        m.target_system = system_;
        m.target_component = kAutopilotComponent;
        send(m);
        break;
    }
    case MissionStep::none: break;
    }
}

void Endpoint::send_heartbeat(SystemState state) noexcept { send(heartbeat_of(state), Perishable::heartbeat); }

bool Endpoint::takes_guided_points() const noexcept
{
    return autopilot_.stack == AutopilotStack::ardupilot && vehicle_class_ == VehicleClass::plane;
}

/// ArduPlane in GUIDED discards velocities. In any other mode ArduPlane answers DO_REPOSITION with FAILED: nothing is
/// sent.
void Endpoint::send_guided_point(const Vec3& velocity, TimePoint now) noexcept
{
    if (autopilot_.mode != FlightMode::external || origin_rank_ == 0) {
        plane_.reset();
        return;
    }
    const std::optional<Vec3> point = plane_.next(velocity, own_.position, now);
    const std::optional<GlobalPosition> place = point ? to_global(*point, origin_) : std::nullopt;
    if (!place) {
        return;
    }
    CommandInt m;
    m.param1 = kNoSpeed;
    m.x = place->lat;
    m.y = place->lon;
    m.z = static_cast<float>(place->alt) * 1e-3F;
    m.command = kDoReposition;
    m.target_system = system_;
    m.target_component = kAutopilotComponent;
    m.frame = kFrameGlobalInt;
    send(m, Perishable::setpoint);
}

void Endpoint::send_velocity(const Vec3& velocity, TimePoint now) noexcept
{
    if (takes_guided_points()) {
        send_guided_point(velocity, now);
        return;
    }
    const Vec3 ned = swap_ned_enu(velocity);
    SetPositionTargetLocalNed m;
    m.time_boot_ms = static_cast<std::uint32_t>(now.us / 1000);
    m.vx = ned.x();
    m.vy = ned.y();
    m.vz = ned.z();
    m.type_mask = kVelocityOnly;
    m.target_system = system_;
    m.target_component = kAutopilotComponent;
    m.coordinate_frame = kFrameLocalNed;
    send(m, Perishable::setpoint);
}

void Endpoint::send_collision(const CollisionWarning& warning) noexcept
{
    Collision m;
    const bool of_system = is_of_system(warning.id);
    m.id = of_system ? warning.id - kSystemIds : warning.id;
    m.time_to_minimum_delta = warning.time_to_closest;
    m.altitude_minimum_delta = warning.vertical_miss;
    m.horizontal_minimum_delta = warning.horizontal_miss;
    // 1: a system of the link, by its id. 0: all others, since MAV_COLLISION_SRC has ADS-B and no other that fits.
    m.src = of_system ? 1 : 0;
    m.action = static_cast<std::uint8_t>(warning.action);
    m.threat_level = static_cast<std::uint8_t>(warning.level);
    send(m);
}

void Endpoint::send_text(Severity severity, std::string_view text) noexcept { send(text_of_severity(severity, text)); }

void Endpoint::send_param(const ParamName& name, float value, std::uint16_t index, std::uint16_t count) noexcept
{
    ParamValue m;
    m.param_value = value;
    m.param_count = count;
    m.param_index = index;
    m.param_id = name;
    m.param_type = kReal32;
    send(m);
}

void Endpoint::acknowledge(const CommandRequest& request, CommandResult result) noexcept
{
    CommandAck m;
    m.command = request.command;
    m.result = static_cast<std::uint8_t>(result);
    m.target_system = request.from_system;
    m.target_component = request.from_component;
    send(m);
}

CommandLong Endpoint::mode_command(std::uint32_t custom_mode) const noexcept
{
    CommandLong m;
    m.command = kDoSetMode;
    m.target_system = system_;
    m.target_component = kAutopilotComponent;
    m.param1 = static_cast<float>(autopilot_.armed ? kCustomModeEnabled | kArmed : kCustomModeEnabled);
    if (autopilot_.stack == AutopilotStack::px4) {
        m.param2 = static_cast<float>(px4_main(custom_mode));
        m.param3 = static_cast<float>(px4_sub(custom_mode));
    } else {
        m.param2 = static_cast<float>(custom_mode);
    }
    return m;
}

void Endpoint::send_mode(std::uint32_t custom_mode) noexcept
{
    send(mode_command(custom_mode), Perishable::mode_request);
}

void Endpoint::acknowledge(const ConstraintPart& part, ConstraintResult result) noexcept
{
    Tunnel m = constraint_answer({part.set, part.index, result});
    m.target_system = part.from_system;
    m.target_component = part.from_component;
    send(m);
}

void Endpoint::send_version(const Version& version) noexcept
{
    constexpr std::uint64_t kMavlink2 = 8192;         // MAV_PROTOCOL_CAPABILITY_MAVLINK2
    constexpr std::uint64_t kParamsEncoded = 131072;  // MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST
    constexpr std::uint32_t kDevelopment = 0;         // FIRMWARE_VERSION_TYPE_DEV
    AutopilotVersion m;
    m.capabilities = kMavlink2 | kParamsEncoded;
    m.flight_sw_version = static_cast<std::uint32_t>(version.major) << 24U |
                          static_cast<std::uint32_t>(version.minor) << 16U |
                          static_cast<std::uint32_t>(version.patch) << 8U | kDevelopment;
    send(m);
}

bool Endpoint::send_log(const LogPart& part) noexcept
{
    const auto fill = [&part](auto&& m) noexcept {
        const std::size_t n = std::min(part.bytes.size(), m.data.size());
        m.sequence = part.sequence;
        m.target_system = part.to_system;
        m.target_component = part.to_component;
        m.length = static_cast<std::uint8_t>(n);
        m.first_message_offset = part.first_message;
        std::transform(part.bytes.begin(), part.bytes.begin() + static_cast<std::ptrdiff_t>(n), m.data.begin(),
                       [](std::byte b) { return static_cast<std::uint8_t>(b); });
        return m;
    };
    return part.is_acknowledged ? send(fill(LoggingDataAcked())) : send(fill(LoggingData()));
}

void Endpoint::request_external_mode() noexcept { send_mode(external_mode(autopilot_.stack, vehicle_class_)); }
void Endpoint::request_mode(std::uint32_t custom_mode) noexcept { send_mode(custom_mode); }
void Endpoint::request_heartbeat() noexcept
{
    CommandLong m;
    m.command = kRequestMessage;
    m.target_system = system_;
    m.target_component = kAutopilotComponent;
    m.param1 = static_cast<float>(Heartbeat::kInfo.id);
    send(m);
}

void Endpoint::request_hold_mode() noexcept { send_mode(hold_mode(autopilot_.stack, vehicle_class_)); }

std::size_t Endpoint::compose_last_words(std::span<std::byte> out, bool hold, std::string_view text) noexcept
{
    const bool known = system_ != 0;
    std::uint8_t number = sequence_;
    std::size_t size = 0;
    bool fits = true;
    const auto add = [&](const auto& message) {
        const std::size_t n = encode_as(unsent(message), number++, out.subspan(size));
        fits = fits && n > 0;
        size += n;
    };
    CommandLong request = mode_command(hold_mode(autopilot_.stack, vehicle_class_));
    if (known && hold) {
        add(request);
    }
    add(heartbeat_of(hold ? SystemState::emergency : SystemState::critical));
    if (known && !text.empty()) {
        add(text_of_severity(Severity::critical, text));
    }
    if (known && hold) {
        request.confirmation = 1;
        add(request);
    }
    return fits ? size : 0;
}

}  // namespace jink::link::mavlink
