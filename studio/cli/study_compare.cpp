// underbody study compare: the study's own [[compare]], or two campaigns side by side.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/compare_studies.h"
#include "cases/percent.h"
#include "core/counted.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "studio/cli/study_parts.h"

namespace underbody::studio {

namespace {

int compare_variants(Shell& shell, const StudyArguments& arguments) {
    const auto study = cases::Study::open(arguments.folder);
    cases::RunOptions options = run_options(arguments);
    options.write_report = false;
    const auto results = results_of_run(shell, study, options);
    nlohmann::json json = nlohmann::json::object();
    std::vector<std::vector<std::string>> rows = {{"comparison", "table", "winner of", "value"}};
    std::string remarks;
    for (const auto& spec : study.comparisons) {
        const auto* document = results.document("compare/" + spec.name);
        if (document == nullptr) {
            continue;
        }
        json[spec.name] = nlohmann::json::parse(*document);
        for (const auto& row : json[spec.name].at("rows")) {
            rows.push_back({spec.name, row.at("table"), row.at("measure"), row.at("text")});
        }
        for (const auto& remark : json[spec.name].at("remarks")) {
            remarks += "\n" + spec.name + ": " + remark.get<std::string>();
        }
    }
    if (shell.json) {
        shell.print_json(json);
    }
    shell.print(aligned(rows) + (remarks.empty() ? "" : "\n" + remarks));
    return results.failed == 0 ? done : wrong_input;
}

/// "3.5 mm": lengths and angles as people read them.
std::string shown(double value, const std::string& unit, int digits = 4) {
    if (!std::isfinite(value)) {
        return "-";
    }
    return unit == "1" ? cases::percent(value, digits) : core::told(value, unit, digits);
}

/// "0.5 N, 0.52 N, 0.02 ± 0.005 N (4 errors)"
std::vector<std::string> numbers_of(const cases::Moved& one) {
    std::string by = shown(one.difference(), one.unit, 3);
    if (std::isfinite(one.sigma())) {
        by += " ± " + shown(one.sigma(), one.unit, 2);
    }
    std::string judged = to_string(one.shift);
    if (one.shift == cases::Shift::beyond || one.shift == cases::Shift::within) {
        judged += ", " + core::counted_text(core::format_number(one.in_sigma(), 2), "standard deviation");
    } else if (one.shift == cases::Shift::unjudged) {
        judged += ", " + cases::percent(one.of_size(), 2);
    }
    return {shown(one.a, one.unit), shown(one.b, one.unit), by, judged};
}

template <class... Words>
std::vector<std::string> row_of(const cases::Moved& one, Words... words) {
    std::vector<std::string> row = {words...};
    const auto numbers = numbers_of(one);
    row.insert(row.end(), numbers.begin(), numbers.end());
    return row;
}

/// The first rows, under a heading; nothing when there are none.
std::string block(const std::string& title, std::vector<std::vector<std::string>> rows, int most) {
    if (rows.size() < 2) {
        return {};
    }
    const std::size_t all = rows.size() - 1;
    if (most >= 0 && all > static_cast<std::size_t>(most)) {
        rows.resize(static_cast<std::size_t>(most) + 1);
    }
    return "\n" + title + "\n" + aligned(rows) +
           (rows.size() - 1 < all ? "\nand " + std::to_string(all - rows.size() + 1) + " more (--most, --json)" : "") +
           "\n";
}

std::string settled_text(const cases::MovedLoad& one) {
    return one.settled_a == one.settled_b ? one.settled_a : one.settled_a + " | " + one.settled_b;
}

std::string names_text(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), 6); ++i) {
        text += (i == 0 ? "" : ", ") + names[i];
    }
    return text + (names.size() > 6 ? ", ..." : "");
}

/// How many loads of each kind.
std::string counts_of(const cases::StudyComparison& c) {
    std::string text;
    for (const auto shift : {cases::Shift::beyond, cases::Shift::unjudged, cases::Shift::within, cases::Shift::same,
                             cases::Shift::only_one}) {
        const auto count =
            std::count_if(c.loads.begin(), c.loads.end(), [&](const auto& one) { return one.load.shift == shift; });
        if (count > 0) {
            text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + to_string(shift);
        }
    }
    return text;
}

std::string summary(const cases::StudyComparison& c) {
    std::string text = "A: " + c.a + "\nB: " + c.b + "\n";
    for (const auto& one : c.apart) {
        text += "they differ as a whole in " + one.condition + ": " + (one.a.empty() ? "(none)" : one.a) + " | " +
                (one.b.empty() ? "(none)" : one.b) + "\n";
    }
    text += core::counted(c.cases, "case") + " on both sides";
    text += c.only_a.empty() ? "" : "; only in A " + std::to_string(c.only_a.size()) + ": " + names_text(c.only_a);
    text += c.only_b.empty() ? "" : "; only in B " + std::to_string(c.only_b.size()) + ": " + names_text(c.only_b);
    return text + (c.loads.empty() ? "" : "\nloads (B less A): " + counts_of(c)) + "\n";
}

