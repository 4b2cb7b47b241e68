// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/convex.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <ccd/ccd.h>

#include "core/geometry/swept_box.hpp"

namespace jink::geometry {

namespace {

using detail::kRounding;

/// State that the support functions update. A separate object, because libccd passes the query itself as const.
struct Progress {
    WorkBudget& budget;
    std::uint32_t turn = 0;  ///< units of two calls, one of either solid
    std::uint32_t calls = 0;
    bool ended = false;        ///< no further information to be gained, or no call left
    bool parted = false;       ///< some direction is proven to separate the two solids
    ccd_real_t own_along = 0;  ///< last own support value
};

/// A query in units of its own size, so that libccd's absolute tolerances (1.5e-8 on lengths) are relative ones.
///
/// The own solid is the sum of a segment (+-sweep), a box (+-half) and a sphere (`rounding`), centred on the origin;
/// the other one is `core` moved by `offset`.
struct Query {
    ccd_vec3_t sweep{};
    ccd_vec3_t half{};
    ccd_vec3_t offset{};
    ccd_real_t rounding = 0;
    ccd_real_t scale = 1;  ///< query units per metre
    Shape core;            ///< centred on the origin [m]
    Progress* progress = nullptr;
};

ccd_real_t dot(const ccd_vec3_t& a, const ccd_vec3_t& b) noexcept { return ccdVec3Dot(&a, &b); }

const Query& query_of(const void* object) noexcept { return *static_cast<const Query*>(object); }

/// A point on the wrong side: such an answer ends every loop of libccd at once.
void answer_wrongly(const ccd_vec3_t& direction, ccd_vec3_t& answer) noexcept
{
    answer = direction;
    ccdVec3Scale(&answer, ccd_real_t(-1));
}

ccd_real_t signed_like(ccd_real_t magnitude, ccd_real_t sign) noexcept { return sign < 0 ? -magnitude : magnitude; }

/// libccd calls the own solid first, then the other solid in the opposite direction: calls are counted in pairs.
void own_support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* answer)
{
    const Query& query = query_of(object);
    Progress& progress = *query.progress;
    progress.ended =
        progress.parted || progress.calls + 2 > kSupportCallsPerQuery / 2 || !progress.budget.spend(progress.turn);
    if (progress.ended) {
        answer_wrongly(*direction, *answer);
        return;
    }
    progress.calls += 2;
    const ccd_real_t end = dot(*direction, query.sweep) < 0 ? ccd_real_t(-1) : ccd_real_t(1);
    const ccd_real_t length = std::sqrt(dot(*direction, *direction));
    const ccd_real_t sphere = length > 0 ? query.rounding / length : ccd_real_t(0);
    for (int i = 0; i < 3; ++i) {
        const ccd_real_t along = direction->v[i];
        answer->v[i] = end * query.sweep.v[i] + signed_like(query.half.v[i], along) + sphere * along;
    }
    progress.own_along = dot(*answer, *direction);
}

void other_support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* answer)
{
    const Query& query = query_of(object);
    Progress& progress = *query.progress;
    if (progress.ended) {
        answer_wrongly(*direction, *answer);
        return;
    }
    const ccd_real_t length = std::sqrt(dot(*direction, *direction));
    const ccd_real_t inverse = length > 0 ? ccd_real_t(1) / length : ccd_real_t(0);
    const Vec3 unit(static_cast<float>(direction->v[0] * inverse), static_cast<float>(direction->v[1] * inverse),
                    static_cast<float>(direction->v[2] * inverse));
    const Vec3 point = support(query.core, unit);
    for (int i = 0; i < 3; ++i) {
        answer->v[i] = query.offset.v[i] + query.scale * static_cast<ccd_real_t>(point[i]);
    }
    progress.parted = progress.own_along + dot(*answer, *direction) < 0;
}

