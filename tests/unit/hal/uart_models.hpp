// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace jink::hal {

/// The CMSDK APB UART: one byte of buffer each way.
struct CmsdkModel {
    std::uint32_t state = 0, control = 0, interrupts = 0, divider = 0;
    std::uint8_t received = 0;
    std::deque<std::byte> shifting;  ///< one byte at most
    std::vector<std::byte> line;     ///< sent bytes
    bool woken = false;
    bool free_running = false;  ///< a byte is sent at each read of the state, or at each `period`th
    unsigned period = 1, reads = 0;

    std::uint32_t read(std::uint32_t offset)
    {
        switch (offset) {
        case 0x00: state &= ~2U; return received;
        case 0x04:
            if (free_running && ++reads % period == 0) {
                shift_out();
            }
            return state;
        case 0x08: return control;
        case 0x0C: return interrupts | overrun_interrupt();
        case 0x10: return divider;
        default: ADD_FAILURE() << "no register at " << offset; return 0;
        }
    }
    void write(std::uint32_t offset, std::uint32_t value)
    {
        switch (offset) {
        case 0x00:
            if ((state & 1U) != 0) {
                state |= 4U;  // transmit overrun: the byte before is overwritten
                shifting.clear();
            }
            shifting.push_back(static_cast<std::byte>(value));
            state |= 1U;
            break;
        case 0x04: state &= ~(value & 0xCU); break;
        case 0x08: control = value & 0x7F; break;
        case 0x0C:
            interrupts &= ~value;
            state &= ~(value & 0xCU);
            break;
        case 0x10: divider = value & 0xFFFFF; break;
        default: ADD_FAILURE() << "no register at " << offset;
        }
    }
    [[nodiscard]] std::uint32_t overrun_interrupt() const { return state & (control >> 2U) & 0xCU; }
    void arrive(std::byte byte)
    {
        if ((control & 2U) == 0) {
            return;
        }
        state |= (state & 2U) != 0 ? 8U : 0U;
        received = std::to_integer<std::uint8_t>(byte);
        state |= 2U;
        interrupts |= (control & 8U) != 0 ? 2U : 0U;
    }
    void shift_out()
    {
        if (!shifting.empty()) {
            line.push_back(shifting.front());
            shifting.clear();
            state &= ~1U;
            interrupts |= (control & 4U) != 0 ? 1U : 0U;
        }
    }
};

/// The sending half of an STM32's USART: a shift register, and `depth` bytes behind it.
struct UsartTransmitter {
    std::uint32_t control1 = 0, divider = 0;
    std::deque<std::byte> to_shift;
    std::deque<std::byte> shifting;
    std::vector<std::byte> line;
    bool woken = false;
    bool free_running = false;  ///< a byte is sent at each read of the status, or at each `period`th
    unsigned period = 1, reads = 0;

    /// A read of the status.
    std::uint32_t space(std::size_t depth)
    {
        if (free_running && ++reads % period == 0) {
            shift_out();
        }
        return to_shift.size() < depth ? 1U << 7U : 0U;
    }
    void send(std::uint32_t value, std::size_t depth)
    {
        EXPECT_LT(to_shift.size(), depth) << "lost";
        to_shift.push_back(static_cast<std::byte>(value));
        feed_shifter();
    }
    void feed_shifter()
    {
        if (shifting.empty() && !to_shift.empty()) {
            shifting.push_back(to_shift.front());
            to_shift.pop_front();
        }
    }
    void shift_out()
    {
        if (!shifting.empty()) {
            line.push_back(shifting.front());
            shifting.clear();
        }
        feed_shifter();
    }
};

/// A USART of the STM32F4: a shift register and one byte behind it, each way.
struct UsartModel : UsartTransmitter {
    bool rxne = false, ore = false, line_error = false, read_status = false;
    std::uint8_t received = 0;

