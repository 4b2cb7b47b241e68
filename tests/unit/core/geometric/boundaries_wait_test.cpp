// SPDX-License-Identifier: BSD-3-Clause
// Candidates that wait: where the vehicle is, how fast, and how long it all takes, against the rule in double
// precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/geometric/curve.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using detail::Wait;
using world::PlanStatus;

/// The rule of curve.hpp: towards the slow speed until `until`, then up to the speed of the leg.
class Rule {
public:
    explicit Rule(const Wait& wait)
        : start_(double(wait.start_speed)), slow_(double(wait.share) * double(wait.speed)), speed_(double(wait.speed)),
          until_(double(wait.until)), acceleration_(double(wait.acceleration)), length_(double(wait.length))
    {
    }

    double at(double t) const
    {
        if (t > until_) {
            return std::min(speed_, at(until_) + acceleration_ * (t - until_));
        }
        return start_ > slow_ ? std::max(slow_, start_ - acceleration_ * t)
                              : std::min(slow_, start_ + acceleration_ * t);
    }
    double way(double t) const
    {
        constexpr int kSteps = 20'000;
        double sum = 0.0;
        for (int i = 0; i < kSteps; ++i) {
            sum += at((i + 0.5) * t / kSteps) * t / kSteps;
        }
        return sum;
    }
    /// The remaining path after waiting takes as long as at full speed, plus the time of the acceleration.
    double total() const
    {
        return until_ + (speed_ - at(until_)) / acceleration_ + std::max(0.0, length_ - way(until_)) / speed_;
    }

private:
    double start_, slow_, speed_, until_, acceleration_, length_;
};

std::vector<Wait> waits()
{
    return {{30.0F, 5.0F, 5.0F, 0.6F, 4.0F, 3.5F},   // slows down, waits, continues
            {30.0F, 5.0F, 5.0F, 0.0F, 6.0F, 3.5F},   // static
            {30.0F, 0.0F, 5.0F, 0.6F, 4.0F, 3.5F},   // speeds up to less than it will
            {30.0F, 0.0F, 5.0F, 0.0F, 4.0F, 3.5F},   // static from the beginning
            {30.0F, 3.0F, 5.0F, 0.6F, 4.0F, 3.5F},   // is as slow already
            {30.0F, 5.0F, 5.0F, 0.0F, 3.0F, 0.7F},   // still slowing down when the wait is over
            {30.0F, 1.0F, 5.0F, 0.6F, 1.5F, 0.7F},   // still speeding up
            {12.0F, 9.0F, 9.0F, 0.3F, 4.0F, 1.0F},   // comes past the end meanwhile
            {30.0F, 5.0F, 5.0F, 1.0F, 4.0F, 3.5F}};  // no wait at all
}

TEST(WaitingCurve, IsWhereTheRuleSaysAndAsFast)
{
    const Vec3 along(0.6F, 0.0F, 0.8F);
    for (const Wait& wait : waits()) {
        detail::Curve curve;
        detail::make_waiting_curve(wait, along, kMaxPathPoints, curve);
        ASSERT_EQ(curve.points, kMaxPathPoints);
        const Rule rule(wait);
        EXPECT_NEAR(double(curve.duration()), rule.total(), 2e-3)
            << "start " << wait.start_speed << " share " << wait.share << " until " << wait.until;
        // Between its points a curve is straight: each bend of the speed costs an eighth of a step's change.
        const double step = double(curve.duration()) / (kMaxPathPoints - 1);
        const double bend = 4.0 * double(wait.acceleration) * step * step / 8.0 + 1e-3;
        EXPECT_EQ(curve.position(0), Vec3(0.0F, 0.0F, 0.0F));
        for (std::size_t i = 0; i < curve.points; ++i) {
            EXPECT_NEAR(double(curve.t[i]), double(i) * step, 1e-4);
            const double way = double(curve.position(i).dot(along));
            EXPECT_NEAR(way, rule.way(double(curve.t[i])), bend) << i;
            EXPECT_LT((curve.position(i) - curve.position(i).dot(along) * along).norm(), 1e-4F);
        }
        // Never short of the end, and past it by speeding up alone or by the wait itself.
        const double end = double(curve.position(curve.points - 1).dot(along));
        EXPECT_GE(end, double(wait.length) - bend);
        // No coordinate is faster than the bound, and the bound is tight.
        for (std::size_t i = 0; i + 1 < curve.points; ++i) {
            EXPECT_LE(curve.velocity(i).norm(), curve.fastest);
        }
        EXPECT_LE(curve.fastest, 1.02F * wait.speed);
    }
}

/// Only waiting candidates, without threats.
struct WaitScene : Scene {
    explicit WaitScene(const Vec3& direction)
    {
        settings.simple = settings.symmetric = false;
        settings.wait = true;
        settings.verify_flight = false;
        threats.clear();
        problem.main = kNoThreat;
        problem.frame = make_path_frame(Vec3(0.0F, 0.0F, 50.0F), direction);
        problem.start_velocity = 5.0F * direction.normalized();
    }
};

/// Of the greatest acceleration that the vehicle has along the leg, waits use 0.7.
double acceleration_along(const Vec3& along, const vehicle::VehicleLimits& limits)
{
    const double steep = std::abs(double(along.z()));
    const double level = std::sqrt(std::max(0.0, 1.0 - steep * steep));
    const double of_level = level > 1e-9 ? double(limits.max_acceleration) / level : 1e9;
    const double of_steep = steep > 1e-9 ? double(limits.max_vertical_acceleration) / steep : 1e9;
    return 0.7 * std::min(of_level, of_steep);
}

