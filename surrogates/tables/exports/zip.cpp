#include "surrogates/tables/exports/zip.h"

#include <zlib.h>

#include <cstdint>

namespace underbody::tables {

namespace {

void put(std::string& out, std::uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) {
        out += static_cast<char>(value >> (8 * i) & 0xff);
    }
}

constexpr std::uint32_t first_day = 1U << 5 | 1U;  // 1980-01-01

}  // namespace

std::string zip_archive(const std::vector<std::pair<std::string, std::string>>& entries, const std::string& comment) {
    std::string archive;
    std::string directory;
    for (const auto& [name, content] : entries) {
        const auto checksum = static_cast<std::uint32_t>(
            ::crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size())));
        const auto size = static_cast<std::uint32_t>(content.size());
        std::string common;
        put(common, 20, 2);
        put(common, 0, 2);
        put(common, 0, 2);  // stored
        put(common, 0, 2);
        put(common, first_day, 2);
        put(common, checksum, 4);
        put(common, size, 4);
        put(common, size, 4);
        put(common, static_cast<std::uint32_t>(name.size()), 2);
        put(common, 0, 2);
        const auto offset = static_cast<std::uint32_t>(archive.size());
        put(archive, 0x04034b50, 4);
        archive += common + name + content;
        put(directory, 0x02014b50, 4);
        put(directory, 3U << 8 | 20U, 2);  // made on Unix
        directory += common;
        put(directory, 0, 2);
        put(directory, 0, 2);
        put(directory, 0, 2);
        put(directory, (name.ends_with(".so") ? 0100755U : 0100644U) << 16, 4);
        put(directory, offset, 4);
        directory += name;
    }
    const auto start = static_cast<std::uint32_t>(archive.size());
    archive += directory;
    put(archive, 0x06054b50, 4);
    put(archive, 0, 2);
    put(archive, 0, 2);
    put(archive, static_cast<std::uint32_t>(entries.size()), 2);
    put(archive, static_cast<std::uint32_t>(entries.size()), 2);
    put(archive, static_cast<std::uint32_t>(directory.size()), 4);
    put(archive, start, 4);
    put(archive, static_cast<std::uint32_t>(comment.size()), 2);
    return archive + comment;
}

}  // namespace underbody::tables
