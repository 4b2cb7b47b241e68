// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>

#include "core/base/random.hpp"
#include "toolchain/sim/truth_vehicle.hpp"
#include "toolchain/sim/vec.hpp"

namespace jink::sim {

/// The estimator's errors. All 0: the own state is exact.
struct OwnSensor {
    double latency = 0.0;        ///< age of the reported state [s]
    double bias = 0.0;           ///< of the position, level, per axis: standard deviation [m]
    double bias_vertical = 0.0;  ///< the same of the height: the barometer's drift [m]
    double bias_time = 60.0;     ///< correlation time of both (Gauss-Markov) [s]
};

/// Gusts by the Dryden model of MIL-F-8785C for low altitudes (below 1000 ft).
struct Wind {
    double at_20_ft = 0.0;  ///< wind speed 6.1 m above the ground, sets the gust intensity [m/s]; 0: calm
};

/// The autopilot's estimate of its own motion. The same seed gives the same errors, independent of the calls.
class OwnEstimate {
public:
    OwnEstimate(const OwnSensor& sensor, std::uint64_t seed);

    /// Advances by one kStep. O(1).
    void step(const Truth& truth);
    [[nodiscard]] const Truth& reported() const noexcept { return reported_; }
    [[nodiscard]] const Vec& bias() const noexcept { return bias_; }

private:
    OwnSensor sensor_;
    Random random_;
    Vec bias_ = Vec::Zero();
    std::deque<Truth> past_;
    Truth reported_;
};

/// Gust velocities along the axes of the flight: along, across, up. Spectra: u of first order, v and w of second.
class Gusts {
public:
    Gusts(const Wind& wind, std::uint64_t seed);

    /// Advances by one kStep, at a height above the ground [m] and an airspeed [m/s]. O(1).
    void step(double height, double airspeed);
    /// Gust velocity in the axes of a vehicle with this course [m/s].
    [[nodiscard]] Vec velocity(double course) const;
    [[nodiscard]] bool is_calm() const noexcept { return wind_.at_20_ft <= 0.0; }

private:
    /// (1 + sqrt(3) tau s) / (1 + tau s)^2 driven by white noise.
    struct Second {
        double x = 0.0;
        double rate = 0.0;
        double y = 0.0;
        void step(double noise, double tau, double sigma, double dt);
    };

    Wind wind_;
    Random random_;
    double along_ = 0.0;
    Second across_;
    Second up_;
};

}  // namespace jink::sim
