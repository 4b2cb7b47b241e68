// SPDX-License-Identifier: BSD-3-Clause
#include "tests/target/probe.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/random.hpp"
#include "firmware/app/parameters.hpp"
#include "firmware/app/work_rate.hpp"
#include "firmware/vehicles/default/reach_sets_reduced.hpp"
#include "tests/target/probe_io.hpp"
#include "tests/target/window.hpp"
#include "tests/unit/core/world/same_bits.hpp"

namespace jink::target {
namespace {

constexpr std::uint32_t kMaxUpdates = 100;

Vec3 vec(const float (&v)[3]) noexcept { return {v[0], v[1], v[2]}; }

bool fits(const ProbeRecord& r) noexcept
{
    return r.magic == kProbeMagic && r.track_count <= kProbeTracks && r.track_count <= kMaxTracks &&
           r.obstacle_count <= kProbeObstacles && r.obstacle_count <= kMaxObstacles;
}

world::Track track_of(const ProbeTrack& t, std::uint32_t id) noexcept
{
    world::Track track;
    track.id = id;
    track.position = vec(t.position);
    track.velocity = vec(t.velocity);
    track.radius = t.radius;
    track.sigma_position = t.sigma_position;
    track.sigma_velocity = t.sigma_velocity;
    track.max_acceleration = t.max_acceleration;
    return track;
}

world::Obstacle obstacle_of(const ProbeObstacle& o, std::uint32_t id) noexcept
{
    switch (o.kind) {
    case ProbeShape::box: {
        Mat3 axes = Mat3::Identity();
        axes(0, 0) = axes(1, 1) = std::cos(o.yaw);
        axes(1, 0) = std::sin(o.yaw);
        axes(0, 1) = -axes(1, 0);
        return {id, geometry::make_box(vec(o.a), vec(o.b), axes)};
    }
    case ProbeShape::capsule: return {id, geometry::make_capsule(vec(o.a), vec(o.b), o.radius)};
    case ProbeShape::cylinder: return {id, geometry::make_cylinder(vec(o.a), vec(o.b), o.radius)};
    case ProbeShape::sphere: break;
    }
    return {id, geometry::make_sphere(vec(o.a), o.radius)};
}

app::Configuration configuration_of(const ProbeRecord& r) noexcept
{
    app::Configuration c = app::Parameters().configuration();
    c.planner.offsets = static_cast<std::uint16_t>(r.offsets);
    c.planner.extra_planes = static_cast<std::uint16_t>(r.extra_planes);
    c.planner.simple = (r.families & 1U) != 0;
    c.planner.symmetric = (r.families & 2U) != 0;
    c.planner.smooth = (r.families & 4U) != 0;
    c.planner.plateau = (r.families & 8U) != 0;
    c.planner.wait = (r.families & 16U) != 0;
    c.planner.retries = static_cast<std::uint8_t>(r.retries);
    c.planner.waypoints = static_cast<std::uint16_t>(r.waypoints);
    c.planner.security = r.swept != 0 ? geometric::SecurityMode::swept : geometric::SecurityMode::time_aware;
    c.rules.lookahead = r.lookahead;
    if (r.reduced_sets != 0) {
        c.reach.sets = &reach::kDefaultReducedSets;
    }
    c.rules.k_sigma = r.k_sigma;
    c.limits.half_extents = vec(r.half);
    c.limits.cruise_speed = r.cruise_speed;
    c.limits.max_climb = r.max_climb;
    c.limits.max_descent = r.max_descent;
    c.limits.max_acceleration = r.max_acceleration;
    c.limits.max_vertical_acceleration = r.max_vertical_acceleration;
    c.limits.velocity_lag = r.velocity_lag;
    return c;
}

}  // namespace

struct Probe::World {
    app::Configuration configuration;
    vehicle::VehicleState own;
    world::Reference reference;
    world::Airspace airspace;
    StaticVector<world::Track, kProbeTracks> tracks;
    StaticVector<world::Obstacle, kProbeObstacles> obstacles;

