// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/sweep.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <sstream>

#include "tests/property/core/geometry/oracle.hpp"

namespace jink::geometry {
namespace {

using oracle::Passage;

struct Case {
    Vec3 half = Vec3::Zero();
    Motion own, threat;
    float radius = 0.0F;
    Seconds horizon = 1.0F;
};

std::string text(const Case& c)
{
    std::ostringstream out;
    out << std::hexfloat;
    const auto put = [&](const char* name, const Vec3& v) {
        out << name << " " << v.x() << " " << v.y() << " " << v.z() << "  ";
    };
    put("half", c.half);
    put("own", c.own.position);
    put("at", c.own.velocity);
    put("threat", c.threat.position);
    put("at", c.threat.velocity);
    out << "radius " << c.radius << " horizon " << c.horizon;
    return out.str();
}

/// One to three components set to zero, to one another's value, or left alone.
void degenerate(Random& random, Vec3& v)
{
    switch (random.below(6)) {
    case 0: v = Vec3::Zero(); break;
    case 1: v[static_cast<int>(random.below(3))] = 0.0F; break;
    case 2: {
        const auto i = static_cast<int>(random.below(3));
        const float kept = v[i];
        v = Vec3::Zero();
        v[i] = kept;
        break;
    }
    case 3: v[static_cast<int>(random.below(3))] = v[static_cast<int>(random.below(3))]; break;
    default: break;
    }
}

/// Everything of the size of `size` metres somewhere within `far` metres of the origin.
Case ordinary(Random& random, float size, float far)
{
    Case c;
    c.half = oracle::in_cube(random, 0.5F * size).cwiseAbs();
    const Vec3 centre = oracle::in_cube(random, far);
    c.own.position = centre + oracle::in_cube(random, 3.0F * size);
    c.threat.position = centre + oracle::in_cube(random, 3.0F * size);
    const float speed = size * oracle::power_of_ten(random, -1.0F, 1.5F);
    c.own.velocity = oracle::in_cube(random, speed);
    c.threat.velocity = oracle::in_cube(random, speed);
    c.radius = random.uniform(0.0F, size);
    c.horizon = oracle::power_of_ten(random, -1.0F, 1.0F);
    return c;
}

/// Small whole numbers: parallel faces, equal coordinates and exact contact are common, without rounding.
Case on_grid(Random& random)
{
    const auto whole = [&](std::uint64_t n) {
        return static_cast<float>(random.below(2 * n + 1)) - static_cast<float>(n);
    };
    Case c;
    c.half = Vec3(whole(2), whole(2), whole(2)).cwiseAbs();
    c.own.position = Vec3(whole(4), whole(4), whole(4));
    c.threat.position = Vec3(whole(6), whole(6), whole(6));
    c.own.velocity = Vec3(whole(2), whole(2), whole(2));
    c.threat.velocity = Vec3(whole(3), whole(3), whole(3));
    c.radius = std::abs(whole(3));
    c.horizon = static_cast<float>(1 + random.below(4));
    return c;
}

/// Aims the threat such that it passes the box at `radius` within rounding.
void make_grazing(Random& random, Case& c)
{
    const Passage passage(c.half, c.own, c.threat);
    const double least = passage.distance(passage.closest(double(c.horizon)));
    const float ulps = random.uniform(-16.0F, 16.0F);
    c.radius = std::max(static_cast<float>(least) * (1.0F + ulps * 0x1p-23F), 0.0F);
}

Case any_case(Random& random)
{
    const auto kind = random.below(8);
    if (kind == 0) {
        return on_grid(random);
    }
    const float size = kind == 1 ? 1e-3F : oracle::power_of_ten(random, -3.0F, 2.0F);
    const float far = kind == 2 ? 1000.0F : size * oracle::power_of_ten(random, -1.0F, 1.0F);
    Case c = ordinary(random, size, far);
    if (kind >= 5) {
        degenerate(random, c.half);
        degenerate(random, c.own.velocity);
        degenerate(random, c.threat.velocity);
        if (random.below(4) == 0) {
            c.threat.velocity = c.own.velocity;
        }
        if (random.below(4) == 0) {
            c.threat.position = c.own.position;
        }
        if (random.below(3) == 0) {
            c.radius = 0.0F;
        }
    }
    if (kind == 4 || kind == 7) {
        make_grazing(random, c);
    }
    return c;
}

/// The promise of the header: how far beyond the radius a reported contact may be.
double allowed(const Case& c)
{
    const Vec3 relative = c.threat.position - c.own.position;
    return 1e-6 * double(relative.cwiseAbs().sum() + c.half.sum() + c.radius);
}

struct Tally {
    std::size_t cases = 0, hits = 0, missed = 0, spurious = 0, late = 0, loose = 0, within_slack = 0;
    double worst_instant = 0;  ///< of contacts that go deeper than a hundredth of the radius, as a share of the horizon
    double worst_grazing = 0;  ///< of the others
    double worst_excess = 0;   ///< distance beyond the radius at a reported instant, as a share of the tolerance

