// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/snapshot.hpp"

namespace jink::world {

void Snapshot::take(const Situation& situation) noexcept
{
    // Does not compile when a field is added that it does not know.
    const auto& [now, own, limits, airframe, reference, rules, threats, flying, own_id, commanded, shared_horizon,
                 cost_to_go] = situation;
    now_ = now;
    own_ = own;
    limits_ = limits;
    airframe_ = airframe;
    reference_ = reference.moved_to(route_);
    rules_ = rules;
    own_id_ = own_id;
    shared_horizon_ = shared_horizon;
    cost_to_go_ = cost_to_go;
    flying_.reset();
    if (flying != nullptr) {
        flying_.emplace(*flying);
    }
    commanded_.reset();
    if (commanded != nullptr) {
        commanded_.emplace(*commanded);
    }
    threats_.clear();
    tracks_.clear();
    shapes_.clear();
    cylinders_.clear();
    collected_ = threats.data() != nullptr && threats.size() <= ThreatSet::kMaxThreats;
    if (!collected_) {
        return;
    }
    for (const Threat& threat : threats) {
        Threat copy = threat;
        if (threat.form == ThreatForm::cylinder) {
            cylinders_.unchecked_push_back(*threat.cylinder);
            copy.cylinder = &cylinders_.back();
        } else if (threat.ref.kind == ThreatKind::track && threat.track != nullptr) {
            tracks_.unchecked_push_back(*threat.track);
            copy.track = &tracks_.back();
        } else if (threat.ref.kind == ThreatKind::obstacle && threat.solid != nullptr) {
            shapes_.unchecked_push_back(*threat.solid);
            copy.solid = &shapes_.back();
        }
        threats_.unchecked_push_back(copy);
    }
}

Situation Snapshot::situation() const noexcept
{
    const std::span<const Threat> threats =
        collected_ ? std::span<const Threat>(threats_.data(), threats_.size()) : std::span<const Threat>();
    return {now_,
            own_,
            limits_,
            airframe_,
            reference_,
            rules_,
            threats,
            flying_ ? &*flying_ : nullptr,
            own_id_,
            commanded_ ? &*commanded_ : nullptr,
            shared_horizon_,
            cost_to_go_};
}

}  // namespace jink::world
