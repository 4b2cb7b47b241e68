// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/sent_texts.hpp"

#include <algorithm>

#include "firmware/link/mavlink/frame.hpp"

namespace jink::flightlog {
namespace {

using link::mavlink::kHeaderV2;

constexpr std::byte kStatustext{253};

std::size_t size_of_frame(std::span<const std::byte> frame)
{
    const bool is_signed = (frame[2] & link::mavlink::kFlagSigned) != std::byte{0};
    return kHeaderV2 + static_cast<std::size_t>(frame[1]) + link::mavlink::kChecksumSize +
           (is_signed ? link::mavlink::kSignatureSize : 0U);
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
    while (at < accepted && rest.size() >= kHeaderV2 && rest.front() == link::mavlink::kStartV2) {
        const std::size_t size = std::min(size_of_frame(rest), rest.size());
        if (is_text(rest) && rest.size() > kHeaderV2 + 1 && count_ < kMaxTexts) {
            Text& text = texts_[count_++];
            text.severity = static_cast<std::uint8_t>(std::min(static_cast<unsigned>(rest[kHeaderV2]), 7U));
            const std::span<const std::byte> chars = rest.subspan(
                kHeaderV2 + 1,
                std::min({static_cast<std::size_t>(rest[1]) - 1, kMaxLength, rest.size() - kHeaderV2 - 1}));
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
