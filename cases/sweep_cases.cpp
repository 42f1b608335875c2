// Which cases a sweep wants, and how far each is.
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "cases/lock.h"
#include "cases/openfoam_result.h"
#include "cases/openfoam_run.h"
#include "cases/sweep.h"
#include "cases/sweep_parts.h"
#include "cases/sweep_slurm.h"
#include "core/counted.h"
#include "core/file.h"
#include "core/inputs.h"
#include "core/own_files.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/body/body_surface.h"
#include "geometry/cases/flow_domain.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

const SweepSpec& spec_of(const Study& study) {
    if (!study.sweep) {
        throw core::InputError("missing", "the study has no [sweep]",
                               {(study.folder() / "study.toml").string(), {}, {}, {}},
                               "for instance [sweep] with bodies = [\"ellipse\"], gap = [\"2 mm\", \"5 mm\"], pitch = "
                               "[\"0 deg\"], speed = \"0.5 m/s\"");
    }
    const bool mirrored = study.symmetry.empty() || study.symmetry == "y";
    if (study.forward != "+x" || study.up != "+z" || !mirrored) {
        throw core::InputError("range",
                               "the cases of a sweep have x forward, z up and their symmetry plane at y = 0; the "
                               "study's [frame] says otherwise",
                               {(study.folder() / "study.toml").string(), {}, {}, {}},
                               "a study of its own for the sweep");
    }
    return *study.sweep;
}

/// "ellipse-h5-p0-u0.5"; blanks become underscores, so that the name can be a folder and a pattern finds its parts.
std::string name_for(const std::string& body, double gap, double pitch, double speed) {
    std::string name = body + "-h" + core::format_number(1000 * gap, 6) + "-p" +
                       core::format_number(core::convert(pitch, "rad", "deg"), 6) + "-u" +
                       core::format_number(speed, 6);
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
}

}  // namespace

fs::path beside(const fs::path& folder, const char* ending) {
    return folder.parent_path() / (folder.filename().string() + ending);
}

geometry::FlowOptions flow_of(const Study& study, const Conditions& conditions) {
    return flow_of(spec_of(study), study.reference.number("density"), !study.symmetry.empty(), conditions);
}

geometry::FlowOptions flow_of(const SweepSpec& spec, std::optional<double> density, bool half,
                              const Conditions& conditions) {
    geometry::FlowOptions flow;
    flow.placement.gap = conditions.number("gap").value_or(0);
    flow.placement.pitch = conditions.number("pitch").value_or(0);
    flow.speed = conditions.number("speed").value_or(flow.speed);
    flow.density = density.value_or(flow.density);
    flow.kinematic_viscosity = spec.kinematic_viscosity;
    flow.half = half;
    flow.jet_flow = spec.jet.flow(conditions);
    spec.mesh.put_into(flow);
    return flow;
}

nlohmann::json read_marker(const fs::path& file) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) {
        return nullptr;
    }
    const auto json = nlohmann::json::parse(core::read_file(file), nullptr, false);
    return json.is_object() && json.contains("walls") && json["walls"].is_array() ? json : nlohmann::json(nullptr);
}

std::optional<CaseRecord> read_record(const fs::path& folder) {
    const fs::path file = folder / record_file;
    std::error_code ignored;
    return fs::is_regular_file(file, ignored)
               ? record_from(nlohmann::json::parse(core::read_file(file), nullptr, false))
               : std::nullopt;
}

void write_record(const fs::path& folder, const CaseRecord& record) {
    const core::ReplacingAllowed of_this_program;  // copied with its study it has lost what says so
    core::write_file(folder / record_file, to_json(record).dump(1) + "\n");
}

const geometry::BodyShape& Bodies::shape(const fs::path& file) {
    auto found = shapes_.find(file);
    if (found == shapes_.end()) {
        found = shapes_.emplace(file, geometry::read_shape(file)).first;
    }
    return found->second;
}

const geometry::SurfaceMesh& Bodies::surface(const fs::path& file, core::Progress& progress) {
    auto found = surfaces_.find(file);
    if (found == surfaces_.end()) {
        found = surfaces_.emplace(file, geometry::make_surface(shape(file), {}, progress)).first;
    }
    return found->second;
}

