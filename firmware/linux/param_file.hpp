// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "firmware/app/parameters.hpp"
#include "firmware/linux/complaint.hpp"

// Parameter files in the format of ArduPilot's ground stations: one `NAME,VALUE` or `NAME VALUE` per line, `#` starts a
// comment.

namespace jink::files {

using ParamValues = std::array<float, app::kParamCount>;

/// `values`, replaced by those of the file. If any line is wrong: complaints and nothing. Errors: no such file, no
/// value, more than one value, unknown name, name given before, not a number, not finite, out of range, not a whole
/// number.
///
/// Each value is checked alone. `apply_together` checks their consistency once all files are read.
[[nodiscard]] std::optional<ParamValues> apply_param_file(const std::filesystem::path& path, const ParamValues& values,
                                                          Complaints& complaints);

/// The same for text already read; `file` is the file's name in complaints.
[[nodiscard]] std::optional<ParamValues> apply_param_text(std::string_view text, const std::string& file,
                                                          const ParamValues& values, Complaints& complaints);

/// Sets all of `values` at once. False if they are inconsistent: complaints name the parameters, and nothing is
/// changed. `file` is the origin's name in complaints.
bool apply_together(const ParamValues& values, const std::string& file, app::Parameters& parameters,
                    Complaints& complaints);

/// Parameters of a program started with `--vehicle` and `--params`: the defaults, overridden by the vehicle file, then
/// by the parameter file, checked together. An empty path is skipped. If anything is wrong: nothing, with complaints.
[[nodiscard]] std::optional<app::Parameters>
load_parameters(const std::filesystem::path& vehicle, const std::filesystem::path& params, Complaints& complaints);

/// Text of a parameter file with all values and their meaning; reads back bit for bit.
[[nodiscard]] std::string param_file_text(const ParamValues& values);

}  // namespace jink::files
