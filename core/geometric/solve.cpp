// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <type_traits>

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

/// One run of `solve`: what its steps share.
class Run {
public:
    Run(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
        const vehicle::Airframe& airframe, WorkBudget& budget, Result& result) noexcept
        : problem_(problem), settings_(settings), limits_(limits), airframe_(airframe), budget_(budget),
          result_(result), along_(problem.frame.axes.col(0)), clearance_(problem, settings, limits),
          flown_(problem, settings, limits, clearance_)
    {
    }

    PlanStatus operator()() noexcept
    {
        generate();
        prepare();
        for (Candidate& candidate : result_.candidates) {
            if (!evaluate(candidate)) {
                break;
            }
        }
        return choose();
    }

private:
    void generate() noexcept;
    void prepare() noexcept;
    [[nodiscard]] bool evaluate(Candidate& candidate) noexcept;
    void assess(Candidate& candidate) noexcept;
    [[nodiscard]] float smoothness_of(const CandidateShape& shape) noexcept;
    [[nodiscard]] float closeness_of(const path::TimedPath& path) const noexcept;
    void list_moving() noexcept;
    void build(const CandidateShape& shape) noexcept;
    [[nodiscard]] Vec3 side_of(const CandidateShape& shape) const noexcept;
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
    void next_cheapest(Order& order, bool first) noexcept;
    void take(std::size_t index, const path::TimedPath& path) noexcept;
    [[nodiscard]] PlanStatus choose() noexcept;

    const Problem& problem_;
    const Settings& settings_;
    const vehicle::VehicleLimits& limits_;
    const vehicle::Airframe& airframe_;
    WorkBudget& budget_;
    Result& result_;
    const Vec3 along_;
    Seconds longest_ = 0.0F;         ///< duration of any candidate, where threats sweep volumes
    std::array<UnitCurve, 2> unit_;  ///< by family
    Clearance clearance_;
    detail::Flown flown_;
    StaticVector<std::uint16_t, detail::Flown::kLanes> trial_;  ///< by lane of flown_
    Order order_;
    Curve curve_;                                          ///< of the candidate at hand
    path::TimedPath path_;                                 ///< the same, about the start
    StaticVector<cost::MovingThreat, kMaxTracks> moving_;  ///< about the start
    struct {
        CandidateShape shape;
        float value = -1.0F;
    } last_smoothness_;
};

Vec3 Run::side_of(const CandidateShape& shape) const noexcept
{
    return detail::plane_direction(problem_.frame, shape.plane);
}

void Run::build(const CandidateShape& shape) noexcept
{
    detail::make_curve(unit_[static_cast<std::size_t>(shape.family)], along_, side_of(shape), problem_.distance,
                       shape.offset, problem_.speed, limits_, curve_);
}

