// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <deque>
#include <vector>

#include "core/reach/planner.hpp"
#include "core/world/threat_set.hpp"
#include "tests/unit/core/reach/small_tree.hpp"

namespace jink::reach::test {

/// A reach planner with trees of a few movements, for a vehicle that flies east at 5 m/s on a long leg. Movements are
/// 2.5 m long, the grid extends 10 m. No threats.
struct PlannerBench {
    static constexpr std::uint32_t kAllTheWork = 1'000'000;
    static inline const Grid<float> kGrid{4, 7, 3, 4.0F, 0.8F, 0.5F};

    /// Navigation: straight on, or to the left; emergency: to the right.
    PlannerBench()
    {
        SmallTree navigation(kGrid);
        navigation.chain(Movement::straight, 4, 1280);
        navigation.chain(Movement::left, 4, 1536);
        SmallTree emergency(kGrid);
        emergency.chain(Movement::right, 4, 1792);
        pairs.fill({keep(navigation), keep(emergency), false});
        sets.vehicle = "bench";
        sets.period = 0.5F;
        sets.max_acceleration = 5.0F;
        sets.max_vertical_acceleration = 3.0F;
        sets.max_climb = 3.0F;
        sets.max_descent = 2.0F;
        sets.cruise_speed = 5.0F;
        sets.speeds = speeds;
        sets.most_speed = 2.0F;
        sets.pitch_separators = separators;
        sets.most_pitch = most_pitch;
        sets.segments = pairs;
        settings.sets = &sets;
        own.stamp = now;
        own.position = Vec3(0.0F, 0.0F, 30.0F);
        own.velocity = Vec3(5.0F, 0.0F, 0.0F);
        limits.half_extents = Vec3(0.5F, 0.5F, 0.5F);
        reference = world::Reference({Vec3(-20.0F, 0.0F, 30.0F), Vec3(500.0F, 0.0F, 30.0F), 5.0F});
    }
    PlannerBench(const PlannerBench&) = delete;
    PlannerBench& operator=(const PlannerBench&) = delete;

    void leg(const Vec3& start, const Vec3& to) { reference = world::Reference({start, to, 5.0F}); }

    /// Tables with a stable address.
    const ReachSet* keep(const SmallTree& tree)
    {
        trees.push_back(tree);
        views.push_back(trees.back().view());
        return &views.back();
    }
    void only(const ReachSet* navigation, const ReachSet* emergency) { pairs.fill({navigation, emergency, false}); }
    /// One tree for everything.
    void only(const SmallTree& tree)
    {
        const ReachSet* const set = keep(tree);
        only(set, set);
    }

    [[nodiscard]] world::Situation view() const
    {
        world::Situation s{
            .now = now, .own = own, .limits = limits, .airframe = airframe, .reference = reference, .rules = rules};
        static_cast<void>(threats.collect(s, {tracks, obstacles, airspace}));
        s.threats = threats.all();
        return s;
    }
    mutable world::ThreatSet threats;  ///< of the newest view
    world::PlanStatus plan(std::uint32_t units = kAllTheWork)
    {
        static_cast<void>(planner.configure(settings));
        WorkBudget budget(units);
        out = {};
        const world::PlanStatus status = planner.plan(view(), budget, out);
        spent = budget.spent();
        return status;
    }
    [[nodiscard]] const Report& report() const { return planner.last(); }
    [[nodiscard]] Vec3 end() const { return out.path.points.back().position; }

    void add_box(const Vec3& centre, const Vec3& half)
    {
        obstacles.push_back({static_cast<world::ObstacleId>(obstacles.size()), geometry::make_box(centre, half)});
    }
    void add_sphere(const Vec3& centre, float radius)
    {
        obstacles.push_back({static_cast<world::ObstacleId>(obstacles.size()), geometry::make_sphere(centre, radius)});
    }
    void add_track(const Vec3& position, const Vec3& velocity, float radius)
    {
        world::Track track;
        track.id = static_cast<world::TrackId>(tracks.size() + 1);
        track.stamp = now;
        track.position = position;
        track.velocity = velocity;
        track.radius = radius;
        tracks.push_back(track);
    }

    std::deque<SmallTree> trees;
    std::deque<ReachSet> views;
    std::array<SegmentSets, kPitchSegments> pairs{};
    std::array<float, 1> speeds{0.25F};
    std::array<std::array<float, 2>, 1> separators{{{-0.13F, 0.13F}}};
    std::array<float, 1> most_pitch{0.8F};
    VehicleSets sets;
    Settings settings;
    TimePoint now{50'000'000};
    vehicle::VehicleState own;
    vehicle::VehicleLimits limits;
    vehicle::Airframe airframe;
    world::Reference reference;
    std::vector<world::Track> tracks;
    std::vector<world::Obstacle> obstacles;
    world::Airspace airspace;
    world::FlightRules rules;
    Planner planner{Settings{}};
    world::Manoeuvre out;
    std::uint32_t spent = 0;
};

/// Navigation: straight on, left and right at once.
class PlannerChoice : public ::testing::Test, protected PlannerBench {
protected:
    PlannerChoice()
    {
        SmallTree three(kGrid);
        three.chain(Movement::straight, 4, 1024);
        three.chain(Movement::left, 4, 1024);
        three.chain(Movement::right, 4, 1024);
        only(three);
    }
    enum class Way { nothing, straight, left, right, other };
    Way way()
    {
        if (plan() != world::PlanStatus::found) {
            return Way::nothing;
        }
        const Vec3 at = end() - own.position - rules.latency * own.velocity;
        const float y = at.x() > 9.0F ? at.y() : NAN;
        return std::abs(y) < 0.01F                    ? Way::straight
               : std::abs(y - 2.5F * 0.9066F) < 0.01F ? Way::left
               : std::abs(y + 2.5F * 0.9066F) < 0.01F ? Way::right
                                                      : Way::other;
    }
};

/// Rates cells as configured, and records its calls.
class FakeSource final : public CellSource {
public:
    RateStatus status = RateStatus::rated;
    std::vector<CellIndex> blocked;
    Level level = 0;
    std::size_t calls = 0;
    Seconds lead = -1.0F;
    Vec3 origin = Vec3::Zero();
    const ReachSet* set = nullptr;
    std::size_t cells = 0;
    std::size_t free = 0;  ///< cells that were free before

    RateStatus rate(const world::Situation&, const Placed& placed, const CellSpheres& spheres, Seconds at,
                    std::span<Level> blocks, WorkBudget&) noexcept override
    {
        ++calls;
        lead = at;
        origin = placed.origin;
        set = placed.set;
        cells = spheres.are_of(placed.set->grid) ? blocks.size() : 0;
        free = static_cast<std::size_t>(std::count(blocks.begin(), blocks.end(), kFree));
        for (const CellIndex cell : blocked) {
            blocks[cell] = std::min(blocks[cell], level);
        }
        return status;
    }
};

}  // namespace jink::reach::test
