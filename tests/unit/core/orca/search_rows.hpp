// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/orca/search.hpp"

namespace jink::orca::test {

/// Rows for velocities of about 4 m/s, with the other inputs of a search. Each search begins with the rows as given.
class SearchRows : public ::testing::Test {
protected:
    explicit SearchRows(float radius) : spheres{{Vec3::Zero(), radius}} {}

    void add(const Vec3& normal, float offset, float yield = 1.0F)
    {
        rows.push_back({normal, offset});
        yields.push_back(yield);
    }
    void clear()
    {
        rows.clear();
        yields.clear();
    }
    template <class Real>
    Search<Real> search_for(const Vec3& goal, WorkBudget& budget)
    {
        shifted = rows;
        derived.resize(rows.size());
        held.resize(rows.size() + 8);
        return Search<Real>(spheres, goal, {shifted, derived, yields, held}, scale, budget);
    }
    /// Largest violation of the first `count` rows at `x`.
    [[nodiscard]] float outside(std::size_t count, const Vec3& x) const
    {
        float out = 0.0F;
        for (std::size_t i = 0; i < count; ++i) {
            out = std::max(out, rows[i].violation(x));
        }
        return out;
    }
    /// Largest violation of the rows from `from` on at `x`, in units of their yields.
    [[nodiscard]] float given_way(std::size_t from, const Vec3& x) const
    {
        float out = 0.0F;
        for (std::size_t i = from; i < rows.size(); ++i) {
            out = std::max(out, rows[i].violation(x) / yields[i]);
        }
        return out;
    }

    float scale = 4.0F;
    std::vector<Row> rows;
    std::vector<Row> shifted;  ///< rows after yielding
    std::vector<Row> derived;
    std::vector<float> yields;
    std::vector<std::uint16_t> held;
    std::vector<Sphere> spheres;
};

}  // namespace jink::orca::test
