// SPDX-License-Identifier: BSD-3-Clause
// Least separation of predicted flights, which deviate from their chords, and the cost of a check.
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/work_units.hpp"
#include "core/world/separation_parts.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

/// Along x at 1 m/s in chords of a second; the chord from `bent` on leaves its chord by `any`, and `vertical` up or
/// down.
path::Prediction bent_flight(std::size_t chords, std::size_t bent, float any, float vertical)
{
    path::Prediction flight;
    for (std::size_t i = 0; i <= chords; ++i) {
        const auto at = static_cast<float>(i);
        flight.path.points.unchecked_push_back({Vec3(at, 0, 0), Vec3(1, 0, 0), at});
        if (i < chords) {
            flight.sagittas.unchecked_push_back(i == bent ? path::Sagitta{any, vertical} : path::Sagitta{});
        }
    }
    return flight;
}

Separation flown(const Scene& scene, const path::Prediction& flight, const EscapeRule& escape = {},
                 const Cutoff& cutoff = {})
{
    WorkBudget budget(kPlenty);
    return least_separation(scene.situation(), flight, 100.0F, budget, escape, cutoff);
}

using Place = void (*)(Scene&);

/// Each 2 m from the box while it flies its fourth chord.
const std::pair<ThreatKind, Place> kBesideTheFourth[] = {
    {ThreatKind::track, [](Scene& s) { s.track(Vec3(3.5F, 4, 0), Vec3::Zero(), 1.0F); }},
    {ThreatKind::track,
     [](Scene& s) { s.track(Vec3(3.5F, 4.0F, 0), Vec3::Zero(), 1.0F).sigma_velocity = 1e-7F; }},  // in parts
    {ThreatKind::obstacle, [](Scene& s) { s.obstacle(geometry::make_sphere(Vec3(3.5F, 4, 0), 1.0F)); }},
    {ThreatKind::obstacle, [](Scene& s) { s.obstacle(geometry::make_box(Vec3(3.5F, 5, 0), Vec3(0.02F, 2, 0.02F))); }},
    {ThreatKind::cylinder, [](Scene& s) { s.cylinder(Vec2(3.5F, 4), 1.0F); }},
};

TEST(PredictedFlights, AreMetAsMuchEarlierAsTheyLeaveTheirChord)
{
    for (const auto& [kind, place] : kBesideTheFourth) {
        Scene scene;
        place(scene);
        const float tolerance = scene.obstacles.empty() ? 1e-3F : 0.06F;
        EXPECT_NEAR(flown(scene, bent_flight(20, 19, 0.0F, 0.0F)).margin, 2.0F, tolerance);
        EXPECT_EQ(flown(scene, bent_flight(20, 19, 0.0F, 0.0F)).against.kind, kind);
        EXPECT_NEAR(flown(scene, bent_flight(20, 3, 0.75F, 0.0F)).margin, 1.25F, tolerance) << static_cast<int>(kind);
        EXPECT_NEAR(flown(scene, bent_flight(20, 3, 3.0F, 0.0F)).margin, -1.0F, tolerance) << static_cast<int>(kind);
        // Elsewhere it does not count: the chord is half a metre off along the flight and more.
        EXPECT_GT(flown(scene, bent_flight(20, 12, 0.75F, 0.0F)).margin, 2.0F - tolerance) << static_cast<int>(kind);
    }
}

/// Another threat is nearly as near: a threat skipped because of it is certainly not nearer.
TEST(PredictedFlights, AreNotPassedOverBecauseOfAnotherThreat)
{
    for (const auto& [kind, place] : kBesideTheFourth) {
        Scene scene;
        if (kind == ThreatKind::track || kind == ThreatKind::cylinder) {
            scene.track(Vec3(12, 3.9F, 0), Vec3::Zero(), 1.0F);  // 1.9 m
            place(scene);
        } else {
            scene.obstacle(geometry::make_sphere(Vec3(12, 3.9F, 0), 1.0F));
            place(scene);
        }
        const float tolerance = kind == ThreatKind::obstacle ? 0.06F : 1e-3F;
        EXPECT_NEAR(flown(scene, bent_flight(20, 19, 0.0F, 0.0F)).margin, 1.9F, 1e-3F);
        EXPECT_NEAR(flown(scene, bent_flight(20, 3, 0.3F, 0.0F)).margin, 1.7F, tolerance) << static_cast<int>(kind);
        EXPECT_NEAR(flown(scene, bent_flight(20, 8, 0.3F, 0.0F)).margin, 1.9F, 1e-3F) << static_cast<int>(kind);
    }
}

