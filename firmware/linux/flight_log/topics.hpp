// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "firmware/flight_log/topics.hpp"
#include "firmware/linux/flight_log/ulog.hpp"

// What the log of jinkd has beside the topics of boards: nominal paths, obstacles, closed areas, and records of its
// ports.

namespace jink::flightlog {

/// One segment of a nominal path, from the one on that is being flown: path::RouteSegment. All segments of both paths
/// have the same timestamp.
struct NominalTopic {
    static constexpr std::string_view kFormat =
        "jink_nominal:uint64_t timestamp;float[3] start;float[3] along;float[3] towards;float radius;float length;"
        "float speed;uint8_t path;uint8_t segment;uint8_t segments;bool on_route;";
    std::uint64_t timestamp = 0;
    Xyz start{};
    Xyz along{};
    Xyz towards{};
    float radius = 0.0F;
    float length = 0.0F;
    float speed = 0.0F;
    std::uint8_t path = 0;  ///< 0: the one that is flown in control; 1: the other one
    std::uint8_t segment = 0;
    std::uint8_t segments = 0;
    bool on_route = false;  ///< as the link reports it; else the measured motion
};

/// An obstacle, or a part of a map, of a round: what was known after one step, at `known`. The solid stands about
/// `centre`, turned by the unit quaternion `turn` (w, x, y, z) from its own axes into the world's.
struct ObstacleTopic {
    static constexpr std::string_view kFormat =
        "jink_obstacle:uint64_t timestamp;uint64_t known;uint32_t id;float[3] centre;float[3] half;float[4] turn;"
        "float radius;float uncertainty;uint16_t number;uint16_t obstacles;uint16_t areas;uint8_t kind;bool of_map;"
        "bool is_bound;";
    std::uint64_t timestamp = 0;
    std::uint64_t known = 0;
    std::uint32_t id = 0;
    Xyz centre{};
    Xyz half{};  ///< of a box; z of a capsule and a cylinder: of their axis; of a hull: of the box about it
    std::array<float, 4> turn{};
    float radius = 0.0F;          ///< of a sphere, capsule and cylinder
    float uncertainty = 0.0F;     ///< it may stand out of its shape by so much
    std::uint16_t number = 0;     ///< among the obstacles of the round
    std::uint16_t obstacles = 0;  ///< of the round
    std::uint16_t areas = 0;      ///< of the round
    std::uint8_t kind = 0;        ///< geometry::ShapeKind
    bool of_map = false;
    bool is_bound = false;  ///< centre, half and turn are a box that holds the solid: a hull's
};

/// A closed area of a round: an upright cylinder, where it was at `known`.
struct AreaTopic {
    static constexpr std::string_view kFormat =
        "jink_area:uint64_t timestamp;uint64_t known;float[2] centre;float[2] velocity;float radius;float bottom;"
        "float top;float margin;uint16_t number;uint16_t obstacles;uint16_t areas;";
    std::uint64_t timestamp = 0;
    std::uint64_t known = 0;
    std::array<float, 2> centre{};
    std::array<float, 2> velocity{};
    float radius = 0.0F;
    float bottom = 0.0F;
    float top = 0.0F;
    float margin = 0.0F;
    std::uint16_t number = 0;     ///< among the areas of the round
    std::uint16_t obstacles = 0;  ///< of the round
    std::uint16_t areas = 0;      ///< of the round
};

/// Records of steps are cut into parts, and a part takes the smallest of these sizes in which it fits; ULog has no
/// messages of variable size. Topic ids from TopicId::hal on.
inline constexpr std::array<std::uint16_t, 9> kHalSizes{32, 64, 128, 192, 256, 384, 512, 1024, 4096};
/// Head of such a message: timestamp, sequence of parts since the start, bytes in use, and flags.
struct HalHead {
    static constexpr std::size_t kBytes = 16;
    static constexpr std::uint16_t kGoesOn = 1;     ///< the record goes on in the next part
    static constexpr std::uint16_t kContinues = 2;  ///< the record began in a part before
    std::uint64_t timestamp = 0;
    std::uint32_t sequence = 0;
    std::uint16_t length = 0;
    std::uint16_t flags = 0;
};
static_assert(sizeof(HalHead) == HalHead::kBytes);

/// All formats, index = topic id.
[[nodiscard]] std::vector<std::string> topic_formats();

/// Names of the faults in a set, with commas; "none".
[[nodiscard]] std::string names_of_faults(std::uint16_t faults);

}  // namespace jink::flightlog