namespace {

/// Every case by name and conditions, whatever is there of it.
std::vector<SweepCase> asked_for(const Study& study) {
    const SweepSpec& spec = spec_of(study);
    std::vector<SweepCase> cases;
    for (const auto& body : spec.bodies) {
        for (std::size_t jet = 0; jet < spec.jet.count(); ++jet) {
            for (const double speed : spec.speeds) {
                for (const double pitch : spec.pitches) {
                    for (const double gap : spec.gaps) {
                        SweepCase one;
                        one.name = name_for(body.name, gap, pitch, speed);
                        one.shape = body.shape;
                        one.conditions = spec.conditions;
                        one.conditions.texts.insert(one.conditions.texts.begin(), {"variant", body.name});
                        for (const auto& [name, value] : {std::pair{"gap", gap}, {"pitch", pitch}, {"speed", speed}}) {
                            one.conditions.numbers.emplace_back(name, value);
                        }
                        if (spec.jet.any()) {
                            one.name += spec.jet.ending(spec.jet.values[jet]);
                            one.conditions.numbers.emplace_back(spec.jet.quantity, spec.jet.values[jet]);
                        }
                        one.folder = study.folder() / spec.folder / one.name;
                        cases.push_back(std::move(one));
                    }
                }
            }
        }
    }
    return cases;
}

std::string joined(const std::vector<std::string>& texts, const char* between, std::size_t most = 4) {
    std::string text;
    for (std::size_t i = 0; i < std::min(texts.size(), most); ++i) {
        text += (i > 0 ? between : "") + texts[i];
    }
    return text + (texts.size() > most ? between + std::to_string(texts.size() - most) + " more" : "");
}

/// Cases of a study by the numbers of their conditions: of ten thousand few have one value of the number that differs
/// most.
class CasesByNumber {
public:
    explicit CasesByNumber(const Study& study) : study_(study) {
        for (const Case& entry : study.cases) {
            for (const auto& [name, value] : entry.conditions.numbers) {
                by_number_[name].emplace_back(value, &entry);
            }
        }
        for (auto& [name, list] : by_number_) {
            std::sort(list.begin(), list.end());
        }
    }

    /// A case with these conditions whose file does not lie in the case's own folder.
    [[nodiscard]] bool have_another(const SweepCase& one) const {
        const fs::path own = one.folder.lexically_normal();
        const auto other = [&](const Case& entry) {
            return entry.conditions.satisfies(one.conditions) && entry.file.lexically_normal() != own &&
                   entry.file.parent_path().lexically_normal() != own;
        };
        std::optional<std::pair<List::const_iterator, List::const_iterator>> fewest;
        for (const auto& [name, value] : one.conditions.numbers) {
            const auto found = by_number_.find(name);
            if (found == by_number_.end()) {
                return false;
            }
            const double slack = 1e-8 * std::abs(value) + 1e-14;  // wider than Conditions::satisfies
            const auto less = [](const Entry& entry, double bound) { return entry.first < bound; };
            const List& list = found->second;
            const auto first = std::lower_bound(list.begin(), list.end(), value - slack, less);
            const auto last = std::lower_bound(first, list.end(), value + slack, less);
            if (!fewest || last - first < fewest->second - fewest->first) {
                fewest = {first, last};
            }
        }
        return fewest ? std::any_of(fewest->first, fewest->second,
                                    [&](const Entry& entry) { return other(*entry.second); })
                      : std::any_of(study_.cases.begin(), study_.cases.end(), other);
    }

private:
    using Entry = std::pair<double, const Case*>;
    using List = std::vector<Entry>;
    const Study& study_;
    std::map<std::string, List> by_number_;
};

/// "40 s", "12 min", "3 h"
std::string in_words(double seconds) {
    return seconds < 100    ? core::format_number(std::ceil(seconds)) + " s"
           : seconds < 6000 ? core::format_number(std::ceil(seconds / 60)) + " min"
                            : core::format_number(std::ceil(seconds / 3600)) + " h";
}

/// How far the one that is in the making has come: "iteration 150 of 400, at most 12 min left".
std::string how_far(SweepCase& one, const fs::path& unfinished, bool runs) {
    const RunState state = run_state(unfinished);
    one.iteration = state.iteration;
    one.iterations = state.iterations;
    if (runs && state.seconds_left) {
        one.seconds_left = state.seconds_left;
        return "iteration " + std::to_string(state.iteration) + " of " + std::to_string(state.iterations) +
               ", at most " + in_words(*state.seconds_left) + " left";
    }
    return state.iteration > 0
               ? "iteration " + std::to_string(state.iteration) + " of " + std::to_string(state.iterations)
           : state.step.empty() ? "begun"
                                : state.step;
}

/// What the last failed attempt said.
std::string failure_of(const fs::path& failed) {
    const fs::path file = failed / failure_file;
    std::error_code ignored;
    return fs::is_regular_file(file, ignored) ? std::string(core::trimmed(core::read_file(file)))
                                              : "see its logs in " + failed.filename().string();
}

/// States of the cases of a study, one after the other.
class Examiner {
public:
    Examiner(const Study& study, core::Progress& progress, std::string submission = {})
        : study_(study), known_(study), progress_(progress), submission_(std::move(submission)) {}

