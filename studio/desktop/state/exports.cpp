#include "studio/desktop/state/exports.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cases/engine.h"
#include "cases/export_files.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/table.h"
#include "core/text.h"
#include "surrogates/tables/exports/export.h"

namespace underbody::studio {

namespace {

using nlohmann::json;

/// What the exports of `study run` say of their result, where the store holds it as it is.
std::string origin_of(const Session& session, const cases::TableSpec& spec) {
    const std::string* known = session.results.document("table/" + spec.name);
    if (known == nullptr || session.results.store == nullptr) {
        return {};
    }
    json document = json::parse(*known);
    document.erase("exports");  // put there as it comes out of the store
    if (document.value("points", "") != core::write_csv(cases::table_points(spec, session.results))) {
        return {};
    }
    std::vector<cases::StoredResult> stored;
    session.results.store->for_each_result([&](const cases::Store::Texts& one) {
        if (one.kind == "table" && one.name == spec.name) {
            stored.push_back(one.result());
        }
    });
    for (auto one = stored.rbegin(); one != stored.rend(); ++one) {
        const auto value = session.results.store->value(one->id);
        if (value && json::parse(*value) == document) {
            return cases::Made{one->kind, one->name, one->id, one->identity(), {}}.origin_line();
        }
    }
    return {};
}

}  // namespace

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
    const auto points = cases::table_points(*spec, session.results);
    tables::FitOptions fit = cases::fit_options(*spec);
    auto fitted = tables::ForceTable::fit(points, spec->quantity, fit);
    tables::ExportOptions options;
    if (const std::string origin = origin_of(session, *spec); !origin.empty()) {
        options.provenance = {origin};
    }
    for (const auto& axis : fitted.axes()) {
        const auto at = record.range.find(axis.name);
        const auto known = at == record.range.end() ? std::nullopt : tables::range_policy(at->second);
        if (known && *known != axis.range) {
            fit.range.named.emplace_back(axis.name, *known);
            options.provenance.clear();  // another fit than that of the study
        }
    }
    if (!fit.range.named.empty()) {
        fitted = tables::ForceTable::fit(points, spec->quantity, fit);
    }
    options.name = record.name;
    options.frame = record.frame == "ned" ? tables::Frame::ned : tables::Frame::up;
    options.single_precision = record.number == "float";
    if (record.max_error) {
        options.max_error = *record.max_error;
    }
    options.overwrite = true;  // it is this file that is made again
    tables::export_table(fitted, record.format, file, options, progress);
}

std::string TableOfStudy::line(const Words& words) const {
    return (first.empty() ? "" : first + " && ") + line_of(words) + (before.empty() ? "" : "  # " + before);
}

TableOfStudy table_of_study(const Session& session, const std::string& table) {
    TableOfStudy found;
    const auto* spec = session.study.find_table(table);
    if (spec == nullptr) {
        return found;
    }
    found.name = table;
    found.origin = origin_of(session, *spec);
    const auto exported = [&](const std::string& format) {
        return std::find(spec->exports.begin(), spec->exports.end(), format) != spec->exports.end();
    };
    const std::string format = !exported("csv") && exported("json") ? "json" : "csv";  // both are read back exactly
    const auto file = session.folder / "report" / "exports" / cases::export_file(table, format);
    found.file = file.string();
    if (!exported(format)) {
        found.before = "with \"csv\" among the exports of [[table]] '" + table + "' in study.toml";
    }
    std::error_code none;
    if (found.origin.empty() || !std::filesystem::is_regular_file(file, none) ||
        core::read_file(file).find(found.origin) == std::string::npos) {
        found.first = line_of({"underbody", "study", "run", session.folder.string()});
    } else {
        found.before.clear();
    }
    return found;
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