    std::uint32_t read(std::uint32_t offset)
    {
        switch (offset) {
        case 0x00:
            read_status = true;
            return (rxne ? 1U << 5U : 0U) | (ore ? 1U << 3U : 0U) | (line_error ? 2U : 0U) | space(1);
        case 0x04: {
            rxne = false;
            if (read_status) {
                ore = line_error = false;
            }
            return received;
        }
        case 0x0C: return control1;
        default: ADD_FAILURE() << "not read: " << offset; return 0;
        }
    }
    void write(std::uint32_t offset, std::uint32_t value)
    {
        switch (offset) {
        case 0x04: send(value, 1); break;
        case 0x08: divider = value; break;
        case 0x0C: control1 = value; break;
        case 0x10:
        case 0x14: EXPECT_EQ(value, 0U); break;
        default: ADD_FAILURE() << "not written: " << offset;
        }
    }
    void arrive(std::byte byte, bool damaged = false)
    {
        if ((control1 & 4U) == 0) {
            return;
        }
        if (rxne) {
            ore = true;  // the new byte is lost, the old one stays
            return;
        }
        received = std::to_integer<std::uint8_t>(byte);
        rxne = true;
        line_error = damaged;
        read_status = false;
    }
    [[nodiscard]] bool interrupt() const
    {
        return ((control1 & (1U << 5U)) != 0 && (rxne || ore)) || ((control1 & (1U << 7U)) != 0 && to_shift.empty());
    }
};

/// A USART of the STM32H7 with its FIFOs on (ST RM0433, 48.5 and 48.8): a shift register and 16 bytes behind it, each
/// way. An overrun stops the receiver until its flag is cleared. Errors of a line belong to the byte that is read next.
struct FifoUsartModel : UsartTransmitter {
    static constexpr std::size_t kDepth = 16;

    std::deque<std::pair<std::byte, bool>> received;  ///< and whether it is damaged
    bool overrun = false;

    std::uint32_t read(std::uint32_t offset)
    {
        switch (offset) {
        case 0x1C:
            return (received.empty() ? 0U : 1U << 5U) | (overrun ? 1U << 3U : 0U) |
                   (!received.empty() && received.front().second ? 2U : 0U) | space(kDepth);
        case 0x24: {
            if (received.empty()) {
                ADD_FAILURE() << "nothing is there";
                return 0;
            }
            const std::byte byte = received.front().first;
            received.pop_front();
            return std::to_integer<std::uint32_t>(byte);
        }
        default: ADD_FAILURE() << "not read: " << offset; return 0;
        }
    }
    void write(std::uint32_t offset, std::uint32_t value)
    {
        switch (offset) {
        case 0x00:
            EXPECT_TRUE((control1 & value & 1U) == 0 || ((control1 ^ value) & 1U << 29U) == 0)
                << "the FIFO, while it is on";
            control1 = value;
            break;
        case 0x0C:
            EXPECT_EQ(control1 & 1U, 0U) << "the rate, while it is on";
            divider = value;
            break;
        case 0x04:
        case 0x08: EXPECT_EQ(value, 0U); break;
        case 0x20:
            overrun = overrun && (value & 8U) == 0;
            if (!received.empty() && (value & 7U) != 0) {
                received.front().second = false;
            }
            break;
        case 0x28: send(value, kDepth); break;
        default: ADD_FAILURE() << "not written: " << offset;
        }
    }
    void arrive(std::byte byte, bool damaged = false)
    {
        constexpr std::uint32_t kReceives = 1U << 0U | 1U << 2U | 1U << 29U;
        if ((control1 & kReceives) != kReceives || overrun) {
            return;
        }
        if (received.size() == kDepth) {
            overrun = true;  // the new byte is lost, the old ones stay
            return;
        }
        received.emplace_back(byte, damaged);
    }
    [[nodiscard]] bool interrupt() const
    {
        return ((control1 & (1U << 5U)) != 0 && (!received.empty() || overrun)) ||
               ((control1 & (1U << 7U)) != 0 && to_shift.size() < kDepth);
    }
};

template <class Model>
struct By {
    Model* model;
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) const { return model->read(offset); }
    void write(std::uint32_t offset, std::uint32_t value) const { model->write(offset, value); }
};
template <class Model>
struct Waking {
    Model* model;
    void operator()() const { model->woken = true; }
};

}  // namespace jink::hal
