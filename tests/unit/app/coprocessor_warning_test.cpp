// SPDX-License-Identifier: BSD-3-Clause
// The co-processor's reports of a conflict: COLLISION reports, their values against the conflict itself, and texts.
#include <gtest/gtest.h>

#include "tests/unit/app/telling_bench.hpp"

namespace jink::app::test {
namespace {

using link::CollisionAction;
using link::CollisionWarning;
using link::ThreatLevel;

/// Half the distance that a vehicle of 5 m/s, 5 m/s2 and a lag of 0.25 s takes to stop: 0.75 s of full deceleration
/// from 5 to 1.25 m/s, then a decay to 0.05 m/s; and one second more.
constexpr float kNearTime = 0.75F + 0.25F * 3.218876F + 1.0F;

std::unique_ptr<Teller> advising()
{
    Parameters parameters;
    EXPECT_EQ(parameters.set(Param::mode, 1.0F), ParamStatus::ok);
    auto t = std::make_unique<Teller>(parameters);
    t->fly(60);
    return t;
}

/// The warning of this step against the conflict that the step reports.
void expect_true_of(const CollisionWarning& w, const StepReport& report)
{
    ASSERT_TRUE(report.guidance.conflict.has_value());
    const world::Conflict& c = *report.guidance.conflict;
    const Vec3 miss = c.own_at_closest - c.threat_at_closest;
    EXPECT_EQ(w.time_to_closest, c.time_to_closest);
    EXPECT_NEAR(w.horizontal_miss, miss.head<2>().norm(), 1e-4F);
    EXPECT_NEAR(w.vertical_miss, std::sqrt(miss.z() * miss.z()), 1e-5F);
}

TEST(Warnings, AreSentAtOnceAndTwiceASecondWhileTheConflictLasts)
{
    const auto t = advising();
    EXPECT_TRUE(t->link.warnings.empty());
    t->put_ahead(60.0F);
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.guidance.conflict.has_value(); }));
    ASSERT_EQ(t->link.warnings.size(), 1U) << "at once";
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 24; ++k) {
            t->step();
            ASSERT_TRUE(t->last.guidance.conflict.has_value());
            ASSERT_TRUE(t->link.warnings.empty()) << i << ' ' << k;
        }
        t->step(19'999);
        ASSERT_TRUE(t->link.warnings.empty()) << i;
        t->step(1);
        ASSERT_EQ(t->link.warnings.size(), 1U) << i;
        expect_true_of(t->link.warnings[0], t->last);
    }
    EXPECT_EQ(t->said("jink: conflict"), 1);
    t->traffic.clear();
    ASSERT_TRUE(t->until([](const StepReport& r) { return !r.guidance.conflict.has_value(); }));
    for (int i = 0; i < 100; ++i) {
        t->step();
        ASSERT_TRUE(t->link.warnings.empty()) << "no conflict, no warning";
    }
    t->put_ahead(20.0F);
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.guidance.conflict.has_value(); }));
    EXPECT_EQ(t->link.warnings.size(), 1U);
    EXPECT_EQ(t->said("jink: conflict"), 2) << "another conflict is said anew";
}

TEST(Warnings, OfTrafficCarryItsIdAndItsMissByHeightAndSide)
{
    for (const Vec3& aside : {Vec3(0.0F, 1.2F, 0.0F), Vec3(0.0F, 0.0F, 1.4F), Vec3(0.0F, -0.6F, -0.9F)}) {
        const auto t = advising();
        t->put_ahead(35.0F, Vec3::Zero(), aside);
        ASSERT_TRUE(t->until([](const StepReport& r) { return r.guidance.conflict.has_value(); }));
        ASSERT_EQ(t->link.warnings.size(), 1U);
        const CollisionWarning& w = t->link.warnings[0];
        EXPECT_EQ(w.id, 100U);
        expect_true_of(w, t->last);
        EXPECT_NEAR(w.horizontal_miss, std::abs(aside.y()), 0.1F);
        EXPECT_NEAR(w.vertical_miss, std::abs(aside.z()), 0.1F);
        EXPECT_EQ(w.action, CollisionAction::report) << "nobody acts";
        EXPECT_EQ(t->said("jink: conflict, traffic in "), 1);
    }
}

