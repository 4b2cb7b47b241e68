// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/host/scratch.hpp"
#include "toolchain/host/problem_file.hpp"

namespace jink::test {

/// A leg of 60 m to the east, and a threat that comes along it.
inline const std::string kHead = "vehicle: default\nleg: {start: [0, 0, 20], end: [60, 0, 20], speed: 5}\n";
inline const std::string kThreat = "threats:\n  - {position: [20, 1, 20], velocity: [-3, 0, 0], radius: 1.5}\n";

/// A reference with a quarter of a turn.
inline const std::string kBend =
    "vehicle: default\nreference:\n  start: [0, 0, 20]\n  speed: 5\n  segments: [{to: [10, 0, 20]}, "
    "{centre: [10, 20, 20], turn: 90}, {to: [30, 60, 20]}]\n";

/// Complaints about a problem file with this text; none for a valid file.
inline files::Complaints complaints_of(const std::string& text)
{
    auto read = host::read_problem_text(text, "p.yaml");
    return std::holds_alternative<files::Complaints>(read) ? std::get<files::Complaints>(read) : files::Complaints{};
}

}  // namespace jink::test
