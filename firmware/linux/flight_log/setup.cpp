// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/setup.hpp"

#include <array>
#include <charconv>

#include "firmware/linux/flight_log/ulog_reader.hpp"

namespace jink::flightlog {
namespace {

constexpr const char* kFormatVersion = "1";

std::string hex_of(const link::dronecan::UniqueId& id)
{
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    for (const std::uint8_t byte : id) {
        text += kDigits[byte >> 4U];
        text += kDigits[byte & 0xFU];
    }
    return text;
}

bool parse_hex(std::string_view text, link::dronecan::UniqueId& id)
{
    if (text.size() != 2 * id.size()) {
        return false;
    }
    for (std::size_t i = 0; i < id.size(); ++i) {
        const char* const from = text.data() + 2 * i;
        if (std::from_chars(from, from + 2, id[i], 16).ptr != from + 2) {
            return false;
        }
    }
    return true;
}

/// Reads the texts of information messages; the first that is missing or no number is kept as the reason.
class Texts {
public:
    Texts(const ulog::Reader& log, std::string& why_not) : log_(log), why_not_(why_not) {}

    std::string text(const char* name)
    {
        std::string found = log_.info(name);
        if (found.empty() && why_not_.empty()) {
            why_not_ = std::string("the log does not say ") + name;
        }
        return found;
    }
    template <class T>
    T number(const char* name)
    {
        const std::string found = text(name);
        T value{};
        const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), value);
        if (why_not_.empty() && (error != std::errc{} || end != found.data() + found.size())) {
            why_not_ = std::string(name) + " is \"" + found + "\"";
        }
        return value;
    }
    bool flag(const char* name) { return number<unsigned>(name) != 0; }

private:
    const ulog::Reader& log_;
    std::string& why_not_;
};

bool read_values(const std::map<std::string, ulog::Keyed>& from, files::ParamValues& into, std::string& why_not)
{
    for (std::size_t i = 0; i < into.size(); ++i) {
        const std::string name(app::param_table()[i].name);
        const auto found = from.find(name);
        const std::optional<float> value = found == from.end() ? std::nullopt : found->second.number();
        if (!value) {
            why_not = "the log has no value of " + name;
            return false;
        }
        into[i] = *value;
    }
    return true;
}

}  // namespace

const char* build_version() noexcept { return JINK_VERSION; }

void put_infos(const Setup& s, ulog::Messages& into)
{
    const auto flag = [](bool value) { return value ? "1" : "0"; };
    into.info("sys_name", "jink");
    into.info("sys_os_name", "Linux");
    into.info("ver_sw", s.version);
    into.info("jink_log_format", kFormatVersion);
    into.info("jink_build", s.digest);
    into.info("jink_system_id", std::to_string(s.system_id));
    into.info("jink_clock_mhz", std::to_string(s.clock));
    into.info("jink_mavlink_on_bus", flag(s.on_bus));
    into.info("jink_bus", flag(s.has_bus));
    if (s.has_bus) {
        into.info("jink_bus_node", std::to_string(s.node.node));
        into.info("jink_bus_preferred", std::to_string(s.node.preferred));
        into.info("jink_bus_seed", std::to_string(s.node.seed));
        into.info("jink_bus_unique_id", hex_of(s.node.unique_id));
        into.info("jink_bus_major", std::to_string(s.node.software.major));
        into.info("jink_bus_minor", std::to_string(s.node.software.minor));
    }
    into.info("jink_cloud_line", flag(s.has_cloud));
    into.info("jink_cloud_logged", flag(s.logs_cloud));
    into.info("jink_keeps_state", flag(s.keeps_state));
    into.info("jink_map", s.map ? std::to_string(*s.map) : "none");
    into.info("jink_reach_sets", std::to_string(s.reach_sets));
    into.info("jink_signed", flag(s.has_key));
    into.info("jink_keys_can_be_set", flag(s.keys_can_be_set));
    into.info("jink_signing_time", std::to_string(s.signing_time));
    into.info("jink_unsigned_frames", s.unsigned_frames);
    into.info("jink_param_generation", std::to_string(s.generation));
}

void put_parameter(std::size_t index, float value, ulog::Messages& into)
{
    const app::ParamInfo& info = app::param_table()[index];
    if (info.integer) {
        into.parameter(info.name, static_cast<std::int32_t>(value));
    } else {
        into.parameter(info.name, value);
    }
}

void put_defaults(const files::ParamValues& values, ulog::Messages& into)
{
    for (std::size_t i = 0; i < values.size(); ++i) {
        const app::ParamInfo& info = app::param_table()[i];
        if (info.integer) {
            into.parameter_default(info.name, static_cast<std::int32_t>(values[i]));
        } else {
            into.parameter_default(info.name, values[i]);
        }
    }
}

std::optional<Setup> read_setup(const ulog::Reader& log, std::string& why_not)
{
    why_not.clear();
    if (log.info("sys_name") != "jink") {
        why_not = "the log is not jink's";
        return std::nullopt;
    }
    Texts texts(log, why_not);
    if (texts.text("jink_log_format") != kFormatVersion) {
        why_not = why_not.empty() ? "the log has another format than this program reads" : why_not;
        return std::nullopt;
    }
    Setup s;
    s.version = texts.text("ver_sw");
    s.digest = texts.text("jink_build");
    s.system_id = texts.number<std::uint8_t>("jink_system_id");
    s.clock = texts.number<unsigned>("jink_clock_mhz");
    s.on_bus = texts.flag("jink_mavlink_on_bus");
    s.has_bus = texts.flag("jink_bus");
    if (s.has_bus) {
        s.node.node = texts.number<std::uint8_t>("jink_bus_node");
        s.node.preferred = texts.number<std::uint8_t>("jink_bus_preferred");
        s.node.seed = texts.number<std::uint64_t>("jink_bus_seed");
        s.node.software.major = texts.number<std::uint8_t>("jink_bus_major");
        s.node.software.minor = texts.number<std::uint8_t>("jink_bus_minor");
        if (!parse_hex(texts.text("jink_bus_unique_id"), s.node.unique_id) || s.node.node > 127) {
            why_not = why_not.empty() ? "jink_bus_unique_id or jink_bus_node is no id" : why_not;
        }
    }
    s.has_cloud = texts.flag("jink_cloud_line");
    s.logs_cloud = texts.flag("jink_cloud_logged");
    s.keeps_state = texts.flag("jink_keeps_state");
    if (log.info("jink_map") != "none") {
        s.map = texts.number<std::uint32_t>("jink_map");
    }
    s.reach_sets = texts.number<std::uint32_t>("jink_reach_sets");
    s.has_key = texts.flag("jink_signed");
    s.keys_can_be_set = texts.flag("jink_keys_can_be_set");
    s.signing_time = texts.number<std::uint64_t>("jink_signing_time");
    s.unsigned_frames = texts.text("jink_unsigned_frames");
    s.generation = texts.number<std::uint32_t>("jink_param_generation");
    if (why_not.empty() && s.on_bus && !s.has_bus) {
        why_not = "MAVLink comes through a bus that is not there";
    }
    const bool good = why_not.empty() && read_values(log.defaults(), s.initial, why_not) &&
                      read_values(log.parameters(), s.stored, why_not);
    return good ? std::optional(std::move(s)) : std::nullopt;
}

}  // namespace jink::flightlog
