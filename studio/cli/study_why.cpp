// underbody study why: from a number back to all that made it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "cases/why.h"
#include "core/counted.h"
#include "core/text.h"
#include "studio/cli/study_parts.h"

namespace underbody::studio {

namespace {

using Lines = std::vector<std::pair<std::string, std::string>>;

std::string block(const char* title, const Lines& lines) {
    std::string text;
    for (const auto& [key, value] : lines) {
        text += (text.empty() ? std::string("  ") + title + "\n" : "") + "    " + key +
                (value.empty() ? "" : ": " + value) + "\n";
    }
    return text;
}

std::string title_of(const cases::Origin& origin) {
    return origin.kind + " '" + origin.name + "'" +
           (origin.made.empty() ? ": no longer known"
                                : ", made " + origin.made + " UTC" +
                                      (origin.state == cases::StepState::unchanged ? "" : ", made anew since"));
}

/// Files with the first digits of their hashes; those that were looked for and not found with `all`.
Lines files_of(const cases::Origin& origin, bool all) {
    Lines read;
    for (const auto& file : origin.files) {
        if (all || file.state != "absent") {
            read.emplace_back(file.path + (file.pattern.empty() ? "" : " (names like " + file.pattern + ")"),
                              all ? file.state : file.state.substr(0, 12));
        }
    }
    return read;
}

/// Options with their units, hashes as such; what the title says already and what was not given is left out.
Lines options_of(const cases::Origin& origin) {
    static const std::map<std::string, std::string> units = {
        {"density", "kg/m^3"},  {"length", "m"}, {"width", "m"},   {"height", "m"},  {"net_weight", "N"},
        {"virtual_mass", "kg"}, {"gap", "m"},    {"pitch", "rad"}, {"speed", "m/s"}, {"for", "s"}};
    static const std::regex hash("[0-9a-f]{32}");
    Lines lines;
    for (const auto& [label, value] : origin.options) {
        if (label == "kind" || value == "nan" || value.empty()) {
            continue;
        }
        const auto unit = units.find(label.substr(label.rfind('.') + 1));
        const bool number = core::parse_number(value).has_value();
        lines.emplace_back(label, std::regex_match(value, hash)   ? "hash " + value.substr(0, 12)
                                  : number && unit != units.end() ? value + " " + unit->second
                                                                  : value);
    }
    return lines;
}

/// All that a result says.
std::string whole(const cases::Origin& origin, bool verbose) {
    Lines facts, from;
    for (const auto& fact : origin.facts) {
        facts.emplace_back(fact.name, fact.value);
    }
    for (const auto& [kind, name] : origin.from) {
        from.emplace_back(kind + " '" + name + "'", "");
    }
    return title_of(origin) + "\n" + block("says", facts) + block("made with", options_of(origin)) +
           block("read, with the hash of the content", files_of(origin, verbose)) + block("made of", from) +
           block("by code (hash of the sources)", origin.code);
}

/// A line for a result further back: what it rests on, in short.
std::vector<std::string> brief(const cases::Origin& origin) {
    std::string says;
    for (const auto& fact : origin.facts) {
        const bool matters = origin.kind != "loads" || fact.name == "lift_force" || fact.name == "drag_force";
        if (fact.number && matters && says.size() < 60) {
            says += (says.empty() ? "" : ", ") + fact.name + " " + fact.value;
        }
    }
    std::size_t zones = 0;
    std::string solver;
    for (const auto& fact : origin.facts) {
        zones += fact.name.starts_with("zone '") ? 1 : 0;
        solver = fact.name == "writer" || (fact.name == "format" && solver.empty()) ? fact.value : solver;
    }
    std::string files;
    const Lines read = files_of(origin, false);
    for (std::size_t i = 0; i < std::min<std::size_t>(read.size(), 2); ++i) {
        files += (i == 0 ? "" : ", ") + read[i].first + " " + read[i].second;
    }
    files += read.size() > 2 ? " and " + std::to_string(read.size() - 2) + " more" : "";
    return {origin.kind + " '" + origin.name + "'",
            says,
            zones > 0 ? core::counted(zones, "zone") : "",
            solver,
            files,
            origin.state == cases::StepState::unchanged ? "" : "changed since"};
}

int why(Shell& shell, const StudyArguments& arguments) {
    const auto study = cases::Study::open(arguments.folder);
    const auto way = with_store_hint([&] { return cases::way_back(study, run_options(arguments), arguments.what); });
    if (shell.json) {
        nlohmann::json json = {{"study", study.title}, {"notes", way.notes}, {"origins", way.origins}};
        if (way.asked) {
            json["asked"] = *way.asked;
        }
        shell.print_json(json);
        return done;
    }
    for (const auto& note : way.notes) {
        shell.print("note: " + note);
    }
    const cases::Origin& first = way.origins.front();
    if (way.asked) {
        shell.print(way.asked->name + " of " + first.kind + " '" + first.name + "': " + way.asked->value + "\n");
    }
    if (shell.verbose) {
        for (const auto& origin : way.origins) {
            shell.print(whole(origin, true));
        }
        return done;
    }
    std::string text = whole(first, false);
    std::vector<std::vector<std::string>> rows;
    for (auto origin = way.origins.begin() + 1; origin != way.origins.end(); ++origin) {
        rows.push_back(brief(*origin));
    }
    if (!rows.empty()) {
        text +=
            "\nall that it rests on, nearest first (faces, settings, hashes and code of each: study why of it, or "
            "--verbose)\n" +
            aligned(rows);
    }
    shell.print(text);
    return done;
}

}  // namespace

void add_study_why(CLI::App* study, std::shared_ptr<StudyArguments> arguments, Shell& shell) {
    auto* command = study->add_subcommand(
        "why", "where a number comes from: loads, faces, files with their hashes, settings and code");
    add_common(command, *arguments);
    command
        ->add_option(
            "result", arguments->what,
            "of the report, a table or an exported file: table/lift, \"lift_force of cube-h2\", \"stable gap\", \"3.5 "
            "mm\" (as printed), exports/lift.h, or a copy of it elsewhere")
        ->required();
    shell.on(command, [arguments, &shell] { return why(shell, *arguments); });
}

}  // namespace underbody::studio