std::string text_of(const cases::StudyComparison& c, int most) {
    std::vector<std::vector<std::string>> loads = {{"case", "load", "A", "B", "B less A", "", "solution"}};
    for (const auto& one : c.loads) {
        if (one.load.shift != cases::Shift::same) {
            loads.push_back(row_of(one.load, one.case_a == one.case_b ? one.case_a : one.case_a + " | " + one.case_b,
                                   one.load.name));
            loads.back().push_back(settled_text(one));
        }
    }
    std::vector<std::vector<std::string>> tables = {{"table", "where", "A", "B", "B less A", "", "of the range"}};
    for (const auto& one : c.tables) {
        std::string at = one.why_not;
        for (const auto& [axis, value] : one.at) {
            const auto* quantity = core::find_quantity(axis);
            at += (at.empty() ? "" : ", ") + axis + " " + shown(value, quantity != nullptr ? quantity->unit : "1");
        }
        tables.push_back(row_of(one.force, one.table, at));
        tables.back().push_back(cases::percent(one.beyond_share, 3) + " beyond");
    }
    std::string text = summary(c) + block("What moved most:", loads, most) + block("Force tables:", tables, most);
    for (const auto& [list, title] : {std::pair{&c.equilibria, "Equilibria:"}, {&c.maps, "Maps:"}}) {
        std::vector<std::vector<std::string>> rows = {{"result", "", "A", "B", "B less A", ""}};
        for (const auto& one : *list) {
            rows.push_back(row_of(one.value, one.result, one.value.name));
        }
        text += block(title, rows, most);
    }
    text.pop_back();
    return text;
}

/// One side: computed, or as its store has it.
cases::StudyResults results_of_side(Shell& shell, const StudyArguments& arguments, const cases::Study& study,
                                    const std::string& store) {
    cases::RunOptions options = run_options(arguments);
    options.store = store;
    options.pictures = false;
    options.renderer = {};
    options.write_report = false;
    options.as_stored = arguments.as_stored;
    auto results = arguments.as_stored ? with_store_hint([&] { return cases::stored_results(study, options); })
                                       : results_of_run(shell, study, options);
    for (const auto& step : results.steps) {
        if (!step.error.empty()) {
            shell.warn(step.kind + " '" + step.name + "' failed: " + step.error);
        }
    }
    if (arguments.as_stored && results.changed > 0) {
        shell.print("note: " + core::counted(results.changed, "result") + " of '" + study.title +
                    "' are compared as the store has them: files, options or code have changed since");
    }
    return results;
}

std::string name_of(const cases::Study& study, const std::string& folder, const std::string& where) {
    return study.title + " (" + folder + (where.empty() ? "" : ", " + where) + ")";
}

int compare_campaigns(Shell& shell, const StudyArguments& arguments) {
    const std::string other = arguments.other.empty() ? arguments.folder : arguments.other;
    const auto study_a = cases::Study::open(arguments.folder);
    const auto study_b = cases::Study::open(other);
    const auto results_a = results_of_side(shell, arguments, study_a, arguments.store);
    const bool one = other == arguments.folder && arguments.other_store == arguments.store;
    const auto results_b =
        one ? cases::StudyResults() : results_of_side(shell, arguments, study_b, arguments.other_store);
    const auto where = [](const std::string& text) {
        return text.empty() ? cases::Conditions() : cases::conditions_from(text);
    };
    const auto compared = cases::compare_studies(
        {name_of(study_a, arguments.folder, arguments.where_a), &study_a, &results_a, where(arguments.where_a)},
        {name_of(study_b, other, arguments.where_b), one ? &study_a : &study_b, one ? &results_a : &results_b,
         where(arguments.where_b)},
        shell.progress());
    if (shell.json) {
        nlohmann::json json = compared;
        for (const auto& [key, results] :
             {std::pair{"stale_a", &results_a}, {"stale_b", one ? &results_a : &results_b}}) {
            json[key] = results->changed;
        }
        shell.print_json(json);
    }
    if (const std::size_t unsettled = compared.unsettled_a + compared.unsettled_b; unsettled > 0 && !shell.json) {
        shell.show_warning("of these cases " + std::to_string(compared.unsettled_a) + " in A and " +
                           std::to_string(compared.unsettled_b) + " in B " + (unsettled == 1 ? "has" : "have") +
                           " not settled");
    }
    shell.print(text_of(compared, arguments.most));
    return results_a.failed + results_b.failed == 0 ? done : wrong_input;
}

int compare(Shell& shell, const StudyArguments& arguments) {
    const bool campaigns = !arguments.other.empty() || !arguments.other_store.empty() || !arguments.where_a.empty() ||
                           !arguments.where_b.empty();
    if (!campaigns && arguments.as_stored) {
        throw core::UsageError("usage", "--as-stored belongs to the comparison of two campaigns", {},
                               "underbody study compare A B --as-stored");
    }
    return campaigns ? compare_campaigns(shell, arguments) : compare_variants(shell, arguments);
}

}  // namespace

void add_study_compare(CLI::App* study, std::shared_ptr<StudyArguments> arguments, Shell& shell) {
    auto* command = study->add_subcommand(
        "compare", "the study's [[compare]]; with a second study, what moved beyond its error between the two");
    add_common(command, *arguments);
    command->add_option("other", arguments->other, "folder of a second study (campaign, mesh, solver, version)");
    command->add_option("--store-b", arguments->other_store, "the store of the second one");
    command->add_option("--where-a", arguments->where_a,
                        "only cases with these conditions on the first side, such as mesh=coarse; without a second "
                        "study both sides are of this one");
    command->add_option("--where-b", arguments->where_b, "likewise on the second side");
    command->add_flag("--as-stored", arguments->as_stored,
                      "compute nothing: what the stores hold, also of earlier files, options and versions of the "
                      "program");
    command->add_option("--most", arguments->most, "rows of each list")->capture_default_str();
    shell.on(command, [arguments, &shell] { return compare(shell, *arguments); });
}

}  // namespace underbody::studio
