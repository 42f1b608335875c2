#include "studio/desktop/desk.h"

#include <QTimer>
#include <set>

#include "core/file.h"
#include "studio/desktop/drawing_context.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/state/session_file.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace fs = std::filesystem;

Desk::Desk(Jobs& jobs, const fs::path& log_folder, QObject* parent)
    : QObject(parent), jobs_(jobs), session_(open_session({})), refresh_(new QTimer(this)) {
    if (!log_folder.empty()) {
        log_ = std::make_unique<ActionLog>(log_folder);
    }
    history_.on_line = [this](const std::string& line) {
        if (log_) {
            log_->append(line);
        }
        const bool action = line != "undo" && line != "redo" && history_.position() > 0;
        Q_EMIT acted(qt(line), action ? qt(history_.steps()[history_.position() - 1].command) : QString());
    };
    refresh_->setInterval(2500);
    connect(refresh_, &QTimer::timeout, this, &Desk::refresh_results);
}

Desk::~Desk() = default;

namespace {
/// What was asked for, as the history would name it.
QString title_of(const Words& words) {
    try {
        return qt(name_of(words));
    } catch (const core::Error&) {  // no such verb, or words that it does not know
        return words.empty() ? QString() : qt(words.front());
    }
}
}  // namespace

bool Desk::act(const Words& words, const QString& gesture) {
    try {
        if (history_.act(words, *session_, gesture.toStdString())) {
            follow_state();
            Q_EMIT changed();
        }
        return true;
    } catch (...) {
        Q_EMIT refused(title_of(words), std::current_exception());
        return false;
    }
}

void Desk::end_gesture() { history_.end_gesture(); }

void Desk::undo() {
    if (history_.undo()) {
        follow_state();
        Q_EMIT changed();
    }
}

void Desk::redo() {
    if (history_.redo()) {
        follow_state();
        Q_EMIT changed();
    }
}

void Desk::go_to(std::size_t position) {
    history_.go_to(position);
    follow_state();
    Q_EMIT changed();
}

void Desk::take_session(const SessionPointer& fresh) {
    SessionPointer session = fresh;
    if (fs::path(state().study) == fresh->folder) {
        try {
            session = with_models(fresh, state().accepted);
        } catch (const core::Error& error) {  // the result that was accepted is gone
            Q_EMIT found({core::Problem::Severity::warning, error.message(), error.place()});
        }
    }
    session = with_failures(session);
    std::erase_if(earlier_, [&](const SessionPointer& one) { return one->folder == session->folder; });
    earlier_.push_back(session);
    if (earlier_.size() > 3) {
        earlier_.erase(earlier_.begin());
    }
    session_ = session;
    tell_problems();
    Q_EMIT session_changed();
}

SessionPointer Desk::with_failures(const SessionPointer& session) const {
    if (failed_.empty() || session->folder != failed_in_) {
        return session;
    }
    auto newer = std::make_shared<Session>(*session);
    for (const auto& step : failed_) {
        for (auto& loads : newer->results.case_loads) {
            if (step.kind == "loads" && loads.name == step.name && loads.values.empty()) {
                loads.state = cases::StepState::failed;
                loads.error = step.error;
            }
        }
    }
    return newer;
}

/// What is wrong with what is shown, and what its numbers mean less for; what is alike in many cases once.
void Desk::tell_problems() {
    using Severity = core::Problem::Severity;
    const auto tell_steps = [&](const std::vector<cases::StepResult>& steps) {
        for (const auto& step : steps) {
            if (!step.error.empty()) {
                Q_EMIT found({Severity::error, step.kind + " '" + step.name + "': " + step.error, {}});
            }
        }
    };
    for (const auto& problem : session_->problems) {
        Q_EMIT found(problem);
    }
    for (const auto& note : session_->study.notes) {
        if (note.severity != Severity::note) {
            Q_EMIT found(note);
        }
    }
    // They count the cases that are alike: said when all are there.
    for (const auto& problem : computing() ? core::Problems{} : session_->results.gathered_warnings(false)) {
        Q_EMIT found({Severity::warning, problem.message, {problem.place.file, {}, {}, {}}});
    }
    tell_steps(session_->results.steps);
    if (session_->folder == failed_in_) {
        tell_steps(failed_);
    }
}

