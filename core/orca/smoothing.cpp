// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/smoothing.hpp"

#include <algorithm>

namespace jink::orca {

CommandFilter::CommandFilter(std::size_t length) noexcept : length_(std::clamp<std::size_t>(length, 1, kMax))
{
    commands_.fill(Vec3::Zero());
}

Vec3 CommandFilter::add(const Vec3& command) noexcept
{
    if (length_ == 1) {
        return command;
    }
    if (count_ < length_) {
        commands_[count_++] = command;
        weighted_ += static_cast<float>(count_) * command;
        sum_ += command;
    } else {
        // Every weight falls by one, which takes the oldest out.
        weighted_ += static_cast<float>(length_) * command - sum_;
        sum_ += command - commands_[oldest_];
        commands_[oldest_] = command;
        oldest_ = (oldest_ + 1) % length_;
    }
    if (++since_exact_ >= kExact) {
        sum_up();
    }
    return weighted_ * (2.0F / static_cast<float>(count_ * (count_ + 1)));
}

void CommandFilter::clear() noexcept
{
    count_ = 0;
    oldest_ = 0;
    since_exact_ = 0;
    sum_.setZero();
    weighted_.setZero();
}

void CommandFilter::sum_up() noexcept
{
    since_exact_ = 0;
    sum_.setZero();
    weighted_.setZero();
    for (std::size_t i = 0; i < count_; ++i) {
        const Vec3& command = commands_[(oldest_ + i) % length_];
        sum_ += command;
        weighted_ += static_cast<float>(i + 1) * command;
    }
}

}  // namespace jink::orca
