// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/target/can/netlink.hpp"

namespace jink::target {

/// Runs /jinkd on an active interface, and tests it as another node of the bus: identity, parameters, status, MAVLink
/// through the tunnel, interface down and up again, shutdown. False if /jinkd is missing.
bool try_daemon(Netlink& links, const char* interface);

}  // namespace jink::target
