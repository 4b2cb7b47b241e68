// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>

#include "firmware/link/mavlink/parser.hpp"
#include "tests/target/board/debugger.hpp"
#include "toolchain/sim/board_line.hpp"
#include "toolchain/sim/child.hpp"
#include "toolchain/sim/hold_up.hpp"
#include "toolchain/sim/plant.hpp"

namespace jink::target {

/// A flight image in an emulated board, its debugger, and the simulator's autopilot at the other end of its line.
/// Everything that the board says is kept, with the plant's time, which is the board's: a machine with other work makes
/// the flight longer and no step late. From a fault on, until the board that started anew tells its time, it is the
/// wall's.
class Board {
public:
    struct Heard {
        double time;
        link::mavlink::Header from;
        std::uint32_t id;
        std::array<std::byte, link::mavlink::kMaxPayload> payload;
    };

    /// The board stands still before its first instruction.
    Board(const std::filesystem::path& image, const std::string& machine, const sim::Scenario& scenario,
          const std::filesystem::path& folder);

    /// Flies on until `until()` or the plant's time `limit` [s]; false at the limit.
    template <class Condition>
    bool fly_until(Condition until, double limit)
    {
        while (!until() && seconds() < limit) {
            tick();
        }
        return until();
    }
    void fly_for(double seconds_more)
    {
        const double end = seconds() + seconds_more;
        static_cast<void>(fly_until([] { return false; }, end));
    }

    /// Lets the processor run until it comes to `address`, while the plant flies on; false at the limit. It stands
    /// there.
    bool run_to(std::uint32_t address, double limit);
    /// Has it execute these Thumb instructions from `address` on, from where it stands.
    void execute(const std::vector<std::uint16_t>& instructions, std::uint32_t address);

    /// The one symbol whose (mangled) name contains `part`, or is it. @throws std::runtime_error
    [[nodiscard]] std::uint32_t symbol(const std::string& part) const;
    /// A ground station's wish.
    void ask_for_mission();

    [[nodiscard]] double seconds() const { return static_cast<double>(plant_.now()) * 1e-6; }
    [[nodiscard]] sim::Plant& plant() { return plant_; }
    [[nodiscard]] Debugger& debugger() { return *debugger_; }
    [[nodiscard]] const std::vector<Heard>& heard() const { return heard_; }
    /// What was lost on the way by this machine.
    [[nodiscard]] std::uint64_t dropped() const { return line_.dropped(); }
    /// How long this machine kept the emulator from running, the longest [s]. Beyond HoldUp::kStall the board's clock
    /// has leapt while it waited: its watchdog may have bitten, and what the flight shows says nothing.
    [[nodiscard]] double held_up() const { return hold_up_.longest(); }
    [[nodiscard]] const link::mavlink::ParserDiagnostics& parser() const { return parser_.diagnostics(); }

private:
    void tick();

    sim::BoardLine line_;
    sim::Plant plant_;
    std::unique_ptr<sim::Child> qemu_;
    std::unique_ptr<Debugger> debugger_;
    sim::HoldUp hold_up_;
    std::map<std::string, std::uint32_t> symbols_;
    link::mavlink::Parser parser_;
    std::vector<Heard> heard_;
    std::chrono::steady_clock::time_point moved_;  ///< when the plant last did
};

}  // namespace jink::target
