// SPDX-License-Identifier: BSD-3-Clause
#include "tests/timing/orca_nearest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace jink::orca {

namespace {

/// Keeps the `keep` nearest, nearest first. @return the distance beyond which nothing more is kept
float insert(std::array<NearestPoints::Found, NearestPoints::kMax>& found, std::size_t& count, std::size_t keep,
             float bound, const NearestPoints::Found& point)
{
    std::size_t place = count < keep ? count++ : keep - 1;
    for (; place > 0 && found[place - 1].distance2 > point.distance2; --place) {
        found[place] = found[place - 1];
    }
    found[place] = point;
    return count == keep ? found[keep - 1].distance2 : bound;
}

}  // namespace

NearestPoints::NearestPoints(std::size_t points, std::size_t most, float range)
    : most_(most), wide_(std::min(3 * most + 4, kMax)), range_(range), nodes_(2 * points + 2), order_(points),
      near_(points)
{
    std::iota(order_.begin(), order_.end(), 0U);
    for (std::vector<float>& axis : along_) {
        axis.resize(points + kLeaf, std::numeric_limits<float>::max());
    }
}

void NearestPoints::move(const std::vector<Vec3>& points, float moved)
{
    points_ = &points;
    moved_ += moved;
    built_ = false;
}

void NearestPoints::split()
{
    std::size_t used = 1;
    for (std::size_t at = 0; at < used; ++at) {
        Node& here = nodes_[at];
        here.low = Vec3::Constant(std::numeric_limits<float>::max());
        here.high = -here.low;
        for (std::uint32_t i = here.begin; i < here.end; ++i) {
            here.low = here.low.cwiseMin((*points_)[order_[i]]);
            here.high = here.high.cwiseMax((*points_)[order_[i]]);
        }
        here.left = 0;
        if (here.end - here.begin <= kLeaf) {
            continue;
        }
        int axis = 0;
        (here.high - here.low).maxCoeff(&axis);
        const float at_value = 0.5F * (here.low[axis] + here.high[axis]);
        auto* const first = order_.data() + here.begin;
        auto* const last = order_.data() + here.end;
        auto* middle = std::partition(first, last, [&](std::uint32_t i) { return (*points_)[i][axis] < at_value; });
        if (middle == first || middle == last) {
            middle = first + (last - first) / 2;
        }
        const auto cut = static_cast<std::uint32_t>(middle - order_.data());
        here.left = static_cast<std::uint32_t>(used);
        nodes_[used] = {here.low, here.high, here.begin, cut, 0};
        nodes_[used + 1] = {here.low, here.high, cut, here.end, 0};
        used += 2;
    }
}

void NearestPoints::build()
{
    built_ = true;
    nodes_[0] = {Vec3::Zero(), Vec3::Zero(), 0, static_cast<std::uint32_t>(points_->size()), 0};
    split();
    for (std::size_t i = 0; i < points_->size(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            along_[axis][i] = (*points_)[order_[i]][static_cast<Eigen::Index>(axis)];
        }
    }
}

void NearestPoints::look_up(std::size_t self, float wide, Near& near)
{
    if (!built_) {
        build();
    }
    const Vec3 centre = (*points_)[self];
    std::array<Found, kMax> found;
    float bound = wide * wide;
    std::size_t count = 0;
    const auto away = [&](const Node& node) {
        return (centre - centre.cwiseMax(node.low).cwiseMin(node.high)).squaredNorm();
    };
    struct Later {
        std::uint32_t node;
        float distance2;
    };
    std::array<Later, 64> stack{};
    std::size_t depth = 0;
    Later next{0, 0.0F};
    while (true) {
        if (next.distance2 < bound) {
            const Node& node = nodes_[next.node];
            if (node.left != 0) {
                const Later left{node.left, away(nodes_[node.left])};
                const Later right{node.left + 1, away(nodes_[node.left + 1])};
                const bool left_first = left.distance2 <= right.distance2;
                stack[depth++] = left_first ? right : left;
                next = left_first ? left : right;
                continue;
            }
            // A whole leaf at once: a loop of fixed length is vectorised by four.
            std::array<float, kLeaf> away2{};
            for (std::size_t k = 0; k < kLeaf; ++k) {
                const float x = along_[0][node.begin + k] - centre.x();
                const float y = along_[1][node.begin + k] - centre.y();
                const float z = along_[2][node.begin + k] - centre.z();
                away2[k] = x * x + y * y + z * z;
            }
            for (std::uint32_t i = node.begin; i < node.end; ++i) {
                if (away2[i - node.begin] < bound && order_[i] != self) {
                    bound = insert(found, count, wide_, bound, {away2[i - node.begin], order_[i]});
                }
            }
        }
        if (depth == 0) {
            break;
        }
        next = stack[--depth];
    }
    near.count = count;
    near.outside = std::sqrt(bound);
    near.moved = moved_;
    for (std::size_t k = 0; k < count; ++k) {
        near.index[k] = found[k].index;
    }
}

std::size_t NearestPoints::query(std::size_t self, std::array<Found, kMax>& found)
{
    Near& near = near_[self];
    const Vec3 centre = (*points_)[self];
    const std::size_t keep = most_ + 1;
    for (int look = 0;; ++look) {
        // Points that were outside; both may have moved towards each other.
        const float sure = near.outside - 2.0F * (moved_ - near.moved) - 1e-3F;
        float bound = range_ * range_;
        std::size_t count = 0;
        for (std::size_t k = 0; k < near.count; ++k) {
            const float distance2 = ((*points_)[near.index[k]] - centre).squaredNorm();
            if (distance2 < bound) {
                bound = insert(found, count, keep, bound, {distance2, near.index[k]});
            }
        }
        if (look > 0 || (sure > 0.0F && bound <= sure * sure)) {
            // In the order of distance, so that the next query finds them nearly sorted.
            return count;
        }
        constexpr float kSkin = 4.0F;  // [m] of movement that a list lasts for
        look_up(self, range_ + kSkin, near);
    }
}

}  // namespace jink::orca
