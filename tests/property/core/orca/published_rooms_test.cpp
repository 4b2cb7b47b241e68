// SPDX-License-Identifier: BSD-3-Clause
// Simulations of Alejo 7.3 among obstacles (S3 to S5), flown by VelocityFilter. Alejo draws the rooms without
// coordinates: these are from the G-ORCA specification, section 19.1.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/property/core/geometry/oracle.hpp"
#include "tests/property/core/orca/closed_loop_report.hpp"

namespace jink::orca {
namespace {

using namespace closed_loop;
using geometry::oracle::case_count;
using geometry::oracle::seed_of;

/// Two level pipes of 0.3 m, 4 m long, at 1.0 and 1.8 m.
std::vector<Body> pipes()
{
    return {{Vec3d(0, -1, 1.0), Vec3d(2, 0, 0), 0.15}, {Vec3d(0, 1, 1.8), Vec3d(2, 0, 0), 0.15}};
}

Scene room(std::size_t vehicles)
{
    Scene scene;
    scene.settings = testbed_settings();
    scene.bodies = pipes();
    scene.agents = on_a_circle(vehicles, 4.0, 1.5);
    return scene;
}

/// Manoeuvres as section 19.1 counts them: the command off the preferred velocity by more than 0.05 m/s, gaps of less
/// than 1 s ignored; and half-spaces of others or of obstacles are active, otherwise each start would count.
class Manoeuvres {
public:
    void watch(const Watched& tick)
    {
        std::set<std::uint32_t> with;
        bool held = false;
        for (const Binding& binding : tick.decision.bindings) {
            if (binding.level == Level::conflict || binding.level == Level::warning) {
                with.insert(tick.input.neighbours[binding.source].id);
            }
            held = held || binding.level != Level::limits;
        }
        auto open = open_.find(tick.vehicle);
        if (open != open_.end() && tick.now - open->second.last >= 1.0) {
            close(open->second);
            open_.erase(open);
            open = open_.end();
        }
        if (!held || (tick.decision.command - tick.input.preferred).norm() <= 0.05F) {
            return;
        }
        if (open == open_.end()) {
            open = open_.emplace(tick.vehicle, One{tick.now, tick.now, {}}).first;
        }
        open->second.last = tick.now;
        open->second.with.insert(with.begin(), with.end());
    }
    /// Only manoeuvres with other vehicles: Table 7.1 gives the number involved.
    void finish()
    {
        for (const auto& [vehicle, one] : open_) {
            close(one);
        }
        open_.clear();
    }
    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] std::size_t alone() const { return alone_; }
    [[nodiscard]] double mean_length() const { return length_ / double(std::max<std::size_t>(count_, 1)); }
    [[nodiscard]] double mean_vehicles() const { return vehicles_ / double(std::max<std::size_t>(count_, 1)); }

private:
    struct One {
        double first;
        double last;
        std::set<std::uint32_t> with;
    };
    void close(const One& one)
    {
        if (one.with.empty()) {
            ++alone_;
            return;
        }
        ++count_;
        length_ += one.last - one.first;
        vehicles_ += double(1 + one.with.size());
    }
    std::map<std::size_t, One> open_;
    std::size_t count_ = 0;
    std::size_t alone_ = 0;
    double length_ = 0.0;
    double vehicles_ = 0.0;
};

/// S3 REFERENCE, Table 7.1: 55 manoeuvres in 600 s, 9.56 s each, 2.81 vehicles involved; least separations 0.853 to
/// 1.17 m across or in height, 0.81 to 0.87 m to obstacles with 0.8 m required. Separations hold; manoeuvres depend on
/// an unpublished room and mission.
TEST(PublishedRoom, S3)
{
    Scene scene = room(4);
    scene.swaps = true;
    scene.until = std::clamp(double(case_count(600)), 60.0, 3600.0);
    Manoeuvres manoeuvres;
    scene.watch = [&](const Watched& tick) { manoeuvres.watch(tick); };
    const Outcome o = fly("S3", scene);
    manoeuvres.finish();
    std::printf(
        "[ measured ] S3: %zu missions in %.0f s, %zu manoeuvres with others, mean %.2f s, %.2f vehicles; %zu for "
        "obstacles alone\n",
        o.missions, scene.until, manoeuvres.count(), manoeuvres.mean_length(), manoeuvres.mean_vehicles(),
        manoeuvres.alone());
    EXPECT_GE(double(o.missions), scene.until / 30.0);
    EXPECT_GE(0.7 * o.cylinder, 0.7);
    EXPECT_LT(0.7 * o.cylinder, 1.0);
    EXPECT_GE(double(scene.settings.obstacles.horizontal) * o.obstacle, 0.8);
    EXPECT_EQ(o.conflict + o.obstacle_relaxed, 0U);
    EXPECT_LT(longest_wait(o), 10.0);
    EXPECT_GE(double(manoeuvres.count()), scene.until / 30.0);
    EXPECT_GE(manoeuvres.mean_vehicles(), 2.0);
}

/// S4 REFERENCE: 8 vehicles, at least 1.12 m between vehicles and 1.02 m to obstacles. The latter to 2 %; between
/// vehicles the minimum, 0.7 m across or 0.45 m in height, is reached.
TEST(PublishedRoom, S4)
{
    const Scene scene = room(8);
    const Outcome o = fly("S4", scene);
    EXPECT_GT(o.time, 0.0);
    EXPECT_NEAR(double(scene.settings.obstacles.horizontal) * o.obstacle, 1.02, 0.02);
    EXPECT_GE(o.cylinder, 1.0);
    EXPECT_EQ(o.conflict + o.obstacle_relaxed, 0U);
}

/// 12 hulls of 0.5 to 1.5 m on a disc of 5.8 m, gaps of 1.9 m between any two.
std::vector<Body> random_hulls(Random& random)
{
    constexpr std::size_t kHulls = 12;
    constexpr double kGap = 1.9;
    std::vector<Body> bodies;
    std::vector<double> radii;
    while (bodies.size() < kHulls) {
        const double radius = 0.5 * double(random.uniform(0.5F, 1.5F));
        const Vec3d at(random.uniform(-5.5F, 5.5F), random.uniform(-5.5F, 5.5F), random.uniform(0.5F, 3.5F));
        bool fits = std::hypot(at.x(), at.y()) + radius < 5.8;
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            fits = fits && (at - bodies[i].centre).norm() >= radius + radii[i] + kGap;
        }
        if (!fits) {
            if (random.below(20'000) == 0) {  // no space left for another hull: starts again
                bodies.clear();
                radii.clear();
            }
            continue;
        }
        Body body{at, Vec3d::Zero()};
        for (int k = 0; k < 12; ++k) {
            const Vec3 direction(random.normal(), random.normal(), random.normal());
            body.hull.push_back(Point3::of(direction.normalized() * float(radius)));
        }
        radii.push_back(radius);
        bodies.push_back(body);
    }
    return bodies;
}

/// S5: pair separations 0.7 / 0.42 m and 0.55 / 0.30 m, obstacles 0.9 / 0.5 m, 0.2 m/s; 20 Hz instead of 40.
Scene among_hulls(Random& random, std::size_t vehicles)
{
    Scene scene;
    scene.settings = testbed_settings();
    scene.settings.half_width = 0.35F;
    scene.settings.half_height = 0.21F;
    scene.settings.pair.conflict_ratio = 0.55F / 0.7F;
    scene.settings.obstacles.horizontal = 0.9F;
    scene.settings.obstacles.vertical = 0.5F;
    scene.plant.period = 0.05;
    scene.cruise = 0.2;
    scene.e_xy = 0.55;
    scene.e_z = 0.30;
    scene.until = 300.0;
    scene.bodies = random_hulls(random);
    scene.agents = on_a_circle(vehicles, 7.0, 1.5);
    return scene;
}

/// S5 REFERENCE: up to 8 vehicles among complex obstacles, completed. A local method may end in a hollow between
/// hulls: 2 of 1000 of these rooms do (JINK_CASES=1000). Separations hold in all.
TEST(PublishedRoom, S5)
{
    Random random(seed_of(5));
    const std::size_t count = std::max<std::size_t>(4, std::min<std::size_t>(case_count(20), 2000));
    std::size_t stuck = 0;
    double slowest = 0.0;
    double ellipsoid = 1e9;
    double obstacle = 1e9;
    for (std::size_t i = 0; i < count; ++i) {
        const Scene scene = among_hulls(random, 2 + i % 7);
        World world(scene);
        ASSERT_TRUE(world.configured());
        const Outcome o = world.fly();
        ASSERT_GE(o.ellipsoid, 1.0) << "room " << i;
        ASSERT_GE(o.obstacle, 0.999) << "room " << i;
        ASSERT_EQ(o.conflict + o.obstacle_relaxed + o.other + o.outside, 0U) << "room " << i;
        ASSERT_TRUE(o.time > 0.0 || o.blocked) << "room " << i;
        stuck += o.time < 0.0 ? 1U : 0U;
        slowest = std::max(slowest, o.time);
        ellipsoid = std::min(ellipsoid, o.ellipsoid);
        obstacle = std::min(obstacle, o.obstacle);
    }
    std::printf("[ measured ] S5: %zu rooms, %zu not completed, slowest %.0f s, ellipsoid %.3f, obstacles %.3f\n",
                count, stuck, slowest, ellipsoid, obstacle);
    EXPECT_LE(double(stuck), 1.0 + 0.05 * double(count));
}

}  // namespace
}  // namespace jink::orca
