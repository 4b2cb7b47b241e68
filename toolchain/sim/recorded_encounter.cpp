// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/recorded_encounter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "firmware/linux/complaint.hpp"
#include "toolchain/sim/input_file.hpp"
#include "toolchain/sim/recorded_columns.hpp"

namespace jink::sim {
namespace {

/// A map about a place: metres along its meridian, and along the parallel of each fix, on the WGS84 ellipsoid.
/// Distances between nearby places are true everywhere.
class LocalMap {
public:
    LocalMap(double lat, double lon) : lat_(lat), lon_(lon) {}
    [[nodiscard]] Vec place(double lat, double lon, double alt) const
    {
        const double w = latitude_term(0.5 * (lat + lat_));
        const double north = kMajor * (1.0 - kEccentricity2) / (w * std::sqrt(w)) * kPerDegree;
        const double east = kMajor / std::sqrt(latitude_term(lat)) * std::cos(lat * kPerDegree) * kPerDegree;
        return {std::remainder(lon - lon_, 360.0) * east, (lat - lat_) * north, alt};
    }

private:
    static constexpr double kMajor = 6378137.0;
    static constexpr double kEccentricity2 = 6.69437999014e-3;
    static constexpr double kPerDegree = std::numbers::pi / 180.0;

    static double latitude_term(double lat)
    {
        const double s = std::sin(lat * kPerDegree);
        return 1.0 - kEccentricity2 * s * s;
    }
    double lat_, lon_;
};

class EncounterReader {
public:
    RecordedEncounter read(std::istream& in, const std::string& name)
    {
        std::size_t number = 0;
        for (std::string line; std::getline(in, line);) {
            ++number;
            const std::string text = line.substr(0, line.find('#'));
            try {
                take(words_of(text), line);
            } catch (const BadWord& e) {
                throw std::runtime_error(files::to_string({number, column_of(text, e.word), e.what(), name}));
            }
        }
        if (encounter_.aircraft.size() < 2) {
            throw std::runtime_error(name + ": fewer than two aircraft");
        }
        return std::move(encounter_);
    }

private:
    void take(const std::vector<std::string>& words, const std::string& line)
    {
        if (words.empty()) {
            return;
        }
        if (const std::size_t zero = line.find('\0'); zero != std::string::npos) {
            throw BadWord(words_of(line.substr(0, zero) + "x").size() - 1, "a zero byte");
        }
        if (!columns_) {
            if (line.find('=') == std::string::npos) {
                columns_.emplace(words);
            }
            return;
        }
        if (!units_known_) {
            units_known_ = true;
            if (columns_->take_units(words)) {
                return;
            }
        }
        add(columns_->row(words));
    }

    void add(const RecordedRow& row)
    {
        // As in DAIDALUS: the aircraft of the row before.
        const bool again = row.name == "\"";
        if (again && last_name_.empty()) {
            throw BadWord(0, "no aircraft is named before");
        }
        const std::string name = again ? last_name_ : row.name;
        Fix fix;
        fix.time = row.time;
        fix.velocity = row.velocity;
        fix.position = row.place;
        if (columns_->global()) {
            if (!map_) {
                map_.emplace(row.place.x(), row.place.y());
            }
            fix.position = map_->place(row.place.x(), row.place.y(), row.place.z());
        }
        std::vector<Fix>& fixes = fixes_of(name);
        last_name_ = name;
        const auto later = std::upper_bound(fixes.begin(), fixes.end(), fix.time,
                                            [](double time, const Fix& other) { return time < other.time; });
        if (later != fixes.begin() && (later - 1)->time == fix.time) {
            throw BadWord(0, "a second fix of " + last_name_ + " at " + std::to_string(fix.time) + " s");
        }
        encounter_.reordered += later != fixes.end() ? 1U : 0U;
        fixes.insert(later, fix);
    }

    std::vector<Fix>& fixes_of(const std::string& name)
    {
        for (Aircraft& aircraft : encounter_.aircraft) {
            if (aircraft.name == name) {
                return aircraft.fixes;
            }
        }
        encounter_.aircraft.push_back({name, {}});
        return encounter_.aircraft.back().fixes;
    }

    RecordedEncounter encounter_;
    std::optional<RecordedColumns> columns_;
    bool units_known_ = false;
    std::optional<LocalMap> map_;
    std::string last_name_;
};

Fix between(const Fix& before, const Fix& after, double t)
{
    const double share = (t - before.time) / (after.time - before.time);
    return {t, before.position + share * (after.position - before.position),
            before.velocity + share * (after.velocity - before.velocity)};
}

}  // namespace

Fix Aircraft::at(double t) const
{
    const auto next =
        std::upper_bound(fixes.begin(), fixes.end(), t, [](double time, const Fix& fix) { return time < fix.time; });
    if (next == fixes.begin()) {
        return fixes.front();
    }
    if (next == fixes.end()) {
        return fixes.back();
    }
    return between(*(next - 1), *next, t);
}

RecordedEncounter read_encounter(std::istream& in, const std::string& name) { return EncounterReader().read(in, name); }

RecordedEncounter read_encounter(const std::filesystem::path& file)
{
    std::ifstream in = open_input(file);
    return read_encounter(in, file.string());
}

Paired pair_by_time(const Aircraft& own, const Aircraft& other)
{
    Paired paired;
    for (const Fix& fix : own.fixes) {
        const auto next = std::lower_bound(other.fixes.begin(), other.fixes.end(), fix.time,
                                           [](const Fix& of, double time) { return of.time < time; });
        if (next != other.fixes.end() && next->time == fix.time) {
            paired.fixes.push_back({fix, *next});
        } else if (next != other.fixes.begin() && next != other.fixes.end() &&
                   next->time - (next - 1)->time <= kLongestFixGap) {
            paired.fixes.push_back({fix, between(*(next - 1), *next, fix.time)});
            ++paired.interpolated;
        } else {
            ++paired.unmatched;
        }
    }
    return paired;
}

}  // namespace jink::sim
