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

/// Vehicles on a circle, each with a co-processor of its own, that change places with those opposite (Alejo 7.3.4), and
/// what else flies there.
struct SwarmSetup {
    unsigned vehicles = 20;   ///< 2 to 64
    double circle = 10.0;     ///< its radius [m]
    double height = 20.0;     ///< above home [m]
    double cruise = 1.0;      ///< [m/s]
    double spread = 0.1;      ///< each starts up to this far from its place, each axis [m]
    bool back = false;        ///< and return to where they started
    unsigned obstacles = 0;   ///< balls that fly straight through the circle, slower than the vehicles
    double body = 0.25;       ///< radius of vehicles and obstacles [m]
    double level = 0.7;       ///< separation of two vehicles' centres: this, level, or
    double vertical = 0.5;    ///< this, in height [m]
    double rate = 10.0;       ///< of broadcasts [Hz]
    double loss = 0.0;        ///< of broadcasts and of reports of obstacles, share
    double delay = 0.0;       ///< of both [s]
    double duration = 180.0;  ///< at most [s]
    Stack stack = Stack::ardupilot;
    std::map<std::string, double> parameters;  ///< of the co-processors, beyond `swarm_parameters`
};

/// The co-processors' parameters: small slow vehicles and their separations, the delay; and what the setup says.
/// @throws std::runtime_error for a name that is none and values that are refused
[[nodiscard]] app::Parameters swarm_parameters(const SwarmSetup& setup);

/// Vehicle `index` of the swarm of a seed, and the obstacles, which are the same for all of them. The same seed gives
/// the same scenario on every machine.
[[nodiscard]] Scenario swarm_scenario(const SwarmSetup& setup, std::uint64_t seed, unsigned index);

/// How it went.
struct SwarmResult {
    std::uint64_t seed = 0;
    double distance = 1e9;    ///< least between two vehicles' centres [m]
    double margin = 1e9;      ///< least of max(level / its separation, height / its), 1: just kept
    double obstacle = 1e9;    ///< least from a vehicle's centre to an obstacle's surface [m]; 1e9 without any
    unsigned collisions = 0;  ///< pairs of bodies that touched, obstacles' included
    unsigned vehicles = 0;
    unsigned arrived = 0;
    double time = 0.0;   ///< the last arrival, or the end [s]
    double stall = 0.0;  ///< longest that one stood on its way, slower than a tenth of its cruise speed [s]
    unsigned takeovers = 0;
    std::uint64_t digest = 0;         ///< of all places every 0.1 s: equal for equal flights
    std::vector<std::string> faults;  ///< rules of the protocol that were broken

    [[nodiscard]] bool good() const noexcept { return collisions == 0 && arrived == vehicles && faults.empty(); }
};

/// Everything but the co-processors: the autopilots' end of all cables, the radio between them, and the one who takes
/// notes. Whoever owns it moves the bytes, as with a Plant.
///
/// Separations are measured at every kStep: what is missed between two is below 0.1 mm.
class Swarm {
public:
    /// @param setup  outlives the swarm
    Swarm(const SwarmSetup& setup, std::uint64_t seed);

    [[nodiscard]] std::size_t size() const noexcept { return plants_.size(); }
    [[nodiscard]] Plant& plant(std::size_t i) { return *plants_[i]; }
    [[nodiscard]] Micros now() const noexcept { return plants_.front()->now(); }
    /// One kStep of time for all. O(vehicles * (vehicles + obstacles)).
    void step();
    /// Time is up, or all have been at their goals for 2 s.
    [[nodiscard]] bool finished() const;
    void note_fault(std::size_t vehicle, const std::string& what);
    [[nodiscard]] SwarmResult result() const;
    /// Places every 0.1 s: time, vehicle, x, y, z, mode. @throws std::runtime_error when it cannot be written
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

/// In this process. The same setup and seed give the same result, bit by bit.
/// @param tracks  folder for SEED.csv of flights that are not good; empty: none
[[nodiscard]] SwarmResult fly_swarm(const SwarmSetup& setup, std::uint64_t seed, const std::filesystem::path& tracks);

/// In real time, against one jinkd for each vehicle, each on a pseudo-terminal of its own.
/// @param folder  for what they print, their parameters and summaries; must exist
[[nodiscard]] SwarmResult fly_swarm_of_daemons(const SwarmSetup& setup, std::uint64_t seed,
                                               const std::filesystem::path& program,
                                               const std::filesystem::path& folder);

}  // namespace jink::sim
