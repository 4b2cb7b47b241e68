// SPDX-License-Identifier: BSD-3-Clause
// The probe as a Linux program: records on standard input, answers on standard output.
#include <unistd.h>

#include "tests/target/probe_io.hpp"

namespace jink::target {

bool read_all(void* bytes, std::size_t count) noexcept
{
    for (std::size_t done = 0; done < count;) {
        const ssize_t n = ::read(STDIN_FILENO, static_cast<char*>(bytes) + done, count - done);
        if (n <= 0) {
            return false;
        }
        done += static_cast<std::size_t>(n);
    }
    return true;
}

void write_all(const void* bytes, std::size_t count) noexcept
{
    for (std::size_t done = 0; done < count;) {
        const ssize_t n = ::write(STDOUT_FILENO, static_cast<const char*>(bytes) + done, count - done);
        if (n <= 0) {
            ::_exit(1);
        }
        done += static_cast<std::size_t>(n);
    }
}

std::uint32_t stack_used() noexcept { return 0; }

}  // namespace jink::target

int main() { jink::target::serve(); }
