#include "cases/sweep.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "cases/lock.h"
#include "cases/openfoam_result.h"
#include "cases/openfoam_run.h"
#include "cases/sweep_parts.h"
#include "cases/sweep_slurm.h"
#include "core/file.h"
#include "core/text.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

/// One case in the making.
struct Job {
    SweepCase wanted;
    std::optional<Lock> lock;
    CaseRecord record;
    std::unique_ptr<OpenFoamRun> run;
    SweepOutcome outcome;
    int retries = 0;
    bool started = false;
    bool over = false;
};

/// A folder beside the cases for what is not to be lost: set_aside/NAME, set_aside/NAME-2, ...
void set_aside(const fs::path& folder, const std::string& name) {
    const fs::path shelf = folder.parent_path() / "set_aside";
    fs::create_directories(shelf);
    fs::path to = shelf / name;
    for (int i = 2; fs::exists(fs::symlink_status(to)); ++i) {
        to = shelf / (name + "-" + std::to_string(i));
    }
    fs::rename(folder, to);
}

/// Bytes of every file of a solved case's last time and of its forces, by name: what must still be there later.
nlohmann::json sizes_of_result(const fs::path& folder) {
    nlohmann::json sizes = nlohmann::json::object();
    std::vector<fs::path> roots = {folder / "postProcessing", folder / "constant" / "polyMesh"};
    if (const auto times = times_of(folder); !times.empty()) {
        roots.push_back(times.back().folder);
    }
    for (const auto& root : roots) {
        std::error_code error;
        for (auto entry = fs::recursive_directory_iterator(root, error);
             !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
            if (entry->is_regular_file(error)) {
                sizes[entry->path().lexically_relative(folder).generic_string()] = entry->file_size();
            }
        }
    }
    return sizes;
}

