// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/simplex.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/random.hpp"

// The point of a simplex nearest to the origin against a search over all subsets of its points in double precision: the
// point of each subset's flat nearest to the origin, where it lies between the points. No regions, no signs of
// products.

namespace jink::geometry::detail {
namespace {

using Point = std::array<double, 3>;

Point to_double(const Vec3& v) { return {double(v.x()), double(v.y()), double(v.z())}; }
double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

struct Nearest {
    double distance = 0;
    std::vector<double> shares;  ///< of the points, summing to 1, all of them above 0
};

/// Shares of the points at which the flat through them comes nearest to the origin; none where they do not span one.
std::optional<std::vector<double>> shares_on_flat(const std::vector<Point>& points)
{
    // Least |p0 + sum x_i (p_i - p0)|: normal equations, elimination with pivots.
    const std::size_t n = points.size() - 1;
    std::vector<Point> edges;
    for (std::size_t i = 0; i < n; ++i) {
        edges.push_back(
            {points[i + 1][0] - points[0][0], points[i + 1][1] - points[0][1], points[i + 1][2] - points[0][2]});
    }
    std::array<std::array<double, 4>, 3> m{};
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
            m[i][j] = dot(edges[i], edges[j]);
            largest = std::max(largest, std::abs(m[i][j]));
        }
        m[i][n] = -dot(edges[i], points[0]);
    }
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t pivot = k;
        for (std::size_t i = k + 1; i < n; ++i) {
            pivot = std::abs(m[i][k]) > std::abs(m[pivot][k]) ? i : pivot;
        }
        if (std::abs(m[pivot][k]) <= 1e-12 * largest) {
            return std::nullopt;
        }
        std::swap(m[k], m[pivot]);
        for (std::size_t i = 0; i < n; ++i) {
            const double factor = i == k ? 0.0 : m[i][k] / m[k][k];
            for (std::size_t j = k; j <= n; ++j) {
                m[i][j] -= factor * m[k][j];
            }
        }
    }
    std::vector<double> shares(1, 1.0);
    for (std::size_t i = 0; i < n; ++i) {
        shares.push_back(m[i][n] / m[i][i]);
        shares[0] -= shares.back();
    }
    return shares;
}

/// Of the hull of the points; of equally near ones that of the fewest points.
Nearest nearest_of(const std::vector<Point>& points)
{
    Nearest best{1e300, {}};
    for (unsigned size = 1; size <= points.size(); ++size) {
        for (unsigned subset = 1; subset < 1U << points.size(); ++subset) {
            if (unsigned(std::popcount(subset)) != size) {
                continue;
            }
            std::vector<Point> chosen;
            for (std::size_t i = 0; i < points.size(); ++i) {
                if ((subset >> i & 1U) != 0) {
                    chosen.push_back(points[i]);
                }
            }
            const auto shares = shares_on_flat(chosen);
            if (!shares || *std::min_element(shares->begin(), shares->end()) < 0) {
                continue;
            }
            Point sum{};
            for (std::size_t i = 0; i < chosen.size(); ++i) {
                for (std::size_t k = 0; k < 3; ++k) {
                    sum[k] += (*shares)[i] * chosen[i][k];
                }
            }
            const double distance = std::sqrt(dot(sum, sum));
            if (distance < best.distance - 1e-9) {
                best = {distance, *shares};
            }
        }
    }
    return best;
}

std::vector<Point> points_of(const Simplex& simplex)
{
    std::vector<Point> points;
    for (std::size_t i = 0; i < simplex.size; ++i) {
        points.push_back(to_double(simplex.points[i]));
    }
    return points;
}

double largest_of(const std::vector<Point>& points)
{
    double largest = 0;
    for (const Point& p : points) {
        largest = std::max(largest, std::sqrt(dot(p, p)));
    }
    return largest;
}

/// Nearest point, kept points among the given ones, and nearest point of those. `tolerance` is relative.
void expect_nearest(const Simplex& given, double tolerance, const Nearest& expected, Simplex& kept)
{
    kept = given;
    const Vec3 found = reduce_to_nearest(kept);
    const double size = largest_of(points_of(given));
    ASSERT_NEAR(double(found.norm()), expected.distance, tolerance * size);
    ASSERT_GE(kept.size, 1U);
    ASSERT_LE(kept.size, given.size);
    for (std::size_t i = 0; i < kept.size; ++i) {
        ASSERT_NE(std::find(given.points.begin(), given.points.begin() + int(given.size), kept.points[i]),
                  given.points.begin() + int(given.size));
    }
    ASSERT_NEAR(nearest_of(points_of(kept)).distance, expected.distance, tolerance * size) << "kept the wrong ones";
}

/// Points with whole coordinates up to `side`: many lie in line, in a plane, on the border of regions or at the origin.
Simplex on_grid(Random& random, std::size_t size, std::uint64_t side)
{
    Simplex simplex;
    simplex.size = size;
    const auto any = [&] { return float(random.below(2 * side + 1)) - float(side); };
    for (std::size_t i = 0; i < size; ++i) {
        simplex.points[i] = Vec3(any(), any(), any());
    }
    return simplex;
}

