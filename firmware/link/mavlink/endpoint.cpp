// SPDX-License-Identifier: BSD-3-Clause
// Reception of what the autopilot says about itself, and sending. Sensors, traffic and requests: endpoint_sensors.cpp,
// endpoint_requests.cpp.
#include "firmware/link/mavlink/endpoint.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/link/mavlink/text.hpp"

namespace jink::link::mavlink {
namespace {

constexpr std::uint8_t kAutopilotComponent = 1;
constexpr std::uint8_t kUsualSystem = 1;
constexpr std::uint8_t kAutopilotInvalid = 8;
constexpr std::uint8_t kAutopilotArduPilot = 3;
constexpr std::uint8_t kAutopilotPx4 = 12;
constexpr std::uint8_t kTypeFixedWing = 1;
constexpr std::uint8_t kTypeOnboardController = 18;
constexpr std::uint8_t kArmed = 128;
constexpr std::uint8_t kCustomModeEnabled = 1;
constexpr std::uint8_t kLocalNed = 1;
constexpr std::uint16_t kDoSetMode = 176;
constexpr std::uint16_t kSetMessageInterval = 511;
constexpr std::uint16_t kVelocityOnly = 0x0DC7;
constexpr std::uint8_t kReal32 = 9;
constexpr Seconds kTimesyncPeriod = 1.0F;
/// A line this long without a byte is not in the middle of a frame any more: 20 bytes take less at 2400 baud [s].
constexpr Seconds kSilence = 0.1F;
/// A stamp may lie this far ahead of our clock: resolution of the wire and of the mapping [s].
constexpr Seconds kFutureSlack = 0.03F;

constexpr std::uint8_t clamp_enum(std::uint32_t value) noexcept { return static_cast<std::uint8_t>(value & 0xFFU); }

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
    while (const std::optional<Frame> frame = silent ? parser_.flush() : parser_.next(bytes)) {
        ++diagnostics_.frames_in;
        dispatch({*frame, now, inbox});
    }
    const ParserDiagnostics& p = parser_.diagnostics();
    diagnostics_.frames_refused = p.incompatible_flags + p.unknown_message + p.too_short + p.too_long + p.bad_checksum +
                                  p.cut + p.signed_refused + p.unsigned_refused + p.wrong_signature +
                                  p.stale_signature + p.signature_streams;
    const bool fetched = mission_.take_leg();
    if (fetched || leg_waits_) {
        resolve_leg(inbox);
    }
    if (mission_.take_loss() || (fetched && !has_mission_leg_)) {
        lose_leg(inbox);
    }
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
    case GpsGlobalOrigin::kInfo.id: on_origin(c); break;
    case HomePosition::kInfo.id: on_home(c); break;
    case PositionTargetLocalNed::kInfo.id: on_position_target(c); break;
    case CommandAck::kInfo.id: on_command_ack(c); break;
    case ExtendedSysState::kInfo.id: {
        ExtendedSysState m;
        autopilot_.landed = decode(c.frame, m) && m.landed_state == 1;
        break;
    }
    case MissionCurrent::kInfo.id: {
        MissionCurrent m;
        if (decode(c.frame, m)) {
            mission_.current(m.seq);
        }
        break;
    }
    case MissionCount::kInfo.id: {
        MissionCount m;
        if (decode(c.frame, m) && m.mission_type == 0) {
            mission_.count(m.count, c.now);
        }
        break;
    }
    case MissionItemInt::kInfo.id: on_mission_item(c); break;
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
    if (!is_autopilot || c.frame.header.system_id != system_) {
        ++diagnostics_.frames_ignored;
        return;
    }
    autopilot_.stamp = c.now;
    autopilot_.stack = m.autopilot == kAutopilotPx4         ? AutopilotStack::px4
                       : m.autopilot == kAutopilotArduPilot ? AutopilotStack::ardupilot
                                                            : AutopilotStack::unknown;
    vehicle_class_ = m.type == kTypeFixedWing ? VehicleClass::plane : VehicleClass::copter;
    autopilot_.fixed_wing = m.type == kTypeFixedWing;
    autopilot_.armed = (m.base_mode & kArmed) != 0;
    autopilot_.custom_mode = m.custom_mode;
    autopilot_.mode = classify(autopilot_.stack, vehicle_class_, m.custom_mode);
    // A reboot noticed earlier in the same batch must not be lost when a second heartbeat follows.
    const bool pending_reboot = c.inbox.has_autopilot && c.inbox.autopilot.rebooted;
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
        has_yaw_ = has_odometry_ = has_local_ = has_home_ = has_target_ = has_mission_leg_ = leg_waits_ = false;
        origin_rank_ = 0;
        mission_.forget();
        streams_.restart();
    }
}

