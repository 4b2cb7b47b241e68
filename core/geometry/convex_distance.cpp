// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/geometry/convex.hpp"
#include "core/geometry/origin_search.hpp"
#include "core/geometry/swept_box.hpp"

namespace jink::geometry {

namespace {

using detail::SweptBox;

/// The difference of the swept box and a solid, relative to the middle of the swept segment, so that numbers stay as
/// small as the scene allows.
class Difference {
public:
    Difference(const SweptBox& box, const Shape& shape) noexcept
        : half_(box.half), sweep_(0.5F * (box.to - box.from)), offset_((shape.centre - box.from) - sweep_),
          solid_(shape)
    {
        solid_.centre = Vec3::Zero();
    }

    [[nodiscard]] const Vec3& offset() const noexcept { return offset_; }

    [[nodiscard]] Vec3 support(const Vec3& direction) const noexcept
    {
        const Vec3 corner(std::copysign(half_.x(), direction.x()), std::copysign(half_.y(), direction.y()),
                          std::copysign(half_.z(), direction.z()));
        const Vec3 end = direction.dot(sweep_) < 0.0F ? Vec3(-sweep_) : sweep_;
        return (corner + end) - (offset_ + geometry::support(solid_, -direction));
    }

private:
    Vec3 half_;
    Vec3 sweep_;
    Vec3 offset_;
    Shape solid_;
};

}  // namespace

float detail::proven_distance(const SweptBox& box, const Shape& shape, const SearchLimits& limits,
                              WorkBudget& budget) noexcept
{
    const Difference difference(box, shape);
    const auto support = [&](const Vec3& direction) { return difference.support(direction); };
    const std::uint32_t turn = units::kSearchTurn + units::hull_units(shape.vertices.size());
    const SearchResult found =
        search_origin(support, SearchBegin{-difference.offset()}, box.slack(shape), limits, turn, budget);
    return found.budget_spent ? 0.0F : std::min(found.proven, limits.reach);
}

float swept_box_distance(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape, float reach,
                         float resolution, WorkBudget& budget) noexcept
{
    assert(is_valid(shape) && half.minCoeff() >= 0.0F && reach >= 0.0F && resolution >= 0.0F);
    const SweptBox box{half, from, to};
    const float slack = box.slack(shape);
    if (detail::has_closed_form(shape)) {
        if (!budget.spend(detail::closed_form_units(shape))) {
            return 0.0F;
        }
        return std::clamp(box.closed_form_distance(shape) - slack, 0.0F, reach);
    }
    if (!budget.spend(units::kSolidQuery)) {
        return 0.0F;
    }
    if (box.distance_to(shape.centre) - bounding_radius(shape) - slack >= reach) {
        return reach;
    }
    return detail::proven_distance(box, shape, {0.0F, reach, resolution, kSupportCallsPerQuery}, budget);
}

}  // namespace jink::geometry
