// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

// Programs and images that a command line names.

namespace jink::sim {

/// Looks for the program `name`: an executable file, or, of a name without a folder, one in PATH. Replaces `name` by
/// the path of what it finds. @return the error; empty: found
[[nodiscard]] std::string find_program(std::string& name);

/// @return the error of an image that is no ELF file; empty: it is one
[[nodiscard]] std::string check_image(const std::string& name);

/// jinkd beside this program, or at its place in a build folder.
/// @param option  that names another place, for the message
/// @throws std::runtime_error when jinkd is at neither place
[[nodiscard]] std::filesystem::path find_daemon(const std::string& option);

}  // namespace jink::sim
