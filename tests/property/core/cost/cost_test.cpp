// SPDX-License-Identifier: BSD-3-Clause
#include "core/cost/cost.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/random.hpp"
#include "tests/oracle/cost_oracle.hpp"

namespace jink::cost {
namespace {

struct Drawn {
    path::TimedPath path;
    oracle::Flight flight;
    oracle::Vehicle figures;
    vehicle::VehicleLimits limits;
    vehicle::Airframe airframe;
};

Vec3 random_vector(Random& random, float size)
{
    return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

Drawn draw(Random& random)
{
    Drawn d;
    d.limits.cruise_speed = random.uniform(1.0F, 15.0F);
    d.limits.max_climb = random.uniform(0.5F, 6.0F);
    d.limits.max_descent = random.uniform(0.5F, 6.0F);
    d.airframe.mass = random.uniform(0.5F, 12.0F);
    d.airframe.drag_coefficient = random.uniform(0.1F, 1.0F);
    d.airframe.effective_area = random.uniform(0.1F, 10.0F);
    d.airframe.blade_drag_coefficient = random.uniform(0.0F, 0.02F);
    d.figures.speed = static_cast<double>(d.limits.cruise_speed);
    d.figures.climb = static_cast<double>(d.limits.max_climb);
    d.figures.descent = static_cast<double>(d.limits.max_descent);
    d.figures.mass = static_cast<double>(d.airframe.mass);
    d.figures.drag = static_cast<double>(d.airframe.drag_coefficient);
    d.figures.area = static_cast<double>(d.airframe.effective_area);
    d.figures.blade_drag = static_cast<double>(d.airframe.blade_drag_coefficient);
    std::vector<Vec3> positions{random_vector(random, 50.0F)};
    for (std::uint64_t i = 0, n = 4 + random.below(50); i < n; ++i) {
        positions.push_back(positions.back() + random_vector(random, 2.0F));
    }
    std::vector<oracle::P3> points;
    for (const Vec3& p : positions) {
        points.push_back(oracle::to_double(p));
    }
    EXPECT_TRUE(path::make_timed_path(positions, d.limits.cruise_speed, d.limits, d.path));
    d.flight = oracle::fly(points, d.figures);
    return d;
}

TEST(CostLaws, TimeEnergyAndPowerAgreeWithTheFormulasInDouble)
{
    for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
        Random random(seed);
        const Drawn d = draw(random);
        const double energy_expected = oracle::energy(d.flight, d.figures);
        const double power_expected = oracle::hover_power(d.flight, d.figures);
        ASSERT_NEAR(static_cast<double>(flight_time(d.path)), d.flight.t.back(), 2e-4 * d.flight.t.back())
            << "seed " << seed;
        ASSERT_NEAR(static_cast<double>(energy(d.path, d.airframe)), energy_expected, 1e-3 * energy_expected)
            << "seed " << seed;
        ASSERT_NEAR(static_cast<double>(hover_power(d.path, d.airframe)), power_expected, 1e-3 * power_expected)
            << "seed " << seed;
    }
}

TEST(CostLaws, SmoothnessAtEqualStepsIsThatOfTheCurve)
{
    for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
        Random random(seed);
        const float step = random.uniform(0.05F, 5.0F);
        const float size = random.uniform(0.1F, 20.0F);
        std::vector<float> x;
        std::vector<float> y;
        for (std::uint64_t i = 0, n = 3 + random.below(60); i < n; ++i) {
            x.push_back(step * static_cast<float>(i));
            y.push_back(size * std::sin(0.2F * static_cast<float>(i)) + random.uniform(-0.1F, 0.1F));
        }
        for (const SmoothnessMethod method :
             {SmoothnessMethod::curvature, SmoothnessMethod::deviation, SmoothnessMethod::second_derivative}) {
            const float expected = smoothness(x, y, method);
            ASSERT_NEAR(smoothness(step, y, method), expected, 2e-3F * expected + 1e-6F)
                << "seed " << seed << " method " << static_cast<int>(method);
        }
    }
}

TEST(CostLaws, ClosenessAgreesWithTheFormulaInDouble)
{
    for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
        Random random(seed);
        const Drawn d = draw(random);
        geometry::Motion threat{d.path.points[0].position + random_vector(random, 30.0F), random_vector(random, 5.0F)};
        const float radius = random.uniform(0.0F, 4.0F);
        Seconds swept_for = random.uniform(0.5F, 20.0F);
        if (random.uniform() < 0.1F) {
            threat.velocity.setZero();
        }
        const oracle::Moving moving{oracle::to_double(threat.position), oracle::to_double(threat.velocity),
                                    static_cast<double>(radius)};
        for (const auto method : {ClosenessMethod::swept, ClosenessMethod::time_aware}) {
            const double span = method == ClosenessMethod::swept ? static_cast<double>(swept_for) : -1.0;
            const double expected = 1.0 / oracle::closeness(d.flight, moving, span);
            if (std::abs(expected) < 1e-3) {
                continue;  // on the very edge of contact
            }
            const double got = 1.0 / static_cast<double>(closeness(d.path, threat, radius, method, swept_for));
            ASSERT_NEAR(got, expected, 2e-3 * (1.0 + expected)) << "seed " << seed;
        }
        // The nearest point of its path is never farther than where it is at one instant of the flight.
        swept_for = std::max(swept_for, d.path.duration());
        ASSERT_GE(closeness(d.path, threat, radius, ClosenessMethod::swept, swept_for),
                  closeness(d.path, threat, radius, ClosenessMethod::time_aware) * 0.9999F)
            << "seed " << seed;
    }
}

