// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include "firmware/linux/param_file.hpp"

namespace jink::host {

/// All parameters as MAVLink component metadata (COMP_METADATA_TYPE_PARAMETER, parameter.schema.json), in the order of
/// their MAVLink index. Names, ranges, units and meaning are those of app::param_table(). Every parameter has the type
/// Float, which it has on the link.
///
/// @param defaults  values that a ground station offers as defaults
/// @param version   of the format: 1 as QGroundControl reads and PX4 writes, or 3 as the present schema requires. The
///                  content is the same.
///
/// Throws std::logic_error if the table has a unit or a prefix that is not known here.
[[nodiscard]] nlohmann::ordered_json parameter_metadata(const files::ParamValues& defaults, int version);

}  // namespace jink::host
