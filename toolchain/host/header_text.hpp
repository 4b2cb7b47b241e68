// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "firmware/linux/vehicle_file.hpp"

// Generated C++ headers: numbers, arrays and names as text; reading the vehicle and writing the file.

namespace jink::host {

/// The shortest text that reads as the same number.
[[nodiscard]] std::string literal(float value);
template <std::integral T>
[[nodiscard]] std::string literal(T value)
{
    return std::to_string(static_cast<int>(value));
}

/// `inline constexpr std::array<type, n> name{...};` in lines of up to 118 characters. `items`: as written, numbers or
/// lists in braces.
void append_array_of(std::string& out, const std::string& type, const std::string& name,
                     const std::vector<std::string>& items);
template <class Range>
void append_array(std::string& out, const std::string& type, const std::string& name, const Range& values)
{
    std::vector<std::string> items;
    items.reserve(values.size());
    for (const auto& value : values) {
        items.push_back(literal(value));
    }
    append_array_of(out, type, name, items);
}

/// Converts a name to a C++ identifier: `my quad-3` gives MyQuad3. Empty if no character remains, or if a digit comes
/// first.
[[nodiscard]] std::string identifier_of(const std::string& name);

/// True for a name of ASCII letters, digits, blanks, `-`, `_` and `.` that converts to a C++ identifier: such a name
/// may stand in a C++ text.
[[nodiscard]] bool names_tables(const std::string& name);

/// The vehicle of a file; its name must convert to a C++ identifier. Complaints go to standard error.
/// @throws CLI::RuntimeError with kExitBadInput
[[nodiscard]] files::Vehicle read_named_vehicle(const std::string& command, const std::string& file);
/// Refuses outputs that have no folder, or are the same file as an input or as another output. Called before the work,
/// so that nothing is written then. Empty names are passed over; devices may come twice.
/// @throws CLI::RuntimeError with kExitBadInput
void check_outputs(const std::string& command, const std::vector<std::string>& inputs,
                   const std::vector<std::string>& outputs);
/// Replaces the file as a whole: an earlier one stays as it is when the new one cannot be written.
/// @throws CLI::RuntimeError with kExitBadInput when the file cannot be written
void write_whole(const std::string& command, const std::string& file, const std::string& text);
/// One line on standard error, `jink COMMAND: why`.
/// @throws CLI::RuntimeError with kExitBadInput
[[noreturn]] void refuse(const std::string& command, const std::string& why);

}  // namespace jink::host
