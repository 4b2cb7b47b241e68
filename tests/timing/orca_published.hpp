// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/timing/orca_swarm.hpp"

namespace jink::orca {

/// The same swarm flown by the published algorithm (van den Berg, Guy, Lin and Manocha, Reciprocal n-body collision
/// avoidance, in three dimensions; Alejo 7.1), written anew from its equations: one half-space of each of the nearest
/// neighbours, an incremental linear program in the order of distance, and where there is no solution the velocity
/// whose worst violation is least. It shares no code with core/orca, and stands for the public library, which cannot be
/// had here: both have the same rules and the same figures of distance (tests/timing/orca_bench.cpp prints them
/// side by side).
class PublishedSwarm : public MovingPoints {
public:
    PublishedSwarm(std::size_t count, const SwarmSettings& settings);
    void step();
    [[nodiscard]] std::size_t under_way() const { return MovingPoints::under_way(2.0F * settings_.radius); }
    [[nodiscard]] bool arrived() const { return under_way() == 0; }
    [[nodiscard]] float least_distance() const { return MovingPoints::least_distance(settings_.step); }

private:
    struct Plane {
        Vec3 point;
        Vec3 normal;
    };
    struct Node {
        Vec3 low = Vec3::Zero();
        Vec3 high = Vec3::Zero();
        std::uint32_t begin = 0, end = 0;
        std::uint32_t left = 0, right = 0;  ///< 0: a leaf
    };
    struct Found {
        float distance2;
        std::uint32_t index;
    };
    void build();
    void split(std::uint32_t node);
    void search(std::uint32_t node, std::size_t self, float& range2);
    void add_planes(std::size_t self);
    [[nodiscard]] Vec3 decide(std::size_t self);

    SwarmSettings settings_;
    std::vector<Vec3> next_;
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
    std::vector<Found> found_;
    std::vector<Plane> planes_;
    std::vector<Plane> projected_;
    friend struct PublishedProgram;
};

}  // namespace jink::orca