TEST(Waiting, TakesWhatTheVehicleCanDoAlongAnyLeg)
{
    for (const Vec3& direction : {Vec3(1.0F, 0.0F, 0.0F), Vec3(3.0F, 1.0F, 2.0F), Vec3(3.0F, 1.0F, -2.0F),
                                  Vec3(0.0F, 0.0F, 1.0F), Vec3(0.0F, 0.0F, -1.0F), Vec3(1.0F, 0.0F, -5.0F)}) {
        const Vec3 along = direction.normalized();
        for (const Vec3& velocity :
             {Vec3(5.0F * along), Vec3(2.0F * along), Vec3(-3.0F * along), Vec3(9.0F * along), Vec3(Vec3::Zero())}) {
            WaitScene scene(direction);
            scene.problem.start_velocity = velocity;
            ASSERT_EQ(scene.run(), PlanStatus::found);
            ASSERT_EQ(scene.result.candidates.size(), kWaits);
            const double speed = double(vehicle::clamped_velocity(along, 5.0F, scene.limits).norm());
            for (const Candidate& c : scene.result.candidates) {
                Wait wait;
                wait.length = 1.5F * scene.problem.distance;
                wait.speed = static_cast<float>(speed);
                wait.start_speed = static_cast<float>(std::clamp(double(velocity.dot(along)), 0.0, speed));
                wait.share = c.shape.share;
                wait.until = c.shape.until;
                wait.acceleration = static_cast<float>(acceleration_along(along, scene.limits));
                ASSERT_NEAR(double(c.duration), Rule(wait).total(), 5e-3)
                    << direction.z() << " at " << velocity.dot(along) << " share " << wait.share;
            }
        }
    }
    EXPECT_EQ(curve_length_x(Family::wait, 8.0F), 12.0F);
}

TEST(Waiting, AFrameAsSkewAsIsTakenGivesFiniteTimes)
{
    WaitScene scene(Vec3::UnitZ());
    scene.problem.frame.axes *= 1.0004F;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    for (const Candidate& c : scene.result.candidates) {
        EXPECT_TRUE(std::isfinite(c.duration));
        EXPECT_GT(c.duration, 0.0F);
    }
}

TEST(Waiting, IsForMultirotorsAlone)
{
    WaitScene scene(Vec3::UnitX());
    scene.settings.simple = true;
    static_cast<void>(scene.run());
    const std::size_t with = scene.result.candidates.size();
    scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    static_cast<void>(scene.run());
    EXPECT_EQ(scene.result.candidates.size() + kWaits, with);
}

TEST(Waiting, IsNeverTooMuchForTheVehicleAndOnNoSide)
{
    // From rest, and from flight in the opposite direction: no curve is flyable.
    for (const float speed : {0.0F, -5.0F}) {
        WaitScene scene(Vec3::UnitX());
        scene.problem.start_velocity = Vec3(speed, 0.0F, 0.0F);
        for (const float side : {-1.0F, 1.0F}) {
            scene.problem.preferred_side = Vec3(0.0F, side, 0.0F);
            ASSERT_EQ(scene.run(), PlanStatus::found);
            EXPECT_EQ(scene.count(CandidateStatus::not_flyable), 0U);
            for (const Candidate& c : scene.result.candidates) {
                EXPECT_EQ(c.flip_penalty, 0.0F);
                EXPECT_EQ(c.terms.smoothness, 0.0F);
            }
        }
    }
}

TEST(Waiting, FindsWhatStandsAnywhereOnItsWay)
{
    // From rest too, where the speed bounds nothing; up to a wait's extent, and not beside it.
    for (const float speed : {0.0F, 5.0F}) {
        for (const float ahead : {3.0F, 15.0F, 29.0F}) {
            WaitScene scene(Vec3::UnitX());
            scene.problem.start_velocity = Vec3(speed, 0.0F, 0.0F);
            scene.threats = {Scene::still(Vec3(ahead, 0.0F, 50.0F), 0.5F)};
            EXPECT_EQ(scene.run(), PlanStatus::none_available);
            EXPECT_EQ(scene.count(CandidateStatus::hits_static), kWaits) << speed << " " << ahead;
            scene.threats = {Scene::still(Vec3(ahead, 1.6F, 50.0F), 0.5F)};
            EXPECT_EQ(scene.run(), PlanStatus::found) << speed << " " << ahead;
            EXPECT_EQ(scene.count(CandidateStatus::hits_static), 0U) << speed << " " << ahead;
        }
    }
}

TEST(Waiting, FindsWhatCrossesItsEndAsLateAsItIsThere)
{
    // For each candidate a threat that crosses the last metres of its path just before its arrival: no other candidate
    // is there then, and no common bound of all candidates may hide the threat.
    WaitScene free(Vec3::UnitX());
    ASSERT_EQ(free.run(), PlanStatus::found);
    for (std::size_t i = 0; i < kWaits; ++i) {
        const Seconds then = free.result.candidates[i].duration - 0.1F;
        WaitScene scene(Vec3::UnitX());
        scene.settings.max_cost = 1.0F;
        // At `then` it is at the candidate's end, for any earlier passes.
        Wait wait{30.0F, 5.0F, 5.0F, free.result.candidates[i].shape.share, free.result.candidates[i].shape.until,
                  3.5F};
        const float there = static_cast<float>(Rule(wait).way(double(then)));
        const Vec3 velocity(0.0F, -8.0F, 0.0F);
        scene.threats = {{{Vec3(there, 0.0F, 50.0F) - then * velocity, velocity}, 0.2F}};
        static_cast<void>(scene.run());
        EXPECT_EQ(scene.result.candidates[i].status, CandidateStatus::hits_moving) << i;
    }
}

}  // namespace
}  // namespace jink::geometric
