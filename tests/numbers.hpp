// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

namespace jink {

/// A value that no interface may accept as a number.
inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace jink
