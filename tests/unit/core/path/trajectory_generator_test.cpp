// SPDX-License-Identifier: BSD-3-Clause
// The trajectory generator (G-ORCA section 13) and its acceptance test T10; look-ahead bounds are in the property
// tests.
#include "core/path/trajectory_generator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace jink::path {
namespace {

constexpr Seconds kTick = 0.025F;

class GeneratorTest : public ::testing::Test {
protected:
    void SetUp() override
    {
        limits.max_climb = 2.0F;
        limits.max_descent = 1.0F;
        limits.max_acceleration = 2.0F;
        build();
    }
    void build() { generator = std::make_unique<TrajectoryGenerator>(settings, limits); }

    /// Corners joined by samples every 5 cm, 50 ms each.
    void load(const std::vector<Vec3>& corners, bool continues = false, bool last = true)
    {
        DensePath& path = generator->path();
        ASSERT_EQ(path.begin(continues), DenseStatus::ok);
        std::uint32_t t = 0;
        ASSERT_EQ(path.add(corners[0], t), DenseStatus::ok);
        for (std::size_t i = 1; i < corners.size(); ++i) {
            const Vec3 way = corners[i] - corners[i - 1];
            const int n = std::max(1, static_cast<int>(way.norm() / 0.05F));
            for (int k = 1; k <= n; ++k) {
                t += 50;
                const Vec3 p = corners[i - 1] + way * (static_cast<float>(k) / static_cast<float>(n));
                ASSERT_EQ(path.add(p, t), DenseStatus::ok);
            }
        }
        ASSERT_EQ(path.commit(last), DenseStatus::ok);
    }
    void start(float speed, Seconds limit = 0.0F) { ASSERT_TRUE(generator->start({speed, limit}, now)); }
    GeneratorOutput step(bool blocked = false)
    {
        now = now + kTick;
        return generator->step(own, now, blocked);
    }
    /// A vehicle that flies what it is told, for as long.
    GeneratorOutput fly(Seconds time)
    {
        GeneratorOutput output;
        for (Seconds t = 0.0F; t < time; t += kTick) {
            output = step();
            own.velocity = output.velocity;
            own.position += own.velocity * kTick;
            farthest = std::max(farthest, output.error);
            EXPECT_TRUE(is_finite(output.velocity));
            EXPECT_LE(output.velocity.z(), limits.max_climb * 1.0001F);
            EXPECT_GE(output.velocity.z(), -limits.max_descent * 1.0001F);
        }
        return output;
    }

