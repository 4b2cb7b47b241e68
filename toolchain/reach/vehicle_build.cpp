// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/reach/vehicle_build.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <optional>

#include "toolchain/reach/best_paths.hpp"
#include "toolchain/reach/generators.hpp"

namespace jink::reach::build {
namespace {

using Make = std::function<Set(const Settings&)>;

std::string in_digits(double value)
{
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%g", value);
    return text.data();
}

void require(bool holds, const std::string& otherwise)
{
    if (!holds) {
        throw CannotBuild(otherwise);
    }
}

void check_recipe(const Recipe& recipe)
{
    require(recipe.period >= 0.05 && recipe.period <= 5.0,
            "a movement takes 0.05 to 5 s, not " + in_digits(recipe.period));
    require(!recipe.speeds.empty() && recipe.speeds.size() <= kMaxSpeedSegments,
            "there are 1 to " + std::to_string(kMaxSpeedSegments) + " speed segments");
    double before = 0.0;
    for (const double speed : recipe.speeds) {
        require(speed > before,
                "speeds ascend from above 0: " + in_digits(speed) + " comes after " + in_digits(before));
        before = speed;
    }
    require(recipe.most_speed > before && recipe.most_speed <= 3.0,
            "the greatest speed is above the last segment's lower end and at most 3 times the cruise speed, not " +
                in_digits(recipe.most_speed));
}

/// Number of steps of `step` whose climb or sink rate at `speed` stays within `rate`.
std::int8_t steps_within(double step, double speed, double rate)
{
    const double steepest = std::asin(std::min(1.0, rate / speed));
    return static_cast<std::int8_t>(std::min(100.0, std::floor(steepest / step + 1e-9)));
}

Make navigation_of(Profile profile)
{
    const BestRule rule{profile == Profile::full ? BestFor::cells : BestFor::columns};
    return [rule](const Settings& settings) { return best_paths(settings, rule); };
}

Make emergency_of(Profile profile, const Density& density)
{
    if (profile == Profile::reduced) {
        return [density](const Settings& settings) {
            return kept(grow(settings, acas(settings, kAllSeparations, density.spread)), kFromAcas);
        };
    }
    return [density](const Settings& settings) {
        Settings front_alone = settings;
        front_alone.keep_lateral = false;
        return merged(kept(grow(settings, chaotic(settings, density.spread, 3)), kFromChaotic),
                      kept(grow(front_alone, harmonic(front_alone, 1)), kFromHarmonic));
    };
}

/// The size variants of a profile, largest first. Spreads are reduced before exits at the sides: the emergency set
/// exists for side escapes, and one per cell is the minimum.
std::vector<Density> densities_of(Profile profile)
{
    std::vector<Density> densities;
    if (profile == Profile::full) {
        for (const std::size_t spread : {8U, 7U, 6U, 5U, 4U, 3U, 2U}) {
            densities.push_back({spread, 2});
            densities.push_back({spread, 1});
        }
    } else {
        for (const std::size_t spread : {9U, 8U, 7U, 6U, 5U, 4U, 3U, 2U, 1U}) {
            densities.push_back({spread, 1});
        }
    }
    return densities;
}

constexpr std::array<std::string_view, kPitchSegments> kPitchNames{"descending", "level", "climbing"};
constexpr std::array<std::int8_t, kPitchSegments> kRootPitch{1, 0, -1};

/// Navigation sets are the same in every size variant: cached by their names.
enum class Lasts : std::uint8_t { with_this_density, with_every_density };
using Known = std::map<std::string, Set>;

class Builder {
public:
    Builder(const std::string& name, const vehicle::VehicleLimits& limits, const Recipe& recipe, const Density& density,
            Known& known)
        : known_(known)
    {
        built_.vehicle = name;
        built_.limits = limits;
        built_.recipe = recipe;
        built_.density = density;
    }

    BuiltVehicle run()
    {
        const Recipe& recipe = built_.recipe;
        for (std::size_t i = 0; i < recipe.speeds.size(); ++i) {
            const double upper = i + 1 < recipe.speeds.size() ? recipe.speeds[i + 1] : recipe.most_speed;
            const double cruise = static_cast<double>(built_.limits.cruise_speed);
            Settings settings = settings_at(built_.limits, upper * cruise, recipe.period);
            built_.speeds.push_back(static_cast<float>(recipe.speeds[i]));
            const auto half = static_cast<float>(settings.step.pitch / 2.0);
            built_.pitch_separators.push_back({-half, half});
            built_.most_pitch.push_back(3.0F * half);
            for (std::size_t pitch = 0; pitch < kPitchSegments; ++pitch) {
                add_segment(settings, in_digits(recipe.speeds[i]), pitch);
            }
        }
        return std::move(built_);
    }

private:
    void add_segment(Settings settings, const std::string& speed, std::size_t pitch)
    {
        const bool mirrors = kRootPitch[pitch] < 0 && settings.most_up == settings.most_down;
        if (mirrors) {
            BuiltVehicle::Segment segment = built_.segments[built_.segments.size() - kPitchSegments + 1];
            segment.upside_down = true;
            built_.segments.push_back(segment);
            return;
        }
        settings.root_pitch = kRootPitch[pitch];
        // The smooth set of the full profile has trajectories that end at the sides; the set by columns has none.
        settings.keep_lateral = built_.recipe.profile == Profile::full;
        const std::string name = built_.vehicle + " " + speed + " " + std::string(kPitchNames[pitch]);
        BuiltVehicle::Segment segment;
        segment.navigation =
            add(name + " navigation", settings, navigation_of(built_.recipe.profile), {}, Lasts::with_every_density);
        settings.keep_lateral = true;
        settings.most_lateral = built_.density.most_lateral;
        CostRule cost;
        cost.by_smoothness = true;
        segment.emergency = add(name + " emergency", settings, emergency_of(built_.recipe.profile, built_.density),
                                cost, Lasts::with_this_density);
        built_.segments.push_back(segment);
    }

