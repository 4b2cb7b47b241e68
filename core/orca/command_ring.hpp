// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/vec3.hpp"
#include "core/capacity.hpp"

namespace jink::orca {

/// A velocity command, which holds until the next one.
struct IssuedCommand {
    TimePoint issued;
    Vec3 velocity = Vec3::Zero();  ///< [m/s], world frame
};

/// Why a command is not remembered.
enum class RingStatus : std::uint8_t {
    ok,
    not_finite,  ///< a component is NaN or infinite
    not_later,   ///< issued no later than the newest one: a clock that went back, or the same command twice
};

/// The last kMaxCommands commands as they were emitted, in the order of their times: what a vehicle is still going to
/// do when its newest state is measured (Alejo 8.4, G-ORCA 11.3). Those of a smoothing filter go in behind it.
///
/// When full the oldest is overwritten; nothing is lost without a word, because a prediction whose window begins before
/// the oldest says that it was clipped. Memory: 24 bytes per command.
class CommandRing {
public:
    /// Nothing changes unless the answer is ok. O(1).
    [[nodiscard]] RingStatus add(TimePoint issued, const Vec3& velocity) noexcept
    {
        if (!is_finite(velocity)) {
            return RingStatus::not_finite;
        }
        if (size_ > 0 && issued <= newest().issued) {
            return RingStatus::not_later;
        }
        if (size_ < kMaxCommands) {
            commands_[place(size_++)] = {issued, velocity};
        } else {
            commands_[first_] = {issued, velocity};
            first_ = place(1);
        }
        return RingStatus::ok;
    }

    /// After a pause, a reset or a change of clock: what was commanded before says nothing about what is flown now.
    void clear() noexcept { size_ = 0; }

    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
    /// Command `i` < size(), the oldest first.
    [[nodiscard]] const IssuedCommand& operator[](std::size_t i) const noexcept
    {
        assert(i < size_);
        return commands_[place(i)];
    }
    /// Not empty.
    [[nodiscard]] const IssuedCommand& newest() const noexcept { return (*this)[size_ - 1]; }

private:
    [[nodiscard]] std::size_t place(std::size_t i) const noexcept { return (first_ + i) % kMaxCommands; }

    std::array<IssuedCommand, kMaxCommands> commands_{};
    std::size_t first_ = 0;
    std::size_t size_ = 0;
};

}  // namespace jink::orca
