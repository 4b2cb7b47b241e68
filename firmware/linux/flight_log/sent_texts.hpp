// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace jink::flightlog {

/// Finds STATUSTEXT frames (MAVLink 2) in what is written to a line. Bytes that the line did not accept are offered
/// again later, and are counted then. O(frames).
class SentTexts {
public:
    /// Texts of one step that are kept; further ones are left out.
    static constexpr std::size_t kMaxTexts = 8;
    static constexpr std::size_t kMaxLength = 50;

    struct Text {
        std::uint8_t severity = 0;  ///< MAV_SEVERITY
        std::uint8_t length = 0;
        std::array<char, kMaxLength> text{};
        [[nodiscard]] std::string_view view() const noexcept { return {text.data(), length}; }
    };

    void note(std::span<const std::byte> offered, std::size_t accepted) noexcept;
    [[nodiscard]] std::span<const Text> texts() const noexcept { return std::span(texts_).first(count_); }
    void clear() noexcept { count_ = 0; }

private:
    std::array<Text, kMaxTexts> texts_{};
    std::size_t count_ = 0;
    std::size_t rest_ = 0;  ///< bytes of a frame whose beginning was accepted before
};

}  // namespace jink::flightlog
