// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/planner.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/finite.hpp"
#include "core/base/work_units.hpp"
#include "core/world/conflict.hpp"
#include "core/world/cost_to_go.hpp"
#include "core/world/route_way.hpp"

namespace jink::reach {
namespace {

using world::PlanStatus;
using world::Situation;

static_assert(world::AvoidanceMethod<Planner>);

/// Courses of a multirotor that hardly moves, relative to the nominal path [rad].
constexpr std::array<float, Planner::kHeadings> kTurns{0.0F, kPi / 3.0F, -kPi / 3.0F, 2.0F * kPi / 3.0F,
                                                       -2.0F * kPi / 3.0F};
/// The goal lies just beyond the grid [its range].
constexpr float kGoalShare = 1.02F;
/// A vehicle that hovers begins towards a point of the way past obstacles that is so far away [m], if it is not nearly
/// above or below: level at least by this share.
constexpr float kHoverLook = 6.0F;
constexpr float kMinLevel = 0.1F;
/// Time steps of the stop at the end of a trajectory.
constexpr int kStopPieces = 4;
static_assert(kMaxPathPoints >= 2 * kMaxDepth + 2, "the deepest way has to fit");
/// A path nearer to the nominal path than this has no side [m].
constexpr float kMinSide = 0.1F;

bool fits(const ReachSet* set) noexcept
{
    return set != nullptr && set->nodes() > 0 && set->nodes() <= kMaxReachNodes &&
           set->grid.cells() <= kMaxReachCells && CellSpheres::serves(set->grid);
}

/// A point on the way past obstacles, where there are any in the way and it is known.
std::optional<Vec3> way_around(const Situation& s, float distance, WorkBudget& budget) noexcept
{
    return s.cost_to_go != nullptr && budget.spend(units::kWayAround)
               ? s.cost_to_go->way_around(s.own.position, distance)
               : std::nullopt;
}

/// The point that lies `ahead` [m] away on the way past obstacles. Where there are none in the way, or that is not
/// known: of the route, in front of the vehicle, or its end; of a place, beyond it.
Vec3 goal_of(const Situation& s, const world::Way& way, float ahead, WorkBudget& budget) noexcept
{
    if (const std::optional<Vec3> around = way_around(s, ahead, budget)) {
        return *around;
    }
    const path::RouteView route = s.reference.route();
    const float length = route.length();
    if (!(length > 0.0F)) {
        return way.origin + way.direction * ahead;
    }
    const float abeam = route.abeam_of(s.own.position, s.reference.segment).arc_length;
    return route.at(std::min(abeam + ahead, length)).position;
}

/// Unit vector from the nominal path towards the farthest point of the path.
Vec3 side_of(const world::Way& way, const path::TimedPath& path) noexcept
{
    Vec3 farthest = Vec3::Zero();
    for (const path::PathPoint& point : path.points) {
        const Vec3 from = point.position - way.origin;
        const Vec3 off = from - way.direction * way.direction.dot(from);
        farthest = off.squaredNorm() > farthest.squaredNorm() ? off : farthest;
    }
    const float distance = farthest.norm();
    return distance > kMinSide ? Vec3(farthest / distance) : Vec3(Vec3::Zero());
}

}  // namespace

/// Values that all courses of a plan share.
struct Planner::Start {
    const world::Way& way;
    const SegmentSets& sets;
    Seconds lead;
    float speed;  ///< along the movements [m/s]
    float stop;   ///< stopping distance [m]; 0 for a vehicle that does not stop
};

bool is_valid(const Settings& s) noexcept
{
    return s.sets != nullptr && s.tries >= 1 && s.tries <= 64 &&
           std::all_of(s.sets->segments.begin(), s.sets->segments.end(),
                       [](const SegmentSets& sets) { return fits(sets.navigation) && fits(sets.emergency); });
}

bool suits(const VehicleSets& sets, const vehicle::VehicleLimits& limits) noexcept
{
    constexpr float kRounding = 1.0F - 1e-4F;
    return limits.max_acceleration >= kRounding * sets.max_acceleration &&
           limits.max_vertical_acceleration >= kRounding * sets.max_vertical_acceleration &&
           limits.max_climb >= kRounding * sets.max_climb && limits.max_descent >= kRounding * sets.max_descent &&
           sets.most_speed * sets.cruise_speed >= kRounding * limits.cruise_speed;
}

bool Planner::configure(const Settings& settings) noexcept
{
    if (!is_valid(settings)) {
        return false;
    }
    settings_ = settings;
    return true;
}

PlanStatus Planner::plan(const Situation& situation, WorkBudget& budget, world::Manoeuvre& out) noexcept
{
    report_ = {};
    if (!world::is_complete(situation) || !is_valid(settings_)) {
        return PlanStatus::bad_input;
    }
    const VehicleSets& sets = *settings_.sets;
    const world::Way way = world::way_of(situation);
    const Vec3& velocity = situation.own.velocity;
    const float own_speed = velocity.norm();
    const float least_speed = sets.speeds.front() * sets.cruise_speed;
    const bool stops = situation.limits.kind == vehicle::VehicleKind::multirotor;
    const bool hovers = stops && own_speed < least_speed;
    // On the way past what is in the way, where that is known, or else along the nominal path.
    const std::optional<Vec3> around = hovers ? way_around(situation, kHoverLook, budget) : std::nullopt;
    const Vec3 along = around ? Vec3(*around - situation.own.position) : way.direction;
    const bool is_level = std::hypot(along.x(), along.y()) > kMinLevel * along.norm();
    const Vec3 ahead = hovers ? (is_level ? along : way.direction) : velocity;
    const float level_ahead = std::hypot(ahead.x(), ahead.y());
    const float pitch = hovers ? 0.0F : -std::atan2(velocity.z(), level_ahead);
    const float speed = std::max(own_speed, least_speed);
    const SegmentSets* of = segment_of(sets, speed / sets.cruise_speed, pitch);
    if (of == nullptr) {
        return PlanStatus::none_available;  // faster or steeper than every set allows
    }
    const Seconds lead = hovers ? 0.0F : situation.rules.latency;
    const Start start{way, *of, lead, speed, stops ? vehicle::stopping_distance(speed, situation.limits) : 0.0F};
    Placed placed;
    placed.origin = situation.own.position + velocity * lead;
    placed.unit = speed * sets.period;
    placed.period = sets.period;
    placed.upside_down = of->upside_down;
    const float course = level_ahead > 0.0F ? std::atan2(ahead.y(), ahead.x()) : situation.own.yaw;
    const std::size_t headings = hovers ? kHeadings : 1;
    for (std::size_t i = 0; i < headings; ++i) {
        placed.cosine = std::cos(course + kTurns[i]);
        placed.sine = std::sin(course + kTurns[i]);
        ++report_.headings;
        looked_ = false;
        PlanStatus status = PlanStatus::none_available;
        for (const ReachSet* set : {of->navigation, of->emergency}) {
            if (status == PlanStatus::none_available && set != placed.set) {
                placed.set = set;
                report_.emergency = set == of->emergency;
                status = try_set(situation, placed, start, budget, out);
            }
        }
        if (status != PlanStatus::none_available) {
            return status;
        }
        placed.set = nullptr;
    }
    return PlanStatus::none_available;
}

/// The trajectory to a node as a path, its movements in halves.
void Planner::make_path(const Situation& situation, const Placed& placed, NodeIndex node, const Start& start,
                        path::TimedPath& path) noexcept
{
    const ReachSet& set = *placed.set;
    std::array<NodeIndex, kMaxDepth> way{};
    std::size_t movements = 0;
    for (NodeIndex at = node; at != 0; at = set.parent[at]) {
        way[movements++] = at;
    }
    path.points.clear();
    if (start.lead > 0.0F) {
        path.points.unchecked_push_back({situation.own.position, Vec3::Zero(), 0.0F});
    }
    path.points.unchecked_push_back({placed.origin, Vec3::Zero(), start.lead});
    for (std::size_t i = movements; i > 0; --i) {
        const NodeIndex to = way[i - 1];
        const NodeIndex from = set.parent[to];
        const Pose<float> pose{set.position_of(from),
                               static_cast<float>(set.attitude[std::size_t{2} * from]) * set.step.pitch,
                               static_cast<float>(set.attitude[std::size_t{2} * from + 1]) * set.step.yaw};
        const Vec3 middle = at_share(pose, static_cast<Movement>(set.movement[to]), 0.5F, set.step).position;
        const Seconds end = start.lead + placed.time(to);
        path.points.unchecked_push_back({placed.to_world(middle), Vec3::Zero(), end - 0.5F * placed.period});
        path.points.unchecked_push_back({placed.node(to), Vec3::Zero(), end});
    }
    for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
        const path::PathPoint& next = path.points[i + 1];
        path::PathPoint& point = path.points[i];
        point.velocity = (next.position - point.position) / (next.time - point.time);
    }
    path.points.back().velocity = path.points[path.points.size() - 2].velocity;
}

