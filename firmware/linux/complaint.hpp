// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Errors in files, and common parts of the file readers. Host only: heap and exceptions are allowed here.

namespace jink::files {

/// One error in a file. Readers collect all errors, not only the first.
struct Complaint {
    std::size_t line = 0;    ///< from 1; 0: the file as a whole
    std::size_t column = 0;  ///< from 1; 0: the line as a whole
    std::string text;
    std::string file;  ///< name as given to the reader
};
using Complaints = std::vector<Complaint>;

/// "file:line:column: text", as compilers write it, so that editors find the place. Parts that are 0 are omitted.
[[nodiscard]] std::string to_string(const Complaint& complaint);

/// Closed range of permitted values.
struct Range {
    float low;
    float high;
};

/// Shortest decimal that reads back as `value`.
[[nodiscard]] std::string to_text(float value);

/// Text from outside in printable form: cut at 60 bytes, everything but printable ASCII as \xNN.
[[nodiscard]] std::string printable(std::string_view text);
/// The same in single quotes.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// Where the first byte is that is no UTF-8 (RFC 3629); the text's size where all of it is.
[[nodiscard]] std::size_t end_of_utf8(std::string_view text);

enum class NumberStatus { ok, not_a_number, not_finite, too_big };
/// Reads a decimal number that is the whole of `text`: optional sign, no blanks, no hexadecimal. Independent of the
/// locale.
[[nodiscard]] NumberStatus parse_number(std::string_view text, float& out);
[[nodiscard]] NumberStatus parse_number(std::string_view text, double& out);
/// Error text for an invalid number or a number outside `range`; nothing if the number is good.
[[nodiscard]] std::optional<std::string> judge_number(std::string_view text, const Range& range, bool integer,
                                                      float& out);

/// The known name most similar to `name` (Damerau-Levenshtein distance at most a third of its length, ignoring case),
/// or nothing.
[[nodiscard]] std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string_view> names);
/// "; did you mean 'x'?" or an empty text.
[[nodiscard]] std::string suggestion(std::string_view name, std::span<const std::string_view> names);

/// Hand-written files are far below this size [bytes]; larger files are refused unread.
inline constexpr std::size_t kMaxFileSize = 1U << 20U;
/// Whole text of a regular file. If the file cannot be read or is larger than kMaxFileSize: a complaint and nothing.
/// FIFOs, sockets and devices are refused without waiting for them.
[[nodiscard]] std::optional<std::string> read_text_file(const std::filesystem::path& path, Complaints& complaints);
/// The same of any file up to `most` bytes; a larger one is complained of in the words `too_large`.
[[nodiscard]] std::optional<std::string> read_file(const std::filesystem::path& path, std::size_t most,
                                                   const char* too_large, Complaints& complaints);

}  // namespace jink::files
