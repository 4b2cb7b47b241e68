// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/script.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

#include "toolchain/host/header_text.hpp"

namespace jink::host {

namespace {

namespace fs = std::filesystem;

/// Beside the program, otherwise in `folder`.
fs::path installed_or_in(const fs::path& folder, const std::string& name)
{
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    const fs::path installed = program.parent_path().parent_path() / "share/jink/report" / name;
    return fs::exists(installed, error) ? installed : folder / name;
}

}  // namespace

fs::path find_report_script(const std::string& name) { return installed_or_in(JINK_REPORT_FOLDER, name); }
fs::path find_viewer() { return installed_or_in(JINK_VIEWER_FOLDER, "viewer.html"); }

void become_report_script(const char* command, const std::string& python, const std::string& name,
                          const std::string& input, const std::string& folder)
{
    std::FILE* const file = std::tmpfile();
    if (file == nullptr || std::fwrite(input.data(), 1, input.size(), file) != input.size() || std::fflush(file) != 0 ||
        lseek(fileno(file), 0, SEEK_SET) != 0 || dup2(fileno(file), STDIN_FILENO) < 0) {
        refuse(command, std::string("nothing can be handed to the script: ") + std::strerror(errno));
    }
    const std::string script = find_report_script(name).string();
    std::fflush(nullptr);
    // -I keeps PYTHONPATH and user packages out.
    execl(python.c_str(), python.c_str(), "-I", "-B", script.c_str(), folder.c_str(), static_cast<char*>(nullptr));
    refuse(command, python + " cannot be started: " + std::strerror(errno));
}

}  // namespace jink::host
