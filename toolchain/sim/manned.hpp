// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "toolchain/sim/encounter_model.hpp"
#include "toolchain/sim/scenario.hpp"
#include "toolchain/sim/statistics.hpp"

// Encounters of a mission leg with sampled tracks of manned aircraft, and their risk ratios (ASTM F3442).

namespace jink::sim {

/// How the aircraft is known.
enum class MannedSensor : std::uint8_t {
    adsb,   ///< transponder: once a second from 75 s before they meet, positions, heights and speeds quantised
    range,  ///< a sensor of the vehicle with a range of 2 km: twice a second, 10 m and 1 m/s of noise
};
[[nodiscard]] std::string_view to_string(MannedSensor sensor) noexcept;

/// Cylinders about the aircraft, by level distance and by height above or below [m].
struct Volume {
    double radius = 0.0;
    double height = 0.0;
};
inline constexpr Volume kNearMidAirVolume{152.4, 30.48};
inline constexpr Volume kWellClearVolume{609.6, 76.2};

/// Where the vehicle would be beside the aircraft when they meet, each a third of the encounters: in the volume of a
/// near mid-air collision, in the rest of the well clear volume, and in the rest of one 1.5 times as large.
inline constexpr std::size_t kMannedStrata = 3;

struct MannedEncounter {
    Scenario scenario;
    double weight = 1.0;  ///< so that places are even over the largest volume
};

/// The same seed gives the same encounter. The vehicle flies a straight leg at 5 to 15 m/s, 40 to 250 m high; the
/// aircraft's track is drawn anew until its height allows that and the two begin well clear of each other.
/// @throws std::runtime_error where none of 10 000 tracks does
[[nodiscard]] MannedEncounter manned_encounter(const EncounterModel& model, MannedSensor sensor, std::uint64_t seed);

/// What came of one.
struct MannedResult {
    std::uint64_t seed = 0;
    double weight = 1.0;
    bool near_alone = false;  ///< near mid-air collision of the mission alone
    bool lost_alone = false;  ///< loss of well clear of the mission alone
    bool near = false;        ///< the same with the co-processor
    bool lost = false;
    bool unavoidable = false;  ///< near_alone, and none of the judge's commands avoids it from the first report on
    bool took_over = false;
    bool broke_rule = false;  ///< of the protocol or of the airspace
};

/// Flies and judges one. `parameters` are set besides those of the encounter. The judge holds each of 51 commands (16
/// courses at cruise speed, level, climbing and descending; straight up and down; standing) against the true track.
[[nodiscard]] MannedResult fly_manned(const EncounterModel& model, MannedSensor sensor, std::uint64_t seed,
                                      const std::map<std::string, double>& parameters, const Board& board);

/// A ratio of weighted frequencies, with its 95 % interval by 1000 bootstrap samples within the strata (seeded). Of
/// fewer than ten events the upper limit is at least that of the plain share of those that it is a ratio to (share_of).
struct Ratio {
    double value = 0.0;
    double low = 0.0;
    double high = 0.0;
};
struct MannedSummary {
    std::size_t flown = 0;
    Ratio near_mid_air;  ///< near mid-air collisions, with over without
    Ratio well_clear;    ///< losses of well clear, with over without
    Ratio unavoidable;   ///< share of the near mid-air collisions without
    std::size_t near_alone = 0, near = 0, lost_alone = 0, lost = 0, unavoidable_count = 0, took_over = 0;
    std::size_t broken_rules = 0;
};
[[nodiscard]] MannedSummary summary_of(const std::vector<MannedResult>& results);

}  // namespace jink::sim
