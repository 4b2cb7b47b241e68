// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/avoid/settings.hpp"
#include "core/world/well_clear.hpp"

namespace jink::avoid {

/// Stands in Manoeuvre::by for what gives way to aircraft: no method's id.
inline constexpr std::uint8_t kGivesWay = 255;

/// How many commands are tried at most.
inline constexpr int kGiveWayTries = 4;
/// How many aircraft are kept clear of: those that come nearest while the vehicle flies on as it does.
inline constexpr std::size_t kMaxAircraft = 4;

/// What is flown to keep well clear of aircraft, a velocity that is held: at cruise speed 8 courses, level, climbing
/// and descending; straight up and down; standing. Of those that keep well clear of all aircraft for
/// world::kAircraftAhead with a tenth to spare, also where these go on turning as they do, the one that differs least
/// from the nominal velocity; else the one that stays farthest from a near mid-air collision. `previous` (may be null)
/// counts a little better, so that noise does not change sides. Climbs and descents end in time before ceiling and
/// floor. The choice has to pass the final check against everything else; where it does not, the next best one is
/// tried. A fixed wing does not stand or climb straight up.
/// @return least predicted margin, >= 0 [m]; nothing where no command passes or the budget ends: `out` is void then.
/// O((27 + 9) * aircraft + tries * points * threats).
[[nodiscard]] std::optional<float> choose_give_way(const world::Situation& situation, const Vec3& along,
                                                   const Vec3* previous, const Settings& settings, WorkBudget& budget,
                                                   world::Manoeuvre& out) noexcept;

}  // namespace jink::avoid
