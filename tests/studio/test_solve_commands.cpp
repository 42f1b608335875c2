// solve and sweep as a user runs them, with a stand-in for OpenFOAM: programs of its names that write what it writes.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/table.h"
#include "core/text.h"
#include "tests/studio/solve_commands.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

TEST_F(SolveCommands, SolveRunsACaseAndTellsItsForces) {
    ASSERT_EQ(run({"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse.toml").string(), "--gap",
                   "10mm", "--out", "case", "--mesher", "snappy", "--iterations", "30"})
                  .exit_code,
              0);
    const auto first = run({"solve", "case", "--json"});
    ASSERT_EQ(first.exit_code, 0) << first.errors;
    const json result = json::parse(first.output);
    EXPECT_EQ(result["iterations"], 30);
    EXPECT_EQ(result["solved_before"], false);
    EXPECT_EQ(result["forces"][0]["force"], json({-1.5, 0.0, 2.0}));
    EXPECT_THAT(run({"solve", "case"}).output, HasSubstr("solved before"));
    EXPECT_THAT(run({"solve", "case", "--again"}).output, HasSubstr("solved in"));
}

TEST_F(SolveCommands, SolveSaysWhatIsMissingAndWhatFailed) {
    ASSERT_EQ(run({"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse.toml").string(), "--gap",
                   "10mm", "--out", "case", "--mesher", "snappy"})
                  .exit_code,
              0);
    const auto none = test::run_underbody({"solve", "case", "--json"}, folder_.path(), {{"PATH", "/nowhere"}});
    EXPECT_EQ(none.exit_code, 3);
    EXPECT_THAT(json::parse(none.output)["error"]["hint"].get<std::string>(), HasSubstr("apt install openfoam"));
    EXPECT_EQ(run({"solve", "nowhere"}).exit_code, 3);
    fs::create_directories(folder_.path() / "empty");
    EXPECT_THAT(run({"solve", "empty"}).errors, HasSubstr("no Allrun"));
    program("snappyHexMesh", "echo 'reading'; echo '--> FOAM FATAL ERROR:'; echo 'no such surface body.stl'; exit 1");
    const auto failed = run({"solve", "case"});
    EXPECT_EQ(failed.exit_code, 3);
    EXPECT_THAT(failed.errors, HasSubstr("log.snappyHexMesh"));
    EXPECT_THAT(failed.errors, HasSubstr("no such surface body.stl"));
}

TEST_F(SolveCommands, SweepMakesTheMissingCasesAndOnlyThose) {
    write_study();
    EXPECT_THAT(run({"sweep", "study", "--list"}).output, HasSubstr("missing  ellipse-h5-p1-u0.5"));
    const auto one = run({"sweep", "study", "--only", "ellipse-h10-p1-u0.5"});
    EXPECT_EQ(one.exit_code, 0) << one.errors;
    EXPECT_TRUE(fs::exists(folder_.path() / "study/runs/ellipse-h10-p1-u0.5/case.foam"));
    const auto rest = run({"sweep", "study", "--json", "--jobs", "2"});
    EXPECT_EQ(rest.exit_code, 0) << rest.errors;
    ASSERT_EQ(json::parse(rest.output)["cases"].size(), 1U);
    EXPECT_EQ(json::parse(rest.output)["cases"][0]["name"], "ellipse-h5-p1-u0.5");
    EXPECT_THAT(run({"sweep", "study"}).output, HasSubstr("nothing is missing"));
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "solved");
    // The study has them with their conditions, without a [[case]].
    const auto list = run({"study", "list", "study"});
    EXPECT_EQ(list.exit_code, 0) << list.errors;
    EXPECT_THAT(list.output, HasSubstr("ellipse-h10-p1-u0.5"));
    EXPECT_EQ(run({"sweep", "study", "--only", "ellipse-h11-p1-u0.5"}).exit_code, 3);
}