/// Floor and ceiling count its vertical part alone, the keep-in radius all of it.
TEST(PredictedFlights, MeetFloorAndCeilingByTheirVerticalPart)
{
    const auto margin = [](auto set, std::size_t bent) {
        Scene scene;
        set(scene.airspace);
        return flown(scene, bent_flight(20, bent, 0.7F, 0.2F)).margin;
    };
    const auto floor = [](Airspace& a) { a.has_floor = true, a.floor = -3.0F; };
    const auto ceiling = [](Airspace& a) { a.has_ceiling = true, a.ceiling = 3.0F; };
    const auto keep_in = [](Airspace& a) { a.has_keep_in = true, a.keep_in_radius = 20.0F + std::sqrt(2.0F) + 2.0F; };
    EXPECT_NEAR(margin(floor, 3), 1.8F, 1e-5F);
    EXPECT_NEAR(margin(ceiling, 3), 1.8F, 1e-5F);
    EXPECT_NEAR(margin(keep_in, 19), 1.3F, 1e-4F);
    EXPECT_NEAR(margin(keep_in, 3), 2.0F, 1e-4F) << "not where it is far from it";
}

/// Cost of a flight far from everything, or near one of many threats.
std::uint32_t cost(const Scene& scene, const path::TimedPath& path, const EscapeRule& escape = {},
                   const Cutoff& cutoff = {})
{
    WorkBudget budget(kPlenty);
    static_cast<void>(least_separation(scene.situation(), path, 100.0F, budget, escape, cutoff));
    return budget.spent();
}

/// Eight pieces a second long, eastwards at 1 m/s.
path::TimedPath eastwards(int pieces = 8)
{
    std::vector<Vec3> positions;
    for (int i = 0; i <= pieces; ++i) {
        positions.push_back(Vec3(static_cast<float>(i), 0, 0));
    }
    return flight(positions, 1.0F);
}

/// In a chunk that may be near, only the near pieces cost a detailed check.
TEST(SeparationCosts, PiecesThatStayBeyondAreNotLookedAt)
{
    Scene scene;
    scene.track(Vec3(4, 3.0F, 0), Vec3::Zero(), 1.0F);  // 1 m from the pieces at its side
    const std::uint32_t base =
        1 + 9 * units::kPathPiece + units::kThreat + units::kThreatChunk + 8 * units::kThreatPiece;
    const std::uint32_t looks = (cost(scene, eastwards()) - base) / units::kSpherePart;
    EXPECT_EQ((cost(scene, eastwards()) - base) % units::kSpherePart, 0U);
    EXPECT_GE(looks, 2U);
    EXPECT_LT(looks, 8U) << "not those that are farther than the best";
    scene.tracks[0].max_acceleration = 1e-6F;  // grows: four parts of each piece
    const std::uint32_t parts = (cost(scene, eastwards()) - base) / units::kSpherePart;
    EXPECT_GE(parts, 2 * looks);
    EXPECT_LE(parts, 4 * looks);
    Scene solid;
    solid.obstacle(geometry::make_box(Vec3(4, 40, 0), Vec3::Ones()));
    const std::uint32_t far = cost(solid, eastwards());
    solid.obstacle(geometry::make_sphere(Vec3(7.5F, 2.2F, 0), 1.0F));
    solid.obstacle(geometry::make_box(Vec3(0.2F, 3.5F, 0), Vec3(0.1F, 1, 1)));
    Scene first = solid;
    std::swap(first.obstacles[1], first.obstacles[2]);
    EXPECT_GT(cost(solid, eastwards()), far);
    EXPECT_LT(cost(solid, eastwards()), cost(first, eastwards())) << "the nearer one first spares looks at the solid";
}

/// Each set bound is checked for each point.
TEST(SeparationCosts, EachBoundOfTheAirspaceIsPaidFor)
{
    const std::uint32_t none = cost(Scene(), eastwards());
    for (bool Airspace::*bound : {&Airspace::has_floor, &Airspace::has_ceiling, &Airspace::has_keep_in}) {
        Scene scene;
        scene.airspace.*bound = true;
        EXPECT_EQ(cost(scene, eastwards()), none + 9 * units::kBoundPiece);
    }
}

/// A solid is checked once per piece; in parts only while the flight escapes from it.
TEST(SeparationCosts, ASolidIsLookedAtInPartsOnlyDuringAnEscape)
{
    Scene scene;
    scene.obstacle(geometry::make_box(Vec3(0.5F, 4.5F, 0), Vec3(3, 3, 3)));  // half a metre beside the box
    const path::TimedPath one = flight({Vec3::Zero(), Vec3(1, 0, 0)}, 1.0F);
    const std::uint32_t clear = cost(scene, one);
    scene.obstacles[0].shape = geometry::make_box(Vec3(0.5F, 3.8F, 0), Vec3(3, 3, 3));  // inside by 0.2 m
    const path::TimedPath out = flight({Vec3::Zero(), Vec3(0, -1, 0)}, 1.0F);
    EXPECT_GE(separation(scene, out).margin, 0.0F);
    EXPECT_GT(cost(scene, out), clear + 3 * units::kSolidQuery);
    scene.obstacles[0].shape = geometry::make_box(Vec3(0.5F, 4.5F, 0), Vec3(3, 3, 3));
    EXPECT_LT(cost(scene, one), cost(scene, flight({Vec3::Zero(), Vec3(0.5F, 0, 0), Vec3(1, 0, 0)}, 0.5F)))
        << "two pieces are two looks";
}

