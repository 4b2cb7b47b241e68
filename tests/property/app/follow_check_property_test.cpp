// SPDX-License-Identifier: BSD-3-Clause
// A vehicle that follows is never accused, one that does not is found within the time stated. JINK_CASES and JINK_SEED.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "core/base/random.hpp"
#include "firmware/app/follow_check.hpp"

namespace jink::app {
namespace {

constexpr float kStep = 0.02F;

std::uint64_t number_of(const char* name, std::uint64_t normal)
{
    const char* text = std::getenv(name);
    return text != nullptr ? std::strtoull(text, nullptr, 0) : normal;
}

/// Velocity in double, written independently of core's vehicle: dead time, first-order lag, an acceleration that is
/// limited and itself takes time, a speed limit, and gusts that push the ground speed and are fought.
struct Craft {
    double acceleration = 2.5, lag = 0.6, dead = 0.2, jerk = 5.0, top = 20.0, gust = 0.0;
    std::array<double, 3> v{}, a{}, push{};
    std::array<std::array<double, 3>, 20> delayed{};
    std::size_t at = 0;

    void step(const Vec3& command, Random& random)
    {
        const std::size_t lead = static_cast<std::size_t>(dead / static_cast<double>(kStep));
        double speed = 0.0;
        for (std::size_t i = 0; i < 3; ++i) {
            delayed[(at + lead) % delayed.size()][i] = static_cast<double>(command[static_cast<int>(i)]);
            speed += delayed[at][i] * delayed[at][i];
        }
        speed = std::sqrt(speed);
        const double cut = speed > top ? top / speed : 1.0;
        double wanted = 0.0;
        std::array<double, 3> want{};
        for (std::size_t i = 0; i < 3; ++i) {
            want[i] = (cut * delayed[at][i] - v[i]) / lag;
            wanted += want[i] * want[i];
        }
        wanted = std::sqrt(wanted);
        const double limit = wanted > acceleration ? acceleration / wanted : 1.0;
        for (std::size_t i = 0; i < 3; ++i) {
            const double change = std::clamp(limit * want[i] - a[i], -jerk * 0.02, jerk * 0.02);
            a[i] += change;
            // A gust with a correlation time of one second; the autopilot's loop compensates its push with a lag.
            push[i] += -push[i] * 0.02 + gust * std::sqrt(2.0 * 0.02) * static_cast<double>(random.normal());
            v[i] += (a[i] + 0.5 * push[i]) * 0.02;
        }
        at = (at + 1) % delayed.size();
    }
    [[nodiscard]] Vec3 seen(Random& random, float sigma) const
    {
        return {static_cast<float>(v[0]) + sigma * random.normal(), static_cast<float>(v[1]) + sigma * random.normal(),
                static_cast<float>(v[2]) + sigma * random.normal()};
    }
};

Vec3 random_command(Random& random)
{
    const float speed = random.uniform(0.0F, 12.0F);
    const Vec3 direction(random.normal(), random.normal(), 0.3F * random.normal());
    return direction.norm() > 1e-3F ? Vec3(direction.normalized() * speed) : Vec3(Vec3::Zero());
}

TEST(FollowCheckLaw, AVehicleThatFollowsIsNeverAccused)
{
    const std::uint64_t cases = number_of("JINK_CASES", 4000);
    const std::uint64_t seed = number_of("JINK_SEED", 20260725);
    std::uint64_t accused = 0;
    for (std::uint64_t i = 0; i < cases; ++i) {
        Random random(seed + i);
        Craft craft;
        craft.acceleration = static_cast<double>(random.uniform(2.5F, 6.0F));
        craft.lag = static_cast<double>(random.uniform(0.2F, 0.6F));
        craft.dead = static_cast<double>(random.uniform(0.0F, 0.3F));
        craft.jerk = static_cast<double>(random.uniform(5.0F, 20.0F));
        craft.top = static_cast<double>(random.uniform(0.0F, 1.0F) < 0.2F ? 7.0F : 20.0F);
        craft.gust = static_cast<double>(random.uniform(0.0F, 1.0F));
        const Vec3 first = random_command(random);
        for (std::size_t k = 0; k < 3; ++k) {
            craft.v[k] = static_cast<double>(first[static_cast<int>(k)]);
            for (auto& d : craft.delayed) {
                d[k] = craft.v[k];
            }
        }
        const auto every = 1 + random.below(5);  // ticks between own states
        const float sigma = random.uniform(0.0F, 0.15F);
        FollowCheck check;
        Vec3 command = first;
        Vec3 seen = first;
        std::uint64_t next = random.below(100);
        for (std::uint64_t tick = 0; tick < 400; ++tick) {
            // Another manoeuvre after 2 s or more: the supervisor keeps one that is still clear.
            if (tick >= next) {
                next = tick + 100 + random.below(100);
                command = random_command(random);
            }
            craft.step(command, random);
            seen = tick % every == 0 ? craft.seen(random, sigma) : seen;
            const TimePoint now{1'000'000 + static_cast<std::int64_t>(tick) * 20'000};
            if (check.update(command, seen, {}, now)) {
                ++accused;
                EXPECT_GT(accused, 1U) << "at " << static_cast<float>(tick) * kStep
                                       << " s; JINK_CASES=1 JINK_SEED=" << seed + i;
                break;
            }
        }
    }
    EXPECT_EQ(accused, 0U) << "of " << cases;
}

/// A plan that is renewed with each report bends the command little by little; then the other side is chosen.
TEST(FollowCheckLaw, AVehicleThatFollowsABendingCommandIsNotAccusedWhenTheCommandTurnsOver)
{
    const std::uint64_t cases = number_of("JINK_CASES", 2000);
    const std::uint64_t seed = number_of("JINK_SEED", 20261124);
    std::uint64_t accused = 0;
    for (std::uint64_t i = 0; i < cases; ++i) {
        Random random(seed + i);
        Craft craft;
        craft.dead = static_cast<double>(random.uniform(0.0F, 0.15F));
        craft.lag = static_cast<double>(random.uniform(0.2F, 0.4F));
        craft.acceleration = static_cast<double>(random.uniform(2.5F, 4.0F));
        craft.v = {-4.0, 3.0, 0.0};
        for (auto& d : craft.delayed) {
            d = craft.v;
        }
        const float rate = random.uniform(0.5F, 1.2F);  // [rad/s]
        const auto flip = 60 + random.below(60);        // ticks
        FollowCheck check;
        for (std::uint64_t tick = 0; tick < flip + 60; ++tick) {
            const float angle = 2.5F - rate * kStep * static_cast<float>(tick);
            const Vec3 bent(5.0F * std::cos(angle), 5.0F * std::sin(angle), 0.0F);
            const Vec3 command = tick < flip ? bent : Vec3(-bent.y(), bent.x(), 0.0F);
            craft.step(command, random);
            accused += check.update(command, craft.seen(random, 0.0F), {},
                                    TimePoint{1'000'000 + static_cast<std::int64_t>(tick) * 20'000})
                           ? 1U
                           : 0U;
        }
        ASSERT_EQ(accused, 0U) << "JINK_CASES=1 JINK_SEED=" << seed + i;
    }
}

/// A velocity that is renewed with each noisy report jumps to and fro about its mean; then the other side is chosen.
TEST(FollowCheckLaw, AVehicleThatFollowsAJumpingCommandIsNotAccusedWhenTheCommandTurnsOver)
{
    const std::uint64_t cases = number_of("JINK_CASES", 2000);
    const std::uint64_t seed = number_of("JINK_SEED", 20261129);
    for (std::uint64_t i = 0; i < cases; ++i) {
        Random random(seed + i);
        Craft craft;
        craft.dead = static_cast<double>(random.uniform(0.1F, 0.25F));
        craft.lag = static_cast<double>(random.uniform(0.2F, 0.4F));
        craft.v = {3.2, 3.8, 0.0};
        for (auto& d : craft.delayed) {
            d = craft.v;
        }
        const auto every = 3 + random.below(4);   // ticks between velocities
        const auto flip = 50 + random.below(40);  // ticks
        FollowCheck check;
        Vec3 command(3.2F, 3.8F, 0.0F);
        for (std::uint64_t tick = 0; tick < flip + 60; ++tick) {
            if (tick % every == 0) {
                const float angle = random.uniform(1.1F, 1.9F);
                command = Vec3(5.0F * std::cos(angle), 5.0F * std::sin(angle), -1.0F);
            }
            const Vec3 asked = tick < flip ? command : Vec3(3.5F, 3.4F, -1.0F);
            craft.step(asked, random);
            ASSERT_FALSE(check.update(asked, craft.seen(random, 0.0F), {},
                                      TimePoint{1'000'000 + static_cast<std::int64_t>(tick) * 20'000}))
                << "at tick " << tick << " of " << flip << "; JINK_CASES=1 JINK_SEED=" << seed + i;
        }
    }
}

/// A manoeuvre and a stop that take turns: an answer is clear as long as the vehicle is slow, and not when it is
/// faster. The vehicle is late by as much as a command lasts, and answers the one before.
TEST(FollowCheckLaw, AVehicleThatFollowsManoeuvresAndStopsThatTakeTurnsIsNotAccused)
{
    const std::uint64_t cases = number_of("JINK_CASES", 2000);
    const std::uint64_t seed = number_of("JINK_SEED", 20261201);
    std::uint64_t accused = 0;
    for (std::uint64_t i = 0; i < cases; ++i) {
        Random random(seed + i);
        Craft craft;
        craft.acceleration = static_cast<double>(random.uniform(2.0F, 4.0F));
        craft.dead = static_cast<double>(random.uniform(0.0F, 0.15F));
        craft.lag = static_cast<double>(random.uniform(0.2F, 0.4F));
        craft.jerk = 20.0;
        craft.gust = static_cast<double>(random.uniform(0.0F, 0.5F));
        vehicle::VehicleLimits limits;
        limits.max_acceleration = static_cast<float>(craft.acceleration);
        const Vec3 manoeuvre(0.0F, random.uniform(5.0F, 15.0F), random.uniform(-2.0F, 2.0F));
        const std::uint64_t longest = 10 + random.below(20);
        FollowCheck check;
        bool stops = random.below(2) == 0;
        std::uint64_t next = 50 + random.below(50);
        for (std::uint64_t tick = 0; tick < 1000; ++tick) {
            if (tick >= next) {
                stops = !stops;
                next = tick + 5 + random.below(longest);
            }
            const Vec3 command = stops ? Vec3(Vec3::Zero()) : manoeuvre;
            craft.step(command, random);
            if (check.update(command, craft.seen(random, 0.05F), limits,
                             TimePoint{1'000'000 + static_cast<std::int64_t>(tick) * 20'000})) {
                ++accused;
                EXPECT_GT(accused, 1U) << "at " << static_cast<float>(tick) * kStep
                                       << " s; JINK_CASES=1 JINK_SEED=" << seed + i;
                break;
            }
        }
    }
    EXPECT_EQ(accused, 0U) << "of " << cases;
}

TEST(FollowCheckLaw, AVehicleThatIgnoresItsCommandsIsFoundWithinASecondAndAHalf)
{
    const std::uint64_t cases = number_of("JINK_CASES", 4000);
    const std::uint64_t seed = number_of("JINK_SEED", 20260726);
    float longest = 0.0F;
    for (std::uint64_t i = 0; i < cases; ++i) {
        Random random(seed + i);
        const Vec3 velocity = random_command(random);
        Vec3 command = random_command(random);
        // Clearly another one: a manoeuvre that hardly differs from the mission needs no following.
        while ((command - velocity).norm() < std::max(1.5F, 0.5F * command.norm()) + 0.5F) {
            command = random_command(random);
        }
        const float along = command.norm() > 1.0F ? velocity.dot(command.normalized()) / command.norm() : 0.0F;
        if (along >= 0.45F) {
            continue;  // flies in that direction anyway, only more slowly
        }
        const float sigma = random.uniform(0.0F, 0.1F);
        FollowCheck check;
        float found = -1.0F;
        for (int tick = 0; tick < 150 && found < 0.0F; ++tick) {
            const Vec3 noise(random.normal(), random.normal(), random.normal());
            const TimePoint now{1'000'000 + tick * 20'000LL};
            found = check.update(command, velocity + sigma * noise, {}, now) ? static_cast<float>(tick) * kStep : found;
        }
        ASSERT_GE(found, 0.5F) << "JINK_CASES=1 JINK_SEED=" << seed + i;
        ASSERT_LE(found, 1.5F) << "JINK_CASES=1 JINK_SEED=" << seed + i;
        longest = std::max(longest, found);
    }
    std::printf("[ follow    ] found after %.2f s at most\n", static_cast<double>(longest));
}

/// Commands that jump with each noisy report give no proof by themselves, nor do gusts about a velocity that is kept.
TEST(FollowCheckLaw, AVehicleThatIgnoresJumpingCommandsInGustsIsFoundWithinTenSeconds)
{
    const std::uint64_t cases = number_of("JINK_CASES", 2000);
    const std::uint64_t seed = number_of("JINK_SEED", 20261130);
    std::uint64_t late = 0;
    for (std::uint64_t i = 0; i < cases; ++i) {
        Random random(seed + i);
        const auto every = 3 + random.below(4);  // ticks between velocities
        const float mean = random.uniform(2.4F, 4.2F);
        const float gusts = random.uniform(0.0F, 0.8F);  // [m/s], of a correlation time of 1 s
        FollowCheck check;
        Vec3 command = Vec3::Zero();
        Vec3 gust = Vec3::Zero();
        float found = -1.0F;
        for (std::uint64_t tick = 0; tick < 500 && found < 0.0F; ++tick) {
            if (tick % every == 0) {
                const float angle = random.uniform(mean - 0.4F, mean + 0.4F);
                command = Vec3(5.0F * std::cos(angle), 5.0F * std::sin(angle), -1.0F);
            }
            const Vec3 push(random.normal(), random.normal(), random.normal());
            gust += kStep * -gust + gusts * std::sqrt(kStep) * push;
            const Vec3 noise(random.normal(), random.normal(), random.normal());
            const TimePoint now{1'000'000 + static_cast<std::int64_t>(tick) * 20'000};
            const bool alarm = check.update(command, Vec3(3.2F, 3.8F, 0.0F) + gust + 0.1F * noise, {}, now);
            found = alarm ? static_cast<float>(tick) * kStep : found;
        }
        ASSERT_GE(found, 0.5F) << "JINK_CASES=1 JINK_SEED=" << seed + i;
        late += found > 1.5F ? 1U : 0U;
    }
    EXPECT_LE(late * 10, cases) << "nine of ten within a second and a half";
}

/// Nor does a command that goes and stops hide a vehicle that does neither.
TEST(FollowCheckLaw, AVehicleThatIgnoresManoeuvresAndStopsThatTakeTurnsIsFoundWithinTenSeconds)
{
    const std::uint64_t cases = number_of("JINK_CASES", 2000);
    const std::uint64_t seed = number_of("JINK_SEED", 20261202);
    float longest = 0.0F;
    for (std::uint64_t i = 0; i < cases; ++i) {
        Random random(seed + i);
        vehicle::VehicleLimits limits;
        limits.max_acceleration = random.uniform(2.0F, 5.0F);
        const Vec3 manoeuvre(0.0F, random.uniform(5.0F, 15.0F), random.uniform(-2.0F, 2.0F));
        const float course = random.uniform(-2.4F, -0.7F);  // not the manoeuvre's
        const float speed = random.uniform(2.5F, 12.0F);
        const Vec3 velocity(speed * std::cos(course), speed * std::sin(course), 0.0F);
        const float gusts = random.uniform(0.0F, 0.5F);
        const std::uint64_t most = 10 + random.below(20);
        FollowCheck check;
        Vec3 gust = Vec3::Zero();
        bool stops = random.below(2) == 0;
        std::uint64_t next = random.below(50);
        float found = -1.0F;
        for (std::uint64_t tick = 0; tick < 500 && found < 0.0F; ++tick) {
            if (tick >= next) {
                stops = !stops;
                next = tick + 5 + random.below(most);
            }
            const Vec3 push(random.normal(), random.normal(), random.normal());
            gust += kStep * -gust + gusts * std::sqrt(kStep) * push;
            const Vec3 noise(random.normal(), random.normal(), random.normal());
            const TimePoint now{1'000'000 + static_cast<std::int64_t>(tick) * 20'000};
            const Vec3 command = stops ? Vec3(Vec3::Zero()) : manoeuvre;
            const bool alarm = check.update(command, velocity + gust + 0.05F * noise, limits, now);
            found = alarm ? static_cast<float>(tick) * kStep : found;
        }
        ASSERT_GE(found, 0.5F) << "JINK_CASES=1 JINK_SEED=" << seed + i;
        longest = std::max(longest, found);
    }
    std::printf("[ follow    ] found after %.2f s at most\n", static_cast<double>(longest));
}

/// A plane in double, independent of core and of the simulator: points reach it twice a second, it begins to roll
/// after a dead time, banks with a lag and turns its course by an L1 law; its speed is its own.
struct Wing {
    double course = 0.0, speed = 18.0, bank = 0.5, roll = 0.5, gain = 0.55, dead = 0.3, pace = 0.5;
    double lateral = 0.0, climb = 0.0, heard = 0.0, heard_climb = 0.0, next = 0.0;

    void step(double wanted, double wanted_climb, double time)
    {
        if (time >= next) {
            heard = wanted;
            heard_climb = wanted_climb;
            next = time + pace;
        }
        const double error = time < dead ? 0.0 : std::clamp(std::remainder(heard - course, 2.0 * M_PI), -1.57, 1.57);
        const double demand = std::clamp(gain * speed * std::sin(error), -9.81 * bank, 9.81 * bank);
        lateral += (demand - lateral) * 0.02 / roll;
        course += lateral / speed * 0.02;
        climb += std::clamp((heard_climb - climb) / 1.5, -1.0, 1.0) * 0.02;
    }
    [[nodiscard]] Vec3 seen() const
    {
        return {static_cast<float>(speed * std::cos(course)), static_cast<float>(speed * std::sin(course)),
                static_cast<float>(climb)};
    }
};

vehicle::VehicleLimits wing_limits(float acceleration)
{
    vehicle::VehicleLimits limits;
    limits.kind = vehicle::VehicleKind::fixed_wing;
    limits.cruise_speed = 18.0F;
    limits.max_acceleration = acceleration;
    return limits;
}

TEST(FollowCheckLaw, APlaneThatRollsInAndTurnsIsNeverAccused)
{
    const std::uint64_t cases = number_of("JINK_CASES", 2000);
    const std::uint64_t seed = number_of("JINK_SEED", 20260801);
    for (std::uint64_t i = 0; i < cases; ++i) {
        Random random(seed + i);
        Wing wing;
        wing.course = static_cast<double>(random.uniform(-3.1F, 3.1F));
        wing.speed = static_cast<double>(random.uniform(13.0F, 24.0F));
        wing.bank = static_cast<double>(random.uniform(0.4F, 0.8F));
        wing.roll = static_cast<double>(random.uniform(0.3F, 0.6F));
        wing.dead = static_cast<double>(random.uniform(0.0F, 0.5F));
        const vehicle::VehicleLimits limits = wing_limits(random.uniform(3.0F, 6.0F));
        double wanted = wing.course;
        double rate = 0.0;
        float reported = 18.0F, climb = 0.0F;
        FollowCheck check;
        for (int tick = 0; tick < 600; ++tick) {
            if (tick % 250 == 10) {
                const bool circles = random.below(3) == 0;
                wanted += circles ? 0.0 : static_cast<double>(random.uniform(-1.5F, 1.5F));
                rate = circles ? static_cast<double>(random.uniform(-0.17F, 0.17F)) : 0.0;
                reported = random.uniform(12.0F, 24.0F);
                climb = random.uniform(-2.0F, 2.0F);
            }
            wanted += rate * 0.02;
            wing.step(wanted, static_cast<double>(climb), 0.02 * tick);
            const Vec3 command(reported * static_cast<float>(std::cos(wanted)),
                               reported * static_cast<float>(std::sin(wanted)), climb);
            ASSERT_FALSE(check.update(command, wing.seen(), limits, {1'000'000 + tick * 20'000LL}))
                << "at " << 0.02 * tick << " s; JINK_CASES=1 JINK_SEED=" << seed + i;
        }
    }
}

TEST(FollowCheckLaw, APlaneThatFliesStraightOnIsFoundWithinThreeSeconds)
{
    const std::uint64_t cases = number_of("JINK_CASES", 2000);
    const std::uint64_t seed = number_of("JINK_SEED", 20260802);
    for (std::uint64_t i = 0; i < cases; ++i) {
        Random random(seed + i);
        const float turn = random.uniform(0.4F, 2.7F) * (random.below(2) == 0 ? 1.0F : -1.0F);
        const float reported = random.uniform(12.0F, 24.0F);
        const Vec3 command(reported * std::cos(turn), reported * std::sin(turn), 0.0F);
        const vehicle::VehicleLimits limits = wing_limits(random.uniform(3.0F, 6.0F));
        FollowCheck check;
        float found = -1.0F;
        for (int tick = 0; tick < 250 && found < 0.0F; ++tick) {
            const bool alarm = check.update(command, Vec3(18.0F, 0.0F, 0.0F), limits, {1'000'000 + tick * 20'000LL});
            found = alarm ? static_cast<float>(tick) * kStep : found;
        }
        ASSERT_GE(found, 2.0F) << "JINK_CASES=1 JINK_SEED=" << seed + i;
        ASSERT_LE(found, 3.0F) << "JINK_CASES=1 JINK_SEED=" << seed + i;
    }
}

TEST(FollowCheckLaw, FirstManoeuvreThatIsIgnoredIsFoundEarlyAlsoAfterACommandThatWasFlownAnyway)
{
    const Vec3 north(0.0F, 5.0F, 0.0F), east(5.0F, 0.0F, 0.0F);
    FollowCheck check;
    Random random(7);
    float found = -1.0F;
    for (int tick = 0; tick < 500 && found < 0.0F; ++tick) {
        const Vec3 noise(random.normal(), random.normal(), random.normal());
        const TimePoint now{1'000'000 + tick * 20'000LL};
        const bool ignored = check.update(tick < 100 ? north : east, north + 0.1F * noise, {}, now);
        found = ignored ? static_cast<float>(tick) * kStep : found;
    }
    EXPECT_GE(found, 2.9F);
    EXPECT_LE(found, 3.5F) << "the manoeuvre begins at 2 s";
}

TEST(FollowCheckLaw, AVehicleThatStopsFollowingIsFoundAfterTheAllowance)
{
    const Vec3 north(0.0F, 5.0F, 0.0F), east(5.0F, 0.0F, 0.0F);
    FollowCheck check;
    Vec3 velocity = Vec3::Zero();
    float found = -1.0F;
    for (int tick = 0; tick < 500 && found < 0.0F; ++tick) {
        velocity.y() = std::min(velocity.y() + 0.06F, 5.0F);  // 3 m/s2
        const TimePoint now{1'000'000 + tick * 20'000LL};
        found = check.update(tick < 100 ? north : east, velocity, {}, now) ? static_cast<float>(tick) * kStep : found;
    }
    EXPECT_GE(found, 2.0F + FollowCheck::kPatience + FollowCheck::kAllowance);
    EXPECT_LE(found, 7.0F);
}

}  // namespace
}  // namespace jink::app
