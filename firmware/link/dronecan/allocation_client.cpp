// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/dronecan/allocation_client.hpp"

#include <algorithm>

namespace jink::link::dronecan {

std::optional<Allocation> AllocationClient::poll(TimePoint now) noexcept
{
    if (node_ != kAnonymous) {
        return std::nullopt;
    }
    if (!started_) {
        started_ = true;
        wait(now, kMinPeriod);
    }
    if (now < due_) {
        return std::nullopt;
    }
    Allocation request;
    request.node = preferred_;
    request.first_part = confirmed_ == 0;
    for (std::size_t i = confirmed_; i < std::min(confirmed_ + kPart, unique_id_.size()); ++i) {
        request.unique_id.unchecked_push_back(unique_id_[i]);
    }
    // Without an answer the exchange starts again.
    confirmed_ = 0;
    wait(now, kMinPeriod);
    return request;
}

void AllocationClient::receive(const Allocation& message, std::uint8_t source, TimePoint now) noexcept
{
    if (node_ != kAnonymous) {
        return;
    }
    started_ = true;
    wait(now, kMinPeriod);
    confirmed_ = 0;
    const bool ours = source != kAnonymous && !message.unique_id.empty() &&
                      std::equal(message.unique_id.begin(), message.unique_id.end(), unique_id_.begin());
    if (!ours) {
        return;
    }
    if (message.unique_id.size() < unique_id_.size()) {
        confirmed_ = message.unique_id.size();
        wait(now, 0.0F);
    } else if (message.node != kAnonymous) {
        node_ = message.node;
    }
}

}  // namespace jink::link::dronecan
