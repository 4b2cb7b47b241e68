// SPDX-License-Identifier: BSD-3-Clause
// Where an image's counters lie within the objects that hold them, for who reads its memory from outside. Compiled for
// the target with the image's own settings, access control off, and linked into nothing: the sizes of these arrays are
// the answer, less one for offsets, and the list of symbols tells them.
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