    /// In place: a small stack cannot hold two.
    void take(const ProbeRecord& r) noexcept
    {
        configuration = configuration_of(r);
        tracks.clear();
        obstacles.clear();
        own.position = vec(r.own_position);
        own.velocity = vec(r.own_velocity);
        own.sigma_position = r.own_sigma;
        reference = world::Reference({vec(r.leg_start), vec(r.leg_end), r.leg_speed});
        airspace.has_floor = (r.bounds & 1U) != 0;
        airspace.has_ceiling = (r.bounds & 2U) != 0;
        airspace.has_keep_in = (r.bounds & 4U) != 0;
        airspace.floor = r.floor;
        airspace.ceiling = r.ceiling;
        airspace.keep_in_radius = r.keep_in;
        for (std::uint32_t i = 0; i < r.track_count; ++i) {
            tracks.unchecked_push_back(track_of(r.tracks[i], i));
            tracks.back().cooperative = (r.shared >> i & 1U) != 0;
        }
        for (std::uint32_t i = 0; i < r.obstacle_count; ++i) {
            obstacles.unchecked_push_back(obstacle_of(r.obstacles[i], i));
        }
    }
};

Probe::Probe() noexcept
    : planner_(geometric::Settings{}), reach_(reach::Settings{}),
      supervisor_(avoid::Settings{}, planner_, reach_, orca_), memory_(fresh_plan_memory())
{
}

world::PlanStatus Probe::plan(ProbeKind kind, const world::Situation& situation, WorkBudget& budget) noexcept
{
    switch (kind) {
    case ProbeKind::plan: return planner_.plan(situation, budget, manoeuvre_);
    case ProbeKind::reach: return reach_.plan(situation, budget, manoeuvre_);
    default: return orca_.plan(situation, budget, manoeuvre_);
    }
}

std::uint32_t Probe::differing(const world::Situation& situation, const avoid::Settings& settings,
                               std::uint32_t slicings, ProbeAnswer& out) noexcept
{
    static avoid::Diagnostics diagnostics;
    Random random(out.seed);
    const avoid::Planning planning = supervisor_.planning();
    const avoid::Inflated inflated(situation, situation.rules.clearance);
    avoid::Settings limited = settings;
    if (random.below(3) == 0) {
        limited.plan_budget = settings.kept_for_next + static_cast<std::uint32_t>(random.below(8000));
    }
    WorkBudget budget(limited.plan_budget);
    avoid::Choice choice;
    orca_.reset();
    const world::PlanStatus status =
        planning.plan(planning.self, {inflated.situation, situation}, limited, budget, diagnostics, manoeuvre_, choice);
    out.status = static_cast<std::uint32_t>(status);
    out.work = budget.spent();
    std::uint32_t found = 0;
    avoid::SlicedPlan& sliced = memory_.plan;
    for (std::uint32_t i = 0; i < slicings; ++i) {
        const std::uint64_t longest = i == 0 ? 1 : 1 + random.below(6000);
        orca_.reset();
        sliced.begin(situation, planning, limited, diagnostics);
        while (!sliced.advance(static_cast<std::uint32_t>(1 + random.below(longest)))) {
            ++out.candidates;
        }
        const bool same = sliced.status() == status && sliced.ran_out() == budget.exhausted() &&
                          (status != world::PlanStatus::found || world::test::same_bits(sliced.answer(), manoeuvre_));
        found += same ? 0U : 1U;
    }
    return found;
}

bool Probe::is_by_reach(const ProbeRecord& record, const ProbeAnswer& answer) const noexcept
{
    if (record.kind == ProbeKind::reach) {
        return answer.status == static_cast<std::uint32_t>(world::PlanStatus::found);
    }
    const world::Manoeuvre* flying = record.kind == ProbeKind::update ? supervisor_.flying() : nullptr;
    return flying != nullptr && flying->by == reach::Planner::kTraits.id;
}

void Probe::answer(const ProbeRecord& record, ProbeAnswer& out) noexcept
{
    out = {};
    out.seed = record.seed;
    if (!fits(record)) {
        return;
    }
    static World world;  // not on the stack, which is measured for the co-processor
    world.take(record);
    world::Situation situation{{},
                               world.own,
                               world.configuration.limits,
                               world.configuration.airframe,
                               world.reference,
                               world.configuration.rules};
    static_cast<void>(threats_.collect(situation, {{world.tracks.data(), world.tracks.size()},
                                                   {world.obstacles.data(), world.obstacles.size()},
                                                   world.airspace}));
    situation.threats = threats_.all();
    if (!planner_.configure(world.configuration.planner) || !reach_.configure(world.configuration.reach) ||
        !orca_.configure(world.configuration.orca)) {
        return;
    }
    avoid::Settings settings = world.configuration.supervisor;
    constexpr std::array kIds{geometric::Planner::kTraits.id, reach::Planner::kTraits.id, orca::Planner::kTraits.id};
    for (std::size_t i = 0; i < kIds.size(); ++i) {
        static_cast<void>((record.methods >> i & 1U) != 0 && settings.order.try_add(kIds[i]));
    }
    if (record.clock >= app::WorkRate::kMinMegahertz) {
        settings.work = app::WorkRate::of_megahertz(record.clock).work();
        supervisor_.plan_in_slices(memory_.plan);
    } else {
        supervisor_.plan_in_whole();
    }
    if (!supervisor_.configure(settings)) {
        return;
    }
    supervisor_.reset();
    out.magic = kProbeMagic;
    if (record.kind == ProbeKind::slices) {
        out.chosen = differing(situation, settings, record.updates, out);
        return;
    }
    bool ran_out = false;
    const bool reciprocal = record.kind == ProbeKind::reciprocal;
    if (record.kind == ProbeKind::plan || record.kind == ProbeKind::reach || reciprocal) {
        orca_.reset();
        WorkBudget budget(world.configuration.supervisor.plan_budget);
        jink_window_begin();
        const world::PlanStatus status = plan(record.kind, situation, budget);
        jink_window_end();
        out.status = static_cast<std::uint32_t>(status);
        out.work = budget.spent();
        if (status == world::PlanStatus::found) {
            out.cost = manoeuvre_.cost;
            const Vec3& v = reciprocal ? manoeuvre_.command : manoeuvre_.path.points.front().velocity;
            std::copy_n(v.data(), 3, out.velocity);
        }
    } else if (record.kind == ProbeKind::update) {
        for (std::uint32_t i = 1; i < std::min(record.updates, kMaxUpdates); ++i) {
            static_cast<void>(supervisor_.update(situation, false));
            situation.now.us += 20'000;
        }
        const std::uint32_t spent = supervisor_.diagnostics().budget_spent;
        jink_window_begin();
        const avoid::Guidance guidance = supervisor_.update(situation, false);
        jink_window_end();
        ran_out = supervisor_.diagnostics().budget_spent != spent;
        out.status = static_cast<std::uint32_t>(guidance.plan_status);
        out.work = guidance.work;
        out.state = static_cast<std::uint32_t>(guidance.kind);
        out.margin = guidance.margin;
        std::copy_n(guidance.velocity.data(), 3, out.velocity);
        if (supervisor_.flying() != nullptr) {
            out.cost = supervisor_.flying()->cost;
        }
    }
    const geometric::Result& result = planner_.last();
    out.candidates = static_cast<std::uint32_t>(result.candidates.size());
    out.chosen =
        is_by_reach(record, out) ? kReachChose + reach_.last().node : static_cast<std::uint32_t>(result.chosen);
    out.cut_short = result.cut_short || ran_out ? 1U : 0U;
    out.stack_used = stack_used();
}

void serve() noexcept
{
    static Probe probe;
    static ProbeRecord record;
    ProbeAnswer answer;
    while (read_all(&record, sizeof record)) {
        probe.answer(record, answer);
        write_all(&answer, sizeof answer);
    }
}

}  // namespace jink::target
