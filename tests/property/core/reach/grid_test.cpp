// SPDX-License-Identifier: BSD-3-Clause
// Every point of the grid lies in one cell, and in the one that its ranges say.
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/reach/cell_finder.hpp"

namespace jink::reach {
namespace {

template <class T>
bool within(T value, T from, T to, T slack)
{
    return value >= from - slack && value <= to + slack;
}

template <class T>
void every_point_lies_in_its_cell(int count, T slack)
{
    constexpr std::uint64_t kSeed = 11;
    Random random(kSeed);
    const Grid<T> grids[] = {Grid<T>(), Grid<T>(16, 16, 16, T(150), T(3.1), T(1.5)),
                             Grid<T>(1, 1, 1, T(2), T(0.1), T(0.2))};
    int inside = 0;
    for (int i = 0; i < count; ++i) {
        const Grid<T>& grid = grids[random.below(3)];
        const auto in = [&](T size) { return static_cast<T>(random.uniform(-1.0F, 1.0F)) * size; };
        const Polar<T> polar{std::abs(in(grid.distance() * T(1.1))), in(std::min(grid.horizontal() * T(1.1), T(3.14))),
                             in(std::min(grid.vertical() * T(1.1), T(1.57)))};
        const Point<T> point = from_polar(polar);
        const Located at = grid.locate(point);
        const bool far = polar.distance > grid.distance() * (T(1) + slack) ||
                         std::abs(polar.horizontal) > grid.horizontal() * (T(1) + slack) ||
                         std::abs(polar.vertical) > grid.vertical() * (T(1) + slack);
        if (far) {
            ASSERT_NE(at.status, LocateStatus::inside) << "case " << i;
            continue;
        }
        if (at.status != LocateStatus::inside) {
            continue;  // within rounding of the border
        }
        ++inside;
        const CellPlace& p = at.place;
        ASSERT_LT(grid.index(p), grid.cells());
        const T near = slack * grid.distance();
        ASSERT_TRUE(within(polar.distance, grid.layer_start(p.layer), grid.layer_end(p.layer), near)) << "case " << i;
        // Near the vehicle rounding dominates the angles.
        const T angle = slack * (T(1) + grid.distance() / std::max(polar.distance * std::cos(polar.vertical), T(1e-3)));
        ASSERT_TRUE(within(polar.horizontal, grid.column_start(p.column), grid.column_start(p.column + 1U), angle))
            << "case " << i;
        ASSERT_TRUE(within(polar.vertical, grid.row_start(p.row), grid.row_start(p.row + 1U), angle)) << "case " << i;
    }
    EXPECT_GT(inside, count / 2);
}

TEST(GridLaws, EveryPointLiesInItsCell)
{
    every_point_lies_in_its_cell<double>(500000, 1e-8);
    every_point_lies_in_its_cell<float>(500000, 2e-5F);
}

TEST(GridLaws, CentresLieInTheirCells)
{
    const Grid<float> grid;
    for (CellIndex cell = 0; cell < grid.cells(); ++cell) {
        const Located at = grid.locate(grid.centre(grid.place(cell)));
        ASSERT_EQ(at.status, LocateStatus::inside);
        ASSERT_EQ(grid.index(at.place), cell);
    }
}

/// Without angles as by angles, but for points on a face.
TEST(CellFinderLaw, ManyPointsLieWhereEachOfThemDoes)
{
    Random random(13);
    const Grid<float> grids[] = {Grid<float>(),
                                 Grid<float>(16, 16, 16, 150.0F, 1.5F, 1.5F),
                                 Grid<float>(1, 1, 1, 2.0F, 0.1F, 0.2F),
                                 Grid<float>(7, 3, 5, 10.0F, 0.7F, 0.4F),
                                 Grid<float>(10, 28, 5, 10.0F, kPi, 0.5F),
                                 Grid<float>(10, 32, 5, 8.0F, 2.5F, 0.5F)};
    std::size_t inside = 0;
    std::size_t points = 0;
    for (int i = 0; i < 40000; ++i) {
        const Grid<float>& grid = grids[random.below(6)];
        const CellFinder finder(grid);
        const std::size_t n = 1 + random.below(CellFinder::kAtOnce);
        CellFinder::Coordinates x{};
        CellFinder::Coordinates y{};
        CellFinder::Coordinates z{};
        for (std::size_t k = 0; k < n; ++k) {
            const auto in = [&] { return 1.1F * grid.distance() * random.uniform(-1.0F, 1.0F); };
            Vec3 point(random.below(4) == 0 ? in() : std::abs(in()), 0.7F * in(), 0.5F * in());
            if (random.below(8) == 0) {  // on the end of a layer, to the last bit or so
                point *= grid.layer_end(random.below(static_cast<std::uint32_t>(grid.layers()))) / point.norm();
            }
            x[k] = point.x();
            y[k] = point.y();
            z[k] = random.below(500) == 0 ? std::numeric_limits<float>::infinity() : point.z();
        }
        std::array<CellIndex, CellFinder::kAtOnce> found{};
        finder.locate_all(x, y, z, {found.data(), n});
        for (std::size_t k = 0; k < n; ++k) {
            const Vec3 point(x[k], y[k], z[k]);
            const Located at = finder.locate(point);
            const CellIndex expected = at.status == LocateStatus::inside ? grid.index(at.place) : kNoCell;
            // The length of a point may be summed up in another order: layers may differ where one ends there.
            const float layers = point.norm() / grid.distance() * static_cast<float>(grid.layers());
            if (expected != found[k] && std::abs(layers - std::round(layers)) < 1e-5F * std::max(layers, 1.0F)) {
                continue;
            }
            ASSERT_EQ(found[k], expected) << "round " << i << ", point " << k;
            inside += expected != kNoCell ? 1U : 0U;
            ++points;
        }
    }
    EXPECT_GT(inside, points / 10);
}

TEST(CellFinderLaw, FindsTheCellThatTheGridLocates)
{
    std::size_t inside = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        Random random(seed);
        const bool is_around = random.below(4) == 0;
        const float horizontal = is_around ? kPi : random.uniform(0.1F, 3.1F);
        const Grid<float> grid(1 + random.below(16), 1 + random.below(32), 1 + random.below(16),
                               random.uniform(0.5F, 200.0F), horizontal, random.uniform(0.1F, 1.5F));
        ASSERT_TRUE(CellFinder::serves(grid));
        const CellFinder finder(grid);
        const float slack = 1e-5F * grid.distance();
        for (int i = 0; i < 5000; ++i) {
            const auto in = [&] { return random.uniform(-1.1F, 1.1F) * grid.distance(); };
            const Vec3 point(in(), in(), in());
            const Located found = finder.locate(point);
            const Located located = grid.locate(point);
            inside += located.status == LocateStatus::inside ? 1U : 0U;
            if (found.status == located.status && found.place == located.place) {
                continue;
            }
            // Some point about it lies on the other side of a face.
            bool on_a_face = false;
            for (int axis = 0; axis < 3; ++axis) {
                for (const float sign : {-slack, slack}) {
                    Vec3 moved = point;
                    moved[axis] += sign;
                    const Located at = grid.locate(moved);
                    on_a_face = on_a_face || (at.status == found.status && at.place == found.place);
                }
            }
            ASSERT_TRUE(on_a_face) << "seed " << seed << " point " << i;
        }
    }
    EXPECT_GT(inside, 10000U);
    const CellFinder finder{Grid<float>()};
    EXPECT_EQ(finder.locate(Vec3(NAN, 0.0F, 0.0F)).status, LocateStatus::not_a_number);
    EXPECT_EQ(finder.locate(Vec3(INFINITY, 0.0F, 0.0F)).status, LocateStatus::outside);
    EXPECT_EQ(finder.locate(Vec3(-1.0F, 0.0F, 0.0F)).status, LocateStatus::outside) << "behind";
    EXPECT_EQ(finder.locate(Vec3::Zero()).status, LocateStatus::inside);
    EXPECT_TRUE(CellFinder::serves(Grid<float>(1, 32, 1, 1.0F, kPi, 0.5F)));
    EXPECT_FALSE(CellFinder::serves(Grid<float>(1, 33, 1, 1.0F, kPi, 0.5F)));
    EXPECT_FALSE(CellFinder::serves(Grid<float>(1, 1, 1, 1.0F, 3.2F, 0.5F)));
    EXPECT_FALSE(CellFinder::serves(Grid<float>(1, 1, 1, 1.0F, 0.5F, 1.6F)));
    const CellFinder around{Grid<float>(1, 4, 1, 1.0F, kPi, 0.5F)};
    for (const float right_or_left : {-1e-6F, -0.0F, 0.0F, 1e-6F}) {
        const Located behind = around.locate(Vec3(-0.5F, right_or_left, 0.0F));
        EXPECT_EQ(behind.status, LocateStatus::inside) << "behind";
        EXPECT_EQ(behind.place.column, right_or_left < 0.0F ? 0 : 3) << right_or_left;
    }
}

}  // namespace
}  // namespace jink::reach
