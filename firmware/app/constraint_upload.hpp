// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/link/constraint.hpp"

namespace jink::app {

struct ConstraintUploadDiagnostics {
    std::uint32_t sets = 0;       ///< complete
    std::uint32_t abandoned = 0;  ///< incomplete when another set began
    std::uint32_t refused = 0;    ///< parts: out of range, of too large a set, or not in the frame of its other parts
};

/// Collects the parts of a set of constraints, in any order. The set in force does not change before the new one is
/// complete. A part that comes again replaces its former value in an incomplete set.
///
/// A set differs from the former by its sender, its number or its count; from a complete one also by any value of a
/// part but its stamp. A sender that starts anew with the same number therefore replaces its former areas as a whole,
/// and a sender whose answer was lost repeats the part as it was. A part of another set abandons an incomplete one.
///
/// Memory: 72 bytes for each of kMaxReportedConstraints.
class ConstraintUpload {
public:
    /// O(1).
    [[nodiscard]] link::ConstraintResult take(const link::ConstraintPart& part, TimePoint now) noexcept;

    /// The set is complete and has changed since mark_in_force().
    [[nodiscard]] bool is_new() const noexcept { return is_complete_ && !in_force_; }
    /// Valid while is_new().
    [[nodiscard]] std::span<const link::Constraint> set() const noexcept { return {parts_.data(), count_}; }
    void mark_in_force() noexcept { in_force_ = true; }

    [[nodiscard]] const ConstraintUploadDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    [[nodiscard]] bool belongs(const link::ConstraintPart& part) const noexcept;
    void begin(const link::ConstraintPart& part) noexcept;

    std::array<link::Constraint, link::kMaxReportedConstraints> parts_{};
    static_assert(link::kMaxReportedConstraints < 32);
    std::uint32_t received_ = 0;  ///< bit i: part i
    std::size_t count_ = 0;
    bool has_set_ = false;
    bool is_complete_ = false;
    bool in_force_ = false;
    bool is_global_ = false;  ///< the parts are placed on the globe
    std::uint8_t number_ = 0;
    std::uint8_t from_system_ = 0;
    std::uint8_t from_component_ = 0;
    ConstraintUploadDiagnostics diagnostics_;
};

}  // namespace jink::app
