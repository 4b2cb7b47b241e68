// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "core/vehicle/vehicle.hpp"

// A candidate's costs in double precision, directly from the formulas (geometric planner, sections 2, 3 and 5).
// Reference for building and checking look-up tables and for choosing the number of waypoints.

namespace jink::host {

/// A family of curves for D = w = 1, in the order of geometric::Family.
struct CurveFamily {
    std::string_view name;
    double length;             ///< of the abscissa
    double (*offset)(double);  ///< at u in [0, length]
};
/// The tabulated families; a planner may use any subset.
[[nodiscard]] std::span<const CurveFamily> curve_families();

/// A curve to fly. Unit vectors along the leg and towards positive offsets are given by their vertical components.
struct ExactQuery {
    double offset = 0.0;    ///< [m]
    double distance = 0.0;  ///< [m]
    double speed = 0.0;     ///< [m/s]
    double along_z = 0.0;
    double side_z = 0.0;
    double max_climb = 0.0;    ///< [m/s]
    double max_descent = 0.0;  ///< [m/s]
    double mass = 0.0;         ///< [kg]
    double drag = 0.0;         ///< C_D rho A_e / 4 [kg/m]
};

/// A family's curve for D = 1 at `waypoints` equal steps of the abscissa, and the quantities that depend on the curve
/// alone.
class ExactCurve {
public:
    ExactCurve(const CurveFamily& family, std::size_t waypoints);

    [[nodiscard]] std::size_t chords() const { return slope_.size(); }
    [[nodiscard]] double step() const { return step_; }
    [[nodiscard]] std::span<const double> offset() const { return offset_; }
    /// Of each chord for r = 1.
    [[nodiscard]] std::span<const double> slope() const { return slope_; }

    /// Length of chord `i` for D = 1.
    [[nodiscard]] double chord(std::size_t i, double ratio) const;
    /// S D, by the planner's scheme (Pinheiro eq. 4.6, central differences, one-sided at the ends, trapezoids).
    [[nodiscard]] double bend(double ratio) const;
    /// Sum over chords and those after them of length * 2 (1 - cos of the turn), D = 1.
    [[nodiscard]] double turn(double ratio) const;
    [[nodiscard]] double length(double ratio) const;  ///< D = 1
    [[nodiscard]] double time(const ExactQuery& query) const;
    [[nodiscard]] double energy(const ExactQuery& query) const;
    /// Times at which the waypoints are reached.
    [[nodiscard]] std::vector<double> times(const ExactQuery& query) const;

private:
    [[nodiscard]] double chord_time(std::size_t i, const ExactQuery& query) const;

    double step_;
    std::vector<double> offset_;
    std::vector<double> slope_;
};

/// Integral of squared curvature over the abscissa for D = 1, accurate to 1e-6: by differences of a curve far finer
/// than any flown curve.
[[nodiscard]] double exact_bend(const CurveFamily& family, double ratio);

/// C_D rho A_e / 4 [kg/m].
[[nodiscard]] double drag_of(const vehicle::Airframe& airframe);
/// A query with the vehicle's limits and airframe set.
[[nodiscard]] ExactQuery query_for(const vehicle::VehicleLimits& limits, const vehicle::Airframe& airframe);

}  // namespace jink::host
