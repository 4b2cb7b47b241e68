// SPDX-License-Identifier: BSD-3-Clause
// Vehicles that want the worst and are held back by stoppable_command alone: no planner, no fallback. Each knows the
// others by reports that are late, seldom and lost.
//
// Law: no two of them ever come nearer than their separations, whatever they want.
#include "core/avoid/common_stop.hpp"

#include <deque>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/geometry/sweep.hpp"
#include "tests/property/core/geometry/oracle.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::avoid {
namespace {

using geometry::oracle::case_count;
using geometry::oracle::seed_of;

constexpr Seconds kTick = 0.02F;
constexpr float kAny = std::numeric_limits<float>::infinity();

struct Report {
    TimePoint stamp;
    Vec3 position;
    Vec3 velocity;
};

struct Flier {
    vehicle::VehicleState state;
    Vec3 wants = Vec3::Zero();
    Vec3 said = Vec3::Zero();  ///< the newest command
    bool is_held_back = false;
    Vec3 command = Vec3::Zero();  ///< what the autopilot flies
    std::deque<Vec3> on_the_way;  ///< commands that the autopilot does not have yet
    std::vector<Report> heard;    ///< the last of each
};

struct Crowd {
    explicit Crowd(Random& random) : random_(random)
    {
        limits.cruise_speed = random.uniform(1.0F, 12.0F);
        limits.max_acceleration = random.uniform(1.0F, 6.0F);
        limits.max_vertical_acceleration = limits.max_acceleration * random.uniform(0.4F, 1.0F);
        limits.max_climb = limits.max_descent = limits.cruise_speed;
        limits.velocity_lag = random.uniform(0.0F, 0.4F);
        limits.half_extents = {random.uniform(0.3F, 2.0F), 0.0F, random.uniform(0.3F, 1.0F)};
        limits.half_extents.y() = limits.half_extents.x();
        rules.latency = random.uniform(0.05F, 0.3F);
        loss = random.uniform(0.0F, 0.8F);
        delay = random.uniform(0.0F, 1.0F);
        // A set-point counts from the next one on.
        held = random.below(static_cast<std::uint64_t>(rules.latency / kTick));
        evades = random.below(2) == 0;
        const std::size_t n = 2 + random.below(5);
        const float apart = 30.0F + limits.cruise_speed * limits.cruise_speed / limits.max_acceleration;
        for (std::size_t i = 0; i < n; ++i) {
            Flier v;
            const float angle = 2.0F * kPi * static_cast<float>(i) / static_cast<float>(n);
            v.state.position = {apart * std::cos(angle), apart * std::sin(angle), 100.0F + random.uniform(-3.0F, 3.0F)};
            v.heard.assign(n, {});
            vehicles.push_back(v);
        }
    }

    void report()
    {
        for (Flier& hears : vehicles) {
            for (std::size_t i = 0; i < vehicles.size(); ++i) {
                if (static_cast<float>(past.size()) * kTick > delay &&
                    (random_.uniform() >= loss || hears.heard[i].stamp == TimePoint{})) {
                    hears.heard[i] = past.front()[i];
                }
            }
        }
    }

    /// After another one, through the middle, or anywhere, for a while.
    void want(std::size_t own)
    {
        Flier& v = vehicles[own];
        if (random_.uniform() < 0.99F) {
            return;
        }
        const Flier& other = vehicles[random_.below(vehicles.size())];
        Vec3 to = other.state.position + 1.0F * other.state.velocity - v.state.position;
        if (random_.below(3) == 0) {
            to = Vec3(0.0F, 0.0F, 100.0F) - v.state.position;
        }
        if (random_.below(4) == 0) {
            to = {random_.uniform(-1.0F, 1.0F), random_.uniform(-1.0F, 1.0F), random_.uniform(-0.5F, 0.5F)};
        }
        v.wants = vehicle::clamped_velocity(to, limits.cruise_speed * random_.uniform(0.3F, 1.0F), limits);
    }

