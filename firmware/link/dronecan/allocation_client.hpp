// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/base/random.hpp"
#include "core/base/time.hpp"
#include "firmware/link/dronecan/messages.hpp"

namespace jink::link::dronecan {

/// Gets a node id from the bus's allocator (uavcan.protocol.dynamic_node_id.Allocation, the client's side).
///
/// The unique id is sent in three anonymous messages of 6, 6 and 4 bytes, each after the allocator has repeated the
/// bytes received so far; its answer to the third gives the node id. Waits are random, so that two clients do not stay
/// in step: between requests 0.6 to 1.0 s, after a confirmation 0 to 0.4 s. Any allocation message received restarts
/// the wait. A message that does not continue our own id restarts the exchange. O(1).
class AllocationClient {
public:
    static constexpr Seconds kMinPeriod = 0.6F;
    static constexpr Seconds kSpread = 0.4F;
    static constexpr std::size_t kPart = 6;  ///< bytes of the unique id in one anonymous frame

    /// @param preferred  node id to ask for; 0: any
    AllocationClient(const UniqueId& unique_id, std::uint8_t preferred, std::uint64_t seed) noexcept
        : unique_id_(unique_id), preferred_(preferred), random_(seed)
    {
    }

    /// The next request, if due.
    [[nodiscard]] std::optional<Allocation> poll(TimePoint now) noexcept;
    /// An allocation message; source kAnonymous: another client's.
    void receive(const Allocation& message, std::uint8_t source, TimePoint now) noexcept;

    /// kAnonymous until a node id is allocated.
    [[nodiscard]] std::uint8_t node() const noexcept { return node_; }

private:
    void wait(TimePoint now, Seconds least) noexcept { due_ = now + (least + random_.uniform(0.0F, kSpread)); }

    UniqueId unique_id_;
    std::uint8_t preferred_;
    Random random_;
    std::size_t confirmed_ = 0;  ///< bytes of the unique id that the allocator has
    bool started_ = false;
    TimePoint due_;
    std::uint8_t node_ = kAnonymous;
};

}  // namespace jink::link::dronecan
