// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

// Platform interface of a probe program: posix_io.cpp, semihosting_io.cpp.

namespace jink::target {

/// Reads all of `bytes`; false at the end of the input.
[[nodiscard]] bool read_all(void* bytes, std::size_t count) noexcept;
void write_all(const void* bytes, std::size_t count) noexcept;
/// [bytes] since start; 0 where unknown.
[[nodiscard]] std::uint32_t stack_used() noexcept;

/// Defined by the program: answers records until the input ends. Called by the platform.
void serve() noexcept;

}  // namespace jink::target
