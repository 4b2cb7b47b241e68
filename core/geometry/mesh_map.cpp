// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/mesh_map.hpp"

#include <cassert>
#include <limits>

namespace jink::geometry {

namespace {

/// Puts `piece` among the first `found` of `out`, nearest first. Returns the distance of the piece that drops out of a
/// full list.
float insert(std::span<NearPiece> out, std::size_t& found, const NearPiece& piece) noexcept
{
    float lost = std::numeric_limits<float>::infinity();
    if (found == out.size()) {
        lost = std::max(piece.from.distance, out.back().from.distance);
        if (piece.from.distance >= out.back().from.distance) {
            return piece.from.distance;
        }
        --found;
    }
    std::size_t at = found++;
    for (; at > 0 && piece.from.distance < out[at - 1].from.distance; --at) {
        out[at] = out[at - 1];
    }
    out[at] = piece;
    return lost;
}

}  // namespace

Separation piece_distance(const MeshMap& map, std::size_t piece, const Vec3& point, const DistanceQuery& query,
                          WorkBudget& budget) noexcept
{
    const float slack = stretched_slack(map, query.stretch);
    DistanceQuery bare = query;
    bare.reach += slack;
    Separation from = point_hull_distance(point, map.vertices_of(piece), bare, budget);
    from.distance -= slack;
    if (!(from.distance > 0.0F)) {
        from.distance = 0.0F;
        from.direction = Vec3::Zero();
    }
    return from;
}

Exit piece_exit(const MeshMap& map, std::size_t piece, const Vec3& point, float stretch) noexcept
{
    Exit out = map.pieces[piece].faces > 0 ? exit_by_faces(point, map.faces_of(piece), stretch)
                                           : exit_by_vertices(point, map.vertices_of(piece), stretch);
    out.depth += stretched_slack(map, stretch);
    return out;
}

NearestPieces nearest_pieces(const MeshMap& map, const Vec3& point, const DistanceQuery& query,
                             std::span<NearPiece> out, WorkBudget& budget) noexcept
{
    assert(!out.empty());
    NearestPieces answer;
    float lost = query.reach;
    const auto visit = [&](std::uint16_t piece, float bound) {
        const bool full = answer.found == out.size();
        DistanceQuery asked = query;
        asked.start = Vec3::Zero();
        asked.reach = full ? std::max(out.back().from.distance, std::numeric_limits<float>::min()) : query.reach;
        const NearPiece near{piece, piece_distance(map, piece, point, asked, budget)};
        if (budget.exhausted()) {
            lost = std::min(lost, std::max(bound, near.from.distance));
        } else if (near.from.distance < query.reach) {
            lost = std::min(lost, insert(out, answer.found, near));
        }
        return answer.found == out.size() ? std::min(query.reach, out.back().from.distance) : query.reach;
    };
    const float passed_over = visit_near(map, point, query.stretch, query.reach, budget, visit);
    answer.dropped = std::min(lost, passed_over);
    return answer;
}

}  // namespace jink::geometry
