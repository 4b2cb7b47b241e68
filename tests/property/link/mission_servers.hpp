// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "tests/unit/link/mavlink_tools.hpp"

// Small models of mission servers, from PX4's mavlink_mission.cpp and ArduPilot's MissionItemProtocol.cpp, and of the
// line to them.

namespace jink::link::mavlink::test {

constexpr std::uint8_t kVehicle = 1;
constexpr std::uint8_t kAutopilotId = 1;
constexpr std::uint8_t kStation = 255;
constexpr std::uint8_t kStationId = 190;

/// In order, late, with losses and doubled frames.
struct LossyLine {
    struct Sent {
        double at, sent;
        Bytes bytes;
    };
    void send(const Bytes& bytes, double now, Random& random)
    {
        if (random.uniform() < loss) {
            return;
        }
        free_at = std::max(free_at, now + random.uniform(0.005F, slowest));
        frames.push_back({free_at, now, bytes});
        if (random.uniform() < doubles) {
            frames.push_back({free_at, now, bytes});
        }
    }
    std::optional<Sent> take(double now)
    {
        if (frames.empty() || frames.front().at > now) {
            return std::nullopt;
        }
        Sent first = std::move(frames.front());
        frames.pop_front();
        return first;
    }
    float loss = 0.0F;
    float doubles = 0.0F;
    float slowest = 0.1F;
    double free_at = 0.0;  ///< earlier frames arrive before later ones
    std::deque<Sent> frames;
};

/// Version and sequence number of an item, as its coordinates carry them.
using ItemName = std::pair<int, int>;

class MissionServer {
public:
    MissionServer(LossyLine& line, Random& random) : line_(line), random_(random) {}
    virtual ~MissionServer() = default;

    virtual void hear(const Received& frame, double sent, double now) = 0;
    virtual void tick(double now) = 0;

    /// The flown item: the current item, or the navigation item behind DO_ items. None if it has no place.
    [[nodiscard]] std::optional<ItemName> truth(int first_item) const { return goal_of(version, current, first_item); }
    [[nodiscard]] std::optional<ItemName> goal_of(int of_version, std::size_t i, int first_item) const
    {
        const std::vector<MissionItemInt>& items = missions[static_cast<std::size_t>(of_version)];
        if (static_cast<int>(i) < first_item) {
            return std::nullopt;
        }
        while (i < items.size() && items[i].command > 95) {
            ++i;
        }
        const bool has_place = i < items.size() && items[i].command == 16;
        return has_place ? std::optional(ItemName{of_version, static_cast<int>(i)}) : std::nullopt;
    }
    void replace(std::size_t n)
    {
        ++version;
        mission.clear();
        for (std::size_t i = 0; i < n; ++i) {
            MissionItemInt item;
            const float kind = random_.uniform();
            item.command = kind < 0.75F ? 16 : kind < 0.85F ? 18 : kind < 0.95F ? 178 : 20;
            item.frame = 1;
            item.x = (version * 100 + static_cast<int>(i)) * 10'000;
            item.z = -30.0F;
            item.seq = static_cast<std::uint16_t>(i);
            mission.push_back(item);
        }
        missions.push_back(mission);
        current = 0;
    }
    template <Message M>
    void say(const M& message, double now)
    {
        line_.send(frame_of(message, {kVehicle, kAutopilotId, sequence_++}), now, random_);
    }
    template <Message M>
    static bool takes(const Received& frame, M& message)
    {
        return decode(frame.frame(), message) && message.target_system == kVehicle &&
               message.target_component == kAutopilotId;
    }
    template <Message M>
    static M to(std::uint8_t system, std::uint8_t component)
    {
        M message;
        message.target_system = system;
        message.target_component = component;
        return message;
    }

    std::vector<MissionItemInt> mission;
    std::vector<std::vector<MissionItemInt>> missions{{}};  ///< by version
    int version = 0;
    std::uint16_t current = 0;

protected:
    LossyLine& line_;
    Random& random_;
    std::uint8_t sequence_ = 0;
    double reported_ = -10.0;
    int reported_current_ = -1;
};

/// PX4's messages to its pilot.
struct Px4Texts {
    int out_of_order = 0;
    int timeout = 0;
    std::vector<double> beyond_count;  ///< when the request was sent
    std::vector<double> not_partner;
};

class Px4Server final : public MissionServer {
public:
    using MissionServer::MissionServer;

    [[nodiscard]] std::uint32_t id() const { return 0x1000U + static_cast<std::uint32_t>(version); }