void Run::generate() noexcept
{
    const int planes = settings_.extra_planes + 1;
    for (const Family family : {Family::simple, Family::symmetric}) {
        if (!(family == Family::simple ? settings_.simple : settings_.symmetric)) {
            continue;
        }
        unit_[static_cast<std::size_t>(family)] = detail::make_unit_curve(family, settings_.waypoints);
        for (int i = 0; i < planes; ++i) {
            Candidate candidate;
            candidate.shape.family = family;
            candidate.shape.plane = kPi * static_cast<float>(i) / static_cast<float>(planes);
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

bool Run::evaluate(Candidate& candidate) noexcept
{
    build(candidate.shape);
    candidate.duration = curve_.duration();
    if (settings_.check_acceleration && !detail::is_flyable(curve_, along_, problem_.speed, limits_)) {
        candidate.status = CandidateStatus::not_flyable;
        return true;
    }
    const detail::Verdict verdict = clearance_.check(curve_, budget_);
    candidate.status = verdict.status;
    candidate.hit = verdict.hit;
    if (verdict.status == CandidateStatus::available) {
        assess(candidate);
    }
    return verdict.status != CandidateStatus::not_evaluated;
}

float Run::smoothness_of(const CandidateShape& shape) noexcept
{
    // Even in the offset and blind to the plane, so neighbours often share it.
    if (last_smoothness_.value >= 0.0F && last_smoothness_.shape.family == shape.family &&
        std::abs(last_smoothness_.shape.offset) == std::abs(shape.offset)) {
        return last_smoothness_.value;
    }
    const UnitCurve& unit = unit_[static_cast<std::size_t>(shape.family)];
    detail::Coordinates x;
    detail::Coordinates y;
    for (std::size_t i = 0; i < unit.points; ++i) {
        x[i] = problem_.distance * unit.u[i];
        y[i] = std::abs(shape.offset) * unit.f[i];
    }
    last_smoothness_.shape = shape;
    last_smoothness_.value = cost::smoothness({x.data(), unit.points}, {y.data(), unit.points}, settings_.smoothness);
    return last_smoothness_.value;
}

float Run::closeness_of(const path::TimedPath& path) const noexcept
{
    std::array<float, kMaxTracks> per_threat{};
    for (std::size_t i = 0; i < moving_.size(); ++i) {
        per_threat[i] = cost::closeness(path, moving_[i], settings_.closeness);
    }
    return cost::combined_closeness({per_threat.data(), moving_.size()});
}

void Run::assess(Candidate& candidate) noexcept
{
    detail::to_timed_path(curve_, Vec3::Zero(), path_);
    cost::Terms& terms = candidate.terms;
    terms.time = cost::flight_time(path_);
    terms.smoothness = smoothness_of(candidate.shape);
    terms.smoothness_penalised =
        cost::penalised_smoothness(terms.smoothness, candidate.sin_alpha, settings_.rotation_penalty);
    terms.closeness = closeness_of(path_);
    terms.energy = cost::energy(path_, airframe_);
    terms.hover_power = cost::hover_power(path_, airframe_);
    candidate.normalised = cost::normalise(terms, settings_.caps);
    candidate.total = std::min(cost::total(candidate.normalised, settings_.weights), 1.0F);
    const float sign = std::copysign(1.0F, candidate.shape.offset);
    constexpr float kOtherSide = -1e-3F;  // a plane at right angles to what is flown is on neither side
    candidate.flip_penalty =
        sign * side_of(candidate.shape).dot(problem_.preferred_side) < kOtherSide ? settings_.flip_penalty : 0.0F;
}

/// The next cheapest candidates, the cheapest alone at first: most often it passes.
void Run::next_cheapest(Order& order, bool first) noexcept
{
    flown_.clear();
    trial_.clear();
    while (!order.empty() && !flown_.full() && !(first && flown_.size() == 1)) {
        std::pop_heap(order.begin(), order.end(), by_cost());
        const std::size_t index = order.back();
        order.pop_back();
        build(result_.candidates[index].shape);
        detail::to_timed_path(curve_, Vec3::Zero(), flown_.add());
        trial_.unchecked_push_back(static_cast<std::uint16_t>(index));
    }
}

void Run::take(std::size_t index, const path::TimedPath& path) noexcept
{
    Candidate& best = result_.candidates[index];
    best.status = CandidateStatus::chosen;
    result_.chosen = index;
    result_.side = std::copysign(1.0F, best.shape.offset) * side_of(best.shape);
    result_.path = path;
    for (path::PathPoint& point : result_.path.points) {
        point.position += problem_.frame.origin;
    }
}

PlanStatus Run::choose() noexcept
{
    Order& order = order_;
    for (std::size_t i = 0; i < result_.candidates.size(); ++i) {
        const Candidate& candidate = result_.candidates[i];
        if (candidate.status == CandidateStatus::available && candidate.total <= settings_.max_cost) {
            order.unchecked_push_back(static_cast<std::uint16_t>(i));
        }
    }
    std::make_heap(order.begin(), order.end(), by_cost());
    for (bool first = true; !order.empty(); first = false) {
        next_cheapest(order, first);
        if (settings_.verify_flight) {
            flown_.fly();
        }
        for (std::size_t lane = 0; lane < flown_.size(); ++lane) {
            Candidate& candidate = result_.candidates[trial_[lane]];
            const detail::Verdict verdict =
                settings_.verify_flight ? flown_.judge(lane, longest_, budget_) : detail::Verdict{};
            if (verdict.status == CandidateStatus::available) {
                take(trial_[lane], flown_.path(lane));
                return PlanStatus::found;
            }
            candidate.status = verdict.status;
            candidate.hit = verdict.hit;
        }
    }
    return budget_.exhausted() ? PlanStatus::budget_spent : PlanStatus::none_available;
}

}  // namespace

PlanStatus solve(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits,
                 const vehicle::Airframe& airframe, WorkBudget& budget, Workspace& workspace, Result& result) noexcept
{
    result.candidates.clear();
    result.path.points.clear();
    result.side = Vec3::Zero();
    result.chosen = 0;
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
