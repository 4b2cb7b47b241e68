// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

// What a probe program needs of the platform that it runs on: posix_io.cpp, semihosting_io.cpp.

namespace jink::target {

/// Reads all of `bytes`; false at the end of the input.
[[nodiscard]] bool read_all(void* bytes, std::size_t count) noexcept;
void write_all(const void* bytes, std::size_t count) noexcept;
/// [bytes] since start; 0 where it cannot be told.
[[nodiscard]] std::uint32_t stack_used() noexcept;

/// By the program: answers record after record until the input ends. Called by the platform.
void serve() noexcept;

}  // namespace jink::target
