// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace jink::sim {

void in_parallel(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work)
{
    std::atomic<std::size_t> next{0};
    std::atomic<bool> failed{false};
    std::exception_ptr failure;
    const auto run = [&] {
        for (std::size_t i = next++; i < count && !failed; i = next++) {
            try {
                work(i);
            } catch (...) {
                if (!failed.exchange(true)) {
                    failure = std::current_exception();
                }
            }
        }
    };
    const std::size_t wanted = threads > 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
    {
        std::vector<std::jthread> workers;  // joined at the end of this scope, also when a thread cannot be started
        for (std::size_t i = 0; i < std::min(wanted, count); ++i) {
            workers.emplace_back(run);
        }
    }
    if (failure) {
        std::rethrow_exception(failure);
    }
}

}  // namespace jink::sim
