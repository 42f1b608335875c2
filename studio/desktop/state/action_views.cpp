// Actions on force tables, stability maps and what is explored.
#include <algorithm>

#include "core/text.h"
#include "core/units.h"
#include "geometry/body/variants.h"
#include "studio/desktop/state/action_parts.h"
#include "studio/desktop/state/known_things.h"
#include "surrogates/dynamics/simulate/feedback.h"

namespace underbody::studio::action {

using core::UsageError;

State look_at_table(State state, const Words& words, const Session& session) {
    need(words, 2, 100, "table NAME KEY=VALUE ...");
    need_one_of(words[0], names_of(state, session, "table"), "table");
    const auto& axes = session.study.find_table(words[0])->axes;
    TableView& view = state.tables[words[0]];
    for (std::size_t i = 1; i < words.size(); ++i) {
        const auto [key, text] = assignment(words[i]);
        if (key == "net_weight") {
            view.net_weight = number_or_none(text, "N");
        } else if (key == "virtual_mass") {
            view.virtual_mass = number_or_none(text, "kg");
            within(view.virtual_mass.value_or(0), 0, 1e9, "virtual mass (kg)");
        } else if (key == "shown") {
            need_table_view(axes, text);
            view.shown = text;
        } else if (key == "beside") {
            view.beside.clear();
            for (const auto other : core::split(text, ',')) {
                if (!other.empty()) {
                    view.beside.emplace_back(other);
                    need_table_view(axes, view.beside.back());
                }
            }
            within(static_cast<double>(view.beside.size()), 0, 5, "views beside the first");
        } else if (key == "logarithmic") {
            view.logarithmic = text.empty() ? std::optional<bool>() : yes_or_no(text);
        } else if (key.starts_with("held.")) {
            need_one_of(key.substr(5), axes, "axis");
            const auto* quantity = core::find_quantity(key.substr(5));
            view.held[key.substr(5)] = core::parse_in(text, quantity != nullptr ? quantity->unit : "1");
        } else {
            unknown_key(key, {"net_weight", "virtual_mass", "shown", "beside", "logarithmic", "held.AXIS"});
        }
    }
    return state;
}

namespace {
void need_map(const std::string& kind) {
    const std::vector<std::string> known = {"ends", "probability", "sweep", "estimator"};
    if (std::find(known.begin(), known.end(), kind) == known.end()) {
        unknown_key(kind, known);
    }
}
}  // namespace

State look_at_region(State state, const Words& words, const Session& session) {
    need(words, 2, 100, "region NAME KEY=VALUE ...");
    need_one_of(words[0], names_of(state, session, "region"), "region");
    RegionView& view = state.regions[words[0]];
    for (std::size_t i = 1; i < words.size(); ++i) {
        const auto [key, text] = assignment(words[i]);
        if (key == "cells") {
            view.cells = static_cast<int>(within(core::parse_in(text, "1"), 20, 1000, "starts a side"));
        } else if (key == "show") {
            need_map(text);
            view.show = text;
        } else if (key == "beside") {
            view.beside.clear();
            for (const auto kind : core::split(text, ',')) {
                if (!kind.empty()) {
                    view.beside.emplace_back(kind);
                    need_map(view.beside.back());
                }
            }
        } else if (key == "axes") {
            if (!text.empty() && core::parse_ranges(text).size() != 2) {
                throw UsageError("range", "a map has two axes, not those of '" + text + "'", {},
                                 "such as gap=1mm:20mm,pitch=-3deg:3deg");
            }
            for (const auto& axis : text.empty() ? std::vector<core::NamedRange>() : core::parse_ranges(text)) {
                need_one_of(axis.name, {"gap", "heave_velocity", "pitch", "pitch_rate"}, "axis of a map");
            }
            view.axes = text;
            view.start.reset();
            view.start_of.clear();
        } else if (key == "feedback") {
            if (!text.empty()) {
                static_cast<void>(dynamics::pitch_feedback(text));  // says what is wrong with it
            }
            view.feedback = text;
        } else if (key == "sweep") {
            if (!text.empty() && core::parse_ranges(text).size() != 1) {
                throw UsageError("range", "one condition is swept, not '" + text + "'", {}, "such as speed=0.3:0.7");
            }
            view.sweep = text;
        } else if (key == "steps") {
            view.steps = static_cast<int>(within(core::parse_in(text, "1"), 2, 50, "maps of the sweep"));
        } else if (key == "draws") {
            view.draws = static_cast<int>(within(core::parse_in(text, "1"), 2, 1000, "draws"));
        } else if (key == "gap_noise") {
            view.gap_noise = within(core::parse_in(text, "m"), 1e-9, 1, "noise of the gap (m)");
        } else if (key == "velocity_noise") {
            view.velocity_noise =
                text.empty() ? 0 : within(core::parse_in(text, "m/s"), 0, 10, "noise of the velocity (m/s)");
        } else if (key == "drag_error") {
            view.drag_error = within(core::parse_in(text, "1"), 1e-3, 10, "error of the drag law");
        } else if (key == "logarithmic") {
            view.logarithmic = text.empty() ? std::optional<bool>() : yes_or_no(text);
        } else if (key == "duration") {
            view.duration = number_or_none(text, "s");
            within(view.duration.value_or(1), 1e-3, 1e6, "duration (s)");
        } else if (key == "start") {
            view.start.reset();
            view.start_of.clear();
            if (text.find('=') != std::string::npos) {
                for (const auto& value : core::parse_assignments(text)) {
                    need_one_of(value.name, {"gap", "heave_velocity", "pitch", "pitch_rate"}, "state of a start");
                    view.start_of[value.name] = value.value;
                }
            }
            if (text.empty() || !view.start_of.empty()) {
                continue;
            }
            const auto parts = core::split(text, ',');
            if (parts.size() != 2) {
                throw UsageError("parse", "a start is GAP,VELOCITY", {}, "such as start=5mm,10mm/s");
            }
            view.start = {core::parse_in(parts[0], "m"), core::parse_in(parts[1], "m/s")};
        } else if (key == "as_declared" && text.empty()) {
            view.set.clear();
        } else if (key.starts_with("set.")) {
            if (text.empty()) {
                view.set.erase(key.substr(4));
            } else {
                view.set[key.substr(4)] = core::parse_in(text, "1");
                need_parameter(session, words[0], key.substr(4), view.set[key.substr(4)]);
            }
        } else {
            unknown_key(key,
                        {"cells", "duration", "start", "show", "beside", "axes", "feedback", "sweep", "steps", "draws",
                         "gap_noise", "velocity_noise", "drag_error", "logarithmic", "as_declared", "set.PARAMETER"});
        }
    }
    return state;
}

State explore_axes(State state, const Words& words, const Session& session) {
    need(words, 2, 2, "axes X Y");
    need_column(session, words[0]);
    need_column(session, words[1]);
    state.explore.x = words[0];
    state.explore.y = words[1];
    return state;
}

namespace {
/// SI unit of what is explored: a known quantity, a column of the loads, a parameter or number of a shape.
std::string unit_of_column(const std::string& name, const Session& session) {
    if (const auto* quantity = core::find_quantity(name)) {
        return quantity->unit;
    }
    if (const auto* column = session.results.loads.find(name); column != nullptr && !column->is_text()) {
        return column->unit;
    }
    for (const auto& column : geometry::variant_columns()) {
        if (column.name == name) {
            return column.unit;
        }
    }
    for (const auto& parameter : geometry::parameter_names()) {
        if (parameter.name == name && !parameter.unit.empty()) {
            return parameter.unit;
        }
    }
    return "1";
}
}  // namespace

State brush(State state, const Words& words, const Session& session) {
    need(words, 0, 100, "brush COLUMN=LOW:HIGH ...");
    if (words.empty()) {
        state.explore.brush.clear();
    }
    for (const auto& word : words) {
        const auto [column, text] = assignment(word);
        need_column(session, column);
        if (text.empty()) {
            state.explore.brush.erase(column);
        } else {
            const std::string unit = unit_of_column(column, session);
            const auto middle = text.find(':', 1);
            const bool one = middle == std::string::npos || text.substr(0, middle) == text.substr(middle + 1);
            const double value = one ? core::parse_in(text.substr(0, middle), unit) : 0;
            state.explore.brush[column] = one ? std::array<double, 2>{value, value} : range_of(text, unit.c_str());
        }
    }
    return state;
}

State order(State state, const Words& words, const Session& session) {
    for (const auto& column : words) {
        need_column(session, column);
        if (std::count(words.begin(), words.end(), column) > 1) {
            throw UsageError("words", "the axis '" + column + "' is named twice", {}, "name it once");
        }
    }
    state.explore.order = words;
    return state;
}

State vary(State state, const Words& words, const Session& session) {
    need(words, 0, 12, "vary PARAMETER=FROM:TO:COUNT ...");
    std::vector<geometry::Vary> varied;
    std::size_t count = 1;
    for (const auto& word : words) {
        varied.push_back(geometry::vary_from(word));
        count *= varied.back().values.size();
        const bool twice = std::count_if(varied.begin(), varied.end(),
                                         [&](const auto& one) { return one.key == varied.back().key; }) > 1;
        if (twice) {
            throw UsageError("words", "'" + varied.back().key + "' is varied twice", {}, "name it once");
        }
    }
    constexpr std::size_t most = 5000;  // made while somebody waits
    if (count > most) {
        throw UsageError("range", std::to_string(count) + " shapes are more than the window makes", {},
                         "at most " + std::to_string(most) + "; `underbody body sweep` makes more");
    }
    if (!varied.empty()) {
        static_cast<void>(shape_of(state, session, need_shape(state, session)));
    }
    state.explore.vary = std::move(varied);
    state.explore.shapes = !state.explore.vary.empty();
    return state;
}

State rows(State state, const Words& words, const Session&) {
    need(words, 1, 1, "rows cases|shapes");
    if (words[0] != "cases" && words[0] != "shapes") {
        throw UsageError("unknown", "rows are cases or shapes, not '" + words[0] + "'", {},
                         core::did_you_mean(words[0], {"cases", "shapes"}));
    }
    state.explore.shapes = words[0] == "shapes";
    return state;
}

State show(State state, const Words& words, const Session& session) {
    need(words, 1, 2, "show points|pictures [VIEW]|lift|map");
    const std::string& what = words[0];
    need_one_of(what, {"points", "pictures", "lift", "map"}, "view");
    if (words.size() > 1 && what != "pictures") {
        throw UsageError("words", "'" + what + "' takes no further word, not '" + words[1] + "'", {}, "show " + what);
    }
    if (what == "lift" || what == "map") {
        state.design.map = what == "map";
        return state;
    }
    state.explore.pictures = what == "pictures";
    if (words.size() > 1) {
        need_one_of(words[1], case_views(session), "picture of cases");
        state.explore.picture = words[1];
    }
    return state;
}

State choose_cells(State state, const Words& words, const Session&) {
    need(words, 1, 7, "cells WORKSPACE [VIEW ...]");
    const auto& workspaces = workspace_names();
    if (std::find(workspaces.begin(), workspaces.end(), words[0]) == workspaces.end()) {
        throw UsageError("unknown", "there is no workspace '" + words[0] + "'", {},
                         core::did_you_mean(words[0], workspaces));
    }
    const auto& views = workspace_views(words[0]);
    std::vector<std::string> names, chosen;
    for (const auto& view : views) {
        names.push_back(view.name);
        if (std::find(words.begin() + 1, words.end(), view.name) != words.end()) {
            chosen.push_back(view.name);
        }
    }
    for (std::size_t i = 1; i < words.size(); ++i) {
        need_one_of(words[i], names, "view of " + words[0]);
    }
    if (chosen.empty() || chosen.size() == views.size()) {
        state.cells.erase(words[0]);
    } else {
        state.cells[words[0]] = chosen;
    }
    return state;
}

}  // namespace underbody::studio::action
