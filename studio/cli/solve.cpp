// underbody solve CASE: runs an OpenFOAM case. underbody sweep STUDY: CFD of the cases that a study misses.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "cases/openfoam_run.h"
#include "cases/sweep.h"
#include "core/file.h"
#include "core/own_files.h"
#include "core/parallel.h"
#include "core/text.h"
#include "postproc/importers/openfoam_forces.h"
#include "studio/cli/commands.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

namespace {

namespace fs = std::filesystem;

std::string seconds(double value) { return core::format_number(value, 3) + " s"; }

// ---- solve ----

nlohmann::json forces_of(const fs::path& folder) {
    nlohmann::json forces = nlohmann::json::array();
    for (const auto& history : postproc::read_openfoam_forces(folder)) {
        postproc::ForceHistory::Triple total{};
        for (std::size_t k = 0; k < 3; ++k) {
            total[k] = history.pressure_force.back()[k] + history.viscous_force.back()[k];
        }
        forces.push_back({{"name", history.name}, {"force", total}, {"patches", history.patches}});
    }
    return forces;
}

int solve(Shell& shell, const std::string& folder, bool again) {
    const bool before = !again && cases::is_solved(folder);
    double needed = 0;
    if (!before) {
        cases::OpenFoamRun run(folder);
        while (!run.finished()) {
            shell.progress().check();
            const auto state = cases::run_state(folder);
            shell.progress().report(state.fraction(), state.step + (state.iteration > 0 ? " " + std::to_string(state.iteration) + " of " + std::to_string(state.iterations) : ""));
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
        needed = run.seconds();
        if (!cases::is_solved(folder)) {
            throw core::InputError("solver", "the script ended without a solution", {(fs::path(folder) / "log.Allrun").string(), {}, {}, {}});
        }
    }
    const auto state = cases::run_state(folder);
    const auto forces = forces_of(folder);
    if (shell.json) {
        shell.print_json({{"case", folder}, {"solved_before", before}, {"iterations", state.iteration}, {"seconds", needed}, {"forces", forces}});
        return done;
    }
    shell.print(folder + (before ? ": solved before, nothing was run (--again runs it)" : ": solved in " + seconds(needed) + ", " + std::to_string(state.iteration) + " iterations"));
    for (const auto& entry : forces) {
        std::string numbers;
        for (const auto& number : entry["force"]) {
            numbers += (numbers.empty() ? "" : ", ") + core::format_number(number.get<double>(), 5);
        }
        shell.print("force of '" + entry["name"].get<std::string>() + "', in the case's axes and of the mesh: " + numbers + " N");
    }
    return done;
}

// ---- sweep ----

struct SweepArguments {
    std::string study, engine = "local", only, script;
    int jobs = 0;
    bool list = false;
};

int list_cases(Shell& shell, const cases::Study& study) {
    nlohmann::json all = nlohmann::json::array();
    for (const auto& one : cases::sweep_cases(study)) {
        all.push_back({{"name", one.name}, {"folder", one.folder.string()}, {"present", one.present}});
        shell.print((one.present ? "present  " : "missing  ") + one.name + "  " + one.conditions.label());
    }
    if (shell.json) {
        shell.print_json({{"cases", all}});
    }
    return done;
}

int submit(Shell& shell, const cases::Study& study, const SweepArguments& given) {
    const std::string script = cases::slurm_script(study, fs::read_symlink("/proc/self/exe").string());
    if (script.empty()) {
        shell.print("nothing is missing");
        if (shell.json) {
            shell.print_json({{"missing", 0}});
        }
        return done;
    }
    const fs::path file = given.script.empty() ? study.folder() / study.sweep->folder / "sweep.sh" : fs::path(given.script);
    core::write_file(file, script);
    const auto sbatch = cases::find_program("sbatch");
    std::string answer;
    if (sbatch) {
        const core::TemporaryFolder scratch;
        const fs::path log = scratch.path() / "sbatch";
        cases::ChildProcess child(sbatch->string(), {"--parsable", fs::absolute(file).string()}, fs::absolute(file).parent_path(), log);
        while (!child.ended()) {
            shell.progress().check();
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        answer = std::string(core::trimmed(core::read_file(log)));
        if (*child.ended() != 0) {
            throw core::SystemError("slurm", "sbatch refused the job: " + answer, {file.string(), {}, {}, {}});
        }
    }
    shell.print("wrote " + file.string() + (sbatch ? "; submitted as job " + answer : "; 'sbatch' is not here: submit it where Slurm is, in a folder that both machines see"));
    if (shell.json) {
        shell.print_json({{"script", file.string()}, {"job", sbatch ? nlohmann::json(answer) : nlohmann::json(nullptr)}});
    }
    return done;
}

int sweep(Shell& shell, const SweepArguments& given) {
    const auto study = cases::Study::open(given.study);
    if (given.list) {
        return list_cases(shell, study);
    }
    if (given.engine == "slurm") {
        return submit(shell, study, given);
    }
    cases::SweepOptions options;
    options.jobs = given.jobs > 0 ? given.jobs : static_cast<int>(core::threads());
    if (!given.only.empty()) {
        options.only = given.only;
    }
    const auto outcomes = cases::sweep_locally(study, options, shell.progress());
    int failed = 0;
    nlohmann::json all = nlohmann::json::array();
    for (const auto& one : outcomes) {
        failed += one.error.empty() ? 0 : 1;
        all.push_back({{"name", one.name}, {"seconds", one.seconds}, {"error", one.error}});
        if (one.error.empty()) {
            shell.print(one.name + ": solved in " + seconds(one.seconds));
        } else {
            shell.warn(one.name + ": " + one.error);
        }
    }
    if (outcomes.empty()) {
        shell.print("nothing is missing");
    } else if (failed < static_cast<int>(outcomes.size())) {
        shell.info("the study has the new cases: underbody study run " + given.study);
    }
    if (shell.json) {
        shell.print_json({{"cases", all}, {"failed", failed}});
    }
    return failed > 0 ? wrong_input : done;
}

}  // namespace

void add_solve_command(CLI::App& app, Shell& shell) {
    auto* command = app.add_subcommand("solve", "runs an OpenFOAM case: mesh, solver, forces");
    struct Arguments {
        std::string folder;
        bool again = false;
    };
    auto o = std::make_shared<Arguments>();
    command->add_option("case", o->folder, "folder of the case, with an Allrun, as `underbody body domain` writes it")->required();
    command->add_flag("--again", o->again, "also when it is solved already");
    command->footer(
        "Examples:\n"
        "  underbody solve case\n"
        "  underbody solve case --json\n"
        "Needs OpenFOAM (Debian: openfoam). Ctrl-C ends the solver too; the logs stay in the folder.");
    shell.on(command, [&shell, o] {
        const core::ReplacingAllowed the_case;
        return solve(shell, o->folder, o->again);
    });
}

void add_sweep_command(CLI::App& app, Shell& shell) {
    auto* command = app.add_subcommand("sweep", "CFD of the cases that a study wants and does not have");
    auto o = std::make_shared<SweepArguments>();
    command->add_option("study", o->study, "folder with study.toml, which has a [sweep]")->required();
    command->add_option("--engine", o->engine, "local: OpenFOAM on this machine; slurm: a job array")->check(CLI::IsMember({"local", "slurm"}))->capture_default_str();
    command->add_option("--jobs", o->jobs, "local: cases at a time, each on one core (default: all cores)")->check(CLI::Range(1, 1024));
    command->add_option("--only", o->only, "local: this case alone, by name");
    command->add_option("--script", o->script, "slurm: where the batch script goes (default: sweep.sh beside the cases)");
    command->add_flag("--list", o->list, "only say which cases are there and which are missing");
    command->footer(
        "Examples:\n"
        "  underbody sweep mystudy --list\n"
        "  underbody sweep mystudy --jobs 2\n"
        "  underbody sweep mystudy --engine slurm\n"
        "In study.toml:\n"
        "  [sweep]\n"
        "  bodies = [\"ellipse\"]                 # names of [[body]]; default all\n"
        "  gap = [\"2 mm\", \"5 mm\"]\n"
        "  pitch = [\"0 deg\", \"2 deg\"]\n"
        "  speed = \"0.5 m/s\"\n"
        "  # folder, conditions, kinematic_viscosity, cell, surface_level, layers, iterations\n"
        "Solved cases belong to the study without a [[case]]. A sweep that was stopped goes on where it was.");
    shell.on(command, [&shell, o] {
        const core::ReplacingAllowed the_cases;
        return sweep(shell, *o);
    });
}

}  // namespace underbody::studio
