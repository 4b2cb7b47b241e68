// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

namespace jink::sim {

/// Calls `work(i)` once for each i in [0, count), in parallel; the calls begin in the order of i. Returns after all
/// calls have ended.
///
/// @param threads  0: one to a core. No more than `count` threads are started.
/// @param work     called from several threads at once
///
/// If a call throws, no further call begins, and the first exception is thrown on here after the others have ended.
void in_parallel(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work);

}  // namespace jink::sim
