// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace jink::target {

/// qemu's debugger stub over a UNIX socket (gdb's Remote Serial Protocol): the subset needed to cause faults.
class Debugger {
public:
    /// @throws std::runtime_error if the socket does not accept within 10 s. Halts the processor.
    explicit Debugger(const std::string& socket_path);
    ~Debugger();
    Debugger(const Debugger&) = delete;
    Debugger& operator=(const Debugger&) = delete;

    /// Resumes the processor.
    void go();
    /// Halts the processor.
    void halt();
    void break_at(std::uint32_t address);
    void clear(std::uint32_t address);
    /// True once the processor has stopped by itself.
    [[nodiscard]] bool stopped();

    [[nodiscard]] std::vector<std::uint8_t> read(std::uint32_t address, std::size_t size);
    void write(std::uint32_t address, const std::vector<std::uint8_t>& bytes);
    void jump(std::uint32_t address);

private:
    void send(const std::string& body);
    [[nodiscard]] std::string receive(int patience_ms);
    std::string ask(const std::string& body);

    int socket_ = -1;
    std::string heard_;
};

}  // namespace jink::target
