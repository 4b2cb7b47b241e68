// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace jink::test {

/// A child process with a socket on its file descriptor 3 and its standard output on a pipe.
class PeerProcess {
public:
    /// Starts `command` (looked up in PATH) in `directory`; throws std::runtime_error when that fails.
    PeerProcess(const std::vector<std::string>& command, const std::string& directory);
    ~PeerProcess();
    PeerProcess(const PeerProcess&) = delete;
    PeerProcess& operator=(const PeerProcess&) = delete;

    /// Writes all of `bytes` to the socket; false when the peer has gone.
    bool send(std::span<const std::byte> bytes) const;
    /// Signals the end of the data to the peer.
    void finish_sending() const;
    /// Bytes received on the socket, blocks until some arrive; empty at its end.
    [[nodiscard]] std::vector<std::byte> receive() const;
    /// The peer's whole output, up to the end.
    [[nodiscard]] std::string read_output() const;
    /// Waits for the end of the process. @return its exit code, -1 when a signal ended it
    int wait();

private:
    int socket_ = -1;
    int output_ = -1;
    pid_t child_ = -1;
};

}  // namespace jink::test
