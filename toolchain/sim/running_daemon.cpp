// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/running_daemon.hpp"

#include <chrono>
#include <thread>

#include <pthread.h>
#include <sched.h>

namespace jink::sim {
namespace {

using Clock = std::chrono::steady_clock;

/// Time-out: a working program starts and stops much faster on any host.
constexpr auto kStartTime = std::chrono::seconds(60);
constexpr auto kStopTime = std::chrono::seconds(30);
constexpr auto kNap = std::chrono::milliseconds(2);

}  // namespace

bool wait_for_life(Child& child, PseudoTerminal& line, Plant& plant)
{
    for (const auto until = Clock::now() + kStartTime; Clock::now() < until && child.running();) {
        const auto bytes = line.read();
        if (!bytes.empty()) {
            plant.deliver(bytes);
            return true;
        }
        std::this_thread::sleep_for(kNap);
    }
    return false;
}

void stop_daemon(Child& child, PseudoTerminal& line, Plant& plant, std::vector<std::string>& faults)
{
    child.ask_to_stop();
    for (const auto until = Clock::now() + kStopTime; Clock::now() < until && child.running();) {
        plant.deliver(line.read());
        std::this_thread::sleep_for(kNap);
    }
    plant.deliver(line.read());
    if (child.running()) {
        faults.emplace_back("jinkd does not stop on SIGTERM");
        return;
    }
    if (!child.ending().empty()) {
        faults.push_back("jinkd: " + child.ending());
    }
    constexpr int kCritical = 5;
    if (plant.autopilot().heard().state != kCritical) {
        faults.emplace_back("jinkd stopped without saying so");
    }
}

bool go_first()
{
    sched_param param{};
    param.sched_priority = kOwnPriority;
    return ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &param) == 0;
}

}  // namespace jink::sim
