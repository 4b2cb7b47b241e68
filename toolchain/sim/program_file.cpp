// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/program_file.hpp"

#include <array>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include <unistd.h>

#include "toolchain/sim/input_file.hpp"

namespace jink::sim {
namespace {

namespace fs = std::filesystem;

bool can_run(const fs::path& file)
{
    std::error_code error;
    return fs::is_regular_file(file, error) && ::access(file.c_str(), X_OK) == 0;
}

}  // namespace

std::string find_program(std::string& name)
{
    if (name.find('/') != std::string::npos) {
        return can_run(name) ? "" : name + " is no executable file";
    }
    if (can_run(name)) {
        name.insert(0, "./");
        return "";
    }
    const char* const path = std::getenv("PATH");
    std::istringstream folders(path == nullptr ? "" : path);
    for (std::string folder; std::getline(folders, folder, ':');) {
        const fs::path file = fs::path(folder.empty() ? "." : folder) / name;
        if (can_run(file)) {
            name = file.string();
            return "";
        }
    }
    return name + " is no executable file, and no program in PATH";
}

std::string check_image(const std::string& name)
{
    try {
        std::array<char, 4> magic{};
        open_input(name).read(magic.data(), magic.size());
        return magic == std::array{'\x7f', 'E', 'L', 'F'} ? "" : name + " is no ELF file";
    } catch (const std::runtime_error& error) {
        return error.what();
    }
}

fs::path find_daemon(const std::string& option)
{
    const fs::path here = fs::read_symlink("/proc/self/exe").parent_path();
    for (const fs::path& candidate : {here / "jinkd", here / "../../firmware/linux/jinkd"}) {
        if (fs::exists(candidate)) {
            return fs::canonical(candidate);
        }
    }
    throw std::runtime_error("jinkd is not where this program is; say where with " + option);
}

}  // namespace jink::sim
