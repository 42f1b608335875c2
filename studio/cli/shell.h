// What every command shares: output, errors, exit codes, progress, cancelling.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/progress.h"

namespace CLI {
class App;
}

namespace underbody::core {
class Table;
}

namespace underbody::geometry {
struct SurfaceMesh;
}

namespace underbody::postproc {
struct Field;
struct ReadOptions;
}  // namespace underbody::postproc

namespace underbody::studio {

struct Caller;

enum ExitCode { done = 0, defect = 1, wrong_usage = 2, wrong_input = 3, check_failed = 4, cancelled = 130 };

/// "0.1.0"
std::string version();

class Shell {
public:
    Shell();
    /// How a warning begins that is of files that were not asked for.
    static constexpr std::string_view left_out_by_pattern = "left out, for their names do not fit the pattern";

    /// For a program that runs commands in its own process: nothing goes to the terminal, all of it to the caller.
    Shell(Caller& caller, core::Progress::Listener listener);

    bool json = false;
    bool quiet = false;
    bool verbose = false;
    int threads = 0;
    bool force = false;           ///< files of others are replaced
    bool all_or_nothing = false;  ///< the text is kept until the command has ended; none of it where by an error
    bool list_on_stdout = false;  ///< a table or names of files, for other programs: no line of ours among them

    /// Runs `action` when the sub-command was chosen; its result is the exit code.
    void on(CLI::App* command, std::function<int()> action);

    /// One JSON document on stdout.
    void print_json(const nlohmann::json& document);
    /// Text on stdout (nothing with --json).
    void print(const std::string& text);
    /// To stderr. `info` is silent with --quiet, `detail` speaks with --verbose only. What is said of the result is
    /// for show().
    void warn(const std::string& text);
    void info(const std::string& text);
    void detail(const std::string& text);
    /// Problems that change what the numbers mean, each once and where the numbers are read: in the text a line
    /// "warning: ..." on stdout (but where stdout is for other programs: `list_on_stdout`), in the document of --json,
    /// whose `warnings` get what it does not hold elsewhere; and on stderr, unless both streams lead to one place (a
    /// terminal, 2>&1): there only what no text, document or table took. Notes are detail. `told`: the text of the
    /// command holds them.
    void show(const core::Problems& problems, bool told = false);
    void show_warning(const std::string& message) { show({{core::Problem::Severity::warning, message, {}}}); }
    /// The warnings so far as comments of a table that is a result, those that it does not hold.
    void comment_warnings(core::Table& table);
    /// The result holds the warnings so far.
    void documented() { held_back_.clear(); }
    /// Refuses, before the work is done, to write over a file that is somebody else's (core/own_files.h). Empty:
    /// nothing.
    static void will_write(const std::string& path);

    /// A CFD file, or the field that the caller read from it before.
    postproc::Field read_field(const std::string& path, const postproc::ReadOptions& options);
    /// A table of the results, whether or not it is written to a file: the caller takes it. `make` runs only for one.
    void hand_over(const std::string& name, const std::function<core::Table()>& make);
    void hand_over(const geometry::SurfaceMesh& surface);
    /// Of the process that runs the command; nullptr: a terminal.
    [[nodiscard]] const Caller* caller() const { return caller_; }
    /// Path of `underbody`, for scripts that call it later. Throws core::UsageError where there is none.
    [[nodiscard]] std::string program() const;

    /// Draws a bar on stderr when it is a terminal and nobody asked for quiet; Ctrl-C cancels it.
    core::Progress& progress() { return progress_; }

    /// Parses, runs, turns exceptions into exit codes and messages.
    int run(CLI::App& app, int argc, const char* const* argv);
    /// run() that leaves the process's signals alone.
    int execute(CLI::App& app, int argc, const char* const* argv);

private:
    struct Warning {
        std::string text;  ///< with its place
        std::string message;
    };

    int run_action();
    void report(const core::Error& error, const char* what);
    void say(int level, const std::string& text);
    /// To stderr: warnings that the result was to hold and does not.
    void release();
    std::function<int()> action_;
    std::set<std::string> said_;          ///< warnings, each of which is said once
    std::vector<Warning> undocumented_;   ///< said, but in no document yet
    std::string text_;                    ///< kept while all_or_nothing
    std::vector<std::string> held_back_;  ///< for the result alone, where a line of stderr would be read beside it
    Caller* caller_ = nullptr;
    core::Progress progress_;
};

}  // namespace underbody::studio