/// Whether the vehicle can stop at the end of a path, with the stop itself clear of the near threats.
bool Planner::can_stop(const Situation& situation, const path::TimedPath& path, const Start& start,
                       WorkBudget& budget) const noexcept
{
    if (!(start.stop > 0.0F)) {
        return true;
    }
    vehicle::VehicleState at = situation.own;
    at.position = path.points.back().position;
    at.velocity = path.points.back().velocity;
    const Seconds step = vehicle::stopping_time(at.velocity, situation.limits) / static_cast<float>(kStopPieces);
    const float acceleration =
        std::hypot(situation.limits.max_acceleration, situation.limits.max_vertical_acceleration);
    const float bulge = 0.125F * acceleration * step * step;
    Seconds t = path.duration() - start.lead;
    for (int i = 0; i < kStopPieces; ++i) {
        const Vec3 from = at.position;
        vehicle::advance(at, Vec3::Zero(), situation.limits, step);
        if (!is_free(near_.level({from, at.position, t, t + step, bulge}, budget), AvoidanceRun::hard_constraints)) {
            return false;
        }
        t += step;
    }
    return true;
}

/// Rates the cells by the cell sources, into `blocks_`. Levels of the course's other set are used again where both sets
/// have the same cells, but not with `fusion_`: its ratings depend on the times of the set's own trajectories.
PlanStatus Planner::look(const Situation& situation, const Placed& placed, const Start& start,
                         WorkBudget& budget) noexcept
{
    const Grid<float>& grid = placed.set->grid;
    const bool same_cells = spheres_.are_of(grid);
    if (looked_ && same_cells && fusion_ == nullptr) {
        return PlanStatus::found;
    }
    if (!same_cells) {
        spheres_ = CellSpheres(grid);
    }
    const std::span<Level> blocks(blocks_.data(), grid.cells());
    std::fill(blocks.begin(), blocks.end(), kFree);
    for (CellSource* source : {picture_, fusion_}) {
        const RateStatus status = source != nullptr
                                      ? source->rate(situation, placed, spheres_, start.lead, blocks, budget)
                                      : RateStatus::rated;
        if (status == RateStatus::blind || status == RateStatus::budget_spent) {
            return status == RateStatus::blind ? PlanStatus::none_available : PlanStatus::budget_spent;
        }
    }
    looked_ = true;
    return PlanStatus::found;
}

