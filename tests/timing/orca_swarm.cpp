// SPDX-License-Identifier: BSD-3-Clause
#include "tests/timing/orca_swarm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tests/oracle/obstacle_threats.hpp"

namespace jink::orca {

namespace {

/// Points of a Fibonacci sphere.
std::vector<Vec3> on_sphere(std::size_t count, float radius)
{
    std::vector<Vec3> out(count);
    const double golden = 3.14159265358979323846 * (3.0 - std::sqrt(5.0));
    for (std::size_t i = 0; i < count; ++i) {
        const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(count);
        const double level = std::sqrt(1.0 - z * z);
        const double angle = golden * static_cast<double>(i);
        const Eigen::Vector3d at(std::cos(angle) * level, std::sin(angle) * level, z);
        out[i] = (at * static_cast<double>(radius)).cast<float>();
    }
    return out;
}

std::vector<Vec3> opposite(std::vector<Vec3> points)
{
    for (Vec3& point : points) {
        point = -point;
    }
    return points;
}

}  // namespace

MovingPoints::MovingPoints(std::size_t count, float radius)
    : MovingPoints(on_sphere(count, radius), opposite(on_sphere(count, radius)))
{
}

MovingPoints::MovingPoints(std::vector<Vec3> positions, std::vector<Vec3> goals)
    : positions_(std::move(positions)), velocities_(positions_.size(), Vec3::Zero()), goals_(std::move(goals))
{
}

Vec3 MovingPoints::preferred(std::size_t self, float cruise) const
{
    const Vec3 way = goals_[self] - positions_[self];
    const float length = way.norm();
    const Vec3 wanted = length > cruise ? Vec3(way * (cruise / length)) : way;
    Random random(self * 1000003U + steps_);
    return wanted + 1e-3F * Vec3(random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F));
}

void MovingPoints::move(const std::vector<Vec3>& velocities, float step)
{
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        velocities_[i] = velocities[i];
        positions_[i] += velocities[i] * step;
    }
    ++steps_;
}

std::size_t MovingPoints::under_way(float distance) const
{
    std::size_t count = 0;
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        count += (goals_[i] - positions_[i]).squaredNorm() > distance * distance ? 1U : 0U;
    }
    return count;
}

float MovingPoints::least_distance(float step) const
{
    float least2 = std::numeric_limits<float>::max();
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        for (std::size_t j = i + 1; j < positions_.size(); ++j) {
            const Vec3 now = positions_[j] - positions_[i];
            const Vec3 velocity = velocities_[j] - velocities_[i];
            const float speed2 = velocity.squaredNorm();
            const float ago = speed2 > 0.0F ? std::clamp(now.dot(velocity) / speed2, 0.0F, step) : 0.0F;
            least2 = std::min(least2, (now - ago * velocity).squaredNorm());
        }
    }
    return std::sqrt(least2);
}

Swarm::Swarm(std::size_t count, const SwarmSettings& settings)
    : Swarm(on_sphere(count, settings.sphere), opposite(on_sphere(count, settings.sphere)), settings)
{
}

Swarm::Swarm(std::vector<Vec3> positions, std::vector<Vec3> goals, const SwarmSettings& settings)
    : MovingPoints(std::move(positions), std::move(goals)), settings_(settings), next_(size()),
      nearest_(size(), settings.most, settings.range)
{
    settings_.pair.conflict_ratio = settings_.regions ? 2.0F * settings_.radius / settings_.warning : 0.999F;
}

world::MapSelection choose_obstacles(const geometry::MeshMap& map, const OwnMotion& own,
                                     const ObstacleSettings& settings, WorkBudget& budget, world::ObstacleTable& table)
{
    table.clear();
    return world::append_map(map, {}, own.position, obstacle_reach(envelope_of(settings), own, settings), budget,
                             table);
}

void Swarm::set_map(const geometry::MeshMap& map, const ObstacleSettings& settings)
{
    map_ = map;
    table_.keep_places_for_map();
    obstacle_settings_ = settings;
    is_among_obstacles_ = true;
}

/// The first half-spaces: how many they are. Caps the speed where they are not all.
std::size_t Swarm::add_obstacles(std::size_t self, float& cap)
{
    WorkBudget budget(1'000'000);
    const OwnMotion own{positions_[self], velocities_[self], settings_.max_speed};
    static_cast<void>(choose_obstacles(map_, own, obstacle_settings_, budget, table_));
    const std::vector<world::Threat> threats = oracle::threats_of(table_.obstacles());
    const ObstaclePlanes found = obstacle_planes(threats, own, obstacle_settings_, budget);
    cap = std::min(cap, found.speed_cap);
    counts_.penetrating += found.penetrating ? 1U : 0U;
    counts_.beside_obstacles += found.planes.size();
    std::copy(found.planes.begin(), found.planes.end(), planes_.begin());
    return found.planes.size();
}

void Swarm::build()
{
    float fastest2 = 0.0F;
    for (const Vec3& velocity : velocities_) {
        fastest2 = std::max(fastest2, velocity.squaredNorm());
    }
    nearest_.move(positions_, std::sqrt(fastest2) * settings_.step);
}

void Swarm::decide(std::size_t self)
{
    const std::size_t seen = nearest_.query(self, found_);
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
    const std::size_t first = is_among_obstacles_ ? add_obstacles(self, cap) : 0;
    HalfSpace* const planes = planes_.data() + first;
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
            planes[k] = both.conflict;
            planes[conflicts + warnings++] = both.warning;
        } else {
            planes[conflicts + warnings++] = pair_plane(pair, settings_.pair);
        }
    }
    const Sphere sphere{Vec3::Zero(), cap};
    WorkBudget budget(1'000'000);
    const Solution solution = solve({{planes_.data(), first + conflicts + warnings},
                                     {&sphere, 1},
                                     preferred(self, settings_.cruise),
                                     velocities_[self]},
                                    scratch_.view(), budget);
    ++counts_.solved;
    counts_.planes += first + conflicts + warnings;
    counts_.warning += (solution.status & kRelaxedWarning) != 0 ? 1U : 0U;
    counts_.conflict += (solution.status & kRelaxedConflict) != 0 ? 1U : 0U;
    counts_.other += (solution.status & ~(kRelaxedWarning | kRelaxedConflict)) != 0 ? 1U : 0U;
    next_[self] = solution.velocity;
}

void Swarm::step()
{
    build();
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        decide(i);
    }
    move();
}

}  // namespace jink::orca
