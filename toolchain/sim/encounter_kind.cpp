// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/encounter_kind.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "toolchain/sim/built_up.hpp"
#include "toolchain/sim/random_scenario.hpp"
#include "toolchain/sim/uniform.hpp"

namespace jink::sim {
namespace {

constexpr double kPiece = 0.2;  ///< of a motion that is not straight [s]

double either_sign(Random& random) { return random.below(2) == 0 ? -1.0 : 1.0; }

/// When an intruder is nearest to the vehicle on its leg [s].
double meeting_time(const Scenario& s, const Threat& threat)
{
    const Vec gap = threat.position - s.start_position;
    const Vec closing = threat.velocity - s.start_velocity;
    return std::clamp(-gap.dot(closing) / closing.squaredNorm(), 1.0, 30.0);
}

/// `velocity(t)` in pieces, through the place where the threat is at `meets` while it flies straight on.
template <class Velocity>
void bend(Threat& threat, double meets, double until, Velocity&& velocity)
{
    const Vec at = threat.position + threat.velocity * meets;
    threat.velocity = velocity(0.5 * kPiece);
    threat.turns.clear();
    Vec last = threat.velocity;
    for (double t = kPiece; t < until; t += kPiece) {
        const Vec next = velocity(t + 0.5 * kPiece);
        if (next != last) {
            threat.turns.push_back({t, next});
        }
        last = next;
    }
    threat.position = Vec::Zero();
    threat.position = at - threat.position_at(meets);
}

/// Time passed since `from`, `lasts` at most [s].
double passed(double t, double from, double lasts) { return std::clamp(t - from, 0.0, lasts); }

void turn(Random& random, Threat& threat, double meets, double until)
{
    const double rate = either_sign(random) * uniform(random, 1.0, 6.0) * std::numbers::pi / 180.0;
    const double from = meets - uniform(random, 0.0, 10.0);
    const double lasts = uniform(random, 3.0, 15.0);
    const Vec velocity = threat.velocity;
    bend(threat, meets, until, [&](double t) {
        const double angle = rate * (passed(t, from, lasts) - passed(meets, from, lasts));
        return Vec(Eigen::AngleAxisd(angle, Vec::UnitZ()) * velocity);
    });
}

void climb(Random& random, Threat& threat, double meets, double until)
{
    const double change = either_sign(random) * uniform(random, 1.0, 4.0);  // at 1 m/s2
    const double from = meets + uniform(random, -5.0, 3.0);
    const double lasts = std::abs(change);
    const Vec velocity = threat.velocity;
    bend(threat, meets, until, [&](double t) {
        const double more = std::copysign(passed(t, from, lasts) - passed(meets, from, lasts), change);
        return Vec(velocity + more * Vec::UnitZ());
    });
}

void speed_up(Random& random, Threat& threat, double meets, double until)
{
    const double rate = either_sign(random) * uniform(random, 0.5, 2.0);
    const double from = meets + uniform(random, -6.0, 1.0);
    const double lasts = uniform(random, 1.0, 5.0);
    const double speed = threat.velocity.norm();
    const Vec direction = threat.velocity / speed;
    bend(threat, meets, until, [&](double t) {
        const double more = rate * (passed(t, from, lasts) - passed(meets, from, lasts));
        return Vec(std::max(0.0, speed + more) * direction);
    });
}

/// Between 15 and 90 m along the leg and 20 m to either side.
void add_pillars(Random& random, Scenario& s)
{
    constexpr int kPillars = 12;
    const Vec leg = s.mission[1] - s.mission[0];
    const Vec forward = Vec(leg.x(), leg.y(), 0.0).normalized();
    const Vec left(-forward.y(), forward.x(), 0.0);
    for (int i = 0; i < kPillars; ++i) {
        Threat pillar;
        pillar.name = "pillar_" + std::to_string(i + 1);
        pillar.radius = uniform(random, 0.5, 1.5);
        pillar.half_height = 15.0;
        const double along = uniform(random, 15.0, 90.0);
        pillar.position = s.mission[0] + along * forward + uniform(random, -20.0, 20.0) * left;
        pillar.sensed_by = SensedBy::scan;
        s.threats.push_back(pillar);
    }
}

}  // namespace

std::string_view to_string(EncounterKind kind) noexcept
{
    switch (kind) {
    case EncounterKind::turning: return "turning";
    case EncounterKind::climbing: return "climbing";
    case EncounterKind::speeding: return "speeding";
    case EncounterKind::seldom: return "seldom";
    case EncounterKind::drifting: return "drifting";
    case EncounterKind::windy: return "windy";
    case EncounterKind::cluttered: return "cluttered";
    case EncounterKind::late: return "late";
    case EncounterKind::built_up: return "built_up";
    case EncounterKind::open: break;
    }
    return "open";
}

Scenario encounter_of(EncounterKind kind, std::uint64_t seed)
{
    if (kind == EncounterKind::built_up) {
        return built_up_area(seed);
    }
    Scenario s = open_encounter(seed);
    if (kind == EncounterKind::open) {
        return s;
    }
    s.name = std::string(to_string(kind)) + "_" + std::to_string(seed);
    Random random(seed * 32452843U + static_cast<std::uint64_t>(kind));
    const auto each = [&](auto&& change) {
        for (Threat& threat : s.threats) {
            if (!threat.at_rest()) {
                change(random, threat, meeting_time(s, threat), s.duration);
            }
        }
    };
    switch (kind) {
    case EncounterKind::turning: each(turn); break;
    case EncounterKind::climbing: each(climb); break;
    case EncounterKind::speeding: each(speed_up); break;
    case EncounterKind::seldom: s.traffic.rate = 1.0; break;
    case EncounterKind::drifting:
        s.traffic.sigma_drift = 1.5;
        s.traffic.drift_time = 20.0;
        s.own.bias = 1.0;
        s.own.bias_vertical = 1.0;
        s.parameters["TRK_SIGMA_P"] = 1.6;
        break;
    case EncounterKind::windy: s.wind.at_20_ft = 8.0; break;
    case EncounterKind::cluttered: add_pillars(random, s); break;
    case EncounterKind::late:
        s.threats.resize(1);
        s.threats[0].appears_at = meeting_time(s, s.threats[0]) - uniform(random, 0.4, 1.6);
        break;
    case EncounterKind::built_up:
    case EncounterKind::open: break;
    }
    return s;
}

}  // namespace jink::sim