PlanStatus Planner::try_set(const Situation& situation, const Placed& placed, const Start& start, WorkBudget& budget,
                            world::Manoeuvre& out) noexcept
{
    const ReachSet& set = *placed.set;
    const std::span<const Level> blocks(blocks_.data(), set.grid.cells());
    const std::span<Level> cells(cells_.data(), set.grid.cells());
    const std::span<Level> nodes(nodes_.data(), set.nodes());
    if (const PlanStatus looked = look(situation, placed, start, budget); looked != PlanStatus::found) {
        return looked;
    }
    const auto entries = static_cast<std::uint32_t>(set.entries.size());
    const bool collected = near_.collect(situation, placed, start.lead, start.stop, budget);
    report_.near = static_cast<std::uint16_t>(near_.size());
    if (!collected || !near_.mark(placed, spheres_, budget) ||
        !budget.spend(units::kReachEntries * (1U + entries / 8U))) {
        return PlanStatus::budget_spent;
    }
    // A node that conflicts with any threat is of no use, nor are its descendants, whatever the threat.
    const auto own_level = [&](NodeIndex node) {
        if (fusion_ != nullptr) {
            return kFree;  // the ratings of the cells include all threats
        }
        const Level level = near_.level(placed, node, budget);
        return is_free(level, AvoidanceRun::hard_constraints) ? level : static_cast<Level>(AvoidanceRun::obstacles);
    };
    evaluate_with(set, blocks, own_level, nodes, cells);
    const float range = placed.unit * set.grid.distance();
    const Vec3 goal = placed.to_set(goal_of(situation, start.way, kGoalShare * range, budget));
    const ChoiceRule rule{false, settings_.least_outer_layer};
    path::TimedPath path;
    for (int i = 0; i < settings_.tries && !budget.exhausted(); ++i) {
        const Choice choice =
            find_best_path_of_all(set, spheres_, nodes, cells, goal, AvoidanceRun::hard_constraints, rule, budget);
        if (budget.exhausted()) {
            break;
        }
        report_.path = choice.status;
        report_.run = choice.run;
        report_.node = choice.node;
        if (choice.node == kNoNode) {
            return PlanStatus::none_available;
        }
        ++report_.tries;
        make_path(situation, placed, choice.node, start, path);
        if (budget.spend(units::kReachPath) && can_stop(situation, path, start, budget)) {
            report_.free_nodes = static_cast<std::uint16_t>(
                std::count_if(nodes.begin() + 1, nodes.end(), [&](Level level) { return is_free(level, choice.run); }));
            out.kind = world::ManoeuvreKind::follow_path;
            out.start = situation.now;
            out.valid_until = situation.now + path.duration();
            out.path = path;
            out.command = Vec3::Zero();
            out.side = side_of(start.way, out.path);
            out.cost =
                std::clamp(set.cost_of(choice.node) / static_cast<float>(set.depth[choice.node]) - 1.0F, 0.0F, 1.0F);
            return PlanStatus::found;
        }
        cells[choice.cell] = 0;  // discarded as an end; trajectories through the cell stay
    }
    return budget.exhausted() ? PlanStatus::budget_spent : PlanStatus::none_available;
}

}  // namespace jink::reach
