// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/linux/param_file.hpp"

// Parameters that were set over a link, kept over a restart of the daemon in a state file of its own, beside the
// hand-written files. The state file holds the values that differ from those files, one `NAME,VALUE` per line, and in
// its last line a checksum over the lines before.

namespace jink::files {

/// Text of a state file: the values that differ from `initial`.
[[nodiscard]] std::string state_text(const ParamValues& initial, const ParamValues& values);

/// Adds a last line with the checksum of the text; the reverse gives the text before that line, or nothing if the
/// checksum is wrong.
[[nodiscard]] std::string with_checksum(const std::string& text);
[[nodiscard]] std::optional<std::string_view> without_checksum(std::string_view text);

enum class FileAccess : unsigned { everyone_reads = 0644, owner_only = 0600 };

/// Replaces a file as a whole: a new file beside it (PATH.new), fsync, rename, fsync of the folder. A power cut or a
/// kill at any point leaves the former content or the new one. A symbolic link keeps its name, its target is replaced.
/// A device or a pipe is written into, where everyone may read. @return the error; empty on success
[[nodiscard]] std::string replace_file(const std::string& path, std::string_view text,
                                       FileAccess access = FileAccess::everyone_reads);

/// Whether two names lead to one file or device, also where the file does not exist yet. False for an empty name.
[[nodiscard]] bool is_same_file(const std::string& a, const std::string& b);

struct Overwritten {
    std::string output;
    std::string other;  ///< the input or the earlier output that is the same file
};
/// The first output that is the same file as an input or an earlier output; nothing if there is none. Empty names are
/// passed over, and outputs that are devices or pipes.
[[nodiscard]] std::optional<Overwritten> find_overwritten(const std::vector<std::string>& inputs,
                                                          const std::vector<std::string>& outputs);

struct StateLoad {
    std::size_t taken = 0;
    /// Lines left out: unknown name, not a number, out of range, or inconsistent with the others.
    std::size_t refused = 0;
};

/// Applies a state file's text to `parameters`. A wrong line is left out with a complaint; the others are applied. If
/// the checksum is missing or wrong, the whole text is left out: it was cut, and so may be its last number.
StateLoad apply_state(std::string_view text, const std::string& file, app::Parameters& parameters,
                      Complaints& complaints);

/// The same from a file. A missing file is no error; a file that cannot be opened is left out with a complaint.
StateLoad load_state(const std::string& path, app::Parameters& parameters, Complaints& complaints);

}  // namespace jink::files
