// SPDX-License-Identifier: BSD-3-Clause
// Refusals of a problem file, and their texts.
#include <gtest/gtest.h>

#include "tests/host/problem_text.hpp"

namespace {

using namespace jink;
using files::Complaints;
using test::complaints_of;
using test::kBend;
using test::kHead;
using test::kThreat;
using test::with;

TEST(ProblemFile, EveryComplaint)
{
    const std::string two =
        "threats:\n  - {position: [20, 0, 20], radius: 1}\n  - {position: [25, 0, 20], radius: 1}\n";
    std::string crowd = "threats:\n";
    for (std::size_t i = 0; i <= kMaxTracks; ++i) {
        crowd += "  - {position: [20, 0, 20], radius: 1}\n";
    }
    std::string stones = "obstacles:\n";
    for (std::size_t i = 0; i <= kMaxObstacles; ++i) {
        stones += "  - {sphere: {centre: [20, 0, 20], radius: 1}}\n";
    }
    const auto obstacle = [](const std::string& what) { return kHead + kThreat + "obstacles: [" + what + "]\n"; };
    const auto setting = [](const std::string& what) { return kHead + kThreat + "settings: {" + what + "}\n"; };
    const struct {
        std::string text;
        std::string complaint;
    } cases[] = {
        {kThreat, "missing key 'vehicle'"},
        {"vehicle: uva2\n" + kHead.substr(17) + kThreat, "did you mean 'uav2'?"},
        {"vehicle: default\n" + kThreat, "missing key 'start'"},
        {"vehicle: default\n" + kThreat, "missing key 'direction'"},
        {"vehicle: default\n" + kThreat, "missing key 'distance'"},
        {kHead + kThreat + "distance: 3\n", "distance: does not go with `leg`"},
        {"vehicle: default\nleg: {start: [1, 1, 1], end: [1, 1, 1]}\n" + kThreat, "leg: has no length"},
        {"vehicle: default\nleg: {start: [1, 1, 1]}\n" + kThreat, "missing key 'leg.end'"},
        {"vehicle: default\nstart: [0, 0, 0]\ndirection: [0, 0, 0]\ndistance: 5\n" + kThreat,
         "direction: has no length"},
        {"vehicle: default\nleg: {start: [0, 0, 20], end: [-60, 0, 20]}\n" + kThreat,
         "nearest on it, but at or before its start"},
        {"vehicle: default\nleg: {start: [0, 0, 20], end: [5, 0, 20]}\n" + kThreat,
         "nearest on it, but beyond its end"},
        {kHead + "threats: [{position: [20, 0, 20], velocity: [5, 0, 0], radius: 1}]\n",
         "nearest on it, but at or before its start"},
        {kBend + "leg: {start: [0, 0, 20], end: [60, 0, 20]}\n" + kThreat, "reference: does not go with `leg`"},
        {kBend + "distance: 3\n" + kThreat, "distance: does not go with `reference`"},
        {"vehicle: default\nreference: {start: [0, 0, 20], segments: []}\n" + kThreat, "reference: has no segments"},
        {"vehicle: default\nreference: {start: [0, 0, 20], segments: [{to: [0, 0, 20]}]}\n" + kThreat,
         "reference.segments[0].to: has no length"},
        {"vehicle: default\nreference: {start: [0, 0, 20], segments: [{centre: [0, 5, 21], turn: 90}]}\n" + kThreat,
         "reference.segments[0].centre: is no arc"},
        {"vehicle: default\nreference: {start: [0, 0, 20], segments: [{centre: [0, 5, 20], to: [1, 1, 1], turn: "
         "9}]}\n" +
             kThreat,
         "reference.segments[0].to: does not go with `centre`"},
        {"vehicle: default\nreference: {start: [0, 0, 20], segments: [{to: [9, 0, 20]}, {to: [9, 9, 20]}, {to: [0, 9, "
         "20]}, {to: [0, 20, 20]}, {to: [0, 40, 20]}]}\n" +
             kThreat,
         "reference: segments are more than 4"},
        {"vehicle: default\nreference: {start: [0, 0, 20], segments: [{to: [9, 0, 20]}]}\n"
         "threats: [{position: [20, 1, 20], radius: 1}]\n",
         "reference: the main threat is not nearest on it"},
        {kHead + kThreat + "frame_y: [1, 0, 0]\n", "frame_y: lies along the way"},
        {kHead, "no threat and no obstacle"},
        {kHead + two, "exactly one threat or obstacle must say `main: true`, not 0"},
        {kHead + "threats: [{position: [20, 0, 20], radius: 1, main: true}]\nobstacles: [{main: true, sphere: {centre: "
                 "[9, 9, 9], radius: 1}}]\n",
         "must say `main: true`, not 2"},
        {kHead + crowd, "threats: " + std::to_string(kMaxTracks + 1) + " are more than " + std::to_string(kMaxTracks)},
        {kHead + kThreat + stones, "obstacles: 97 are more than 96"},
        {kHead + "threats: [{position: [20, 0], radius: 1}]\n", "threats[0].position: three numbers are wanted, not 2"},
        {kHead + "threats: [{position: [20, 0, .inf], radius: 1}]\n", "threats[0].position[2]: '.inf' is not finite"},
        {kHead + "threats: [{position: [20, 0, 20], radius: 0}]\n",
         "threats[0].radius: '0' is out of range: 0.01 to 1000"},
        {kHead + "threats: [{position: [20, 0, 20]}]\n", "missing key 'threats[0].radius'"},
        {kHead + "threats: [{position: [20, 0, 20], radius: 1, main: yes}]\n",
         "threats[0].main: true or false is wanted"},
        {kHead + "threats: [{position: [20, 0, 20], radius: 1, raduis: 1}]\n",
         "unknown key 'threats[0].raduis'; did you mean 'radius'?"},
        {kHead + "threats: {position: [20, 0, 20]}\n", "threats: a list is wanted, not a mapping"},
        {kHead + "threats: [far]\n", "threats[0]: a mapping of keys to values is wanted"},
        {obstacle("{}"), "obstacles[0]: exactly one of sphere, box, capsule, cylinder, hull is wanted"},
        {obstacle("{cone: {}}"), "unknown key 'obstacles[0].cone'"},
        {obstacle("{sphere: {centre: [1, 1, 1], radius: 1}, box: {centre: [1, 1, 1], half_extents: [1, 1, 1]}}"),
         "exactly one of sphere"},
        {obstacle("{sphere: {centre: [1, 1, 1]}}"), "missing key 'obstacles[0].sphere.radius'"},
        {obstacle("{capsule: {from: [1, 1, 1], to: [1, 1, 1], radius: 1}}"), "obstacles[0].capsule.to: lies on `from`"},
        {obstacle("{hull: {vertices: [[0, 0, 0]]}}"), "obstacles[0].hull.vertices: 4 to 64 are wanted, not 1"},
        {obstacle("{hull: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], 7]}}"),
         "vertices[3]: a list of three numbers is wanted"},
        {obstacle("{box: {centre: [1, 1, 1], half_extents: [1, -1, 1]}}"), "half_extents[1]: '-1' is out of range"},
        {obstacle("{box: 3}"), "obstacles[0].box: a mapping of keys to values is wanted"},
        {obstacle("nothing"), "obstacles[0]: a mapping of keys to values is wanted"},
        {kHead + kThreat + "airspace: {floor: 20, ceiling: 21}\n",
         "airspace: the own box does not fit between floor and ceiling"},
        {kHead + kThreat + "airspace: {keep_in: {home: [0, 0, 0]}}\n", "missing key 'airspace.keep_in.radius'"},
        {kHead + kThreat + "k_sigma: 7\n", "k_sigma: '7' is out of range: 0 to 6"},
        {kHead + kThreat + "flown_side: [0, 2, 0]\n", "flown_side[1]: '2' is out of range: -1 to 1"},
        {kHead + kThreat + "collision_box_side: 0\n", "collision_box_side: '0' is out of range"},
        {setting("l: 5"), "settings.l: must be even"},
        {setting("l: 66"), "settings.l: '66' is out of range: 2 to 64"},
        {setting("n: 1.5"), "settings.n: '1.5' is not a whole number"},
        {setting("l: 64, n: 31"), "4096 candidates, l (n + 1) for each kind, are more than 512"},
        {setting("waypoints: 7"), "settings.waypoints: '7' is out of range: 8 to 64"},
        {setting("kinds: [simple, round]"),
         "settings.kinds: 'round' is none of: simple, symmetric, smooth, plateau, wait"},
        {setting("kinds: []"), "settings.kinds: at least one of simple, symmetric, smooth, plateau, wait is wanted"},
        {setting("kinds: all"), "settings.kinds: 'all' is none of: simple, symmetric, smooth, plateau, wait, both"},
        {setting("kinds: {a: 1}"), "settings.kinds: a list is wanted, not a mapping"},
        {setting("weights: {k_S: 0.3, k_T: 0.2, k_C: 0.6}"),
         "settings.weights: k_S + k_T + k_C + k_A + k_B must be 1, not 1.1"},
        {setting("weights: {k_S: 0.3, k_T: 0.2}"), "missing key 'settings.weights.k_C'"},
        {setting("weights: {k_S: 0.1, k_T: 0.1, k_C: 0.8}"), "settings.weights.k_C: '0.8' is out of range: 0 to 0.7"},
        {setting("weights: {k_S: 0.35, k_T: 0.05, k_C: 0.6}"),
         "settings.weights.k_T: '0.05' is out of range: 0.1 to 1"},
        {setting("security: quantum"), "settings.security: 'quantum' is none of: time-aware, swept"},
        {setting("offset_rule: x"), "settings.offset_rule: 'x' is none of: clearing, source"},
        {setting("smoothness: x"), "settings.smoothness: 'x' is none of: curvature, deviation, second-derivative"},
        {setting("closeness: x"), "settings.closeness: 'x' is none of: time-aware, swept"},
        {setting("preset: x"), "settings.preset: 'x' is none of: default, source"},
        {setting("max_cost: 0"), "settings.max_cost: '0' is out of range"},
        {setting("k_q: 1"), "unknown key 'settings.k_q'; did you mean 'k_p'?"},
        {kHead + kThreat + "threads: 3\n", "unknown key 'threads'; did you mean 'threats'?"},
        {kHead + kThreat + "title: [a]\n", "title: text is wanted, not a list"},
    };
    for (const auto& c : cases) {
        const Complaints complaints = complaints_of(c.text);
        EXPECT_NE(with(complaints, c.complaint), nullptr) << "wanted: " << c.complaint << "\n"
                                                          << c.text << test::all_of(complaints);
    }
}

TEST(ProblemFile, NamesEverythingThatIsWrongInOrderOfLines)
{
    const Complaints complaints = complaints_of("vehicle: default\n"
                                                "leg: {start: [0, 0, 20], end: [60, 0], sped: 5}\n"
                                                "threats:\n"
                                                "  - {position: [.nan, 0, 20], radius: -1}\n"
                                                "settings: {l: 5}\n");
    ASSERT_EQ(complaints.size(), 5U) << test::all_of(complaints);
    const std::size_t lines[] = {2, 2, 4, 4, 5};
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(complaints[i].line, lines[i]) << test::all_of(complaints);
    }
}

}  // namespace
