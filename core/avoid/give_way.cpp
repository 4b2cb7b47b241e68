// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/give_way.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/avoid/fallback_wing.hpp"
#include "core/avoid/final_check.hpp"
#include "core/base/work_units.hpp"
#include "core/world/threat_set.hpp"

namespace jink::avoid {
namespace {

constexpr int kWayCourses = 8;
constexpr std::size_t kCommandsAtMost = 3 * kWayCourses + 3;
/// Farther off than this nothing is gained [multiples of the well clear volume].
constexpr float kEnough = 1.1F;
/// Nor here [multiples of the volume of a near mid-air collision].
constexpr float kFar = 5.0F;
/// Where nothing is well clear, that counts too: few courses are compared, and a small volume lies between them.
constexpr float kClearShare = 3.0F;
/// What was flown before counts better by so much.
constexpr float kStay = 0.15F;
/// So many commands are compared with how the aircraft turn.
constexpr std::uint32_t kTurnLooks = 9;
/// Commands are alike where they differ by less than this share of the cruise speed.
constexpr float kAlike = 0.2F;
/// The manoeuvre is checked over this time [s].
constexpr Seconds kChecked = 8.0F;
/// A climb or descent for less where the height is used up before, but for so long at least [s].
constexpr Seconds kCheckedAtLeast = 2.0F;
constexpr Seconds kPathStep = 0.25F;
constexpr float kNone = -std::numeric_limits<float>::infinity();

struct Rated {
    Vec3 command = Vec3::Zero();
    float clear = kEnough;      ///< nearness, in multiples of the well clear volume
    float near_mid_air = kFar;  ///< likewise
    float score = kNone;
    bool seen_turning = false;  ///< also compared with how the aircraft turn
};
using Commands = StaticVector<Rated, kCommandsAtMost>;

/// How far the vehicle can climb and descend [m].
struct HeightLeft {
    float up = std::numeric_limits<float>::infinity();
    float down = std::numeric_limits<float>::infinity();
    Seconds stop = 0.0F;  ///< what the final check adds to a command, as time at its speed