class Sweep {
public:
    Sweep(const Study& study, const SweepOptions& options, core::Progress& progress)
        : study_(study), options_(options), progress_(progress) {
        for (auto& wanted : wanted_cases(study, options, progress)) {
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
            const auto running =
                std::count_if(jobs_.begin(), jobs_.end(), [](const Job& job) { return job.started && !job.over; });
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
    void skip(Job& job, const std::string& why) {
        job.outcome.skipped = why;
        job.over = true;
        job.lock.reset();
    }

    void start(Job& job) {
        job.started = true;
        job.lock = Lock::take(beside(job.wanted.folder, ".lock"), "sweep");
        if (!job.lock) {
            skip(job, "being made by " + Lock::holder(beside(job.wanted.folder, ".lock")).value_or("another process"));
            return;
        }
        examine_again(study_, job.wanted, options_.submission, progress_);  // somebody else may have made it meanwhile
        if (job.wanted.present) {
            skip(job, "made by another process meanwhile");
            return;
        }
        if (job.wanted.state == SweepState::waiting || job.wanted.state == SweepState::running) {
            skip(job, job.wanted.reason);
            return;
        }
        try {
            begin(job);
        } catch (const core::InputError& error) {  // this body cannot be placed so; others can
            fail(job, error.what());
            return;
        }
        const auto from = job.run->went_on_from();
        const std::string where = !from       ? ""
                                  : *from > 0 ? "goes on from iteration " + core::format_number(*from)
                                              : "goes on with the mesh that is there";
        const std::string why = job.wanted.state == SweepState::stale ? job.wanted.reason : "";
        job.outcome.note = why + (why.empty() || where.empty() ? "" : "; ") + where;
    }

    void begin(Job& job) {
        prepare(job);
        job.run = std::make_unique<OpenFoamRun>(beside(job.wanted.folder, ".unfinished"), job.lock->descriptor(),
                                                options_.cores);
    }

    /// Tries a case again, whose lock and mark it keeps. Of the same inputs a solution diverges again.
    bool tried_again(Job& job, const core::InputError& error) {
        if (job.retries >= options_.retries ||
            std::string_view(error.what()).find("diverged") != std::string_view::npos) {
            return false;
        }
        ++job.retries;
        job.outcome.note += (job.outcome.note.empty() ? "" : "; ") + std::string("tried again (") +
                            std::to_string(job.retries) + " of " + std::to_string(options_.retries) +
                            "): " + error.what();
        job.run.reset();
        try {
            begin(job);
        } catch (const core::InputError& again) {
            fail(job, again.what());
        }
        return true;
    }

    /// The case in NAME.unfinished: as it was left when it is made of the same, else written anew.
    void prepare(Job& job) {
        const fs::path folder = beside(job.wanted.folder, ".unfinished");
        const auto flow = flow_of(study_, job.wanted.conditions);
        job.record = record_of(bodies_.shape(job.wanted.shape), flow);
        const auto there = read_record(folder);
        if (there && there->code == job.record.code && differences(*there, job.record).empty()) {
            job.record = *there;
            return;
        }
        std::error_code ignored;
        if (!times_of(folder).empty()) {
            set_aside(folder, job.wanted.name + "-unfinished");
        }
        fs::remove_all(folder, ignored);  // of a sweep that was killed before it had solved anything
        const auto& mesh = bodies_.surface(job.wanted.shape, progress_);
        job.record.walls = geometry::flow_domain(mesh, flow).walls;
        geometry::write_openfoam_case(bodies_.shape(job.wanted.shape), flow, folder, progress_);
        job.record.files = case_files(folder);
        write_record(folder, job.record);
    }

    void watch() {
        double done = 0;
        std::string what;
        const bool touch = std::chrono::steady_clock::now() - touched_ > std::chrono::seconds(60);
        if (touch) {
            touched_ = std::chrono::steady_clock::now();
        }
        for (auto& job : jobs_) {
            if (job.over || !job.started) {
                done += job.over ? 1 : 0;
                continue;
            }
            if (touch) {
                job.lock->touch();
            }
            try {
                if (job.run->finished()) {
                    finish(job);
                }
            } catch (const core::InputError& error) {
                if (tried_again(job, error)) {
                    continue;
                }
                if (error.kind() == "killed" || error.kind() == "cut") {
                    fail(job, error.what());  // what is there stays: the next sweep goes on from it
                } else {
                    keep_logs(job, error.what());
                }
            }
            if (!job.over) {
                const RunState state = run_state(job.run->folder());
                done += state.fraction();
                what += (what.empty() ? "" : ", ") + job.wanted.name + " " +
                        (state.iteration > 0 ? std::to_string(state.iteration) + "/" + std::to_string(state.iterations)
                                             : state.step);
            } else {
                done += 1;
            }
        }
        progress_.report(done / static_cast<double>(jobs_.size()), what);
    }

    /// A solve that failed: its folder becomes NAME.failed.
    void keep_logs(Job& job, std::string text) {
        const fs::path failed = beside(job.wanted.folder, ".failed");
        const fs::path folder = job.run->folder();
        job.run.reset();
        fs::remove_all(failed);
        fs::rename(folder, failed);
        if (const auto at = text.find(folder.string()); at != std::string::npos) {
            text.replace(at, folder.string().size(), failed.string());
        }
        core::write_file(failed / failure_file, text + "\n");
        fail(job, text);
    }

    void fail(Job& job, const std::string& error) {
        job.outcome.error = error;
        end(job);
    }

    void end(Job& job) {
        std::error_code ignored;
        fs::remove(claim_file(job.wanted.folder), ignored);
        job.over = true;
        job.run.reset();
        job.lock.reset();
        if (options_.ended) {
            options_.ended(job.wanted, job.outcome.error);
        }
    }

    void finish(Job& job) {
        const fs::path folder = job.run->folder();
        job.outcome.seconds = job.run->seconds();
        const SolveEnd ended = solve_end(folder);
        if (!ended.solved) {
            throw core::InputError(ended.diverged ? "solver" : "cut",
                                   "the script ended without a whole solution: " + ended.why,
                                   {(folder / "log.Allrun").string(), {}, {}, {}});
        }
        const SettledLoads loads = settled_loads(folder);
        if (loads.iterations > 0 && !loads.settled) {
            job.outcome.note += (job.outcome.note.empty() ? "" : "; ") + ("not settled: " + loads.text);
        }
        nlohmann::json marker = {{"settled", loads.iterations > 0 ? nlohmann::json(loads.settled) : nlohmann::json()},
                                 {"settled_text", loads.text},
                                 {"walls", job.record.walls},
                                 {"seconds", job.outcome.seconds},
                                 {"iterations", run_state(folder).iteration},
                                 {"converged", ended.converged},
                                 {"result", sizes_of_result(folder)},
                                 {"conditions", nlohmann::json::object()}};
        for (const auto& [name, value] : job.wanted.conditions.texts) {
            marker["conditions"][name] = value;
        }
        for (const auto& [name, value] : job.wanted.conditions.numbers) {
            marker["conditions"][name] = value;
        }
        core::write_file(folder / solved_marker, marker.dump(2) + "\n");
        job.run.reset();
        if (fs::exists(job.wanted.folder)) {
            if (options_.stale == StaleCases::replace) {
                fs::remove_all(job.wanted.folder);
            } else {
                set_aside(job.wanted.folder, job.wanted.name);
            }
        }
        fs::rename(folder, job.wanted.folder);
        std::error_code ignored;
        fs::remove_all(beside(job.wanted.folder, ".failed"), ignored);  // an earlier attempt
        end(job);
    }

    const Study& study_;
    const SweepOptions& options_;
    core::Progress& progress_;
    Bodies bodies_;
    std::vector<Job> jobs_;
    std::chrono::steady_clock::time_point touched_ = std::chrono::steady_clock::now();
};

}  // namespace

std::vector<SweepOutcome> sweep_locally(const Study& study, const SweepOptions& options, core::Progress& progress) {
    return Sweep(study, options, progress).run();
}

}  // namespace underbody::cases
