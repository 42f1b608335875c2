#include "studio/cli/cause_search.h"

#include <chrono>
#include <utility>

#include "core/error.h"

namespace underbody::studio {

namespace {

CauseSearch::Result answer(const CauseSearch::Question& question, core::Progress& progress) {
    discovery::DiscoverOptions options;
    options.consequence = false;
    options.figures = false;
    try {
        return {discovery::discover(question.model, question.data, options, progress), {}, false};
    } catch (const core::Cancelled&) {
        throw;
    } catch (const core::Error& error) {
        return {{}, error.message(), false};
    }
}

}  // namespace

CauseSearch::~CauseSearch() {
    progress_.cancel();
    if (result_.valid()) {
        result_.wait();
    }
}

void CauseSearch::begin(Question now, std::optional<Question> earlier) {
    result_ = std::async(std::launch::async, [this, now = std::move(now), earlier = std::move(earlier)] {
        return search(now, earlier, progress_);
    });
}

bool CauseSearch::ready() const {
    return running() && result_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

CauseSearch::Result CauseSearch::wait(core::Progress& outer) {
    while (result_.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) {
        if (outer.cancelled()) {
            progress_.cancel();
        }
    }
    return result_.get();
}

CauseSearch::Result CauseSearch::search(const Question& now, const std::optional<Question>& earlier,
                                        core::Progress& progress) {
    if (earlier) {
        Result result = answer(*earlier, progress);
        if (result.error.empty() && result.found.verdict == "effect" && result.found.rest.is_noise) {
            result.same_story = true;
            return result;
        }
    }
    return answer(now, progress);
}

}  // namespace underbody::studio
