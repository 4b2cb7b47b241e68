// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "firmware/link/messages.hpp"

namespace jink::link {

struct ParamEntry {
    ParamName name{};
    float value = 0.0F;
    float initial = 0.0F;  ///< what `erase` brings back
    float low = 0.0F;
    float high = 0.0F;
    bool integer = false;
};

/// What a bus asks of whoever keeps the parameters, while it handles a request. Numbers that are not finite or not
/// exact in a float never get here.
class ParamServer {
public:
    /// False: there is no parameter `index`.
    [[nodiscard]] virtual bool read(std::uint16_t index, ParamEntry& entry) const noexcept = 0;
    /// False: there is none of this name.
    [[nodiscard]] virtual bool find(const ParamName& name, std::uint16_t& index) const noexcept = 0;
    /// A value that is refused changes nothing: the answer is what `read` gives then.
    virtual void write(std::uint16_t index, float value) noexcept = 0;
    /// Keeps all values over a restart; false where that is not possible (now).
    [[nodiscard]] virtual bool save() noexcept = 0;
    /// Back to the initial values; false where that is not possible (now).
    [[nodiscard]] virtual bool erase() noexcept = 0;

protected:
    ~ParamServer() = default;
};

}  // namespace jink::link
