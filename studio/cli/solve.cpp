// underbody solve CASE: runs an OpenFOAM case. underbody sweep STUDY: CFD of the cases that a study misses.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "cases/ask_cfd.h"
#include "cases/openfoam_result.h"
#include "cases/openfoam_run.h"
#include "cases/sweep.h"
#include "cases/sweep_slurm.h"
#include "core/counted.h"
#include "core/file.h"
#include "core/own_files.h"
#include "core/parallel.h"
#include "core/text.h"
#include "geometry/body/body_shape.h"
#include "postproc/importers/reports/openfoam_forces.h"
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

/// Runs the case to its end; the seconds that it took, and the iteration that it went on from.
struct Solved {
    double seconds = 0;
    std::optional<double> from;
};

Solved run_case(Shell& shell, const std::string& folder) {
    cases::OpenFoamRun run(folder);
    const auto from = run.went_on_from();
    if (from) {
        shell.info(*from > 0 ? "goes on from iteration " + core::format_number(*from)
                             : "goes on with the mesh that is there");
    }
    while (!run.finished()) {
        shell.progress().check();
        const auto state = cases::run_state(folder);
        shell.progress().report(state.fraction(),
                                state.step + (state.iteration > 0 ? " " + std::to_string(state.iteration) + " of " +
                                                                        std::to_string(state.iterations)
                                                                  : ""));
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    const cases::SolveEnd end = cases::solve_end(folder);
    if (!end.solved) {
        throw core::InputError("solver", "the script ended without a whole solution: " + end.why,
                               {(fs::path(folder) / "log.Allrun").string(), {}, {}, {}});
    }
    return {run.seconds(), from};
}

void print_solved(Shell& shell, const std::string& folder, bool before, double needed, const cases::RunState& state,
                  const cases::SettledLoads& loads, const nlohmann::json& forces) {
    shell.print(folder + (before
                              ? ": solved before, nothing was run (--again runs it)"
                              : ": solved in " + seconds(needed) + ", " + core::counted(state.iteration, "iteration")));
    if (loads.iterations > 0) {
        shell.print(std::string(loads.settled ? "settled: " : "not settled: ") + loads.text);
    }
    for (const auto& entry : forces) {
        std::string numbers;
        for (const auto& number : entry["force"]) {
            numbers += (numbers.empty() ? "" : ", ") + core::format_number(number.get<double>(), 5);
        }
        shell.print("force of '" + entry["name"].get<std::string>() +
                    "', in the case's axes and of the mesh: " + numbers + " N");
    }
}

int solve(Shell& shell, const std::string& folder, bool again) {
    const bool before = !again && cases::solve_end(folder).solved;
    Solved made;
    if (!before) {
        if (again && cases::solves_anew(folder)) {
            cases::set_results_aside(folder);
        }
        made = run_case(shell, folder);
    }
    const auto state = cases::run_state(folder);
    const auto forces = forces_of(folder);
    const auto loads = cases::settled_loads(folder);
    if (loads.iterations > 0 && !loads.settled) {
        shell.show_warning("not settled: " + loads.text);
    }
    if (shell.json) {
        shell.print_json({{"case", folder},
                          {"solved_before", before},
                          {"went_on_from", made.from ? nlohmann::json(*made.from) : nlohmann::json(nullptr)},
                          {"iterations", state.iteration},
                          {"seconds", made.seconds},
                          {"settled", loads.iterations > 0 ? nlohmann::json(loads.settled) : nlohmann::json(nullptr)},
                          {"settled_text", loads.text},
                          {"forces", forces}});
        return done;
    }
    print_solved(shell, folder, before, made.seconds, state, loads, forces);
    return done;
}

// ---- sweep ----

struct SweepArguments {
    std::string study, engine = "local", only, script, stale = "redo", submission;
    std::string partition, time, memory, account, add, add_as;
    std::optional<int> throttle, max_array, cores, retries;
    int jobs = 0;
    bool list = false, wait = false, cancel = false, run_study = false;
};

nlohmann::json conditions_of(const cases::Conditions& conditions) {
    nlohmann::json json = nlohmann::json::object();
    for (const auto& [name, value] : conditions.numbers) {
        json[name] = value;
    }
    for (const auto& [name, value] : conditions.texts) {
        json[name] = value;
    }
    return json;
}

/// Prints them; how many are neither solved nor had elsewhere.
int say_cases(Shell& shell, const std::vector<cases::SweepCase>& cases) {
    nlohmann::json all = nlohmann::json::array();
    int missing = 0;
    for (const auto& one : cases) {
        missing += one.present ? 0 : 1;
        const std::string state = to_string(one.state);
        all.push_back({{"name", one.name},
                       {"folder", one.folder.string()},
                       {"present", one.present},
                       {"state", state},
                       {"reason", one.reason},
                       {"iteration", one.iteration},
                       {"iterations", one.iterations},
                       {"seconds_left", one.seconds_left ? nlohmann::json(*one.seconds_left) : nlohmann::json(nullptr)},
                       {"conditions", conditions_of(one.conditions)}});
        shell.print(state + std::string(9 - state.size(), ' ') + one.name + "  " + one.conditions.label() +
                    (one.reason.empty() ? "" : "  (" + one.reason + ")"));
    }
    if (shell.json) {
        shell.print_json({{"cases", all}});
    }
    return missing;
}

/// Until nothing waits or runs; wrong_input when a case is still missing then.
int wait(Shell& shell, const cases::Study& study) {
    return say_cases(shell, cases::wait_for_sweep(study, shell.progress())) == 0 ? done : wrong_input;
}

int cancel(Shell& shell, const cases::Study& study) {
    const auto jobs = cases::cancel_sweep(study, shell.progress());
    for (const auto& job : jobs) {
        shell.print("job " + job + " cancelled; what it had begun stays for the next sweep");
    }
    if (jobs.empty()) {
        shell.print("Slurm has no job of this sweep");
    }
    if (shell.json) {
        shell.print_json({{"cancelled", jobs}});
    }
    return done;
}

/// Options of the other engine are refused: what they ask for would not be done.
void check_engine(const SweepArguments& given) {
    if (given.engine == "slurm") {
        if (given.jobs > 0) {
            throw core::UsageError("combination", "--jobs is for a sweep on this machine", {},
                                   "--throttle says how many cases Slurm runs at a time");
        }
        return;
    }
    for (const auto& [is_given, option] : {std::pair{given.wait, "--wait"},
                                           {given.run_study, "--run-study"},
                                           {!given.script.empty(), "--script"},
                                           {!given.partition.empty(), "--partition"},
                                           {!given.time.empty(), "--time"},
                                           {!given.memory.empty(), "--memory"},
                                           {!given.account.empty(), "--account"},
                                           {given.throttle.has_value(), "--throttle"},
                                           {given.max_array.has_value(), "--max-array"}}) {
        if (is_given) {
            throw core::UsageError(
                "combination",
                std::string(option) + " is for jobs of Slurm" +
                    (given.wait || given.run_study ? "; a sweep on this machine ends when its cases are solved" : ""),
                {},
                "add --engine slurm" +
                    (given.run_study ? ", or follow with: underbody study run " + given.study : std::string()));
        }
    }
}

nlohmann::json print_arrays(Shell& shell, const std::vector<cases::SlurmArray>& arrays) {
    nlohmann::json json = nlohmann::json::array();
    for (const auto& array : arrays) {
        shell.print("wrote " + array.script.string() + " of " + core::counted(array.names.size(), "case") +
                    (array.job.empty()
                         ? "; 'sbatch' is not here: submit it where Slurm is, in a folder that both machines see"
                         : "; submitted as job " + array.job));
        json.push_back({{"script", array.script.string()},
                        {"job", array.job.empty() ? nlohmann::json(nullptr) : nlohmann::json(array.job)},
                        {"cases", array.names}});
    }
    return json;
}

cases::SlurmSubmission submission_of(Shell& shell, const cases::Study& study, const SweepArguments& given) {
    cases::SlurmSubmission what;
    what.only = given.only.empty() ? std::nullopt : std::optional(given.only);
    if (study.sweep) {
        what.settings = study.sweep->slurm;
        what.script = given.script.empty() ? study.folder() / study.sweep->folder / "sweep.sh" : fs::path(given.script);
    }
    for (const auto& [text, option, name] : {std::tuple{&what.settings.partition, &given.partition, "--partition"},
                                             {&what.settings.time, &given.time, "--time"},
                                             {&what.settings.memory, &given.memory, "--memory"},
                                             {&what.settings.account, &given.account, "--account"}}) {
        if (!cases::slurm_takes(*option)) {
            throw core::UsageError("value", name + (" '" + *option) + "': Slurm takes no blanks there", {},
                                   "--time 02:00:00 --memory 4G");
        }
        *text = option->empty() ? *text : *option;
    }
    what.settings.throttle = given.throttle.value_or(what.settings.throttle);
    what.settings.max_array = given.max_array.value_or(what.settings.max_array);
    what.settings.cores = given.cores.value_or(what.settings.cores);
    what.settings.retries = given.retries.value_or(what.settings.retries);
    what.settings.run_study = given.run_study || what.settings.run_study;
    what.program = shell.program();
    what.keep_stale = given.stale == "keep";
    what.replace_stale = given.stale == "replace";
    return what;
}

int submit(Shell& shell, const cases::Study& study, const SweepArguments& given) {
    const cases::SlurmSubmission what = submission_of(shell, study, given);
    const auto all = cases::submit_sweep(study, what, shell.progress());
    const auto& arrays = all.arrays;
    const nlohmann::json json = print_arrays(shell, arrays);
    nlohmann::json after = nullptr;
    if (all.study) {
        shell.print("wrote " + all.study->script.string() + ", which runs the study when they have ended" +
                    (all.study->job.empty() ? "" : "; submitted as job " + all.study->job));
        after = {{"script", all.study->script.string()},
                 {"job", all.study->job.empty() ? nlohmann::json(nullptr) : nlohmann::json(all.study->job)}};
    }
    if (arrays.empty()) {
        shell.print("nothing is missing that does not wait or run already");
    }
    if (given.wait) {
        return wait(shell, study);
    }
    if (shell.json && arrays.empty()) {
        shell.print_json({{"missing", 0}, {"arrays", json}, {"study", after}});
    } else if (shell.json) {
        shell.print_json({{"script", json[0]["script"]}, {"job", json[0]["job"]}, {"arrays", json}, {"study", after}});
    }
    return done;
}

/// A shape more in the sweep: its file, its [[body]], and what its cases cost.
int add_shape(Shell& shell, const cases::Study& study, const SweepArguments& given) {
    const std::string name = given.add_as.empty() ? std::filesystem::path(given.add).stem().string() : given.add_as;
    constexpr double usual_gap = 0.005;  // m, of a study that has no [sweep]
    const auto asked = cases::ask_for_cfd(study, geometry::read_shape(given.add), name, usual_gap);
    cases::write_asked(study, asked);
    shell.print(name + ": " + asked.cost() + "; underbody sweep " + given.study + " makes them");
    if (shell.json) {
        shell.print_json({{"name", asked.name},
                          {"shape", asked.shape_file.string()},
                          {"cases", asked.cases},
                          {"seconds", std::isfinite(asked.seconds) ? nlohmann::json(asked.seconds) : nlohmann::json()},
                          {"solved", asked.solved}});
    }
    return done;
}

cases::SweepOptions sweep_options(const SweepArguments& given) {
    cases::SweepOptions options;
    options.cores = given.cores.value_or(1);
    options.retries = given.retries.value_or(0);
    options.jobs = given.jobs > 0 ? given.jobs : std::max(1, static_cast<int>(core::threads()) / options.cores);
    options.stale = given.stale == "keep"      ? cases::StaleCases::keep
                    : given.stale == "replace" ? cases::StaleCases::replace
                                               : cases::StaleCases::redo;
    options.submission = given.submission;
    if (!given.only.empty()) {
        options.only = given.only;
    }
    return options;
}

int sweep(Shell& shell, const SweepArguments& given) {
    const auto study = cases::Study::open(given.study);
    if (!given.add.empty()) {
        return add_shape(shell, study, given);
    }
    if (given.list) {
        say_cases(shell, cases::sweep_cases(study, shell.progress()));
        return done;
    }
    if (given.cancel) {
        return cancel(shell, study);
    }
    check_engine(given);
    if (given.engine == "slurm") {
        return submit(shell, study, given);
    }
    const cases::SweepOptions options = sweep_options(given);
    const auto outcomes = cases::sweep_locally(study, options, shell.progress());
    int failed = 0;
    int solved = 0;
    nlohmann::json all = nlohmann::json::array();
    for (const auto& one : outcomes) {
        failed += one.error.empty() ? 0 : 1;
        solved += one.error.empty() && one.skipped.empty() ? 1 : 0;
        all.push_back({{"name", one.name},
                       {"seconds", one.seconds},
                       {"error", one.error},
                       {"skipped", one.skipped},
                       {"note", one.note}});
        if (!one.error.empty()) {
            shell.warn(one.name + ": " + one.error);
        } else if (!one.skipped.empty()) {
            shell.print(one.name + ": left alone: " + one.skipped);
        } else {
            shell.print(one.name + ": solved in " + seconds(one.seconds) +
                        (one.note.empty() ? "" : " (" + one.note + ")"));
        }
    }
    if (outcomes.empty()) {
        shell.print("nothing is missing");
    } else if (solved > 0) {
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
    command->add_option("case", o->folder, "folder of the case, with an Allrun, as `underbody body domain` writes it")
        ->required();
    command->add_flag("--again", o->again, "also when it is solved already");
    command->footer(
        "Examples:\n"
        "  underbody solve case\n"
        "  underbody solve case --json\n"
        "Needs OpenFOAM (Debian: openfoam). Ctrl-C ends the solver too, and so does a kill; the logs stay in the "
        "folder, and the next\n"
        "solve goes on from the last checkpoint. --again begins anew and keeps the earlier results in the folder "
        "previous.");
    shell.on(command, [&shell, o] {
        const core::ReplacingAllowed the_case;
        return solve(shell, o->folder, o->again);
    });
}

void add_options(CLI::App* command, const std::shared_ptr<SweepArguments>& o) {
    command->add_option("study", o->study, "folder with study.toml, which has a [sweep]")->required();
    command->add_option("--engine", o->engine, "local: OpenFOAM on this machine; slurm: a job array")
        ->check(CLI::IsMember({"local", "slurm"}))
        ->capture_default_str();
    command->add_option("--jobs", o->jobs, "local: cases at a time (default: all cores, over those of a case)")
        ->check(CLI::Range(1, 1024));
    command
        ->add_option("--cores", o->cores, "cores of a case, by MPI (default: [sweep.slurm] of study.toml for slurm, 1)")
        ->check(CLI::Range(1, 4096));
    command
        ->add_option("--retries", o->retries,
                     "how often a case is tried again whose solver was ended or failed; one that diverged is not "
                     "(default: [sweep.slurm] for slurm, 0)")
        ->check(CLI::Range(0, 100));
    command->add_option("--only", o->only, "this case alone, by name");
    command->add_option("--script", o->script,
                        "slurm: where the batch script goes (default: sweep.sh beside the cases)");
    command
        ->add_option("--stale", o->stale,
                     "cases solved for another shape, mesh, flow or number of iterations: redo (solved again, the old "
                     "folder kept in set_aside), replace (solved again, the old one removed), keep (left as they are)")
        ->check(CLI::IsMember({"redo", "replace", "keep"}))
        ->capture_default_str();
    command->add_option("--partition", o->partition,
                        "slurm: as sbatch takes it (default: [sweep.slurm] of study.toml, else the site's)");
    command->add_option("--time", o->time, "slurm: limit of a case, 02:00:00");
    command->add_option("--memory", o->memory, "slurm: of a case, 4G");
    command->add_option("--account", o->account, "slurm: as sbatch takes it");
    command->add_option("--throttle", o->throttle, "slurm: cases at a time")->check(CLI::Range(1, 1000000));
    command
        ->add_option("--max-array", o->max_array,
                     "slurm: cases in one job array; more make several (default: what scontrol says, else 1000)")
        ->check(CLI::Range(1, 4000000));
    command->add_flag("--run-study", o->run_study,
                      "slurm: a job more, which runs the study when the arrays have ended, also those of earlier");
    command->add_flag(
        "--wait", o->wait,
        "slurm: waits until nothing waits or runs, then says how far each case is; exit code 3 when one is "
        "missing");
    command->add_flag("--cancel", o->cancel,
                      "cancels the sweep's jobs in Slurm, and the one that would run the study; what they had begun "
                      "stays");
    auto* add = command->add_option("--add", o->add,
                                    "SHAPE.toml: adds this shape to the study and its sweep, and says what its cases "
                                    "cost; solves nothing");
    command->add_option("--as", o->add_as, "with --add: its name (default: that of the file)")->needs(add);
    command->add_option("--submission", o->submission, "of the Slurm job whose task this is")->group("");
    command->add_flag(
        "--list", o->list,
        "only say how far each case is: missing, waiting, running (iteration, time left at most), solved, "
        "stale, failed (why), present");
}

void add_sweep_command(CLI::App& app, Shell& shell) {
    auto* command = app.add_subcommand("sweep", "CFD of the cases that a study wants and does not have");
    auto o = std::make_shared<SweepArguments>();
    add_options(command, o);
    command->footer(
        "Examples:\n"
        "  underbody sweep mystudy --list\n"
        "  underbody sweep mystudy --add hull.toml --as hull-2\n"
        "  underbody sweep mystudy --jobs 2\n"
        "  underbody sweep mystudy --engine slurm --run-study --wait\n"
        "  underbody sweep mystudy --cancel\n"
        "In study.toml:\n"
        "  [sweep]\n"
        "  bodies = [\"ellipse\"]                 # names of [[body]]; default all\n"
        "  gap = [\"2 mm\", \"5 mm\"]\n"
        "  pitch = [\"0 deg\", \"2 deg\"]\n"
        "  speed = \"0.5 m/s\"\n"
        "  # folder, conditions, kinematic_viscosity, iterations, mesh_density = \"fine\" of the blocks, or\n"
        "  # mesher = \"snappy\" with cell, surface_level, layers\n"
        "  [sweep.slurm]                        # all optional\n"
        "  partition = \"cfd\"\n"
        "  time = \"02:00:00\"\n"
        "  # memory, account, throttle, max_array, cores, retries, run_study, options = [\"--nice=100\"]\n"
        "Solved cases belong to the study without a [[case]]. A sweep that was stopped goes on where it was, a solve "
        "from its last\n"
        "checkpoint. Two sweeps of one study never make the same case: the second leaves it alone.");
    shell.on(command, [&shell, o] {
        const core::ReplacingAllowed the_cases;
        return sweep(shell, *o);
    });
}

}  // namespace underbody::studio