TEST_F(SolveCommands, SweepGoesOnPastACaseThatFailsAndKeepsItsLogs) {
    write_study();
    program("checkMesh", "case \"$PWD\" in *h5*) echo 'mesh is bad'; exit 1;; esac; echo; echo End");
    const auto sweep = run({"sweep", "study", "--jobs", "1"});
    EXPECT_EQ(sweep.exit_code, 3);
    EXPECT_THAT(sweep.output, HasSubstr("ellipse-h10-p1-u0.5: solved")) << sweep.errors;
    EXPECT_THAT(sweep.errors, HasSubstr("mesh is bad"));
    EXPECT_TRUE(fs::exists(folder_.path() / "study/runs/ellipse-h5-p1-u0.5.failed/log.checkMesh"));
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "failed");
    EXPECT_THAT(list()["ellipse-h5-p1-u0.5"]["reason"].get<std::string>(), HasSubstr("mesh is bad"));
    program("checkMesh", "echo; echo End");
    EXPECT_EQ(run({"sweep", "study"}).exit_code, 0);
    EXPECT_FALSE(fs::exists(folder_.path() / "study/runs/ellipse-h5-p1-u0.5.failed"));
    EXPECT_TRUE(fs::exists(folder_.path() / "study/runs/ellipse-h5-p1-u0.5/case.foam"));
}

TEST_F(SolveCommands, SweepWritesAndSubmitsAJobArray) {
    write_study();
    const auto alone = run({"sweep", "study", "--engine", "slurm"});
    EXPECT_EQ(alone.exit_code, 0) << alone.errors;
    EXPECT_THAT(alone.output, HasSubstr("'sbatch' is not here"));
    const std::string script = core::read_file(runs() / "sweep.sh");
    EXPECT_THAT(script, HasSubstr("#SBATCH --array=1-2"));
    EXPECT_THAT(script, HasSubstr("2) name='ellipse-h10-p1-u0.5' ;;"));
    program("sbatch", "cp \"$2\" submitted.sh; echo 4711");
    const auto submitted = run({"sweep", "study", "--engine", "slurm", "--json"});
    EXPECT_EQ(submitted.exit_code, 0) << submitted.errors;
    EXPECT_EQ(json::parse(submitted.output)["job"], "4711");
    // A task of the array makes its case.
    auto variables = environment();
    variables["SLURM_ARRAY_TASK_ID"] = "2";
    const auto task = test::run_program("/bin/sh", {(runs() / "sweep.sh").string()}, "/", variables);
    EXPECT_EQ(task.exit_code, 0) << task.errors;
    EXPECT_TRUE(fs::exists(runs() / "ellipse-h10-p1-u0.5/case.foam"));
    EXPECT_FALSE(fs::exists(runs() / "ellipse-h10-p1-u0.5.submitted"));
    program("squeue", "true");  // the other task is gone without a trace
    program("sbatch", "echo 'invalid partition' >&2; exit 1");
    const auto refused = run({"sweep", "study", "--engine", "slurm"});
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_THAT(refused.errors, HasSubstr("invalid partition"));
    EXPECT_FALSE(fs::exists(runs() / "ellipse-h5-p1-u0.5.submitted"));
}

