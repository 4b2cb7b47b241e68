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

/// The kind of a file. By extension, files other than .yaml and .yml hold parameters. A YAML file is of the kind that
/// most of its top-level keys belong to. If no key identifies the kind, or the file cannot be read, returns nothing and
/// adds a complaint.
[[nodiscard]] std::optional<FileKind> guess_kind(const std::filesystem::path& path, files::Complaints& complaints);

/// All errors of a file of a kind; of a scenario only the first error, since its reader stops there.
[[nodiscard]] files::Complaints check_file(const std::filesystem::path& path, FileKind kind);

}  // namespace jink::host
