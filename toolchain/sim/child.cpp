// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/child.hpp"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

extern "C" char** environ;  // POSIX defines it without a declaration in any header

namespace jink::sim {

PseudoTerminal::PseudoTerminal() : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC))
{
    std::array<char, 64> name{};
    if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0 ||
        ::ptsname_r(master_, name.data(), name.size()) != 0) {
        throw std::runtime_error(std::string("no pseudo-terminal: ") + std::strerror(errno));
    }
    path_ = name.data();
    // Held open, so that bytes written before the program opens the terminal are neither lost nor echoed.
    slave_ = ::open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios settings{};
    if (slave_ < 0 || ::tcgetattr(slave_, &settings) != 0) {
        throw std::runtime_error(path_ + ": " + std::strerror(errno));
    }
    ::cfmakeraw(&settings);
    if (::tcsetattr(slave_, TCSANOW, &settings) != 0) {
        throw std::runtime_error(path_ + ": " + std::strerror(errno));
    }
}

PseudoTerminal::~PseudoTerminal()
{
    if (slave_ >= 0) {
        ::close(slave_);
    }
    ::close(master_);
}

std::span<const std::byte> PseudoTerminal::read()
{
    const ssize_t n = ::read(master_, buffer_.data(), buffer_.size());
    return {buffer_.data(), n > 0 ? static_cast<std::size_t>(n) : 0};
}

std::size_t PseudoTerminal::write(std::span<const std::byte> bytes)
{
    if (bytes.empty()) {
        return 0;
    }
    const ssize_t n = ::write(master_, bytes.data(), bytes.size());
    return n > 0 ? static_cast<std::size_t>(n) : 0;
}

Child::Child(const std::vector<std::string>& arguments, const std::filesystem::path& log)
{
    std::vector<char*> argv;
    for (const std::string& argument : arguments) {
        argv.push_back(const_cast<char*>(argument.c_str()));  // execv's signature; nothing writes there
    }
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    ::posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    const int error = ::posix_spawnp(&pid_, argv[0], &actions, nullptr, argv.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    if (error != 0) {
        throw std::runtime_error(arguments[0] + ": " + std::strerror(error));
    }
}

Child::~Child()
{
    if (running()) {
        ::kill(pid_, SIGKILL);
        ::waitpid(pid_, &status_, 0);
    }
}

bool Child::running()
{
    if (!ended_ && ::waitpid(pid_, &status_, WNOHANG) == pid_) {
        ended_ = true;
    }
    return !ended_;
}

Child::Threads Child::threads() const
{
    Threads threads;
    std::error_code error;
    const std::filesystem::path folder = "/proc/" + std::to_string(pid_) + "/task";
    for (std::filesystem::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
        double ran = 0.0;
        double waited = 0.0;
        std::string stat;
        if (!(std::ifstream(i->path() / "schedstat") >> ran >> waited) ||
            !std::getline(std::ifstream(i->path() / "stat"), stat)) {
            continue;  // ended meanwhile
        }
        // ID (NAME) STATE ...
        const std::size_t name_ends = stat.rfind(')');
        const bool ready = name_ends != std::string::npos && stat.compare(name_ends, 3, ") R") == 0;
        threads[static_cast<pid_t>(std::stol(stat))] = {ran * 1e-9, waited * 1e-9, ready};
    }
    return threads;
}

void Child::ask_to_stop() const { ::kill(pid_, SIGTERM); }

std::string Child::ending() const
{
    if (WIFSIGNALED(status_)) {
        return "killed by signal " + std::to_string(WTERMSIG(status_));
    }
    return WEXITSTATUS(status_) == 0 ? "" : "exit status " + std::to_string(WEXITSTATUS(status_));
}

}  // namespace jink::sim
