// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/linux/flight_log/ulog_reader.hpp"

namespace jink::host {

/// What one file of a flight log says, in short.
struct LogSummary {
    struct Line {
        double time = 0.0;  ///< since the first timestamp [s]
        char level = '6';
        std::string text;
    };
    std::map<std::string, std::string> infos;
    double first = 0.0;     ///< timestamp [s]
    double duration = 0.0;  ///< [s]
    std::uint64_t messages = 0;
    std::uint64_t bytes = 0;
    std::map<std::string, std::uint64_t> topics;  ///< messages of each
    std::uint64_t dropouts = 0;
    double dropout_time = 0.0;  ///< [s]
    std::uint32_t steps = 0;
    std::uint32_t decisions = 0;
    std::uint32_t longest_step = 0;  ///< [us]
    double mean_step = 0.0;          ///< [us]
    std::vector<Line> lines;         ///< logged strings
    std::vector<std::string> parameters_changed;
    std::map<std::string, std::uint64_t> counters;  ///< last values that are not zero
    ulog::End end = ulog::End::none;
    std::uint64_t end_offset = 0;
};

/// Reads a log to its end or to its damage.
[[nodiscard]] LogSummary summarise_log(std::istream& in);
void print_log_summary(const std::string& name, const LogSummary& summary, std::ostream& out);

/// Writes one file for each topic, TOPIC.csv, into a folder: the fields' names, then a line for each message. Arrays
/// are columns of their own, but those of bytes, which are one column of hexadecimal digits. Texts go to texts.csv.
/// Further instances of a topic (multi_id 1 and more) are TOPIC_1.csv and so on. A `/` becomes `_`; a name that another
/// file has gets `_` behind it. Files are held in memory and written at the end, each replaced as a whole.
/// @return lines written; throws std::runtime_error where a file cannot be written
std::uint64_t write_log_csv(ulog::Reader& log, const std::filesystem::path& folder);

/// The text with "?" for everything but printable ASCII.
[[nodiscard]] std::string log_text(std::string_view text);
/// The severity of a logged text, 0 to 7, or "?" for any other byte.
[[nodiscard]] char log_level(std::byte level);
/// Value of one element of a field, as text.
[[nodiscard]] std::string log_value(std::string_view type, std::span<const std::byte> bytes);

}  // namespace jink::host
