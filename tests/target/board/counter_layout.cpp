// SPDX-License-Identifier: BSD-3-Clause
// Offsets of an image's counters within their objects, for reading its memory from outside. Compiled for the target
// with the image's own settings, access control off, and never linked: the sizes of these arrays, less one for offsets,
// are read from the symbol table.
#include <cstddef>

#include "firmware/app/coprocessor.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "hal/cortex_m/cortex_m.hpp"
#include "hal/interrupt_serial_port.hpp"

namespace {

using jink::app::Coprocessor;
using jink::link::mavlink::Endpoint;
using jink::link::mavlink::Parser;
using Port = jink::hal::InterruptSerialPort<jink::hal::cortex_m::Pend>;

}  // namespace

extern "C" {
char jink_size_endpoint[sizeof(Endpoint)];
char jink_size_coprocessor[sizeof(Coprocessor)];

char jink_at_health[offsetof(Port, health_) + 1];
char jink_at_overruns[offsetof(Port, overruns_) + 1];
char jink_at_line_errors[offsetof(Port, line_errors_) + 1];
char jink_at_link[offsetof(Endpoint, diagnostics_) + 1];
char jink_at_parser[offsetof(Endpoint, parser_) + offsetof(Parser, diagnostics_) + 1];
char jink_at_app[offsetof(Coprocessor, diagnostics_) + 1];

char jink_size_health[sizeof(jink::hal::PortHealth)];
char jink_size_link[sizeof(jink::link::LinkDiagnostics)];
char jink_size_parser[sizeof(jink::link::mavlink::ParserDiagnostics)];
char jink_size_app[sizeof(jink::app::Diagnostics)];
}
