// SPDX-License-Identifier: BSD-3-Clause
// Full tables and full ids: which track is replaced, and the order of the snapshot.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/core/world/track_edges.hpp"

namespace jink::world {
namespace {

using namespace test;

/// A full table of static tracks at `distance` to all sides, each measured three times.
struct FullTable : TrackEdges {
    void fill(float distance)
    {
        settings.max_age = 1000.0F;
        table.configure(settings);
        // One more each two seconds: no flood.
        for (std::size_t i = 0; i < kMaxTracks; ++i) {
            for (int n = 0; n < 3; ++n) {
                static_cast<void>(take(standing(static_cast<TrackId>(i + 1), distance, now)));
                now = now + 0.7F;
            }
        }
        // All of them of one age.
        for (std::size_t i = 0; i < kMaxTracks; ++i) {
            static_cast<void>(take(standing(static_cast<TrackId>(i + 1), distance, now)));
        }
        EXPECT_EQ(table.size(), kMaxTracks);
        EXPECT_EQ(table.diagnostics().doubled, 0U);
    }
    [[nodiscard]] static TrackMeasurement standing(TrackId id, float distance, TimePoint stamp)
    {
        const float angle = static_cast<float>(id);
        TrackMeasurement m = seen(id, distance * Vec3(std::cos(angle), std::sin(angle), 0), stamp);
        m.velocity = Vec3::Zero();
        return m;
    }
    [[nodiscard]] bool knows(TrackId id)
    {
        for (const Track& t : table.snapshot(now)) {
            if (t.id == id) {
                return true;
            }
        }
        return false;
    }
    TimePoint now = kStart;
};

/// A newcomer counts one and a half times, twice in a flood. 31 m off, less a metre of body, are 10 s; 22 m are 7 s.
TEST_F(FullTable, ANewcomerCountsMoreInAFlood)
{
    fill(31.0F);
    EXPECT_EQ(take(standing(501, 18.5F, now)), TrackStatus::replaced) << "8.75 s";
    EXPECT_EQ(table.diagnostics().floods, 0U);
    for (int i = 0; i < 2; ++i) {
        now = now + 0.1F;
        EXPECT_EQ(take(standing(501, 18.5F, now)), TrackStatus::updated);  // no newcomer any more
    }
    now = now + 2.0F;
    for (TrackId id = 600; id < 616; ++id) {
        EXPECT_EQ(take(standing(id, 500.0F, now)), TrackStatus::full);
    }
    EXPECT_EQ(table.diagnostics().floods, 0U) << "16 in a second";
    EXPECT_EQ(take(standing(502, 22.0F, now)), TrackStatus::full) << "14 s, to 12 with the others' age";
    EXPECT_EQ(table.diagnostics().floods, 1U) << "the 17th";
    now = now + 1.0F;
    EXPECT_EQ(take(standing(503, 22.0F, now)), TrackStatus::replaced) << "a second after the flood began it is over";
}

/// A very near track is replaced by a nearer one.
TEST_F(FullTable, TheLeastUrgentGivesWayHoweverUrgentAllAre)
{
    fill(3.0F);  // 2 m: two thirds of a second
    now = now + 0.1F;
    for (std::size_t i = 0; i < kMaxTracks; ++i) {
        if (i != 20) {
            static_cast<void>(take(standing(static_cast<TrackId>(i + 1), 3.0F, now)));
        }
    }
    // Number 21 is a tenth of a second older.
    EXPECT_EQ(take(standing(501, 1.0F, now)), TrackStatus::replaced);
    EXPECT_FALSE(knows(21));
    EXPECT_TRUE(knows(501));
    EXPECT_TRUE(knows(1));
}

TEST_F(FullTable, LessUrgentThanTheLeastUrgentIsNotEnough)
{
    fill(31.0F);
    TrackMeasurement m = standing(501, 21.2F, now);  // 20.2 m, one and a half times
    EXPECT_EQ(take(m), TrackStatus::full);
    m = standing(502, 20.8F, now);
    EXPECT_EQ(take(m), TrackStatus::replaced);
}

/// Four of one id: the least urgent of these is replaced, not that of the table, and its instance is reused.
TEST_F(TrackEdges, AFullIdGivesWayToItself)
{
    const auto at = [&](float y, TrackId id = 1) {
        TrackMeasurement m = seen(id, Vec3(0, y, 0));
        m.velocity = Vec3::Zero();
        return m;
    };
    ASSERT_EQ(take(at(900.0F, 9)), TrackStatus::created);  // less urgent than all others, of another id
    for (const float y : {100.0F, -300.0F, 200.0F, -150.0F}) {
        ASSERT_EQ(take(at(y)), TrackStatus::created);
    }
    EXPECT_EQ(take(at(-400.0F)), TrackStatus::full);
    EXPECT_EQ(take(at(50.0F)), TrackStatus::replaced);
    const auto tracks = table.snapshot(kStart);
    ASSERT_EQ(tracks.size(), 5U);
    const float expected[] = {100.0F, 50.0F, 200.0F, -150.0F, 900.0F};
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(tracks[i].position.y(), expected[i]) << i;
        EXPECT_EQ(tracks[i].id, i < 4 ? 1U : 9U);
        EXPECT_EQ(tracks[i].instance, i < 4 ? i : 0U);
    }
}

TEST_F(TrackEdges, AFullIdOfWhatIsAllButHereGivesWayToo)
{
    const auto at = [&](float y) {
        TrackMeasurement m = seen(1, Vec3(0, y, 0));
        m.velocity = Vec3::Zero();
        m.sigma_position = 0.01F;
        return m;
    };
    for (const float y : {1.1F, 2.5F, -1.8F, -1.2F}) {
        ASSERT_EQ(take(at(y)), TrackStatus::created);
    }
    EXPECT_EQ(take(at(0.2F)), TrackStatus::replaced);
    const auto tracks = table.snapshot(kStart);
    ASSERT_EQ(tracks.size(), 4U);
    EXPECT_EQ(tracks[1].position.y(), 0.2F);
}

/// A table that is full of others gives a second one of an id its own instance.
TEST_F(FullTable, ASecondOneOfAnIdThatReplacesAnotherHasItsOwnInstance)
{
    fill(100.0F);
    TrackMeasurement second = standing(5, 10.0F, now);
    second.position = -second.position;
    EXPECT_EQ(take(second), TrackStatus::replaced);
    const auto tracks = table.snapshot(now);
    std::size_t of_id = 0;
    for (std::size_t i = 0; i < tracks.size(); ++i) {
        of_id += tracks[i].id == 5 ? 1U : 0U;
        if (i > 0 && tracks[i].id == tracks[i - 1].id) {
            EXPECT_LT(tracks[i - 1].instance, tracks[i].instance);
        }
    }
    EXPECT_EQ(of_id, 2U);
}

/// For any input order: by id, then by instance.
TEST_F(TrackEdges, SnapshotsAreOrderedByIdAndInstance)
{
    for (const TrackId id : {5U, 3U, 5U, 3U, 5U, 4U}) {
        const auto n = static_cast<float>(table.size());
        static_cast<void>(take(seen(id, Vec3(100.0F * n, 0, 0), kStart + 0.1F * n)));
    }
    settings.max_age = 0.45F;
    table.configure(settings);
    table.expire(kStart + 0.5F);  // the first one; the last takes its place
    static_cast<void>(take(seen(5, Vec3(900, 0, 0), kStart + 0.5F)));
    const auto tracks = table.snapshot(kStart + 0.5F);
    ASSERT_EQ(tracks.size(), 6U);
    for (std::size_t i = 1; i < tracks.size(); ++i) {
        const bool rises = tracks[i - 1].id < tracks[i].id ||
                           (tracks[i - 1].id == tracks[i].id && tracks[i - 1].instance < tracks[i].instance);
        EXPECT_TRUE(rises) << i;
    }
}

}  // namespace
}  // namespace jink::world
