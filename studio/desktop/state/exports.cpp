#include "studio/desktop/state/exports.h"

#include "core/file.h"
#include "core/hash.h"
#include "core/table.h"
#include "core/text.h"
#include "surrogates/tables/exports/export.h"

namespace underbody::studio {

std::string table_digest(const Session& session, const std::string& table) {
    const auto* spec = session.study.find_table(table);
    if (spec == nullptr) {
        return {};
    }
    try {
        return core::content_hash(spec->fit + "\n" + core::write_csv(cases::table_points(*spec, session.results)));
    } catch (const core::InputError&) {  // its own step says why
        return {};
    }
}

ExportState state_of(const Session& session, const std::string& file, const ExportRecord& record) {
    if (!std::filesystem::exists(file)) {
        return ExportState::missing;
    }
    return table_digest(session, record.table) == record.made_of ? ExportState::as_now : ExportState::stale;
}

std::vector<std::string> stale_exports(const State& state, const Session& session) {
    std::vector<std::string> stale;
    for (const auto& [file, record] : state.exports) {
        if (state_of(session, file, record) != ExportState::as_now) {
            stale.push_back(file);
        }
    }
    return stale;
}

void export_again(const Session& session, const std::string& file, const ExportRecord& record,
                  core::Progress& progress) {
    const auto* spec = session.study.find_table(record.table);
    if (spec == nullptr) {
        throw core::InputError("missing", "the study has no table '" + record.table + "' any more", {file, {}, {}, {}});
    }
    tables::FitOptions fit = cases::fit_options(*spec);
    for (const auto& [axis, policy] : record.range) {
        if (const auto known = tables::range_policy(policy)) {
            fit.range.named.emplace_back(axis, *known);
        }
    }
    tables::ExportOptions options;
    options.name = record.name;
    options.frame = record.frame == "ned" ? tables::Frame::ned : tables::Frame::up;
    options.single_precision = record.number == "float";
    if (record.max_error) {
        options.max_error = *record.max_error;
    }
    options.overwrite = true;  // it is this file that is made again
    tables::export_table(tables::ForceTable::fit(cases::table_points(*spec, session.results), spec->quantity, fit),
                         record.format, file, options, progress);
}

std::string table_file(const State& state, const std::string& table) {
    return state.study.empty() ? std::string() : state.study + "/report/exports/" + table + ".csv";
}

Words words_of_export(const std::string& file, const ExportRecord& record) {
    Words words = {"exported",
                   file,
                   record.table,
                   "made_of=" + record.made_of,
                   "format=" + record.format,
                   "name=" + record.name,
                   "frame=" + record.frame,
                   "number=" + record.number};
    if (record.max_error) {
        words.push_back("max_error=" + core::format_number(*record.max_error));
    }
    for (const auto& [axis, policy] : record.range) {
        words.push_back("range." + axis + "=" + policy);
    }
    return words;
}

}  // namespace underbody::studio