    std::size_t add(const std::string& name, const Settings& settings, const Make& make, const CostRule& cost,
                    Lasts lasts)
    {
        const auto known = known_.find(name);
        Set set = known != known_.end() ? known->second : make(settings);
        if (lasts == Lasts::with_every_density) {
            known_.try_emplace(name, set);
        }
        StoredSet stored(name, settings, set, cost);
        for (std::size_t i = 0; i < built_.sets.size(); ++i) {
            if (built_.sets[i].stored.has_tables_of(stored)) {
                return i;
            }
        }
        built_.sets.push_back({settings, make, std::move(set), std::move(stored)});
        return built_.sets.size() - 1;
    }

    Known& known_;
    BuiltVehicle built_;
};

std::size_t largest_of(const BuiltVehicle& built)
{
    std::size_t most = 0;
    for (const BuiltSet& set : built.sets) {
        most = std::max(most, set.set.members.size());
    }
    return most;
}

}  // namespace

std::size_t most_bytes_of(Profile profile) { return profile == Profile::full ? 256U * 1024U : 96U * 1024U; }
std::size_t most_nodes_of(Profile profile) { return profile == Profile::full ? 2560 : 1280; }

Settings settings_at(const vehicle::VehicleLimits& limits, double speed, double period)
{
    const auto step = [&](float acceleration) {
        return std::min(kLargestStep, kTurnShare * static_cast<double>(acceleration) * period / speed);
    };
    const auto climb = static_cast<double>(limits.max_climb);
    const auto descent = static_cast<double>(limits.max_descent);
    Settings settings;
    settings.step.yaw = step(limits.max_acceleration);
    settings.step.pitch =
        std::min(step(limits.max_vertical_acceleration), std::asin(std::min({1.0, climb / speed, descent / speed})));
    for (const double angle : {settings.step.yaw, settings.step.pitch}) {
        require(angle >= kSmallestStep, "at " + in_digits(speed) + " m/s it turns by " +
                                            in_digits(angle * 180.0 / std::numbers::pi) +
                                            " degrees a movement, less than 0.25: take a longer period");
    }
    settings.most_up = steps_within(settings.step.pitch, speed, climb);
    settings.most_down = steps_within(settings.step.pitch, speed, descent);
    const Grid<double> unit;
    settings.grid = Grid<double>(unit.layers(), unit.columns(), unit.rows(), unit.distance(), 3.0 * settings.step.yaw,
                                 2.0 * settings.step.pitch);
    return settings;
}

std::size_t BuiltVehicle::bytes() const
{
    std::size_t all = 0;
    for (const BuiltSet& set : sets) {
        all += bytes_of(set.stored.view());
    }
    return all;
}

BuiltVehicle build_vehicle(const std::string& name, const vehicle::VehicleLimits& limits, const Recipe& recipe)
{
    check_recipe(recipe);
    const std::size_t most_bytes = recipe.most_bytes != 0 ? recipe.most_bytes : most_bytes_of(recipe.profile);
    const std::size_t most_nodes = most_nodes_of(recipe.profile);
    Known known;
    std::optional<BuiltVehicle> built;
    for (const Density& density : densities_of(recipe.profile)) {
        try {
            built = Builder(name, limits, recipe, density, known).run();
        } catch (const std::length_error&) {
            continue;  // one set alone is too large
        }
        if (built->bytes() <= most_bytes && largest_of(*built) <= most_nodes) {
            return *std::move(built);
        }
    }
    require(built.has_value(), "no set fits the tables");
    throw CannotBuild("the smallest sets take " + std::to_string(built->bytes()) + " bytes and up to " +
                      std::to_string(largest_of(*built)) + " nodes each, more than " + std::to_string(most_bytes) +
                      " bytes or " + std::to_string(most_nodes) + " nodes");
}

VehicleView::VehicleView(const BuiltVehicle& built) : built_(built)
{
    for (const BuiltSet& set : built.sets) {
        views_.push_back(set.stored.view());
    }
    for (const BuiltVehicle::Segment& segment : built.segments) {
        segments_.push_back({&views_[segment.navigation], &views_[segment.emergency], segment.upside_down});
    }
}

VehicleSets VehicleView::sets() const
{
    VehicleSets sets;
    sets.vehicle = built_.vehicle;
    sets.period = static_cast<float>(built_.recipe.period);
    sets.max_acceleration = built_.limits.max_acceleration;
    sets.max_vertical_acceleration = built_.limits.max_vertical_acceleration;
    sets.max_climb = built_.limits.max_climb;
    sets.max_descent = built_.limits.max_descent;
    sets.cruise_speed = built_.limits.cruise_speed;
    sets.speeds = built_.speeds;
    sets.most_speed = static_cast<float>(built_.recipe.most_speed);
    sets.pitch_separators = built_.pitch_separators;
    sets.most_pitch = built_.most_pitch;
    sets.segments = segments_;
    sets.checksum = checksum_of(sets);
    return sets;
}

}  // namespace jink::reach::build
