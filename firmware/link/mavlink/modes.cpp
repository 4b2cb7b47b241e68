// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/modes.hpp"

namespace jink::link::mavlink {
namespace {

constexpr std::uint8_t kFixedWing = 1;

FlightMode classify_copter(std::uint32_t mode) noexcept
{
    switch (mode) {
    case 3: return FlightMode::mission;   // AUTO
    case 4: return FlightMode::external;  // GUIDED
    case 5:
    case 17: return FlightMode::hold;  // LOITER, BRAKE
    case 6:
    case 9:
    case 21: return FlightMode::going_home;  // RTL, LAND, SMART_RTL
    case 0:
    case 1:
    case 2:
    case 13:
    case 16: return FlightMode::manual;  // STABILIZE, ACRO, ALT_HOLD, SPORT, POSHOLD
    default: return FlightMode::other;
    }
}

FlightMode classify_plane(std::uint32_t mode) noexcept
{
    switch (mode) {
    case 10: return FlightMode::mission;
    case 15: return FlightMode::external;
    case 12: return FlightMode::hold;
    case 11: return FlightMode::going_home;
    case 0:
    case 2:
    case 4:
    case 5:
    case 6:
    case 7: return FlightMode::manual;  // MANUAL, STABILIZE, ACRO, FBWA, FBWB, CRUISE
    default: return FlightMode::other;
    }
}

FlightMode classify_px4(std::uint32_t custom) noexcept
{
    constexpr std::uint32_t kAuto = 4;
    constexpr std::uint32_t kOffboard = 6;
    const std::uint32_t main = px4_main(custom);
    if (main == kOffboard) {
        return FlightMode::external;
    }
    if (main != kAuto) {
        const bool flown_by_hand = main == 1 || main == 2 || main == 3 || main == 5 || main == 7;
        return flown_by_hand ? FlightMode::manual : FlightMode::other;
    }
    switch (px4_sub(custom)) {
    case 3: return FlightMode::hold;
    case 4: return FlightMode::mission;
    case 5:
    case 6: return FlightMode::going_home;
    default: return FlightMode::other;
    }
}

/// MAV_TYPE: quadrotor, coaxial, helicopter, hexarotor, octorotor, tricopter, dodecarotor, decarotor, other multirotor.
bool is_rotorcraft(std::uint8_t mav_type) noexcept
{
    switch (mav_type) {
    case 2:
    case 3:
    case 4:
    case 13:
    case 14:
    case 15:
    case 29:
    case 35:
    case 43: return true;
    default: return false;
    }
}

bool is_vtol(std::uint8_t mav_type) noexcept { return mav_type >= 19 && mav_type <= 25; }

}  // namespace

VehicleClass vehicle_class(AutopilotStack stack, std::uint8_t mav_type) noexcept
{
    const bool plane = mav_type == kFixedWing || (stack == AutopilotStack::ardupilot && is_vtol(mav_type));
    return plane ? VehicleClass::plane : VehicleClass::copter;
}

bool is_steerable(AutopilotStack stack, std::uint8_t mav_type, std::uint8_t vtol_state) noexcept
{
    constexpr std::uint8_t kNoVtol = 0;  // MAV_VTOL_STATE_UNDEFINED
    constexpr std::uint8_t kHovers = 3;  // MAV_VTOL_STATE_MC
    const bool plane = stack == AutopilotStack::ardupilot && mav_type == kFixedWing && vtol_state == kNoVtol;
    const bool hovering_vtol = stack == AutopilotStack::px4 && is_vtol(mav_type) && vtol_state == kHovers;
    return stack != AutopilotStack::unknown && (is_rotorcraft(mav_type) || hovering_vtol || plane);
}

FlightMode classify(AutopilotStack stack, VehicleClass vehicle, std::uint32_t custom_mode) noexcept
{
    switch (stack) {
    case AutopilotStack::px4: return classify_px4(custom_mode);
    case AutopilotStack::ardupilot:
        return vehicle == VehicleClass::plane ? classify_plane(custom_mode) : classify_copter(custom_mode);
    case AutopilotStack::unknown: break;
    }
    return FlightMode::unknown;
}

std::uint32_t external_mode(AutopilotStack stack, VehicleClass vehicle) noexcept
{
    if (stack == AutopilotStack::px4) {
        return px4_mode(6, 0);
    }
    return vehicle == VehicleClass::plane ? 15 : 4;
}

std::uint32_t hold_mode(AutopilotStack stack, VehicleClass vehicle) noexcept
{
    if (stack == AutopilotStack::px4) {
        return px4_mode(4, 3);
    }
    return vehicle == VehicleClass::plane ? 12 : 17;
}

}  // namespace jink::link::mavlink
