// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/convex.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "core/geometry/sweep.hpp"
#include "tests/property/core/geometry/convex_oracle.hpp"

namespace jink::geometry {
namespace {

constexpr ShapeKind kKinds[] = {ShapeKind::sphere, ShapeKind::box, ShapeKind::capsule, ShapeKind::cylinder,
                                ShapeKind::hull};

struct ConvexCase {
    Vec3 half = Vec3::Zero();
    Vec3 from, to;
    Shape shape;
    std::vector<Point3> vertices;
    float size = 1.0F;
};

void fill(Random& random, ConvexCase& c, ShapeKind kind)
{
    c.size = oracle::power_of_ten(random, -3.0F, 2.0F);
    const Vec3 centre = oracle::in_cube(random, random.below(4) == 0 ? 1000.0F : c.size);
    c.half = oracle::in_cube(random, 0.5F * c.size).cwiseAbs();
    c.from = centre + oracle::in_cube(random, 2.0F * c.size);
    c.to = random.below(5) == 0 ? c.from : Vec3(centre + oracle::in_cube(random, 2.0F * c.size));
    if (random.below(8) == 0) {
        c.half[static_cast<int>(random.below(3))] = 0.0F;
    }
    c.shape = oracle::any_shape(random, kind, centre + oracle::in_cube(random, 2.0F * c.size), c.size, c.vertices);
}

/// The band of the header, of grazing cases that may count as contact [m]. A clear answer is always true.
double band(const ConvexCase& c, float clearance = 0.0F)
{
    const Vec3 extent = (c.shape.centre - c.from).cwiseAbs() + (c.to - c.from).cwiseAbs() + c.half;
    return 1e-5 * double(extent.sum() + bounding_radius(c.shape) + clearance);
}

/// A clearance of any size, often equal to the distance.
float any_clearance(Random& random, const ConvexCase& c, double distance)
{
    const auto about = static_cast<float>(distance);
    switch (random.below(4)) {
    case 0: return random.uniform(0.0F, c.size);
    case 1: return about * (1.0F + random.uniform(-1e-6F, 1e-6F));
    case 2: return about * (1.0F + random.uniform(-1e-3F, 1e-3F));
    default: return 0.0F;
    }
}

struct ConvexTally {
    std::size_t clear = 0, contact = 0, spent = 0, banded = 0, alarms = 0;
    std::uint32_t most_calls = 0;
    double widest = 0;

    /// `distance`: the true one, known within `uncertainty`.
    void judge(const ConvexCase& c, float clearance, Contact found, double distance, double uncertainty)
    {
        const double gap = distance - double(clearance);
        clear += found == Contact::clear ? 1 : 0;
        contact += found == Contact::contact ? 1 : 0;
        spent += found == Contact::budget_spent ? 1 : 0;
        banded += std::abs(gap) <= band(c, clearance) ? 1 : 0;
        const auto describe = [&] {
            return ::testing::Message() << "kind " << int(c.shape.kind) << " distance " << distance << " clearance "
                                        << clearance << " size " << c.size << " found " << int(found);
        };
        if (gap <= -uncertainty) {
            ASSERT_NE(found, Contact::clear) << describe();
        } else if (gap > uncertainty && found != Contact::clear) {
            ++alarms;
            widest = std::max(widest, gap / band(c, clearance));
            ASSERT_LE(gap, band(c, clearance) + uncertainty) << describe();
        }
        // Well inside, contact is found as such.
        if (gap < -band(c, clearance)) {
            ASSERT_EQ(found, Contact::contact) << describe();
        }
    }

