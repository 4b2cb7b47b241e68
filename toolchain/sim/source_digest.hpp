// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace jink::sim {

/// SHA-256 over the sources of a flight in process (core, hal, firmware, toolchain/sim), the compiler and the build
/// type. Programs with the same digest give bit-identical flights. Computed by source_digest.cmake at build time.
[[nodiscard]] const char* source_digest() noexcept;

}  // namespace jink::sim