    [[nodiscard]] float along(const Vec3& command) const noexcept { return command.z() > 0.0F ? up : down; }
    /// No command is offered that would use it up sooner.
    [[nodiscard]] Seconds lasts() const noexcept { return kCheckedAtLeast + stop; }
};

/// A stop; for a wing as much time straight on.
Seconds stop_of(const vehicle::VehicleLimits& limits) noexcept
{
    const float speed = std::max(limits.max_climb, limits.max_descent);
    return limits.kind == vehicle::VehicleKind::multirotor
               ? 2.0F * limits.velocity_lag + 0.5F * speed / limits.max_vertical_acceleration
               : vehicle::stopping_time(Vec3(limits.cruise_speed, 0.0F, speed), limits);
}

// Once in a choice, and so compiled for size; commands_of likewise.
[[gnu::cold, gnu::noinline]] HeightLeft height_left(const world::Situation& s) noexcept
{
    HeightLeft left;
    left.stop = stop_of(s.limits);
    for (const world::Threat& bound : s.threats) {
        if (!bound.is_bound()) {
            break;
        }
        const float above = s.own.position.z() - bound.position.z();
        const float kept = s.limits.half_extents.z() + bound.growth.radius + s.rules.clearance;
        if (bound.form == world::ThreatForm::floor) {
            left.down = std::max(0.0F, above - kept);
        } else if (bound.form == world::ThreatForm::ceiling) {
            left.up = std::max(0.0F, -above - kept);
        }
    }
    return left;
}

[[gnu::cold, gnu::noinline]] Commands commands_of(const world::Situation& s, const Vec3& along,
                                                  const HeightLeft& left) noexcept
{
    const vehicle::VehicleLimits& limits = s.limits;
    constexpr float kHalfAndHalf = 0.70710678F;
    const float slant = kHalfAndHalf * limits.cruise_speed;
    const float up = std::min(limits.max_climb, left.up / left.lasts());
    const float down = std::min(limits.max_descent, left.down / left.lasts());
    const float length = along.head<2>().norm();
    const Vec3 ahead = length > 1e-3F ? Vec3(along.x() / length, along.y() / length, 0.0F) : Vec3(Vec3::UnitX());
    Commands commands;
    for (const float climb : {0.0F, std::min(up, slant), -std::min(down, slant)}) {
        for (int i = 0; i < kWayCourses; ++i) {
            const float course = 2.0F * kPi * static_cast<float>(i) / static_cast<float>(kWayCourses);
            commands.unchecked_push_back({.command = detail::command_on(ahead, course, climb, limits)});
        }
    }
    if (limits.kind == vehicle::VehicleKind::multirotor) {
        commands.unchecked_push_back({});
        commands.unchecked_push_back({.command = std::min(up, limits.cruise_speed) * Vec3::UnitZ()});
        commands.unchecked_push_back({.command = -std::min(down, limits.cruise_speed) * Vec3::UnitZ()});
    }
    return commands;
}

/// A straight piece of an aircraft's way.
struct Piece {
    Vec3 position = Vec3::Zero();  ///< where it begins
    Vec3 velocity = Vec3::Zero();
    Seconds from = 0.0F;  ///< after now
    Seconds span = 0.0F;
};

/// Least nearness to a piece while a command is held: straight on until the height is used up, then level. The last of
/// it is flown more and more slowly, as commands_of offers it; half of that counts. The time until the command is flown
/// moves the beginning.
float nearness_of(const world::Situation& s, const Vec3& command, const HeightLeft& left, const Piece& piece,
                  const world::Volume& volume) noexcept
{
    const Vec3 change = s.own.velocity - command;
    const Seconds lost =
        s.rules.latency + s.limits.velocity_lag + 0.5F * change.head<2>().norm() / s.limits.max_acceleration;
    const float climb = command.z();
    const Seconds until_level = climb != 0.0F ? left.along(command) / std::abs(climb) - 0.5F * left.lasts()
                                              : std::numeric_limits<float>::infinity();
    Vec3 begin = s.own.position + change * lost + command * piece.from;
    begin.z() -= climb * (piece.from - std::min(piece.from, until_level));
    const Seconds span = piece.span;
    const Seconds climbs = std::min(span, std::max(0.0F, until_level - piece.from));
    const Vec3 gap = piece.position - begin;
    const Vec3 closing = piece.velocity - command;
    const float first = world::nearest(gap, closing, volume, climbs).least;
    if (climbs >= span) {
        return first;
    }
    const Vec3 level = closing + climb * Vec3::UnitZ();
    const float rest = world::nearest(gap + closing * climbs, level, volume, span - climbs).least;
    return std::min(first, rest);
}

/// What counts: well clear with something to spare, then how little the command differs from the nominal velocity; well
/// clear; far from a near mid-air collision. Each is worth more than all of the next.
float score_of(float clear, float near_mid_air, float differs) noexcept
{
    if (clear >= kEnough) {
        return 4.0F * kFar - std::min(differs, kFar);
    }
    return clear >= 1.0F ? 2.0F * kFar + clear : std::min(near_mid_air, kFar) + kClearShare * clear;
}

/// An aircraft and the volumes about it.
struct Aircraft {
    const world::Threat* threat = nullptr;
    world::Volume clear;
    world::Volume near_mid_air;
    float nearness = 0.0F;  ///< if the vehicle flies on as it does
    world::TurnPieces turning;
};
using AircraftList = StaticVector<Aircraft, kMaxAircraft>;

AircraftList aircraft_of(const world::Situation& s, WorkBudget& budget) noexcept
{
    AircraftList list;
    for (const world::Threat& threat : world::of_kind(s.threats, world::ThreatKind::track)) {
        if (!world::is_aircraft(s, threat) || !budget.spend(units::kAircraftLook)) {
            continue;
        }
        Aircraft one{&threat, world::well_clear_of(s, threat), world::near_mid_air_of(threat), 0.0F,
                     world::turning_on(threat)};
        one.nearness = world::nearest(threat.position - s.own.position, threat.velocity - s.own.velocity, one.clear,
                                      world::kAircraftAhead)
                           .least;
        if (!list.try_push_back(one)) {
            Aircraft& farthest = *std::max_element(
                list.begin(), list.end(), [](const Aircraft& a, const Aircraft& b) { return a.nearness < b.nearness; });
            farthest = one.nearness < farthest.nearness ? one : farthest;
        }
    }
    return list;
}

/// What commands are compared by.
class Comparison {
public:
    Comparison(const world::Situation& s, const Vec3& along, const Vec3* previous, WorkBudget& budget) noexcept
        : s_(s), along_(along), previous_(previous), left_(height_left(s)), aircraft_(aircraft_of(s, budget)),
          commands_(commands_of(s, along, left_))
    {
    }

    /// Rates all by the courses that any aircraft may take. False where the budget ends.
    bool rate(WorkBudget& budget) noexcept
    {
        for (Rated& one : commands_) {
            if (!budget.spend(units::kAircraftCommand * static_cast<std::uint32_t>(aircraft_.size()))) {
                return false;
            }
            for (const Aircraft& other : aircraft_) {
                for (const world::AircraftCourse& course : world::kAircraftCourses) {
                    meet(one, other,
                         {other.threat->position, course.of(other.threat->velocity), 0.0F,
                          course.straight ? world::kAircraftAhead : world::kTurnAhead});
                }
            }
            score(one);
        }
        looks_ = look_units() > 0 ? std::min(kTurnLooks, budget.left() / 2 / look_units()) : 0;
        return true;
    }

