// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>

namespace CLI {
class App;
}

namespace jink::sim {

/// The command `matrix` of jink-sim.
struct MatrixOptions {
    std::uint64_t from = 1;
    std::size_t count = 20;
    std::string behaviour;  ///< empty: all
    std::string meeting;    ///< empty: all
    std::string flyer;      ///< empty: all
    unsigned threads = 2;
    bool brief = false;  ///< a line per behaviour and autopilot
    bool texts = false;
    bool rough = false;
};

CLI::App& add_matrix(CLI::App& cli, MatrixOptions& options);

/// Prints the cells. @return 1 when a hit was avoidable, a rule was broken or the co-processor caused a text of the
/// autopilot; else 0
int run_matrix(const MatrixOptions& options, std::ostream& out);

}  // namespace jink::sim
