// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "core/geometry/sweep.hpp"
#include "core/path/timed_path.hpp"
#include "core/vehicle/vehicle.hpp"

// Cost terms of a candidate path, their normalisation and total (geometric planner, sections 5 and 6).

namespace jink::cost {

/// Integral of squared curvature; or standard deviation of y; or mean |y''| (Pinheiro 4.1.2).
enum class SmoothnessMethod : std::uint8_t { curvature, deviation, second_derivative };
/// Distance to the threat's whole path, as the source does; or at the same instant.
enum class ClosenessMethod : std::uint8_t { swept, time_aware };

/// Raw terms of one path.
struct Terms {
    float time = 0.0F;            ///< T [s]
    float smoothness = 0.0F;      ///< S
    float smoothness_penalised = 0.0F;  ///< S_rp
    float closeness = 0.0F;       ///< M [1/m]; infinity on contact, 0 with nothing moving
    float energy = 0.0F;          ///< E [J]
    float hover_power = 0.0F;     ///< summed over segments [W]
};

/// The same on [0, 1].
struct NormalisedTerms {
    float time = 0.0F, smoothness = 0.0F, smoothness_penalised = 0.0F, closeness = 0.0F, energy = 0.0F;
};

/// Weights of S_rp, T and M (Pinheiro eq. 4.35): their sum is 1, closeness <= 0.7, time >= 0.1.
struct Weights {
    float smoothness = 0.30F;
    float time = 0.20F;
    float closeness = 0.50F;
};
[[nodiscard]] bool is_valid(const Weights& weights) noexcept;

/// Bounds of the min-max normalisation of time and energy, one set per vehicle.
struct Caps {
    float time_low = 1.2530F, time_high = 7.0814F;    ///< [s]
    float energy_low = 249.59F, energy_high = 1759.0F;  ///< [J]
};

/// A moving threat as the closeness term sees it.
struct MovingThreat {
    geometry::Motion motion;
    float radius = 0.0F;
    Seconds duration = 0.0F;  ///< swept: how long its path is followed [s]
};

/// Sum of segment times [s].
[[nodiscard]] float flight_time(const path::TimedPath& path) noexcept;

/// Smoothness of a curve given in its own plane at abscissae `x` [m] with offsets `y` [m], equal lengths >= 3, x increasing.
/// Numerical: central differences and the trapezoid rule, as the reference. O(n).
[[nodiscard]] float smoothness(std::span<const float> x, std::span<const float> y, SmoothnessMethod method) noexcept;

/// S (1 + k_p |sin alpha|), alpha between the candidate's plane and the ground (Pinheiro eq. 4.10).
[[nodiscard]] float penalised_smoothness(float smoothness, float sin_alpha, float penalty) noexcept;

/// f of one threat (Pinheiro eq. 4.11): 1 / (0.5 mean + 0.5 min) of the waypoint distances less the radius; infinity when that is <= 0.
[[nodiscard]] float closeness(const path::TimedPath& path, const MovingThreat& threat, ClosenessMethod method) noexcept;
/// M over threats (eq. 4.12): half the greatest plus half the mean; 0 for none.
[[nodiscard]] float combined_closeness(std::span<const float> per_threat) noexcept;

/// E = E1 + E2 (Pinheiro eq. 4.1 to 4.3, the formula as printed) [J].
[[nodiscard]] float energy(const path::TimedPath& path, const vehicle::Airframe& airframe) noexcept;

/// Rotor power at vertical speed `climb_rate` [m/s], positive up (momentum theory; Pinheiro 4.1.6 with the bracket mended) [W].
[[nodiscard]] float rotor_power(float climb_rate, const vehicle::Airframe& airframe) noexcept;
/// Sum of `rotor_power` over the segments [W].
[[nodiscard]] float hover_power(const path::TimedPath& path, const vehicle::Airframe& airframe) noexcept;

/// Section 6: natural logarithm, clipped to [0, 1].
[[nodiscard]] NormalisedTerms normalise(const Terms& terms, const Caps& caps) noexcept;
/// k_S S_rp + k_T T + k_C M on normalised terms.
[[nodiscard]] float total(const NormalisedTerms& terms, const Weights& weights) noexcept;

/// Caps for another vehicle: the two stored reference paths flown with it (section 6). Off line; O(waypoints).
[[nodiscard]] Caps caps_for(const vehicle::VehicleLimits& limits, const vehicle::Airframe& airframe) noexcept;

}  // namespace jink::cost
