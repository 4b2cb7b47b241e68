// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/param_service.hpp"

#include <algorithm>

namespace jink::app {

bool ParamService::read(std::uint16_t index, link::ParamEntry& entry) const noexcept
{
    if (index >= kParamCount) {
        return false;
    }
    const ParamInfo& info = param_table()[index];
    entry.name = {};
    std::copy(info.name.begin(), info.name.end(), entry.name.begin());
    entry.value = parameters_.values()[index];
    entry.initial = initial_[index];
    entry.low = info.low;
    entry.high = info.high;
    entry.integer = info.integer;
    return true;
}

bool ParamService::find(const link::ParamName& name, std::uint16_t& index) const noexcept
{
    index = static_cast<std::uint16_t>(Parameters::find({name.data(), name.size()}));
    return index < kParamCount;
}

void ParamService::write(std::uint16_t index, float value) noexcept
{
    const bool taken = index < kParamCount && parameters_.set(static_cast<Param>(index), value) == ParamStatus::ok;
    ++(taken ? set_ : refused_);
}

bool ParamService::erase() noexcept
{
    const bool taken = parameters_.set_all(initial_) == ParamStatus::ok;
    ++(taken ? set_ : refused_);
    return taken;
}

}  // namespace jink::app