    GeneratorSettings settings;
    vehicle::VehicleLimits limits;
    std::unique_ptr<TrajectoryGenerator> generator;
    vehicle::VehicleState own;
    TimePoint now{1'000'000};
    float farthest = 0.0F;
};

TEST_F(GeneratorTest, IdleWithoutATask)
{
    EXPECT_EQ(step().status, GeneratorStatus::idle);
    EXPECT_EQ(step().velocity, Vec3::Zero());
    EXPECT_FALSE(generator->start({1.0F, 0.0F}, now)) << "no path";
    load({{0, 0, 0}, {10, 0, 0}});
    EXPECT_EQ(step().status, GeneratorStatus::idle) << "not started";
    EXPECT_FALSE(generator->start({0.0F, 0.0F}, now));
    EXPECT_FALSE(generator->start({std::numeric_limits<float>::quiet_NaN(), 0.0F}, now));
    EXPECT_FALSE(generator->start({1.0F, -1.0F}, now));
    start(1.0F);
    EXPECT_EQ(step().status, GeneratorStatus::tracking);
}

/// T10, straight line: flown at cruise speed, on the line, and done at its end.
TEST_F(GeneratorTest, T10StraightLine)
{
    load({{0, 0, 0}, {20, 0, 0}});
    start(1.0F);
    const GeneratorOutput amid = fly(10.0F);
    EXPECT_NEAR(own.position.x(), 10.0F, 0.1F);
    EXPECT_LT((amid.velocity - Vec3(1, 0, 0)).norm(), 1e-3F);
    EXPECT_NEAR(amid.look_ahead, 1.3F, 1e-3F) << "0.3 + 1.0 V, no curvature";
    EXPECT_LT((amid.carrot - own.position).norm(), 1.4F);
    EXPECT_LT(farthest, 1e-3F);
    EXPECT_EQ(fly(20.0F).status, GeneratorStatus::done);
    EXPECT_LT((own.position - Vec3(20, 0, 0)).norm(), 0.15F);
}

/// T10, corner: cut by less than the look-ahead, and left behind.
TEST_F(GeneratorTest, T10Corner)
{
    load({{0, 0, 0}, {10, 0, 0}, {10, 10, 0}});
    start(1.0F);
    const GeneratorOutput end = fly(30.0F);
    EXPECT_LT(farthest, 0.8F);
    EXPECT_GT(farthest, 0.05F) << "it is cut";
    EXPECT_EQ(end.status, GeneratorStatus::done);
}

/// T10, vertical segment: climbed at no more than the vehicle can, without a way to the side.
TEST_F(GeneratorTest, T10VerticalSegment)
{
    load({{0, 0, 0}, {5, 0, 0}, {5, 0, 6}, {10, 0, 6}});
    start(1.0F);
    const GeneratorOutput end = fly(40.0F);
    EXPECT_EQ(end.status, GeneratorStatus::done);
    EXPECT_LT(farthest, 0.9F);
    EXPECT_LT((own.position - Vec3(10, 0, 6)).norm(), 0.15F);
}
TEST_F(GeneratorTest, T10StraightUp)
{
    load({{0, 0, 0}, {0, 0, 5}});
    start(1.0F);
    EXPECT_EQ(fly(20.0F).status, GeneratorStatus::done);
    EXPECT_LT(own.position.head<2>().norm(), 1e-4F);
}

/// A climb steeper than the vehicle's: the way in the level waits, and the path is kept.
TEST_F(GeneratorTest, ASteepPathIsNotFlownBeside)
{
    load({{0, 0, 0}, {5, 0, -20}});
    start(4.0F);
    own.velocity = Vec3(0.25F, 0, -1);
    const GeneratorOutput first = step();
    EXPECT_NEAR(first.velocity.z(), -1.0F, 1e-3F);
    EXPECT_NEAR(first.velocity.x(), 0.25F, 0.02F);
    fly(30.0F);
    EXPECT_LT(farthest, 0.2F);
}

/// T10, path end: V_c <- min(V_c, sqrt(2 a d), k_p d).
TEST_F(GeneratorTest, T10SlowsDownTowardsTheEnd)
{
    load({{0, 0, 0}, {20, 0, 0}});
    start(4.0F);
    const auto speed_at = [&](float x) {
        own.position = Vec3(x, 0, 0);
        return step().velocity.norm();
    };
    EXPECT_NEAR(speed_at(5.0F), 4.0F, 1e-3F);
    EXPECT_NEAR(speed_at(17.0F), std::sqrt(2.0F * 1.0F * 3.0F), 1e-2F);
    EXPECT_NEAR(speed_at(19.0F), 1.0F, 1e-2F);
    EXPECT_NEAR(speed_at(19.5F), 0.5F, 1e-2F);
}
/// DONE: within r_acc for t_acc, not for less.
TEST_F(GeneratorTest, T10DoneAfterHalfASecondAtTheEnd)
{
    load({{0, 0, 0}, {2, 0, 0}});
    start(1.0F);
    own.position = Vec3(1.9F, 0, 0);
    EXPECT_EQ(step().status, GeneratorStatus::tracking);
    for (int i = 0; i < 19; ++i) {
        EXPECT_EQ(step().status, GeneratorStatus::tracking) << i;
    }
    own.position = Vec3(1.8F, 0, 0);
    EXPECT_EQ(step().status, GeneratorStatus::tracking) << "away again";
    own.position = Vec3(1.9F, 0, 0);
    for (int i = 0; i < 20; ++i) {
        EXPECT_EQ(step().status, GeneratorStatus::tracking) << i;
    }
    EXPECT_EQ(step().status, GeneratorStatus::done);
    own.position = Vec3(0.5F, 0, 0);
    const GeneratorOutput held = step();
    EXPECT_EQ(held.status, GeneratorStatus::done);
    EXPECT_GT(held.velocity.x(), 0.0F) << "the end is held";
}
/// A path that ends where it begins.
TEST_F(GeneratorTest, ALoopIsNotDoneAtItsStart)
{
    load({{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}, {0, 0, 0}});
    start(2.0F);
    const GeneratorOutput first = fly(2.0F);
    EXPECT_EQ(first.status, GeneratorStatus::tracking);
    EXPECT_GT(first.velocity.x(), 1.9F);
    EXPECT_GT(first.left, 30.0F);
    EXPECT_EQ(fly(40.0F).status, GeneratorStatus::done);
}

/// 13.2 step 3: farther away than L, straight to the nearest point; and no jump where eps = L.
TEST_F(GeneratorTest, FarOffThePathTheCarrotIsTheNearestPoint)
{
    load({{0, 0, 0}, {20, 0, 0}});
    start(1.0F);
    own.position = Vec3(5, 4, 0);
    const GeneratorOutput off = step();
    EXPECT_LT((off.carrot - Vec3(5, 0, 0)).norm(), 1e-4F);
    EXPECT_LT((off.velocity - Vec3(0, -1, 0)).norm(), 1e-4F);
    own.position.y() = off.look_ahead * 1.0001F;
    const Vec3 outside = step().carrot;
    own.position.y() = off.look_ahead * 0.9999F;
    const Vec3 inside = step().carrot;
    EXPECT_LT((outside - inside).norm(), 0.03F * off.look_ahead);
}
/// 8.1 with D23: the carrot at distance L, ahead.
TEST_F(GeneratorTest, TheCarrotIsAtTheLookAhead)
{
    load({{0, 0, 0}, {20, 0, 0}});
    start(1.0F);
    own.position = Vec3(5, 0.2F, 0.1F);
    own.velocity = Vec3(1, 0, 0);
    const GeneratorOutput output = step();
    EXPECT_NEAR((output.carrot - own.position).norm(), output.look_ahead, 1e-4F);
    EXPECT_NEAR(output.carrot.x(), 5.0F + std::sqrt(1.69F - 0.05F), 1e-3F);
    EXPECT_NEAR(output.velocity.head<2>().norm(), 1.0F, 1e-4F) << "V_c in the level";
    const float level = (output.carrot - own.position).head<2>().norm();
    EXPECT_NEAR(output.velocity.z(), -0.1F * 1.0F / level, 1e-4F) << "v_z = (z_carrot - z) V_c / d_xy";
}

/// The non-holonomic variant: (V, dphi), and no faster a turn than its radius allows.
TEST_F(GeneratorTest, TurnsTowardsTheCarrot)
{
    for (const float radius : {0.0F, 5.0F}) {
        settings.turn_radius = radius;
        build();
        load({{0, 0, 0}, {20, 0, 0}});
        start(1.0F);
        own.position = Vec3(5, 4, 0);
        own.yaw = 0.5F;
        const GeneratorOutput output = step();
        EXPECT_NEAR(output.speed, 1.0F, 1e-4F);
        EXPECT_NEAR(output.heading_change, radius > 0.0F ? -1.0F * kTick / 5.0F : -0.5F * kPi - 0.5F, 1e-4F);
    }
}

/// W_SEARCH, and no farther ahead than search_ahead: the next lane of a search pattern is not taken for this one.
TEST_F(GeneratorTest, TheNextLaneIsNotSkippedTo)
{
    load({{0, 0, 0}, {30, 0, 0}, {30, 4, 0}, {0, 4, 0}, {0, 8, 0}, {30, 8, 0}});
    start(1.0F);
    own.position = Vec3(10, 0, 0);
    step();
    own.position = Vec3(10, 3.9F, 0);  // pushed aside, onto the next lane
    const GeneratorOutput pushed = step();
    EXPECT_LT((pushed.nearest - Vec3(10, 0, 0)).norm(), 1e-3F);
    EXPECT_EQ(generator->progress(), 0U);
    EXPECT_LT((pushed.velocity - Vec3(0, -1, 0)).norm(), 1e-3F);
}
/// A long segment is left at its end, however long it is.
TEST_F(GeneratorTest, ALongSegmentEnds)
{
    load({{0, 0, 0}, {100, 0, 0}, {100, 100, 0}});
    start(4.0F);
    own.position = Vec3(99, 0, 0);
    step();
    own.position = Vec3(100, 2, 0);
    const GeneratorOutput output = step();
    EXPECT_GE(generator->progress(), 1U);
    EXPECT_LT((output.velocity - Vec3(0, 4, 0)).norm(), 0.1F);
}

/// Progress never goes back, and waits while the vehicle is held.
TEST_F(GeneratorTest, ProgressIsFrozenWhileTheVehicleIsHeld)
{
    load({{0, 0, 0}, {5, 0, 0}, {5, 5, 0}, {10, 5, 0}});
    start(1.0F);
    own.position = Vec3(5, 2.5F, 0);
    step();
    const std::size_t there = generator->progress();
    EXPECT_GE(there, 1U);
    Vec3 carrot = Vec3::Zero();
    for (int i = 0; i < 400; ++i) {
        const GeneratorOutput output = step();
        carrot = i == 0 ? output.carrot : carrot;
        EXPECT_EQ(output.carrot, carrot) << "no carrot runs away";
    }
    EXPECT_EQ(generator->progress(), there);
    own.position = Vec3(1, 0, 0);
    step();
    EXPECT_EQ(generator->progress(), there) << "never back";
}

TEST_F(GeneratorTest, ReportsAPathThatIsLost)
{
    load({{0, 0, 0}, {20, 0, 0}});
    start(1.0F);
    own.position = Vec3(5, 5.5F, 0);
    GeneratorOutput output;
    for (int i = 0; i < 80; ++i) {
        output = step();
        EXPECT_EQ(output.status, GeneratorStatus::tracking) << i;
    }
    output = step();
    EXPECT_EQ(output.status, GeneratorStatus::path_lost) << "2 s";
    EXPECT_LT(output.velocity.y(), 0.0F) << "back to it";
    own.position.y() = 4.5F;
    EXPECT_EQ(step().status, GeneratorStatus::tracking);
}
TEST_F(GeneratorTest, ReportsWhatTheAvoidanceSays)
{
    load({{0, 0, 0}, {20, 0, 0}});
    start(1.0F);
    EXPECT_EQ(step(true).status, GeneratorStatus::blocked);
    EXPECT_GT(step(true).velocity.norm(), 0.9F) << "it is still wanted";
    EXPECT_EQ(step().status, GeneratorStatus::tracking);
}
TEST_F(GeneratorTest, TimesOut)
{
    load({{0, 0, 0}, {20, 0, 0}});
    start(1.0F, 1.0F);
    for (int i = 0; i < 40; ++i) {
        EXPECT_EQ(step().status, GeneratorStatus::tracking) << i;
    }
    const GeneratorOutput output = step();
    EXPECT_EQ(output.status, GeneratorStatus::timed_out);
    EXPECT_EQ(output.velocity, Vec3::Zero());
    EXPECT_EQ(step().status, GeneratorStatus::timed_out);
    start(1.0F);
    EXPECT_EQ(step().status, GeneratorStatus::tracking) << "another task";
}
TEST_F(GeneratorTest, ReportsATaskThatWasRefused)
{
    generator->reject();
    EXPECT_EQ(step().status, GeneratorStatus::rejected);
    EXPECT_EQ(step().velocity, Vec3::Zero());
    load({{0, 0, 0}, {20, 0, 0}});
    start(1.0F);
    generator->reject();
    EXPECT_EQ(step().status, GeneratorStatus::tracking) << "what is flown goes on";
    generator->stop();
    EXPECT_EQ(step().status, GeneratorStatus::idle);
}
/// Another path in the place of the one being flown: nothing is flown until its task starts.
TEST_F(GeneratorTest, AReplacedPathEndsItsTask)
{
    load({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 1, 0}, {2, 2, 0}});
    start(1.0F);
    own.position = Vec3(2, 1.5F, 0);
    step();
    load({{0, 0, 0}, {20, 0, 0}});
    EXPECT_EQ(step().status, GeneratorStatus::idle);
    EXPECT_EQ(step().velocity, Vec3::Zero());
    start(1.0F);
    EXPECT_EQ(step().status, GeneratorStatus::tracking);
    EXPECT_EQ(generator->progress(), 0U);
}

