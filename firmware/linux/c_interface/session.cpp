// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/c_interface/session.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/app/reach_sets.hpp"
#include "firmware/app/work_rate.hpp"

namespace jink::c_interface {
namespace {

static_assert(sizeof(Session) < 3U << 19U, "jink.h promises less than 1.5 MiB");

link::dronecan::NodeOptions node_of(const jink_options& options) noexcept
{
    link::dronecan::NodeOptions node;
    node.node = options.node_id;
    std::copy_n(options.unique_id, node.unique_id.size(), node.unique_id.begin());
    constexpr std::uint64_t kBasis = 14695981039346656037ULL;  // FNV-1a (Fowler, Noll, Vo)
    constexpr std::uint64_t kPrime = 1099511628211ULL;
    node.seed = kBasis;
    for (const std::uint8_t byte : options.unique_id) {
        node.seed = (node.seed ^ byte) * kPrime;
    }
    node.software.major = JINK_VERSION_MAJOR;
    node.software.minor = JINK_VERSION_MINOR;
    return node;
}

link::mavlink::EndpointOptions link_of(const jink_options& options) noexcept
{
    link::mavlink::EndpointOptions link;
    link.system_id = options.system_id;
    return link;
}

jink_result result_of(app::ParamStatus status) noexcept
{
    switch (status) {
    case app::ParamStatus::ok: return JINK_OK;
    case app::ParamStatus::unknown_name: return JINK_ERROR_NAME;
    case app::ParamStatus::not_finite:
    case app::ParamStatus::out_of_range:
    case app::ParamStatus::not_built: return JINK_ERROR_VALUE;
    case app::ParamStatus::inconsistent: break;
    }
    return JINK_ERROR_INCONSISTENT;
}

link::ParamRequest request_of(std::string_view name, float value) noexcept
{
    link::ParamRequest request;
    request.kind = link::ParamRequestKind::set;
    std::copy_n(name.begin(), std::min(name.size(), request.name.size()), request.name.begin());
    request.value = value;
    return request;
}

}  // namespace

jink_result Session::check(const jink_options& options) noexcept
{
    constexpr std::uint8_t kMaxNode = 127;
    const bool clock_fits = options.clock_mhz == 0 || (options.clock_mhz >= app::WorkRate::kMinMegahertz &&
                                                       options.clock_mhz <= app::WorkRate::kMaxMegahertz);
    const bool switches = options.has_can <= 1 && options.has_cloud <= 1 && options.mavlink_over_can <= options.has_can;
    const bool reserved = std::ranges::all_of(options.reserved, [](std::uint8_t byte) { return byte == 0; });
    return clock_fits && switches && reserved && options.node_id <= kMaxNode ? JINK_OK : JINK_ERROR_OPTION;
}

Session::Session(const jink_options& options) noexcept
    : clouds_(options.has_cloud != 0 ? &cloud_ : nullptr), endpoint_(link_of(options)), picture_(app::reach_sets()),
      over_can_(options.mavlink_over_can != 0), has_cloud_(options.has_cloud != 0)
{
    if (options.has_can != 0) {
        bus_.emplace(can_, node_of(options));
    }
    hal::SerialPort& line = over_can_ ? bus_->serial() : static_cast<hal::SerialPort&>(line_);
    coprocessor_.emplace(link_, line, watchdog_, wanted_, bus_ ? &*bus_ : nullptr);
    if (options.clock_mhz != 0) {
        has_time_ = coprocessor_->plan_in_slices(plans_.plan, app::WorkRate::of_megahertz(options.clock_mhz).work());
    }
    coprocessor_->use_clouds(clouds_);
    if (has_cloud_) {
        coprocessor_->let_reach_sets_see(picture_);
    }
    if (app::kHasReach && reach::check(app::reach_sets()) != reach::SetStatus::good) {
        reach_damaged_ = true;
        coprocessor_->leave_out_reach_sets();
    }
    wanted_ = coprocessor_->parameters();
    generation_ = wanted_.generation();
}

jink_result Session::may_step(std::int64_t now_us) const noexcept
{
    if (has_ended_) {
        return JINK_ERROR_ENDED;
    }
    const bool fits = now_us >= 0 && now_us <= JINK_LATEST_TIME && (!last_step_ || now_us > last_step_->us);
    return fits ? JINK_OK : JINK_ERROR_TIME;
}

jink_result Session::step(TimePoint now) noexcept
{
    if (const jink_result refused = may_step(now.us); refused != JINK_OK) {
        return refused;
    }
    report_ = coprocessor_->step(now);
    last_step_ = now;
    if (coprocessor_->parameters().generation() != generation_) {
        generation_ = coprocessor_->parameters().generation();
        wanted_ = coprocessor_->parameters();
        for (const link::ParamRequest& request : link_.waiting()) {
            static_cast<void>(wanted_.set({request.name.data(), request.name.size()}, request.value));
        }
    }
    return JINK_OK;
}

jink_result Session::shut_down(TimePoint now) noexcept
{
    if (const jink_result refused = may_step(now.us); refused != JINK_OK) {
        return refused;
    }
    coprocessor_->shut_down(now);
    has_ended_ = true;
    return JINK_OK;
}

jink_result Session::set_parameters(const char* const* names, const float* values, std::size_t count) noexcept
{
    app::Parameters changed = wanted_;
    app::ParamValues together = wanted_.values();
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t index = app::Parameters::find(names[i]);
        if (index == app::kParamCount) {
            return JINK_ERROR_NAME;
        }
        together[index] = values[i];
        const jink_result alone = result_of(changed.set(static_cast<app::Param>(index), values[i]));
        if (alone != JINK_OK && (last_step_ || alone != JINK_ERROR_INCONSISTENT)) {
            return alone;
        }
    }
    if (!last_step_) {
        const jink_result result = result_of(changed.set_all(together));
        if (result == JINK_OK) {
            static_cast<void>(coprocessor_->restore_parameters(together));
            wanted_ = coprocessor_->parameters();
            generation_ = wanted_.generation();
        }
        return result;
    }
    if (count > decltype(link::Inbox::params)::capacity() - link_.waiting().size()) {
        return JINK_ERROR_FULL;
    }
    for (std::size_t i = 0; i < count; ++i) {
        static_cast<void>(link_.set(request_of(names[i], values[i])));  // there is space for all of them
    }
    wanted_ = changed;
    return JINK_OK;
}

}  // namespace jink::c_interface
