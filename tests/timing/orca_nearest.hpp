// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/vec3.hpp"

namespace jink::orca {

/// The nearest of many moving points, exactly. A k-d tree finds for each point the points within a wider circle than
/// requested. Only those are checked until outside points may have come nearer. The constructor allocates all memory.
class NearestPoints {
public:
    /// Points kept at most of one query.
    static constexpr std::size_t kMax = 128;
    struct Found {
        float distance2 = 0.0F;
        std::uint32_t index = 0;
    };

    /// @param most   asked for by each query, < kMax
    /// @param range  [m] search range
    NearestPoints(std::size_t points, std::size_t most, float range);

    /// The points have moved, each by `moved` [m] at most.
    void move(const std::vector<Vec3>& points, float moved);
    /// The `most` nearest within range of points[self], but for itself, nearest first, and one more if there is one.
    std::size_t query(std::size_t self, std::array<Found, kMax>& found);

private:
    static constexpr std::uint32_t kLeaf = 8;
    struct Node {
        Vec3 low, high;
        std::uint32_t begin, end;
        std::uint32_t left;  ///< its right twin follows; 0 for a leaf
    };
    /// Neighbours of a point at the last tree query.
    struct Near {
        std::array<std::uint32_t, kMax> index{};
        std::size_t count = 0;
        float outside = 0.0F;  ///< all others were at least this far
        float moved = -1e9F;   ///< moved_ then
    };
    void build();
    void split();
    void look_up(std::size_t self, float wide, Near& near);

    std::size_t most_;
    std::size_t wide_;
    float range_;
    float moved_ = 0.0F;  // sum of all moves
    bool built_ = false;
    std::vector<Node> nodes_;
    std::vector<std::uint32_t> order_;
    std::array<std::vector<float>, 3> along_;  // coordinates in this order
    std::vector<Near> near_;
    const std::vector<Vec3>* points_ = nullptr;
};

}  // namespace jink::orca
