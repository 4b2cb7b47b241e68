// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "toolchain/sim/running_daemon.hpp"
#include "toolchain/sim/swarm.hpp"

namespace jink::sim {
namespace {

/// A jinkd, its line and the line's pending output.
struct Runner {
    explicit Runner(const std::vector<std::string>& before, const std::filesystem::path& folder,
                    const std::string& name)
        : child(arguments(before, line, folder / (name + ".json")), folder / (name + ".log"))
    {
    }
    static std::vector<std::string> arguments(std::vector<std::string> command, const PseudoTerminal& line,
                                              const std::filesystem::path& summary)
    {
        command.insert(command.end(), {"--serial", line.path(), "--summary", summary.string()});
        return command;
    }
    void write(std::span<const std::byte> bytes)
    {
        waiting.insert(waiting.end(), bytes.begin(), bytes.end());
        waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(line.write(waiting)));
    }

    PseudoTerminal line;
    std::vector<std::byte> waiting;
    Child child;
};

void write_parameters(const app::Parameters& parameters, const std::filesystem::path& file)
{
    std::ofstream out(file);
    out.precision(9);
    for (std::size_t i = 0; i < app::kParamCount; ++i) {
        out << app::param_table()[i].name << ',' << parameters.values()[i] << '\n';
    }
    out.close();
    if (!out) {
        throw std::runtime_error(file.string() + " cannot be written");
    }
}

/// Flies in real time until the swarm is finished or a program has ended.
void fly_on_time(Swarm& swarm, std::vector<std::unique_ptr<Runner>>& runners)
{
    auto next = std::chrono::steady_clock::now();
    while (!swarm.finished()) {
        next += std::chrono::microseconds(kStep);
        std::this_thread::sleep_until(next);
        for (std::size_t i = 0; i < swarm.size(); ++i) {
            swarm.plant(i).deliver(runners[i]->line.read());
        }
        swarm.step();
        for (std::size_t i = 0; i < swarm.size(); ++i) {
            runners[i]->write(swarm.plant(i).collect());
            if (!runners[i]->child.running()) {
                swarm.note_fault(i, "the program ended in flight: " + runners[i]->child.ending());
                return;
            }
        }
    }
}

}  // namespace

SwarmResult fly_swarm_of_daemons(const SwarmSetup& setup, std::uint64_t seed, const std::filesystem::path& program,
                                 const std::filesystem::path& folder)
{
    const std::filesystem::path file = folder / "parameters.csv";
    write_parameters(swarm_parameters(setup), file);
    const bool first = go_first();
    Swarm swarm(setup, seed);
    std::vector<std::unique_ptr<Runner>> runners;
    for (std::size_t i = 0; i < swarm.size(); ++i) {
        const std::string id = std::to_string(i + 1);
        std::vector<std::string> command{program.string(), "--system-id",     id, "--params",
                                         file.string(),    "--status-period", "1"};
        if (first) {
            command.insert(command.end(), {"--realtime", std::to_string(kDaemonPriority)});
        }
        runners.push_back(std::make_unique<Runner>(command, folder, "seed_" + std::to_string(seed) + "_vehicle_" + id));
    }
    bool alive = true;
    for (std::size_t i = 0; i < swarm.size(); ++i) {
        if (!wait_for_life(runners[i]->child, runners[i]->line, swarm.plant(i))) {
            swarm.note_fault(i, "the program did not start");
            alive = false;
        }
    }
    if (alive) {
        fly_on_time(swarm, runners);
    }
    SwarmResult result = swarm.result();
    for (std::size_t i = 0; i < swarm.size() && alive; ++i) {
        if (runners[i]->child.running()) {
            std::vector<std::string> faults;
            stop_daemon(runners[i]->child, runners[i]->line, swarm.plant(i), faults);
            for (const std::string& fault : faults) {
                result.faults.push_back("vehicle " + std::to_string(i + 1) + ": " + fault);
            }
        }
    }
    return result;
}

}  // namespace jink::sim
