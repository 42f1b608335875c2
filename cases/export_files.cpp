#include "cases/export_files.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/hash.h"
#include "surrogates/tables/exports/export.h"

namespace underbody::cases {

std::string export_name(std::string table) {
    std::replace_if(
        table.begin(), table.end(), [](char c) { return c == ' ' || c == ',' || c == '/'; }, '_');
    constexpr std::size_t most = 120;  // file systems take 255 bytes, with what other names add to it
    if (table.size() > most) {
        std::size_t cut = most - 9;
        while (cut > 0 && (static_cast<unsigned char>(table[cut]) & 0xC0U) == 0x80U) {
            --cut;  // no half of a letter
        }
        table = table.substr(0, cut) + "_" + core::content_hash(table).substr(0, 8);
    }
    return table;
}

std::string export_file(const std::string& table, const std::string& format) {
    std::vector<std::string> known;
    const auto& formats = tables::export_formats();
    for (const auto& candidate : formats) {
        if (candidate.name == format) {
            const auto first = std::find_if(formats.begin(), formats.end(),
                                            [&](const auto& other) { return other.ending == candidate.ending; });
            return export_name(table) + (first->name == format ? "" : "_" + format) + candidate.ending;
        }
        known.push_back(candidate.name);
    }
    throw core::InputError("name", "unknown export format '" + format + "'", {}, core::did_you_mean(format, known));
}

std::vector<std::pair<std::string, std::string_view>> exported_files(std::string_view value) {
    std::vector<std::pair<std::string, std::string_view>> files;
    const std::size_t line = value.find('\n');
    std::size_t at = line + 1;
    for (const auto& one : nlohmann::json::parse(value.substr(0, line))) {
        const auto size = one.at("size").get<std::size_t>();
        files.emplace_back(one.at("file").get<std::string>(), value.substr(at, size));
        at += size;
    }
    return files;
}

}  // namespace underbody::cases