/// While a shrunk surface grows back: pieces in which it takes half the slack, but no shorter than 20 ms.
TEST(SeparationCosts, AnEscapeIsLookedAtInPiecesOfItsSlack)
{
    Scene scene;
    scene.track(Vec3(3.5F, 0, 0), Vec3::Zero(), 3.0F);  // half a metre inside
    const path::TimedPath out = flight({Vec3::Zero(), Vec3(-1, 0, 0)}, 1.0F);
    const std::uint32_t base = 1 + 2 * units::kPathPiece + units::kThreat + units::kThreatChunk + units::kThreatPiece;
    const auto parts = [&](float slack, float speed) {
        return (cost(scene, out, {slack, speed}) - base) / units::kSpherePart;
    };
    EXPECT_EQ(parts(0.05F, 0.5F), 20U) << "0.05 s each";
    EXPECT_EQ(parts(0.1F, 0.5F), 10U);
    EXPECT_EQ(parts(0.0F, 0.5F), 50U) << "no shorter than 0.02 s";
    EXPECT_EQ(parts(0.05F, 0.0F), 1U) << "what does not grow back needs no parts";
    scene.tracks[0].max_acceleration = 1e-6F;
    EXPECT_EQ(parts(0.4F, 0.5F), 4U) << "but growth does: a quarter of a second";
}

/// Threats after one below the cut-off cost nothing; the named threat is checked first.
TEST(SeparationCosts, ACutOffEndsTheLook)
{
    Scene scene;
    for (int i = 0; i < 10; ++i) {
        scene.track(Vec3(4, 5.0F + static_cast<float>(i), 0), Vec3::Zero(), 1.0F);
    }
    scene.tracks[7].position = Vec3(4, 0, 0);
    const path::TimedPath path = eastwards();
    const std::uint32_t whole = cost(scene, path);
    Scene alone;
    alone.tracks = {scene.tracks[7]};
    const std::uint32_t one = cost(alone, path);
    EXPECT_EQ(cost(scene, path, {}, {0.0F, kSeparationCap, {ThreatKind::track, 7}}), one);
    EXPECT_GT(cost(scene, path, {}, {0.0F, kSeparationCap, {ThreatKind::obstacle, 7}}), one) << "no such obstacle";
    EXPECT_GT(cost(scene, path, {}, {0.0F, kSeparationCap, {}}), one);
    const std::uint32_t until = cost(scene, path, {}, {0.0F, kSeparationCap, {ThreatKind::track, 10}});
    EXPECT_EQ(until, cost(scene, path, {}, {0.0F, kSeparationCap, {}})) << "no such track";
    EXPECT_LT(until, whole);
    scene.cylinder(Vec2(4, 30), 1.0F);
    scene.obstacle(geometry::make_box(Vec3(4, 3, 0), Vec3::Ones()));
    EXPECT_EQ(cost(scene, path, {}, {0.0F, kSeparationCap, {ThreatKind::track, 7}}), one) << "nor any other kind";
    EXPECT_GT(cost(scene, path, {}, {-5.0F, kSeparationCap, {ThreatKind::track, 7}}), one) << "not below that";
    // Named as first and checked once.
    Scene two;
    two.track(Vec3(4, 9, 0), Vec3::Zero(), 1.0F);
    EXPECT_EQ(cost(two, path, {}, {-kSeparationCap, kSeparationCap, {ThreatKind::track, 0}}), cost(two, path));
}

/// For any first threat, all others are checked too.
TEST(Cutoffs, AnyTrackMayBeTheFirstAndAllCount)
{
    Scene scene;
    scene.track(Vec3(4, 9, 0), Vec3::Zero(), 1.0F);
    scene.track(Vec3(4, 0, 0), Vec3::Zero(), 1.0F);
    scene.track(Vec3(4, -6, 0), Vec3::Zero(), 1.0F);
    for (const ThreatKind kind : {ThreatKind::none, ThreatKind::track, ThreatKind::obstacle}) {
        for (std::uint16_t first = 0; first < 4; ++first) {
            WorkBudget budget(kPlenty);
            const Separation found = least_separation(scene.situation(), eastwards(), 100.0F, budget, {},
                                                      {-kSeparationCap, kSeparationCap, {kind, first}});
            EXPECT_NEAR(found.margin, -1.0F, 1e-4F) << first;
            EXPECT_EQ(found.against, (ThreatRef{ThreatKind::track, 1})) << first;
        }
    }
}

