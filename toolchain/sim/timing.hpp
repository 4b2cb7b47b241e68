// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/random.hpp"
#include "toolchain/sim/vec.hpp"

namespace jink::sim {

/// Timing of a flight in process. Defaults: everything on time, the same in every flight.
struct Timing {
    std::uint64_t seed = 0;       ///< of the random numbers drawn in flight
    Micros first_tick = 20'000;   ///< of the co-processor, after the flight's start, 0..
    Micros tick_jitter = 0;       ///< lateness of each tick, uniform from 0 to this
    double held_up_share = 0.0;   ///< share of ticks, and of writes to the line, that the host delays
    Micros held_up_least = 0;     ///< least delay
    Micros held_up_most = 0;      ///< largest delay; uniform between the two
    Micros latency_least = 1000;  ///< of the line: 921600 baud carry a report of 40 bytes in 0.4 ms, USB adapters add
    Micros latency_most = 1000;   ///< a few; uniform, in order
    Micros scan_phase = 0;        ///< the range scanner's clock against the autopilot's
    Micros traffic_phase = 0;     ///< first sighting after a threat appears
};

/// Variation between flights.
struct Spread {
    bool sensors = true;           ///< vary the sensors' clocks; a real-time flight has fixed ones
    double held_up_share = 0.004;  ///< of ticks, and of pieces of telemetry, [0, 1]
    Micros held_up_most = 60'000;  ///< 20 ms or more
};

/// A random timing: ticks in any phase, 0..2 ms late, some delayed by 20 ms to `held_up_most`; a line of 0.4..6 ms;
/// sensors in any phase of `scan_period` and `traffic_period` [us] if they are varied. The same seed gives the same
/// timing.
[[nodiscard]] Timing timing_of(std::uint64_t seed, const Spread& spread, Micros scan_period, Micros traffic_period);

/// Start times of the co-processor's steps, as paced by jinkd: 20 ms apart; a late step is not caught up.
class Ticks {
public:
    explicit Ticks(const Timing& timing) : timing_(timing), random_(timing.seed), next_(timing.first_tick) { draw(); }

    /// Start of the next step [us since the start of the flight].
    [[nodiscard]] Micros next() const noexcept { return begins_; }
    /// The step has begun.
    void begin();

private:
    void draw();

    Timing timing_;
    Random random_;
    Micros next_;
    Micros begins_ = 0;
};

/// Transit time of the next write [us].
class Delays {
public:
    Delays(const Timing& timing, std::uint64_t line) : timing_(timing), random_(timing.seed ^ line) {}
    [[nodiscard]] Micros next();

private:
    Timing timing_;
    Random random_;
};

}  // namespace jink::sim
