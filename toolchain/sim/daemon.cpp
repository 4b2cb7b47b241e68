// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/daemon.hpp"

#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include <nlohmann/json.hpp>

#include "toolchain/sim/child.hpp"
#include "toolchain/sim/plant.hpp"

namespace jink::sim {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;

/// A step that begins this much too late is counted: the co-processor has then seen a gap and a burst.
constexpr auto kLate = microseconds(20'000);
constexpr auto kStartTime = std::chrono::seconds(10);
constexpr auto kStopTime = std::chrono::seconds(3);
constexpr auto kNap = std::chrono::milliseconds(2);

/// Until its first bytes: it runs and has opened the line.
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

/// Flies in step with the wall clock.
void fly_on_time(Plant& plant, PseudoTerminal& line, Child& child, Record& notes)
{
    auto next = Clock::now();
    std::vector<std::byte> waiting;
    while (!plant.finished()) {
        next += microseconds(kStep);
        std::this_thread::sleep_until(next);
        notes.late_steps += Clock::now() - next > kLate ? 1U : 0U;
        plant.deliver(line.read());
        plant.step();
        const std::vector<std::byte> fresh = plant.collect();
        waiting.insert(waiting.end(), fresh.begin(), fresh.end());
        waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(line.write(waiting)));
        if (!child.running()) {
            notes.faults.push_back("jinkd ended in flight: " + child.ending());
            return;
        }
    }
}

void stop(Child& child, PseudoTerminal& line, Plant& plant, Record& notes)
{
    child.ask_to_stop();
    for (const auto until = Clock::now() + kStopTime; Clock::now() < until && child.running();) {
        plant.deliver(line.read());
        std::this_thread::sleep_for(kNap);
    }
    plant.deliver(line.read());
    if (child.running()) {
        notes.faults.emplace_back("jinkd does not stop on SIGTERM");
        return;
    }
    if (!child.ending().empty()) {
        notes.faults.push_back("jinkd: " + child.ending());
    }
    constexpr int kCritical = 5;
    if (plant.autopilot().heard().state != kCritical) {
        notes.faults.emplace_back("jinkd stopped without saying so");
    }
}

/// What the program says of itself, as far as a record has a place for it.
std::optional<Inside> read_summary(const std::filesystem::path& file)
{
    std::ifstream in(file);
    const auto json = nlohmann::json::parse(in, nullptr, false);
    if (!json.is_object()) {
        return std::nullopt;
    }
    const auto count = [&](const char* key) { return json.value(key, 0U); };
    Inside inside;
    inside.steps = {count("steps"), json.value("step_mean_us", 0.0), json.value("step_max_us", 0.0)};
    inside.plan_steps = {count("plan_steps"), json.value("plan_step_mean_us", 0.0),
                         json.value("plan_step_max_us", 0.0)};
    inside.conflicts = count("conflicts");
    inside.plans = count("plans");
    inside.plans_found = count("plans_found");
    inside.answers_rejected = count("answers_rejected");
    inside.manoeuvres = count("manoeuvres");
    inside.replans = count("replans");
    inside.flips = count("flips");
    inside.brakes = count("brakes");
    inside.escapes = count("escapes");
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

}  // namespace

Record fly_daemon(const Scenario& scenario, const std::filesystem::path& daemon, const std::filesystem::path& folder)
{
    PseudoTerminal line;
    Plant plant(scenario);
    Record notes;
    const std::filesystem::path summary = folder / (scenario.name + ".json");
    std::filesystem::remove(summary);
    {
        Child child({daemon.string(), "--serial", line.path(), "--status-period", "1", "--summary", summary.string()},
                    folder / (scenario.name + ".log"));
        if (wait_for_life(child, line, plant)) {
            fly_on_time(plant, line, child, notes);
            Record record = plant.record();
            record.late_steps = notes.late_steps;
            record.faults.insert(record.faults.end(), notes.faults.begin(), notes.faults.end());
            std::swap(record, notes);
            if (child.running()) {
                stop(child, line, plant, notes);
            }
        } else {
            notes = plant.record();
            notes.faults.push_back(child.running() ? "jinkd says nothing" : "jinkd did not start: " + child.ending());
        }
    }
    notes.transport = "daemon";
    notes.inside = read_summary(summary);
    conclude(scenario, notes);
    return notes;
}

std::vector<Record> fly_daemons(const std::vector<Scenario>& scenarios, const std::filesystem::path& daemon,
                                const std::filesystem::path& folder, unsigned at_once)
{
    std::vector<Record> records(scenarios.size());
    std::atomic<std::size_t> next{0};
    std::vector<std::thread> pilots;
    for (unsigned i = 0; i < at_once; ++i) {
        pilots.emplace_back([&] {
            for (std::size_t k = next++; k < scenarios.size(); k = next++) {
                try {
                    records[k] = fly_daemon(scenarios[k], daemon, folder);
                } catch (const std::exception& e) {
                    records[k].name = scenarios[k].name;
                    records[k].transport = "daemon";
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
