// SPDX-License-Identifier: BSD-3-Clause
// The generators against the regression anchors of the reach-set specification, section 16.4.
#include <gtest/gtest.h>

#include "toolchain/reach/generators.hpp"
#include "toolchain/reach/set.hpp"

namespace jink::reach::build {
namespace {

struct Anchor {
    const char* name;
    Constraint (*make)(const Settings&);
    std::uint8_t origin;
    std::size_t nodes, trajectories, cells;
    double smoothness;
    double tolerance;  ///< of nodes and trajectories, relative
};

Settings settings_for(DisplacementModel model, bool attitude = true)
{
    Settings settings;
    settings.model = model;
    settings.attitude_in_key = attitude;
    return settings;
}

constexpr auto kHarmonic9 = [](const Settings& s) { return harmonic(s, 9); };
constexpr auto kHarmonic1 = [](const Settings& s) { return harmonic(s, 1); };
constexpr auto kChaotic9 = [](const Settings& s) { return chaotic(s, 9, 3); };
constexpr auto kChaotic8 = [](const Settings& s) { return chaotic(s, 8, 3); };
constexpr auto kChaotic36 = [](const Settings& s) { return chaotic(s, 36, 3); };
template <std::uint8_t Planes, std::size_t Spread>
constexpr auto kAcas = [](const Settings& s) { return acas(s, Planes, Spread); };

void expect_anchor(const Anchor& a, const Settings& settings)
{
    const Metrics m = measure(kept(grow(settings, a.make(settings)), a.origin));
    const auto near = [&](std::size_t is, std::size_t should) {
        const auto s = static_cast<double>(should);
        EXPECT_NEAR(static_cast<double>(is), s, a.tolerance * s) << a.name;
    };
    near(m.nodes, a.nodes);
    near(m.trajectories, a.trajectories);
    near(m.cells, a.cells);
    EXPECT_NEAR(m.mean_smoothness, a.smoothness, a.tolerance == 0.0 ? 5.1e-4 : 0.02) << a.name;
    EXPECT_LE(m.most_entered, 4U) << a.name;
    EXPECT_LE(m.longest_footprint, 22U) << a.name;
}

/// Sets whose order no rounding decides: to the node.
TEST(ReachSetAnchors, HarmonicAndPlanesToTheNode)
{
    const Anchor arc[] = {
        {"harmonic 9", kHarmonic9, kFromHarmonic, 1667, 1011, 278, 0.405, 0.0},
        {"harmonic 1", kHarmonic1, kFromHarmonic, 235, 135, 120, 0.471, 0.0},
        {"H 9", kAcas<kHorizontal, 9>, kFromAcas, 305, 103, 58, 0.575, 0.0},
        {"V 9", kAcas<kVertical, 9>, kFromAcas, 231, 75, 46, 0.683, 0.0},
        {"HV 9", kAcas<kHorizontal | kVertical, 9>, kFromAcas, 509, 169, 94, 0.621, 0.0},
        {"Full 9", kAcas<kAllSeparations, 9>, kFromAcas, 1069, 397, 198, 0.588, 0.0},
        {"H", kAcas<kHorizontal, kNoLimit>, kFromAcas, 4259, 1933, 58, 0.397, 0.0},
        {"V", kAcas<kVertical, kNoLimit>, kFromAcas, 3250, 1446, 46, 0.413, 0.0},
        {"HV", kAcas<kHorizontal | kVertical, kNoLimit>, kFromAcas, 7498, 3378, 94, 0.404, 0.0},
        {"Full", kAcas<kAllSeparations, kNoLimit>, kFromAcas, 21262, 10338, 198, 0.385, 0.0},
    };
    for (const Anchor& a : arc) {
        expect_anchor(a, settings_for(DisplacementModel::arc));
    }
    const Anchor end_heading[] = {
        {"harmonic 9", kHarmonic9, kFromHarmonic, 2361, 1363, 304, 0.455, 0.0},
        {"harmonic 1", kHarmonic1, kFromHarmonic, 487, 261, 254, 0.304, 0.0},
        {"H 9", kAcas<kHorizontal, 9>, kFromAcas, 357, 117, 62, 0.609, 0.0},
        {"V 9", kAcas<kVertical, 9>, kFromAcas, 269, 87, 48, 0.660, 0.0},
        {"HV 9", kAcas<kHorizontal | kVertical, 9>, kFromAcas, 558, 185, 100, 0.653, 0.0},
        {"Full 9", kAcas<kAllSeparations, 9>, kFromAcas, 1169, 419, 212, 0.616, 0.0},
        {"H", kAcas<kHorizontal, kNoLimit>, kFromAcas, 9622, 4700, 62, 0.374, 0.0},
        {"V", kAcas<kVertical, kNoLimit>, kFromAcas, 6306, 3064, 48, 0.407, 0.0},
        {"HV", kAcas<kHorizontal | kVertical, kNoLimit>, kFromAcas, 15917, 7763, 100, 0.387, 0.0},
        {"Full", kAcas<kAllSeparations, kNoLimit>, kFromAcas, 48971, 25442, 212, 0.372, 0.0},
    };
    for (const Anchor& a : end_heading) {
        expect_anchor(a, settings_for(DisplacementModel::end_heading));
    }
}

/// Mirrored trajectories are equally far from mirrored walls: which one stays is a matter of rounding in the figures
/// of the specification, and of the older one here.
TEST(ReachSetAnchors, ChaoticWithinTheirTies)
{
    const Anchor arc[] = {
        {"chaotic 9/3", kChaotic9, kFromChaotic, 2500, 1830, 241, 0.106, 0.02},
        {"chaotic 8/3", kChaotic8, kFromChaotic, 2087, 1526, 231, 0.105, 0.02},
        {"chaotic 36/3", kChaotic36, kFromChaotic, 9176, 6728, 274, 0.079, 0.05},
    };
    for (const Anchor& a : arc) {
        expect_anchor(a, settings_for(DisplacementModel::arc));
    }
    const Anchor end_heading[] = {
        {"chaotic 9/3", kChaotic9, kFromChaotic, 3249, 2297, 296, 0.146, 0.09},
        {"chaotic 8/3", kChaotic8, kFromChaotic, 2675, 1871, 296, 0.131, 0.02},
        {"chaotic 36/3", kChaotic36, kFromChaotic, 16014, 11266, 304, 0.111, 0.02},
    };
    for (const Anchor& a : end_heading) {
        expect_anchor(a, settings_for(DisplacementModel::end_heading));
    }
}

/// With Gomola's key, the footprint alone, trees collapse.
TEST(ReachSetAnchors, FootprintAlone)
{
    const Settings arc = settings_for(DisplacementModel::arc, false);
    expect_anchor({"harmonic 9", kHarmonic9, kFromHarmonic, 309, 79, 126, 0.507, 0.0}, arc);
    expect_anchor({"chaotic 9/3", kChaotic9, kFromChaotic, 406, 129, 160, 0.056, 0.02}, arc);
    const Settings end_heading = settings_for(DisplacementModel::end_heading, false);
    expect_anchor({"harmonic 9", kHarmonic9, kFromHarmonic, 2087, 325, 292, 0.284, 0.0}, end_heading);
    const auto trajectories = [](const Settings& s, std::uint8_t planes) {
        return kept(grow(s, acas(s, planes, kNoLimit)), kFromAcas).trajectories();
    };
    EXPECT_EQ(trajectories(arc, kHorizontal), 3U);
    EXPECT_EQ(trajectories(arc, kHorizontal | kVertical), 5U);
    EXPECT_EQ(trajectories(arc, kAllSeparations), 9U);
    EXPECT_EQ(trajectories(end_heading, kHorizontal), 39U);
    EXPECT_EQ(trajectories(end_heading, kHorizontal | kVertical), 77U);
    EXPECT_EQ(trajectories(end_heading, kAllSeparations), 501U);
}

Set combined(const Settings& s, std::size_t chaotic_spread = 8, std::size_t harmonic_spread = 1)
{
    return merged(kept(grow(s, chaotic(s, chaotic_spread, 3)), kFromChaotic),
                  kept(grow(s, harmonic(s, harmonic_spread)), kFromHarmonic));
}

TEST(ReachSetAnchors, Combined)
{
    const Metrics arc = measure(combined(settings_for(DisplacementModel::arc)));
    EXPECT_NEAR(static_cast<double>(arc.nodes), 2313.0, 0.02 * 2313.0);
    EXPECT_NEAR(static_cast<double>(arc.trajectories), 1661.0, 0.02 * 1661.0);
    const Metrics end_heading = measure(combined(settings_for(DisplacementModel::end_heading)));
    EXPECT_NEAR(static_cast<double>(end_heading.nodes), 3139.0, 0.02 * 3139.0);
    EXPECT_NEAR(static_cast<double>(end_heading.trajectories), 2132.0, 0.02 * 2132.0);
}

Settings front_with_layers(std::size_t layers, DisplacementModel model)
{
    Settings s = settings_for(model);
    s.grid = Grid<double>(layers, 7, 5, static_cast<double>(layers), s.grid.horizontal(), s.grid.vertical());
    return s;
}

/// All trajectories on four layers, and the chaotic sets' share of the footprints.
TEST(ReachSetAnchors, FullTreeAndCoverage)
{
    const auto counts = [](const Metrics& m, std::size_t nodes, std::size_t trajectories, std::size_t footprints,
                           std::size_t cells) {
        EXPECT_EQ(m.nodes, nodes);
        EXPECT_EQ(m.trajectories, trajectories);
        EXPECT_EQ(m.footprints, footprints);
        EXPECT_EQ(m.cells, cells);
    };
    const Settings arc = front_with_layers(4, DisplacementModel::arc);
    counts(measure(full_set(arc)), 7221, 6401, 253, 68);
    counts(measure(full_set(front_with_layers(4, DisplacementModel::end_heading))), 6697, 5925, 1149, 94);
    const auto share = [&](std::size_t spread) {
        return static_cast<double>(measure(kept(grow(arc, chaotic(arc, spread, 3)), kFromChaotic)).footprints) / 253.0;
    };
    EXPECT_NEAR(share(9), 0.54, 0.005);
    EXPECT_NEAR(share(36), 0.96, 0.005);
    // Cells of the whole grid: the full tree enters 278 of 350.
    const Settings whole = settings_for(DisplacementModel::arc);
    const auto cells = [&](const Constraint& c) { return static_cast<double>(measure(kept(grow(whole, c), 0)).cells); };
    EXPECT_GE(cells(chaotic(whole, 9, 3)) / 278.0, 0.85);
    EXPECT_GE(cells(chaotic(whole, 36, 3)) / 278.0, 0.95);
    EXPECT_GE(cells(harmonic(whole, 9)) / 278.0, 0.95);
}

/// Best smoothness by end column of the greedy harmonic set of spread 36, to one decimal as the specification has it.
TEST(ReachSetAnchors, SmoothnessByColumn)
{
    const Settings s = settings_for(DisplacementModel::arc);
    const Set set = kept(grow(s, harmonic(s, 36)), kFromHarmonic);
    double best[7][5] = {};
    for (const Set::Member& member : set.members) {
        if (member.in_front) {
            double& b = best[member.node.end.column][member.node.end.row];
            b = std::max(b, member.node.smoothness());
        }
    }
    const double expected[4][5] = {
        {.40, .40, .40, .40, .40}, {.60, .70, .70, .70, .60}, {.50, .60, .70, .60, .50}, {.50, .70, 1.0, .70, .50}};
    for (int column = 0; column < 7; ++column) {
        for (int row = 0; row < 5; ++row) {
            EXPECT_NEAR(best[column][row], expected[column < 4 ? column : 6 - column][row], 0.005)
                << column << " " << row;
        }
    }
}

}  // namespace
}  // namespace jink::reach::build
