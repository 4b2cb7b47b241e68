// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "toolchain/sim/daemon.hpp"

namespace jink::sim {

/// One flight against an image on an emulated board, paced by the board's own clock (board_line.hpp).
/// Record::latest_step is the largest lead of the board's clock over the flight, caused by delays of the host.
[[nodiscard]] Record fly_board_once(const Scenario& scenario, const Computer& computer,
                                    const std::filesystem::path& folder);

}  // namespace jink::sim
