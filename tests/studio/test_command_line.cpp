// What all commands have in common: exit codes, errors, the nearest name for what was mistyped, cancelling, examples.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

#include "core/file.h"
#include "core/text.h"
#include "tests/support/small_study.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::run_underbody;
using testing::HasSubstr;

/// Names in the list of sub-commands of a help text.
std::vector<std::string> commands_in(const std::string& help) {
    std::vector<std::string> names;
    const auto begin = help.find("Subcommands:");
    if (begin == std::string::npos) {
        return names;
    }
    const std::string block = help.substr(begin, help.find("\n\n", begin) - begin);
    const std::regex line("\n  ([a-z][a-z-]*) +[^\n]*");
    for (std::sregex_iterator it(block.begin(), block.end(), line), last; it != last; ++it) {
        names.push_back((*it)[1]);
    }
    return names;
}

std::vector<std::string> all_commands() { return commands_in(run_underbody({"--help"}).output); }

TEST(CommandLine, AnswersAMistypedOptionWithTheNearest) {
    const std::vector<std::pair<std::vector<std::string>, std::string>> mistyped = {
        {{"loads", "a.csv", "--symetry", "y"}, "did you mean --symmetry?"},
        {{"loads", "a.csv", "--zone=hull"}, "did you mean --zones?"},
        {{"table", "fit", "a.csv", "--qantity", "drag_force"}, "did you mean --quantity?"},
        {{"region", "model.toml", "--axis", "gap=0:1"}, "did you mean --axes?"},
        {{"--jsn", "info", "a.csv"}, "did you mean --json?"},
        {{"info", "a.csv", "--verbos"}, "did you mean --verbose?"},
        {{"study", "run", "folder", "--reprt", "x"}, "did you mean --report?"}};
    for (const auto& [arguments, answer] : mistyped) {
        const auto run = run_underbody(arguments);
        EXPECT_EQ(run.exit_code, 2) << arguments[0];
        EXPECT_THAT(run.errors, HasSubstr(answer));
        EXPECT_EQ(run.output, "") << arguments[0];
    }
    EXPECT_THAT(run_underbody({"loads", "a.csv", "--colour", "red"}).errors,
                HasSubstr("'underbody loads' has no option --colour"));
}

TEST(CommandLine, SaysRangesAndMissingWordsPlainly) {
    const auto threads = run_underbody({"list", "quantities", "--threads", "-3"});
    EXPECT_EQ(threads.exit_code, 2);
    EXPECT_THAT(threads.errors, HasSubstr("--threads: Value -3 is below 0"));
    EXPECT_THAT(threads.errors, testing::Not(HasSubstr("1797")));
    EXPECT_THAT(run_underbody({"watch", "m.toml", "--per-day", "0"}).errors,
                HasSubstr("--per-day: Value 0 is not above 0"));
    const auto keys = run_underbody({"list", "keys"});
    EXPECT_EQ(keys.exit_code, 2);
    EXPECT_THAT(keys.errors, HasSubstr("format is required: shape, study, model or dataset"));
}

TEST(CommandLine, AnswersAMistypedCommandWithTheNearest) {
    EXPECT_THAT(run_underbody({"lods", "a.csv"}).errors, HasSubstr("did you mean 'underbody loads'?"));
    EXPECT_THAT(run_underbody({"--quiet", "simulat", "model.toml"}).errors,
                HasSubstr("did you mean 'underbody simulate'?"));
    EXPECT_THAT(run_underbody({"table", "equilibra", "a.csv"}).errors,
                HasSubstr("did you mean 'underbody table equilibria'?"));
    EXPECT_EQ(run_underbody({"table", "equilibra", "a.csv"}).exit_code, 2);
    EXPECT_EQ(run_underbody({}).exit_code, 2);
    EXPECT_EQ(run_underbody({"xyzzy"}).exit_code, 2);
}