TEST_F(SolveCommands, ACaseOnSeveralCoresIsTriedAgainFromItsCheckpoint) {
    write_study();
    // Killed once at iteration 17 in each case, on two cores: what was decomposed is put together, and it goes on.
    hook("if [ $i = 17 ] && [ ! -e ../again ]; then touch ../again; kill -9 $$; fi");
    const auto made = run({"sweep", "study", "--jobs", "1", "--cores", "2", "--retries", "1", "--json"});
    ASSERT_EQ(made.exit_code, 0) << made.output << made.errors;
    const json told = json::parse(made.output);
    ASSERT_FALSE(told["cases"].empty());
    for (const auto& one : told["cases"]) {
        const fs::path folder = runs() / one["name"].get<std::string>();
        EXPECT_THAT(one["note"].get<std::string>(), HasSubstr("tried again (1 of 1): "));
        EXPECT_EQ(core::read_file(folder / "cores"), "2\n2\n");
        EXPECT_TRUE(fs::exists(folder / "40" / "U"));
        EXPECT_FALSE(fs::exists(folder / "processor0"));
        EXPECT_EQ(core::read_file(folder / "meshed"), "meshed\n");
        // Iterations 1 to 17, then 16 to 40.
        EXPECT_TRUE(fs::exists(folder / "postProcessing" / "forces" / "15")) << "it went on from the checkpoint";
    }
    const json all = list();
    for (const auto& [name, one] : all.items()) {
        EXPECT_EQ(one["state"], "solved") << name;
    }
}

TEST_F(SolveCommands, ACaseIsTriedAgainAsOftenAsAsked) {
    write_study();
    hook("echo x >> ../../attempts; exit 1");
    const auto made = run({"sweep", "study", "--jobs", "1", "--retries", "2", "--only", "ellipse-h5-p1-u0.5"});
    EXPECT_EQ(made.exit_code, 3);
    EXPECT_EQ(core::read_file(folder_.path() / "study" / "attempts"), "x\nx\nx\n");
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "failed");
}

TEST_F(SolveCommands, OnSeveralCoresTheProgramsOfMpiAreNeeded) {
    write_study();
    fs::remove(folder_.path() / "bin" / "mpirun");
    const auto made = run({"sweep", "study", "--cores", "2"});
    EXPECT_NE(made.exit_code, 0);
    EXPECT_THAT(made.output + made.errors, HasSubstr("needs 'mpirun', which is not on the PATH"));
    EXPECT_THAT(run({"sweep", "study", "--wait"}).errors, HasSubstr("is for jobs of Slurm"));
    EXPECT_THAT(run({"sweep", "study", "--cancel"}).errors, HasSubstr("there is no 'scancel'"));
}

TEST_F(SolveCommands, WhatWaitsOrRunsInSlurmIsMadeByNobodyElse) {
    write_study();
    program("sbatch", "echo \"$@\" >> calls; echo 4711");
    ASSERT_EQ(run({"sweep", "study", "--engine", "slurm"}).exit_code, 0);
    program("squeue", "echo '1 RUNNING'; echo '2 PENDING'");
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "running");
    EXPECT_EQ(list()["ellipse-h10-p1-u0.5"]["state"], "waiting");
    EXPECT_THAT(list()["ellipse-h10-p1-u0.5"]["reason"].get<std::string>(), HasSubstr("4711_2"));
    EXPECT_THAT(run({"sweep", "study", "--engine", "slurm"}).output,
                HasSubstr("nothing is missing that does not wait or run"));
    const std::string calls = core::read_file(runs() / "calls");
    EXPECT_EQ(core::split(calls, '\n').size(), 2U);  // one line
    const auto local = run({"sweep", "study"});
    EXPECT_EQ(local.exit_code, 0) << local.errors;
    EXPECT_THAT(local.output, HasSubstr("ellipse-h5-p1-u0.5: left alone: submitted as job 4711_1"));
    EXPECT_FALSE(fs::exists(runs() / "ellipse-h5-p1-u0.5"));
    program("squeue", "echo 'slurm_load_jobs error: Unable to contact slurm controller' >&2; exit 1");
    EXPECT_THAT(list()["ellipse-h5-p1-u0.5"]["reason"].get<std::string>(), HasSubstr("Slurm cannot be asked"));
    program("squeue", "true");  // the job was cancelled
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "missing");
    EXPECT_EQ(run({"sweep", "study"}).exit_code, 0);
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "solved");
    EXPECT_FALSE(fs::exists(runs() / "ellipse-h5-p1-u0.5.submitted"));
}

