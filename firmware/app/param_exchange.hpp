// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "firmware/app/diagnostics.hpp"
#include "firmware/app/outbox.hpp"
#include "firmware/app/param_service.hpp"
#include "firmware/app/parameters.hpp"

namespace jink::app {

/// The parameters, and everybody who reads or sets them: the link, the bus, and storage at the start.
class ParamExchange {
public:
    ParamExchange(const Parameters& parameters, Diagnostics& counts) noexcept
        : parameters_(parameters), service_(parameters_, counts.params_set, counts.params_refused), counts_(counts),
          applied_(parameters.generation())
    {
    }
    ParamExchange(const ParamExchange&) = delete;
    ParamExchange& operator=(const ParamExchange&) = delete;

    /// Requests of the link: sets, and answers each with the value that holds then.
    void take(std::span<const link::ParamRequest> requests, link::Link& link, Outbox& outbox) noexcept;
    /// The next parts of a list: a few per step, so that the list never fills the transmit buffer.
    void continue_list(link::Link& link) noexcept;
    /// What the autopilot says about its limits; a text for each that bounds a parameter from now on.
    [[gnu::cold]] void believe(const link::ReportedLimits& reported, Outbox& outbox) noexcept;
    /// @return how many were refused: out of range, or not together with the others
    std::size_t restore(const ParamValues& values) noexcept { return parameters_.set_each(values); }
    /// Whether the configuration changed since the last call.
    [[nodiscard]] bool take_change() noexcept;

    [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
    [[nodiscard]] const Configuration& configuration() const noexcept { return parameters_.configuration(); }
    /// For the bus, and for who stores the values.
    [[nodiscard]] ParamService& service() noexcept { return service_; }
    [[nodiscard]] const ParamService& service() const noexcept { return service_; }

private:
    void answer(std::size_t index, link::Link& link) noexcept;

    Parameters parameters_;
    ParamService service_;
    Diagnostics& counts_;
    std::uint32_t applied_;                ///< generation
    bool has_new_limits_ = false;          ///< limits of the autopilot, which are not applied yet
    std::optional<std::uint16_t> cursor_;  ///< next part of a list that is asked for
};

}  // namespace jink::app
