// underbody region: where each start ends.
#include "surrogates/dynamics/basin/region.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/angle.h"
#include "core/counted.h"
#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/feedback_options.h"
#include "studio/cli/force_notes.h"
#include "studio/cli/model_options.h"
#include "studio/cli/option_value.h"
#include "studio/cli/region_loop.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"
#include "surrogates/dynamics/simulate/feedback.h"

namespace underbody::studio {

namespace {

struct RegionArguments {
    std::string model;
    std::vector<std::string> set;
    std::string axes;
    std::string grid;
    std::string duration = "60 s";
    std::string conditions;
    std::string out;
    std::string table;
    std::string starts;
    std::string escape;
    std::string feedback;
    std::string lqr;
    std::string motion = "auto";
    std::string sweep;
    std::string shares;
    std::size_t steps = 5;
    std::size_t draws = 0;
    std::uint64_t seed = 1;
    bool safe = false;
    bool through_contact = false;
    std::vector<std::string> variants;
    RegionLoopOptions loop;
};

/// Feedback in the motion that the map is of.
void close_loop(const RegionArguments& a, const dynamics::Model& model, dynamics::RegionOptions& options,
                Shell& shell) {
    if (a.feedback.empty() && a.lqr.empty()) {
        return;
    }
    const bool pitch_axis = std::any_of(options.axes.begin(), options.axes.end(), [](const core::NamedRange& axis) {
        return axis.name == "pitch" || axis.name == "pitch_rate";
    });
    using Motion = dynamics::RegionOptions::Motion;
    if (options.motion == Motion::heave_pitch || (options.motion == Motion::automatic && pitch_axis)) {
        const dynamics::HeavePitch plant(model, options.held);
        options.pitch_feedback =
            std::make_shared<dynamics::PitchFeedback>(*pitch_feedback_of(shell, a.feedback, a.lqr, plant));
    } else {
        options.feedback = heave_feedback_of(shell, a.feedback, a.lqr, model, options.held);
    }
}

dynamics::RegionOptions options_of(const RegionArguments& a, const dynamics::Model& model, Shell& shell) {
    dynamics::RegionOptions options;
    // Given starts have no range of their own: they escape at the end of the tables, or above the highest start.
    if (!a.axes.empty() || a.starts.empty()) {
        options.axes = core::parse_ranges(a.axes.empty() ? "gap=0:0.5,heave_velocity=-0.1:0.1" : a.axes);
    }
    const std::string usual = a.loop.given() ? "60x40" : "200x200";
    const std::vector<std::string_view> sizes = core::split(a.grid.empty() ? usual : a.grid, 'x');
    const auto columns = core::parse_integer(sizes.front()), rows = core::parse_integer(sizes.back());
    if (sizes.size() > 2 || !columns || !rows || *columns < 1 || *rows < 1 || *columns > 20000 || *rows > 20000) {
        throw core::UsageError("range", "--grid '" + a.grid + "' is not two counts", {}, "for instance --grid 400x400");
    }
    options.columns = static_cast<std::size_t>(*columns);
    options.rows = static_cast<std::size_t>(*rows);
    options.duration = option_value("--for", a.duration, "s");
    for (const core::NamedValue& value :
         a.conditions.empty() ? std::vector<core::NamedValue>{} : core::parse_assignments(a.conditions)) {
        options.held.set(value.name, value.value);
    }
    options.through_contact = a.through_contact;
    if (a.motion != "auto") {
        using Motion = dynamics::RegionOptions::Motion;
        options.motion = a.motion == "heave" ? Motion::heave : Motion::heave_pitch;
    }
    close_loop(a, model, options, shell);
    if (!a.escape.empty()) {
        options.escape_gap = option_value("--escape", a.escape, "m");
    }
    return options;
}

std::string percent(double fraction) { return core::format_number(100 * fraction, 4) + " %"; }

void print_classes(Shell& shell, const std::vector<dynamics::EndClass>& classes) {
    std::string text;
    for (const dynamics::EndClass& end : classes) {
        if (end.fraction > 0 || end.kind == dynamics::EndKind::attractor) {
            text += std::string(dynamics::end_kind_name(end.kind)) +
                    (end.name == dynamics::end_kind_name(end.kind) ? "" : " " + end.name) +
                    (std::isnan(end.gap) ? "" : " at " + core::format_number(1e3 * end.gap, 5) + " mm") + ": " +
                    percent(end.fraction) +
                    (end.outside > 0 ? " (" + percent(end.outside) + " by motions beyond a force table)" : "") + "\n";
        }
    }
    shell.print(text);
}

/// The remarks about one map of several, each with the map's name.
void show_remarks(Shell& shell, const dynamics::StabilityRegion& region, const std::string& name) {
    core::Problems named = region.remarks;
    for (core::Problem& remark : named) {
        remark.message = name + ": " + remark.message;
    }
    shell.show(named);
}

int run_starts(const RegionArguments& a, const dynamics::Model& model, const dynamics::RegionOptions& options,
               Shell& shell) {
    shell.list_on_stdout = a.table.empty();
    const core::Table starts = core::read_csv(std::filesystem::path(a.starts));
    dynamics::StartEnds found = dynamics::ends_of_starts(model, starts, options, shell.progress());
    const std::vector<dynamics::EndClass>& classes = found.classes;
    core::Table& ends = found.table;
    shell.show(found.remarks);
    const std::vector<std::string> warnings = show_table_warnings(shell, model, options.held);
    shell.comment_warnings(ends);
    shell.hand_over("map", [&] { return ends; });
    if (!a.table.empty()) {
        core::write_csv(std::filesystem::path(a.table), ends);
    }
    if (shell.json) {
        nlohmann::json json = {
            {"classes", nlohmann::json::array()}, {"starts", nlohmann::json::array()}, {"warnings", warnings}};
        for (const dynamics::EndClass& end : classes) {
            if (end.fraction > 0) {
                json["classes"].push_back({{"name", end.name},
                                           {"kind", dynamics::end_kind_name(end.kind)},
                                           {"fraction", end.fraction},
                                           {"outside_table_path_fraction", end.outside}});
                if (!std::isnan(end.gap)) {
                    json["classes"].back()["gap"] = end.gap;
                }
            }
        }
        for (std::size_t i = 0; i < ends.rows(); ++i) {
            nlohmann::json row;
            for (const core::Column& column : ends.columns()) {
                row[column.name] =
                    column.is_text() ? nlohmann::json(column.text[i]) : nlohmann::json(column.numbers[i]);
            }
            json["starts"].push_back(row);
        }
        shell.print_json(json);
    } else if (a.table.empty()) {
        shell.print(core::write_csv(ends));
    } else {
        print_classes(shell, classes);
    }
    return ExitCode::done;
}

int run_probability(const RegionArguments& a, const dynamics::Model& model, const dynamics::RegionOptions& options,
                    Shell& shell) {
    const dynamics::ProbabilityMap map = dynamics::probability_map(model, options, a.draws, a.seed, shell.progress());
    shell.show(map.remarks);
    if (!a.out.empty()) {
        write_picture(dynamics::probability_figure(map), a.out);
    }
    nlohmann::json json;
    dynamics::to_json(json, map);
    show_forces(shell, model, options.held, json);
    if (shell.json) {
        shell.print_json(json);
    }
    shell.print("safe area " + percent(map.area_mean) + " +- " + percent(map.area_sigma) + " over " +
                core::counted(map.draws, "draw") + "\n");
    return ExitCode::done;
}

int run_sweep(const RegionArguments& a, const dynamics::Model& model, const dynamics::RegionOptions& options,
              Shell& shell) {
    const std::vector<core::NamedRange> ranges = core::parse_ranges(a.sweep);
    if (ranges.size() != 1) {
        throw core::UsageError("range", "--sweep takes one range, such as jet_voltage=4V:12V");
    }
    const dynamics::RegionSweep sweep = dynamics::swept_regions(model, options, ranges[0], a.steps, shell.progress());
    dynamics::Channel channel{};
    dynamics::find_channel(sweep.name, channel);
    const bool angle = std::string(dynamics::channel_unit(channel)).starts_with("rad");
    std::vector<std::string> names;
    nlohmann::json json = {{"sweep", sweep.name}, {"regions", nlohmann::json::array()}};
    show_forces(shell, model, options.held, json);
    for (std::size_t i = 0; i < sweep.value.size(); ++i) {
        const std::string unit = angle ? "deg" : dynamics::channel_unit(channel);
        names.push_back(sweep.name + " " + core::format_number(sweep.value[i] * (angle ? 1 / core::degree : 1), 4) +
                        " " + unit);
        nlohmann::json one;
        dynamics::to_json(one, sweep.regions[i]);
        one["value"] = sweep.value[i];
        json["regions"].push_back(one);
        show_remarks(shell, sweep.regions[i], names.back());
        shell.print((i > 0 ? "\n" : "") + names.back());
        print_classes(shell, sweep.regions[i].classes);
    }
    if (!a.out.empty()) {
        write_picture(dynamics::region_overlay_figure(sweep.regions, names), a.out);
    }
    if (!a.shares.empty()) {
        write_picture(dynamics::sweep_figure(sweep), a.shares);
    }
    if (shell.json) {
        shell.print_json(json);
    }
    return ExitCode::done;
}

int run_variants(const RegionArguments& a, const dynamics::Model& model, const dynamics::RegionOptions& options,
                 Shell& shell) {
    std::vector<dynamics::StabilityRegion> regions{dynamics::stability_region(model, options, shell.progress())};
    std::vector<std::string> names{a.model};
    for (const std::string& variant : a.variants) {
        const dynamics::Model other = dynamics::read_model(variant);
        dynamics::RegionOptions own = options;
        close_loop(a, other, own, shell);  // gains that --lqr finds are those of this model
        regions.push_back(dynamics::stability_region(other, own, shell.progress()));
        names.push_back(variant);
    }
    if (!a.out.empty()) {
        write_picture(dynamics::region_overlay_figure(regions, names), a.out);
    }
    nlohmann::json json = {{"variants", nlohmann::json::array()}};
    for (std::size_t i = 0; i < regions.size(); ++i) {
        nlohmann::json one;
        dynamics::to_json(one, regions[i]);
        one["name"] = names[i];
        json["variants"].push_back(one);
        show_remarks(shell, regions[i], names[i]);
        shell.print((i > 0 ? "\n" : "") + names[i]);
        print_classes(shell, regions[i].classes);
    }
    if (shell.json) {
        shell.print_json(json);
    }
    return ExitCode::done;
}

/// Each map is of one kind; what that kind would pass over in silence is refused.
void check_kind(const RegionArguments& a) {
    std::vector<std::string> kinds;
    for (const auto& [option, given] : {std::pair{"--starts", !a.starts.empty()},
                                        {"--draws", a.draws > 0},
                                        {"--sweep", !a.sweep.empty()},
                                        {"--with", !a.variants.empty()}}) {
        if (given) {
            kinds.emplace_back(option);
        }
    }
    if (kinds.size() > 1) {
        throw core::UsageError("conflict", kinds[0] + " and " + kinds[1] + " ask for two different maps", {},
                               "run region once for each of them");
    }
    const std::string kind = kinds.empty() ? "" : kinds.front();
    const auto refuse = [&](const char* option, bool given, bool used) {
        if (given && !used) {
            throw core::UsageError(
                "conflict",
                std::string(option) + " has nothing to do " + (kind.empty() ? "without --sweep" : "with " + kind), {},
                "leave it out");
        }
    };
    refuse("--out", !a.out.empty(), kind != "--starts");
    refuse("--table", !a.table.empty(), kind.empty() || kind == "--starts");
    refuse("--safe", a.safe, kind.empty());
    refuse("--shares", !a.shares.empty(), kind == "--sweep");
    refuse("--observer", a.loop.given(), kind.empty() || kind == "--draws");
    if (a.loop.given() && (a.safe || a.through_contact || !a.escape.empty())) {
        throw core::UsageError("conflict", "--safe, --through-contact and --escape are of maps without an estimator",
                               {}, "leave them out, or --observer");
    }
}

/// Says and returns the largest safe sets about each attractor.
nlohmann::json safe_sets(const dynamics::StabilityRegion& region, Shell& shell) {
    nlohmann::json sets = nlohmann::json::array();
    for (const dynamics::EndClass& end : region.classes) {
        if (end.kind == dynamics::EndKind::attractor) {
            const dynamics::SafeSet set = dynamics::largest_safe_set(region, end.name);
            nlohmann::json one;
            dynamics::to_json(one, set);
            sets.push_back(one);
            const auto half = [&](std::size_t axis) {
                const bool angle = set.axes[axis].starts_with("pitch");
                return core::format_number((angle ? 1 / core::degree : 1e3) * set.ellipse[axis], 4) +
                       (angle ? " deg" : " mm") + (set.axes[axis] == "gap" || set.axes[axis] == "pitch" ? "" : "/s");
            };
            shell.print("safe about " + end.name + ": ellipse +-" + half(0) + ", +-" + half(1) + "\n");
        }
    }
    return sets;
}

int run_map(const RegionArguments& a, const dynamics::Model& model, const dynamics::RegionOptions& options,
            Shell& shell) {
    const dynamics::StabilityRegion region = dynamics::stability_region(model, options, shell.progress());
    shell.show(region.remarks);
    nlohmann::json json, forces;
    show_forces(shell, model, options.held, forces);
    if (!a.out.empty()) {
        write_picture(dynamics::region_figure(region), a.out);
    }
    if (!a.table.empty()) {
        core::write_csv(std::filesystem::path(a.table), commented_map(region, shell));
    }
    shell.hand_over("map", [&] { return commented_map(region, shell); });
    dynamics::to_json(json, region);
    json.update(forces);
    print_classes(shell, region.classes);
    if (a.safe) {
        json["safe_sets"] = safe_sets(region, shell);
    }
    if (shell.json) {
        shell.print_json(json);
    }
    return ExitCode::done;
}

int run_region(const RegionArguments& a, Shell& shell) {
    check_kind(a);
    a.loop.check();
    for (const std::string& file : {a.out, a.table, a.shares}) {
        Shell::will_write(file);
    }
    const dynamics::Model model = model_with(a.model, a.set);
    const dynamics::RegionOptions options = options_of(a, model, shell);
    if (!a.lqr.empty() || shell.json) {  // the document states the damping of equilibria
        shell.show(dynamics::HeavePlant(model, options.held).left_out_of_small_motions());
    }
    if (a.loop.given()) {
        return run_region_with_estimator(a.loop, model, options, a.draws, a.seed, a.out, a.table, shell);
    }
    if (!a.starts.empty()) {
        return run_starts(a, model, options, shell);
    }
    if (a.draws > 0) {
        return run_probability(a, model, options, shell);
    }
    if (!a.sweep.empty()) {
        return run_sweep(a, model, options, shell);
    }
    if (!a.variants.empty()) {
        return run_variants(a, model, options, shell);
    }
    return run_map(a, model, options, shell);
}

void add_options(CLI::App* command, const std::shared_ptr<RegionArguments>& a) {
    command->add_option("model", a->model, "the model (model.toml)")->required();
    command->add_option("--set", a->set, set_help());
    command->add_option("--axes", a->axes,
                        "the two axes of starts and their ranges (default gap=0:0.5,heave_velocity=-0.1:0.1)");
    command->add_option("--grid", a->grid,
                        "starts along the two axes (default 200x200; 60x40 with an estimator in the loop)");
    command->add_option("--for", a->duration, "time of motion given to each start (default 60 s)");
    command->add_option("--conditions", a->conditions, "what is held: speed=0.5m/s,jet_voltage=8V, ...");
    command->add_option("--escape", a->escape,
                        "gap above which the body counts as gone (default: end of the table or of the axis; the "
                        "highest of given starts)");
    command->add_option("--feedback", a->feedback, feedback_help());
    command->add_option("--lqr", a->lqr, lqr_help());
    a->loop.add_to(*command);
    command
        ->add_option("--motion", a->motion,
                     "heave, heave-pitch, or auto: heave and pitch where an axis is pitch or pitch_rate")
        ->check(CLI::IsMember({"auto", "heave", "heave-pitch"}));
    command->add_option("--sweep", a->sweep,
                        "a map for each of several values of a condition or a held state: jet_voltage=4V:12V, "
                        "pitch=-2deg:2deg; --out lays their boundaries over each other");
    command->add_option("--steps", a->steps, "values of the sweep (default 5)");
    command->add_option("--shares", a->shares, "picture of the share of each end against what is swept");
    command->add_option("--out", a->out, "the map as a picture (.png, .pdf)");
    command->add_option("--table", a->table, "class and time of every start as a table (CSV)");
    command->add_option(
        "--starts", a->starts,
        "a table of starts (gap, heave_velocity; with pitch or pitch_rate heave and pitch) instead of a grid: one row "
        "each with its class and time");
    command->add_option("--draws", a->draws, "probability map: so many draws of the force tables from their error");
    command->add_option("--seed", a->seed, "seed of the draws");
    command->add_option("--with", a->variants, "further models to lay over the first");
    command->add_flag("--through-contact", a->through_contact,
                      "heave and pitch: go on after touching the ground; contact is then to come to rest on it");
    command->add_flag("--safe", a->safe, "the largest ellipse and box of safe starts about each attractor");
}

}  // namespace

void add_region_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand("region", "stability region: for each start, where the motion ends");
    auto a = std::make_shared<RegionArguments>();
    add_options(command, a);
    command->footer(
        "Examples:\n"
        "  underbody region model.toml --axes gap=0:1,heave_velocity=-0.1:0.1 --out region.png\n"
        "  underbody region model.toml --conditions jet_voltage=8V --grid 400x400 --json\n"
        "  underbody region model.toml --starts starts.csv --table ends.csv\n"
        "  underbody region model.toml --draws 100 --out probability.png      the error of the force table as a chance "
        "to be safe\n"
        "  underbody region smooth.toml --with rough.toml --out both.png\n"
        "  underbody region model.toml --axes gap=1mm:30mm,pitch=-4deg:4deg    heave and pitch together (needs a "
        "pitch_moment table)\n"
        "  underbody region model.toml --sweep jet_voltage=6V:12V --out boundaries.png --shares shares.png\n"
        "Classes: each attractor by name (A is nearest the ground), contact, escape, cycle, undecided in the time "
        "given.");
    shell.on(command, [a, &shell] { return run_region(*a, shell); });
}

}  // namespace underbody::studio
