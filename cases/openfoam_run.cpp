#include "cases/openfoam_run.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "cases/openfoam_result.h"
#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/importers/reports/openfoam_forces.h"
#include "postproc/loads/settled.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

constexpr const char* script_log = "log.Allrun";

std::string text_of_control(const fs::path& folder) { return core::read_file(folder / "system" / "controlDict"); }

/// The log of the step that was written last.
fs::path newest_log(const fs::path& folder) {
    fs::path newest;
    fs::file_time_type when = fs::file_time_type::min();
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with("log.") && name != script_log && entry.is_regular_file(ignored) &&
            (newest.empty() || entry.last_write_time(ignored) > when)) {
            newest = entry.path();
            when = entry.last_write_time(ignored);
        }
    }
    return newest;
}

/// Seconds of one iteration, of those that stand in the end of a log.
std::optional<double> pace(std::string_view log) {
    std::optional<double> first_time, first_clock, time, clock, iteration;
    for (const auto line : core::split(log, '\n')) {
        if (line.starts_with("Time = ")) {
            iteration = core::parse_number(line.substr(7, line.find_first_of(" s", 7) - 7));
        } else if (line.starts_with("ExecutionTime = ") && iteration) {
            time = iteration;
            clock = core::parse_number(line.substr(16, line.find(' ', 16) - 16));
            first_time = first_time.value_or(*time);
            first_clock = first_clock ? first_clock : clock;
        }
    }
    const bool known = clock && first_clock && *time > *first_time && *clock >= *first_clock;
    return known ? std::optional((*clock - *first_clock) / (*time - *first_time)) : std::nullopt;
}

/// Times that a run on several cores wrote and that were never put together.
void put_together(const fs::path& folder, const std::vector<std::pair<std::string, std::string>>& environment) {
    std::error_code ignored;
    for (const char* part : {".", "start"}) {
        const fs::path at = folder / part;
        if (!fs::is_directory(at / "processor0", ignored)) {
            continue;
        }
        const auto reconstruct = find_program("reconstructPar");
        if (std::string_view(part) == "." && reconstruct) {
            ChildProcess child(reconstruct->string(), {"-newTimes"}, folder, folder / "log.reconstructPar",
                               environment);
            while (!child.ended()) {
                std::this_thread::sleep_for(std::chrono::milliseconds(10));
            }
        }
        for (const auto& entry : fs::directory_iterator(at, ignored)) {
            if (entry.path().filename().string().starts_with("processor")) {
                fs::remove_all(entry.path(), ignored);
            }
        }
    }
}

/// s of processor time without a word.
double hung_after() {
    const char* asked = std::getenv("UNDERBODY_HUNG_AFTER");
    if (asked == nullptr || *asked == '\0') {
        return StallWatch::usual_limit;
    }
    const double limit = core::parse_in(asked, "s");
    if (!(limit > 0)) {
        throw core::InputError("range", "UNDERBODY_HUNG_AFTER is '" + std::string(asked) + "'", {},
                               "a time above zero, such as UNDERBODY_HUNG_AFTER=30min");
    }
    return limit;
}

/// What OpenFOAM said when it failed: the lines of its fatal error, else the last ones.
std::string last_words(const fs::path& log) {
    const std::string text = tail_of(log, 1 << 16);
    const auto fatal = text.rfind("FOAM FATAL");
    std::vector<std::string> lines;
    for (const auto line : core::split(std::string_view(text).substr(fatal == std::string::npos ? 0 : fatal), '\n')) {
        const auto bare = core::trimmed(line);
        if (!bare.empty()) {
            lines.emplace_back(bare);
        }
    }
    if (text.find("sigFpe") != std::string::npos) {
        return "a floating-point exception: the solution diverged";
    }
    const std::size_t most = 4;
    const std::size_t first = fatal == std::string::npos && lines.size() > most ? lines.size() - most : 0;
    std::string words;
    for (std::size_t i = first; i < std::min(lines.size(), first + most); ++i) {
        words += (words.empty() ? "" : " ") + lines[i];
    }
    return words;
}

}  // namespace

double RunState::fraction() const {
    if (iteration <= 0 || iterations <= 0) {
        return step.empty() ? 0 : 0.05;
    }
    return 0.1 + 0.9 * std::min(1.0, static_cast<double>(iteration) / iterations);
}