    void judge(const Case& c, const Passage& passage, const std::optional<TimeInterval>& found)
    {
        ++cases;
        const double horizon = double(c.horizon);
        const double radius = double(c.radius);
        const double closest = passage.closest(horizon);
        const double least = passage.distance(closest);
        const bool touches = least <= radius;
        const std::size_t before = missed + spurious + late + loose;
        hits += touches ? 1 : 0;
        if (touches && !found) {
            ++missed;
        } else if (found) {
            if (!touches) {
                ++within_slack;
                spurious += least > radius + allowed(c) ? 1 : 0;
            } else {
                judge_instants(c, passage, *found, closest, least);
            }
            for (const float t : {found->first, found->last}) {
                const double excess = passage.distance(double(t)) - radius;
                worst_excess = std::max(worst_excess, excess / allowed(c));
                loose += excess > allowed(c) ? 1 : 0;
            }
            loose += found->first >= 0.0F && found->first <= found->last && found->last <= c.horizon ? 0 : 1;
        }
        if (missed + spurious + late + loose > before && before < 5) {
            ADD_FAILURE() << "missed " << missed << " spurious " << spurious << " late " << late << " loose " << loose
                          << " least " << least << " radius " << radius << " found "
                          << (found ? double(found->first) : -1.0) << ".." << (found ? double(found->last) : -1.0)
                          << "\n"
                          << text(c);
        }
    }

    void judge_instants(const Case& c, const Passage& passage, const TimeInterval& found, double closest, double least)
    {
        const double horizon = double(c.horizon);
        const double radius = double(c.radius);
        const double first = passage.distance(0) <= radius ? 0.0 : passage.crossing(0, closest, radius);
        // The closest instant may be the first one of a plateau within contact.
        const double last = passage.distance(horizon) <= radius ? horizon : passage.crossing(horizon, closest, radius);
        late +=
            double(found.first) > first + 0x1p-22 * horizon || double(found.last) < last - 0x1p-22 * horizon ? 1 : 0;
        const double error =
            std::max(std::abs(double(found.first) - first), std::abs(double(found.last) - last)) / horizon;
        double& worst = radius - least > 0.01 * radius + 1000 * allowed(c) ? worst_instant : worst_grazing;
        worst = std::max(worst, error);
    }

    void report(const char* what) const
    {
        std::cout << what << ": cases=" << cases << " hits=" << hits << " missed=" << missed << " spurious=" << spurious
                  << " late=" << late << " within slack=" << within_slack << " max instant error=" << worst_instant
                  << " of the horizon (grazing: " << worst_grazing << "), max excess=" << worst_excess
                  << " of the allowed\n";
        ::testing::Test::RecordProperty("cases", std::to_string(cases));
        ::testing::Test::RecordProperty("hits", std::to_string(hits));
        ::testing::Test::RecordProperty("max_instant_error", std::to_string(worst_instant));
        EXPECT_EQ(missed, 0U);
        EXPECT_EQ(spurious, 0U);
        EXPECT_EQ(late, 0U);
        EXPECT_EQ(loose, 0U);
        EXPECT_GT(hits, cases / 10);
        EXPECT_LT(hits, cases - cases / 10);
    }
};

TEST(ContactInterval, BoxAgainstSphereAgreesWithBisectionInDouble)
{
    const std::uint64_t seed = oracle::seed_of(20240601);
    SCOPED_TRACE(seed);
    Random random(seed);
    Tally tally;
    for (std::size_t n = oracle::case_count(1'000'000); n > 0; --n) {
        const Case c = any_case(random);
        tally.judge(c, Passage(c.half, c.own, c.threat),
                    contact_interval(c.half, c.own, c.threat, c.radius, c.horizon));
    }
    tally.report("box/sphere");
}

TEST(ContactInterval, SphereAgainstSphereAgreesWithBisectionInDouble)
{
    const std::uint64_t seed = oracle::seed_of(20240602);
    SCOPED_TRACE(seed);
    Random random(seed);
    Tally tally;
    for (std::size_t n = oracle::case_count(1'000'000); n > 0; --n) {
        Case c = any_case(random);
        c.half = Vec3::Zero();
        tally.judge(c, Passage(c.half, c.own, c.threat), contact_interval(c.own, c.threat, c.radius, c.horizon));
    }
    tally.report("sphere/sphere");
}

}  // namespace
}  // namespace jink::geometry