TEST_F(SolveCommands, ArraysAreAsLongAsTheSiteTakesThemWithItsOptions) {
    write_study();
    replace(folder_.path() / "study" / "study.toml", "gap = [\"5 mm\", \"10 mm\"]",
            "gap = [\"5 mm\", \"6 mm\", \"7 mm\", \"8 mm\", \"10 mm\"]");
    core::write_file(folder_.path() / "study" / "study.toml",
                     core::read_file(folder_.path() / "study" / "study.toml") +
                         "[sweep.slurm]\npartition = \"cfd\"\ntime = \"02:00:00\"\nmemory = \"4G\"\nthrottle = "
                         "2\noptions = [\"--nice=100\"]\n");
    program("scontrol", "echo 'MaxArraySize            = 3'");
    program("sbatch", "echo \"$@\" >> calls; sed -n '$=' calls");
    const auto submitted = run({"sweep", "study", "--engine", "slurm", "--account", "hull", "--json"});
    ASSERT_EQ(submitted.exit_code, 0) << submitted.errors;
    const json arrays = json::parse(submitted.output)["arrays"];
    ASSERT_EQ(arrays.size(), 3U);
    EXPECT_EQ(arrays[2]["cases"].size(), 1U);
    const std::string script = core::read_file(runs() / "sweep-2.sh");
    for (const char* line : {"#SBATCH --array=1-2%2\n", "#SBATCH --partition=cfd\n", "#SBATCH --time=02:00:00\n",
                             "#SBATCH --mem=4G\n", "#SBATCH --account=hull\n", "#SBATCH --nice=100\n"}) {
        EXPECT_THAT(script, HasSubstr(line));
    }
    EXPECT_THAT(core::read_file(runs() / "calls"), HasSubstr("--dependency=afterany:1 "));
    replace(folder_.path() / "study" / "study.toml", "02:00:00", "2 h");
    EXPECT_THAT(run({"sweep", "study", "--list"}).errors, HasSubstr("Slurm takes no blanks"));
}

TEST_F(SolveCommands, SlurmIsGivenTheCaseThatIsNamedAndNoOptionThatIsNotDone) {
    write_study();
    program("sbatch", "echo \"$@\" >> calls; sed -n '$=' calls");
    program("squeue", "case \"$*\" in *underbody-sweep*) echo '1 PENDING' ;; esac");
    const std::vector<std::string> slurm = {"sweep", "study", "--engine", "slurm"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), slurm.begin(), slurm.end());
        return run(more);
    };
    const auto one = with({"--only", "ellipse-h10-p1-u0.5", "--json"});
    ASSERT_EQ(one.exit_code, 0) << one.errors;
    EXPECT_EQ(json::parse(one.output)["arrays"][0]["cases"], json::array({"ellipse-h10-p1-u0.5"}));
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "missing");
    EXPECT_THAT(with({"--only", "ellipse-h10"}).errors, HasSubstr("the sweep has no case 'ellipse-h10'"));
    // Of what was submitted before, the job that runs the study is still to be had, and it waits for that.
    const auto after = with({"--only", "ellipse-h10-p1-u0.5", "--run-study", "--json"});
    ASSERT_EQ(after.exit_code, 0) << after.errors;
    EXPECT_EQ(json::parse(after.output)["study"]["job"], "2") << after.output;
    EXPECT_THAT(core::read_file(runs() / "calls"), HasSubstr("--dependency=afterany:1 "));
    for (const auto& [wrong, says] : {std::pair{"1 hour", "'1 hour': Slurm takes no blanks there"},
                                      {"1\ntouch it", "Slurm takes no blanks there"}}) {
        const auto refused = with({"--time", wrong});
        EXPECT_EQ(refused.exit_code, 2);
        EXPECT_THAT(refused.errors, HasSubstr(says));
    }
    EXPECT_THAT(with({"--jobs", "2"}).errors, HasSubstr("--throttle says how many"));
    for (const char* option :
         {"--partition", "--time", "--memory", "--account", "--throttle", "--max-array", "--script"}) {
        const auto refused = run({"sweep", "study", option, "2"});
        EXPECT_EQ(refused.exit_code, 2) << option;
        EXPECT_THAT(refused.errors, HasSubstr(std::string(option) + " is for jobs of Slurm")) << option;
    }
}

