// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace jink::mpi {

/// Work sharing between the processes of an MPI run. One object per process, created first and destroyed last, used by
/// one thread. Calls marked "together" (collective) are made by every process, in the same order.
class Crew {
public:
    Crew(int& argc, char**& argv);
    Crew(const Crew&) = delete;
    Crew& operator=(const Crew&) = delete;
    ~Crew();

    [[nodiscard]] bool leads() const noexcept { return rank_ == 0; }
    [[nodiscard]] int size() const noexcept { return size_; }

    /// Together: every process gets the leader's values.
    void share(std::vector<std::uint64_t>& values) const;
    void share(std::string& text) const;

    /// Together: restarts the numbers of next() at 0.
    void begin_count();
    /// The next unused number. The counter is in the leader's memory; the calling process increments it without the
    /// leader's participation (MPI_Fetch_and_op).
    [[nodiscard]] std::uint64_t next();
    /// Progresses other processes' messages, where the network needs the processor. Call regularly.
    void attend() const;

    /// Together: barrier.
    void meet() const;
    /// Together: the leader gets all pieces in the order of the processes; other processes get an empty list.
    [[nodiscard]] std::vector<std::string> gather(const std::vector<std::string>& pieces) const;

    /// Ends all processes.
    [[noreturn]] void abandon(int status) const;

private:
    struct Counter;
    int rank_ = 0;
    int size_ = 1;
    std::unique_ptr<Counter> counter_;
};

}  // namespace jink::mpi