TEST(Warnings, SayInHowManySecondsTheConflictComes)
{
    const auto t = advising();
    t->put_ahead(30.0F);
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.guidance.conflict.has_value(); }));
    Text text;
    text << "jink: conflict, traffic in " << t->last.guidance.conflict->time_to_loss << " s";
    EXPECT_TRUE(t->said_as(link::Severity::warning, text.view())) << text.view();
}

TEST(Warnings, OfAnObstacleCarryItsId)
{
    const auto t = advising();
    const float wall = t->own.position.x() + 30.0F;
    for (int i = 0; i < 200 && !t->last.guidance.conflict.has_value(); ++i) {
        link::RangeReading reading;
        reading.stamp = t->now;
        reading.range = wall - t->own.position.x();
        reading.max_range = 60.0F;
        reading.half_angle = 0.02F;
        reading.sensor = 3;
        t->link.next.readings.unchecked_push_back(reading);
        t->step();
    }
    ASSERT_EQ(t->link.warnings.size(), 1U);
    EXPECT_EQ(t->link.warnings[0].id, 0x02000000U + 3U * 128U * 32U);
    expect_true_of(t->link.warnings[0], t->last);
    EXPECT_EQ(t->said("jink: conflict, obstacle in "), 1);
}

TEST(Warnings, OfAClosedAreaCarryItsPlaceAmongThem)
{
    const auto t = advising();
    std::array<link::Constraint, 2> closed;
    for (std::size_t i = 0; i < 2; ++i) {
        closed[i].cylinder.circle.centre = world::Vec2(t->own.position.x() + 45.0F, i == 0 ? 500.0F : 0.0F);
        closed[i].cylinder.circle.radius = 10.0F;
        closed[i].cylinder.bottom = 0.0F;
        closed[i].cylinder.top = 100.0F;
    }
    t->coprocessor.set_constraints(closed, t->now);
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.guidance.conflict.has_value(); }));
    ASSERT_EQ(t->last.guidance.conflict->threat.kind, world::ThreatKind::cylinder);
    ASSERT_EQ(t->link.warnings.size(), 1U);
    EXPECT_EQ(t->link.warnings[0].id, 0x04000000U + t->last.guidance.conflict->threat.index);
    EXPECT_EQ(t->last.guidance.conflict->threat.index, 1U);
    expect_true_of(t->link.warnings[0], t->last);
    EXPECT_EQ(t->said("jink: conflict, closed area in "), 1);
}

TEST(Warnings, AreHighWhenTheLossIsNearerThanTheStopAndASecond)
{
    const auto t = advising();
    t->put_ahead(60.0F);
    int low = 0, high = 0;
    for (int i = 0; i < 700; ++i) {
        t->step();
        for (const CollisionWarning& w : t->link.warnings) {
            const float time = t->last.guidance.conflict->time_to_loss;
            if (std::abs(time - kNearTime) < 1e-3F) {
                continue;
            }
            EXPECT_EQ(w.level, time < kNearTime ? ThreatLevel::high : ThreatLevel::low) << time;
            ++(time < kNearTime ? high : low);
        }
    }
    EXPECT_GT(low, 3);
    EXPECT_GT(high, 3);
}

/// Counts of the actions that were reported.
struct Actions {
    int report = 0, horizontal = 0, vertical = 0, hover = 0;

