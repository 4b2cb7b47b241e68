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
#include "toolchain/sim/frame_writer.hpp"
#include "toolchain/sim/hold_up.hpp"
#include "toolchain/sim/plant.hpp"

namespace jink::target {

/// A flight image in an emulated board, its debugger, and the simulator's autopilot at the other end of its line.
/// Records all board output with the plant's time, which is the board's: load on the host makes the flight longer but
/// no step late. From a fault until the restarted board reports its time, the plant follows wall time.
class Board {
public:
    struct Heard {
        double time;
        link::mavlink::Header from;
        std::uint32_t id;
        std::array<std::byte, link::mavlink::kMaxPayload> payload;
    };

    /// The board is halted before its first instruction.
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

    /// Runs the processor to `address`, while the plant flies on; false at the limit. The processor is then halted.
    bool run_to(std::uint32_t address, double limit);
    /// Makes the halted processor execute these Thumb instructions, placed at `address`.
    void execute(const std::vector<std::uint16_t>& instructions, std::uint32_t address);

    /// The one symbol whose (mangled) name contains `part`, or is it. @throws std::runtime_error
    [[nodiscard]] std::uint32_t symbol(const std::string& part) const;
    /// A ground station's request.
    void ask_for_mission();
    /// Of a ground station, to the board.
    template <link::mavlink::Message M>
    void say(M message)
    {
        message.target_system = sim::kAutopilot.system;
        message.target_component = 196;
        ground_.write(message, sim::kGroundStation);
        line_.say(ground_.bytes());
        ground_.bytes().clear();
    }

    [[nodiscard]] double seconds() const { return static_cast<double>(plant_.now()) * 1e-6; }
    [[nodiscard]] sim::Plant& plant() { return plant_; }
    [[nodiscard]] Debugger& debugger() { return *debugger_; }
    [[nodiscard]] const std::vector<Heard>& heard() const { return heard_; }
    /// Bytes lost by the host.
    [[nodiscard]] std::uint64_t dropped() const { return line_.dropped(); }
    /// Longest delay of the emulator by the host [s]. Beyond HoldUp::kStall the board's clock has jumped while it
    /// waited: its watchdog may have fired, and the flight is inconclusive.
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
    sim::FrameWriter ground_;
    link::mavlink::Parser parser_;
    std::vector<Heard> heard_;
    std::chrono::steady_clock::time_point moved_;  ///< when the plant last did
};

}  // namespace jink::target
