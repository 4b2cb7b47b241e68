// SPDX-License-Identifier: BSD-3-Clause
// The simulated LiDAR: its rays against a walk along them by the distance to each body, its frames against the
// product's receiver, its forms against points on their surfaces.
#include "toolchain/sim/lidar.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/base/random.hpp"
#include "firmware/link/cloud/receiver.hpp"
#include "tests/unit/link/cloud_tools.hpp"
#include "toolchain/sim/scenario_file.hpp"

namespace jink::sim {
namespace {

constexpr double kStepAlong = 0.002;  // [m]

double draw(Random& random, double low, double high)
{
    return low + (high - low) * static_cast<double>(random.uniform());
}
Vec draw_vec(Random& random, double size)
{
    return {draw(random, -size, size), draw(random, -size, size), draw(random, -size, size)};
}

Threat draw_body(Random& random)
{
    Threat body;
    body.form = std::array{Form::sphere, Form::cylinder, Form::box}[random.below(3)];
    body.radius = draw(random, 0.2, 2.0);
    body.half_height = body.form == Form::cylinder || random.below(2) == 0 ? draw(random, 0.2, 4.0) : 0.0;
    body.half_extents = Vec::Constant(2.2) + draw_vec(random, 2.0);
    body.sensed_by = SensedBy::lidar;
    return body;
}

/// Small steps until the distance to the surface is zero; negative: never within `most`.
double walk(const Threat& body, const Vec& centre, const Vec& from, const Vec& direction, double most)
{
    for (double range = 0.0; range <= most; range += kStepAlong) {
        if (surface_distance(body, centre, from + range * direction) <= 0.0) {
            return range;
        }
    }
    return -1.0;
}

/// By its definition: inside or not, without the distance.
bool is_inside(const Threat& body, const Vec& gap)
{
    const bool in_height = std::abs(gap.z()) <= body.half_height;
    switch (body.form) {
    case Form::box: return (gap.cwiseAbs().array() <= body.half_extents.array()).all();
    case Form::cylinder: return in_height && gap.head<2>().squaredNorm() <= body.radius * body.radius;
    case Form::sphere: break;
    }
    const Vec cap(gap.x(), gap.y(), in_height ? 0.0 : std::abs(gap.z()) - body.half_height);
    return cap.squaredNorm() <= body.radius * body.radius;
}

TEST(Lidar, RangesAreThoseOfAWalkAlongTheRay)
{
    Random random(11);
    int hits = 0;
    for (int k = 0; k < 600; ++k) {
        const Threat body = draw_body(random);
        const Vec centre = draw_vec(random, 3.0);
        const Vec from = draw_vec(random, 9.0);
        const Vec aim = centre + draw_vec(random, 3.0) - from;
        const Vec direction = (k % 7 == 0 ? Vec(aim.x(), 0.0, 0.0) : aim).normalized();
        constexpr double kMax = 30.0;
        const double walked = walk(body, centre, from, direction, kMax);
        const double range = ray_range(body, centre, from, direction);
        if (walked >= 0.0) {
            ++hits;
            ASSERT_GE(range, 0.0) << k;
            ASSERT_NEAR(range, walked, 1.01 * kStepAlong) << k << " " << to_string(body.form);
        } else if (range >= 0.0) {
            // A corner that is cut by less than a step is walked over.
            ASSERT_NEAR(surface_distance(body, centre, from + range * direction), 0.0, 1e-9) << k;
            ASSERT_GE(surface_distance(body, centre, from + (range + kStepAlong) * direction), -kStepAlong) << k;
        }
    }
    EXPECT_GT(hits, 150);
}

TEST(Threat, DistancesOfCylindersAndBoxesAreThoseToTheNearestPointInside)
{
    Random random(12);
    for (int k = 0; k < 60; ++k) {
        const Threat body = draw_body(random);
        const Vec point = draw_vec(random, 6.0);
        const double distance = surface_distance(body, Vec::Zero(), point);
        ASSERT_EQ(distance <= 0.0, is_inside(body, point)) << k;
        double least = 1e9;
        const Vec half =
            body.form == Form::box
                ? body.half_extents
                : Vec(body.radius, body.radius, body.half_height + (body.form == Form::sphere ? body.radius : 0.0));
        constexpr int kParts = 40;
        for (int i = 0; i <= kParts * kParts * kParts; ++i) {
            const Vec share(i % kParts, i / kParts % kParts, i / kParts / kParts);
            const Vec inside = half.cwiseProduct(2.0 / (kParts - 1) * share - Vec::Ones());
            least = is_inside(body, inside) ? std::min(least, (inside - point).norm()) : least;
        }
        if (distance > 0.0) {
            ASSERT_LE(distance, least + 1e-9) << k;
            ASSERT_GE(distance, least - 2.0 * half.norm() / kParts) << k << " " << to_string(body.form);
        }
    }
}

Scenario seen_scenario()
{
    return parse_scenario(R"(
mission: [[0, 0, 12], [100, 40, 12]]
ground: 0
threats:
  - {name: trunk, form: cylinder, radius: 0.4, half_height: 15, position: [12, 9, 15], sensed_by: lidar}
  - {name: house, form: box, half_extents: [4, 6, 5], position: [-3, -20, 5], sensed_by: lidar}
  - {name: balloon, radius: 2, position: [20, -5, 20], sensed_by: lidar}
  - {name: late, radius: 3, position: [0, 8, 12], sensed_by: lidar, appears_at: 50}
lidar: {rate: 10, range: 40, pitch: 3, sigma: 0, latency: 0.03}
expect: {outcome: [clear, avoided, braked, collision]}
)",
                          "seen.yaml");
}

/// Range to the first body in a world direction, by stepping; negative: nothing within range.
double walk_world(const World& world, const Vec& direction, double most)
{
    for (double range = 0.0; range <= most; range += kStepAlong) {
        const Vec at = world.own().position + range * direction;
        for (std::size_t i = 0; i < world.scenario().threats.size(); ++i) {
            if (world.visible(i) &&
                surface_distance(world.scenario().threats[i], world.threat_position(i), at) <= 0.0) {
                return range;
            }
        }
        if (at.z() <= *world.scenario().ground) {
            return range;
        }
    }
    return -1.0;
}

/// Every point that the product's receiver delivers is on a surface, and every surface is detected: tilted, turning
/// vehicle, separate stepping along each ray.
TEST(Lidar, TheProductsReceiverFindsTheWorldInItsFrames)
{
    const Scenario scenario = seen_scenario();
    World world(scenario);
    Lidar lidar(scenario);
    link::cloud::Receiver receiver;
    link::cloud::test::Recorder recorder;
    std::vector<Truth> when;
    std::vector<std::byte> bytes(1 << 20);
    for (int i = 0; i < 210; ++i) {
        const std::size_t n = lidar.read(bytes);
        receiver.receive({bytes.data(), n}, {1'000'000 + world.now()}, recorder);
        const Truth before = world.own();
        lidar.step(world);
        if (world.now() % 100'000 == 0) {
            when.push_back(before);
        }
        world.step(Vec(3, -4 + 0.05 * i, 1));
    }
    ASSERT_FALSE(recorder.broken);
    EXPECT_EQ(receiver.diagnostics().noise_bytes, 0U);
    EXPECT_EQ(receiver.diagnostics().points_lost, 0U);
    ASSERT_GE(recorder.scans.size(), 10U);
    int hits = 0;
    double most_tilt = 0.0;
    const std::size_t scan = recorder.scans.size() - 1;
    const Truth& own = when[scan];
    World then(scenario);
    for (int i = 0; i < static_cast<int>(scan) * 20; ++i) {
        then.step(Vec(3, -4 + 0.05 * i, 1));
    }
    ASSERT_LT((then.own().position - own.position).norm(), 1e-9);
    most_tilt = std::max(std::abs(tilt_of(own).roll), std::abs(tilt_of(own).pitch));
    EXPECT_GT(most_tilt, 0.02);
    const auto& rays = recorder.scans[scan].rays;
    EXPECT_EQ(rays.size(), 120U * 31U);
    for (std::size_t i = 0; i < rays.size(); i += 31) {
        const auto& [ray, point] = rays[i];
        const double c = std::cos(own.yaw);
        const double s = std::sin(own.yaw);
        const Vec level = point.cast<double>();
        const Vec direction = Vec(c * level.x() - s * level.y(), s * level.x() + c * level.y(), level.z()).normalized();
        const double walked = walk_world(then, direction, 40.0);
        // Angles of the wire are 1e-4 rad: at a grazing hit the range error is large, so the place is compared.
        if (ray == link::Ray::hit) {
            ++hits;
            const Vec at = own.position + level.norm() * direction;
            double nearest = std::abs(at.z());
            for (std::size_t k = 0; k < 3; ++k) {
                nearest = std::min(nearest,
                                   std::abs(surface_distance(scenario.threats[k], scenario.threats[k].position, at)));
            }
            ASSERT_LT(nearest, 0.03) << i;
            ASSERT_TRUE(walked < 0.0 || walked > level.norm() - 0.5 || nearest < 0.03) << i;
        } else {
            ASSERT_EQ(ray, link::Ray::nothing);
            ASSERT_TRUE(walked < 0.0 || walked > 39.0) << i << " " << walked;
        }
    }
    EXPECT_GT(hits, 25);
}

TEST(Lidar, ScansArriveAtTheirRateAndLate)
{
    const Scenario scenario = seen_scenario();
    World world(scenario);
    Lidar lidar(scenario);
    std::vector<std::byte> bytes(1 << 20);
    std::vector<Micros> arrivals;
    for (int i = 0; i < 100; ++i) {
        lidar.step(world);
        if (lidar.read(bytes) > 0) {
            arrivals.push_back(world.now());
        }
        world.step(Vec::Zero());
    }
    EXPECT_EQ(arrivals, (std::vector<Micros>{30'000, 130'000, 230'000, 330'000, 430'000}));
}

TEST(Lidar, AVehicleThatSpeedsUpLowersItsNoseAndLeansIntoTurns)
{
    Truth truth;
    truth.yaw = 1.0;
    EXPECT_EQ(tilt_of(truth).roll, 0.0);
    truth.acceleration = 2.0 * Vec(std::cos(1.0), std::sin(1.0), 0.0);
    EXPECT_NEAR(tilt_of(truth).pitch, -std::atan(2.0 / 9.80665), 1e-12);
    truth.acceleration = 2.0 * Vec(std::sin(1.0), -std::cos(1.0), 0.0);  // to the right
    EXPECT_NEAR(tilt_of(truth).roll, std::atan(2.0 / 9.80665), 1e-12);
    // The thrust is along the platform's own upward axis.
    truth.acceleration = Vec(1.0, -2.0, 0.7);
    const Vec thrust = (truth.acceleration + Vec(0, 0, 9.80665)).normalized();
    const Vec up = platform_to_world(tilt_of(truth), truth.yaw) * Vec::UnitZ();
    EXPECT_LT((thrust - up).norm(), 1e-12);
}

TEST(ScenarioFile, ScattersAreDrawnBySeedAndKeepApart)
{
    const std::string text = "mission: [[0, 0, 30], [100, 0, 30]]\nexpect: {outcome: clear}\nlidar: {}\nthreats:\n"
                             "  - {name: t, form: cylinder, radius: 1, half_height: 9, position: [5, 6, 7], "
                             "sensed_by: lidar, scatter: {count: 30, half: [40, 20, 0], apart: 6}}\n";
    const Scenario first = parse_scenario("seed: 3\n" + text, "a.yaml");
    const Scenario again = parse_scenario("seed: 3\n" + text, "a.yaml");
    const Scenario other = parse_scenario("seed: 4\n" + text, "a.yaml");
    ASSERT_EQ(first.threats.size(), 30U);
    EXPECT_EQ(first.threats[29].position, again.threats[29].position);
    EXPECT_NE(first.threats[29].position, other.threats[29].position);
    for (const Threat& a : first.threats) {
        EXPECT_LE(std::abs(a.position.x() - 5.0), 40.0);
        EXPECT_LE(std::abs(a.position.y() - 6.0), 20.0);
        EXPECT_EQ(a.position.z(), 7.0);
        for (const Threat& b : first.threats) {
            EXPECT_TRUE(&a == &b || (a.position - b.position).norm() >= 6.0);
        }
    }
}

std::string refused(const std::string& threat, const std::string& more = "lidar: {}")
{
    try {
        static_cast<void>(parse_scenario("mission: [[0, 0, 30], [100, 0, 30]]\nexpect: {outcome: clear}\n" + more +
                                             "\nthreats:\n  - {position: [1, 2, 3], " + threat + "}\n",
                                         "a.yaml"));
    } catch (const BadScenario& bad) {
        return bad.what();
    }
    return "accepted";
}

TEST(ScenarioFile, FormsThatCannotBeAreRefused)
{
    const auto says = [](const std::string& text, const std::string& why) {
        return text.find(why) != std::string::npos;
    };
    EXPECT_EQ(refused("form: box, half_extents: [1, 2, 3], sensed_by: lidar"), "accepted");
    EXPECT_EQ(refused("form: cylinder, half_height: 3, sensed_by: lidar"), "accepted");
    EXPECT_TRUE(says(refused("form: box, sensed_by: lidar"), "a box, and nothing else, has 'half_extents'"));
    EXPECT_TRUE(says(refused("half_extents: [1, 1, 1], sensed_by: lidar"), "a box, and nothing else"));
    EXPECT_TRUE(says(refused("form: box, radius: 2, half_extents: [1, 2, 3], sensed_by: lidar"), "neither 'radius'"));
    EXPECT_TRUE(says(refused("form: cylinder, sensed_by: lidar"), "missing key 'threats[0].half_height'"));
    EXPECT_TRUE(
        says(refused("form: cylinder, half_height: 3, sensed_by: scan"), "only a lidar sees what is no sphere"));
    EXPECT_TRUE(says(refused("sensed_by: lidar", "seed: 1"), "there is no 'lidar'"));
    EXPECT_TRUE(says(refused("sensed_by: lidar, scatter: {count: 200, half: [9, 9, 0], apart: 5}"), "do not fit"));
}

}  // namespace
}  // namespace jink::sim
