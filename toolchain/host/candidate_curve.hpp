// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "core/geometric/candidate.hpp"
#include "toolchain/host/flight_page.hpp"

namespace jink::host {

/// The curve of a candidate about the line from `start` to `to`, own position at the predicted closest approach [m].
/// @return 25 points, at equal distances along the line; none where the line or the shape is not finite, or has no
/// length
[[nodiscard]] Columns3 candidate_curve(const geometric::CandidateShape& shape, const std::array<double, 3>& start,
                                       const std::array<double, 3>& to);

}  // namespace jink::host
