// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/judge.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "toolchain/sim/mission_pilot.hpp"
#include "toolchain/sim/world.hpp"

namespace jink::sim {
namespace {

constexpr int kDirections = 240;
constexpr double kSpeeds[] = {1.0, 0.6, 0.3};
/// Look-ahead of the true motion for a conflict [s].
constexpr double kLookahead = 12.0;
/// Interval between conflict checks [us].
constexpr Micros kAskEvery = 50'000;
/// Step of the tried manoeuvres [s].
constexpr double kTrialStep = 0.01;
/// A separation below that of any flight [m].
constexpr double kNeverEnough = -1e8;

/// Bound on rounding errors of distances of kilometres [m].
constexpr double kRounding = 1e-6;

/// The greatest speed of a threat over all turns [m/s].
double most_speed(const Threat& threat)
{
    double most = threat.velocity.norm();
    for (const Turn& turn : threat.turns) {
        most = std::max(most, turn.velocity.norm());
    }
    return most;
}

/// A threat that counts in a trial.
struct Counted {
    const Threat* threat = nullptr;
    double in_step = 0.0;  ///< largest distance travelled in one step [m]
    double slack = 0.0;    ///< distance that both can travel before this threat could set a new minimum [m]
};

/// Least separation of the rest of the flight under `command(position)`, from `start` on, towards the threats selected
/// by `counts`. Ends early once the separation is below `enough`. A threat is checked again only when it could set a
/// new minimum; the result is unaffected.
template <class Command, class Counts>
double least_separation(const Scenario& scenario, Truth truth, double start, double horizon, double enough,
                        Command&& command, Counts&& counts)
{
    std::vector<Counted> counted;
    for (std::size_t k = 0; k < scenario.threats.size(); ++k) {
        if (counts(k)) {
            counted.push_back({&scenario.threats[k], most_speed(scenario.threats[k]) * kTrialStep, 0.0});
        }
    }
    double least = 1e9;
    const auto steps = static_cast<int>(horizon / kTrialStep);
    for (int i = 0; i < steps && least >= enough; ++i) {
        const Vec before = truth.position;
        const double t = start + i * kTrialStep;
        move(truth, command(before), scenario.vehicle, kTrialStep);
        if (scenario.floor && truth.position.z() < *scenario.floor) {
            return -1e9;
        }
        const double way = (truth.position - before).norm();
        for (Counted& c : counted) {
            c.slack -= way + c.in_step;
            if (c.slack > 0.0) {
                continue;
            }
            const Vec from = c.threat->position_at(t);
            const Vec to = c.threat->position_at(t + kTrialStep);
            least = std::min(least, nearest_in_step(*c.threat, from, to, before, truth.position).distance);
            c.slack = surface_distance(*c.threat, to, truth.position) - least - kRounding;
        }
    }
    return least;
}

bool conflict_in_sight(const Scenario& scenario, const World& world, const MissionPilot& mission)
{
    MissionPilot pilot = mission;
    const double least = least_separation(
        scenario, world.own(), world.seconds(), kLookahead, scenario.promise,
        [&](const Vec& position) { return pilot.command(position); },
        [&](std::size_t k) {
            return world.visible(k) && world.now() - world.appeared(k) >= to_micros(scenario.traffic.latency);
        });
    return least < scenario.promise;
}

/// Directions spread evenly over the sphere (Fibonacci lattice).
Vec direction(int i)
{
    const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double z = 1.0 - 2.0 * (i + 0.5) / kDirections;
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(golden * i), r * std::sin(golden * i), z};
}

}  // namespace

Verdict judge_from(const Scenario& scenario, const Truth& start, double at, double horizon, Trials trials)
{
    const double enough = trials == Trials::to_the_end ? kNeverEnough : scenario.promise;
    Verdict verdict;
    verdict.conflict = true;
    verdict.detected = at;
    verdict.best = -1e9;
    const auto attempt = [&](const Vec& command) {
        if (trials == Trials::until_kept && verdict.keep > 0) {
            return;
        }
        const double least = least_separation(
            scenario, start, at, horizon, enough, [&](const Vec&) { return command; },
            [](std::size_t) { return true; });
        ++verdict.tried;
        verdict.keep += least >= scenario.promise ? 1U : 0U;
        if (least > verdict.best && least >= enough) {
            verdict.best = least;
            verdict.best_command = command;
        }
    };
    attempt(Vec::Zero());
    for (const double share : kSpeeds) {
        for (int i = 0; i < kDirections; ++i) {
            attempt(along(direction(i), share * scenario.vehicle.cruise, scenario.vehicle));
        }
    }
    verdict.avoidable = verdict.keep > 0;
    return verdict;
}

Verdict judge(const Scenario& scenario, double horizon, Trials trials)
{
    World world(scenario);
    MissionPilot mission(scenario);
    while (world.now() < to_micros(scenario.duration)) {
        if (world.now() % kAskEvery == 0 && conflict_in_sight(scenario, world, mission)) {
            return judge_from(scenario, world.own(), world.seconds(), horizon, trials);
        }
        world.step(mission.command(world.own().position));
    }
    return {};
}

}  // namespace jink::sim
