// SPDX-License-Identifier: BSD-3-Clause
// Cylinders: exact limits, rounding at large coordinates, slopes, and the cost of the search between two instants.
#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/base/work_units.hpp"
#include "core/world/cylinder.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;
using detail::CylinderApproach;

Cylinder body(const Vec2& centre, float radius, float bottom, float top, const Vec2& velocity = Vec2::Zero())
{
    return {{centre, radius}, velocity, bottom, top, 0.0F};
}

TEST(CylinderEdges, LimitsAreTaken)
{
    const float far = 1e5F;
    Cylinder most = body(Vec2(far, -far), far, -far, far, Vec2(500, -500));
    most.margin = far;
    EXPECT_TRUE(is_valid(most));
    const std::function<void(Cylinder&)> beyond[] = {
        [](Cylinder& b) { b.circle.centre.x() *= 1.001F; },
        [](Cylinder& b) { b.circle.centre.y() *= 1.001F; },
        [](Cylinder& b) { b.circle.radius *= 1.001F; },
        [](Cylinder& b) { b.bottom *= 1.001F; },
        [](Cylinder& b) { b.top *= 1.001F; },
        [](Cylinder& b) { b.velocity.x() *= 1.001F; },
        [](Cylinder& b) { b.velocity.y() *= 1.001F; },
        [](Cylinder& b) { b.margin *= 1.001F; },
        [](Cylinder& b) { b.margin = -1e-6F; },
        [](Cylinder& b) { b.circle.radius = 0.0F; },
        [](Cylinder& b) { b.bottom = 5.0F, b.top = 4.0F; },
    };
    for (const auto& change : beyond) {
        Cylinder b = most;
        change(b);
        EXPECT_FALSE(is_valid(b));
    }
    most.bottom = most.top = 3.0F;
    EXPECT_TRUE(is_valid(most)) << "as flat as can be";
}

double true_distance(const Vec3& half, const Vec3& own, const Cylinder& b, double t)
{
    const double x = double(b.circle.centre.x()) + double(b.velocity.x()) * t - double(own.x());
    const double y = double(b.circle.centre.y()) + double(b.velocity.y()) * t - double(own.y());
    const auto off = [](double c, double h) { return c - std::clamp(c, -h, h); };
    const double level = std::hypot(off(x, double(half.x())), off(y, double(half.y()))) - double(b.circle.radius);
    const double z = double(own.z());
    const double height = std::max(double(b.bottom) - double(half.z()) - z, z - double(half.z()) - double(b.top));
    return level > 0.0 && height > 0.0 ? std::hypot(level, height) : std::max(level, height);
}

/// At any distance from the origin, on any side: never above the true value, and at most 1e-6 of the coordinates below
/// it.
TEST(CylinderEdges, RoundingIsOnTheSafeSideAtLargeCoordinates)
{
    Random random(20261201);
    for (int i = 0; i < 8000; ++i) {
        const auto sized = [&](float most) {
            const float size = most * std::pow(10.0F, random.uniform(-4.0F, 0.0F));
            return random.below(2) == 0 ? size : -size;
        };
        Cylinder b = body(Vec2(sized(5e4F), sized(5e4F)), std::abs(sized(5e3F)) + 0.1F, sized(1e4F), 0.0F,
                          Vec2(sized(300.0F), sized(300.0F)));
        b.top = b.bottom + std::abs(sized(1e4F));
        const Vec3 half(random.uniform(0.2F, 3.0F), random.uniform(0.2F, 3.0F), random.uniform(0.2F, 3.0F));
        const Seconds t = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 60.0F);
        const Vec2 now = b.circle.centre + b.velocity * t;
        const float near = random.below(2) == 0 ? 1.5F : 0.02F;
        const Vec3 own(now.x() + near * sized(b.circle.radius), now.y() + near * sized(b.circle.radius),
                       b.bottom + random.uniform(-1.2F, 2.2F) * (b.top - b.bottom));
        const double truth = true_distance(half, own, b, double(t));
        const double reported = double(cylinder_distance(half, own, b, t));
        const double size = double(b.circle.centre.cwiseAbs().sum() + (b.velocity * t).cwiseAbs().sum() +
                                   own.cwiseAbs().sum() + half.sum() + b.circle.radius) +
                            std::abs(double(b.bottom)) + std::abs(double(b.top));
        ASSERT_LE(reported, truth) << i;
        ASSERT_GE(reported, truth - 1e-6 * size - 1e-6) << i;
    }
}

