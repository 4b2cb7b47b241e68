// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/random.hpp"

namespace jink::sim {

/// Uniform in [low, high), 24 bits: one number of the stream. O(1).
[[nodiscard]] inline double uniform(Random& random, double low, double high)
{
    return low + (high - low) * static_cast<double>(random.uniform());
}

}  // namespace jink::sim
