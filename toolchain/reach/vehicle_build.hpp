// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/reach/vehicle_sets.hpp"
#include "core/vehicle/vehicle.hpp"
#include "toolchain/reach/stored_set.hpp"

// All sets of one vehicle, from its limits (Gomola 6.2.6).

namespace jink::reach::build {

/// Memory profile: a co-processor with megabytes of flash, or with a few hundred kilobytes.
enum class Profile : std::uint8_t { full, reduced };

struct Recipe {
    Profile profile = Profile::full;
    double period = 0.5;                    ///< of one movement [s]
    std::vector<double> speeds{0.25, 0.7};  ///< lower ends of the speed segments, shares of the cruise speed
    double most_speed = 1.2;                ///< upper end of the last segment
    std::size_t most_bytes = 0;             ///< limit of all tables together; 0: the profile's limit
};
/// A profile's limits on bytes of tables and on nodes of one set: flash of the images, and RAM per node of the largest
/// set.
[[nodiscard]] std::size_t most_bytes_of(Profile profile);
[[nodiscard]] std::size_t most_nodes_of(Profile profile);

/// Share of the acceleration limits that turns may use; the rest is for path tracking and wind.
inline constexpr double kTurnShare = 0.7;
/// Largest step of a turn [rad], Gomola's 15 degrees: with larger steps a movement skips its cell's neighbours.
inline constexpr double kLargestStep = 0.26179938779914943;
/// Smallest step of a turn [rad], a quarter of a degree: below, tables in 1/1024 of a movement distinguish too few
/// trajectories.
inline constexpr double kSmallestStep = 0.0043633231299858;

/// The vehicle cannot have sets by this recipe; the text says why.
class CannotBuild : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Steps, grid and pitch limits at up to `speed` [m/s]. Steps use at most kTurnShare of the accelerations; one pitch
/// step stays within the vehicle's climb and sink rates. The grid extends three yaw and two pitch steps to either side,
/// 45 and 30 degrees for steps of 15: the range of turns over most of the grid's depth (Gomola 6.3).
/// @throws CannotBuild when a step is below kSmallestStep.
[[nodiscard]] Settings settings_at(const vehicle::VehicleLimits& limits, double speed, double period);

/// Size parameters of a build. Variants are tried from largest to smallest; the first that fits is used.
struct Density {
    std::size_t spread = 8;        ///< spread of the chaotic set, or of the plane sets
    std::size_t most_lateral = 1;  ///< per cell at a side
};

/// One set, with its settings.
struct BuiltSet {
    Settings settings;
    std::function<Set(const Settings&)> make;
    Set set;
    StoredSet stored;
};

struct BuiltVehicle {
    struct Segment {
        std::size_t navigation = 0;  ///< in `sets`
        std::size_t emergency = 0;
        bool upside_down = false;
    };
    std::string vehicle;
    vehicle::VehicleLimits limits;
    Recipe recipe;
    Density density;
    std::vector<BuiltSet> sets;  ///< each once
    std::vector<Segment> segments;
    std::vector<float> speeds;
    std::vector<std::array<float, 2>> pitch_separators;
    std::vector<float> most_pitch;

    [[nodiscard]] std::size_t bytes() const;  ///< size of all tables
};

/// @throws CannotBuild when the recipe is invalid or no variant fits.
[[nodiscard]] BuiltVehicle build_vehicle(const std::string& name, const vehicle::VehicleLimits& limits,
                                         const Recipe& recipe);

/// Views of a built vehicle, which must outlive them.
class VehicleView {
public:
    explicit VehicleView(const BuiltVehicle& built);
    [[nodiscard]] VehicleSets sets() const;

private:
    const BuiltVehicle& built_;
    std::vector<ReachSet> views_;
    std::vector<SegmentSets> segments_;
};

}  // namespace jink::reach::build