TEST(CostLaws, SmoothnessAgreesScalesAndIsEven)
{
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
        Random random(seed);
        const bool symmetric = random.uniform() < 0.5F;
        const float distance = random.uniform(2.5F, 40.0F);
        const float offset = distance * random.uniform(-1.28F, 1.28F);
        const int waypoints = 8 + static_cast<int>(random.below(56));
        std::vector<float> x;
        std::vector<float> y;
        std::vector<float> mirrored;
        std::vector<float> x_twice;
        std::vector<float> y_twice;
        std::vector<double> xd;
        std::vector<double> yd;
        for (int i = 0; i < waypoints; ++i) {
            xd.push_back((symmetric ? 2.0 : 1.5) * static_cast<double>(distance) * i / (waypoints - 1));
            yd.push_back(
                oracle::curve(symmetric, static_cast<double>(offset), static_cast<double>(distance), xd.back()));
            x.push_back(static_cast<float>(xd.back()));
            y.push_back(static_cast<float>(yd.back()));
            mirrored.push_back(-y.back());
            x_twice.push_back(2.0F * x.back());
            y_twice.push_back(2.0F * y.back());
        }
        const float got = smoothness(x, y, SmoothnessMethod::curvature);
        const double expected = oracle::smoothness(xd, yd);
        ASSERT_NEAR(static_cast<double>(got), expected, 2e-3 * expected + 1e-7) << "seed " << seed;
        ASSERT_EQ(got, smoothness(x, mirrored, SmoothnessMethod::curvature)) << "seed " << seed;
        ASSERT_NEAR(got, 2.0F * smoothness(x_twice, y_twice, SmoothnessMethod::curvature), 1e-5F * got)
            << "seed " << seed;
    }
}

TEST(CostLaws, NormalisedTermsStayInRangeAndNeverFall)
{
    for (std::uint64_t seed = 1; seed <= 20000; ++seed) {
        Random random(seed);
        Terms low;
        low.time = std::exp(random.uniform(-10.0F, 10.0F));
        low.smoothness = std::exp(random.uniform(-10.0F, 10.0F));
        low.smoothness_penalised = std::exp(random.uniform(-10.0F, 10.0F));
        low.closeness = std::exp(random.uniform(-10.0F, 10.0F));
        low.energy = std::exp(random.uniform(-10.0F, 12.0F));
        Terms high = low;
        const float factor = random.uniform(1.0F, 3.0F);
        high.time *= factor;
        high.smoothness *= factor;
        high.smoothness_penalised *= factor;
        high.closeness *= factor;
        high.energy *= factor;
        const NormalisedTerms a = normalise(low, {});
        const NormalisedTerms b = normalise(high, {});
        for (const auto field :
             {&NormalisedTerms::time, &NormalisedTerms::smoothness, &NormalisedTerms::smoothness_penalised,
              &NormalisedTerms::closeness, &NormalisedTerms::energy}) {
            ASSERT_GE(a.*field, 0.0F) << "seed " << seed;
            ASSERT_LE(b.*field, 1.0F) << "seed " << seed;
            ASSERT_LE(a.*field, b.*field) << "seed " << seed;
        }
        ASSERT_GE(total(a, {}), 0.0F) << "seed " << seed;
        ASSERT_LE(total(b, {}), 1.00001F) << "seed " << seed;
        ASSERT_NEAR(static_cast<double>(a.closeness), oracle::normalised_closeness(static_cast<double>(low.closeness)),
                    1e-5);
        ASSERT_NEAR(static_cast<double>(a.smoothness_penalised),
                    oracle::normalised_smoothness_penalised(static_cast<double>(low.smoothness_penalised)), 1e-5);
        ASSERT_NEAR(static_cast<double>(a.smoothness),
                    oracle::normalised_smoothness(static_cast<double>(low.smoothness)), 1e-5);
        ASSERT_NEAR(static_cast<double>(a.time), oracle::normalised_time(static_cast<double>(low.time)), 1e-5);
        ASSERT_NEAR(static_cast<double>(a.energy), oracle::normalised_energy(static_cast<double>(low.energy)), 1e-5);
    }
}

TEST(CostLaws, RotorPowerAgreesWithTheFormulas)
{
    for (std::uint64_t seed = 1; seed <= 20000; ++seed) {
        Random random(seed);
        vehicle::Airframe airframe;
        airframe.mass = random.uniform(0.3F, 15.0F);
        airframe.rotor_radius = random.uniform(0.05F, 0.4F);
        airframe.rotors = random.uniform() < 0.5F ? 4.0F : 6.0F;
        airframe.blade_drag_coefficient = random.uniform(0.0F, 0.01F);
        airframe.tip_speed = random.uniform(50.0F, 272.0F);
        oracle::Vehicle figures;
        figures.mass = static_cast<double>(airframe.mass);
        figures.rotor_radius = static_cast<double>(airframe.rotor_radius);
        figures.rotors = static_cast<double>(airframe.rotors);
        figures.blade_drag = static_cast<double>(airframe.blade_drag_coefficient);
        figures.tip = static_cast<double>(airframe.tip_speed);
        const float rate = random.uniform(-25.0F, 10.0F);
        const double hover = std::sqrt(
            figures.mass * 9.81 /
            (2.0 * figures.density * figures.rotors * std::numbers::pi * figures.rotor_radius * figures.rotor_radius));
        if (std::abs(static_cast<double>(rate) / hover + 2.0) < 1e-4) {
            continue;  // the formula jumps there
        }
        const double expected = oracle::rotor_power(static_cast<double>(rate), figures);
        ASSERT_NEAR(static_cast<double>(rotor_power(rate, airframe)), expected, 2e-4 * (50.0 + std::abs(expected)))
            << "seed " << seed;
    }
}

}  // namespace
}  // namespace jink::cost
