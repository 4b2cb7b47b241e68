// SPDX-License-Identifier: BSD-3-Clause
#include "tests/scenario/encounter_file.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <optional>
#include <sstream>
#include <stdexcept>

namespace jink::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::vector<std::string> words(std::string line)
{
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream in(line);
    std::vector<std::string> all;
    for (std::string word; in >> word;) {
        all.push_back(word);
    }
    return all;
}

/// SI per unit.
double factor_of(const std::string& unit)
{
    static const std::map<std::string, double> kUnits{{"[deg]", 1.0},
                                                      {"deg", 1.0},
                                                      {"[ft]", 0.3048},
                                                      {"ft", 0.3048},
                                                      {"[m]", 1.0},
                                                      {"[nmi]", 1852.0},
                                                      {"[s]", 1.0},
                                                      {"s", 1.0},
                                                      {"[m/s]", 1.0},
                                                      {"[knot]", 1852.0 / 3600.0},
                                                      {"[kn]", 1852.0 / 3600.0},
                                                      {"knot", 1852.0 / 3600.0},
                                                      {"[fpm]", 0.3048 / 60.0},
                                                      {"fpm", 0.3048 / 60.0},
                                                      {"[none]", 1.0},
                                                      {"unitless", 1.0}};
    const auto found = kUnits.find(unit);
    if (found == kUnits.end()) {
        throw std::runtime_error("unit " + unit + " is not known");
    }
    return found->second;
}

/// Numbers of one row by column name, in SI but for angles.
using Row = std::map<std::string, double>;

double need(const Row& row, const std::string& column)
{
    const auto found = row.find(column);
    if (found == row.end()) {
        throw std::runtime_error("column " + column + " is missing");
    }
    return found->second;
}

/// Metres per degree on the WGS84 ellipsoid about a latitude.
class LocalPlane {
public:
    LocalPlane(double lat, double lon) : lat_(lat), lon_(lon)
    {
        constexpr double kMajor = 6378137.0;
        constexpr double kEccentricity2 = 6.69437999014e-3;
        const double s = std::sin(lat * kDegree);
        const double w = 1.0 - kEccentricity2 * s * s;
        north_ = kMajor * (1.0 - kEccentricity2) / (w * std::sqrt(w)) * kDegree;
        east_ = kMajor / std::sqrt(w) * std::cos(lat * kDegree) * kDegree;
    }
    [[nodiscard]] Eigen::Vector3d place(double lat, double lon, double alt) const
    {
        return {(lon - lon_) * east_, (lat - lat_) * north_, alt};
    }

private:
    double lat_, lon_, north_ = 0.0, east_ = 0.0;
};

Eigen::Vector3d velocity_of(const Row& row)
{
    if (row.count("trk") > 0) {
        const double track = need(row, "trk") * kDegree;
        const double speed = need(row, "gs");
        return {speed * std::sin(track), speed * std::cos(track), need(row, "vs")};
    }
    return {need(row, "vx"), need(row, "vy"), need(row, "vz")};
}

Fix fix_of(const Row& row, std::optional<LocalPlane>& plane)
{
    Fix fix;
    fix.time = need(row, "time");
    fix.velocity = velocity_of(row);
    if (row.count("lat") > 0) {
        if (!plane) {
            plane.emplace(need(row, "lat"), need(row, "lon"));
        }
        fix.position = plane->place(need(row, "lat"), need(row, "lon"), need(row, "alt"));
    } else {
        fix.position = {need(row, "sx"), need(row, "sy"), need(row, "sz")};
    }
    return fix;
}

Aircraft& aircraft_named(Encounter& encounter, const std::string& name)
{
    for (Aircraft& aircraft : encounter.aircraft) {
        if (aircraft.name == name) {
            return aircraft;
        }
    }
    encounter.aircraft.push_back({name, {}});
    return encounter.aircraft.back();
}

Row row_of(const std::vector<std::string>& columns, const std::vector<double>& factors,
           const std::vector<std::string>& fields)
{
    if (fields.size() != columns.size()) {
        throw std::runtime_error("expected " + std::to_string(columns.size()) + " fields");
    }
    Row row;
    for (std::size_t i = 1; i < fields.size(); ++i) {
        row[columns[i]] = std::stod(fields[i]) * factors[i];
    }
    return row;
}

}  // namespace

Eigen::Vector3d Aircraft::position_at(double t) const
{
    const auto next =
        std::upper_bound(fixes.begin(), fixes.end(), t, [](double at, const Fix& fix) { return at < fix.time; });
    if (next == fixes.begin()) {
        return fixes.front().position;
    }
    if (next == fixes.end()) {
        return fixes.back().position;
    }
    const Fix& before = *(next - 1);
    const double share = (t - before.time) / (next->time - before.time);
    return before.position + share * (next->position - before.position);
}

Encounter read_encounter(const std::filesystem::path& file)
{
    std::ifstream in(file);
    if (!in) {
        throw std::runtime_error(file.string() + ": cannot be read");
    }
    Encounter encounter;
    std::optional<LocalPlane> plane;
    std::vector<std::string> columns;
    std::vector<double> factors;
    int number = 0;
    for (std::string line; std::getline(in, line);) {
        ++number;
        const std::vector<std::string> fields = words(line);
        if (fields.empty() || fields[0][0] == '#') {
            continue;
        }
        try {
            if (columns.empty()) {
                columns = fields;
            } else if (factors.empty()) {
                std::transform(fields.begin(), fields.end(), std::back_inserter(factors), factor_of);
            } else {
                const Row row = row_of(columns, factors, fields);
                aircraft_named(encounter, fields[0]).fixes.push_back(fix_of(row, plane));
            }
        } catch (const std::exception& e) {
            throw std::runtime_error(file.string() + ":" + std::to_string(number) + ": " + e.what());
        }
    }
    if (encounter.aircraft.size() < 2) {
        throw std::runtime_error(file.string() + ": fewer than two aircraft");
    }
    return encounter;
}

}  // namespace jink::test
