// SPDX-License-Identifier: BSD-3-Clause
// More intruders than there is room for: the avoidance specification, section 2.10.
#include "core/reach/intruder_table.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace jink::reach {
namespace {

/// Comes head on from so far, at 1 a second, speed known exactly.
Intruder from_afar(float distance)
{
    Intruder intruder;
    intruder.position = Vec3(distance, 0, 0);
    intruder.velocity = Vec3(-1, 0, 0);
    intruder.speed_share = 0.0F;
    return intruder;
}

TEST(IntruderTables, EntryIsWhenTheGridsRangeIsReached)
{
    const Grid<float> grid;
    EXPECT_NEAR(entry_time(grid, from_afar(30.0F)), 20.0F, 1e-4F);
    EXPECT_EQ(entry_time(grid, from_afar(5.0F)), 0.0F);
    Intruder leaves = from_afar(30.0F);
    leaves.velocity = Vec3(1, 0, 0);
    EXPECT_TRUE(std::isinf(entry_time(grid, leaves)));
    leaves.velocity = Vec3::Zero();
    EXPECT_TRUE(std::isinf(entry_time(grid, leaves)));
    leaves.position = Vec3(9, 0, 0);
    EXPECT_EQ(entry_time(grid, leaves), 0.0F) << "it stands in the grid";
    Intruder passes = from_afar(30.0F);
    passes.position.y() = 14.0F;
    EXPECT_TRUE(std::isinf(entry_time(grid, passes)));
    passes.horizontal = 0.4F;
    EXPECT_FALSE(std::isinf(entry_time(grid, passes))) << "it may turn towards it";
}

TEST(IntruderTables, TheMostUrgentAreKeptAndTheRestCounted)
{
    const Grid<float> grid;
    constexpr std::uint64_t kSeed = 3;
    Random random(kSeed);
    for (int i = 0; i < 200; ++i) {
        const std::size_t count = kMaxReachIntruders + random.below(20);
        IntruderTable table;
        std::vector<std::pair<float, std::uint32_t>> all;
        for (std::size_t n = 0; n < count; ++n) {
            // Whole seconds, so that ids decide now and then.
            const Intruder intruder = from_afar(10.0F + static_cast<float>(random.below(30)));
            const auto id = static_cast<std::uint32_t>(n * 7919U % 1009U);
            EXPECT_EQ(table.add(grid, id, intruder), n < kMaxReachIntruders);
            all.emplace_back(entry_time(grid, intruder), id);
        }
        EXPECT_EQ(table.overflow(), count - kMaxReachIntruders);
        std::ranges::sort(all);
        std::vector<std::pair<float, std::uint32_t>> kept;
        for (const TableIntruder& intruder : table.intruders()) {
            kept.emplace_back(intruder.entry, intruder.id);
        }
        std::ranges::sort(kept);
        all.resize(kMaxReachIntruders);
        ASSERT_EQ(kept, all) << "seed " << kSeed << ", case " << i;
        table.clear();
        EXPECT_TRUE(table.intruders().empty());
        EXPECT_EQ(table.overflow(), 0U);
    }
}

}  // namespace
}  // namespace jink::reach