    /// The best one, rated by how the aircraft turn too. That makes none better, so that the rest need no second look;
    /// after kTurnLooks of them, or half of the budget, the best one that had it.
    Rated& best(WorkBudget& budget) noexcept
    {
        for (;;) {
            const bool all_count = looks_ > 0 || !looked_;
            const auto worth = [all_count](const Rated& one) {
                // NOLINTNEXTLINE(bugprone-narrowing-conversions,cppcoreguidelines-narrowing-conversions): both float
                return all_count || one.seen_turning ? one.score : kNone;
            };
            Rated& best = *std::max_element(commands_.begin(), commands_.end(),
                                            [&](const Rated& a, const Rated& b) { return worth(a) < worth(b); });
            if (looks_ == 0 || best.seen_turning || !budget.spend(look_units())) {
                return best;
            }
            --looks_;
            looked_ = true;
            best.seen_turning = true;
            see_turning(best);
        }
    }

    /// How long a command is checked: it ends, and its stop too, where the height does.
    [[nodiscard]] Seconds check_of(const Vec3& command) const noexcept
    {
        return command.z() != 0.0F ? std::min(kChecked, left_.along(command) / std::abs(command.z()) - left_.stop)
                                   : kChecked;
    }

private:
    [[nodiscard]] std::uint32_t look_units() const noexcept
    {
        const auto turns = [](const Aircraft& other) { return !other.turning.empty(); };
        return units::kAircraftCommand *
               static_cast<std::uint32_t>(std::count_if(aircraft_.begin(), aircraft_.end(), turns));
    }

    void meet(Rated& one, const Aircraft& other, const Piece& piece) const noexcept
    {
        one.clear = std::min(one.clear, nearness_of(s_, one.command, left_, piece, other.clear));
        one.near_mid_air = std::min(one.near_mid_air, nearness_of(s_, one.command, left_, piece, other.near_mid_air));
    }

    void see_turning(Rated& one) const noexcept
    {
        for (const Aircraft& other : aircraft_) {
            Seconds from = 0.0F;
            for (const world::TurnPiece& piece : other.turning) {
                meet(one, other, {piece.position, piece.velocity, from, world::kTurnPiece});
                from += world::kTurnPiece;
            }
        }
        score(one);
    }

    void score(Rated& one) const noexcept
    {
        const float cruise = s_.limits.cruise_speed;
        one.score = score_of(one.clear, one.near_mid_air, (one.command - along_).norm() / cruise);
        if (previous_ != nullptr && (one.command - *previous_).norm() < kAlike * cruise) {
            one.score += kStay;
        }
    }

    const world::Situation& s_;
    const Vec3& along_;
    const Vec3* previous_;
    HeightLeft left_;
    AircraftList aircraft_;
    Commands commands_;
    std::uint32_t looks_ = 0;  ///< that are left
    bool looked_ = false;
};

}  // namespace

std::optional<float> choose_give_way(const world::Situation& s, const Vec3& along, const Vec3* previous,
                                     const Settings& settings, WorkBudget& budget, world::Manoeuvre& out) noexcept
{
    Comparison comparison(s, along, previous, budget);
    if (!comparison.rate(budget)) {
        return std::nullopt;
    }
    constexpr Seconds kStep = std::max(kPathStep, kChecked / static_cast<float>(kMaxPathPoints - 4));
    constexpr auto kPathUnits = units::kCommandStep * static_cast<std::uint32_t>(kChecked / kStep + 1.0F);
    for (int i = 0; i < kGiveWayTries; ++i) {
        Rated& best = comparison.best(budget);
        if (!budget.spend(kPathUnits)) {
            return std::nullopt;
        }
        const Seconds checked = comparison.check_of(best.command);
        out.kind = world::ManoeuvreKind::velocity;
        out.by = kGivesWay;
        out.start = s.now;
        out.valid_until = s.now + checked;
        out.command = best.command;
        out.side = Vec3::Zero();
        out.cost = 0.0F;
        path::predict_velocity_command(s.own, out.command, checked, kStep, s.limits, out.path);
        const float margin = check_manoeuvre(s, out, settings, budget).margin;
        if (margin >= 0.0F) {
            return margin;
        }
        best.score = kNone;
    }
    return std::nullopt;
}

}  // namespace jink::avoid
