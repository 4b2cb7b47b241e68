// SPDX-License-Identifier: BSD-3-Clause
// The final check at the edges of its contract: times, the remaining flight, the stop at its end, horizon, escape rule,
// and cost.
#include <cmath>

#include <gtest/gtest.h>

#include "core/avoid/final_check.hpp"
#include "core/base/work_units.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;
using world::ThreatKind;
using world::test::kPlenty;

world::Separation checked(const Flight& f, const Manoeuvre& m, const Settings& settings = {},
                          Seconds horizon = kInfinity, const world::Cutoff& cutoff = {})
{
    WorkBudget budget(kPlenty);
    return check_manoeuvre(f.scene.situation(), m, settings, budget, horizon, cutoff);
}

/// A velocity that is flown for `span` since `ago` seconds.
Manoeuvre held(const Flight& f, const Vec3& command, Seconds span, Seconds ago = 0.0F)
{
    Manoeuvre m;
    m.kind = ManoeuvreKind::velocity;
    m.start = f.scene.now - ago;
    m.command = command;
    path::predict_velocity_command(f.scene.own, command, span, 0.2F, f.scene.limits, m.path);
    return m;
}

/// Distance to a stop [m]: at the limit down to the speed at which the lag asks for no more, then the lag's tail.
constexpr float stop_of(float speed, float limit, float lag)
{
    const float knee = limit * lag;
    return (speed * speed - knee * knee) / (2.0F * limit) + knee * lag;
}
constexpr float kStop = stop_of(5.0F, 5.0F, 0.25F);

TEST(FinalCheckOfTimes, WhatIsNotATimeIsContact)
{
    Flight f;
    for (const ManoeuvreKind kind :
         {ManoeuvreKind::follow_path, ManoeuvreKind::velocity, ManoeuvreKind::brake, ManoeuvreKind::hold_turn}) {
        Manoeuvre good = detour(f.scene.situation(), kLeft, 6.0F, 50.0F);
        good.kind = kind;
        good.command = Vec3(5, 0, 0);
        ASSERT_EQ(checked(f, good).margin, world::kSeparationCap);
        const std::size_t last = good.path.points.size() - 1;
        for (const std::size_t at : {std::size_t{0}, std::size_t{4}, last}) {
            for (const float bad : {kNan, kInfinity, -kInfinity}) {
                Manoeuvre m = good;
                m.path.points[at].time = bad;
                EXPECT_EQ(checked(f, m).margin, -world::kSeparationCap) << at << ' ' << bad;
            }
        }
    }
}

TEST(FinalCheckOfTimes, APathBeginsAtItsStartOrLater)
{
    Flight f;
    for (const ManoeuvreKind kind : {ManoeuvreKind::follow_path, ManoeuvreKind::velocity}) {
        Manoeuvre m = detour(f.scene.situation(), kLeft, 6.0F, 50.0F);
        m.kind = kind;
        for (path::PathPoint& p : m.path.points) {
            p.time -= 0.5F;
        }
        EXPECT_EQ(checked(f, m).margin, -world::kSeparationCap) << "half a second before its own start";
        for (path::PathPoint& p : m.path.points) {
            p.time += 1.0F;
        }
        EXPECT_EQ(checked(f, m).margin, world::kSeparationCap) << "half a second after it";
    }
}

TEST(FinalCheckOfTimes, AStartInTheFutureIsContact)
{
    Flight f;
    Manoeuvre m = detour(f.scene.situation(), kLeft, 6.0F, 50.0F);
    EXPECT_EQ(checked(f, m).margin, world::kSeparationCap);
    m.start.us += 1;
    EXPECT_EQ(checked(f, m).margin, -world::kSeparationCap);
}

TEST(FinalCheckOfTimes, WithoutAPointItIsContact)
{
    Flight f;
    for (const ManoeuvreKind kind : {ManoeuvreKind::follow_path, ManoeuvreKind::velocity, ManoeuvreKind::brake}) {
        Manoeuvre m;
        m.kind = kind;
        m.start = f.scene.now;
        EXPECT_EQ(checked(f, m).margin, -world::kSeparationCap);
    }
}