/// Streaming: the carrot goes over the joint, speed is kept, and what is not complete is not done.
TEST_F(GeneratorTest, FliesOverTheJointOfTwoChunks)
{
    load({{0, 0, 0}, {6, 0, 0}}, false, false);
    start(1.0F);
    fly(2.0F);
    load({{6, 0, 0}, {12, 3, 0}}, true, false);
    for (int i = 0; i < 200; ++i) {
        EXPECT_GT(fly(kTick).velocity.norm(), 0.99F);
    }
    EXPECT_FALSE(generator->path().has_continuation()) << "the first chunk is free";
    EXPECT_LT(farthest, 0.2F);
    EXPECT_EQ(fly(20.0F).status, GeneratorStatus::tracking) << "there is more to come";
    EXPECT_LT((own.position - Vec3(12, 3, 0)).norm(), 0.2F);
    load({{12, 3, 0}, {12, 8, 0}}, true, true);
    EXPECT_EQ(fly(20.0F).status, GeneratorStatus::done);
}

/// 13.2 step 2, term by term.
TEST_F(GeneratorTest, LookAheadByItsFormula)
{
    // Arc of radius 4 m in chords.
    std::vector<Vec3> corners;
    for (int i = 0; i <= 40; ++i) {
        const float a = 0.05F * static_cast<float>(i);
        corners.emplace_back(4.0F * std::sin(a), 4.0F - 4.0F * std::cos(a), 0.0F);
    }
    settings.per_error = 0.5F;
    build();
    load(corners);
    start(1.0F);
    own.position = Vec3(4.0F * std::sin(1.0F), 4.0F - 4.0F * std::cos(1.0F), 0.0F);
    own.velocity = Vec3(1.0F, 0, 0);
    const GeneratorOutput output = step();
    EXPECT_NEAR(output.curvature, 0.25F, 0.02F);
    const float expected = (0.3F + 1.0F - 0.5F * output.error) / (1.0F + 0.5F * output.curvature * 3.0F);
    EXPECT_NEAR(output.look_ahead, expected, 1e-5F);
    own.velocity = Vec3(20.0F, 0, 0);
    EXPECT_EQ(step().look_ahead, 3.0F) << "L_max";
    own.velocity = Vec3::Zero();
    settings.base = 0.1F;
    build();
    load(corners);
    start(0.01F);
    EXPECT_EQ(step().look_ahead, 0.3F) << "L_min";
}