    /// Each warning of the last step reports the flown action, not the threat.
    void check(const Teller& t)
    {
        for (const CollisionWarning& w : t.link.warnings) {
            const bool controls = t.last.control == Control::ours || t.last.control == Control::returning;
            const world::Manoeuvre* flying = t.coprocessor.flying();
            const bool steep = flying != nullptr && std::abs(flying->side.z()) > 0.7F;
            const bool brakes = t.last.guidance.kind == world::ManoeuvreKind::brake;
            const CollisionAction expected = !controls ? CollisionAction::report
                                             : brakes  ? CollisionAction::hover
                                             : steep   ? CollisionAction::ascend_or_descend
                                                       : CollisionAction::move_horizontally;
            EXPECT_EQ(w.action, expected);
            ++(!controls ? report : brakes ? hover : steep ? vertical : horizontal);
        }
    }
};

TEST(Warnings, SayWhetherItIsFlownAroundOverOrUnder)
{
    Actions actions;
    for (const float offset : {-1.0F, 0.0F, 1.0F}) {
        Parameters parameters;
        ASSERT_EQ(parameters.set(Param::rotation_penalty, 0.0F), ParamStatus::ok);
        const auto t = std::make_unique<Teller>(parameters);
        t->fly(60);
        // A row so wide that the path over or under it is shorter; or a single body.
        for (int k = offset != 0.0F ? -6 : 0; k <= (offset != 0.0F ? 6 : 0); ++k) {
            t->put_ahead(50.0F, Vec3::Zero(), Vec3(0.0F, 0.4F + 2.0F * static_cast<float>(k), offset));
        }
        const int vertical = actions.vertical;
        float highest = 0.0F;
        for (int i = 0; i < 600; ++i) {
            t->step();
            actions.check(*t);
            const float side = t->coprocessor.flying() != nullptr ? t->coprocessor.flying()->side.z() : 0.0F;
            highest = std::abs(side) > std::abs(highest) ? side : highest;
        }
        if (offset != 0.0F) {
            EXPECT_LT(highest * offset, 0.0F) << "over what is lower, under what is higher";
            EXPECT_GT(actions.vertical, vertical) << offset;
        }
    }
    EXPECT_GT(actions.report, 0);
    EXPECT_GT(actions.horizontal, 0);
}

/// A level scan of 72 sectors and 40 m, and the plane x = `wall`.
link::RangeScan scan_of(const Teller& t, float wall)
{
    link::RangeScan scan;
    scan.stamp = t.now;
    scan.increment = 2.0F * kPi / 72.0F;
    scan.min_range = 0.2F;
    scan.max_range = 40.0F;
    for (int i = 0; i < 72; ++i) {
        const float range = (wall - t.own.position.x()) / std::cos(scan.increment * static_cast<float>(i));
        scan.ranges.unchecked_push_back(range > 0.2F && range < 40.0F ? range : link::RangeScan::kNothing);
    }
    return scan;
}

TEST(Warnings, SayThatItBrakesInFrontOfAWall)
{
    Actions actions;
    const auto t = teller();
    t->fly(60);
    const float wall = t->own.position.x() + 60.0F;
    for (int i = 0; i < 1500 && actions.hover < 2; ++i) {
        if (i % 5 == 0) {
            t->link.next.scans.unchecked_push_back(scan_of(*t, wall));
        }
        t->step();
        actions.check(*t);
    }
    EXPECT_EQ(actions.hover, 2);
    EXPECT_EQ(t->said("jink: no way around, braking") + t->said("jink: nothing safe, braking"), 1) << "once";
}

TEST(Warnings, OfAConflictThatComesBackAreSentAtOnce)
{
    const auto t = advising();
    t->put_ahead(40.0F);
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.guidance.conflict.has_value(); }));
    t->fly(3);
    t->own.velocity = Vec3(0.0F, 5.0F, 0.0F);
    ASSERT_TRUE(t->until([](const StepReport& r) { return !r.guidance.conflict.has_value(); }, 5));
    t->own.velocity = Vec3(5.0F, 0.0F, 0.0F);
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.guidance.conflict.has_value(); }, 5));
    EXPECT_EQ(t->link.warnings.size(), 1U) << "half a second after the last one is not waited for";
    EXPECT_EQ(t->said("jink: conflict"), 2);
}

}  // namespace
}  // namespace jink::app::test
