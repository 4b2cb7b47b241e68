// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>

namespace jink::sim {

/// Opens a file for reading, as bytes. Throws std::runtime_error where it cannot be read, or is no regular file: the
/// writer of a FIFO may never come.
[[nodiscard]] std::ifstream open_input(const std::filesystem::path& file);

}  // namespace jink::sim