    void report(const char* what) const
    {
        std::cout << what << ": clear=" << clear << " contact=" << contact << " spent=" << spent
                  << " grazing=" << banded << " false contacts=" << alarms << " (widest " << widest
                  << " of the band), most support calls=" << most_calls << "\n";
        EXPECT_GT(clear, 100U);
        EXPECT_GT(contact, 100U);
    }
};

class Convex : public ::testing::Test {
protected:
    const std::uint64_t seed = oracle::seed_of(20240631);
    ::testing::ScopedTrace trace{__FILE__, __LINE__, seed};
    Random random{seed};
};

TEST_F(Convex, ContactAgreesWithLeastNormPointsInDouble)
{
    ConvexTally tally;
    for (std::size_t n = oracle::case_count(200'000); n > 0 && !HasFatalFailure(); --n) {
        ConvexCase c;
        fill(random, c, kKinds[random.below(5)]);
        const oracle::Bounds truth = oracle::swept_box_bounds(c.half, c.from, c.to, c.shape, 1e-9 * double(c.size));
        ASSERT_LE(truth.upper - truth.lower, 1e-6 * double(c.size)) << "the oracle has not converged";
        const float clearance = any_clearance(random, c, truth.lower);
        WorkBudget budget(10'000);
        const Contact found = swept_box_contact(c.half, c.from, c.to, c.shape, clearance, budget);
        tally.most_calls = std::max(tally.most_calls, budget.spent());
        ASSERT_LE(budget.spent(), kUnitsPerQuery);
        tally.judge(c, clearance, found, truth.lower, truth.upper - truth.lower);
    }
    tally.report("swept_box_contact");
}

TEST_F(Convex, DistanceIsALowerBoundWithinItsResolution)
{
    std::uint32_t most_units = 0;
    std::uint64_t units = 0;
    double worst = 0;
    for (std::size_t n = oracle::case_count(50'000); n > 0; --n) {
        ConvexCase c;
        fill(random, c, kKinds[random.below(5)]);
        const oracle::Bounds truth = oracle::swept_box_bounds(c.half, c.from, c.to, c.shape, 1e-9 * double(c.size));
        const float reach = random.uniform(0.0F, 4.0F * c.size);
        const float resolution = random.below(4) == 0 ? 0.0F : c.size * oracle::power_of_ten(random, -4.0F, -1.0F);
        WorkBudget budget(100'000);
        const float found = swept_box_distance(c.half, c.from, c.to, c.shape, reach, resolution, budget);
        most_units = std::max(most_units, budget.spent());
        units += budget.spent();
        const double deficit = std::min(truth.lower, double(reach)) - double(resolution) - double(found);
        worst = std::max(worst, deficit / band(c));
        ASSERT_LE(double(found), std::min(truth.upper, double(reach))) << n << " kind " << int(c.shape.kind);
        ASSERT_GE(double(found), std::min(truth.lower, double(reach)) - double(resolution) - 3.0 * band(c))
            << n << " kind " << int(c.shape.kind);
        if (truth.upper == 0.0) {
            ASSERT_EQ(found, 0.0F);
        }
    }
    std::cout << "swept_box_distance: worst shortfall beyond the resolution " << worst << " of the band, units: mean "
              << units / oracle::case_count(50'000) << " most " << most_units << "\n";
}

TEST_F(Convex, ASpentBudgetIsNeverClear)
{
    std::size_t spent = 0;
    for (std::size_t n = oracle::case_count(100'000); n > 0; --n) {
        ConvexCase c;
        fill(random, c, kKinds[random.below(5)]);
        const float clearance = random.uniform(0.0F, c.size);
        WorkBudget ample(kUnitsPerQuery);
        const Contact full = swept_box_contact(c.half, c.from, c.to, c.shape, clearance, ample);
        const auto units = static_cast<std::uint32_t>(random.below(12 * units::kExactTurn));
        WorkBudget budget(units);
        const Contact found = swept_box_contact(c.half, c.from, c.to, c.shape, clearance, budget);
        ASSERT_LE(budget.spent(), units);
        if (units >= ample.spent()) {
            ASSERT_EQ(found, full);
            ASSERT_FALSE(budget.exhausted());
        } else {
            ++spent;
            ASSERT_EQ(found, Contact::budget_spent);
            ASSERT_TRUE(budget.exhausted());
            WorkBudget small(units);
            ASSERT_EQ(swept_box_distance(c.half, c.from, c.to, c.shape, c.size, 1e-3F * c.size, small) > 0.0F &&
                          small.exhausted(),
                      false);
        }
    }
    EXPECT_GT(spent, 100U);
}

}  // namespace
}  // namespace jink::geometry
