// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>

#include "core/world/world.hpp"

namespace jink::world::test {

/// Whether two manoeuvres are the same to the last bit; `by` is left out.
inline bool same_bits(const Manoeuvre& a, const Manoeuvre& b) noexcept
{
    const auto same = [](const auto& x, const auto& y) noexcept { return std::memcmp(&x, &y, sizeof x) == 0; };
    bool equal = a.kind == b.kind && a.start.us == b.start.us && a.valid_until.us == b.valid_until.us &&
                 same(a.command, b.command) && same(a.side, b.side) && same(a.cost, b.cost) &&
                 a.path.points.size() == b.path.points.size();
    for (std::size_t i = 0; equal && i < a.path.points.size(); ++i) {
        equal = same(a.path.points[i].position, b.path.points[i].position) &&
                same(a.path.points[i].velocity, b.path.points[i].velocity) &&
                same(a.path.points[i].time, b.path.points[i].time);
    }
    return equal;
}

}  // namespace jink::world::test
