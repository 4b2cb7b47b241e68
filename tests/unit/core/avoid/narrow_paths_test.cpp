// SPDX-License-Identifier: BSD-3-Clause
// Paths that are free with a small clearance buffer.
#include <gtest/gtest.h>

#include "tests/unit/core/avoid/waiting.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;

/// An obstacle 0.2 m beside the path: free, but not with a buffer of half a metre.
struct Narrow : Waiting {
    explicit Narrow() : Waiting(quick())
    {
        stand(Vec3(55, 0, 30));
        f.scene.track(Vec3(63, 0, 30), Vec3::Zero(), 1.0F);
        static_cast<void>(update());
        f.scene.own.velocity = Vec3(5, 0, 0);
        EXPECT_EQ(update().state, State::braking);
        f.scene.own.velocity = Vec3::Zero();
        EXPECT_EQ(update().state, State::braking);
        asked = method.asked;
        f.scene.tracks[0].position.y() = 2.2F;
        EXPECT_FALSE(after(0.1F).conflict.has_value());
    }
    int asked = 0;
};

TEST(NarrowPaths, AreTriedAfterThreeTimesTheSettlingTime)
{
    Narrow w;
    EXPECT_EQ(w.wait(1.4F).state, State::braking);
    EXPECT_EQ(w.method.asked, w.asked) << "no plan without a conflict";
    EXPECT_EQ(w.after(0.1F).state, State::rejoining) << "1.5 s";
}

TEST(NarrowPaths, AreWaitedAtAnewAfterEachConflict)
{
    Narrow w;
    static_cast<void>(w.wait(1.0F));
    w.f.scene.tracks[0].position.y() = 1.0F;
    EXPECT_TRUE(w.after(0.1F).conflict.has_value());
    w.f.scene.tracks[0].position.y() = 2.2F;
    EXPECT_FALSE(w.after(0.1F).conflict.has_value());
    EXPECT_EQ(w.wait(1.4F).state, State::braking);
    EXPECT_EQ(w.after(0.1F).state, State::rejoining);
}

/// The clearance buffer is required over the whole look-ahead of conflicts.
TEST(NarrowPaths, AreThoseFarAheadToo)
{
    Narrow w;
    w.f.scene.tracks[0].position = Vec3(92, 2.2F, 30);  // 7 s ahead
    EXPECT_EQ(w.wait(1.3F).state, State::braking);
    EXPECT_EQ(w.wait(0.3F).state, State::rejoining);
}

/// Backing off is bounded while it waits there, too.
TEST(NarrowPaths, AreBackedOffFromUntilTheLimitAlone)
{
    Settings settings = quick();
    settings.settle = 2.0F;
    settings.blocked_patience = 0.0F;
    settings.back_off_limit = 0.45F;
    Waiting w(settings);
    w.stand(Vec3(55, 0, 30));
    w.f.scene.track(Vec3(58, 0, 30), Vec3::Zero(), 1.0F);
    EXPECT_EQ(w.update().state, State::braking);
    w.f.scene.tracks[0].position = Vec3(63, 2.2F, 30);
    int backs = 0;
    for (int i = 0; i < 50; ++i) {
        const Guidance g = w.after(0.1F);
        ASSERT_FALSE(g.conflict.has_value());
        ASSERT_EQ(g.state, State::braking);
        backs += g.kind == ManoeuvreKind::velocity ? 1 : 0;
    }
    EXPECT_EQ(backs, 5);
}

TEST(NarrowPaths, WithMoreToSpareAreTrustedAfterTheSettlingTime)
{
    Narrow w;
    w.f.scene.tracks[0].position.y() = 2.6F;
    static_cast<void>(w.after(0.1F));
    EXPECT_EQ(w.wait(0.4F).state, State::braking);
    EXPECT_EQ(w.after(0.1F).state, State::rejoining) << "half a second";
}

}  // namespace
}  // namespace jink::avoid
