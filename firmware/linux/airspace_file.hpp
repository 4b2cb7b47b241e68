// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/app/constraints.hpp"
#include "firmware/linux/complaint.hpp"

// Airspace files (YAML): closed volumes and storm cells, as circles or polygons between two heights. Keys and units:
// docs/guides/closed_areas.md, an example in firmware/airspace/example.yaml.

namespace jink::files {

/// The same instant on the clock of files and on the co-processor's own.
struct BothClocks {
    double unix_seconds = 0.0;  ///< UTC, since 1970
    TimePoint own;
};

/// Reads an airspace file. If any part of it is wrong, the result is empty, with a complaint for each error. A polygon
/// becomes the smallest circle around it.
[[nodiscard]] std::optional<std::vector<app::Constraint>>
read_airspace_file(const std::filesystem::path& path, const BothClocks& now, Complaints& complaints);

/// The same from text; `file` is the file's name in complaints.
[[nodiscard]] std::optional<std::vector<app::Constraint>>
parse_airspace(const std::string& text, const std::string& file, const BothClocks& now, Complaints& complaints);

/// "FILE: 3 areas are closed", and how many have expired, for the user.
[[nodiscard]] std::string areas_text(const std::string& file, const std::vector<app::Constraint>& areas, TimePoint now);

}  // namespace jink::files
