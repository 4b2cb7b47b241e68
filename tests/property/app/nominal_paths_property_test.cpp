// SPDX-License-Identifier: BSD-3-Clause
// Where the vehicle flies otherwise than the link reports: intruders aimed at its true motion are avoided, traffic that
// passes far off is left alone, and modes do not flicker. JINK_CASES and JINK_SEED are taken.
#include <cstdio>
#include <cstdlib>
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/app/direct_flight.hpp"

namespace jink::app::test {
namespace {

std::uint64_t nominal_setting(const char* name, std::uint64_t otherwise)
{
    const char* const text = std::getenv(name);
    return text != nullptr ? std::strtoull(text, nullptr, 10) : otherwise;
}

enum class Behaviour { circle, replaced_leg, stands, fast, set_points, corners };
constexpr Behaviour kBehaviours[] = {Behaviour::circle, Behaviour::replaced_leg, Behaviour::stands,
                                     Behaviour::fast,   Behaviour::set_points,   Behaviour::corners};
constexpr const char* kNames[] = {
    "circle", "replaced leg", "stands", "12 m/s at VEH_CRUISE 5", "controller set-points", "corners, legs known"};

Vec3 level(float course) { return {std::cos(course), std::sin(course), 0.0F}; }

Course straight(const Vec3& from, const Vec3& velocity)
{
    return {[=](Seconds t) { return Vec3(from + t * velocity); }, [=](Seconds) { return velocity; }};
}

Course circle(const Vec3& centre, float radius, float speed, float phase, float sense)
{
    const float rate = sense * speed / radius;
    return {[=](Seconds t) {
                return Vec3(centre + radius * Vec3(std::cos(phase + rate * t), std::sin(phase + rate * t), 0.0F));
            },
            [=](Seconds t) {
                return Vec3(rate * radius * Vec3(-std::sin(phase + rate * t), std::cos(phase + rate * t), 0.0F));
            }};
}

/// Legs of 40 to 80 m at 5 m/s, one after the other.
struct Corners {
    std::vector<Vec3> points;
    std::vector<Seconds> times;  ///< when each point is reached

