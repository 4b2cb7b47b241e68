// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace jink::link::mavlink {

/// Frames that are only worth sending while they are valid. At most one whole frame of each kind waits.
enum class Perishable : std::uint8_t { no, setpoint, mode_request, heartbeat };
inline constexpr std::size_t kPerishables = 4;

/// Bytes waiting to be written: whole frames are added, any number of bytes is removed. Waiting bytes are always
/// contiguous.
///
/// A perishable frame can be withdrawn as long as none of its bytes has been removed. A partly written frame is never
/// changed, so that the other end's framing survives.
template <std::size_t N>
class TransmitBuffer {
public:
    /// Adds all of `frame`, or nothing (false) if it does not fit. Before adding a perishable frame call `take_back` of
    /// its kind; otherwise the older frame can no longer be withdrawn. O(N) at worst, when the waiting bytes are moved.
    [[nodiscard]] bool push(std::span<const std::byte> frame, Perishable kind = Perishable::no) noexcept
    {
        if (frame.size() > N - (end_ - begin_)) {
            return false;
        }
        if (frame.size() > N - end_) {
            close_ranks();
        }
        std::copy(frame.begin(), frame.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(end_));
        if (kind != Perishable::no) {
            waiting_[static_cast<std::size_t>(kind)] = {end_, frame.size()};
        }
        end_ += frame.size();
        return true;
    }

    /// Removes the waiting whole frame of this kind; false if there is none. O(N).
    bool take_back(Perishable kind) noexcept
    {
        Place& place = waiting_[static_cast<std::size_t>(kind)];
        if (place.size == 0) {
            return false;
        }
        const Place gone = place;
        place = {};
        std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(gone.begin + gone.size),
                  bytes_.begin() + static_cast<std::ptrdiff_t>(end_),
                  bytes_.begin() + static_cast<std::ptrdiff_t>(gone.begin));
        end_ -= gone.size;
        for (Place& other : waiting_) {
            other.begin -= other.begin > gone.begin ? gone.size : 0;
        }
        return true;
    }

    [[nodiscard]] bool holds(Perishable kind) const noexcept
    {
        return waiting_[static_cast<std::size_t>(kind)].size > 0;
    }
    [[nodiscard]] std::span<const std::byte> pending() const noexcept
    {
        return {bytes_.data() + begin_, end_ - begin_};
    }
    void consume(std::size_t n) noexcept
    {
        begin_ += std::min(n, end_ - begin_);
        for (Place& place : waiting_) {
            place = place.begin < begin_ ? Place{} : place;  // its first byte has been removed
        }
        if (begin_ == end_) {
            clear();
        }
    }
    void clear() noexcept
    {
        begin_ = end_ = 0;
        waiting_ = {};
    }

private:
    struct Place {
        std::size_t begin = 0;
        std::size_t size = 0;  ///< 0: nothing waits
    };

    void close_ranks() noexcept
    {
        std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_),
                  bytes_.begin() + static_cast<std::ptrdiff_t>(end_), bytes_.begin());
        for (Place& place : waiting_) {
            place.begin -= place.size > 0 ? begin_ : 0;
        }
        end_ -= begin_;
        begin_ = 0;
    }

    std::size_t begin_ = 0;
    std::size_t end_ = 0;
    std::array<Place, kPerishables> waiting_{};
    std::array<std::byte, N> bytes_{};
};

}  // namespace jink::link::mavlink
