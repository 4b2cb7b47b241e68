// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/exchange.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/base/work_units.hpp"

namespace jink::orca {

namespace {

constexpr int kMostTurns = 16;
constexpr float kBluntCorner = 1e-3F;  // volume that normals span, below which a corner is too blunt to compute with

/// What a corner is computed from.
struct Corners {
    std::span<const Row> rows;
    std::span<const float> yields;
    std::size_t soft;

    [[nodiscard]] float yield(std::size_t i) const noexcept { return i < soft ? 0.0F : yields[i]; }

    /// The shares of corner.rows: sum share * normal = 0, sum share * yield = 1. False where one is negative.
    [[nodiscard]] bool shares(Corner& corner) const noexcept
    {
        const auto& [a, b, c, d] = corner.rows;
        const Vec3 ab = rows[a].normal.cross(rows[b].normal);
        const Vec3 cd = rows[c].normal.cross(rows[d].normal);
        // Volumes of three normals each, alternating: the one solution of sum share * normal = 0.
        std::array<float, 4> part{rows[b].normal.dot(cd), -rows[a].normal.dot(cd), rows[d].normal.dot(ab),
                                  -rows[c].normal.dot(ab)};
        float sum = 0.0F;
        for (std::size_t k = 0; k < 4; ++k) {
            sum += part[k] * yield(corner.rows[k]);
        }
        if (std::fabs(sum) < kBluntCorner) {
            return false;
        }
        bool all = true;
        for (std::size_t k = 0; k < 4; ++k) {
            corner.shares[k] = part[k] / sum;
            all = all && corner.shares[k] >= 0.0F;
        }
        return all;
    }

    /// The point and the violation of a corner with its shares. False where it is too blunt.
    [[nodiscard]] bool solve(Corner& corner) const noexcept
    {
        // About the last point: what the rows are broken by there is exact to rounding, and small.
        std::array<float, 4> missing{};
        float d = 0.0F;
        for (std::size_t k = 0; k < 4; ++k) {
            missing[k] = rows[corner.rows[k]].violation(corner.x);
            d += corner.shares[k] * missing[k];
        }
        // Three of the four planes give the point: leave out the one with the largest share, whose others span most.
        const std::size_t out = static_cast<std::size_t>(std::max_element(corner.shares.begin(), corner.shares.end()) -
                                                         corner.shares.begin());
        std::array<std::size_t, 3> of{};
        std::size_t n = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            if (k != out) {
                of[n++] = k;
            }
        }
        const Vec3& n0 = rows[corner.rows[of[0]]].normal;
        const Vec3& n1 = rows[corner.rows[of[1]]].normal;
        const Vec3& n2 = rows[corner.rows[of[2]]].normal;
        const Vec3 n12 = n1.cross(n2);
        const float volume = n0.dot(n12);
        if (std::fabs(volume) < kBluntCorner) {
            return false;
        }
        const auto away = [&](std::size_t k) { return missing[of[k]] - d * yield(corner.rows[of[k]]); };
        corner.x += (away(0) * n12 + away(1) * n2.cross(n0) + away(2) * n0.cross(n1)) / volume;
        corner.d = d;
        return true;
    }

    /// `corner` with `entering` in the place of the row that makes it a corner again.
    [[nodiscard]] bool exchanged(std::uint16_t entering, Corner& corner) const noexcept
    {
        for (std::size_t k = 0; k < 4; ++k) {
            Corner next = corner;
            next.rows[k] = entering;
            if (shares(next) && solve(next)) {
                corner = next;
                return true;
            }
        }
        return false;
    }
};

}  // namespace

bool exchange(std::span<const Row> rows, std::span<const float> yields, std::size_t soft, Balls balls,
              Tolerance tolerance, WorkBudget& budget, Corner& corner) noexcept
{
    const Corners corners{rows, yields, soft};
    corner.x = Vec3::Zero();
    if (!corners.shares(corner) || !corners.solve(corner)) {
        return false;
    }
    for (int turn = 0; turn < kMostTurns; ++turn) {
        if (!budget.spend(units::kOrcaExchange + units::orca_rows(rows.size()))) {
            return false;
        }
        float most = 4.0F * tolerance.outside;
        std::size_t entering = rows.size();
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const float by = rows[i].violation(corner.x) - (i < soft ? 0.0F : corner.d * yields[i]);
            if (by > most) {
                most = by;
                entering = i;
            }
        }
        if (entering == rows.size()) {
            return std::all_of(balls.begin(), balls.end(), [&](const Ball& ball) {
                return (corner.x - ball.centre).norm() <= ball.radius + tolerance.outside;
            });
        }
        const float before = corner.d;
        if (!corners.exchanged(static_cast<std::uint16_t>(entering), corner) || corner.d <= before) {
            return false;
        }
    }
    return false;
}

}  // namespace jink::orca