    Vec3 held_back(std::size_t own)
    {
        world::test::Scene scene;
        scene.now = now;
        scene.limits = limits;
        scene.rules = rules;
        scene.own = vehicles[own].state;
        scene.own.stamp = now;
        for (std::size_t i = 0; i < vehicles.size(); ++i) {
            const Report& r = vehicles[own].heard[i];
            if (i != own && r.stamp != TimePoint{}) {
                world::Track& t = scene.track(r.position + r.velocity * (now - r.stamp), r.velocity, kBody);
                t.stamp = r.stamp;
                t.cooperative = true;
                t.sigma_position = t.sigma_velocity = 0.0F;
            }
        }
        WorkBudget budget(1'000'000);
        const world::Situation s = scene.situation();
        const Vec3& wants = vehicles[own].wants;
        Flier& v = vehicles[own];
        const float fastest = v.is_held_back ? v.said.norm() + limits.max_acceleration * kTick : kAny;
        v.said = stoppable_command(s, wants, fastest, budget, evades);
        v.is_held_back = v.said != wants;
        slowed += v.is_held_back ? 1 : 0;
        return v.said;
    }

    void step()
    {
        now = now + kTick;
        std::vector<Report> all;
        for (std::size_t i = 0; i < vehicles.size(); ++i) {
            want(i);
            Flier& v = vehicles[i];
            all.push_back({now, v.state.position, v.state.velocity});
        }
        past.push_back(all);
        while (static_cast<float>(past.size() - 1) * kTick > delay) {
            past.pop_front();
        }
        if (++ticks % 5 == 0) {
            report();
        }
        // One after the other, each with what the others do already.
        for (std::size_t i = 0; i < vehicles.size(); ++i) {
            Flier& v = vehicles[i];
            v.on_the_way.push_back(held_back(i));
            if (v.on_the_way.size() > held) {
                v.command = v.on_the_way.front();
                v.on_the_way.pop_front();
            }
            vehicle::advance(v.state, v.command, limits, kTick);
        }
    }

    [[nodiscard]] float margin() const
    {
        float least = 1e9F;
        for (std::size_t i = 0; i < vehicles.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                const Vec3 apart = vehicles[i].state.position - vehicles[j].state.position;
                least = std::min(least, geometry::box_distance(limits.half_extents, apart) - kBody);
            }
        }
        return least;
    }

    static constexpr float kBody = 0.4F;
    vehicle::VehicleLimits limits;
    world::FlightRules rules;
    float loss = 0.0F;
    Seconds delay = 0.0F;
    std::size_t held = 0;
    bool evades = false;  ///< what is wanted is said to be a manoeuvre
    std::vector<Flier> vehicles;
    std::deque<std::vector<Report>> past;
    TimePoint now{1'000'000};
    int ticks = 0;
    int slowed = 0;

private:
    Random& random_;
};

TEST(CommonStop, KeepsVehiclesApartWhateverTheyWant)
{
    const std::size_t cases = case_count(60);
    int slowed = 0;
    for (std::size_t i = 0; i < cases; ++i) {
        Random random(seed_of(1) + i);
        Crowd d(random);
        float margin = 1e9F;
        for (int tick = 0; tick < 1500; ++tick) {
            d.step();
            margin = std::min(margin, d.margin());
        }
        EXPECT_GE(margin, 0.0F) << "case " << i << ", " << d.vehicles.size() << " vehicles, cruise "
                                << d.limits.cruise_speed << ", acceleration " << d.limits.max_acceleration << " "
                                << d.limits.max_vertical_acceleration << ", lag " << d.limits.velocity_lag << ", delay "
                                << d.delay << ", loss " << d.loss << ", latency " << d.rules.latency;
        slowed += d.slowed;
    }
    EXPECT_GT(slowed, 1000) << "else nothing was tried";
}

