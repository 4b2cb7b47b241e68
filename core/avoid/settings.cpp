// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/settings.hpp"

namespace jink::avoid {

bool is_valid(const Settings& s) noexcept
{
    const auto within = [](float value, float low, float high) { return value >= low && value <= high; };
    return within(s.commit, 0.5F, 60.0F) && within(s.prediction_step, 0.02F, 0.5F) &&
           within(s.fallback_horizon, 1.0F, 20.0F) && within(s.reserve, 0.0F, 5.0F) && within(s.settle, 0.0F, 10.0F) &&
           within(s.clear_extra, 0.0F, 10.0F) && within(s.on_leg, 0.05F, 50.0F) &&
           within(s.blocked_patience, 0.0F, 600.0F) && within(s.back_off_speed, 0.0F, 5.0F) &&
           within(s.back_off_limit, 0.0F, 600.0F) && within(s.least_control, 0.0F, 60.0F) &&
           within(s.patience, 0.0F, 600.0F) && s.plan_budget >= 100 && s.kept_for_next <= s.plan_budget &&
           s.kept_for_reactive <= s.plan_budget && is_valid(s.work);
}

}  // namespace jink::avoid
