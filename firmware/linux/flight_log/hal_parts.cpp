// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/hal_parts.hpp"

#include "firmware/linux/flight_log/ulog_reader.hpp"

namespace jink::flightlog {

HalParts::Taken HalParts::take(std::span<const std::byte> content)
{
    if (content.size() < HalHead::kBytes) {
        return Taken::bad;
    }
    const auto head = ulog::read_number<HalHead>(content);
    const std::span<const std::byte> bytes = content.subspan(HalHead::kBytes);
    if (head.sequence != next_) {
        return Taken::gap;
    }
    ++next_;
    time_ = head.timestamp;
    if (!goes_on_) {
        record_.clear();
    }
    goes_on_ = (head.flags & HalHead::kGoesOn) != 0;
    if (head.length > bytes.size() || record_.size() + head.length > kMaxRecord) {
        return Taken::bad;
    }
    record_.insert(record_.end(), bytes.begin(), bytes.begin() + head.length);
    return goes_on_ ? Taken::part : Taken::record;
}

}  // namespace jink::flightlog
