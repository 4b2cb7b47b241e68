// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace jink::mpi {

/// The processes of an MPI run that share work out among themselves. One object per process, made first and gone last;
/// one thread uses it. Calls marked "together" are made by every process, in the same order.
class Crew {
public:
    Crew(int& argc, char**& argv);
    Crew(const Crew&) = delete;
    Crew& operator=(const Crew&) = delete;
    ~Crew();

    [[nodiscard]] bool leads() const noexcept { return rank_ == 0; }
    [[nodiscard]] int size() const noexcept { return size_; }

    /// Together: everybody gets the leader's.
    void share(std::vector<std::uint64_t>& values) const;
    void share(std::string& text) const;

    /// Together: numbers given out by next() begin at 0 again.
    void begin_count();
    /// The next number that nobody got before. The counter lies with the leader, who need not attend to it: the asker
    /// raises it himself (MPI_Fetch_and_op).
    [[nodiscard]] std::uint64_t next();
    /// Lets messages of others through, where the network needs the processor for that. Call it now and then.
    void attend() const;

    /// Together: everybody has come here.
    void meet() const;
    /// Together: the leader gets everybody's pieces, process by process in order; the others get nothing.
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
