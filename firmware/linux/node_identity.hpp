// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "firmware/link/dronecan/messages.hpp"

namespace jink::host {

/// Identity of a DroneCAN node, independent of its node id.
struct NodeIdentity {
    link::dronecan::UniqueId unique_id{};
    std::uint64_t seed = 1;  ///< of random waits, different on each machine
    bool lasting = false;    ///< the same at the next start
};

/// Computed from the machine's own id and the interface's name by SHA-256: a machine id must not be published
/// (machine-id(5)), and two interfaces of one machine are two nodes. Random if the file is missing or empty.
[[nodiscard]] NodeIdentity node_identity(const std::string& machine_id_file, const std::string& interface);

}  // namespace jink::host
