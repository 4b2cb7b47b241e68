// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/timing.hpp"

#include <algorithm>

namespace jink::sim {
namespace {

constexpr Micros kTick = 20'000;

Micros between(Random& random, Micros least, Micros most)
{
    return least + static_cast<Micros>(random.below(static_cast<std::uint64_t>(most - least) + 1U));
}

Micros held_up(Random& random, const Timing& timing)
{
    const bool is = static_cast<double>(random.uniform()) < timing.held_up_share;
    const Micros by = between(random, timing.held_up_least, timing.held_up_most);
    return is ? by : 0;
}

}  // namespace

Timing timing_of(std::uint64_t seed, const Spread& spread, Micros scan_period, Micros traffic_period)
{
    Random random(seed);
    Timing timing;
    timing.seed = random.next();
    timing.first_tick = between(random, 0, kTick - 1);
    timing.tick_jitter = 2'000;
    timing.held_up_share = spread.held_up_share;
    timing.held_up_least = 20'000;
    timing.held_up_most = spread.held_up_most;
    timing.latency_least = 400;
    timing.latency_most = 6'000;
    // On the plant's time grid: a phase between two plant steps would be missed.
    const Micros scan = between(random, 0, scan_period / kStep - 1) * kStep;
    const Micros traffic = between(random, 0, traffic_period / kStep - 1) * kStep;
    if (spread.sensors) {
        timing.scan_phase = scan;
        timing.traffic_phase = traffic;
    }
    return timing;
}

void Ticks::draw() { begins_ = next_ + between(random_, 0, timing_.tick_jitter) + held_up(random_, timing_); }

void Ticks::begin()
{
    next_ = std::max(next_ + kTick, begins_);
    draw();
}

Micros Delays::next()
{
    return between(random_, timing_.latency_least, timing_.latency_most) + held_up(random_, timing_);
}

}  // namespace jink::sim
