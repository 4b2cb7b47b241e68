// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/linux/param_file.hpp"

// Parameters that were set over a link, kept over a restart of the daemon: a state file of its own, beside the files
// that people write. It holds the values that differ from those files, one `NAME,VALUE` per line, and a checksum over
// all of it in its last line.

namespace jink::files {

/// Text of a state file: `values` as far as they differ from `initial`.
[[nodiscard]] std::string state_text(const ParamValues& initial, const ParamValues& values);

/// A text with a last line that holds the checksum of all before it, and the text before that line; nothing when it is
/// not the right one.
[[nodiscard]] std::string with_checksum(const std::string& text);
[[nodiscard]] std::optional<std::string_view> without_checksum(std::string_view text);

enum class FileAccess : unsigned { everyone_reads = 0644, owner_only = 0600 };

/// Replaces a file as a whole: a new file beside it (PATH.new), fsync, rename, fsync of the folder. A power cut or a
/// kill at any point leaves the former content or the new one. @return why not; empty on success
[[nodiscard]] std::string replace_file(const std::string& path, std::string_view text,
                                       FileAccess access = FileAccess::everyone_reads);

struct StateLoad {
    std::size_t taken = 0;
    /// Lines left out: unknown name, not a number, out of range, or not together with the others.
    std::size_t refused = 0;
};

/// Puts what a state file's text says into `parameters`. A line that is wrong is left out with a complaint, the others
/// count. Without its right checksum the text as a whole is left out: it was cut, and so might its last number be.
StateLoad apply_state(std::string_view text, const std::string& file, app::Parameters& parameters,
                      Complaints& complaints);

/// The same from a file. One that is not there says nothing and is no complaint.
StateLoad load_state(const std::string& path, app::Parameters& parameters, Complaints& complaints);

}  // namespace jink::files
