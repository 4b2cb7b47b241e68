// SPDX-License-Identifier: BSD-3-Clause
#include "tests/peer/peer_process.hpp"

#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace jink::test {

PeerProcess::PeerProcess(const std::vector<std::string>& command, const std::string& directory)
{
    int sockets[2];
    int pipes[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0 || ::pipe2(pipes, O_CLOEXEC) != 0) {
        throw std::runtime_error("no socket or pipe for the peer");
    }
    std::vector<char*> arguments;
    for (const std::string& word : command) {
        arguments.push_back(const_cast<char*>(word.c_str()));
    }
    arguments.push_back(nullptr);
    child_ = ::fork();
    if (child_ < 0) {
        throw std::runtime_error("cannot fork");
    }
    if (child_ == 0) {
        // Copies first, so that neither target overwrites the other source; dup2 drops close-on-exec.
        const int socket_copy = ::fcntl(sockets[1], F_DUPFD_CLOEXEC, 10);
        const int output_copy = ::fcntl(pipes[1], F_DUPFD_CLOEXEC, 10);
        if (::chdir(directory.c_str()) == 0 && ::dup2(socket_copy, 3) == 3 && ::dup2(output_copy, 1) == 1) {
            ::execvp(arguments[0], arguments.data());
        }
        ::_exit(127);
    }
    ::close(sockets[1]);
    ::close(pipes[1]);
    socket_ = sockets[0];
    output_ = pipes[0];
}

PeerProcess::~PeerProcess()
{
    ::close(socket_);
    ::close(output_);
    if (child_ > 0) {
        ::kill(child_, SIGKILL);
        ::waitpid(child_, nullptr, 0);
    }
}

bool PeerProcess::send(std::span<const std::byte> bytes) const
{
    while (!bytes.empty()) {
        const ssize_t n = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (n <= 0) {
            return false;
        }
        bytes = bytes.subspan(static_cast<std::size_t>(n));
    }
    return true;
}

void PeerProcess::finish_sending() const { ::shutdown(socket_, SHUT_WR); }

std::vector<std::byte> PeerProcess::receive() const
{
    std::vector<std::byte> bytes(4096);
    const ssize_t n = ::recv(socket_, bytes.data(), bytes.size(), 0);
    bytes.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    return bytes;
}

std::string PeerProcess::read_output() const
{
    std::string all;
    char piece[65536];
    for (;;) {
        const ssize_t n = ::read(output_, piece, sizeof piece);
        if (n <= 0) {
            return all;
        }
        all.append(piece, static_cast<std::size_t>(n));
    }
}

int PeerProcess::wait()
{
    int status = 0;
    ::waitpid(child_, &status, 0);
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace jink::test
