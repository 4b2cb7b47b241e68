// SPDX-License-Identifier: BSD-3-Clause
// Rounds of obstacles and closed areas: tables that change while they go out, solids against their support functions,
// and messages that are lost.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "firmware/linux/flight_log/shape_round.hpp"
#include "firmware/linux/flight_log/shown_shapes.hpp"

namespace {

using namespace jink;
using namespace jink::flightlog;
using geometry::Shape;
using geometry::ShapeKind;
using Quaternion = std::array<double, 4>;  // w, x, y, z
using Place = std::array<double, 3>;

double uniform(std::mt19937_64& random, double low, double high)
{
    return std::uniform_real_distribution<double>(low, high)(random);
}

Vec3 vector_in(std::mt19937_64& random, double size)
{
    const auto one = [&] { return static_cast<float>(uniform(random, -size, size)); };
    const float x = one();
    const float y = one();
    return {x, y, one()};
}

/// Orthonormal axes of either hand.
Mat3 random_axes(std::mt19937_64& random)
{
    Vec3 a = vector_in(random, 1.0) + Vec3(1.5F, 0.0F, 0.0F);
    Vec3 b = vector_in(random, 1.0) + Vec3(0.0F, 1.5F, 0.0F);
    a.normalize();
    b = (b - a * a.dot(b)).normalized();
    Mat3 axes;
    axes.col(0) = a;
    axes.col(1) = b;
    axes.col(2) = random() % 2 == 0 ? a.cross(b) : b.cross(a);
    Mat3 turned = axes;  // also such as have no small turn
    const auto shift = static_cast<int>(random() % 3);
    for (int k = 0; k < 3; ++k) {
        turned.col(k) = axes.col((k + shift) % 3) * (random() % 2 == 0 ? 1.0F : -1.0F);
    }
    return turned;
}

Shape random_shape(std::mt19937_64& random, std::span<const Point3> vertices)
{
    const Vec3 centre = vector_in(random, 50.0);
    const auto size = static_cast<float>(uniform(random, 0.1, 9.0));
    switch (random() % 5) {
    case 0: return geometry::make_sphere(centre, size);
    case 1: return geometry::make_box(centre, vector_in(random, 9.0).cwiseAbs(), random_axes(random));
    case 2: return geometry::make_capsule(centre, centre + vector_in(random, 9.0), size);
    case 3: return geometry::make_cylinder(centre, centre + vector_in(random, 9.0), size);
    default: return geometry::make_hull(vertices, centre, random_axes(random));
    }
}

/// v turned by q, as pages do it: v + 2 q x (q x v + w v).
Place turned(const Quaternion& q, const Place& v)
{
    const auto cross = [](const Place& a, const Place& b) {
        return Place{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const Place axis{q[1], q[2], q[3]};
    Place inner = cross(axis, v);
    for (std::size_t k = 0; k < 3; ++k) {
        inner[k] += q[0] * v[k];
    }
    const Place outer = cross(axis, inner);
    return {v[0] + 2.0 * outer[0], v[1] + 2.0 * outer[1], v[2] + 2.0 * outer[2]};
}

/// How far the solid of a topic reaches in a direction of length 1, from the world's origin on [m].
double reach_of(const ObstacleTopic& topic, const Place& direction)
{
    const Quaternion back{double(topic.turn[0]), -double(topic.turn[1]), -double(topic.turn[2]),
                          -double(topic.turn[3])};
    const Place d = turned(back, direction);
    double reach = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        reach += direction[k] * double(topic.centre[k]);
    }
    switch (static_cast<ShapeKind>(topic.kind)) {
    case ShapeKind::sphere: return reach + double(topic.radius);
    case ShapeKind::capsule: return reach + double(topic.radius) + std::abs(d[2]) * double(topic.half[2]);
    case ShapeKind::cylinder:
        return reach + std::hypot(d[0], d[1]) * double(topic.radius) + std::abs(d[2]) * double(topic.half[2]);
    case ShapeKind::box:
    case ShapeKind::hull: break;
    }
    return reach + std::abs(d[0]) * double(topic.half[0]) + std::abs(d[1]) * double(topic.half[1]) +
           std::abs(d[2]) * double(topic.half[2]);
}

TEST(ShapeRound, TopicsAreTheSolidsAndHullsTheirBoxes)
{
    const std::uint64_t seed = std::random_device{}();
    std::mt19937_64 random(seed);
    for (int i = 0; i < 3'000; ++i) {
        std::vector<Point3> vertices(1 + random() % kMaxHullVertices);
        const Vec3 far = vector_in(random, 100.0);  // as those of a map, whose centre is the map's origin
        for (Point3& p : vertices) {
            p = Point3::of(far + vector_in(random, 4.0));
        }
        const Shape shape = random_shape(random, vertices);
        ObstacleTopic topic;
        put_shape(shape, topic);
        ASSERT_TRUE(is_shape(topic)) << "seed " << seed << ", shape " << i;
        ASSERT_EQ(topic.kind, static_cast<std::uint8_t>(shape.kind));
        const bool is_hull = shape.kind == ShapeKind::hull;
        ASSERT_EQ(topic.is_bound, is_hull);
        for (int k = 0; k < 12; ++k) {
            Vec3 direction = k < 6 ? Vec3(shape.axes.col(k / 2) * (k % 2 == 0 ? 1.0F : -1.0F))
                                   : (vector_in(random, 1.0) + Vec3(0.01F, 0.0F, 0.0F)).normalized();
            const double truly = double(direction.dot(geometry::support(shape, direction)));
            const double shown = reach_of(topic, {double(direction.x()), double(direction.y()), double(direction.z())});
            constexpr double kRounding = 1e-3;  // coordinates up to 300 m
            EXPECT_GE(shown, truly - kRounding) << "seed " << seed << ", shape " << i << ", direction " << k;
            if (!is_hull || k < 6) {
                EXPECT_LE(shown, truly + kRounding) << "seed " << seed << ", shape " << i << ", direction " << k;
            }
        }
    }
}

/// What the control loop does with a round.
struct Loop {
    ShapeRound round;
    std::vector<ObstacleTopic> obstacles;  ///< of the last step
    std::vector<AreaTopic> areas;
    bool has_begun = false;

    void step(std::span<const world::Obstacle> known, std::size_t sensed, std::span<const world::Cylinder> closed,
              TimePoint now)
    {
        obstacles.clear();
        areas.clear();
        has_begun = round.is_due(now) && !(known.empty() && closed.empty());
        if (has_begun) {
            round.begin(known, sensed, closed, now);
        }
        for (std::size_t i = 0; i < ShapeRound::kPerStep && round.goes_on(); ++i) {
            if (round.is_next_area()) {
                areas.push_back(round.next_area(now));
            } else {
                obstacles.push_back(round.next_obstacle(now));
            }
        }
    }
};

struct Tables {
    std::vector<world::Obstacle> obstacles;
    std::size_t sensed = 0;
    std::vector<world::Cylinder> areas;
};

/// Some of before go, others come, some move.
void change(Tables& tables, std::mt19937_64& random, std::uint32_t& next_id)
{
    std::erase_if(tables.obstacles, [&](const world::Obstacle&) { return random() % 8 == 0; });
    std::erase_if(tables.areas, [&](const world::Cylinder&) { return random() % 8 == 0; });
    for (world::Obstacle& obstacle : tables.obstacles) {
        obstacle.shape.centre.x() += random() % 4 == 0 ? 1.0F : 0.0F;
    }
    if (random() % 50 == 0) {
        tables = {};
    }
    const std::size_t wanted = random() % (kMaxObstacles + 1);
    while (tables.obstacles.size() < wanted && random() % 16 != 0) {
        const auto place = static_cast<std::ptrdiff_t>(random() % (tables.obstacles.size() + 1));
        tables.obstacles.insert(tables.obstacles.begin() + place,
                                {next_id++, geometry::make_sphere(vector_in(random, 50.0), 1.0F), 0.5F});
    }
    while (tables.areas.size() < kMaxCylinders && random() % 3 != 0) {
        world::Cylinder area;
        area.circle = {vector_in(random, 100.0).head<2>(), 5.0F};
        area.velocity = vector_in(random, 5.0).head<2>();
        area.top = 50.0F;
        tables.areas.push_back(area);
    }
    tables.sensed = random() % (tables.obstacles.size() + 1);
}

/// A round is the tables of the step at which it began, whatever they become; and so it is to who lacks messages.
TEST(ShapeRound, RoundsOfTablesThatChangeAreTheTablesOfOneStep)
{
    const std::uint64_t seed = std::random_device{}();
    std::mt19937_64 random(seed);
    for (int flight = 0; flight < 40; ++flight) {
        Loop loop;
        Tables tables;
        Tables at_begin;
        ShapeCollector all;
        ShapeCollector with_losses;
        const double loss = uniform(random, 0.0, 0.1);
        std::int64_t now = 1'000'000 + static_cast<std::int64_t>(random() % 1'000'000'000);
        std::int64_t began = 0;
        std::uint32_t next_id = 1;
        std::size_t out = 0;
        std::size_t rounds = 0;
        for (int step = 0; step < 400; ++step) {
            now += 20'000 + static_cast<std::int64_t>(random() % 3'000);
            change(tables, random, next_id);
            loop.step(tables.obstacles, tables.sensed, tables.areas, {now});
            if (loop.has_begun) {
                ASSERT_TRUE(began == 0 || now - began >= ShapeRound::kPeriod) << "seed " << seed;
                ASSERT_TRUE(began == 0 || out == at_begin.obstacles.size() + at_begin.areas.size()) << "seed " << seed;
                at_begin = tables;
                began = now;
                out = 0;
            }
            ASSERT_LE(loop.obstacles.size() + loop.areas.size(), ShapeRound::kPerStep);
            bool is_complete = false;
            for (const ObstacleTopic& o : loop.obstacles) {
                const world::Obstacle& truly = at_begin.obstacles.at(out++);
                ASSERT_EQ(o.id, truly.id) << "seed " << seed << ", flight " << flight << ", step " << step;
                ASSERT_EQ(o.centre, xyz_of(truly.shape.centre));
                ASSERT_EQ(o.of_map, o.number >= at_begin.sensed);
                ASSERT_EQ(o.known, static_cast<std::uint64_t>(began));
                ASSERT_EQ(o.timestamp, static_cast<std::uint64_t>(now));
                is_complete = all.take(o);
                static_cast<void>(uniform(random, 0.0, 1.0) >= loss && with_losses.take(o));
            }
            for (const AreaTopic& a : loop.areas) {
                const world::Cylinder& truly = at_begin.areas.at(out++ - at_begin.obstacles.size());
                ASSERT_EQ(a.centre[1], truly.circle.centre.y()) << "seed " << seed;
                ASSERT_EQ(a.velocity[0], truly.velocity.x());
                is_complete = all.take(a);
                static_cast<void>(uniform(random, 0.0, 1.0) >= loss && with_losses.take(a));
            }
            if (is_complete) {
                ASSERT_EQ(out, at_begin.obstacles.size() + at_begin.areas.size());
                ASSERT_EQ(all.complete().obstacles.size(), at_begin.obstacles.size());
                ASSERT_EQ(all.complete().areas.size(), at_begin.areas.size());
                ++rounds;
            }
            std::set<std::uint32_t> ids;
            for (const ObstacleTopic& o : with_losses.complete().obstacles) {
                ASSERT_TRUE(ids.insert(o.id).second) << "seed " << seed << ": twice " << o.id;
            }
            const bool is_newest = with_losses.complete().known == all.complete().known;
            ASSERT_TRUE(!is_newest || ids.size() == all.complete().obstacles.size()) << "seed " << seed;
        }
        EXPECT_GT(rounds, 3U) << "seed " << seed;
    }
}

TEST(ShapeRound, FullTablesTake32StepsAndNothingKnownNone)
{
    Loop loop;
    loop.step({}, 0, {}, {5'000'000});
    EXPECT_FALSE(loop.round.goes_on());
    std::vector<world::Obstacle> obstacles(kMaxObstacles);
    const std::vector<world::Cylinder> areas(kMaxCylinders);
    for (std::uint32_t i = 0; i < obstacles.size(); ++i) {
        obstacles[i] = {i, geometry::make_sphere(Vec3(float(i), 0.0F, 0.0F), 1.0F), 0.0F};
    }
    std::size_t messages = 0;
    std::size_t steps = 0;
    std::int64_t now = 5'020'000;
    for (; now < 5'020'000 + ShapeRound::kPeriod; now += 20'000) {
        loop.step(obstacles, obstacles.size(), areas, {now});
        messages += loop.obstacles.size() + loop.areas.size();
        steps += loop.obstacles.empty() && loop.areas.empty() ? 0U : 1U;
    }
    EXPECT_EQ(messages, kMaxObstacles + kMaxCylinders);
    EXPECT_EQ(steps, (kMaxObstacles + kMaxCylinders) / ShapeRound::kPerStep);
    loop.step(obstacles, obstacles.size(), areas, {now});
    EXPECT_EQ(loop.obstacles.size(), ShapeRound::kPerStep) << "the next round";
}

}  // namespace
