// SPDX-License-Identifier: BSD-3-Clause
#include "tests/replay/recording.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <numbers>
#include <sstream>

namespace jink::replay_test {
namespace {

namespace fs = std::filesystem;

constexpr std::uint8_t kMavlink2 = 0xFD;
constexpr std::size_t kHead = 10;
constexpr std::size_t kChecksum = 2;

std::uint8_t at(const std::vector<std::byte>& bytes, std::size_t i) { return std::to_integer<std::uint8_t>(bytes[i]); }

fs::path folder()
{
    const char* const given = std::getenv("JINK_RECORDINGS");
    return given != nullptr ? fs::path(given) : fs::path(JINK_RECORDINGS_DEFAULT);
}

/// PX4's ground station calls AUTO's sub modes AUTO.LOITER and so on; its documentation and we call them HOLD ...
std::string plain_name(const std::string& name)
{
    if (name.rfind("AUTO.", 0) != 0) {
        return name;
    }
    return name == "AUTO.LOITER" ? "HOLD" : name.substr(5);
}

void read_truth(const std::string& text, double time, const std::array<std::int32_t, 3>& origin, Recording& out)
{
    TruePoint point;
    point.time = time;
    double a[6] = {};
    if (std::sscanf(text.c_str(), "enu=%lf,%lf,%lf v=%lf,%lf,%lf", a, a + 1, a + 2, a + 3, a + 4, a + 5) == 6) {
        point.position = Vec(a[0], a[1], a[2]);
        point.velocity = Vec(a[3], a[4], a[5]);
    } else if (std::sscanf(text.c_str(), "lat=%lf lon=%lf alt=%lf v=%lf,%lf,%lf", a, a + 1, a + 2, a + 3, a + 4,
                           a + 5) == 6) {
        point.position = local_of({a[0], a[1], a[2]}, origin);
        point.velocity = Vec(a[4], a[3], -a[5]);
    } else {
        return;
    }
    out.truth.push_back(point);
}

void read_event(const std::string& line, const std::array<std::int32_t, 3>& origin, Recording& out)
{
    std::istringstream in(line);
    double time = 0.0;
    std::string kind;
    std::string rest;
    if (!(in >> time >> kind) || !std::getline(in >> std::ws, rest)) {
        return;
    }
    if (kind == "truth") {
        read_truth(rest, time, origin, out);
    } else if (kind == "mode") {
        char name[64] = {};
        char armed[64] = {};
        const bool px4 = std::sscanf(rest.c_str(), "mode=%63s armed=%63s", name, armed) == 2;
        if (px4 || std::sscanf(rest.c_str(), "%63s %63s", name, armed) == 2) {
            out.modes.push_back(
                {time, plain_name(name), px4 ? std::string(armed) == "True" : std::string(armed) == "armed"});
            out.changes.push_back(time);
        }
    } else if (kind == "seq" || kind == "reached" || kind == "mission" || kind == "landed" ||
               rest.find("Mission: ") != std::string::npos || rest.find("Executing Mission") != std::string::npos ||
               rest.find("asks for") != std::string::npos || rest.find("loitering") != std::string::npos ||
               rest.find("akeoff") != std::string::npos || rest.find("imb to") != std::string::npos) {
        out.changes.push_back(time);
    }
}

std::unique_ptr<Recording> load(const std::string& name)
{
    const fs::path wire = folder() / (name + ".wire.xz");
    std::ifstream events(folder() / (name + ".events.txt"));
    if (!fs::exists(wire) || !events) {
        return nullptr;
    }
    auto recording = std::make_unique<Recording>();
    recording->name = name;
    recording->wire = sim::read_wire_file(wire);
    recording->frames = frames_of(recording->wire.records);
    const RawFrame* const origin = recording->newest(kOriginId, 1e9);
    const std::array<std::int32_t, 3> place = origin != nullptr ? place_in(*origin) : std::array<std::int32_t, 3>{};
    for (std::string line; std::getline(events, line);) {
        read_event(line, place, *recording);
    }
    return recording;
}

}  // namespace

std::vector<RawFrame> frames_of(const std::vector<sim::WireRecord>& records)
{
    std::vector<RawFrame> frames;
    std::vector<std::byte> waiting;
    for (const sim::WireRecord& record : records) {
        if (record.direction != sim::WireDirection::from_autopilot) {
            continue;
        }
        waiting.insert(waiting.end(), record.bytes.begin(), record.bytes.end());
        std::size_t used = 0;
        while (waiting.size() - used >= kHead + kChecksum) {
            if (at(waiting, used) != kMavlink2) {
                ++used;
                continue;
            }
            const std::size_t payload = at(waiting, used + 1);
            const std::size_t size = kHead + payload + kChecksum;
            if (waiting.size() - used < size) {
                break;
            }
            RawFrame frame;
            frame.time = record.time;
            frame.system = at(waiting, used + 5);
            frame.component = at(waiting, used + 6);
            frame.message = at(waiting, used + 7) | static_cast<std::uint32_t>(at(waiting, used + 8)) << 8U |
                            static_cast<std::uint32_t>(at(waiting, used + 9)) << 16U;
            const auto from = waiting.begin() + static_cast<std::ptrdiff_t>(used);
            frame.bytes.assign(from, from + static_cast<std::ptrdiff_t>(size));
            std::memcpy(frame.payload.data(), frame.bytes.data() + kHead, payload);
            frames.push_back(frame);
            used += size;
        }
        waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(used));
    }
    return frames;
}