    void examine(SweepCase& one) {
        progress_.check();
        const auto marker = read_marker(one.folder / solved_marker);
        if (!marker.is_null()) {
            one.reason = what_is_stale(one, marker);
            one.state = one.reason.empty() ? SweepState::solved : SweepState::stale;
        }
        if (one.state != SweepState::solved && known_.have_another(one)) {
            one.state = SweepState::present;
            one.reason.clear();
        }
        one.present = one.state == SweepState::solved || one.state == SweepState::present;
        if (!one.present) {
            find_out_who_makes_it(one);
        }
    }

    /// The caller has the lock of what it asks about.
    void holds_locks() { holds_locks_ = true; }

    /// Cases of other versions whose files are those of this one need not be compared again.
    void write_confirmed() const {
        for (const auto& [folder, record] : confirmed_) {
            write_record(folder, record);
        }
    }

    /// What the case itself says of what it is made of, against what is asked for now.
    std::vector<std::string> quick_differences(const SweepCase& one, const CaseRecord& record) {
        return differences(record, record_of(bodies_.shape(one.shape), flow_of(study_, one.conditions)));
    }

private:
    std::string what_is_stale(const SweepCase& one, const nlohmann::json& marker) {
        const std::string cut = what_is_cut(one.folder, marker);
        if (!cut.empty()) {
            return cut;
        }
        const auto record = read_record(one.folder);
        if (record) {
            const auto differs = quick_differences(one, *record);
            if (!differs.empty()) {
                return joined(differs, "; ");
            }
            const auto touched = changed_since_solved(one.folder, *record);
            if (!touched.empty()) {
                return "changed since it was solved: " + joined(touched, ", ");
            }
            if (record->code == code_now()) {
                return {};
            }
        }
        // Solved by another version: what would be written now?
        CaseRecord there = record.value_or(CaseRecord{});
        there.files = case_files(one.folder);
        std::vector<std::string> differs;
        try {
            differs = different_files(there, written_now(one));
        } catch (const core::InputError& error) {
            return std::string("solved by another version of the program; this one cannot write the case: ") +
                   error.what();
        }
        if (differs.empty()) {
            const auto now = record_of(bodies_.shape(one.shape), flow_of(study_, one.conditions));
            confirmed_.emplace_back(one.folder, CaseRecord{now.made_of, now.shape, now.code, there.files,
                                                           marker["walls"].get<std::vector<std::string>>()});
            return {};
        }
        return std::string("solved by another version of the program, which ") +
               (record ? "wrote" : "left no record of what it is made of and wrote") +
               " other case files: " + joined(differs, ", ");
    }

