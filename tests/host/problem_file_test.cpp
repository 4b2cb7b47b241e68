// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/base/random.hpp"
#include "tests/host/problem_text.hpp"

namespace {

using namespace jink;
using namespace jink::host;
using files::Complaints;
using test::complaints_of;
using test::kBend;
using test::kHead;
using test::kThreat;
using test::with;

ProblemFile read_good(const std::string& text)
{
    auto read = read_problem_text(text, "p.yaml");
    if (const auto* complaints = std::get_if<Complaints>(&read)) {
        ADD_FAILURE() << text << "\n" << test::all_of(*complaints);
        return {};
    }
    return std::get<ProblemFile>(read);
}

TEST(ProblemFile, FindsTheCollisionPointOnALeg)
{
    // Closing at 8 m/s along x from 20 m: closest after 2.5 s, 12.5 m along the leg.
    const ProblemFile p = read_good(kHead + kThreat);
    EXPECT_FLOAT_EQ(p.distance, 12.5F);
    EXPECT_FLOAT_EQ(p.main_radius, 1.5F);
    EXPECT_NEAR((p.main_centre_offset - Vec3(0, 1, 0)).norm(), 0.0F, 1e-5F);
    EXPECT_EQ(p.speed, 5.0F);
    EXPECT_EQ(p.velocity, Vec3(5, 0, 0));
    EXPECT_EQ(p.title, "p");
    EXPECT_FALSE(p.main_is_obstacle);
    EXPECT_EQ(p.main, 0U);
}

TEST(ProblemFile, FindsTheCollisionPointOnAReference)
{
    // Half-way round the arc, 2 m outside.
    const float half = 10.0F + 20.0F * 0.25F * kPi;
    const Vec3 point = Vec3(10, 20, 20) + 20.0F * Vec3(std::sqrt(0.5F), -std::sqrt(0.5F), 0);
    const Vec3 outside = 2.0F * Vec3(std::sqrt(0.5F), -std::sqrt(0.5F), 0);
    const auto still = [](const Vec3& at) {
        return "threats: [{position: [" + files::to_text(at.x()) + ", " + files::to_text(at.y()) + ", " +
               files::to_text(at.z()) + "], radius: 1}]\n";
    };
    const ProblemFile p = read_good(kBend + still(point + outside));
    EXPECT_NEAR(p.distance, half, 2e-3F);
    EXPECT_LE((p.main_centre_offset - outside).norm(), 5e-3F);
    EXPECT_LE((p.velocity - Vec3(5, 0, 0)).norm(), 1e-5F);
    ProblemStorage storage;
    const geometric::Problem q = problem_of(p, storage);
    ASSERT_EQ(q.ahead.route.segments().data(), p.route.segments().data());
    EXPECT_NEAR(q.ahead.route.length(), 10.0F + 20.0F * 0.5F * kPi + 40.0F, 1e-3F);
    EXPECT_LE((geometric::collision_point(q) - point).norm(), 3e-3F);
    EXPECT_EQ(Vec3(q.frame.axes.col(1)), Vec3(0, 1, 0));
}

TEST(ProblemFile, FrameIsAnInput)
{
    ProblemStorage storage;
    const ProblemFile p =
        read_good(kBend + "frame_y: [0.5, 0, 0.25]\n" + "obstacles: [{sphere: {centre: [12, 0, 20], radius: 1}}]\n");
    const Mat3 axes = problem_of(p, storage).frame.axes;
    EXPECT_LE((axes.col(0) - Vec3(1, 0, 0)).norm(), 1e-6F);
    EXPECT_LE((axes.col(1) - Vec3(0, 0, 1)).norm(), 1e-6F);
    EXPECT_LE((axes.col(2) - Vec3(0, -1, 0)).norm(), 1e-6F);
}

/// tests/scenario/problems: the manoeuvre begins at the start, ends on the reference past its bend, and clears its main
/// threat.
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
        read_good("vehicle: uav2\nstart: [1, 2, 3]\ndirection: [0, 0, 2]\ndistance: 8\n"
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
        read_good(kHead + "k_sigma: 2\nthreats: [{name: a, position: [20, 0, 20], radius: 1, sigma_position: 0.25, "
                          "sigma_velocity: 0.5, max_acceleration: 0.75}]\n");
    ASSERT_EQ(p.threats.size(), 1U);
    EXPECT_EQ(p.threats[0].name, "a");
    EXPECT_FLOAT_EQ(p.threats[0].threat.growth.radius, 1.5F);
    EXPECT_FLOAT_EQ(p.threats[0].threat.growth.rate, 1.0F);
    EXPECT_FLOAT_EQ(p.threats[0].threat.growth.acceleration, 0.75F);
    EXPECT_FLOAT_EQ(p.main_radius, 1.5F + 1.0F * 4.0F + 0.375F * 16.0F);
    EXPECT_EQ(read_good(kHead + kThreat + "main_radius: 2.5\n").main_radius, 2.5F);
}

TEST(ProblemFile, ReadsObstaclesOfEveryShape)
{
    const ProblemFile p =
        read_good(kHead + kThreat.substr(0, kThreat.size() - 2) +
                  ", main: true}\nobstacles:\n"
                  "  - {name: sphere, sphere: {centre: [1, 2, 3], radius: 4}}\n"
                  "  - {box: {centre: [1, 2, 3], half_extents: [1, 2, 3], yaw: 90}}\n"
                  "  - {capsule: {from: [0, 0, 0], to: [0, 0, 10], radius: 2}}\n"
                  "  - {cylinder: {from: [0, 0, 0], to: [0, 4, 0], radius: 2}}\n"
                  "  - {hull: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], centre: [5, 5, 5]}}\n");
    ASSERT_EQ(p.obstacles.size(), 5U);
    EXPECT_EQ(p.obstacles[0].name, "sphere");
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
    const ProblemFile p = read_good(kHead + "obstacles: [{box: {centre: [30, 1, 20], half_extents: [2, 2, 2]}}]\n");
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
    const ProblemFile p = read_good(
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
        read_good(kHead + kThreat + "settings: {preset: source, kinds: simple}\n").settings;
    EXPECT_EQ(source.security, geometric::SecurityMode::swept);
    EXPECT_FALSE(source.symmetric);
    EXPECT_EQ(read_good(kHead + kThreat + "settings: {smoothness: second-derivative}\n").settings.smoothness,
              cost::SmoothnessMethod::second_derivative);
    EXPECT_TRUE(read_good(kHead + kThreat + "settings: {kinds: both}\n").settings.symmetric);
}

TEST(ProblemFile, ReadsAirspace)
{
    const ProblemFile p =
        read_good(kHead + kThreat + "airspace: {floor: 2, ceiling: 120, keep_in: {home: [1, 2, 3], radius: 500}}\n");
    ASSERT_TRUE(p.has_airspace);
    EXPECT_TRUE(p.airspace.has_floor && p.airspace.has_ceiling && p.airspace.has_keep_in);
    EXPECT_EQ(p.airspace.floor, 2.0F);
    EXPECT_EQ(p.airspace.ceiling, 120.0F);
    EXPECT_EQ(p.airspace.home, Vec3(1, 2, 3));
    EXPECT_EQ(p.airspace.keep_in_radius, 500.0F);
    EXPECT_FALSE(read_good(kHead + kThreat).has_airspace);
}

TEST(ProblemFile, VehicleFromAFileBesideItOrInline)
{
    const test::Scratch scratch;
    static_cast<void>(scratch.write("v.yaml", test::slurp(JINK_SOURCES "/firmware/vehicles/uav2/vehicle.yaml")));
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

}  // namespace
