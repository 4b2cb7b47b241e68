// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/read_ahead.hpp"

#include <algorithm>
#include <span>

namespace jink::host {

void ReadAhead::pump() noexcept
{
    if (begin_ == end_) {
        begin_ = end_ = 0;
    } else if (end_ == bytes_.size() && begin_ > 0) {
        std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_), bytes_.end(), bytes_.begin());
        end_ -= begin_;
        begin_ = 0;
    }
    end_ += device_.read(std::span(bytes_).subspan(end_));
}

std::size_t ReadAhead::read(std::span<std::byte> into) noexcept
{
    const std::size_t n = std::min(into.size(), end_ - begin_);
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_), n, into.begin());
    begin_ += n;
    return n;
}

hal::PortHealth ReadAhead::health() const noexcept
{
    hal::PortHealth health = device_.health();
    health.bytes_in -= end_ - begin_;
    return health;
}

void CanReadAhead::pump() noexcept
{
    std::copy(frames_.begin() + static_cast<std::ptrdiff_t>(begin_),
              frames_.begin() + static_cast<std::ptrdiff_t>(end_), frames_.begin());
    end_ -= begin_;
    begin_ = 0;
    while (end_ < frames_.size() && device_.receive(frames_[end_])) {
        ++end_;
    }
}

bool CanReadAhead::receive(hal::CanFrame& frame) noexcept
{
    if (begin_ == end_) {
        return false;
    }
    frame = frames_[begin_++];
    return true;
}

hal::CanHealth CanReadAhead::health() const noexcept
{
    hal::CanHealth health = device_.health();
    health.frames_in -= end_ - begin_;
    return health;
}

}  // namespace jink::host
