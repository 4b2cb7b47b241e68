// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/exchange.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <Eigen/Geometry>

#include "core/base/work_units.hpp"

namespace jink::orca {

using std::fabs;

namespace {

constexpr int kMaxTurns = 16;
/// Volume that normals span, below which a corner is too blunt to compute with.
template <class Real>
constexpr float kBluntCorner = std::is_same_v<Real, float> ? 1e-3F : 1e-10F;

/// What a corner is computed from.
template <class Real>
struct Corners {
    using V = Vec3Of<Real>;
    std::span<const Row> rows;
    std::span<const float> yields;
    std::size_t soft = 0;

    [[nodiscard]] Real yield(std::size_t i) const noexcept { return i < soft ? 0.0F : yields[i]; }
    [[nodiscard]] V normal(std::size_t i) const noexcept { return rows[i].normal.template cast<Real>(); }

    /// The shares of corner.rows: sum share * normal = 0, sum share * yield = 1. False where one is negative.
    [[nodiscard]] bool shares(Corner<Real>& corner) const noexcept
    {
        const auto& [a, b, c, d] = corner.rows;
        const V ab = normal(a).cross(normal(b));
        const V cd = normal(c).cross(normal(d));
        // Volumes of three normals each, alternating: the one solution of sum share * normal = 0.
        const std::array<Real, 4> part{normal(b).dot(cd), -normal(a).dot(cd), normal(d).dot(ab), -normal(c).dot(ab)};
        Real sum = 0.0F;
        for (std::size_t k = 0; k < 4; ++k) {
            sum += part[k] * yield(corner.rows[k]);
        }
        if (fabs(sum) < kBluntCorner<Real>) {
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
    [[nodiscard]] bool solve(Corner<Real>& corner) const noexcept
    {
        // About the last point: what the rows are broken by there is exact to rounding, and small.
        std::array<Real, 4> missing{};
        Real d = 0.0F;
        for (std::size_t k = 0; k < 4; ++k) {
            missing[k] = violation<Real>(rows[corner.rows[k]], corner.x);
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
        const V n0 = normal(corner.rows[of[0]]);
        const V n1 = normal(corner.rows[of[1]]);
        const V n2 = normal(corner.rows[of[2]]);
        const V n12 = n1.cross(n2);
        const Real volume = n0.dot(n12);
        if (fabs(volume) < kBluntCorner<Real>) {
            return false;
        }
        const auto away = [&](std::size_t k) { return missing[of[k]] - d * yield(corner.rows[of[k]]); };
        corner.x += (away(0) * n12 + away(1) * n2.cross(n0) + away(2) * n0.cross(n1)) / volume;
        corner.d = d;
        return true;
    }

    /// `corner` with `entering` in the place of the row that makes it a corner again.
    [[nodiscard]] bool exchanged(std::uint16_t entering, Corner<Real>& corner) const noexcept
    {
        for (std::size_t k = 0; k < 4; ++k) {
            Corner<Real> next = corner;
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

template <class Real>
bool exchange(std::span<const Row> rows, std::span<const float> yields, std::size_t soft, Spheres spheres,
              Tolerance<Real> tolerance, WorkBudget& budget, Corner<Real>& corner) noexcept
{
    const Corners<Real> corners{rows, yields, soft};
    corner.x = Vec3Of<Real>::Zero();
    if (!corners.shares(corner) || !corners.solve(corner)) {
        return false;
    }
    for (int turn = 0; turn < kMaxTurns; ++turn) {
        if (!budget.spend(cost<Real>(units::kOrcaExchange + units::orca_rows(rows.size())))) {
            return false;
        }
        Real most = 2.0F * tolerance.outside;
        int near = 0;
        std::size_t entering = rows.size();
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const Real by = violation<Real>(rows[i], corner.x) - (i < soft ? Real(0.0F) : corner.d * yields[i]);
            near += by > -4.0F * tolerance.outside ? 1 : 0;
            if (by > most) {
                most = by;
                entering = i;
            }
        }
        if (entering == rows.size()) {
            corner.is_alone = near <= 4;
            return std::all_of(spheres.begin(), spheres.end(),
                               [&](const Sphere& sphere) { return within<Real>(sphere, corner.x, tolerance.outside); });
        }
        const Real before = corner.d;
        if (!corners.exchanged(static_cast<std::uint16_t>(entering), corner) || corner.d <= before) {
            return false;
        }
    }
    return false;
}

template bool exchange(std::span<const Row>, std::span<const float>, std::size_t, Spheres, Tolerance<float>,
                       WorkBudget&, Corner<float>&) noexcept;
template bool exchange(std::span<const Row>, std::span<const float>, std::size_t, Spheres, Tolerance<DoubleFloat>,
                       WorkBudget&, Corner<DoubleFloat>&) noexcept;

}  // namespace jink::orca