/// Section 17, look-ahead bound: V = 1, T_d = 0.5 -> L >= 1.359.
TEST(StableLookAhead, CheckValue)
{
    EXPECT_NEAR(stable_look_ahead(1.0F, 0.5F, 0.0F), 1.359F, 5e-4F);
    EXPECT_NEAR(stable_look_ahead(1.0F, 0.5F, 0.5F), 2.0F, 1e-6F) << "4 V T_v";
    EXPECT_EQ(stable_look_ahead(3.0F, 0.0F, 0.0F), 0.0F);
}
/// It is the least look-ahead at run time, above L_max even.
TEST_F(GeneratorTest, NeverLooksLessFarThanIsStable)
{
    settings.delay = 0.5F;
    settings.most = 1.0F;
    build();
    load({{0, 0, 0}, {20, 0, 0}});
    start(1.0F);
    own.velocity = Vec3(1, 0, 0);
    EXPECT_NEAR(step().look_ahead, 1.359F, 1e-3F);
    own.velocity = Vec3(3, 0, 0);
    EXPECT_NEAR(step().look_ahead, 4.077F, 1e-3F);
    own.velocity = Vec3::Zero();
    EXPECT_NEAR(step().look_ahead, 1.359F, 1e-3F) << "what it is about to fly";
}

TEST(GeneratorSettings, RefusesNonsense)
{
    EXPECT_TRUE(is_valid(GeneratorSettings{}));
    const auto with = [](auto change) {
        GeneratorSettings s;
        change(s);
        return is_valid(s);
    };
    EXPECT_FALSE(with([](auto& s) { s.least = 0.0F; }));
    EXPECT_FALSE(with([](auto& s) { s.most = 0.1F; }));
    EXPECT_FALSE(with([](auto& s) { s.delay = -1.0F; }));
    EXPECT_FALSE(with([](auto& s) { s.position_gain = std::numeric_limits<float>::quiet_NaN(); }));
    EXPECT_FALSE(with([](auto& s) { s.search = 0; }));
    EXPECT_FALSE(with([](auto& s) { s.search_ahead = 0.0F; }));
    EXPECT_FALSE(with([](auto& s) { s.turn_radius = -1.0F; }));
}

}  // namespace
}  // namespace jink::path
