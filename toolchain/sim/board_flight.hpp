// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "toolchain/sim/daemon.hpp"

namespace jink::sim {

/// One flight against an image in an emulated board, by the board's own clock (board_line.hpp). Record::latest_step is
/// how far that clock once ran ahead of the flight: the machine held one of the two up.
[[nodiscard]] Record fly_board_once(const Scenario& scenario, const Computer& computer,
                                    const std::filesystem::path& folder);

}  // namespace jink::sim
