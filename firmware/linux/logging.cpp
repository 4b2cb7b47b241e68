// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/logging.hpp"

#include <cstring>
#include <memory>

namespace jink::host {

Logging::Logging(const LogOptions& options, const flightlog::Setup& setup, flightlog::Output* page) : options_(options)
{
    if (!options.folder.empty()) {
        flightlog::FileOptions files;
        files.folder = options.folder;
        files.file_bytes = std::uint64_t{options.file_megabytes} << 20U;
        files.files = options.files;
        writer_.emplace(files, flightlog::definitions_of(setup), std::make_unique<flightlog::PosixDisk>(),
                        setup.logs_cloud ? flightlog::Writer::kQueueBytesWithClouds : flightlog::Writer::kQueueBytes);
    }
    if (!writer_ && page == nullptr) {
        return;
    }
    flightlog::Output* output = writer_ ? &*writer_ : page;
    if (writer_ && page != nullptr) {
        output = &both_.emplace(*writer_, *page);
    }
    flightlog::FlightLog::Limits limits;
    limits.record += (setup.has_bus ? flightlog::FlightLog::Limits::kOfBus : 0U) +
                     (setup.logs_cloud ? flightlog::FlightLog::Limits::kOfClouds : 0U);
    limits.record = writer_ ? limits.record : 0U;  // the page does not show records
    log_.emplace(*output, limits, setup.stored);
}

hal::SerialPort& Logging::line(hal::SerialPort& port)
{
    return log_ ? line_.emplace(port, log_->recorder(), flightlog::Port::line) : port;
}

hal::SerialPort& Logging::cloud(hal::SerialPort& port)
{
    return log_ && options_.clouds ? cloud_.emplace(port, log_->recorder(), flightlog::Port::cloud) : port;
}

hal::CanPort& Logging::can(hal::CanPort& port) { return log_ ? can_.emplace(port, log_->recorder()) : port; }

void Logging::set_time(TimePoint now) noexcept
{
    if (writer_) {
        writer_->set_time(now.us);
    }
}

void Logging::begin(TimePoint began) noexcept
{
    set_time(began);
    if (log_) {
        log_->begin(began);
    }
}

void Logging::end(const app::StepReport& report, app::Coprocessor& coprocessor, TimePoint began, std::int64_t took_us,
                  Background& background) noexcept
{
    if (!log_) {
        return;
    }
    log_->end(report, coprocessor, began, took_us);
    if (const int error = writer_ ? writer_->take_news() : 0; error != 0) {
        background.print(Stream::error, "jinkd: " + options_.folder + ": the log is not written: " +
                                            std::strerror(error) + "; trying again every 10 s");
    }
}

void Logging::begin_shut_down(TimePoint now) noexcept
{
    set_time(now);
    if (log_) {
        log_->begin_shut_down(now);
    }
}

void Logging::end_shut_down(TimePoint now) noexcept
{
    if (log_) {
        log_->end_shut_down(now);
    }
    if (writer_) {
        static_cast<void>(writer_->finish());
    }
}

}  // namespace jink::host
