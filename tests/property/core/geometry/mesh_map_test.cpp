// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/mesh_map.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "tests/oracle/map_of_hulls.hpp"
#include "tests/property/core/geometry/oracle.hpp"

// Queries of a map through its tree against a check of every piece.

namespace jink::geometry {
namespace {

std::vector<std::vector<Vec3>> any_pieces(Random& random, std::size_t count, float room)
{
    std::vector<std::vector<Vec3>> pieces(count);
    const Vec3 centre = random.below(3) == 0 ? oracle::in_cube(random, 800.0F) : Vec3(Vec3::Zero());
    for (auto& piece : pieces) {
        const Vec3 at = centre + oracle::in_cube(random, room);
        piece.resize(random.below(2) == 0 ? 3 : 4 + random.below(29));
        for (Vec3& v : piece) {
            v = at + oracle::in_cube(random, random.uniform(0.1F, 2.0F));
        }
    }
    return pieces;
}

struct Seen {
    std::uint16_t piece;
    float distance;
};

std::vector<Seen> look_at_all(const MeshMap& map, const Vec3& point, const DistanceQuery& query)
{
    std::vector<Seen> out;
    for (std::size_t i = 0; i < map.pieces.size(); ++i) {
        WorkBudget budget(100'000);
        const float distance = piece_distance(map, i, point, query, budget).distance;
        if (distance < query.reach) {
            out.push_back({static_cast<std::uint16_t>(i), distance});
        }
    }
    std::sort(out.begin(), out.end(), [](const Seen& a, const Seen& b) { return a.distance < b.distance; });
    return out;
}

TEST(NearestPieces, AreThoseThatALookAtEveryPieceFinds)
{
    Random random(oracle::seed_of(31));
    std::size_t full = 0;
    std::size_t visits = 0;
    for (std::size_t n = 0; n < oracle::case_count(200); ++n) {
        const float room = random.uniform(1.0F, 40.0F);
        const auto pieces = any_pieces(random, 1 + random.below(200), room);
        const jink::oracle::MapOfHulls tables(pieces, random.below(2) == 0 ? 0.0F : 0.01F);
        const MeshMap& map = tables.map();
        ASSERT_EQ(check(map), MapStatus::good);
        for (int q = 0; q < 10; ++q) {
            DistanceQuery query;
            query.stretch = random.below(2) == 0 ? 1.0F : random.uniform(0.5F, 4.0F);
            query.reach = random.uniform(0.1F, 20.0F);
            const Vec3 point = 0.5F * (map.low.vec() + map.high.vec()) + oracle::in_cube(random, 1.5F * room);
            std::vector<NearPiece> out(1 + random.below(20));
            WorkBudget budget(10'000'000);
            const NearestPieces found = nearest_pieces(map, point, query, out, budget);
            const std::vector<Seen> truth = look_at_all(map, point, query);
            // Pieces at the reach, within the resolution, may be left out.
            const auto sure = static_cast<std::size_t>(std::count_if(
                truth.begin(), truth.end(), [&](const Seen& seen) { return seen.distance < query.reach - 2.5e-4F; }));
            ASSERT_GE(found.found, std::min(out.size(), sure)) << "case " << n;
            ASSERT_LE(found.found, std::min(out.size(), truth.size())) << "case " << n;
            for (std::size_t i = 0; i < found.found; ++i) {
                // A search that may stop early at the last one's distance knows it less exactly.
                ASSERT_NEAR(out[i].from.distance, truth[i].distance, 2.5e-4F) << "case " << n;
                if (i > 0) {
                    ASSERT_GE(out[i].from.distance, out[i - 1].from.distance);
                }
            }
            if (truth.size() > out.size()) {
                ++full;
                ASSERT_LE(found.dropped, truth[out.size()].distance + 2.5e-4F) << "case " << n;
                ASSERT_GE(found.dropped, out[found.found - 1].from.distance);
            } else if (truth.size() < out.size()) {
                ASSERT_EQ(found.dropped, query.reach) << "case " << n;
            }
            // The same with a small budget: pieces outside the answer are not nearer than stated.
            WorkBudget little(static_cast<std::uint32_t>(random.below(300)));
            const NearestPieces some = nearest_pieces(map, point, query, out, little);
            for (const Seen& seen : truth) {
                const bool told = std::any_of(out.begin(), out.begin() + long(some.found),
                                              [&](const NearPiece& near) { return near.piece == seen.piece; });
                ASSERT_TRUE(told || seen.distance >= some.dropped - 2.5e-4F) << "case " << n;
            }
            visits += budget.spent();
        }
    }
    std::cout << full << " answers with pieces left out, " << visits / (10 * oracle::case_count(200))
              << " units a query\n";
    EXPECT_GT(full, oracle::case_count(200) / 4);
}

TEST(VisitNear, VisitsEveryPieceWithinReachOnceAndItsBoundHolds)
{
    Random random(oracle::seed_of(32));
    for (std::size_t n = 0; n < oracle::case_count(300); ++n) {
        const auto pieces = any_pieces(random, 1 + random.below(100), 10.0F);
        const jink::oracle::MapOfHulls tables(pieces);
        const MeshMap& map = tables.map();
        const float stretch = random.uniform(0.5F, 4.0F);
        const float reach = random.uniform(0.1F, 15.0F);
        const Vec3 point = 0.5F * (map.low.vec() + map.high.vec()) + oracle::in_cube(random, 12.0F);
        std::vector<int> visited(map.pieces.size(), 0);
        WorkBudget budget(1'000'000);
        DistanceQuery query;
        query.stretch = stretch;
        const float passed_over = visit_near(map, point, stretch, reach, budget, [&](std::uint16_t piece, float bound) {
            ++visited[piece];
            WorkBudget own(100'000);
            const Separation from = piece_distance(map, piece, point, query, own);
            EXPECT_LE(bound, from.upper * (1.0F + 1e-5F) + 1e-6F);
            return reach;
        });
        ASSERT_EQ(passed_over, reach);
        for (std::size_t i = 0; i < visited.size(); ++i) {
            WorkBudget own(100'000);
            const bool near = piece_distance(map, i, point, query, own).upper < reach;
            ASSERT_LE(visited[i], 1);
            ASSERT_TRUE(!near || visited[i] == 1) << "case " << n << " piece " << i;
        }
    }
}

}  // namespace
}  // namespace jink::geometry
