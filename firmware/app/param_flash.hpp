// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/app/parameters.hpp"
#include "hal/flash_region.hpp"

namespace jink::app {

/// What load() found.
struct ParamLoad {
    std::uint16_t taken = 0;    ///< values of the newest record
    std::uint16_t unknown = 0;  ///< of them names that there are no more
    bool damaged = false;       ///< there are records, and none has the right checksum
};

struct ParamFlashDiagnostics {
    std::uint32_t writes = 0;
    std::uint32_t erases = 0;
    std::uint32_t failures = 0;  ///< of either: what was to be kept is not
};

/// Parameters in two sectors of flash, as jinkd's state file holds them: by name, those that differ from the image's
/// own, with a checksum over all.
///
/// Records follow one another in a sector, each whole; the newest one with the right checksum counts. Where the next
/// one does not fit, the sector that does not hold the newest record is erased and goes on. So a power cut at any unit
/// of a write or an erase leaves the values before the change or those after it, and a damaged record leaves those
/// before it; the sector before holds what was in force when it became full. An unreadable unit counts as damaged, and
/// as used.
///
/// Record, in words, from a multiple of 64 bytes on: magic, sequence number, number of values n; n times name (16
/// bytes, filled up with zeros) and value (float); CRC-32 of all before; erased words up to a whole unit of the flash.
/// 36 bytes for one value that differs, 1236 for 61: 2048 to 102 changes in a sector of 128 KiB. The layout is the same
/// for every size of unit.
///
/// Memory: 44 bytes. Reading is O(sector bytes); save() the same when it fails or needs the other sector, else
/// O(record).
class ParamFlash {
public:
    /// @param region  outlives this; sectors are multiples of 64 bytes, and hold a record of all parameters, else
    ///                save() fails
    explicit ParamFlash(hal::FlashRegion& region) noexcept : region_(region) {}

    /// Puts the values of the newest record into `values`. They are not judged: anything that a float holds may be
    /// among them. To be called before save().
    ParamLoad load(ParamValues& values) noexcept;

    /// Keeps `values` as far as they differ from `initial`. True: load() finds them from now on. Nothing is written
    /// where they are the newest record's. May erase.
    [[nodiscard]] bool save(const ParamValues& initial, const ParamValues& values) noexcept;

    [[nodiscard]] const ParamFlashDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    struct Place {
        std::uint32_t sector = 0;
        std::uint32_t offset = 0;
    };

    [[nodiscard]] std::optional<std::uint32_t> word(const Place& place, std::uint32_t index) const noexcept
    {
        return region_.read(place.sector, place.offset + 4U * index);
    }
    [[nodiscard]] bool is_valid(const Place& place) const noexcept;
    [[nodiscard]] bool find_newest(std::uint32_t sector, Place& place, bool& damaged) const noexcept;
    [[nodiscard]] std::uint32_t free_from(std::uint32_t sector) const noexcept;
    [[nodiscard]] bool is_newest(const ParamValues& initial, const ParamValues& values) const noexcept;
    [[nodiscard]] bool make_room(std::uint32_t bytes) noexcept;
    [[nodiscard]] bool write(const ParamValues& initial, const ParamValues& values) noexcept;

    hal::FlashRegion& region_;
    bool has_newest_ = false;
    Place newest_;
    std::uint32_t newest_end_ = 0;  ///< offset of the first block behind it
    Place next_;                    ///< all from here on in its sector is erased
    std::uint32_t sequence_ = 0;
    ParamFlashDiagnostics diagnostics_;
};

}  // namespace jink::app
