// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/param_exchange.hpp"

#include <algorithm>

namespace jink::app {

void ParamExchange::answer(std::size_t index, link::Link& link) noexcept
{
    const std::string_view text = param_table()[index].name;
    link::ParamName name{};
    std::copy(text.begin(), text.end(), name.begin());
    link.send_param(name, parameters_.values()[index], static_cast<std::uint16_t>(index),
                    static_cast<std::uint16_t>(kParamCount));
}

void ParamExchange::take(std::span<const link::ParamRequest> requests, link::Link& link, Outbox& outbox) noexcept
{
    for (const link::ParamRequest& request : requests) {
        if (request.kind == link::ParamRequestKind::list) {
            cursor_ = 0;
            continue;
        }
        const std::size_t index = request.kind == link::ParamRequestKind::read_by_index
                                      ? (request.index >= 0 ? static_cast<std::size_t>(request.index) : kParamCount)
                                      : Parameters::find({request.name.data(), request.name.size()});
        if (index >= kParamCount) {
            ++counts_.params_unknown;
            continue;
        }
        if (request.kind == link::ParamRequestKind::set) {
            const ParamStatus status = request.value_finite ? parameters_.set(static_cast<Param>(index), request.value)
                                                            : ParamStatus::not_finite;
            ++(status == ParamStatus::ok ? counts_.params_set : counts_.params_refused);
            if (status == ParamStatus::not_built) {
                outbox.say(link::Severity::warning, "jink: JNK_METHODS refused, method not built in");
            }
        }
        answer(index, link);
    }
}

void ParamExchange::continue_list(link::Link& link) noexcept
{
    constexpr std::uint16_t kPerStep = 3;
    for (std::uint16_t i = 0; cursor_ && i < kPerStep; ++i) {
        answer((*cursor_)++, link);
        if (*cursor_ >= kParamCount) {
            cursor_.reset();
        }
    }
}

void ParamExchange::believe(const link::ReportedLimits& reported, Outbox& outbox) noexcept
{
    const vehicle::VehicleLimits before = configuration().limits;
    parameters_.believe(reported);
    has_new_limits_ = true;
    const vehicle::VehicleLimits& limits = configuration().limits;
    const auto say = [&outbox, this](Param param, float was, float is) {
        if (is != was) {
            Text text;
            text << "jink: " << param_table()[static_cast<std::size_t>(param)].name << " counts as " << is
                 << (is == parameters_.get(param) ? " again" : ", the autopilot's");
            outbox.say(link::Severity::notice, text.view());
        }
    };
    say(Param::acceleration, before.max_acceleration, limits.max_acceleration);
    say(Param::vertical_acceleration, before.max_vertical_acceleration, limits.max_vertical_acceleration);
    say(Param::climb, before.max_climb, limits.max_climb);
    say(Param::descent, before.max_descent, limits.max_descent);
    say(Param::lag, before.velocity_lag, limits.velocity_lag);
}

bool ParamExchange::take_change() noexcept
{
    const bool changed = has_new_limits_ || applied_ != parameters_.generation();
    applied_ = parameters_.generation();
    has_new_limits_ = false;
    return changed;
}

}  // namespace jink::app
