// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "core/world/threat_set.hpp"

namespace jink::oracle {

/// A situation with its threats collected.
class Collected {
public:
    Collected(const world::Situation& situation, const world::Surroundings& around) : situation_(situation)
    {
        static_cast<void>(set_->collect(situation, around));
        situation_.threats = set_->all();
    }
    // NOLINTNEXTLINE(google-explicit-constructor): stands for the situation
    operator const world::Situation&() const { return situation_; }
    const world::Situation* operator->() const { return &situation_; }
    const world::Situation& operator*() const { return situation_; }

private:
    std::unique_ptr<world::ThreatSet> set_ = std::make_unique<world::ThreatSet>();
    world::Situation situation_;
};

}  // namespace jink::oracle
