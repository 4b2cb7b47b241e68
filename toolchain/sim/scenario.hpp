// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "toolchain/sim/closed_area.hpp"
#include "toolchain/sim/disturbance.hpp"
#include "toolchain/sim/mission_item.hpp"
#include "toolchain/sim/threat.hpp"
#include "toolchain/sim/truth_vehicle.hpp"

namespace jink::sim {

enum class Stack : std::uint8_t { ardupilot, px4 };

/// Settings of the co-processor's planner.
enum class PlannerKind : std::uint8_t {
    product,  ///< as flashed: set by the parameters
    source,   ///< geometric::source_settings(), with the co-processor's look-ahead; in process only
};

/// The processor that the co-processor runs on.
struct Board {
    /// [MHz]: its steps do as much work as fits into a tick there (app::WorkRate), and plans go on over several steps;
    /// 0: as the program jinkd does.
    unsigned clock = 0;
    bool reduced_sets = false;  ///< the default vehicle's reduced reach sets, as where memory is small

    bool operator==(const Board&) const = default;
};

enum class Outcome : std::uint8_t {
    clear,      ///< no manoeuvre needed, none flown
    avoided,    ///< control was taken and the promise kept
    braked,     ///< as `avoided`, and the vehicle stopped for a time
    breach,     ///< separation below the promise
    collision,  ///< the bodies were in contact
    failed,     ///< a rule of the protocol or of the airspace was broken
};

[[nodiscard]] std::string_view to_string(Outcome outcome) noexcept;
[[nodiscard]] std::string_view to_string(Mode mode) noexcept;
[[nodiscard]] std::string_view to_string(Stack stack) noexcept;
[[nodiscard]] std::string_view to_string(PlannerKind planner) noexcept;

/// Model of the traffic sensor.
struct TrafficSensor {
    double rate = 5.0;            ///< [Hz]
    double sigma_position = 0.0;  ///< per axis [m]
    double sigma_velocity = 0.0;  ///< per axis [m/s]
    double sigma_drift = 0.0;     ///< of a position's error that stays (Gauss-Markov), per axis and threat [m]
    double drift_time = 20.0;     ///< its correlation time [s]
    double latency = 0.1;         ///< from measurement to arrival [s]
    double jitter = 0.0;          ///< additional, uniform [s]
    double dropout = 0.0;         ///< share of lost reports
    /// Quantised as ADS-B: positions in cells of 5.1 m, heights in steps of 25 ft, speeds in steps of 1 kt and 64
    /// ft/min.
    bool quantised = false;
    Micros phase = 0;  ///< delay of the first report after a threat appears; not in files: timing.hpp
};

/// Level range scan.
struct ScanSensor {
    double rate = 10.0;   ///< [Hz]
    double range = 30.0;  ///< [m]
    Micros phase = 0;     ///< of its clock, below its period; not in files: timing.hpp
};

/// A body-fixed LiDAR: rays in rows and columns about its axes. A whole scan is measured at one instant.
struct LidarSensor {
    double rate = 10.0;     ///< scans [Hz]
    double range = 60.0;    ///< [m]
    double level = 360.0;   ///< field of view about the nose [deg]
    double up = 45.0;       ///< highest row [deg]
    double down = 45.0;     ///< lowest row, below the level [deg]
    double pitch = 2.0;     ///< between neighbouring rays and rows [deg]
    double sigma = 0.03;    ///< noise of range [m]
    double latency = 0.02;  ///< from measurement to arrival [s]
};

/// Injected faults. Times in [s]; an empty time disables the fault.
struct Faults {
    std::optional<double> pilot_takes_over;  ///< mode of `pilot_mode` chosen by the pilot
    Mode pilot_mode = Mode::hold;            ///< hold, home or pilot
    Vec pilot_velocity = Vec::Zero();        ///< flown in pilot mode [m/s]
    bool refuse_external = false;            ///< every request of the external mode is denied
    double offboard_proof = 0.0;             ///< a PX4 that requires set-points for longer than this [s]
    std::optional<double> reboot_at;         ///< the autopilot falls silent, then restarts its boot clock
    double reboot_lasts = 1.0;
    std::optional<double> clock_jump_at;  ///< the boot clock jumps
    double clock_jump_by = 0.0;
    std::optional<double> cable_pulled_at;  ///< no bytes in either direction
    double cable_pulled_for = 0.0;
};

struct Expectation {
    std::vector<Outcome> outcomes;   ///< any of these
    std::optional<bool> given_back;  ///< the mission flies again at the end, and control had been taken
    std::optional<Mode> final_mode;
    std::optional<int> flips_at_most;
    std::optional<bool> goal_reached;  ///< the last waypoint
};

/// One flight: the world, the vehicle, its mission, the autopilot and the expectations.
struct Scenario {
    std::string name;
    std::string title;
    std::uint64_t seed = 1;
    std::uint8_t system = 1;  ///< of the vehicle on the link; not in files: swarm.hpp
    Stack stack = Stack::ardupilot;
    PlannerKind planner = PlannerKind::product;
    double duration = 20.0;        ///< at most [s]
    double promise = 0.7;          ///< least distance from the vehicle's centre to a true surface [m]
    double body_radius = 0.5;      ///< of the vehicle [m]
    std::optional<double> floor;   ///< least height of the centre above the origin of the local frame [m]
    std::optional<double> ground;  ///< height of the ground plane for the LiDAR [m]
    bool to_goal = false;          ///< ends at the last waypoint instead of when all threats are past
    TruthLimits vehicle;
    Vec start_position = Vec::Zero();
    Vec start_velocity = Vec::Zero();
    std::vector<Vec> mission;  ///< at least two waypoints; the first is the start of the first leg
    double reached = 2.0;      ///< a waypoint is reached within this distance; not in files [m]
    double at_goal = 3.0;      ///< the last waypoint is reached within this distance; not in files [m]
    /// Flown in place of `mission`; the goal stays the last waypoint of `mission`. Not in files.
    std::optional<NominalFlight> flight;
    Vec home = Vec::Zero();  ///< in the local frame, whose origin is the estimator's; not in files
    std::vector<Threat> threats;
    std::vector<ClosedArea> areas;
    TrafficSensor traffic;
    ScanSensor scan;
    OwnSensor own;
    Wind wind;
    std::optional<LidarSensor> lidar;
    std::map<std::string, double> parameters;  ///< set at the start, verified
    Board board;
    bool timed = false;  ///< its steps are timed, which takes a fifth of a flight
    Faults faults;
    Expectation expect;
};

/// The vehicle answers set-points as its autopilot did in the recordings.
inline void answer_as_recorded(Scenario& scenario) noexcept
{
    scenario.stack == Stack::px4 ? answer_as_px4(scenario.vehicle) : answer_as_arducopter(scenario.vehicle);
}

}  // namespace jink::sim
