// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/param_flash.hpp"

#include <bit>

#include "core/base/crc.hpp"

namespace jink::app {
namespace {

/// No name holds its first byte: no value's words are taken for the head of a record.
constexpr std::uint32_t kRecordMagic = 0x014B4E8A;
constexpr std::uint32_t kErasedWord = 0xFFFFFFFF;
constexpr std::uint32_t kBlock = 64;  ///< records begin at multiples of this [bytes]
static_assert(kBlock % hal::FlashRegion::kMaxUnitBytes == 0);

constexpr std::uint32_t kHeadWords = 3;
constexpr std::uint32_t kNameWords = 4;
constexpr std::uint32_t kEntryWords = kNameWords + 1;

constexpr std::uint32_t words_of(std::uint32_t entries) noexcept { return kHeadWords + entries * kEntryWords + 1U; }

constexpr std::uint32_t whole_blocks(std::uint32_t bytes) noexcept { return (bytes + kBlock - 1U) / kBlock * kBlock; }

bool differs(float a, float b) noexcept { return std::bit_cast<std::uint32_t>(a) != std::bit_cast<std::uint32_t>(b); }

std::uint32_t entries_of(const ParamValues& initial, const ParamValues& values) noexcept
{
    std::uint32_t entries = 0;
    for (std::size_t i = 0; i < kParamCount; ++i) {
        entries += differs(values[i], initial[i]) ? 1U : 0U;
    }
    return entries;
}

std::uint32_t name_word(std::string_view name, std::uint32_t index) noexcept
{
    std::uint32_t word = 0;
    for (std::uint32_t i = 0; i < 4U && 4U * index + i < name.size(); ++i) {
        word |= static_cast<std::uint32_t>(static_cast<unsigned char>(name[4U * index + i])) << (8U * i);
    }
    return word;
}

/// One copy of the loop over bits, not four unrolled ones for each word: 1 KiB less, and a record takes milliseconds.
[[gnu::noinline]] void add_byte(Crc& crc, std::uint32_t byte) noexcept { crc.add(static_cast<std::uint8_t>(byte)); }

[[gnu::noinline]] void add_word(Crc& crc, std::uint32_t word) noexcept
{
    for (std::uint32_t shift = 0; shift < 32U; shift += 8U) {
        add_byte(crc, word >> shift & 0xFFU);
    }
}

/// The words of a record, one after the other.
class RecordWords {
public:
    RecordWords(const ParamValues& initial, const ParamValues& values, std::uint32_t sequence) noexcept
        : initial_(initial), values_(values), sequence_(sequence), entries_(entries_of(initial, values))
    {
    }

    [[nodiscard]] std::uint32_t size() const noexcept { return words_of(entries_); }

    [[gnu::noinline]] std::uint32_t next() noexcept
    {
        const std::uint32_t i = at_++;
        std::uint32_t word = kRecordMagic;
        if (i == 1) {
            word = sequence_;
        } else if (i == 2) {
            word = entries_;
        } else if (i + 1U == size()) {
            return crc_.value();
        } else if (i > 2) {
            word = entry_word((i - kHeadWords) % kEntryWords);
        }
        add_word(crc_, word);
        return word;
    }

private:
    std::uint32_t entry_word(std::uint32_t part) noexcept
    {
        if (part < kNameWords) {
            while (part == 0 && !differs(values_[param_], initial_[param_])) {
                ++param_;
            }
            return name_word(param_table()[param_].name, part);
        }
        return std::bit_cast<std::uint32_t>(values_[param_++]);
    }

