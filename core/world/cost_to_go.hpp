// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/base/time.hpp"
#include "core/base/vec3.hpp"

namespace jink::world {

/// What is known of the way to the route past the obstacles: how long it takes from any place near the vehicle, in the
/// manner of a navigation function. An interface, so that an image without one carries none of its code. It guides; no
/// answer is safer for it, and every answer is checked.
class CostToGo {
public:
    /// What obstacles cost on the way from `place`, beside the way through open air [s], 0 or more; nothing where this
    /// is not known.
    [[nodiscard]] virtual std::optional<Seconds> lost_from(const Vec3& place) const noexcept = 0;
    /// A point about `distance` [m] from `from` on the quickest way past the obstacles; nothing where no obstacle is in
    /// the way, and where no way is known.
    [[nodiscard]] virtual std::optional<Vec3> way_around(const Vec3& from, float distance) const noexcept = 0;

protected:
    ~CostToGo() = default;
};

}  // namespace jink::world