TEST(FinalCheckOfACommand, HoldsItForTheRestOfItsTimeAndStops)
{
    Flight f;
    f.scene.track(Vec3(40, 0, 30), Vec3::Zero(), 1.0F);
    const auto margin = [&](Seconds ago) { return checked(f, held(f, Vec3(5, 0, 0), 4.0F, ago)).margin; };
    // Box and sphere take 2 m of the 40.
    EXPECT_NEAR(margin(0.0F), 38.0F - 4.0F * 5.0F - kStop, 0.1F);
    EXPECT_NEAR(margin(3.0F), 38.0F - 1.0F * 5.0F - kStop, 0.1F);
    EXPECT_NEAR(margin(4.0F), 38.0F - kStop, 0.1F) << "nothing is left but the stop";
    EXPECT_NEAR(margin(9.0F), 38.0F - kStop, 0.1F) << "its end lies 5 s back";
}

TEST(FinalCheckOfAPath, ThatHasBeenFlownIsAStop)
{
    Flight f;
    f.scene.track(Vec3(40, 0, 30), Vec3::Zero(), 1.0F);
    Manoeuvre m = along(f.scene.situation(), {Vec3(0, 0, 30), Vec3(20, 0, 30)}, kLeft);
    m.start = f.scene.now - (m.path.duration() + 5.0F);
    EXPECT_NEAR(checked(f, m).margin, 38.0F - kStop, 0.1F);
}

/// A vertical stop takes longer than a level one: the check covers it.
TEST(FinalCheckOfAPath, TheStopLastsUntilTheVehicleStandsVertically)
{
    Flight f;
    f.scene.limits.max_vertical_acceleration = 1.0F;
    f.scene.own.velocity = Vec3(0, 0, -3);
    const Manoeuvre m = held(f, Vec3(0, 0, -3), 1.0F);
    const float stops = 3.0F + stop_of(3.0F, 1.0F, 0.25F);  // 7.5 m, and the box is a metre below
    f.scene.airspace.has_floor = true;
    f.scene.airspace.floor = 29.0F - stops - 0.15F;
    EXPECT_NEAR(checked(f, m).margin, 0.15F, 0.1F);
    f.scene.airspace.floor = 29.0F - stops + 1.0F;
    EXPECT_NEAR(checked(f, m).margin, -1.0F, 0.1F);
    EXPECT_EQ(checked(f, m).against.kind, ThreatKind::floor);
}

TEST(FinalCheckOfAPath, AFixedWingFliesOnAtItsEnd)
{
    Flight f;
    f.scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    const Manoeuvre m = held(f, Vec3(5, 0, 0), 2.0F);
    f.scene.track(Vec3(40, 0, 30), Vec3::Zero(), 1.0F);
    const Seconds stop = vehicle::stopping_time(5.0F, f.scene.limits);
    EXPECT_NEAR(checked(f, m).margin, 38.0F - 10.0F - 5.0F * stop, 0.1F);
}

TEST(FinalCheckOfAPath, LooksUntilTheHorizonAndNoFarther)
{
    Flight f;
    f.scene.track(Vec3(40, 0, 30), Vec3::Zero(), 1.0F);
    const Manoeuvre m = along(f.scene.situation(), {Vec3(0, 0, 30), Vec3(60, 0, 30)}, kLeft);
    EXPECT_LT(checked(f, m).margin, 0.0F);
    for (const Seconds horizon : {0.0F, 2.0F, 6.0F}) {
        EXPECT_NEAR(checked(f, m, {}, horizon).margin, 38.0F - 5.0F * horizon, 0.1F) << horizon;
    }
}

