// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "firmware/linux/complaint.hpp"

namespace jink::host {

/// The kinds of files that people write for jink.
enum class FileKind { vehicle, problem, scenario, params };
[[nodiscard]] std::string_view name_of(FileKind kind);
[[nodiscard]] std::optional<FileKind> file_kind(std::string_view name);

/// What a file is meant to be: by its extension (.yaml and .yml, everything else holds parameters), and a YAML file by
/// the kind that most of its top-level keys belong to. A complaint and nothing when no key tells, or the file cannot be
/// read.
[[nodiscard]] std::optional<FileKind> guess_kind(const std::filesystem::path& path, files::Complaints& complaints);

/// All that is wrong with a file of a kind; of a scenario only the first thing, since its reader stops there.
[[nodiscard]] files::Complaints check_file(const std::filesystem::path& path, FileKind kind);

}  // namespace jink::host
