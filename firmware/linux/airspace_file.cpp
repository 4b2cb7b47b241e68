// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/airspace_file.hpp"

#include <algorithm>
#include <cmath>

#include "core/reach/cylinder.hpp"
#include "firmware/link/mavlink/geodesy.hpp"
#include "firmware/linux/yaml_map.hpp"

namespace jink::files {
namespace {

using link::GlobalPosition;
constexpr Range kLocal{-1e5F, 1e5F};      // [m]
constexpr Range kHeight{-1000.0F, 5e4F};  // [m]
constexpr Range kRadius{0.1F, 1e5F};      // [m]
constexpr Range kMargin{0.0F, 1e5F};      // [m]
constexpr Range kSpeed{-200.0F, 200.0F};  // [m/s]
constexpr Range kLatitude{-85.0F, 85.0F};
constexpr Range kLongitude{-180.0F, 180.0F};
constexpr Range kUnix{0.0F, 1e11F};  // [s]
constexpr double kMicro = 1e6;
/// Tolerance of a circle for the map projection and rounding.
constexpr float kCircleSlack = 1e-4F;
/// A clock error below this is accepted [s].
constexpr double kClockSlack = 0.25;

struct Reader {
    std::string file;
    BothClocks now;
    bool is_global = false;
    Complaints& complaints;
};

/// A place in the file: [east, north] in metres, or [latitude, longitude] in degrees.
struct Place {
    double first = 0.0;
    double second = 0.0;

