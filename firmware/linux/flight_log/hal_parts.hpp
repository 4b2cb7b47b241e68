// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "firmware/linux/flight_log/topics.hpp"

namespace jink::flightlog {

/// Puts the parts of records together (kHalSizes). A record is 1 MiB at most.
class HalParts {
public:
    static constexpr std::size_t kMaxRecord = 1U << 20U;

    enum class Taken : std::uint8_t {
        part,    ///< the record goes on
        record,  ///< `record` is whole
        gap,     ///< parts are missing before this one
        bad,     ///< lengths that cannot be
    };
    /// @param content  of a message whose topic is jink_hal_*
    [[nodiscard]] Taken take(std::span<const std::byte> content);
    [[nodiscard]] std::span<const std::byte> record() const noexcept { return record_; }
    /// Timestamp of the newest part [us].
    [[nodiscard]] std::uint64_t time() const noexcept { return time_; }

private:
    std::vector<std::byte> record_;
    std::uint32_t next_ = 0;
    std::uint64_t time_ = 0;
    bool goes_on_ = false;
};

}  // namespace jink::flightlog
