// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/sent_texts.hpp"

#include <algorithm>

namespace jink::flightlog {
namespace {

constexpr std::byte kMagic{0xFD};
constexpr std::size_t kHeader = 10;
constexpr std::size_t kChecksum = 2;
constexpr std::size_t kSignature = 13;
constexpr std::byte kStatustext{253};

std::size_t size_of_frame(std::span<const std::byte> frame)
{
    const bool is_signed = (frame[2] & std::byte{1}) != std::byte{0};
    return kHeader + static_cast<std::size_t>(frame[1]) + kChecksum + (is_signed ? kSignature : 0U);
}

bool is_text(std::span<const std::byte> frame)
{
    return frame[7] == kStatustext && frame[8] == std::byte{0} && frame[9] == std::byte{0} && frame[1] > std::byte{1};
}

}  // namespace

void SentTexts::note(std::span<const std::byte> offered, std::size_t accepted) noexcept
{
    const std::size_t known = std::min(rest_, offered.size());
    std::span<const std::byte> rest = offered.subspan(known);
    std::size_t at = known;
    rest_ -= std::min(rest_, accepted);
    while (at < accepted && rest.size() >= kHeader && rest.front() == kMagic) {
        const std::size_t size = std::min(size_of_frame(rest), rest.size());
        if (is_text(rest) && rest.size() > kHeader + 1 && count_ < kMaxTexts) {
            Text& text = texts_[count_++];
            text.severity = static_cast<std::uint8_t>(std::min(static_cast<unsigned>(rest[kHeader]), 7U));
            const std::span<const std::byte> chars = rest.subspan(
                kHeader + 1, std::min({static_cast<std::size_t>(rest[1]) - 1, kMaxLength, rest.size() - kHeader - 1}));
            const auto end = std::find(chars.begin(), chars.end(), std::byte{0});
            text.length = static_cast<std::uint8_t>(end - chars.begin());
            std::transform(chars.begin(), end, text.text.begin(), [](std::byte b) { return static_cast<char>(b); });
        }
        at += size;
        rest = rest.subspan(size);
    }
    rest_ = at > accepted ? at - accepted : rest_;
}

}  // namespace jink::flightlog