    [[nodiscard]] world::Vec2 local() const { return {static_cast<float>(first), static_cast<float>(second)}; }
    [[nodiscard]] GlobalPosition global() const
    {
        return {static_cast<std::int32_t>(std::llround(first * 1e7)),
                static_cast<std::int32_t>(std::llround(second * 1e7)), 0};
    }
};

std::optional<Place> read_place(const Reader& reader, const YAML::Node& node, const std::string& where)
{
    if (!node.IsSequence() || node.size() != 2) {
        reader.complaints.push_back(
            complaint_at(node.Mark(), reader.file, where + ": a list of two numbers is wanted"));
        return std::nullopt;
    }
    if (!node.Tag().empty() && node.Tag() != "?" && node.Tag() != "!") {
        reader.complaints.push_back(
            complaint_at(node.Mark(), reader.file, where + ": no tag is wanted, such as " + in_quotes(node.Tag())));
        return std::nullopt;
    }
    const Range first = reader.is_global ? kLatitude : kLocal;
    const Range second = reader.is_global ? kLongitude : kLocal;
    const bool good = element(node[0], first, where + "[0]", reader.file, reader.complaints).has_value() &&
                      element(node[1], second, where + "[1]", reader.file, reader.complaints).has_value();
    return good ? std::optional<Place>({node[0].as<double>(), node[1].as<double>()}) : std::nullopt;
}

std::optional<std::vector<Place>> read_polygon(const Reader& reader, YamlMap& map)
{
    const auto nodes = map.list("polygon");
    if (!nodes) {
        return std::nullopt;
    }
    if (nodes->size() < 3 || nodes->size() > reach::kMaxCorners) {
        map.complain("polygon", "3 to " + std::to_string(reach::kMaxCorners) + " corners are wanted, not " +
                                    std::to_string(nodes->size()));
        return std::nullopt;
    }
    std::vector<Place> places;
    for (std::size_t i = 0; i < nodes->size(); ++i) {
        const auto place = read_place(reader, (*nodes)[i], map.name("polygon") + "[" + std::to_string(i) + "]");
        if (place) {
            places.push_back(*place);
        }
    }
    return places.size() == nodes->size() ? std::optional(places) : std::nullopt;
}

/// The smallest circle about all corners; on the globe about a centre of its own, in whose local map all distances are
/// computed.
bool enclose(const Reader& reader, const std::vector<Place>& corners, app::Constraint& out)
{
    std::vector<world::Vec2> points;
    for (const Place& corner : corners) {
        const Vec3 on_map =
            reader.is_global ? link::mavlink::to_local(corner.global(), corners[0].global()) : Vec3(Vec3::Zero());
        points.push_back(reader.is_global ? world::Vec2(on_map.head<2>()) : corner.local());
    }
    world::Circle circle = reach::smallest_circle(points);
    if (reader.is_global) {
        const auto centre = link::mavlink::to_global({circle.centre.x(), circle.centre.y(), 0.0F}, corners[0].global());
        if (!centre) {
            return false;
        }
        out.about = centre;
        out.about->alt = 0;  // heights are above mean sea level
        circle = {};
        for (const Place& corner : corners) {
            const Vec3 off = link::mavlink::to_local(corner.global(), *out.about);
            circle.radius = std::max(circle.radius, std::hypot(off.x(), off.y()));
        }
    }
    circle.radius *= 1.0F + kCircleSlack;
    out.cylinder.circle = circle;
    return true;
}

void read_shape(const Reader& reader, YamlMap& map, app::Constraint& out)
{
    if (map.has("polygon") == map.has("centre")) {
        map.complain(map.has("polygon") ? "centre" : "polygon", "an area has either 'polygon' or 'centre'");
        return;
    }
    if (const auto corners = read_polygon(reader, map)) {
        if (!enclose(reader, *corners, out) || !(out.cylinder.circle.radius > kRadius.low) ||
            out.cylinder.circle.radius > kRadius.high) {
            map.complain("polygon", "is no area of 0.1 m to 100 km");
        }
    }
    const auto node = map.node("centre");
    if (!node) {
        return;
    }
    const auto place = read_place(reader, *node, map.name("centre"));
    out.cylinder.circle.radius = map.number("radius", kRadius, kNeed).value_or(1.0F);
    if (place && reader.is_global) {
        out.about = place->global();
    } else if (place) {
        out.cylinder.circle.centre = place->local();
    }
}

/// Converts a key in seconds since 1970 to the own clock.
std::optional<TimePoint> read_time(const Reader& reader, YamlMap& map, std::string_view key, YamlMap::Need need)
{
    if (!map.number(key, kUnix, need)) {
        return std::nullopt;
    }
    const double from_now = map.node(key)->as<double>() - reader.now.unix_seconds;
    return TimePoint{reader.now.own.us + static_cast<std::int64_t>(std::llround(from_now * kMicro))};
}

void read_motion(const Reader& reader, YamlMap& map, app::Constraint& out)
{
    out.stamp = reader.now.own;
    if (const auto node = map.node("velocity")) {
        Reader metres{reader.file, reader.now, false, reader.complaints};
        if (const auto velocity = read_place(metres, *node, map.name("velocity"))) {
            out.cylinder.velocity = velocity->local();
            if (!(out.cylinder.velocity.cwiseAbs().maxCoeff() <= kSpeed.high)) {
                map.complain("velocity", "is more than " + to_text(kSpeed.high) + " m/s");
            }
        }
    }
    // A moving area's position is useless without its time: least of all after a restart.
    const bool moves = out.cylinder.velocity != world::Vec2::Zero();
    if (const auto known = read_time(reader, map, "known_at", moves ? kNeed : YamlMap::Need::optional)) {
        out.stamp = *known;
        if (known->us > reader.now.own.us + static_cast<std::int64_t>(kClockSlack * kMicro)) {
            map.complain("known_at", "lies in the future");
        }
    }
    if (const auto ends = read_time(reader, map, "until", YamlMap::Need::optional)) {
        out.ends = *ends;
    }
}

void read_area(const Reader& reader, const YAML::Node& node, std::size_t index, std::vector<app::Constraint>& out)
{
    YamlMap map(node, "areas[" + std::to_string(index) + "]", reader.file, reader.complaints);
    if (!map.is_map()) {
        return;
    }
    app::Constraint area;
    static_cast<void>(map.text("name"));
    read_shape(reader, map, area);
    area.cylinder.bottom = map.number("bottom", kHeight, kNeed).value_or(0.0F);
    area.cylinder.top = map.number("top", kHeight, kNeed).value_or(area.cylinder.bottom);
    if (area.cylinder.top < area.cylinder.bottom) {
        map.complain("top", "lies below the bottom");
    }
    area.cylinder.margin = map.number("margin", kMargin).value_or(0.0F);
    read_motion(reader, map, area);
    map.finish();
    out.push_back(area);
}

std::optional<std::vector<app::Constraint>> read_airspace(const YAML::Node& root, const std::string& file,
                                                          const BothClocks& now, Complaints& complaints)
{
    const std::size_t before = complaints.size();
    YamlMap map(root, "", file, complaints);
    std::vector<app::Constraint> out;
    if (map.is_map()) {
        const Reader reader{file, now, map.choice("frame", {"local", "global"}, kNeed).value_or(0) == 1, complaints};
        const auto areas = map.list("areas", kNeed);
        for (std::size_t i = 0; areas && i < areas->size(); ++i) {
            read_area(reader, (*areas)[i], i, out);
        }
        map.finish();
    }
    return complaints.size() == before ? std::optional(out) : std::nullopt;
}

}  // namespace

std::optional<std::vector<app::Constraint>> parse_airspace(const std::string& text, const std::string& file,
                                                           const BothClocks& now, Complaints& complaints)
{
    const std::optional<YAML::Node> root = parse_yaml(text, file, complaints);
    return root ? read_airspace(*root, file, now, complaints) : std::nullopt;
}

std::optional<std::vector<app::Constraint>> read_airspace_file(const std::filesystem::path& path, const BothClocks& now,
                                                               Complaints& complaints)
{
    const std::optional<YAML::Node> root = load_yaml(path, complaints);
    return root ? read_airspace(*root, path.string(), now, complaints) : std::nullopt;
}

std::string areas_text(const std::string& file, const std::vector<app::Constraint>& areas, TimePoint now)
{
    const auto expired =
        std::count_if(areas.begin(), areas.end(), [&](const app::Constraint& area) { return now > area.ends; });
    const auto closed = static_cast<std::ptrdiff_t>(areas.size()) - expired;
    std::string text = file + ": " + std::to_string(closed) + (closed == 1 ? " area is closed" : " areas are closed");
    if (expired > 0) {
        text += ", " + std::to_string(expired) + (expired == 1 ? " has expired" : " have expired");
    }
    return text;
}

}  // namespace jink::files
