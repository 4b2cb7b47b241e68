// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/daemon.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <numeric>
#include <thread>

#include <nlohmann/json.hpp>

#include "toolchain/sim/board_flight.hpp"
#include "toolchain/sim/child.hpp"
#include "toolchain/sim/hold_up.hpp"
#include "toolchain/sim/plant.hpp"
#include "toolchain/sim/running_daemon.hpp"

namespace jink::sim {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;

/// A step that begins this late is counted: the co-processor then receives a gap and a burst.
constexpr auto kLate = microseconds(20'000);
/// Beyond this delay, a flight that depends on each tenth of a second may end differently than on an unloaded host.
constexpr double kHeldUp = 0.015;  // [s]
constexpr unsigned kAttempts = 4;

/// Flies in real time.
void fly_on_time(Plant& plant, PseudoTerminal& line, Child& child, Record& notes)
{
    auto next = Clock::now();
    std::vector<std::byte> waiting;
    HoldUp hold_up;
    while (!plant.finished()) {
        next += microseconds(kStep);
        std::this_thread::sleep_until(next);
        const auto late = Clock::now() - next;
        notes.late_steps += late > kLate ? 1U : 0U;
        notes.latest_step = std::max(notes.latest_step, std::chrono::duration<double>(late).count());
        if (plant.now() % to_micros(HoldUp::kCheckEvery) == 0) {
            const double wall = std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
            notes.latest_step = std::max(notes.latest_step, hold_up.look(HoldUp::sample(child, wall)));
        }
        plant.deliver(line.read());
        plant.step();
        const std::vector<std::byte> fresh = plant.collect();
        waiting.insert(waiting.end(), fresh.begin(), fresh.end());
        waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(line.write(waiting)));
        if (!child.running()) {
            notes.faults.push_back("the program ended in flight: " + child.ending());
            return;
        }
    }
}

/// The program's own summary, as far as a record has fields for it.
std::optional<Inside> read_summary(const std::filesystem::path& file)
{
    std::ifstream in(file);
    const auto json = nlohmann::json::parse(in, nullptr, false);
    if (!json.is_object()) {
        return std::nullopt;
    }
    const auto count = [&](const char* key) { return json.value(key, 0U); };
    Inside inside;
    inside.steps = {count("steps"), json.value("step_mean_us", 0.0), json.value("step_max_us", 0.0), {}};
    inside.plan_steps = {
        count("plan_steps"), json.value("plan_step_mean_us", 0.0), json.value("plan_step_max_us", 0.0), {}};
    const auto bins = json.value("plan_step_bins_us", nlohmann::json::object());
    for (const auto& [from, times] : bins.items()) {
        constexpr double kHalfBin = 5.0;
        const double middle = std::stod(from) + kHalfBin;
        inside.plan_steps.times.insert(inside.plan_steps.times.end(), times.get<std::size_t>(), middle);
    }
    inside.conflicts = count("conflicts");
    inside.plans = count("plans");
    inside.plans_found = count("plans_found");
    inside.answers_rejected = count("answers_rejected");
    inside.manoeuvres = count("manoeuvres");
    inside.replans = count("replans");
    inside.flips = count("flips");
    inside.brakes = count("brakes");
    inside.escapes = count("escapes");
    inside.holds = count("holds");
    inside.rejoined = count("rejoined");
    inside.budget_spent = count("budget_spent");
    inside.deadlines_missed = count("deadlines_missed");
    inside.setpoints_withheld = count("setpoints_withheld");
    inside.autopilot_reboots = count("autopilot_reboots");
    inside.clock_relocks = count("clock_relocks");
    inside.tracks_refused = count("tracks_refused");
    inside.frames_refused = count("frames_refused");
    inside.stale_stamp = count("stale_stamps");
    return inside;
}

std::string transport_of(const Computer& computer) { return computer.emulated() ? computer.machine : "daemon"; }

std::vector<std::string> command_of(const Computer& computer, const std::string& line,
                                    const std::filesystem::path& summary, bool realtime)
{
    std::vector<std::string> command{computer.program.string(), "--serial", line, "--status-period", "1", "--summary",
                                     summary.string()};
    if (realtime) {
        command.insert(command.end(), {"--realtime", std::to_string(kDaemonPriority)});
    }
    return command;
}

Record fly_daemon_once(const Scenario& scenario, const Computer& computer, const std::filesystem::path& folder)
{
    const std::filesystem::path summary = folder / (scenario.name + ".json");
    std::filesystem::remove(summary);
    PseudoTerminal line;
    const std::vector<std::string> command = command_of(computer, line.path(), summary, go_first());
    Plant plant(scenario);
    Record notes;
    Record record;
    {
        Child child(command, folder / (scenario.name + ".log"));
        if (wait_for_life(child, line, plant)) {
            fly_on_time(plant, line, child, notes);
            record = plant.record();
            if (child.running()) {
                stop_daemon(child, line, plant, notes.faults);
            }
        } else {
            record = plant.record();
            notes.faults.push_back(child.running() ? "the program says nothing"
                                                   : "the program did not start: " + child.ending());
        }
    }
    record.faults.insert(record.faults.end(), notes.faults.begin(), notes.faults.end());
    record.late_steps = notes.late_steps;
    record.latest_step = notes.latest_step;
    record.inside = read_summary(summary);
    return record;
}

Record fly_once(const Scenario& scenario, const Computer& computer, const std::filesystem::path& folder)
{
    Record record =
        computer.emulated() ? fly_board_once(scenario, computer, folder) : fly_daemon_once(scenario, computer, folder);
    record.transport = transport_of(computer);
    conclude(scenario, record);
    return record;
}

/// True for an inconclusive flight: the host stalled, or delayed something in a flight that ended unexpectedly.
bool says_nothing(const Scenario& scenario, const Record& record)
{
    return record.latest_step > HoldUp::kStall ||
           ((record.latest_step > kHeldUp || record.held_up > HoldUp::kStall) && !unmet(scenario, record).empty());
}

}  // namespace

