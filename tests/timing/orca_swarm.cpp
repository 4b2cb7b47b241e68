// SPDX-License-Identifier: BSD-3-Clause
#include "tests/timing/orca_swarm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace jink::orca {

NearestPoints::NearestPoints(std::size_t capacity) : nodes_(2 * capacity + 2), order_(capacity), sorted_(capacity) {}

void NearestPoints::split(std::size_t node)
{
    // Iterative: children are appended, and split in turn.
    std::size_t used = node + 1;
    for (std::size_t at = node; at < used; ++at) {
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
        nodes_[used] = {{}, {}, here.begin, cut, 0};
        nodes_[used + 1] = {{}, {}, cut, here.end, 0};
        used += 2;
    }
}

void NearestPoints::build(const std::vector<Vec3>& points)
{
    points_ = &points;
    // The last step's order is nearly right already.
    if (order_.size() != points.size() || order_[0] == order_[1 % order_.size()]) {
        order_.resize(points.size());
        std::iota(order_.begin(), order_.end(), 0U);
    }
    nodes_[0] = {{}, {}, 0, static_cast<std::uint32_t>(points.size()), 0};
    split(0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        sorted_[i] = points[order_[i]];
    }
}

std::size_t NearestPoints::query(std::size_t self, std::size_t most, float range,
                                 std::array<Found, kMost>& found) const
{
    const Vec3 centre = (*points_)[self];
    const std::size_t keep = std::min(most + 1, kMost);
    float bound = range * range;
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
                const float left = away(nodes_[node.left]);
                const float right = away(nodes_[node.left + 1]);
                const bool left_first = left <= right;
                stack[depth++] = left_first ? Later{node.left + 1, right} : Later{node.left, left};
                next = left_first ? Later{node.left, left} : Later{node.left + 1, right};
                continue;
            }
            for (std::uint32_t i = node.begin; i < node.end; ++i) {
                const float distance2 = (sorted_[i] - centre).squaredNorm();
                if (distance2 >= bound || order_[i] == self) {
                    continue;
                }
                std::size_t place = count < keep ? count++ : keep - 1;
                for (; place > 0 && found[place - 1].distance2 > distance2; --place) {
                    found[place] = found[place - 1];
                }
                found[place] = {distance2, order_[i]};
                if (count == keep) {
                    bound = found[keep - 1].distance2;
                }
            }
        }
        if (depth == 0) {
            return count;
        }
        next = stack[--depth];
    }
}

Swarm::Swarm(std::size_t count, const SwarmSettings& settings)
    : settings_(settings), positions_(count), velocities_(count, Vec3::Zero()), goals_(count), next_(count),
      nearest_(count)
{
    // Points of a Fibonacci sphere.
    const double golden = 3.14159265358979323846 * (3.0 - std::sqrt(5.0));
    for (std::size_t i = 0; i < count; ++i) {
        const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(count);
        const double level = std::sqrt(1.0 - z * z);
        const double angle = golden * static_cast<double>(i);
        const Eigen::Vector3d at(std::cos(angle) * level, std::sin(angle) * level, z);
        positions_[i] = (at * static_cast<double>(settings.sphere)).cast<float>();
        goals_[i] = -positions_[i];
    }
    settings_.pair.conflict_ratio = settings_.regions ? 2.0F * settings_.radius / settings_.warning : 0.999F;
}

Vec3 Swarm::preferred(std::size_t self) const
{
    const Vec3 way = goals_[self] - positions_[self];
    const float length = way.norm();
    const Vec3 wanted = length > settings_.cruise ? Vec3(way * (settings_.cruise / length)) : way;
    Random random(self * 1000003U + steps_);
    return wanted + 1e-3F * Vec3(random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F));
}

void Swarm::build() { nearest_.build(positions_); }

void Swarm::decide(std::size_t self)
{
    const std::size_t seen = nearest_.query(self, settings_.most, settings_.range, found_);
    const std::size_t used = std::min(seen, settings_.most);
    Pair pair;
    pair.own_velocity = velocities_[self];
    pair.across = pair.upright = settings_.regions ? settings_.warning : 2.0F * settings_.radius;
    const float inner = 2.0F * settings_.radius;
    float cap = settings_.max_speed;
    if (settings_.regions && seen > used) {
        const float gap = std::sqrt(found_[used].distance2) - inner;
        cap = std::min(cap, std::max(gap, 0.0F) / (2.0F * settings_.pair.brake));
        counts_.truncated += cap < settings_.max_speed ? 1U : 0U;
    }
    std::size_t conflicts = 0;
    std::size_t warnings = 0;
    const float felt = inner + 2.0F * settings_.pair.brake * cap;
    // Those near enough come first: their conflict half-spaces before all warning ones.
    while (settings_.regions && conflicts < used && found_[conflicts].distance2 < felt * felt) {
        ++conflicts;
    }
    for (std::size_t k = 0; k < used; ++k) {
        const std::uint32_t other = found_[k].index;
        pair.position = positions_[other] - positions_[self];
        pair.other_velocity = velocities_[other];
        pair.above = self > other;
        pair.source = static_cast<std::uint16_t>(other);
        if (k < conflicts) {
            const PairPlanes both = pair_planes(pair, settings_.pair);
            planes_[k] = both.conflict;
            planes_[conflicts + warnings++] = both.warning;
        } else {
            planes_[conflicts + warnings++] = pair_plane(pair, settings_.pair);
        }
    }
    const Ball ball{Vec3::Zero(), cap};
    WorkBudget budget(1'000'000);
    const Solution solution = solve({{planes_.data(), conflicts + warnings}, {&ball, 1}, preferred(self), velocities_[self]},
                                    scratch_.view(), budget);
    ++counts_.solved;
    counts_.warning += (solution.status & kRelaxedWarning) != 0 ? 1U : 0U;
    counts_.conflict += (solution.status & kRelaxedConflict) != 0 ? 1U : 0U;
    counts_.other += (solution.status & ~(kRelaxedWarning | kRelaxedConflict)) != 0 ? 1U : 0U;
    next_[self] = solution.velocity;
}

void Swarm::move()
{
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        velocities_[i] = next_[i];
        positions_[i] += velocities_[i] * settings_.step;
    }
    ++steps_;
}

void Swarm::step()
{
    build();
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        decide(i);
    }
    move();
}

bool Swarm::arrived() const
{
    const float near2 = 4.0F * settings_.radius * settings_.radius;
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        if ((goals_[i] - positions_[i]).squaredNorm() > near2) {
            return false;
        }
    }
    return true;
}

float Swarm::least_distance() const
{
    float least2 = std::numeric_limits<float>::max();
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        for (std::size_t j = i + 1; j < positions_.size(); ++j) {
            const Vec3 now = positions_[j] - positions_[i];
            const Vec3 velocity = velocities_[j] - velocities_[i];
            const float speed2 = velocity.squaredNorm();
            const float ago = speed2 > 0.0F ? std::clamp(now.dot(velocity) / speed2, 0.0F, settings_.step) : 0.0F;
            least2 = std::min(least2, (now - ago * velocity).squaredNorm());
        }
    }
    return std::sqrt(least2);
}

}  // namespace jink::orca