TEST(CommandLine, GivesEveryErrorAsJsonWhenAskedTo) {
    const core::TemporaryFolder folder;
    for (const auto& arguments :
         std::vector<std::vector<std::string>>{{"--json", "lods"},
                                               {"loads", "a.csv", "--symetry", "y", "--json"},
                                               {"loads", "none.csv", "--json"},
                                               {"loads", "none.csv", "--threads", "many", "--json"},
                                               {"table", "--json"}}) {
        const auto run = run_underbody(arguments, folder.path());
        const json error = json::parse(run.output)["error"];
        EXPECT_TRUE(error["kind"].is_string());
        EXPECT_FALSE(error["message"].get<std::string>().empty());
        EXPECT_TRUE(error["hint"].is_string());
        EXPECT_TRUE(run.exit_code == 2 || run.exit_code == 3) << run.exit_code;
        EXPECT_THAT(run.errors, HasSubstr(error["message"].get<std::string>()));
    }
}

TEST(CommandLine, OfEveryCommandHasHelpWithExamplesAndRefusesNonsense) {
    const auto commands = all_commands();
    ASSERT_GE(commands.size(), 15U);
    const core::TemporaryFolder folder;
    for (const auto& command : commands) {
        const auto help = run_underbody({command, "--help"});
        EXPECT_EQ(help.exit_code, 0) << command;
        EXPECT_THAT(help.output, HasSubstr("underbody " + command + " ")) << command << ": no example";
        const auto wrong = run_underbody({command, "--no-such-option-at-all"}, folder.path());
        EXPECT_EQ(wrong.exit_code, 2) << command;
        EXPECT_THAT(wrong.errors, HasSubstr("no option --no-such-option-at-all")) << command;
        if (command == "doctor") {
            continue;  // takes no argument
        }
        const auto missing = run_underbody({command, "--json"}, folder.path());
        EXPECT_EQ(missing.exit_code, 2) << command << " without arguments: " << missing.errors;
        EXPECT_TRUE(json::parse(missing.output).contains("error")) << command;
    }
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(CommandLine, TakesTheCommonOptionsBeforeAndAfterTheCommand) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "a.csv", test::cube_field(0.005, 100));
    const auto plain = run_underbody({"info", "a.csv", "--json"}, folder.path());
    ASSERT_EQ(plain.exit_code, 0) << plain.errors;
    for (const auto& arguments :
         std::vector<std::vector<std::string>>{{"--json", "--threads", "1", "info", "a.csv"},
                                               {"info", "--quiet", "a.csv", "--json", "--threads", "2"},
                                               {"--verbose", "info", "a.csv", "--json"}}) {
        const auto run = run_underbody(arguments, folder.path());
        EXPECT_EQ(run.exit_code, 0) << run.errors;
        EXPECT_EQ(run.output, plain.output);
    }
    EXPECT_EQ(run_underbody({"info", "a.csv", "--threads", "-3"}, folder.path()).exit_code, 2);
}

TEST(CommandLine, AValueWithAWrongUnitIsAWrongCommandLine) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "a.csv", test::cube_field(0.005, 100));
    for (const char* density : {"5 kg", "heavy"}) {
        const auto run = run_underbody({"loads", "a.csv", "--density", density}, folder.path());
        EXPECT_EQ(run.exit_code, 2);
        EXPECT_NE(run.errors.find("'" + std::string(density) + "'"), std::string::npos) << run.errors;
    }
    // It says which option: a command has several in seconds and in metres.
    const std::string study = (test::source_folder() / "cases" / "evie").string();
    const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
        {{"simulate", study + "/glide.toml", "--from", "gap=4 mm", "--for"}, "--for"},
        {{"simulate", study + "/glide.toml", "--from", "gap=4 mm", "--step"}, "--step"},
        {{"region", study + "/glide.toml", "--escape"}, "--escape"},
        {{"body", study + "/shapes/ellipse.toml", "--gap"}, "--gap"},
        {{"predict", study + "/heave/model.toml", "--data", study + "/heave", "--horizon"}, "--horizon"}};
    for (auto [words, option] : wrong) {
        words.emplace_back("5 kg");
        const auto run = run_underbody(words, folder.path());
        EXPECT_EQ(run.exit_code, 2) << option;
        EXPECT_THAT(run.errors, HasSubstr("wrong use: " + option + ": '5 kg': unit 'kg' has another dimension"));
    }
}

