// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/convex.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <ccd/ccd.h>

#include "core/geometry/sweep.hpp"

namespace jink::geometry {

namespace {

/// Largest relative error of one float operation.
constexpr float kRounding = 0x1p-24F;

/// Rounds of a distance search: from the largest to the smallest distance worth telling apart (2^40) in halves.
constexpr int kDistanceRounds = 40;

/// A query in units of its own size, so that libccd's absolute tolerances (1.5e-8 on lengths) are relative ones.
///
/// The own solid is the sum of a segment (+-sweep), a box (+-half) and a ball (`rounding`), centred on the origin; the other
/// one is `core` moved by `offset`.
struct Query {
    ccd_vec3_t sweep{};
    ccd_vec3_t half{};
    ccd_vec3_t offset{};
    ccd_real_t rounding = 0;
    ccd_real_t scale = 1;            ///< query units per metre
    Shape core;                      ///< centred on the origin [m]
    std::uint32_t calls = 0;
    std::uint32_t calls_allowed = 0;
    bool spent = false;
    ccd_real_t own_along = 0;        ///< last own support value
    ccd_real_t gap = 0;              ///< largest separation that a direction has proven so far, 0 when none has
};

ccd_real_t dot(const ccd_vec3_t& a, const ccd_vec3_t& b) noexcept { return ccdVec3Dot(&a, &b); }

/// libccd hands the objects over as pointers to const; both are the query, which lives on the caller's stack.
Query& query_of(const void* object) noexcept { return *static_cast<Query*>(const_cast<void*>(object)); }

/// A point on the wrong side: with it every loop of libccd ends at once.
void answer_wrongly(const ccd_vec3_t& direction, ccd_vec3_t& answer) noexcept
{
    answer = direction;
    ccdVec3Scale(&answer, ccd_real_t(-1));
}

ccd_real_t signed_like(ccd_real_t magnitude, ccd_real_t sign) noexcept { return sign < 0 ? -magnitude : magnitude; }

/// libccd asks the own solid first, then the other one in the opposite direction: calls are counted in pairs.
void own_support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* answer)
{
    Query& query = query_of(object);
    if (query.calls + 2 > query.calls_allowed) {
        query.spent = true;
        answer_wrongly(*direction, *answer);
        return;
    }
    query.calls += 2;
    const ccd_real_t end = dot(*direction, query.sweep) < 0 ? ccd_real_t(-1) : ccd_real_t(1);
    const ccd_real_t length = std::sqrt(dot(*direction, *direction));
    const ccd_real_t ball = length > 0 ? query.rounding / length : ccd_real_t(0);
    for (int i = 0; i < 3; ++i) {
        const ccd_real_t along = direction->v[i];
        answer->v[i] = end * query.sweep.v[i] + signed_like(query.half.v[i], along) + ball * along;
    }
    query.own_along = dot(*answer, *direction);
}

void other_support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* answer)
{
    Query& query = query_of(object);
    if (query.spent) {
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
    const ccd_real_t reach = query.own_along + dot(*answer, *direction);
    query.gap = std::max(query.gap, -reach * inverse);
}

void first_direction(const void* object, const void*, ccd_vec3_t* direction)
{
    const Query& query = query_of(object);
    *direction = query.offset;
    if (dot(*direction, *direction) < ccd_real_t(1e-12)) {
        ccdVec3Set(direction, ccd_real_t(1), ccd_real_t(0), ccd_real_t(0));
    }
}

/// What one query found.
struct Finding {
    Contact contact = Contact::contact;
    float gap = 0.0F;  ///< when clear: proven separation beyond the clearance [m]
};

/// The distance of the swept box from a point, in closed form [m].
float distance_to(const Vec3& half, const Vec3& from, const Vec3& to, const Vec3& point) noexcept
{
    return least_distance(half, {from, to - from}, {point, Vec3::Zero()}, 1.0F).distance;
}

/// Rounding error of the closed forms [m]: a dozen roundings of numbers of this size.
float closed_form_slack(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape) noexcept
{
    const float size = (shape.centre - from).cwiseAbs().sum() + (to - from).cwiseAbs().sum() + half.sum() + bounding_radius(shape);
    return 16.0F * kRounding * size;
}

bool has_closed_form(ShapeKind kind) noexcept { return kind == ShapeKind::sphere || kind == ShapeKind::capsule; }

/// Distance from the solid's centre (sphere) or axis (capsule), less its radius [m].
float closed_form_distance(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape) noexcept
{
    if (shape.kind == ShapeKind::sphere) {
        return distance_to(half, from, to, shape.centre) - shape.radius;
    }
    const Vec3 arm = shape.axes.col(2) * shape.half.z();
    return swept_distance(half, from, to, shape.centre - arm, shape.centre + arm) - shape.radius;
}

/// One run of libccd's GJK. It answers "no" both with a separating direction in hand and when it cannot go on (a flat simplex, a
/// direction that vanished); only the first is a proof, so anything else counts as contact.
Finding run_gjk(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape, float clearance, WorkBudget& budget) noexcept
{
    Query query;
    const float radius = bounding_radius(shape);
    const float size = half.sum() + 0.5F * (to - from).cwiseAbs().sum() + radius + clearance;
    query.scale = size > 0.0F ? ccd_real_t(1) / static_cast<ccd_real_t>(size) : ccd_real_t(1);
    query.core = shape;
    query.core.centre = Vec3::Zero();
    for (int i = 0; i < 3; ++i) {
        const auto a = static_cast<ccd_real_t>(from[i]);
        const auto b = static_cast<ccd_real_t>(to[i]);
        query.sweep.v[i] = (b - a) * query.scale / 2;
        query.half.v[i] = static_cast<ccd_real_t>(half[i]) * query.scale;
        query.offset.v[i] = (static_cast<ccd_real_t>(shape.centre[i]) - (a + b) / 2) * query.scale;
    }
    query.rounding = (static_cast<ccd_real_t>(clearance) + static_cast<ccd_real_t>(8.0F * kRounding * radius)) * query.scale;
    query.calls_allowed = std::min(kSupportCallsPerQuery, budget.left());

    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.first_dir = first_direction;
    ccd.support1 = own_support;
    ccd.support2 = other_support;
    ccd.max_iterations = kSupportCallsPerQuery;
    const bool intersects = ccdGJKIntersect(&query, &query, &ccd) != 0;

    const bool refused = query.spent && budget.left() < kSupportCallsPerQuery;
    // A refused call leaves the budget marked as exhausted.
    (void)budget.spend(refused ? budget.left() + 1 : query.calls);
    if (query.spent) {
        return {Contact::budget_spent, 0.0F};
    }
    if (intersects || !(query.gap > 0)) {
        return {Contact::contact, 0.0F};
    }
    return {Contact::clear, static_cast<float>(query.gap / query.scale) * (1.0F - 2.0F * kRounding)};
}

}  // namespace

