// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace jink::sim {

/// SHA-256 over the sources that a flight in process is made of (core, hal, firmware, toolchain/sim), the compiler and
/// the kind of build: what has the same digest flies the same, bit by bit. Made by source_digest.cmake at build time.
[[nodiscard]] const char* source_digest() noexcept;

}  // namespace jink::sim