// ---- files that cannot be used ----

/// Commands that read no file.
const std::set<std::string> without_files = {"theory", "new", "list", "doctor", "completion"};

/// How each command is given a file.
const std::vector<std::vector<std::string>> with_file = {
    {"body", "FILE", "--out", "out.stl"},
    {"info", "FILE"},
    {"import", "FILE", "--out", "out.vtp"},
    {"loads", "FILE"},
    {"views", "FILE", "--out", "out"},
    {"probe", "FILE", "--point", "0,0,0"},
    {"discover", "FILE", "--data", ".", "--out", "out"},
    {"simulate", "FILE", "--from", "gap=0.1", "--for", "1", "--out", "out.csv"},
    {"predict", "FILE", "--data", ".", "--out", "out.csv"},
    {"region", "FILE", "--axes", "gap=0:1", "--out", "out.png"},
    {"table", "fit", "FILE"},
    {"export", "FILE", "--format", "c", "--out", "out.h"},
    {"study", "run", "FILE"},
    {"study", "accept", "FILE", "x"},
    {"solve", "FILE"},
    {"sweep", "FILE"},
    {"design", "plan", "FILE"},
    {"learn", "FILE", "--out", "out.json"},
    {"estimate", "FILE", "--data", ".", "--out", "out.csv"},
    {"control", "FILE", "--hold", "20mm", "--from", "gap=0.1", "--out", "out.csv"},
    {"linear", "FILE", "--out", "out.png"},
    {"watch", "FILE", "run.csv"}};

