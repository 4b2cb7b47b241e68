// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "firmware/app/parameters.hpp"
#include "firmware/linux/complaint.hpp"

// Parameter files as ArduPilot's ground stations write them: one `NAME,VALUE` or `NAME VALUE` per line, `#` starts a
// comment.

namespace jink::files {

using ParamValues = std::array<float, app::kParamCount>;

/// `values` with those of the file in place of theirs; complaints and nothing when any line is wrong: no such file, no
/// value, more than one value, unknown name, name given before, not a number, not finite, out of range, not a whole
/// number.
///
/// Each value is judged alone. Whether they fit together is asked once all files are in: `apply_together`.
[[nodiscard]] std::optional<ParamValues> apply_param_file(const std::filesystem::path& path, const ParamValues& values,
                                                          Complaints& complaints);

/// The same for text already read; `file` is what complaints call it.
[[nodiscard]] std::optional<ParamValues> apply_param_text(std::string_view text, const std::string& file,
                                                          const ParamValues& values, Complaints& complaints);

/// Sets all of `values` at once; false, with complaints that say which of them do not fit together and nothing changed,
/// when refused. `file` is what complaints call the origin.
bool apply_together(const ParamValues& values, const std::string& file, app::Parameters& parameters,
                    Complaints& complaints);

/// Everything that a program started with `--vehicle` and `--params` wants: the defaults, the vehicle file over them,
/// the parameter file over that, checked together. An empty path is skipped. Nothing, with complaints, when anything is
/// wrong.
[[nodiscard]] std::optional<app::Parameters>
load_parameters(const std::filesystem::path& vehicle, const std::filesystem::path& params, Complaints& complaints);

/// Text of a parameter file with all values and their meaning; reads back bit for bit.
[[nodiscard]] std::string param_file_text(const ParamValues& values);

}  // namespace jink::files