    /// Files that were there and are other ones now; what the mesher adds is no part of it. Files that are older than
    /// the marker, which was written when all was over, need not be read: by the time that users can set and by the one
    /// that they cannot.
    static std::vector<std::string> changed_since_solved(const fs::path& folder, const CaseRecord& record) {
        const core::FileStamp solved = core::stamp_of(folder / solved_marker);
        const bool untouched = std::all_of(record.files.begin(), record.files.end(), [&](const auto& file) {
            const core::FileStamp now = core::stamp_of(folder / file.first);
            return now.kind == core::FileStamp::Kind::file && now.modified <= solved.modified &&
                   now.changed <= solved.changed;
        });
        std::vector<std::string> names;
        if (untouched) {
            return names;
        }
        const auto now = case_files(folder);
        for (const auto& [name, hash] : record.files) {
            const auto found = now.find(name);
            if (found == now.end() || found->second != hash) {
                names.push_back(name);
            }
        }
        return names;
    }

    /// Fields that the finished solve had and that are gone or shorter.
    static std::string what_is_cut(const fs::path& folder, const nlohmann::json& marker) {
        if (!marker.contains("result") || !marker["result"].is_object()) {
            const SolveEnd end = solve_end(folder);
            return end.solved ? "" : "not solved to its end: " + end.why;
        }
        for (const auto& [name, size] : marker["result"].items()) {
            std::error_code error;
            const auto bytes = fs::file_size(folder / name, error);
            if (error || !size.is_number() || bytes != size.get<std::uintmax_t>()) {
                return name + (error ? " is gone" : " has " + std::to_string(bytes) + " bytes, it had " + size.dump());
            }
        }
        return {};
    }

    std::string code_now() { return record_of({}, {}).code; }

    CaseRecord written_now(const SweepCase& one) {
        const core::TemporaryFolder scratch("underbody-sweep");
        const fs::path folder = scratch.path() / "case";
        CaseRecord record;
        geometry::write_openfoam_case(bodies_.shape(one.shape), flow_of(study_, one.conditions), folder, progress_);
        record.files = case_files(folder);
        return record;
    }

    void find_out_who_makes_it(SweepCase& one) {
        const fs::path unfinished = beside(one.folder, ".unfinished");
        std::error_code ignored;
        if (const auto holder = holds_locks_ ? std::nullopt : Lock::holder(beside(one.folder, ".lock"))) {
            one.state = SweepState::running;
            one.reason = how_far(one, unfinished, true) + ", by " + *holder;
            return;
        }
        if (const auto claim = read_claim(one.folder); claim && claim->submission != submission_) {
            const auto state = queue_.state(*claim);
            const std::string job =
                claim->job.empty() ? "" : " as job " + claim->job + "_" + std::to_string(claim->task);
            if (!state || !state->empty()) {
                one.state = state && *state == "RUNNING" ? SweepState::running : SweepState::waiting;
                const std::string far =
                    one.state == SweepState::running ? ", " + how_far(one, unfinished, true) : std::string();
                one.reason = "submitted" + job + ", " + claim->since +
                             (state ? ": " + core::lower_case(*state)
                                    : "; Slurm cannot be asked here: remove " + claim_file(one.folder).string() +
                                          " if it is gone") +
                             far;
                return;
            }
        }
        if (one.state == SweepState::missing && fs::is_directory(unfinished, ignored)) {
            one.reason = "cut at " + how_far(one, unfinished, false);
        } else if (one.state == SweepState::missing && fs::is_directory(beside(one.folder, ".failed"), ignored)) {
            one.state = SweepState::failed;
            one.reason = failure_of(beside(one.folder, ".failed"));
        }
    }

    const Study& study_;
    const CasesByNumber known_;
    core::Progress& progress_;
    std::string submission_;
    bool holds_locks_ = false;
    Bodies bodies_;
    SlurmQueue queue_;
    std::vector<std::pair<fs::path, CaseRecord>> confirmed_;
};

}  // namespace

std::string to_string(SweepState state) {
    static const std::map<SweepState, std::string> names = {
        {SweepState::missing, "missing"}, {SweepState::present, "present"}, {SweepState::solved, "solved"},
        {SweepState::stale, "stale"},     {SweepState::waiting, "waiting"}, {SweepState::running, "running"},
        {SweepState::failed, "failed"}};
    return names.at(state);
}