bool is_flat(const std::vector<Point>& points) { return !shares_on_flat(points).has_value(); }

/// On a grid all products are exact, so that a nearest point on a border belongs to the smaller feature.
void expect_least_feature(std::uint64_t seed, std::size_t size, std::uint64_t side)
{
    Random random(seed);
    const Simplex given = on_grid(random, size, side);
    const Nearest expected = nearest_of(points_of(given));
    Simplex kept;
    expect_nearest(given, 1e-5, expected, kept);
    // Of a flat simplex several subsets may hold the point, and inside of a tetrahedron nothing is left out; an origin
    // on its surface is not inside.
    if (!is_flat(points_of(given)) && expected.shares.size() < 4) {
        ASSERT_EQ(kept.size, expected.shares.size());
    }
}

TEST(Simplex, SegmentsOnAGridKeepTheLeastFeature)
{
    for (std::uint64_t seed = 1; seed <= 20'000 && !::testing::Test::HasFatalFailure(); ++seed) {
        ::testing::ScopedTrace trace{__FILE__, __LINE__, seed};
        expect_least_feature(seed, 2, 2 + seed % 3);
    }
}

TEST(Simplex, TrianglesOnAGridKeepTheLeastFeature)
{
    for (std::uint64_t seed = 1; seed <= 60'000 && !::testing::Test::HasFatalFailure(); ++seed) {
        ::testing::ScopedTrace trace{__FILE__, __LINE__, seed};
        expect_least_feature(seed, 3, 1 + seed % 4);
    }
}

TEST(Simplex, TetrahedraOnAGridKeepTheLeastFeature)
{
    for (std::uint64_t seed = 1; seed <= 60'000 && !::testing::Test::HasFatalFailure(); ++seed) {
        ::testing::ScopedTrace trace{__FILE__, __LINE__, seed};
        expect_least_feature(seed, 4, 1 + seed % 4);
    }
}

/// Whether some three of the points are nearly in line: with a height of a hundredth of the sides and less, the
/// rounding of the points' differences turns the triangle's normal by 1e-5 and more.
bool is_slender(const std::vector<Point>& points)
{
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t j = i + 1; j < points.size(); ++j) {
            for (std::size_t k = j + 1; k < points.size(); ++k) {
                Point u{};
                Point v{};
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    u[axis] = points[j][axis] - points[i][axis];
                    v[axis] = points[k][axis] - points[i][axis];
                }
                const double sides = dot(u, u) * dot(v, v);
                if (sides - dot(u, v) * dot(u, v) < 1e-4 * sides) {
                    return true;
                }
            }
        }
    }
    return false;
}

TEST(Simplex, OfAnyPointsIsTheNearest)
{
    for (std::uint64_t seed = 1; seed <= 60'000 && !::testing::Test::HasFatalFailure(); ++seed) {
        ::testing::ScopedTrace trace{__FILE__, __LINE__, seed};
        Random random(seed);
        const float away = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 3.0F);
        const float scale = std::pow(10.0F, random.uniform(-3.0F, 3.0F));
        Simplex given;
        given.size = 1 + random.below(4);
        for (std::size_t i = 0; i < given.size; ++i) {
            given.points[i] = scale * Vec3(away + random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F),
                                           random.uniform(-1.0F, 1.0F));
        }
        if (!is_slender(points_of(given))) {
            Simplex kept;
            expect_nearest(given, 1e-4, nearest_of(points_of(given)), kept);
        }
    }
}

TEST(Simplex, HoldsTheOriginInsideOnly)
{
    for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
        Random random(seed);
        Simplex given;
        given.size = 4;
        Vec3 sum = Vec3::Zero();
        for (Vec3& point : given.points) {
            point = Vec3(random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F));
            sum += point;
        }
        for (Vec3& point : given.points) {
            point -= 0.25F * sum;  // its centre is the origin
        }
        const Vec3 a = given.points[1] - given.points[0];
        const Vec3 b = given.points[2] - given.points[0];
        const Vec3 c = given.points[3] - given.points[0];
        const float volume = a.x() * (b.y() * c.z() - b.z() * c.y()) + a.y() * (b.z() * c.x() - b.x() * c.z()) +
                             a.z() * (b.x() * c.y() - b.y() * c.x());
        if (std::abs(volume) < 1e-3F) {
            continue;
        }
        Simplex kept = given;
        ASSERT_TRUE(reduce_to_nearest(kept) == Vec3::Zero()) << "seed " << seed;
        ASSERT_EQ(kept.size, 4U) << "seed " << seed;
        ASSERT_TRUE(kept.points == given.points) << "seed " << seed;
    }
}

}  // namespace
}  // namespace jink::geometry::detail
