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
    while (messages.size() >= ulog::kDataHeader) {
        const std::size_t content = static_cast<unsigned>(messages[0]) | static_cast<unsigned>(messages[1]) << 8U;
        const std::size_t size = std::min(ulog::kMessageHeader + content, messages.size());
        const std::span<const std::byte> message = messages.first(size);
        if (is_shown(message)) {
            all = queue_.add(message, 0, 1) && all;
        }
        messages = messages.subspan(size);
    }
    return all;
}

}  // namespace jink::livepage