/// A vehicle at 4 m/s on its way east, and another one that it avoids and that avoids it.
struct Pair : world::test::Scene {
    Pair()
    {
        own.velocity = {4, 0, 0};
        own.stamp = now;
    }
    world::Track& other(const Vec3& position, const Vec3& velocity)
    {
        world::Track& t = track(position, velocity);
        t.cooperative = true;
        return t;
    }
    [[nodiscard]] Vec3 flown(const Vec3& wanted = {4, 0, 0}, std::uint32_t units = 100'000, float fastest = kAny,
                             bool evades = false) const
    {
        WorkBudget budget(units);
        return stoppable_command(situation(), wanted, fastest, budget, evades);
    }
};

TEST(CommonStop, LetsACommandBeThatLeavesTheStop)
{
    Pair far;
    far.other({40, 0, 0}, {-4, 0, 0});
    EXPECT_EQ(far.flown(), Vec3(4, 0, 0));
    Pair beside;
    beside.other({0, 12, 0}, {4, 0, 0});
    EXPECT_EQ(beside.flown(), Vec3(4, 0, 0));
    Pair alone;
    EXPECT_EQ(alone.flown(), Vec3(4, 0, 0));
}

TEST(CommonStop, SlowsDownByHowOldTheReportIs)
{
    float before = 10.0F;
    for (const Seconds age : {0.0F, 0.3F, 0.6F, 1.0F, 2.0F}) {
        Pair pair;
        pair.own.velocity = {2, 0, 0};
        world::Track& other = pair.other({9, 0, 0}, {0, 0, 0});
        other.stamp = pair.now - age;
        const float speed = pair.flown().x();
        EXPECT_LE(speed, before) << age;
        EXPECT_GE(speed, 0.0F);
        before = speed;
    }
    EXPECT_EQ(before, 0.0F) << "two seconds hide 10 m";
}

TEST(CommonStop, KeepsClearOfWhatAVehicleHasShownThatItCan)
{
    const auto speed = [](float shown) {
        Pair pair;
        pair.own.velocity = {2, 0, 0};
        pair.limits.max_acceleration = 2.0F;
        pair.limits.max_vertical_acceleration = 1.0F;
        world::Track& other = pair.other({8, 0, 0}, {0, 0, 0});
        other.stamp = pair.now - 0.6F;
        other.shown_acceleration = shown;
        return pair.flown().x();
    };
    const float usual = speed(0.0F);
    EXPECT_GT(usual, 1.0F);
    EXPECT_EQ(speed(2.4F), usual) << "less than a quarter more is noise";
    EXPECT_LT(speed(4.0F), usual);
    EXPECT_LT(speed(8.0F), speed(4.0F));
}