/// A stand-in for the solver on a mesh of blocks: its forces swing by `swing`, its run ends when it finds the file for
/// which the case's function object waits.
std::string waiting_solver(const std::string& swing) {
    return "swing=" + swing + R"sh(
if [ "$1" = -case ]; then cd "$2" || exit 1; fi
end=$(sed -n 's/^endTime \([0-9]*\);.*/\1/p' system/controlDict)
from=0
for d in [1-9]*; do if [ -e "$d/U" ]; then from=$d; fi; done
mkdir -p postProcessing/forces/$from
f=postProcessing/forces/$from/force.dat
echo '# Time (total_x total_y total_z) (pressure_x pressure_y pressure_z) (viscous_x viscous_y viscous_z)' > $f
i=$from
while [ $i -lt $end ] && [ ! -e settled ]; do
    i=$((i + 1))
    echo
    echo "Time = $i"
    echo "$i (-1.5 0 2) (-1 0 $((i % 2 * swing + 200))e-2) (-0.5 0 0)" >> $f
    if [ $i -gt 240 ]; then sleep 0.1; fi
done
mkdir -p $i
for v in U p k omega nut; do
    printf 'FoamFile\n{\n    class volScalarField;\n}\ninternalField uniform 1;\n// **** //\n' > $i/$v
done
if [ -e settled ]; then
    rm settled  # as OpenFOAM 1912 does
    echo "USER REQUESTED ABORT (timeIndex=$i): stop and write data"
fi
echo
echo End
)sh";
}

TEST_F(SolveCommands, ARunOnBlocksEndsWhenItsLoadsHaveSettled) {
    program("ln", "exec /bin/ln \"$@\"");
    program("simpleFoam", waiting_solver("0"));
    write_study();
    replace(folder_.path() / "study" / "study.toml", "mesher = \"snappy\"\niterations = 40",
            "mesh_density = \"coarse\"");
    const auto sweep = run({"sweep", "study", "--json", "--only", "ellipse-h5-p1-u0.5"});
    ASSERT_EQ(sweep.exit_code, 0) << sweep.errors << sweep.output;
    const fs::path made = runs() / "ellipse-h5-p1-u0.5";
    const json marker = json::parse(core::read_file(made / "case.foam"));
    EXPECT_EQ(marker["settled"], true);
    EXPECT_GE(marker["iterations"], 220);
    EXPECT_LT(marker["iterations"], 800);
    EXPECT_EQ(marker["walls"], json({"base", "hull"}));
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "solved");
    const json mesh = json::parse(core::read_file(made / "constant" / "mesh.json"));
    EXPECT_EQ(mesh["cells"], 57280);
    EXPECT_EQ(mesh["cells_in_gap"], 20);
    EXPECT_EQ(mesh["negative_volumes"], 0);
    // Another density is another case.
    replace(folder_.path() / "study" / "study.toml", "coarse\"\n", "medium\"\n");
    EXPECT_THAT(list()["ellipse-h5-p1-u0.5"]["reason"].get<std::string>(),
                HasSubstr("mesh density: coarse there, medium now"));
}