    [[nodiscard]] std::size_t leg_at(Seconds t) const
    {
        std::size_t i = 0;
        while (i + 2 < points.size() && t >= times[i + 1]) {
            ++i;
        }
        return i;
    }
    [[nodiscard]] Vec3 velocity(Seconds t) const
    {
        const std::size_t i = leg_at(t);
        return (points[i + 1] - points[i]) / (times[i + 1] - times[i]);
    }
    [[nodiscard]] Vec3 position(Seconds t) const
    {
        const std::size_t i = leg_at(t);
        return points[i] + (t - times[i]) * velocity(t);
    }
};

Corners draw_corners(Random& random, const Vec3& from, float heading)
{
    Corners c{{from}, {0.0F}};
    for (int i = 0; i < 12; ++i) {
        const float length = random.uniform(40.0F, 80.0F);
        c.points.emplace_back(c.points.back() + length * level(heading));
        c.times.push_back(c.times.back() + length / 5.0F);
        heading += (random.below(2) == 0 ? 1.0F : -1.0F) * random.uniform(0.5F, 2.0F);
    }
    return c;
}

/// A flight of one kind, and its true course.
struct Drawn {
    Course course;
    Corners corners;
    std::unique_ptr<DirectFlight> flight;
};

Drawn draw(Behaviour behaviour, Random& random)
{
    const Vec3 from(0.0F, 0.0F, 50.0F);
    const float heading = random.uniform(-kPi, kPi);
    Drawn d;
    world::Leg leg{from, from + 300.0F * level(heading), 5.0F};
    switch (behaviour) {
    case Behaviour::circle: {
        const float radius = random.uniform(12.0F, 40.0F);
        const float sense = random.below(2) == 0 ? 1.0F : -1.0F;
        d.course = circle(from + radius * level(heading), radius, 5.0F, heading + kPi, sense);
        leg.end = from + radius * level(heading);
        break;
    }
    case Behaviour::replaced_leg:
        d.course =
            straight(from, 5.0F * level(heading + (random.below(2) == 0 ? 1.0F : -1.0F) * random.uniform(0.6F, 3.1F)));
        break;
    case Behaviour::stands: d.course = straight(from, Vec3::Zero()); break;
    case Behaviour::fast:
        d.course = straight(from, 12.0F * level(heading));
        leg.end = from + 2000.0F * level(heading);
        leg.speed = 0.0F;
        break;
    case Behaviour::set_points: d.course = straight(from, 5.0F * level(heading)); break;
    case Behaviour::corners:
        d.corners = draw_corners(random, from, heading);
        d.course = {[c = d.corners](Seconds t) { return c.position(t); },
                    [c = d.corners](Seconds t) { return c.velocity(t); }};
        leg = {d.corners.points[0], d.corners.points[1], 5.0F};
        break;
    }
    d.flight = std::make_unique<DirectFlight>(d.course, Parameters{}, random.next());
    d.flight->leg = leg;
    d.flight->reports_leg = true;
    return d;
}

void advance(Drawn& d, Behaviour behaviour)
{
    if (behaviour == Behaviour::set_points) {
        // Two metres ahead of the vehicle at every report, from where the one before was.
        const world::Leg before = d.flight->leg;
        const Vec3 ahead = d.flight->state.position + 0.4F * d.flight->state.velocity;
        if ((ahead - before.end).norm() > 0.5F) {
            d.flight->leg = {before.end, ahead, 0.0F};
        }
    }
    if (behaviour == Behaviour::corners) {
        const std::size_t i = d.corners.leg_at(d.flight->mission_time());
        d.flight->leg = {d.corners.points[i], d.corners.points[i + 1], 5.0F};
    }
    d.flight->tick();
}

Vec3 any_direction(Random& random)
{
    const float z = 0.5F * random.uniform(-1.0F, 1.0F);
    const Vec3 level_part = std::sqrt(1.0F - z * z) * level(random.uniform(-kPi, kPi));
    return level_part + Vec3(0.0F, 0.0F, z);
}

/// At most one take-over and one giving back within 5 s.
void expect_no_flicker(const DirectFlight& f, const char* name, std::uint64_t seed)
{
    for (const auto* times : {&f.taken, &f.given_back}) {
        for (std::size_t i = 1; i < times->size(); ++i) {
            EXPECT_GE((*times)[i] - (*times)[i - 1], 5.0F) << name << ", JINK_SEED=" << seed;
        }
    }
}

constexpr float kHit = 1.5F;  ///< both bodies' radii [m]

TEST(NominalPathsLaw, IntrudersAimedAtTheTrueMotionAreAvoided)
{
    const std::uint64_t cases = nominal_setting("JINK_CASES", 6);
    const std::uint64_t first = nominal_setting("JINK_SEED", 1);
    for (std::size_t b = 0; b < std::size(kBehaviours); ++b) {
        int hits = 0, taken = 0, critical = 0;
        for (std::uint64_t seed = first; seed < first + cases; ++seed) {
            Random random(seed * 7919 + b);
            Drawn d = draw(kBehaviours[b], random);
            const Seconds meets = random.uniform(10.0F, 14.0F);
            const Vec3 at = d.course.position(meets) + random.uniform(0.0F, 0.5F) * any_direction(random);
            const Vec3 velocity = random.uniform(1.0F, 12.0F) * any_direction(random);
            d.flight->intruders = {{at - meets * velocity, velocity, meets - 8.0F}};
            while (d.flight->time < 35.0F) {
                advance(d, kBehaviours[b]);
            }
            if (d.flight->nearest < kHit) {
                ++hits;
                std::printf("  hit: %s, JINK_SEED=%llu: %.2f m, velocity %.1f %.1f %.1f, taken at %.2f of %.2f s\n",
                            kNames[b], static_cast<unsigned long long>(seed), static_cast<double>(d.flight->nearest),
                            static_cast<double>(velocity.x()), static_cast<double>(velocity.y()),
                            static_cast<double>(velocity.z()),
                            d.flight->taken.empty() ? -1.0 : static_cast<double>(d.flight->taken.front()),
                            static_cast<double>(meets));
            }
            taken += static_cast<int>(d.flight->taken.size());
            critical += d.flight->said(link::Severity::critical);
            expect_no_flicker(*d.flight, kNames[b], seed);
        }
        std::printf("%-24s %d hits, %d take-overs, %d critical texts in %d encounters, seeds from %d\n", kNames[b],
                    hits, taken, critical, static_cast<int>(cases), static_cast<int>(first));
        EXPECT_EQ(hits, 0) << kNames[b];
    }
}

TEST(NominalPathsLaw, TrafficThatPassesFarOffIsLeftAlone)
{
    const std::uint64_t cases = nominal_setting("JINK_CASES", 6);
    const std::uint64_t first = nominal_setting("JINK_SEED", 1);
    float hours = 0.0F;
    int all = 0;
    for (std::size_t b = 0; b < std::size(kBehaviours); ++b) {
        int taken = 0;
        for (std::uint64_t seed = first; seed < first + cases; ++seed) {
            Random random(seed * 104729 + b);
            Drawn d = draw(kBehaviours[b], random);
            for (int i = 0; i < 100 && d.flight->intruders.empty(); ++i) {
                const Seconds meets = random.uniform(20.0F, 40.0F);
                const Vec3 at = d.course.position(meets) +
                                random.uniform(10.0F, 150.0F) * level(random.uniform(-kPi, kPi)) +
                                Vec3(0.0F, 0.0F, random.uniform(-40.0F, 60.0F));
                const Vec3 velocity = random.uniform(1.0F, 12.0F) * any_direction(random);
                const Intruder intruder{at - meets * velocity, velocity, 0.0F};
                float least = 1e9F;
                for (Seconds t = 0.0F; t < 60.0F; t += 0.05F) {
                    least = std::min(least, (intruder.at(t) - d.course.position(t)).norm());
                }
                if (least >= 10.0F) {
                    d.flight->intruders = {intruder};
                }
            }
            while (d.flight->time < 60.0F) {
                advance(d, kBehaviours[b]);
            }
            hours += 60.0F / 3600.0F;
            taken += static_cast<int>(d.flight->taken.size());
            expect_no_flicker(*d.flight, kNames[b], seed);
        }
        std::printf("%-24s %d take-overs in %d min, one aircraft a minute\n", kNames[b], taken,
                    static_cast<int>(cases));
        all += taken;
    }
    std::printf("%.2f take-overs per hour\n", static_cast<double>(static_cast<float>(all) / hours));
    EXPECT_LT(static_cast<float>(all), std::max(1.0F, hours));
}

}  // namespace
}  // namespace jink::app::test
