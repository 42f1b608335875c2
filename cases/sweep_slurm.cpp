#include "cases/sweep_slurm.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <thread>

#include "cases/child_process.h"
#include "cases/lock.h"
#include "cases/sweep_parts.h"
#include "core/counted.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

constexpr int usual_max_array = 1000;  ///< Slurm's own default of MaxArraySize is 1001, indices below it

/// A word for the shell.
std::string quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : text) {
        result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    }
    return result + "'";
}

struct Answer {
    int code = 0;
    std::string text;
};

/// What a program of Slurm says; nothing when it is not here.
std::optional<Answer> ask(const std::string& program, const std::vector<std::string>& arguments, const fs::path& folder,
                          core::Progress& progress) {
    const auto file = find_program(program);
    if (!file) {
        return {};
    }
    const core::TemporaryFolder scratch;
    const fs::path log = scratch.path() / "answer";
    ChildProcess child(file->string(), arguments, folder, log);
    while (!child.ended()) {
        progress.check();
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return Answer{*child.ended(), std::string(core::trimmed(core::read_file(log)))};
}

std::string job_name(const std::string& submission) { return "underbody-sweep-" + submission; }

/// Of the job that runs the study.
std::string study_job_name(const Study& study) {
    return "underbody-study-" +
           core::content_hash(fs::weakly_canonical(fs::absolute(study.folder())).string()).substr(0, 12);
}

/// Unlikely to come again, on whatever machine.
std::string new_submission() {
    std::random_device device;
    const char* digits = "0123456789abcdef";
    std::string text;
    for (int i = 0; i < 12; ++i) {
        text += digits[device() % 16];
    }
    return text;
}

std::string text_of(const SlurmClaim& claim) {
    return nlohmann::json(
               {{"submission", claim.submission}, {"job", claim.job}, {"task", claim.task}, {"since", claim.since}})
               .dump() +
           "\n";
}

/// False when the case has been claimed meanwhile.
bool claim_case(const fs::path& folder, const SlurmClaim& claim) {
    const fs::path file = claim_file(folder);
    fs::create_directories(file.parent_path());
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (descriptor < 0 && errno == EEXIST) {
        return false;
    }
    const std::string text = text_of(claim);
    if (descriptor < 0 || ::write(descriptor, text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
        const int error = errno;
        if (descriptor >= 0) {
            ::close(descriptor);
            ::unlink(file.c_str());
        }
        throw core::SystemError("write", std::string("cannot be written: ") + std::strerror(error),
                                {file.string(), {}, {}, {}});
    }
    ::close(descriptor);
    return true;
}

/// Tasks that the site takes in one array.
int tasks_per_array(const SlurmSpec& settings, core::Progress& progress) {
    if (settings.max_array > 0) {
        return settings.max_array;
    }
    if (const auto answer = ask("scontrol", {"show", "config"}, ".", progress); answer && answer->code == 0) {
        for (const auto line : core::split(answer->text, '\n')) {
            const auto equals = line.find('=');
            if (core::trimmed(line).starts_with("MaxArraySize") && equals != std::string_view::npos) {
                const auto size = core::parse_integer(core::trimmed(line.substr(equals + 1)));
                return size && *size > 1 ? static_cast<int>(*size) - 1 : usual_max_array;  // indices end below it
            }
        }
    }
    return usual_max_array;
}

std::string folder_of(const Study& study) { return fs::absolute(study.folder()).lexically_normal().string(); }

std::string site_options(const SlurmSpec& s) {
    const auto option = [](const char* name, const std::string& value) {
        return value.empty() ? std::string() : std::string("#SBATCH --") + name + "=" + value + "\n";
    };
    std::string text = option("partition", s.partition) + option("time", s.time) + option("mem", s.memory) +
                       option("account", s.account);
    for (const auto& further : s.options) {
        text += "#SBATCH " + further + "\n";
    }
    return text;
}

/// Hands a script to sbatch; the job's number. `before`: what was submitted already, for the words of a refusal.
std::string submitted(const fs::path& script, std::vector<std::string> arguments, std::size_t before,
                      core::Progress& progress) {
    arguments.insert(arguments.begin(), "--parsable");
    arguments.push_back(fs::absolute(script).string());
    const auto answer = ask("sbatch", arguments, fs::absolute(script).parent_path(), progress);
    if (!answer || answer->code != 0) {
        throw core::SystemError(
            "slurm", "sbatch refused the job: " + (answer ? answer->text : ""), {script.string(), {}, {}, {}},
            before == 0 ? ""
                        : core::counted(before, "array before it was submitted", "arrays before it were submitted"));
    }
    return answer->text.substr(0, answer->text.find_first_of(";\n"));
}

std::string script_text(const Study& study, const SlurmSubmission& what, const std::string& submission,
                        const std::vector<std::string>& names) {
    const SlurmSpec& s = what.settings;
    std::string title = study.title;
    std::replace(title.begin(), title.end(), '\n', ' ');
    std::string script = "#!/bin/sh\n# One task for each case that the study '" + title +
                         "' misses.\n#SBATCH --job-name=" + job_name(submission) + "\n#SBATCH --array=1-" +
                         std::to_string(names.size()) + (s.throttle > 0 ? "%" + std::to_string(s.throttle) : "") +
                         "\n#SBATCH --nodes=1\n#SBATCH --ntasks=" + std::to_string(s.cores) +
                         "\n#SBATCH --cpus-per-task=1\n# What was preempted goes on from its last checkpoint.\n#SBATCH "
                         "--requeue\n" +
                         site_options(s);
    script += "case \"$SLURM_ARRAY_TASK_ID\" in\n";
    for (std::size_t i = 0; i < names.size(); ++i) {
        script += std::to_string(i + 1) + ") name=" + quoted(names[i]) + " ;;\n";
    }
    return script + "*) echo 'run this as a Slurm job array' >&2; exit 2 ;;\nesac\nexec " + quoted(what.program) +
           " sweep " + quoted(folder_of(study)) + " --engine local --jobs 1 --cores " + std::to_string(s.cores) +
           " --retries " + std::to_string(s.retries) + " --only \"$name\" --submission " + submission +
           (what.replace_stale ? " --stale replace"
            : what.keep_stale  ? " --stale keep"
                               : "") +
           "\n";
}

/// The cases of one array, claimed for it.
struct Claimed {
    std::vector<const SweepCase*> cases;
    std::string submission = new_submission();

    void release() const {
        for (const SweepCase* one : cases) {
            std::error_code ignored;
            fs::remove(claim_file(one->folder), ignored);
        }
    }
    void write_job(const std::string& job) const {
        for (std::size_t i = 0; i < cases.size(); ++i) {
            if (auto claim = read_claim(cases[i]->folder); claim && claim->submission == submission) {
                claim->job = job;
                core::write_file(claim_file(cases[i]->folder), text_of(*claim));
            }
        }
    }
};

/// Numbers of the jobs that have these cases already.
std::set<std::string> jobs_of(const std::vector<SweepCase>& cases) {
    std::set<std::string> jobs;
    for (const SweepCase& one : cases) {
        if (const auto claim = read_claim(one.folder); claim && !claim->job.empty()) {
            jobs.insert(claim->job);
        }
    }
    return jobs;
}

/// Does one wait that runs the study when the arrays have ended?
bool has_study_job(const Study& study, core::Progress& progress) {
    const auto answer = ask("squeue", {"--noheader", "--name", study_job_name(study), "--format", "%A"}, ".", progress);
    return answer && answer->code == 0 && !answer->text.empty();
}

/// The job that runs the study when these have ended, however; `arrays` were submitted just now.
SlurmArray submit_study(const Study& study, const SlurmSubmission& what, const std::set<std::string>& jobs,
                        std::size_t arrays, core::Progress& progress) {
    SlurmArray job;
    job.script =
        what.script.parent_path() / (what.script.stem().string() + "-study" + what.script.extension().string());
    core::write_file(job.script, "#!/bin/sh\n# Runs the study when its cases are solved.\n#SBATCH --job-name=" +
                                     study_job_name(study) + "\n#SBATCH --ntasks=1\n" + site_options(what.settings) +
                                     "exec " + quoted(what.program) + " study run " + quoted(folder_of(study)) + "\n");
    std::string after;
    for (const std::string& number : jobs) {
        after += ":" + number;
    }
    if (!jobs.empty()) {
        job.job = submitted(job.script, {"--dependency=afterany" + after}, arrays, progress);
    }
    return job;
}

}  // namespace

bool slurm_takes(const std::string& text) {
    return std::none_of(text.begin(), text.end(), [](unsigned char c) { return std::isspace(c) || std::iscntrl(c); });
}

fs::path claim_file(const fs::path& case_folder) { return beside(case_folder, ".submitted"); }

std::optional<SlurmClaim> read_claim(const fs::path& case_folder) {
    std::error_code ignored;
    const fs::path file = claim_file(case_folder);
    if (!fs::is_regular_file(file, ignored)) {
        return {};
    }
    const auto json = nlohmann::json::parse(core::read_file(file), nullptr, false);
    SlurmClaim claim;
    if (json.is_object()) {
        claim.submission = json.value("submission", "");
        claim.job = json.value("job", "");
        claim.task = json.value("task", 0);
        claim.since = json.value("since", "");
    }
    return claim;
}

std::optional<std::string> SlurmQueue::state(const SlurmClaim& claim) {
    auto known = known_.find(claim.submission);
    if (known == known_.end()) {
        std::optional<std::map<int, std::string>> tasks;
        const auto answer =
            ask("squeue", {"--noheader", "--array", "--name", job_name(claim.submission), "--format", "%K %T"}, ".",
                core::Progress::none());
        if (answer && answer->code == 0) {
            tasks.emplace();
            for (const auto line : core::split(answer->text, '\n')) {
                const auto words = core::split(core::trimmed(line), ' ');
                const auto task = core::parse_integer(words.front());
                if (task && words.size() > 1) {
                    (*tasks)[static_cast<int>(*task)] = std::string(words.back());
                }
            }
        }
        known = known_.emplace(claim.submission, std::move(tasks)).first;
    }
    if (!known->second) {
        return {};
    }
    const auto task = known->second->find(claim.task);
    return task == known->second->end() ? "" : task->second;
}

bool SlurmQueue::has_any(const SlurmClaim& claim) {
    (void)state(claim);
    const auto& tasks = known_.at(claim.submission);
    return tasks && !tasks->empty();
}

namespace {

void write_array(const Study& study, const SlurmSubmission& what, const Claimed& claimed, std::size_t before,
                 SlurmArray& array) {
    const std::string number = before == 0 ? "" : "-" + std::to_string(before + 1);
    array.script =
        what.script.parent_path() / (what.script.stem().string() + number + what.script.extension().string());
    core::write_file(array.script, script_text(study, what, claimed.submission, array.names));
}

/// After those before it; its cases are free again where it fails.
void submit_array(const SlurmSubmission& what, Claimed& claimed, const std::vector<SlurmArray>& before,
                  SlurmArray& array, core::Progress& progress) {
    std::vector<std::string> arguments;
    if (what.settings.throttle > 0 && !before.empty()) {
        arguments.push_back("--dependency=afterany:" + before.back().job);
    }
    try {
        array.job = submitted(array.script, arguments, before.size(), progress);
    } catch (const core::SystemError&) {
        claimed.release();
        throw;
    }
    claimed.write_job(array.job);
}

}  // namespace

SlurmSweep submit_sweep(const Study& study, const SlurmSubmission& what, core::Progress& progress) {
    if (!study.sweep) {
        return (void)wanted_cases(study, {}, progress), SlurmSweep{};  // says that there is none
    }
    SweepOptions options;
    options.only = what.only;
    options.stale = what.keep_stale ? StaleCases::keep : what.replace_stale ? StaleCases::replace : StaleCases::redo;
    const fs::path submit_lock = study.folder() / study.sweep->folder / ".submit.lock";
    const auto lock = Lock::take(submit_lock, "sweep --engine slurm");
    if (!lock) {
        throw core::InputError(
            "busy", "the sweep is being submitted by " + Lock::holder(submit_lock).value_or("another process"),
            {study.folder().string(), {}, {}, {}});
    }
    auto wanted = wanted_cases(study, options, progress);
    const auto theirs = std::stable_partition(wanted.begin(), wanted.end(), [](const SweepCase& one) {
        return one.state != SweepState::running && one.state != SweepState::waiting;
    });
    std::set<std::string> jobs = jobs_of(std::vector<SweepCase>(theirs, wanted.end()));
    wanted.erase(theirs, wanted.end());
    const auto sbatch = find_program("sbatch");
    const auto most = static_cast<std::size_t>(wanted.empty() ? 1 : tasks_per_array(what.settings, progress));
    SlurmSweep all;
    std::vector<SlurmArray>& arrays = all.arrays;
    for (std::size_t next = 0; next < wanted.size();) {
        Claimed claimed;
        SlurmArray array;
        for (; next < wanted.size() && claimed.cases.size() < most; ++next) {
            const SweepCase& one = wanted[next];
            const SlurmClaim claim{claimed.submission, {}, static_cast<int>(claimed.cases.size()) + 1, now_text()};
            std::error_code ignored;
            fs::remove(claim_file(one.folder), ignored);  // of a job that is gone: see wanted_cases
            if (!sbatch || claim_case(one.folder, claim)) {
                claimed.cases.push_back(&one);
                array.names.push_back(one.name);
            }
        }
        if (array.names.empty()) {
            continue;
        }
        write_array(study, what, claimed, arrays.size(), array);
        if (sbatch) {
            submit_array(what, claimed, arrays, array, progress);
            jobs.insert(array.job);
        }
        arrays.push_back(std::move(array));
    }
    const bool anything = !arrays.empty() || (!jobs.empty() && !has_study_job(study, progress));
    if (what.settings.run_study && anything) {
        all.study = submit_study(study, what, jobs, arrays.size(), progress);
    }
    return all;
}

std::vector<SweepCase> wait_for_sweep(const Study& study, core::Progress& progress) {
    auto pause = std::chrono::milliseconds(500);
    while (true) {
        auto cases = sweep_cases(study, progress);
        double done = 0;
        std::size_t open = 0;
        for (const SweepCase& one : cases) {
            const bool waits = one.state == SweepState::waiting || one.state == SweepState::running;
            open += waits ? 1 : 0;
            done += !waits ? 1 : one.iterations > 0 ? static_cast<double>(one.iteration) / one.iterations : 0;
        }
        if (open == 0) {
            return cases;
        }
        progress.report(done / static_cast<double>(cases.size()),
                        core::counted(open, "case waits or runs", "cases wait or run"));
        const auto until = std::chrono::steady_clock::now() + pause;
        while (std::chrono::steady_clock::now() < until) {
            progress.check();
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
        pause = std::min(2 * pause, std::chrono::milliseconds(15000));
    }
}

std::vector<std::string> cancel_sweep(const Study& study, core::Progress& progress) {
    if (!study.sweep) {
        (void)wanted_cases(study, {}, progress);  // says that there is none
    }
    if (!find_program("scancel")) {
        throw core::SystemError("missing", "Slurm is not here: there is no 'scancel' on the PATH", {},
                                "cancel where the sweep was submitted");
    }
    SlurmQueue queue;
    std::map<std::string, std::string> jobs;  // by submission
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(study.folder() / study.sweep->folder, ignored)) {
        if (entry.path().extension() != ".submitted") {
            continue;
        }
        const auto claim = read_claim(entry.path().parent_path() / entry.path().stem());
        if (claim && queue.has_any(*claim)) {
            jobs.emplace(claim->submission, claim->job);
        }
    }
    std::vector<std::string> names = {"--name=" + study_job_name(study)}, numbers;
    for (const auto& [submission, job] : jobs) {
        names.push_back("--name=" + job_name(submission));
        numbers.push_back(job);
    }
    for (const auto& name : names) {
        const auto answer = ask("scancel", {name}, ".", progress);
        if (!answer || answer->code != 0) {
            throw core::SystemError("slurm", "scancel refused: " + (answer ? answer->text : ""), {});
        }
    }
    return numbers;
}

}  // namespace underbody::cases