/// The margin to the bounds holds for any position of the vehicle within its uncertainty.
TEST(FinalCheckOfBounds, OwnUncertaintyAndBoxAreTakenOff)
{
    const auto margin = [](float sigma, auto set) {
        Flight f;
        f.scene.own.sigma_position = sigma;
        f.scene.limits.half_extents = Vec3(1.0F, 2.0F, 0.5F);
        set(f.scene.airspace);
        return checked(f, along(f.scene.situation(), {Vec3(0, 0, 30), Vec3(20, 0, 30)}, kLeft)).margin;
    };
    const auto floor = [](world::Airspace& a) { a.has_floor = true, a.floor = 25.0F; };
    const auto ceiling = [](world::Airspace& a) { a.has_ceiling = true, a.ceiling = 37.0F; };
    const auto keep_in = [](world::Airspace& a) {
        a.has_keep_in = true, a.home = Vec3(0, 30, 0), a.keep_in_radius = 60.0F;
    };
    EXPECT_NEAR(margin(0.0F, floor), 4.5F, 1e-3F);
    EXPECT_NEAR(margin(0.4F, floor), 4.5F - 1.2F, 1e-3F);
    EXPECT_NEAR(margin(0.0F, ceiling), 6.5F, 1e-3F);
    EXPECT_NEAR(margin(0.4F, ceiling), 6.5F - 1.2F, 1e-3F);
    EXPECT_NEAR(margin(0.0F, keep_in) - margin(0.4F, keep_in), 1.2F, 1e-3F);
    EXPECT_NEAR(margin(0.0F, keep_in), 60.0F - std::hypot(30.0F, 20.0F + kStop) - std::sqrt(5.0F), 0.1F);
}

/// A start inside a margin is judged by the escape rule of the settings.
TEST(FinalCheck, JudgesAStartInsideByTheEscapeRuleThatIsSet)
{
    Flight f;
    f.scene.own.velocity = Vec3(-1, 0, 0);
    f.scene.track(Vec3(3.5F, 0, 30), Vec3::Zero(), 3.0F);  // half a metre too near
    Manoeuvre m = held(f, Vec3(-1, 0, 0), 3.0F);
    Settings settings;
    EXPECT_GE(checked(f, m, settings).margin, 0.0F) << "leaves at twice the pace that is asked for";
    f.scene.rules.escape.speed = 3.0F;
    EXPECT_LT(checked(f, m, settings).margin, 0.0F) << "at a third of it";
    WorkBudget budget(kPlenty);
    EXPECT_LT(command_margin(f.scene.situation(), Vec3(-1, 0, 0), settings, budget), 0.0F);
    f.scene.rules.escape = {};
    EXPECT_GE(command_margin(f.scene.situation(), Vec3(-1, 0, 0), settings, budget), 0.0F);
}

/// Cooperative tracks count until the vehicle has stopped: time_to_stop, for a velocity alone.
TEST(FinalCheckOfACommand, TracksThatShareTheReactionCountUntilTheStop)
{
    Flight f;
    Settings settings;
    settings.reserve = 1.0F;
    const Seconds stop = vehicle::stopping_time(5.0F, f.scene.limits) + 1.0F;
    EXPECT_NEAR(time_to_stop(f.scene.situation(), settings), stop, 1e-5F);
    f.scene.track(Vec3(40, 0, 30), Vec3::Zero(), 1.0F).cooperative = true;
    const Manoeuvre m = held(f, Vec3(5, 0, 0), 8.0F);
    EXPECT_NEAR(checked(f, m, settings).margin, 38.0F - 5.0F * stop, 0.1F);
    f.scene.tracks[0].cooperative = false;
    EXPECT_LT(checked(f, m, settings).margin, 0.0F);
    f.scene.tracks[0].cooperative = true;
    const Manoeuvre path = along(f.scene.situation(), {Vec3(0, 0, 30), Vec3(60, 0, 30)}, kLeft);
    EXPECT_LT(checked(f, path, settings).margin, 0.0F) << "what is planned to its end is checked to its end";
    f.scene.own.velocity = Vec3(0, 0, 0);
    EXPECT_NEAR(time_to_stop(f.scene.situation(), settings), 1.0F, 1e-6F);
}

