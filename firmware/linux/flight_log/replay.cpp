// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/replay.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "firmware/linux/flight_log/flight_log.hpp"

namespace jink::flightlog {
namespace {

/// The first field of two topics of one format that differs.
std::string first_difference(const ulog::Format& format, std::span<const std::byte> is, std::span<const std::byte> was)
{
    for (const ulog::Field& field : format.fields) {
        const std::size_t size = ulog::size_of_type(field.type) * field.count;
        const auto here = is.subspan(field.offset, size);
        const auto there = was.subspan(field.offset, size);
        if (!std::equal(here.begin(), here.end(), there.begin())) {
            return "jink_step." + field.name;
        }
    }
    return "jink_step";
}

}  // namespace

bool FlightReplay::refuse(std::string why)
{
    result_.refused = std::move(why);
    return false;
}

bool FlightReplay::set_up(const ulog::Reader& log)
{
    std::string why;
    const auto setup = read_setup(log, why);
    if (!setup) {
        return refuse(why);
    }
    setup_ = *setup;
    run_ = log.info("jink_run");
    if (setup_.digest != build_digest() && !options_.any_version) {
        return refuse("the log is of another version: " + setup_.version + " " + setup_.digest.substr(0, 12) +
                      ", this program is " + build_version() + " " + std::string(build_digest()).substr(0, 12) +
                      "; --any-version replays it nevertheless");
    }
    if (setup_.reach_sets != reach_sets_checksum() && !options_.any_version) {
        return refuse("the log was written with other reach sets");
    }
    if (setup_.has_cloud && !setup_.logs_cloud) {
        return refuse("the point clouds of this flight are not in the log (--log-clouds)");
    }
    if (setup_.has_key && !options_.key) {
        return refuse("the frames are signed: the key file is needed (--signing-key)");
    }
    if (setup_.map && options_.map == nullptr) {
        return refuse("a map was used: its file is needed (--map)");
    }
    if (setup_.map && options_.map->checksum != *setup_.map) {
        return refuse("the map is not the one that was used: its checksum differs");
    }
    link::mavlink::UnsignedFrames frames;
    if (!files::parse_unsigned_frames(setup_.unsigned_frames, frames)) {
        return refuse("jink_unsigned_frames is \"" + setup_.unsigned_frames + "\"");
    }
    signing_.take_unsigned(frames);
    signing_.let_keys_be_set(setup_.keys_can_be_set);
    signing_.advance_to(setup_.signing_time);
    if (setup_.has_key) {
        signing_.set_key(*options_.key, setup_.signing_time);
    }
    app::Parameters initial;
    if (initial.set_all(setup_.initial) != app::ParamStatus::ok) {
        return refuse("the parameters of the log are refused by this program");
    }
    generation_ = initial.generation();
    assembly_.emplace(setup_, initial,
                      AssemblyPorts{setup_.on_bus ? nullptr : &line_, setup_.has_bus ? &can_ : nullptr,
                                    setup_.has_cloud ? &cloud_ : nullptr},
                      watchdog_, signing_, setup_.map ? options_.map : nullptr);
    return assembly_->has_time_for_plans() || refuse("the clock of the log leaves no time for a plan");
}

/// A further file of the same run.
bool FlightReplay::may_follow(const ulog::Reader& log)
{
    return log.info("jink_run") == run_ || refuse("a file of another run: " + log.info("jink_run"));
}

bool FlightReplay::play(ulog::Reader& log)
{
    bool is_known = false;
    while (const auto message = log.next()) {
        if (message->type != ulog::Type::data) {
            continue;
        }
        if (!is_known) {
            is_known = true;
            if (!(assembly_ ? may_follow(log) : set_up(log))) {
                return false;
            }
        }
        const ulog::Format* const format = log.topic(ulog::read_number<std::uint16_t>(message->content));
        if (format != nullptr && !take(*message, *format)) {
            return false;
        }
    }
    return true;
}

bool FlightReplay::take(const ulog::Message& message, const ulog::Format& format)
{
    const std::span<const std::byte> content = message.content.subspan(2);
    if (format.name.starts_with("jink_hal_")) {
        switch (parts_.take(content)) {
        case HalParts::Taken::part: return true;
        case HalParts::Taken::record: return step(parts_.record());
        case HalParts::Taken::gap:
            result_.incomplete = result_.steps == 0 ? "the log does not begin with its first file"
                                                    : "the log has a gap: messages were dropped, or a file is missing";
            return false;
        case HalParts::Taken::bad: result_.incomplete = "the record is damaged"; return false;
        }
    }
    if (format.name == name_of_format(StepTopic::kFormat)) {
        if (content.size() != kBytesOf<StepTopic>) {
            result_.incomplete = "the step's topic has another format";
            return false;
        }
        if (!expected_ || compare(content)) {
            return true;
        }
        const auto parsed = ulog::parse_format(StepTopic::kFormat);
        result_.difference = first_difference(*parsed, content_of(*expected_), content) + " differs";
        result_.difference_step = result_.steps;
        return false;
    }
    return true;
}

bool FlightReplay::compare(std::span<const std::byte> content)
{
    StepTopic recorded;
    std::memcpy(static_cast<void*>(&recorded), content.data(), content.size());
    expected_->step = recorded.step;
    expected_->duration_us = recorded.duration_us;
    const std::span<const std::byte> wanted = content_of(*expected_);
    ++result_.reports;
    if (!std::equal(wanted.begin(), wanted.end(), content.begin())) {
        return false;
    }
    expected_.reset();
    return true;
}

bool FlightReplay::take_areas()
{
    EntryReader& reader = tape_.reader();
    const TimePoint now{reader.number<std::int64_t>()};
    const std::uint64_t count = reader.count();
    std::vector<app::Constraint> areas;
    for (std::uint64_t i = 0; i < count && reader.is_good(); ++i) {
        areas.push_back(reader.area());
    }
    if (!reader.is_good()) {
        return false;
    }
    assembly_->coprocessor().set_constraints(areas, now);
    return true;
}

bool FlightReplay::step(std::span<const std::byte> record)
{
    app::Coprocessor& coprocessor = assembly_->coprocessor();
    tape_.load(record);
    EntryReader& reader = tape_.reader();
    bool is_step = false;
    while (!is_step && !reader.empty() && reader.is_good() && tape_.difference().empty()) {
        const Entry kind = reader.kind();
        reader.pass();
        switch (kind) {
        case Entry::areas:
            if (!take_areas()) {
                tape_.differ("the closed areas of the record are damaged");
            }
            break;
        case Entry::stored: {
            const auto generation = reader.number<std::uint32_t>();
            coprocessor.note_stored(generation - setup_.generation + generation_);
            break;
        }
        case Entry::begin: {
            const TimePoint now{reader.number<std::int64_t>()};
            const app::StepReport report = coprocessor.step(now);
            expected_ = step_topic(report, now);
            is_step = true;
            break;
        }
        case Entry::shut_down:
            coprocessor.shut_down({reader.number<std::int64_t>()});
            result_.was_shut_down = true;
            is_step = true;
            break;
        default: tape_.differ("the record does not begin with a step");
        }
    }
    tape_.finish();
    result_.bytes = tape_.bytes_compared();
    if (tape_.has_lost_key()) {
        result_.incomplete = "a signing key was set over the link, and the log does not hold it";
        return false;
    }
    if (!tape_.difference().empty()) {
        result_.difference = tape_.difference();
        result_.difference_step = result_.steps;
        return false;
    }
    result_.steps += result_.was_shut_down ? 0U : 1U;
    return true;
}

}  // namespace jink::flightlog
