// SPDX-License-Identifier: BSD-3-Clause
// The closed forms of the intruder models against Gomola's clouds of points, in double: no cell and no time of arrival
// is missed (avoidance specification, sections 2.5 to 2.7).
#include "tests/reference/reach/reference_models.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/base/random.hpp"
#include "tests/reference/reach/intruder.hpp"

namespace jink::reach {
namespace {

using reference::P;

std::vector<CellSphere> spheres_of(const Grid<float>& grid)
{
    std::vector<CellSphere> spheres;
    for (CellIndex cell = 0; cell < grid.cells(); ++cell) {
        spheres.push_back(sphere_of(grid, grid.place(cell)));
    }
    return spheres;
}

Intruder random_intruder(Random& random)
{
    Intruder intruder;
    const float z = random.uniform(-0.6F, 0.6F);
    const float azimuth = random.uniform(-kPi, kPi);
    const float level = std::sqrt(1.0F - z * z);
    intruder.velocity = random.uniform(0.5F, 8.0F) * Vec3(level * std::cos(azimuth), level * std::sin(azimuth), z);
    intruder.radius = random.uniform(0.2F, 1.5F);
    intruder.horizontal = random.uniform(0.0F, 0.8F);
    intruder.vertical = random.uniform(0.0F, 0.5F);
    intruder.speed_share = 0.1F;
    const Vec3 target =
        random.uniform(1.0F, 9.0F) * Vec3(1.0F, random.uniform(-0.9F, 0.9F), random.uniform(-0.5F, 0.5F)).normalized();
    intruder.position = target - random.uniform(0.0F, 3.0F) * intruder.velocity;
    return intruder;
}

reference::Intruder exact(const Intruder& i)
{
    return {i.position.cast<double>(), i.velocity.cast<double>(), static_cast<double>(i.radius),
            static_cast<double>(i.horizontal), static_cast<double>(i.vertical)};
}

struct Count {
    std::size_t touched = 0;
    std::size_t named = 0;
};

/// 60 cones, all 350 cells each, both laws of the lateral offset: 0 cells missed, 0 times of arrival outside.
TEST(IntruderReference, SixtyConesTimes350CellsMissNothing)
{
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    const Grid<float> grid;
    const Grid<double> exact_grid;
    const std::vector<CellSphere> spheres = spheres_of(grid);
    Count count;
    for (int i = 0; i < 60; ++i) {
        const Intruder intruder = random_intruder(random);
        const auto law = i % 4 == 0 ? reference::SpreadLaw::sine : reference::SpreadLaw::tangent;
        const reference::SpreadResult cloud = reference::spread(exact_grid, exact(intruder), 0.15, law);
        for (const auto& [cell, touch] : cloud.cells) {
            const std::optional<Stay> stay = spread_in(spheres[cell], intruder);
            ASSERT_TRUE(stay) << "seed " << kSeed << ", cone " << i << ", cell " << cell;
            ASSERT_LE(static_cast<double>(stay->from), touch.from + 1e-4);
            ASSERT_GE(static_cast<double>(stay->to), touch.to - 1e-4);
        }
        count.touched += cloud.cells.size();
        for (const CellSphere& sphere : spheres) {
            count.named += spread_in(sphere, intruder) ? 1U : 0U;
        }
    }
    EXPECT_GT(count.touched, 2000U);
    // The price of the cells' spheres and the intruder's: its body is not in the clouds.
    EXPECT_LT(count.named, 6 * count.touched);
    RecordProperty("named_per_touched_percent", static_cast<int>(100 * count.named / count.touched));
}

/// 40 bodies as clouds of points, whose times are the sphere's middle's: 0 cells missed, 0 times outside.
TEST(IntruderReference, BodiesMissNothing)
{
    constexpr std::uint64_t kSeed = 21;
    Random random(kSeed);
    const Grid<float> grid;
    const Grid<double> exact_grid;
    const std::vector<CellSphere> spheres = spheres_of(grid);
    Count count;
    for (int i = 0; i < 40; ++i) {
        const Intruder intruder = random_intruder(random);
        const reference::Touched cloud = reference::body(exact_grid, exact(intruder), 0.2);
        for (const auto& [cell, touch] : cloud) {
            const std::optional<Stay> stay = body_in(spheres[cell], intruder);
            ASSERT_TRUE(stay) << "seed " << kSeed << ", body " << i << ", cell " << cell;
            ASSERT_LE(static_cast<double>(stay->from), touch.from + 1e-4);
            ASSERT_GE(static_cast<double>(stay->to), touch.to - 1e-4);
        }
        count.touched += cloud.size();
        for (const CellSphere& sphere : spheres) {
            count.named += body_in(sphere, intruder) ? 1U : 0U;
        }
    }
    EXPECT_GT(count.touched, 500U);
    EXPECT_LT(count.named, 4 * count.touched);
    RecordProperty("named_per_touched_percent", static_cast<int>(100 * count.named / count.touched));
}

/// 300 lines, 400 samples each, in double: every sample lies in the cell that the traversal has at its time, unless it
/// is within 1e-4 of a wall of that cell or the line's distances round.
TEST(IntruderReference, ThreeHundredLinesOf400SamplesWithoutMismatch)
{
    constexpr std::uint64_t kSeed = 22;
    Random random(kSeed);
    const Grid<float> grid;
    const Grid<double> exact_grid;
    int samples = 0;
    std::size_t most = 0;
    for (int i = 0; i < 300; ++i) {
        const Intruder intruder = random_intruder(random);
        CrossedCells crossed;
        cross(grid, intruder.position, intruder.velocity, crossed);
        most = std::max(most, crossed.size());
        const double length =
            (10.0 + static_cast<double>(intruder.position.norm())) / static_cast<double>(intruder.velocity.norm());
        for (int k = 0; k < 400; ++k) {
            const double t = (k + 0.5) * length / 400.0;
            const P at = intruder.position.cast<double>() + t * intruder.velocity.cast<double>();
            const Located in = exact_grid.locate(at);
            const bool found = std::ranges::any_of(crossed, [&](const CellStay& c) {
                return t >= static_cast<double>(c.stay.from) - 1e-4 && t <= static_cast<double>(c.stay.to) + 1e-4 &&
                       (in.status != LocateStatus::inside || c.cell == grid.index(in.place));
            });
            if (in.status == LocateStatus::inside) {
                ++samples;
                ASSERT_TRUE(found) << "seed " << kSeed << ", line " << i << ", sample " << k;
            } else {
                // Outside nothing is named, but at the borders.
                const auto inner = [&](const CellStay& c) {
                    return t > static_cast<double>(c.stay.from) + 1e-3 && t < static_cast<double>(c.stay.to) - 1e-3;
                };
                ASSERT_FALSE(std::ranges::any_of(crossed, inner)) << "seed " << kSeed << ", line " << i;
            }
        }
    }
    EXPECT_GT(samples, 20000);
    EXPECT_LE(most, 41U);
}

}  // namespace
}  // namespace jink::reach