TEST(CommonStop, ComesUpAgainNoFasterThanItMay)
{
    Pair far;
    far.other({40, 0, 0}, {-4, 0, 0});
    EXPECT_EQ(far.flown({4, 0, 0}, 100'000, 1.0F), Vec3(1, 0, 0));
    EXPECT_EQ(far.flown({4, 0, 0}, 100'000, 0.0F), Vec3(0, 0, 0));
    EXPECT_EQ(far.flown({4, 0, 0}, 100'000, 4.5F), Vec3(4, 0, 0));
    EXPECT_EQ(far.flown({0, 0, 0}, 100'000, 0.0F), Vec3(0, 0, 0));
}

TEST(CommonStop, StopsInFrontOfOneThatComes)
{
    Pair pair;
    pair.other({6, 0, 0}, {-4, 0, 0});
    EXPECT_EQ(pair.flown(), Vec3(0, 0, 0));
    pair.tracks[0].cooperative = false;
    EXPECT_EQ(pair.flown(), Vec3(4, 0, 0)) << "that one does not stop: the planners' business";
}

/// One comes from the right. A stop is too late for a near one, which flying on is better for; and not clear of a far
/// one only as long as that may have come nearer since its report.
TEST(CommonStop, EvadesWhereAStopIsTooLateAsReported)
{
    const Vec3 on = {4, 0, 0};
    Pair near;
    near.other({0.5F, -3.5F, 0}, {0, 4, 0});
    EXPECT_EQ(near.flown(on, 100'000, kAny, true), on);
    EXPECT_EQ(near.flown(on), Vec3(0, 0, 0)) << "no manoeuvre";
    EXPECT_EQ(near.flown({0, -4, 0}, 100'000, kAny, true), Vec3(0, 0, 0)) << "nearer than a stop";
    Pair old;
    old.other({0.5F, -8, 0}, {0, 4, 0}).stamp = old.now - 1.0F;
    EXPECT_EQ(old.flown(on, 100'000, kAny, true), Vec3(0, 0, 0));
    Pair both = near;
    both.other({4, 0, 0}, {0, 0, 0});
    EXPECT_EQ(both.flown(on, 100'000, kAny, true), Vec3(0, 0, 0)) << "into one that a stop is clear of";
}

TEST(CommonStop, LeavesTheReachOfOneThatStandsTooNear)
{
    Pair pair;
    pair.own.velocity = Vec3::Zero();
    pair.other({2.5F, 0, 0}, Vec3::Zero()).stamp = pair.now - 1.0F;
    const Vec3 flown = pair.flown();
    EXPECT_LT(flown.x(), 0.0F);
    EXPECT_NEAR(flown.norm(), 0.3F, 1e-3F);
    pair.other({-2.1F, 0, 0}, Vec3::Zero());
    EXPECT_EQ(pair.flown(), Vec3(0, 0, 0)) << "shut in";
}

/// Nearer than this, of two that stand either one has to leave, or neither may move. docs/guides/common_stop.md.
TEST(CommonStop, TwoThatStandNeedSpaceThatGrowsWithTheAccelerationAndTheSquareOfTheAge)
{
    for (const float acceleration : {0.5F, 1.0F, 2.0F, 4.0F}) {
        for (const Seconds age : {0.1F, 0.5F, 1.0F, 1.5F}) {
            const auto stands_clear = [&](float distance) {
                Pair pair;
                pair.own.velocity = Vec3::Zero();
                pair.limits.cruise_speed = 20.0F;
                pair.limits.max_acceleration = pair.limits.max_vertical_acceleration = acceleration;
                pair.other({distance, 0, 0}, Vec3::Zero()).stamp = pair.now - age;
                return pair.flown(Vec3::Zero()) == Vec3(0, 0, 0);
            };
            float low = 0.0F;
            float high = 50.0F;
            while (high - low > 1e-3F) {
                const float middle = 0.5F * (low + high);
                (stands_clear(middle) ? high : low) = middle;
            }
            const Pair pair;
            const Seconds unheard = age + pair.rules.latency;
            const float expected = pair.limits.half_extents.x() + 1.0F + acceleration * unheard * unheard;
            EXPECT_NEAR(high, expected, 0.02F) << acceleration << " m/s2, " << age << " s";
        }
    }
}

TEST(CommonStop, IsNoReasonToStopInAnAircraftsWay)
{
    Pair pair;
    pair.other({6, 0, 0}, {-4, 0, 0});
    pair.track({-12, 0, 0}, {12, 0, 0});
    EXPECT_EQ(pair.flown(Vec3(4, 4, 0)), Vec3(4, 4, 0));
}

TEST(CommonStop, StopsWithoutBudgetAndLeavesWingsAlone)
{
    Pair pair;
    pair.other({40, 0, 0}, {-4, 0, 0});
    EXPECT_EQ(pair.flown(Vec3(4, 0, 0), 10), Vec3(0, 0, 0));
    pair.limits.kind = vehicle::VehicleKind::fixed_wing;
    EXPECT_EQ(pair.flown(Vec3(4, 0, 0), 10), Vec3(4, 0, 0));
}

}  // namespace
}  // namespace jink::avoid
