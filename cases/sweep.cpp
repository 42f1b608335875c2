#include "cases/sweep.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "cases/openfoam_run.h"
#include "core/file.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/body_shape.h"
#include "geometry/body_surface.h"
#include "geometry/flow_domain.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

const SweepSpec& spec_of(const Study& study) {
    if (!study.sweep) {
        throw core::InputError("missing", "the study has no [sweep]", {(study.folder() / "study.toml").string(), {}, {}, {}},
                               "for instance [sweep] with bodies = [\"ellipse\"], gap = [\"2 mm\", \"5 mm\"], pitch = [\"0 deg\"], speed = \"0.5 m/s\"");
    }
    const bool mirrored = study.symmetry.empty() || study.symmetry == "y";
    if (study.forward != "+x" || study.up != "+z" || !mirrored) {
        throw core::InputError("range", "the cases of a sweep have x forward, z up and their symmetry plane at y = 0; the study's [frame] says otherwise",
                               {(study.folder() / "study.toml").string(), {}, {}, {}}, "a study of its own for the sweep");
    }
    return *study.sweep;
}

/// "ellipse-h5-p0-u0.5"; blanks become underscores, so that the name can be a folder and a pattern finds its parts.
std::string name_for(const std::string& body, double gap, double pitch, double speed) {
    std::string name = body + "-h" + core::format_number(1000 * gap, 6) + "-p" + core::format_number(core::convert(pitch, "rad", "deg"), 6) + "-u" + core::format_number(speed, 6);
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
}

nlohmann::json marker_of(const fs::path& folder) {
    std::error_code ignored;
    const fs::path file = folder / solved_marker;
    if (!fs::is_regular_file(file, ignored)) {
        return nullptr;
    }
    const auto json = nlohmann::json::parse(core::read_file(file), nullptr, false);
    return json.is_object() && json.contains("walls") ? json : nlohmann::json(nullptr);
}

geometry::FlowOptions flow_of(const Study& study, const SweepCase& one) {
    const SweepSpec& spec = spec_of(study);
    geometry::FlowOptions flow;
    flow.placement.gap = one.conditions.number("gap").value_or(0);
    flow.placement.pitch = one.conditions.number("pitch").value_or(0);
    flow.speed = one.conditions.number("speed").value_or(flow.speed);
    flow.density = study.reference.number("density").value_or(flow.density);
    flow.kinematic_viscosity = spec.kinematic_viscosity;
    flow.half = !study.symmetry.empty();
    flow.cell = spec.cell;
    flow.surface_level = spec.surface_level;
    flow.layers = spec.layers;
    flow.iterations = spec.iterations;
    return flow;
}

}  // namespace

std::vector<SweepCase> sweep_cases(const Study& study) {
    const SweepSpec& spec = spec_of(study);
    std::vector<SweepCase> cases;
    for (const auto& body : spec.bodies) {
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
                    one.folder = study.folder() / spec.folder / one.name;
                    one.present = !marker_of(one.folder).is_null() || !study.select(one.conditions).empty();
                    cases.push_back(std::move(one));
                }
            }
        }
    }
    return cases;
}

std::vector<Case> solved_cases(const Study& study) {
    std::vector<Case> cases;
    if (!study.sweep) {
        return cases;
    }
    for (const auto& wanted : sweep_cases(study)) {
        const auto marker = marker_of(wanted.folder);
        if (!marker.is_null()) {
            cases.push_back({wanted.name, wanted.folder / solved_marker, wanted.conditions, marker["walls"].get<std::vector<std::string>>()});
        }
    }
    return cases;
}

namespace {

/// The cases to make: those that are missing, or the one that was named.
std::vector<SweepCase> wanted_cases(const Study& study, const std::optional<std::string>& only) {
    std::vector<SweepCase> wanted;
    std::vector<std::string> names;
    for (auto& one : sweep_cases(study)) {
        names.push_back(one.name);
        if (!one.present && (!only || *only == one.name)) {
            wanted.push_back(std::move(one));
        }
    }
    if (only && std::find(names.begin(), names.end(), *only) == names.end()) {
        throw core::InputError("name", "the sweep has no case '" + *only + "'", {(study.folder() / "study.toml").string(), {}, {}, {}}, core::did_you_mean(*only, names));
    }
    return wanted;
}

/// One case in the making.
struct Job {
    SweepCase wanted;
    std::vector<std::string> walls;
    std::unique_ptr<OpenFoamRun> run;
    SweepOutcome outcome;
    bool started = false;
    bool over = false;
};

fs::path beside(const fs::path& folder, const char* ending) { return folder.parent_path() / (folder.filename().string() + ending); }

class Sweep {
public:
    Sweep(const Study& study, const SweepOptions& options, core::Progress& progress) : study_(study), options_(options), progress_(progress) {
        for (auto& wanted : wanted_cases(study, options.only)) {
            Job job;
            job.outcome.name = wanted.name;
            job.wanted = std::move(wanted);
            jobs_.push_back(std::move(job));
        }
    }

