// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

// What a flight log says of own state and tracks, at any time between its messages. World frame; metres, seconds.

namespace jink::host {

/// A track is logged every 0.2 s; without news for longer it is gone [s].
inline constexpr double kTrackLife = 0.5;

struct Sighting {
    double time = 0.0;
    std::array<double, 3> position{}, velocity{};
    double radius = 0.0, half_height = 0.0;
};

struct OwnAt {
    double time = 0.0;
    std::array<double, 3> position{}, velocity{};
};

/// Where something was at a time, from what is known of it before and its velocity then.
template <class Known>
std::array<double, 3> carried(const Known& known, double time)
{
    std::array<double, 3> place{};
    for (std::size_t k = 0; k < 3; ++k) {
        place[k] = known.position[k] + (time - known.time) * known.velocity[k];
    }
    return place;
}

/// The last item at or before a time, none where that is older than `life`. Items are in order of time.
template <class Item>
const Item* latest(const std::vector<Item>& items, double time, double life)
{
    const auto after =
        std::upper_bound(items.begin(), items.end(), time, [](double t, const Item& item) { return t < item.time; });
    return after == items.begin() || time - (after - 1)->time > life ? nullptr : &*(after - 1);
}

inline double distance_to_surface(const std::array<double, 3>& own, const std::array<double, 3>& at,
                                  const Sighting& track)
{
    const double up = std::max(0.0, std::abs(own[2] - at[2]) - track.half_height);
    return std::hypot(own[0] - at[0], own[1] - at[1], up) - track.radius;
}

/// Two aircraft under one id differ in their instance.
inline std::string track_name(unsigned id, unsigned instance)
{
    return "track " + std::to_string(id) + (instance > 0 ? " (" + std::to_string(instance + 1) + ")" : "");
}

}  // namespace jink::host
