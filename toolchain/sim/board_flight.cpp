// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/board_flight.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "toolchain/sim/board_line.hpp"
#include "toolchain/sim/child.hpp"
#include "toolchain/sim/hold_up.hpp"
#include "toolchain/sim/plant.hpp"

namespace jink::sim {
namespace {

using Clock = std::chrono::steady_clock;

/// Polling interval of the line.
constexpr auto kNap = std::chrono::microseconds(500);
/// Start-up time-out: a working emulator sends its first bytes much earlier on any host.
constexpr auto kStartTime = std::chrono::seconds(60);

bool wait_for_life(Child& child, BoardLine& line, Plant& plant)
{
    for (const auto until = Clock::now() + kStartTime; Clock::now() < until && child.running();) {
        const std::vector<std::byte> bytes = line.listen(plant.now());
        if (!bytes.empty()) {
            plant.deliver(bytes);
            return true;
        }
        std::this_thread::sleep_for(kNap);
    }
    return false;
}

void fly(Plant& plant, BoardLine& line, Child& child, Record& notes)
{
    HoldUp hold_up;
    while (!plant.finished()) {
        std::this_thread::sleep_for(kNap);
        hold_up.watch(child, line.wall());
        notes.held_up = hold_up.longest();
        plant.deliver(line.listen(plant.now()));
        const Micros due = line.due(plant.now());
        notes.late_steps += due - plant.now() > BoardClock::kStepOfBoard ? 1U : 0U;
        notes.latest_step = std::max(notes.latest_step, to_seconds(due - plant.now()));
        for (Micros i = 0; i < BoardClock::kStepOfBoard && plant.now() + kStep <= due; i += kStep) {
            plant.step();
            line.say(plant.collect());
        }
        line.flush();
        if (!child.running()) {
            notes.faults.push_back("the emulator ended in flight: " + child.ending());
            return;
        }
    }
}

}  // namespace

Record fly_board_once(const Scenario& scenario, const Computer& computer, const std::filesystem::path& folder)
{
    BoardLine line;
    std::vector<std::string> command{"qemu-system-arm", "-M",   computer.machine, "-nographic",
                                     "-monitor",        "none", "-kernel",        computer.program.string()};
    for (const std::string& option : line.options()) {
        command.push_back(option);
    }
    Plant plant(scenario);
    Record notes;
    Child child(command, folder / (scenario.name + ".log"));
    if (wait_for_life(child, line, plant)) {
        fly(plant, line, child, notes);
    } else {
        notes.faults.push_back(child.running() ? "the board says nothing"
                                               : "the emulator did not start: " + child.ending());
    }
    Record record = plant.record();
    record.faults.insert(record.faults.end(), notes.faults.begin(), notes.faults.end());
    record.late_steps = notes.late_steps;
    record.latest_step = notes.latest_step;
    record.held_up = notes.held_up;
    if (line.clock().times_deaf() > 0) {
        record.faults.emplace_back("the board told no time for a while");
        record.latest_step = std::max(record.latest_step, BoardClock::kDeaf);
    }
    if (line.dropped() > 0) {
        record.faults.push_back("this machine lost " + std::to_string(line.dropped()) + " datagrams of the line");
        record.latest_step = std::max(record.latest_step, BoardClock::kDeaf);
    }
    return record;
}

}  // namespace jink::sim
