// SPDX-License-Identifier: BSD-3-Clause
// The autopilot's modes and their velocity commands.
#include "toolchain/sim/autopilot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware/link/mavlink/text.hpp"
#include "toolchain/sim/plane_item_pilot.hpp"

namespace jink::sim {
namespace {

/// Boot clock at the start of the flight: the autopilot booted before [us].
constexpr Micros kUpBefore = 60 * kSecond;
/// GUID_TIMEOUT and COM_OF_LOSS_T [us].
constexpr Micros kArdupilotTimeout = 3 * kSecond;
constexpr Micros kPx4Timeout = 1 * kSecond;
/// Position hold: gain towards the stopping place [1/s].
constexpr double kHoldGain = 0.8;
constexpr double kStopped = 0.3;     // [m/s]
constexpr std::uint8_t kNotice = 5;  // MAV_SEVERITY_NOTICE
constexpr double kLandSpeed = 1.5;   // [m/s]
/// RTL_ALTITUDE of ArduPlane above home [m].
constexpr double kPlaneHomeHeight = 100.0;

std::unique_ptr<ItemPilot> pilot_of_items(const Scenario& scenario)
{
    if (!scenario.flight || scenario.flight->items.empty()) {
        return nullptr;
    }
    return scenario.vehicle.min_speed > 0.0 ? std::make_unique<PlaneItemPilot>(scenario)
                                            : std::make_unique<ItemPilot>(scenario);
}

}  // namespace

Autopilot::Autopilot(World& world)
    : world_(world), scenario_(world.scenario()), mission_(scenario_), plane_(scenario_.vehicle),
      items_(pilot_of_items(scenario_)), estimate_(scenario_.own, scenario_.seed), receiver_(world),
      writer_(scenario_.system), server_(scenario_.stack, writer_), reported_(scenario_.threats.size())
{
    if (scenario_.flight) {
        mode_ = scenario_.flight->mode;
    }
    aim_plane();
    for (const auto& [name, value] : scenario_.parameters) {
        wanted_.push_back({name, static_cast<float>(value), false});
    }
    parameters_verified_ = wanted_.empty() ? 0 : -1;
    estimate_.step(world.own());
}

Micros Autopilot::boot_us() const noexcept
{
    const Faults& faults = scenario_.faults;
    Micros boot = world_.now() + kUpBefore;
    if (faults.reboot_at && world_.now() >= to_micros(*faults.reboot_at)) {
        boot = world_.now() - to_micros(*faults.reboot_at);
    }
    if (faults.clock_jump_at && world_.now() >= to_micros(*faults.clock_jump_at)) {
        boot += to_micros(faults.clock_jump_by);
    }
    return boot;
}

bool Autopilot::rebooting() const noexcept
{
    const Faults& faults = scenario_.faults;
    return faults.reboot_at && world_.now() >= to_micros(*faults.reboot_at) &&
           world_.now() < to_micros(*faults.reboot_at + faults.reboot_lasts);
}

void Autopilot::enter(Mode mode, bool asked)
{
    if (mode == mode_) {
        return;
    }
    if (mode_ == Mode::mission && items_) {
        items_->leave();
    }
    mode_ = mode;
    mode_since_ = world_.now();
    last_change_was_asked_ = asked;
    holding_ = false;
    aim_plane();
    if (mode == Mode::external) {
        ++takeovers_;
        last_followed_ = world_.now();
        // GUIDED starts by holding its place. OFFBOARD flies no set-point from before it (MavlinkReceiver publishes
        // them in OFFBOARD alone): the former mode's last one stands until the next.
        has_external_setpoint_ = scenario_.stack == Stack::px4;
        setpoint_ = has_external_setpoint_ ? command_ : Vec(Vec::Zero());
    }
    if (mode == Mode::mission && items_) {
        items_->resume(world_.own());
    } else if (mode == Mode::mission && scenario_.stack == Stack::ardupilot) {
        mission_.resume(world_.own().position);
    }
    if (scenario_.stack == Stack::ardupilot) {
        send_heartbeat();  // PX4 does not: once a second in all cases
    }
}

/// Sets the centre that a plane circles about in the entered mode.
void Autopilot::aim_plane()
{
    const Vec& here = world_.own().position;
    if (mode_ == Mode::guided && scenario_.flight) {
        plane_.go_to(scenario_.flight->target, here);
    } else if (mode_ == Mode::home) {
        plane_.go_to(scenario_.home + Vec(0.0, 0.0, kPlaneHomeHeight), here);
    } else {
        plane_.hold(here);
    }
}

/// Actions of a ground station on another line.
void Autopilot::follow_others()
{
    if (!scenario_.flight) {
        return;
    }
    const NominalFlight& flight = *scenario_.flight;
    if (flight.mission_at >= 0.0 && !sent_to_mission_ && world_.now() >= to_micros(flight.mission_at)) {
        sent_to_mission_ = true;
        enter(Mode::mission, false);
    }
    if (items_ && flight.upload_at >= 0.0 && !uploaded_ && world_.now() >= to_micros(flight.upload_at)) {
        uploaded_ = true;
        items_->replace(flight.uploaded, world_.own());
        // ArduCopter alone reports this.
        if (scenario_.stack == Stack::ardupilot && !is_plane()) {
            link::mavlink::Statustext text;
            text.severity = kNotice;
            static_cast<void>(link::mavlink::set_text(text.text, "Auto mission changed, restarted command"));
            writer_.write(text);
        }
    }
}

void Autopilot::suffer_faults()
{
    const Faults& faults = scenario_.faults;
    if (faults.pilot_takes_over && !pilot_acted_ && world_.now() >= to_micros(*faults.pilot_takes_over)) {
        pilot_acted_ = true;
        enter(faults.pilot_mode, false);
    }
    if (faults.reboot_at && !rebooted_ && world_.now() >= to_micros(*faults.reboot_at)) {
        rebooted_ = true;
        writer_.restart();
        writer_.bytes().clear();
        reported_origin_ = false;
        server_.restart();
        if (mode_ == Mode::external) {
            enter(Mode::hold, false);
        }
    }
}

void Autopilot::watch_setpoints()
{
    if (mode_ != Mode::external || is_plane()) {
        return;
    }
    const Micros silent = world_.now() - last_followed_;
    heard_.longest_setpoint_gap = std::max(heard_.longest_setpoint_gap, silent);
    if (scenario_.stack == Stack::px4 && silent > kPx4Timeout) {
        enter(Mode::hold, false);
    }
    if (scenario_.stack == Stack::ardupilot && silent > kArdupilotTimeout) {
        has_external_setpoint_ = false;
    }
}

/// Uses the autopilot's own position estimate.
Vec Autopilot::mission_velocity()
{
    Truth own = world_.own();
    own.position = believed_position();
    if (!items_) {
        return mission_.command(own.position);
    }
    const Vec command = items_->command(own);
    world_.set_airspeed(items_->speed());
    return command;
}

/// Velocity by the sticks; position hold with centred sticks.
Vec Autopilot::pilot_velocity(const Truth& own)
{
    if (!scenario_.flight) {
        return scenario_.faults.pilot_velocity;
    }
    if (scenario_.flight->moved_at >= 0.0 && world_.now() >= to_micros(scenario_.flight->moved_at)) {
        return scenario_.flight->stick;
    }
    // FLY_BY_WIRE_B keeps its wings level and its height.
    return is_plane() ? Vec(own.velocity.x(), own.velocity.y(), 0.0) : held_place(own);
}

/// Outside of the mission mode.
Vec Autopilot::plane_velocity(const Truth& own)
{
    world_.set_airspeed(scenario_.vehicle.cruise);
    return mode_ == Mode::pilot ? pilot_velocity(own) : plane_.command(own);
}

Vec Autopilot::held_place(const Truth& own)
{
    if (!holding_ && own.velocity.norm() < kStopped) {
        holding_ = true;
        hold_at_ = own.position;
    }
    return holding_ ? Vec(kHoldGain * (hold_at_ - own.position)) : Vec(Vec::Zero());
}

Vec Autopilot::wanted_velocity()
{
    const Truth& own = world_.own();
    if (is_plane() && mode_ != Mode::mission) {
        return plane_velocity(own);
    }
    switch (mode_) {
    case Mode::mission: return mission_velocity();
    case Mode::external:
        if (has_external_setpoint_) {
            return setpoint_;
        }
        break;
    case Mode::pilot: return pilot_velocity(own);
    case Mode::home: {
        const Vec to_home(scenario_.home.x() - own.position.x(), scenario_.home.y() - own.position.y(), 0.0);
        return along(to_home, std::min(scenario_.vehicle.cruise, kHoldGain * to_home.norm()), scenario_.vehicle);
    }
    case Mode::guided: {
        const Vec left = scenario_.flight ? Vec(scenario_.flight->target - own.position) : Vec(Vec::Zero());
        return along(left, std::min(scenario_.vehicle.cruise, kHoldGain * left.norm()), scenario_.vehicle);
    }
    case Mode::land: return Vec(0.0, 0.0, own.position.z() > scenario_.home.z() + 0.2 ? -kLandSpeed : 0.0);
    case Mode::hold:
    case Mode::brake: break;
    }
    return held_place(own);
}

void Autopilot::step()
{
    estimate_.step(world_.own());
    suffer_faults();
    follow_others();
    if (!rebooting()) {
        server_.step(world_.now());
        send_telemetry();
    }
    send_traffic();
    send_scan();
    watch_setpoints();
    command_ = wanted_velocity();
    world_.step(command_);
}

void Autopilot::relay(std::span<const std::byte> frames)
{
    if (!rebooting()) {
        writer_.bytes().insert(writer_.bytes().end(), frames.begin(), frames.end());
    }
}

std::vector<std::byte> Autopilot::take_output() { return std::exchange(writer_.bytes(), {}); }

std::vector<std::string> Autopilot::parameters_missing() const
{
    std::vector<std::string> missing;
    for (const Wanted& wanted : wanted_) {
        if (!wanted.verified) {
            missing.push_back(wanted.name);
        }
    }
    return missing;
}

}  // namespace jink::sim