/// Cooperative tracks until the shared horizon, all others to the end.
TEST(SharedHorizon, BoundsTracksThatShareTheReactionAlone)
{
    Scene scene;
    scene.track(Vec3(20, 0, 0), Vec3(-1, 0, 0), 1.0F).cooperative = true;
    const auto margin = [&](Seconds shared, Seconds horizon) {
        scene.shared_horizon = shared;
        WorkBudget budget(kPlenty);
        return least_separation(scene.situation(), eastwards(), horizon, budget).margin;
    };
    EXPECT_NEAR(margin(kInfinity, kInfinity), 18.0F - 16.0F, 1e-3F);
    EXPECT_NEAR(margin(3.0F, kInfinity), 18.0F - 6.0F, 1e-3F);
    EXPECT_NEAR(margin(3.0F, 3.0F), 18.0F - 6.0F, 1e-3F);
    EXPECT_NEAR(margin(3.0F, 2.0F), 18.0F - 4.0F, 1e-3F) << "never beyond the horizon";
    EXPECT_NEAR(margin(0.0F, kInfinity), 18.0F, 1e-3F);
    scene.tracks[0].cooperative = false;
    EXPECT_NEAR(margin(3.0F, kInfinity), 18.0F - 16.0F, 1e-3F);
    scene.track(Vec3(0, 6, 0), Vec3::Zero(), 1.0F).cooperative = true;
    EXPECT_NEAR(margin(3.0F, kInfinity), 2.0F, 1e-3F);
    scene.tracks[1].position = Vec3(7, 4, 0);
    EXPECT_NEAR(margin(3.0F, kInfinity), 2.0F, 1e-3F) << "the other one still counts to the end";
}

/// A static flight, one with a point at the horizon, and one of many chunks.
TEST(FlightPieces, AreThoseBeforeTheHorizon)
{
    const path::TimedPath path = eastwards(20);
    const auto pieces = [&](Seconds horizon) {
        return detail::Flight({path.points.data(), path.points.size()}, {}, horizon);
    };
    EXPECT_EQ(pieces(5.0F).size(), 5U) << "none begins at the horizon";
    EXPECT_EQ(pieces(5.5F).size(), 6U);
    EXPECT_EQ(pieces(5.5F).piece(5).duration, 0.5F);
    EXPECT_EQ(pieces(100.0F).size(), 20U);
    ASSERT_EQ(pieces(100.0F).chunks().size(), 3U);
    EXPECT_EQ(pieces(100.0F).chunks()[2].last, 20U);
    EXPECT_EQ(pieces(100.0F).chunks()[2].low, Vec3(16, 0, 0));
    EXPECT_EQ(pieces(100.0F).chunks()[2].high, Vec3(20, 0, 0));
    EXPECT_EQ(pieces(100.0F).chunks()[1].end, 16.0F);
    const detail::Flight standing = pieces(0.0F);
    EXPECT_EQ(standing.size(), 1U);
    EXPECT_EQ(standing.piece(0).velocity, Vec3(0, 0, 0));
    EXPECT_EQ(standing.piece(0).duration, 0.0F);
    EXPECT_EQ(standing.chunks()[0].high, Vec3(0, 0, 0));
    const path::TimedPath back = flight({Vec3(0, 0, 0), Vec3(-3, 5, 1), Vec3(2, -2, 4)}, 1.0F);
    const detail::Flight turned({back.points.data(), back.points.size()}, {}, 10.0F);
    EXPECT_LT((turned.chunks()[0].low - Vec3(-3, -2, 0)).norm(), 1e-5F);
    EXPECT_LT((turned.chunks()[0].high - Vec3(2, 5, 4)).norm(), 1e-5F);
}

/// A margin of exactly 0 at the start is a start outside: no credit to go in.
TEST(StartsExactlyOutside, HaveNoCredit)
{
    const std::pair<ThreatKind, Place> places[] = {
        {ThreatKind::track, [](Scene& s) { s.track(Vec3(4, 0, 0), Vec3::Zero(), 3.0F); }},
        {ThreatKind::floor, [](Scene& s) { s.airspace.has_floor = true, s.airspace.floor = -1.0F; }},
    };
    for (const auto& [kind, place] : places) {
        Scene scene;
        place(scene);
        const Vec3 in = kind == ThreatKind::floor ? Vec3(0, 0, -0.04F) : Vec3(0.04F, 0, 0);
        EXPECT_EQ(separation(scene, flight({Vec3::Zero(), Vec3::Zero()}, 1.0F)).margin, 0.0F);
        EXPECT_NEAR(separation(scene, flight({Vec3::Zero(), in}, 0.01F)).margin, -0.04F, 1e-5F);
    }
}

}  // namespace
}  // namespace jink::world
