// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/target/can/netlink.hpp"

namespace jink::target {

/// Runs /jinkd on an interface that is up, and speaks to it as another node of the bus: who it is, its parameters, its
/// status, MAVLink through the tunnel, the interface down and up again, its end. False where there is no /jinkd.
bool try_daemon(Netlink& links, const char* interface);

}  // namespace jink::target