std::string no_input_for(const Scenario& scenario)
{
    if (scenario.planner != PlannerKind::product) {
        return "'planner: source' is flown in process only";
    }
    return scenario.lidar ? "a LiDAR is simulated in process only" : "";
}

Record fly_daemon(const Scenario& scenario, const Computer& computer, const std::filesystem::path& folder)
{
    Record record = fly_once(scenario, computer, folder);
    for (unsigned repeats = 1; repeats < kAttempts && says_nothing(scenario, record); ++repeats) {
        record = fly_once(scenario, computer, folder);
        record.repeats = repeats;
    }
    if (record.latest_step > HoldUp::kStall) {
        record.faults.push_back("the machine stood still for " + std::to_string(record.latest_step) +
                                " s in each attempt");
        record.outcome = Outcome::failed;
    }
    return record;
}

std::vector<Record> fly_daemons(const std::vector<Scenario>& scenarios, const Computer& computer,
                                const std::filesystem::path& folder, unsigned at_once)
{
    for (const Scenario& scenario : scenarios) {
        if (const std::string reason = no_input_for(scenario); !reason.empty()) {
            throw std::runtime_error(scenario.name + ": " + reason);
        }
    }
    // The longest first: none of them begins when the others are about to end.
    std::vector<std::size_t> order(scenarios.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return scenarios[a].duration > scenarios[b].duration; });
    std::vector<Record> records(scenarios.size());
    std::atomic<std::size_t> next{0};
    std::vector<std::thread> pilots;
    for (unsigned pilot = 0; pilot < at_once; ++pilot) {
        pilots.emplace_back([&] {
            for (std::size_t i = next++; i < order.size(); i = next++) {
                const std::size_t k = order[i];
                try {
                    records[k] = fly_daemon(scenarios[k], computer, folder);
                } catch (const std::exception& e) {
                    records[k].name = scenarios[k].name;
                    records[k].transport = transport_of(computer);
                    records[k].faults.emplace_back(e.what());
                }
            }
        });
    }
    for (std::thread& pilot : pilots) {
        pilot.join();
    }
    return records;
}

}  // namespace jink::sim
