// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/mode_names.hpp"

#include <span>
#include <string_view>

#include "firmware/link/mavlink/modes.hpp"

namespace jink::sim {
namespace {

struct NamedMode {
    std::uint32_t number;
    std::string_view name;
};

constexpr NamedMode kCopterModes[] = {
    {0, "STABILIZE"},  {1, "ACRO"},      {2, "ALT_HOLD"}, {3, "AUTO"},    {4, "GUIDED"},      {5, "LOITER"},
    {6, "RTL"},        {7, "CIRCLE"},    {9, "LAND"},     {11, "DRIFT"},  {13, "SPORT"},      {14, "FLIP"},
    {15, "AUTOTUNE"},  {16, "POSHOLD"},  {17, "BRAKE"},   {18, "THROW"},  {19, "AVOID_ADSB"}, {20, "GUIDED_NOGPS"},
    {21, "SMART_RTL"}, {22, "FLOWHOLD"}, {23, "FOLLOW"},  {24, "ZIGZAG"}, {25, "SYSTEMID"},   {26, "AUTOROTATE"},
    {27, "AUTO_RTL"},  {28, "TURTLE"},
};

constexpr NamedMode kPlaneModes[] = {
    {0, "MANUAL"},        {1, "CIRCLE"},        {2, "STABILIZE"},   {3, "TRAINING"}, {4, "ACRO"},
    {5, "FLY_BY_WIRE_A"}, {6, "FLY_BY_WIRE_B"}, {7, "CRUISE"},      {8, "AUTOTUNE"}, {10, "AUTO"},
    {11, "RTL"},          {12, "LOITER"},       {14, "AVOID_ADSB"}, {15, "GUIDED"},  {16, "INITIALISING"},
    {17, "QSTABILIZE"},   {18, "QHOVER"},       {19, "QLOITER"},    {20, "QLAND"},   {21, "QRTL"},
};

constexpr NamedMode kPx4MainModes[] = {
    {1, "MANUAL"}, {2, "ALTCTL"}, {3, "POSCTL"}, {5, "ACRO"}, {6, "OFFBOARD"}, {7, "STABILIZED"}, {8, "RATTITUDE"},
};

constexpr NamedMode kPx4AutoModes[] = {
    {1, "READY"}, {2, "TAKEOFF"}, {3, "HOLD"}, {4, "MISSION"},
    {5, "RTL"},   {6, "LAND"},    {7, "RTGS"}, {8, "FOLLOW_TARGET"},
};

std::string name_of(std::span<const NamedMode> modes, std::uint32_t number, std::uint32_t whole)
{
    for (const NamedMode& mode : modes) {
        if (mode.number == number) {
            return std::string(mode.name);
        }
    }
    return std::to_string(whole);
}

}  // namespace

std::string mode_name(link::AutopilotStack stack, bool fixed_wing, std::uint32_t custom_mode)
{
    constexpr std::uint32_t kAuto = 4;
    switch (stack) {
    case link::AutopilotStack::ardupilot:
        return fixed_wing ? name_of(kPlaneModes, custom_mode, custom_mode)
                          : name_of(kCopterModes, custom_mode, custom_mode);
    case link::AutopilotStack::px4:
        return link::mavlink::px4_main(custom_mode) == kAuto
                   ? name_of(kPx4AutoModes, link::mavlink::px4_sub(custom_mode), custom_mode)
                   : name_of(kPx4MainModes, link::mavlink::px4_main(custom_mode), custom_mode);
    case link::AutopilotStack::unknown: break;
    }
    return std::to_string(custom_mode);
}

}  // namespace jink::sim
