// SPDX-License-Identifier: BSD-3-Clause
// Intruder models against samples of where the intruder may be: no cell and no time is missed.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "core/base/random.hpp"
#include "tests/reference/reach/intruder.hpp"

namespace jink::reach {
namespace {

Vec3 any_direction(Random& random)
{
    const float z = random.uniform(-1.0F, 1.0F);
    const float azimuth = random.uniform(-kPi, kPi);
    const float r = std::sqrt(1.0F - z * z);
    return {r * std::cos(azimuth), r * std::sin(azimuth), z};
}

/// 300 lines, 400 samples each: the cell that a sample is in is on the list, at that time.
TEST(IntruderLaws, LinesMissNothing)
{
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    const Grid<float> grid;
    int inside = 0;
    int mismatches = 0;
    for (int i = 0; i < 3000; ++i) {
        const Vec3 target = random.uniform(0.5F, 10.0F) *
                            Vec3(1.0F, random.uniform(-0.9F, 0.9F), random.uniform(-0.5F, 0.5F)).normalized();
        const Vec3 velocity = random.uniform(0.2F, 8.0F) * any_direction(random);
        const float meets = random.uniform(0.0F, 5.0F);
        const Vec3 start = target - meets * velocity;
        CrossedCells cells;
        cross(grid, start, velocity, cells);
        const float step = 2.0F * (meets + 10.0F / velocity.norm()) / 400.0F;
        for (int k = 0; k < 400; ++k) {
            const float t = (static_cast<float>(k) + 0.5F) * step;
            const Located at = grid.locate(Vec3(start + t * velocity));
            if (at.status != LocateStatus::inside) {
                continue;
            }
            ++inside;
            const CellIndex cell = grid.index(at.place);
            bool found = false;
            for (const CellStay& c : cells) {
                // Within rounding of a border another cell may be named.
                found = found || (c.cell == cell && t >= c.stay.from - 1e-4F && t <= c.stay.to + 1e-4F);
            }
            mismatches += found ? 0 : 1;
        }
    }
    EXPECT_GT(inside, 100000);
    // A sample within rounding of a cell's border, and nothing else.
    EXPECT_LE(mismatches, inside / 20000) << "seed " << kSeed;
}

/// 10^5 points of bodies that deviate within their cones: no cell, no time missed.
TEST(IntruderLaws, ConesMissNothing)
{
    constexpr std::uint64_t kSeed = 3;
    Random random(kSeed);
    const Grid<float> grid;
    std::vector<CellSphere> spheres;
    for (CellIndex cell = 0; cell < grid.cells(); ++cell) {
        spheres.push_back(sphere_of(grid, grid.place(cell)));
    }
    int inside = 0;
    for (int i = 0; inside < 100000; ++i) {
        ASSERT_LT(i, 20000);
        Intruder intruder;
        intruder.velocity =
            random.uniform(0.2F, 8.0F) * (i % 10 == 0 ? Vec3(0, 0, i % 20 == 0 ? 1.0F : -1.0F) : any_direction(random));
        intruder.radius = random.uniform(0.0F, 1.5F);
        intruder.horizontal = i % 7 == 0 ? 0.0F : random.uniform(0.0F, kMaxSpread);
        intruder.vertical = i % 5 == 0 ? 0.0F : random.uniform(0.0F, kMaxSpread);
        intruder.speed_share = random.uniform(0.0F, 0.5F);
        const Vec3 target = random.uniform(0.5F, 10.0F) *
                            Vec3(1.0F, random.uniform(-0.9F, 0.9F), random.uniform(-0.5F, 0.5F)).normalized();
        intruder.position = target - random.uniform(0.0F, 5.0F) * intruder.velocity;
        const Vec3 along = intruder.velocity.normalized();
        Vec3 left = Vec3::UnitZ().cross(along);
        left = left.norm() < 1e-3F ? Vec3(Vec3::UnitX()) : Vec3(left.normalized());
        const Vec3 up = along.cross(left);
        for (int k = 0; k < 300; ++k) {
            // A point of the ellipse at some axial distance, and one of the body about it.
            const float axial = random.uniform(0.0F, 25.0F);
            const float angle = random.uniform(-kPi, kPi);
            const float share = std::sqrt(random.uniform(0.0F, 1.0F));
            const Vec3 centre = intruder.position + axial * along +
                                share * std::cos(angle) * std::tan(intruder.horizontal) * axial * left +
                                share * std::sin(angle) * std::tan(intruder.vertical) * axial * up;
            const Vec3 point = centre + random.uniform(0.0F, intruder.radius) * any_direction(random);
            const Located at = grid.locate(point);
            if (at.status != LocateStatus::inside) {
                continue;
            }
            ++inside;
            const std::optional<Stay> stay = spread_in(spheres[grid.index(at.place)], intruder);
            ASSERT_TRUE(stay) << "seed " << kSeed << ", case " << i << ", sample " << k;
            // The straight path to the centre, at any possible speed.
            const float way = (centre - intruder.position).norm();
            const float slow = intruder.velocity.norm() * (1.0F - intruder.speed_share);
            const float fast = intruder.velocity.norm() * (1.0F + intruder.speed_share);
            ASSERT_LE(stay->from, way / fast + 1e-4F) << "seed " << kSeed << ", case " << i << ", sample " << k;
            ASSERT_GE(stay->to, way / slow - 1e-3F) << "seed " << kSeed << ", case " << i << ", sample " << k;
        }
    }
}

/// Bodies flying straight, by samples of the line and the body.
TEST(IntruderLaws, BodiesMissNothing)
{
    constexpr std::uint64_t kSeed = 4;
    Random random(kSeed);
    const Grid<float> grid;
    int inside = 0;
    for (int i = 0; inside < 100000; ++i) {
        ASSERT_LT(i, 20000);
        Intruder intruder;
        intruder.velocity = i % 9 == 0 ? Vec3(Vec3::Zero()) : Vec3(random.uniform(0.2F, 8.0F) * any_direction(random));
        intruder.radius = random.uniform(0.0F, 3.0F);
        const Vec3 target = random.uniform(0.5F, 10.0F) *
                            Vec3(1.0F, random.uniform(-0.9F, 0.9F), random.uniform(-0.5F, 0.5F)).normalized();
        intruder.position = target - random.uniform(0.0F, 5.0F) * intruder.velocity;
        for (int k = 0; k < 100; ++k) {
            const float t = random.uniform(0.0F, 10.0F);
            const Vec3 point = intruder.position + t * intruder.velocity +
                               random.uniform(0.0F, intruder.radius) * any_direction(random);
            const Located at = grid.locate(point);
            if (at.status != LocateStatus::inside) {
                continue;
            }
            ++inside;
            const std::optional<Stay> stay = body_in(sphere_of(grid, at.place), intruder);
            ASSERT_TRUE(stay && stay->from <= t + 1e-3F && stay->to >= t - 1e-3F)
                << "seed " << kSeed << ", case " << i << ", sample " << k;
        }
    }
}

/// The sphere of a cell contains the whole cell.
TEST(IntruderLaws, SpheresHoldTheirCells)
{
    Random random(8);
    const Grid<float> grids[] = {Grid<float>(), Grid<float>(4, 3, 3, 8.0F, 1.4F, 0.9F)};
    for (const Grid<float>& grid : grids) {
        for (int i = 0; i < 50000; ++i) {
            const Vec3 point = from_polar(Polar<float>{random.uniform(0.0F, grid.distance()),
                                                       random.uniform(-grid.horizontal(), grid.horizontal()),
                                                       random.uniform(-grid.vertical(), grid.vertical())});
            const Located at = grid.locate(point);
            if (at.status == LocateStatus::inside) {
                const CellSphere sphere = sphere_of(grid, at.place);
                ASSERT_LE((point - sphere.centre).norm(), sphere.radius + 1e-4F);
            }
        }
    }
}

}  // namespace
}  // namespace jink::reach
