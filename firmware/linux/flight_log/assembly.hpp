// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>

#include "core/geometry/mesh_map.hpp"
#include "firmware/app/can_bus.hpp"
#include "firmware/app/cloud_input.hpp"
#include "firmware/app/coprocessor.hpp"
#include "firmware/app/plan_memory.hpp"
#include "firmware/app/reach_picture.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/linux/flight_log/setup.hpp"

namespace jink::flightlog {

/// The ports of an assembly; they outlive it.
struct AssemblyPorts {
    hal::SerialPort* line = nullptr;   ///< MAVLink's; nullptr: through the bus
    hal::CanPort* can = nullptr;       ///< nullptr: no bus
    hal::SerialPort* cloud = nullptr;  ///< nullptr: no cloud line
};

/// The co-processor as jinkd sets it up, with its link, bus and clouds. jinkd flies it, and a replay of a log runs it
/// again over recorded ports.
class Assembly {
public:
    /// @param initial  parameters with the values Setup::initial
    /// @param signing  as Setup says, with the key; outlives this
    /// @param map      nullptr: none; outlives this
    Assembly(const Setup& setup, const app::Parameters& initial, const AssemblyPorts& ports, hal::Watchdog& watchdog,
             link::mavlink::Signing& signing, const geometry::MeshMap* map);

    /// Setup::clock leaves time for a plan. Otherwise the assembly is not to be used.
    [[nodiscard]] bool has_time_for_plans() const noexcept { return has_time_; }
    [[nodiscard]] bool are_reach_sets_damaged() const noexcept { return reach_damaged_; }

    [[nodiscard]] app::Coprocessor& coprocessor() noexcept { return *coprocessor_; }
    [[nodiscard]] link::mavlink::Endpoint& endpoint() noexcept { return endpoint_; }
    [[nodiscard]] app::CanBus* bus() noexcept { return bus_ ? &*bus_ : nullptr; }
    [[nodiscard]] app::CloudInput& clouds() noexcept { return *clouds_; }

private:
    std::optional<app::CanBus> bus_;
    std::unique_ptr<app::CloudInput> clouds_;
    link::mavlink::Endpoint endpoint_;
    std::unique_ptr<app::PlanMemory> plans_;
    std::unique_ptr<app::ReachPicture> picture_;
    std::unique_ptr<app::Coprocessor> coprocessor_;
    bool has_time_ = true;
    bool reach_damaged_ = false;
};

/// Checksum of the reach sets that this program flies.
[[nodiscard]] std::uint32_t reach_sets_checksum() noexcept;

}  // namespace jink::flightlog