    std::vector<SweepOutcome> run() {
        if (!jobs_.empty()) {
            need_openfoam();
        }
        while (true) {
            progress_.check();  // children end with their jobs
            const auto running = std::count_if(jobs_.begin(), jobs_.end(), [](const Job& job) { return job.started && !job.over; });
            const auto next = std::find_if(jobs_.begin(), jobs_.end(), [](const Job& job) { return !job.started; });
            if (running == 0 && next == jobs_.end()) {
                break;
            }
            if (next != jobs_.end() && running < std::max(1, options_.jobs)) {
                start(*next);
                continue;
            }
            watch();
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        std::vector<SweepOutcome> outcomes;
        for (auto& job : jobs_) {
            outcomes.push_back(std::move(job.outcome));
        }
        return outcomes;
    }

private:
    void start(Job& job) {
        job.started = true;
        const fs::path folder = beside(job.wanted.folder, ".unfinished");
        fs::remove_all(folder);  // of a sweep that was killed
        const auto mesh = geometry::make_surface(geometry::read_shape(job.wanted.shape), {}, progress_);
        const auto flow = flow_of(study_, job.wanted);
        try {
            job.walls = geometry::flow_domain(mesh, flow).walls;
            geometry::write_openfoam_case(mesh, flow, folder);
        } catch (const core::InputError& error) {  // this body cannot be placed so; others can
            fail(job, error.what());
            return;
        }
        job.run = std::make_unique<OpenFoamRun>(folder);
    }

    void watch() {
        double done = 0;
        std::string what;
        for (auto& job : jobs_) {
            if (job.over || !job.started) {
                done += job.over ? 1 : 0;
                continue;
            }
            try {
                if (job.run->finished()) {
                    finish(job);
                }
            } catch (const core::InputError& error) {
                const fs::path failed = beside(job.wanted.folder, ".failed");
                fs::remove_all(failed);
                fs::rename(job.run->folder(), failed);
                std::string text = error.what();
                if (const auto at = text.find(job.run->folder().string()); at != std::string::npos) {
                    text.replace(at, job.run->folder().string().size(), failed.string());
                }
                fail(job, text);
            }
            if (!job.over) {
                const RunState state = run_state(job.run->folder());
                done += state.fraction();
                what += (what.empty() ? "" : ", ") + job.wanted.name + " " + (state.iteration > 0 ? std::to_string(state.iteration) + "/" + std::to_string(state.iterations) : state.step);
            } else {
                done += 1;
            }
        }
        progress_.report(done / static_cast<double>(jobs_.size()), what);
    }

    void fail(Job& job, const std::string& error) {
        job.outcome.error = error;
        job.over = true;
        job.run.reset();
    }

    void finish(Job& job) {
        const fs::path folder = job.run->folder();
        job.outcome.seconds = job.run->seconds();
        if (!is_solved(folder)) {
            throw core::InputError("solver", "the script ended without a solution", {(folder / "log.Allrun").string(), {}, {}, {}});
        }
        nlohmann::json marker = {{"walls", job.walls}, {"seconds", job.outcome.seconds}, {"iterations", run_state(folder).iteration}, {"conditions", nlohmann::json::object()}};
        for (const auto& [name, value] : job.wanted.conditions.texts) {
            marker["conditions"][name] = value;
        }
        for (const auto& [name, value] : job.wanted.conditions.numbers) {
            marker["conditions"][name] = value;
        }
        core::write_file(folder / solved_marker, marker.dump(2) + "\n");
        job.run.reset();
        fs::rename(folder, job.wanted.folder);
        std::error_code ignored;
        fs::remove_all(beside(job.wanted.folder, ".failed"), ignored);  // an earlier attempt
        job.over = true;
    }

    const Study& study_;
    const SweepOptions& options_;
    core::Progress& progress_;
    std::vector<Job> jobs_;
};

/// A word for the shell.
std::string quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : text) {
        result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    }
    return result + "'";
}

}  // namespace

std::vector<SweepOutcome> sweep_locally(const Study& study, const SweepOptions& options, core::Progress& progress) { return Sweep(study, options, progress).run(); }

std::string slurm_script(const Study& study, const std::string& program) {
    const auto missing = wanted_cases(study, std::nullopt);
    if (missing.empty()) {
        return {};
    }
    std::string title = study.title;
    std::replace(title.begin(), title.end(), '\n', ' ');
    const std::string folder = fs::absolute(study.folder()).lexically_normal().string();
    std::string script = "#!/bin/sh\n# One task for each case that the study '" + title + "' misses.\n#SBATCH --job-name=underbody-sweep\n#SBATCH --array=1-" +
                         std::to_string(missing.size()) + "\n#SBATCH --ntasks=1\n#SBATCH --cpus-per-task=1\ncase \"$SLURM_ARRAY_TASK_ID\" in\n";
    for (std::size_t i = 0; i < missing.size(); ++i) {
        script += std::to_string(i + 1) + ") name=" + quoted(missing[i].name) + " ;;\n";
    }
    return script + "*) echo 'run this as a Slurm job array' >&2; exit 2 ;;\nesac\nexec " + quoted(program) + " sweep " + quoted(folder) + " --engine local --only \"$name\"\n";
}

}  // namespace underbody::cases
