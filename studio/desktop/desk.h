// What every part of the window shares: the state with its history, the session, and the jobs. Nothing else changes
// what is shown: a widget asks for an action, and is drawn again from the state that comes of it.
#pragma once

#include <QObject>
#include <QStringList>
#include <memory>

#include "studio/desktop/jobs.h"
#include "studio/desktop/state/action_log.h"

class QTimer;

namespace underbody::studio {

class Desk : public QObject {
    Q_OBJECT
public:
    /// `log_folder`: where the lines of the session are kept as they come; empty: nowhere.
    Desk(Jobs& jobs, const std::filesystem::path& log_folder, QObject* parent);
    ~Desk() override;

    [[nodiscard]] const State& state() const { return *history_.state(); }
    [[nodiscard]] const Session& session() const { return *session_; }
    [[nodiscard]] const SessionPointer& session_pointer() const { return session_; }
    [[nodiscard]] const History& history() const { return history_; }
    [[nodiscard]] Jobs& jobs() { return jobs_; }
    [[nodiscard]] bool has_study() const { return !session_->folder.empty(); }

    /// Carries an action out; what is wrong with it is said by `refused`, and false is given. Actions with the same
    /// `gesture` are one step of the history until `end_gesture`.
    bool act(const Words& words, const QString& gesture = {});
    void end_gesture();
    void undo();
    void redo();
    void go_to(std::size_t position);

    /// Opens a study in a job, then acts.
    void open_study(const std::filesystem::path& folder);
    /// The same, then carries out these actions and computes it.
    void open_and_run(const std::filesystem::path& folder, const std::vector<Words>& then = {});
    /// Reads the study and its store again; what failed is forgotten. While it is computed: at the end of that.
    void reload();
    /// Computes what changed; what is stored is shown as it comes, also of a run that is cancelled or fails.
    void run_study();
    [[nodiscard]] bool computing() const { return jobs_.busy("run"); }
    /// Carries out the lines of a log, from an empty state, or from what `start` is: a study, a session, a shape, a
    /// CFD file. `recover`: lines that are refused (what they name has gone since) are passed over and said.
    void replay_log(const std::filesystem::path& file, const std::filesystem::path& start = {}, bool recover = false);
    void open_session_file(const std::filesystem::path& file);
    void save_session_file(const std::filesystem::path& file);
    /// Keeps what is seen of the study for the next time it is opened, where a log is kept; quietly nothing where its
    /// folder cannot be written.
    void keep_session() const;

Q_SIGNALS:
    void changed();
    void session_changed();
    /// A study was opened that was not open before.
    void opened(const QString& folder);
    void refused(const QString& what, std::exception_ptr error);
    void noted(const QString& text);
    /// Somebody looks for a number of the shape ("protrusion.height").
    void sought(const QString& parameter);
    void found(const core::Problem& problem);
    /// An action was done: its line, and the command that does the same (may be empty).
    void acted(const QString& line, const QString& command);

private:
    void open(const std::filesystem::path& folder, bool run, const std::vector<Words>& then = {});
    void take_session(const SessionPointer& session);
    void read_again();
    /// With what the last run could not do, which no store keeps.
    [[nodiscard]] SessionPointer with_failures(const SessionPointer& session) const;
    void tell_problems();
    /// Gets the session that the state names.
    void follow_state();
    /// What was taken into the study, or is taken back, is written.
    void write_measurements();
    void refresh_results();
    void start_from(const State& state, const QString& what);

    Jobs& jobs_;
    std::unique_ptr<ActionLog> log_;
    History history_;
    SessionPointer session_;
    std::vector<SessionPointer> earlier_;  ///< of studies that were open: undo goes back without reading
    QTimer* refresh_ = nullptr;
    std::filesystem::path failed_in_;                ///< the study of `failed_`
    std::vector<cases::StepResult> failed_;          ///< of its last run
    std::string written_in_;                         ///< the study of `written_`
    std::map<std::string, MeasuredRecord> written_;  ///< measurements as they stand on disk
};

}  // namespace underbody::studio
