// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "firmware/link/dronecan/messages.hpp"

namespace jink::host {

/// Who a DroneCAN node is, whatever its node id.
struct NodeIdentity {
    link::dronecan::UniqueId unique_id{};
    std::uint64_t seed = 1;  ///< of random waits, another on each machine
    bool lasting = false;    ///< the same at the next start
};

/// Out of the machine's own id and the interface's name, by SHA-256: a machine id is not to be shown to others
/// (machine-id(5)), and two interfaces of one machine are two nodes. Where the file is missing or empty: random.
[[nodiscard]] NodeIdentity node_identity(const std::string& machine_id_file, const std::string& interface);

}  // namespace jink::host
