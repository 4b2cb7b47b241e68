// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/app/parameters.hpp"
#include "firmware/link/param_server.hpp"

namespace jink::app {

/// Parameters for a bus. Initial values are those the application was built with: the vehicle's and the user's files,
/// or the image's, not the table's, because the defaults are those of some other vehicle. "Erase" brings them back.
///
/// "Save" writes nothing: whoever keeps the parameters stores each change by itself and notes it here. The answer says
/// whether a restart would bring the present values.
class ParamService final : public link::ParamServer {
public:
    ParamService(Parameters& parameters, std::uint32_t& set, std::uint32_t& refused) noexcept
        : parameters_(parameters), set_(set), refused_(refused), initial_(parameters.values())
    {
    }

    [[nodiscard]] bool read(std::uint16_t index, link::ParamEntry& entry) const noexcept override;
    [[nodiscard]] bool find(const link::ParamName& name, std::uint16_t& index) const noexcept override;
    void write(std::uint16_t index, float value) noexcept override;
    [[nodiscard]] bool save() noexcept override { return has_stored_ && stored_ == parameters_.generation(); }
    [[nodiscard]] bool erase() noexcept override;

    [[nodiscard]] const ParamValues& initial() const noexcept { return initial_; }
    /// The values of this Parameters::generation() are what a restart brings.
    void note_stored(std::uint32_t generation) noexcept
    {
        has_stored_ = true;
        stored_ = generation;
    }

private:
    Parameters& parameters_;
    std::uint32_t& set_;
    std::uint32_t& refused_;
    ParamValues initial_;
    bool has_stored_ = false;
    std::uint32_t stored_ = 0;
};

}  // namespace jink::app