/// Maps a boot-clock stamp to ours; false, and counted, when it is too old or in the future.
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
    // Only the answer to our newest request: others carry times that we never sent.
    if (!timesync_asked_ || m.ts1 != last_timesync_.us * 1000) {
        ++diagnostics_.frames_ignored;
        return;
    }
    timesync_asked_ = false;
    note(clock_.round_trip(last_timesync_.us, m.tc1 / 1000, c.now.us));
}

void Endpoint::on_command_ack(const Context& c) noexcept
{
    CommandAck m;
    const bool known = decode(c.frame, m) && (m.command == kDoSetMode || m.command == kSetMessageInterval);
    if (!known || (m.target_system != 0 && !for_us(m.target_system, m.target_component))) {
        ++diagnostics_.frames_ignored;
        return;
    }
    constexpr std::uint8_t kInProgress = 5;
    if (m.command == kSetMessageInterval) {
        diagnostics_.rates_refused += m.result == 0 || m.result == kInProgress ? 0U : 1U;
        return;
    }
    if (m.result != kInProgress && !c.inbox.mode_answers.try_push_back({m.result == 0, m.result})) {
        ++diagnostics_.inbox_full;
    }
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
    switch (mission_.next(now)) {
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
    case MissionStep::finish: {
        MissionAck m;
        m.target_system = system_;
        m.target_component = kAutopilotComponent;
        send(m);
        break;
    }
    case MissionStep::none: break;
    }
}

void Endpoint::take_back(Perishable kind) noexcept
{
    if (!transmit_.take_back(kind)) {
        return;
    }
    switch (kind) {
    case Perishable::setpoint: ++diagnostics_.setpoints_dropped; break;
    case Perishable::mode_request: ++diagnostics_.requests_dropped; break;
    case Perishable::heartbeat: ++diagnostics_.heartbeats_dropped; break;
    case Perishable::no: break;
    }
}

template <Message M>
void Endpoint::send(const M& message, Perishable kind) noexcept
{
    if (system_ == 0 && M::kInfo.id != Heartbeat::kInfo.id) {  // nobody known yet to speak to
        return;
    }
    take_back(kind);
    std::array<std::byte, kMaxFrame> frame;
    // 0 is nobody's id: until the autopilot is known, its usual one.
    const Header header{system_ != 0 ? system_ : kUsualSystem, options_.component_id, sequence_};
    const std::size_t size =
        signing_ != nullptr ? encode_signed(message, header, *signing_, frame) : encode(message, header, frame);
    if (!transmit_.push({frame.data(), size}, kind)) {
        ++diagnostics_.outbox_full;
        return;
    }
    ++sequence_;
    ++diagnostics_.frames_out;
}

void Endpoint::send_heartbeat(SystemState state) noexcept
{
    Heartbeat m;
    m.type = kTypeOnboardController;
    m.autopilot = kAutopilotInvalid;
    m.system_status = clamp_enum(static_cast<std::uint32_t>(state));
    send(m, Perishable::heartbeat);
}

void Endpoint::send_velocity(const Vec3& velocity, TimePoint now) noexcept
{
    const Vec3 ned = swap_ned_enu(velocity);
    SetPositionTargetLocalNed m;
    m.time_boot_ms = static_cast<std::uint32_t>(now.us / 1000);
    m.vx = ned.x();
    m.vy = ned.y();
    m.vz = ned.z();
    m.type_mask = kVelocityOnly;
    m.target_system = system_;
    m.target_component = kAutopilotComponent;
    m.coordinate_frame = kLocalNed;
    send(m, Perishable::setpoint);
}

void Endpoint::send_collision(const CollisionWarning& warning) noexcept
{
    Collision m;
    m.id = warning.id;
    m.time_to_minimum_delta = warning.time_to_closest;
    m.altitude_minimum_delta = warning.vertical_miss;
    m.horizontal_minimum_delta = warning.horizontal_miss;
    m.src = 0;  // from ADS-B and own sensing alike: MAV_COLLISION_SRC knows no other that fits
    m.action = static_cast<std::uint8_t>(warning.action);
    m.threat_level = static_cast<std::uint8_t>(warning.level);
    send(m);
}

void Endpoint::send_text(Severity severity, std::string_view text) noexcept
{
    Statustext m;
    m.severity = static_cast<std::uint8_t>(severity);
    static_cast<void>(set_text(m.text, text));  // cutting is what the contract says
    send(m);
}

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

void Endpoint::send_mode(std::uint32_t custom_mode) noexcept
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
    send(m, Perishable::mode_request);
}

void Endpoint::request_external_mode() noexcept { send_mode(external_mode(autopilot_.stack, vehicle_class_)); }
void Endpoint::request_mode(std::uint32_t custom_mode) noexcept { send_mode(custom_mode); }
void Endpoint::request_hold_mode() noexcept { send_mode(hold_mode(autopilot_.stack, vehicle_class_)); }

}  // namespace jink::link::mavlink