std::optional<TruePoint> Recording::truth_at(double time) const
{
    constexpr double kMissing = 1.6;  // [s]
    const auto next =
        std::upper_bound(truth.begin(), truth.end(), time, [](double t, const TruePoint& p) { return t < p.time; });
    if (next == truth.begin() || next == truth.end() || next->time - std::prev(next)->time > kMissing) {
        return std::nullopt;
    }
    const TruePoint& a = *std::prev(next);
    const TruePoint& b = *next;
    const double h = b.time - a.time;
    const double s = (time - a.time) / h;
    TruePoint point;
    point.time = time;
    point.position = (2 * s * s * s - 3 * s * s + 1) * a.position + (s * s * s - 2 * s * s + s) * h * a.velocity +
                     (3 * s * s - 2 * s * s * s) * b.position + (s * s * s - s * s) * h * b.velocity;
    point.velocity = (1 - s) * a.velocity + s * b.velocity;
    return point;
}

const RawFrame* Recording::newest(std::uint32_t message, double time) const
{
    auto it =
        std::upper_bound(frames.begin(), frames.end(), time, [](double t, const RawFrame& f) { return t < f.time; });
    while (it != frames.begin()) {
        --it;
        if (it->message == message && it->component == 1 && it->system == 1) {
            return &*it;
        }
    }
    return nullptr;
}

const std::vector<std::string>& recording_names()
{
    static const std::vector<std::string> names{
        "arducopter_10_m_s",
        "arducopter_cable_pulled",
        "arducopter_companion_killed",
        "arducopter_first_leg",
        "arducopter_off_leg",
        "arducopter_parameters",
        "arducopter_pilot_takes_over",
        "arducopter_reboot",
        "arducopter_takeoff_item",
        "arducopter_three_encounters",
        "arducopter_wall",
        "px4_multirotor_crossing",
        "px4_multirotor_head_on",
        "px4_multirotor_head_on_advise",
        "px4_multirotor_overtaking_items_in_order",
    };
    return names;
}

const Recording* find_recording(const std::string& name)
{
    static std::map<std::string, std::unique_ptr<Recording>> read;
    const auto known = read.find(name);
    return known != read.end() ? known->second.get() : (read[name] = load(name)).get();
}

const std::vector<sim::Belief>& beliefs_of(const Recording& recording)
{
    static std::map<std::string, std::vector<sim::Belief>> known;
    std::vector<sim::Belief>& beliefs = known[recording.name];
    if (beliefs.empty()) {
        sim::replay(recording.wire.records, app::Parameters(),
                    [&](const sim::Belief& belief) { beliefs.push_back(belief); });
    }
    return beliefs;
}

Vec local_of(const std::array<double, 3>& place, const std::array<std::int32_t, 3>& origin)
{
    constexpr double kMetresPerDegree = 6371000.0 * std::numbers::pi / 180.0;
    const double lat = place[0] * std::numbers::pi / 180.0;
    return {(place[1] - origin[1] * 1e-7) * kMetresPerDegree * std::cos(lat),
            (place[0] - origin[0] * 1e-7) * kMetresPerDegree, place[2] - origin[2] * 1e-3};
}

std::array<std::int32_t, 3> place_in(const RawFrame& frame)
{
    std::array<std::int32_t, 3> place{};
    std::memcpy(place.data(), frame.payload.data(), sizeof place);
    return place;
}

}  // namespace jink::replay_test