TEST(CommandLine, OfEveryCommandSaysWhatIsWrongWithItsFileAndWritesNothing) {
    std::set<std::string> tried;
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "rubbish", std::string("\x01\x02 not a file of ours\n\xff", 24));
    for (const std::string file : {"missing.file", "rubbish"}) {
        for (auto arguments : with_file) {
            tried.insert(arguments[0]);
            std::replace(arguments.begin(), arguments.end(), std::string("FILE"), file);
            arguments.emplace_back("--json");
            const auto run = run_underbody(arguments, folder.path());
            const bool by_ending = arguments[0] == "body";  // which format a name means is a matter of use
            EXPECT_EQ(run.exit_code, by_ending ? 2 : 3) << arguments[0] << ' ' << file << ": " << run.errors;
            if (run.exit_code == 2 || run.exit_code == 3) {
                EXPECT_FALSE(json::parse(run.output)["error"]["message"].get<std::string>().empty()) << arguments[0];
                EXPECT_THAT(run.errors, HasSubstr(file)) << arguments[0];
            }
        }
    }
    for (const auto& command : all_commands()) {
        EXPECT_TRUE(tried.contains(command) || without_files.contains(command)) << command << " is not tried here";
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST(CommandLine, LeavesFilesOfOthersAloneUnlessForced) {
    const core::TemporaryFolder folder;
    const auto write = [&](const char* name, const std::string& text) { std::ofstream(folder.path() / name) << text; };
    const auto read = [&](const char* name) { return core::read_file(folder.path() / name); };
    write("lift.csv", "gap [mm], lift_force [N]\n1, 0.1\n2, 0.02\n5, -0.03\n10, -0.04\n20, -0.01\n50, 0.04\n");
    write("model.toml",
          "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.754 kg\"\n[[force]]\nquantity = \"lift_force\"\ntable "
          "= \"lift.csv\"\n");
    const std::vector<std::vector<std::string>> writers = {
        {"region", "model.toml", "--grid", "5x5", "--for", "1", "--out"},
        {"simulate", "model.toml", "--from", "gap=3mm", "--for", "1", "--plot"},
        {"table", "fit", "lift.csv", "--picture"},
    };
    for (auto words : writers) {
        words.emplace_back("notes.png");
        write("notes.png", "what I wrote down");
        const auto refused = run_underbody(words, folder.path());
        EXPECT_EQ(refused.exit_code, 3) << words[0];
        EXPECT_THAT(refused.errors, testing::HasSubstr("--force"));
        EXPECT_EQ(read("notes.png"), "what I wrote down");
        words.emplace_back("--force");
        EXPECT_EQ(run_underbody(words, folder.path()).exit_code, 0);
        EXPECT_TRUE(read("notes.png").starts_with("\x89PNG"));
        words.pop_back();
        EXPECT_EQ(run_underbody(words, folder.path()).exit_code, 0) << "its own file is replaced as ever";
    }
    // The input itself, a file of the program's own that was changed since, and a fresh empty file.
    const std::string before = read("lift.csv");
    EXPECT_EQ(
        run_underbody({"simulate", "model.toml", "--from", "gap=3mm", "--for", "1", "--out", "lift.csv"}, folder.path())
            .exit_code,
        3);
    EXPECT_EQ(read("lift.csv"), before);
    ASSERT_EQ(
        run_underbody({"simulate", "model.toml", "--from", "gap=3mm", "--for", "1", "--out", "run.csv"}, folder.path())
            .exit_code,
        0);
    std::ofstream(folder.path() / "run.csv", std::ios::app) << "# my remark\n";
    EXPECT_EQ(
        run_underbody({"simulate", "model.toml", "--from", "gap=3mm", "--for", "1", "--out", "run.csv"}, folder.path())
            .exit_code,
        3);
    write("empty.csv", "");
    EXPECT_EQ(run_underbody({"simulate", "model.toml", "--from", "gap=3mm", "--for", "1", "--out", "empty.csv"},
                            folder.path())
                  .exit_code,
              0);
}

TEST(CommandLine, EndsWithThreeWhenTheResultCannotBeWritten) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "a.csv", test::cube_field(0.005, 100));
    core::write_file(folder.path() / "file", "no folder");
    const auto run = run_underbody({"loads", "a.csv", "--out", "file/loads.csv", "--json"}, folder.path());
    EXPECT_EQ(run.exit_code, 3) << run.errors;
    EXPECT_TRUE(json::parse(run.output).contains("error"));
}

// ---- cancelling ----

struct Interrupted {
    int exit_code = 0;
    double seconds = 0;            ///< from the signal to the end, by the clock
    double processor_seconds = 0;  ///< of its whole life: a busy machine does not lengthen it
    double own_seconds = 0;  ///< of that, without the kernel's: clearing and taking back memory depends on the machine
    double own_after = 0;    ///< of these, from the signal on
    bool ended_before = false;  ///< without the signal
};

