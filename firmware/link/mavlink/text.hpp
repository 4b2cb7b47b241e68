// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace jink::link::mavlink {

/// The text of a character field: up to the first NUL, or the full field without one. Views into `field`.
template <std::size_t N>
[[nodiscard]] constexpr std::string_view text_of(const std::array<char, N>& field) noexcept
{
    const auto end = std::find(field.begin(), field.end(), '\0');
    return {field.data(), static_cast<std::size_t>(end - field.begin())};
}

/// Writes `text` and pads with NULs; false if the text was cut to the N characters that fit.
template <std::size_t N>
[[nodiscard]] constexpr bool set_text(std::array<char, N>& field, std::string_view text) noexcept
{
    field.fill('\0');
    std::copy_n(text.begin(), std::min(text.size(), N), field.begin());
    return text.size() <= N;
}

}  // namespace jink::link::mavlink
