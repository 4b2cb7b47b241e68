// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/area_sender.hpp"

#include <algorithm>
#include <utility>

#include "firmware/link/mavlink/constraint_message.hpp"

namespace jink::sim {
namespace {

constexpr std::uint8_t kSet = 1;
constexpr std::uint8_t kObstacleAvoidance = 196;  // MAV_COMP_ID_OBSTACLE_AVOIDANCE
constexpr Micros kRepeat = kSecond / 5;
/// A set that comes into force later does not count as known at the start of the flight.
constexpr Micros kAtTheStart = 2 * kSecond;

}  // namespace

std::vector<std::byte> AreaSender::send(Micros now)
{
    if (in_force_at_ >= 0 || (sent_at_ >= 0 && now - sent_at_ < kRepeat)) {
        return {};
    }
    sent_at_ = now;
    const std::vector<link::Constraint> constraints = constraints_of(areas_, {0});
    for (std::size_t i = 0; i < constraints.size(); ++i) {
        if (results_[i].answered) {
            continue;
        }
        link::ConstraintPart part;
        part.constraint = constraints[i];
        part.set = kSet;
        part.index = static_cast<std::uint8_t>(i);
        part.count = static_cast<std::uint8_t>(constraints.size());
        link::mavlink::Tunnel message = link::mavlink::constraint_message(part, {now});
        message.target_system = kAutopilot.system;
        message.target_component = kObstacleAvoidance;
        writer_.write(message, kGroundStation);
    }
    return std::exchange(writer_.bytes(), {});
}

void AreaSender::receive(std::span<const std::byte> bytes, Micros now)
{
    if (areas_.empty() || in_force_at_ >= 0) {
        return;
    }
    while (const auto frame = parser_.next(bytes)) {
        link::mavlink::Tunnel message;
        link::mavlink::ConstraintAnswer answer;
        if (!decode(*frame, message) || message.target_system != kGroundStation.system ||
            message.target_component != kGroundStation.component || !read_constraint_answer(message, answer) ||
            answer.set != kSet || answer.index >= results_.size()) {
            continue;
        }
        results_[answer.index] = {true, answer.result};
        if (answer.result == link::ConstraintResult::in_force) {
            in_force_at_ = now;
        }
    }
}

std::string AreaSender::fault() const
{
    for (std::size_t i = 0; i < areas_.size() && in_force_at_ < 0; ++i) {
        if (!results_[i].answered) {
            return "closed area " + areas_[i].name + " was not acknowledged";
        }
        if (results_[i].result != link::ConstraintResult::kept) {
            return "closed area " + areas_[i].name + " was refused, result " +
                   std::to_string(static_cast<int>(results_[i].result));
        }
    }
    if (in_force_at_ > kAtTheStart) {
        return "closed areas were in force after " + std::to_string(in_force_at_ / kSecond) + " s only";
    }
    return "";
}

}  // namespace jink::sim
