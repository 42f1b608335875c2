// The study's own file follows the measurements of the state.
#include <map>

#include "cases/add_measurement.h"
#include "studio/desktop/desk.h"
#include "studio/desktop/state/measured.h"

namespace underbody::studio {

namespace fs = std::filesystem;

namespace {

using MeasuredRecords = std::map<std::string, MeasuredRecord>;

/// True when something was added.
bool change_measurements(const fs::path& folder, const MeasuredRecords& before, const MeasuredRecords& after) {
    const auto same_in = [](const MeasuredRecords& records, const auto& one) {
        const auto at = records.find(one.first);
        return at != records.end() && at->second == one.second;
    };
    bool added = false;
    for (const auto& one : before) {
        if (!same_in(after, one)) {
            cases::take_out(folder, new_measurement(one.first, one.second));
        }
    }
    for (const auto& one : after) {
        if (!same_in(before, one)) {
            cases::write_added(cases::with_new_measurement(folder, new_measurement(one.first, one.second)));
            added = true;
        }
    }
    return added;
}

}  // namespace

void Desk::write_measurements() {
    const State& wanted = state();
    const auto before = wanted.study == written_in_ ? written_ : wanted.measured;
    written_in_ = wanted.study;
    written_ = wanted.measured;
    if (before == wanted.measured) {
        return;
    }
    jobs_.cancel("run");  // of a study that is another one now
    jobs_.start("measurements", "writing measurements into the study",
                [this, folder = fs::path(wanted.study), before,
                 after = wanted.measured](core::Progress&) -> std::function<void()> {
                    try {
                        const bool added = change_measurements(folder, before, after);
                        return [this, added] {
                            Q_EMIT noted(added ? "study.toml has the measurement now."
                                               : "study.toml is without the measurement again.");
                            reload();
                            if (added) {
                                run_study();
                            }
                        };
                    } catch (const core::Error&) {
                        return [this, before, error = std::current_exception()] {
                            const std::size_t last = history_.position();
                            if (last > 0 && history_.steps()[last - 1].line.starts_with("measure ")) {
                                written_ = before;
                                undo();  // what cannot be done is not done
                            }
                            Q_EMIT refused("writing measurements into the study", error);
                        };
                    }
                });
}

}  // namespace underbody::studio
