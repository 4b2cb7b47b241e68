// SPDX-License-Identifier: BSD-3-Clause
#include "tests/replay/nominal_oracle.hpp"

#include <algorithm>
#include <cstdio>

namespace jink::replay_test {
namespace {

constexpr double kAhead = 3.0;        // [s]
constexpr double kAside = 3.0;        // [m]
constexpr double kSteady = 0.5;       // change of the true velocity over kAhead [m/s]
constexpr double kSteadyError = 2.0;  // [m/s]

double distance_from(const Vec& point, const Vec& from, const Vec& to)
{
    const Vec span = to - from;
    const double length2 = span.squaredNorm();
    const double s = length2 > 0.0 ? std::clamp((point - from).dot(span) / length2, 0.0, 1.0) : 0.0;
    return (point - (from + s * span)).norm();
}

std::string text(const char* what, double value, double after)
{
    char line[128];
    static_cast<void>(std::snprintf(line, sizeof line, "%s %.1f after %.0f s", what, value, after));
    return line;
}

}  // namespace

std::string contradiction(const Recording& recording, const sim::Belief& belief)
{
    if (!belief.nominal || !belief.position || belief.armed != true) {
        return "";
    }
    const bool changes = std::any_of(recording.changes.begin(), recording.changes.end(),
                                     [&](double t) { return t > belief.time - 1.5 && t < belief.time + kAhead; });
    const auto now = recording.truth_at(belief.time);
    const auto last = recording.truth_at(belief.time + kAhead);
    if (changes || !now || !last) {
        return "";
    }
    const sim::NominalBelief& nominal = *belief.nominal;
    if (nominal.turns) {
        return "";
    }
    const double look = nominal.is_route ? kAhead : 1.0;
    for (double after = 1.0; after <= look; after += 1.0) {
        const auto truth = recording.truth_at(belief.time + after);
        if (!truth) {
            return "";
        }
        const double aside = distance_from(truth->position, *belief.position, nominal.end);
        if (aside > kAside) {
            return text(nominal.is_route ? "route: metres beside it" : "motion: metres beside it", aside, after);
        }
    }
    const double speed = now->velocity.norm();
    if (nominal.is_route && speed > 1.3 * nominal.speed + 1.0) {
        return text("route: flown faster than believed, m/s", speed, 0.0);
    }
    const bool steady = (last->velocity - now->velocity).norm() < kSteady && now->velocity.head<2>().norm() > 1.0;
    if (nominal.is_route && steady && std::abs(speed - nominal.speed) > kSteadyError) {
        return text("route: flown at another speed, m/s", speed, 0.0);
    }
    return "";
}

}  // namespace jink::replay_test
