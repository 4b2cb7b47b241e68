// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/common_stop.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/static_vector.hpp"
#include "core/base/work_units.hpp"
#include "core/path/prediction.hpp"
#include "core/world/separation.hpp"
#include "core/world/threat_set.hpp"

namespace jink::avoid {
namespace {

/// Chords of a stop, and all points: the beginning, up to three chords of the command, and one by rounding.
constexpr std::size_t kChords = 7;
constexpr std::size_t kMaxPoints = kChords + 5;
/// Halvings of the share.
constexpr int kHalvings = 3;
/// Where not even a stop is clear of a track, the vehicle gets out of its reach no faster than this [m/s].
constexpr float kLeaving = 0.3F;
constexpr float kTiny = 1e-3F;
/// Below zero margins are counted as they are, above they are all the same.
constexpr world::Cutoff kContactAlone{-world::kSeparationCap, 0.0F, {}};

/// A tick of set-points passes before anything changes.
Seconds latency_of(const world::Situation& s) noexcept { return std::max(s.rules.latency, path::kSetpointPeriod); }

/// Time to brake from a velocity at full deceleration, level and vertically by itself.
struct Braking {
    Seconds level;
    Seconds vertical;

    Braking(const Vec3& velocity, const vehicle::VehicleLimits& limits, float faster = 0.0F) noexcept
        : level((velocity.head<2>().norm() + faster) / limits.max_acceleration),
          vertical((std::abs(velocity.z()) + faster) / limits.max_vertical_acceleration)
    {
    }
    [[nodiscard]] Seconds longest() const noexcept { return std::max(level, vertical); }
};

/// Way over speed, `t` after braking began that takes `span`.
float braked(Seconds t, Seconds span) noexcept
{
    const Seconds b = std::min(t, span);
    return span > 0.0F ? b - 0.5F * b * b / span : 0.0F;
}

/// A cooperative track that flies on for the latency and stops then, and what else it may do.
class OtherStop {
public:
    /// `as_reported`: without what it may have changed since.
    [[gnu::cold, gnu::noinline]] OtherStop(const world::Situation& s, const world::Threat& track, Seconds ahead,
                                           bool as_reported = false) noexcept
        : begins_(latency_of(s) + ahead), velocity_(track.velocity), braking_(track.velocity, s.limits), threat_(track)
    {
        const float acceleration =
            std::max(world::unheard_acceleration(*track.track, s.limits, s.rules), s.limits.max_vertical_acceleration);
        const float speed = velocity_.norm();
        const float most = speed + std::max(speed, s.limits.cruise_speed);
        const Seconds unheard = as_reported ? 0.0F : std::max(s.now - track.track->stamp, 0.0F) + latency_of(s);
        const Seconds changes = std::min(unheard, most / acceleration);
        const float unknown = acceleration * changes;
        const float place = 0.5F * unknown * changes + unknown * (unheard - changes);
        threat_.velocity = Vec3::Zero();
        threat_.growth = {world::growth_of(s, *track.track).radius - world::doubt_of(s, *track.track).position + place,
                          0.0F, 0.0F};
        threat_.grows = true;
        threat_.doubted = true;
        threat_.doubt = unknown + s.rules.k_sigma * track.track->sigma_velocity;
        // Two stops from velocities that differ by d end no farther apart than d (v + d / 2) / a.
        threat_.doubt_ends = Braking(velocity_, s.limits, 0.5F * threat_.doubt).longest();
    }
    [[nodiscard]] Seconds ends() const noexcept { return begins_ + threat_.doubt_ends; }
    /// How far it has come at time `t` >= 0 [m].
    [[nodiscard]] Vec3 way(Seconds t) const noexcept
    {
        const Seconds on = std::min(t, begins_);
        const float level = on + braked(t - on, braking_.level);
        return {level * velocity_.x(), level * velocity_.y(), (on + braked(t - on, braking_.vertical)) * velocity_.z()};
    }
    /// And at most [m].
    [[nodiscard]] float reach() const noexcept { return velocity_.norm() * (begins_ + 0.5F * braking_.longest()); }
    /// In the frame that goes its way: what may be there of it, about where it is now.
    [[nodiscard]] const world::Threat& threat() const noexcept { return threat_; }

private:
    Seconds begins_;
    Vec3 velocity_;
    Braking braking_;
    world::Threat threat_;
};

/// The own flight: a command for the latency, then a stop. What follows is compiled for size: it is seldom needed.
struct OwnStop {
    StaticVector<path::PathPoint, kMaxPoints> points;
    float sagitta = 0.0F;  ///< greatest [m]
    float reach = 0.0F;    ///< distance from its beginning, at most [m]
};

class CommonStop {
public:
    CommonStop(const world::Situation& s, const Vec3& wanted, float fastest, bool evades, Seconds ahead,
               WorkBudget& budget) noexcept
        : s_(s), wanted_(wanted), wanted_evades_(evades), ahead_(ahead), latency_(latency_of(s) + ahead),
          most_(fastest < wanted.norm() ? fastest / wanted.norm() : 1.0F),
          tracks_(world::of_kind(s.threats, world::ThreatKind::track)), budget_(budget),
          acceleration_(std::max(s.limits.max_acceleration, s.limits.max_vertical_acceleration))
    {
        const float faster = acceleration_ * latency_;
        horizon_ = latency_ + std::max(Braking(s.own.velocity, s.limits, faster).longest(),
                                       vehicle::stopping_time(s.own.velocity.norm() + faster, s.limits));
    }

