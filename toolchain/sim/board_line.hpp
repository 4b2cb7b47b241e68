// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <optional>

#include "firmware/link/mavlink/parser.hpp"
#include "toolchain/sim/datagram_line.hpp"
#include "toolchain/sim/frame_writer.hpp"
#include "toolchain/sim/vec.hpp"

namespace jink::sim {

/// What a board's own clock says, in the time of the plant that flies with it. An emulator keeps no pace with the
/// wall's clock where the machine has other work; flown by the board's clock, such a flight takes longer and is the
/// same.
///
/// Pure: the wall's time comes in [s].
class BoardClock {
public:
    /// The board's clock stood at `board` [us] when a step of it began; heard at `wall`, the plant standing at `plant`.
    void tell(Micros board, Micros plant, double wall);
    /// The board is about to start anew, or to fall silent: by the wall's clock, until its new life tells one.
    void let_go(Micros plant, double wall);
    /// Where the plant is to be now [us]. Beyond what was told it goes on by the wall for one step of the board, then
    /// waits; after kDeaf it goes on by the wall: a board that is dead holds up nobody.
    [[nodiscard]] Micros due(Micros plant, double wall);

    /// By the wall's clock at present.
    [[nodiscard]] bool is_free() const noexcept { return !bound_; }
    /// How often it had to be gone on without the board.
    [[nodiscard]] unsigned times_deaf() const noexcept { return times_deaf_; }

    /// Silence that no machine explains that runs at all [s].
    static constexpr double kDeaf = 2.0;
    static constexpr Micros kStepOfBoard = 20'000;
    /// Answers of the life before may still be under way: no further on than this [us].
    static constexpr Micros kAfterlife = 3 * kStepOfBoard;

private:
    bool begun_ = false;
    bool bound_ = false;
    bool restarts_ = false;  ///< let go, and no answer of the new life yet
    Micros last_ = -1;       ///< what the board told last
    Micros offset_ = 0;      ///< plant's time less the board's
    Micros from_ = 0;        ///< free: the plant's time at `wall_`
    double wall_ = 0.0;      ///< when it was told, or let go
    unsigned times_deaf_ = 0;
};

/// The UART of an emulated board: datagrams, as qemu takes them whole, and the plant's time kept with the board's by
/// asking for it with TIMESYNC, in the autopilot's name.
class BoardLine {
public:
    /// qemu's options for the line, and for a clock that counts instructions: 8 ns each; while the board waits, its
    /// time goes on as the wall's.
    [[nodiscard]] std::vector<std::string> options() const;

    /// What the board said since the last call. `plant`: the plant's time.
    [[nodiscard]] std::vector<std::byte> listen(Micros plant);
    /// Queues telemetry.
    void say(std::span<const std::byte> bytes);
    /// Sends what is queued, as far as the emulator takes it, and asks for the time.
    void flush();

    /// Where the plant is to be now.
    [[nodiscard]] Micros due(Micros plant) { return clock_.due(plant, wall()); }
    void let_go(Micros plant) { clock_.let_go(plant, wall()); }
    [[nodiscard]] const BoardClock& clock() const noexcept { return clock_; }
    /// Datagrams lost by this machine, not by the board.
    [[nodiscard]] std::uint64_t dropped() const { return line_.dropped(); }

    /// Since the line began [s].
    [[nodiscard]] double wall() const;

private:
    DatagramLine line_;
    BoardClock clock_;
    link::mavlink::Parser parser_{nullptr, link::mavlink::LongerPayload::accept};
    FrameWriter writer_;
    std::vector<std::byte> waiting_;
    double asked_ = 0.0;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace jink::sim
