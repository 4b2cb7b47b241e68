// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/board_line.hpp"

#include <algorithm>

#include "firmware/link/mavlink/messages.hpp"

namespace jink::sim {
namespace {

/// Interval between time requests [s].
constexpr double kAskEvery = 0.01;
/// Marks our requests, to distinguish them from the requests of the simulator's autopilot.
constexpr std::int64_t kMark = std::int64_t{1} << 62;
/// Largest datagram [bytes]; the line carries 460 bytes in 5 ms.
constexpr std::size_t kPiece = 200;

}  // namespace

void BoardClock::tell(Micros board, Micros plant, double wall)
{
    const bool again = board == last_;  // another answer of the same step
    const bool late = restarts_ && board > last_ && board <= last_ + kAfterlife;
    if (again || late) {
        return;
    }
    if (!bound_ || board < last_) {
        offset_ = plant - board;
    }
    bound_ = begun_ = true;
    restarts_ = false;
    last_ = board;
    wall_ = wall;
}

void BoardClock::let_go(Micros plant, double wall)
{
    bound_ = false;
    begun_ = restarts_ = true;
    from_ = plant;
    wall_ = wall;
}

Micros BoardClock::due(Micros plant, double wall)
{
    const bool deaf = bound_ && wall - wall_ > kDeaf;
    if (!begun_ || deaf) {
        times_deaf_ += deaf ? 1U : 0U;
        let_go(plant, wall);
        restarts_ = false;
    }
    const Micros since = to_micros(wall - wall_);
    return bound_ ? offset_ + last_ + std::min(since, kStepOfBoard) : from_ + since;
}

std::vector<std::string> BoardLine::options() const
{
    std::vector<std::string> options = line_.options();
    options.insert(options.end(), {"-icount", "shift=3,sleep=on"});
    return options;
}

double BoardLine::wall() const
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

std::vector<std::byte> BoardLine::listen(Micros plant)
{
    std::vector<std::byte> heard = line_.take();
    std::span<const std::byte> bytes = heard;
    while (const auto frame = parser_.next(bytes)) {
        link::mavlink::Timesync sync;
        if (link::mavlink::decode(*frame, sync) && sync.tc1 != 0 && sync.ts1 == kMark) {
            clock_.tell(sync.tc1 / 1000, plant, wall());
        }
    }
    return heard;
}

void BoardLine::say(std::span<const std::byte> bytes) { waiting_.insert(waiting_.end(), bytes.begin(), bytes.end()); }

void BoardLine::flush()
{
    if (const double now = wall(); now - asked_ >= kAskEvery && line_.may_send()) {
        asked_ = now;
        writer_.write(link::mavlink::Timesync{0, kMark, 0, 0});
        say(writer_.bytes());
        writer_.bytes().clear();
    }
    while (!waiting_.empty() && line_.may_send()) {
        const std::size_t n = std::min(kPiece, waiting_.size());
        line_.send(std::span<const std::byte>(waiting_).first(n));
        waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(n));
    }
}

}  // namespace jink::sim
