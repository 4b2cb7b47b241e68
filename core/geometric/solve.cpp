// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <type_traits>

#include "core/base/work_units.hpp"
#include "core/geometric/curve.hpp"
#include "core/geometric/flown.hpp"
#include "core/geometric/offsets.hpp"
#include "core/geometric/planner.hpp"

namespace jink::geometric {
namespace {

using detail::Clearance;
using detail::Curve;
using detail::UnitCurve;
using world::PlanStatus;

bool positive(float value) noexcept { return std::isfinite(value) && value > 0.0F; }

bool not_negative(float value) noexcept { return std::isfinite(value) && value >= 0.0F; }

bool is_valid(const Threat& t) noexcept
{
    return is_finite(t.motion.position) && is_finite(t.motion.velocity) && not_negative(t.radius) &&
           not_negative(t.radius_rate) && not_negative(t.radius_acceleration);
}

bool is_valid(const PathFrame& frame) noexcept
{
    return is_finite(frame.origin) && frame.axes.allFinite() && frame.axes.isUnitary(1e-3F);
}

bool has_valid_scales(const Problem& p) noexcept
{
    return is_valid(p.frame) && positive(p.distance) && positive(p.main_radius) && positive(p.speed) &&
           not_negative(p.obstacle_clearance) && not_negative(p.body_radius) && not_negative(p.span_from) &&
           not_negative(p.span_to) && is_finite(p.start_velocity) && is_finite(p.preferred_side) &&
           is_finite(p.main_centre_offset);
}

bool is_valid(const Problem& p) noexcept
{
    return has_valid_scales(p) && p.threats.size() <= kMaxTracks && p.obstacles.size() <= kMaxObstacles &&
           (p.main == kNoThreat || p.main < p.threats.size()) &&
           std::all_of(p.threats.begin(), p.threats.end(), [](const Threat& t) { return is_valid(t); }) &&
           std::all_of(p.obstacles.begin(), p.obstacles.end(),
                       [](const world::Obstacle& o) { return geometry::is_valid(o.shape); }) &&
           (p.main_shape == nullptr || geometry::is_valid(*p.main_shape));
}

float angle_of(int plane, int planes) noexcept { return kPi * static_cast<float>(plane) / static_cast<float>(planes); }

/// One run of `solve`: what its steps share.
class Run {
public:
    Run(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
        const vehicle::Airframe& airframe, WorkBudget& budget, Result& result) noexcept
        : problem_(problem), settings_(settings), limits_(limits), airframe_(airframe), budget_(budget),
          result_(result), along_(problem.frame.axes.col(0)), clearance_(problem, settings, limits),
          flown_(problem, settings, limits)
    {
    }

    PlanStatus operator()() noexcept
    {
        generate();
        prepare();
        // What has been found must not be left unchecked.
        const std::uint32_t kept = std::min(units_of_checks(), budget_.left() / 2);
        WorkBudget curves(budget_.left() - kept);
        for (Candidate& candidate : result_.candidates) {
            if (!evaluate(candidate, curves)) {
                break;
            }
        }
        static_cast<void>(budget_.spend(curves.spent()));  // never more than was left
        spent_ = curves.exhausted();
        return choose();
    }

private:
    void generate() noexcept;
    void prepare() noexcept;
    [[nodiscard]] bool evaluate(Candidate& candidate, WorkBudget& budget) noexcept;
    void assess(Candidate& candidate) noexcept;
    [[nodiscard]] std::uint32_t units_of_checks() const noexcept
    {
        constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
        const std::uint64_t shares = 1 + std::uint64_t{units::kSolidShares} * clearance_.solids();
        return static_cast<std::uint32_t>(std::min(kMost, settings_.check_units * shares));
    }
    [[nodiscard]] std::uint32_t units_of_costs() const noexcept
    {
        return units::kCostPoint * settings_.waypoints + units::closeness_units(settings_.waypoints, moving_.size());
    }
    [[nodiscard]] float smoothness_of(const CandidateShape& shape) const noexcept;
    [[nodiscard]] float closeness() const noexcept;
    void list_moving() noexcept;
    void build(const CandidateShape& shape) noexcept;
    [[nodiscard]] const Vec3& side_of(const CandidateShape& shape) const noexcept
    {
        const float planes = static_cast<float>(settings_.extra_planes) + 1.0F;
        return sides_[static_cast<std::size_t>(std::lround(shape.plane * (planes / kPi)))];
    }
    /// Candidates still to be tried, a heap with the cheapest at its front, of equally cheap ones the first.
    using Order = StaticVector<std::uint16_t, kMaxCandidates>;
    [[nodiscard]] auto by_cost() const noexcept
    {
        return [this](std::uint16_t a, std::uint16_t b) {
            const float cost_a = result_.candidates[a].total + result_.candidates[a].flip_penalty;
            const float cost_b = result_.candidates[b].total + result_.candidates[b].flip_penalty;
            return cost_b < cost_a || (cost_b == cost_a && b < a);
        };
    }
    [[nodiscard]] bool try_in_turn(WorkBudget& budget) noexcept;
    [[nodiscard]] detail::Verdict verdict_of(const CandidateShape& shape, WorkBudget& budget) noexcept;
    void take(std::size_t index) noexcept;
    [[nodiscard]] PlanStatus choose() noexcept;

