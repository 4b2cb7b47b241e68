// SPDX-License-Identifier: BSD-3-Clause
// The autopilot's handling of the co-processor's messages.
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "firmware/link/mavlink/numbers.hpp"
#include "firmware/link/mavlink/text.hpp"
#include "toolchain/sim/autopilot.hpp"
#include "toolchain/sim/modes.hpp"

namespace jink::sim {

using namespace link::mavlink;

namespace {

constexpr std::uint8_t kAccepted = 0;
constexpr std::uint8_t kTemporarilyRejected = 1;
constexpr std::uint8_t kDenied = 2;
constexpr std::uint8_t kUnsupported = 3;
constexpr std::uint8_t kFailed = 4;
constexpr float kCustomModeEnabled = 1.0F;
/// PX4 enters OFFBOARD if the last set-point is not older than this [us] (offboardCheck.cpp since v1.14). PX4's
/// documentation (Offboard Mode, v1.16) requires a second of set-points with gaps up to this: Faults::offboard_proof.
constexpr Micros kStreamGap = kSecond / 2;
/// Its commander reads set-points once in this time, and refuses a request that comes in the pass of the first one,
/// with a text (Commander.cpp: run, offboardControlCheck, printRejectMode) [us].
constexpr Micros kCommanderPass = kSecond / 100;
/// Set-points in transit when another sender chooses a mode are tolerated for this time [us].
constexpr Micros kGrace = kSecond / 5;

}  // namespace

bool Autopilot::for_us(std::uint8_t system, std::uint8_t component) const noexcept
{
    return (system == scenario_.system || system == 0) && (component == kAutopilot.component || component == 0);
}

void Autopilot::receive(std::span<const std::byte> bytes)
{
    if (rebooting()) {
        return;
    }
    while (const auto frame = parser_.next(bytes)) {
        ++heard_.frames;
        handle(*frame);
    }
    const ParserDiagnostics& d = parser_.diagnostics();
    heard_.frames_refused = d.unknown_message + d.too_long + d.too_short + d.bad_checksum + d.incompatible_flags;
}

void Autopilot::handle(const Frame& frame)
{
    Heartbeat heartbeat;
    SetPositionTargetLocalNed target;
    CommandLong command;
    CommandInt command_int;
    ParamValue value;
    ParamRequestRead read;
    Timesync sync;
    Statustext text;
    Collision collision;
    if (decode(frame, heartbeat) && frame.header.component_id == kJink) {
        hear_heartbeat(heartbeat);
    } else if (decode(frame, target)) {
        hear_setpoint(target);
    } else if (decode(frame, command)) {
        hear_command(command, frame.header);
    } else if (decode(frame, command_int)) {
        hear_command_int(command_int, frame.header);
    } else if (decode(frame, value)) {
        hear_param(value);
    } else if (decode(frame, read)) {
        answer_param(read);
    } else if (decode(frame, sync)) {
        answer_timesync(sync, frame.header);
    } else if (decode(frame, text)) {
        heard_.texts.push_back({world_.seconds(), text.severity, std::string(text_of(text.text))});
    } else if (decode(frame, collision)) {
        ++heard_.warnings;
        heard_.first_warning = heard_.first_warning < 0 ? world_.now() : heard_.first_warning;
        heard_.last_warning = world_.now();
    } else if (MissionServer::is_for(frame)) {
        server_.receive(frame, mission_items(), mission_id(), world_.now());
    }
}

void Autopilot::hear_heartbeat(const Heartbeat& heartbeat)
{
    if (heard_.last_heartbeat >= 0) {
        heard_.longest_heartbeat_gap = std::max(heard_.longest_heartbeat_gap, world_.now() - heard_.last_heartbeat);
    }
    heard_.last_heartbeat = world_.now();
    heard_.state = heartbeat.system_status;
    ++heard_.heartbeats;
}

void Autopilot::hear_setpoint(const SetPositionTargetLocalNed& target)
{
    ++heard_.setpoints;
    const Vec velocity(static_cast<double>(target.vy), static_cast<double>(target.vx), -static_cast<double>(target.vz));
    const bool good = for_us(target.target_system, target.target_component) && target.type_mask == kVelocityMask &&
                      target.coordinate_frame == kLocalNed && velocity.allFinite() && !is_plane();
    if (!good) {
        ++heard_.bad_setpoints;
        return;
    }
    if (last_setpoint_ < 0 || world_.now() - last_setpoint_ > kStreamGap) {
        stream_since_ = world_.now();
    }
    last_setpoint_ = world_.now();
    if (mode_ == Mode::external) {
        last_followed_ = world_.now();
        const bool jumps = has_external_setpoint_ && (velocity - setpoint_).norm() > 0.5 * scenario_.vehicle.cruise;
        heard_.jumps += jumps ? 1U : 0U;
        has_external_setpoint_ = true;
        setpoint_ = velocity;
    } else if (mode_ != Mode::mission && !last_change_was_asked_ && world_.now() - mode_since_ > kGrace) {
        ++heard_.setpoints_overruled;
    }
}

std::uint8_t Autopilot::set_mode(const CommandLong& command)
{
    const auto mode = requested_mode(scenario_.stack, command.param2, command.param3, is_plane());
    if (command.param1 != kCustomModeEnabled && command.param1 != kCustomModeEnabled + kArmed) {
        return kDenied;
    }
    if (!mode) {
        return kUnsupported;
    }
    if (*mode == Mode::external) {
        ++heard_.external_requests;
        if (scenario_.faults.refuse_external) {
            return kDenied;
        }
        const Micros proof = std::max(kCommanderPass, to_micros(scenario_.faults.offboard_proof));
        const bool stream =
            last_setpoint_ >= 0 && world_.now() - last_setpoint_ <= kStreamGap && world_.now() - stream_since_ >= proof;
        if (scenario_.stack == Stack::px4 && !stream) {
            server_.complain("Switching to Offboard is currently not available");
            return kTemporarilyRejected;
        }
    }
    enter(*mode, true);
    return kAccepted;
}

void Autopilot::hear_command(const CommandLong& command, Header from)
{
    if (!for_us(command.target_system, command.target_component)) {
        return;
    }
    CommandAck ack;
    ack.command = command.command;
    ack.result = kUnsupported;
    if (command.command == kDoSetMode) {
        ack.result = set_mode(command);
        heard_.refused_requests += ack.result == kAccepted ? 0U : 1U;
    } else if (command.command == kSetMessageInterval) {
        // Message rates are fixed in this model. PX4 refuses a rate for HEARTBEAT.
        const bool refused = scenario_.stack == Stack::px4 && command.param1 == static_cast<float>(Heartbeat::kInfo.id);
        ack.result = refused ? kFailed : kAccepted;
    } else if (command.command == kRequestMessage) {
        ack.result = send_message(static_cast<int>(command.param1)) ? kAccepted : kUnsupported;
    }
    ack.target_system = from.system_id;
    ack.target_component = from.component_id;
    writer_.write(ack);
    if (command.command == kDoSetMode && scenario_.stack == Stack::px4 && ack.result == kAccepted) {
        writer_.write(ack);  // once by the MAVLink module, once by the commander
    }
}

/// Sent to ArduPlane only.
void Autopilot::hear_command_int(const CommandInt& command, Header from)
{
    if (!for_us(command.target_system, command.target_component)) {
        return;
    }
    ++heard_.setpoints;
    CommandAck ack;
    ack.command = command.command;
    ack.result = is_plane() ? plane_.hear(command, mode_ == Mode::external, world_.own().position) : kUnsupported;
    heard_.bad_setpoints += ack.result == kAccepted || mode_ != Mode::external ? 0U : 1U;
    if (mode_ != Mode::external && mode_ != Mode::mission && !last_change_was_asked_ &&
        world_.now() - mode_since_ > kGrace) {
        ++heard_.setpoints_overruled;
    }
    ack.target_system = from.system_id;
    ack.target_component = from.component_id;
    writer_.write(ack);
}

void Autopilot::hear_param(const ParamValue& value)
{
    for (Wanted& wanted : wanted_) {
        if (text_of(value.param_id) == wanted.name) {
            wanted.verified = value.param_value == wanted.value;
        }
    }
    if (parameters_verified_ < 0 && parameters_missing().empty()) {
        parameters_verified_ = world_.now();
    }
}

/// The parameters that bound what is flown; of the others nothing is answered, as ArduCopter does with a name that it
/// does not know.
void Autopilot::answer_param(const ParamRequestRead& request)
{
    if (!for_us(request.target_system, request.target_component) || is_plane()) {
        return;
    }
    struct Known {
        Stack stack;
        std::string_view name;
        double value;
    };
    const TruthLimits& limits = scenario_.vehicle;
    const std::array known{
        Known{Stack::ardupilot, "WPNAV_ACCEL", 100.0 * limits.max_acceleration},
        Known{Stack::ardupilot, "WPNAV_ACCEL_Z", 100.0 * limits.max_vertical_acceleration},
        Known{Stack::ardupilot, "PSC_JERK_XY", limits.reported_jerk},
        Known{Stack::px4, "MPC_Z_VEL_MAX_UP", limits.max_climb},
        Known{Stack::px4, "MPC_Z_VEL_MAX_DN", limits.max_descent},
    };
    for (const Known& one : known) {
        if (one.stack == scenario_.stack && one.name == text_of(request.param_id) && one.value > 0.0) {
            writer_.write(ParamValue{static_cast<float>(one.value), 1, 0xFFFF, request.param_id, kReal32});
        }
    }
}

void Autopilot::answer_timesync(const Timesync& sync, Header from)
{
    if (sync.tc1 == 0) {
        writer_.write(Timesync{boot_us() * 1000, sync.ts1, from.system_id, from.component_id});
    }
}

}  // namespace jink::sim
