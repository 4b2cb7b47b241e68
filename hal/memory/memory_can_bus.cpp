// SPDX-License-Identifier: BSD-3-Clause
#include "hal/memory/memory_can_bus.hpp"

#include <algorithm>

namespace jink::hal {
namespace {

constexpr std::uint32_t kMillion = 1'000'000;

[[nodiscard]] constexpr std::int64_t bits_of(const CanFrame& frame) noexcept
{
    return 80 + 10 * (frame.remote ? 0 : static_cast<std::int64_t>(frame.length));
}

/// As on the wire: an 11-bit identifier has precedence over a 29-bit one with the same beginning.
[[nodiscard]] constexpr std::uint32_t rank_of(const CanFrame& frame) noexcept
{
    return frame.extended ? frame.id << 1U | 1U : frame.id << 19U;
}

}  // namespace

MemoryCanBus::MemoryCanBus(Clock& clock, std::uint64_t seed, std::uint32_t bit_rate) noexcept
    : clock_(clock), random_state_(seed), bit_rate_(bit_rate)
{
    for (Port& port : ports_) {
        port.bus_ = this;
        port.health_.state = CanState::active;
    }
}

// SplitMix64 (Steele, Lea & Flood 2014), as in memory_serial_link.cpp.
bool MemoryCanBus::chance(std::uint32_t per_million) noexcept
{
    random_state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = random_state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return (z ^ (z >> 31U)) % kMillion < per_million;
}

/// The port that sends next, and the time at which its frame begins; nullptr: no frame waits.
MemoryCanBus::Port* MemoryCanBus::next(std::int64_t& begin) noexcept
{
    begin = INT64_MAX;
    for (const Port& port : ports_) {
        if (port.to_send_.size > 0) {
            begin = std::min(begin, port.to_send_.front().due_us);
        }
    }
    begin = std::max(begin, free_us_);
    Port* chosen = nullptr;
    for (Port& port : ports_) {
        if (port.to_send_.size == 0 || port.to_send_.front().due_us > begin) {
            continue;
        }
        if (chosen == nullptr || rank_of(port.to_send_.front().frame) < rank_of(chosen->to_send_.front().frame)) {
            chosen = &port;
        }
    }
    return chosen;
}

void MemoryCanBus::deliver(Port& from, std::int64_t at) noexcept
{
    const CanFrame& frame = from.to_send_.front().frame;
    for (Port& to : ports_) {
        // Always two random numbers per receiver: switching a fault on changes its own frames, not the random sequence
        // after them.
        const bool lost = chance(faults_.loss_per_million);
        const int copies = chance(faults_.duplicate_per_million) ? 2 : 1;
        if (&to == &from || !to.takes_part() || lost) {
            continue;
        }
        for (int i = 0; i < copies; ++i) {
            if (to.received_.size >= std::min(faults_.receive_frames, kMemoryCanFrames)) {
                ++to.health_.overruns;
            } else {
                to.received_.push({frame, at});
            }
        }
    }
    from.to_send_.pop();
}

void MemoryCanBus::run() noexcept
{
    const std::int64_t now = clock_.now_us();
    std::int64_t begin = 0;
    while (Port* const port = next(begin)) {
        const std::int64_t end = begin + bits_of(port->to_send_.front().frame) * kMillion / bit_rate_;
        if (faults_.unacknowledged || end > now) {
            free_us_ = faults_.unacknowledged ? now : free_us_;
            return;
        }
        free_us_ = end;
        deliver(*port, end);
    }
}

bool MemoryCanBus::Port::receive(CanFrame& frame) noexcept
{
    bus_->run();
    if (received_.size == 0) {
        return false;
    }
    frame = received_.front().frame;
    received_.pop();
    ++health_.frames_in;
    return true;
}

bool MemoryCanBus::Port::send(const CanFrame& frame) noexcept
{
    bus_->run();
    if (!is_valid(frame) || frame.fd) {
        ++health_.frames_bad;
        return false;
    }
    if (!takes_part() || to_send_.size >= std::min(bus_->faults_.transmit_frames, kMemoryCanFrames)) {
        ++health_.frames_refused;
        return false;
    }
    to_send_.push({frame, bus_->clock_.now_us()});
    ++health_.frames_out;
    return true;
}

void MemoryCanBus::Port::become(CanState state) noexcept
{
    bus_->run();
    const CanState before = health_.state;
    if (state == before) {
        return;
    }
    health_.downs += state == CanState::down ? 1U : 0U;
    health_.ups += before == CanState::down ? 1U : 0U;
    health_.bus_offs += state == CanState::bus_off ? 1U : 0U;
    health_.restarts += before == CanState::bus_off ? 1U : 0U;
    health_.state = state;
    if (!takes_part()) {
        to_send_.size = received_.size = 0;
    }
}

}  // namespace jink::hal
