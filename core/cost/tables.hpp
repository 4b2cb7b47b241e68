// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/cost/cost.hpp"

// Cost look-up tables: arc length, duration, smoothness and energy of a candidate curve without its waypoints.
//
// A curve is its family, the ratio r = w / D of offset to distance, its plane, the slope of the leg, and the scale D
// (geometric planner, section 2). The tables hold, over |r|, the planner's own evaluation of a curve with a fixed
// number of waypoints:
//   arc     length of the first k chords / D. Chords on which the climb or descent limit binds are found by their slope
//           alone; their time is their rise over the limit, a difference of two heights, and that of the others is
//           their length over the speed. So any limit, speed, plane and leg is served by one table of two dimensions.
//   bend    smoothness S D / r^2
//   turn    reduction of the drag term by the turns: sum of chord length (1 - cos of the turn) 2 / (D r^2)
// Between its columns, which are at equal steps, a table is interpolated by cubics (Catmull-Rom).
//
// `jink tables` writes a vehicle's tables as a header (firmware/vehicles/<name>/cost_tables.hpp), and proves their
// bounds. Memory: stated in that header; less than 6 KiB a vehicle, constant. A query outside the tables is refused,
// and the caller evaluates the curve; nothing is clamped.

namespace jink::cost::tables {

/// Largest |r| = |w| / D: 3.2 radii aside at the least distance of 2.5 radii, plus rounding. No candidate lies further
/// out.
inline constexpr float kLargestRatio = 1.2801F;
/// Steps from 0 to kLargestRatio. Columns are one more, and one beyond each end for the interpolation.
inline constexpr std::size_t kArcSteps = 16;
inline constexpr std::size_t kBendSteps = 32;
inline constexpr std::size_t kArcColumns = kArcSteps + 3;
inline constexpr std::size_t kBendColumns = kBendSteps + 3;
/// Parts of a curve with monotonic slope: a family with more parts is not tabulated.
inline constexpr std::size_t kMaxRuns = 4;

/// Largest errors relative to the exact evaluation in double precision, rounding of the look-up included; over the
/// whole domain. Length and time hold for any limits and speed, the energy for those of the tables' vehicle.
struct Bounds {
    float length = 0.0F;
    float time = 0.0F;
    float smoothness = 0.0F;
    float energy = 0.0F;
};

/// One family of curves: `chords` chords at equal steps of the abscissa.
struct FamilyTable {
    std::string_view name;
    float length = 0.0F;                 ///< of the abscissa, over D
    bool mirrored = false;               ///< about its middle chord's start: `arc` holds the first half of its rows
    std::span<const float> offset;       ///< for D = w = 1 at each waypoint: chords + 1
    std::span<const float> slope;        ///< of each chord, for r = 1: chords
    std::span<const std::uint8_t> runs;  ///< ends of the runs of chords with monotonic slope; the last is `chords`
    std::span<const float> arc;          ///< kArcColumns for each k = 1 .. chords (mirrored: chords / 2)
    std::span<const float> turn;         ///< kArcColumns
    std::span<const float> bend;         ///< kBendColumns
    Bounds bounds;

    [[nodiscard]] std::size_t chords() const noexcept { return slope.size(); }
};

/// One vehicle's tables: a view, copied freely. Families in the order of geometric::Family.
struct Tables {
    std::string_view vehicle;
    std::span<const FamilyTable> families;
    std::uint16_t waypoints = 0;  ///< assumed number of every curve's waypoints
    float cruise_speed = 0.0F;    ///< of the vehicle file [m/s]
    float max_climb = 0.0F;       ///< [m/s]
    float max_descent = 0.0F;     ///< [m/s]
    float mass = 0.0F;            ///< [kg]
    float drag = 0.0F;            ///< C_D rho A_e / 4 [kg/m]
    Caps caps;                    ///< of the vehicle
    std::size_t bytes = 0;        ///< size of this vehicle's constants
};

/// The same curves for other limits: all bounds hold except that of the energy. O(1).
[[nodiscard]] Tables with_limits(const Tables& tables, const vehicle::VehicleLimits& limits,
                                 const vehicle::Airframe& airframe) noexcept;

/// A curve on a leg. Only the vertical components of the unit vectors along the leg and towards positive offsets count.
struct CurveQuery {
    std::size_t family = 0;  ///< index in Tables::families
    float offset = 0.0F;     ///< w, signed, |w| <= kLargestRatio D [m]
    float distance = 0.0F;   ///< D > 0 [m]
    float speed = 0.0F;      ///< along the curve > 0 [m/s]
    float along_z = 0.0F;    ///< of the leg, up: along_z^2 + side_z^2 <= 1 (plus the rounding of a path frame)
    float side_z = 0.0F;     ///< of the plane's direction, up
};

/// The terms by which candidates are ordered.
struct Estimate {
    float length = 0.0F;      ///< [m]
    float time = 0.0F;        ///< T [s]
    float smoothness = 0.0F;  ///< S, of the curvature method [1/m]
};

/// Whether the query lies in the domain above: known family, finite values.
[[nodiscard]] bool covers(const Tables& tables, const CurveQuery& query) noexcept;

/// Empty outside the domain. O(1) where no limit binds, else O(kMaxRuns log waypoints).
[[nodiscard]] std::optional<Estimate> estimate(const Tables& tables, const CurveQuery& query) noexcept;

/// S alone, equal to that of `estimate` to the bit, for any plane, leg and speed; empty outside the domain. O(1).
[[nodiscard]] std::optional<float> smoothness(const Tables& tables, std::size_t family, float offset,
                                              float distance) noexcept;

/// E of the candidate [J]; empty outside the domain. Chords on which a limit binds, and those before them, are
/// evaluated exactly: O(kMaxRuns log waypoints) plus their number.
[[nodiscard]] std::optional<float> energy(const Tables& tables, const CurveQuery& query) noexcept;

}  // namespace jink::cost::tables
