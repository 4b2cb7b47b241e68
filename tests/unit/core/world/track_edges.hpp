// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include "core/world/track_table.hpp"

namespace jink::world::test {

inline constexpr TimePoint kStart{80'000'000};

inline TrackMeasurement seen(TrackId id, const Vec3& position, TimePoint stamp = kStart)
{
    TrackMeasurement m;
    m.id = id;
    m.stamp = stamp;
    m.position = position;
    m.has_velocity = true;
    m.radius = 1.0F;
    m.sigma_position = 0.5F;
    m.sigma_velocity = 0.3F;
    return m;
}

struct TrackEdges : testing::Test {
    TrackStatus take(const TrackMeasurement& m) { return table.update(m, own, m.stamp); }
    [[nodiscard]] Track only(TimePoint at)
    {
        const auto tracks = table.snapshot(at);
        EXPECT_EQ(tracks.size(), 1U);
        return tracks.empty() ? Track{} : tracks[0];
    }

    TrackTableSettings settings;
    TrackTable table;
    vehicle::VehicleState own;
};

}  // namespace jink::world::test
