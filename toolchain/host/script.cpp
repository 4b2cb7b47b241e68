// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/script.hpp"

#include <system_error>

namespace jink::host {

std::filesystem::path find_report_script(const std::string& name)
{
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    const fs::path installed = program.parent_path().parent_path() / "share/jink/report" / name;
    return fs::exists(installed, error) ? installed : fs::path(JINK_REPORT_FOLDER) / name;
}

}  // namespace jink::host
