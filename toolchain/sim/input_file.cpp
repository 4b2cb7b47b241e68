// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/input_file.hpp"

#include <stdexcept>
#include <system_error>

namespace jink::sim {

std::ifstream open_input(const std::filesystem::path& file)
{
    std::error_code error;
    if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error)) {
        throw std::runtime_error(file.string() + ": is not a regular file");
    }
    std::ifstream in(file, std::ios::binary);
    if (!in) {
        throw std::runtime_error(file.string() + ": cannot be read");
    }
    return in;
}

}  // namespace jink::sim
