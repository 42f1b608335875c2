// What changed since an alarm of a watch, looked for beside it.
#pragma once

#include <future>
#include <optional>
#include <string>

#include "core/progress.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::studio {

/// Looks for what changed, in a thread of its own where the log does not wait.
class CauseSearch {
public:
    /// What a model lacks that was watched.
    struct Question {
        dynamics::Model model;
        dynamics::Measurements data;
    };
    struct Result {
        discovery::Discovery found;
        std::string error;        ///< why nothing can be told
        bool same_story = false;  ///< one change since the earlier alarm explains all of it
    };
    ~CauseSearch();
    void begin(Question now, std::optional<Question> earlier);
    [[nodiscard]] bool running() const { return result_.valid(); }
    [[nodiscard]] bool ready() const;
    /// Waits for it; Ctrl-C ends both. Throws core::Cancelled.
    Result wait(core::Progress& outer);
    /// `earlier`: since the first alarm of what may be one change, and the model then. One change that leaves noise is
    /// the simpler story than a second one, and its numbers are surer; else what changed of late is asked for.
    static Result search(const Question& now, const std::optional<Question>& earlier, core::Progress& progress);

private:
    core::Progress progress_;
    std::future<Result> result_;
};

}  // namespace underbody::studio