TEST_F(SolveCommands, ARunThatDoesNotSettleRunsToItsEndAndSaysSo) {
    program("ln", "exec /bin/ln \"$@\"");
    program("simpleFoam", waiting_solver("5"));
    ASSERT_EQ(run({"body", "domain", (test::source_folder() / "cases/evie/shapes/rectangle.toml").string(), "--gap",
                   "10mm", "--mesh-density", "coarse", "--out", "case", "--iterations", "240"})
                  .exit_code,
              0);
    const auto solved = run({"solve", "case", "--json"});
    ASSERT_EQ(solved.exit_code, 0) << solved.errors;
    EXPECT_EQ(json::parse(solved.output)["settled"], false);
    EXPECT_EQ(json::parse(solved.output)["iterations"], 240);
    EXPECT_THAT(run({"solve", "case"}).output, HasSubstr("not settled: lift, drag or pitch moment change by 2"));
    // --again solves anew on the same mesh.
    EXPECT_EQ(run({"solve", "case", "--again"}).exit_code, 0);
    EXPECT_TRUE(fs::exists(folder_.path() / "case" / "previous" / "240" / "U"));
    EXPECT_TRUE(fs::exists(folder_.path() / "case" / "constant" / "polyMesh" / "owner"));
}

TEST_F(SolveCommands, ADesignTakesWhatPeopleTypedAndSaysWhenAllFailed) {
    program("ln", "exec /bin/ln \"$@\"");
    program("simpleFoam", waiting_solver("0"));
    write_study();
    const fs::path study = folder_.path() / "search";
    core::write_file(study / "evie.toml", core::read_file(folder_.path() / "study" / "ellipse.toml"));
    core::write_file(study / "study.toml",
                     "title = \"search\"\n[frame]\nsymmetry = \"y\"\n[design]\nshape = \"evie.toml\"\npoints = 1\n"
                     "gap = \"3 mm\"\npitch = [\"-6 deg\", \"-5 deg\"]\nkinematic_viscosity = \"1.1e-6 m^2/s\"\n"
                     "[[design.vary]]\nkey = \"body.base_cut\"\nfrom = 0.74\nto = 0.76\n"
                     "[[design.fidelity]]\nname = \"draft\"\niterations = 240\n");
    core::write_file(study / "design" / "plan.csv",
                     "design,body.base_cut [1],fidelity,why,state,remark\nmine,0.75,draft,typed,planned,see above\n");
    const auto failed = run({"design", "run", "search", "--json"});
    EXPECT_EQ(failed.exit_code, 3) << "not one case gave loads";
    ASSERT_TRUE(fs::exists(study / "design" / "results.csv")) << failed.errors << failed.output;
    EXPECT_EQ(json::parse(failed.output)["usable"], 0);
    core::Table table = core::read_csv(study / "design" / "results.csv");
    ASSERT_EQ(table.rows(), 2u);
    for (const std::string& state : table.text("state")) {
        EXPECT_THAT(state, HasSubstr("below the ground"));  // was: no such file, of the shape that was typed
    }
    EXPECT_TRUE(fs::exists(study / "design/shapes/mine.toml"));
    // A remark beside the results, and a pitch at which there is room.
    std::string text = core::read_file(study / "design" / "results.csv");
    text.insert(text.find('\n'), ", remark");
    text.insert(text.find('\n', text.find('\n') + 1), ", touches");
    text.insert(text.rfind('\n'), ", touches too");
    fs::remove(study / "design" / "results.csv");
    std::ofstream(study / "design" / "results.csv") << text;
    replace(study / "study.toml", "\"-5 deg\"", "\"1 deg\"");
    (void)run({"design", "run", "search", "--json"});  // the stand-in's fields hold no loads
    table = core::read_csv(study / "design" / "results.csv");
    ASSERT_EQ(table.rows(), 3u);
    EXPECT_EQ(table.text("remark")[0], "touches");
    EXPECT_EQ(table.text("remark")[1], "touches too");
    EXPECT_EQ(core::read_csv(study / "design" / "plan.csv").text("remark")[0], "see above");
    EXPECT_THAT(core::read_file(study / "design/runs/draft/mine-h3-p1-u0.5/constant/transportProperties"),
                HasSubstr("nu 1.1e-06"));
}

