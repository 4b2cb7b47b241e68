// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/assembly.hpp"

#include "firmware/app/reach_sets.hpp"
#include "firmware/app/work_rate.hpp"

namespace jink::flightlog {
namespace {

link::mavlink::EndpointOptions link_options(const Setup& setup)
{
    link::mavlink::EndpointOptions options;
    options.system_id = setup.system_id;
    return options;
}

}  // namespace

Assembly::Assembly(const Setup& setup, const app::Parameters& initial, const AssemblyPorts& ports,
                   hal::Watchdog& watchdog, link::mavlink::Signing& signing, const geometry::MeshMap* map)
    : clouds_(std::make_unique<app::CloudInput>(ports.cloud)),  // single points of the link without a cloud line too
      endpoint_(link_options(setup), &signing)
{
    if (ports.can != nullptr) {
        bus_.emplace(*ports.can, setup.node);
    }
    hal::SerialPort& line = ports.line != nullptr ? *ports.line : bus_->serial();
    coprocessor_ = std::make_unique<app::Coprocessor>(endpoint_, line, watchdog, initial, bus());
    static_cast<void>(coprocessor_->restore_parameters(setup.stored));  // validated together when they were read
    if (setup.keeps_state) {
        coprocessor_->note_stored(coprocessor_->parameters().generation());
    }
    if (setup.clock != 0) {
        plans_ = std::make_unique<app::PlanMemory>();
        has_time_ = coprocessor_->plan_in_slices(plans_->plan, app::WorkRate::of_megahertz(setup.clock).work());
    }
    coprocessor_->use_clouds(*clouds_);
    if (map != nullptr) {
        coprocessor_->use_map(*map);
    }
    picture_ = std::make_unique<app::ReachPicture>(app::reach_sets());
    if (ports.cloud != nullptr) {
        coprocessor_->let_reach_sets_see(*picture_);
    }
    if (app::kHasReach && reach::check(app::reach_sets()) != reach::SetStatus::good) {
        reach_damaged_ = true;
        coprocessor_->leave_out_reach_sets();
    }
}

std::uint32_t reach_sets_checksum() noexcept { return app::reach_sets().checksum; }

}  // namespace jink::flightlog
