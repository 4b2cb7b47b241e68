// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <vector>

#include "core/world/cost_to_go_field.hpp"
#include "tests/property/core/geometry/convex_oracle.hpp"
#include "tests/unit/core/world/scene.hpp"

// The field of cost to go anew, from its header, in double precision: cells are marked by the distance of an upright
// segment from the solids (Wolfe's method), costs come from Dijkstra's algorithm with a queue.

namespace jink::world::oracle {

using geometry::oracle::Vec3d;
using test::Scene;

inline constexpr double kUnreached = std::numeric_limits<double>::infinity();

struct CellIndex {
    int x = 0, y = 0, z = 0;
};

enum class Mark : std::uint8_t { free, unsure, blocked };

/// The grid of a scene, its cells' marks and the costs.
class CostToGoOracle {
public:
    static constexpr int kWide = CostToGoField::kColumns;
    static constexpr int kHigh = CostToGoField::kLayers;
    /// Marks within this of the limit are unsure [m].
    static constexpr double kNear = 2e-3;
    /// The nearest point of a tilted or round solid is not the one that is nearest to the box: its cells may be free
    /// though the box is nearer than the limit by so much [m].
    static constexpr double kSlanted = 0.2;

    /// Half of a diagonal step, and some [m].
    static constexpr double kTight = 1.002 * 1.4142136;

    explicit CostToGoOracle(const Scene& scene) : scene_(scene)
    {
        const path::RouteView route = scene.reference.route();
        const float abeam = route.abeam_of(scene.own.position, scene.reference.segment).arc_length;
        goal_ = route.at(std::min(abeam + CostToGoField::kAhead, route.length())).position.cast<double>();
        speed_ = std::max(1.0, double(scene.reference.speed));
        climb_ = std::max(0.5, double(std::min(scene.limits.max_climb, scene.limits.max_descent)));
        mark();
        low_ = costs(Mark::unsure);
        high_ = costs(Mark::free);
    }