/// One design at three gaps, on draft meshes.
void write_search(const fs::path& study, const fs::path& shape) {
    core::write_file(study / "evie.toml", core::read_file(shape));
    core::write_file(study / "study.toml",
                     "title = \"search\"\n[frame]\nsymmetry = \"y\"\n[design]\nshape = \"evie.toml\"\npoints = 1\n"
                     "gap = [\"3 mm\", \"5 mm\", \"8 mm\"]\n[[design.vary]]\nkey = \"body.base_cut\"\nfrom = 0.74\n"
                     "to = 0.76\n[[design.fidelity]]\nname = \"draft\"\niterations = 240\n");
}

/// At 5 mm the solver does what `fault` says; the plan goes on, the point is kept as failed with a clear word.
TEST_F(SolveCommands, ADesignKeepsWhatDivergesOrHangsAsFailedAndGoesOn) {
    program("ln", "exec /bin/ln \"$@\"");
    write_study();
    const fs::path study = folder_.path() / "search";
    struct Fault {
        std::string solver, state;
    };
    const std::string
        at_5 = "if ! grep -q 'CofR (0 0 0.005)' system/controlDict; then true; else ",
        rows =
            "mkdir -p postProcessing/forces/60; for i in $(seq 61 300); do echo \"$i (nan 0 2) (nan 0 2) (0 "
            "0 0)\"; done > postProcessing/forces/60/force.dat; ";
    for (const Fault& fault :
         {Fault{"echo '#1  Foam::sigFpe::sigHandler(int) at ??:?'; kill -FPE $$", "the solution diverged"},
          Fault{"kill -SEGV $$", "ended itself by signal 11"}, Fault{"while :; do :; done", "hangs and was ended"},
          Fault{rows + "sleep 1000", "no longer finite: the solution diverged"}}) {
        SCOPED_TRACE(fault.state);
        fs::remove_all(study);
        write_search(study, folder_.path() / "study" / "ellipse.toml");
        program("simpleFoam", at_5 + fault.solver + "; fi\n" + waiting_solver("0"));
        const auto ended = run({"design", "run", "search", "--json"});
        const core::Table table = core::read_csv(study / "design" / "results.csv");
        ASSERT_EQ(table.rows(), 3u) << ended.errors;
        for (std::size_t i = 0; i < 3; ++i) {
            const bool bad = std::abs(table.numbers("gap")[i] - 5e-3) < 1e-6;
            EXPECT_EQ(table.text("state")[i].find(fault.state) != std::string::npos, bad) << table.text("state")[i];
        }
        EXPECT_TRUE(fs::exists(study / "design/runs/draft/design-001-h5-p0-u0.5.failed")) << "its logs";
    }
}

TEST_F(SolveCommands, WhatBelongsToOneMesherIsRefusedWithTheOther) {
    write_study();
    const fs::path toml = folder_.path() / "study" / "study.toml";
    replace(toml, "mesher = \"snappy\"", "mesher = \"blocks\"\nlayers = 2");
    EXPECT_THAT(run({"sweep", "study", "--list"}).errors, HasSubstr("snappyHexMesh's"));
    replace(toml, "mesher = \"blocks\"\nlayers = 2", "mesher = \"snappy\"\nmesh_density = \"fine\"");
    EXPECT_THAT(run({"sweep", "study", "--list"}).errors, HasSubstr("mesh_density is that of the blocks"));
    replace(toml, "mesher = \"snappy\"\nmesh_density = \"fine\"", "mesh_density = \"finer\"");
    EXPECT_THAT(run({"sweep", "study", "--list"}).errors, HasSubstr("fine"));
    const auto nowhere = run({"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse.toml").string(),
                              "--gap", "5mm", "--pitch", "6deg", "--out", "case"});
    EXPECT_EQ(nowhere.exit_code, 3);
    EXPECT_THAT(nowhere.errors, HasSubstr("below the ground"));
    EXPECT_FALSE(fs::exists(folder_.path() / "case"));
}

}  // namespace
}  // namespace underbody
