// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/param_file.hpp"

#include <algorithm>
#include <numeric>

#include "firmware/linux/vehicle_file.hpp"

namespace jink::files {
namespace {

constexpr std::string_view kBlanks = " \t\r";

/// Errors named of one file; a file of another kind has one in each line.
constexpr std::size_t kMaxErrors = 20;

std::string_view trimmed(std::string_view text)
{
    const std::size_t first = text.find_first_not_of(kBlanks);
    return first == std::string_view::npos ? text.substr(0, 0)
                                           : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

struct Line {
    std::string_view name;
    std::string_view value;
    bool of_other_component = false;
};

/// A whole number from 0 to 255, as ids and types are.
std::optional<unsigned> small_number(std::string_view text)
{
    float value = 0.0F;
    const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
    return digits && parse_number(text, value) == NumberStatus::ok && value <= 255.0F
               ? std::optional(static_cast<unsigned>(value))
               : std::nullopt;
}

/// A line of QGroundControl's format: five columns, of which the first two and the last are ids and the type.
std::optional<Line> split_columns(std::string_view line)
{
    std::vector<std::string_view> columns;
    while (!line.empty() && columns.size() < 6) {
        const std::size_t end = std::min(line.find_first_of(kBlanks), line.size());
        columns.push_back(line.substr(0, end));
        line = trimmed(line.substr(end));
    }
    if (columns.size() != 5 || !small_number(columns[0]) || !small_number(columns[1]) || !small_number(columns[4])) {
        return std::nullopt;
    }
    return Line{columns[2], columns[3], small_number(columns[1]) != kComponentId};
}

/// Any other line: split at the first comma, or else at the first blank.
Line split(std::string_view line)
{
    if (const std::optional<Line> columns = split_columns(line)) {
        return *columns;
    }
    const std::size_t comma = line.find(',');
    const std::size_t at = comma != std::string_view::npos ? comma : line.find_first_of(kBlanks);
    return at == std::string_view::npos ? Line{line, {}}
                                        : Line{trimmed(line.substr(0, at)), trimmed(line.substr(at + 1))};
}

std::vector<std::string_view> names()
{
    std::vector<std::string_view> out;
    for (const app::ParamInfo& info : app::param_table()) {
        out.push_back(info.name);
    }
    return out;
}

struct Fault {
    const char* at;  ///< in the line
    std::string text;
};

/// Sets the value of one line. @return the line's error, or nothing
std::optional<Fault> take(const Line& line, std::size_t number, ParamValues& values,
                          std::array<std::size_t, app::kParamCount>& seen)
{
    const std::vector<std::string_view> known = names();
    const auto at = std::find(known.begin(), known.end(), line.name);
    if (at == known.end()) {
        return Fault{line.name.data(), "unknown parameter " + in_quotes(line.name) + suggestion(line.name, known)};
    }
    const auto index = static_cast<std::size_t>(at - known.begin());
    if (line.value.empty()) {
        return Fault{line.name.data() + line.name.size(), std::string(line.name) + " has no value"};
    }
    if (seen[index] != 0) {
        return Fault{line.name.data(),
                     std::string(line.name) + " was given in line " + std::to_string(seen[index]) + " already"};
    }
    seen[index] = number;
    const app::ParamInfo& info = app::param_table()[index];
    if (const auto wrong = judge_number(line.value, {info.low, info.high}, info.integer, values[index])) {
        return Fault{line.value.data(), std::string(line.name) + ": " + *wrong + " (" + std::string(info.text) + ")"};
    }
    return std::nullopt;
}

float value_of(const ParamValues& values, app::Param p) { return values[static_cast<std::size_t>(p)]; }

/// Known reasons why a set of values is inconsistent, with the names of the parameters concerned.
std::vector<std::string> misfits(const ParamValues& values)
{
    using app::Param;
    std::vector<std::string> out;
    const auto bounds = static_cast<unsigned>(value_of(values, Param::bounds));
    if ((bounds & 3U) == 3U &&
        value_of(values, Param::ceiling) - value_of(values, Param::floor) < 4.0F * value_of(values, Param::half_z)) {
        out.emplace_back("JNK_CEILING must lie at least 4 JNK_HALF_Z above JNK_FLOOR");
    }
    if (value_of(values, Param::time_high) * cost::kTimeHeadroom <= value_of(values, Param::time_low)) {
        out.emplace_back("GEO_T_HIGH * 1.15 must be greater than GEO_T_LOW");
    }
    const float smoothness = value_of(values, Param::weight_smoothness);
    const float time = value_of(values, Param::weight_time);
    const float passing = value_of(values, Param::weight_passing);
    const float beyond = value_of(values, Param::weight_beyond);
    if (!cost::is_valid(
            cost::Weights{smoothness, time, 1.0F - smoothness - time - passing - beyond, passing, beyond})) {
        out.emplace_back("GEO_K_S, GEO_K_T, GEO_K_A and GEO_K_B leave closeness a weight outside 0 to 0.7: "
                         "their sum must be 0.3 to 1");
    }
    if (static_cast<unsigned>(value_of(values, Param::offsets)) % 2U != 0) {
        out.emplace_back("GEO_OFFSETS must be even");
    }
    const float families = (static_cast<unsigned>(value_of(values, Param::families)) == 3U) ? 2.0F : 1.0F;
    if (families * value_of(values, Param::offsets) * (value_of(values, Param::planes) + 1.0F) >
        static_cast<float>(kMaxCandidates)) {
        out.emplace_back("GEO_OFFSETS * (GEO_PLANES + 1) candidates per family are more than " +
                         std::to_string(kMaxCandidates));
    }
    if (!app::is_built(static_cast<unsigned>(value_of(values, Param::methods)))) {
        out.emplace_back("JNK_METHODS names a method that this program is built without");
    }
    return out;
}

}  // namespace

std::optional<ParamValues> apply_param_text(std::string_view text, const std::string& file, const ParamValues& values,
                                            Complaints& complaints)
{
    const std::size_t before = complaints.size();
    ParamValues changed = values;
    std::array<std::size_t, app::kParamCount> seen{};
    bool others = false;
    bool own = false;
    if (text.starts_with("\xEF\xBB\xBF")) {
        text.remove_prefix(3);
    }
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::size_t end = text.find('\n');
        std::string_view line = text.substr(0, end);
        text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
        if (const std::size_t zero = line.find('\0'); zero != std::string_view::npos) {
            complaints.push_back({number, zero + 1, "a zero byte: the file has to be text", file});
            break;
        }
        const char* const begin = line.data();
        line = trimmed(line.substr(0, line.find('#')));
        if (line.empty()) {
            continue;
        }
        const Line parts = split(line);
        (parts.of_other_component ? others : own) = true;
        if (const auto wrong = parts.of_other_component ? std::nullopt : take(parts, number, changed, seen)) {
            complaints.push_back({number, static_cast<std::size_t>(wrong->at - begin) + 1, wrong->text, file});
        }
        if (complaints.size() == before + kMaxErrors && !text.empty()) {
            complaints.push_back({number + 1, 0, "too many errors: nothing is read from this line on", file});
            break;
        }
    }
    if (others && !own) {
        complaints.push_back({0, 0, "has parameters of other components alone; jink is component 196", file});
    }
    return complaints.size() == before ? std::optional<ParamValues>(changed) : std::nullopt;
}

std::optional<ParamValues> apply_param_file(const std::filesystem::path& path, const ParamValues& values,
                                            Complaints& complaints)
{
    const std::optional<std::string> text = read_text_file(path, complaints);
    return text ? apply_param_text(*text, path.string(), values, complaints) : std::nullopt;
}

bool apply_together(const ParamValues& values, const std::string& file, app::Parameters& parameters,
                    Complaints& complaints)
{
    if (parameters.set_all(values) == app::ParamStatus::ok) {
        return true;
    }
    std::vector<std::string> reasons = misfits(values);
    if (reasons.empty()) {
        reasons.emplace_back("values do not fit together");
    }
    for (std::string& reason : reasons) {
        complaints.push_back({0, 0, std::move(reason), file});
    }
    return false;
}

std::optional<app::Parameters> load_parameters(const std::filesystem::path& vehicle,
                                               const std::filesystem::path& params, Complaints& complaints)
{
    const std::size_t before = complaints.size();
    app::Parameters parameters;
    ParamValues values = parameters.values();
    std::string file;
    if (!vehicle.empty()) {
        values = apply_vehicle_file(vehicle, values, complaints).value_or(values);
        file = vehicle.string();
    }
    if (!params.empty()) {
        values = apply_param_file(params, values, complaints).value_or(values);
        file += (file.empty() ? "" : " with ") + params.string();
    }
    if (complaints.size() != before || !apply_together(values, file, parameters, complaints)) {
        return std::nullopt;
    }
    return parameters;
}

std::string param_file_text(const ParamValues& values)
{
    std::string out;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const app::ParamInfo& info = app::param_table()[i];
        out += "# " + std::string(info.text) + "; " + to_text(info.low) + " to " + to_text(info.high) + "\n";
        out += std::string(info.name) + "," + to_text(values[i]) + "\n";
    }
    return out;
}

