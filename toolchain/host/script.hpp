// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace jink::host {

/// A Python script of the reports: installed beside the program (bin/jink, share/jink/report), or in the sources that
/// it was built from.
[[nodiscard]] std::filesystem::path find_report_script(const std::string& name);

/// Replaces this program by such a script, which reads `input` from its standard input and gets `folder` to write to;
/// its exit status is the script's. What goes wrong is told in the name of `command`.
[[noreturn]] void become_report_script(const char* command, const std::string& python, const std::string& name,
                                       const std::string& input, const std::string& folder);

}  // namespace jink::host