Contact swept_box_contact(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape, float clearance,
                          WorkBudget& budget) noexcept
{
    assert(is_valid(shape) && half.minCoeff() >= 0.0F && clearance >= 0.0F);
    const float slack = closed_form_slack(half, from, to, shape);
    if (has_closed_form(shape.kind)) {
        if (!budget.spend()) {
            return Contact::budget_spent;
        }
        return closed_form_distance(half, from, to, shape) <= clearance + slack ? Contact::contact : Contact::clear;
    }
    if (distance_to(half, from, to, shape.centre) > bounding_radius(shape) + clearance + slack) {
        return Contact::clear;
    }
    return run_gjk(half, from, to, shape, clearance, budget).contact;
}

float swept_box_distance(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape, float reach, float resolution,
                         WorkBudget& budget) noexcept
{
    assert(is_valid(shape) && half.minCoeff() >= 0.0F && reach >= 0.0F && resolution > 0.0F);
    const float slack = closed_form_slack(half, from, to, shape);
    if (has_closed_form(shape.kind)) {
        if (!budget.spend()) {
            return 0.0F;
        }
        return std::clamp(closed_form_distance(half, from, to, shape) - slack, 0.0F, reach);
    }
    const float radius = bounding_radius(shape);
    const float to_centre = distance_to(half, from, to, shape.centre);
    float clear = std::max(to_centre - radius - slack, 0.0F);
    float contact = std::min(reach, to_centre + radius + slack);
    // Each round halves the interval at least; the budget of rounds is that of a bisection over floats.
    for (int round = 0; round < kDistanceRounds && contact - clear > resolution; ++round) {
        const float middle = clear + 0.5F * (contact - clear);
        const Finding finding = run_gjk(half, from, to, shape, middle, budget);
        if (budget.exhausted()) {
            return 0.0F;
        }
        if (finding.contact == Contact::clear) {
            clear = middle + finding.gap;
        } else {
            contact = middle;
        }
    }
    return std::min(clear, reach);
}

}  // namespace jink::geometry