std::vector<std::size_t> setting_order(const ParamValues& values)
{
    std::vector<std::size_t> waiting(values.size());
    std::iota(waiting.begin(), waiting.end(), std::size_t{0});
    std::erase(waiting, static_cast<std::size_t>(app::Param::mode));
    std::vector<std::size_t> order;
    app::Parameters parameters;
    for (bool any = true; any;) {
        any = false;
        std::vector<std::size_t> refused;
        for (const std::size_t i : waiting) {
            const bool taken = parameters.set(static_cast<app::Param>(i), values[i]) == app::ParamStatus::ok;
            (taken ? order : refused).push_back(i);
            any = any || taken;
        }
        waiting = std::move(refused);
    }
    order.insert(order.end(), waiting.begin(), waiting.end());
    order.push_back(static_cast<std::size_t>(app::Param::mode));
    return order;
}

std::string qgroundcontrol_text(const ParamValues& values, unsigned system)
{
    constexpr unsigned kReal32 = 9;  // MAV_PARAM_TYPE_REAL32, the type of every parameter on the link
    const std::string ids = std::to_string(system) + "\t" + std::to_string(kComponentId) + "\t";
    std::string out = "# Onboard parameters for Vehicle " + std::to_string(system) +
                      "\n#\n# Stack: jink\n#\n# Vehicle-Id Component-Id Name Value Type\n";
    for (const std::size_t i : setting_order(values)) {
        out += ids + std::string(app::param_table()[i].name) + "\t" + to_text(values[i]) + "\t" +
               std::to_string(kReal32) + "\n";
    }
    return out;
}

}  // namespace jink::files
