#include "studio/desktop/state/known_models.h"

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

#include "core/inputs.h"

namespace underbody::studio {

namespace {

struct KnownModel {
    std::filesystem::path file;
    std::vector<std::pair<std::filesystem::path, core::FileStamp>> rests_on;
    std::shared_ptr<const dynamics::Model> model;

    [[nodiscard]] bool still_true() const {
        return std::all_of(rests_on.begin(), rests_on.end(),
                           [](const auto& input) { return core::stamp_of(input.first) == input.second; });
    }
};

std::mutex mutex;
std::vector<KnownModel> known;  ///< the last used one behind
std::size_t read_so_far = 0;

}  // namespace

std::shared_ptr<const dynamics::Model> known_model(const std::filesystem::path& file) {
    constexpr std::size_t most = 16;
    const std::lock_guard<std::mutex> lock(mutex);
    const auto at = std::find_if(known.begin(), known.end(), [&](const auto& one) { return one.file == file; });
    if (at != known.end() && at->still_true()) {
        std::rotate(at, at + 1, known.end());
        return known.back().model;
    }
    if (at != known.end()) {
        known.erase(at);
    }
    KnownModel fresh;
    fresh.file = file;
    std::mutex of_stamps;  // readers may be parallel
    core::InputRecord record([&](const core::Input& input) {
        const std::lock_guard<std::mutex> alone(of_stamps);
        fresh.rests_on.emplace_back(input.path, core::stamp_of(input.path));
        return std::string();
    });
    ++read_so_far;
    {
        const core::RecordInputs recording(record);
        fresh.model = std::make_shared<const dynamics::Model>(dynamics::read_model(file));
    }
    if (known.size() == most) {
        known.erase(known.begin());
    }
    known.push_back(std::move(fresh));
    return known.back().model;
}

std::size_t models_read() {
    const std::lock_guard<std::mutex> lock(mutex);
    return read_so_far;
}

}  // namespace underbody::studio
