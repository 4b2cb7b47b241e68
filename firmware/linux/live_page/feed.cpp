// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/live_page/feed.hpp"

#include <algorithm>

#include "firmware/linux/flight_log/topics.hpp"

namespace jink::livepage {
namespace {

/// Whether the page shows this message.
bool is_shown(std::span<const std::byte> message) noexcept
{
    const auto type = static_cast<ulog::Type>(message[2]);
    if (type != ulog::Type::data) {
        return type == ulog::Type::text || type == ulog::Type::parameter;
    }
    const auto id =
        static_cast<flightlog::TopicId>(static_cast<unsigned>(message[3]) | static_cast<unsigned>(message[4]) << 8U);
    return id == flightlog::TopicId::step || id == flightlog::TopicId::own || id == flightlog::TopicId::track ||
           id == flightlog::TopicId::decision;
}

}  // namespace

bool Feed::add(std::span<const std::byte> messages, std::uint32_t /*count*/) noexcept
{
    bool all = true;
    std::size_t shown = 0;  // bytes of the messages that are shown, before `at`
    std::uint32_t shown_count = 0;
    std::size_t at = 0;
    const auto copy = [&] {
        all = (shown == 0 || queue_.add(messages.subspan(at - shown, shown), 0, shown_count)) && all;
        shown = 0;
        shown_count = 0;
    };
    while (messages.size() - at >= ulog::kDataHeader) {
        const std::size_t content = static_cast<unsigned>(messages[at]) | static_cast<unsigned>(messages[at + 1]) << 8U;
        const std::size_t size = std::min(ulog::kMessageHeader + content, messages.size() - at);
        if (is_shown(messages.subspan(at, size))) {
            shown += size;
            ++shown_count;
        } else {
            copy();
        }
        at += size;
    }
    copy();
    return all;
}

}  // namespace jink::livepage
