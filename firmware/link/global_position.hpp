// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace jink::link {

/// Position on the globe in the unit of every link: degrees * 1e7, millimetres above mean sea level.
struct GlobalPosition {
    std::int32_t lat = 0;
    std::int32_t lon = 0;
    std::int32_t alt = 0;

    friend bool operator==(const GlobalPosition&, const GlobalPosition&) = default;
};

}  // namespace jink::link