/// A moving box against a moving body, `t` seconds after the beginning.
struct Approaching {
    explicit Approaching(Random& random)
        : half(random.uniform(0.2F, 2.0F), random.uniform(0.2F, 2.0F), random.uniform(0.2F, 2.0F)),
          own{Vec3(random.uniform(-40, 40), random.uniform(-40, 40), random.uniform(-20, 20)),
              Vec3(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-3, 3))},
          cylinder(body(Vec2(random.uniform(-9, 9), random.uniform(-9, 9)), random.uniform(0.5F, 20.0F), -5.0F,
                        random.uniform(-4.0F, 9.0F), Vec2(random.uniform(-6, 6), random.uniform(-6, 6)))),
          outset(random.uniform(-0.5F, 0.9F)), growth(random.below(2) == 0 ? 0.0F : random.uniform(0.1F, 0.8F))
    {
    }
    [[nodiscard]] double truth(double t) const
    {
        // The box at rest at its first place, the body's motion relative to it; heights likewise.
        Cylinder b = cylinder;
        const double z = double(own.position.z()) + double(own.velocity.z()) * t;
        b.velocity -= own.velocity.head<2>();
        const Vec3 at(own.position.x(), own.position.y(), static_cast<float>(z));
        return true_distance(half, at, b, t) - double(outset) - double(growth) * t;
    }
    /// The same without rounding, at any distance.
    [[nodiscard]] double exact(double t) const
    {
        const auto off = [](double c, double h) { return c - std::clamp(c, -h, h); };
        const auto gap = [&](int axis) {
            return double(cylinder.circle.centre[axis]) + double(cylinder.velocity[axis]) * t -
                   (double(own.position[axis]) + double(own.velocity[axis]) * t);
        };
        const double level =
            std::hypot(off(gap(0), double(half.x())), off(gap(1), double(half.y()))) - double(cylinder.circle.radius);
        const double z = double(own.position.z()) + double(own.velocity.z()) * t;
        const double height =
            std::max(double(cylinder.bottom) - double(half.z()) - z, z - double(half.z()) - double(cylinder.top));
        const double apart = level > 0.0 && height > 0.0 ? std::hypot(level, height) : std::max(level, height);
        return apart - double(outset) - double(growth) * t;
    }
    Vec3 half;
    geometry::Motion own;
    Cylinder cylinder;
    float outset;
    float growth;
};

TEST(CylinderApproach, LooksAreDistancesAndTheirSlopes)
{
    Random random(20261202);
    int compared = 0;
    for (int i = 0; i < 4000; ++i) {
        const Approaching a(random);
        const CylinderApproach approach(a.half, a.own, a.cylinder, 0.0F, a.outset, a.growth);
        const float t = random.uniform(0.1F, 6.0F);
        const auto look = approach.look(t);
        ASSERT_LE(double(look.value), a.truth(double(t)) + 1e-5) << i;
        ASSERT_GE(double(look.value), a.truth(double(t)) - 2e-3) << i;
        const double h = 1e-3;
        const double before = (a.truth(double(t)) - a.truth(double(t) - h)) / h;
        const double after = (a.truth(double(t) + h) - a.truth(double(t))) / h;
        if (std::abs(after - before) < 0.05) {
            ++compared;
            ASSERT_NEAR(double(look.slope), 0.5 * (before + after), 0.06) << i;
        }
    }
    EXPECT_GT(compared, 3000);
}

/// Fast and long: the rounding bound of each speed and growth is subtracted, for either sign.
TEST(CylinderApproach, LooksNeverSayMoreThanThereIs)
{
    Random random(20261204);
    for (int i = 0; i < 6000; ++i) {
        Approaching a(random);
        const auto fast = [&] { return random.below(2) == 0 ? random.uniform(-400.0F, 400.0F) : 0.0F; };
        const Seconds t = random.uniform(10.0F, 60.0F);
        a.own.velocity = Vec3(fast(), fast(), random.below(3) == 0 ? 0.0F : random.uniform(-400.0F, 400.0F));
        a.cylinder.velocity = Vec2(fast(), fast());
        // Near to each other after that time.
        const Vec2 met = a.cylinder.circle.centre + a.cylinder.velocity * t;
        a.own.position.head<2>() =
            met - a.own.velocity.head<2>() * t + 1.3F * a.cylinder.circle.radius * Vec2(random.uniform(-1, 1), 0.7F);
        a.own.position.z() = random.uniform(-12.0F, 16.0F) - a.own.velocity.z() * t;
        const CylinderApproach approach(a.half, a.own, a.cylinder, 0.0F, a.outset, a.growth);
        const double size = double(a.own.position.cwiseAbs().sum() + a.cylinder.velocity.cwiseAbs().sum() * t +
                                   a.own.velocity.cwiseAbs().sum() * t) +
                            60.0;
        ASSERT_LE(double(approach.look(t).value), a.exact(double(t))) << i;
        ASSERT_GE(double(approach.look(t).value), a.exact(double(t)) - 2e-6 * size) << i;
    }
}

