// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/constraint_upload.hpp"

#include "firmware/app/constraints.hpp"
#include "firmware/link/mavlink/geodesy.hpp"

namespace jink::app {
namespace {

/// The same area, whenever it was sent: the instant of its position varies with the line's delay.
bool is_repetition(const link::Constraint& a, const link::Constraint& b) noexcept
{
    const TimePoint never = link::Constraint{}.ends;
    const bool same_end =
        a.ends == never || b.ends == never ? a.ends == b.ends : a.ends.us - a.stamp.us == b.ends.us - b.stamp.us;
    return same_end && a.about == b.about && a.cylinder.circle.centre == b.cylinder.circle.centre &&
           a.cylinder.circle.radius == b.cylinder.circle.radius && a.cylinder.velocity == b.cylinder.velocity &&
           a.cylinder.bottom == b.cylinder.bottom && a.cylinder.top == b.cylinder.top &&
           a.cylinder.margin == b.cylinder.margin;
}

}  // namespace

bool ConstraintUpload::belongs(const link::ConstraintPart& part) const noexcept
{
    return has_set_ && part.set == number_ && part.count == count_ && part.from_system == from_system_ &&
           part.from_component == from_component_;
}

void ConstraintUpload::begin(const link::ConstraintPart& part) noexcept
{
    diagnostics_.abandoned += has_set_ && !is_complete_ ? 1U : 0U;
    has_set_ = true;
    is_complete_ = in_force_ = false;
    received_ = 0;
    number_ = part.set;
    count_ = part.count;
    from_system_ = part.from_system;
    from_component_ = part.from_component;
}

link::ConstraintResult ConstraintUpload::take(const link::ConstraintPart& part, TimePoint now) noexcept
{
    if (part.count > link::kMaxReportedConstraints) {
        ++diagnostics_.refused;
        return link::ConstraintResult::too_many;
    }
    const link::Constraint& constraint = part.constraint;
    const bool is_sound = ConstraintTable::accepts(constraint, now) &&
                          (!constraint.about || link::mavlink::is_on_earth(*constraint.about));
    if (part.count > 0 && !is_sound) {
        ++diagnostics_.refused;
        return link::ConstraintResult::out_of_range;
    }
    const bool is_other =
        is_complete_ && belongs(part) && part.count > 0 && !is_repetition(parts_[part.index], constraint);
    if (is_other || !belongs(part)) {
        begin(part);
    }
    // Merged on a board, such a set would be placed in one of the two frames.
    const bool has_others = part.count > 0 && (received_ & ~(1U << part.index)) != 0;
    if (has_others && constraint.about.has_value() != is_global_) {
        ++diagnostics_.refused;
        return link::ConstraintResult::out_of_range;
    }
    is_global_ = constraint.about.has_value();
    if (part.count > 0) {
        parts_[part.index] = constraint;
        received_ |= 1U << part.index;
    }
    const bool was_complete = is_complete_;
    is_complete_ = received_ + 1U == 1U << count_;
    in_force_ = false;
    diagnostics_.sets += is_complete_ && !was_complete ? 1U : 0U;
    return is_complete_ ? link::ConstraintResult::in_force : link::ConstraintResult::kept;
}

}  // namespace jink::app
