// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "firmware/app/parameters.hpp"
#include "toolchain/sim/frame_writer.hpp"
#include "toolchain/sim/plant.hpp"
#include "toolchain/sim/radio.hpp"

namespace jink::sim {

/// Vehicles on a circle, each with its own co-processor, that exchange places with the opposite vehicle (Alejo 7.3.4),
/// and moving obstacles.
struct SwarmSetup {
    unsigned vehicles = 20;     ///< 2 to 64
    double circle = 10.0;       ///< its radius [m]
    double sector = 360.0;      ///< of the circle on which the vehicles start, evenly spread [deg]
    double tilt = 0.0;          ///< of the circle's plane: at 90 the first vehicle starts above the others [deg]
    double height = 20.0;       ///< of the circle's lowest point above home [m]
    double cruise = 1.0;        ///< [m/s]
    double acceleration = 2.0;  ///< of the vehicles, at most, to every side [m/s2]
    bool as_recorded = false;   ///< vehicles answer as their autopilots in the recordings, whatever `acceleration` says
    double slow = 1.0;          ///< share of it that every second vehicle flies at
    double spread = 0.1;        ///< largest start offset from the vehicle's place, per axis [m]
    bool back = false;          ///< the vehicles return to their starts
    unsigned obstacles = 0;     ///< spheres that fly straight through the circle, slower than the vehicles
    double body = 0.25;         ///< radius of vehicles and obstacles [m]
    double level = 0.7;         ///< required level separation of two vehicles' centres, or
    double vertical = 0.5;      ///< required vertical separation instead [m]
    double rate = 10.0;         ///< of broadcasts [Hz]
    double loss = 0.0;          ///< lost share of broadcasts and obstacle reports
    double delay = 0.0;         ///< delay of broadcasts and obstacle reports [s]
    double duration = 180.0;    ///< at most [s]
    Board board;
    Stack stack = Stack::ardupilot;
    bool both_stacks = false;                  ///< every second autopilot is a PX4 in place of `stack`
    std::map<std::string, double> parameters;  ///< of the co-processors, in addition to `swarm_parameters`
    std::map<std::string, double> others;      ///< of every second vehicle's, in addition to these
};

/// Parameters of the co-processor of vehicle `index`: for small slow vehicles, their separations and the delay; then
/// those of the setup.
/// @throws std::runtime_error for an unknown name or a refused value
[[nodiscard]] app::Parameters swarm_parameters(const SwarmSetup& setup, unsigned index = 0);

/// Vehicle `index` of the swarm of a seed, and the obstacles, equal for all vehicles. The same seed gives the same
/// scenario on every machine.
[[nodiscard]] Scenario swarm_scenario(const SwarmSetup& setup, std::uint64_t seed, unsigned index);

/// Result of a swarm flight.
struct SwarmResult {
    std::uint64_t seed = 0;
    double distance = 1e9;    ///< least between two vehicles' centres [m]
    double margin = 1e9;      ///< least of max(level / its separation, height / its), 1: just kept
    double obstacle = 1e9;    ///< least from a vehicle's centre to an obstacle's surface [m]; 1e9 without any
    unsigned collisions = 0;  ///< pairs of bodies in contact, obstacles included
    unsigned vehicles = 0;
    unsigned arrived = 0;
    double time = 0.0;   ///< time of the last arrival, or of the end [s]
    double stall = 0.0;  ///< longest stall of a vehicle en route, slower than a tenth of its cruise speed [s]
    unsigned takeovers = 0;
    unsigned jumps = 0;               ///< of the velocities that are flown, as in Heard
    std::uint64_t digest = 0;         ///< over all positions every 0.1 s: equal for equal flights
    std::vector<std::string> faults;  ///< broken rules of the protocol

    [[nodiscard]] bool good() const noexcept { return collisions == 0 && arrived == vehicles && faults.empty(); }
};

/// Everything except the co-processors: the autopilots' end of all cables, the radio between them, and recording. The
/// owner moves the bytes, as with a Plant.
///
/// Separations are measured at every kStep; the error between steps is below 0.1 mm.
class Swarm {
public:
    /// @param setup  outlives the swarm
    Swarm(const SwarmSetup& setup, std::uint64_t seed);

    [[nodiscard]] std::size_t size() const noexcept { return plants_.size(); }
    [[nodiscard]] Plant& plant(std::size_t i) { return *plants_[i]; }
    [[nodiscard]] Micros now() const noexcept { return plants_.front()->now(); }
    /// Advances all by one kStep. O(vehicles * (vehicles + obstacles)).
    void step();
    /// The duration has elapsed, or all vehicles have been at their goals for 2 s.
    [[nodiscard]] bool finished() const;
    void note_fault(std::size_t vehicle, const std::string& what);
    [[nodiscard]] SwarmResult result() const;
    /// Writes positions every 0.1 s: time, vehicle, x, y, z, mode. @throws std::runtime_error when the file cannot be
    /// written
    void write_tracks(const std::filesystem::path& file) const;

private:
    void broadcast();
    void measure();

    const SwarmSetup& setup_;
    std::vector<Scenario> scenarios_;
    std::vector<std::unique_ptr<Plant>> plants_;
    std::vector<FrameWriter> writers_;
    std::vector<Micros> phases_;
    Radio radio_;
    SwarmResult result_;
    std::vector<bool> touched_;           ///< vehicle * (vehicles + obstacles) + other
    std::vector<Micros> arrived_;         ///< -1: not yet
    std::vector<Micros> standing_since_;  ///< -1: not
};

/// Flies in this process. The same setup and seed give the same result, bit by bit.
/// @param tracks  folder for SEED.csv of failed flights; empty: none
[[nodiscard]] SwarmResult fly_swarm(const SwarmSetup& setup, std::uint64_t seed, const std::filesystem::path& tracks);

/// Flies in real time against one jinkd per vehicle, each on its own pseudo-terminal.
/// @param folder  for the programs' output, parameters and summaries; must exist
[[nodiscard]] SwarmResult fly_swarm_of_daemons(const SwarmSetup& setup, std::uint64_t seed,
                                               const std::filesystem::path& program,
                                               const std::filesystem::path& folder);

}  // namespace jink::sim