/// Least value and its instant, against four hundred samples.
TEST(CylinderApproach, TheLeastIsFoundWhereItIs)
{
    Random random(20261203);
    std::uint32_t most_spent = 0;
    std::uint32_t all = 0;
    for (int i = 0; i < 600; ++i) {
        const Approaching a(random);
        const CylinderApproach approach(a.half, a.own, a.cylinder, 0.0F, a.outset, a.growth);
        const float span = random.uniform(0.5F, 12.0F);
        WorkBudget budget(kPlenty);
        const geometry::Approach near = approach.least(span, 1e9F, budget);
        double least = 1e9;
        for (int k = 0; k <= 400; ++k) {
            least = std::min(least, a.truth(double(span) * k / 400.0));
        }
        ASSERT_LE(double(near.distance), least + 1e-5) << i;
        ASSERT_GE(near.when, 0.0F);
        ASSERT_LE(near.when, span);
        ASSERT_LE(a.truth(double(near.when)), least + 3e-3) << i << ": that is where it is";
        const double step = double(span) / 400.0 * 20.0;
        ASSERT_GE(double(near.distance), least - 2e-3 - step) << i;
        most_spent = std::max(most_spent, budget.spent());
        all += budget.spent();
        WorkBudget enough(kPlenty);
        ASSERT_GE(approach.least(span, -1e8F, enough).distance, -1e8F);
        ASSERT_EQ(enough.spent(), units::kCylinderPart) << "nothing is below that: no instant between is looked at";
    }
    EXPECT_LT(most_spent, units::kCylinderPart + (CylinderApproach::kTurns - 4) * units::kCylinderTurn);
    EXPECT_LT(all, 600U * (units::kCylinderPart + 5 * units::kCylinderTurn));
    std::printf("[ measured ] instants: %u units at most, %.1f on average\n", most_spent, double(all) / 600.0);
}

/// An approach that is nearest in the middle of its time.
const CylinderApproach kPassing(Vec3::Ones(), {Vec3(-20, 8, 0), Vec3(5, 0, 0)},
                                {{Vec2::Zero(), 3.0F}, Vec2::Zero(), -10.0F, 10.0F, 0.0F}, 0.0F, 0.0F, 0.0F);

TEST(CylinderApproach, WithoutABudgetThereIsContact)
{
    WorkBudget plenty(kPlenty);
    EXPECT_NEAR(kPassing.least(8.0F, 1e9F, plenty).distance, 4.0F, 1e-3F);
    EXPECT_NEAR(kPassing.least(8.0F, 1e9F, plenty).when, 4.0F, 0.3F);
    WorkBudget none(units::kCylinderPart - 1);
    EXPECT_EQ(kPassing.least(8.0F, 1e9F, none).distance, -CylinderApproach::kNoBudget);
    WorkBudget ends(units::kCylinderPart);
    EXPECT_EQ(kPassing.least(8.0F, 1e9F, ends).distance, -CylinderApproach::kNoBudget);
    WorkBudget no_contact(16);
    EXPECT_EQ(kPassing.first_contact(4.0F, no_contact), 0.0F);
}

TEST(CylinderApproach, AtAnInstantItIsWhatItIsThere)
{
    WorkBudget budget(kPlenty);
    const geometry::Approach near = kPassing.least(0.0F, 1e9F, budget);
    EXPECT_EQ(near.when, 0.0F);
    EXPECT_EQ(near.distance, kPassing.look(0.0F).value);
}

TEST(CylinderApproach, TheFirstContactIsNotLate)
{
    const CylinderApproach approach(Vec3::Ones(), {Vec3(-20, 0, 0), Vec3(5, 0, 0)},
                                    body(Vec2::Zero(), 3.0F, -10.0F, 10.0F), 0.0F, 0.0F, 0.0F);
    WorkBudget budget(kPlenty);
    const Seconds first = approach.first_contact(4.0F, budget);
    EXPECT_LE(first, 16.0F / 5.0F);
    EXPECT_GE(first, 16.0F / 5.0F - 4.0F / 65536.0F - 1e-5F);
}

}  // namespace
}  // namespace jink::world
