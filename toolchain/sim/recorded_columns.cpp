// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/recorded_columns.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "firmware/linux/complaint.hpp"

namespace jink::sim {
namespace {

constexpr double kFoot = 0.3048;
constexpr double kNauticalMile = 1852.0;
constexpr double kMile = 5280.0 * kFoot;
constexpr double kHour = 3600.0;
constexpr double kKnot = kNauticalMile / kHour;
constexpr double kFootPerMinute = kFoot / 60.0;
constexpr double kRadian = 180.0 / std::numbers::pi;

/// A unit by its names in DAIDALUS (nasa/daidalus, C++/src/Units.cpp); angles in degrees.
struct Unit {
    const char* names;  ///< each with a blank before and behind
    char quantity;
    double factor;
};
constexpr Unit kUnits[] = {
    {" m meter metre ", 'l', 1.0},
    {" ft feet foot ", 'l', kFoot},
    {" km kilometer ", 'l', 1000.0},
    {" nmi NM nm nautical_mile ", 'l', kNauticalMile},
    {" mi mile ", 'l', kMile},
    {" in inch ", 'l', kFoot / 12.0},
    {" yard ", 'l', 3.0 * kFoot},
    {" mm millimeter ", 'l', 0.001},
    {" s ", 't', 1.0},
    {" ms ", 't', 0.001},
    {" min minute minutes ", 't', 60.0},
    {" h hr hour ", 't', kHour},
    {" deg degree ", 'a', 1.0},
    {" rad radian ", 'a', kRadian},
    {" m/s mps meter_per_second ", 'v', 1.0},
    {" knot kn kts ", 'v', kKnot},
    {" fpm ft/min foot/min feet/min ", 'v', kFootPerMinute},
    {" ft/s fps foot_per_second feet_per_second ", 'v', kFoot},
    {" km/h kph kilometer_per_hour kilometre_per_hour ", 'v', 1000.0 / kHour},
    {" mph ", 'v', kMile / kHour},
    {" NM/s nmi/s nautical_mile_per_second ", 'v', kNauticalMile},
};

/// Without its brackets.
std::string bare(std::string word)
{
    if (word.size() >= 2 &&
        ((word.front() == '[' && word.back() == ']') || (word.front() == '(' && word.back() == ')'))) {
        word = word.substr(1, word.size() - 2);
    }
    return word;
}

std::string lower(std::string word)
{
    std::transform(word.begin(), word.end(), word.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return word;
}

/// A decimal number that is the whole word, as large as a time since 1970 in milliseconds at most.
std::optional<double> number_of(std::string_view word)
{
    constexpr double kLargest = 1e13;
    double value = 0.0;
    const bool good = files::parse_number(word, value) == files::NumberStatus::ok && std::abs(value) <= kLargest;
    return good ? std::optional(value) : std::nullopt;
}

/// Seconds, minutes and seconds, or hours as well.
std::optional<double> clock_of(const std::string& word)
{
    std::istringstream in(word);
    double seconds = 0.0;
    for (std::string part; std::getline(in, part, ':');) {
        const std::optional<double> value = number_of(part);
        if (!value) {
            return std::nullopt;
        }
        seconds = 60.0 * seconds + *value;
    }
    return word.empty() ? std::nullopt : std::optional(seconds);
}

/// Column of the first alternative that is present.
std::optional<std::size_t> find(const std::vector<std::string>& names, std::initializer_list<const char*> alternatives)
{
    for (const char* wanted : alternatives) {
        const auto found = std::find(names.begin(), names.end(), wanted);
        if (found != names.end()) {
            return static_cast<std::size_t>(found - names.begin());
        }
    }
    return std::nullopt;
}

std::size_t need(const std::vector<std::string>& names, std::initializer_list<const char*> alternatives)
{
    const std::optional<std::size_t> found = find(names, alternatives);
    if (!found) {
        throw BadWord(names.size(), std::string("column ") + *alternatives.begin() + " is missing");
    }
    return *found;
}

}  // namespace

std::size_t column_of(const std::string& line, std::size_t word)
{
    constexpr const char* kBetween = ", \t\r\v\f";
    std::size_t begin = line.find_first_not_of(kBetween);
    for (std::size_t i = 0; i < word && begin != std::string::npos; ++i) {
        begin = line.find_first_not_of(kBetween, line.find_first_of(kBetween, begin));
    }
    return std::min(begin, line.size()) + 1;
}

std::vector<std::string> words_of(std::string line)
{
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream in(line);
    std::vector<std::string> all;
    for (std::string word; in >> word;) {
        all.push_back(word);
    }
    return all;
}

RecordedColumns::RecordedColumns(const std::vector<std::string>& names)
{
    std::transform(names.begin(), names.end(), std::back_inserter(names_), lower);
    name_ = need(names_, {"name", "aircraft", "id"});
    const std::optional<std::size_t> clock = find(names_, {"clock"});
    clock_ = clock.has_value();
    time_ = {clock ? *clock : need(names_, {"time", "tm", "st"}), 't', 1.0};
    global_ = find(names_, {"lat", "latitude"}).has_value();
    if (global_) {
        place_ = {{{need(names_, {"lat", "latitude"}), 'a', 1.0},
                   {need(names_, {"lon", "long", "longitude"}), 'a', 1.0},
                   {need(names_, {"alt", "altitude"}), 'l', kFoot}}};
    } else {
        place_ = {{{need(names_, {"sx", "x"}), 'l', kNauticalMile},
                   {need(names_, {"sy", "y"}), 'l', kNauticalMile},
                   {need(names_, {"sz", "z"}), 'l', kFoot}}};
    }
    polar_ = find(names_, {"trk", "track"}).has_value();
    velocity_ = {{{0, 'v', kKnot}, {0, 'v', kKnot}, {0, 'v', kFootPerMinute}}};
    if (polar_) {
        velocity_[0] = {need(names_, {"trk", "track"}), 'a', 1.0};
        velocity_[1].index = need(names_, {"gs", "groundspeed", "groundspd"});
        velocity_[2].index = need(names_, {"vs", "verticalspeed", "hdot"});
    } else {
        velocity_[0].index = need(names_, {"vx"});
        velocity_[1].index = need(names_, {"vy"});
        velocity_[2].index = need(names_, {"vz"});
    }
}

bool RecordedColumns::take_units(const std::vector<std::string>& words)
{
    if (time_.index < words.size() && clock_of(words[time_.index])) {
        return false;
    }
    if (words.size() != names_.size()) {
        throw BadWord(std::min(words.size(), names_.size()),
                      "expected " + std::to_string(names_.size()) + " units, not " + std::to_string(words.size()));
    }
    const auto take = [&](Column& column) {
        const std::string unit = bare(words[column.index]);
        if (unit == "-" || unit == "unspecified") {
            return;
        }
        for (const Unit& known : kUnits) {
            if (std::string(known.names).find(" " + unit + " ") != std::string::npos) {
                if (known.quantity != column.quantity) {
                    throw BadWord(column.index, "unit " + unit + " is none of column " + names_[column.index]);
                }
                column.factor = known.factor;
                return;
            }
        }
        throw BadWord(column.index, "unit " + files::in_quotes(unit) + " of column " +
                                        files::in_quotes(names_[column.index]) + " is not known");
    };
    if (!clock_) {
        take(time_);
    }
    for (std::array<Column, 3>* const columns : {&place_, &velocity_}) {
        for (Column& column : *columns) {
            take(column);
        }
    }
    return true;
}

double RecordedColumns::value(const Column& column, const std::vector<std::string>& words) const
{
    const std::optional<double> number = number_of(words[column.index]);
    if (!number) {
        throw BadWord(column.index, "column " + names_[column.index] + ": " + files::in_quotes(words[column.index]) +
                                        " is not a number from -1e13 to 1e13");
    }
    return *number * column.factor;
}

RecordedRow RecordedColumns::row(const std::vector<std::string>& words) const
{
    if (words.size() != names_.size()) {
        throw BadWord(std::min(words.size(), names_.size()),
                      "expected " + std::to_string(names_.size()) + " fields, not " + std::to_string(words.size()));
    }
    RecordedRow row;
    row.name = words[name_];
    if (clock_) {
        const std::optional<double> time = clock_of(words[time_.index]);
        if (!time) {
            throw BadWord(time_.index, "column clock: " + files::in_quotes(words[time_.index]) + " is not a time");
        }
        row.time = *time;
    } else {
        row.time = value(time_, words);
    }
    for (int i = 0; i < 3; ++i) {
        row.place[i] = value(place_[static_cast<std::size_t>(i)], words);
        row.velocity[i] = value(velocity_[static_cast<std::size_t>(i)], words);
    }
    if (global_ && std::abs(row.place.x()) > 90.0) {
        throw BadWord(place_[0].index, "a latitude of " + std::to_string(row.place.x()) + " deg");
    }
    if (polar_) {
        const double track = row.velocity.x() / kRadian;
        const double speed = row.velocity.y();
        row.velocity.head<2>() = Eigen::Vector2d(speed * std::sin(track), speed * std::cos(track));
    }
    return row;
}

}  // namespace jink::sim