    static std::size_t index(const CellIndex& c) { return static_cast<std::size_t>((c.z * kWide + c.y) * kWide + c.x); }
    static bool is_in(const CellIndex& c)
    {
        return c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x < kWide && c.y < kWide && c.z < kHigh;
    }
    static CellIndex cell(std::size_t i)
    {
        const auto at = static_cast<int>(i);
        return {at % kWide, at / kWide % kWide, at / (kWide * kWide)};
    }
    [[nodiscard]] Vec3d middle(const CellIndex& c) const
    {
        return scene_.own.position.cast<double>() + Vec3d(2.0 * (c.x - 16), 2.0 * (c.y - 16), 2.5 * (c.z - 5));
    }
    [[nodiscard]] Mark mark_of(const CellIndex& c) const { return marks_[index(c)]; }
    [[nodiscard]] double time_of(const Vec3d& way) const
    {
        const double x = std::abs(way.x());
        const double y = std::abs(way.y());
        const double level = std::abs(x - y) + std::sqrt(2.0) * std::min(x, y);
        return level / speed_ + std::abs(way.z()) / climb_;
    }
    [[nodiscard]] double straight(const Vec3d& from) const { return time_of(goal_ - from); }
    /// Bounds of what is lost from a place of the grid; `cell`: the one it lies in.
    [[nodiscard]] std::array<double, 2> lost_from(const Vec3d& place, const CellIndex& cell) const
    {
        std::array<double, 2> lost{kUnreached, kUnreached};
        double open = kUnreached;
        around(cell, [&](const CellIndex& other) {
            const double over = time_of(middle(other) - place);
            open = std::min(open, straight(middle(other)) + over);
            lost[0] = std::min(lost[0], low_[index(other)] + over);
            lost[1] = std::min(lost[1], high_[index(other)] + over);
        });
        for (double& value : lost) {
            value = std::clamp(value - open, 0.0, double(CostToGoField::kNoWay));
        }
        return lost;
    }
    /// Whether the sources do not depend on cells that are unsure.
    [[nodiscard]] bool knows_sources() const { return knows_sources_; }

private:
    template <class Visit>
    static void around(const CellIndex& c, const Visit& visit)
    {
        for (int n = 0; n < 27; ++n) {
            const CellIndex other{c.x + n % 3 - 1, c.y + n / 3 % 3 - 1, c.z + n / 9 - 1};
            if (is_in(other)) {
                visit(other);
            }
        }
    }
    void block(const CellIndex& c, double beyond, double slanted)
    {
        Mark& mark = marks_[index(c)];
        mark = std::max(mark, beyond > kNear ? Mark::free : (beyond > -kNear - slanted ? Mark::unsure : Mark::blocked));
    }
    /// All cells that a solid grown by `grown` blocks.
    void block_by(const geometry::Shape& shape, double grown)
    {
        const double side = double(scene_.limits.half_extents.head<2>().maxCoeff());
        const Vec3 line(0, 0, scene_.limits.half_extents.z());
        // No wall is so thin that it fits between two cells. What is round about an upright axis counts whole.
        const bool is_round = shape.kind == geometry::ShapeKind::sphere ||
                              (shape.kind == geometry::ShapeKind::capsule && std::abs(shape.axes(2, 2)) == 1.0F);
        const double own_radius = is_round ? double(shape.radius) : 0.0;
        const double limit = std::max(grown + side + double(CostToGoField::kSpare), kTight - own_radius);
        const double most = limit + double(geometry::bounding_radius(shape)) + double(line.z()) + 0.1;
        const bool is_upright = shape.kind == geometry::ShapeKind::box ? shape.axes(2, 2) > 0.999999F : false;
        for (std::size_t i = 0; i < marks_.size(); ++i) {
            const Vec3d at = middle(cell(i));
            if (marks_[i] != Mark::blocked && (at - shape.centre.cast<double>()).norm() < most) {
                const Vec3 from = at.cast<float>();
                const auto apart = geometry::oracle::swept_box_bounds(line, from, from, shape, 1e-4);
                block(cell(i), 0.5 * (apart.lower + apart.upper) - limit, is_upright ? 0.0 : kSlanted);
            }
        }
    }
    void mark()
    {
        marks_.assign(CostToGoField::kCells, Mark::free);
        const double own = double(scene_.rules.k_sigma) * double(scene_.own.sigma_position);
        const Vec3d half = scene_.limits.half_extents.cast<double>();
        const double side = std::max(half.x(), half.y());
        const double grown = own + side + double(CostToGoField::kSpare);
        const Airspace& air = scene_.airspace;
        for (std::size_t i = 0; i < marks_.size(); ++i) {
            const Vec3d at = middle(cell(i));
            const double above = double(CostToGoField::kSpare) + own + half.z();
            if (air.has_floor) {
                block(cell(i), at.z() - double(air.floor) - above, 0.0);
            }
            if (air.has_ceiling) {
                block(cell(i), double(air.ceiling) - at.z() - above, 0.0);
            }
            if (air.has_keep_in) {
                const double out = (at - air.home.cast<double>()).head<2>().norm();
                block(cell(i), double(air.keep_in_radius) - out - grown, 0.0);
            }
        }
        for (const Cylinder& area : air.cylinders) {
            const Vec3 low(area.circle.centre.x(), area.circle.centre.y(), area.bottom);
            const Vec3 high(low.x(), low.y(), area.top);
            block_by(geometry::make_cylinder(low, high, area.circle.radius + area.margin), own);
        }
        for (const Obstacle& obstacle : scene_.obstacles) {
            block_by(obstacle.shape, own + double(obstacle.uncertainty));
        }
    }
    /// Costs where cells up to `most` count as free.
    std::vector<double> costs(Mark most)
    {
        std::vector<double> cost(marks_.size(), kUnreached);
        const Vec3d in = goal_ - middle({});
        const bool is_within = in.minCoeff() >= 0.0 && in.x() <= 64.0 && in.y() <= 64.0 && in.z() <= 25.0;
        double nearest = kUnreached;
        for (std::size_t i = 0; i < cost.size() && is_within; ++i) {
            nearest = marks_[i] <= most ? std::min(nearest, time_of(goal_ - middle(cell(i)))) : nearest;
        }
        knows_sources_ = most == Mark::unsure || nearest == nearest_;
        nearest_ = nearest;
        const double step = time_of(Vec3d(2.0, 2.0, 2.5));
        using Entry = std::pair<double, std::size_t>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        for (std::size_t i = 0; i < cost.size(); ++i) {
            const CellIndex c = cell(i);
            const double straight = time_of(goal_ - middle(c));
            const bool is_side = c.x == 0 || c.y == 0 || c.x == kWide - 1 || c.y == kWide - 1 ||
                                 (c.z == 0 && in.z() < 0.0) || (c.z == kHigh - 1 && in.z() > 25.0);
            if (marks_[i] <= most && (nearest < kUnreached ? straight <= nearest + step + 1e-6 : is_side)) {
                cost[i] = straight;
                queue.emplace(straight, i);
            }
        }
        while (!queue.empty()) {
            const auto [now, i] = queue.top();
            queue.pop();
            if (now > cost[i]) {
                continue;
            }
            around(cell(i), [&](const CellIndex& other) {
                const std::size_t j = index(other);
                const double over = now + time_of(middle(other) - middle(cell(i)));
                if (marks_[j] <= most && over < cost[j]) {
                    cost[j] = over;
                    queue.emplace(over, j);
                }
            });
        }
        return cost;
    }

    const Scene& scene_;
    Vec3d goal_ = Vec3d::Zero();
    double speed_ = 1.0;
    double climb_ = 1.0;
    double nearest_ = kUnreached;
    bool knows_sources_ = true;
    std::vector<Mark> marks_;
    std::vector<double> low_;
    std::vector<double> high_;
};

}  // namespace jink::world::oracle
