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

/// Size and time of the files of the models that may change a force: a study's own that was written meanwhile counts.
std::string stamp_of(const Session& session) {
    namespace fs = std::filesystem;
    std::string stamp;
    for (const auto& one : session.study.measurements) {
        if (!session.accepted.contains(one.name) &&
            !cases::same_place(one.model, session.study.folder() / cases::accepted_model(one.name))) {
            continue;
        }
        std::vector<std::string> files;
        std::error_code none;
        for (const auto& entry : fs::directory_iterator(one.model.parent_path(), none)) {
            files.push_back(entry.path().string() + " " + std::to_string(entry.file_size(none)) + " " +
                            std::to_string(entry.last_write_time(none).time_since_epoch().count()) + "\n");
        }
        std::sort(files.begin(), files.end());
        stamp += one.name + "\n";
        for (const auto& file : files) {
            stamp += file;
        }
    }
    return stamp;
}

KnownForces::Known known_of(const Session& session, const cases::TableSpec& spec) {
    const std::string stamp = stamp_of(session);
    if (const auto known = session.known_forces.of(spec.name, stamp)) {
        return *known;
    }
    KnownForces::Known known{stamp, cases::found_force(session.study, session.results, spec, session.accepted), {}};
    try {
        known.digest =
            core::content_hash(spec.fit + "\n" + core::write_csv(cases::table_points(spec, session.results)) +
                               (known.found ? "\n" + known.found->digest : ""));
    } catch (const core::InputError&) {  // its own step says why
    }
    session.known_forces.keep(spec.name, known);
    return known;
}

std::optional<cases::FoundForce> found_of(const Session& session, const cases::TableSpec& spec) {
    return known_of(session, spec).found;
}

const cases::TableSpec& needed_table(const Session& session, const std::string& table) {
    const auto* spec = session.study.find_table(table);
    if (spec == nullptr) {
        throw core::InputError("missing", "the study has no table '" + table + "' any more");
    }
    return *spec;
}

/// The policies of the table's axes among these.
tables::RangePolicies policies_of(const cases::TableSpec& spec, const std::map<std::string, std::string>& range) {
    tables::RangePolicies policies;
    for (const auto& axis : spec.axes) {
        const auto at = range.find(axis);
        if (const auto known = at == range.end() ? std::nullopt : tables::range_policy(at->second)) {
            policies.named.emplace_back(axis, *known);
        }
    }
    return policies;
}

/// None of them is another one than the study's own.
bool as_the_study(const cases::TableSpec& spec, const tables::RangePolicies& policies) {
    const tables::RangePolicies own = cases::fit_options(spec).range;
    return std::all_of(policies.named.begin(), policies.named.end(),
                       [&](const auto& named) { return named.second == own.of(named.first); });
}

}  // namespace

std::string table_digest(const Session& session, const std::string& table) {
    const auto* spec = session.study.find_table(table);
    if (spec == nullptr) {
        return {};
    }
    return known_of(session, *spec).digest;
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
    const auto policies = policies_of(spec, range);
    if (const auto found = found_of(session, spec)) {
        return cases::table_of_found(*found, spec, policies, progress);
    }
    tables::FitOptions fit = cases::fit_options(spec);
    fit.range.named.insert(fit.range.named.begin(), policies.named.begin(), policies.named.end());
    return tables::ForceTable::fit(cases::table_points(spec, session.results), spec.quantity, fit);
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
    const auto& spec = needed_table(session, record.table);
    const TableOfStudy of = table_of_study(session, record.table);
    if (!of.found.empty()) {
        options.provenance = {of.found_line()};
    } else if (as_the_study(spec, policies_of(spec, record.range)) && !of.origin.empty()) {
        options.provenance = {of.origin};
    }
    tables::export_table(exported_table(session, record.table, record.range, progress), record.format, file, options,
                         progress);
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