    void hear(const Received& frame, double sent, double now) override
    {
        MissionRequestList list;
        MissionRequestInt request;
        MissionAck ack;
        const std::pair from{frame.header.system_id, frame.header.component_id};
        if (takes(frame, list) && uploading_until_ > 0.0) {
            texts.not_partner.push_back(sent);  // "Mission download request ignored, already active"
        } else if (takes(frame, list)) {
            sends_ = sends_ && next_ != mission.size();
            last_ = now;
            sends_ = true;
            next_ = 0;
            transfer_count_ = mission.size();
            partner_ = from;
            MissionCount count = to<MissionCount>(from.first, from.second);
            count.count = static_cast<std::uint16_t>(mission.size());
            count.opaque_id = id();
            say(count, now);
        } else if (takes(frame, request)) {
            answer(request, from, sent, now);
        } else if (takes(frame, ack)) {
            if (from != partner_) {
                texts.not_partner.push_back(sent);
            } else {
                sends_ = false;
            }
        }
    }
    void tick(double now) override
    {
        if (uploading_until_ > 0.0 && now >= uploading_until_) {
            uploading_until_ = 0.0;
            replace(uploaded_);
            say(to<MissionAck>(kStation, kStationId), now);
        } else if (uploading_until_ > 0.0) {
            say(to<MissionRequestInt>(kStation, kStationId), now);
        }
        if (sends_ && now - last_ > 5.0) {
            sends_ = false;
            ++texts.timeout;
        }
        if (now - reported_ >= 1.0 || reported_current_ != current) {
            reported_ = now;
            reported_current_ = current;
            MissionCurrent m;
            m.seq = current;
            m.total = static_cast<std::uint16_t>(mission.size());
            m.mission_id = id();
            say(m, now);
        }
    }
    /// A ground station writes a mission over the same line: it becomes the partner.
    void station_writes(std::size_t n, double now)
    {
        partner_ = {kStation, kStationId};
        sends_ = false;
        uploaded_ = n;
        uploading_until_ = now + random_.uniform(0.1F, 2.0F);
    }
    /// A ground station reads the mission over the same line: it becomes the partner.
    void station_reads(double now)
    {
        partner_ = {kStation, kStationId};
        sends_ = false;
        MissionCount count = to<MissionCount>(kStation, kStationId);
        count.count = static_cast<std::uint16_t>(mission.size());
        say(count, now);
        for (const MissionItemInt& item : mission) {
            MissionItemInt m = item;
            m.target_system = kStation;
            m.target_component = kStationId;
            say(m, now);
        }
    }

    Px4Texts texts;

private:
    void answer(const MissionRequestInt& request, std::pair<std::uint8_t, std::uint8_t> from, double sent, double now)
    {
        if (from != partner_) {
            texts.not_partner.push_back(sent);
            return;
        }
        if (!sends_) {
            return;  // silently ignored
        }
        last_ = now;
        if (request.seq == next_ && next_ < transfer_count_) {
            ++next_;
        } else if (request.seq + 1U != next_) {
            ++texts.out_of_order;
            fail(from, now);
            return;
        }
        if (request.seq >= mission.size()) {
            texts.beyond_count.push_back(sent);
            fail(from, now);
            return;
        }
        MissionItemInt m = mission[request.seq];
        m.target_system = from.first;
        m.target_component = from.second;
        say(m, now);
    }
    void fail(std::pair<std::uint8_t, std::uint8_t> to_whom, double now)
    {
        sends_ = false;
        MissionAck ack = to<MissionAck>(to_whom.first, to_whom.second);
        ack.type = 1;
        say(ack, now);
    }

    bool sends_ = false;
    double uploading_until_ = 0.0;
    std::size_t uploaded_ = 0;
    std::size_t next_ = 0;
    std::size_t transfer_count_ = 0;
    std::pair<std::uint8_t, std::uint8_t> partner_{0, 0};
    double last_ = 0.0;
};

/// A version without mission ids: a replaced mission of the same length is not announced.
class ArduPilotServer final : public MissionServer {
public:
    using MissionServer::MissionServer;

    void hear(const Received& frame, double /*sent*/, double now) override
    {
        MissionRequestList list;
        MissionRequestInt request;
        const std::uint8_t system = frame.header.system_id;
        const std::uint8_t component = frame.header.component_id;
        const bool is_list = takes(frame, list);
        const bool is_item = !is_list && takes(frame, request);
        MissionAck ack = to<MissionAck>(system, component);
        if ((is_list || is_item) && now < receiving_until) {
            ack.type = 14;
            say(ack, now);
            return;
        }
        if (is_list || (is_item && request.seq >= mission.size())) {
            MissionCount count = to<MissionCount>(system, component);
            count.count = static_cast<std::uint16_t>(mission.size());
            say(count, now);
            ack.type = 1;
            if (is_item) {
                say(ack, now);
            }
        } else if (is_item) {
            MissionItemInt m = mission[request.seq];
            m.target_system = system;
            m.target_component = component;
            say(m, now);
        }
    }
    void tick(double now) override
    {
        if (now - reported_ >= 0.5) {
            reported_ = now;
            MissionCurrent m;
            m.seq = current;
            m.total = static_cast<std::uint16_t>(mission.empty() ? 0 : mission.size() - 1);
            say(m, now);
        }
    }

    double receiving_until = 0.0;  ///< an upload on another line is in progress
};

}  // namespace jink::link::mavlink::test