void Desk::follow_state() {
    const State& wanted = state();
    write_measurements();
    SessionPointer known;
    for (const auto& one : earlier_) {
        known = one->folder == fs::path(wanted.study) ? one : known;
    }
    if (wanted.study.empty()) {
        known = session_->folder.empty() ? session_ : open_session({});
    }
    if (known) {
        std::set<std::string> had, want;
        for (const auto& [name, file] : known->shape_files) {
            had.insert(file.string());
        }
        bool all = known == session_;
        for (const auto& entry : wanted.files) {
            all = all && (!entry.starts_with("shape:") || had.contains(entry.substr(6)));
        }
        if (!all) {
            take_session(with_files(*known, wanted.files));
        } else if (known->accepted != wanted.accepted) {
            take_session(known);
        }
        return;
    }
    jobs_.start("open", "opening " + qt(wanted.study),
                [this, study = wanted.study, files = wanted.files](core::Progress&) {
                    auto session = open_session(study, files);
                    return [this, session] { take_session(session); };
                });
}

void Desk::open_study(const fs::path& folder) { open(folder, false); }

void Desk::open_and_run(const fs::path& folder, const std::vector<Words>& then) { open(folder, true, then); }

namespace {
/// A session that was kept, of this very study.
bool fits(const fs::path& kept, const fs::path& study) {
    try {
        return fs::exists(kept) && fs::path(read_session(kept).state.study) == study;
    } catch (const core::Error&) {  // of a later version, or damaged: the study is opened as it is
        return false;
    }
}
}  // namespace

void Desk::keep_session() const {
    if (!log_ || state().study.empty()) {
        return;
    }
    try {
        write_session(state(), kept_session(state().study));
    } catch (const std::exception&) {  // a study that is only read
    }
}

void Desk::open(const fs::path& folder, bool run, const std::vector<Words>& then) {
    DrawingContext::instance().begin();  // its views will want it
    const QString name = qt(folder.string());
    const bool ask_kept = log_ && !run && state().files.empty();
    jobs_.start(
        "open", "opening " + name, [this, folder, name, run, then, ask_kept, files = state().files](core::Progress&) {
            auto session = open_session(folder, files);
            const fs::path kept = kept_session(session->folder);
            const bool has_kept = ask_kept && fits(kept, session->folder);
            return [this, session, name, run, then, kept, has_kept] {
                const bool other = state().study != session->folder.string();
                if (other) {
                    keep_session();
                }
                take_session(session);
                if (has_kept && other) {
                    act({"session", kept.string()});
                } else if (!run || other) {  // what the open one shows is kept
                    act({"open", session->folder.string()});
                    if (session->shapes.empty() && !session->study.cases.empty() && state().workspace == "design") {
                        act({"workspace", "compare"});  // there is no shape to design
                    }
                }
                for (const auto& words : then) {
                    act(words);
                }
                Q_EMIT noted(QString("Opened %1: %2 cases").arg(name).arg(session->study.cases.size()));
                if (run) {
                    run_study();
                } else if (session->results.loads.rows() == 0 && !session->study.cases.empty()) {
                    Q_EMIT noted(
                        session->results.changed > 0
                            ? "What was computed of this study rests on other files, options or another version "
                              "of the program: Study > Compute what changed (Ctrl+R) makes it anew."
                            : "Nothing of this study is computed yet: Study > Compute what changed (Ctrl+R).");
                }
                Q_EMIT opened(qt(session->folder.string()));
            };
        });
}

void Desk::reload() {
    if (!has_study()) {
        return;
    }
    if (computing()) {
        Q_EMIT noted("The study is being computed: it is read again when that is done.");
        return;
    }
    failed_.clear();
    read_again();
}

void Desk::read_again() {
    jobs_.start("open", "reading " + qt(session_->folder.string()),
                [this, folder = session_->folder, files = state().files](core::Progress&) {
                    auto session = open_session(folder, files);
                    return [this, session] { take_session(session); };
                });
}

