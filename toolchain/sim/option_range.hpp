// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>

// Checks of numbers on a command line, for every option that takes one. Those of CLI11 let values through: NaN passes
// each of its ranges, an unsigned option takes -1 as 18446744073709551615, and 010 is 8.

namespace jink::sim {

/// Takes decimal numbers from `low` to `high`, neither NaN nor infinite.
[[nodiscard]] inline CLI::Validator finite(double low, double high)
{
    std::ostringstream range;
    range << low << " to " << high;
    std::ostringstream type;
    type << "FLOAT in [" << low << " - " << high << "]";
    return CLI::Validator(
        [low, high, wanted = range.str()](const std::string& text) {
            double value = 0.0;
            const bool good = CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
            return good ? std::string() : text + " is no number from " + wanted;
        },
        type.str());
}

/// Takes finite numbers above 0.
[[nodiscard]] inline CLI::Validator positive()
{
    return CLI::Validator(
        [](const std::string& text) {
            double value = 0.0;
            const bool good = CLI::detail::lexical_cast(text, value) && value > 0.0 && std::isfinite(value);
            return good ? std::string() : text + " is no finite number above 0";
        },
        "POSITIVE");
}

/// Takes whole numbers from `low` to `high`, in decimal digits alone.
[[nodiscard]] inline CLI::Validator whole(std::uint64_t low, std::uint64_t high)
{
    const std::string range = std::to_string(low) + " to " + std::to_string(high);
    return CLI::Validator(
        [low, high, range](const std::string& text) {
            std::uint64_t value = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            const bool good = error == std::errc{} && end == text.data() + text.size() && value >= low &&
                              value <= high && (text.size() == 1 || text.front() != '0');
            return good ? std::string() : text + " is no whole number from " + range;
        },
        "UINT in [" + std::to_string(low) + " - " + std::to_string(high) + "]");
}

/// Any seed. Without a range in the help text.
[[nodiscard]] inline CLI::Validator any_seed()
{
    return whole(0, std::numeric_limits<std::uint64_t>::max()).description("");
}

}  // namespace jink::sim
