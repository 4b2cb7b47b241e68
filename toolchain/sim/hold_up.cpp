// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/hold_up.hpp"

#include <algorithm>
#include <fstream>
#include <string>

#include <unistd.h>

namespace jink::sim {
namespace {

/// /proc/stat: "cpu user nice system idle iowait irq softirq steal ..." in ticks.
double stolen_time()
{
    constexpr int kStealAt = 8;
    std::ifstream file("/proc/stat");
    std::string name;
    double ticks = 0.0;
    file >> name;
    for (int i = 0; i < kStealAt; ++i) {
        file >> ticks;
    }
    return file ? ticks / static_cast<double>(::sysconf(_SC_CLK_TCK)) : 0.0;
}

}  // namespace

HoldUp::Sample HoldUp::sample(const Child& child, double wall) { return {wall, stolen_time(), child.threads()}; }

void HoldUp::watch(const Child& child, double wall)
{
    if (first_ || wall >= last_.wall + kCheckEvery) {
        static_cast<void>(look(sample(child, wall)));
    }
}

double HoldUp::look(const Sample& now)
{
    double held = 0.0;
    if (!first_) {
        const double gap = now.wall - last_.wall;
        held = std::max(gap > 2.0 * kCheckEvery ? gap : 0.0, now.stolen - last_.stolen);
    }
    for (const auto& [id, thread] : now.threads) {
        const auto before = last_.threads.find(id);
        if (before == last_.threads.end()) {
            continue;
        }
        held = std::max(held, thread.waited - before->second.waited);
        if (thread.ready && thread.ran == before->second.ran) {
            // The first sample that finds the thread runnable may come just before its turn.
            held = std::max(held, now.wall - ready_since_.try_emplace(id, now.wall).first->second);
        } else {
            ready_since_.erase(id);
        }
    }
    first_ = false;
    last_ = now;
    longest_ = std::max(longest_, held);
    return held;
}

}  // namespace jink::sim
