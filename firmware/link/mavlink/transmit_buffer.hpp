// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

namespace jink::link::mavlink {

/// Bytes waiting to be written: whole frames go in, any number of bytes comes off. What waits is always contiguous.
template <std::size_t N>
class TransmitBuffer {
public:
    /// All of `frame`, or nothing (false) when there is no room for all of it. O(N) at worst, when it has to close
    /// ranks.
    [[nodiscard]] bool push(std::span<const std::byte> frame) noexcept
    {
        if (frame.size() > N - (end_ - begin_)) {
            return false;
        }
        if (frame.size() > N - end_) {
            std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_),
                      bytes_.begin() + static_cast<std::ptrdiff_t>(end_), bytes_.begin());
            end_ -= begin_;
            begin_ = 0;
        }
        std::copy(frame.begin(), frame.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(end_));
        end_ += frame.size();
        return true;
    }
    [[nodiscard]] std::span<const std::byte> pending() const noexcept
    {
        return {bytes_.data() + begin_, end_ - begin_};
    }
    void consume(std::size_t n) noexcept
    {
        begin_ += std::min(n, end_ - begin_);
        if (begin_ == end_) {
            clear();
        }
    }
    void clear() noexcept { begin_ = end_ = 0; }

private:
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
    std::array<std::byte, N> bytes_{};
};

}  // namespace jink::link::mavlink