/// Processor time of a process so far without the kernel's, s: field 14 of /proc/PID/stat, behind the name in brackets.
double own_time(pid_t process) {
    std::string text;
    std::getline(std::ifstream("/proc/" + std::to_string(process) + "/stat"), text);
    std::istringstream fields(text.substr(text.rfind(')') + 2));
    std::string skipped;
    for (int field = 3; field < 14; ++field) {
        fields >> skipped;
    }
    double user = 0;
    fields >> user;
    return user / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

bool has_ended(pid_t child) {
    siginfo_t info{};
    return ::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == child;
}

/// Runs the program and sends it SIGINT after so many seconds, by the clock or of its own processor time (without the
/// kernel's), as Ctrl-C does.
Interrupted interrupted(const std::vector<std::string>& arguments, const fs::path& folder, double after,
                        bool of_own_time = false) {
    const pid_t child = ::fork();
    if (child == 0) {
        if (::chdir(folder.c_str()) != 0) {
            ::_exit(126);
        }
        ::dup2(::open("/dev/null", O_RDWR), 0);
        ::dup2(0, 1);
        ::dup2(0, 2);
        const std::string program = (test::program_folder() / "underbody").string();
        std::vector<char*> argv = {const_cast<char*>(program.c_str())};
        for (const auto& argument : arguments) {
            argv.push_back(const_cast<char*>(argument.c_str()));
        }
        argv.push_back(nullptr);
        ::execv(program.c_str(), argv.data());
        ::_exit(127);
    }
    if (!of_own_time) {
        std::this_thread::sleep_for(std::chrono::duration<double>(after));
    }
    while (of_own_time && !has_ended(child) && own_time(child) < after) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    const auto start = std::chrono::steady_clock::now();
    const double before = own_time(child);
    const bool ended_before = has_ended(child);
    ::kill(child, SIGINT);
    int status = 0;
    rusage used{};
    ::wait4(child, &status, 0, &used);
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
            seconds(used.ru_utime) + seconds(used.ru_stime),
            seconds(used.ru_utime),
            seconds(used.ru_utime) - before,
            ended_before};
}

TEST(CommandLine, EndsWith130OnCtrlCAndLeavesNothingHalfWritten) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "model.toml",
                     "[vehicle]\nmass = \"2 kg\"\nadded_mass_heave = \"2 kg\"\nnet_weight = \"0.35 N\"\n"
                     "[drag.heave]\nlinear = \"0.5 N s/m\"\nquadratic = \"10 N s^2/m^2\"\n");
    core::write_file(folder.path() / "shape.toml",
                     "[body]\nlength = \"200 mm\"\nwidth = \"150 mm\"\nheight = \"140 mm\"\nbase_cut = 0.75\n");
    fs::copy(test::source_folder() / "cases" / "evie" / "heave", folder.path() / "runs", fs::copy_options::recursive);
    const auto entries = [&] {
        std::set<std::string> names;
        for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
            names.insert(entry.path().string());
        }
        return names;
    };
    const auto before = entries();
    for (const auto& arguments : std::vector<std::vector<std::string>>{
             {"region", "model.toml", "--axes", "gap=0.001:1,heave_velocity=-0.1:0.1", "--grid", "6000x6000", "--for",
              "10000", "--out", "map.png"},
             {"simulate", "model.toml", "--from", "gap=100000", "--for", "1e7", "--step", "1e-3", "--out", "run.csv"},
             {"body", "shape.toml", "--triangles", "20000000", "--out", "body.stl"},
             {"discover", "runs/model.toml", "--data", "runs", "--out", "found"}}) {
        const auto run = interrupted(arguments, folder.path(), 0.5);
        EXPECT_EQ(run.exit_code, 130) << arguments[0];
        EXPECT_LT(run.processor_seconds, 5) << arguments[0];  // left alone they take minutes
        EXPECT_LT(run.seconds, 20) << arguments[0] << " (by the clock, on a busy machine)";
        EXPECT_EQ(entries(), before) << arguments[0];
    }
}

TEST(CommandLine, ALargeMapEndsOnCtrlCWhereverItIs) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "model.toml", "[vehicle]\nmass = \"2 kg\"\nadded_mass_heave = \"2 kg\"\n");
    // Its starts escape at once: most of the time goes into laying them out and counting where they ended.
    const std::vector<std::string> map = {"region", "model.toml", "--axes",   "gap=1:2,heave_velocity=10:20",
                                          "--grid", "6000x6000",  "--escape", "1m"};
    const auto whole = interrupted(map, folder.path(), 1e9, true);
    ASSERT_EQ(whole.exit_code, 0);
    double seconds = whole.own_seconds;
    for (const double part : {0.05, 0.15, 0.3, 0.45, 0.6}) {
        auto run = interrupted(map, folder.path(), part * seconds, true);
        // A shared processor that became faster ends the map before the signal: it takes as long as that one then.
        for (int again = 0; run.ended_before && again < 5; ++again) {
            seconds = run.own_seconds;
            run = interrupted(map, folder.path(), part * seconds, true);
        }
        EXPECT_EQ(run.exit_code, 130) << "after " << 100 * part << " % of " << seconds << " s";
        EXPECT_LT(run.own_after, 0.25 * seconds) << "after " << 100 * part << " % of " << seconds << " s";
    }
}

