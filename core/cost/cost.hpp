// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/geometry/sweep.hpp"
#include "core/path/timed_path.hpp"
#include "core/vehicle/vehicle.hpp"

// Cost terms of a candidate path, their normalisation and total (geometric planner, sections 5 and 6).

namespace jink::cost {

/// Integral of squared curvature; or standard deviation of y; or mean |y''| (Pinheiro 4.1.2).
enum class SmoothnessMethod : std::uint8_t { curvature, deviation, second_derivative };
/// Distance to the threat's whole path, as Pinheiro computes it; or at the same instant.
enum class ClosenessMethod : std::uint8_t { swept, time_aware };

/// Raw terms of one path.
struct Terms {
    float time = 0.0F;                  ///< T [s]
    float smoothness = 0.0F;            ///< S
    float smoothness_penalised = 0.0F;  ///< S_rp
    float closeness = 0.0F;             ///< M [1/m]; infinity on contact, 0 with nothing moving
    float energy = 0.0F;                ///< E [J]
    float hover_power = 0.0F;           ///< mean over the path's time [W]
    float passing = 0.0F;               ///< side on which moving threats are passed: 0 behind them, 1 in front of them
    float beyond = 0.0F;                ///< time from abeam of the collision point until the end [s]
};

/// The same on [0, 1].
struct NormalisedTerms {
    float time = 0.0F, smoothness = 0.0F, smoothness_penalised = 0.0F, closeness = 0.0F, energy = 0.0F;
    float passing = 0.0F, beyond = 0.0F;
};

/// Weights of S_rp, T and M (Pinheiro eq. 4.35), and of two terms that Pinheiro leaves for future work: the sum of all
/// is 1, closeness <= 0.7, time >= 0.1.
struct Weights {
    float smoothness = 0.30F;
    float time = 0.20F;
    float closeness = 0.50F;
    float passing = 0.0F;
    float beyond = 0.0F;
};
[[nodiscard]] bool is_valid(const Weights& weights) noexcept;
/// The seven combinations that Pinheiro tried, in his order (tab. 4.8); the fifth is the default.
inline constexpr std::array<Weights, 7> kTriedWeights{{{0.20F, 0.10F, 0.70F},
                                                       {0.30F, 0.10F, 0.60F},
                                                       {0.25F, 0.15F, 0.60F},
                                                       {0.40F, 0.10F, 0.50F},
                                                       {0.30F, 0.20F, 0.50F},
                                                       {0.35F, 0.15F, 0.50F},
                                                       {0.35F, 0.25F, 0.40F}}};

/// Bounds of the min-max normalisation of time and energy, one set per vehicle.
struct Caps {
    float time_low = 1.2530F, time_high = 7.0814F;      ///< [s]
    float energy_low = 249.59F, energy_high = 1759.0F;  ///< [J]
};
/// Finite, low < 1.15 high for the time and low < high for the energy, lows >= 0.
[[nodiscard]] bool is_valid(const Caps& caps) noexcept;

/// Pinheiro's upper bound of the normalised time is the cap times this factor (4.2.2.1).
inline constexpr float kTimeHeadroom = 1.15F;

/// Waypoints of a path, coordinate by coordinate [m], and their arrival times [s]: equal lengths, not empty.
struct Waypoints {
    std::span<const float> x, y, z, t;
};

/// Sum of segment times [s].
[[nodiscard]] float flight_time(const path::TimedPath& path) noexcept;

/// Smoothness of a curve given in its own plane at abscissae `x` [m] with offsets `y` [m], equal lengths >= 3, x
/// increasing (Pinheiro eq. 4.6 to 4.9).
///
/// Numerical, as in Pinheiro: derivatives by central differences over the index, one-sided at both ends; the second
/// derivative is the derivative of the first; the integral by the trapezoid rule. For a flat curve, 57 points give 93 %
/// of the exact integral for a simple candidate and 91 % for a symmetric one: the one-sided differences flatten the
/// ends. O(n).
[[nodiscard]] float smoothness(std::span<const float> x, std::span<const float> y, SmoothnessMethod method) noexcept;

/// The same for abscissae at equal steps of `step` > 0 [m]: a third of the work, equal but for rounding. O(n).
[[nodiscard]] float smoothness(float step, std::span<const float> y, SmoothnessMethod method) noexcept;

/// S (1 + k_p |sin alpha|), alpha between the candidate's plane and the ground (Pinheiro eq. 4.10).
[[nodiscard]] float penalised_smoothness(float smoothness, float sin_alpha, float penalty) noexcept;

/// f of one threat (Pinheiro eq. 4.11): 1 / (0.5 mean + 0.5 min) of the distances between the waypoints and the
/// threat's centre less its radius. Infinity when the denominator is <= 0. swept: distance to the threat's whole path
/// from 0 to `swept_for`, which the other method does not read. Path not empty. O(points).
[[nodiscard]] float closeness(const path::TimedPath& path, const geometry::Motion& threat, float radius,
                              ClosenessMethod method, Seconds swept_for = 0.0F) noexcept;
/// The same result to the bit.
[[nodiscard]] float closeness(const Waypoints& path, const geometry::Motion& threat, float radius,
                              ClosenessMethod method, Seconds swept_for = 0.0F) noexcept;
/// M over threats (eq. 4.12): half the greatest plus half the mean; 0 for none.
[[nodiscard]] float combined_closeness(std::span<const float> per_threat) noexcept;

/// How one moving threat is passed (Pinheiro's collision angle as a cost, 6.2). Let the position be that of the vehicle
/// at the waypoint nearest to the threat at the same instant, relative to the threat. The share is (1 + cosine) / 2 of
/// the angle between this position and the threat's velocity: 0 straight behind the threat, 1 straight in front. The
/// offset at the closest approach is perpendicular to the relative velocity, so the angle between both courses limits
/// the choice. Head-on (180 degrees) and overtaking give one half on every side, crossing at 90 degrees with equal
/// speeds 0.15 or 0.85.
struct Passing {
    float share = 0.5F;
    float gap = 0.0F;  ///< from the threat's surface there [m]; not above 0 on contact
};
/// Path not empty. One half where threat and vehicle are at one point, or the threat is static. O(points).
[[nodiscard]] Passing passing(const Waypoints& path, const geometry::Motion& threat, float radius) noexcept;
/// Mean over threats, weighted by 1 / gap, gaps of at least kMinGap; 0 for none.
class PassingMean {
public:
    static constexpr float kMinGap = 0.1F;
    void add(const Passing& threat) noexcept
    {
        const float weight = 1.0F / (threat.gap > kMinGap ? threat.gap : kMinGap);
        sum_ += weight * threat.share;
        weights_ += weight;
    }
    [[nodiscard]] float value() const noexcept { return weights_ > 0.0F ? sum_ / weights_ : 0.0F; }

private:
    float sum_ = 0.0F;
    float weights_ = 0.0F;
};

/// Time from the first instant at which the path is abeam of the collision point, `distance` [m] from the origin along
/// `along` (unit vector), until the path's end [s]; 0 where the path does not get there. Path not empty. O(points).
[[nodiscard]] float time_beyond(const Waypoints& path, const Vec3& along, float distance) noexcept;

/// E = E1 + E2 (Pinheiro eq. 4.1 to 4.3, the formula as printed) [J].
[[nodiscard]] float energy(const path::TimedPath& path, const vehicle::Airframe& airframe) noexcept;

/// Rotor power at vertical speed `climb_rate` [m/s], positive up (momentum theory; Pinheiro 4.1.6 with the bracket
/// corrected) [W].
[[nodiscard]] float rotor_power(float climb_rate, const vehicle::Airframe& airframe) noexcept;
/// Mean of `rotor_power` over the time of the path, each segment at the climb rate of its beginning [W]. Path not
/// empty.
[[nodiscard]] float hover_power(const path::TimedPath& path, const vehicle::Airframe& airframe) noexcept;

/// Section 6: natural logarithm, clipped to [0, 1]. Time beyond the collision point: over the upper cap of the time.
[[nodiscard]] NormalisedTerms normalise(const Terms& terms, const Caps& caps) noexcept;
/// k_S S_rp + k_T T + k_C M on normalised terms, plus both other weighted terms.
[[nodiscard]] float total(const NormalisedTerms& terms, const Weights& weights) noexcept;

/// Times and energies of the two stored reference paths flown by a vehicle.
///
/// lower: main threat at D = 3 m on a level leg, R = 1 m; simple candidate, level plane, w = 2.1333 m. upper: D = 8.25
/// m ahead and 1.75 m below, R = 3 m; simple candidate, vertical plane, w = -9.6 m. Of all candidates in that
/// environment the upper path's time is the nearest to the published cap, and the only one that fits Pinheiro's number
/// for the path (path 39 when two planes of 13 symmetric and 13 simple candidates are counted through; 23 is the lower
/// path in its first plane). 57 points, or kMaxPathPoints. O(points).
[[nodiscard]] Caps reference_flights(const vehicle::VehicleLimits& limits, const vehicle::Airframe& airframe) noexcept;

/// Caps for another vehicle, computed offline: the published caps, each scaled by the ratio of `reference_flights` of
/// this vehicle to that of the default one. So the default vehicle keeps the published caps, not all of which its own
/// flights reach (docs/evidence/reproduction_pinheiro.md).
[[nodiscard]] Caps caps_for(const vehicle::VehicleLimits& limits, const vehicle::Airframe& airframe) noexcept;

}  // namespace jink::cost