    const ParamValues& initial_;
    const ParamValues& values_;
    std::uint32_t sequence_;
    std::uint32_t entries_;
    std::uint32_t at_ = 0;
    std::size_t param_ = 0;
    Crc crc_;
};

}  // namespace

bool ParamFlash::is_valid(const Place& place) const noexcept
{
    const std::uint32_t most = (region_.sector_bytes() - place.offset) / 4U;
    const std::optional<std::uint32_t> entries = word(place, 2);
    if (!entries || *entries > (most - words_of(0)) / kEntryWords) {
        return false;
    }
    const std::uint32_t last = words_of(*entries) - 1U;
    Crc crc;
    for (std::uint32_t i = 0; i < last; ++i) {
        const std::optional<std::uint32_t> next = word(place, i);
        if (!next) {
            return false;
        }
        add_word(crc, *next);
    }
    return word(place, last) == crc.value();
}

/// The last valid record of a sector: records are written in their order.
bool ParamFlash::find_newest(std::uint32_t sector, Place& place, bool& damaged) const noexcept
{
    for (std::uint32_t block = region_.sector_bytes() / kBlock; block > 0; --block) {
        place = {sector, (block - 1U) * kBlock};
        const std::optional<std::uint32_t> head = word(place, 0);
        if (head == kRecordMagic && is_valid(place)) {
            return true;
        }
        damaged = damaged || !head || head == kRecordMagic;
    }
    return false;
}

/// The first block of a sector from which on all is erased, behind the newest record; its end where there is none.
std::uint32_t ParamFlash::free_from(std::uint32_t sector) const noexcept
{
    std::uint32_t end = region_.sector_bytes();
    // The newest record may end in erased words: its checksum may be one.
    const std::uint32_t used = has_newest_ && newest_.sector == sector ? newest_end_ : 0;
    while (end > used && region_.read(sector, end - 4U) == kErasedWord) {
        end -= 4U;
    }
    return whole_blocks(end);
}

ParamLoad ParamFlash::load(ParamValues& values) noexcept
{
    ParamLoad load;
    bool damaged = false;
    std::uint32_t entries = 0;
    for (std::uint32_t sector = 0; sector < hal::FlashRegion::kSectors; ++sector) {
        Place place;
        if (!find_newest(sector, place, damaged)) {
            continue;
        }
        const std::uint32_t sequence = word(place, 1).value_or(0);
        if (!has_newest_ || sequence > sequence_) {
            has_newest_ = true;
            newest_ = place;
            sequence_ = sequence;
            entries = word(place, 2).value_or(0);
            newest_end_ = place.offset + whole_blocks(4U * words_of(entries));
        }
    }
    next_ = {newest_.sector, free_from(newest_.sector)};
    if (!has_newest_) {
        load.damaged = damaged;
        return load;
    }
    for (std::uint32_t i = 0; i < entries; ++i) {
        const std::uint32_t at = kHeadWords + i * kEntryWords;
        std::array<char, 4U * kNameWords> name{};
        for (std::uint32_t k = 0; k < name.size(); ++k) {
            name[k] = static_cast<char>(word(newest_, at + k / 4U).value_or(0) >> (8U * (k % 4U)) & 0xFFU);
        }
        const std::size_t index = Parameters::find({name.data(), name.size()});
        const std::optional<std::uint32_t> value = word(newest_, at + kNameWords);
        ++load.taken;
        if (index < kParamCount && value) {
            values[index] = std::bit_cast<float>(*value);
        } else {
            ++load.unknown;
        }
    }
    return load;
}

/// Never at the cost of the newest record.
bool ParamFlash::make_room(std::uint32_t bytes) noexcept
{
    if (bytes > region_.sector_bytes()) {
        return false;
    }
    if (next_.offset + bytes <= region_.sector_bytes()) {
        return true;
    }
    const std::uint32_t other = 1U - (has_newest_ ? newest_.sector : next_.sector);
    ++diagnostics_.erases;
    if (!region_.erase(other)) {
        return false;
    }
    next_ = {other, free_from(other)};
    return next_.offset == 0;
}

bool ParamFlash::write(const ParamValues& initial, const ParamValues& values) noexcept
{
    RecordWords record(initial, values, sequence_ + 1U);
    const std::uint32_t words = record.size();
    const std::uint32_t in_unit = region_.unit_bytes() / 4U;
    if (!make_room(whole_blocks(4U * words))) {
        return false;
    }
    ++sequence_;
    for (std::uint32_t at = 0; at < words; at += in_unit) {
        std::array<std::uint32_t, hal::FlashRegion::kMaxUnitBytes / 4U> unit{};
        for (std::uint32_t i = 0; i < in_unit; ++i) {
            unit[i] = at + i < words ? record.next() : kErasedWord;
        }
        if (!region_.program(next_.sector, next_.offset + 4U * at, {unit.data(), in_unit})) {
            return false;
        }
    }
    if (!is_valid(next_)) {
        return false;
    }
    has_newest_ = true;
    newest_ = next_;
    next_.offset += whole_blocks(4U * words);
    newest_end_ = next_.offset;
    return true;
}

bool ParamFlash::is_newest(const ParamValues& initial, const ParamValues& values) const noexcept
{
    RecordWords record(initial, values, word(newest_, 1).value_or(0));
    const std::uint32_t size = record.size();
    std::uint32_t same = 0;
    while (same < size && word(newest_, same) == record.next()) {
        ++same;
    }
    return same == size;
}

bool ParamFlash::save(const ParamValues& initial, const ParamValues& values) noexcept
{
    if (has_newest_ && is_newest(initial, values)) {
        return true;
    }
    if (write(initial, values)) {
        ++diagnostics_.writes;
        return true;
    }
    ++diagnostics_.failures;
    next_.offset = free_from(next_.sector);
    return false;
}

}  // namespace jink::app
