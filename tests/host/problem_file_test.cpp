// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/problem_file.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "core/base/random.hpp"
#include "tests/host/scratch.hpp"

namespace {

using namespace jink;
using namespace jink::host;
using files::Complaints;
using test::with;

Complaints complaints_of(const std::string& text)
{
    auto read = read_problem_text(text, "p.yaml");
    return std::holds_alternative<Complaints>(read) ? std::get<Complaints>(read) : Complaints{};
}

ProblemFile problem(const std::string& text)
{
    auto read = read_problem_text(text, "p.yaml");
    if (const auto* complaints = std::get_if<Complaints>(&read)) {
        ADD_FAILURE() << text << "\n" << test::all_of(*complaints);
        return {};
    }
    return std::get<ProblemFile>(read);
}

const std::string kHead = "vehicle: default\nleg: {start: [0, 0, 20], end: [60, 0, 20], speed: 5}\n";
const std::string kThreat = "threats:\n  - {position: [20, 1, 20], velocity: [-3, 0, 0], radius: 1.5}\n";

TEST(ProblemFile, FindsTheCollisionPointOnALeg)
{
    // Closing at 8 m/s along x from 20 m: closest after 2.5 s, 12.5 m along the leg.
    const ProblemFile p = problem(kHead + kThreat);
    EXPECT_FLOAT_EQ(p.distance, 12.5F);
    EXPECT_FLOAT_EQ(p.main_radius, 1.5F);
    EXPECT_NEAR((p.main_centre_offset - Vec3(0, 1, 0)).norm(), 0.0F, 1e-5F);
    EXPECT_EQ(p.speed, 5.0F);
    EXPECT_EQ(p.velocity, Vec3(5, 0, 0));
    EXPECT_EQ(p.title, "p");
    EXPECT_FALSE(p.main_is_obstacle);
    EXPECT_EQ(p.main, 0U);
}

const std::string kBend =
    "vehicle: default\nreference:\n  start: [0, 0, 20]\n  speed: 5\n  segments: [{to: [10, 0, 20]}, "
    "{centre: [10, 20, 20], turn: 90}, {to: [30, 60, 20]}]\n";

TEST(ProblemFile, FindsTheCollisionPointOnAReference)
{
    // Half way round the arc, 2 m outside of it.
    const float half = 10.0F + 20.0F * 0.25F * kPi;
    const Vec3 point = Vec3(10, 20, 20) + 20.0F * Vec3(std::sqrt(0.5F), -std::sqrt(0.5F), 0);
    const Vec3 outside = 2.0F * Vec3(std::sqrt(0.5F), -std::sqrt(0.5F), 0);
    const auto still = [](const Vec3& at) {
        return "threats: [{position: [" + files::to_text(at.x()) + ", " + files::to_text(at.y()) + ", " +
               files::to_text(at.z()) + "], radius: 1}]\n";
    };
    const ProblemFile p = problem(kBend + still(point + outside));
    EXPECT_NEAR(p.distance, half, 2e-3F);
    EXPECT_LE((p.main_centre_offset - outside).norm(), 5e-3F);
    EXPECT_LE((p.velocity - Vec3(5, 0, 0)).norm(), 1e-5F);
    ProblemStorage storage;
    const geometric::Problem q = problem_of(p, storage);
    ASSERT_EQ(q.ahead.route, &p.route);
    EXPECT_NEAR(q.ahead.route->length(), 10.0F + 20.0F * 0.5F * kPi + 40.0F, 1e-3F);
    EXPECT_LE((geometric::collision_point(q) - point).norm(), 3e-3F);
    EXPECT_EQ(Vec3(q.frame.axes.col(1)), Vec3(0, 1, 0));
}

TEST(ProblemFile, FrameIsAnInput)
{
    ProblemStorage storage;
    const ProblemFile p =
        problem(kBend + "frame_y: [0.5, 0, 0.25]\n" + "obstacles: [{sphere: {centre: [12, 0, 20], radius: 1}}]\n");
    const Mat3 axes = problem_of(p, storage).frame.axes;
    EXPECT_LE((axes.col(0) - Vec3(1, 0, 0)).norm(), 1e-6F);
    EXPECT_LE((axes.col(1) - Vec3(0, 0, 1)).norm(), 1e-6F);
    EXPECT_LE((axes.col(2) - Vec3(0, -1, 0)).norm(), 1e-6F);
}

/// tests/scenario/problems: the manoeuvre begins at the start, ends on the reference past its bend, and clears what it
/// is planned around.
TEST(ProblemFile, NamedReferencesAreFollowed)
{
    for (const char* name : {"bend", "corner"}) {
        auto read = read_problem(std::string(JINK_SOURCES "/tests/scenario/problems/") + name + ".yaml");
        ASSERT_TRUE(std::holds_alternative<ProblemFile>(read)) << name;
        const auto& file = std::get<ProblemFile>(read);
        const auto outcome = solve_problem(file, 60'000);
        ASSERT_EQ(outcome->status, world::PlanStatus::found) << name;
        const auto& points = outcome->result.path.points;
        EXPECT_LE((points.front().position - file.start).norm(), 1e-3F) << name;
        const path::Abeam end = file.route.abeam_of(points.back().position);
        EXPECT_LE(end.off, 0.01F) << name;
        EXPECT_GE(end.segment, 1U) << name << ": ends before the bend";
        const geometric::Candidate& chosen = outcome->result.candidates[outcome->result.chosen];
        EXPECT_NEAR(end.arc_length, geometric::curve_length_x(chosen.shape.family, file.distance), 0.02F) << name;
    }
}

TEST(ProblemFile, CollisionPointIsTheClosestApproachOfTheFlight)
{
    const std::uint64_t seed = 99;
    Random random(seed);
    int solved = 0;
    for (int i = 0; i < 400; ++i) {
        const auto u = [&](float a, float b) { return files::to_text(random.uniform(a, b)); };
        const Vec3 end(random.uniform(30, 80), random.uniform(-40, 40), random.uniform(-40, 40));
        const Vec3 at(random.uniform(5, 60), random.uniform(-10, 10), random.uniform(-10, 10));
        const Vec3 v(random.uniform(-6, 3), random.uniform(-3, 3), random.uniform(-2, 2));
        const auto list = [](const Vec3& p) {
            return "[" + files::to_text(p.x()) + ", " + files::to_text(p.y()) + ", " + files::to_text(p.z()) + "]";
        };
        const std::string text = "vehicle: default\nleg: {start: [0, 0, 0], end: " + list(end) + ", speed: " + u(2, 8) +
                                 "}\nthreats: [{position: " + list(at) + ", velocity: " + list(v) +
                                 ", radius: 1, sigma_position: 0.1, sigma_velocity: 0.2, max_acceleration: 0.3}]\n";
        const auto read = read_problem_text(text, "p.yaml");
        // Oracle: the flight in double precision, stepped through in milliseconds.
        const Eigen::Vector3d along = end.cast<double>().normalized();
        if (std::holds_alternative<Complaints>(read)) {
            const auto& complaints = std::get<Complaints>(read);
            ASSERT_EQ(complaints.size(), 1U) << text << test::all_of(complaints);
            ASSERT_NE(with(complaints, "the main threat is not nearest on it"), nullptr)
                << text << test::all_of(complaints);
            continue;
        }
        const ProblemFile& p = std::get<ProblemFile>(read);
        const double speed = static_cast<double>(vehicle::clamped_velocity(end, p.speed, p.vehicle.limits).norm());
        double best = 1e9;
        double when = 0.0;
        for (double t = 0.0; t <= static_cast<double>(end.norm()) / speed; t += 1e-3) {
            const double d = (at.cast<double>() + t * v.cast<double>() - t * speed * along).norm();
            if (d < best) {
                best = d;
                when = t;
            }
        }
        ASSERT_NEAR(static_cast<double>(p.distance), when * speed, 0.02) << "seed " << seed << " case " << i << "\n"
                                                                         << text;
        const Eigen::Vector3d offset = at.cast<double>() + when * v.cast<double>() - when * speed * along;
        ASSERT_LT((p.main_centre_offset.cast<double>() - offset).norm(), 0.02) << text;
        ASSERT_NEAR(static_cast<double>(p.main_radius), 1.0 + 3 * 0.1 + 3 * 0.2 * when + 0.15 * when * when, 0.01)
            << text;
        ++solved;
    }
    EXPECT_GT(solved, 150);
}

TEST(ProblemFile, TakesTheCollisionPointAsGiven)
{
    const ProblemFile p =
        problem("vehicle: uav2\nstart: [1, 2, 3]\ndirection: [0, 0, 2]\ndistance: 8\n"
                "threats: [{position: [1, 2.5, 11], radius: 2}]\nvelocity: [0, 1, 0]\nflown_side: [0, 1, 0]\n");
    EXPECT_EQ(p.direction, Vec3(0, 0, 1));
    EXPECT_EQ(p.distance, 8.0F);
    EXPECT_EQ(p.speed, 15.0F) << "of the vehicle";
    EXPECT_EQ(p.vehicle.limits.max_climb, 8.0F);
    EXPECT_EQ(p.velocity, Vec3(0, 1, 0));
    EXPECT_EQ(p.flown_side, Vec3(0, 1, 0));
    EXPECT_NEAR((p.main_centre_offset - Vec3(0, 0.5F, 0)).norm(), 0.0F, 1e-5F);
}

TEST(ProblemFile, ThreatsGrowByTheirUncertainty)
{
    const ProblemFile p =
        problem(kHead + "k_sigma: 2\nthreats: [{name: a, position: [20, 0, 20], radius: 1, sigma_position: 0.25, "
                        "sigma_velocity: 0.5, max_acceleration: 0.75}]\n");
    ASSERT_EQ(p.threats.size(), 1U);
    EXPECT_EQ(p.threats[0].name, "a");
    EXPECT_FLOAT_EQ(p.threats[0].threat.radius, 1.5F);
    EXPECT_FLOAT_EQ(p.threats[0].threat.radius_rate, 1.0F);
    EXPECT_FLOAT_EQ(p.threats[0].threat.radius_acceleration, 0.75F);
    EXPECT_FLOAT_EQ(p.main_radius, 1.5F + 1.0F * 4.0F + 0.375F * 16.0F);
    EXPECT_EQ(problem(kHead + kThreat + "main_radius: 2.5\n").main_radius, 2.5F);
}

TEST(ProblemFile, ReadsObstaclesOfEveryShape)
{
    const ProblemFile p =
        problem(kHead + kThreat.substr(0, kThreat.size() - 2) +
                ", main: true}\nobstacles:\n"
                "  - {name: ball, sphere: {centre: [1, 2, 3], radius: 4}}\n"
                "  - {box: {centre: [1, 2, 3], half_extents: [1, 2, 3], yaw: 90}}\n"
                "  - {capsule: {from: [0, 0, 0], to: [0, 0, 10], radius: 2}}\n"
                "  - {cylinder: {from: [0, 0, 0], to: [0, 4, 0], radius: 2}}\n"
                "  - {hull: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], centre: [5, 5, 5]}}\n");
    ASSERT_EQ(p.obstacles.size(), 5U);
    EXPECT_EQ(p.obstacles[0].name, "ball");
    EXPECT_EQ(p.obstacles[1].name, "obstacle 1");
    const auto reach = [&](std::size_t i, const Vec3& direction) {
        return geometry::support(p.obstacles[i].obstacle.shape, direction);
    };
    EXPECT_NEAR(reach(0, Vec3::UnitX()).x(), 5.0F, 1e-5F);
    EXPECT_NEAR(reach(1, Vec3::UnitX()).x(), 3.0F, 1e-5F) << "turned by a quarter, its half extent of 2 lies along x";
    EXPECT_NEAR(reach(1, Vec3::UnitY()).y(), 3.0F, 1e-5F);
    EXPECT_NEAR(reach(2, Vec3::UnitZ()).z(), 12.0F, 1e-5F);
    EXPECT_NEAR(reach(3, Vec3::UnitY()).y(), 4.0F, 1e-5F) << "flat ends";
    EXPECT_NEAR(reach(4, Vec3::UnitZ()).z(), 6.0F, 1e-5F);
    // A copy refers to vertices that stay.
    auto copy = std::make_unique<ProblemFile>(p);
    const ProblemFile second = *copy;
    copy.reset();
    EXPECT_NEAR(geometry::support(second.obstacles[4].obstacle.shape, Vec3::UnitX()).x(), 6.0F, 1e-5F);
}

TEST(ProblemFile, AnObstacleMayBeTheMainThreat)
{
    const ProblemFile p = problem(kHead + "obstacles: [{box: {centre: [30, 1, 20], half_extents: [2, 2, 2]}}]\n");
    EXPECT_TRUE(p.main_is_obstacle);
    EXPECT_FLOAT_EQ(p.distance, 30.0F);
    EXPECT_GE(p.main_radius, std::sqrt(12.0F)) << "a sphere about the centre that holds it";
    EXPECT_LT(p.main_radius, 1.01F * std::sqrt(12.0F));
    ProblemStorage storage;
    const geometric::Problem solved = problem_of(p, storage);
    EXPECT_EQ(solved.main, geometric::kNoThreat);
    ASSERT_NE(solved.main_shape, nullptr);
    EXPECT_EQ(solved.main_shape->kind, geometry::ShapeKind::box);
    EXPECT_EQ(solve_problem(p, 200000)->status, world::PlanStatus::found);
}

TEST(ProblemFile, EverySettingReachesThePlanner)
{
    const ProblemFile p = problem(
        kHead + kThreat +
        "collision_box_side: 3\n"
        "settings:\n  l: 6\n  n: 5\n  kinds: [symmetric]\n  waypoints: 31\n  security: swept\n  offset_rule: source\n"
        "  closeness: swept\n  smoothness: deviation\n  weights: {k_S: 0.3, k_T: 0.1, k_C: 0.4, k_A: 0.15, k_B: "
        "0.05}\n  k_p: 0.5\n"
        "  flip_penalty: 0.2\n  max_cost: 0.8\n  source_drop_margin: 1\n  closeness_nearest: 2\n  retries: 1\n"
        "  moving_nearest: 3\n  check_units: 777\n"
        "  main_swept_to_collision_point: true\n  check_acceleration: false\n  verify_flight: false\n"
        "  escape_from_margin: false\n");
    const geometric::Settings& s = p.settings;
    EXPECT_EQ(s.offsets, 6);
    EXPECT_EQ(s.extra_planes, 5);
    EXPECT_FALSE(s.simple);
    EXPECT_TRUE(s.symmetric);
    EXPECT_EQ(s.waypoints, 31);
    EXPECT_EQ(s.security, geometric::SecurityMode::swept);
    EXPECT_EQ(s.offset_rule, geometric::OffsetRule::source);
    EXPECT_EQ(s.closeness, cost::ClosenessMethod::swept);
    EXPECT_EQ(s.smoothness, cost::SmoothnessMethod::deviation);
    EXPECT_EQ(s.weights.smoothness, 0.3F);
    EXPECT_EQ(s.weights.time, 0.1F);
    EXPECT_EQ(s.weights.closeness, 0.4F);
    EXPECT_EQ(s.weights.passing, 0.15F);
    EXPECT_EQ(s.weights.beyond, 0.05F);
    EXPECT_EQ(s.moving_nearest, 3);
    EXPECT_EQ(s.check_units, 777U);
    EXPECT_EQ(s.rotation_penalty, 0.5F);
    EXPECT_EQ(s.flip_penalty, 0.2F);
    EXPECT_EQ(s.max_cost, 0.8F);
    EXPECT_EQ(s.source_drop_margin, 1.0F);
    EXPECT_EQ(s.closeness_nearest, 2);
    EXPECT_EQ(s.retries, 1);
    EXPECT_TRUE(s.main_swept_to_collision_point);
    EXPECT_FALSE(s.check_acceleration);
    EXPECT_FALSE(s.verify_flight);
    EXPECT_FALSE(s.escape_from_margin);
    EXPECT_EQ(p.vehicle.limits.half_extents, Vec3::Constant(1.5F));

    const geometric::Settings source =
        problem(kHead + kThreat + "settings: {preset: source, kinds: simple}\n").settings;
    EXPECT_EQ(source.security, geometric::SecurityMode::swept);
    EXPECT_FALSE(source.symmetric);
    EXPECT_EQ(problem(kHead + kThreat + "settings: {smoothness: second-derivative}\n").settings.smoothness,
              cost::SmoothnessMethod::second_derivative);
    EXPECT_TRUE(problem(kHead + kThreat + "settings: {kinds: both}\n").settings.symmetric);
}

TEST(ProblemFile, ReadsAirspace)
{
    const ProblemFile p =
        problem(kHead + kThreat + "airspace: {floor: 2, ceiling: 120, keep_in: {home: [1, 2, 3], radius: 500}}\n");
    ASSERT_TRUE(p.has_airspace);
    EXPECT_TRUE(p.airspace.has_floor && p.airspace.has_ceiling && p.airspace.has_keep_in);
    EXPECT_EQ(p.airspace.floor, 2.0F);
    EXPECT_EQ(p.airspace.ceiling, 120.0F);
    EXPECT_EQ(p.airspace.home, Vec3(1, 2, 3));
    EXPECT_EQ(p.airspace.keep_in_radius, 500.0F);
    EXPECT_FALSE(problem(kHead + kThreat).has_airspace);
}

TEST(ProblemFile, VehicleFromAFileBesideItOrInline)
{
    const test::Scratch scratch;
    static_cast<void>(scratch.write("v.yaml", test::slurp(JINK_SOURCES "/firmware/vehicles/uav2.yaml")));
    const auto beside =
        read_problem(scratch.write("p.yaml", "vehicle: v.yaml\nleg: {start: [0, 0, 0], end: [99, 0, 0]}\n"
                                             "threats: [{position: [50, 0, 0], radius: 1}]\n"));
    ASSERT_TRUE(std::holds_alternative<ProblemFile>(beside)) << test::all_of(std::get<Complaints>(beside));
    EXPECT_EQ(std::get<ProblemFile>(beside).vehicle.limits.cruise_speed, 15.0F);

    const auto broken =
        read_problem(scratch.write("q.yaml", "vehicle: w.yaml\nleg: {start: [0, 0, 0], end: [99, 0, 0]}\n"
                                             "threats: [{position: [50, 0, 0], radius: 1}]\n"));
    static_cast<void>(scratch.write("w.yaml", "cruise_speed: fast\n"));
    const auto wrong = read_problem(scratch.path() / "q.yaml");
    ASSERT_TRUE(std::holds_alternative<Complaints>(broken));
    EXPECT_NE(with(std::get<Complaints>(broken), "no such file"), nullptr);
    ASSERT_TRUE(std::holds_alternative<Complaints>(wrong));
    const files::Complaint* inner = with(std::get<Complaints>(wrong), "'fast' is not a number");
    ASSERT_NE(inner, nullptr);
    EXPECT_EQ(inner->line, 1U);
    EXPECT_TRUE(inner->file.ends_with("w.yaml"));
    EXPECT_NE(with(std::get<Complaints>(wrong), "is neither a vehicle file beside this one"), nullptr);

    EXPECT_NE(
        with(complaints_of("vehicle: {kind: multirotor}\n" + kHead.substr(17) + kThreat), "missing key 'vehicle.mass'"),
        nullptr);
}

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
        const char* complaint;
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
        {kHead + crowd, "threats: 33 are more than 32"},
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
