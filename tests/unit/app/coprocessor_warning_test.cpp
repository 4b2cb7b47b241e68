// SPDX-License-Identifier: BSD-3-Clause
// What the co-processor says of a conflict: COLLISION reports, their numbers against the conflict itself, and texts.
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
    ASSERT_TRUE(report.guidance.has_conflict);
    const world::Conflict& c = report.guidance.conflict;
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
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.guidance.has_conflict; }));
    ASSERT_EQ(t->link.warnings.size(), 1U) << "at once";
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 24; ++k) {
            t->step();
            ASSERT_TRUE(t->last.guidance.has_conflict);
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
    ASSERT_TRUE(t->until([](const StepReport& r) { return !r.guidance.has_conflict; }));
    for (int i = 0; i < 100; ++i) {
        t->step();
        ASSERT_TRUE(t->link.warnings.empty()) << "no conflict, no warning";
    }
    t->put_ahead(20.0F);
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.guidance.has_conflict; }));
    EXPECT_EQ(t->link.warnings.size(), 1U);
    EXPECT_EQ(t->said("jink: conflict"), 2) << "another conflict is said anew";
}

TEST(Warnings, OfTrafficCarryItsIdAndItsMissByHeightAndSide)
{
    for (const Vec3& aside : {Vec3(0.0F, 1.2F, 0.0F), Vec3(0.0F, 0.0F, 1.4F), Vec3(0.0F, -0.6F, -0.9F)}) {
        const auto t = advising();
        t->put_ahead(35.0F, Vec3::Zero(), aside);
        ASSERT_TRUE(t->until([](const StepReport& r) { return r.guidance.has_conflict; }));
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
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.guidance.has_conflict; }));
    Text text;
    text << "jink: conflict, traffic in " << t->last.guidance.conflict.time_to_loss << " s";
    EXPECT_TRUE(t->said_as(link::Severity::warning, text.view())) << text.view();
}

TEST(Warnings, OfAnObstacleCarryItsId)
{
    const auto t = advising();
    const float wall = t->own.position.x() + 30.0F;
    for (int i = 0; i < 200 && !t->last.guidance.has_conflict; ++i) {
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
    EXPECT_EQ(t->link.warnings[0].id, 0x02000000U + 3U * 32U);
    expect_true_of(t->link.warnings[0], t->last);
    EXPECT_EQ(t->said("jink: conflict, obstacle in "), 1);
}

TEST(Warnings, OfAClosedAreaCarryItsPlaceAmongThem)
{
    const auto t = advising();
    std::array<link::Constraint, 2> closed;
    for (std::size_t i = 0; i < 2; ++i) {
        closed[i].barrel.circle.centre = world::Vec2(t->own.position.x() + 45.0F, i == 0 ? 500.0F : 0.0F);
        closed[i].barrel.circle.radius = 10.0F;
        closed[i].barrel.bottom = 0.0F;
        closed[i].barrel.top = 100.0F;
    }
    t->coprocessor.set_constraints(closed, t->now);
    ASSERT_TRUE(t->until([](const StepReport& r) { return r.guidance.has_conflict; }));
    ASSERT_EQ(t->last.guidance.conflict.threat.kind, world::ThreatKind::barrel);
    ASSERT_EQ(t->link.warnings.size(), 1U);
    EXPECT_EQ(t->link.warnings[0].id, 0x04000000U + t->last.guidance.conflict.threat.index);
    EXPECT_EQ(t->last.guidance.conflict.threat.index, 1U);
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
            const float time = t->last.guidance.conflict.time_to_loss;
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

/// The action that a manoeuvre is reported as: what is flown, not what is met.
TEST(Warnings, SayWhatIsFlownInControl)
{
    int horizontal = 0, vertical = 0, hover = 0, report = 0;
    for (const float planes : {0.0F, 3.0F}) {
        for (const bool high_wall : {false, true}) {
            Parameters parameters;
            ASSERT_EQ(parameters.set(Param::planes, planes), ParamStatus::ok);
            ASSERT_EQ(parameters.set(Param::rotation_penalty, 0.0F), ParamStatus::ok);
            const auto t = std::make_unique<Teller>(parameters);
            t->fly(60);
            if (high_wall) {  // so wide that above it is the shorter way
                for (int k = -6; k <= 6; ++k) {
                    t->put_ahead(50.0F, Vec3::Zero(), Vec3(0.0F, 2.0F * static_cast<float>(k), -0.5F));
                }
            } else {
                t->put_ahead(50.0F, Vec3::Zero(), Vec3(0.0F, 0.4F, 0.0F));
            }
            for (int i = 0; i < 600; ++i) {
                t->step();
                for (const CollisionWarning& w : t->link.warnings) {
                    const bool controls = t->last.control == Control::ours || t->last.control == Control::returning;
                    const world::Manoeuvre* flying = t->coprocessor.flying();
                    const bool steep = flying != nullptr && std::abs(flying->side.z()) > 0.7F;
                    const bool brakes = t->last.guidance.kind == world::ManoeuvreKind::brake;
                    const CollisionAction expected = !controls ? CollisionAction::report
                                                     : brakes  ? CollisionAction::hover
                                                     : steep   ? CollisionAction::ascend_or_descend
                                                               : CollisionAction::move_horizontally;
                    EXPECT_EQ(w.action, expected);
                    ++(!controls ? report : brakes ? hover : steep ? vertical : horizontal);
                }
            }
        }
    }
    EXPECT_GT(report, 0);
    EXPECT_GT(horizontal, 0);
    EXPECT_GT(vertical, 0);
    std::printf("[ warnings ] report %d, horizontal %d, vertical %d, hover %d\n", report, horizontal, vertical, hover);
}

}  // namespace
}  // namespace jink::app::test
