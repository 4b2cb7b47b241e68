// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace jink::host {

/// A Python script of the reports: installed beside the program (bin/jink, share/jink/report), or in the sources that
/// it was built from.
[[nodiscard]] std::filesystem::path find_report_script(const std::string& name);

}  // namespace jink::host
