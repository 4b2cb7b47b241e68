// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

namespace jink::app {

/// The last `digits` hexadecimal digits, at most eight.
struct Hex {
    std::uint32_t value;
    unsigned digits = 8;
};

/// Builds a STATUSTEXT of at most 50 characters without the C library's formatting, which would bring an allocator into
/// images. What does not fit is cut off.
class Text {
public:
    /// Out of line: texts are put together in many places, and images are small.
    [[gnu::noinline]] Text& operator<<(std::string_view part) noexcept
    {
        for (const char c : part) {
            if (size_ < buffer_.size()) {
                buffer_[size_++] = c;
            }
        }
        return *this;
    }

    Text& operator<<(std::uint32_t value) noexcept
    {
        std::array<char, 10> digits{};
        std::size_t n = 0;
        do {
            digits[n++] = static_cast<char>('0' + static_cast<char>(value % 10U));
            value /= 10U;
        } while (value != 0 && n < digits.size());
        while (n > 0) {
            *this << std::string_view(&digits[--n], 1);
        }
        return *this;
    }

    Text& operator<<(Hex hex) noexcept
    {
        for (unsigned shift = 4U * hex.digits; shift > 0; shift -= 4) {
            *this << std::string_view("0123456789ABCDEF").substr(hex.value >> (shift - 4U) & 0xFU, 1);
        }
        return *this;
    }

    /// One decimal; "?" for what is not finite or beyond 10^8.
    Text& operator<<(float value) noexcept
    {
        if (!(std::abs(value) < 1e8F)) {
            return *this << std::string_view("?");
        }
        // The whole part apart: ten times a large value would be rounded.
        auto whole = static_cast<std::uint32_t>(std::abs(value));
        auto tenths = static_cast<std::uint32_t>(std::lround((std::abs(value) - static_cast<float>(whole)) * 10.0F));
        whole += tenths / 10U;
        tenths %= 10U;
        if (value < 0.0F && (whole != 0 || tenths != 0)) {
            *this << std::string_view("-");
        }
        return *this << whole << std::string_view(".") << tenths;
    }

    [[nodiscard]] std::string_view view() const noexcept { return {buffer_.data(), size_}; }

private:
    std::array<char, 50> buffer_{};
    std::size_t size_ = 0;
};

}  // namespace jink::app
