// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/cost/tables.hpp"
#include "firmware/linux/vehicle_file.hpp"
#include "toolchain/host/exact_curve.hpp"

// Cost look-up tables of a vehicle: built, measured, and written as a C++ header.

namespace jink::host {

/// Owns the data of a Tables view. Do not move while a view is in use.
struct MadeTables {
    struct Family {
        std::string name;
        float length = 0.0F;
        bool mirrored = false;
        std::vector<float> offset, slope, arc, turn, bend;
        std::vector<std::uint8_t> runs;
        cost::tables::Bounds bounds;
    };
    std::string vehicle;
    vehicle::VehicleLimits limits;
    vehicle::Airframe airframe;
    cost::Caps caps;
    std::uint16_t waypoints = 0;
    std::vector<Family> families;
    std::vector<cost::tables::FamilyTable> family_views;

    [[nodiscard]] std::size_t bytes() const;  ///< of the arrays
    [[nodiscard]] cost::tables::Tables view();
};

/// Tables of a vehicle for curves of `waypoints` (8..kMaxPathPoints) points. Bounds are measured (kMeasuring), enlarged
/// by kBoundMargin and rounded up to two digits.
[[nodiscard]] MadeTables make_tables(const files::Vehicle& vehicle, std::uint16_t waypoints);

/// How densely the domain is sampled.
struct Density {
    std::size_t per_step = 20;     ///< ratios in each step of the bend table
    std::size_t elevations = 13;   ///< of the leg, -90 to 90 degrees
    std::size_t planes = 13;       ///< about the leg, -90 to 90 degrees; beyond: the same with opposite offsets
    std::size_t energy_every = 8;  ///< energy is checked at every n-th ratio
};
/// kMeasuring: for the bounds. The second density is twice as fine, so that points between are sampled, with no angle
/// in common.
inline constexpr Density kMeasuring{};
inline constexpr Density kChecking{40, 42, 42, 16};
inline constexpr double kBoundMargin = 1.1;
/// Speeds of the sampling, as shares of the vehicle's cruise speed: those of geometric::kAttempts.
inline constexpr std::array<double, 3> kSpeedShares{1.0, 0.6, 0.3};
/// Distances of the sampling [m]; only the energy does not scale with the distance.
inline constexpr std::array<double, 3> kEnergyDistances{2.5, 10.0, 40.0};

/// Largest relative errors of look-ups against ExactCurve.
struct TableErrors {
    double length = 0.0;
    double time = 0.0;
    /// Sum of the errors of all chords over the length: an upper bound on the time's error, whichever limits bind.
    double chords = 0.0;
    double smoothness = 0.0;
    double energy = 0.0;
    std::size_t look_ups = 0;
    std::size_t refused = 0;  ///< refused look-ups; must be 0
};
[[nodiscard]] TableErrors sample_errors(const cost::tables::Tables& tables, std::size_t family, const Density& density);
/// True if every error is within the family's bounds and no look-up is refused.
[[nodiscard]] bool holds(const TableErrors& errors, const cost::tables::Bounds& bounds);

/// The tables as a header: `inline constexpr Tables k<Identifier>` in jink::cost::tables. `source` names the vehicle
/// file.
[[nodiscard]] std::string tables_header(MadeTables& made);

}  // namespace jink::host