RunState run_state(const fs::path& folder) {
    RunState state;
    const fs::path control = folder / "system" / "controlDict";
    const auto end = dictionary_number(control, "endTime");
    const auto step = dictionary_number(control, "deltaT");
    if (end && step && *step > 0) {
        state.iterations = static_cast<int>(std::lround(*end / *step));
    }
    const fs::path log = newest_log(folder);
    if (log.empty()) {
        return state;
    }
    state.step = log.filename().string().substr(4);
    const std::string text = tail_of(log, 1 << 14);
    const auto at = text.rfind("\nTime = ");
    if (at != std::string::npos && state.step.ends_with("Foam")) {
        const std::string_view rest = std::string_view(text).substr(at + 8);
        if (const auto time = core::parse_number(rest.substr(0, rest.find_first_of(" s\n")))) {
            state.iteration = static_cast<int>(std::lround(*time / step.value_or(1)));
            if (const auto each = pace(text); each && state.iterations >= state.iteration) {
                state.seconds_left = *each / step.value_or(1) * (state.iterations - state.iteration);
            }
        }
    }
    return state;
}

SettledLoads settled_loads(const fs::path& folder) {
    constexpr std::size_t window = 100;
    constexpr double first_iteration = 220;
    SettledLoads loads;
    const auto histories = postproc::read_openfoam_forces(folder);
    const auto found = std::find_if(histories.begin(), histories.end(),
                                    [](const postproc::ForceHistory& history) { return history.name == "forces"; });
    if (found == histories.end() || found->time.size() < window || found->time.back() < first_iteration) {
        return loads;
    }
    const auto& f = *found;
    const auto over = [&](const auto& value) {
        double low = HUGE_VAL, high = -HUGE_VAL, sum = 0;
        for (std::size_t i = f.time.size() - window; i < f.time.size(); ++i) {
            const double v = value(i);
            low = std::min(low, v), high = std::max(high, v), sum += v;
        }
        return std::pair{sum / window, high - low};
    };
    const auto drag = over([&](std::size_t i) { return f.pressure_force[i][0] + f.viscous_force[i][0]; });
    const auto lift = over([&](std::size_t i) { return f.pressure_force[i][2] + f.viscous_force[i][2]; });
    loads.iterations = static_cast<int>(window);
    loads.resultant = std::hypot(drag.first, lift.first);
    loads.force_range = std::max(drag.second, lift.second);
    const double arm = 0.1 * dictionary_number(folder / "system" / "controlDict", "lRef").value_or(0);
    if (arm > 0 && f.pressure_moment.size() == f.time.size()) {
        loads.moment_range =
            over([&](std::size_t i) { return f.pressure_moment[i][1] + f.viscous_moment[i][1]; }).second;
    }
    const double share = std::max(loads.force_range, arm > 0 ? loads.moment_range / arm : 0) / loads.resultant;
    loads.settled = share <= postproc::still_range;
    loads.text =
        (loads.settled ? "lift, drag and pitch moment stay within " : "lift, drag or pitch moment change by ") +
        core::format_number(100 * share, 2) + " % of the resultant over " + std::to_string(window) +
        " iterations (a run is ended early at " + core::format_number(100 * postproc::still_range, 2) + " %)";
    return loads;
}

void need_openfoam() {
    for (const char* program : {"blockMesh", "simpleFoam"}) {
        if (!find_program(program)) {
            throw core::SystemError("missing",
                                    std::string("OpenFOAM is not here: there is no '") + program + "' on the PATH", {},
                                    "install it: apt install openfoam");
        }
    }
}

namespace {

void check_case(const fs::path& folder) {
    if (!fs::is_directory(folder) || !fs::is_regular_file(folder / "Allrun")) {
        throw core::InputError("missing",
                               fs::exists(folder) ? "there is no Allrun in this folder" : "there is no such folder",
                               {folder.string(), {}, {}, {}},
                               "'body domain' writes a case around a shape, from its gap on (option 'gap 5mm')");
    }
    if (!fs::is_regular_file(folder / "system" / "controlDict")) {
        throw core::InputError("missing", "the case has no system/controlDict", {folder.string(), {}, {}, {}});
    }
}

void need_programs(int cores) {
    need_openfoam();
    for (const char* program : {"mpirun", "decomposePar", "reconstructPar"}) {
        if (cores > 1 && !find_program(program)) {
            throw core::SystemError(
                "missing", std::string("a case on several cores needs '") + program + "', which is not on the PATH", {},
                "install it: apt install openfoam openmpi-bin");
        }
    }
}

/// Debian's OpenFOAM needs one variable and nothing sourced.
std::vector<std::pair<std::string, std::string>> needed_environment() {
    std::vector<std::pair<std::string, std::string>> environment;
    if (std::getenv("WM_PROJECT_DIR") == nullptr) {
        environment.emplace_back("WM_PROJECT_DIR", "/usr/share/openfoam");
    }
    return environment;
}

}  // namespace