// ---- examples ----

/// Words of a line as a shell splits them; a comment that stands behind two blanks ends it.
std::vector<std::string> words_of(const std::string& line) {
    std::vector<std::string> words;
    std::string word;
    char quote = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (quote != 0) {
            quote == c ? quote = 0 : (word += c, 0);
        } else if (c == '\'' || c == '"') {
            quote = c;
        } else if (c == ' ') {
            if (!word.empty()) {
                words.push_back(word);
            }
            word.clear();
            if (i + 1 < line.size() && line[i + 1] == ' ') {
                break;
            }
        } else {
            word += c;
        }
    }
    if (!word.empty()) {
        words.push_back(word);
    }
    const auto second = std::find(words.begin(), words.end(), "&&");
    words.erase(second, words.end());
    return words;
}

/// The example lines of a text: those that begin with "underbody ".
std::vector<std::string> examples_in(const std::string& text, const std::string& usage) {
    std::vector<std::string> examples;
    std::istringstream lines(text);
    std::string line;
    while (std::getline(lines, line)) {
        std::erase(line, '\\');
        const std::string bare(core::trimmed(line));
        if (bare.starts_with("underbody ") && bare != usage && bare.find(" COMMAND") == std::string::npos) {
            examples.push_back(bare);
        }
    }
    return examples;
}

/// All examples of the program's own help and of its man page.
std::vector<std::string> all_examples() {
    const std::string page = core::read_file(test::source_folder() / "docs" / "man" / "underbody.1");
    auto examples = examples_in(page.substr(page.find(".SH EXAMPLES")), "");
    const auto take = [&](const std::vector<std::string>& path) {
        auto arguments = path;
        arguments.emplace_back("--help");
        const std::string help = run_underbody(arguments).output;
        const auto more = examples_in(
            help.substr(help.find("Example") == std::string::npos ? help.size() : help.find("Example")), "");
        examples.insert(examples.end(), more.begin(), more.end());
        return commands_in(help);
    };
    for (const auto& command : take({})) {
        for (const auto& inner : take({command})) {
            take({command, inner});
        }
    }
    return examples;
}

TEST(Examples, OfEveryHelpTextAreCommandLinesThatTheProgramUnderstands) {
    const core::TemporaryFolder empty;
    const auto examples = all_examples();
    EXPECT_GE(examples.size(), 40U);
    for (const auto& example : examples) {
        auto arguments = words_of(example);
        arguments.erase(arguments.begin());
        const auto run = run_underbody(arguments, empty.path());
        if (without_files.contains(arguments[0])) {
            // A template is never written over a file that an earlier example made.
            // And what a machine lacks is no fault of the example.
            EXPECT_TRUE(run.exit_code == 0 || (arguments[0] == "new" && run.exit_code == 3) ||
                        (arguments[0] == "doctor" && run.exit_code == 4))
                << example << "\n"
                << run.errors;
            continue;
        }
        // There is no file here, so that they cannot succeed; but it must be the file that is missing.
        EXPECT_TRUE(run.exit_code == 3 || run.errors.find("does not exist") != std::string::npos)
            << example << "\n"
            << run.exit_code << ": " << run.errors;
        EXPECT_THAT(run.errors, testing::Not(HasSubstr("has no option"))) << example;
        EXPECT_THAT(run.errors, testing::Not(HasSubstr("not expected"))) << example;
    }
}

}  // namespace
}  // namespace underbody
