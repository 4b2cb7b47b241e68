// SPDX-License-Identifier: BSD-3-Clause
#include "hal/memory/memory_serial_link.hpp"

#include <cassert>

namespace jink::hal {

namespace {

constexpr std::uint32_t kMillion = 1'000'000;

}  // namespace

void MemoryLine::set_faults(const LineFaults& faults) noexcept
{
    assert(faults.loss_per_million <= kMillion && faults.corruption_per_million <= kMillion);
    assert(faults.latency_us >= 0 && faults.capacity <= kMemoryLineCapacity);
    faults_ = faults;
}

bool MemoryLine::try_add_stall(StallWindow stall) noexcept
{
    if (stall_count_ == kMaxStalls) {
        return false;
    }
    stalls_[stall_count_++] = stall;
    return true;
}

// SplitMix64 (Steele, Lea & Flood 2014); own copy, because hal does not depend on core.
std::uint64_t MemoryLine::random() noexcept
{
    random_state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = random_state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
}

bool MemoryLine::chance(std::uint32_t per_million) noexcept { return random() % kMillion < per_million; }

bool MemoryLine::stalled(std::int64_t now_us) const noexcept
{
    for (std::size_t i = 0; i < stall_count_; ++i) {
        if (now_us >= stalls_[i].from_us && now_us < stalls_[i].until_us) {
            return true;
        }
    }
    return false;
}

std::size_t MemoryLine::write(std::span<const std::byte> from) noexcept
{
    const std::int64_t due_us = clock_.now_us() + faults_.latency_us;
    std::size_t taken = 0;
    for (const std::byte sent : from) {
        const bool full = size_ >= faults_.capacity;
        if (full && faults_.back_pressure) {
            break;
        }
        ++taken;
        // Always three random numbers per byte: switching a fault on changes its own bytes, not the random sequence
        // after them.
        const bool lost = chance(faults_.loss_per_million);
        const bool corrupted = chance(faults_.corruption_per_million);
        const std::byte flip{static_cast<unsigned char>(1U << (random() % 8U))};
        if (lost) {
            ++counters_.lost;
        } else if (full) {
            ++counters_.overrun;
        } else {
            counters_.corrupted += corrupted ? 1U : 0U;
            ring_[(head_ + size_) % kMemoryLineCapacity] = {due_us, corrupted ? sent ^ flip : sent};
            ++size_;
        }
    }
    counters_.taken += taken;
    return taken;
}

std::size_t MemoryLine::read(std::span<std::byte> into) noexcept
{
    const std::int64_t now_us = clock_.now_us();
    if (stalled(now_us)) {
        return 0;
    }
    std::size_t count = 0;
    while (count < into.size() && size_ > 0 && ring_[head_].due_us <= now_us) {
        into[count++] = ring_[head_].value;
        head_ = (head_ + 1) % kMemoryLineCapacity;
        --size_;
    }
    counters_.delivered += count;
    return count;
}

void MemoryLine::cut() noexcept
{
    counters_.discarded += size_;
    size_ = 0;
}

LineCounters MemoryLine::counters() const noexcept
{
    LineCounters now = counters_;
    now.queued = size_;
    return now;
}

MemorySerialLink::MemorySerialLink(Clock& clock, std::uint64_t seed) noexcept
    : a_to_b_(clock, seed), b_to_a_(clock, ~seed), a_(*this, a_to_b_, b_to_a_), b_(*this, b_to_a_, a_to_b_)
{
}

void MemorySerialLink::disconnect() noexcept
{
    if (connected_) {
        connected_ = false;
        ++disconnects_;
        a_to_b_.cut();
        b_to_a_.cut();
    }
}

void MemorySerialLink::reconnect() noexcept
{
    if (!connected_) {
        connected_ = true;
        ++reconnects_;
    }
}

std::size_t MemorySerialLink::Port::read(std::span<std::byte> into) noexcept
{
    return link_.connected_ ? in_.read(into) : 0;
}

std::size_t MemorySerialLink::Port::write(std::span<const std::byte> from) noexcept
{
    const std::size_t taken = link_.connected_ ? out_.write(from) : 0;
    bytes_refused_ += from.size() - taken;
    return taken;
}

PortHealth MemorySerialLink::Port::health() const noexcept
{
    const LineCounters in = in_.counters();
    PortHealth health;
    health.state = link_.connected_ ? PortState::open : PortState::lost;
    health.bytes_in = in.delivered;
    health.bytes_out = out_.counters().taken;
    health.bytes_refused = bytes_refused_;
    health.overruns = in.overrun;
    health.disconnects = link_.disconnects_;
    health.reconnects = link_.reconnects_;
    return health;
}

}  // namespace jink::hal
