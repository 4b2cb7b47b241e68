// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace jink::host {

/// A Python script of the reports: installed beside the program (bin/jink, share/jink/report), or in the tree of
/// sources of the build.
[[nodiscard]] std::filesystem::path find_report_script(const std::string& name);

/// The page of `jink report` without flights, viewer.html: installed like the scripts, or in the folder of the build.
[[nodiscard]] std::filesystem::path find_viewer();

/// Replaces this program by a report script. The script reads `input` from its standard input and writes to `folder`;
/// its exit status is the program's. Errors are reported in the name of `command`.
[[noreturn]] void become_report_script(const char* command, const std::string& python, const std::string& name,
                                       const std::string& input, const std::string& folder);

}  // namespace jink::host