/// Margins saturate at the cut-off; smaller ones are reported below it.
TEST(FinalCheck, IsCutOffAsAsked)
{
    Flight f;
    f.scene.track(Vec3(40, 10, 30), Vec3::Zero(), 1.0F);
    const Manoeuvre m = along(f.scene.situation(), {Vec3(0, 0, 30), Vec3(60, 0, 30)}, kLeft);
    EXPECT_NEAR(checked(f, m).margin, 8.0F, 0.05F);
    EXPECT_EQ(checked(f, m, {}, kInfinity, {0.0F, 3.0F, {}}).margin, 3.0F);
    f.scene.track(Vec3(40, 0, 30), Vec3::Zero(), 1.0F);
    EXPECT_LT(checked(f, m, {}, kInfinity, {0.0F, 3.0F, {}}).margin, 0.0F);
}

// --- cost of a check: every set-point, every chord of the stop, every piece ---

std::uint32_t cost_of(const Flight& f, const Manoeuvre& m, const Settings& settings = {})
{
    WorkBudget budget(kPlenty);
    static_cast<void>(check_manoeuvre(f.scene.situation(), m, settings, budget));
    return budget.spent();
}

/// Chords of the stop from 5 m/s. It takes the stopping time, in steps of the prediction, one more is paid.
std::uint32_t stop_chords(const Flight& f, Seconds step)
{
    return static_cast<std::uint32_t>(std::ceil(vehicle::stopping_time(5.0F, f.scene.limits) / step));
}

TEST(FinalCheckCosts, OfAPathItsSetPointsItsStopAndItsPieces)
{
    Flight f;
    // 20 m at 5 m/s along the flight: 4 s, 80 set-points; chords of 1, 2 and then 4 of them.
    const Manoeuvre m = along(f.scene.situation(), {Vec3(0, 0, 30), Vec3(20, 0, 30)}, kLeft);
    const auto setpoints = static_cast<std::uint32_t>(std::ceil(m.path.duration() / path::kSetpointPeriod));
    const std::uint32_t chords = 2 + (setpoints - 3 + 3) / 4;
    const std::uint32_t stop = stop_chords(f, 0.2F);
    const std::uint32_t expected =
        setpoints * units::kFlightPart + (stop + 1) * units::kCommandStep + 1 + (chords + stop + 1) * units::kPathPiece;
    EXPECT_NEAR(static_cast<double>(cost_of(f, m)), static_cast<double>(expected),
                static_cast<double>(units::kPathPiece + units::kCommandStep));
    Settings fine;
    fine.prediction_step = 0.1F;
    EXPECT_GT(cost_of(f, m, fine), cost_of(f, m) + 30) << "twice as many chords";
}

/// However long, and however fine the steps: a flight never has more points than a path may have.
TEST(FinalCheckCosts, LongFlightsAreTakenInLongerChords)
{
    Flight f;
    Settings fine;
    fine.prediction_step = 0.02F;
    f.scene.track(Vec3(4000, 0, 30), Vec3::Zero(), 1.0F);
    for (const Seconds span : {1.0F, 20.0F, 60.0F}) {
        const Manoeuvre m = held(f, Vec3(5, 0, 0), span);
        EXPECT_EQ(checked(f, m, fine).margin, world::kSeparationCap) << span;
        const std::uint32_t least = units::kCommandStep * 50;
        EXPECT_GT(cost_of(f, m, fine), least);
        EXPECT_LT(cost_of(f, m, fine), 600U);
        WorkBudget budget(kPlenty);
        EXPECT_EQ(command_margin(f.scene.situation(), Vec3(5, 0, 0), span, fine, budget), world::kSeparationCap);
        EXPECT_LT(budget.spent(), units::kCommandStep * (kMaxPathPoints + 1) + units::kPathPiece * kMaxPathPoints + 60);
    }
}