void Desk::run_study() {
    if (!has_study()) {
        return;
    }
    if (computing()) {
        Q_EMIT noted("The study is being computed already.");
        return;
    }
    const fs::path folder = session_->folder;
    refresh_->start();
    failed_.clear();
    jobs_.start(
        "run", "computing",
        [this, folder](core::Progress& progress) {
            cases::RunOptions options;
            options.renderer = [](const core::Figure& figure) { return render_png(figure); };
            auto results = cases::run_study(cases::Study::open(folder), options, progress);
            const QString text = QString("Computed %1 steps, reused %2, failed %3")
                                     .arg(results.computed)
                                     .arg(results.reused)
                                     .arg(results.failed);
            std::erase_if(results.steps, [](const cases::StepResult& step) { return step.error.empty(); });
            return [this, text, folder, failed = std::move(results.steps)] {
                failed_in_ = folder;
                failed_ = failed;
                Q_EMIT noted(text);
            };
        },
        false,
        [this] {
            refresh_->stop();
            read_again();  // also what a cancelled or failed run has stored
        });
}

void Desk::refresh_results() {
    if (!computing() || jobs_.busy("refresh")) {
        return;
    }
    jobs_.start(
        "refresh", "reading results",
        [this, session = session_](core::Progress&) {
            auto newer = std::make_shared<Session>(*session);
            newer->results = cases::stored_results(session->study, {});
            newer->results.steps.clear();  // their errors are told at the end
            return [this, session, newer] {
                if (session_ == session) {
                    take_session(newer);
                }
            };
        },
        true);
}

void Desk::start_from(const State& state, const QString& what) {
    jobs_.start("open", what, [this, state](core::Progress&) {
        auto session = open_session(state.study, state.files);
        return [this, state, session] {
            auto on_line = history_.on_line;
            history_ = History(state);
            history_.on_line = std::move(on_line);
            written_in_ = state.study;  // a session that was saved changes no study
            written_ = state.measured;
            take_session(session);
            Q_EMIT changed();
            Q_EMIT opened(qt(state.study));
        };
    });
}

void Desk::open_session_file(const fs::path& file) {
    const auto saved = read_session(file);
    for (const auto& problem : saved.problems) {
        Q_EMIT found(problem);
    }
    if (!saved.missing.empty()) {
        throw core::InputError("missing", "the session needs " + saved.missing.front() + ", which is not there",
                               {file.string(), {}, {}, {}}, "File > Locate says where it is now");
    }
    start_from(saved.state, "opening " + qt(file.string()));
}

void Desk::save_session_file(const fs::path& file) {
    end_gesture();
    write_session(state(), file);
    Q_EMIT noted("Saved the session as " + qt(file.string()));
}

void Desk::replay_log(const fs::path& file, const fs::path& start, bool recover) {
    jobs_.start("open", "replaying " + qt(file.string()), [this, file, start, recover](core::Progress&) {
        auto history = std::make_shared<History>();
        SessionPointer session = open_session({});
        std::exception_ptr error;
        std::vector<std::string> refused;
        try {
            const auto load = [&](const State& state) { return load_session(state, session); };
            if (!start.empty()) {
                start_with(start, *history, session, load);
            }
            replay(core::read_file(file), file.string(), *history, session, load, recover ? &refused : nullptr);
        } catch (...) {
            error = std::current_exception();  // what came before the wrong line is kept
        }
        return [this, history, session, error, refused] {
            auto on_line = history_.on_line;
            history_ = *history;
            history_.on_line = std::move(on_line);
            for (std::size_t i = 0; i < history_.position(); ++i) {
                if (log_) {
                    log_->append(history_.steps()[i].line);
                }
            }
            take_session(session);
            written_in_ = state().study;
            written_.clear();
            for (const auto& one : session->study.measurements) {
                if (const auto known = state().measured.find(one.name); known != state().measured.end()) {
                    written_.insert(*known);
                }
            }
            write_measurements();
            Q_EMIT changed();
            for (const std::string& line : refused) {
                Q_EMIT noted("Not done again: " + qt(line));
            }
            if (error) {
                std::rethrow_exception(error);
            }
        };
    });
}

}  // namespace underbody::studio