OpenFoamRun::OpenFoamRun(fs::path folder, int lock, int cores)
    : folder_(std::move(folder)),
      start_(std::chrono::steady_clock::now()),
      cores_(std::max(1, cores)),
      stall_(hung_after()) {
    check_case(folder_);
    need_programs(cores);
    lock_ = Lock::take(folder_ / ".underbody.lock", "solve");
    if (!lock_) {
        throw core::InputError(
            "busy",
            "the case is being solved by " + Lock::holder(folder_ / ".underbody.lock").value_or("another process"),
            {folder_.string(), {}, {}, {}}, "wait for it, or end it first");
    }
    auto environment = needed_environment();
    put_together(folder_, environment);
    from_ = ready_to_go_on(folder_);
    if (!from_ && solves_anew(folder_)) {
        set_results_aside(folder_);
    }
    environment.emplace_back("UNDERBODY_CORES", std::to_string(std::max(1, cores)));
    if (cores > 1 && ::geteuid() == 0) {  // Open MPI wants to be told twice that root may
        environment.emplace_back("OMPI_ALLOW_RUN_AS_ROOT", "1");
        environment.emplace_back("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
    }
    const fs::path at = fs::absolute(folder_);
    std::vector<std::string> words = {"./Allrun"};
    if (from_) {
        words.emplace_back("solve");
    }
    watched_ = text_of_control(folder_).find(std::string("/") + settled_file + "\"") != std::string::npos;
    std::error_code ignored;
    if (watched_) {
        fs::remove(folder_ / settled_file, ignored);  // of a run that was cut as it ended
    }
    child_.emplace("/bin/sh", words, at, at / script_log, environment, std::array<int, 2>{lock_->descriptor(), lock});
}

bool OpenFoamRun::finished() {
    const auto code = child_->ended();
    if (!code) {
        const auto now = std::chrono::steady_clock::now();
        if (now - looked_ >= std::chrono::seconds(1)) {
            looked_ = now;
            look_at_loads();
            look_whether_it_hangs();
        }
        return false;
    }
    if (*code == 0) {
        return true;
    }
    // The script names the step that failed; a script of another make may not.
    fs::path log = folder_ / script_log;
    const std::string text = "\n" + tail_of(log, 4096);
    if (const auto failed = text.find(" failed: see "); failed != std::string::npos) {
        const auto begin = text.rfind('\n', failed) + 1;
        const fs::path named = folder_ / ("log." + text.substr(begin, failed - begin));
        log = fs::is_regular_file(named) ? named : log;
    }
    // What a program does to itself is no signal from outside: OpenFOAM ends itself by them when it diverges.
    const std::array own = {128 + SIGFPE, 128 + SIGABRT, 128 + SIGSEGV, 128 + SIGBUS, 128 + SIGILL};
    if (*code > 128 && std::find(own.begin(), own.end(), *code) == own.end()) {
        throw core::InputError("killed", "the solver was ended by signal " + std::to_string(*code - 128),
                               {log.string(), {}, {}, {}}, "the next solve goes on from its last checkpoint");
    }
    const std::string words =
        *code == 128 + SIGFPE ? "a floating-point exception: the solution diverged" : last_words(log);
    throw core::InputError("solver",
                           (*code > 128 ? "the solver ended itself by signal " + std::to_string(*code - 128)
                                        : "the solver ended with code " + std::to_string(*code)) +
                               (words.empty() ? "" : ": " + words),
                           {log.string(), {}, {}, {}});
}

void OpenFoamRun::look_at_loads() {
    if (!watched_ || !fs::is_directory(folder_ / "postProcessing")) {
        return;
    }
    SettledLoads loads;
    try {
        loads = settled_loads(folder_);
    } catch (const core::InputError&) {
        return;  // a row is being written: the next look, or the end of the run, tells
    }
    if (!std::isfinite(loads.resultant)) {
        stop();
        throw core::InputError("solver", "its forces are no longer finite: the solution diverged",
                               {(folder_ / "postProcessing").string(), {}, {}, {}});
    }
    if (loads.settled) {
        core::write_file(folder_ / settled_file, loads.text + "\n");
        watched_ = false;
    }
}

void OpenFoamRun::look_whether_it_hangs() {
    std::uintmax_t said = 0;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder_, ignored)) {
        if (entry.path().filename().string().starts_with("log.") && entry.is_regular_file(ignored)) {
            said += entry.file_size(ignored);
        }
    }
    const ChildProcess::Use use = child_->use();
    const std::string why = stall_.look(said, use.processor_seconds / cores_, seconds(), use.stopped);
    if (!why.empty()) {
        stop();
        throw core::InputError("solver", "the solver hangs and was ended: " + why,
                               {newest_log(folder_).string(), {}, {}, {}});
    }
}

double OpenFoamRun::seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

}  // namespace underbody::cases
