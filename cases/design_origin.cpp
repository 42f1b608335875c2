#include "cases/design_origin.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/design_file.h"
#include "cases/sweep_parts.h"
#include "core/counted.h"
#include "core/error.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/body/variants.h"

namespace underbody::cases {

namespace fs = std::filesystem;
using tables::SearchVariable;

namespace {

const std::vector<OriginNumber> origin_numbers = {{"gap", "m"},          {"pitch", "rad"},
                                                  {"speed", "m/s"},      {"jet_flow", "m^3/s"},
                                                  {"density", "kg/m^3"}, {"kinematic_viscosity", "m^2/s"}};

const SearchVariable* variable_named(const std::vector<SearchVariable>& all, const std::string& name) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const SearchVariable& v) { return v.name == name; });
    return found == all.end() ? nullptr : &*found;
}

/// The shape that a record tells; nothing where this version does not read it.
std::optional<geometry::BodyShape> shape_in(const CaseRecord& record) {
    std::string text, section;
    for (const auto& [name, value] : record.made_of) {
        const auto dot = name.find('.');
        if (dot == std::string::npos) {
            continue;
        }
        if (name.substr(0, dot) != section) {
            section = name.substr(0, dot);
            text += "[" + section + "]\n";
        }
        text += name.substr(dot + 1) + " = " + (core::parse_number(value) ? value : core::toml_string(value)) + "\n";
    }
    try {
        return geometry::parse_shape(text);
    } catch (const core::InputError&) {
        return {};
    }
}

bool same_number(double a, double b) { return std::abs(a - b) <= 1e-6 * std::max(std::abs(a), std::abs(b)) + 1e-12; }

/// "blocks draft 800 iterations", "snappy cell 0.125 surface_level 3 layers 3 800 iterations"
std::string mesh_of(const CaseRecord& record) {
    std::string text, iterations;
    bool blocks = false;
    for (const auto& [name, value] : record.made_of) {
        if (name == "mesher" || name == "mesh density") {
            blocks = true;
            text += (text.empty() ? "" : " ") + value;
        } else if (name == "cell" || name == "surface_level" || name == "layers") {
            text += (text.empty() ? "" : " ") + name + " " + value;
        } else if (name == "iterations") {
            iterations = value;
        }
    }
    return text.empty() ? text : (blocks ? "" : "snappy ") + text + " " + iterations + " iterations";
}

bool same_mesh(const RunOrigin& a, const RunOrigin& b) { return a.mesh.empty() || b.mesh.empty() || a.mesh == b.mesh; }

bool same_shape(const RunOrigin& a, const RunOrigin& b) {
    return a.shape.empty() || b.shape.empty() || a.shape == b.shape;
}

bool same_moments(const RunOrigin& a, const RunOrigin& b) {
    return a.moments.empty() || b.moments.empty() || a.moments == b.moments;
}

/// "speed: 1 m/s there, 0.5 m/s now"
std::vector<std::string> differences_of(const RunOrigin& there, const RunOrigin& now) {
    std::vector<std::string> found;
    for (const auto& [name, unit] : origin_numbers) {
        const auto a = there.numbers.find(name), b = now.numbers.find(name);
        if (a != there.numbers.end() && b != now.numbers.end() && !same_number(a->second, b->second)) {
            found.push_back(name + ": " + geometry::shown_value(a->second, unit, 6) + " there, " +
                            geometry::shown_value(b->second, unit, 6) + " now");
        }
    }
    if (!same_shape(there, now)) {
        found.push_back("another shape: " + there.shape + " there, " + now.shape + " now");
    }
    if (!same_mesh(there, now)) {
        found.push_back("mesh: " + there.mesh + " there, " + now.mesh + " now");
    }
    return found;
}

/// A solved case in [design] folder.
struct SolvedRun {
    std::string fidelity;
    CaseRecord record;
    RunOrigin origin;
};

std::map<std::string, double> numbers_of(const CaseRecord& record) {
    std::map<std::string, double> numbers = {{"jet_flow", 0}};  // said where there is one
    for (const auto& [name, unit] : origin_numbers) {
        const auto found = std::find_if(record.made_of.begin(), record.made_of.end(),
                                        [&, key = name](const auto& item) { return item.first == key; });
        if (found != record.made_of.end()) {
            numbers[name] = core::parse_in(found->second, unit);
        }
    }
    return numbers;
}

std::string in_folders(std::string name) {
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
}

/// By fidelity and design.
using SolvedRuns = std::map<std::pair<std::string, std::string>, std::vector<SolvedRun>>;