void first_direction(const void* own, const void* /*other*/, ccd_vec3_t* direction)
{
    const Query& query = query_of(own);
    *direction = query.offset;
    if (dot(*direction, *direction) < ccd_real_t(1e-12)) {
        ccdVec3Set(direction, ccd_real_t(1), ccd_real_t(0), ccd_real_t(0));
    }
}

/// Scales and centres the query.
Query make_query(const detail::SweptBox& box, const Shape& shape, float clearance) noexcept
{
    Query query;
    const float radius = bounding_radius(shape);
    const float size = box.half.sum() + 0.5F * (box.to - box.from).cwiseAbs().sum() + radius + clearance;
    query.scale = size > 0.0F ? ccd_real_t(1) / static_cast<ccd_real_t>(size) : ccd_real_t(1);
    query.core = shape;
    query.core.centre = Vec3::Zero();
    for (int i = 0; i < 3; ++i) {
        const auto a = static_cast<ccd_real_t>(box.from[i]);
        const auto b = static_cast<ccd_real_t>(box.to[i]);
        query.sweep.v[i] = (b - a) * query.scale / 2;
        query.half.v[i] = static_cast<ccd_real_t>(box.half[i]) * query.scale;
        query.offset.v[i] = (static_cast<ccd_real_t>(shape.centre[i]) - (a + b) / 2) * query.scale;
    }
    // The sphere also covers the rounding of the float support points, and of libccd's own sums.
    const ccd_real_t largest =
        std::abs(query.offset.v[0]) + std::abs(query.offset.v[1]) + std::abs(query.offset.v[2]) + 1;
    query.rounding = static_cast<ccd_real_t>(clearance + 8.0F * kRounding * radius) * query.scale +
                     16 * std::numeric_limits<ccd_real_t>::epsilon() * largest;
    return query;
}

/// libccd's GJK runs first. libccd answers "no" both with a separating plane and when it cannot continue (a flat
/// simplex, a vanished direction), and gives a false "yes" on rare slender simplices. So only a separating plane makes
/// the answer `clear`. For any other answer the distance search uses the remaining calls to find a plane.
Contact search_plane(const detail::SweptBox& box, const Shape& shape, float clearance, WorkBudget& budget) noexcept
{
    Query query = make_query(box, shape, clearance);
    Progress progress{budget, units::kExactTurn + units::hull_units(shape.vertices.size())};
    query.progress = &progress;
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.first_dir = first_direction;
    ccd.support1 = own_support;
    ccd.support2 = other_support;
    ccd.max_iterations = kSupportCallsPerQuery;
    (void)ccdGJKIntersect(&query, &query, &ccd);
    if (budget.exhausted()) {
        return Contact::budget_spent;
    }
    if (progress.parted) {
        return Contact::clear;
    }
    const float slack = box.slack(shape);
    const float distance = detail::proven_distance(
        box, shape, {clearance, clearance + slack, 0.0F, kSupportCallsPerQuery - progress.calls}, budget);
    if (budget.exhausted()) {
        return Contact::budget_spent;
    }
    return distance > clearance ? Contact::clear : Contact::contact;
}

}  // namespace

Contact swept_box_contact(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape, float clearance,
                          WorkBudget& budget) noexcept
{
    assert(is_valid(shape) && half.minCoeff() >= 0.0F && clearance >= 0.0F);
    const detail::SweptBox box{half, from, to};
    const float near = clearance + box.slack(shape);
    if (detail::has_closed_form(shape)) {
        if (!budget.spend(detail::closed_form_units(shape))) {
            return Contact::budget_spent;
        }
        return box.closed_form_distance(shape) <= near ? Contact::contact : Contact::clear;
    }
    if (!budget.spend(units::kSolidQuery)) {
        return Contact::budget_spent;
    }
    if (box.distance_to(shape.centre) - bounding_radius(shape) > near) {
        return Contact::clear;
    }
    return search_plane(box, shape, clearance, budget);
}

}  // namespace jink::geometry
