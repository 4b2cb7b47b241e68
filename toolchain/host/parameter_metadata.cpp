// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/parameter_metadata.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace jink::host {
namespace {

using nlohmann::ordered_json;

struct Prefix {
    std::string_view name;
    const char* group;     ///< heading of docs/guides/parameters.md
    const char* category;  ///< Advanced: for whoever tunes a method
};
constexpr std::array<Prefix, 8> kPrefixes{{{"JNK", "jink", "Standard"},
                                           {"TRK", "Traffic", "Standard"},
                                           {"OBS", "Range scans", "Standard"},
                                           {"OWN", "Own state and autopilot", "Standard"},
                                           {"HB", "Own state and autopilot", "Standard"},
                                           {"VEH", "Vehicle", "Standard"},
                                           {"GEO", "Geometric planner", "Advanced"},
                                           {"RCH", "Reach sets", "Advanced"}}};

/// Unit of the table, and its name in component metadata.
constexpr std::array<std::array<const char*, 2>, 7> kUnits{{{"m", "m"},
                                                            {"s", "s"},
                                                            {"m/s", "m/s"},
                                                            {"m/s2", "m/s^2"},
                                                            {"kg", "kg"},
                                                            {"m2", "m^2"},
                                                            {"% of half their travel", "%"}}};

/// A number and its meaning: a value, or an addend of a sum.
struct Choice {
    unsigned value;
    std::string_view text;
};

/// The meaning without its unit, and the unit's name in component metadata; empty if there is none.
struct Meaning {
    std::string text;
    std::string unit;
};
Meaning split_unit(std::string_view text)
{
    const std::size_t open = text.find(" [");
    const std::size_t close = text.find(']');
    if (open == std::string_view::npos || close == std::string_view::npos) {
        return {std::string(text), ""};
    }
    const std::string_view unit = text.substr(open + 2, close - open - 2);
    const auto* known = std::find_if(kUnits.begin(), kUnits.end(), [&](const auto& u) { return u[0] == unit; });
    if (known == kUnits.end()) {
        throw std::logic_error("parameter unit without a name in component metadata: " + std::string(unit));
    }
    return {std::string(text.substr(0, open)) + std::string(text.substr(close + 1)), (*known)[1]};
}

/// "1 floor, 2 ceiling; rest": the choices up to a semicolon, as long as each begins with a number.
std::vector<Choice> choices_of(std::string_view text)
{
    std::vector<Choice> out;
    text = text.substr(0, text.find(';'));
    while (!text.empty()) {
        const std::size_t end = std::min(text.find(", "), text.size());
        const std::string_view item = text.substr(0, end);
        Choice choice{};
        const auto [rest, error] = std::from_chars(item.data(), item.data() + item.size(), choice.value);
        if (error != std::errc{} || rest == item.data() + item.size() || *rest != ' ') {
            return {};
        }
        choice.text = item.substr(static_cast<std::size_t>(rest - item.data()) + 1);
        out.push_back(choice);
        text = text.substr(std::min(end + 2, text.size()));
    }
    return out;
}

constexpr std::string_view kSum = "sum of: ";

void add_choices(const app::ParamInfo& info, std::string_view text, ordered_json& out)
{
    const std::size_t sum = text.find(kSum);
    if (sum != std::string_view::npos) {
        for (const Choice& bit : choices_of(text.substr(sum + kSum.size()))) {
            out["bitmask"].push_back({{"index", std::countr_zero(bit.value)}, {"description", bit.text}});
        }
    } else if (info.low == 0.0F && info.high == 1.0F && text.starts_with("1: ")) {
        out["values"] = {{{"value", 0}, {"description", "Disabled"}}, {{"value", 1}, {"description", "Enabled"}}};
    } else {
        for (const Choice& value : choices_of(text)) {
            out["values"].push_back({{"value", value.value}, {"description", value.text}});
        }
    }
}

/// The first clause, as a title.
std::string title(std::string_view text)
{
    text = text.substr(0, text.find(", sum of: "));
    text = text.substr(0, text.find(';'));
    std::string out(text.starts_with("1: ") ? text.substr(3) : text);
    if (!out.empty() && out[0] >= 'a' && out[0] <= 'z') {
        out[0] = static_cast<char>(out[0] - 'a' + 'A');
    }
    return out;
}

/// The shortest decimal that is this float: 0.1, not 0.10000000149.
double decimal(float value) { return std::stod(files::to_text(value)); }

int decimals(float value)
{
    int n = 0;
    for (double scaled = decimal(value); n < 7 && std::abs(scaled - std::round(scaled)) > 1e-6; ++n) {
        scaled = decimal(value) * std::pow(10.0, n + 1);
    }
    return n;
}

ordered_json metadata_of(const app::ParamInfo& info, float initial)
{
    const std::string_view prefix = info.name.substr(0, info.name.find('_'));
    const auto* about =
        std::find_if(kPrefixes.begin(), kPrefixes.end(), [&](const Prefix& p) { return p.name == prefix; });
    if (about == kPrefixes.end()) {
        throw std::logic_error("parameter without a group: " + std::string(info.name));
    }
    const Meaning meaning = split_unit(info.text);
    constexpr int kMinDecimals = 2;
    const int places = info.integer ? 0 : std::max({kMinDecimals, decimals(info.low), decimals(initial)});
    ordered_json out;
    out["name"] = info.name;
    out["type"] = "Float";
    out["group"] = about->group;
    out["category"] = about->category;
    out["shortDesc"] = title(meaning.text);
    out["longDesc"] = meaning.text;
    if (!meaning.unit.empty()) {
        out["units"] = meaning.unit;
    }
    out["default"] = decimal(initial);
    out["min"] = decimal(info.low);
    out["max"] = decimal(info.high);
    out["decimalPlaces"] = places;
    out["increment"] = places == 0 ? 1.0 : std::stod("1e-" + std::to_string(places));
    out["rebootRequired"] = false;  // every change is in force at once
    out["volatile"] = false;
    add_choices(info, meaning.text, out);
    return out;
}

}  // namespace

ordered_json parameter_metadata(const files::ParamValues& defaults, int version)
{
    ordered_json out;
    out["version"] = version;
    for (std::size_t i = 0; i < app::kParamCount; ++i) {
        out["parameters"].push_back(metadata_of(app::param_table()[i], defaults[i]));
    }
    return out;
}

}  // namespace jink::host