SolvedRuns solved_runs(const DesignSpec& spec) {
    SolvedRuns runs;
    for (const FidelitySpec& fidelity : spec.fidelities) {
        std::error_code none;
        for (const auto& entry : fs::directory_iterator(spec.folder / "runs" / fidelity.name, none)) {
            const std::string name = entry.path().filename().string();
            const auto condition = name.rfind("-h");
            const std::string ending = entry.path().extension().string();
            if (condition == std::string::npos || ending == ".unfinished" || ending == ".failed" ||
                !fs::exists(entry.path() / solved_marker, none)) {
                continue;
            }
            if (const auto record = read_record(entry.path())) {
                const auto shape = shape_in(*record);
                runs[{fidelity.name, name.substr(0, condition)}].push_back(
                    {fidelity.name,
                     *record,
                     {numbers_of(*record), shape ? hash_of_base(spec, *shape) : std::string(), mesh_of(*record)}});
            }
        }
    }
    return runs;
}

/// What each row is of, by its columns and the runs that are there.
class Settler {
public:
    Settler(const DesignSpec& spec, const geometry::BodyShape& base, const DesignWater& water)
        : spec_(spec),
          base_(base),
          water_(water),
          all_(spec.all_variables()),
          solved_(solved_runs(spec)),
          moments_now_(moments_about(spec, water)) {}

    void settle(DesignRun& run) const {
        static const std::vector<SolvedRun> none;
        const auto of_design = solved_.find({run.fidelity, in_folders(run.design)});
        const SolvedRun* found = nullptr;
        std::vector<std::string> fewest;
        bool ambiguous = false;
        for (const SolvedRun& one : of_design == solved_.end() ? none : of_design->second) {
            if (!is_of(one, run)) {
                continue;
            }
            auto differs = against_now(one, run);
            ambiguous = ambiguous || (found != nullptr && filled(run, *found) != filled(run, one));
            if (found == nullptr || differs.size() < fewest.size()) {
                found = &one;
                fewest = std::move(differs);
            }
        }
        if (found != nullptr && !ambiguous) {
            const bool other_shape = std::any_of(fewest.begin(), fewest.end(), [](const std::string& text) {
                return text.starts_with("shape:") || text.find('.') < text.find(':');
            });
            take_over(*found, other_shape, run);
        } else if (const auto now = asked(run.at, run.fidelity)) {
            fewest = differences_of(run.origin, origin_of(spec_, base_, *now));
        }
        // The case does not say it: its loads are taken about another point without solving it again.
        if (!same_moments(run.origin, {{}, {}, {}, moments_now_})) {
            fewest.push_back("moments_about: " + run.origin.moments + " there, " + moments_now_ + " now");
        }
        for (const std::string& one : fewest) {
            run.other += (run.other.empty() ? "" : "; ") + one;
        }
    }

private:
    /// What the row does not say, by its run.
    void take_over(const SolvedRun& one, bool other_shape, DesignRun& run) const {
        run.at = filled(run, one);
        run.origin.numbers.insert(one.origin.numbers.begin(), one.origin.numbers.end());
        run.origin.mesh = run.origin.mesh.empty() ? one.origin.mesh : run.origin.mesh;
        if (run.origin.shape.empty()) {
            const bool tied_otherwise = other_shape && one.origin.shape == hash_of_base(spec_, base_);
            run.origin.shape = tied_otherwise ? one.record.shape.substr(0, 12) : one.origin.shape;
        }
    }

    /// Where the run stands among the numbers of the shape; what it does not tell is the row's.
    [[nodiscard]] std::vector<double> place_of(const SolvedRun& one, const DesignRun& run) const {
        std::vector<double> at = filled(run, one);
        for (std::size_t v = 0; v < spec_.variables.size(); ++v) {
            for (const auto& [name, value] : one.record.made_of) {
                at[v] = name == all_[v].name ? core::parse_in(value, all_[v].unit) : at[v];
            }
        }
        return at;
    }

    /// Rows may be rounded by whoever wrote them.
    [[nodiscard]] bool is_of(const SolvedRun& one, const DesignRun& run) const {
        const std::vector<double> at = place_of(one, run);
        RunOrigin known = run.origin;
        for (std::size_t v = 0; v < all_.size(); ++v) {
            const bool of_shape = v < spec_.variables.size();
            if (of_shape && std::abs(at[v] - run.at[v]) > 1e-3 * (all_[v].upper - all_[v].lower)) {
                return false;
            }
            if (!of_shape && std::isfinite(run.at[v])) {
                known.numbers.emplace(all_[v].name, run.at[v]);
            }
        }
        return agree(one.origin, known);
    }