/// A command: all its points cost work units while it lasts, and only its stop after its end.
TEST(FinalCheckCosts, OfACommandDependOnItsChords)
{
    Flight f;
    Settings coarse;
    coarse.prediction_step = 0.5F;
    const Manoeuvre m = held(f, Vec3(5, 0, 0), 4.0F);
    EXPECT_GE(cost_of(f, m), cost_of(f, m, coarse) + 11 * units::kPathPiece) << "20 chords, or 8";
    const std::uint32_t stop = stop_chords(f, 0.2F);
    EXPECT_LE(cost_of(f, held(f, Vec3(5, 0, 0), 4.0F, 4.0F)),
              (stop + 2) * (units::kCommandStep + units::kPathPiece) + 1);
}

float margin_within(const Flight& f, Seconds horizon, Seconds step, std::uint32_t& spent)
{
    Settings settings;
    settings.prediction_step = step;
    WorkBudget budget(kPlenty);
    const float margin = command_margin(f.scene.situation(), Vec3(5, 0, 0), horizon, settings, budget);
    spent = budget.spent();
    return margin;
}

/// For any horizon and step: the flight reaches exactly the horizon.
TEST(CommandMargin, ReachesTheHorizon)
{
    Flight f;
    f.scene.track(Vec3(330, 0, 30), Vec3::Zero(), 1.0F);
    f.scene.track(Vec3(5, 0, 30), Vec3::Zero(), 1.0F);
    std::uint32_t spent = 0;
    for (const Seconds step : {0.02F, 0.05F, 0.2F, 0.5F}) {
        for (const Seconds horizon : {0.03F, 0.05F, 0.1F, 0.149F, 0.15F, 0.19F, 0.2F, 0.3F, 0.31F, 0.45F, 0.6F}) {
            ASSERT_NEAR(margin_within(f, horizon, step, spent), 3.0F - 5.0F * horizon, 1e-3F) << horizon << ' ' << step;
        }
    }
    f.scene.tracks.pop_back();
    for (const Seconds step : {0.02F, 0.5F}) {
        for (const Seconds horizon : {57.0F, 60.0F, 64.0F}) {
            ASSERT_NEAR(margin_within(f, horizon, step, spent), 328.0F - 5.0F * horizon, 2e-2F)
                << horizon << ' ' << step;
        }
    }
}

TEST(CommandMargin, TakesAsManyChordsAsTheStepAsksFor)
{
    Flight f;
    std::uint32_t spent = 0;
    const auto expected = [](std::uint32_t steps, std::uint32_t points) {
        return steps * units::kCommandStep + 1 + points * units::kPathPiece;
    };
    static_cast<void>(margin_within(f, 4.0F, 0.2F, spent));
    EXPECT_EQ(spent, expected(20, 21));
    static_cast<void>(margin_within(f, 4.0F, 0.5F, spent));
    EXPECT_EQ(spent, expected(8, 9));
    static_cast<void>(margin_within(f, 1.0F, 0.5F, spent));
    EXPECT_EQ(spent, expected(2, 5)) << "the first two are short";
}

/// The fallback of a fixed wing: either turn in set-points, and chords of the prediction's step.
TEST(FallbackCosts, OfAFixedWingAreThoseOfTwoTurns)
{
    Flight f;
    f.scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    const auto cost = [&](Seconds horizon, Seconds step) {
        Settings settings;
        settings.fallback_horizon = horizon;
        settings.prediction_step = step;
        WorkBudget budget(kPlenty);
        const Situation s = f.scene.situation();
        EXPECT_EQ(choose_fallback(s, world::way_of(s), nullptr, settings, budget).margin, world::kSeparationCap);
        return budget.spent();
    };
    const auto expected = [](std::uint32_t setpoints, std::uint32_t points) {
        return 2 * (setpoints * units::kTurnStep + 1 + points * units::kPathPiece);
    };
    EXPECT_EQ(cost(4.0F, 0.2F), expected(80, 21));
    EXPECT_EQ(cost(4.0F, 0.5F), expected(80, 9));
    EXPECT_EQ(cost(3.3F, 0.2F), expected(66, 18)) << "the last chord is the shorter";
    EXPECT_EQ(cost(20.0F, 0.02F), expected(400, 59)) << "chords of 7 periods, so that they fit";
}

}  // namespace
}  // namespace jink::avoid
