// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "firmware/app/parameters.hpp"
#include "firmware/flight_log/topics.hpp"
#include "firmware/link/messages.hpp"

namespace jink::flightlog {

/// What a board's log begins with: file header, flags, information, formats, parameters, subscriptions; about 6 kB. It
/// is composed in parts wherever a part is asked for, and only the values of the parameters are kept for it. The same
/// part has the same bytes whenever it is composed.
class StreamHead {
public:
    /// A byte of the definitions.
    struct Place {
        std::uint16_t message = 0;
        std::uint16_t offset = 0;  ///< within it
        friend bool operator==(const Place&, const Place&) = default;
    };
    struct Part {
        std::span<const std::byte> bytes;
        std::uint8_t first_message = 0;  ///< as in link::LogPart
        Place next;
    };

    /// A log begins with these values.
    void begin(TimePoint started, const app::ParamValues& values) noexcept
    {
        started_ = started;
        values_ = values;
    }
    /// As many bytes as `into` has, fewer at the end. O(bytes + longest message): twice 900 bytes at most.
    [[nodiscard, gnu::cold]] Part part(Place from, std::span<std::byte> into) const noexcept;
    [[nodiscard]] static bool is_end(Place place) noexcept;

    /// Values as the log has them: those of the beginning, and the changes since then that were logged.
    [[nodiscard]] app::ParamValues& values() noexcept { return values_; }

    /// The message of a parameter: size of its name and type, both, and the value.
    static constexpr std::size_t kMaxParameter = ulog::kMessageHeader + 1 + 8 + link::kParamNameLength + 4;
    [[nodiscard, gnu::cold]] std::span<const std::byte> parameter(std::size_t index,
                                                                  std::span<std::byte> into) const noexcept;

private:
    class Window;
    [[gnu::cold]] void put_message(std::size_t index, Window& into) const noexcept;
    [[gnu::cold]] void put_content(std::size_t index, Window& into) const noexcept;

    TimePoint started_;
    app::ParamValues values_{};
};

}  // namespace jink::flightlog