    /// Where a row stands, with the conditions that it does not say.
    [[nodiscard]] std::vector<double> filled(const DesignRun& run, const SolvedRun& one) const {
        std::vector<double> at = run.at;
        for (std::size_t v = spec_.variables.size(); v < all_.size(); ++v) {
            const auto known = one.origin.numbers.find(all_[v].name);
            at[v] = std::isfinite(at[v]) || known == one.origin.numbers.end() ? at[v] : known->second;
        }
        return at;
    }

    [[nodiscard]] std::optional<CaseRecord> asked(const std::vector<double>& at, const std::string& fidelity) const {
        try {
            return asked_for(spec_, base_, water_, at, fidelity);
        } catch (const core::InputError&) {
            return {};  // no such shape: its state says so
        }
    }

    [[nodiscard]] std::vector<std::string> against_now(const SolvedRun& one, const DesignRun& run) const {
        const auto now = asked(place_of(one, run), one.fidelity);
        return now ? differences(one.record, *now) : std::vector<std::string>{};
    }

    const DesignSpec& spec_;
    const geometry::BodyShape& base_;
    const DesignWater& water_;
    std::vector<SearchVariable> all_;
    SolvedRuns solved_;
    std::string moments_now_;
};

}  // namespace

// The varied numbers stand in columns of their own, rounded by whoever wrote them.
std::string hash_of_base(const DesignSpec& spec, geometry::BodyShape shape) {
    try {
        for (const SearchVariable& v : spec.variables) {
            geometry::set_parameter(shape, v.name, "0.5");
        }
        for (const geometry::Tie& tie : spec.ties) {
            geometry::apply(tie, shape);
        }
        return geometry::shape_hash(shape).substr(0, 12);
    } catch (const core::InputError&) {
        return {};
    }
}

std::vector<OriginNumber> origin_columns(const DesignSpec& spec) {
    const auto all = spec.all_variables();
    std::vector<OriginNumber> columns;
    for (const OriginNumber& number : origin_numbers) {
        if (variable_named(all, number.name) == nullptr && (number.name != "jet_flow" || spec.jet.any())) {
            columns.push_back(number);
        }
    }
    return columns;
}

bool has_moments(const DesignSpec& spec) {
    return std::any_of(spec.quantities.begin(), spec.quantities.end(), [](const std::string& quantity) {
        return quantity.ends_with("_moment") && quantity != moment_at_buoyancy;
    });
}

std::string moments_about(const DesignSpec& spec, const DesignWater& water) {
    if (!has_moments(spec)) {
        return {};
    }
    if (!water.moments_about) {
        return "base_centre";
    }
    std::string point;
    for (const double x : *water.moments_about) {
        // The same number written in other units differs in its last bits.
        point += (point.empty() ? "" : " ") + core::format_number(x == 0 ? 0.0 : x, 12);
    }
    return point + " m";
}

RunOrigin origin_of(const DesignSpec& spec, const geometry::BodyShape& base, const CaseRecord& record) {
    return {numbers_of(record), hash_of_base(spec, base), mesh_of(record)};
}

bool agree(const RunOrigin& a, const RunOrigin& b) {
    return same_shape(a, b) && same_mesh(a, b) && same_moments(a, b) &&
           std::all_of(a.numbers.begin(), a.numbers.end(), [&](const auto& number) {
               const auto other = b.numbers.find(number.first);
               return other == b.numbers.end() || same_number(number.second, other->second);
           });
}

CaseRecord asked_for(const DesignSpec& spec, const geometry::BodyShape& base, const DesignWater& water,
                     const std::vector<double>& at, const std::string& fidelity) {
    const auto all = spec.all_variables();
    Conditions conditions;
    for (const ComputedCondition& c : spec.conditions()) {
        const SearchVariable* varied = variable_named(all, c.name);
        conditions.set(c.name,
                       varied != nullptr ? at[static_cast<std::size_t>(varied - all.data())] : c.values.front());
    }
    SweepSpec sweep;
    sweep.jet = spec.jet;
    sweep.kinematic_viscosity = spec.kinematic_viscosity;
    sweep.mesh = spec.fidelities[level_of(spec, fidelity, fidelity)].mesh;
    return record_of(shape_at(spec, base, at), flow_of(sweep, water.density, water.half, conditions));
}

