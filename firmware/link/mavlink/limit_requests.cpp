// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/limit_requests.hpp"

#include <algorithm>
#include <span>

namespace jink::link::mavlink {
namespace {

enum class Quantity : std::uint8_t { acceleration, vertical_acceleration, jerk, climb, descent };

struct Named {
    std::string_view name;
    Quantity quantity;
    float per_unit;  ///< of the parameter's units in one SI unit
};
constexpr std::array<Named, 7> kOfArduCopter{{
    {"WPNAV_ACCEL", Quantity::acceleration, 100.0F},
    {"WPNAV_ACCEL_Z", Quantity::vertical_acceleration, 100.0F},
    {"PSC_JERK_XY", Quantity::jerk, 1.0F},
    {"WP_ACC", Quantity::acceleration, 1.0F},
    {"WP_ACC_Z", Quantity::vertical_acceleration, 1.0F},
    {"PSC_JERK_NE", Quantity::jerk, 1.0F},
    {"PSC_NE_JERK", Quantity::jerk, 1.0F},
}};
constexpr std::array<Named, 2> kOfPx4{{
    {"MPC_Z_VEL_MAX_UP", Quantity::climb, 1.0F},
    {"MPC_Z_VEL_MAX_DN", Quantity::descent, 1.0F},
}};

std::span<const Named> names_of(AutopilotStack stack) noexcept
{
    switch (stack) {
    case AutopilotStack::ardupilot: return kOfArduCopter;
    case AutopilotStack::px4: return kOfPx4;
    case AutopilotStack::unknown: break;
    }
    return {};
}

constexpr std::size_t index_of(Quantity quantity) noexcept { return static_cast<std::size_t>(quantity); }

/// Any of the quantities, in SI units.
constexpr float kMin = 0.2F;
constexpr float kMax = 100.0F;

}  // namespace

std::optional<std::string_view> LimitRequests::next(AutopilotStack stack, TimePoint now) noexcept
{
    const std::span<const Named> names = names_of(stack);
    const Seconds wait = rounds_ < kRounds ? kPeriod : kRest;
    if (begun_ && now - asked_ < wait) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (name_ >= names.size()) {
            name_ = 0;
            rounds_ = std::min(rounds_ + 1, kRounds);
        }
        const Named& named = names[name_++];
        if (!is_new_[index_of(named.quantity)]) {
            begun_ = true;
            asked_ = now;
            return named.name;
        }
    }
    return std::nullopt;
}

LimitRequests::Outcome LimitRequests::heard(AutopilotStack stack, std::string_view name, float value) noexcept
{
    for (const Named& named : names_of(stack)) {
        if (named.name != name) {
            continue;
        }
        const float si = value / named.per_unit;
        if (!(si >= kMin && si <= kMax)) {
            return Outcome::refused;
        }
        const std::size_t i = index_of(named.quantity);
        const bool differs = reported_[i] != si;
        reported_[i] = si;
        is_new_[i] = true;
        return differs ? Outcome::changed : Outcome::unchanged;
    }
    return Outcome::not_a_limit;
}

void LimitRequests::restart() noexcept
{
    is_new_.fill(false);
    name_ = 0;
    rounds_ = 0;
    begun_ = false;
}

ReportedLimits LimitRequests::limits() const noexcept
{
    const auto of = [this](Quantity quantity) { return reported_[index_of(quantity)]; };
    const bool knows_lag = of(Quantity::acceleration) > 0.0F && of(Quantity::jerk) > 0.0F;
    const Seconds lag = knows_lag ? of(Quantity::acceleration) / of(Quantity::jerk) + kAttitudeLag : 0.0F;
    return {of(Quantity::acceleration), of(Quantity::vertical_acceleration), of(Quantity::climb), of(Quantity::descent),
            std::min(lag, kMaxLag)};
}

}  // namespace jink::link::mavlink
