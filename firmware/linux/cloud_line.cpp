// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/cloud_line.hpp"

#include <algorithm>
#include <span>

namespace jink::host {

void CloudLine::pump() noexcept
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

std::size_t CloudLine::read(std::span<std::byte> into) noexcept
{
    const std::size_t n = std::min(into.size(), end_ - begin_);
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_), n, into.begin());
    begin_ += n;
    return n;
}

}  // namespace jink::host
