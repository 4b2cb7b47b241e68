// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/app/parameters.hpp"
#include "firmware/linux/complaint.hpp"

// Parameter files in two formats of ground stations; `#` starts a comment.
// * ArduPilot's: one `NAME,VALUE` or `NAME VALUE` per line.
// * QGroundControl's (.params): system id, component id, name, value, MAV_PARAM_TYPE, with tabs between them. Lines of
//   other components, such as the autopilot's, are passed over.

namespace jink::files {

using ParamValues = std::array<float, app::kParamCount>;

/// MAV_COMP_ID_OBSTACLE_AVOIDANCE, jink's component id in QGroundControl's format.
inline constexpr unsigned kComponentId = 196;

/// `values`, replaced by those of the file. If any line is wrong: complaints and nothing. Errors: no such file, no
/// value, more than one value, unknown name, name given before, not a number, not finite, out of range, not a whole
/// number, lines of other components alone.
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

/// All parameters in an order in which each of `values` is accepted by itself, if they are set one after the other and
/// all others start from the defaults: what a ground station does. Parameters for which there is no such place follow.
/// JNK_MODE comes last, so that jink acts by all of the other values.
[[nodiscard]] std::vector<std::size_t> setting_order(const ParamValues& values);

/// The same in QGroundControl's format, in the setting order; `system` is the vehicle's system id, 1 to 255, without
/// which QGroundControl loads nothing.
[[nodiscard]] std::string qgroundcontrol_text(const ParamValues& values, unsigned system);

}  // namespace jink::files
