// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/app/parameters.hpp"
#include "firmware/link/param_server.hpp"

namespace jink::app {

/// Parameters for a bus. Initial values are those the application was started with: the vehicle's and the user's files,
/// not the table's, because what a restart would bring is what "erase" stands for, and the defaults are those of some
/// other vehicle. There is nowhere to save to.
class ParamService final : public link::ParamServer {
public:
    ParamService(Parameters& parameters, std::uint32_t& set, std::uint32_t& refused) noexcept
        : parameters_(parameters), set_(set), refused_(refused), initial_(parameters.values())
    {
    }

    [[nodiscard]] bool read(std::uint16_t index, link::ParamEntry& entry) const noexcept override;
    [[nodiscard]] bool find(const link::ParamName& name, std::uint16_t& index) const noexcept override;
    void write(std::uint16_t index, float value) noexcept override;
    [[nodiscard]] bool save() noexcept override { return false; }
    [[nodiscard]] bool erase() noexcept override;

private:
    Parameters& parameters_;
    std::uint32_t& set_;
    std::uint32_t& refused_;
    std::array<float, kParamCount> initial_;
};

}  // namespace jink::app
