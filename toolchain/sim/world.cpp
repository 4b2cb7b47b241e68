// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/world.hpp"

#include <algorithm>
#include <cmath>

namespace jink::sim {
namespace {

/// A gust accelerates a multirotor by this share of the gust speed before the velocity loop responds [1/s].
constexpr double kDragRate = 0.3;

}  // namespace

World::World(const Scenario& scenario)
    : scenario_(scenario), limits_(scenario.vehicle), gusts_(scenario.wind, scenario.seed),
      lowest_(scenario.start_position.z())
{
    own_.position = scenario.start_position;
    own_.velocity = scenario.start_velocity;
    own_.yaw = std::atan2(own_.velocity.y(), own_.velocity.x());
    own_.held = held_at(own_.velocity, limits_);
    for (const Threat& threat : scenario.threats) {
        positions_.push_back(threat.position_at(0.0));
        appeared_.push_back(-1);
    }
    before_ = positions_;
    measure(own_.position, before_);
    look();
}

void World::look()
{
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        const Threat& threat = scenario_.threats[i];
        const bool due = threat.appears_when_own_within
                             ? (own_.position - threat.collision_point).norm() <= *threat.appears_when_own_within
                             : seconds() >= threat.appears_at;
        if (appeared_[i] < 0 && due) {
            appeared_[i] = now_;
        }
    }
}

void World::measure(const Vec& own_before, const std::vector<Vec>& before)
{
    const Vec half = Vec::Ones();
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        const Threat& threat = scenario_.threats[i];
        const Nearest nearest = nearest_in_step(threat, before[i], positions_[i], own_before, own_.position);
        if (nearest.distance < closest_.surface) {
            closest_.surface = nearest.distance;
            closest_.time = seconds() - (1.0 - nearest.share) * to_seconds(kStep);
            closest_.own = own_before + (own_.position - own_before) * nearest.share;
            closest_.threat_centre = before[i] + (positions_[i] - before[i]) * nearest.share;
            closest_.threat = i;
        }
        closest_.box = std::min(closest_.box, box_distance(threat, positions_[i], own_.position, half));
    }
    for (const ClosedArea& area : scenario_.areas) {
        closest_area_ = std::min(closest_area_, surface_distance(area, seconds(), own_.position));
    }
}

void World::step(const Vec& command)
{
    const Vec own_before = own_.position;
    before_ = positions_;
    now_ += kStep;
    if (!gusts_.is_calm()) {
        const double level_speed = own_.velocity.head<2>().norm();
        gusts_.step(own_.position.z() - scenario_.home.z(), level_speed + scenario_.wind.at_20_ft);
        own_.velocity += kDragRate * to_seconds(kStep) * gusts_.velocity(own_.yaw);
    }
    fly(own_, command, limits_, to_seconds(kStep));
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        positions_[i] = scenario_.threats[i].position_at(seconds());
    }
    lowest_ = std::min(lowest_, own_.position.z());
    measure(own_before, before_);
    look();
}

double World::separation(std::size_t& nearest) const
{
    double least = 1e9;
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        const double distance = surface_distance(scenario_.threats[i], positions_[i], own_.position);
        if (distance < least) {
            least = distance;
            nearest = i;
        }
    }
    return least;
}

bool World::all_past() const
{
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        const Threat& threat = scenario_.threats[i];
        const Vec gap = positions_[i] - own_.position;
        const Vec closing = threat.velocity_at(seconds()) - own_.velocity;
        const bool turns_later = !threat.turns.empty() && threat.turns.back().at > seconds();
        if (appeared_[i] < 0 || turns_later || gap.dot(closing) < 0.0) {
            return false;
        }
    }
    return std::all_of(scenario_.areas.begin(), scenario_.areas.end(), [&](const ClosedArea& area) {
        const Vec gap = area.centre_at(seconds()) - own_.position;
        const Vec closing = area.velocity - own_.velocity;
        return gap.head<2>().dot(closing.head<2>()) >= 0.0;
    });
}

}  // namespace jink::sim
