#include "studio/desktop/session.h"

namespace underbody::studio {

SessionPointer open_session(const std::filesystem::path& folder) {
    auto study = cases::Study::open(folder);
    auto results = cases::stored_results(study, {});
    return std::make_shared<const Session>(Session{std::move(study), std::move(results)});
}

}  // namespace underbody::studio
