// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <string_view>

#include "firmware/linux/flight_log/shown_curves.hpp"

// JSON, appended to a text.

namespace jink::livepage {

/// By a format of printf, 239 characters at most.
template <class... Values>
void add(std::string& out, const char* format, Values... values)
{
    std::array<char, 240> text{};
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg): GCC 12 has no std::format
    const int n = std::snprintf(text.data(), text.size(), format, values...);
    out.append(text.data(), std::min(static_cast<std::size_t>(std::max(n, 0)), text.size() - 1));
}

/// Null where it is unknown: not finite, or too large to be shown.
void add_number(std::string& out, double value, int decimals = 3);
/// `position` carried on with `velocity` for `seconds`.
void add_vector(std::string& out, const flightlog::Xyz& position, const flightlog::Xyz& velocity = {},
                double seconds = 0.0);
/// [[x, ...], [y, ...], [z, ...]], in centimetres.
void add_columns(std::string& out, const flightlog::Columns3& points);
/// In quotes, up to a zero byte. Control characters and bytes beyond ASCII become question marks.
void add_string(std::string& out, std::string_view text);
/// A comma, the key and its text.
void add_name(std::string& out, const char* key, std::string_view name);

}  // namespace jink::livepage
