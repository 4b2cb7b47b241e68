// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <optional>

#include "firmware/link/mavlink/parser.hpp"
#include "toolchain/sim/datagram_line.hpp"
#include "toolchain/sim/frame_writer.hpp"
#include "toolchain/sim/vec.hpp"

namespace jink::sim {

/// Maps an emulated board's clock to the plant's time. On a loaded host an emulator falls behind wall time. Paced by
/// the board's clock, such a flight takes longer and has the same result.
///
/// Pure: wall time is an argument [s].
class BoardClock {
public:
    /// Sets the board's clock: `board` [us] at the start of a board step, received at wall time `wall` and plant time
    /// `plant`.
    void tell(Micros board, Micros plant, double wall);
    /// The board is about to restart or to fall silent: follows wall time until the restarted board reports its clock.
    void let_go(Micros plant, double wall);
    /// Plant time that is due now [us]. Follows wall time for one board step past the last report, then waits. After
    /// kDeaf without a report it follows wall time again: a dead board does not block the flight.
    [[nodiscard]] Micros due(Micros plant, double wall);

    /// True while wall time is followed.
    [[nodiscard]] bool is_free() const noexcept { return !bound_; }
    /// Number of times kDeaf elapsed without a report.
    [[nodiscard]] unsigned times_deaf() const noexcept { return times_deaf_; }

    /// Silence longer than any host delay [s].
    static constexpr double kDeaf = 2.0;
    static constexpr Micros kStepOfBoard = 20'000;
    /// Answers from before a restart may still be in transit: their clock exceeds the last one by at most this [us].
    static constexpr Micros kAfterlife = 3 * kStepOfBoard;

private:
    bool begun_ = false;
    bool bound_ = false;
    bool restarts_ = false;  ///< let go, and no answer since the restart
    Micros last_ = -1;       ///< last clock value that the board reported
    Micros offset_ = 0;      ///< plant's time less the board's
    Micros from_ = 0;        ///< free: the plant's time at `wall_`
    double wall_ = 0.0;      ///< wall time of the last report, or of let_go()
    unsigned times_deaf_ = 0;
};

/// The UART of an emulated board, carried in datagrams. Synchronises the plant with the board's clock by TIMESYNC
/// requests in the autopilot's name.
class BoardLine {
public:
    /// qemu's options for the line, and for a clock that counts instructions: 8 ns each. While the board waits, its
    /// clock follows wall time.
    [[nodiscard]] std::vector<std::string> options() const;

    /// Bytes from the board since the last call. `plant`: the plant's time.
    [[nodiscard]] std::vector<std::byte> listen(Micros plant);
    /// Queues telemetry.
    void say(std::span<const std::byte> bytes);
    /// Sends queued bytes as far as the emulator takes them, and requests the time.
    void flush();

    /// Plant time that is due now.
    [[nodiscard]] Micros due(Micros plant) { return clock_.due(plant, wall()); }
    void let_go(Micros plant) { clock_.let_go(plant, wall()); }
    [[nodiscard]] const BoardClock& clock() const noexcept { return clock_; }
    /// Datagrams lost by the host, not by the board.
    [[nodiscard]] std::uint64_t dropped() const { return line_.dropped(); }

    /// Wall time since the line began [s].
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
