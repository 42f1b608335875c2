#include "studio/desktop/state/exports.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cases/accept.h"
#include "cases/engine.h"
#include "cases/export_files.h"
#include "cases/found_force.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/table.h"
#include "core/text.h"

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

std::optional<cases::FoundForce> found_of(const Session& session, const cases::TableSpec& spec) {
    return cases::found_force(session.study, session.results, spec, session.accepted);
}

const cases::TableSpec& needed_table(const Session& session, const std::string& table) {
    const auto* spec = session.study.find_table(table);
    if (spec == nullptr) {
        throw core::InputError("missing", "the study has no table '" + table + "' any more");
    }
    return *spec;
}

/// Those policies that are not the ones of the table.
tables::RangePolicies other_policies(const tables::ForceTable& table, const std::map<std::string, std::string>& range) {
    tables::RangePolicies others;
    for (const auto& axis : table.axes()) {
        const auto at = range.find(axis.name);
        const auto known = at == range.end() ? std::nullopt : tables::range_policy(at->second);
        if (known && *known != axis.range) {
            others.named.emplace_back(axis.name, *known);
        }
    }
    return others;
}

}  // namespace

std::string table_digest(const Session& session, const std::string& table) {
    const auto* spec = session.study.find_table(table);
    if (spec == nullptr) {
        return {};
    }
    try {
        const auto found = found_of(session, *spec);
        return core::content_hash(spec->fit + "\n" + core::write_csv(cases::table_points(*spec, session.results)) +
                                  (found ? "\n" + found->digest : ""));
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

std::vector<std::string> marked_tables(const State& state, const Session& session) {
    std::vector<std::string> marked;
    for (const auto& spec : session.study.tables) {
        const std::string id = "table/" + spec.name;
        if (state.stars.contains(id) ||
            std::find(state.selection.begin(), state.selection.end(), id) != state.selection.end()) {
            marked.push_back(spec.name);
        }
    }
    return marked;
}

std::vector<std::string> foreign_files(const State& state, const std::vector<std::string>& files) {
    std::vector<std::string> foreign;
    for (const auto& file : files) {
        const auto known = state.exports.find(file);
        if (std::filesystem::exists(file) && (known == state.exports.end() || known->second.written.empty() ||
                                              core::content_hash(core::read_file(file)) != known->second.written)) {
            foreign.push_back(file);
        }
    }
    return foreign;
}

tables::ForceTable exported_table(const Session& session, const std::string& table,
                                  const std::map<std::string, std::string>& range, core::Progress& progress) {
    const auto& spec = needed_table(session, table);
    if (const auto found = found_of(session, spec)) {
        const auto made = cases::table_of_found(*found, spec, {}, progress);
        const auto others = other_policies(made, range);
        return others.named.empty() ? made : cases::table_of_found(*found, spec, others, progress);
    }
    const auto points = cases::table_points(spec, session.results);
    tables::FitOptions fit = cases::fit_options(spec);
    auto fitted = tables::ForceTable::fit(points, spec.quantity, fit);
    const auto others = other_policies(fitted, range);
    if (!others.named.empty()) {
        fit.range.named.insert(fit.range.named.end(), others.named.begin(), others.named.end());
        fitted = tables::ForceTable::fit(points, spec.quantity, fit);
    }
    return fitted;
}

tables::ExportOptions options_of(const ExportRecord& record) {
    tables::ExportOptions options;
    options.name = record.name;
    options.frame = record.frame == "ned" ? tables::Frame::ned : tables::Frame::up;
    options.single_precision = record.number == "float";
    options.max_error = record.max_error.value_or(0);
    options.overwrite = true;  // it is this file that is made again
    return options;
}

ExportRecord export_again(const Session& session, const std::string& file, ExportRecord record,
                          core::Progress& progress) {
    tables::ExportOptions options = options_of(record);
    const auto as_fitted = exported_table(session, record.table, {}, progress);
    const bool as_the_study = other_policies(as_fitted, record.range).named.empty();
    const TableOfStudy of = table_of_study(session, record.table);
    if (!of.found.empty()) {
        options.provenance = {of.found_line()};
    } else if (as_the_study && !of.origin.empty()) {
        options.provenance = {of.origin};
    }
    const auto table = as_the_study ? as_fitted : exported_table(session, record.table, record.range, progress);
    tables::export_table(table, record.format, file, options, progress);
    record.made_of = table_digest(session, record.table);
    record.written = core::content_hash(core::read_file(file));
    return record;
}

std::string TableOfStudy::found_line() const { return "With " + found; }

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
    if (const auto force = found_of(session, *spec)) {
        const auto written = session.folder / cases::accepted_model(force->measurement);
        found.file = written.string();
        found.found = force->effects + ", found of '" + force->measurement + "'";
        if (session.accepted.contains(force->measurement)) {
            found.first = line_of({"underbody", "study", "accept", session.folder.string(), force->measurement});
        }
        for (const auto& axis : spec->axes) {
            found.axes += (found.axes.empty() ? "" : ",") + axis;
        }
        return found;
    }
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

Words TableOfStudy::command(const std::string& quantity, const std::string& file_to_write,
                            const ExportRecord& record) const {
    Words words = {"underbody",   "export",   file.empty() ? "TABLE.csv" : file,
                   "--quantity",  quantity,   "--format",
                   record.format, "--out",    file_to_write,
                   "--name",      record.name};
    const auto add = [&words](const char* option, const std::string& value) {
        words.insert(words.end(), {option, value});
    };
    if (!axes.empty()) {
        add("--axes", axes);
    }
    if (record.frame != "up") {
        add("--frame", record.frame);
    }
    if (record.number != "double") {
        add("--number", record.number);
    }
    if (record.max_error) {
        add("--max-error", core::format_number(100 * *record.max_error, 12) + "%");
    }
    std::string range;
    for (const auto& [axis, policy] : record.range) {
        range += (range.empty() ? "" : ",") + axis + "=" + policy;
    }
    if (!range.empty()) {
        add("--range", range);
    }
    return words;
}

Words words_of_exports(const ExportedFiles& files) {
    Words words = {"exported"};
    for (const auto& [file, record] : files) {
        if (words.size() > 1) {
            words.emplace_back("and");
        }
        words.insert(words.end(), {file, record.table, "made_of=" + record.made_of, "written=" + record.written,
                                   "format=" + record.format, "name=" + record.name, "frame=" + record.frame,
                                   "number=" + record.number});
        if (record.max_error) {
            words.push_back("max_error=" + core::format_number(*record.max_error));
        }
        for (const auto& [axis, policy] : record.range) {
            words.push_back("range." + axis + "=" + policy);
        }
    }
    return words;
}

Words words_of_export(const std::string& file, const ExportRecord& record) {
    return words_of_exports({{file, record}});
}

std::vector<Words> split_exports(const Words& words) {
    std::vector<Words> all(1);
    for (const auto& word : words) {
        if (word == "and" && !all.back().empty()) {
            all.emplace_back();
        } else {
            all.back().push_back(word);
        }
    }
    return all;
}

}  // namespace underbody::studio