std::vector<SweepCase> sweep_cases(const Study& study, core::Progress& progress) {
    auto cases = asked_for(study);
    Examiner examiner(study, progress);
    for (auto& one : cases) {
        examiner.examine(one);
    }
    return cases;
}

void examine_again(const Study& study, SweepCase& one, const std::string& submission, core::Progress& progress) {
    one.state = SweepState::missing;
    one.reason.clear();
    Examiner examiner(study, progress, submission);
    examiner.holds_locks();
    examiner.examine(one);
}

namespace {

void note_thin_gaps(const Study& study, const std::vector<Case>& cases, core::Problems& notes) {
    std::vector<std::string> thin;
    double thinnest = geometry::smallest_tried_gap;
    for (const auto& one : cases) {
        const double gap = one.conditions.number("gap").value_or(thinnest);
        if (gap < geometry::smallest_tried_gap) {
            thin.push_back(one.name);
            thinnest = std::min(thinnest, gap);
        }
    }
    if (!thin.empty()) {
        notes.push_back({core::Problem::Severity::warning,
                         core::counted(thin.size(), "case") + " (" + joined(thin, ", ", 3) +
                             "): " + geometry::doubt_of_gap(thinnest),
                         {(study.folder() / "study.toml").string(), {}, {}, {}}});
    }
}

}  // namespace

std::vector<Case> solved_cases(const Study& study, core::Problems& notes) {
    std::vector<Case> cases;
    if (!study.sweep) {
        return cases;
    }
    Examiner examiner(study, core::Progress::none());
    std::vector<std::string> stale;
    for (const auto& wanted : asked_for(study)) {
        const auto marker = read_marker(wanted.folder / solved_marker);
        if (marker.is_null()) {
            continue;
        }
        if (const auto record = read_record(wanted.folder)) {
            std::vector<std::string> differs;
            try {
                differs = examiner.quick_differences(wanted, *record);
            } catch (const core::InputError&) {
                // The shape's own readers tell what is wrong with it.
            }
            if (!differs.empty()) {
                stale.push_back(wanted.name + " (" + joined(differs, "; ", 2) + ")");
                continue;
            }
        }
        Case solved;
        solved.name = wanted.name;
        solved.file = wanted.folder / solved_marker;
        solved.conditions = wanted.conditions;
        solved.zones = marker["walls"].get<std::vector<std::string>>();
        cases.push_back(std::move(solved));
    }
    note_thin_gaps(study, cases, notes);
    if (!stale.empty()) {
        notes.push_back(
            {core::Problem::Severity::warning,
             std::to_string(stale.size()) + (stale.size() == 1 ? " case of the sweep is" : " cases of the sweep are") +
                 " solved for something else than study.toml asks for now, and left out: " + joined(stale, ", ", 3),
             {(study.folder() / "study.toml").string(), {}, {}, {}}});
    }
    return cases;
}

std::vector<SweepCase> wanted_cases(const Study& study, const SweepOptions& options, core::Progress& progress) {
    auto cases = asked_for(study);
    if (options.only &&
        std::none_of(cases.begin(), cases.end(), [&](const SweepCase& one) { return one.name == *options.only; })) {
        std::vector<std::string> names;
        for (const auto& one : cases) {
            names.push_back(one.name);
        }
        throw core::InputError("name", "the sweep has no case '" + *options.only + "'",
                               {(study.folder() / "study.toml").string(), {}, {}, {}},
                               core::did_you_mean(*options.only, names));
    }
    std::vector<SweepCase> wanted;
    Examiner examiner(study, progress, options.submission);
    for (auto& one : cases) {
        if ((options.only && one.name != *options.only) || (options.wanted && !options.wanted(one))) {
            continue;
        }
        examiner.examine(one);
        if (!one.present && !(one.state == SweepState::stale && options.stale == StaleCases::keep)) {
            wanted.push_back(std::move(one));
        }
    }
    examiner.write_confirmed();
    return wanted;
}

}  // namespace underbody::cases
