// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "toolchain/sim/matrix.hpp"
#include "toolchain/sim/uniform.hpp"

// Common parts of the matrix's multirotor and plane flights. Private to the matrix.

namespace jink::sim::detail {

/// Places about home, with x along a random course.
class Field {
public:
    /// @param height  default height of places above home [m]
    Field(const Vec& home, double course, double height)
        : home_(home), x_(std::cos(course), std::sin(course), 0.0), height_(height)
    {
    }

    [[nodiscard]] Vec at(double x, double y) const { return at(x, y, height_); }
    [[nodiscard]] Vec at(double x, double y, double height) const { return home_ + along_course(x, y, height); }
    [[nodiscard]] Vec along_course(double x, double y, double z = 0.0) const
    {
        return x * x_ + y * Vec(-x_.y(), x_.x(), 0.0) + Vec(0.0, 0.0, z);
    }

private:
    Vec home_;
    Vec x_;
    double height_;
};

using Items = std::vector<Item>;

[[nodiscard]] inline Item waypoint(const Vec& place) { return {ItemKind::waypoint, place, 0.0, 0}; }

/// Time at which the intruder reaches the vehicle [s].
struct Times {
    double from, to;
};

/// Limits of ArduPlane in the simulator, and the co-processor's parameters for it (docs/guides/setup.md).
void set_plane(Scenario& scenario);
/// A plane's flight of the behaviour: its items, its start and its mode.
[[nodiscard]] Times lay_out_plane(Behaviour behaviour, const Field& field, Scenario& scenario, NominalFlight& flight);

}  // namespace jink::sim::detail