    /// Until the last one stands. False where there is no such track.
    [[nodiscard]] bool has_tracks() noexcept
    {
        bool any = false;
        static_cast<void>(budget_.spend(units::kStopLook));
        for (const world::Threat& track : tracks_) {
            if (counts(track)) {
                any = true;
                horizon_ = std::max(horizon_, OtherStop(s_, track, ahead_).ends());
            }
        }
        return any;
    }

    /// See stoppable_command.
    [[nodiscard, gnu::cold, gnu::noinline]] Vec3 command() noexcept
    {
        OwnStop own;
        float share = most_;
        fly(share * wanted_, own);
        for (const world::Threat& track : tracks_) {
            if (counts(track)) {
                share = share_for(track, share, own);
            }
        }
        if (share >= 1.0F) {
            return wanted_;
        }
        Vec3 command = share * wanted_;
        if (share <= 0.0F || !is_clear(command, own)) {
            command = evades(own) ? wanted_ : way_out(own);
        }
        fly(command, own);
        const float rest = margin_to_rest(own);
        if (rest < 0.0F) {
            fly(wanted_, own);
            command = margin_to_rest(own) >= rest && !budget_.exhausted() ? wanted_ : command;
        }
        return command;
    }

private:
    [[nodiscard]] static bool counts(const world::Threat& t) noexcept { return t.reciprocal && t.track != nullptr; }

    /// What follows without budget is contact.
    [[gnu::cold, gnu::noinline]] void fly(const Vec3& command, OwnStop& out) noexcept
    {
        static_cast<void>(budget_.spend(units::kStopFlight));
        path::Prediction flight;
        path::predict_velocity_command(s_.own, command, latency_, latency_, s_.limits, flight);
        out = {};
        const Seconds rest = horizon_ - latency_;
        path::extend_by_velocity_command(Vec3::Zero(), rest, rest / static_cast<float>(kChords), s_.limits, flight);
        for (const path::PathPoint& p : flight.path.points) {
            if (!out.points.try_push_back(p)) {
                budget_.exhaust();
            }
            out.reach = std::max(out.reach, (p.position - s_.own.position).norm());
        }
        for (const path::Sagitta& sagitta : flight.sagittas) {
            out.sagitta = std::max(out.sagitta, sagitta.any);
        }
    }

    /// Below 0 where the track may be met, whether it stops now or as late as the own vehicle.
    [[nodiscard, gnu::cold, gnu::noinline]] float margin_to(const world::Threat& track, const OwnStop& own) noexcept
    {
        const float margin = margin_to(track, own, ahead_);
        return ahead_ > 0.0F && margin >= 0.0F ? std::min(margin, margin_to(track, own, 0.0F)) : margin;
    }
    [[nodiscard, gnu::cold, gnu::noinline]] float margin_to(const world::Threat& track, const OwnStop& own,
                                                            Seconds ahead, bool as_reported = false) noexcept
    {
        if (!budget_.spend(units::kStopLook)) {
            return -world::kSeparationCap;
        }
        const OtherStop other(s_, track, ahead, as_reported);
        world::Threat threat = other.threat();
        const float far = (threat.position - s_.own.position).norm() - own.reach - own.sagitta - other.reach() -
                          s_.limits.half_extents.norm() - threat.half_height - threat.radius_at(horizon_);
        if (far > 0.0F) {
            return far;
        }
        auto points = own.points;
        float longest = 0.0F;
        for (path::PathPoint& p : points) {
            p.position -= other.way(p.time);
        }
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            const Seconds span = points[i + 1].time - points[i].time;
            points[i].velocity = (points[i + 1].position - points[i].position) / span;
            longest = std::max(longest, span);
        }
        // Both bend away from the chords.
        constexpr float kSagitta = 0.125F;
        threat.growth.radius += own.sagitta + kSagitta * acceleration_ * longest * longest;
        world::Situation alone = s_;
        alone.threats = {&threat, 1};
        return world::least_separation(alone, {points.data(), points.size()}, horizon_, budget_, s_.rules.escape,
                                       kContactAlone)
            .margin;
    }

