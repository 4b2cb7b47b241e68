// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "firmware/link/messages.hpp"

namespace jink::link {

struct ParamEntry {
    ParamName name{};
    float value = 0.0F;
    float initial = 0.0F;  ///< value after `erase`
    float low = 0.0F;
    float high = 0.0F;
    bool integer = false;
};

/// Interface of the parameter owner, called while a bus handles a request. Values are finite and exact in a float; the
/// bus refuses all others.
class ParamServer {
public:
    /// False: there is no parameter `index`.
    [[nodiscard]] virtual bool read(std::uint16_t index, ParamEntry& entry) const noexcept = 0;
    /// False: there is no parameter of this name.
    [[nodiscard]] virtual bool find(const ParamName& name, std::uint16_t& index) const noexcept = 0;
    /// A refused value changes nothing: the answer is then the value that `read` gives.
    virtual void write(std::uint16_t index, float value) noexcept = 0;
    /// Stores all values in persistent memory; false if that is not possible now.
    [[nodiscard]] virtual bool save() noexcept = 0;
    /// Restores the initial values; false if that is not possible now.
    [[nodiscard]] virtual bool erase() noexcept = 0;

protected:
    ~ParamServer() = default;
};

}  // namespace jink::link
