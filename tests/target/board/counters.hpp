// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <type_traits>

#include "firmware/app/coprocessor.hpp"
#include "firmware/link/mavlink/parser.hpp"
#include "hal/port_health.hpp"
#include "tests/target/board/debugger.hpp"

namespace jink::target {

/// The counters of a flight image, read from its memory.
struct Counters {
    hal::PortHealth port;  ///< overruns and line errors of the interrupt handlers included
    link::LinkDiagnostics link;
    link::mavlink::ParserDiagnostics parser;
    app::Diagnostics app;
};

/// Locates the counters: the image's symbols give the objects' addresses; symbols of
/// tests/target/board/counter_layout.cpp, compiled beside the image, give the counters' offsets. Counters are integers
/// of fixed width, little-endian and aligned alike on both machines; their sizes, and those of the objects around them,
/// are compared.
class CounterReader {
public:
    /// @param layout  library of counter_layout.cpp
    /// @throws std::runtime_error where a symbol is missing, or the two do not belong together
    CounterReader(const std::filesystem::path& image, const std::filesystem::path& layout);

    /// The processor must be halted.
    [[nodiscard]] Counters read(Debugger& debugger) const;

private:
    struct Symbol {
        std::uint32_t address = 0;
        std::uint32_t size = 0;
    };
    using Symbols = std::map<std::string, Symbol>;
    [[nodiscard]] static Symbols symbols_of(const std::filesystem::path& file);
    [[nodiscard]] static Symbol one(const Symbols& symbols, const std::string& name);

    std::uint32_t health_, overruns_, line_errors_, link_, parser_, app_;
};

}  // namespace jink::target
