// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "firmware/link/dronecan/node.hpp"
#include "firmware/link/mavlink/signing.hpp"
#include "firmware/linux/flight_log/ulog.hpp"
#include "firmware/linux/param_file.hpp"

namespace jink::ulog {
class Reader;
}

namespace jink::flightlog {

/// Everything that decides what the co-processor of jinkd does, beside what its ports bring. A log holds it, so that
/// the same co-processor can be set up again.
struct Setup {
    std::uint8_t system_id = 0;  ///< --system-id
    unsigned clock = 0;          ///< --clock [MHz]; 0: not given
    bool on_bus = false;         ///< MAVLink comes through the bus: there is no serial line
    bool has_bus = false;
    link::dronecan::NodeOptions node;  ///< of the bus
    bool has_cloud = false;            ///< a cloud line
    bool logs_cloud = false;           ///< its bytes are in the log
    bool keeps_state = false;          ///< a state file keeps the parameters
    std::optional<std::uint32_t> map;  ///< checksum of the map in use
    std::uint32_t reach_sets = 0;      ///< checksum of the reach sets
    bool has_key = false;              ///< frames are signed; the key is not here
    bool keys_can_be_set = false;
    std::uint64_t signing_time = 0;  ///< at the start [10 us since 2015]
    std::string unsigned_frames = "none";
    files::ParamValues initial{};  ///< of the files that people write
    files::ParamValues stored{};   ///< in force at the start
    std::uint32_t generation = 0;  ///< Parameters::generation() of `initial`
    std::string version;           ///< of the program
    std::string digest;            ///< of the sources that decide (build_digest)
};

/// SHA-256 over the sources of core, hal, link, application and flight log, the compiler and its options. Programs with
/// the same digest do the same with the same input, bit for bit.
[[nodiscard]] const char* build_digest() noexcept;
/// "0.1.0"
[[nodiscard]] const char* build_version() noexcept;

/// Information messages and parameters.
void put_infos(const Setup& setup, ulog::Messages& into);
void put_defaults(const files::ParamValues& values, ulog::Messages& into);
/// One parameter, as float or int32_t.
void put_parameter(std::size_t index, float value, ulog::Messages& into);

/// Of the definitions that were read. Nothing, with the reason, where something is missing or cannot be.
[[nodiscard]] std::optional<Setup> read_setup(const ulog::Reader& log, std::string& why_not);

}  // namespace jink::flightlog