    /// What one track leaves of a share; `own` flies it then, unless it is 0.
    [[nodiscard, gnu::cold, gnu::noinline]] float share_for(const world::Threat& track, float share,
                                                            OwnStop& own) noexcept
    {
        if (share > 0.0F && margin_to(track, own) >= 0.0F) {
            return share;
        }
        OwnStop attempt;
        fly(Vec3::Zero(), attempt);
        if (margin_to(track, attempt) < 0.0F) {
            const Vec3 apart = s_.own.position - track.position;
            away_ += apart / std::max(apart.squaredNorm(), kTiny);
            return 0.0F;
        }
        float low = 0.0F;
        float high = share;
        for (int i = 0; i < kHalvings && share > 0.0F; ++i) {
            const float half = 0.5F * (low + high);
            fly(half * wanted_, attempt);
            if (margin_to(track, attempt) >= 0.0F) {
                low = half;
                own = attempt;
            } else {
                high = half;
            }
        }
        return low;
    }

    /// Of all tracks but those that the command leads away from.
    [[nodiscard, gnu::cold, gnu::noinline]] bool is_clear(const Vec3& command, const OwnStop& own,
                                                          bool leaves = false) noexcept
    {
        return std::ranges::all_of(tracks_, [&](const world::Threat& track) noexcept {
            const bool left = leaves && command.dot(s_.own.position - track.position) > 0.0F;
            return !counts(track) || left || margin_to(track, own) >= 0.0F;
        });
    }

    /// Of a vehicle that moves, where control came too late, so that two meet although they stop as reported: whether
    /// what is wanted is clear of all tracks but those that not even a stop is clear of, and comes less near to these.
    [[nodiscard, gnu::cold, gnu::noinline]] bool evades(OwnStop& own) noexcept
    {
        if (!wanted_evades_ || s_.own.velocity.norm() <= 2.0F * kLeaving || !(away_.norm() > kTiny)) {
            return false;
        }
        OwnStop stop;
        fly(Vec3::Zero(), stop);
        fly(wanted_, own);
        bool is_late = false;
        const bool better = std::ranges::all_of(tracks_, [&](const world::Threat& track) noexcept {
            if (!counts(track)) {
                return true;
            }
            const float margin = margin_to(track, own);
            const float stopped = margin >= 0.0F && is_late ? margin : margin_to(track, stop);
            is_late = is_late || (stopped < 0.0F && margin_to(track, stop, 0.0F, true) < 0.0F);
            return margin >= 0.0F || margin > stopped;
        });
        return better && is_late && !budget_.exhausted();
    }

    /// A stop; or slowly out of the reach of the tracks that not even a stop is clear of.
    [[nodiscard]] Vec3 way_out(OwnStop& own) noexcept
    {
        const float length = away_.norm();
        if (s_.own.velocity.norm() > 2.0F * kLeaving || !(length > kTiny)) {
            return Vec3::Zero();
        }
        const Vec3 away = vehicle::clamped_velocity(away_, kLeaving, s_.limits);
        fly(away, own);
        return is_clear(away, own, true) && margin_to_rest(own) >= 0.0F ? away : Vec3::Zero();
    }

    /// To all that is no such track.
    [[nodiscard, gnu::cold, gnu::noinline]] float margin_to_rest(const OwnStop& own) noexcept
    {
        world::Situation rest = s_;
        rest.shared_horizon = 0.0F;
        return world::least_separation(rest, {own.points.data(), own.points.size()}, horizon_, budget_, s_.rules.escape,
                                       kContactAlone)
            .margin;
    }

    const world::Situation& s_;
    const Vec3& wanted_;
    bool wanted_evades_;
    Seconds ahead_;    ///< before the own vehicle stops, and perhaps the others
    Seconds latency_;  ///< and with the latency
    float most_;       ///< share of what is wanted, at most
    std::span<const world::Threat> tracks_;
    WorkBudget& budget_;
    float acceleration_;
    Seconds horizon_ = 0.0F;
    Vec3 away_ = Vec3::Zero();  ///< from the tracks that not even a stop is clear of, the nearer the more
};

}  // namespace

Vec3 stoppable_command(const world::Situation& s, const Vec3& wanted, float fastest, WorkBudget& budget, bool evades,
                       Seconds ahead) noexcept
{
    if (s.limits.kind != vehicle::VehicleKind::multirotor || s.threats.data() == nullptr || !is_finite(wanted) ||
        world::of_kind(s.threats, world::ThreatKind::track).empty()) {
        return wanted;
    }
    CommonStop stop(s, wanted, fastest, evades, ahead, budget);
    return stop.has_tracks() ? stop.command() : wanted;
}

}  // namespace jink::avoid
