// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/plant.hpp"

#include <algorithm>
#include <cmath>

namespace jink::sim {
namespace {

constexpr Micros kSamplePeriod = 20'000;
/// A set-point slower than this is a command to stop [m/s].
constexpr double kStill = 0.1;
/// A commanded stop of this duration counts as braking [s].
constexpr double kHeldLong = 0.5;
/// The flight continues for this long after the last event [us].
constexpr Micros kSettled = 2 * kSecond;
/// Back on the leg within this distance [m].
constexpr double kOnLeg = 1.5;
/// Longest permitted gap between set-points in external mode: half of PX4's time-out [s].
constexpr double kLongestGap = 0.5;
/// Longest gap between the co-processor's heartbeats [s].
constexpr double kHeartbeatGap = 1.5;

/// A flight may end in external mode if a conflict warning is at most this old [s].
constexpr double kStillWarned = 5.0;

}  // namespace

Plant::Plant(const Scenario& scenario)
    : scenario_(scenario), world_(scenario), autopilot_(world_), areas_(scenario.areas), flips_(scenario.mission),
      sides_(scenario.mission)
{
    take_notes();
}

bool Plant::cable_pulled() const noexcept
{
    const Faults& faults = scenario_.faults;
    return faults.cable_pulled_at && world_.seconds() >= *faults.cable_pulled_at &&
           world_.seconds() < *faults.cable_pulled_at + faults.cable_pulled_for;
}

void Plant::deliver(std::span<const std::byte> bytes)
{
    if (!cable_pulled()) {
        autopilot_.receive(bytes);
        areas_.receive(bytes, world_.now());
    }
}

std::vector<std::byte> Plant::collect()
{
    std::vector<std::byte> bytes = autopilot_.take_output();
    if (cable_pulled()) {
        bytes.clear();
    }
    return bytes;
}

void Plant::take_notes()
{
    Sample sample;
    sample.time = world_.seconds();
    sample.position = world_.own().position;
    sample.velocity = world_.own().velocity;
    sample.acceleration = world_.own().acceleration;
    sample.setpoint = autopilot_.setpoint();
    sample.mode = autopilot_.mode();
    sample.separation = world_.separation(sample.nearest);
    sample.jink_state = autopilot_.heard().state;
    samples_.push_back(sample);
}

/// Below the floor, unless the leg leads there, or the autopilot by its own tracking of the leg.
bool Plant::is_below_floor() const
{
    constexpr double kFollowing = 0.5;
    const auto above = [&](const Vec& place) { return autopilot_.mission().height_abeam(place) - place.z(); };
    const Vec& position = world_.own().position;
    // As its autopilot believes: an own position that is wrong is no descent of jink's.
    const bool follows = autopilot_.mode() == Mode::mission && above(autopilot_.believed_position()) <= kFollowing;
    return scenario_.floor && position.z() < *scenario_.floor && position.z() + above(position) >= *scenario_.floor &&
           !follows;
}

void Plant::step()
{
    autopilot_.step();
    autopilot_.relay(areas_.send(world_.now()));
    below_floor_ = below_floor_ || is_below_floor();
    if (goal_at_ < 0 && (autopilot_.believed_position() - scenario_.mission.back()).norm() <= scenario_.at_goal) {
        goal_at_ = world_.now();
    }
    if (autopilot_.mode() == Mode::external) {
        flips_.note(world_.own().position, autopilot_.command());
        sides_.note(world_.seconds(), autopilot_.takeovers(), world_.own().position, autopilot_.command());
        held_ = autopilot_.command().norm() < kStill ? held_ + kStep : 0;
        longest_hold_ = std::max(longest_hold_, held_);
    } else {
        held_ = 0;
    }
    if (world_.now() % kSamplePeriod == 0) {
        take_notes();
    }
}

void Plant::note_choice(const Vec& side)
{
    if (autopilot_.mode() == Mode::external) {
        sides_.choose(world_.seconds(), autopilot_.takeovers(), side);
    }
}

bool Plant::faults_over() const
{
    const Faults& faults = scenario_.faults;
    const double t = world_.seconds() - 2.0;
    return (!faults.pilot_takes_over || t > *faults.pilot_takes_over) &&
           (!faults.reboot_at || t > *faults.reboot_at + faults.reboot_lasts) &&
           (!faults.clock_jump_at || t > *faults.clock_jump_at) &&
           (!faults.cable_pulled_at || t > *faults.cable_pulled_at + faults.cable_pulled_for);
}

bool Plant::finished() const
{
    if (world_.now() >= to_micros(scenario_.duration)) {
        return true;
    }
    if (scenario_.to_goal) {
        return goal_at_ >= 0 && autopilot_.mode() == Mode::mission && world_.now() - goal_at_ >= kSettled;
    }
    const bool back = autopilot_.mode() == Mode::mission && autopilot_.mode_since() > 0 &&
                      world_.now() - autopilot_.mode_since() >= kSettled &&
                      autopilot_.mission().cross_track(world_.own().position) < kOnLeg;
    return back && world_.all_past() && faults_over();
}

Record Plant::record(const std::vector<double>& scanned) const
{
    Record record;
    record.name = scenario_.name;
    record.title = scenario_.title;
    record.stack = scenario_.stack;
    record.seed = scenario_.seed;
    record.promise = scenario_.promise;
    record.duration = world_.seconds();
    record.closest = world_.closest();
    record.closest_threat = scenario_.threats.empty() ? "" : scenario_.threats[record.closest.threat].name;
    record.closest_area = world_.closest_area();
    record.takeovers = autopilot_.takeovers();
    record.flips = flips_.flips();
    record.longest_hold = to_seconds(longest_hold_);
    record.final_mode = autopilot_.mode();
    record.given_back =
        record.takeovers > 0 && autopilot_.mode() == Mode::mission && autopilot_.last_change_was_asked();
    record.cross_track = autopilot_.mission().cross_track(world_.own().position);
    record.goal_at = goal_at_ < 0 ? -1.0 : to_seconds(goal_at_);
    record.lowest = world_.lowest();
    record.below_floor = below_floor_;
    record.heard = autopilot_.heard();
    record.critical_texts = static_cast<unsigned>(autopilot_.critical_texts().size());
    record.mission = scenario_.mission;
    record.threats = scenario_.threats;
    for (std::size_t i = 0; i < scenario_.threats.size(); ++i) {
        record.appeared.push_back(world_.appeared(i) < 0 ? -1.0 : to_seconds(world_.appeared(i)));
        const double by_lidar = i < scanned.size() ? scanned[i] : -1.0;
        record.course_reported.push_back(to_seconds(autopilot_.course_reported(i)));
        record.reported.push_back(autopilot_.reported(i) < 0 ? by_lidar : to_seconds(autopilot_.reported(i)));
    }
    record.sides = sides_.counts(record.reported);
    record.chosen_sides = sides_.chosen(record.reported);
    record.samples = samples_;
    for (const std::string& name : autopilot_.parameters_missing()) {
        record.faults.push_back("parameter " + name + " was not taken");
    }
    for (const std::string& text : autopilot_.critical_texts()) {
        record.faults.push_back("the autopilot told the pilot \"" + text + "\"");
    }
    if (const std::string fault = areas_.fault(); !fault.empty()) {
        record.faults.push_back(fault);
    }
    return record;
}

void conclude(const Scenario& scenario, Record& record)
{
    const auto check = [&](bool broken, const std::string& what) {
        if (broken) {
            record.faults.push_back(what);
        }
    };
    const Heard& heard = record.heard;
    const bool link_faulty = scenario.faults.cable_pulled_at || scenario.faults.reboot_at;
    check(heard.heartbeats == 0, "the co-processor was never heard");
    check(heard.bad_setpoints > 0, std::to_string(heard.bad_setpoints) + " set-points that an autopilot refuses");
    check(heard.setpoints_overruled > 0,
          std::to_string(heard.setpoints_overruled) + " set-points after somebody else chose a mode");
    check(heard.frames_refused > 0 && !link_faulty, std::to_string(heard.frames_refused) + " damaged frames");
    check(!link_faulty && to_seconds(heard.longest_heartbeat_gap) > kHeartbeatGap,
          "the co-processor's heartbeat paused");
    check(!link_faulty && to_seconds(heard.longest_setpoint_gap) > kLongestGap,
          "the set-points paused in external mode");
    check(record.below_floor, "below the floor");
    const bool still_warned =
        heard.last_warning >= 0 && record.duration - to_seconds(heard.last_warning) < kStillWarned;
    check(record.final_mode == Mode::external && !still_warned, "the external mode was not given back");

    const double surface = std::min(record.closest.surface, record.closest_area);
    if (surface < scenario.body_radius) {
        record.outcome = Outcome::collision;
    } else if (surface < scenario.promise) {
        record.outcome = Outcome::breach;
    } else if (!record.faults.empty()) {
        record.outcome = Outcome::failed;
    } else if (record.longest_hold >= kHeldLong) {
        record.outcome = Outcome::braked;
    } else {
        record.outcome = record.takeovers > 0 ? Outcome::avoided : Outcome::clear;
    }
}

}  // namespace jink::sim
