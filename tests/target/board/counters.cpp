// SPDX-License-Identifier: BSD-3-Clause
#include "tests/target/board/counters.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <cstring>
#include <sstream>
#include <stdexcept>

namespace jink::target {
namespace {

static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(hal::PortHealth) == 88 && offsetof(hal::PortHealth, bytes_in) == 8);
static_assert(alignof(link::LinkDiagnostics) == 4 && alignof(link::mavlink::ParserDiagnostics) == 4 &&
              alignof(app::Diagnostics) == 4);

template <class T>
T read_as(Debugger& debugger, std::uint32_t address)
{
    static_assert(std::is_trivially_copyable_v<T> && std::is_standard_layout_v<T>);
    const std::vector<std::uint8_t> bytes = debugger.read(address, sizeof(T));
    T value;
    std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
}

}  // namespace

CounterReader::Symbols CounterReader::symbols_of(const std::filesystem::path& file)
{
    Symbols symbols;
    const std::string command = "arm-none-eabi-nm -S -C '" + file.string() + "'";
    FILE* pipe = ::popen(command.c_str(), "r");
    std::array<char, 4096> line{};
    while (pipe != nullptr && std::fgets(line.data(), line.size(), pipe) != nullptr) {
        std::istringstream words(line.data());
        std::string address, size, kind, name;
        if (words >> address >> size >> kind && kind.size() == 1 && std::getline(words >> std::ws, name)) {
            symbols[name] = {static_cast<std::uint32_t>(std::stoul(address, nullptr, 16)),
                             static_cast<std::uint32_t>(std::stoul(size, nullptr, 16))};
        }
    }
    if (pipe == nullptr || ::pclose(pipe) != 0 || symbols.empty()) {
        throw std::runtime_error("no symbols of " + file.string());
    }
    return symbols;
}

/// The one symbol whose name ends in `name`; that of a guard variable names the same, behind more words.
CounterReader::Symbol CounterReader::one(const Symbols& symbols, const std::string& name)
{
    const Symbol* found = nullptr;
    for (const auto& [full, symbol] : symbols) {
        if (full.ends_with(name) && !full.starts_with("guard variable")) {
            if (found != nullptr) {
                throw std::runtime_error("more than one " + name);
            }
            found = &symbol;
        }
    }
    if (found == nullptr) {
        throw std::runtime_error("no symbol " + name);
    }
    return *found;
}

CounterReader::CounterReader(const std::filesystem::path& image, const std::filesystem::path& layout)
{
    const Symbols objects = symbols_of(image);
    const Symbols places = symbols_of(layout);
    const auto size = [&](const char* name) { return one(places, name).size; };
    const auto at = [&](const char* name) { return one(places, name).size - 1U; };
    const Symbol port = one(objects, "art()::port");
    const Symbol coprocessor = one(objects, "::coprocessor");  // of jink_main, or of run_board
    // A static of the same function, or of one of its own.
    const bool of_main =
        std::any_of(objects.begin(), objects.end(), [](const auto& s) { return s.first.ends_with("::endpoint"); });
    const Symbol endpoint = one(objects, of_main ? "::endpoint" : "endpoint()::link");
    const bool together = endpoint.size == size("jink_size_endpoint") &&
                          coprocessor.size == size("jink_size_coprocessor") &&
                          sizeof(hal::PortHealth) == size("jink_size_health") &&
                          sizeof(link::LinkDiagnostics) == size("jink_size_link") &&
                          sizeof(link::mavlink::ParserDiagnostics) == size("jink_size_parser") &&
                          sizeof(app::Diagnostics) == size("jink_size_app") && at("jink_at_line_errors") < port.size;
    if (!together) {
        throw std::runtime_error(image.string() + " and " + layout.string() + " do not belong together");
    }
    health_ = port.address + at("jink_at_health");
    overruns_ = port.address + at("jink_at_overruns");
    line_errors_ = port.address + at("jink_at_line_errors");
    link_ = endpoint.address + at("jink_at_link");
    parser_ = endpoint.address + at("jink_at_parser");
    app_ = coprocessor.address + at("jink_at_app");
}

Counters CounterReader::read(Debugger& debugger) const
{
    Counters counters{read_as<hal::PortHealth>(debugger, health_), read_as<link::LinkDiagnostics>(debugger, link_),
                      read_as<link::mavlink::ParserDiagnostics>(debugger, parser_),
                      read_as<app::Diagnostics>(debugger, app_)};
    counters.port.overruns = read_as<std::uint32_t>(debugger, overruns_);
    counters.port.line_errors = read_as<std::uint32_t>(debugger, line_errors_);
    return counters;
}

}  // namespace jink::target
