// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/map_obstacles.hpp"

#include <algorithm>
#include <array>
#include <cassert>

#include "core/base/work_units.hpp"

namespace jink::world {
namespace {

using geometry::MeshMap;
using geometry::MeshNode;

/// What rounding may move a placed shape by, as a share of the magnitudes that were added.
constexpr float kRounding = 5e-7F;

/// A node that stands for all pieces below it.
struct Part {
    std::uint16_t node = 0;
    bool is_leaf = false;
    float distance = 0.0F;  ///< [m]
};

/// Parts that hold everything within reach: in front a heap of those that can be opened, the nearest on top, then
/// leaves.
class Parts {
public:
    Parts(const MeshMap& map, const Vec3& point, float reach) noexcept : map_(map), point_(point), reach_(reach)
    {
        const Part root = part_of(0);
        if (root.distance <= reach_) {
            add(root);
        }
    }

    /// Opens the nearest node. False when there is none, or no place for what it holds.
    [[nodiscard]] bool open_nearest() noexcept
    {
        if (closed_ == 0) {
            return false;
        }
        const std::size_t nearest = parts_[0].node;
        const Part left = part_of(nearest + 1);
        const Part right = part_of(map_.nodes[nearest].right);
        const bool has_left = left.distance <= reach_;
        const bool has_right = right.distance <= reach_;
        if (has_left && has_right && size() == parts_.size()) {
            return false;
        }
        std::pop_heap(parts_.begin(), heap_end(), is_later);
        --closed_;
        if (has_left) {
            add(left);
        }
        if (has_right) {
            add(right);
        }
        return true;
    }

    [[nodiscard]] bool has_closed() const noexcept { return closed_ > 0; }
    /// Distance of the nearest node that is not opened [m]; there is one.
    [[nodiscard]] float nearest_closed() const noexcept { return parts_[0].distance; }

    /// All of them, in the order of their nodes. No part can be opened any more.
    [[nodiscard]] std::span<const Part> in_order() noexcept
    {
        if (size() < parts_.size()) {  // leaves lie at the far end
            std::copy(parts_.end() - static_cast<std::ptrdiff_t>(leaves_), parts_.end(), heap_end());
        }
        const std::span<Part> all(parts_.data(), size());
        const auto by_node = [](const Part& a, const Part& b) { return a.node < b.node; };
        std::make_heap(all.begin(), all.end(), by_node);
        std::sort_heap(all.begin(), all.end(), by_node);
        return all;
    }

private:
    [[nodiscard]] static bool is_later(const Part& a, const Part& b) noexcept
    {
        return a.distance != b.distance ? a.distance > b.distance : a.node > b.node;
    }
    [[nodiscard]] std::size_t size() const noexcept { return closed_ + leaves_; }
    [[nodiscard]] std::array<Part, kMaxMapObstacles>::iterator heap_end() noexcept
    {
        return parts_.begin() + static_cast<std::ptrdiff_t>(closed_);
    }
    [[nodiscard]] Part part_of(std::size_t node) const noexcept
    {
        const MeshNode& at = map_.nodes[node];
        return {static_cast<std::uint16_t>(node), at.is_leaf(), geometry::box_distance(at, point_)};
    }
    void add(const Part& part) noexcept
    {
        if (part.is_leaf) {
            ++leaves_;
            parts_[parts_.size() - leaves_] = part;
            return;
        }
        parts_[closed_++] = part;
        std::push_heap(parts_.begin(), heap_end(), is_later);
    }

    const MeshMap& map_;
    const Vec3 point_;
    const float reach_;
    std::array<Part, kMaxMapObstacles> parts_;
    std::size_t closed_ = 0;
    std::size_t leaves_ = 0;
};

/// The node's box, or of a leaf the hull of its piece.
Obstacle obstacle_of(const MeshMap& map, const MapPlace& place, const Part& part) noexcept
{
    const MeshNode& node = map.nodes[part.node];
    const Vec3 low = node.low.vec();
    const Vec3 high = node.high.vec();
    Obstacle out;
    out.id = kFirstMapId + part.node;
    out.shape = part.is_leaf ? map.shape_of(node.piece) : geometry::make_box(0.5F * (low + high), 0.5F * (high - low));
    out.shape.centre += place.origin;
    const float magnitudes = (low.cwiseAbs() + high.cwiseAbs() + place.origin.cwiseAbs()).sum();
    out.uncertainty = map.slack + place.uncertainty + kRounding * magnitudes;
    return out;
}

}  // namespace

MapSelection append_map(const MeshMap& map, const MapPlace& place, const Vec3& point, float reach, WorkBudget& budget,
                        ObstacleTable& table) noexcept
{
    assert(is_finite(point) && reach >= 0.0F && place.uncertainty >= 0.0F);
    // Every distance is shorter by what the pieces may be larger by, and by the rounding of places in the map.
    const Vec3 in_map = point - place.origin;
    const float larger = map.slack + place.uncertainty + kRounding * (point.cwiseAbs() + place.origin.cwiseAbs()).sum();
    Parts parts(map, in_map, reach + larger);
    while (budget.spend(units::kMeshNode) && parts.open_nearest()) {
    }
    MapSelection out;
    out.exact_within = parts.has_closed() ? std::clamp(parts.nearest_closed() - larger, 0.0F, reach) : reach;
    for (const Part& part : parts.in_order()) {
        if (!table.append(obstacle_of(map, place, part))) {
            // No place: the table was not set to keep any. Then nothing is known.
            out.exact_within = 0.0F;
            return out;
        }
        ++(part.is_leaf ? out.pieces : out.boxes);
    }
    return out;
}

}  // namespace jink::world