void read_origins(const core::Table& table, const DesignSpec& spec, std::vector<DesignRun>& runs) {
    const auto all = spec.all_variables();
    for (const auto& [name, unit] : origin_numbers) {
        if (table.find(name) == nullptr || variable_named(all, name) != nullptr) {
            continue;
        }
        const auto& values = table.numbers(name);
        for (std::size_t i = 0; i < runs.size(); ++i) {
            if (std::isfinite(values[i])) {
                runs[i].origin.numbers[name] = values[i];
            }
        }
    }
    const auto text = [&](const char* name, std::string RunOrigin::*member) {
        for (std::size_t i = 0; table.find(name) != nullptr && i < runs.size(); ++i) {
            runs[i].origin.*member = table.text(name)[i];
        }
    };
    text("shape_hash", &RunOrigin::shape);
    text("mesh_settings", &RunOrigin::mesh);
    text("moments_about", &RunOrigin::moments);
}

void settle_origins(const core::Table& table, const DesignSpec& spec, const geometry::BodyShape& base,
                    const DesignWater& water, std::vector<DesignRun>& runs, core::Problems& notes) {
    const Settler settler(spec, base, water);
    std::vector<std::pair<std::string, std::size_t>> reasons;
    std::size_t left_out = 0, first = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        settler.settle(runs[i]);
        if (const std::string& other = runs[i].other; !other.empty()) {
            first = left_out++ == 0 ? i : first;
            auto reason = std::find_if(reasons.begin(), reasons.end(), [&](const auto& r) { return r.first == other; });
            (reason == reasons.end() ? reasons.insert(reason, {other, 0}) : reason)->second += 1;
        }
    }
    constexpr std::size_t most = 3;
    if (left_out > 0) {
        std::string text = core::counted_of(left_out, runs.size(), "row", "is", "are") +
                           " of something else than [design] asks for now, and left out: ";
        for (std::size_t r = 0; r < std::min(most, reasons.size()); ++r) {
            text += (r > 0 ? ", " : "") + std::to_string(reasons[r].second) + " (" + reasons[r].first + ")";
        }
        text += reasons.size() > most ? " and more" : "";
        notes.push_back({core::Problem::Severity::warning, text, table.place(first, "design")});
    }
}

void note_silent_rows(const DesignSpec& spec, const std::string& file, const std::vector<DesignRun>& runs,
                      core::Problems& notes) {
    std::vector<std::string> unsaid;
    std::size_t silent = 0;
    const auto columns = origin_columns(spec);
    for (const DesignRun& run : runs) {
        if (!run.counts() || run.loads.empty()) {
            continue;
        }
        std::vector<std::string> missing;
        for (const auto& column : columns) {
            if (!run.origin.numbers.contains(column.name)) {
                missing.push_back(column.name);
            }
        }
        if (run.origin.shape.empty()) {
            missing.emplace_back("shape_hash");
        }
        if (run.origin.mesh.empty()) {
            missing.emplace_back("mesh_settings");
        }
        if (has_moments(spec) && run.origin.moments.empty()) {
            missing.emplace_back("moments_about");
        }
        silent += missing.empty() ? 0 : 1;
        unsaid = missing.size() > unsaid.size() ? missing : unsaid;
    }
    std::string names;
    for (std::size_t k = 0; k < unsaid.size(); ++k) {
        names += (k == 0 ? "" : k + 1 < unsaid.size() ? ", " : " and ") + unsaid[k];
    }
    if (silent > 0) {
        notes.push_back({core::Problem::Severity::note,
                         core::counted_of(silent, runs.size(), "row", "does", "do") + " not say all of " + names +
                             ": taken as what [design] asks for now",
                         {file, {}, {}, {}}});
    }
}

void note_other_conditions(const DesignSpec& spec, const core::Table& table, core::Problems& notes) {
    for (const ComputedCondition& c : spec.conditions()) {
        if (c.values.size() < 2 || table.find(c.name) == nullptr) {
            continue;
        }
        const double low = c.values.front(), high = c.values.back();
        const double rounding = 1e-6 * std::max(high - low, std::max(std::abs(low), std::abs(high)));
        std::vector<double> other;
        std::size_t first = 0;
        const auto& at = table.numbers(c.name);
        for (std::size_t i = 0; i < at.size(); ++i) {
            if (at[i] < low - rounding || at[i] > high + rounding) {
                first = other.empty() ? i : first;
                other.push_back(at[i]);
            }
        }
        if (other.empty()) {
            continue;
        }
        const auto shown = [&](double from, double to) {
            return geometry::shown_value(from, c.unit, 6) +
                   (from < to ? " to " + geometry::shown_value(to, c.unit, 6) : "");
        };
        const auto [least, most] = std::minmax_element(other.begin(), other.end());
        notes.push_back({core::Problem::Severity::warning,
                         c.name + " is " + shown(*least, *most) + " in " + core::counted(other.size(), "row") +
                             ", and [design] computes " + shown(low, high) +
                             ": what is said there rests on rows that lie elsewhere",
                         table.place(first, c.name)});
    }
}

}  // namespace underbody::cases