    const Problem& problem_;
    const Settings& settings_;
    const vehicle::VehicleLimits& limits_;
    const vehicle::Airframe& airframe_;
    WorkBudget& budget_;
    Result& result_;
    const Vec3 along_;
    bool spent_ = false;             ///< the budget has ended before all candidates were looked at
    Seconds longest_ = 0.0F;         ///< duration of any candidate, where threats sweep volumes
    std::array<UnitCurve, 2> unit_;  ///< by family
    std::array<Vec3, kMaxPlanes> sides_;
    Clearance clearance_;
    detail::Flown flown_;
    Order order_;
    Curve curve_;                                          ///< of the candidate at hand
    path::TimedPath path_;                                 ///< the same, about the start
    StaticVector<cost::MovingThreat, kMaxTracks> moving_;  ///< about the start
};

void Run::build(const CandidateShape& shape) noexcept
{
    detail::make_curve(unit_[static_cast<std::size_t>(shape.family)], along_, side_of(shape), problem_.distance,
                       shape.offset, problem_.speed, limits_, curve_);
}

void Run::generate() noexcept
{
    const int planes = settings_.extra_planes + 1;
    for (int i = 0; i < planes; ++i) {
        sides_[static_cast<std::size_t>(i)] = detail::plane_direction(problem_.frame, angle_of(i, planes));
    }
    for (const Family family : {Family::simple, Family::symmetric}) {
        if (!(family == Family::simple ? settings_.simple : settings_.symmetric)) {
            continue;
        }
        unit_[static_cast<std::size_t>(family)] = detail::make_unit_curve(family, settings_.waypoints);
        for (int i = 0; i < planes; ++i) {
            Candidate candidate;
            candidate.shape.family = family;
            candidate.shape.plane = angle_of(i, planes);
            const Vec3 side = side_of(candidate.shape);
            candidate.sin_alpha = std::min(std::sqrt(along_.z() * along_.z() + side.z() * side.z()), 1.0F);
            detail::Offsets offsets;
            detail::offsets_of_plane(problem_, settings_, family, limits_.half_extents, side, offsets);
            for (const float offset : offsets) {
                candidate.shape.offset = offset;
                result_.candidates.unchecked_push_back(candidate);  // is_valid(Settings) has counted them
            }
        }
    }
}

void Run::prepare() noexcept
{
    float widest = 0.0F;
    for (const Candidate& candidate : result_.candidates) {
        widest = std::max(widest, std::abs(candidate.shape.offset));
    }
    const float length = curve_length_x(settings_.symmetric ? Family::symmetric : Family::simple, problem_.distance);
    const Vec3 end = length * along_;
    const Vec3 aside = Vec3::Constant(widest);
    const float slowest = std::min({problem_.speed, limits_.max_climb, limits_.max_descent});
    clearance_.collect({end.cwiseMin(0.0F) - aside, end.cwiseMax(0.0F) + aside}, (length + 2.0F * widest) / slowest,
                       budget_);
    if (settings_.security == SecurityMode::swept || settings_.closeness == cost::ClosenessMethod::swept) {
        for (const Candidate& candidate : result_.candidates) {
            build(candidate.shape);
            longest_ = std::max(longest_, curve_.duration());
        }
        clearance_.sweep_until(longest_);
    }
    list_moving();
}

void Run::list_moving() noexcept
{
    std::array<float, kMaxTracks> distance{};
    for (std::size_t i = 0; i < problem_.threats.size(); ++i) {
        const Threat& threat = problem_.threats[i];
        if (threat.motion.velocity.squaredNorm() > 0.0F) {
            const Vec3 position = threat.motion.position - problem_.frame.origin;
            distance[moving_.size()] = position.norm() - threat.radius;
            moving_.unchecked_push_back({{position, threat.motion.velocity}, threat.radius, clearance_.sweep_end(i)});
        }
    }
    while (settings_.closeness_nearest > 0 && moving_.size() > settings_.closeness_nearest) {
        const auto count = static_cast<std::ptrdiff_t>(moving_.size());
        const auto farthest =
            static_cast<std::size_t>(std::max_element(distance.begin(), distance.begin() + count) - distance.begin());
        distance[farthest] = distance[moving_.size() - 1];
        moving_.swap_erase(farthest);
    }
}

bool Run::evaluate(Candidate& candidate, WorkBudget& budget) noexcept
{
    if (!budget.spend(units::kCandidatePoint * settings_.waypoints)) {
        candidate.status = CandidateStatus::not_evaluated;
        return false;
    }
    build(candidate.shape);
    candidate.duration = curve_.duration();
    if (settings_.check_acceleration && !detail::is_flyable(curve_, along_, problem_.speed, limits_)) {
        candidate.status = CandidateStatus::not_flyable;
        return true;
    }
    candidate.status = CandidateStatus::available;  // for all that is known without evaluate_all
    if (settings_.evaluate_all) {
        const detail::Verdict verdict = clearance_.check(curve_, budget);
        candidate.status = verdict.status;
        candidate.hit = verdict.hit;
    }
    if (candidate.status == CandidateStatus::available && !budget.spend(units_of_costs())) {
        candidate.status = CandidateStatus::not_evaluated;
    }
    if (candidate.status == CandidateStatus::available) {
        assess(candidate);
    }
    return candidate.status != CandidateStatus::not_evaluated;
}

float Run::smoothness_of(const CandidateShape& shape) const noexcept
{
    const UnitCurve& unit = unit_[static_cast<std::size_t>(shape.family)];
    detail::Coordinates y;
    for (std::size_t i = 0; i < unit.points; ++i) {
        y[i] = std::abs(shape.offset) * unit.f[i];
    }
    return cost::smoothness(problem_.distance * unit.u[1], {y.data(), unit.points}, settings_.smoothness);
}

float Run::closeness() const noexcept
{
    const auto all = [this](const detail::Coordinates& c) { return std::span<const float>(c.data(), curve_.points); };
    const cost::Waypoints path{all(curve_.x), all(curve_.y), all(curve_.z), all(curve_.t)};
    std::array<float, kMaxTracks> per_threat{};
    for (std::size_t i = 0; i < moving_.size(); ++i) {
        per_threat[i] = cost::closeness(path, moving_[i], settings_.closeness);
    }
    return cost::combined_closeness({per_threat.data(), moving_.size()});
}

void Run::assess(Candidate& candidate) noexcept
{
    cost::Terms& terms = candidate.terms;
    terms.time = curve_.duration();
    terms.smoothness = smoothness_of(candidate.shape);
    terms.smoothness_penalised =
        cost::penalised_smoothness(terms.smoothness, candidate.sin_alpha, settings_.rotation_penalty);
    terms.closeness = closeness();
    if (settings_.all_terms) {
        detail::to_timed_path(curve_, Vec3::Zero(), path_);
        terms.energy = cost::energy(path_, airframe_);
        terms.hover_power = cost::hover_power(path_, airframe_);
    }
    candidate.normalised = cost::normalise(terms, settings_.caps);
    candidate.total = std::min(cost::total(candidate.normalised, settings_.weights), 1.0F);
    if (problem_.preferred_side == Vec3::Zero()) {
        return;
    }
    const float sign = std::copysign(1.0F, candidate.shape.offset);
    constexpr float kOtherSide = -1e-3F;  // a plane at right angles to what is flown is on neither side
    candidate.flip_penalty =
        sign * side_of(candidate.shape).dot(problem_.preferred_side) < kOtherSide ? settings_.flip_penalty : 0.0F;
}

void Run::take(std::size_t index) noexcept
{
    Candidate& best = result_.candidates[index];
    best.status = CandidateStatus::chosen;
    result_.chosen = index;
    result_.side = std::copysign(1.0F, best.shape.offset) * side_of(best.shape);
    result_.path = path_;
    for (path::PathPoint& point : result_.path.points) {
        point.position += problem_.frame.origin;
    }
}

PlanStatus Run::choose() noexcept
{
    for (std::size_t i = 0; i < result_.candidates.size(); ++i) {
        Candidate& candidate = result_.candidates[i];
        if (candidate.status != CandidateStatus::available) {
            continue;
        }
        if (candidate.total <= settings_.max_cost) {
            order_.unchecked_push_back(static_cast<std::uint16_t>(i));
        } else if (!settings_.evaluate_all) {
            candidate.status = CandidateStatus::not_evaluated;
        }
    }
    std::make_heap(order_.begin(), order_.end(), by_cost());
    WorkBudget checks(std::min(units_of_checks(), budget_.left()));
    const bool is_short = checks.left() < units_of_checks();
    const bool found = try_in_turn(checks);
    static_cast<void>(budget_.spend(checks.spent()));  // never more than was left
    result_.cut_short = spent_ || checks.exhausted();
    if (found) {
        return PlanStatus::found;
    }
    return spent_ || (checks.exhausted() && is_short) ? PlanStatus::budget_spent : PlanStatus::none_available;
}

/// The candidates of order_, cheapest first, until one is clear. Those that are not reached are not evaluated.
bool Run::try_in_turn(WorkBudget& budget) noexcept
{
    bool found = false;
    while (!order_.empty()) {
        std::pop_heap(order_.begin(), order_.end(), by_cost());
        const std::size_t index = order_.back();
        order_.pop_back();
        Candidate& candidate = result_.candidates[index];
        if (found || budget.exhausted()) {
            candidate.status = found && settings_.evaluate_all ? candidate.status : CandidateStatus::not_evaluated;
            continue;
        }
        const detail::Verdict verdict = verdict_of(candidate.shape, budget);
        candidate.status = verdict.status;
        candidate.hit = verdict.hit;
        if (verdict.status == CandidateStatus::available) {
            take(index);
            found = true;
        }
    }
    return found;
}

/// Of a candidate as a curve, where that is not known yet, and in flight. Its path is in path_ where it is available.
detail::Verdict Run::verdict_of(const CandidateShape& shape, WorkBudget& budget) noexcept
{
    if (!budget.spend(units::kCandidatePoint * settings_.waypoints)) {
        return {CandidateStatus::not_evaluated, {}};
    }
    build(shape);
    const detail::Verdict curve = settings_.evaluate_all ? detail::Verdict{} : clearance_.check(curve_, budget);
    if (curve.status != CandidateStatus::available) {
        return curve;
    }
    detail::to_timed_path(curve_, Vec3::Zero(), path_);
    return settings_.verify_flight ? flown_.judge(path_, longest_, budget) : detail::Verdict{};
}

}  // namespace

PlanStatus solve(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
                 const vehicle::Airframe& airframe, WorkBudget& budget, Workspace& workspace, Result& result) noexcept
{
    result.candidates.clear();
    result.path.points.clear();
    result.side = Vec3::Zero();
    result.chosen = 0;
    result.cut_short = false;
    if (!is_valid(settings) || !vehicle::is_valid(limits) || !vehicle::is_valid(airframe) || !is_valid(problem)) {
        return PlanStatus::bad_input;
    }
    if (problem.distance < kLeastDistanceInRadii * scale_radius(problem)) {
        return PlanStatus::too_close;
    }
    static_assert(sizeof(Run) <= Workspace::kBytes && Workspace::kBytes <= sizeof(Run) + sizeof(Run) / 4 + 1024);
    static_assert(alignof(Run) <= alignof(std::max_align_t) && std::is_trivially_destructible_v<Run>);
    return (*new (workspace.bytes()) Run(problem, settings, limits, airframe, budget, result))();
}

PlanStatus solve(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
                 const vehicle::Airframe& airframe, WorkBudget& budget, Result& result) noexcept
{
    Workspace workspace;
    return solve(problem, settings, limits, airframe, budget, workspace, result);
}

bool make_candidate_path(const Problem& problem, const CandidateShape& shape, std::uint16_t waypoints,
                         const vehicle::VehicleLimits& limits, path::TimedPath& out) noexcept
{
    if (waypoints < 8 || waypoints > kMaxPathPoints || !has_valid_scales(problem) || !vehicle::is_valid(limits) ||
        !std::isfinite(shape.plane) || !std::isfinite(shape.offset)) {
        return false;
    }
    Curve curve;
    detail::make_curve(detail::make_unit_curve(shape.family, waypoints), problem.frame.axes.col(0),
                       detail::plane_direction(problem.frame, shape.plane), problem.distance, shape.offset,
                       problem.speed, limits, curve);
    detail::to_timed_path(curve, problem.frame.origin, out);
    return true;
}

}  // namespace jink::geometric
