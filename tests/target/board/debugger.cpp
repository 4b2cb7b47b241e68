// SPDX-License-Identifier: BSD-3-Clause
#include "tests/target/board/debugger.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <thread>

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace jink::target {
namespace {

constexpr int kPatience = 10'000;  // [ms]

std::string hex(std::uint32_t value)
{
    std::array<char, 9> text{};
    std::snprintf(text.data(), text.size(), "%x", value);
    return text.data();
}

}  // namespace

Debugger::Debugger(const std::string& socket_path) : socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0))
{
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, socket_path.c_str(), sizeof address.sun_path - 1);
    for (int i = 0; ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0; ++i) {
        if (i >= 500) {
            throw std::runtime_error("no debugger at " + socket_path);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    static_cast<void>(ask("?"));
    static_cast<void>(ask("qXfer:features:read:target.xml:0,ff0"));  // or it lets no single register be written
}

Debugger::~Debugger() { ::close(socket_); }

void Debugger::send(const std::string& body)
{
    unsigned sum = 0;
    for (const char c : body) {
        sum += static_cast<unsigned char>(c);
    }
    std::array<char, 4> tail{};
    std::snprintf(tail.data(), tail.size(), "#%02x", sum & 0xFFU);
    std::string packet("$");
    packet.append(body).append(tail.data());
    if (::write(socket_, packet.data(), packet.size()) != static_cast<ssize_t>(packet.size())) {
        throw std::runtime_error("the debugger is gone");
    }
}

/// The next packet's body; empty where none comes in time.
std::string Debugger::receive(int patience_ms)
{
    for (;;) {
        const std::size_t begin = heard_.find('$');
        const std::size_t end = begin == std::string::npos ? begin : heard_.find('#', begin);
        if (end != std::string::npos && heard_.size() >= end + 3) {
            const std::string body = heard_.substr(begin + 1, end - begin - 1);
            heard_.erase(0, end + 3);
            static_cast<void>(::write(socket_, "+", 1));
            return body;
        }
        pollfd waiting{socket_, POLLIN, 0};
        if (::poll(&waiting, 1, patience_ms) <= 0) {
            return {};
        }
        std::array<char, 4096> bytes{};
        const ssize_t n = ::read(socket_, bytes.data(), bytes.size());
        if (n <= 0) {
            throw std::runtime_error("the debugger is gone");
        }
        heard_.append(bytes.data(), static_cast<std::size_t>(n));
    }
}

std::string Debugger::ask(const std::string& body)
{
    send(body);
    const std::string answer = receive(kPatience);
    if (answer.empty() || answer[0] == 'E') {
        throw std::runtime_error("the debugger does not do " + body.substr(0, 20) + ": " + answer);
    }
    return answer;
}

void Debugger::go() { send("c"); }

void Debugger::halt()
{
    static_cast<void>(::write(socket_, "\x03", 1));
    if (receive(kPatience).empty()) {
        throw std::runtime_error("the processor does not stop");
    }
}

bool Debugger::stopped() { return !receive(0).empty(); }

void Debugger::break_at(std::uint32_t address)
{
    static_cast<void>(ask(std::string("Z0,").append(hex(address)).append(",2")));
}

void Debugger::clear(std::uint32_t address)
{
    static_cast<void>(ask(std::string("z0,").append(hex(address)).append(",2")));
}

std::vector<std::uint8_t> Debugger::read(std::uint32_t address, std::size_t size)
{
    constexpr std::size_t kPiece = 1024;
    std::vector<std::uint8_t> bytes;
    while (bytes.size() < size) {
        const std::size_t n = std::min(kPiece, size - bytes.size());
        const std::uint32_t from = address + static_cast<std::uint32_t>(bytes.size());
        const std::string text =
            ask(std::string("m").append(hex(from)).append(",").append(hex(static_cast<std::uint32_t>(n))));
        for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
            bytes.push_back(static_cast<std::uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16)));
        }
    }
    return bytes;
}

void Debugger::write(std::uint32_t address, const std::vector<std::uint8_t>& bytes)
{
    std::string text("M");
    text.append(hex(address)).append(",").append(hex(static_cast<std::uint32_t>(bytes.size()))).append(":");
    for (const std::uint8_t byte : bytes) {
        std::array<char, 3> digits{};
        std::snprintf(digits.data(), digits.size(), "%02x", byte);
        text += digits.data();
    }
    static_cast<void>(ask(text));
}

/// Register 15, little-endian on the wire.
void Debugger::jump(std::uint32_t address)
{
    std::array<char, 9> digits{};
    std::snprintf(digits.data(), digits.size(), "%02x%02x%02x%02x", address & 0xFFU, address >> 8U & 0xFFU,
                  address >> 16U & 0xFFU, address >> 24U);
    static_cast<void>(ask(std::string("Pf=").append(digits.data())));
}

}  // namespace jink::target
